//! Second pass: blending of the samples of a frame with its history, eight pixels at a time.

use super::super::jitter::Continuation;
use super::super::quads::Quad;
use super::super::ycocg::YCoCg;
use super::super::{HistoryStep, Motion, PastColor, Rejection, Reprojected, Tap, UpscaleInputs, Upscaling};
use super::convert::{Convert, Converted};
use super::jitter_of;
use super::kernel::{Around, Axis, Position, Shape, is_near};
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
    size: (u32, u32),
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

/// Position of a pixel in the previous frame, and its history there; an error if it has none.
type PastOfPixel = Result<(Reprojected, Quad), Rejection>;

/// Samples of a row, stretched to the width of the picture: by place among three columns and by channel.
type StretchedRow = [[Vec<f32>; 3]; 3];

/// Buffers of the rows of samples around a row of pixels.
pub(super) struct RowBuffers {
    /// Three adjacent rows of samples, each with its index.
    stretched: [(Option<u32>, StretchedRow); 3],
    /// Result of the first pass for a row of samples, with its index.
    converted: (Option<u32>, Vec<Converted>),
    decoded: Vec<Quad>,
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

/// Histories of eight pixels, one per lane.
struct PastLanes {
    /// Colour and accumulated weight.
    color: [[f32; LANES]; 4],
    /// 1 where there is a history, otherwise 0.
    is_known: [f32; LANES],
    speed_px: [f32; LANES],
    depth_clip: [f32; LANES],
}

/// Blending of eight pixels with their history.
struct Blend<S: Simd> {
    present: [F32<S>; 3],
    rectified: [F32<S>; 3],
    /// Colours after blending, before they are encoded.
    color: [F32<S>; 3],
    /// Share of this frame, in [0, 1].
    share: F32<S>,
    /// Accumulated weight for the next frame.
    weight: F32<S>,
}

impl RowBuffers {
    pub(super) fn new(frame: &Sgsr2Frame<'_>) -> Self {
        let width = frame.columns.index.len();
        let stretched = || [0; 3].map(|_| [0; 3].map(|_| vec![0.0; width]));
        let samples = frame.drawn.color.width() as usize;
        Self {
            stretched: [0; 3].map(|_| (None, stretched())),
            converted: (None, vec![Converted::default(); samples]),
            decoded: vec![[0.0; 4]; samples],
        }
    }

    /// Makes sure that a row of samples is decoded and stretched.
    #[inline(always)]
    fn fill(&mut self, frame: &Sgsr2Frame<'_>, index: u32) {
        let (held, stretched) = &mut self.stretched[index as usize % 3];
        if held.replace(index) == Some(index) {
            return;
        }
        for (quad, codes) in self.decoded.iter_mut().zip(frame.drawn.color.row(index)) {
            *quad = frame.colors.decoded(*codes);
        }
        for (place, planes) in stretched.iter_mut().enumerate() {
            for (channel, plane) in planes.iter_mut().enumerate() {
                for (value, columns) in plane.iter_mut().zip(&frame.columns.index) {
                    *value = self.decoded[columns[place] as usize][channel];
                }
            }
        }
    }

    /// Makes sure that the first pass is done for a row of samples.
    #[inline(always)]
    fn convert(&mut self, frame: &Sgsr2Frame<'_>, row: u32) {
        let Some(convert) = &frame.convert else { return };
        let (held, converted) = &mut self.converted;
        if held.replace(row) != Some(row) {
            for (column, converted) in (0..).zip(converted) {
                *converted = convert.sample((column, row));
            }
        }
    }
}

impl PastLanes {
    const NONE: Self =
        Self { color: [[0.0; LANES]; 4], is_known: [0.0; LANES], speed_px: [0.0; LANES], depth_clip: [0.0; LANES] };

    /// Sets the history of the pixel in a lane.
    #[inline(always)]
    fn set(&mut self, lane: usize, at: (u32, u32), depth_clip: f32, past: Option<(Reprojected, Quad)>) {
        let Some((before, color)) = past else { return };
        for (lanes, value) in self.color.iter_mut().zip(color) {
            lanes[lane] = value;
        }
        self.is_known[lane] = 1.0;
        self.depth_clip[lane] = depth_clip;
        let [x, y] = before.place;
        let [across, down] = [x - (at.0 as f32 + 0.5), y - (at.1 as f32 + 0.5)];
        self.speed_px[lane] = (across * across + down * down).sqrt();
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
            size,
            narrow: 0.5 * factor,
            wide: 0.5 * (0.3 + 0.3 * factor).max(1.0),
            deviations: (area * area * area).min(MOST_DEVIATIONS),
            columns: Axis::new(lattice, place[0], size.0, samples.0),
            rows: Axis::new(lattice, place[1], size.1, samples.1),
            convert: Convert::new(lattice, drawn).filter(|_| moves),
            is_settled,
            history: history.map(|(motion, accumulated)| (motion, &accumulated.color)),
        }
    }

