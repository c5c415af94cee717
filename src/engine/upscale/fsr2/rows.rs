//! Blending of the samples of a frame with its history, sixteen pixels of a row at a time.

use super::super::history::{FilterWeights, PastPlaces, centers};
use super::super::quads::{self, Quad};
use super::super::row_parts::{OutputRow, RowBlock, RowSpan};
use super::super::{Accumulated, HistoryStep, PastColor, Rejection};
use super::frame::{Fsr2Frame, RowScratch};
use super::kernel::{Kernel, history_weights};
use super::locks::Locks;
use crate::image::Rgba8;
use crate::math::lanes::*;

/// Average weight of the present colour at a narrowing of 1. At a narrowing of n, it is smaller by the factor n².
const AVERAGE_WEIGHT: f32 = 0.74;

/// Limit of the accumulated weight of pixels that do not move in a view that changes.
const MOST_WEIGHT: f32 = 12.0;

/// Number of average frames to which the history is limited in pixels that move.
const MOVING_FRAMES: f32 = 10.0;

/// Speed from which [`MOVING_FRAMES`] applies, in pixels per frame.
const MOVING_PX: f32 = 0.1;

/// Speed at which the history is limited to one average frame, in pixels per frame.
const FAST_PX: f32 = 20.0;

/// Maximum size of the box of colours, in standard deviations to each side of the mean.
const MOST_DEVIATIONS: f32 = 20.0;

/// Colour codes and history of sixteen pixels.
struct Blended {
    codes: [Rgba8; WIDE],
    color: [Quad; WIDE],
    locks: [[f32; 2]; WIDE],
}

/// One pixel of the picture without sharpening.
pub(super) struct Fsr2Pixel {
    pub(super) codes: Rgba8,
    /// Colour and accumulated weight for the next frame.
    #[cfg_attr(not(test), expect(dead_code, reason = "tests compare it with that of rows"))]
    pub(super) color: Quad,
    /// Lock for the next frame, as [`Locks::stored`] returns it.
    #[cfg_attr(not(test), expect(dead_code, reason = "tests compare it with that of rows"))]
    pub(super) lock: [f32; 2],
    /// Weights of the 3 × 3 samples in the present colour, row by row.
    pub(super) weights: [[f32; 3]; 3],
    /// Blending with the history.
    pub(super) step: HistoryStep,
}

/// History of sixteen pixels. Where it is not known, the numbers are not meaningful.
struct Past<S: Simd> {
    is_known: mask32x16<S>,
    /// Colour, and accumulated weight.
    color: [f32x16<S>; 4],
    /// Locks as [`Locks::stored`] returns them.
    locks: [f32x16<S>; 2],
    /// Position in the previous frame, in pixels.
    place: [f32x16<S>; 2],
    /// Length of the motion vector in pixels.
    speed_px: f32x16<S>,
}

/// Blending of sixteen pixels with their history.
struct Blend<S: Simd> {
    present: [f32x16<S>; 4],
    /// Weights of the 3 × 3 samples in the present colour, row by row.
    weights: [[f32x16<S>; 3]; 3],
    past: Past<S>,
    /// Colour of the history after rectification.
    rectified: [f32x16<S>; 3],
    /// Share of this frame, in [0, 1]; 1 where the history is not known.
    share: f32x16<S>,
    /// Accumulated weight for the next frame.
    weight: f32x16<S>,
    /// Stored locks for the next frame.
    locks: [f32x16<S>; 2],
}

/// The 3 × 3 samples around sixteen pixels: their weighted means, and the boxes of their colours.
struct Around<S: Simd> {
    present: [f32x16<S>; 4],
    /// Weight of the present colour.
    weight: f32x16<S>,
    least: [f32x16<S>; 4],
    greatest: [f32x16<S>; 4],
    mean: [f32x16<S>; 3],
    deviation: [f32x16<S>; 3],
}

