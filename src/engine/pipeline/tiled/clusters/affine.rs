//! Affine functions over the bounding boxes of eight clusters.

use glam::{Mat4, Vec4};

use super::super::super::clip_space::ClipPlane;
use super::super::super::vertex::{ROUNDING, UNDERFLOW};
use crate::math::lanes::*;
use crate::scene::clusters::Boxes;

/// Bounding boxes of eight clusters, one per lane.
pub(super) struct EightBoxes<S: Simd> {
    /// Corner with the least x, y and z, in model space.
    least: [F64<S>; 3],
    /// Corner with the greatest x, y and z, in model space.
    greatest: [F64<S>; 3],
    /// Largest magnitude of each coordinate.
    farthest: [F64<S>; 3],
}

impl<S: Simd> EightBoxes<S> {
    #[inline(always)]
    pub(super) fn new(simd: S, boxes: &Boxes) -> Self {
        let [least, greatest] = each!(end in [0, 1] => {
            each!(axis in [0, 1, 2] => widen(simd, F32::load_array(simd, boxes[end][axis])))
        });
        let farthest = each!(axis in [0, 1, 2] => least[axis].abs().max(greatest[axis].abs()));
        Self { least, greatest, farthest }
    }
}

/// An affine function of a model-space position, such as the distance from a plane, with magnitudes that bound its
/// rounding error.
#[derive(Clone, Copy, Debug)]
pub(super) struct Affine {
    coefficients: [f64; 4],
    magnitudes: [f64; 4],
}

impl Affine {
    /// Creates the function that gives the signed distance from a clip plane. `widening`, a power of two, is the factor
    /// by which the side planes are moved outward.
    pub(super) fn distance(plane: ClipPlane, clip_from_model: Mat4, widening: f32) -> Self {
        let columns: [Vec4; 4] = std::array::from_fn(|column| clip_from_model.col(column));
        let factor = f64::from(widening);
        Self {
            coefficients: columns.map(|column| plane.distance(column, widening)),
            magnitudes: columns.map(|column| plane.magnitude(column.abs().as_dvec4()) * factor),
        }
    }

    /// Creates the function that gives a clip-space coordinate, selected by `axis`: 0 to 3 for x, y, z and w.
    pub(super) fn component(axis: usize, clip_from_model: Mat4) -> Self {
        let row = clip_from_model.row(axis).as_dvec4();
        Self { coefficients: row.to_array(), magnitudes: row.abs().to_array() }
    }

    /// Returns the maximum of the exact function over each of eight boxes.
    #[inline(always)]
    pub(super) fn greatest<S: Simd>(&self, simd: S, boxes: &EightBoxes<S>) -> F64<S> {
        self.at_corner(simd, [&boxes.least, &boxes.greatest])
    }

    /// Returns the minimum of the exact function over each of eight boxes.
    #[inline(always)]
    pub(super) fn least<S: Simd>(&self, simd: S, boxes: &EightBoxes<S>) -> F64<S> {
        self.at_corner(simd, [&boxes.greatest, &boxes.least])
    }

    /// Returns the function at one corner of each of eight boxes. The coordinates of the corner are taken from `falling`
    /// where the function decreases along the axis, and from `rising` where it increases.
    #[inline(always)]
    fn at_corner<S: Simd>(&self, simd: S, [falling, rising]: [&[F64<S>; 3]; 2]) -> F64<S> {
        let mut sum = F64::splat(simd, self.coefficients[3]);
        for axis in 0..3 {
            let corner = if self.coefficients[axis] > 0.0 { rising[axis] } else { falling[axis] };
            sum += corner * self.coefficients[axis];
        }
        sum
    }

    /// Returns an upper bound on the sum of the magnitudes of the function's terms in each of eight boxes.
    #[inline(always)]
    pub(super) fn magnitude<S: Simd>(&self, simd: S, boxes: &EightBoxes<S>) -> F64<S> {
        let [x, y, z, one] = self.magnitudes;
        let [far_x, far_y, far_z] = boxes.farthest;
        far_x * x + far_y * y + far_z * z + F64::splat(simd, one)
    }

    /// Returns, for each of eight boxes, a bound on the difference between the function value that the pipeline
    /// computes and the exact one.
    #[inline(always)]
    pub(super) fn slack<S: Simd>(&self, simd: S, boxes: &EightBoxes<S>) -> F64<S> {
        self.magnitude(simd, boxes) * ROUNDING + UNDERFLOW
    }
}

/// Clip planes that clusters are tested against. The eye plane is redundant next to the depth planes, because z ≥ 0 and
/// z ≤ w imply w ≥ 0.
pub(super) const PLANES: [ClipPlane; 6] =
    [ClipPlane::Near, ClipPlane::Far, ClipPlane::Left, ClipPlane::Right, ClipPlane::Bottom, ClipPlane::Top];
