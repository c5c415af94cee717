//! Depth as a function of the sample, set up once per triangle.
//!
//! z/w is an affine function of the screen, so it is interpolated with the edge values themselves, never with the
//! perspective-correct weights. A depth that is linear in space is interpolated with just those. Both take the form of the
//! least depth plus what lies above it at the corners, each with a weight that is not negative: nothing cancels, a constant
//! depth is returned exactly, and no sample leaves the range of the corners. It is computed in f64 and rounded once.

use super::DepthEncoding;
use crate::pipeline::raster::Sample;
use crate::pipeline::viewport::ScreenTriangle;

/// Depth over the samples of one triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthFunction {
    course: Course,
    encoding: DepthEncoding,
    /// The least of the corners' depths.
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
        let inverse_area = 1.0 / doubled_area;
        Self { course: Course::Screen, encoding, least, rises: rises.map(|rise| rise * inverse_area) }
    }

    /// From depths at corners at any distances.
    pub fn linear_in_space(corners: [f64; 3], encoding: DepthEncoding) -> Self {
        let (least, rises) = rises(corners);
        Self { course: Course::Space, encoding, least, rises }
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
    let DepthFunction { course, encoding, least, rises } = triangle.depth;
    let weighted = |weights: [f64; 3]| weights[0] * rises[0] + weights[1] * rises[1] + weights[2] * rises[2];
    let edges = sample.edges.map(|e| e as f64);
    let rise = match course {
        Course::Screen => weighted(edges),
        Course::Space => {
            let [a, b, c] = triangle.vertices.each_ref().map(|v| f64::from(v.inv_w));
            let weights = [edges[0] * a, edges[1] * b, edges[2] * c];
            weighted(weights) / (weights[0] + weights[1] + weights[2])
        }
    };
    encoding.quantize((least + rise).max(least).min(1.0))
}
