//! Ways into the workbench: a window, or one picture of it.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use eframe::egui::{self, Vec2, ViewportBuilder};

use super::app::Workbench;
use super::checks;
use super::command::Command;
use super::compare::Change;
use super::engine::Shown;
use super::fates;
use super::headless::Headless;
use super::lab;
use super::layout;
use super::panels::bottom::Tab;
use super::place;
use super::session::{Level, PictureSize, Preferences, Session, WindowState};
use super::store::{self, Found, Store};
use super::theme;
use super::watch;
use super::worker::Worker;
use crate::chain::Recipe;
use crate::image::{Image, Rgba8};
use crate::inspect::Place;
use crate::inspect::display::Display;
use crate::inspect::fates::{Bin, TriangleFate};
use crate::inspect::mesh_view::MeshStyle;
use crate::inspect::overlays::Layer;
use crate::inspect::scrub::Moment;
use crate::lab::Page;
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, LoadControl, MemoryLimit, Scene, SceneError, SceneSource, Warning};

/// What the workbench starts with.
#[derive(Clone, Debug)]
pub struct WindowStart {
    /// Where the scene comes from.
    pub source: SceneSource,
    /// The scene.
    pub scene: Arc<Scene>,
    /// What the loader had to say.
    pub warnings: Vec<Warning>,
    /// How it is drawn.
    pub recipe: Recipe,
    /// From where.
    pub camera: Camera,
    /// Whether the scene is the mirror image in z of its source.
    pub mirrored: bool,
    /// Whether a window takes up scene, recipe and view where it was left instead.
    pub resume: bool,
    /// What is looked at.
    pub seen: Seen,
    /// Memory limit of models.
    pub memory_limit: MemoryLimit,
    /// Scene to load once the window is open.
    pub pending: Option<PendingScene>,
}

/// Scene that takes too long to load before the window opens.
#[derive(Clone, Debug, PartialEq)]
pub struct PendingScene {
    /// Path of the model.
    pub path: PathBuf,
    /// View of the scene; its own if `None`.
    pub camera: Option<Camera>,
}

/// What of the frame is looked at from the start; where nothing is said, as always.
#[derive(Clone, Debug, Default)]
pub struct Seen {
    /// The questioned pixel.
    pub pixel: Option<(u32, u32)>,
    /// A buffer, the picture after a stage, or a number on the way.
    pub shown: Option<Shown>,
    /// By which range, colour map and channels.
    pub display: Option<Display>,
    /// What is laid over it, the lowest first.
    pub layers: Vec<Layer>,
    /// An earlier moment of the frame than its last.
    pub moment: Option<Moment>,
    /// Size of the picture.
    pub picture: Option<Viewport>,
}

impl Seen {
    fn show(self, session: &mut Session) {
        session.pick = self.pixel;
        session.shown = self.shown.unwrap_or(session.shown);
        if let Some(display) = self.display {
            session.range.show_by(display, session.shown);
        }
        for layer in self.layers {
            // Each but once: what is laid over twice stands where it was said last.
            session.overlays.layers.retain(|other| other.overlay != layer.overlay);
            session.overlays.layers.push(layer);
        }
        if let Some(moment) = self.moment {
            session.begin_at(moment);
        }
        if let Some(Viewport { width, height }) = self.picture {
            session.state.size = PictureSize::Fixed(width, height);
        }
    }
}

/// Colours of the workbench.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Theme {
    /// Light text on dark panels.
    Dark,
    /// Dark text on light panels.
    Light,
}

/// What a picture of the workbench shows.
#[derive(Clone, Debug)]
pub struct ScreenshotRequest {
    /// What it starts with.
    pub start: WindowStart,
    /// Size in px.
    pub size: Viewport,
    /// Interface scale.
    pub pixels_per_point: f32,
    /// Colours.
    pub theme: Theme,
    /// Whether all upscalers are timed first, which takes some seconds, so that their frame times are shown.
    pub measure: bool,
    /// Whether it is probed first how firmly the picture stands.
    pub probe: bool,
    /// Whether the scene is shown from outside, too, and how.
    pub mesh: Option<MeshStyle>,
    /// What is compared, if anything.
    pub compare: Option<Change>,
    /// The tab that is open, if not the first.
    pub tab: Option<Tab>,
    /// What the canvas shows, if not the colours.
    pub shown: Option<Shown>,
    /// How much of the frame is drawn, if not all.
    pub moment: Option<Moment>,
    /// The triangles that are selected, by how they ended; the tab of fates is open then.
    pub fate: Option<TriangleFate>,
    /// The picked pixel; one near the middle if none is given.
    pub selected: Option<(u32, u32)>,
    /// The page of the lab to show, and how many of its steps, instead of the pipeline.
    pub lab: Option<(Page, Option<usize>)>,
    /// What is done first, as by keys.
    pub first: Vec<Command>,
}

