//! SIMD version of [`super::Motion::reproject_by`] for eight pixels, with bit-identical results.

use crate::math::lanes::*;
use crate::pipeline::gbuffer::SAME_DISTANCE;

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

/// Visible surfaces of 16 pixels.
#[derive(Clone, Copy)]
pub(in crate::upscale) struct SurfaceLanes<S: Simd> {
    pub(in crate::upscale) object: u32x16<S>,
    pub(in crate::upscale) distance: f32x16<S>,
}

impl<S: Simd> SurfaceLanes<S> {
    /// Returns a mask of the 16 pixel pairs that show the same object at about the same distance, bit-identical to
    /// [`crate::pipeline::gbuffer::GBuffer::same_surface`].
    #[inline(always)]
    pub(in crate::upscale) fn same_surface(self, other: Self) -> mask32x16<S> {
        let near = (other.distance - self.distance).abs().simd_le(self.distance.abs() * SAME_DISTANCE);
        other.object.simd_eq(self.object) & (near | other.distance.simd_eq(self.distance))
    }

    /// Returns the surfaces of `self` selected by a mask, and of `other` elsewhere.
    #[inline(always)]
    pub(in crate::upscale) fn select(self, other: Self, mask: mask32x16<S>) -> Self {
        Self { object: mask.select(self.object, other.object), distance: mask.select(self.distance, other.distance) }
    }
}

/// Motion vectors of a group of pixels, and whether the previous frame shows them.
pub(in crate::upscale) struct VectorLanes<S: Simd> {
    /// Columns of the pixels.
    pub(crate) column: F32<S>,
    /// Row of the pixels.
    pub(crate) row: F32<S>,
    pub(crate) across_px: F32<S>,
    pub(crate) down_px: F32<S>,
    /// Not zero where the previous frame shows the pixel's surface.
    pub(crate) visible: u32x8<S>,
}

impl<S: Simd> VectorLanes<S> {
    /// Returns the positions of the pixels in the previous frame, a picture of `width` × `height` px.
    #[inline(always)]
    pub(in crate::upscale) fn reproject(&self, simd: S, (width, height): (u32, u32)) -> ReprojectedLanes<S> {
        let place = [self.column + 0.5 + self.across_px, self.row + 0.5 + self.down_px];
        let ((left, next, right), (top, bottom, down)) =
            (between(simd, place[0], width), between(simd, place[1], height));
        let zero = F32::splat(simd, 0.0);
        let [across, down_inside] = each!(axis in [0, 1] => {
            let length = F32::splat(simd, [width, height][axis] as f32);
            place[axis].simd_ge(zero) & place[axis].simd_lt(length)
        });
        let is_visible = !self.visible.simd_eq(u32x8::splat(simd, 0)) & across & down_inside;
        ReprojectedLanes {
            upper: is_visible.select(top * width + left, u32x8::splat(simd, NOT_VISIBLE)),
            lower: bottom * width + left,
            step: next - left,
            right,
            down,
        }
    }
}

/// Returns the indices of the pixels whose centres lie before and after each position along an axis of `length` px, and
/// the interpolation weights. Positions that are not finite give arbitrary indices within the axis.
#[inline(always)]
fn between<S: Simd>(simd: S, place: F32<S>, length: u32) -> (u32x8<S>, u32x8<S>, F32<S>) {
    let from = place - 0.5;
    let floor = from.floor();
    let last = F32::splat(simd, (length - 1) as f32);
    let zero = F32::splat(simd, 0.0);
    let [first, second] =
        each!(at in [floor, floor + 1.0] => at.max(zero).min(last).to_int::<i32x8<S>>().bitcast::<u32x8<S>>());
    (first, second, from - floor)
}
