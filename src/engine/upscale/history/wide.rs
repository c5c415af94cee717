//! SIMD version of [`Motion::reproject`] for eight pixels of a row, with bit-identical results.

use std::ops::Range;

use super::{Lens, Motion, SAME_DISTANCE, ViewChange};
use crate::math::lanes::*;

/// Index that marks a pixel that was not visible in the previous frame.
pub(in crate::upscale) const NOT_VISIBLE: u32 = u32::MAX;

/// Reprojected positions of eight pixels: indices of the four pixels around each, and bilinear weights.
pub(in crate::upscale) struct ReprojectedLanes<S: Simd> {
    /// Index of the upper left of the four history pixels to interpolate; [`NOT_VISIBLE`] if the reprojected pixel was
    /// not visible.
    pub(crate) upper: u32x8<S>,
    /// Index of the lower left of the four history pixels to interpolate; meaningless if the reprojected pixel was not
    /// visible.
    pub(crate) lower: u32x8<S>,
    /// Index step from left to right: 1, or 0 at the border.
    pub(crate) step: u32x8<S>,
    /// Bilinear weights of the right and the lower pixels, in [0, 1).
    pub(crate) right: F32<S>,
    pub(crate) down: F32<S>,
}

/// Returns a mask of the 16 pixel pairs that show the same object at about the same distance, bit-identical to
/// [`super::GBuffer::same_surface`].
#[inline(always)]
pub(in crate::upscale) fn same_surface<S: Simd>(
    (object, distance): (u32x16<S>, f32x16<S>),
    (other, there): (u32x16<S>, f32x16<S>),
) -> mask32x16<S> {
    let near = (there - distance).abs().simd_le(distance.abs() * SAME_DISTANCE);
    other.simd_eq(object) & (near | there.simd_eq(distance))
}

impl Motion<'_> {
    /// Whether the camera is unchanged, so that every pixel maps to itself.
    pub(in crate::upscale) fn is_still(&self) -> bool {
        self.path.is_none()
    }

    /// Returns the horizontal view-space offsets of `columns` for [`Self::find`], padded to whole vectors. The list is
    /// empty if the camera is unchanged.
    pub(in crate::upscale) fn across(&self, columns: impl Iterator<Item = u32>) -> Vec<f64> {
        let Some(ViewChange { lenses: [from, _], .. }) = &self.path else { return Vec::new() };
        let mut across: Vec<f64> = columns.map(|x| from.right_of(f64::from(x) + 0.5)).collect();
        across.resize(across.len().next_multiple_of(WIDE), 0.0);
        across
    }

    /// Reprojects up to eight adjacent pixels of a row; see [`Self::find`].
    #[inline(always)]
    pub(in crate::upscale) fn find_part<S: Simd>(
        &self,
        simd: S,
        (columns, y): (Range<usize>, u32),
        across: &[f64; LANES],
    ) -> ReprojectedLanes<S> {
        let (objects, distances) =
            (&self.gbuffer.object.row(y)[columns.clone()], &self.gbuffer.distance.row(y)[columns]);
        // Unused lanes hold NaN, which is never visible in the previous frame.
        let (mut object, mut distance) = ([[0; 4]; LANES], [f32::NAN; LANES]);
        let (objects, distances) = match (objects.first_chunk(), distances.first_chunk()) {
            (Some(objects), Some(distances)) => (objects, distances),
            _ => {
                object[..objects.len()].copy_from_slice(objects);
                distance[..distances.len()].copy_from_slice(distances);
                (&object, &distance)
            }
        };
        let object = u8x32::from_slice(simd, objects.as_flattened()).bitcast::<u32x8<S>>();
        self.find(simd, y, across, (object, F32::load_array_ref(simd, distances)))
    }

    /// Reprojects eight pixels of row `y`, given the objects and distances that they show. `across` holds the results
    /// of [`Self::across`] for their columns. Image width and height must be at most 2²⁴ px.
    #[inline(always)]
    pub(in crate::upscale) fn find<S: Simd>(
        &self,
        simd: S,
        y: u32,
        across: &[f64; LANES],
        (object, distance): (u32x8<S>, F32<S>),
    ) -> ReprojectedLanes<S> {
        let nowhere = u32x8::splat(simd, NOT_VISIBLE);
        let nought = F32::splat(simd, 0.0);
        let Some(path) = &self.path else {
            return ReprojectedLanes { upper: nowhere, lower: nowhere, step: nowhere, right: nought, down: nought };
        };
        let ([x, y], expected) = path.moved_lanes(simd, y, across, widen(simd, distance));
        let (width, height) = (f64::from(self.size.0), f64::from(self.size.1));
        let zero = F64::splat(simd, 0.0);
        // NaN fails every comparison, so it is not inside.
        let inside = expected.simd_gt(zero)
            & x.simd_ge(zero)
            & x.simd_lt(F64::splat(simd, width))
            & y.simd_ge(zero)
            & y.simd_lt(F64::splat(simd, height));
        let (x, y) = (inside.select(x, zero), inside.select(y, zero));
        let pixel = (whole(simd, y.floor()) * self.size.0 + whole(simd, x.floor())).to_array();
        let (mut objects, mut distances) = ([0; LANES], [0.0; LANES]);
        let surfaces = &self.history.surfaces;
        let (all_objects, all_distances) = (surfaces.object.pixels(), surfaces.distance.pixels());
        for lane in 0..LANES {
            let at = pixel[lane] as usize;
            (objects[lane], distances[lane]) = (u32::from_le_bytes(all_objects[at]), all_distances[at]);
        }
        let (there, expected) = (F32::load_array(simd, distances), narrow(simd, expected));
        let near = (there - expected).abs().simd_le(expected.abs() * SAME_DISTANCE) | there.simd_eq(expected);
        let is_inside = narrow(simd, inside.select(F64::splat(simd, 1.0), zero)).simd_gt(nought);
        let same = u32x8::load_array(simd, objects).simd_eq(object) & near & is_inside;

        let ((left, next, right), (top, bottom, down)) = (between(simd, x, width), between(simd, y, height));
        ReprojectedLanes {
            upper: same.select(top * self.size.0 + left, nowhere),
            lower: bottom * self.size.0 + left,
            step: next - left,
            right,
            down,
        }
    }
}

