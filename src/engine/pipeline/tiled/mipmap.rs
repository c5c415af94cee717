//! SIMD reads of mip-mapped textures for sixteen samples: the two mip levels that each sample reads, and the texels in
//! both. The arithmetic is the same as in [`weight_gradient`], [`uv_gradient`] and [`MipFilter::reads`], operation by
//! operation.
//!
//! [`weight_gradient`]: crate::pipeline::interpolate::weight_gradient
//! [`uv_gradient`]: crate::pipeline::interpolate::uv_gradient
//! [`MipFilter::reads`]: crate::pipeline::footprint::MipFilter::reads

use super::axis::{TexelAxis, below_repeated};
use super::gather::Taps;
use super::record::TriangleSource;
use super::texture::{Images, Layout, TextureReader};
use super::weights::AttributeWeights;
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
    /// Filtered texels of sixteen samples by channel, in [0, 1]. Only valid with the anisotropic filter, which reads its
    /// texels at once, because their number differs from sample to sample.
    pub(super) filtered: [[f32; WIDE]; 4],
}

/// Texture taps of sixteen samples in their mip levels.
#[derive(Clone, Copy, Debug)]
pub(super) struct LevelTaps<'a> {
    /// Taps in the finer level, or in the only one.
    pub(super) fine: &'a Taps,
    /// Taps in the coarser level; `None` without mip-mapping.
    pub(super) coarse: Option<&'a CoarseTaps>,
}

/// Texture taps of sixteen samples in their mip levels, to be computed.
#[derive(Debug)]
pub(super) struct LevelTapsMut<'a> {
    /// Taps in the finer level, or in the only one.
    pub(super) fine: &'a mut Taps,
    /// Taps in the coarser level; `None` without mip-mapping.
    pub(super) coarse: Option<&'a mut CoarseTaps>,
}

/// Mip level that each of sixteen samples reads, one per lane.
pub(super) struct LevelOfEach<S: Simd> {
    /// Index of the first texel of each level.
    first: i32x16<S>,
    /// Width and height of each level, in texels.
    size: [i32x16<S>; 2],
}

/// The two mip levels that each of sixteen samples reads.
pub(super) struct TwoLevels<S: Simd> {
    pub(super) finer: LevelOfEach<S>,
    coarser: LevelOfEach<S>,
    /// Weight of the coarser level, in [0, 1).
    share: f32x16<S>,
}

/// Texture coordinates of sixteen samples.
pub(super) struct Coordinates<S: Simd> {
    pub(super) uv: [f32x16<S>; 2],
    /// Changes of u and v per pixel to the right, and per pixel downwards.
    pub(super) gradient: [[f32x16<S>; 2]; 2],
}

impl<S: Simd> Coordinates<S> {
    #[inline(always)]
    pub(super) fn new(simd: S, source: impl TriangleSource, weights: AttributeWeights<S>) -> Self {
        let attributes = source.uv(simd);
        let gradient = weights.gradient(simd, source);
        Self {
            gradient: each!(weights in [gradient[0], gradient[1]] => each!(axis in [0, 1] => attributes[axis].change(weights))),
            uv: each!(axis in [0, 1] => attributes[axis].at(weights.of_corners)),
        }
    }
}

