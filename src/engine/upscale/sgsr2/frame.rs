//! Second pass: blending of the samples of a frame with its history, sixteen pixels of a row at a time.

use super::super::jitter::Continuation;
use super::super::planes::{PAD, SampleLanes};
use super::super::quads::{self, Quad, window};
use super::super::row_parts::{OutputRow, RowBlock, RowSpan};
use super::super::sample_rows::DecodedRows;
use super::super::statistics::Statistics;
use super::super::ycocg::YCoCg;
use super::super::{HistoryStep, Motion, PastColor, Rectification, Rejection, Tap, UpscaleInputs, Upscaling};
use super::convert::{Convert, Converted, MotionRow, SurfaceRows};
use super::jitter_of;
use super::kernel::{Around, Axis, Position, Samples, Shape, is_near};
use super::past::{MotionLanes, Past};
use crate::image::{Image, Rgba8};
use crate::math::lanes::*;

/// Maximum size of the box of colours, in standard deviations to each side of the mean.
const MOST_DEVIATIONS: f32 = 20.0;

/// Speed at which the history is limited to the weight of one frame, in pixels per frame.
const FAST_PX: f32 = 20.0;

/// Speed at which the history is limited to the weight of [`MOVING_FRAMES`], in pixels per frame.
const MOVING_PX: f32 = 0.1;

/// Number of frames to which the history of a moving pixel is limited.
const MOVING_FRAMES: f32 = 10.0;

/// Speed at which the box takes the weights of fast pixels, in pixels per frame.
const NARROW_BOX_PX: f32 = 50.0;

/// Limit of the weight of a history that the box has changed.
const RECTIFIED_WEIGHT: f32 = 0.1;

/// Smallest sum of the weights of present and history.
const LEAST_TOTAL: f32 = 1.192e-7;

/// Share of the depth clip in the width of the kernel.
const CLIP_IN_KERNEL: f32 = 0.25;

/// Frame to upscale, with its history.
pub(super) struct Sgsr2Frame<'a> {
    colors: YCoCg,
    drawn: &'a UpscaleInputs<'a>,
    /// Reciprocal of the kernel's radius at a depth clip of 0, in sample distances.
    narrow: f32,
    /// Reciprocal of the radius towards which the depth clip widens the kernel, in sample distances.
    wide: f32,
    /// Half the size of the box of a pixel that does not move, in standard deviations.
    deviations: f32,
    columns: Axis,
    rows: Axis,
    history: Option<(Motion<'a>, &'a Image<Quad>)>,
    /// First pass; `None` unless the view changes.
    convert: Option<Convert<'a>>,
    /// Whether every jitter position has been drawn since the view became still; the image then no longer changes.
    is_settled: bool,
}

/// Samples of a row, stretched to the width of the picture: by place among three columns and by channel.
type StretchedRow = [[Vec<f32>; 3]; 3];

/// Buffers of the rows of samples around a row of pixels.
pub(super) struct RowBuffers {
    /// Three adjacent rows of samples, each with its index.
    stretched: [(Option<u32>, StretchedRow); 3],
    /// Motion of a row of samples, with its index.
    motion: (Option<u32>, MotionRow),
    surfaces: SurfaceRows,
    decoded: DecodedRows,
    statistics: Statistics,
}

/// Samples around sixteen pixels of a row.
struct RowSamples<'a, S: Simd> {
    simd: S,
    /// Rows of samples before, at and after the pixels.
    rows: [&'a StretchedRow; 3],
    /// Column of the first pixel.
    first: usize,
    range: [[f32x16<S>; 3]; 2],
}

impl<S: Simd> Samples<S> for RowSamples<'_, S> {
    #[inline(always)]
    fn at(&self, row: usize, column: usize) -> [f32x16<S>; 3] {
        let planes = &self.rows[row][column];
        each!(channel in [0, 1, 2] => f32x16::from_slice(self.simd, &planes[channel][self.first..self.first + WIDE]))
    }

    #[inline(always)]
    fn range(&self) -> [[f32x16<S>; 3]; 2] {
        self.range
    }
}

