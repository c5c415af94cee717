//! SIMD reads of mip-mapped textures for sixteen samples: the two mip levels that each sample reads, and the texels in
//! both. The arithmetic is the same as in [`weight_gradient`], [`uv_gradient`] and [`MipFilter::reads`], operation by
//! operation.
//!
//! [`weight_gradient`]: crate::pipeline::interpolate::weight_gradient
//! [`uv_gradient`]: crate::pipeline::interpolate::uv_gradient
//! [`MipFilter::reads`]: crate::pipeline::footprint::MipFilter::reads

use super::axis::{TexelAxis, below_repeated};
use super::gather::Taps;
use super::kernel::AttributeWeights;
use super::record::TriangleSource;
use super::texture::{Images, Layout, TextureReader};
use crate::math::lanes::*;
use crate::math::log2::log2_lanes;
use crate::pipeline::footprint::LEAST_SQUARED_LENGTH;

/// Texture taps of sixteen samples in the coarser of their two mip levels.
#[derive(Clone, Debug, Default)]
#[repr(align(64))]
pub(super) struct CoarseTaps {
    taps: Taps,
    /// Weight of the coarser mip level for each sample.
    share: [f32; WIDE],
    /// Whether the weight is nonzero for any sample. Otherwise the taps are not valid.
    pub(super) is_read: bool,
}

/// Mip level that each of sixteen samples reads, one per lane.
struct LevelOfEach<S: Simd> {
    /// Index of the first texel of each level.
    first: i32x16<S>,
    /// Width and height of each level, in texels.
    size: [i32x16<S>; 2],
}

impl CoarseTaps {
    /// Prefetches the texels of every `step`th of sixteen samples, if the coarser level is read.
    #[inline(always)]
    pub(super) fn prefetch(&self, texture: &TextureReader<'_>, step: usize) {
        if self.is_read {
            texture.prefetch(&self.taps, step);
        }
    }
}

