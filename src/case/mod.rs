//! Numerical cases in files: small inputs to one algorithm each, answered by the same code that draws.
//!
//! In: a JSON file with an `id`, a `kind`, and what that kind needs, one file per kind here. Out: a result that can be
//! compared with an answer known from elsewhere, or a [`Refusal`] in words where this program does not do what a case
//! asks. Pixels and samples lie as in [`crate::math`]; all real numbers are values of 32-bit floats.

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

pub use circle::{Circle, CircleAnswer};
pub use clip_tri::{ClipSample, ClipTri, ClipTriAnswer};
pub use control::{Control, MAX_ANSWER_BYTES};
pub use coplanar_pair::{CoplanarPair, CoplanarPairAnswer};
pub use depth::{Depth, DepthAnswer, DepthFormat, Mapping};
pub use distance_line::{DistanceLine, DistanceLineAnswer};
pub use ellipse::{Ellipse, EllipseAnswer};
pub use file::CaseError;
pub use json::{Exactly, Float, Point, Real};
pub use line::{Line, LineAnswer};
pub use minimal::MinimalCase;
pub use poly_fill::{PolyFill, PolyFillAnswer, PolygonRule};
pub use real_line::{RealLine, RealLineAnswer};
pub use region_fill::{FillMode, RegionFill, RegionFillAnswer};
pub use texture::{Texture, TextureAddress, TextureAnswer, TextureFilter};
pub use tri_area::{TriArea, TriAreaAnswer};
pub use tri_attr::{SampleAttributes, TriAttr, TriAttrAnswer, Vertex};
pub use tri_coverage::{Covered, TriCoverage, TriCoverageAnswer};
pub use upscale::{Upscale, UpscaleAnswer};

use std::path::Path;

use serde::Serialize;
use thiserror::Error;

use control::check_length;

use crate::math::fixed::SUBPIXEL_BITS;
use crate::pipeline::settings::{Arithmetic, Rasterizer};
use crate::pipeline::viewport::Viewport;

/// A case as read from a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Its name, fit to name a file.
    pub id: String,
    /// What is asked.
    pub task: Task,
}

impl Case {
    /// Reads a case. Errors: not a regular file of at most 16 MiB, not JSON, no known kind, or not what the kind needs.
    pub fn read(path: &Path) -> Result<Self, CaseError> {
        file::read(path)
    }

    /// Takes a case from text; `path` is what errors name.
    pub fn parse(json: &[u8], path: &Path) -> Result<Self, CaseError> {
        file::parse(json, path)
    }
}

/// With which of its algorithms the program answers, where it has several.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// How the samples inside a triangle are found.
    pub rasterizer: Rasterizer,
    /// The numbers that coverage is decided in. Polygons are filled exactly either way: in fixed point with their corners
    /// snapped, else with their corners as given.
    pub arithmetic: Arithmetic,
}

impl Options {
    /// Fraction bits of the grid that corners are snapped to; `None` if they are used as given.
    fn snap_bits(self) -> Option<u32> {
        snap_bits(self.arithmetic)
    }
}

/// Returns the fraction bits of the grid that an arithmetic snaps corners to; `None` if it uses them as given.
fn snap_bits(arithmetic: Arithmetic) -> Option<u32> {
    (arithmetic == Arithmetic::Fixed).then_some(SUBPIXEL_BITS)
}

impl Default for Options {
    fn default() -> Self {
        Self { rasterizer: Rasterizer::BoundingBox, arithmetic: Arithmetic::Fixed }
    }
}

/// Why a case is not answered although nothing is wrong with it, in one sentence.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{0}")]
pub struct Refusal(pub(crate) String);

/// Why a case has no answer.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum Unanswered {
    /// The program does not do what the case asks.
    #[error(transparent)]
    Refused(#[from] Refusal),
    /// The evaluation was cancelled.
    #[error("cancelled")]
    Cancelled,
}

/// What is wrong with the values of a case of the right form.
trait Check {
    /// Says so in one sentence, if anything is.
    fn check(&self) -> Result<(), String> {
        Ok(())
    }
}

/// Declares the enum of kinds, each with its struct and its word in files.
macro_rules! tasks {
    ($($kind:ident = $word:literal, $doc:literal;)+) => {
        /// What a case asks, one kind for each algorithm.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Task {
            $(#[doc = $doc] $kind($kind),)+
        }

        impl Task {
            /// The words of all kinds.
            pub const KINDS: &[&str] = &[$($word),+];

            /// Reads what a kind needs; `None` for an unknown kind.
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
    TriCoverage = "tri_coverage", "Which samples lie inside triangles.";
    PolyFill = "poly_fill", "Which samples lie inside a polygon.";
    TriAttr = "tri_attr", "Weights and attributes at samples of a triangle.";
    CoplanarPair = "coplanar_pair", "The same in two triangles of one plane.";
    ClipTri = "clip_tri", "Triangles in clip space, clipped, projected and interpolated.";
    TriArea = "tri_area", "What area of each pixel a triangle covers.";
    Line = "line", "A line between two pixels.";
    RealLine = "real_line", "A line between two real points.";
    DistanceLine = "distance_line", "The pixels close to a segment.";
    Circle = "circle", "A circle around a pixel.";
    Ellipse = "ellipse", "An ellipse around a pixel, with axes along rows and columns.";
    RegionFill = "region_fill", "A region filled from a seed.";
    Depth = "depth", "What a depth buffer stores.";
    Texture = "texture", "What a texture reads as.";
    Upscale = "upscale", "An enlarged picture.";
}

/// The answer to a case, as results write it.
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

/// Answers a case.
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

/// The content of a result file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CaseResult {
    /// The name of the case.
    pub id: String,
    /// What came out.
    #[serde(flatten)]
    pub outcome: Outcome,
}

/// An answer, or the reason why there is none.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Outcome {
    /// The answer.
    Answered(Answer),
    /// Why there is none.
    Refused {
        /// One sentence.
        error: String,
    },
}

/// Answers a case, or says in the result why not; `None` if it was cancelled.
pub fn solve(case: &Case, options: Options, control: &Control<'_>) -> Option<CaseResult> {
    let outcome = match answer(case, options, control) {
        Ok(answer) => Outcome::Answered(answer),
        Err(Unanswered::Refused(refusal)) => Outcome::Refused { error: refusal.to_string() },
        Err(Unanswered::Cancelled) => return None,
    };
    Some(CaseResult { id: case.id.clone(), outcome })
}

/// Says what is wrong with the size of a picture, if anything is.
fn check_picture(width: u32, height: u32) -> Result<(), String> {
    Viewport { width, height }.check().map_err(|flaw| format!("a picture of {width} × {height} px: {flaw}"))
}
