//! Comparison in a project file, with its picture files and sequences of them.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::recipe_text;
use crate::chain::Recipe;
use crate::measure::difference::Difference;
use crate::measure::reference::Reference;
use crate::measure::region::PixelRegion;
use crate::measure::tone::Tone;
use crate::text;

/// Largest shift of a sequence, in frames.
pub const MAX_SHIFT: i64 = 1_000_000;

/// Maximum number of compared pictures: more than there are built-in upscalers.
pub const MAX_TILES: usize = 20;

/// Largest playback speed, in frames per second.
const MAX_SPEED: f32 = 1000.0;

/// Way in which compared pictures are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ComparisonView {
    /// Tiles side by side.
    Tiles,
    /// A to the left of a line, B to its right.
    Wipe,
    /// A or B on the whole canvas.
    Flip,
    /// Difference of A and B.
    Difference,
}

/// Comparison of several pictures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Comparison {
    /// Way in which the pictures are shown.
    pub view: ComparisonView,
    /// Compared pictures: A, B and so on; 2 to 16.
    pub tiles: Vec<ComparedTile>,
    /// Index of the picture that has the settings of the project.
    #[serde(default)]
    pub active: usize,
    /// Reference for errors, unless it is a file.
    pub reference: Reference,
    /// Picture file, or sequence of them, that is the reference.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reference_file: Option<PathBuf>,
    /// Layer, range and shift of each picture file, at most one entry per path.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub files: Vec<ComparedFile>,
    /// Frame and speed of the sequences; `None` if no picture file is a sequence.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub playback: Option<FilePlayback>,
    /// Difference that is shown.
    pub difference: Difference,
    /// Factor by which differences are amplified; 1 to 65 536.
    pub gain: u32,
    /// Position of the wipe, as a fraction of the width from 0 to 1.
    pub wipe: f32,
    /// Region with errors of its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub region: Option<PixelRegion>,
    /// Exposure and tone curve of float pictures.
    pub tone: Tone,
}

/// Picture of a comparison.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ComparedTile {
    /// Recipe with which the picture is drawn.
    #[serde(default, with = "recipe_text")]
    pub settings: Recipe,
    /// Picture file that is shown instead, or a sequence of them: a folder, or a pattern such as `f.####.png`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<PathBuf>,
}

/// Layer, range and shift of a picture file in a comparison.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ComparedFile {
    /// Path of the file, or of a sequence, as in [`ComparedTile::file`] or [`Comparison::reference_file`].
    pub file: PathBuf,
    /// Name of the shown and compared layer; `None` means the first one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub layer: Option<String>,
    /// Values of data that are shown as black and as white; `None` means the smallest and the largest value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub range: Option<(f32, f32)>,
    /// Number of frames by which a sequence is ahead of the others, from -[`MAX_SHIFT`] to [`MAX_SHIFT`].
    #[serde(default, skip_serializing_if = "is_zero")]
    pub shift: i64,
}

fn is_zero(shift: &i64) -> bool {
    *shift == 0
}

/// Playback of the sequences in a comparison.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FilePlayback {
    /// Frame number that all sequences show, before their shifts.
    pub frame: i64,
    /// Speed in frames per second, above 0 and at most 1000.
    pub speed: f32,
}

impl Comparison {
    /// Returns every path of a file.
    pub(super) fn paths_mut(&mut self) -> impl Iterator<Item = &mut PathBuf> {
        let of_tiles = self.tiles.iter_mut().filter_map(|tile| tile.file.as_mut());
        of_tiles.chain(self.reference_file.as_mut()).chain(self.files.iter_mut().map(|entry| &mut entry.file))
    }

    /// Checks that the values are in range.
    pub(super) fn check(&self) -> Result<(), String> {
        let count = self.tiles.len();
        if !(2..=MAX_TILES).contains(&count) {
            return Err(format!("expected 2 to {MAX_TILES} tiles, but there are {count}"));
        }
        if self.active >= count {
            return Err(format!("the active tile {} does not exist; tiles are counted from 0", self.active));
        }
        if !(1..=1 << 16).contains(&self.gain) {
            return Err("the gain must be from 1 to 65536".to_owned());
        }
        if !(0.0..=1.0).contains(&self.wipe) {
            return Err("the wipe must be from 0 to 1".to_owned());
        }
        if self.tone.exposure.is_nan() || self.tone.exposure.abs() > 100.0 {
            return Err("the exposure must be from -100 to 100 stops".to_owned());
        }
        if self.region.is_some_and(|region| region.left >= region.right || region.top >= region.bottom) {
            return Err("the region is empty".to_owned());
        }
        self.files.iter().try_for_each(ComparedFile::check)?;
        if self.playback.is_some_and(|playback| !(playback.speed > 0.0 && playback.speed <= MAX_SPEED)) {
            return Err(format!("the speed must be above 0 and at most {MAX_SPEED} frames per second"));
        }
        self.tiles.iter().try_for_each(|tile| tile.settings.check())
    }
}

impl ComparedFile {
    fn check(&self) -> Result<(), String> {
        let file = text::path(&self.file);
        if !(-MAX_SHIFT..=MAX_SHIFT).contains(&self.shift) {
            return Err(format!("the shift of {file} must be from -{MAX_SHIFT} to {MAX_SHIFT} frames"));
        }
        match self.range {
            Some((low, high)) if !(low.is_finite() && high.is_finite() && low <= high) => {
                Err(format!("the range of {file} must be two finite numbers, the smaller one first"))
            }
            _ => Ok(()),
        }
    }
}
