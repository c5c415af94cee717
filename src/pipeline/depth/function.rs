//! Depth as a function of the sample, set up once per triangle.
//!
//! z/w is an affine function of the screen, so it is interpolated with the edge values themselves, never with the
//! perspective-correct weights. A depth that is linear in space is interpolated with just those. Both take the form of the
//! least depth plus what lies above it at the corners, each with a weight that is not negative: nothing cancels, a constant
//! depth is returned exactly, and no sample inside leaves the range of the corners. A depth bias is added to the least depth. It is computed in f64 and rounded once.

use super::DepthEncoding;
use crate::pipeline::raster::Sample;
use crate::pipeline::viewport::ScreenTriangle;

/// Depth over the samples of one triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthFunction {
    course: Course,
    encoding: DepthEncoding,
    /// The least of the corners' depths, after the depth bias.
    least: f64,
    /// Depth of each corner above the least; per unit of its edge value where depth is affine on the screen.
    rises: [f64; 3],
}

/// What depth is linear in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Course {
    /// The screen.
    Screen,
    /// Space.
    Space,
}

impl DepthFunction {
    /// From depths at the corners of a triangle of this doubled area, in the unit of edge values.
    pub fn affine_on_screen(corners: [f64; 3], doubled_area: f64, encoding: DepthEncoding) -> Self {
        let (least, rises) = rises(corners);
        Self { course: Course::Screen, encoding, least, rises: rises.map(|rise| rise / doubled_area) }
    }

    /// From depths at corners at any distances.
    pub fn linear_in_space(corners: [f64; 3], encoding: DepthEncoding) -> Self {
        let (least, rises) = rises(corners);
        Self { course: Course::Space, encoding, least, rises }
    }

    /// The same with an offset added to all depths.
    #[inline(always)]
    pub(super) fn offset_by(self, offset: f64) -> Self {
        Self { least: self.least + offset, ..self }
    }

    /// Whether depth is linear in space rather than on the screen.
    pub(crate) fn is_linear_in_space(&self) -> bool {
        self.course == Course::Space
    }

    /// The least depth, and per corner what multiplies its edge value (or, where depth is linear in space, its weight).
    #[inline(always)]
    pub(crate) fn terms(&self) -> (f64, [f64; 3]) {
        (self.least, self.rises)
    }
}

/// The least depth, and each above it.
fn rises(corners: [f64; 3]) -> (f64, [f64; 3]) {
    let least = corners[0].min(corners[1]).min(corners[2]);
    (least, corners.map(|depth| depth - least))
}

/// Depth of a covered sample, as it is stored.
#[inline]
pub fn depth_at(triangle: &ScreenTriangle, sample: &Sample) -> f32 {
    triangle.depth.encoding.quantize(unquantised_depth_at(triangle, sample))
}

/// Depth of a covered sample before it is quantised, in [0, 1].
#[inline]
pub(crate) fn unquantised_depth_at(triangle: &ScreenTriangle, sample: &Sample) -> f64 {
    let DepthFunction { course, least, rises, .. } = triangle.depth;
    let weighted = |[a, b, c]: [f64; 3]| a * rises[0] + b * rises[1] + c * rises[2];
    let rise = match course {
        Course::Screen => weighted(sample.edges),
        Course::Space => {
            let [a, b, c] = triangle.vertices.each_ref().map(|v| f64::from(v.inv_w));
            // Beyond an edge, where arithmetic that is not exact finds samples too, distances would run to infinity and back.
            let [e0, e1, e2] = sample.edges.map(|edge| edge.max(0.0));
            let weights = [e0 * a, e1 * b, e2 * c];
            let sum = weights[0] + weights[1] + weights[2];
            // Floats may see no edge value above 0 at all.
            if sum > 0.0 { weighted(weights) / sum } else { 0.0 }
        }
    };
    (least + rise).clamp(0.0, 1.0)
}