impl TextureReader<'_> {
    /// Computes the texture taps of sixteen samples in two mip levels, like [`TextureReader::locate`]. Not inlined, so
    /// that the code for textures without mip levels stays small.
    #[inline(never)]
    pub(super) fn locate_in_levels<S: Simd>(
        &self,
        simd: S,
        layout: Layout,
        source: impl TriangleSource,
        weights: AttributeWeights<S>,
        (fine, coarse): (&mut Taps, &mut CoarseTaps),
    ) {
        simd.vectorize(
            #[inline(always)]
            || {
                let attributes = source.uv(simd);
                let gradient = weights.gradient(simd, source);
                let gradient =
                    each!(weights in [gradient[0], gradient[1]] => each!(axis in [0, 1] => attributes[axis].change(weights)));
                let uv = each!(axis in [0, 1] => attributes[axis].at(weights.of_corners));
                let level = self.level(simd, gradient);
                let finer: i32x16<S> = level.to_int();
                let share = level - finer.to_float::<f32x16<S>>();
                let [of_fine, of_coarse] = self.two_levels(simd, finer);
                self.locate_in_level(simd, layout, uv, &of_fine, fine);
                // The coarser level need not be read if its weight is zero for all samples: texels are finite and
                // non-negative, so adding it would not change the result, not even the sign of a zero.
                coarse.is_read = !share.simd_eq(0.0).all_true();
                if coarse.is_read {
                    share.store_array(&mut coarse.share);
                    self.locate_in_level(simd, layout, uv, &of_coarse, &mut coarse.taps);
                }
            },
        );
    }

    /// Returns the level of detail (LOD) of each sample, from 0 for the full-size texture to the index of the coarsest
    /// mip level.
    #[inline(always)]
    fn level<S: Simd>(&self, simd: S, gradient: [[f32x16<S>; 2]; 2]) -> f32x16<S> {
        let [right, down] = each!([u, v] in [gradient[0], gradient[1]] => {
            let (x, y) = (u * self.extent[0], v * self.extent[1]);
            x * x + y * y
        });
        let longest = down.simd_gt(right).select(down, right);
        let least = f32x16::splat(simd, LEAST_SQUARED_LENGTH);
        let longest = longest.simd_gt(least).select(longest, least);
        let level = log2_lanes(longest) * 0.5 + self.mip_bias;
        let zero = f32x16::splat(simd, 0.0);
        level.simd_gt(zero).select(level, zero).min((self.levels.len() - 1) as f32)
    }

    /// Returns the mip levels with these indices, and the next coarser levels. The coarsest level is its own successor.
    #[inline(always)]
    fn two_levels<S: Simd>(&self, simd: S, finer: i32x16<S>) -> [LevelOfEach<S>; 2] {
        let finer = finer.to_array();
        let places = each!(lane in [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15] => {
            let level = &self.levels[finer[lane] as usize];
            u32x4::load_array_ref(simd, &level.numbers).bitcast::<f32x4<S>>()
        });
        let columns = transpose_wide(places);
        let [first, next, width, height] = each!(column in [0, 1, 2, 3] => columns[column].bitcast::<i32x16<S>>());
        let halved = each!(side in [width, height] => (side >> 1).max(1));
        [LevelOfEach { first, size: [width, height] }, LevelOfEach { first: next, size: halved }]
    }

    #[inline(always)]
    fn locate_in_level<S: Simd>(
        &self,
        simd: S,
        layout: Layout,
        uv: [f32x16<S>; 2],
        level: &LevelOfEach<S>,
        taps: &mut Taps,
    ) {
        let [width, height] = level.size;
        if layout == Layout::PowerOfTwoQuads
            && let Some([(x, right), (y, down)]) = below_repeated(each!(axis in [0, 1] => {
                uv[axis] * level.size[axis].to_float::<f32x16<S>>()
            }))
        {
            let place = self.place(x & (width - 1), y & (height - 1)) + level.first;
            place.bitcast::<u32x16<S>>().store_array(&mut taps.index[0]);
            right.store_array(&mut taps.right);
            down.store_array(&mut taps.down);
            return;
        }
        let ((u0, u1), (v0, v1)) = (uv[0].split(), uv[1].split());
        let ((first0, first1), (width0, width1), (height0, height1)) =
            (level.first.split(), width.split(), height.split());
        for (uv, (first, width, height), lane) in
            [([u0, v0], (first0, width0, height0), 0), ([u1, v1], (first1, width1, height1), LANES)]
        {
            let axes = each!(length in [width, height] => TexelAxis::of(simd, length));
            let images = Images { first, axes };
            self.locate_eight(simd, layout, &images, uv, taps, lane);
        }
    }

    /// Reads two mip levels with [`TextureReader::read_bytes`] and mixes them. Reads only one level without
    /// mip-mapping.
    #[inline(always)]
    pub(super) fn read_levels_bytes<S: Simd>(
        &self,
        simd: S,
        layout: Layout,
        (fine, coarse): (&Taps, Option<&CoarseTaps>),
        first: usize,
    ) -> [S::f32s; 4] {
        let finer = self.read_bytes(simd, layout, fine, first);
        let Some(coarse) = coarse.filter(|coarse| coarse.is_read) else { return finer };
        let coarser = self.read_bytes(simd, layout, &coarse.taps, first);
        mix(simd, finer, coarser, S::f32s::from_slice(simd, &coarse.share[first..first + S::f32s::LEN]))
    }

    /// Reads the alpha channel of two mip levels and mixes them. Reads only one level without mip-mapping.
    #[inline(always)]
    pub(super) fn read_levels_alpha<S: Simd>(
        &self,
        simd: S,
        layout: Layout,
        taps: (&Taps, Option<&CoarseTaps>),
    ) -> f32x16<S> {
        if self.mixes_light() {
            let [.., alpha] = self.read_levels_linear(simd, layout, taps);
            return alpha;
        }
        let mut sixteen = [0.0; WIDE];
        for first in (0..WIDE).step_by(S::f32s::LEN) {
            let [.., alpha] = self.read_levels_bytes(simd, layout, taps, first);
            alpha.store_slice(&mut sixteen[first..first + S::f32s::LEN]);
        }
        f32x16::load_array(simd, sixteen)
    }

    /// Reads two mip levels with [`TextureReader::read_linear`] and mixes them. Reads only one level without
    /// mip-mapping.
    #[inline(always)]
    pub(super) fn read_levels_linear<S: Simd>(
        &self,
        simd: S,
        layout: Layout,
        (fine, coarse): (&Taps, Option<&CoarseTaps>),
    ) -> [f32x16<S>; 4] {
        let finer = self.read_linear(simd, layout, fine);
        let Some(coarse) = coarse.filter(|coarse| coarse.is_read) else { return finer };
        let coarser = self.read_linear(simd, layout, &coarse.taps);
        mix(simd, finer, coarser, f32x16::load_array_ref(simd, &coarse.share))
    }
}

/// Mixes two RGBA colours. `share` is the weight of the second one.
#[inline(always)]
fn mix<S: Simd, F: SimdFloat<S, Element = f32>>(simd: S, finer: [F; 4], coarser: [F; 4], share: F) -> [F; 4] {
    let rest = F::splat(simd, 1.0) - share;
    each!(channel in [0, 1, 2, 3] => finer[channel] * rest + coarser[channel] * share)
}
