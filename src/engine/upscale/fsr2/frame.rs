//! Blending of the samples of a frame with its history, pixel by pixel. A pixel's four numbers are one SIMD vector.

use super::super::history::whole_and_fraction;
use super::super::sample_rows::DecodedRows;
use super::super::ycocg::{Quad, YCoCg};
use super::super::{Accumulated, CENTRE, HistoryStep, Motion, PastColor, Rejection, UpscaleInputs, Upscaling};
use super::kernel::{AxisSamples, Kernel, history_weights};
use super::locks::{Contrast, Lock, Luminances};
use super::{jitter, jitter_positions};
use crate::image::{Image, Rgba8};
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

/// Frame to upscale, with its history.
pub(super) struct Fsr2Frame<'a> {
    colors: YCoCg,
    contrast: Contrast,
    drawn: &'a UpscaleInputs<'a>,
    size: (u32, u32),
    /// Upscaling factor per axis.
    scale: f32,
    /// Number of jitter positions.
    positions: u32,
    columns: Vec<AxisSamples>,
    rows: Vec<AxisSamples>,
    history: Option<(Motion<'a>, &'a Accumulated)>,
    /// Whether every jitter position has been drawn since the view became still; the image then no longer changes.
    is_settled: bool,
}

/// Colour codes and history of one pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Blended {
    pub(super) codes: Rgba8,
    pub(super) color: Quad,
    pub(super) lock: [f32; 2],
}

/// Rows of the history for the next frame.
pub(super) struct HistoryRow<'a> {
    pub(super) color: &'a mut [Quad],
    pub(super) locks: &'a mut [[f32; 2]],
}

/// History of a pixel.
struct Past<S: Simd> {
    /// Colour, and accumulated weight.
    color: f32x4<S>,
    /// Stored lock.
    lock: [f32; 2],
    /// Position in the previous frame, in pixels.
    place: [f32; 2],
    /// Length of the motion vector in pixels; `None` if camera and scene are still.
    speed_px: Option<f32>,
}

/// Blending of a pixel with its history.
struct Blend<S: Simd> {
    present: f32x4<S>,
    /// History, and its colour after rectification.
    past: Result<(Past<S>, f32x4<S>), Rejection>,
    /// Share of this frame, in [0, 1].
    share: f32,
    /// Accumulated weight of the pixel for the next frame.
    weight: f32,
    /// Stored lock of the pixel for the next frame.
    lock: [f32; 2],
}

/// The 3 × 3 samples around a pixel: their weighted mean, and the box of their colours.
struct Around<S: Simd> {
    present: f32x4<S>,
    /// Weight of the present colour.
    weight: f32,
    least: f32x4<S>,
    greatest: f32x4<S>,
    mean: f32x4<S>,
    deviation: f32x4<S>,
}