/// Returns the squared length of the longer of two gradients in texels.
#[inline(always)]
pub(super) fn longest_squared<S: Simd>(gradient: [[f32x16<S>; 2]; 2]) -> f32x16<S> {
    let [right, down] = each!([x, y] in [gradient[0], gradient[1]] => x * x + y * y);
    down.simd_gt(right).select(down, right)
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
    /// that the code for textures without mip levels stays small, and all sources of triangles share it.
    #[inline(never)]
    pub(super) fn locate_in_levels<S: Simd>(
        &self,
        simd: S,
        at: &Coordinates<S>,
        fine: &mut Taps,
        coarse: &mut CoarseTaps,
    ) {
        simd.vectorize(
            #[inline(always)]
            || {
                let longest = longest_squared(self.in_texels(at.gradient));
                // Footprints of up to one texel read only the largest level: no logarithm, no places of two levels. On
                // Zen 4, trilinear frames of chess, fence and stained glass at 1080p take 5 to 10 % less time.
                if self.mip_bias <= 0.0 && longest.simd_le(1.0).all_true() {
                    coarse.is_read = false;
                    self.locate(simd, self.layout, at.uv, fine);
                    return;
                }
                let levels = self.two_levels(simd, self.level(simd, longest));
                self.locate_in_level(simd, at.uv, &levels.finer, fine);
                self.locate_in_coarser(simd, at.uv, &levels, coarse);
            },
        );
    }

    /// Computes the texture taps of sixteen samples in their coarser levels, unless these have no weight.
    #[inline(always)]
    pub(super) fn locate_in_coarser<S: Simd>(
        &self,
        simd: S,
        uv: [f32x16<S>; 2],
        TwoLevels { coarser, share, .. }: &TwoLevels<S>,
        coarse: &mut CoarseTaps,
    ) {
        // The coarser level need not be read if its weight is zero for all samples: texels are finite and
        // non-negative, so adding it would not change the result, not even the sign of a zero.
        coarse.is_read = !share.simd_eq(0.0).all_true();
        if coarse.is_read {
            share.store_array(&mut coarse.share);
            self.locate_in_level(simd, uv, coarser, &mut coarse.taps);
        }
    }

    /// Converts the gradients of texture coordinates to texels per pixel.
    #[inline(always)]
    pub(super) fn in_texels<S: Simd>(&self, gradient: [[f32x16<S>; 2]; 2]) -> [[f32x16<S>; 2]; 2] {
        each!([u, v] in [gradient[0], gradient[1]] => [u * self.extent[0], v * self.extent[1]])
    }

    /// Returns the level of detail (LOD) of each sample, from 0 for the full-size texture to the index of the coarsest
    /// mip level. `longest` is the squared length of the footprint, in texels².
    #[inline(always)]
    pub(super) fn level<S: Simd>(&self, simd: S, longest: f32x16<S>) -> f32x16<S> {
        let least = f32x16::splat(simd, LEAST_SQUARED_LENGTH);
        let longest = longest.simd_gt(least).select(longest, least);
        let level = log2_lanes(longest) * 0.5 + self.mip_bias;
        let zero = f32x16::splat(simd, 0.0);
        level.simd_gt(zero).select(level, zero).min((self.levels.count - 1) as f32)
    }

    /// Returns the mip levels below and above each level of detail. The coarsest level is its own successor.
    #[inline(always)]
    pub(super) fn two_levels<S: Simd>(&self, simd: S, level: f32x16<S>) -> TwoLevels<S> {
        let finer = whole_part(level);
        let share = level - float_of(finer);
        let [first, next] = each!(level in [finer, finer + 1] => {
            entries_of_32(simd, &self.levels.first, level).bitcast::<i32x16<S>>()
        });
        let [width, height] = each!(side in [self.size.0, self.size.1] => {
            (u32x16::splat(simd, side) >> finer).max(1).bitcast::<i32x16<S>>()
        });
        let halved = each!(side in [width, height] => (side >> 1).max(1));
        TwoLevels {
            finer: LevelOfEach { first, size: [width, height] },
            coarser: LevelOfEach { first: next, size: halved },
            share,
        }
    }

    /// Computes the texture taps of sixteen samples in one mip level of each.
    #[inline(always)]
    pub(super) fn locate_in_level<S: Simd>(
        &self,
        simd: S,
        uv: [f32x16<S>; 2],
        level: &LevelOfEach<S>,
        taps: &mut Taps,
    ) {
        let [width, height] = level.size;
        if self.layout == Layout::PowerOfTwoQuads
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
            self.locate_eight(simd, &images, uv).store(self.layout, taps, lane);
        }
    }

    /// Returns the filtered texels of as many samples as a register holds, starting at sample `first`, as
    /// [`TextureReader::read_bytes`] does.
    #[inline(always)]
    pub(super) fn filtered_bytes<S: Simd>(
        &self,
        simd: S,
        layout: Layout,
        taps: LevelTaps<'_>,
        first: usize,
    ) -> [S::f32s; 4] {
        match taps.coarse {
            Some(coarse) if self.is_anisotropic() => {
                each!(channel in [0, 1, 2, 3] => S::f32s::from_slice(simd, &coarse.filtered[channel][first..first + S::f32s::LEN]))
            }
            _ => self.read_levels_bytes(simd, layout, taps, first),
        }
    }

    /// Returns the filtered texels of sixteen samples, as [`TextureReader::read_linear`] does.
    #[inline(always)]
    pub(super) fn filtered_linear<S: Simd>(&self, simd: S, layout: Layout, taps: LevelTaps<'_>) -> [f32x16<S>; 4] {
        match taps.coarse {
            Some(coarse) if self.is_anisotropic() => {
                each!(channel in [0, 1, 2, 3] => f32x16::load_array_ref(simd, &coarse.filtered[channel]))
            }
            _ => self.read_levels_linear(simd, layout, taps),
        }
    }

    /// Returns the filtered alpha channel of sixteen samples.
    #[inline(always)]
    pub(super) fn filtered_alpha<S: Simd>(&self, simd: S, layout: Layout, taps: LevelTaps<'_>) -> f32x16<S> {
        if self.mixes_light() {
            let [.., alpha] = self.filtered_linear(simd, layout, taps);
            return alpha;
        }
        let mut sixteen = [0.0; WIDE];
        for first in (0..WIDE).step_by(S::f32s::LEN) {
            let [.., alpha] = self.filtered_bytes(simd, layout, taps, first);
            alpha.store_slice(&mut sixteen[first..first + S::f32s::LEN]);
        }
        f32x16::load_array(simd, sixteen)
    }

    /// Reads two mip levels with [`TextureReader::read_bytes`] and mixes them. Reads only one level without
    /// mip-mapping.
    #[inline(always)]
    pub(super) fn read_levels_bytes<S: Simd>(
        &self,
        simd: S,
        layout: Layout,
        LevelTaps { fine, coarse }: LevelTaps<'_>,
        first: usize,
    ) -> [S::f32s; 4] {
        let finer = self.read_bytes(simd, layout, fine, first);
        let Some(coarse) = coarse.filter(|coarse| coarse.is_read) else { return finer };
        let coarser = self.read_bytes(simd, layout, &coarse.taps, first);
        mix(simd, finer, coarser, S::f32s::from_slice(simd, &coarse.share[first..first + S::f32s::LEN]))
    }

    /// Reads two mip levels with [`TextureReader::read_linear`] and mixes them. Reads only one level without
    /// mip-mapping.
    #[inline(always)]
    pub(super) fn read_levels_linear<S: Simd>(
        &self,
        simd: S,
        layout: Layout,
        LevelTaps { fine, coarse }: LevelTaps<'_>,
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
