//! Entry point of the window, and the initial state of the workbench in a window or in a screenshot.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use eframe::egui::{self, Vec2, ViewportBuilder};

use super::app::Workbench;
use super::engine::Shown;
use super::motion::desktop_reduces_motion;
use super::session::command::Command;
use super::session::picture_role::PictureRole;
use super::session::{PictureSize, Preferences, Session, Severity, WindowState, place};
use super::store::{self, LoadedPreferences, Store};
use super::worker::Worker;
use super::{layout, theme};
use crate::chain::Recipe;
use crate::inspect::InspectionState;
use crate::inspect::display::Display;
use crate::inspect::overlays::OverlayLayer;
use crate::inspect::project::Project;
use crate::inspect::scrub::Moment;
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, LoadControl, MemoryLimit, Scene, SceneError, SceneSource, Warning};
use crate::ui::session::file_command::FileCommand;

/// Initial state of the workbench.
#[derive(Clone, Debug)]
pub(crate) struct WindowStart {
    /// Source of the scene.
    pub(crate) source: SceneSource,
    /// Scene to show.
    pub(crate) scene: Arc<Scene>,
    /// Warnings from loading the scene, for the log.
    pub(crate) warnings: Vec<Warning>,
    /// Recipe with which the scene is drawn.
    pub(crate) recipe: Recipe,
    /// Initial camera of the scene.
    pub(crate) camera: Camera,
    /// Whether the scene is mirrored along z relative to its source.
    pub(crate) mirrored: bool,
    /// Whether the window restores the scene, recipe and camera of the previous run instead of those in this struct.
    pub(crate) resume: bool,
    /// Initial view of the frame.
    pub(crate) initial_view: InitialView,
    /// Maximum memory for the meshes and textures of a model.
    pub(crate) memory_limit: MemoryLimit,
    /// Scene to load after the window has opened, if any.
    pub(crate) pending: Option<PendingScene>,
    /// Project that gave the scene, for what the other fields do not hold: comparison, workspace and probe.
    pub(crate) project: Option<Box<Project>>,
}

/// Scene that takes too long to load before the window opens.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PendingScene {
    /// Path of the model.
    pub(crate) path: PathBuf,
    /// Camera for the scene; `None` means the scene's home view.
    pub(crate) camera: Option<Camera>,
}

/// Initial view of the frame; `None` and empty fields mean the defaults.
#[derive(Clone, Debug, Default)]
pub(crate) struct InitialView {
    /// Picture files to compare, with their roles.
    pub(crate) files: Vec<(PictureRole, PathBuf)>,
    /// Column and row of the picked pixel.
    pub(crate) pixel: Option<(u32, u32)>,
    /// Shown buffer, stage or intermediate value.
    pub(crate) shown: Option<Shown>,
    /// Range, colour map and channels of the shown quantity.
    pub(crate) display: Option<Display>,
    /// Overlays, from bottom to top.
    pub(crate) layers: Vec<OverlayLayer>,
    /// Point at which drawing of the frame stops; `None` draws the complete frame.
    pub(crate) moment: Option<Moment>,
    /// Fixed size of the picture, in pixels.
    pub(crate) picture: Option<Viewport>,
}

impl InitialView {
    /// Returns this view with the values of a project in place of the defaults.
    pub(crate) fn or_of(self, project: &Project) -> Self {
        let state = project.state();
        Self {
            files: self.files,
            pixel: self.pixel.or(state.pixel),
            shown: self.shown.or(Some(place::shown_at(&state))),
            display: self.display.or(Some(state.display)),
            layers: if self.layers.is_empty() { state.overlays } else { self.layers },
            moment: self.moment.or(project.moment()),
            picture: self.picture.or(Some(project.size())),
        }
    }

    fn show(self, session: &mut Session) {
        session.pick = self.pixel;
        session.set_shown(self.shown.unwrap_or(session.shown));
        if let Some(display) = self.display {
            session.features.range.show_by(display, session.shown);
        }
        for layer in self.layers {
            // Each overlay occurs once: a repeated one takes its last position.
            session.features.overlays.layers.retain(|other| other.overlay != layer.overlay);
            session.features.overlays.layers.push(layer);
        }
        if let Some(moment) = self.moment {
            session.begin_at(moment);
        }
        if let Some(Viewport { width, height }) = self.picture {
            session.state.size = PictureSize::Fixed(width, height);
        }
    }
}

