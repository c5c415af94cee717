//! Anisotropic texture filter for sixteen samples. The arithmetic is the same as in [`MipFilter::reads`] and
//! [`TextureReads::position`], operation by operation, and in the mean over the probes in [`crate::pipeline::shade`].
//!
//! [`MipFilter::reads`]: crate::pipeline::footprint::MipFilter::reads
//! [`TextureReads::position`]: crate::pipeline::footprint::TextureReads::position

use super::gather::Taps;
use super::mipmap::{CoarseTaps, Coordinates, LevelTaps, longest_squared};
use super::texture::{Layout, TextureReader};
use crate::math::lanes::*;
use crate::pipeline::footprint::RATIO_TOLERANCE;

/// Probes that each of sixteen samples takes along the major axis of its footprint.
struct ProbesOfEach<S: Simd> {
    /// Number of probes, a whole number from 1.
    count: f32x16<S>,
    /// Major axis, in texture coordinates. Arbitrary for a single probe.
    major_axis: [f32x16<S>; 2],
    /// Squared length of the part of the footprint that a probe covers, in texels².
    squared_length: f32x16<S>,
}

impl TextureReader<'_> {
    /// Filters the texture for sixteen samples, and stores the result in `out`.
    #[inline(never)]
    pub(super) fn filter_along_axis<S: Simd>(
        &self,
        simd: S,
        layout: Layout,
        at: &Coordinates<S>,
        out: &mut CoarseTaps,
    ) {
        simd.vectorize(
            #[inline(always)]
            || self.mean_of_probes(simd, layout, at, out),
        );
    }

    #[inline(always)]
    fn mean_of_probes<S: Simd>(&self, simd: S, layout: Layout, at: &Coordinates<S>, out: &mut CoarseTaps) {
        let probes = self.probes(simd, at.gradient);
        let levels = self.two_levels(simd, self.level(simd, probes.squared_length));
        let most = probes.count.to_array().into_iter().fold(1.0, f32::max) as u32;
        let mut fine = Taps::default();
        for probe in 0..most {
            let uv = probes.position(simd, at.uv, probe);
            self.locate_in_level(simd, uv, &levels.finer, &mut fine);
            self.locate_in_coarser(simd, uv, &levels, out);
            let is_taken = probes.count.simd_gt(f32x16::splat(simd, probe as f32));
            let read = self.read_sixteen(simd, layout, LevelTaps { fine: &fine, coarse: Some(out) });
            for (stored, read) in out.filtered.iter_mut().zip(read) {
                let sum = f32x16::load_array_ref(simd, stored);
                let sum = if probe == 0 { read } else { is_taken.select(sum + read, sum) };
                sum.store_array(stored);
            }
        }
        if most > 1 {
            for sum in &mut out.filtered {
                (f32x16::load_array_ref(simd, sum) / probes.count).store_array(sum);
            }
        }
    }

    /// Reads and mixes both levels for sixteen samples.
    #[inline(always)]
    fn read_sixteen<S: Simd>(&self, simd: S, layout: Layout, taps: LevelTaps<'_>) -> [f32x16<S>; 4] {
        if self.mixes_light() {
            return self.read_levels_linear(simd, layout, taps);
        }
        let mut sixteen = [[0.0; WIDE]; 4];
        for first in (0..WIDE).step_by(S::f32s::LEN) {
            let read = self.read_levels_bytes(simd, layout, taps, first);
            for channel in 0..4 {
                read[channel].store_slice(&mut sixteen[channel][first..first + S::f32s::LEN]);
            }
        }
        each!(channel in [0, 1, 2, 3] => f32x16::load_array_ref(simd, &sixteen[channel]))
    }

    /// Returns the probes for footprints with these gradients of the texture coordinates.
    #[inline(always)]
    fn probes<S: Simd>(&self, simd: S, gradient: [[f32x16<S>; 2]; 2]) -> ProbesOfEach<S> {
        let texels @ [right, down] = self.in_texels(gradient);
        let a = right[0] * right[0] + right[1] * right[1];
        let b = right[0] * down[0] + right[1] * down[1];
        let c = down[0] * down[0] + down[1] * down[1];
        let half_difference = (a - c) * 0.5;
        let root = (half_difference * half_difference + b * b).sqrt();
        let major_squared = (a + c) * 0.5 + root;
        let ratio = major_squared / (right[0] * down[1] - right[1] * down[0]).abs();
        let wanted = (ratio - RATIO_TOLERANCE).ceil().min(major_squared.sqrt().ceil()).min(self.max_probes as f32);
        let one = f32x16::splat(simd, 1.0);
        // False if the ratio is not a number.
        let has_ratio = ratio.simd_ge(f32x16::splat(simd, 0.0));
        let is_several = major_squared.is_finite() & has_ratio & wanted.simd_gt(one);
        let is_wide = a.simd_ge(c);
        let direction = [is_wide.select(half_difference + root, b), is_wide.select(b, root - half_difference)];
        let length = (direction[0] * direction[0] + direction[1] * direction[1]).sqrt();
        let direction = each!(axis in [0, 1] => direction[axis] / length);
        ProbesOfEach {
            count: is_several.select(wanted, one),
            major_axis: each!(axis in [0, 1] => gradient[0][axis] * direction[0] + gradient[1][axis] * direction[1]),
            squared_length: is_several.select(major_squared / (wanted * wanted), longest_squared(texels)),
        }
    }
}

impl<S: Simd> ProbesOfEach<S> {
    /// Returns the texture coordinates of a probe of each sample at `uv`. Samples that do not take it stay at `uv`.
    #[inline(always)]
    fn position(&self, simd: S, uv: [f32x16<S>; 2], probe: u32) -> [f32x16<S>; 2] {
        let one = f32x16::splat(simd, 1.0);
        let moves = self.count.simd_gt(one) & self.count.simd_gt(f32x16::splat(simd, probe as f32));
        let offset = f32x16::splat(simd, (2 * probe + 1) as f32) / (self.count * 2.0) - 0.5;
        each!(axis in [0, 1] => moves.select(uv[axis] + self.major_axis[axis] * offset, uv[axis]))
    }
}
