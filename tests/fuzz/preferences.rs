//! Fuzz target: stored preferences with random changes, loaded by a window.

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use eframe::egui::{Theme, Vec2};
use fastrand::Rng;
use rasterscope::chain::Recipe;
use rasterscope::scene::{MemoryLimit, SceneSource};
use rasterscope::ui::app::Workbench;
use rasterscope::ui::headless::Headless;
use rasterscope::ui::session::command::Command;
use rasterscope::ui::session::preferences::Bookmark;
use rasterscope::ui::session::{PictureSize, Preferences, Session, WindowState, place};
use rasterscope::ui::worker::Worker;
use rasterscope::ui::{InitialView, WindowStart, resumed, store, workbench};
use serde_json::Value;

use crate::fuzz::driver::{Failure, Target};
use crate::fuzz::images::check_message;
use crate::fuzz::input::Input;
use crate::fuzz::{mutate, strings};

/// Name of the file in which the program stores its preferences.
const FILE: &str = "preferences.json";

/// Largest number of bookmarks that an execution opens.
const MOST_BOOKMARKS: usize = 3;

/// Size of the window, in pixels of the screen; small, because small pictures are drawn faster.
const WINDOW_PX: Vec2 = Vec2::new(900.0, 560.0);

/// Fuzz target that loads mutated preferences.
pub(crate) struct StoredPreferences;

impl Target for StoredPreferences {
    fn name(&self) -> &'static str {
        "preferences"
    }

    fn generate(&self, rng: &mut Rng) -> Input {
        let mut tree: Value = serde_json::from_str(&preferences(rng).write()).expect("sound");
        if rng.u8(..16) > 0 {
            mutate::json(rng, &mut tree);
        }
        mutate::shrink_sizes(&mut tree);
        let mut text = format!("{tree:#}").into_bytes();
        if rng.u8(..8) == 0 {
            mutate::bytes(rng, &mut text);
        }
        Input::file(FILE, text)
    }

    fn run(&self, folder: &Path) -> Result<(), Failure> {
        // Backups are written beside the file.
        let copy = tempfile::tempdir_in(folder).map_err(|error| Failure::Wrong(error.to_string()))?;
        let Ok(bytes) = std::fs::read(folder.join(FILE)) else { return Ok(()) };
        std::fs::write(copy.path().join(FILE), &bytes).map_err(|error| Failure::Wrong(error.to_string()))?;
        let found = store::read(copy.path()).ok_or_else(|| Failure::Wrong("no preferences found".to_owned()))?;
        check_backup(copy.path(), &bytes, found.warning.as_deref())?;
        check_written(&found.preferences)?;
        start(&found.preferences)
    }
}

/// Returns valid preferences.
fn preferences(rng: &mut Rng) -> Preferences {
    let source = SceneSource::named("triangle".into());
    let scene = source.load().expect("built in").scene;
    let mut recipe = Recipe::default();
    for _ in 0..rng.u8(..4) {
        let setting = strings::sound_setting(rng);
        // Post filters and anti-aliasing are left to the target `recipes`: here the picture fills the canvas, so they
        // are slow.
        if !setting.starts_with("post.") && !setting.starts_with("antialias.") {
            // Rejected settings change nothing.
            let _ = recipe.set(&setting);
        }
    }
    let camera = scene.home;
    let mut session = Session::new(Arc::new(scene), source, recipe, camera);
    session.pick = rng.bool().then_some((20, 10));
    session.state.size = *mutate::pick(rng, &[PictureSize::MatchWindow, PictureSize::Fixed(96, 64)]);
    let bookmark = |session: &Session| Bookmark { name: "kept".to_owned(), place: session.place() };
    session.features.places.bookmarks = (0..rng.usize(..3)).map(|_| bookmark(&session)).collect();
    session.features.watch.pixels = (0..rng.u32(..4)).map(|n| (n * 7, n)).collect();
    session.features.files.recent = (0..rng.usize(..3)).map(|n| format!("/models/{n}.obj").into()).collect();
    let scale = *mutate::pick(rng, &[0.0, 1.0, 1.5]);
    session.preferences(&WindowState { light_theme: rng.bool(), scale, ..WindowState::default() })
}

/// Checks that a warning comes with a backup of the whole file, and that no backup exists without a warning.
fn check_backup(folder: &Path, bytes: &[u8], warning: Option<&str>) -> Result<(), Failure> {
    let backup = std::fs::read(folder.join("preferences-backup.json")).ok();
    match (warning, backup) {
        (None, None) => Ok(()),
        (Some(warning), Some(backup)) if backup == bytes => check_message(warning, FILE),
        (warning, backup) => {
            let kept = backup.map_or(0, |backup| backup.len());
            Err(Failure::Wrong(format!("backup of {kept} bytes after the warning {warning:?}")))
        }
    }
}

/// Checks that written preferences are read back unchanged.
fn check_written(preferences: &Preferences) -> Result<(), Failure> {
    let text = preferences.write();
    match Preferences::read_checked(&text) {
        (read, true) if read == *preferences => Ok(()),
        (_, is_complete) => {
            Err(Failure::Wrong(format!("preferences are not read back: complete: {is_complete}, {text}")))
        }
    }
}

/// Starts a window with preferences, opens its bookmarks, and checks the preferences that would be stored at the end.
fn start(preferences: &Preferences) -> Result<(), Failure> {
    let source = SceneSource::named("triangle".into());
    let scene = source.load().expect("built in").scene;
    let camera = scene.home;
    let start = WindowStart {
        source,
        camera,
        scene: Arc::new(scene),
        warnings: Vec::new(),
        recipe: Recipe::default(),
        mirrored: false,
        resume: true,
        initial_view: InitialView::default(),
        memory_limit: MemoryLimit::default(),
        pending: None,
        project: None,
    };
    let bookmarks = preferences.bookmarks.len().min(MOST_BOOKMARKS);
    let scale = if preferences.window.scale > 0.0 { preferences.window.scale.clamp(0.5, 3.0) } else { 1.0 };
    let mut headless = Headless::new(WINDOW_PX / scale, scale, Theme::Dark);
    let mut app = workbench(resumed(start, preferences, Duration::MAX), preferences, Worker::inline());
    pass(&mut headless, &mut app);
    for bookmark in 0..bookmarks {
        app.queue(vec![Command::Place(place::PlaceChange::Jump(bookmark))]);
        pass(&mut headless, &mut app);
        pass(&mut headless, &mut app);
    }
    check_written(&app.session().preferences(&WindowState { scale, ..WindowState::default() }))?;
    let broken = app.session().features.messages.log.iter().find(|line| line.text.contains("internal error"));
    broken.map_or(Ok(()), |line| Err(Failure::Wrong(line.text.clone())))
}

fn pass(headless: &mut Headless, app: &mut Workbench) {
    headless.pass(Vec::new(), |ui| app.show(ui));
}
