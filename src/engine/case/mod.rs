//! Numerical cases in files. Each case is a small input to one algorithm. The code that renders frames computes its
//! answer.
//!
//! Input: a JSON file with an `id`, a `kind`, and the fields of that kind. Each kind has a source file in this module.
//! Output: a result that can be compared with an independently known answer. If the program does not support a request,
//! the output is a [`Refusal`] with the reason. Pixels and samples follow the conventions of [`crate::math`]; all real
//! numbers are in the range of 32-bit floats.

mod circle;
mod clip_tri;
mod control;
mod coplanar_pair;
mod depth;
mod distance_line;
mod ellipse;
mod file;
mod json;
mod line;
mod minimal;
mod poly_fill;
mod real_line;
mod region_fill;
pub(crate) mod rule;
mod texture;
mod tri_area;
mod tri_attr;
mod tri_coverage;
mod upscale;

pub(crate) use circle::Circle;
pub(crate) use circle::CircleAnswer;
pub(crate) use clip_tri::ClipTri;
pub(crate) use clip_tri::ClipTriAnswer;
pub use control::Control;
pub(crate) use coplanar_pair::CoplanarPair;
pub(crate) use coplanar_pair::CoplanarPairAnswer;
pub(crate) use depth::Depth;
pub(crate) use depth::DepthAnswer;
pub(crate) use distance_line::DistanceLine;
pub(crate) use distance_line::DistanceLineAnswer;
pub(crate) use ellipse::Ellipse;
pub(crate) use ellipse::EllipseAnswer;
pub use file::CaseError;
pub(crate) use json::Exactly;
pub(crate) use json::Float;
pub(crate) use json::Point;
pub(crate) use json::Real;
pub(crate) use line::Line;
pub(crate) use line::LineAnswer;
pub use minimal::MinimalCase;
pub(crate) use poly_fill::PolyFill;
pub(crate) use poly_fill::PolyFillAnswer;
pub(crate) use real_line::RealLine;
pub(crate) use real_line::RealLineAnswer;
pub(crate) use region_fill::RegionFill;
pub(crate) use region_fill::RegionFillAnswer;
pub(crate) use texture::Texture;
pub(crate) use texture::TextureAnswer;
pub(crate) use tri_area::TriArea;
pub(crate) use tri_area::TriAreaAnswer;
pub(crate) use tri_attr::AttributeVertex;
pub(crate) use tri_attr::SampleAttributes;
pub(crate) use tri_attr::TriAttr;
pub(crate) use tri_attr::TriAttrAnswer;
pub(crate) use tri_coverage::TriCoverage;
pub(crate) use tri_coverage::TriCoverageAnswer;
pub(crate) use tri_coverage::TriangleSpans;
pub(crate) use upscale::Upscale;
pub(crate) use upscale::UpscaleAnswer;

use std::path::Path;

use serde::Serialize;
use thiserror::Error;

use control::check_length;

use crate::math::fixed::SUBPIXEL_BITS;
use crate::pipeline::raster::CoverageRules;
use crate::pipeline::settings::{Arithmetic, FillRule, Rasterizer};
use crate::pipeline::viewport::Viewport;

/// Numerical case: a small input to one algorithm, as read from a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Identifier of the case, valid as a file name.
    pub id: String,
    /// Kind of the case, with the input of its algorithm.
    pub task: Task,
}

impl Case {
    /// Reads a case from a JSON file.
    ///
    /// Returns an error if the path is not a regular file of at most 16 MiB, or if its content is not JSON, has an
    /// unknown kind, or has fields that do not match the kind.
    pub fn read(path: &Path) -> Result<Self, CaseError> {
        file::read(path)
    }

    /// Parses a case from JSON text. Error messages name `path`.
    pub fn parse(json: &[u8], path: &Path) -> Result<Self, CaseError> {
        file::parse(json, path)
    }
}