/// Default size of the window, in points.
const DEFAULT_SIZE: Vec2 = Vec2::new(1280.0, 800.0);

/// Minimum size of the window, in points.
const MIN_SIZE: Vec2 = Vec2::new(900.0, 560.0);

/// Maximum initial size of a window, in points.
const MAX_SIZE: Vec2 = Vec2::splat(16_384.0);

/// Time limit for loading the previous scene before the window opens.
const LOAD_TIMEOUT: Duration = Duration::from_millis(400);

/// Name of the program's data folder.
const APP_ID: &str = "rasterscope";

/// Opens the window and returns when it is closed. Returns an error immediately if no window can be opened.
pub(crate) fn run_window(start: WindowStart) -> Result<(), String> {
    let folder = eframe::storage_dir(APP_ID);
    let found = folder.as_deref().and_then(store::read).unwrap_or_default();
    let WindowState { window_size, maximized, .. } = found.preferences.window;
    let size = window_size.map(Vec2::from).filter(|size| size.is_finite()).unwrap_or(DEFAULT_SIZE);
    let options = eframe::NativeOptions {
        viewport: ViewportBuilder::default()
            .with_title("Rasterscope")
            .with_inner_size(size.clamp(MIN_SIZE, MAX_SIZE))
            .with_min_inner_size(MIN_SIZE)
            .with_maximized(maximized)
            .with_drag_and_drop(true),
        // Window geometry is stored in the preferences file instead, which is replaced atomically.
        persist_window: false,
        // Dithering would change the colours of the picture.
        dithering: false,
        ..Default::default()
    };
    let make = |cc: &eframe::CreationContext<'_>| -> Result<Box<dyn eframe::App>, _> {
        Ok(Box::new(windowed(start, folder, found, cc)))
    };
    eframe::run_native(APP_ID, options, Box::new(make)).map_err(|error| one_line(&error.to_string()))
}

/// Creates the application for a window, with its own renderer thread, and stores its preferences in `folder`.
fn windowed(
    start: WindowStart,
    folder: Option<PathBuf>,
    found: LoadedPreferences,
    cc: &eframe::CreationContext<'_>,
) -> Workbench {
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
    let start = if start.resume { resumed(start, &preferences, LOAD_TIMEOUT) } else { start };
    let store = folder.map(|folder| Store::new(folder, preferences.clone()));
    let mut workbench = workbench(start, &preferences, worker);
    workbench.session_mut().features.appearance.desktop_reduces_motion = desktop_reduces_motion();
    match store {
        Some(store) => workbench.save_preferences_to(store),
        None => {
            workbench
                .session_mut()
                .report(Severity::Warning, "Preferences and bookmarks are not saved: no data folder was found");
        }
    }
    if let Some(warning) = found.warning {
        workbench.session_mut().report(Severity::Error, warning);
    }
    workbench
}

/// Closes the window cleanly on SIGTERM, SIGHUP and SIGINT. If the window does not respond within 3 s, the process
/// exits; the preferences are already on disk.
fn close_on_signals(context: egui::Context) {
    const EXIT_TIMEOUT: Duration = Duration::from_secs(3);
    let close = move || {
        context.send_viewport_cmd(egui::ViewportCommand::Close);
        context.request_repaint();
        std::thread::sleep(EXIT_TIMEOUT);
        std::process::exit(1);
    };
    // If no handler can be installed, the signals end the process at once, which loses no data on disk.
    drop(ctrlc::set_handler(close));
}

/// Returns `start` with the scene, recipe and camera of the previous run. Invalid parts are ignored, because stored
/// preferences may be damaged or belong to an older version. A model that does not load within `patience` becomes the
/// pending scene.
pub(crate) fn resumed(start: WindowStart, preferences: &Preferences, patience: Duration) -> WindowStart {
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
            let text = format!("cannot reopen the scene of the last session: {error}");
            WindowStart { warnings: vec![Warning::file(&path, text)], ..start }
        }
    }
}

