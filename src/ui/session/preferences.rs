//! What is kept between runs.

use std::path::PathBuf;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::{Map, Value, json};

use super::Session;
use crate::chain::Recipe;
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, SceneSource};
use crate::ui::place::Bookmark;

/// How large the picture is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PictureSize {
    /// As large as the canvas, one picture pixel on each screen pixel.
    #[default]
    Canvas,
    /// Fixed, in px.
    Fixed(u32, u32),
}

impl PictureSize {
    /// This size, or that of the canvas if no picture may be that large.
    pub fn checked(self) -> Self {
        match self {
            Self::Fixed(width, height) if Viewport { width, height }.check().is_err() => Self::Canvas,
            size => size,
        }
    }
}

/// What the pointer does on the canvas.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PointerMode {
    /// Drag moves the picture, wheel enlarges it.
    #[default]
    Inspect,
    /// Drag turns the scene, wheel comes closer, W A S D fly.
    Camera,
}

impl PointerMode {
    /// The mode that is not this one.
    pub fn other(self) -> Self {
        match self {
            Self::Inspect => Self::Camera,
            Self::Camera => Self::Inspect,
        }
    }
}

/// Kept between runs, as JSON. What cannot be read of it, because an older or newer program wrote it or somebody else, is left
/// out by itself.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Preferences {
    /// Last scene: the id of a built-in one, or a path.
    pub source: Option<PathBuf>,
    /// Last recipe.
    pub recipe: Recipe,
    /// Last view; the scene's own if none.
    pub camera: Option<Camera>,
    /// Last picture size.
    pub size: PictureSize,
    /// Files opened, newest first.
    #[serde(deserialize_with = "the_readable")]
    pub recent: Vec<PathBuf>,
    /// Whether the first hint was closed.
    pub hint_closed: bool,
    /// Light theme instead of dark.
    pub light_theme: bool,
    /// Interface scale; 0 means 1.
    pub scale: f32,
    /// Places that were kept.
    #[serde(deserialize_with = "the_readable")]
    pub bookmarks: Vec<Bookmark>,
    /// Pixels that are watched.
    #[serde(deserialize_with = "the_readable")]
    pub watched: Vec<(u32, u32)>,
}

impl Preferences {
    /// From what was stored, but for what cannot be read of it.
    pub fn read(stored: &str) -> Self {
        let fields: Map<String, Value> = serde_json::from_str(stored).unwrap_or_default();
        let can_be_read = |(key, value): &(String, Value)| Self::deserialize(json!({ key: value })).is_ok();
        serde_json::from_value(fields.into_iter().filter(can_be_read).collect()).unwrap_or_default()
    }

    /// As it is stored.
    pub fn write(&self) -> String {
        // Nothing in it can fail to be written: its maps have names, and what is not finite becomes null.
        serde_json::to_string(self).unwrap_or_default()
    }
}

/// Those of a list that can be read.
fn the_readable<'de, D: Deserializer<'de>, T: DeserializeOwned>(from: D) -> Result<Vec<T>, D::Error> {
    let items = Vec::<Value>::deserialize(from)?;
    Ok(items.into_iter().filter_map(|item| serde_json::from_value(item).ok()).collect())
}

impl Session {
    /// What is kept between runs.
    pub fn preferences(&self, light_theme: bool, scale: f32) -> Preferences {
        Preferences {
            source: Some(match &self.source {
                SceneSource::Builtin(_) => self.source.name(),
                SceneSource::File(path) => std::path::absolute(path).unwrap_or_else(|_| path.clone()),
            }),
            recipe: self.state.recipe,
            camera: Some(if self.mirrored { self.state.camera.mirrored_z() } else { self.state.camera }),
            size: self.state.size,
            recent: self.recent.clone(),
            hint_closed: self.hint_closed,
            light_theme,
            scale,
            bookmarks: self.places.bookmarks.clone(),
            watched: self.watch.pixels.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;

    #[test]
    fn what_cannot_be_read_costs_nothing_else() {
        let source = SceneSource::default();
        let scene = source.load().unwrap().scene;
        let home = scene.home;
        let place = Session::new(Arc::new(scene), source, Recipe::default(), home).place();
        let bookmark = Bookmark { name: "kept".to_owned(), place };
        let mut kept = Preferences {
            recent: vec!["a.obj".into()],
            bookmarks: vec![bookmark; 3],
            watched: vec![(1, 2)],
            scale: 1.5,
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
