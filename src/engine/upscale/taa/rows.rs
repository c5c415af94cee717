//! Blending of the samples of a frame with its history, sixteen pixels of a row at a time.

use super::super::history::{DilatedVectors, FilterWeights, PastPlaces, centers};
use super::super::jitter::Continuation;
use super::super::lattice::ThreeSamples;
use super::super::planes::{Combination, PAD, Planes, SampleLanes, combine, padded_row};
use super::super::quads::{self, Quad, window, with_spare};
use super::super::row_parts::{OutputRow, RowBlock, RowSpan};
use super::super::sample_rows::DecodedRows;
use super::super::statistics::Statistics;
use super::super::ycocg::YCoCg;
use super::super::{
    HistoryFilter, HistoryOptions, HistoryStep, Lattice, Motion, PastColor, Rejection, Scale, Tap, UpscaleInputs,
    Upscaling,
};
use super::{MOVING_WEIGHT, jitter_of};
use crate::image::{Image, Rgba8};
use crate::math::lanes::*;

/// Sharpness of the Gaussian that weights samples by their squared distance from the pixel, in output pixels. It
/// approximates a Blackman-Harris window of width 3.3 (Karis, 2014).
const SHARPNESS: f64 = 2.29;

/// Coefficients of t³, t², t and 1 in the weights of four adjacent values for an interpolation at `t` in [0, 1) between
/// the second and the third (Catmull and Rom, “A Class of Local Interpolating Splines”, 1974).
const CATMULL_ROM: [[f32; 4]; 4] =
    [[-0.5, 1.0, -0.5, 0.0], [1.5, -2.5, 0.0, 1.0], [-1.5, 2.0, 0.5, 0.0], [0.5, -0.5, 0.0, 0.0]];

/// Samples along one axis that contribute to an output column or row: three adjacent ones, clamped to the image.
#[derive(Clone, Copy, Debug)]
struct AxisSamples {
    index: [u32; 3],
    /// Index of the middle one in a padded row.
    padded: u32,
    /// Share of each sample.
    share: [f32; 3],
    /// Sum of the weights of the samples, which is 1 for a single one at the centre of the pixel.
    total: f32,
}

/// [`AxisSamples`] of all columns. Those of sixteen can be loaded from every column.
struct ColumnLanes {
    padded: Vec<u32>,
    share: [Vec<f32>; 3],
    total: Vec<f32>,
}

/// Frame to upscale, with its history.
pub(super) struct TaaFrame<'a> {
    options: HistoryOptions,
    colors: YCoCg,
    drawn: &'a UpscaleInputs<'a>,
    size: (u32, u32),
    scale: Scale,
    columns: Vec<AxisSamples>,
    column_lanes: ColumnLanes,
    rows: Vec<AxisSamples>,
    history: Option<(Motion<'a>, &'a Image<Quad>)>,
    /// Limit of the accumulated weight of the history.
    most_weight: f32,
    /// Whether every jitter position has been drawn since the view became still; the image then no longer changes.
    is_settled: bool,
}

/// Buffers for the rows of a band.
pub(super) struct RowScratch {
    samples: DecodedRows,
    /// Means of three vertically adjacent samples, with the shares of the row; padded.
    vertical: Planes,
    statistics: Statistics,
    /// `None` if there is no G-buffer.
    vectors: Option<DilatedVectors>,
}

/// One pixel of the picture.
pub(super) struct TaaPixel {
    pub(super) codes: Rgba8,
    /// History for the next frame.
    #[cfg_attr(not(test), expect(dead_code, reason = "tests compare it with that of rows"))]
    pub(super) memory: Quad,
    /// Blending with the history.
    pub(super) step: HistoryStep,
}

/// Colours of sixteen pixels, from the samples of this frame.
struct Present<S: Simd> {
    /// Y, Co, Cg and alpha.
    color: [f32x16<S>; 4],
    /// Weight of the colours, relative to 1 for a sample at the centre of the pixel; at most 1.
    confidence: f32x16<S>,
}

/// Blending of sixteen pixels with their history.
struct Blend<S: Simd> {
    present: Present<S>,
    past: Past<S>,
}

/// History of sixteen pixels. Where it is not known, the numbers are not meaningful.
struct Past<S: Simd> {
    is_known: mask32x16<S>,
    /// Position in the previous frame, in pixels.
    place: [f32x16<S>; 2],
    /// Colour, and accumulated weight.
    read: [f32x16<S>; 4],
    rectified: [f32x16<S>; 3],
    /// Accumulated weight within its limit.
    weight: f32x16<S>,
    /// Share of this frame, in [0, 1].
    share: f32x16<S>,
}

