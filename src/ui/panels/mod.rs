//! Panels of the window, and the parts that they consist of. A panel reads the session and emits commands.

pub(crate) mod add_upscaler;
mod budget_line;
pub(crate) mod camera_path;
pub(crate) mod canvas;
pub(crate) mod case;
pub(crate) mod checks;
pub(crate) mod compare;
pub(crate) mod explaining;
pub(crate) mod fates;
pub(crate) mod fault_bar;
pub(crate) mod filmstrip;
pub(crate) mod filter_taps;
pub(crate) mod frame_times;
pub(crate) mod inspector;
pub(crate) mod lab;
pub(crate) mod legend_strip;
pub(crate) mod log;
pub(crate) mod menu;
pub(crate) mod mesh_view;
pub(crate) mod message;
pub(crate) mod navigate;
pub(crate) mod onboarding;
pub(crate) mod over_time;
pub(crate) mod overlays;
pub(crate) mod picture;
pub(crate) mod picture_size;
pub(crate) mod pipeline;
pub(crate) mod place;
pub(crate) mod probe;
pub(crate) mod range;
pub(crate) mod scaling;
mod scene_menu;
pub(crate) mod scene_time;
pub(crate) mod scrub;
pub(crate) mod sequences;
pub(crate) mod setting_row;
pub(crate) mod skipped_work;
mod smooth;
pub(crate) mod stability;
pub(crate) mod switches;
pub(crate) mod temporal;
mod tools;
pub(crate) mod trace;
pub(crate) mod tradeoff;
pub(crate) mod transport;
pub(crate) mod vertices;
pub(crate) mod watch;
pub(crate) mod what_if;

use std::time::Instant;

use eframe::egui::{Frame, ScrollArea, Ui};

use super::session::Session;
use super::session::command::Command;
use super::theme::space;
use super::thumbnails::Thumbnails;
use super::widgets::choice;
use crate::manual::Chapter;
use crate::pipeline::settings::Choice;
use canvas::CanvasView;
use case::CaseView;
use compare::tiles::TilesView;
use filmstrip::FilmstripView;
use inspector::Inspector;
use mesh_view::MeshPane;

/// Drawing of a panel, declared in the file of the panel.
pub(crate) struct PanelSpec {
    /// Chapter of the manual that describes the panel.
    pub(crate) chapter: Chapter,
    /// Whether the panel takes the space that a larger window offers, instead of keeping its size.
    pub(crate) grows: bool,
    /// Whether the panel has a title even if it is alone in its area. A panel with a toolbar of its own needs none.
    pub(crate) titled: bool,
    /// Draws the controls in a row above the content; `None` if there are none.
    pub(crate) controls: Option<fn(&mut Ui, &mut PanelContext<'_>)>,
    /// Draws the content of the panel into the remaining space.
    pub(crate) content: fn(&mut Ui, &mut PanelContext<'_>),
}

/// Inputs of a panel, and the list to which it appends commands.
pub(crate) struct PanelContext<'a> {
    /// Session that the panel reads.
    pub(crate) session: &'a Session,
    /// Widget state of all panels.
    pub(crate) widgets: &'a mut PanelWidgets,
    /// Commands to run after the layout pass.
    pub(crate) commands: &'a mut Vec<Command>,
}

/// State of the widgets in all panels.
#[derive(Default)]
pub(crate) struct PanelWidgets {
    /// Canvas with the picture.
    pub(crate) canvas: CanvasView,
    /// Tiles of a comparison.
    pub(crate) tiles: TilesView,
    /// Filmstrip below the tiles.
    pub(crate) filmstrip: FilmstripView,
    /// Whether the last pass showed the filmstrip.
    pub(crate) shows_filmstrip: bool,
    /// Height of the panel with the picture, in points, as of the last pass that showed it.
    pub(crate) picture_panel_height: f32,
    /// Pictures of a case.
    pub(crate) case: CaseView,
    /// Widget that draws the scene from a second camera.
    pub(crate) mesh: MeshPane,
    /// Inspector of the picked pixel.
    pub(crate) inspector: Inspector,
    /// Small pictures of the built-in scenes.
    pub(crate) thumbnails: Thumbnails,
    /// Size of the canvas in screen pixels, as of the last frame that showed it.
    pub(crate) canvas_px: (u32, u32),
    /// Size of the visible canvas in screen pixels, without the legend strip.
    pub(crate) visible_px: (u32, u32),
    /// Time at which the oldest unanswered render request was sent; `None` if all requests are answered.
    pub(crate) requested_at: Option<Instant>,
    /// Whether pictures are drawn synchronously, as in screenshots and tests.
    pub(crate) is_synchronous: bool,
}

/// Draws content with the margin that panels with text have.
pub(crate) fn framed(ui: &mut Ui, content: impl FnOnce(&mut Ui)) {
    Frame::new().inner_margin(space::S).show(ui, content);
}

/// Draws the content of a panel that scrolls vertically.
pub(crate) fn scrolling(ui: &mut Ui, content: impl FnOnce(&mut Ui)) {
    ScrollArea::vertical().auto_shrink(false).show(ui, content);
}

/// Draws a picker for a [`Choice`], with names and help texts from the enum. Returns whether the value changed.
pub(crate) fn pick<C: Choice>(ui: &mut Ui, value: &mut C) -> bool {
    let options: Vec<_> = C::ALL.iter().map(|c| (*c, c.name(), c.help())).collect();
    choice(ui, value, &options)
}
