//! Assertions: properties that must hold for every fragment, checked while a frame is drawn again.
//!
//! Each [`Assertion`] is one small function in `checks`. It runs as soon as its inputs are known: when a sample is
//! covered, when it passes the depth test, or when it is shaded. [`check`] draws the triangles of a frame again with an
//! observer and counts violations. It keeps the first violating fragment in drawing order for inspection. Normal
//! drawing has no overhead.

mod checks;

mod exact;

mod junctions;

mod watch;

use serde::Serialize;

use self::watch::AssertionObserver;
use crate::chain::{Frame, Recipe};
use crate::inspect::control::TaskControl;
use crate::pipeline::framebuffer::Framebuffer;
use crate::pipeline::pixel_box::box_around;
use crate::pipeline::raster::Scissor;
use crate::pipeline::screen_triangle::ScreenTriangle;
use crate::pipeline::settings::{Choice, choice};
use crate::pipeline::viewport::Viewport;
use crate::pipeline::{DrawCall, Extent};
use crate::scene::seams::Seams;
use crate::scene::{Scene, TriangleId};

choice! {
    /// An assertion: a property that must hold for every fragment, or for every vertex on an open edge of the mesh.
    pub Assertion {
        Owner = "owner", "Owner is exact", "The triangle that owns a sample contains its centre, in exact arithmetic and by a fill rule that draws shared edges once.";
        EdgeSum = "edge-sum", "Edges sum to the area", "The three edge values sum to the doubled area: exactly in fixed point, otherwise within 4 ε of f64, relative to the area.";
        Weights = "weights", "Weights in 0…1", "No corner weight is below 0 or above 1: the sample lies inside the triangle.";
        WeightsSum = "weights-sum", "Weights sum to 1", "The attribute weights sum to 1 within 2 ulp, so that a constant attribute stays constant.";
        Finite = "finite", "Weights and depth finite", "No weight and no depth is NaN or infinite.";
        DepthRange = "depth-range", "Depth between corners", "The depth lies between the corner depths, with a tolerance of one step of the depth buffer, and within 0…1.";
        DepthPass = "depth-pass", "Depth test is correct", "A fragment that passed the depth test lies on the correct side of the fragment that it replaced, with a tolerance of 8 steps of the depth buffer. The test “Always” is checked as if the nearer fragment had to win.";
        Attributes = "attributes", "Attributes finite", "No texture coordinate, normal, vertex colour or light is NaN or infinite.";
        BlendOrder = "blend-order", "Blended from far to near", "No fragment is blended over a nearer blended fragment, according to their depths.";
        Normal = "normal", "Normal exists", "Every lit fragment has a normal whose length is not zero.";
        Junctions = "t-junctions", "No T-junctions", "No vertex in the picture lies within the open edge of another triangle (T-junction) or close to a vertex that it should be welded with.";
    }
}

/// The first fragment that violates an assertion.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Violation {
    /// Column of the violating pixel in the raster image, before upscaling.
    pub x: u32,
    /// Row of the violating pixel in the raster image, before upscaling.
    pub y: u32,
    /// Triangle of the violating fragment.
    pub triangle: TriangleId,
    /// Description of the violation, including the wrong values.
    pub text: String,
}

/// Result of checking one assertion on a frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// The assertion that was checked.
    pub assertion: Assertion,
    /// Number of fragments, or of vertices of open edges, that were checked.
    pub checked: u64,
    /// Number of the checked fragments or vertices that violate the assertion.
    pub violated: u64,
    /// First violation in drawing order; `None` if there is none. For T-junctions, this is the first crack or double
    /// hit at a junction, in reading order. If there is no such fault, it is the first junction in the picture.
    pub first: Option<Violation>,
}

/// Results of all assertions that were checked on a frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AssertionReport {
    /// One finding for each requested assertion, in the requested order.
    pub findings: Vec<Finding>,
}

impl AssertionReport {
    /// Whether all assertions hold.
    #[cfg(test)]
    pub(crate) fn holds(&self) -> bool {
        self.findings.iter().all(|finding| finding.violated == 0)
    }

    /// Returns the first violation of the first violated assertion.
    pub fn first_violation(&self) -> Option<(Assertion, &Violation)> {
        self.findings.iter().find_map(|finding| Some((finding.assertion, finding.first.as_ref()?)))
    }
}

/// Maximum number of triangles drawn between two checks for cancellation.
const TRIANGLES_AT_ONCE: usize = 256;

