//! Source of a scene: a built-in scene or a file, from which the scene can be rebuilt or reloaded.

use std::path::PathBuf;

use super::builtin::{self, Builtin};
use super::obj::{self, Loaded, TrMeaning};
use super::{LoadControl, MemoryLimit, Scene, SceneError};
use crate::text;

/// Built-in scene or model file.
#[derive(Clone, Debug)]
pub enum SceneSource {
    /// Generated scene.
    Builtin(&'static Builtin),
    /// Wavefront OBJ file, and the meaning of `Tr` in its materials.
    File(PathBuf, TrMeaning),
}

impl SceneSource {
    /// Returns the source for `name`: a built-in scene if it is one's ID, otherwise a file path. (`./chess` is the
    /// file.)
    pub fn named(name: PathBuf) -> Self {
        match name.to_str().and_then(builtin::by_id) {
            Some(builtin) => Self::Builtin(builtin),
            None => Self::File(name, TrMeaning::Auto),
        }
    }

    /// Returns a name from which [`SceneSource::named`] recreates this source, if no file has the name of a built-in
    /// scene.
    pub fn name(&self) -> PathBuf {
        match self {
            Self::Builtin(builtin) => builtin.id.into(),
            Self::File(path, _) => path.clone(),
        }
    }

    /// Returns the display name: a title, or the name of the file.
    pub(crate) fn title(&self) -> String {
        match self {
            Self::Builtin(builtin) => builtin.title.to_owned(),
            Self::File(path, _) => path.file_name().map_or_else(String::new, |name| text::path(name.as_ref())),
        }
    }

    /// Returns the source with this meaning of `Tr`; a built-in scene is returned unchanged.
    pub(crate) fn with_tr(self, tr: TrMeaning) -> Self {
        match self {
            Self::Builtin(builtin) => Self::Builtin(builtin),
            Self::File(path, _) => Self::File(path, tr),
        }
    }

    /// Builds the scene, or loads it within the default memory limit. Only files can fail; see [`obj::load`].
    ///
    /// # Examples
    /// ```
    /// use rasterscope::scene::SceneSource;
    ///
    /// let folder = tempfile::tempdir()?;
    /// let path = folder.path().join("square.obj");
    /// std::fs::write(&path, "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n")?;
    ///
    /// let loaded = SceneSource::named(path).load()?;
    /// assert_eq!(loaded.scene.name, "square");
    /// assert_eq!(loaded.scene.triangle_count(), 2);
    /// assert!(loaded.warnings.is_empty());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn load(&self) -> Result<Loaded, SceneError> {
        self.load_with(LoadControl::quiet(MemoryLimit::default()))
    }

    /// Builds or loads the scene like [`SceneSource::load`], with the given memory limit, progress and cancellation.
    pub(crate) fn load_with(&self, control: LoadControl<'_>) -> Result<Loaded, SceneError> {
        let mut loaded = match self {
            Self::Builtin(builtin) => Loaded::from(builtin.build()),
            Self::File(path, tr) => obj::load_with(path, *tr, control)?,
        };
        loaded.scene.clean_names();
        Ok(loaded)
    }
}

impl Default for SceneSource {
    /// Returns the first built-in scene.
    fn default() -> Self {
        Self::Builtin(&builtin::ALL[0])
    }
}

impl From<Scene> for Loaded {
    /// Wraps a scene without warnings or notes.
    fn from(scene: Scene) -> Self {
        Self { scene, warnings: Vec::new(), notes: Vec::new() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_mean_built_in_scenes_and_all_else_is_a_path() {
        for builtin in builtin::ALL {
            assert!(matches!(SceneSource::named(builtin.id.into()), SceneSource::Builtin(b) if b.id == builtin.id));
        }
        let SceneSource::File(path, _) = SceneSource::named("./chess".into()) else { panic!("a path was given") };
        assert!(SceneSource::File(path, TrMeaning::Auto).load().is_err());
    }
}
