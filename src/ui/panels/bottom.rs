//! The tabs along the bottom.

use eframe::egui::{ScrollArea, Ui, UiBuilder};

use super::{frame_times, log, plan, scaling, stability, tradeoff, xray};
use crate::ui::checks;
use crate::ui::command::Command;
use crate::ui::fates::tab as fates;
use crate::ui::probe;
use crate::ui::range::panel;
use crate::ui::session::Session;
use crate::ui::trace::panel as trace;
use crate::ui::vertices;
use crate::ui::watch;

/// A tab.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tab {
    /// Frame time of each upscaler.
    #[default]
    FrameTime,
    /// What each upscaler costs and how wrong it is.
    ErrorTime,
    /// Every step of the arithmetic of a pixel.
    Arithmetic,
    /// What a pixel of the picture is made of.
    Xray,
    /// How often each value is there.
    Histogram,
    /// Where triangles and fragments went.
    Fates,
    /// What the scene needs and what is left out.
    Plan,
    /// How cost grows.
    Scaling,
    /// How the engine does on hard cases.
    Stability,
    /// What holds for every fragment.
    Checks,
    /// What all buffers hold at watched pixels.
    Watch,
    /// The vertices of the picked triangle at every stage.
    Vertices,
    /// How firmly the picture stands.
    Probe,
    /// Messages.
    Log,
}

/// What each of them needs to be of use, in points.
pub const LEAST_HEIGHT: f32 = 90.0;

/// All tabs, with name and explanation.
pub const TABS: &[(Tab, &str, &str)] = &[
    (Tab::FrameTime, "Frame time", "How long a frame takes with each upscaler"),
    (Tab::ErrorTime, "Error vs time", "What each upscaler costs and how wrong its picture is; a click compares it"),
    (
        Tab::Arithmetic,
        "Arithmetic",
        "Every step from the corners of a triangle to the picked pixel, with the numbers and what each step rounded",
    ),
    (
        Tab::Xray,
        "X-ray",
        "The samples that the upscaler made the picked pixel of, and how the method answers test signals",
    ),
    (Tab::Histogram, "Histogram", "How often each value of what is shown is there, and the figures of it"),
    (Tab::Fates, "Fates", "How every triangle and every fragment ended, in all and per object; a click selects them"),
    (Tab::Plan, "Plan", "What this scene needs, and what is left out of each draw and why"),
    (Tab::Scaling, "Scaling", "How the cost of a frame grows with triangles, pixels, layers and threads"),
    (
        Tab::Stability,
        "Stability",
        "How right and how fast every rasterizer, arithmetic and depth format is on hard cases",
    ),
    (Tab::Checks, "Assertions", "What should hold for every fragment of a frame: checked on demand"),
    (Tab::Watch, "Watch", "What all buffers hold at pixels that are watched, followed from frame to frame"),
    (Tab::Vertices, "Vertices", "The vertices of the picked triangle, or of its object, at every stage"),
    (
        Tab::Probe,
        "Probe",
        "Which pixels and triangles do not stand firm when all moves by a few units in the last place",
    ),
    (Tab::Log, "Log", "Everything that was reported"),
];

/// Room for all tabs and what belongs to one of them in one row, points.
const ONE_ROW_POINTS: f32 = 1500.0;

/// Draws the tabs and the chosen one.
pub fn ui(ui: &mut Ui, tab: &mut Tab, session: &Session, commands: &mut Vec<Command>) {
    if ui.available_width() >= ONE_ROW_POINTS {
        ui.horizontal(|ui| {
            tabs(ui, tab);
            if has_controls(*tab) {
                ui.separator();
                controls(ui, *tab, session, commands);
            }
        });
    } else {
        ui.horizontal_wrapped(|ui| tabs(ui, tab));
        if has_controls(*tab) {
            ui.horizontal(|ui| controls(ui, *tab, session, commands));
        }
    }
    ui.add_space(4.0);
    panel::tell(*tab == Tab::Histogram, session, commands);
    // A tab has the room that there is: one that wants more would move the picture, whose size may be that of the canvas.
    let room = ui.available_rect_before_wrap();
    let mut within = ui.new_child(UiBuilder::new().id_salt("tab").max_rect(room).layout(*ui.layout()));
    within.shrink_clip_rect(room.expand2(ui.spacing().item_spacing));
    content(&mut within, *tab, session, commands);
    ui.advance_cursor_after_rect(room);
}

/// What the chosen tab shows.
fn content(ui: &mut Ui, tab: Tab, session: &Session, commands: &mut Vec<Command>) {
    match tab {
        Tab::Histogram => panel::ui(ui, session, commands),
        Tab::FrameTime => frame_times::ui(ui, session, commands),
        Tab::ErrorTime => tradeoff::ui(ui, session, commands),
        Tab::Arithmetic => trace::ui(ui, session, commands),
        Tab::Xray => xray::ui(ui, session, commands),
        Tab::Fates => fates::ui(ui, session, commands),
        Tab::Scaling => scaling::ui(ui, session),
        Tab::Watch => watch::panel::ui(ui, session, commands),
        Tab::Stability => stability::ui(ui, session, commands),
        Tab::Checks => checks::panel::ui(ui, session, commands),
        Tab::Vertices => vertices::ui(ui, session, commands),
        Tab::Probe => probe::ui(ui, session, commands),
        Tab::Plan => {
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| plan::ui(ui, session));
        }
        Tab::Log => {
            ScrollArea::vertical().auto_shrink(false).stick_to_bottom(true).show(ui, |ui| log::ui(ui, session));
        }
    }
}

fn tabs(ui: &mut Ui, tab: &mut Tab) {
    for (value, name, help) in TABS {
        ui.selectable_value(tab, *value, *name).on_hover_text(*help);
    }
}

fn has_controls(tab: Tab) -> bool {
    !matches!(tab, Tab::Arithmetic | Tab::Xray | Tab::Log)
}

/// What is asked of the chosen tab.
fn controls(ui: &mut Ui, tab: Tab, session: &Session, commands: &mut Vec<Command>) {
    match tab {
        Tab::FrameTime => frame_times::controls(ui, session, commands),
        Tab::ErrorTime => tradeoff::controls(ui, session, commands),
        Tab::Stability => stability::controls(ui, session, commands),
        Tab::Plan => plan::controls(ui, session, commands),
        Tab::Scaling => scaling::controls(ui, session, commands),
        Tab::Checks => checks::panel::controls(ui, session, commands),
        Tab::Histogram => panel::controls(ui, session, commands),
        Tab::Fates => fates::controls(ui, session),
        Tab::Watch => watch::panel::controls(ui, session, commands),
        Tab::Vertices => vertices::controls(ui, session, commands),
        Tab::Probe => probe::controls(ui, session, commands),
        Tab::Arithmetic | Tab::Xray | Tab::Log => {}
    }
}