/// Choice of algorithm for cases that the program can answer in several ways.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Rasterizer that finds the samples inside a triangle.
    pub rasterizer: Rasterizer,
    /// Arithmetic that decides coverage. Polygon fills decide coverage exactly with every arithmetic; with fixed point,
    /// they snap the corners first.
    pub arithmetic: Arithmetic,
}

impl Options {
    /// Returns the rules of coverage with a fill rule.
    fn coverage(self, fill_rule: FillRule) -> CoverageRules {
        CoverageRules { rasterizer: self.rasterizer, arithmetic: self.arithmetic, fill_rule }
    }

    /// Returns the number of fractional bits of the grid to which corners are snapped; `None` if they are used as
    /// given.
    fn snap_bits(self) -> Option<u32> {
        snap_bits(self.arithmetic)
    }
}

/// Returns the number of fractional bits of the grid to which `arithmetic` snaps corners; `None` if it uses them as
/// given.
fn snap_bits(arithmetic: Arithmetic) -> Option<u32> {
    (arithmetic == Arithmetic::Fixed).then_some(SUBPIXEL_BITS)
}

impl Default for Options {
    fn default() -> Self {
        Self { rasterizer: Rasterizer::BoundingBox, arithmetic: Arithmetic::Fixed }
    }
}

/// Reason why a valid case is not supported, in one sentence.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{0}")]
pub struct Refusal(pub(crate) String);

/// Reason why a case has no answer.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum Unanswered {
    /// The program does not support the request.
    #[error(transparent)]
    Refused(#[from] Refusal),
    /// The evaluation was cancelled.
    #[error("cancelled")]
    Cancelled,
}

/// Validation of the values of a case whose JSON is well-formed.
trait Check {
    /// Returns an error, in one sentence, if a value is invalid.
    fn check(&self) -> Result<(), String> {
        Ok(())
    }
}

/// Declares `Task`, with one variant for each kind of case. Each kind has a struct for its fields, and a name that is
/// used in case files.
macro_rules! tasks {
    ($($kind:ident = $word:literal, $doc:literal;)+) => {
        /// Input of a case, with one variant per algorithm.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Task {
            $(#[doc = $doc] $kind($kind),)+
        }

        impl Task {
            /// Values of the field `kind` in case files, one for each variant.
            pub const KINDS: &[&str] = &[$($word),+];

            /// Parses the input of a case of the given kind. Returns `None` if the kind is unknown.
            fn parse(kind: &str, json: &[u8]) -> Option<serde_json::Result<Self>> {
                match kind {
                    $($word => Some(serde_json::from_slice(json).map(Self::$kind)),)+
                    _ => None,
                }
            }
        }

        impl Check for Task {
            fn check(&self) -> Result<(), String> {
                match self {
                    $(Self::$kind(task) => task.check(),)+
                }
            }
        }
    };
}

tasks! {
    TriCoverage = "tri_coverage", "Samples that lie inside triangles.";
    PolyFill = "poly_fill", "Samples that lie inside a polygon.";
    TriAttr = "tri_attr", "Weights and attributes at samples of a triangle.";
    CoplanarPair = "coplanar_pair", "Weights and attributes at samples of two coplanar triangles.";
    ClipTri = "clip_tri", "Triangles in clip space, clipped, projected and interpolated.";
    TriArea = "tri_area", "Covered area of each pixel of a triangle.";
    Line = "line", "A line between two pixels.";
    RealLine = "real_line", "A line between two points with real coordinates.";
    DistanceLine = "distance_line", "The pixels close to a segment.";
    Circle = "circle", "A circle around a pixel.";
    Ellipse = "ellipse", "An ellipse around a pixel, with axes along rows and columns.";
    RegionFill = "region_fill", "A region filled from a seed.";
    Depth = "depth", "Depths as stored in a depth buffer.";
    Texture = "texture", "Values sampled from a texture.";
    Upscale = "upscale", "An upscaled picture.";
}