/// Converts non-negative integers stored as `f64` to 32-bit integers.
#[inline(always)]
fn whole<S: Simd>(simd: S, number: F64<S>) -> u32x8<S> {
    narrow(simd, number).to_int::<i32x8<S>>().bitcast()
}

/// Returns the indices of the pixels whose centres lie before and after each position along an axis of `length` px, and
/// the interpolation weights.
#[inline(always)]
fn between<S: Simd>(simd: S, place: F64<S>, length: f64) -> (u32x8<S>, u32x8<S>, F32<S>) {
    let from = place - 0.5;
    let floor = from.floor();
    let [first, second] = each!(at in [floor, floor + 1.0] => whole(simd, clamp_f64(at, 0.0, length - 1.0)));
    (first, second, narrow(simd, from - floor))
}

impl ViewChange {
    /// Transforms the positions and distances of eight pixels into the previous view, like [`ViewChange::moved`]. The
    /// caller must reject points behind the eye and non-finite results.
    #[inline(always)]
    fn moved_lanes<S: Simd>(
        &self,
        simd: S,
        row: u32,
        across: &[f64; LANES],
        distance: F64<S>,
    ) -> ([F64<S>; 2], F64<S>) {
        let [from, to] = &self.lenses;
        let spread = from.spread(simd, distance);
        let right = F64::load_array_ref(simd, across) * spread;
        let up = spread * from.up_of(f64::from(row) + 0.5);
        let [a, b, c, d] = self.to_from.to_cols_array_2d();
        // In the order of the scalar matrix–vector product.
        let [x, y, z] = each!(axis in [0, 1, 2] => {
            ((right * a[axis] + up * b[axis]) - distance * c[axis]) + d[axis]
        });
        let distance = -z;
        let spread = to.spread(simd, distance);
        let (across, up) = (x / (spread * to.half[0]), y / (spread * to.half[1]));
        let place = [(across + 1.0) * 0.5 * to.size[0], (F64::splat(simd, 1.0) - up) * 0.5 * to.size[1]];
        (place, distance)
    }
}

impl Lens {
    #[inline(always)]
    fn spread<S: Simd>(&self, simd: S, distance: F64<S>) -> F64<S> {
        if self.in_perspective { distance } else { F64::splat(simd, 1.0) }
    }
}