/// Samples around one pixel, in all lanes.
struct PixelSamples<S: Simd>([[[f32x16<S>; 3]; 3]; 3]);

impl<S: Simd> Samples<S> for PixelSamples<S> {
    #[inline(always)]
    fn at(&self, row: usize, column: usize) -> [f32x16<S>; 3] {
        self.0[row][column]
    }

    #[inline(always)]
    fn range(&self) -> [[f32x16<S>; 3]; 2] {
        let (mut least, mut greatest) = (self.0[1][1], self.0[1][1]);
        for color in self.0.as_flattened() {
            least = each!(channel in [0, 1, 2] => least[channel].min(color[channel]));
            greatest = each!(channel in [0, 1, 2] => greatest[channel].max(color[channel]));
        }
        [least, greatest]
    }
}

/// One pixel of the picture.
pub(super) struct Sgsr2Pixel {
    pub(super) codes: Rgba8,
    /// History for the next frame.
    #[cfg_attr(not(test), expect(dead_code, reason = "tests compare it with that of rows"))]
    pub(super) memory: Quad,
    /// Blending with the history.
    pub(super) step: HistoryStep,
}

/// Blending of sixteen pixels with their history.
struct Blend<S: Simd> {
    present: [f32x16<S>; 3],
    rectified: [f32x16<S>; 3],
    /// Colours after blending, before they are encoded.
    color: [f32x16<S>; 3],
    /// Share of this frame, in [0, 1].
    share: f32x16<S>,
    /// Accumulated weight for the next frame.
    weight: f32x16<S>,
}

impl RowBuffers {
    pub(super) fn new(frame: &Sgsr2Frame<'_>) -> Self {
        let width = frame.columns.index.len();
        let stretched = || [0; 3].map(|_| [0; 3].map(|_| vec![0.0; width]));
        let samples = frame.drawn.color.width();
        Self {
            stretched: [0; 3].map(|_| (None, stretched())),
            motion: (None, MotionRow::new(samples)),
            surfaces: frame.surface_rows(),
            decoded: DecodedRows::new(samples),
            statistics: Statistics::new(samples),
        }
    }

    /// Makes sure that three rows of samples are decoded and stretched, and that their range is known.
    #[inline(always)]
    fn fill<S: Simd>(&mut self, simd: S, frame: &Sgsr2Frame<'_>, indices: [u32; 3]) {
        let padded = &frame.columns.padded;
        let [first, last] = [padded.first(), padded.last()].map(|at| at.map_or(PAD, |at| *at as usize));
        let read = first - 1..last + 2;
        for index in indices {
            let (held, stretched) = &mut self.stretched[index as usize % 3];
            if held.replace(index) == Some(index) {
                continue;
            }
            let span = RowSpan { columns: read.clone(), y: index };
            self.decoded.fill(simd, frame.colors, frame.drawn.color, &span);
            let decoded = self.decoded.row(index);
            for (from, padded) in (0..).step_by(WIDE).zip(padded.as_chunks().0) {
                let samples = SampleLanes::ascending(simd, padded);
                for (place, planes) in stretched.iter_mut().enumerate() {
                    for (plane, decoded) in planes.iter_mut().zip(decoded) {
                        samples.read_beside(simd, decoded, place).store_slice(&mut plane[from..from + WIDE]);
                    }
                }
            }
        }
        self.statistics.fill(simd, Rectification::Clamp, self.decoded.three(indices, read));
    }

    /// Makes sure that the first pass is done for a row of samples.
    #[inline(always)]
    fn find_motion<S: Simd>(&mut self, simd: S, frame: &Sgsr2Frame<'_>, row: u32) {
        let (held, motion) = &mut self.motion;
        if let Some(convert) = &frame.convert
            && held.replace(row) != Some(row)
        {
            convert.row(simd, row, &mut self.surfaces, motion);
        }
    }
}

