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

/// Surfaces of the pixels of a row, and their motion vectors.
struct SurfaceRow<'a> {
    distance: &'a [f32],
    across_px: &'a [f32],
    down_px: &'a [f32],
    visible: &'a [u8],
}

impl SurfaceRow<'_> {
    /// Replaces the nearest surface of a column by that of this row if it is nearer.
    #[inline(always)]
    fn replace(&self, index: usize, nearest: &mut Nearest) {
        if self.distance[index] < nearest.distance {
            *nearest = self.at(index);
        }
    }

    /// Returns the surface of a pixel. Its vector is not a number if the previous frame does not show the surface.
    #[inline(always)]
    fn at(&self, index: usize) -> Nearest {
        let is_visible = self.visible[index] == MotionVectors::VISIBLE;
        Nearest {
            distance: self.distance[index],
            across_px: if is_visible { self.across_px[index] } else { f32::NAN },
            down_px: self.down_px[index],
        }
    }
}

/// Nearest surface of a column.
#[derive(Clone, Copy)]
struct Nearest {
    distance: f32,
    across_px: f32,
    down_px: f32,
}

impl DilatedVectors {
    /// Returns buffers for rows of `width` pixels.
    pub(in crate::upscale) fn new(width: u32) -> Self {
        let [distance, across_px, down_px] = [0, 1, 2].map(|_| vec![0.0; width as usize + 2 + WIDE]);
        Self { distance, across_px, down_px }
    }

    /// Finds the nearest surfaces for a range of pixels of row `y`.
    #[inline(always)]
    pub(in crate::upscale) fn fill(
        &mut self,
        gbuffer: &GBuffer,
        vectors: &MotionVectors,
        (columns, y): (&Range<usize>, u32),
    ) {
        let (width, height) = gbuffer.distance.size();
        let width = width as usize;
        let read = columns.start.saturating_sub(1)..(columns.end + 1).min(width);
        let [at, above, below] = [y, y.saturating_sub(1), (y + 1).min(height - 1)].map(|row| SurfaceRow {
            distance: &gbuffer.distance.row(row)[read.clone()],
            across_px: &vectors.across_px.row(row)[read.clone()],
            down_px: &vectors.down_px.row(row)[read.clone()],
            visible: &vectors.visible.row(row)[read.clone()],
        });
        let stored = read.start + 1..read.end + 1;
        let (distance, across_px, down_px) =
            (&mut self.distance[stored.clone()], &mut self.across_px[stored.clone()], &mut self.down_px[stored]);
        for index in 0..read.len() {
            let mut nearest = at.at(index);
            above.replace(index, &mut nearest);
            below.replace(index, &mut nearest);
            (distance[index], across_px[index], down_px[index]) =
                (nearest.distance, nearest.across_px, nearest.down_px);
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