/// Passes of a picture: the first finds the canvas's size, the second has a frame, the rest let sizes settle.
const SCREENSHOT_PASSES: usize = 6;

/// Size of the window at first, in points.
const DEFAULT_SIZE: Vec2 = Vec2::new(1280.0, 800.0);

/// Smallest size of the window, in points.
const LEAST_SIZE: Vec2 = Vec2::new(900.0, 560.0);

/// Largest size that a window is opened with, in points.
const MOST_SIZE: Vec2 = Vec2::splat(16_384.0);

/// Time for loading the last scene before the window opens.
const PATIENCE: Duration = Duration::from_millis(400);

/// Name of the folder with the program's data.
const APP_ID: &str = "rasterscope";

/// Opens the window and returns when it is closed, or at once with the reason why there is none.
pub fn run_window(start: WindowStart) -> Result<(), String> {
    let folder = eframe::storage_dir(APP_ID);
    let found = folder.as_deref().and_then(store::read).unwrap_or_default();
    let WindowState { window_size, maximized, .. } = found.preferences.window;
    let size = window_size.map(Vec2::from).filter(|size| size.is_finite()).unwrap_or(DEFAULT_SIZE);
    let options = eframe::NativeOptions {
        viewport: ViewportBuilder::default()
            .with_title("Rasterscope")
            .with_inner_size(size.clamp(LEAST_SIZE, MOST_SIZE))
            .with_min_inner_size(LEAST_SIZE)
            .with_maximized(maximized)
            .with_drag_and_drop(true),
        // Kept with the preferences, whose file is replaced atomically.
        persist_window: false,
        // Noise over the picture would falsify it.
        dithering: false,
        ..Default::default()
    };
    let make = |cc: &eframe::CreationContext<'_>| -> Result<Box<dyn eframe::App>, _> {
        Ok(Box::new(windowed(start, folder, found, cc)))
    };
    eframe::run_native(APP_ID, options, Box::new(make)).map_err(|error| one_line(&error.to_string()))
}

/// Returns the application in a window: resumed from the preferences in `folder`, with a renderer of its own.
fn windowed(start: WindowStart, folder: Option<PathBuf>, found: Found, cc: &eframe::CreationContext<'_>) -> Workbench {
    let preferences = found.preferences;
    layout::restore(&cc.egui_ctx, &preferences.window.layout);
    theme::install(&cc.egui_ctx);
    cc.egui_ctx.set_theme(if preferences.window.light_theme { egui::Theme::Light } else { egui::Theme::Dark });
    if preferences.window.scale > 0.0 {
        cc.egui_ctx.set_zoom_factor(preferences.window.scale.clamp(0.5, 3.0));
    }
    let context = cc.egui_ctx.clone();
    let worker = Worker::spawn(move || context.request_repaint());
    close_on_signals(cc.egui_ctx.clone());
    let start = if start.resume { resumed(start, &preferences, PATIENCE) } else { start };
    let store = folder.map(|folder| Store::new(folder, preferences.clone()));
    let mut workbench = workbench(start, preferences, worker);
    match store {
        Some(store) => workbench.keep_in(store),
        None => {
            workbench.session_mut().report(Level::Warning, "There is no folder to keep preferences and bookmarks in");
        }
    }
    if let Some(warning) = found.warning {
        workbench.session_mut().report(Level::Error, warning);
    }
    workbench
}

/// Closes the window in the ordinary way on SIGTERM, SIGHUP and SIGINT. A window that does not answer ends all the same:
/// its preferences are on disk already.
fn close_on_signals(context: egui::Context) {
    const PATIENCE: Duration = Duration::from_secs(3);
    let close = move || {
        context.send_viewport_cmd(egui::ViewportCommand::Close);
        context.request_repaint();
        std::thread::sleep(PATIENCE);
        std::process::exit(1);
    };
    // Without a handler the signals end the process at once, which loses nothing that is on disk.
    drop(ctrlc::set_handler(close));
}

