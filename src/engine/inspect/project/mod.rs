//! Project files: the state of the window as a small JSON file, which the window and the command line restore.
//!
//! Paths in the file are relative to its folder where possible. Settings are those that differ from the defaults, in the
//! syntax of `--set`. Unknown fields and values are errors that name the line, with one exception: an upscaler that is
//! not registered is replaced by native resolution, with a warning. Reading a project starts no process.

mod comparison;

mod paths;

mod recipe_text;

use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::buffers::Buffer;
use super::display::Display;
use super::intermediate::Intermediate;
use super::overlays::OverlayLayer;
use super::place::InspectionState;
use super::probe::Probe;
use super::scrub::Moment;
use super::stages::Stage;
use crate::chain::Recipe;
use crate::disk::{self, stored_path};
use crate::pipeline::viewport::Viewport;
use crate::scene::obj::TrMeaning;
use crate::scene::{Camera, KeyView, SceneError, SceneSource, Warning, camera_file, key_views};
use crate::text;

pub use comparison::{ComparedFile, ComparedTile, Comparison, ComparisonView, FilePlayback, MAX_SHIFT, MAX_TILES};

/// File name extension, in lower case and without the dot.
pub const EXTENSION: &str = "rasterscope";

/// Version of the format, which changes if an older program would misread a file.
const VERSION: u32 = 1;

/// Maximum size of a project file, in bytes. Typical files have about a thousand.
const MAX_BYTES: u64 = 1 << 20;

/// Number of bytes at the start of a model that its fingerprint covers, besides its length.
const FINGERPRINT_BYTES: u64 = 16 << 20;

/// Content of a project file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Project {
    /// Version of the format.
    rasterscope: u32,
    /// Scene: the id of a built-in scene, or the path of a model.
    #[serde(with = "stored_path")]
    scene: PathBuf,
    /// Fingerprint of the model when the project was saved; `None` for a built-in scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    fingerprint: Option<String>,
    /// Meaning of `Tr` in the material libraries of the model.
    #[serde(default)]
    tr: TrMeaning,
    /// Whether the scene is mirrored in z. `camera` views the mirrored scene.
    #[serde(default)]
    mirrored: bool,
    /// Time of the pose of an animated scene, in seconds.
    #[serde(default, skip_serializing_if = "is_zero")]
    time_s: f64,
    /// Camera of the view.
    #[serde(with = "camera_file")]
    camera: Camera,
    /// Recipe for drawing the frame.
    #[serde(default, with = "recipe_text")]
    settings: Recipe,
    /// Width and height of the picture in pixels.
    size: (u32, u32),
    /// Displayed buffer, if neither a stage nor an intermediate value is displayed.
    #[serde(default = "color")]
    buffer: Buffer,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    stage: Option<Stage>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    intermediate: Option<Intermediate>,
    /// Range, colour map and channels of the display.
    #[serde(default)]
    look: Display,
    /// Overlays of the picture, from bottom to top.
    #[serde(default)]
    overlays: Vec<OverlayLayer>,
    /// Number of rasterized triangles to draw; `None` for all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    triangles: Option<usize>,
    /// Number of drawn fragments of the last triangle; `None` for all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    fragments: Option<usize>,
    /// Picked pixel: column and row.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pick: Option<(u32, u32)>,
    /// Comparison that is shown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub comparison: Option<Comparison>,
    /// Id of the workspace that is shown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub workspace: Option<String>,
    /// Settings of the stability probe.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub probe: Option<Probe>,
    /// Recorded camera path; `None` without a key view.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub camera_path: Option<StoredPath>,
}

/// Camera path that was recorded in the window.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoredPath {
    /// Key views in ascending order of their times, at least one.
    #[serde(with = "key_views")]
    pub keys: Vec<KeyView>,
    /// Whether the camera follows the path when the time changes.
    #[serde(default = "yes")]
    pub follows: bool,
    /// Shown time of a still scene, in seconds.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub time_s: f64,
}

