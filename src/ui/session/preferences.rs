//! What is kept between runs.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

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

/// Kept between runs.
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
    pub recent: Vec<PathBuf>,
    /// Whether the first hint was closed.
    pub hint_closed: bool,
    /// Light theme instead of dark.
    pub light_theme: bool,
    /// Interface scale; 0 means 1.
    pub scale: f32,
    /// Places that were kept.
    pub bookmarks: Vec<Bookmark>,
    /// Pixels that are watched.
    pub watched: Vec<(u32, u32)>,
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
