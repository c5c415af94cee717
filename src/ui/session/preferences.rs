//! Preferences that persist between runs of the program.

use std::path::PathBuf;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::{Map, Value, json};

use super::Session;
use crate::chain::Recipe;
use crate::disk::stored_path::StoredPath;
use crate::inspect::InspectionState;
use crate::pipeline::viewport::Viewport;
use crate::scene::Camera;
use crate::ui::session::layout::StoredLayouts;
use crate::upscale::{Scale, Upscaling};

/// Maximum number of recent files.
pub(crate) const MAX_RECENT: usize = 8;

/// Maximum number of watched pixels. After every frame, each watched pixel is replayed to find its values.
pub(crate) const MAX_WATCHED: usize = 24;

/// Size of the picture that the pipeline draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum PictureSize {
    /// Size of the canvas, with one picture pixel per screen pixel.
    MatchWindow,
    /// Fixed width and height, in pixels.
    Fixed(u32, u32),
}

impl Default for PictureSize {
    fn default() -> Self {
        Self::Fixed(1280, 720)
    }
}

impl PictureSize {
    /// Returns this size, or the default size if it is not a valid picture size.
    pub(crate) fn checked(self) -> Self {
        match self {
            Self::Fixed(width, height) if Viewport { width, height }.check().is_err() => Self::default(),
            size => size,
        }
    }
}

/// Pointer mode of the canvas: what dragging with the left button and the wheel do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum PointerMode {
    /// Dragging orbits the camera, the wheel zooms the picture.
    #[default]
    Orbit,
    /// Dragging pans the picture, the wheel zooms it.
    Pan,
    /// Dragging orbits the camera, the wheel dollies, W A S D Q E fly.
    Camera,
}

impl PointerMode {
    /// Returns `mode`, or the default mode if `mode` is already on.
    pub(crate) fn toggled(self, mode: Self) -> Self {
        if self == mode { Self::default() } else { mode }
    }
}

/// Parts of the introduction that the user has closed. They do not open by themselves again.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Seen {
    /// Whether the start card was closed.
    pub(crate) start_card: bool,
    /// Whether the coach was finished or skipped.
    pub(crate) coach: bool,
}

impl Seen {
    /// Returns the parts that were closed in either of two windows.
    pub(crate) fn merged(self, other: Self) -> Self {
        Self { start_card: self.start_card || other.start_card, coach: self.coach || other.coach }
    }
}

/// Inspection state saved under a name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Bookmark {
    /// Display name of the bookmark.
    pub(crate) name: String,
    /// Inspection state that the bookmark restores.
    pub(crate) place: InspectionState,
}

/// State of the window itself: theme, scale, size and layout.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct WindowState {
    /// Whether the theme is light rather than dark.
    pub(crate) light_theme: bool,
    /// Interface scale, as a factor of the default size; 0 means 1.
    pub(crate) scale: f32,
    /// Whether the window avoids motion; `None` follows the desktop.
    pub(crate) reduce_motion: Option<bool>,
    /// Width and height of the window while it is not maximized, in points at interface scale 1; `None` means the
    /// default size.
    pub(crate) window_size: Option<[f32; 2]>,
    /// Whether the window is maximized.
    pub(crate) maximized: bool,
    /// State of widgets such as headings: [`eframe::egui::Memory`] serialised as RON; empty for the default layout.
    pub(crate) layout: String,
    /// Layouts of the workspaces that differ from their defaults.
    pub(crate) workspaces: StoredLayouts,
}

impl WindowState {
    fn merged(&self, base: &Self, theirs: &Self) -> Self {
        Self {
            light_theme: latest(&self.light_theme, &base.light_theme, &theirs.light_theme),
            scale: latest(&self.scale, &base.scale, &theirs.scale),
            reduce_motion: latest(&self.reduce_motion, &base.reduce_motion, &theirs.reduce_motion),
            window_size: latest(&self.window_size, &base.window_size, &theirs.window_size),
            maximized: latest(&self.maximized, &base.maximized, &theirs.maximized),
            layout: latest(&self.layout, &base.layout, &theirs.layout),
            workspaces: latest(&self.workspaces, &base.workspaces, &theirs.workspaces),
        }
    }
}