impl<'a> Fsr2Frame<'a> {
    pub(super) fn new(how: Upscaling, drawn: &'a UpscaleInputs<'a>, size: (u32, u32)) -> Self {
        let scale = how.scale();
        let place = drawn.frame.map_or(CENTRE, |seen| jitter(scale, seen.frames()));
        let history: Option<(Motion<'_>, _)> =
            drawn.frame.and_then(|seen| Some((seen.reprojection()?, seen.history?.accumulated.as_ref()?)));
        let (positions, samples) = (jitter_positions(scale), drawn.color.size());
        let axis = |place: f64, length: u32, samples: u32| {
            (0..length).map(|at| AxisSamples::new(how.lattice(), place, at, samples)).collect()
        };
        let is_settled = |motion: &Motion<'_>| motion.is_still() && motion.history.still_frames >= positions;
        let colors = YCoCg::new(how.light());
        Self {
            colors,
            contrast: Contrast::of(colors),
            drawn,
            size,
            scale: scale.value() as f32,
            positions,
            columns: axis(place[0], size.0, samples.0),
            rows: axis(place[1], size.1, samples.1),
            history,
            is_settled: history.as_ref().is_some_and(|(motion, _)| is_settled(motion)),
        }
    }

    pub(super) fn decoded_rows(&self) -> DecodedRows {
        DecodedRows::new(self.drawn.color.width())
    }

    /// Computes a row of the picture without sharpening, and of the history for the next frame.
    #[inline(always)]
    pub(super) fn row<S: Simd>(
        &self,
        simd: S,
        y: u32,
        decoded: &mut DecodedRows,
        (row, history): (&mut [Rgba8], HistoryRow<'_>),
    ) {
        let rows = self.rows[y as usize].index;
        for index in rows {
            decoded.fill(index, |codes| self.colors.decoded(codes), self.drawn.color);
        }
        let [above, at, below] = rows.map(|index| decoded.row(index));
        let history = history.color.iter_mut().zip(history.locks);
        for (x, (codes, (color, lock))) in (0..).zip(row.iter_mut().zip(history)) {
            let columns = self.columns[x as usize].index;
            let samples = each!(row in [above, at, below] => {
                each!(place in [0, 1, 2] => f32x4::load_array_ref(simd, &row[columns[place] as usize]))
            });
            let pixel = self.blended(simd, (x, y), samples);
            (*codes, *color, *lock) = (pixel.codes, pixel.color, pixel.lock);
        }
    }

    /// Computes one pixel of the picture without sharpening, and of the history for the next frame.
    #[inline(always)]
    pub(super) fn pixel<S: Simd>(&self, simd: S, at: (u32, u32)) -> Blended {
        self.blended(simd, at, self.samples(simd, at))
    }

    /// Computes one pixel of the picture without sharpening.
    pub(super) fn plain_pixel(&self, at: (u32, u32)) -> Rgba8 {
        on_lanes!(Lanes::best(), simd => self.pixel(simd, at).codes)
    }

    /// Returns the samples around a pixel and their weights in its present colour, which sum to 1. Samples at the border
    /// may occur several times.
    pub(super) fn sample_weights(&self, (x, y): (u32, u32)) -> impl Iterator<Item = ((u32, u32), f32)> {
        let (columns, rows) = (self.columns[x as usize], self.rows[y as usize]);
        let weights = on_lanes!(Lanes::best(), simd => {
            let past = self.past(simd, (x, y));
            Kernel::new(simd, &columns, &rows, self.narrowing(past.as_ref().ok())).lanczos
        });
        let row = move |(row, weights): (u32, [f32; 3])| {
            columns.index.into_iter().zip(weights).map(move |(column, weight)| ((column, row), weight))
        };
        rows.index.into_iter().zip(weights).flat_map(row)
    }

    /// Returns how one pixel is blended with its history, before sharpening.
    pub(super) fn step(&self, at: (u32, u32)) -> HistoryStep {
        on_lanes!(Lanes::best(), simd => {
            let color = |quad: f32x4<_>| quad.to_array().first_chunk().copied().unwrap_or_default();
            let (_, blend) = self.blend(simd, at, self.samples(simd, at));
            let past = blend.past.map(|(past, rectified)| PastColor {
                position_px: past.place,
                read: color(past.color),
                rectified: color(rectified),
            });
            HistoryStep { space: self.colors.space(), present: color(blend.present), share: blend.share, past }
        })
    }

    /// Returns the 3 × 3 samples around a pixel.
    #[inline(always)]
    fn samples<S: Simd>(&self, simd: S, at: (u32, u32)) -> [[f32x4<S>; 3]; 3] {
        let (columns, rows) = (self.columns[at.0 as usize].index, self.rows[at.1 as usize].index);
        each!(row in [0, 1, 2] => each!(column in [0, 1, 2] => {
            f32x4::load_array(simd, self.colors.decoded(self.drawn.color.at(columns[column], rows[row])))
        }))
    }

    /// Returns the picture and the history of a pixel with these samples around it.
    #[inline(always)]
    fn blended<S: Simd>(&self, simd: S, at: (u32, u32), samples: [[f32x4<S>; 3]; 3]) -> Blended {
        let (around, blend) = self.blend(simd, at, samples);
        let color = match blend.past {
            Ok((_, rectified)) => rectified + (blend.present - rectified) * blend.share,
            Err(_) => blend.present,
        };
        self.pixel_of(color, blend.weight, &around, blend.lock)
    }

    /// Returns the samples around a pixel, and how they are blended with its history.
    #[inline(always)]
    fn blend<S: Simd>(&self, simd: S, at: (u32, u32), samples: [[f32x4<S>; 3]; 3]) -> (Around<S>, Blend<S>) {
        let (columns, rows) = (&self.columns[at.0 as usize], &self.rows[at.1 as usize]);
        let past = self.past(simd, at);
        let narrowing = self.narrowing(past.as_ref().ok());
        let around = Around::new(simd, &samples, &Kernel::new(simd, columns, rows, narrowing));
        let present = around.present;
        let may_lock = columns.is_inside && rows.is_inside;
        let past = match past {
            Ok(past) => past,
            Err(rejection) => {
                let lock = self.lock(Lock::NONE, may_lock, &samples).stored();
                let weight = around.weight;
                return (around, Blend { present, past: Err(rejection), share: 1.0, weight, lock });
            }
        };
        let [.., weight] = past.color.to_array();
        if self.is_settled {
            let (lock, color) = (past.lock, past.color);
            return (around, Blend { present, past: Ok((past, color)), share: 0.0, weight, lock });
        }
        let old_lock = Lock::from_stored(past.lock);
        let lock = self.lock(old_lock, may_lock, &samples);
        let (mut rectified, mut most_weight) = (past.color, f32::INFINITY);
        if let Some(speed_px) = past.speed_px {
            let strength = if lock == Lock::NONE { 0.0 } else { old_lock.strength() };
            rectified = around.rectified(rectified, self.deviations(speed_px), strength);
            most_weight = limit_of_weight(speed_px, narrowing);
        }
        let weight = weight.max(0.0).min(most_weight);
        let total = weight + around.weight;
        let share = around.weight / total;
        let lock = lock.stored();
        (around, Blend { present, past: Ok((past, rectified)), share, weight: total, lock })
    }

    /// Returns the pixel of a colour with its accumulated weight. Its alpha is that of the samples.
    #[inline(always)]
    fn pixel_of<S: Simd>(&self, color: f32x4<S>, weight: f32, around: &Around<S>, lock: [f32; 2]) -> Blended {
        let [.., alpha] = around.present.to_array();
        let color @ [y, co, cg, _] = color.to_array();
        Blended { codes: self.colors.encoded(color, alpha), color: [y, co, cg, weight], lock }
    }

    /// Returns the narrowing of the kernel: the more history a pixel has, the nearer the samples must be that count.
    #[inline(always)]
    fn narrowing<S: Simd>(&self, past: Option<&Past<S>>) -> f32 {
        let Some(past) = past else { return 1.0 };
        let [.., weight] = past.color.to_array();
        1.0 + (self.scale - 1.0) * ((weight - 0.5) * (1.0 / 3.0)).clamp(0.0, 1.0)
    }

    /// Returns half the size of the box to which the history is rectified, in standard deviations.
    #[inline(always)]
    fn deviations(&self, speed_px: f32) -> f32 {
        let area = self.scale * self.scale;
        let still = (area * area * area).min(MOST_DEVIATIONS);
        still + (1.0 - still) * (speed_px * (1.0 / FAST_PX)).min(1.0)
    }

    /// Returns the lock of a pixel after this frame. `may_lock` is whether the middle sample lies inside the pixel.
    #[inline(always)]
    fn lock<S: Simd>(&self, old: Lock, may_lock: bool, samples: &[[f32x4<S>; 3]; 3]) -> Lock {
        if !may_lock && old == Lock::NONE {
            return Lock::NONE;
        }
        let [[a, b, c], [d, e, f], [g, h, i]] = samples;
        let luminances: Luminances = each!(sample in [a, b, c, d, e, f, g, h, i] => sample.to_array()[0]);
        if may_lock && self.contrast.is_thin(&luminances) {
            return Lock::new(&luminances);
        }
        if old == Lock::NONE { old } else { old.aged(self.positions, &luminances, self.contrast) }
    }

    /// Returns the history of a pixel.
    #[inline(always)]
    fn past<S: Simd>(&self, simd: S, at: (u32, u32)) -> Result<Past<S>, Rejection> {
        let (_, Accumulated { color, locks }) = self.history.as_ref().ok_or(Rejection::FirstFrame)?;
        let frame = self.drawn.frame.ok_or(Rejection::FirstFrame)?;
        let before = frame.reproject_dilated(at)?;
        let place @ [x, y] = before.place;
        let lock = locks.as_ref().map_or([0.0; 2], |locks| before.read(self.size, |x, y| locks.at(x, y)));
        if before.is_still {
            let color = f32x4::load_array(simd, color.at(x as u32, y as u32));
            return Ok(Past { color, lock, place, speed_px: None });
        }
        let [across, down] = [x - (at.0 as f32 + 0.5), y - (at.1 as f32 + 0.5)];
        let speed_px = (across * across + down * down).sqrt();
        Ok(Past { color: self.read(simd, color, place), lock, place, speed_px: Some(speed_px) })
    }

    /// Reads the history between its pixels, filtered by 4 × 4 pixels and clamped to the range of the nearest 2 × 2.
    #[inline(always)]
    fn read<S: Simd>(&self, simd: S, color: &Image<Quad>, [x, y]: [f32; 2]) -> f32x4<S> {
        let ((column, right), (row, down)) = (whole_and_fraction(x), whole_and_fraction(y));
        let inside = |at: i64, length: u32| at.clamp(0, i64::from(length) - 1);
        let columns = each!(by in [-1, 0, 1, 2] => inside(column + by, self.size.0) as usize);
        let across = history_weights(simd, right);
        let mut sum = f32x4::splat(simd, 0.0);
        let (mut least, mut greatest) = (f32x4::splat(simd, f32::INFINITY), f32x4::splat(simd, f32::NEG_INFINITY));
        for (by, weight) in (-1..).zip(history_weights(simd, down)) {
            let row = color.row(inside(row + by, self.size.1) as u32);
            let [a, b, c, d] = each!(place in [0, 1, 2, 3] => f32x4::load_array_ref(simd, &row[columns[place]]));
            sum += (a * across[0] + b * across[1] + c * across[2] + d * across[3]) * weight;
            if by == 0 || by == 1 {
                least = least.min(b.min(c));
                greatest = greatest.max(b.max(c));
            }
        }
        sum.max(least).min(greatest)
    }
}

/// Returns the limit of the accumulated weight of a pixel that moves at this speed.
#[inline(always)]
fn limit_of_weight(speed_px: f32, narrowing: f32) -> f32 {
    let frame = AVERAGE_WEIGHT / (narrowing * narrowing);
    let moving = (speed_px * (1.0 / MOVING_PX)).min(1.0);
    let limit = MOST_WEIGHT + (MOVING_FRAMES * frame - MOST_WEIGHT) * moving;
    limit + (frame - limit) * (speed_px * (1.0 / FAST_PX)).min(1.0)
}

impl<S: Simd> Around<S> {
    #[inline(always)]
    fn new(simd: S, samples: &[[f32x4<S>; 3]; 3], kernel: &Kernel) -> Self {
        let zero = f32x4::splat(simd, 0.0);
        let (mut present, mut mean, mut square) = (zero, zero, zero);
        let (mut least, mut greatest) = (samples[1][1], samples[1][1]);
        for (samples, (lanczos, window)) in samples.iter().zip(kernel.lanczos.iter().zip(&kernel.window)) {
            for (sample, (lanczos, window)) in samples.iter().zip(lanczos.iter().zip(window)) {
                let weighted = *sample * *window;
                present += *sample * *lanczos;
                mean += weighted;
                square += weighted * *sample;
                least = least.min(*sample);
                greatest = greatest.max(*sample);
            }
        }
        Self {
            present: present.max(least).min(greatest),
            weight: kernel.sum,
            least,
            greatest,
            mean,
            deviation: (square - mean * mean).max(zero).sqrt(),
        }
    }

    /// Returns the history clamped to the box of the colours, which extends by a number of standard deviations to each side
    /// of the mean but not beyond the range. A lock keeps a share of the history as it is. The fourth number is not
    /// meaningful.
    #[inline(always)]
    fn rectified(&self, past: f32x4<S>, deviations: f32, lock: f32) -> f32x4<S> {
        let half = self.deviation * deviations;
        let (least, greatest) = (self.least.max(self.mean - half), self.greatest.min(self.mean + half));
        let clamped = past.max(least).min(greatest);
        clamped + (past - clamped) * lock
    }
}