impl<'a> Sgsr2Frame<'a> {
    pub(super) fn new(how: Upscaling, drawn: &'a UpscaleInputs<'a>, size: (u32, u32)) -> Self {
        let scale = how.scale();
        let Continuation { place, history, is_settled } = Continuation::new(drawn, jitter_of(scale));
        let (lattice, samples) = (how.lattice(), drawn.color.size());
        let moves = history.as_ref().is_some_and(|(motion, _)| !motion.is_still());
        let factor = scale.value() as f32;
        let area = factor * factor;
        Self {
            colors: YCoCg::new(how.light()),
            drawn,
            narrow: 0.5 * factor,
            wide: 0.5 * (0.3 + 0.3 * factor).max(1.0),
            deviations: (area * area * area).min(MOST_DEVIATIONS),
            columns: Axis::new(lattice, place[0], size.0, samples.0),
            rows: Axis::new(lattice, place[1], size.1, samples.1),
            convert: Convert::new(drawn).filter(|_| moves),
            is_settled,
            history: history.map(|(motion, accumulated)| (motion, &accumulated.color)),
        }
    }

    /// Computes a row of the picture and of the history for the next frame.
    #[inline(always)]
    pub(super) fn row<S: Simd>(
        &self,
        simd: S,
        buffers: &mut RowBuffers,
        OutputRow { y, pixels, history }: OutputRow<'_>,
    ) {
        let indices = self.rows.index[y as usize];
        buffers.fill(simd, self, indices);
        buffers.find_motion(simd, self, indices[1]);
        let stretched = indices.map(|index| &buffers.stretched[index as usize % 3].1);
        let [.., alphas] = buffers.decoded.row(indices[1]);
        let rows = self.rows.splat(simd, y as usize);
        let groups = pixels.chunks_mut(WIDE).zip(history.chunks_mut(WIDE));
        for (from, (pixels, history)) in (0..).step_by(WIDE).zip(groups) {
            let nearest = SampleLanes::ascending(simd, window(&self.columns.padded, from));
            let mut motion = MotionLanes::unknown(simd);
            if self.convert.is_some() {
                motion = buffers.motion.1.read(simd, &nearest);
            }
            let past = self.past(simd, RowBlock { from, y }, &motion);
            let range = buffers.statistics.range(simd, &nearest);
            let samples = RowSamples { simd, rows: stretched, first: from, range };
            let position = Position { columns: self.columns.load(simd, from), rows };
            let blend = self.blend(simd, &position, &past, &samples);
            let [y, co, cg] = blend.color;
            let mut quads = [[0.0; 4]; WIDE];
            quads::store([y, co, cg, blend.weight], &mut quads);
            store_in(history, &quads);
            store_in(pixels, &self.colors.encode(simd, [y, co, cg], nearest.read(simd, alphas)));
        }
    }

    /// Computes one pixel, bit-identical to [`Self::row`].
    pub(super) fn pixel(&self, at: (u32, u32), surfaces: &mut SurfaceRows) -> Sgsr2Pixel {
        let converted = self.converted(at, surfaces);
        let first = |numbers: f32x16<_>| numbers.to_array()[0];
        let (past, blend) = self.alone(baseline(), at, converted.as_ref());
        let [y, co, cg] = blend.color.map(first);
        let memory = [y, co, cg, first(blend.weight)];
        let past = self.rejection(at, converted.as_ref()).map(|()| PastColor {
            position_px: past.place.map(first),
            read: past.color.map(first),
            rectified: blend.rectified.map(first),
        });
        let (space, share) = (self.colors.space(), first(blend.share));
        let step = HistoryStep { space, present: blend.present.map(first), share, past };
        Sgsr2Pixel { codes: self.colors.encoded(memory, self.alpha(at)), memory, step }
    }

