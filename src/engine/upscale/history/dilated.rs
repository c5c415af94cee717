//! Motion vectors of the nearest surfaces around the pixels of a row.

use std::ops::Range;

use super::FrameInputs;
use super::surface_grid::{Around, SurfaceGrid};
use crate::math::lanes::*;
use crate::pipeline::gbuffer::GBuffer;
use crate::pipeline::motion::MotionVectors;
use crate::upscale::planes::SampleLanes;
use crate::upscale::quads::{window, with_spare};
use crate::upscale::row_parts::{RowBlock, RowSpan};

/// Motion vector of the nearest surface around every output pixel of a row. An anti-aliased edge thus moves with its object
/// (Karis, 2014).
///
/// In a G-buffer with the pixels of the full picture, the surfaces are those of 3 × 3 pixels. Otherwise, they are those of
/// the 2 × 2 pixels around the output pixel: 3 × 3 would move more of the background than is anti-aliased.
pub(in crate::upscale) struct DilatedVectors {
    grid: SurfaceGrid,
    /// `None` if the G-buffer has the pixels of the full picture.
    columns: Option<ColumnPairs>,
    /// Rows of the G-buffer, and pixels of these rows, that the buffers below hold.
    holds: Option<(Around, Range<usize>)>,
    /// Nearest of the pixels of each column of these rows, and its motion vector. Column `x` is at index `x + 1`; the first
    /// and the last column are repeated.
    distance: Vec<f32>,
    across_px: Vec<f32>,
    down_px: Vec<f32>,
}

/// Columns of a G-buffer to the left and to the right of every output column, as indices of the buffers of
/// [`DilatedVectors`]. Sixteen can be loaded from every output column.
struct ColumnPairs {
    left: Vec<u32>,
    right: Vec<u32>,
    /// 1 if the right column is closer to the output column than the left one, otherwise 0.
    is_right_closer: Vec<f32>,
}

impl ColumnPairs {
    fn new(grid: &SurfaceGrid, width: u32) -> Option<Self> {
        let all = (0..width).map(|x| grid.left_and_right(x)).collect::<Option<Vec<_>>>()?;
        Some(Self {
            left: with_spare(&all, |([left, _], _)| left + 1),
            right: with_spare(&all, |([_, right], _)| right + 1),
            is_right_closer: with_spare(&all, |(_, is_right_closer)| f32::from(u8::from(*is_right_closer))),
        })
    }
}

/// Surfaces of sixteen pixels of a row of a G-buffer, and their motion vectors. The vector of a surface that the previous
/// frame does not show is NaN.
#[derive(Clone, Copy)]
struct Surfaces<S: Simd> {
    distance: f32x16<S>,
    across_px: f32x16<S>,
    down_px: f32x16<S>,
}

impl<S: Simd> Surfaces<S> {
    /// Loads the pixels of a block. Those beyond the end of the row are arbitrary.
    #[inline(always)]
    fn load(simd: S, gbuffer: &GBuffer, vectors: &MotionVectors, RowBlock { from, y }: RowBlock) -> Self {
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
        self.or(other, other.distance.simd_lt(self.distance))
    }

    /// Replaces the surfaces of a mask.
    #[inline(always)]
    fn or(self, other: Self, mask: mask32x16<S>) -> Self {
        Self {
            distance: mask.select(other.distance, self.distance),
            across_px: mask.select(other.across_px, self.across_px),
            down_px: mask.select(other.down_px, self.down_px),
        }
    }
}

impl DilatedVectors {
    /// Returns buffers for a frame.
    pub(in crate::upscale) fn new(frame: &FrameInputs<'_>) -> Self {
        let grid = frame.surface_grid();
        let columns = ColumnPairs::new(&grid, frame.size.0);
        let [distance, across_px, down_px] =
            [0, 1, 2].map(|_| vec![0.0; frame.gbuffer.object.width() as usize + 2 + WIDE]);
        Self { grid, columns, holds: None, distance, across_px, down_px }
    }

    /// Finds the nearest surfaces for a range of output pixels.
    #[inline(always)]
    pub(in crate::upscale) fn fill<S: Simd>(
        &mut self,
        simd: S,
        gbuffer: &GBuffer,
        vectors: &MotionVectors,
        RowSpan { columns, y }: &RowSpan,
    ) {
        let rows = self.grid.rows(*y);
        let [first, last] = [columns.start, columns.end - 1].map(|column| self.grid.columns(column as u32));
        let first = first.into_iter().min().unwrap_or_default() as usize;
        let last = last.into_iter().max().unwrap_or_default() as usize;
        let read = first..last + 1;
        if self.holds.as_ref().is_some_and(|held| *held == (rows.clone(), read.clone())) {
            return;
        }
        for from in read.clone().step_by(WIDE) {
            let mut nearest = Surfaces::load(simd, gbuffer, vectors, RowBlock { from, y: rows[0] });
            for y in rows[1..].iter().copied() {
                nearest = nearest.or_nearer(Surfaces::load(simd, gbuffer, vectors, RowBlock { from, y }));
            }
            nearest.distance.store_slice(&mut self.distance[from + 1..][..WIDE]);
            nearest.across_px.store_slice(&mut self.across_px[from + 1..][..WIDE]);
            nearest.down_px.store_slice(&mut self.down_px[from + 1..][..WIDE]);
        }
        let width = gbuffer.distance.width() as usize;
        for numbers in [&mut self.distance, &mut self.across_px, &mut self.down_px] {
            if read.start == 0 {
                numbers[0] = numbers[1];
            }
            if read.end == width {
                numbers[width + 1] = numbers[width];
            }
        }
        self.holds = Some((rows, read));
    }

    /// Returns the motion vectors of 16 output pixels from column `from` on, in pixels to the right and downwards. Those of
    /// surfaces that the previous frame does not show are not numbers.
    #[inline(always)]
    pub(in crate::upscale) fn load<S: Simd>(&self, simd: S, from: usize) -> [f32x16<S>; 2] {
        let nearest = match &self.columns {
            Some(ColumnPairs { left, right, is_right_closer }) => {
                let [left, right] = each!(columns in [left, right] => {
                    self.surfaces(simd, SampleLanes::ascending(simd, window(columns, from)))
                });
                let wins_ties = f32x16::load_array_ref(simd, window(is_right_closer, from));
                let wins_ties = wins_ties.simd_gt(f32x16::splat(simd, 0.0));
                let distance = [left.distance, right.distance];
                left.or(right, distance[1].simd_lt(distance[0]) | (distance[1].simd_eq(distance[0]) & wins_ties))
            }
            None => {
                let [left, at, right] = each!(by in [0, 1, 2] => self.surfaces(simd, SampleLanes::Adjacent(from + by)));
                at.or_nearer(left).or_nearer(right)
            }
        };
        [nearest.across_px, nearest.down_px]
    }

    /// Returns the surfaces at 16 indices.
    #[inline(always)]
    fn surfaces<S: Simd>(&self, simd: S, at: SampleLanes<S>) -> Surfaces<S> {
        let [distance, across_px, down_px] =
            each!(numbers in [&self.distance, &self.across_px, &self.down_px] => at.read(simd, numbers));
        Surfaces { distance, across_px, down_px }
    }
}
