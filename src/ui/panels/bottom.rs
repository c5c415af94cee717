//! The tabs at the bottom of the window.

use eframe::egui::{ScrollArea, Ui, UiBuilder};

use super::{frame_times, log, plan, scaling, stability, tradeoff, xray};
use crate::manual::Chapter;
use crate::ui::checks;
use crate::ui::command::Command;
use crate::ui::fates::tab as fates;
use crate::ui::manual::manual_button;
use crate::ui::probe;
use crate::ui::range::panel;
use crate::ui::session::Session;
use crate::ui::trace::panel as trace;
use crate::ui::vertices;
use crate::ui::watch;

/// Tab at the bottom of the window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Tab {
    /// Frame time of each upscaler.
    #[default]
    FrameTime,
    /// Error against time of each upscaler.
    ErrorTime,
    /// Every arithmetic step of a fragment at the picked pixel.
    Arithmetic,
    /// Samples from which the picked pixel was reconstructed, with their weights.
    Xray,
    /// Histogram and statistics of the values shown on the canvas.
    Histogram,
    /// Fate of every triangle and fragment, such as culled or visible.
    Fates,
    /// Parts of the pipeline that each draw runs or skips, with reasons.
    Plan,
    /// Scaling of the frame time with triangles, pixels, overlapping layers and threads.
    Scaling,
    /// Stability report on difficult test cases.
    Stability,
    /// Assertions that are checked for every fragment.
    Checks,
    /// Values of all buffers at watched pixels.
    Watch,
    /// Vertices of the picked triangle after every pipeline stage.
    Vertices,
    /// Stability probe: pixels that change if the camera or the vertices are jittered by a few units in the last place.
    Probe,
    /// Log of all messages.
    Log,
}

/// Minimum useful height of a tab's content, in points.
pub(crate) const MIN_HEIGHT: f32 = 90.0;

/// All tabs, each with its name and help text.
pub(crate) const TABS: &[(Tab, &str, &str)] = &[
    (Tab::FrameTime, "Frame time", "Frame time of each upscaler"),
    (Tab::ErrorTime, "Error vs time", "Error and time of each upscaler; click a point to compare that upscaler"),
    (
        Tab::Arithmetic,
        "Calculation",
        "Every step from the corners of a triangle to the picked pixel, with numbers and rounding errors",
    ),
    (
        Tab::Xray,
        "X-ray",
        "Samples from which the upscaler reconstructed the picked pixel, and its response to test signals",
    ),
    (Tab::Histogram, "Histogram", "Histogram and statistics of the shown values"),
    (
        Tab::Fates,
        "Fates",
        "Fate of every triangle and fragment, such as culled or visible; click a fate to select its triangles",
    ),
    (Tab::Plan, "Plan", "Parts of the pipeline that each draw runs or skips, and why"),
    (Tab::Scaling, "Scaling", "Frame time against the number of triangles, pixels, layers and threads"),
    (
        Tab::Stability,
        "Stability",
        "Error and time of every rasterizer, arithmetic and depth format on ill-conditioned and extreme cases",
    ),
    (Tab::Checks, "Assertions", "Conditions that every fragment of a frame should satisfy, checked on demand"),
    (Tab::Watch, "Watch", "Values of all buffers at the watched pixels, updated after every frame"),
    (Tab::Vertices, "Vertices", "Vertices of the picked triangle, or of its object, at every stage"),
    (Tab::Probe, "Probe", "Pixels that change if the camera or the vertices move by a few units in the last place"),
    (Tab::Log, "Log", "All messages, warnings and errors"),
];

/// Minimum width at which the tabs and the controls of the selected tab share one row, in points.
const ONE_ROW_POINTS: f32 = 1500.0;

/// Draws the tabs and the content of the selected tab.
pub(crate) fn ui(ui: &mut Ui, tab: &mut Tab, session: &Session, commands: &mut Vec<Command>) {
    if ui.available_width() >= ONE_ROW_POINTS {
        ui.horizontal(|ui| {
            tabs(ui, tab, commands);
            if has_controls(*tab) {
                ui.separator();
                controls(ui, *tab, session, commands);
            }
        });
    } else {
        ui.horizontal_wrapped(|ui| tabs(ui, tab, commands));
        if has_controls(*tab) {
            ui.horizontal(|ui| controls(ui, *tab, session, commands));
        }
    }
    ui.add_space(4.0);
    panel::notify_open(*tab == Tab::Histogram, session, commands);
    // The content is clipped to the available space. A taller tab would shrink the canvas, and also the picture if it
    // has the size of the canvas.
    let room = ui.available_rect_before_wrap();
    let mut within = ui.new_child(UiBuilder::new().id_salt("tab").max_rect(room).layout(*ui.layout()));
    within.shrink_clip_rect(room.expand2(ui.spacing().item_spacing));
    content(&mut within, *tab, session, commands);
    ui.advance_cursor_after_rect(room);
}

/// Draws the content of the selected tab.
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

fn tabs(ui: &mut Ui, tab: &mut Tab, commands: &mut Vec<Command>) {
    for (value, name, help) in TABS {
        ui.selectable_value(tab, *value, *name).on_hover_text(*help);
    }
    manual_button(ui, tab.chapter(), commands);
}

impl Tab {
    /// Returns the chapter of the manual that describes the tab.
    fn chapter(self) -> Chapter {
        match self {
            Self::FrameTime | Self::ErrorTime | Self::Scaling => Chapter::ErrorAgainstTime,
            Self::Arithmetic | Self::Watch => Chapter::InspectingAPixel,
            Self::Xray => Chapter::ComparingUpscalers,
            Self::Histogram => Chapter::ReadingPlots,
            Self::Fates | Self::Vertices => Chapter::Stages,
            Self::Plan => Chapter::SkippedWork,
            Self::Stability | Self::Checks | Self::Probe => Chapter::Stability,
            Self::Log => Chapter::GettingStarted,
        }
    }
}

fn has_controls(tab: Tab) -> bool {
    !matches!(tab, Tab::Arithmetic | Tab::Xray | Tab::Log)
}

/// Draws the controls of the selected tab.
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