    /// Returns the samples that contribute to a pixel. Those that only rectify the history have weight 0.
    pub(super) fn taps(&self, at @ (x, y): (u32, u32)) -> Vec<Tap> {
        let simd = baseline();
        let position = self.position(simd, at);
        let converted = self.converted(at, &mut self.surface_rows());
        let shape = self.shape(simd, &self.past_alone(simd, at, converted.as_ref()));
        let (columns, rows) = (self.columns.index[x as usize], self.rows.index[y as usize]);
        let places = (0..3).flat_map(|row| (0..3).map(move |column| (row, column)));
        let weights: Vec<_> = places.map(|place| (place, position.weight(simd, shape, place).to_array()[0])).collect();
        let sum: f32 = weights.iter().map(|(_, weight)| weight).sum();
        let mut taps: Vec<Tap> = Vec::new();
        for ((row, column), weight) in weights {
            let is_middle = (row, column) == (1, 1);
            let weight = if is_near(sum) { weight / sum } else { f32::from(u8::from(is_middle)) };
            let (x, y) = (columns[column], rows[row]);
            match taps.iter_mut().find(|tap| (tap.x, tap.y) == (x, y)) {
                Some(tap) => tap.weight += weight,
                None => taps.push(Tap { x, y, weight }),
            }
        }
        taps
    }

    /// Returns the history of one pixel, and how the pixel is blended with it, both in the first lane.
    #[inline(always)]
    fn alone<S: Simd>(&self, simd: S, at: (u32, u32), converted: Option<&Converted>) -> (Past<S>, Blend<S>) {
        let past = self.past_alone(simd, at, converted);
        let (columns, rows) = (self.columns.index[at.0 as usize], self.rows.index[at.1 as usize]);
        let samples = PixelSamples(rows.map(|row| {
            columns.map(|column| {
                let quad = self.colors.decoded(self.drawn.color.at(column, row));
                each!(channel in [0, 1, 2] => f32x16::splat(simd, quad[channel]))
            })
        }));
        let blend = self.blend(simd, &self.position(simd, at), &past, &samples);
        (past, blend)
    }

    #[inline(always)]
    fn position<S: Simd>(&self, simd: S, (x, y): (u32, u32)) -> Position<S> {
        Position { columns: self.columns.splat(simd, x as usize), rows: self.rows.splat(simd, y as usize) }
    }

    /// Returns buffers for [`Self::pixel`].
    pub(super) fn surface_rows(&self) -> SurfaceRows {
        SurfaceRows::new(self.drawn.color.width())
    }

    /// Returns the result of the first pass for the sample nearest to a pixel; `None` in the first frame, and in a still
    /// view.
    fn converted(&self, (x, y): (u32, u32), surfaces: &mut SurfaceRows) -> Option<Converted> {
        let nearest = (self.columns.index[x as usize][1], self.rows.index[y as usize][1]);
        Some(self.convert.as_ref()?.sample(nearest, surfaces))
    }

    /// Returns why a pixel has no history, if it has none.
    fn rejection(&self, at: (u32, u32), converted: Option<&Converted>) -> Result<(), Rejection> {
        let (motion, _) = self.history.as_ref().ok_or(Rejection::FirstFrame)?;
        motion.reproject_by(at, converted.map_or(at, |converted| converted.vector_of)).map(|_| ())
    }

    /// Returns the history of one pixel in the first lane.
    #[inline(always)]
    fn past_alone<S: Simd>(&self, simd: S, at: (u32, u32), converted: Option<&Converted>) -> Past<S> {
        let mut motion = MotionLanes::unknown(simd);
        if let Some(Converted { vector_px, depth_clip, .. }) = converted {
            motion.vector_px = each!(axis in [0, 1] => f32x16::splat(simd, vector_px[axis]));
            motion.depth_clip = f32x16::splat(simd, *depth_clip);
        }
        self.past(simd, RowBlock { from: at.0 as usize, y: at.1 }, &motion)
    }

