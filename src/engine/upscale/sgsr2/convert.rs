//! First pass: the motion vector and the depth clip of every sample, from the distances of the samples around it.

use std::ops::Range;

use super::super::planes::{PAD, SampleLanes, padded_row};
use super::super::quads::window;
use super::super::{FrameInputs, UpscaleInputs};
use super::past::MotionLanes;
use crate::image::Image;
use crate::math::lanes::*;
use crate::pipeline::motion::MotionVectors;

/// Relative difference of two distances up to which they belong to one surface, per pixel of the diagonal of the drawn
/// picture.
const SEPARATION: f32 = 1.37e-5;

/// Motion of a sample, and its source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Converted {
    /// Sample whose motion vector applies: that of the nearest surface among the 3 × 3 samples around the sample.
    pub(super) vector_of: (u32, u32),
    /// Motion vector, in pixels to the right and downwards; NaN if the previous frame does not show the surface.
    pub(super) vector_px: [f32; 2],
    /// Share of depth edges around the sample, in [0, 1].
    pub(super) depth_clip: f32,
}

/// Motion of the samples of a row: padded buffers of both coordinates of the vectors, and of the depth clip.
pub(super) struct MotionRow([Vec<f32>; 3]);

impl MotionRow {
    /// Returns the buffers for a row of `samples` samples.
    pub(super) fn new(samples: u32) -> Self {
        Self([0; 3].map(|_| padded_row(samples)))
    }

    /// Reads the motion of sixteen samples.
    #[inline(always)]
    pub(super) fn read<S: Simd>(&self, simd: S, samples: &SampleLanes<S>) -> MotionLanes<S> {
        let [across, down, depth_clip] = each!(number in [0, 1, 2] => samples.read(simd, &self.0[number]));
        MotionLanes { vector_px: [across, down], depth_clip }
    }
}

/// Motion of sixteen samples, and its source.
struct ConvertedLanes<S: Simd> {
    motion: MotionLanes<S>,
    /// Sample whose motion vector applies, by its place among the 3 × 3 samples, row by row.
    vector_of: u32x16<S>,
}

/// Visible surfaces at all samples, and their motion.
#[derive(Clone, Debug)]
pub(super) struct Convert<'a> {
    distance: &'a Image<f32>,
    /// `None` if nothing moves.
    vectors: Option<&'a MotionVectors>,
    /// Relative difference of two distances up to which they belong to one surface.
    separation: f32,
}

/// Surfaces of four adjacent rows of samples.
pub(super) struct SurfaceRows([SurfaceRow; 4]);

/// Surfaces of a row of samples at padded indices; see [`sample_at`]. Sixteen can be read from every sample and from the
/// two behind it.
struct SurfaceRow {
    /// Row and samples that the buffers hold.
    holds: Option<(u32, Range<u32>)>,
    distance: Vec<f32>,
    across_px: Vec<f32>,
    down_px: Vec<f32>,
}

/// Returns the sample at a padded index along an axis. Sample `i` is at index `i + 1`; the first and the last are repeated.
fn sample_at(padded: u32, samples: u32) -> u32 {
    padded.saturating_sub(1).min(samples - 1)
}

impl SurfaceRows {
    /// Returns buffers for rows of `samples` samples, which hold none yet.
    pub(super) fn new(samples: u32) -> Self {
        let numbers = || vec![0.0; samples as usize + 3 + WIDE];
        let row = || SurfaceRow { holds: None, distance: numbers(), across_px: numbers(), down_px: numbers() };
        Self([0; 4].map(|_| row()))
    }
}

impl<'a> Convert<'a> {
    /// Prepares the pass; returns `None` if there is no G-buffer.
    pub(super) fn new(drawn: &UpscaleInputs<'a>) -> Option<Self> {
        let FrameInputs { gbuffer, motion: vectors, .. } = drawn.frame?;
        let distance = &gbuffer.distance;
        let (width, height) = (distance.width() as f32, distance.height() as f32);
        let separation = SEPARATION * (width * width + height * height).sqrt();
        Some(Self { distance, vectors, separation })
    }

    /// Computes the motion of all samples of a row.
    #[inline(always)]
    pub(super) fn row<S: Simd>(&self, simd: S, row: u32, surfaces: &mut SurfaceRows, motion: &mut MotionRow) {
        let samples = self.distance.width();
        let around = self.surfaces_around(row, 0..samples, surfaces);
        let samples = samples as usize;
        for first in (0..samples).step_by(WIDE) {
            let MotionLanes { vector_px: [across, down], depth_clip } = self.sixteen(simd, &around, first).motion;
            for (buffer, numbers) in motion.0.iter_mut().zip([across, down, depth_clip]) {
                numbers.store_slice(&mut buffer[PAD + first..][..WIDE]);
            }
        }
        for buffer in &mut motion.0 {
            buffer.copy_within(PAD..PAD + 1, PAD - 1);
            buffer.copy_within(PAD + samples - 1..PAD + samples, PAD + samples);
        }
    }