/// Returns the start with scene, recipe and view of the last time, as far as they still exist and are sound: stored preferences may
/// be of an older program, or damaged. A model that does not load within `patience` is loaded once the window is open.
pub fn resumed(start: WindowStart, preferences: &Preferences, patience: Duration) -> WindowStart {
    let recipe = if preferences.recipe.check().is_ok() { preferences.recipe } else { start.recipe };
    let start = WindowStart { recipe, ..start };
    let Some(path) = preferences.source.clone() else { return start };
    let camera = preferences.camera.filter(|camera| camera.check().is_ok());
    let source = SceneSource::named(path.clone());
    let (begun, cancel) = (Instant::now(), AtomicBool::new(false));
    let progress = |_: f32| {
        if begun.elapsed() > patience {
            cancel.store(true, Ordering::Relaxed);
        }
    };
    let memory = start.memory_limit;
    match source.load_with(LoadControl { memory, progress: &progress, cancel: &cancel }) {
        Ok(loaded) => WindowStart {
            source,
            camera: camera.unwrap_or(loaded.scene.home),
            scene: Arc::new(loaded.scene),
            warnings: loaded.warnings,
            ..start
        },
        Err(SceneError::Cancelled { .. }) => WindowStart { pending: Some(PendingScene { path, camera }), ..start },
        Err(error) => {
            let text = format!("was open last time and cannot be opened again: {error}");
            WindowStart { warnings: vec![Warning::file(&path, text)], ..start }
        }
    }
}

/// Returns the application as it starts, with these preferences.
pub fn workbench(start: WindowStart, preferences: Preferences, worker: Worker) -> Workbench {
    let mut session = Session::new(start.scene, start.source, start.recipe, start.camera);
    session.recent = preferences.recent;
    session.hint_closed = preferences.hint_closed;
    session.places.bookmarks = preferences.bookmarks;
    session.watch.pixels = preferences.watched;
    session.watch.pixels.truncate(watch::MOST);
    session.mirrored = start.mirrored;
    session.memory_limit = start.memory_limit;
    session.state.size = preferences.size.checked();
    start.seen.show(&mut session);
    session.settle_silently();
    let mut workbench = Workbench::new(session, worker);
    workbench.warn(&start.warnings);
    if let Some(PendingScene { path, camera }) = start.pending {
        let open = match camera {
            Some(camera) => {
                let place = Place { scene: path, camera, ..workbench.session().place() };
                Command::Place(place::Change::Go(Box::new(place)))
            }
            None => Command::Open(path),
        };
        workbench.ask_for(vec![open]);
    }
    workbench
}

/// The whole workbench as a picture, drawn by the CPU, with no window and no display. The error is the size of the
/// scene's picture, where that has no pixel such as the one to be picked.
pub fn screenshot(request: &ScreenshotRequest) -> Result<Image<Rgba8>, Viewport> {
    let Viewport { width, height } = request.size;
    let theme = match request.theme {
        Theme::Dark => egui::Theme::Dark,
        Theme::Light => egui::Theme::Light,
    };
    let size_points = Vec2::new(width as f32, height as f32) / request.pixels_per_point;
    let mut headless = Headless::new(size_points, request.pixels_per_point, theme);
    let mut app = workbench(request.start.clone(), Preferences::default(), Worker::inline());
    app.session_mut().pick = request.selected.or(request.start.seen.pixel);
    if let Some(change) = request.compare.clone() {
        app.session_mut().apply(Command::Compare(change));
    }
    if request.tab == Some(Tab::Checks) {
        app.session_mut().checks.apply(checks::Change::Run);
    }
    if let Some(style) = request.mesh {
        let mesh = &mut app.session_mut().mesh_view;
        (mesh.open, mesh.style) = (true, style);
    }
    if let Some(tab) = request.tab {
        app.open_tab(tab);
    }
    if let Some(shown) = request.shown {
        app.session_mut().shown = shown;
    }
    if let Some(moment) = request.moment {
        app.session_mut().begin_at(moment);
    }
    if let Some(fate) = request.fate {
        app.open_tab(Tab::Fates);
        app.session_mut().apply(Command::Fates(fates::Change::Bin(Bin::Triangles(fate))));
    }
    if let Some((page, step)) = request.lab {
        let changes = [lab::Change::Open(true), lab::Change::Page(page), lab::Change::Go(step.unwrap_or(usize::MAX))];
        changes.into_iter().chain(request.measure.then_some(lab::Change::Compare)).for_each(|change| {
            app.session_mut().lab.apply(change);
        });
    }
    app.ask_for(request.first.clone());
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
        super::probe::probe_now(app.session_mut());
        headless.pass(Vec::new(), |ui| app.show(ui));
    }
    if request.measure {
        app.measure();
        headless.pass(Vec::new(), |ui| app.show(ui));
        headless.pass(Vec::new(), |ui| app.show(ui));
    }
    Ok(headless.picture())
}