impl<'a> TaaFrame<'a> {
    pub(super) fn new(how: Upscaling, drawn: &'a UpscaleInputs<'a>, size: (u32, u32)) -> Self {
        let scale = how.scale();
        let jitter = jitter_of(scale);
        let Continuation { place, history, is_settled } = Continuation::new(drawn, jitter);
        let is_still = history.as_ref().is_some_and(|(motion, _)| motion.is_still());
        let samples = drawn.color.size();
        let axis = |place: f64, length: u32, samples: u32| {
            let all = (0..length).map(|at| AxisSamples::new(how.lattice(), place, at, samples));
            all.collect::<Vec<_>>()
        };
        let columns = axis(place[0], size.0, samples.0);
        Self {
            options: how.history(),
            colors: YCoCg::new(how.light()),
            drawn,
            size,
            scale,
            column_lanes: ColumnLanes::new(&columns),
            columns,
            rows: axis(place[1], size.1, samples.1),
            history: history.map(|(motion, accumulated)| (motion, &accumulated.color)),
            most_weight: if is_still { (jitter.positions() - 1) as f32 } else { MOVING_WEIGHT },
            is_settled,
        }
    }

    pub(super) fn scratch(&self) -> RowScratch {
        let samples = self.drawn.color.width();
        RowScratch {
            samples: DecodedRows::new(samples),
            vertical: [0; 4].map(|_| padded_row(samples)),
            statistics: Statistics::new(samples),
            vectors: self.drawn.frame.as_ref().map(DilatedVectors::new),
        }
    }

    /// Computes a row of the picture and of the history for the next frame.
    #[inline(always)]
    pub(super) fn row<S: Simd>(
        &self,
        simd: S,
        scratch: &mut RowScratch,
        OutputRow { y, pixels, history }: OutputRow<'_>,
    ) {
        self.prepare(simd, &RowSpan { columns: 0..pixels.len(), y }, scratch);
        let blocks = pixels.chunks_mut(WIDE).zip(history.chunks_mut(WIDE));
        for (from, (pixels, history)) in (0..).step_by(WIDE).zip(blocks) {
            let (codes, quads) = self.finished(simd, &self.block(simd, RowBlock { from, y }, scratch));
            store_in(pixels, &codes);
            store_in(history, &quads);
        }
    }

    /// Computes one pixel, bit-identical to [`Self::row`].
    pub(super) fn pixel(&self, at @ (x, y): (u32, u32), scratch: &mut RowScratch) -> TaaPixel {
        let (simd, from) = (baseline(), x as usize);
        self.prepare(simd, &RowSpan { columns: from..from + 1, y }, scratch);
        let blend = self.block(simd, RowBlock { from, y }, scratch);
        let ([codes, ..], [memory, ..]) = self.finished(simd, &blend);
        TaaPixel { codes, memory, step: self.step(blend, at) }
    }

    /// Returns how the first of sixteen pixels is blended with its history.
    fn step<S: Simd>(&self, Blend { present, past }: Blend<S>, at: (u32, u32)) -> HistoryStep {
        let first = |numbers: f32x16<S>| numbers.to_array()[0];
        let reprojected = self.drawn.frame.map_or(Err(Rejection::FirstFrame), |frame| frame.reproject_dilated(at));
        let past = self.history.as_ref().ok_or(Rejection::FirstFrame).and_then(|_| reprojected.map(|_| past));
        let share = past.as_ref().map_or(1.0, |past| first(past.share));
        let [y, co, cg, _] = present.color;
        let past = past.map(|Past { place, read: [y, co, cg, _], rectified, .. }| PastColor {
            position_px: place.map(first),
            read: [y, co, cg].map(first),
            rectified: rectified.map(first),
        });
        HistoryStep { space: self.colors.space(), present: [y, co, cg].map(first), share, past }
    }

    /// Prepares all inputs of a range of pixels.
    #[inline(always)]
    fn prepare<S: Simd>(&self, simd: S, span: &RowSpan, scratch: &mut RowScratch) {
        let RowScratch { samples, vertical, statistics, vectors } = scratch;
        let RowSpan { columns, y } = span;
        let row = self.rows[*y as usize];
        let [first, last] = [columns.start, columns.end - 1].map(|column| self.columns[column].padded as usize);
        let read = first - 1..last + 2;
        for y in row.index {
            samples.fill(simd, self.colors, self.drawn.color, &RowSpan { columns: read.clone(), y });
        }
        let rows = samples.three(row.index, read);
        if self.scale != Scale::ONE {
            for (channel, vertical) in vertical.iter_mut().enumerate() {
                let runs = each!(i in [0, 1, 2] => &rows.planes[i][channel][rows.range.start..]);
                combine(simd, runs, vertical, &rows.range, Combination::Weighted(row.share));
            }
        }
        let motion = self.history.as_ref().and_then(|(motion, _)| motion.vectors);
        if let (Some(motion), Some(frame), Some(vectors)) = (motion, self.drawn.frame, vectors) {
            statistics.fill(simd, self.options.rectification, rows);
            vectors.fill(simd, frame.gbuffer, motion, span);
        }
    }