/// Answer to a case, in the form written to result files.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
#[expect(missing_docs, reason = "each variant is the answer to the task of its name")]
pub enum Answer {
    TriCoverage(TriCoverageAnswer),
    PolyFill(PolyFillAnswer),
    TriAttr(TriAttrAnswer),
    CoplanarPair(CoplanarPairAnswer),
    ClipTri(ClipTriAnswer),
    TriArea(TriAreaAnswer),
    Line(LineAnswer),
    RealLine(RealLineAnswer),
    DistanceLine(DistanceLineAnswer),
    Circle(CircleAnswer),
    Ellipse(EllipseAnswer),
    RegionFill(RegionFillAnswer),
    Depth(DepthAnswer),
    Texture(TextureAnswer),
    Upscale(UpscaleAnswer),
}

/// Evaluates a case. Returns an error if the request is not supported or the case is cancelled.
///
/// # Examples
/// ```
/// use std::path::Path;
///
/// use rasterscope_engine::case::{Answer, Case, Control, Options, answer};
///
/// let json = br#"{"id": "diagonal", "kind": "line", "p0": [0, 0], "p1": [2, 2], "last_pixel": true}"#;
/// let case = Case::parse(json, Path::new("diagonal.json"))?;
/// let Answer::Line(line) = answer(&case, Options::default(), &Control::default())? else {
///     panic!("the case is a line");
/// };
/// assert_eq!(line.pixels, [(0, 0), (1, 1), (2, 2)]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn answer(case: &Case, options: Options, control: &Control<'_>) -> Result<Answer, Unanswered> {
    Ok(match &case.task {
        Task::TriCoverage(task) => Answer::TriCoverage(task.answer(options, control)?),
        Task::TriAttr(task) => Answer::TriAttr(task.answer(options.arithmetic, control)?),
        Task::CoplanarPair(task) => Answer::CoplanarPair(task.answer(options.arithmetic, control)?),
        Task::ClipTri(task) => Answer::ClipTri(task.answer(options, control)?),
        Task::Depth(task) => Answer::Depth(task.answer(control)?),
        Task::PolyFill(task) => Answer::PolyFill(task.answer(options, control)?),
        Task::TriArea(task) => Answer::TriArea(task.answer(control)?),
        Task::Line(task) => Answer::Line(task.answer(control)?),
        Task::RealLine(task) => Answer::RealLine(task.answer(control)?),
        Task::DistanceLine(task) => Answer::DistanceLine(task.answer(control)?),
        Task::Circle(task) => Answer::Circle(task.answer(control)?),
        Task::Ellipse(task) => Answer::Ellipse(task.answer(control)?),
        Task::RegionFill(task) => Answer::RegionFill(task.answer(control)?),
        Task::Texture(task) => Answer::Texture(task.answer(control)?),
        Task::Upscale(task) => Answer::Upscale(task.answer(control)?),
    })
}

/// Content of a result file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CaseResult {
    /// Identifier of the case.
    pub(crate) id: String,
    /// Answer, or the reason why there is none.
    #[serde(flatten)]
    pub outcome: CaseOutcome,
}

/// Outcome of a case: the answer, or the reason why there is none.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum CaseOutcome {
    /// Answer to a supported case.
    Answered(Answer),
    /// The request is not supported.
    Refused {
        /// Reason for the refusal, in one sentence.
        error: String,
    },
}

/// Evaluates a case and returns the content of its result file; `None` if it was cancelled.
pub fn solve(case: &Case, options: Options, control: &Control<'_>) -> Option<CaseResult> {
    let outcome = match answer(case, options, control) {
        Ok(answer) => CaseOutcome::Answered(answer),
        Err(Unanswered::Refused(refusal)) => CaseOutcome::Refused { error: refusal.to_string() },
        Err(Unanswered::Cancelled) => return None,
    };
    Some(CaseResult { id: case.id.clone(), outcome })
}

/// Returns an error if a picture of `width` × `height` px is not supported.
fn check_picture(width: u32, height: u32) -> Result<(), String> {
    Viewport { width, height }.check().map_err(|flaw| format!("a picture of {width} × {height} px: {flaw}"))
}