fn yes() -> bool {
    true
}

fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

fn color() -> Buffer {
    Buffer::Color
}

/// Project that was read, with warnings.
#[derive(Clone, Debug)]
pub struct LoadedProject {
    /// State that the file describes.
    pub project: Project,
    /// Warnings about a changed model and about upscalers that are not registered.
    pub warnings: Vec<Warning>,
}

impl Project {
    /// Creates a project with the state of an inspection, without a comparison. `tr` is the meaning of `Tr` with which the
    /// model was loaded, and `size` the size of the picture.
    pub fn new(state: InspectionState, tr: TrMeaning, size: Viewport) -> Self {
        Self {
            rasterscope: VERSION,
            scene: state.scene,
            fingerprint: None,
            tr,
            mirrored: state.mirrored,
            time_s: state.time_s,
            camera: state.camera,
            settings: state.recipe,
            size: (size.width, size.height),
            buffer: state.buffer,
            stage: state.stage,
            intermediate: state.number,
            look: state.display,
            overlays: state.overlays,
            triangles: state.triangles,
            fragments: state.fragments,
            pick: state.pixel,
            comparison: None,
            workspace: None,
            probe: None,
            camera_path: None,
        }
    }

    /// Returns whether a path has the extension of project files.
    pub fn is_named(path: &Path) -> bool {
        path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(EXTENSION))
    }

    /// Reads a project file of at most 1 MiB. Paths of the result are absolute.
    ///
    /// # Errors
    /// Returns an error that names the file and, if known, the line: for an unreadable file, malformed JSON, a newer
    /// version, unknown fields, and values out of range.
    pub fn read(path: &Path) -> Result<LoadedProject, SceneError> {
        let bytes =
            disk::read(path, MAX_BYTES).map_err(|source| SceneError::Unreadable { path: path.to_owned(), source })?;
        let at_line = |line, reason: String| SceneError::Line { path: path.to_owned(), line, reason };
        let json = |error: serde_json::Error| at_line(error.line().max(1), reason_of(&error));
        let head: Head = serde_json::from_slice(&bytes).map_err(json)?;
        if head.rasterscope > VERSION {
            let line = line_of(&bytes, "\"rasterscope\"");
            let version = head.rasterscope;
            let reason = format!("the project has version {version}; this program reads up to version {VERSION}");
            return Err(at_line(line, reason));
        }
        let mut project: Self = serde_json::from_slice(&bytes).map_err(json)?;
        let unusable = |reason| SceneError::Unusable { path: path.to_owned(), reason };
        project.check().map_err(unusable)?;
        let folder = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        project.change_paths(|stored| paths::absolute(stored, folder.parent().unwrap_or(&folder)));
        let mut warnings: Vec<Warning> = recipe_text::unknown_upscalers(&bytes)
            .into_iter()
            .map(|id| Warning::file(path, format!("the upscaler `{id}` is not registered; native resolution is used")))
            .collect();
        if let SceneSource::File(model, _) = project.source()
            && let Some(stored) = &project.fingerprint
            && fingerprint(&model).is_ok_and(|now| now != *stored)
        {
            let text = format!("the model {} has changed since the project was saved", text::path(&model));
            warnings.push(Warning::file(path, text));
        }
        Ok(LoadedProject { project, warnings })
    }

    /// Encodes the project as a file in `folder`. Reads the model to identify it later.
    ///
    /// # Errors
    /// Returns an error if the model cannot be read.
    pub fn encode(mut self, folder: &Path) -> io::Result<Vec<u8>> {
        if let SceneSource::File(model, _) = self.source() {
            self.fingerprint = Some(fingerprint(&model)?);
        }
        let folder = std::path::absolute(folder)?;
        self.change_paths(|path| paths::relative(path, &folder));
        let mut text = serde_json::to_vec_pretty(&self)?;
        text.push(b'\n');
        Ok(text)
    }

    /// Returns the source of the scene.
    pub fn source(&self) -> SceneSource {
        SceneSource::named(self.scene.clone()).with_tr(self.tr)
    }

    /// Returns the size of the picture.
    pub fn size(&self) -> Viewport {
        let (width, height) = self.size;
        Viewport { width, height }
    }

    /// Returns the point at which drawing of the frame stops; `None` if it is drawn completely.
    pub fn moment(&self) -> Option<Moment> {
        self.triangles.map(|triangles| Moment { triangles, fragments: self.fragments })
    }

    /// Returns the state of the inspection.
    pub fn state(&self) -> InspectionState {
        InspectionState {
            scene: self.scene.clone(),
            mirrored: self.mirrored,
            time_s: self.time_s,
            camera: self.camera,
            recipe: self.settings,
            picture: Some(self.size),
            buffer: self.buffer,
            stage: self.stage,
            number: self.intermediate,
            display: self.look,
            overlays: self.overlays.clone(),
            triangles: self.triangles,
            fragments: self.fragments,
            pixel: self.pick,
        }
    }

    /// Replaces every path of a file. Ids of built-in scenes stay.
    fn change_paths(&mut self, change: impl Fn(&Path) -> PathBuf) {
        if matches!(self.source(), SceneSource::File(..)) {
            self.scene = change(&self.scene);
        }
        if let Some(comparison) = &mut self.comparison {
            comparison.paths_mut().for_each(|path| *path = change(path));
        }
    }

    /// Checks that the values are in range.
    fn check(&self) -> Result<(), String> {
        self.state().check()?;
        let (width, height) = self.size;
        if let Some((x, y)) = self.pick.filter(|(x, y)| *x >= width || *y >= height) {
            return Err(format!("pick: pixel {x}, {y} lies outside the picture of {width} × {height} px"));
        }
        if self.probe.is_some_and(|probe| probe.runs == 0) {
            return Err("probe: the number of runs must be at least 1".to_owned());
        }
        if self.camera_path.as_ref().is_some_and(|path| !path.time_s.is_finite()) {
            return Err("camera_path: the time must be finite".to_owned());
        }
        self.comparison.as_ref().map_or(Ok(()), |comparison| comparison.check().map_err(|r| format!("comparison: {r}")))
    }
}