    /// Returns the history of sixteen pixels. `motion` is that of their nearest samples.
    #[inline(always)]
    fn past<S: Simd>(&self, simd: S, at: RowBlock, motion: &MotionLanes<S>) -> Past<S> {
        match &self.history {
            None => Past::none(simd),
            Some((_, history)) if self.convert.is_none() => Past::still(simd, history, at),
            Some((_, history)) => Past::moved(simd, history, at, motion),
        }
    }

    /// Returns the alpha of a pixel as an 8-bit value: that of the nearest sample.
    #[inline(always)]
    fn alpha(&self, (x, y): (u32, u32)) -> f32 {
        let [.., alpha] = self.drawn.color.at(self.columns.index[x as usize][1], self.rows.index[y as usize][1]);
        f32::from(alpha)
    }

    /// Returns the shape of the kernel.
    #[inline(always)]
    fn shape<S: Simd>(&self, simd: S, past: &Past<S>) -> Shape<S> {
        let inverse_radius = past.depth_clip * (CLIP_IN_KERNEL * (self.wide - self.narrow)) + self.narrow;
        let fast = (past.speed_px * (1.0 / NARROW_BOX_PX)).min(f32x16::splat(simd, 1.0));
        Shape { narrowing: inverse_radius * inverse_radius, fast }
    }

    /// Blends sixteen pixels with their history.
    #[inline(always)]
    fn blend<S: Simd>(&self, simd: S, position: &Position<S>, past: &Past<S>, samples: &impl Samples<S>) -> Blend<S> {
        let around = position.around(simd, self.shape(simd, past), self.colors.white(), samples);
        let (rectified, weight) = match &self.convert {
            Some(_) => self.rectified(simd, &around, past),
            None => (past.color, past.weight),
        };
        let one = f32x16::splat(simd, 1.0);
        let total = weight + around.weight;
        let mut share = around.weight / total.max(f32x16::splat(simd, LEAST_TOTAL));
        let mut total = total;
        if self.is_settled {
            (share, total) = (f32x16::splat(simd, 0.0), past.weight);
        }
        let (is_known, present) = (past.is_known, around.present);
        let color = each!(channel in [0, 1, 2] => {
            let blended = rectified[channel] + (present[channel] - rectified[channel]) * share;
            is_known.select(blended, present[channel])
        });
        Blend {
            present,
            rectified,
            color,
            share: is_known.select(share, one),
            weight: is_known.select(total, around.weight),
        }
    }

    /// Returns the history of sixteen pixels in a changing view, clamped to the box of the colours, and its weight.
    #[inline(always)]
    fn rectified<S: Simd>(&self, simd: S, around: &Around<S>, past: &Past<S>) -> ([f32x16<S>; 3], f32x16<S>) {
        let (one, zero) = (f32x16::splat(simd, 1.0), f32x16::splat(simd, 0.0));
        let Past { color: read, depth_clip: clip, speed_px, .. } = *past;
        let fast = (speed_px * (1.0 / FAST_PX)).min(one);
        let deviations = clip.max(fast) * (1.0 - self.deviations) + self.deviations;
        let clamped = each!(channel in [0, 1, 2] => {
            let half = around.deviation[channel] * deviations;
            let least = around.least[channel].max(around.mean[channel] - half);
            let greatest = around.greatest[channel].min(around.mean[channel] + half);
            read[channel].max(least).min(greatest)
        });
        let [y, co, cg] = each!(channel in [0, 1, 2] => clamped[channel].simd_eq(read[channel]));
        let is_inside = y & co & cg;
        let limited = |limit: f32x16<S>, other: f32x16<S>, share: f32x16<S>| limit.min(limit + (other - limit) * share);
        let moving = (speed_px * (1.0 / MOVING_PX)).min(one);
        let limit = limited(one - clip, around.weight * MOVING_FRAMES, moving);
        let limit = limited(limit, around.weight, fast);
        let weight = past.weight.min(limit.max(zero));
        (clamped, is_inside.select(weight, weight.min(f32x16::splat(simd, RECTIFIED_WEIGHT))))
    }
}
