//! The panels around the canvas, one file each. A panel reads the session and emits commands.

pub(crate) mod add_upscaler;

mod budget_line;

pub(crate) mod case;

pub(crate) mod dialogs;

pub(crate) mod frame_times;

pub(crate) mod inspector;

pub(crate) mod log;

pub(crate) mod menu;

pub(crate) mod message;

pub(crate) mod modal;

pub(crate) mod pipeline;

pub(crate) mod skipped_work;

mod scene_menu;

pub(crate) mod scaling;

pub(crate) mod setting_row;

mod smooth;

pub(crate) mod stability;

pub(crate) mod switches;

pub(crate) mod system_dialog;

pub(crate) mod tradeoff;

mod tools;

pub(crate) mod transport;

pub(crate) mod filter_taps;

use eframe::egui::Ui;

use super::widgets::choice;
use crate::pipeline::settings::Choice;

/// Draws a picker for a [`Choice`], with names and help texts from the enum. Returns whether the value changed.
pub(crate) fn pick<C: Choice>(ui: &mut Ui, value: &mut C) -> bool {
    let options: Vec<_> = C::ALL.iter().map(|c| (*c, c.name(), c.help())).collect();
    choice(ui, value, &options)
}