    /// Blends sixteen pixels, which must have been prepared.
    #[inline(always)]
    fn block<S: Simd>(&self, simd: S, at: RowBlock, scratch: &RowScratch) -> Blend<S> {
        let present = self.present(simd, at, scratch);
        let past = match &self.history {
            None => Past::none(simd),
            Some((Motion { vectors: None, .. }, history)) => self.past_of_still(simd, at, history),
            Some((_, history)) => self.past_of_moving(simd, at, scratch, history),
        };
        Blend { past: self.weighted(simd, &present, past), present }
    }

    /// Returns the samples nearest to sixteen pixels from column `from` on.
    #[inline(always)]
    fn nearest_samples<S: Simd>(&self, simd: S, from: usize) -> SampleLanes<S> {
        let padded: &[u32; WIDE] = window(&self.column_lanes.padded, from);
        match self.scale {
            Scale::ONE => SampleLanes::Adjacent(padded[0] as usize),
            _ => SampleLanes::ascending(simd, padded),
        }
    }

    /// Returns the colours of sixteen pixels from the samples of this frame alone.
    #[inline(always)]
    fn present<S: Simd>(&self, simd: S, RowBlock { from, y }: RowBlock, scratch: &RowScratch) -> Present<S> {
        let samples = self.nearest_samples(simd, from);
        if self.scale == Scale::ONE {
            let row = scratch.samples.row(self.rows[y as usize].index[1]);
            let color = each!(channel in [0, 1, 2, 3] => samples.read(simd, &row[channel]));
            return Present { color, confidence: f32x16::splat(simd, 1.0) };
        }
        let ColumnLanes { share, total, .. } = &self.column_lanes;
        let [a, b, c] = each!(i in [0, 1, 2] => f32x16::load_array_ref(simd, window(&share[i], from)));
        let color = each!(channel in [0, 1, 2, 3] => {
            let [left, at, right] = each!(by in [0, 1, 2] => samples.read_beside(simd, &scratch.vertical[channel], by));
            left * a + at * b + right * c
        });
        let confidence = f32x16::load_array_ref(simd, window(total, from)) * self.rows[y as usize].total;
        Present { color, confidence: confidence.min(1.0) }
    }

    /// Returns the history of sixteen pixels in a still view.
    #[inline(always)]
    fn past_of_still<S: Simd>(&self, simd: S, at: RowBlock, history: &Image<Quad>) -> Past<S> {
        let row = &history.row(at.y)[at.from..];
        let mut block = [[0.0; 4]; WIDE];
        let read = row.len().min(WIDE);
        block[..read].copy_from_slice(&row[..read]);
        let zero = f32x16::splat(simd, 0.0);
        let read @ [y, co, cg, _] = quads::columns(simd, &block);
        Past {
            is_known: zero.simd_eq(zero),
            place: centers(simd, at),
            read,
            rectified: [y, co, cg],
            weight: zero,
            share: zero,
        }
    }

    /// Returns the history of sixteen pixels at the positions to which motion vectors lead.
    #[inline(always)]
    fn past_of_moving<S: Simd>(&self, simd: S, at: RowBlock, scratch: &RowScratch, history: &Image<Quad>) -> Past<S> {
        let vectors = match &scratch.vectors {
            Some(vectors) => vectors.load(simd, at.from),
            None => [f32x16::splat(simd, f32::NAN); 2],
        };
        let places = PastPlaces::new(simd, at, vectors, self.size);
        let mut block = [[0.0; 4]; WIDE];
        match self.options.filter {
            HistoryFilter::Bilinear => places.read_bilinear(simd, history, &mut block),
            HistoryFilter::CatmullRom => {
                let [across, down] = each!(axis in [0, 1] => catmull_rom(places.fraction[axis]));
                places.read_filtered::<false>(simd, history, &FilterWeights { across, down }, &mut block);
            }
        }
        let read = quads::columns(simd, &block);
        let [y, co, cg, _] = read;
        let samples = self.nearest_samples(simd, at.from);
        let rectified = scratch.statistics.rectified(simd, [y, co, cg], self.options.rectification, &samples);
        let zero = f32x16::splat(simd, 0.0);
        Past { is_known: places.is_known, place: places.place, read, rectified, weight: zero, share: zero }
    }

