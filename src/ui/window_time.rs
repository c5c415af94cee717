//! Time spent in the user interface itself: laying out the panels, tessellating them and submitting the triangles to
//! the graphics driver. The picture is not included, because other threads draw it.

use super::app::Workbench;
use super::headless::{Headless, PassCost};
use super::session::command::Command;
use super::session::compare::{CompareChange as Compare, Mode};
use super::session::timings::request::MeasureRequest;
use super::session::workspace::{Panel, WorkspaceChange};
use super::session::{Preferences, lab, mesh_view, overlays, range, watch, what_if};
use super::start::{WindowStart, workbench};
use super::worker::Worker;
use crate::chain::Recipe;
use crate::inspect::Stage;
use crate::inspect::overlays::Overlay;
use crate::lab::Page;
use crate::measure::metric::Metric;
use crate::measure::motion::Turn;
use crate::measure::reference::Reference;
use crate::measure::timing::summarize;
use crate::measure::window_cost::WindowCost;
use crate::pipeline::settings::Choice as _;
use crate::pipeline::viewport::Viewport;
use crate::ui::session::stages::StageChange;
use crate::ui::session::window_task::DialogCommand;
use crate::upscale::Upscaling;
use eframe::egui::{self, Event, Pos2, Vec2};

/// Number of unmeasured passes at the start, in which sizes converge, pictures are drawn and fonts are rasterized.
const WARM_UP_PASSES: usize = 12;

/// Number of frame times that are plotted for each upscaler. A measurement of all upscalers records as many.
const PLOTTED_FRAMES: usize = 25;

/// Times `passes` passes of a window of `size` pixels, with each of its parts open in turn, and then with as many parts
/// as possible open at once. The pointer moves over the picture, which does not change, so the times exclude drawing
/// the picture. They also exclude the work of a graphics card.
pub(crate) fn window_costs(start: &WindowStart, size: Viewport, passes: usize) -> Vec<WindowCost> {
    situations().into_iter().filter_map(|(what, first)| cost(start, size, passes.max(1), what, first)).collect()
}

/// Returns every timed configuration of the window: its name, and the commands that set it up.
fn situations() -> Vec<(String, Vec<Command>)> {
    let panels = Panel::ALL.iter().map(|panel| {
        let watch = Command::Watch(watch::WatchChange::AddPick);
        (format!("Panel “{}”", panel.name()), vec![watch, show(*panel)])
    });
    let through = ["lanczos3", "fsr1"].map(|method| {
        let choose = Upscaling::every()
            .filter(|upscaling| upscaling.method() == method)
            .last()
            .map(|upscaler| Command::SetRecipe(Recipe { upscaler, ..Recipe::default() }));
        (format!("Panel “Filter taps”, {method}"), choose.into_iter().chain([show(Panel::FilterTaps)]).collect())
    });
    let compared = [
        ("Comparison: four tiles", Compare::Count(4)),
        ("Comparison: every upscaler", Compare::Every(None)),
        ("Comparison: difference", Compare::Mode(Mode::Difference)),
    ];
    let compared = compared.map(|(name, change)| (name.to_owned(), vec![Command::Compare(change)]));
    let more = [
        ("Mesh view", vec![Command::MeshView(mesh_view::MeshViewChange::Toggle)]),
        ("What changed?", vec![Command::WhatIf(what_if::WhatIfChange::Toggle)]),
        ("Value range and overlays", laid_over()),
        ("Switches of “Shade”", vec![Command::Stage(StageChange::Select(Stage::Shade))]),
        ("Keys", vec![Command::Dialog(DialogCommand::Keys)]),
        ("Find anything", vec![Command::Dialog(DialogCommand::Palette)]),
        ("Everything at once", everything()),
    ];
    let more = more.map(|(name, first)| (name.to_owned(), first));
    let pages = Page::ALL.iter().map(|page| {
        let first = [lab::LabChange::Open(true), lab::LabChange::Page(*page), lab::LabChange::Go(usize::MAX)];
        (format!("2D lab, {}", page.name()), first.map(Command::Lab).into())
    });
    panels.chain(through).chain(compared).chain(more).chain(pages).collect()
}

fn show(panel: Panel) -> Command {
    Command::Workspace(WorkspaceChange::Panel(panel))
}