/// Preferences, stored as JSON. Fields that cannot be read, for example because another version wrote them, are skipped
/// individually.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Preferences {
    /// Last scene: the id of a built-in scene, or the path of a file.
    #[serde(serialize_with = "stored", deserialize_with = "restored")]
    pub(crate) source: Option<PathBuf>,
    /// Recipe of the last frame.
    pub(crate) recipe: Recipe,
    /// Camera of the last frame; `None` means the scene's home view.
    pub(crate) camera: Option<Camera>,
    /// Picture size of the last frame.
    pub(crate) size: PictureSize,
    /// Recently opened files, newest first.
    #[serde(serialize_with = "all_stored", deserialize_with = "all_restored")]
    pub(crate) recent: Vec<PathBuf>,
    /// Parts of the introduction for new users that the user has closed.
    pub(crate) seen: Seen,
    /// Theme, scale, size and layout of the window.
    #[serde(flatten)]
    pub(crate) window: WindowState,
    /// Bookmarks, in the order of their keyboard shortcuts.
    #[serde(deserialize_with = "the_readable")]
    pub(crate) bookmarks: Vec<Bookmark>,
    /// Watched pixels, as column and row.
    #[serde(deserialize_with = "the_readable")]
    pub(crate) watched: Vec<(u32, u32)>,
}

impl Preferences {
    /// Parses stored preferences, skipping fields that cannot be read.
    #[cfg(test)]
    pub(crate) fn read(stored: &str) -> Self {
        Self::read_checked(stored).0
    }

    /// Parses stored preferences, skipping fields that cannot be read. Also returns whether everything was read.
    pub(crate) fn read_checked(stored: &str) -> (Self, bool) {
        let Ok(fields) = serde_json::from_str::<Map<String, Value>>(stored) else { return Default::default() };
        // A number too large for its type is read as infinity and written as null, which cannot be read again.
        let can_be_read = |(key, value): &(String, Value)| {
            let read = Self::deserialize(json!({ key: value })).and_then(serde_json::to_value);
            read.is_ok_and(|again| Self::deserialize(json!({ key: again[key] })).is_ok())
        };
        let (readable, others): (Map<_, _>, Map<_, _>) = fields.into_iter().partition(can_be_read);
        let read: Self = serde_json::from_value(readable.clone().into()).unwrap_or_default();
        // Everything was read if writing the result yields the same fields, and lists of the same lengths. Unknown
        // fields and skipped list items are missing from the result.
        let again = serde_json::to_value(&read).unwrap_or_default();
        let is_kept = |(key, value): (&String, &Value)| {
            let length = |value: &Value| value.as_array().map(Vec::len);
            again.get(key).is_some_and(|kept| length(kept) == length(value))
        };
        let is_complete = others.is_empty() && readable.iter().all(is_kept);
        (read, is_complete)
    }

    /// Returns the id of the first upscaler in stored preferences that is not registered.
    pub(crate) fn unknown_upscaler(stored: &str) -> Option<String> {
        fn search(value: &Value) -> Option<String> {
            let method = value.pointer("/upscaler/method").and_then(Value::as_str);
            let unknown = method.filter(|method| Upscaling::new(method, Scale::ONE).is_none()).map(str::to_owned);
            unknown.or_else(|| match value {
                Value::Object(fields) => fields.values().find_map(search),
                Value::Array(items) => items.iter().find_map(search),
                _ => None,
            })
        }
        search(&serde_json::from_str(stored).ok()?)
    }

    /// Merges two sets of preferences that were both derived from `base`. Lists are merged item by item. Any other
    /// field is taken from `self` if it was changed there, otherwise from `theirs`.
    pub(crate) fn merged(&self, base: &Self, theirs: &Self) -> Self {
        let mut recent = self.recent.clone();
        let others = theirs.recent.iter().filter(|path| !self.recent.contains(path) && !base.recent.contains(path));
        recent.extend(others.cloned());
        recent.truncate(MAX_RECENT);
        let mut watched = merged_list(&self.watched, &base.watched, &theirs.watched);
        watched.truncate(MAX_WATCHED);
        Self {
            source: latest(&self.source, &base.source, &theirs.source),
            recipe: latest(&self.recipe, &base.recipe, &theirs.recipe),
            camera: latest(&self.camera, &base.camera, &theirs.camera),
            size: latest(&self.size, &base.size, &theirs.size),
            recent,
            seen: self.seen.merged(theirs.seen),
            window: self.window.merged(&base.window, &theirs.window),
            bookmarks: merged_list(&self.bookmarks, &base.bookmarks, &theirs.bookmarks),
            watched,
        }
    }

    /// Serializes the preferences as JSON.
    pub(crate) fn write(&self) -> String {
        // Serialization cannot fail: map keys are strings, and non-finite numbers become null.
        serde_json::to_string(self).unwrap_or_default()
    }
}

/// Returns `mine` if it differs from `base`, otherwise `theirs`.
fn latest<T: PartialEq + Clone>(mine: &T, base: &T, theirs: &T) -> T {
    if mine == base { theirs.clone() } else { mine.clone() }
}