/// Creates the application from its initial state and the stored preferences.
pub(crate) fn workbench(start: WindowStart, preferences: &Preferences, worker: Worker) -> Workbench {
    let mut session = Session::new(start.scene, start.source, start.recipe, start.camera);
    session.features.restore(preferences);
    // The start card would hide pictures that the user names.
    if start.resume && start.initial_view.files.is_empty() {
        session.features.onboarding.begin();
    }
    session.mirrored = start.mirrored;
    session.features.files.memory_limit = start.memory_limit;
    session.state.size = preferences.size.checked();
    let files = start.initial_view.files.clone();
    start.initial_view.show(&mut session);
    let restored = start.project.map_or_else(Vec::new, |project| session.restore_tools(&project));
    session.settle_silently();
    let mut workbench = Workbench::new(session, worker);
    workbench.warn(&start.warnings);
    let named = files.into_iter().map(|(role, path)| FileCommand::OpenPicture(role, path));
    workbench.queue(restored.into_iter().chain(named).map(Command::File).collect());
    if let Some(PendingScene { path, camera }) = start.pending {
        let open = match camera {
            Some(camera) => {
                let place = InspectionState { scene: path, camera, ..workbench.session().place() };
                Command::Place(place::PlaceChange::Go(Box::new(place)))
            }
            None => Command::File(FileCommand::Open(path)),
        };
        workbench.queue(vec![open]);
    }
    workbench
}

/// Joins the lines of an error from the windowing toolkit, because every message of the program is a single line.
fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::ui::headless::Headless;

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
            project: None,
            initial_view: InitialView::default(),
        }
    }

    #[test]
    fn the_first_frame_keeps_the_layout_and_size_of_the_window() {
        let folder = tempfile::tempdir().unwrap();
        let window = WindowState {
            window_size: Some([1010.0, 707.0]),
            layout: "kept".to_owned(),
            light_theme: true,
            ..WindowState::default()
        };
        let preferences = Preferences { window: window.clone(), ..Preferences::default() };
        let mut app = workbench(start(), &preferences, Worker::inline());
        app.save_preferences_to(Store::new(folder.path().to_owned(), preferences));
        let mut headless = Headless::new(DEFAULT_SIZE, 1.0, egui::Theme::Light);
        headless.pass(Vec::new(), |ui| app.show(ui));
        app.save_preferences();
        drop(app);
        assert_eq!(store::read(folder.path()).unwrap().preferences.window, window);
    }

    #[test]
    fn scene_and_recipe_of_the_previous_run_are_restored() {
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
            let mut app = workbench(resumed, &preferences, Worker::inline());
            for _ in 0..2 {
                headless.pass(Vec::new(), |ui| app.show(ui));
            }
            let session = app.session();
            assert_eq!(session.place().scene, path);
            assert_eq!(session.state.camera, camera.unwrap_or(session.scene.home));
        }
    }

    #[test]
    fn invalid_preferences_are_ignored() {
        let mut preferences = Preferences { source: Some("triangle".into()), ..Preferences::default() };
        preferences.recipe.pipeline.light.direction = Vec3::NAN;
        preferences.camera = Some(Camera { near: f32::NAN, ..start().camera });
        let resumed = resumed(start(), &preferences, Duration::MAX);
        assert_eq!(resumed.recipe, Recipe::default());
        assert_eq!(resumed.camera, resumed.scene.home);
        assert_eq!(PictureSize::Fixed(100_000, 100_000).checked(), PictureSize::default());
        assert_eq!(PictureSize::Fixed(1280, 720).checked(), PictureSize::Fixed(1280, 720));
    }

    #[test]
    fn a_missing_model_is_reported_and_the_default_scene_stays() {
        let preferences = Preferences { source: Some("/nowhere/model.obj".into()), ..Preferences::default() };
        let resumed = resumed(start(), &preferences, Duration::MAX);
        assert_eq!(resumed.source.name(), SceneSource::default().name());
        assert!(resumed.warnings[0].to_string().contains("/nowhere/model.obj"));
    }
}
