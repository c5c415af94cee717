//! The panels around the canvas, one file each. A panel reads the session and pushes commands.

pub mod bottom;

pub mod case;

pub mod dialogs;

pub mod frame_times;

pub mod inspector;

pub mod log;

pub mod menu;

pub mod message;

pub mod pipeline;

pub mod plan;

pub mod scaling;
mod smooth;

pub mod stability;

pub mod switches;

pub mod tradeoff;

pub mod transport;

pub mod xray;

use eframe::egui::Ui;

use super::widgets::choice;
use crate::pipeline::settings::Choice;

/// Draws a picker for a [`Choice`], with names and help texts from the enum. Returns whether the value changed.
pub fn pick<C: Choice>(ui: &mut Ui, value: &mut C) -> bool {
    let options: Vec<_> = C::ALL.iter().map(|c| (*c, c.name(), c.help())).collect();
    choice(ui, value, &options)
}