/// Field that identifies a project file.
#[derive(Deserialize)]
struct Head {
    rasterscope: u32,
}

/// Returns the message of a JSON error without its position.
fn reason_of(error: &serde_json::Error) -> String {
    let whole = error.to_string();
    let reason = whole.rsplit_once(" at line ").map_or(whole.as_str(), |(reason, _)| reason);
    match reason {
        "missing field `rasterscope`" => "not a project of Rasterscope: it has no field `rasterscope`".to_owned(),
        reason => text::message(reason),
    }
}

/// Returns the line of the first occurrence of a text, counted from 1; 1 if there is none.
fn line_of(bytes: &[u8], text: &str) -> usize {
    let place = bytes.windows(text.len()).position(|window| window == text.as_bytes()).unwrap_or(0);
    1 + bytes[..place].iter().filter(|byte| **byte == b'\n').count()
}

/// Returns a fingerprint of a file: its length, and the 64-bit FNV-1a hash of its first 16 MiB. It recognises changes by
/// accident, not by intent.
fn fingerprint(path: &Path) -> io::Result<String> {
    const OFFSET: u64 = 0xCBF2_9CE4_8422_2325;
    const PRIME: u64 = 0x0100_0000_01B3;
    let length = path.metadata()?.len();
    let hash = disk::start(path, FINGERPRINT_BYTES)
        .iter()
        .fold(OFFSET, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(PRIME));
    Ok(format!("{length}-{hash:016x}"))
}

#[cfg(test)]
mod tests;