impl Fsr2Frame<'_> {
    /// Computes a row of the picture without sharpening, and the colours and locks of the history for the next frame.
    #[inline(always)]
    pub(super) fn row<S: Simd>(
        &self,
        simd: S,
        scratch: &mut RowScratch,
        OutputRow { y, pixels, history }: OutputRow<'_>,
        locks: &mut [[f32; 2]],
    ) {
        self.prepare(simd, &RowSpan { columns: 0..pixels.len(), y }, scratch);
        let history = history.chunks_mut(WIDE).zip(locks.chunks_mut(WIDE));
        for (from, (pixels, (color, locks))) in (0..).step_by(WIDE).zip(pixels.chunks_mut(WIDE).zip(history)) {
            let blended = self.finished(simd, &self.block(simd, RowBlock { from, y }, scratch));
            store_in(pixels, &blended.codes);
            store_in(color, &blended.color);
            store_in(locks, &blended.locks);
        }
    }

    /// Computes one pixel without sharpening, bit-identical to [`Self::row`].
    pub(super) fn pixel(&self, at @ (x, y): (u32, u32), scratch: &mut RowScratch) -> Fsr2Pixel {
        let (simd, from) = (baseline(), x as usize);
        self.prepare(simd, &RowSpan { columns: from..from + 1, y }, scratch);
        let blend = self.block(simd, RowBlock { from, y }, scratch);
        let Blended { codes: [codes, ..], color: [color, ..], locks: [lock, ..] } = self.finished(simd, &blend);
        let weights = blend.weights.map(|row| row.map(|weights| weights.to_array()[0]));
        Fsr2Pixel { codes, color, lock, weights, step: self.step(&blend, at) }
    }

    /// Returns how the first of sixteen pixels is blended with its history.
    fn step<S: Simd>(&self, blend: &Blend<S>, at: (u32, u32)) -> HistoryStep {
        let color = |[y, co, cg, _]: [f32x16<S>; 4]| [y, co, cg].map(|numbers| numbers.to_array()[0]);
        let reprojected = self.drawn.frame.map_or(Err(Rejection::FirstFrame), |frame| frame.reproject_dilated(at));
        let past = self.history.as_ref().ok_or(Rejection::FirstFrame).and_then(|_| reprojected.map(|_| &blend.past));
        HistoryStep {
            space: self.colors.space(),
            present: color(blend.present),
            share: past.as_ref().map_or(1.0, |_| blend.share.to_array()[0]),
            past: past.map(|past| PastColor {
                position_px: past.place.map(|numbers| numbers.to_array()[0]),
                read: color(past.color),
                rectified: blend.rectified.map(|numbers| numbers.to_array()[0]),
            }),
        }
    }

    /// Prepares all inputs of a range of pixels.
    #[inline(always)]
    fn prepare<S: Simd>(&self, simd: S, span: &RowSpan, scratch: &mut RowScratch) {
        let RowScratch { samples, surroundings, vectors, reactive } = scratch;
        let RowSpan { columns, y } = span;
        let row = &self.rows[*y as usize];
        let [first, last] = [columns.start, columns.end - 1].map(|column| self.columns[column].padded as usize);
        let read = first - 1..last + 2;
        for y in row.index {
            samples.fill(simd, self.colors, self.drawn.color, &RowSpan { columns: read.clone(), y });
        }
        surroundings.fill(simd, self.contrast, samples.three(row.index, read));
        let motion = self.history.as_ref().and_then(|(motion, _)| motion.vectors);
        if let (Some(motion), Some(frame), Some(vectors)) = (motion, self.drawn.frame, vectors) {
            vectors.fill(simd, frame.gbuffer, motion, span);
        }
        if let (Some(reactivity), Some(frame), Some(reactive)) = (self.reactivity, self.drawn.frame, reactive) {
            reactive.fill(frame.gbuffer, reactivity, span);
        }
    }

    /// Blends sixteen pixels, which must have been prepared.
    #[inline(always)]
    fn block<S: Simd>(&self, simd: S, at: RowBlock, scratch: &RowScratch) -> Blend<S> {
        let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
        let past = match &self.history {
            None => Past::none(simd),
            Some((motion, history)) if motion.is_still() => self.past_of_still(simd, at, history),
            Some((_, history)) => self.past_of_moving(simd, at, history, scratch),
        };
        let narrowing = past.is_known.select(self.narrowing(simd, &past), one);
        let across = self.column_lanes.distance_squared(simd, at.from);
        let kernel = Kernel::new(simd, across, self.rows[at.y as usize].distance_squared, narrowing);
        let around = self.around(simd, at, &kernel, scratch);
        let [past_y, past_co, past_cg, past_weight] = past.color;
        let mut rectified = [past_y, past_co, past_cg];
        let kept = match &scratch.reactive {
            Some(reactive) => reactive.kept(simd, at.from),
            None => one,
        };
        let stored = each!(number in [0, 1] => past.is_known.select(past.locks[number] * kept, zero));
        let locks = self.next_locks(simd, at, stored, scratch);
        let mut weight = past_weight.max(zero);
        if self.history.as_ref().is_some_and(|(motion, _)| !motion.is_still()) {
            let exists = locks.lifetime.simd_gt(zero);
            let strength = exists.select(Locks::from_stored(simd, stored).strength(), zero);
            rectified = around.rectified(rectified, self.deviations(past.speed_px), strength);
            weight = weight.min(limit_of_weight(past.speed_px, narrowing) * kept);
        }
        let total = weight + around.weight;
        let has_weight = past.is_known & total.simd_gt(zero);
        let mut share = has_weight.select(around.weight / total, one);
        let mut weight = past.is_known.select(total, around.weight);
        let mut locks = locks.stored();
        if self.is_settled {
            (share, weight, locks) = (zero, past_weight, past.locks);
        }
        Blend { present: around.present, weights: kernel.lanczos, past, rectified, share, weight, locks }
    }

    /// Returns the 3 × 3 samples around sixteen pixels.
    #[inline(always)]
    fn around<S: Simd>(&self, simd: S, at: RowBlock, kernel: &Kernel<S>, scratch: &RowScratch) -> Around<S> {
        let (zero, nearest) = (f32x16::splat(simd, 0.0), self.column_lanes.samples(simd, at.from));
        let (mut present, mut mean, mut square) = ([zero; 4], [zero; 3], [zero; 3]);
        for (row, index) in self.rows[at.y as usize].index.into_iter().enumerate() {
            let samples = scratch.samples.row(index);
            for number in 0..3 {
                let sample = each!(channel in [0, 1, 2, 3] => nearest.read_beside(simd, &samples[channel], number));
                let (lanczos, share) = (kernel.lanczos[row][number], kernel.window[row][number]);
                present = each!(i in [0, 1, 2, 3] => present[i] + sample[i] * lanczos);
                let weighted = each!(i in [0, 1, 2] => sample[i] * share);
                mean = each!(i in [0, 1, 2] => mean[i] + weighted[i]);
                square = each!(i in [0, 1, 2] => square[i] + weighted[i] * sample[i]);
            }
        }
        let [least, greatest] = each!(bound in [0, 1] => {
            each!(channel in [0, 1, 2, 3] => nearest.read(simd, &scratch.surroundings.range[bound][channel]))
        });
        Around {
            present: each!(i in [0, 1, 2, 3] => present[i].max(least[i]).min(greatest[i])),
            weight: kernel.sum,
            least,
            greatest,
            mean,
            deviation: each!(i in [0, 1, 2] => (square[i] - mean[i] * mean[i]).max(zero).sqrt()),
        }
    }

    /// Returns the narrowing of the kernel: the more history a pixel has, the nearer the samples must be that count.
    #[inline(always)]
    fn narrowing<S: Simd>(&self, simd: S, past: &Past<S>) -> f32x16<S> {
        let share = ((past.color[3] - 0.5) * (1.0 / 3.0)).max(f32x16::splat(simd, 0.0)).min(1.0);
        share * (self.scale - 1.0) + 1.0
    }

    /// Returns half the size of the box to which the history is rectified, in standard deviations.
    #[inline(always)]
    fn deviations<S: Simd>(&self, speed_px: f32x16<S>) -> f32x16<S> {
        let area = self.scale * self.scale;
        let still = (area * area * area).min(MOST_DEVIATIONS);
        (speed_px * (1.0 / FAST_PX)).min(1.0) * (1.0 - still) + still
    }

    /// Returns the locks of sixteen pixels after this frame, from the stored ones before it. A lock is created where
    /// the middle sample lies inside the pixel and belongs to a thin feature.
    #[inline(always)]
    fn next_locks<S: Simd>(
        &self,
        simd: S,
        RowBlock { from, y }: RowBlock,
        stored: [f32x16<S>; 2],
        scratch: &RowScratch,
    ) -> Locks<S> {
        let nearest = self.column_lanes.samples(simd, from);
        let median = nearest.read(simd, &scratch.surroundings.median);
        let zero = f32x16::splat(simd, 0.0);
        let mut is_new = zero.simd_gt(zero);
        if self.rows[y as usize].is_inside {
            let is_thin = nearest.read(simd, &scratch.surroundings.thin).simd_gt(zero);
            is_new = is_thin & self.column_lanes.is_inside(simd, from);
        }
        Locks::from_stored(simd, stored).next(self.positions, is_new, median, self.contrast)
    }

    /// Returns the history of sixteen pixels in a still view.
    #[inline(always)]
    fn past_of_still<S: Simd>(&self, simd: S, at: RowBlock, history: &Accumulated) -> Past<S> {
        let RowBlock { from, y } = at;
        let (mut quads, mut pairs) = ([[0.0; 4]; WIDE], [[0.0; 2]; WIDE]);
        let read = from..self.size.0.min((from + WIDE) as u32) as usize;
        quads[..read.len()].copy_from_slice(&history.color.row(y)[read.clone()]);
        if let Some(locks) = &history.locks {
            pairs[..read.len()].copy_from_slice(&locks.row(y)[read]);
        }
        let zero = f32x16::splat(simd, 0.0);
        Past {
            is_known: zero.simd_eq(zero),
            color: quads::columns(simd, &quads),
            locks: numbers_of_pairs(simd, &pairs),
            place: centers(simd, at),
            speed_px: zero,
        }
    }

    /// Returns the history of sixteen pixels at the positions to which motion vectors lead.
    #[inline(always)]
    fn past_of_moving<S: Simd>(
        &self,
        simd: S,
        at: RowBlock,
        Accumulated { color, locks }: &Accumulated,
        scratch: &RowScratch,
    ) -> Past<S> {
        let mut quads = [[0.0; 4]; WIDE];
        let vectors @ [across, down] = match &scratch.vectors {
            Some(vectors) => vectors.load(simd, at.from),
            None => [f32x16::splat(simd, f32::NAN); 2],
        };
        let places = PastPlaces::new(simd, at, vectors, self.size);
        let weights = each!(axis in [0, 1] => history_weights(places.fraction[axis]));
        let weights = FilterWeights { across: weights[0], down: weights[1] };
        places.read_filtered::<true>(simd, color, &weights, &mut quads);
        let mut lock_numbers = [f32x16::splat(simd, 0.0); 2];
        if let Some(locks) = locks {
            lock_numbers = places.pairs_bilinear(simd, locks);
        }
        Past {
            is_known: places.is_known,
            color: quads::columns(simd, &quads),
            locks: lock_numbers,
            place: places.place,
            speed_px: (across * across + down * down).sqrt(),
        }
    }

    /// Returns the codes of sixteen pixels, without sharpening, and their history for the next frame.
    #[inline(always)]
    fn finished<S: Simd>(&self, simd: S, blend: &Blend<S>) -> Blended {
        let [y, co, cg, alpha] = blend.present;
        let present = [y, co, cg];
        let color @ [y, co, cg] = each!(i in [0, 1, 2] => {
            let blended = blend.rectified[i] + (present[i] - blend.rectified[i]) * blend.share;
            blend.past.is_known.select(blended, present[i])
        });
        let (mut quads, mut pairs) = ([[0.0; 4]; WIDE], [[0.0; 2]; WIDE]);
        quads::store([y, co, cg, blend.weight], &mut quads);
        let (first, last) = blend.locks[0].interleave(blend.locks[1]);
        let numbers = pairs.as_flattened_mut();
        first.store_slice(&mut numbers[..WIDE]);
        last.store_slice(&mut numbers[WIDE..]);
        Blended { codes: self.colors.encode(simd, color, alpha), color: quads, locks: pairs }
    }
}

