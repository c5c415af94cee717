//! What should hold for every fragment, checked while a frame is drawn once more.
//!
//! Each [`Assertion`] is one small function over what is known at its moment (`checks`): when a sample is covered, when its
//! depth has passed, when it is shaded. [`check`] draws the triangles of a frame again, watched, and counts; of what is violated
//! it keeps the first fragment in drawing order, so that it can be questioned. The frame itself pays nothing.

mod checks;

mod exact;

mod junctions;

mod watch;

use std::sync::atomic::{AtomicBool, Ordering};

use serde::Serialize;

use self::watch::Watch;
use crate::chain::{Frame, Recipe};
use crate::pipeline::framebuffer::Framebuffer;
use crate::pipeline::raster::Scissor;
use crate::pipeline::settings::{Choice, choice};
use crate::pipeline::triangle_list::box_around;
use crate::pipeline::viewport::{ScreenTriangle, Viewport};
use crate::pipeline::{Extent, Until, draw};
use crate::scene::seams::Seams;
use crate::scene::{Scene, TriangleId};

choice! {
    /// A property that every fragment should have, or every vertex of a border.
    Assertion {
        Owner = "owner", "Owner is exact", "The triangle that a sample was given to contains its centre, by exact arithmetic and a fill rule that draws shared edges once.";
        EdgeSum = "edge-sum", "Edges sum to the area", "The three edge values sum to the doubled area: exactly in fixed point, within 4 roundings of an f64 otherwise.";
        Weights = "weights", "Weights in 0…1", "None of the weights of the corners is negative or above 1: the sample lies between them.";
        WeightsSum = "weights-sum", "Weights sum to 1", "The weights that attributes are interpolated with sum to 1 within 2 ulp, so that a constant stays constant.";
        Finite = "finite", "Weights and depth finite", "No weight and no depth is NaN or infinite.";
        DepthRange = "depth-range", "Depth between corners", "The depth lies between those of the corners, or one step of the buffer beside: it neither leaps nor leaves 0…1.";
        DepthPass = "depth-pass", "Depth passes are real", "What passed the depth test lies where the test asks for, in front of what it replaced or behind, but for 8 steps of the buffer. A test that lets everything pass claims to be in front.";
        Attributes = "attributes", "Attributes finite", "Texture coordinates, normal, vertex colour and light are neither NaN nor infinite.";
        BlendOrder = "blend-order", "Blended from far to near", "What is blended over another blended fragment is not farther than it, by the stored depths.";
        Normal = "normal", "Normal there", "A fragment that is lit has a normal to be lit by.";
        Junctions = "t-junctions", "No T-junctions", "No vertex in the picture lies within the open edge of another triangle, or close to another vertex without being the same.";
    }
}

/// The first fragment that violates an assertion.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Violation {
    /// Column of its pixel in the picture that was drawn.
    pub x: u32,
    /// Row of its pixel.
    pub y: u32,
    /// Its triangle.
    pub triangle: TriangleId,
    /// What is wrong, with the numbers.
    pub text: String,
}

/// What became of one assertion.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// Which.
    pub assertion: Assertion,
    /// Fragments, or vertices of open edges, that it was checked on.
    pub checked: u64,
    /// Number of checked fragments or pixels that violate the assertion.
    pub violated: u64,
    /// The first of them in drawing order; of T-junctions the first pixel in reading order that one leaves open, if one does.
    pub first: Option<Violation>,
}

/// The findings of a frame, in the order of [`Assertion::ALL`].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// One for each assertion that was asked for.
    pub findings: Vec<Finding>,
}

impl Report {
    /// Whether nothing is violated.
    pub fn holds(&self) -> bool {
        self.findings.iter().all(|finding| finding.violated == 0)
    }

    /// The first violation of the first assertion that has one.
    pub fn first_violation(&self) -> Option<(Assertion, &Violation)> {
        self.findings.iter().find_map(|finding| Some((finding.assertion, finding.first.as_ref()?)))
    }
}

/// Triangles that are drawn between two looks at whether to go on.
const TRIANGLES_AT_ONCE: usize = 256;

/// Pixels of their boxes at most, so that cancelling takes less than a second; one triangle may have more.
const PIXELS_AT_ONCE: u64 = 1 << 20;

/// Rows in which triangles that are drawn all at once are drawn at once.
const ROWS_AT_ONCE: usize = 32;

/// Checks assertions on every fragment of a frame: of the samples at the centres of its drawn pixels. `tell` hears the share that
/// is done; nothing comes back once `stop` is set.
pub fn check(
    scene: &Scene,
    recipe: &Recipe,
    frame: &Frame,
    wanted: &[Assertion],
    tell: &dyn Fn(f32),
    stop: &AtomicBool,
) -> Option<Report> {
    let (raster, settings, geometry) = (frame.raster, &recipe.pipeline, &*frame.geometry);
    let grid = frame.sampling.grid();
    let mut framebuffer = Framebuffer::new(grid, raster.width, raster.height, scene.background, settings);
    let mut watch = Watch::new(recipe, frame, wanted);
    let count = geometry.triangles.len();
    let sorted_from = geometry.sorted_from(settings);
    let mut next = 0;
    while next < count {
        if stop.load(Ordering::Relaxed) {
            return None;
        }
        tell(next as f32 / count as f32);
        let whole = Scissor::full(raster.width, raster.height);
        if next < sorted_from {
            let end = next + drawn_at_once(&geometry.triangles[next..sorted_from], raster);
            let triangles = next..end;
            next = triangles.end;
            let extent = Extent { triangles, scissor: whole };
            draw(scene, geometry, settings, &extent, Until::Shade, &mut framebuffer, &mut watch);
            continue;
        }
        // Fragments that are sorted by depth must not be drawn in parts, but rows do not depend on each other.
        for top in (0..raster.height).step_by(ROWS_AT_ONCE) {
            let drawn = f64::from(top) / f64::from(raster.height) * (count - next) as f64;
            tell((next as f64 + drawn) as f32 / count as f32);
            if stop.load(Ordering::Relaxed) {
                return None;
            }
            let scissor = Scissor { top, bottom: (top + ROWS_AT_ONCE as u32).min(raster.height), ..whole };
            let extent = Extent { triangles: next..count, scissor };
            draw(scene, geometry, settings, &extent, Until::Shade, &mut framebuffer, &mut watch);
        }
        next = count;
    }
    let mut report = watch.report();
    if let Some(finding) = report.findings.iter_mut().find(|finding| finding.assertion == Assertion::Junctions) {
        *finding = junctions::check(scene, recipe, frame, &Seams::find(scene, stop)?);
    }
    Some(report)
}

/// Returns how many of the triangles are drawn at once, from the first; none only of none.
fn drawn_at_once(triangles: &[ScreenTriangle], viewport: Viewport) -> usize {
    let mut pixels = 0;
    let most = triangles.len().min(TRIANGLES_AT_ONCE);
    let last = triangles[..most].iter().position(|triangle| {
        pixels += box_pixels(triangle, viewport);
        pixels > PIXELS_AT_ONCE
    });
    last.map_or(most, |last| last + 1)
}

/// Returns about how many pixels of the picture the box around a triangle has; one at least.
fn box_pixels(triangle: &ScreenTriangle, viewport: Viewport) -> u64 {
    let [left, right, top, bottom] = box_around(triangle.corners_px());
    let side = |least: f32, greatest: f32, size: u32| (greatest.min(size as f32) - least.max(0.0)).max(0.0) as u64 + 1;
    side(left, right, viewport.width) * side(top, bottom, viewport.height)
}

#[cfg(test)]
mod tests;