    /// Computes a row of the picture and of the history for the next frame.
    #[inline(always)]
    pub(super) fn row<S: Simd>(
        &self,
        simd: S,
        y: u32,
        buffers: &mut RowBuffers,
        (row, memory): (&mut [Rgba8], &mut [Quad]),
    ) {
        let rows = self.rows.index[y as usize];
        for index in rows {
            buffers.fill(self, index);
        }
        buffers.convert(self, rows[1]);
        let samples = rows.map(|index| &buffers.stretched[index as usize % 3].1);
        let rows = self.rows.splat(simd, y as usize);
        let groups = row.chunks_mut(LANES).zip(memory.chunks_mut(LANES));
        for (first, (pixels, memory)) in (0..).step_by(LANES).zip(groups) {
            let mut past = PastLanes::NONE;
            for lane in 0..pixels.len() {
                let at = ((first + lane) as u32, y);
                let sample = self.columns.index[first + lane][1];
                let converted = self.convert.as_ref().map(|_| buffers.converted.1[sample as usize]);
                let (depth_clip, found) = self.past(at, converted);
                past.set(lane, at, depth_clip, found.ok());
            }
            let position = Position { columns: self.columns.load(simd, first), rows };
            let blend = self.blend(
                simd,
                &position,
                &past,
                #[inline(always)]
                |row, column| {
                    each!(channel in [0, 1, 2] => {
                        F32::from_slice(simd, &samples[row][column][channel][first..first + LANES])
                    })
                },
            );
            let ([luminance, orange, green], weight) =
                (each!(channel in [0, 1, 2] => blend.color[channel].to_array()), blend.weight.to_array());
            for (lane, (pixel, memory)) in pixels.iter_mut().zip(memory).enumerate() {
                *memory = [luminance[lane], orange[lane], green[lane], weight[lane]];
                *pixel = self.colors.encoded(*memory, self.alpha(((first + lane) as u32, y)));
            }
        }
    }

    /// Computes one pixel, bit-identical to [`Self::row`].
    pub(super) fn pixel(&self, at: (u32, u32)) -> Sgsr2Pixel {
        let first = |color: [F32<_>; 3]| color.map(|lanes| lanes.to_array()[0]);
        let (past, blend) = self.alone(baseline(), at);
        let [y, co, cg] = first(blend.color);
        let memory = [y, co, cg, blend.weight.to_array()[0]];
        let past = past.map(|(before, [y, co, cg, _])| PastColor {
            position_px: before.place,
            read: [y, co, cg],
            rectified: first(blend.rectified),
        });
        let (space, share) = (self.colors.space(), blend.share.to_array()[0]);
        let step = HistoryStep { space, present: first(blend.present), share, past };
        Sgsr2Pixel { codes: self.colors.encoded(memory, self.alpha(at)), memory, step }
    }