impl<S: Simd> Past<S> {
    /// Returns the state of pixels without history.
    #[inline(always)]
    fn none(simd: S) -> Self {
        let zero = f32x16::splat(simd, 0.0);
        let is_known = zero.simd_gt(zero);
        Self { is_known, color: [zero; 4], locks: [zero; 2], place: [zero; 2], speed_px: zero }
    }
}

/// Returns the first and the second numbers of sixteen pairs.
#[inline(always)]
fn numbers_of_pairs<S: Simd>(simd: S, pairs: &[[f32; 2]; WIDE]) -> [f32x16<S>; 2] {
    let numbers = pairs.as_flattened();
    let (first, second) =
        f32x16::from_slice(simd, &numbers[..WIDE]).deinterleave(f32x16::from_slice(simd, &numbers[WIDE..]));
    [first, second]
}

/// Returns the limits of the accumulated weights of pixels that move at these speeds.
#[inline(always)]
fn limit_of_weight<S: Simd>(speed_px: f32x16<S>, narrowing: f32x16<S>) -> f32x16<S> {
    let frame = AVERAGE_WEIGHT / (narrowing * narrowing);
    let moving = (speed_px * (1.0 / MOVING_PX)).min(1.0);
    let limit = (frame * MOVING_FRAMES - MOST_WEIGHT) * moving + MOST_WEIGHT;
    limit + (frame - limit) * (speed_px * (1.0 / FAST_PX)).min(1.0)
}

impl<S: Simd> Around<S> {
    /// Returns the history clamped to the box of the colours, which extends by a number of standard deviations to each side
    /// of the mean but not beyond the range. A lock keeps a share of the history as it is.
    #[inline(always)]
    fn rectified(&self, past: [f32x16<S>; 3], deviations: f32x16<S>, lock: f32x16<S>) -> [f32x16<S>; 3] {
        each!(i in [0, 1, 2] => {
            let half = self.deviation[i] * deviations;
            let (least, greatest) = (self.least[i].max(self.mean[i] - half), self.greatest[i].min(self.mean[i] + half));
            let clamped = past[i].max(least).min(greatest);
            clamped + (past[i] - clamped) * lock
        })
    }
}
