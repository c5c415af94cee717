//! Motion vectors of the nearest surfaces around the pixels of a row.

use std::ops::Range;

use crate::math::lanes::*;
use crate::pipeline::gbuffer::GBuffer;
use crate::pipeline::motion::MotionVectors;
use crate::upscale::quads::window;

/// For every pixel of a row, the motion vector of the nearest surface among the 3 × 3 pixels around it, so that the
/// anti-aliased edge of an object moves with the object (Karis, 2014). Gives the vectors of the pixels that
/// [`GBuffer::nearest_around`] finds.
pub(in crate::upscale) struct DilatedVectors {
    /// Nearest of three pixels of each column, and its motion vector. Column `x` is at index `x + 1`; the first and the
    /// last column are repeated.
    distance: Vec<f32>,
    across_px: Vec<f32>,
    down_px: Vec<f32>,
}

/// Surfaces of sixteen pixels of a row, and their motion vectors. That of a surface that the previous frame does not
/// show is not a number.
#[derive(Clone, Copy)]
struct Surfaces<S: Simd> {
    distance: f32x16<S>,
    across_px: f32x16<S>,
    down_px: f32x16<S>,
}

impl<S: Simd> Surfaces<S> {
    /// Loads the pixels of row `y` that begin at column `from`. Those beyond its end are arbitrary.
    #[inline(always)]
    fn load(simd: S, gbuffer: &GBuffer, vectors: &MotionVectors, (from, y): (usize, u32)) -> Self {
        let [distance, across_px, down_px] = each!(image in [&gbuffer.distance, &vectors.across_px, &vectors.down_px] => {
            f32x16::load_array(simd, padded(&image.row(y)[from..], 0.0))
        });
        let mut visible = [0; WIDE];
        for (wide, byte) in visible.iter_mut().zip(padded::<WIDE, u8>(&vectors.visible.row(y)[from..], 0)) {
            *wide = u32::from(byte);
        }
        let is_visible =
            u32x16::load_array(simd, visible).simd_eq(u32x16::splat(simd, u32::from(MotionVectors::VISIBLE)));
        Self { distance, across_px: is_visible.select(across_px, f32x16::splat(simd, f32::NAN)), down_px }
    }

    /// Replaces surfaces by those that are nearer.
    #[inline(always)]
    fn or_nearer(self, other: Self) -> Self {
        let is_nearer = other.distance.simd_lt(self.distance);
        Self {
            distance: is_nearer.select(other.distance, self.distance),
            across_px: is_nearer.select(other.across_px, self.across_px),
            down_px: is_nearer.select(other.down_px, self.down_px),
        }
    }
}

impl DilatedVectors {
    /// Returns buffers for rows of `width` pixels.
    pub(in crate::upscale) fn new(width: u32) -> Self {
        let [distance, across_px, down_px] = [0, 1, 2].map(|_| vec![0.0; width as usize + 2 + WIDE]);
        Self { distance, across_px, down_px }
    }

    /// Finds the nearest surfaces for a range of pixels of row `y`.
    #[inline(always)]
    pub(in crate::upscale) fn fill<S: Simd>(
        &mut self,
        simd: S,
        gbuffer: &GBuffer,
        vectors: &MotionVectors,
        (columns, y): (&Range<usize>, u32),
    ) {
        let (width, height) = gbuffer.distance.size();
        let width = width as usize;
        let read = columns.start.saturating_sub(1)..(columns.end + 1).min(width);
        let rows = [y, y.saturating_sub(1), (y + 1).min(height - 1)];
        for from in read.clone().step_by(WIDE) {
            let [at, above, below] = each!(i in [0, 1, 2] => Surfaces::load(simd, gbuffer, vectors, (from, rows[i])));
            let nearest = at.or_nearer(above).or_nearer(below);
            for (stored, numbers) in [
                (&mut self.distance, nearest.distance),
                (&mut self.across_px, nearest.across_px),
                (&mut self.down_px, nearest.down_px),
            ] {
                numbers.store_slice(&mut stored[from + 1..][..WIDE]);
            }
        }
        for numbers in [&mut self.distance, &mut self.across_px, &mut self.down_px] {
            if read.start == 0 {
                numbers[0] = numbers[1];
            }
            if read.end == width {
                numbers[width + 1] = numbers[width];
            }
        }
    }

    /// Returns the motion vectors of 16 pixels from column `from` on, in pixels to the right and downwards. Those of
    /// surfaces that the previous frame does not show are not numbers.
    #[inline(always)]
    pub(in crate::upscale) fn load<S: Simd>(&self, simd: S, from: usize) -> [f32x16<S>; 2] {
        let [left, mut nearest, right] = each!(by in [0, 1, 2] => {
            each!(numbers in [&self.distance, &self.across_px, &self.down_px] => {
                f32x16::load_array_ref(simd, window(numbers, from + by))
            })
        });
        for other in [left, right] {
            let is_nearer = other[0].simd_lt(nearest[0]);
            nearest = each!(i in [0, 1, 2] => is_nearer.select(other[i], nearest[i]));
        }
        let [_, across_px, down_px] = nearest;
        [across_px, down_px]
    }
}