    /// Returns the history with the weights and shares of the blending.
    #[inline(always)]
    fn weighted<S: Simd>(&self, simd: S, present: &Present<S>, mut past: Past<S>) -> Past<S> {
        let zero = f32x16::splat(simd, 0.0);
        let weight = past.read[3].max(zero).min(self.most_weight);
        let mut weights = [present.confidence, weight];
        if self.options.luminance_weighting {
            // Each colour counts 1 / (1 + its luminance relative to white). Both are multiplied by the product of the
            // divisors.
            let [now, then] = each!(y in [present.color[0], past.rectified[0]] => y.max(zero) + self.colors.white());
            weights = [present.confidence * then, weight * now];
        }
        let share = if self.is_settled { zero } else { weights[0] / (weights[1] + weights[0]) };
        (past.weight, past.share) = (weight, share);
        past
    }

    /// Returns the codes of sixteen pixels and their history for the next frame.
    #[inline(always)]
    fn finished<S: Simd>(&self, simd: S, blend: &Blend<S>) -> ([Rgba8; WIDE], [Quad; WIDE]) {
        let Present { color: [y, co, cg, alpha], confidence } = blend.present;
        let (past, present) = (&blend.past, [y, co, cg]);
        let color @ [y, co, cg] = each!(i in [0, 1, 2] => {
            past.is_known.select(past.rectified[i] + (present[i] - past.rectified[i]) * past.share, present[i])
        });
        let weight = past.is_known.select(past.weight + confidence, confidence);
        let mut quads = [[0.0; 4]; WIDE];
        quads::store([y, co, cg, weight], &mut quads);
        (self.colors.encode(simd, color, alpha), quads)
    }

    /// Returns the samples that contribute to a pixel. Those that only rectify the history have weight 0.
    pub(super) fn taps(&self, (x, y): (u32, u32)) -> Vec<Tap> {
        let (columns, rows) = (self.columns[x as usize], self.rows[y as usize]);
        let mut taps: Vec<Tap> = Vec::new();
        for (y, vertical) in rows.index.into_iter().zip(rows.share) {
            for (x, horizontal) in columns.index.into_iter().zip(columns.share) {
                let weight = horizontal * vertical;
                match taps.iter_mut().find(|tap| (tap.x, tap.y) == (x, y)) {
                    Some(tap) => tap.weight += weight,
                    None => taps.push(Tap { x, y, weight }),
                }
            }
        }
        taps
    }
}

impl<S: Simd> Past<S> {
    /// Returns the state of pixels without history.
    #[inline(always)]
    fn none(simd: S) -> Self {
        let zero = f32x16::splat(simd, 0.0);
        let is_known = zero.simd_gt(zero);
        Self { is_known, place: [zero; 2], read: [zero; 4], rectified: [zero; 3], weight: zero, share: zero }
    }
}

impl ColumnLanes {
    fn new(columns: &[AxisSamples]) -> Self {
        Self {
            padded: with_spare(columns, |column| column.padded),
            share: [0, 1, 2].map(|number| with_spare(columns, |column| column.share[number])),
            total: with_spare(columns, |column| column.total),
        }
    }
}

impl AxisSamples {
    /// Returns the samples around output column or row `at`, out of `samples` samples of a lattice. They lie at `place`
    /// within their areas.
    fn new(lattice: Lattice, place: f64, at: u32, samples: u32) -> Self {
        let ThreeSamples { index, nearest, from_nearest } = lattice.three_around(place, at, samples);
        let weight = [-1.0, 0.0, 1.0].map(|number: f64| {
            if lattice.scale == Scale::ONE {
                return if number == 0.0 { 1.0 } else { 0.0 };
            }
            let distance = (number - f64::from(from_nearest)) * lattice.scale.value();
            (-SHARPNESS * distance * distance).exp() as f32
        });
        let total = weight.iter().sum();
        Self { index, padded: (nearest + PAD as i64) as u32, share: weight.map(|weight| weight / total), total }
    }
}

/// Returns the weights of four adjacent values for an interpolation at `t` in [0, 1) between the second and the third.
#[inline(always)]
pub(super) fn catmull_rom<S: Simd>(t: f32x16<S>) -> [f32x16<S>; 4] {
    each!(i in [0, 1, 2, 3] => {
        let [cubic, square, linear, constant] = CATMULL_ROM[i];
        ((t * cubic + square) * t + linear) * t + constant
    })
}
