//! Vectorised checkerboard fill: 16 missing pixels at a time.
//!
//! Of every four pixels in a row, two are drawn and two are missing. The packed image contains only the drawn pixels. The
//! missing pixels of a row are numbered in the same way, without gaps. The drawn neighbours of missing pixels n to n + 15
//! are then adjacent in the packed image: some in the same row, some in a row above, and some in a row below.

use super::{BEHIND, PixelPosition, TOUCHING, step};
use crate::image::{Image, Rgba8};
use crate::math::lanes::*;
use crate::pipeline::gbuffer::GBuffer;
use crate::pipeline::grid::SampleGrid;
use crate::pipeline::motion::MotionVectors;
use crate::upscale::history::{SurfaceLanes, VectorLanes};
use crate::upscale::{Scale, bands};

/// Kernel that computes missing pixels of a checkerboard.
pub(super) trait Fill: Sync {
    /// Computes one pixel of the full image, drawn or missing.
    fn pixel(&self, at: PixelPosition) -> Rgba8;

    /// Computes 16 missing pixels in packed RGBA, with red in the lowest byte; bit-identical to [`Self::pixel`].
    fn missing<S: Simd>(&self, simd: S, run: &MissingRun, around: DrawnNeighbours<S>) -> u32x16<S>;
}

/// Position of 16 consecutive missing pixels of a row.
pub(super) struct MissingRun {
    /// Row of the missing pixels. Row `across` has the drawn pixels that touch them from above or below, and row
    /// `far_across` has the drawn pixels behind them.
    pub(crate) y: u32,
    pub(crate) across: u32,
    pub(crate) far_across: u32,
    /// Column directly before the first of the 16 pixels.
    pub(crate) before: usize,
}

impl MissingRun {
    /// Compares 16 missing pixels with their drawn neighbours. Returns one mask for each neighbour, in the order of the
    /// fields of [`DrawnNeighbours`]. A bit is set if the missing pixel and that neighbour show the same surface.
    #[inline(always)]
    pub(super) fn same_surface_masks<S: Simd>(&self, simd: S, surfaces: &GBuffer) -> [mask32x16<S>; 4] {
        let GBuffer { object, distance } = surfaces;
        let [own, near, far] = each!(y in [self.y, self.across, self.far_across] => {
            let objects = &object.row(y).as_flattened()[4 * self.before..];
            let (even, odd) = words(simd, objects).deinterleave(words(simd, &objects[4 * WIDE..]));
            let distances = &distance.row(y)[self.before..];
            let [a, b] = each!(at in [0, WIDE] => f32x16::from_slice(simd, &distances[at..at + WIDE]));
            let (even_far, odd_far) = a.deinterleave(b);
            let [even, odd] = each!((object, distance) in [(even, even_far), (odd, odd_far)] => {
                SurfaceLanes { object, distance }
            });
            (even, odd)
        });
        // Starting one column before a missing pair, the second and third of every four pixels are missing.
        let first = firsts(simd);
        let (even, odd) = own;
        let beside = even.select(odd, first);
        let far_beside = SurfaceLanes {
            object: swap_pairs(beside.object),
            distance: swap_pairs(beside.distance.bitcast()).bitcast(),
        };
        let [own, near, far] = each!((even, odd) in [own, near, far] => odd.select(even, first));
        each!(there in [beside, near, far_beside, far] => own.same_surface(there))
    }

    /// Loads the values of a full-width image row at the positions of the 16 missing pixels.
    #[inline(always)]
    pub(super) fn own<S: Simd>(&self, simd: S, row: &[Rgba8]) -> u32x16<S> {
        let codes = &row.as_flattened()[4 * self.before..];
        let (even, odd) = words(simd, codes).deinterleave(words(simd, &codes[4 * WIDE..]));
        firsts(simd).select(odd, even)
    }