    /// Returns the samples that contribute to a pixel. Those that only rectify the history have weight 0.
    pub(super) fn taps(&self, at @ (x, y): (u32, u32)) -> Vec<Tap> {
        let simd = baseline();
        let (position, past) = (self.position(simd, at), self.past_alone(at).1);
        let shape = self.shape(simd, &past);
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

    /// Returns the history of one pixel, and how the pixel is blended with it. The blending is in the first lane.
    #[inline(always)]
    fn alone<S: Simd>(&self, simd: S, at: (u32, u32)) -> (PastOfPixel, Blend<S>) {
        let (found, past) = self.past_alone(at);
        let (columns, rows) = (self.columns.index[at.0 as usize], self.rows.index[at.1 as usize]);
        let blend = self.blend(
            simd,
            &self.position(simd, at),
            &past,
            #[inline(always)]
            |row, column| {
                let quad = self.colors.decoded(self.drawn.color.at(columns[column], rows[row]));
                each!(channel in [0, 1, 2] => F32::splat(simd, quad[channel]))
            },
        );
        (found, blend)
    }

    #[inline(always)]
    fn position<S: Simd>(&self, simd: S, (x, y): (u32, u32)) -> Position<S> {
        Position { columns: self.columns.splat(simd, x as usize), rows: self.rows.splat(simd, y as usize) }
    }

    /// Returns the history of one pixel, and the same in the first lane.
    fn past_alone(&self, at: (u32, u32)) -> (PastOfPixel, PastLanes) {
        let sample = (self.columns.index[at.0 as usize][1], self.rows.index[at.1 as usize][1]);
        let converted = self.convert.as_ref().map(|convert| convert.sample(sample));
        let (depth_clip, found) = self.past(at, converted);
        let mut past = PastLanes::NONE;
        past.set(0, at, depth_clip, found.ok());
        (found, past)
    }

    /// Returns the depth clip of a pixel, and its position in the previous frame with the history there.
    #[inline(always)]
    fn past(&self, at: (u32, u32), converted: Option<Converted>) -> (f32, PastOfPixel) {
        let Converted { vector_of, depth_clip } = converted.unwrap_or(Converted { vector_of: at, depth_clip: 0.0 });
        let read = |(motion, memory): &(Motion<'_>, &Image<Quad>)| {
            let before = motion.reproject_by(at, vector_of)?;
            Ok((before, before.read(self.size, |x, y| memory.at(x, y))))
        };
        (depth_clip, self.history.as_ref().ok_or(Rejection::FirstFrame).and_then(read))
    }

    /// Returns the alpha of a pixel as an 8-bit value: that of the nearest sample.
    #[inline(always)]
    fn alpha(&self, (x, y): (u32, u32)) -> f32 {
        let [.., alpha] = self.drawn.color.at(self.columns.index[x as usize][1], self.rows.index[y as usize][1]);
        f32::from(alpha)
    }

    /// Returns the shape of the kernel.
    #[inline(always)]
    fn shape<S: Simd>(&self, simd: S, past: &PastLanes) -> Shape<S> {
        let (clip, speed_px) = (F32::load_array(simd, past.depth_clip), F32::load_array(simd, past.speed_px));
        let inverse_radius = clip * (CLIP_IN_KERNEL * (self.wide - self.narrow)) + self.narrow;
        let fast = (speed_px * (1.0 / NARROW_BOX_PX)).min(F32::splat(simd, 1.0));
        Shape { narrowing: inverse_radius * inverse_radius, fast }
    }

    /// Blends eight pixels with their history.
    #[inline(always)]
    fn blend<S: Simd>(
        &self,
        simd: S,
        position: &Position<S>,
        past: &PastLanes,
        sample: impl Fn(usize, usize) -> [F32<S>; 3],
    ) -> Blend<S> {
        let around = position.around(simd, self.shape(simd, past), self.colors.white(), sample);
        let read = each!(channel in [0, 1, 2] => F32::load_array(simd, past.color[channel]));
        let stored = F32::load_array(simd, past.color[3]).max(F32::splat(simd, 0.0));
        let (rectified, weight) = match &self.convert {
            Some(_) => self.rectified(simd, &around, past, (read, stored)),
            None => (read, stored),
        };
        let one = F32::splat(simd, 1.0);
        let total = weight + around.weight;
        let mut share = around.weight / total.max(F32::splat(simd, LEAST_TOTAL));
        let mut total = total;
        if self.is_settled {
            (share, total) = (F32::splat(simd, 0.0), stored);
        }
        let is_known = F32::load_array(simd, past.is_known).simd_gt(0.0);
        let present = around.present;
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

    /// Returns the history of eight pixels in a changing view, clamped to the box of the colours, and its weight.
    #[inline(always)]
    fn rectified<S: Simd>(
        &self,
        simd: S,
        around: &Around<S>,
        past: &PastLanes,
        (read, stored): ([F32<S>; 3], F32<S>),
    ) -> ([F32<S>; 3], F32<S>) {
        let (one, zero) = (F32::splat(simd, 1.0), F32::splat(simd, 0.0));
        let (clip, speed_px) = (F32::load_array(simd, past.depth_clip), F32::load_array(simd, past.speed_px));
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
        let limited = |limit: F32<S>, other: F32<S>, share: F32<S>| limit.min(limit + (other - limit) * share);
        let moving = (speed_px * (1.0 / MOVING_PX)).min(one);
        let limit = limited(one - clip, around.weight * MOVING_FRAMES, moving);
        let limit = limited(limit, around.weight, fast);
        let weight = stored.min(limit.max(zero));
        (clamped, is_inside.select(weight, weight.min(F32::splat(simd, RECTIFIED_WEIGHT))))
    }
}