    /// Returns the motion of one sample, bit-identical to [`Self::row`].
    pub(super) fn sample(&self, (column, row): (u32, u32), surfaces: &mut SurfaceRows) -> Converted {
        let around = self.surfaces_around(row, column..column + 1, surfaces);
        let ConvertedLanes { motion, vector_of } = self.sixteen(baseline(), &around, column as usize);
        let place = vector_of.to_array()[0];
        Converted {
            vector_px: motion.vector_px.map(|numbers| numbers.to_array()[0]),
            depth_clip: motion.depth_clip.to_array()[0],
            vector_of: (
                sample_at(column + place % 3, self.distance.width()),
                sample_at(row + place / 3, self.distance.height()),
            ),
        }
    }

    /// Returns the row of samples before a row, that row and the two behind it, with the surfaces at and around the given
    /// samples.
    #[inline(always)]
    fn surfaces_around<'b>(&self, row: u32, samples: Range<u32>, surfaces: &'b mut SurfaceRows) -> [&'b SurfaceRow; 4] {
        let rows = [0, 1, 2, 3].map(|by| sample_at(row + by, self.distance.height()));
        for row in rows {
            self.fill(row, &samples, &mut surfaces.0[row as usize % 4]);
        }
        rows.map(|row| &surfaces.0[row as usize % 4])
    }

    /// Makes sure that a row holds the surfaces at and around the given samples.
    #[inline(always)]
    fn fill(&self, row: u32, samples: &Range<u32>, surfaces: &mut SurfaceRow) {
        if surfaces.holds.as_ref().is_some_and(|(held, all)| (*held, all) == (row, samples)) {
            return;
        }
        let distances = self.distance.row(row);
        for padded in samples.start..samples.end + 3 {
            let x = sample_at(padded, self.distance.width());
            let vector = self.vectors.and_then(|vectors| vectors.visible_vector((x, row)));
            let padded = padded as usize;
            surfaces.distance[padded] = distances[x as usize];
            [surfaces.across_px[padded], surfaces.down_px[padded]] = vector.unwrap_or([f32::NAN; 2]);
        }
        surfaces.holds = Some((row, samples.clone()));
    }

    /// Returns the motion of sixteen samples from sample `first` on.
    #[inline(always)]
    fn sixteen<S: Simd>(&self, simd: S, around: &[&SurfaceRow; 4], first: usize) -> ConvertedLanes<S> {
        let load = |numbers: &[f32], column: usize| f32x16::load_array_ref(simd, window(numbers, first + column));
        let distances = each!(row in [0, 1, 2, 3] => {
            each!(column in [0, 1, 2, 3] => load(&around[row].distance, column))
        });
        // The sample itself wins ties.
        let (mut nearest, mut vector_of) = (distances[1][1], u32x16::splat(simd, 4));
        let mut vector_px = [load(&around[1].across_px, 1), load(&around[1].down_px, 1)];
        for (row, distances) in distances.iter().enumerate().take(3) {
            for (column, distance) in distances.iter().enumerate().take(3) {
                let is_nearer = distance.simd_lt(nearest);
                let vector = [load(&around[row].across_px, column), load(&around[row].down_px, column)];
                vector_px = each!(axis in [0, 1] => is_nearer.select(vector[axis], vector_px[axis]));
                vector_of = is_nearer.select(u32x16::splat(simd, (3 * row + column) as u32), vector_of);
                nearest = is_nearer.select(*distance, nearest);
            }
        }
        let depth_clip = self.depth_clip(simd, &distances);
        ConvertedLanes { motion: MotionLanes { vector_px, depth_clip }, vector_of }
    }

    /// Returns the share of depth edges among 4 × 4 distances. The nearest distance of each quarter is compared with that
    /// of the middle 2 × 2.
    #[inline(always)]
    fn depth_clip<S: Simd>(&self, simd: S, distances: &[[f32x16<S>; 4]; 4]) -> f32x16<S> {
        let [first, middle, last] = each!(row in [0, 1, 2] => each!(column in [0, 1, 2] => {
            let [above, below] = [distances[row], distances[row + 1]];
            above[column].min(above[column + 1]).min(below[column].min(below[column + 1]))
        }));
        let (middle, one) = (middle[1], f32x16::splat(simd, 1.0));
        let [a, b, c, d] = each!(nearest in [first[0], first[2], last[0], last[2]] => {
            // The relative difference, also if one distance is infinite.
            let difference = (one - middle / nearest).abs();
            difference.simd_gt(self.separation).select(self.separation / difference, one)
        });
        let clip = (one - (a + b + c + d) * 0.25).max(0.0).min(1.0);
        middle.simd_lt(f32::INFINITY).select(clip, f32x16::splat(simd, 0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Rgba8;
    use crate::pipeline::gbuffer::GBuffer;
    use crate::upscale::{Anchor, FrameInputs, Lattice, Sampling, Scale};

    fn converted(distance: Image<f32>, at: (u32, u32)) -> Converted {
        let (width, height) = distance.size();
        let gbuffer = GBuffer { object: Image::filled(width, height, [0; 4]), distance };
        let color: Image<Rgba8> = Image::filled(width, height, [0; 4]);
        let drawn = UpscaleInputs { color: &color, frame: Some(inputs(&gbuffer, None)) };
        Convert::new(&drawn).unwrap().sample(at, &mut SurfaceRows::new(width))
    }

    fn inputs<'a>(gbuffer: &'a GBuffer, motion: Option<&'a MotionVectors>) -> FrameInputs<'a> {
        let (width, height) = gbuffer.object.size();
        let sampling = Sampling::Lattice(Lattice { scale: Scale::TWO, anchor: Anchor::Centre });
        FrameInputs { size: (2 * width, 2 * height), sampling, gbuffer, motion, history: None, reactivity: None }
    }

    #[test]
    fn samples_move_like_the_nearest_surface_among_the_3_by_3_samples() {
        let (columns, rows) = (45, 11);
        let mut random = fastrand::Rng::with_seed(3);
        // Few distances, so that many are equal.
        let distance = Image::from_fn(columns, rows, |_, _| f32::from(random.u8(1..6)));
        let [across_px, down_px] = [0, 1].map(|_| Image::from_fn(columns, rows, |_, _| random.f32()));
        let visible = Image::from_fn(columns, rows, |_, _| if random.bool() { MotionVectors::VISIBLE } else { 0 });
        let vectors = MotionVectors { across_px, down_px, visible };
        let gbuffer = GBuffer { object: Image::filled(columns, rows, [0; 4]), distance };
        let color: Image<Rgba8> = Image::filled(columns, rows, [0; 4]);
        let drawn = UpscaleInputs { color: &color, frame: Some(inputs(&gbuffer, Some(&vectors))) };
        let convert = Convert::new(&drawn).unwrap();
        let mut surfaces = SurfaceRows::new(columns);
        for lanes in Lanes::all() {
            let mut motion = MotionRow::new(columns);
            for row in 0..rows {
                on_lanes!(lanes, simd => convert.row(simd, row, &mut surfaces, &mut motion));
                for column in 0..columns {
                    let [across, down, depth_clip] = motion.0.each_ref().map(|buffer| buffer[column as usize + PAD]);
                    let around = |at: u32, last: u32| [at.saturating_sub(1), at, (at + 1).min(last)];
                    let all = around(row, rows - 1).map(|y| around(column, columns - 1).map(|x| (x, y)));
                    let candidates = std::iter::once((column, row)).chain(all.into_iter().flatten());
                    let of = |pixel: &(u32, u32)| gbuffer.distance.at(pixel.0, pixel.1);
                    let nearest = candidates.min_by(|a, b| of(a).total_cmp(&of(b))).unwrap();
                    let expected = vectors.visible_vector(nearest).unwrap_or([f32::NAN; 2]).map(f32::to_bits);
                    let context = || format!("({column}, {row}) {}", lanes.name());
                    assert_eq!([across, down].map(f32::to_bits), expected, "{}", context());
                    let converted = convert.sample((column, row), &mut SurfaceRows::new(columns));
                    assert_eq!(converted.vector_of, nearest, "{}", context());
                    assert_eq!(converted.depth_clip.to_bits(), depth_clip.to_bits(), "{}", context());
                }
            }
        }
    }

    #[test]
    fn depth_edges_clip_the_samples_behind_them_and_lend_them_their_motion() {
        // A surface at distance 2 on the left of column 10, before one at distance 10.
        let edge = |x: u32, _| if x < 10 { 2.0 } else { 10.0 };
        let at = |column| converted(Image::from_fn(32, 24, edge), (column, 12));
        // In front of the edge, all quarters are as near as the middle, or half of them are far behind it.
        assert_eq!(at(3).depth_clip, 0.0);
        assert!((0.49..=0.5).contains(&at(9).depth_clip), "{:?}", at(9));
        // Just behind the edge, half of the quarters are nearer.
        assert!((0.49..=0.5).contains(&at(10).depth_clip), "{:?}", at(10));
        assert_eq!(at(15).depth_clip, 0.0);
        // Sample 10 lies behind the edge. Of the equally near samples in column 9, the uppermost one is taken.
        assert_eq!(at(10).vector_of, (9, 11));
        assert_eq!(at(11).vector_of, (11, 12));
    }

    #[test]
    fn slanted_surfaces_and_the_background_have_no_edges() {
        let slanted = Image::from_fn(32, 24, |x, y| 5.0 + 2e-4 * (x + y) as f32);
        assert_eq!(converted(slanted, (16, 12)).depth_clip, 0.0);
        assert_eq!(converted(Image::filled(32, 24, f32::INFINITY), (16, 12)).depth_clip, 0.0);
        let horizon = Image::from_fn(32, 24, |_, y| if y < 12 { f32::INFINITY } else { 3.0 });
        let clip = converted(horizon, (16, 11)).depth_clip;
        assert!((0.49..=0.5).contains(&clip), "{clip}");
    }
}