    /// Loads the motion vectors of the 16 missing pixels, eight at a time.
    #[inline(always)]
    pub(super) fn vectors<S: Simd>(&self, simd: S, of: &MotionVectors) -> [VectorLanes<S>; 2] {
        let [(across, next_across), (down, next_down)] = each!(image in [&of.across_px, &of.down_px] => {
            let row = &image.row(self.y)[self.before..];
            let [a, b] = each!(at in [0, WIDE] => f32x16::from_slice(simd, &row[at..at + WIDE]));
            let (even, odd) = a.deinterleave(b);
            firsts(simd).select(odd, even).split()
        });
        let visible = &of.visible.row(self.y)[self.before..];
        let columns = F32::load_array(simd, [1.0, 2.0, 5.0, 6.0, 9.0, 10.0, 13.0, 14.0]) + self.before as f32;
        let row = F32::splat(simd, self.y as f32);
        let [first, last] = each!(part in [0, WIDE] => {
            u32x8::load_array(simd, [1, 2, 5, 6, 9, 10, 13, 14].map(|column| u32::from(visible[part + column])))
        });
        [
            VectorLanes { column: columns, row, across_px: across, down_px: down, visible: first },
            VectorLanes {
                column: columns + WIDE as f32,
                row,
                across_px: next_across,
                down_px: next_down,
                visible: last,
            },
        ]
    }
}

/// Drawn pixels around 16 missing ones: touching (`beside`, `across`) and behind (`far_beside`, `far_across`).
#[derive(Clone, Copy)]
pub(super) struct DrawnNeighbours<S: Simd> {
    pub(crate) beside: u32x16<S>,
    pub(crate) across: u32x16<S>,
    pub(crate) far_beside: u32x16<S>,
    pub(crate) far_across: u32x16<S>,
}

/// Fills an image with drawn and interpolated pixels, in parallel.
pub(super) fn fill(lanes: Lanes, grid: SampleGrid, drawn: &Image<Rgba8>, full: &mut Image<Rgba8>, by: &impl Fill) {
    let (width, height) = full.size();
    let half = DrawnHalf { grid, drawn, height };
    bands::fill(full, Scale::ONE, |first, _, pixels| {
        for (y, row) in (first..).zip(pixels.chunks_exact_mut(width as usize)) {
            let filled = on_lanes!(lanes, simd => half.fill_row(simd, y, row, by));
            for x in (0..filled.start).chain(filled.end..row.len()) {
                row[x] = by.pixel((x as u32, y));
            }
        }
    });
}

/// Drawn half of the pixels of a picture.
struct DrawnHalf<'a> {
    grid: SampleGrid,
    drawn: &'a Image<Rgba8>,
    /// Height of the full picture in pixels.
    height: u32,
}

impl DrawnHalf<'_> {
    /// Fills the interior of a row, where all sources of a pixel lie inside the image. Returns the columns filled; the
    /// range is empty if there are too few such pixels.
    #[inline(always)]
    fn fill_row<S: Simd>(&self, simd: S, y: u32, row: &mut [Rgba8], by: &impl Fill) -> std::ops::Range<usize> {
        let Self { grid, drawn, height } = *self;
        let [Some(across), Some(far_across)] = [TOUCHING, BEHIND].map(|by| step(y, by, height)) else { return 0..0 };
        let drawn_first = grid.sample_at(0, y).is_some();
        // Groups of four pixels whose two missing pixels have a drawn one on both sides.
        let fours = if drawn_first { 0..row.len().saturating_sub(1) / 4 } else { 1..row.len() / 4 };
        let (from, end) = (2 * fours.start, 2 * fours.end);
        if end < from + WIDE {
            return 0..0;
        }
        let [own, near, far] = [y, across, far_across].map(|y| drawn.row(y).as_flattened());
        // The packed index of the drawn pixel beside a missing pixel is one more or one less than the index of the missing
        // pixel among the missing ones.
        let beside = |first: usize| if drawn_first { first + 1 } else { first - 1 };
        let mut first = from;
        loop {
            let touching = words(simd, &own[4 * beside(first)..]);
            let around = DrawnNeighbours {
                beside: touching,
                across: words(simd, &near[4 * first..]),
                far_beside: swap_pairs(touching),
                far_across: words(simd, &far[4 * first..]),
            };
            let before = 2 * (first + usize::from(drawn_first)) - 1;
            let run = MissingRun { y, across, far_across, before };
            let missing = by.missing(simd, &run, around).bitcast::<u64x8<S>>();
            let drawn = words(simd, &own[4 * first..]).bitcast::<u64x8<S>>();
            let (left, right) = if drawn_first { drawn.interleave(missing) } else { missing.interleave(drawn) };
            let codes = row[2 * first..2 * (first + WIDE)].as_flattened_mut();
            left.bitcast::<u8x64<S>>().store_slice(&mut codes[..4 * WIDE]);
            right.bitcast::<u8x64<S>>().store_slice(&mut codes[4 * WIDE..]);
            if first + WIDE == end {
                return 4 * fours.start..4 * fours.end;
            }
            // The last run overlaps the previous one.
            first = (first + WIDE).min(end - WIDE);
        }
    }
}