/// Maximum number of bounding-box pixels drawn between two checks for cancellation. It limits the delay after a
/// cancellation to less than a second. A single triangle may exceed the maximum.
const PIXELS_AT_ONCE: u64 = 1 << 20;

/// Number of rows drawn between two checks for cancellation if fragments are sorted by depth.
const ROWS_AT_ONCE: usize = 32;

/// Checks assertions on every fragment of a frame, sampled at the centre of each drawn pixel. Returns `None` if
/// cancelled.
///
/// # Examples
/// ```
/// use rasterscope_engine::chain::{Recipe, run};
/// use rasterscope_engine::inspect::assertions::{Assertion, check};
/// use rasterscope_engine::inspect::control::TaskControl;
/// # use rasterscope_engine::pipeline::viewport::Viewport;
/// # use rasterscope_engine::scene::builtin;
///
/// # let scene = builtin::by_id("shared-edges").unwrap().build();
/// # let viewport = Viewport { width: 64, height: 40 };
/// let mut recipe = Recipe::default();
/// recipe.set("fill_rule=inclusive")?;
/// let frame = run(&scene, &scene.home, &recipe, viewport, &mut ());
///
/// // The inclusive fill rule draws samples on shared edges twice.
/// let report = check(&scene, &recipe, &frame, &[Assertion::Owner], TaskControl::quiet()).unwrap();
/// let (assertion, violation) = report.first_violation().unwrap();
/// assert_eq!(assertion, Assertion::Owner);
/// assert!(violation.x < 64 && violation.y < 40);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn check(
    scene: &Scene,
    recipe: &Recipe,
    frame: &Frame,
    wanted: &[Assertion],
    control: TaskControl<'_>,
) -> Option<AssertionReport> {
    let (raster, settings, geometry) = (frame.raster, &recipe.pipeline, frame.geometry());
    let grid = frame.sampling.grid();
    let mut framebuffer = Framebuffer::new(grid, raster.width, raster.height, scene.background, settings);
    let mut watch = AssertionObserver::new(recipe, frame, wanted);
    let count = geometry.triangles.len();
    let sorted_from = geometry.sorted_from(settings);
    let mut next = 0;
    while next < count {
        control.check()?;
        (control.progress)(next as f32 / count as f32);
        let whole = Scissor::full(raster.width, raster.height);
        if next < sorted_from {
            let end = next + drawn_at_once(&geometry.triangles[next..sorted_from], raster);
            let triangles = next..end;
            next = triangles.end;
            let extent = Extent { triangles, scissor: whole };
            DrawCall::new(scene, geometry, settings, &extent).draw(&mut framebuffer, &mut watch);
            continue;
        }
        // Depth-sorted fragments cannot be drawn in batches of triangles, but rows are independent of each other.
        for top in (0..raster.height).step_by(ROWS_AT_ONCE) {
            let drawn = f64::from(top) / f64::from(raster.height) * (count - next) as f64;
            (control.progress)((next as f64 + drawn) as f32 / count as f32);
            control.check()?;
            let scissor = Scissor { top, bottom: (top + ROWS_AT_ONCE as u32).min(raster.height), ..whole };
            let extent = Extent { triangles: next..count, scissor };
            DrawCall::new(scene, geometry, settings, &extent).draw(&mut framebuffer, &mut watch);
        }
        next = count;
    }
    let mut report = watch.report();
    if let Some(finding) = report.findings.iter_mut().find(|finding| finding.assertion == Assertion::Junctions) {
        *finding = junctions::check(scene, recipe, frame, &Seams::find(scene, control.cancel)?);
    }
    Some(report)
}

/// Returns the number of leading triangles to draw in one batch; 0 only for an empty slice.
fn drawn_at_once(triangles: &[ScreenTriangle], viewport: Viewport) -> usize {
    let mut pixels = 0;
    let most = triangles.len().min(TRIANGLES_AT_ONCE);
    let last = triangles[..most].iter().position(|triangle| {
        pixels += box_pixels(triangle, viewport);
        pixels > PIXELS_AT_ONCE
    });
    last.map_or(most, |last| last + 1)
}

/// Returns the approximate number of pixels of the picture that a triangle's bounding box contains, at least 1.
fn box_pixels(triangle: &ScreenTriangle, viewport: Viewport) -> u64 {
    let [left, right, top, bottom] = box_around(triangle.corners_px());
    let side = |least: f32, greatest: f32, size: u32| (greatest.min(size as f32) - least.max(0.0)).max(0.0) as u64 + 1;
    side(left, right, viewport.width) * side(top, bottom, viewport.height)
}

#[cfg(test)]
mod tests;