/// Errors of the toolkit may span lines; ours never do.
fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    fn start() -> WindowStart {
        let source = SceneSource::default();
        let scene = source.load().unwrap().scene;
        WindowStart {
            source,
            camera: scene.home,
            scene: Arc::new(scene),
            warnings: Vec::new(),
            recipe: Recipe::default(),
            mirrored: false,
            resume: true,
            memory_limit: MemoryLimit::default(),
            pending: None,
            seen: Seen::default(),
        }
    }

    #[test]
    fn the_first_frame_keeps_layout_and_size_of_the_window() {
        let folder = tempfile::tempdir().unwrap();
        let window = WindowState {
            window_size: Some([1010.0, 707.0]),
            layout: "kept".to_owned(),
            light_theme: true,
            ..WindowState::default()
        };
        let preferences = Preferences { window: window.clone(), ..Preferences::default() };
        let mut app = workbench(start(), preferences.clone(), Worker::inline());
        app.keep_in(Store::new(folder.path().to_owned(), preferences));
        let mut headless = Headless::new(DEFAULT_SIZE, 1.0, egui::Theme::Light);
        headless.pass(Vec::new(), |ui| app.show(ui));
        app.keep_preferences();
        drop(app);
        assert_eq!(store::read(folder.path()).unwrap().preferences.window, window);
    }

    #[test]
    fn what_was_left_comes_back() {
        let triangle = SceneSource::named("triangle".into());
        let mut preferences = Preferences { source: Some(triangle.name()), ..Preferences::default() };
        preferences.recipe.wireframe = true;
        let resumed = resumed(start(), &preferences, Duration::MAX);
        assert_eq!((resumed.source.name(), resumed.recipe.wireframe), (triangle.name(), true));
    }

    #[test]
    fn a_slow_model_is_loaded_once_the_window_is_open() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("slow.obj");
        std::fs::write(&path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
        let camera = Camera { far: 33.0, ..start().camera };
        for camera in [None, Some(camera)] {
            let preferences = Preferences { source: Some(path.clone()), camera, ..Preferences::default() };
            let resumed = resumed(start(), &preferences, Duration::ZERO);
            assert_eq!(resumed.source.name(), SceneSource::default().name());
            assert_eq!(resumed.pending, Some(PendingScene { path: path.clone(), camera }));
            let mut headless = Headless::new(DEFAULT_SIZE, 1.0, egui::Theme::Dark);
            let mut app = workbench(resumed, preferences, Worker::inline());
            for _ in 0..2 {
                headless.pass(Vec::new(), |ui| app.show(ui));
            }
            let session = app.session();
            assert_eq!(session.place().scene, path);
            assert_eq!(session.state.camera, camera.unwrap_or(session.scene.home));
        }
    }

    #[test]
    fn damaged_preferences_are_not_believed() {
        let mut preferences = Preferences { source: Some("triangle".into()), ..Preferences::default() };
        preferences.recipe.pipeline.light.direction = Vec3::NAN;
        preferences.camera = Some(Camera { near: f32::NAN, ..start().camera });
        let resumed = resumed(start(), &preferences, Duration::MAX);
        assert_eq!(resumed.recipe, Recipe::default());
        assert_eq!(resumed.camera, resumed.scene.home);
        assert_eq!(PictureSize::Fixed(100_000, 100_000).checked(), PictureSize::Canvas);
        assert_eq!(PictureSize::Fixed(1280, 720).checked(), PictureSize::Fixed(1280, 720));
    }

    #[test]
    fn a_model_that_is_gone_is_said_and_the_default_scene_stays() {
        let preferences = Preferences { source: Some("/nowhere/model.obj".into()), ..Preferences::default() };
        let resumed = resumed(start(), &preferences, Duration::MAX);
        assert_eq!(resumed.source.name(), SceneSource::default().name());
        assert!(resumed.warnings[0].to_string().contains("/nowhere/model.obj"));
    }
}