/// Merges two lists that were both derived from `base`: adds to `theirs` the items that were added in `mine`, and
/// removes from it the items that were removed in `mine`.
fn merged_list<T: PartialEq + Clone>(mine: &[T], base: &[T], theirs: &[T]) -> Vec<T> {
    if theirs == base {
        return mine.to_vec();
    }
    let is_kept = |item: &&T| mine.contains(item) || !base.contains(item);
    let gained = mine.iter().filter(|item| !base.contains(item) && !theirs.contains(item));
    theirs.iter().filter(is_kept).chain(gained).cloned().collect()
}

fn stored<S: Serializer>(path: &Option<PathBuf>, to: S) -> Result<S::Ok, S::Error> {
    path.clone().map(StoredPath).serialize(to)
}

fn restored<'de, D: Deserializer<'de>>(from: D) -> Result<Option<PathBuf>, D::Error> {
    Ok(Option::<StoredPath>::deserialize(from)?.map(|path| path.0))
}

fn all_stored<S: Serializer>(paths: &[PathBuf], to: S) -> Result<S::Ok, S::Error> {
    to.collect_seq(paths.iter().cloned().map(StoredPath))
}

fn all_restored<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<PathBuf>, D::Error> {
    Ok(the_readable::<D, StoredPath>(from)?.into_iter().map(|path| path.0).collect())
}

/// Deserializes a list, skipping items that do not survive a round trip of deserialization and serialization.
fn the_readable<'de, D: Deserializer<'de>, T: DeserializeOwned + Serialize>(from: D) -> Result<Vec<T>, D::Error> {
    let items = Vec::<Value>::deserialize(from)?;
    let read = |item: Value| {
        let read: T = serde_json::from_value(item).ok()?;
        let again: Option<T> = serde_json::to_value(&read).ok().and_then(|again| serde_json::from_value(again).ok());
        again.map(|_| read)
    };
    Ok(items.into_iter().filter_map(read).collect())
}

impl Session {
    /// Returns the preferences to store, with the given state of the window.
    pub(crate) fn preferences(&self, window: &WindowState) -> Preferences {
        // While a scene is loading, that scene is the one to store.
        let InspectionState { scene, camera, mirrored, .. } =
            self.features.places.pending.clone().unwrap_or_else(|| self.place());
        let mut preferences = Preferences {
            source: Some(scene),
            recipe: self.state.recipe,
            camera: Some(if mirrored { camera.mirrored_z() } else { camera }),
            size: self.state.size,
            window: window.clone(),
            ..Preferences::default()
        };
        self.features.store(&mut preferences);
        preferences
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::scene::SceneSource;

    #[test]
    fn a_scene_that_is_still_loading_is_stored() {
        let source = SceneSource::default();
        let scene = source.load().unwrap().scene;
        let home = scene.home;
        let mut session = Session::new(Arc::new(scene), source, Recipe::default(), home);
        let camera = Camera { far: 77.0, ..home };
        session.features.places.pending =
            Some(InspectionState { scene: "/models/large.obj".into(), camera, ..session.place() });
        let kept = session.preferences(&WindowState::default());
        assert_eq!((kept.source, kept.camera), (Some("/models/large.obj".into()), Some(camera)));
    }

    #[test]
    fn unreadable_fields_do_not_affect_others() {
        let source = SceneSource::default();
        let scene = source.load().unwrap().scene;
        let home = scene.home;
        let place = Session::new(Arc::new(scene), source, Recipe::default(), home).place();
        let bookmark = Bookmark { name: "kept".to_owned(), place };
        let mut kept = Preferences {
            recent: vec!["a.obj".into()],
            bookmarks: vec![bookmark; 3],
            watched: vec![(1, 2)],
            window: WindowState { scale: 1.5, window_size: Some([1000.0, 700.0]), ..WindowState::default() },
            ..Preferences::default()
        };
        assert_eq!(Preferences::read(&kept.write()), kept);
        let mut stored: Value = serde_json::from_str(&kept.write()).unwrap();
        for (place, damaged) in [
            ("/recipe/culling", json!("of another version")),
            ("/bookmarks/1/place/camera", json!(null)),
            ("/size", json!("as large as the moon")),
            ("/watched", json!("none")),
        ] {
            *stored.pointer_mut(place).unwrap_or_else(|| panic!("{place}")) = damaged;
        }
        kept.bookmarks.truncate(2);
        kept.watched.clear();
        assert_eq!(Preferences::read(&stored.to_string()), kept);
        assert_eq!(Preferences::read("(of: \"an older\" program)"), Preferences::default());
    }
}
