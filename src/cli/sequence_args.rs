//! Options for sequences of frames: numbers, rate and camera path.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::chain::{KeepDepth, Recipe};
use crate::inspect::scrub::Moment;
use crate::measure::shot::{CameraMotion, Shot, ShotFrame, ShotInputs, ShotRenderer};
use crate::pipeline::viewport::Viewport;
use crate::scene::CameraPath;
use clap::Args;

use super::failure::Failure;
use super::parse;
use super::scene_args::{DrawnFrame, RequestedView};

/// Options for a sequence of frames.
#[derive(Args, Debug)]
pub(crate) struct SequenceArgs {
    /// Write a sequence of frames: a number of frames, or a range without its end such as 12..24. Frame k shows the
    /// time k divided by --fps
    #[arg(long, value_name = "N|A..B", conflicts_with_all = ["time", "data", "totals", "times"],
          value_parser = parse::frames)]
    frames: Option<Range<u32>>,

    /// Number of frames per second
    #[arg(long, value_name = "FPS", default_value_t = 30.0, requires = "frames",
          value_parser = parse::frames_per_second)]
    fps: f64,

    #[arg(long, value_name = "FILE|PRESET", requires = "frames", help = path_help())]
    path: Option<PathBuf>,
}

fn path_help() -> String {
    let presets: Vec<_> = CameraPath::presets().collect();
    format!("Camera path: a JSON file of key views, or a preset that moves the camera: {}", presets.join(" or "))
}

/// Options for the motion of a clip: frame rate and camera path.
#[derive(Args, Debug)]
pub(crate) struct ShotArgs {
    /// Number of frames per second
    #[arg(long, value_name = "FPS", default_value_t = 30.0, value_parser = parse::frames_per_second)]
    fps: f64,

    #[arg(long, value_name = "FILE|PRESET", help = path_help())]
    path: Option<PathBuf>,
}

impl ShotArgs {
    /// Whether a camera path is given.
    pub(crate) fn has_path(&self) -> bool {
        self.path.is_some()
    }

    /// Returns scene and camera of every frame of a clip. Reads the camera path.
    pub(crate) fn shot(&self, view: &RequestedView) -> Result<Shot, Failure> {
        let path = self.path.as_deref().map(camera_path).transpose()?;
        Ok(Shot::from_start(Arc::clone(&view.scene), view.camera, CameraMotion::along(path), self.fps))
    }
}

/// Frames of a sequence.
#[derive(Debug)]
pub(crate) struct Sequence {
    numbers: Range<u32>,
    fps: f64,
    path: Option<CameraPath>,
    output: PathBuf,
}

/// Frame of a sequence.
pub(crate) struct SequenceFrame {
    pub(crate) number: u32,
    pub(crate) output: PathBuf,
}

impl SequenceArgs {
    /// Returns the frames of the sequence; `None` if the options ask for a single frame. Reads the camera path.
    pub(crate) fn frames(&self, output: &Path) -> Result<Option<Sequence>, Failure> {
        let Some(numbers) = self.frames.clone() else { return Ok(None) };
        let path = self.path.as_deref().map(camera_path).transpose()?;
        Ok(Some(Sequence { numbers, fps: self.fps, path, output: output.to_owned() }))
    }
}

/// Returns the camera path with the name of a preset, or reads it from a file.
fn camera_path(given: &Path) -> Result<CameraPath, Failure> {
    match given.to_str().and_then(CameraPath::preset) {
        Some(preset) => Ok(preset),
        None => Ok(CameraPath::read(given)?),
    }
}

impl Sequence {
    /// Returns the number of the first frame.
    pub(crate) fn first(&self) -> u32 {
        self.numbers.start
    }

    /// Returns the number of frames.
    pub(crate) fn count(&self) -> usize {
        self.numbers.len()
    }

    /// Returns the frames in ascending order. A frame depends on its number only, not on the range.
    pub(crate) fn iter(&self) -> impl Iterator<Item = SequenceFrame> {
        self.numbers.clone().map(|number| SequenceFrame { number, output: numbered(&self.output, number) })
    }

    /// Returns scene and camera of every frame. Without a camera path, the camera does not move.
    pub(crate) fn shot(&self, view: &RequestedView) -> Shot {
        let motion = CameraMotion::along(self.path.clone());
        Shot::from_start(Arc::clone(&view.scene), view.camera, motion, self.fps)
    }
}

/// Renderer of the frames of a sequence, completely or up to a point of drawing.
#[derive(Debug)]
pub(crate) struct SequenceRenderer {
    renderer: ShotRenderer,
}

impl SequenceRenderer {
    /// Prepares to draw frames; draws nothing yet.
    pub(crate) fn new(shot: Shot, recipe: Recipe, size: Viewport) -> Self {
        Self { renderer: ShotRenderer::new(ShotInputs { shot, recipe, viewport: size }) }
    }

    /// Draws a frame, completely or only up to `moment`. With an upscaler that reads history, a complete frame has the
    /// history of all frames from frame 0 on.
    pub(crate) fn draw(&mut self, number: u32, moment: Option<Moment>) -> DrawnFrame {
        let ShotInputs { shot, recipe, viewport } = self.renderer.inputs().clone();
        let wanted = ShotFrame { shot, number: number.into() };
        let (scene, camera) = wanted.shot.view(wanted.number);
        if moment.is_none() && recipe.upscaler.upscaler().reads().history {
            return DrawnFrame { scene, camera, recipe, frame: self.renderer.draw(number, KeepDepth::Yes) };
        }
        let mut drawn = DrawnFrame::of(scene, camera, recipe, viewport, moment);
        drawn.frame.before = Some(wanted.before());
        drawn
    }
}

/// Returns the file name of a frame: the number replaces a run of `#`, padded to its length, or else follows the name
/// with four digits, as in `turn.0012.png`.
fn numbered(path: &Path, number: u32) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    if let (Some(first), Some(last)) = (name.find('#'), name.rfind('#'))
        && name[first..last].bytes().all(|byte| byte == b'#')
    {
        let (before, after, width) = (&name[..first], &name[last + 1..], last + 1 - first);
        return path.with_file_name(format!("{before}{number:0width$}{after}"));
    }
    let suffix = path.extension().map(|suffix| format!(".{}", suffix.to_string_lossy())).unwrap_or_default();
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!("{stem}.{number:04}{suffix}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_replace_a_run_of_marks_or_precede_the_suffix() {
        for (given, expected) in [
            ("out/turn.png", "out/turn.0012.png"),
            ("turn", "turn.0012"),
            ("a.b.exr", "a.b.0012.exr"),
            ("turn.######.png", "turn.000012.png"),
            ("turn#.png", "turn12.png"),
            ("#a#.png", "#a#.0012.png"),
        ] {
            assert_eq!(numbered(Path::new(given), 12), Path::new(expected));
        }
    }
}