fn laid_over() -> Vec<Command> {
    let layers = [Overlay::Rasterized, Overlay::Wireframe];
    let layers = layers.map(|overlay| Command::Overlays(overlays::OverlayChange::Toggle(overlay)));
    let open = [Command::Overlays(overlays::OverlayChange::Open(true)), Command::Range(range::RangeChange::Open(true))];
    layers.into_iter().chain(open).collect()
}

/// Returns commands that open as many parts as possible at once, including the panel with the most content.
fn everything() -> Vec<Command> {
    let more = [
        show(Panel::Calculation),
        Command::Stage(StageChange::Select(Stage::Shade)),
        Command::MeshView(mesh_view::MeshViewChange::Toggle),
        Command::WhatIf(what_if::WhatIfChange::Toggle),
        Command::Watch(watch::WatchChange::AddPick),
    ];
    laid_over().into_iter().chain(more).collect()
}

fn cost(start: &WindowStart, size: Viewport, passes: usize, what: String, first: Vec<Command>) -> Option<WindowCost> {
    let points = Vec2::new(size.width as f32, size.height as f32);
    let mut headless = Headless::new(points, 1.0, egui::Theme::Dark);
    let mut app = workbench(start.clone(), &Preferences::default(), Worker::inline());
    headless.pass(Vec::new(), |ui| app.show(ui));
    headless.pass(Vec::new(), |ui| app.show(ui));
    plot_something(&mut app);
    app.queue(first);
    let pass = |number| headless.timed_pass(vec![pointer(points, number)], |ui| app.show(ui));
    let costs: Vec<_> = (0..WARM_UP_PASSES + passes).map(pass).skip(WARM_UP_PASSES).collect();
    let ms = |time: fn(&PassCost) -> f64| summarize(&costs.iter().map(time).collect::<Vec<_>>());
    Some(WindowCost {
        what,
        layout_ms: ms(|cost| cost.layout.as_secs_f64() * 1e3)?,
        tessellation_ms: ms(|cost| cost.tessellation.as_secs_f64() * 1e3)?,
        whole_ms: ms(|cost| (cost.layout + cost.tessellation).as_secs_f64() * 1e3)?,
        vertices: costs.last()?.vertices,
        texture_bytes: costs.iter().map(|cost| cost.texture_bytes).max()?,
    })
}

/// Fills the plots with as many frame times as a measurement of all upscalers would. The values are made up, which does
/// not affect the cost of the window.
fn plot_something(app: &mut Workbench) {
    let request = app.session().request();
    let timings = &mut app.session_mut().features.timings;
    let reference = Reference::Native;
    timings.begin_measurement(MeasureRequest {
        number: 0,
        of: request,
        reference,
        turn: Turn::default(),
        metric: Metric::Flip,
    });
    for (place, upscaling) in Upscaling::every().enumerate() {
        for frame in 0..PLOTTED_FRAMES {
            timings.record_measured(upscaling, (1 + place + frame % 5) as f64);
        }
    }
}

/// Returns the pointer event of a pass. The pointer moves repeatedly along a diagonal near the middle of the window.
fn pointer(window: Vec2, pass: usize) -> Event {
    const STEP_POINTS: f32 = 3.0;
    const TRAVEL_POINTS: usize = 40;
    let down = (pass % TRAVEL_POINTS) as f32 * STEP_POINTS;
    Event::PointerMoved(Pos2::new(window.x * 0.4 + down, window.y * 0.3 + down))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ui::InitialView;

    #[test]
    fn each_part_of_the_window_is_timed_and_uploads_no_textures_at_rest() {
        let source = crate::scene::SceneSource::named("triangle".into());
        let scene = source.load().unwrap().scene;
        let start = WindowStart {
            camera: scene.home,
            scene: std::sync::Arc::new(scene),
            source,
            warnings: Vec::new(),
            recipe: Recipe::default(),
            mirrored: false,
            resume: false,
            memory_limit: crate::scene::MemoryLimit::default(),
            pending: None,
            project: None,
            initial_view: InitialView { picture: Some(Viewport { width: 64, height: 40 }), ..InitialView::default() },
        };
        let size = Viewport { width: 1000, height: 600 };
        let situations = situations();
        for (what, first) in situations.into_iter().filter(|(what, _)| what.contains("Watch") || what.contains("once"))
        {
            let cost = cost(&start, size, 2, what, first).unwrap();
            assert_eq!(cost.texture_bytes, 0, "{}: textures are uploaded again and again", cost.what);
            assert_eq!(cost.whole_ms.n, 2);
            assert!(cost.vertices > 1000, "{}: {} vertices", cost.what, cost.vertices);
        }
    }
}