/// Loads 16 packed pixels from the start of a byte slice.
#[inline(always)]
pub(super) fn words<S: Simd>(simd: S, codes: &[u8]) -> u32x16<S> {
    u8x64::from_slice(simd, &codes[..4 * WIDE]).bitcast()
}

/// Returns a mask of the pixels that come first in their pair of missing pixels.
#[inline(always)]
fn firsts<S: Simd>(simd: S) -> mask32x16<S> {
    let places = u32x16::load_array(simd, [0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1]);
    places.simd_eq(u32x16::splat(simd, 0))
}

#[inline(always)]
fn swap_pairs<S: Simd>(words: u32x16<S>) -> u32x16<S> {
    let pairs = words.bitcast::<u64x8<S>>();
    (pairs << 32 | pairs >> 32).bitcast()
}

/// Extracts a channel of 16 pixels as floats.
#[inline(always)]
pub(super) fn channel<S: Simd>(of: u32x16<S>, channel: u32) -> f32x16<S> {
    float_of((of >> (8 * channel)) & 255)
}

/// Packs 16 pixels from four channels, truncated toward zero.
#[inline(always)]
pub(super) fn pixels<S: Simd>([r, g, b, a]: [f32x16<S>; 4]) -> u32x16<S> {
    let [r, g, b, a] = each!(channel in [r, g, b, a] => whole_part(channel));
    r | g << 8 | b << 16 | a << 24
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::upscale::checkerboard::edges::AlongEdges;
    use crate::upscale::checkerboard::surfaces::SurfaceFill;
    use crate::upscale::checkerboard::temporal::{TemporalFill, grid_of};
    use crate::upscale::history::tests::frames;
    use crate::upscale::{UpscaleInputs, Upscaling};

    fn check(grid: SampleGrid, drawn: &Image<Rgba8>, (width, height): (u32, u32), by: &impl Fill) {
        for lanes in Lanes::all() {
            let mut full = Image::filled(width, height, [1, 2, 3, 4]);
            fill(lanes, grid, drawn, &mut full, by);
            for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
                assert_eq!(full.at(x, y), by.pixel((x, y)), "({x}, {y}) of {width}×{height} {grid:?} {}", lanes.name());
            }
        }
    }

    #[test]
    fn sixteen_pixels_at_a_time_equal_single_pixels() {
        let mut random = fastrand::Rng::with_seed(5);
        for size in [(33, 4), (34, 5), (35, 6), (36, 7), (37, 8), (75, 9), (140, 5)] {
            for (grid, number) in [(SampleGrid::Checkerboard, 1), (SampleGrid::OddCheckerboard, 2)] {
                let (columns, rows) = grid.packed_size(size.0, size.1);
                // Few distinct values, so that differences of zero occur.
                let color = Image::from_fn(columns, rows, |_, _| std::array::from_fn(|_| random.u8(..) & 0xf1));
                for frames in frames(Upscaling::new("checkerboard-temporal", 1).unwrap(), size, number) {
                    let drawn = UpscaleInputs { color: &color, frame: Some(frames.seen()) };
                    check(grid, &color, size, &SurfaceFill { grid, drawn: &drawn, size });
                    if grid_of(&drawn) == grid {
                        check(grid, &color, size, &TemporalFill::new(&drawn, size));
                    }
                }
                let drawn = UpscaleInputs::from(&color);
                check(grid, &color, size, &SurfaceFill { grid, drawn: &drawn, size });
                if grid == SampleGrid::Checkerboard {
                    check(grid, &color, size, &AlongEdges { drawn: &color, size });
                }
            }
        }
    }
}
