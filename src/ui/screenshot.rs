//! Screenshots of the workbench, without a window or a display.

use eframe::egui::{self, Vec2};

use super::engine::Shown;
use super::headless::Headless;
use super::session::command::Command;
use super::session::compare::CompareChange;
use super::session::workspace::{Panel, Workspace};
use super::session::{Preferences, checks, fates, lab};
use super::start::{WindowStart, workbench};
use super::worker::Worker;
use crate::image::{Image, Rgba8};
use crate::inspect::fates::{Bin, TriangleFate};
use crate::inspect::mesh_view::MeshStyle;
use crate::inspect::scrub::Moment;
use crate::lab::Page;
use crate::pipeline::viewport::Viewport;

/// Colour theme of the workbench.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Theme {
    /// Light text on dark panels.
    Dark,
    /// Dark text on light panels.
    Light,
}

/// Settings of a screenshot of the workbench.
#[derive(Clone, Debug)]
pub(crate) struct ScreenshotRequest {
    /// Initial state of the workbench.
    pub(crate) start: WindowStart,
    /// Width and height of the screenshot, in pixels.
    pub(crate) size: Viewport,
    /// Interface scale, in pixels per point.
    pub(crate) pixels_per_point: f32,
    /// Colour theme of the screenshot.
    pub(crate) theme: Theme,
    /// Whether all upscalers are timed first, so that the screenshot contains their frame times. Takes a few seconds.
    pub(crate) measure: bool,
    /// Whether the stability probe is run first, so that the screenshot contains its result.
    pub(crate) probe: bool,
    /// Style of the mesh view beside the picture; `None` shows no mesh view.
    pub(crate) mesh: Option<MeshStyle>,
    /// Comparison to show; `None` shows no comparison.
    pub(crate) compare: Option<CompareChange>,
    /// Workspace to show; `None` shows the one that the other fields need.
    pub(crate) workspace: Option<Workspace>,
    /// Panel to show; `None` shows the first ones of the workspace.
    pub(crate) panel: Option<Panel>,
    /// Buffer, stage or intermediate value on the canvas; `None` shows the final colours.
    pub(crate) shown: Option<Shown>,
    /// Point at which drawing of the frame stops; `None` draws the complete frame.
    pub(crate) moment: Option<Moment>,
    /// Fate by which to select triangles in the panel “Triangle fates”, which is then shown; `None` selects none.
    pub(crate) fate: Option<TriangleFate>,
    /// Column and row of the picked pixel; `None` picks one near the centre.
    pub(crate) selected: Option<(u32, u32)>,
    /// Page of the 2D lab to show instead of the pipeline, and the number of algorithm steps to show on it; an inner
    /// `None` shows all steps.
    pub(crate) lab: Option<(Page, Option<usize>)>,
    /// Commands to apply before the first layout pass.
    pub(crate) first: Vec<Command>,
}

/// Number of layout passes for a screenshot. The first one determines the size of the canvas, the second one shows a
/// frame, and sizes converge in the others.
const SCREENSHOT_PASSES: usize = 6;

/// Renders the whole workbench to an image on the CPU, without a window or a display.
///
/// # Errors
///
/// Returns the size of the scene's picture if the pixel to pick lies outside the picture.
pub(crate) fn screenshot(request: &ScreenshotRequest) -> Result<Image<Rgba8>, Viewport> {
    let Viewport { width, height } = request.size;
    let theme = match request.theme {
        Theme::Dark => egui::Theme::Dark,
        Theme::Light => egui::Theme::Light,
    };
    let size_points = Vec2::new(width as f32, height as f32) / request.pixels_per_point;
    let mut headless = Headless::new(size_points, request.pixels_per_point, theme);
    let mut app = workbench(request.start.clone(), &Preferences::default(), Worker::inline());
    app.session_mut().pick = request.selected.or(request.start.initial_view.pixel);
    if let Some(change) = request.compare.clone() {
        app.session_mut().apply(Command::Compare(change));
    }
    if request.panel == Some(Panel::Assertions) {
        app.session_mut().features.checks.apply(checks::ChecksChange::Run);
    }
    if let Some(style) = request.mesh {
        let mesh = &mut app.session_mut().features.mesh_view;
        (mesh.open, mesh.style) = (true, style);
    }
    if let Some(workspace) = request.workspace {
        app.session_mut().show_workspace(workspace);
    }
    if let Some(panel) = request.panel {
        app.show_panel(panel);
    }
    if let Some(shown) = request.shown {
        app.session_mut().set_shown(shown);
    }
    if let Some(moment) = request.moment {
        app.session_mut().begin_at(moment);
    }
    if let Some(fate) = request.fate {
        app.show_panel(Panel::TriangleFates);
        app.session_mut().apply(Command::Fates(fates::FatesChange::Bin(Bin::Triangles(fate))));
    }
    if let Some((page, step)) = request.lab {
        let changes =
            [lab::LabChange::Open(true), lab::LabChange::Page(page), lab::LabChange::Go(step.unwrap_or(usize::MAX))];
        changes.into_iter().chain(request.measure.then_some(lab::LabChange::Compare)).for_each(|change| {
            app.session_mut().features.lab.apply(change);
        });
    }
    app.queue(request.first.clone());
    for _ in 0..SCREENSHOT_PASSES {
        headless.pass(Vec::new(), |ui| app.show(ui));
    }
    if request.lab.is_some() {
        return Ok(headless.picture());
    }
    let picture = app.session().viewport();
    if request.selected.is_some_and(|(x, y)| x >= picture.width || y >= picture.height) {
        return Err(picture);
    }
    if request.probe {
        super::session::probe::probe_now(app.session_mut());
        headless.pass(Vec::new(), |ui| app.show(ui));
    }
    if request.measure {
        app.measure();
        headless.pass(Vec::new(), |ui| app.show(ui));
        headless.pass(Vec::new(), |ui| app.show(ui));
    }
    Ok(headless.picture())
}
