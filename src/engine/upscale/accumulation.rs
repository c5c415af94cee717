//! Temporal accumulation: jitters the samples in every frame and blends them with the reprojected history.
//!
//! A pixel stores the mean of n earlier samples. A new sample has weight 1 / (n + 1) until n reaches its maximum; from
//! then on, old samples decay exponentially. In a still view, no sample decays until every jitter position has been
//! drawn once. The image becomes the mean over all positions of the jitter pattern, and further frames leave it
//! unchanged. In motion, the history is reprojected to where the previous frame showed the same surface. It is clamped
//! to the minimum and maximum of the surrounding 3 × 3 samples, which rejects stale colours and sometimes valid ones.
//!
//! When upscaling, a sample that lies inside an output pixel has full weight. If this frame has no sample inside the
//! pixel, the four surrounding samples are interpolated, and the result has a low weight.

use std::ops::Range;

use arrayvec::ArrayVec;

use super::jitter::Continuation;
use super::{
    Accumulated, Anchor, BlendSpace, FilterSpace, HistoryStep, HistorySteps, Jitter, Lattice, Motion, Offers,
    PastColor, Reads, Rejection, Sampling, Scale, Tap, UpscaleInputs, Upscaled, Upscaler, Upscaling,
};
use crate::image::color::Tables;
use crate::image::{Image, Rgba8};
use crate::math::lanes::Lanes;

mod rows;

/// Temporal accumulation of jittered samples.
pub(crate) static ACCUMULATION: Accumulation = Accumulation;

/// [`Upscaler`] implementation of [`ACCUMULATION`].
pub(crate) struct Accumulation;

/// Number of jitter positions per pixel, one per frame.
const JITTER_POSITIONS: u32 = 16;

/// Returns the jitter of the samples.
fn jitter() -> Jitter {
    Jitter::low_discrepancy(JITTER_POSITIONS)
}

/// Weight of an interpolated colour in the accumulation, relative to 1 for a sample inside the pixel.
const INTERPOLATED: f32 = 0.05;

impl Upscaler for Accumulation {
    fn id(&self) -> &'static str {
        "accumulation"
    }

    fn name(&self) -> &'static str {
        "Temporal accumulation"
    }

    fn help(&self) -> &'static str {
        "Jitters the samples by a fraction of a pixel in every frame and blends them with the history, reprojected to \
         where it showed the same surface. Still pictures become the mean of 16 samples of each pixel, one per frame, \
         and then stay unchanged; upscaled ones regain detail that a single frame lacks. In motion the picture \
         softens, and where the history is clamped to the colours around the pixel, fine detail flickers. TAA, after \
         B. Karis, “High Quality Temporal Supersampling”, 2014."
    }

    fn artefacts(&self) -> &'static str {
        "softens in motion, fine detail flickers"
    }

    fn offers(&self) -> Offers {
        Offers {
            scales: &[Scale::ONE, Scale::TWO],
            anchors: &[Anchor::Centre],
            lights: &[FilterSpace::Linear, FilterSpace::Bytes],
            deringing: false,
            sharpening: false,
            history: false,
        }
    }

    fn default_scale(&self) -> Scale {
        Scale::ONE
    }

    fn reads(&self) -> Reads {
        Reads { gbuffer: true, history: true }
    }

    fn jitter(&self, _how: Upscaling) -> Option<Jitter> {
        Some(jitter())
    }

    fn sampling(&self, how: Upscaling) -> Sampling {
        Sampling::Lattice(how.lattice())
    }

    fn upscale(&self, how: Upscaling, drawn: &UpscaleInputs<'_>, full: &mut Image<Rgba8>) {
        self.upscale_with_history(how, drawn, full, None);
    }

    fn upscale_with_history(
        &self,
        how: Upscaling,
        drawn: &UpscaleInputs<'_>,
        full: &mut Image<Rgba8>,
        memory: Option<Accumulated>,
    ) -> Upscaled {
        let size = full.size();
        let mut memory = Accumulated::reusing(memory, size);
        rows::fill(Lanes::best(), &FrameContext::new(how, drawn, size), full, &mut memory.color);
        Upscaled { history: Some(memory), ..Upscaled::default() }
    }

    fn pixel(&self, how: Upscaling, drawn: &UpscaleInputs<'_>, size: (u32, u32), at: (u32, u32)) -> Rgba8 {
        FrameContext::new(how, drawn, size).pixel(at)
    }

    /// Returns the samples of this frame only; history contributes no taps.
    fn taps(&self, how: Upscaling, drawn: &UpscaleInputs<'_>, size: (u32, u32), at: (u32, u32)) -> Vec<Tap> {
        let now = FrameContext::new(how, drawn, size);
        let mut taps = now.present(at).taps.to_vec();
        if drawn.frame.is_some_and(|seen| seen.reproject(at).is_ok_and(|before| !before.is_still)) {
            let (columns, rows) = now.neighbourhood(at);
            for (x, y) in rows.flat_map(|y| columns.clone().map(move |x| (x as u32, y))) {
                if taps.iter().all(|tap| (tap.x, tap.y) != (x, y)) {
                    taps.push(Tap { x, y, weight: 0.0 });
                }
            }
        }
        taps
    }

    fn history_steps<'a>(&'a self, how: Upscaling, drawn: &'a UpscaleInputs<'a>) -> HistorySteps<'a> {
        let now = drawn.frame.map(|seen| FrameContext::new(how, drawn, seen.size));
        Box::new(move |at| {
            let now = now.as_ref()?;
            Some(now.step(at, &now.present(at)).0)
        })
    }
}

/// Frame to upscale, with its history.
struct FrameContext<'a> {
    light: FilterSpace,
    lattice: Lattice,
    drawn: &'a UpscaleInputs<'a>,
    /// Size of the full image, in pixels.
    size: (u32, u32),
    /// Jitter position of this frame within a pixel.
    place: [f64; 2],
    /// Whether every jitter position has been drawn since the view became still; the image then no longer changes.
    is_settled: bool,
    /// Motion since the previous frame and the accumulated history: RGB mean and sample count per pixel.
    history: Option<(Motion<'a>, &'a Image<[f32; 4]>)>,
    tables: &'static Tables,
}

/// Samples of this frame that contribute to an output pixel.
struct PresentSamples {
    /// Samples with normalised weights.
    taps: ArrayVec<Tap, 4>,
    /// Weight of their mean in the accumulation.
    counts_for: f32,
}

impl<'a> FrameContext<'a> {
    fn new(how: Upscaling, drawn: &'a UpscaleInputs<'a>, size: (u32, u32)) -> Self {
        let Continuation { place, history, is_settled } = Continuation::new(drawn, jitter());
        Self {
            light: how.light(),
            lattice: how.lattice(),
            drawn,
            size,
            place,
            is_settled,
            history: history.map(|(motion, accumulated)| (motion, &accumulated.color)),
            tables: Tables::get(),
        }
    }

    fn number(&self, code: u8) -> f32 {
        match self.light {
            FilterSpace::Linear => self.tables.linear_of_code.values[code as usize],
            FilterSpace::Bytes => f32::from(code),
        }
    }

    fn pixel(&self, at: (u32, u32)) -> Rgba8 {
        let present = self.present(at);
        let [r, g, b, _] = self.blend_history(at, &present);
        let [r, g, b] = BlendSpace::Rgb(self.light).encoded(self.tables, [r, g, b]);
        let alpha = self.mean(&present.taps)[3];
        [r, g, b, (alpha + 0.5) as u8]
    }

    /// Returns the weighted mean of samples: RGB in the filtering colour space, alpha as an 8-bit value.
    fn mean(&self, taps: &[Tap]) -> [f32; 4] {
        let mut mean = [0.0; 4];
        for tap in taps {
            let [r, g, b, a] = self.drawn.color.at(tap.x, tap.y);
            let sample = [self.number(r), self.number(g), self.number(b), f32::from(a)];
            (0..4).for_each(|channel| mean[channel] += tap.weight * sample[channel]);
        }
        mean
    }

    /// Blends this frame's samples, as returned by [`Self::present`], with the history. Returns the RGB mean and the
    /// sample count.
    fn blend_history(&self, at: (u32, u32), present: &PresentSamples) -> [f32; 4] {
        let (step, count) = self.step(at, present);
        let [r, g, b] = step.blended();
        [r, g, b, count]
    }

    /// Returns how this frame's samples, as returned by [`Self::present`], are blended with the history, and the new
    /// sample count.
    fn step(&self, at: (u32, u32), present: &PresentSamples) -> (HistoryStep, f32) {
        let counts_for = present.counts_for;
        let [r, g, b, _] = self.mean(&present.taps);
        let of = |share, past| HistoryStep { space: BlendSpace::Rgb(self.light), present: [r, g, b], share, past };
        let history = self.history.as_ref().ok_or(Rejection::FirstFrame);
        let reproject = || self.drawn.frame.ok_or(Rejection::FirstFrame)?.reproject(at);
        let before = history.and_then(|(_, memory)| Ok((reproject()?, memory)));
        let (before, memory) = match before {
            Ok(before) => before,
            Err(rejection) => return (of(1.0, Err(rejection)), counts_for),
        };
        let [r, g, b, count] = before.read(self.size, |x, y| memory.at(x, y));
        let mut past = PastColor { position_px: before.place, read: [r, g, b], rectified: [r, g, b] };
        if !before.is_still {
            self.clamp(at, &mut past.rectified);
        }
        let count = count.min((JITTER_POSITIONS - 1) as f32);
        let share = if self.is_settled { 0.0 } else { counts_for / (count + counts_for) };
        (of(share, Ok(past)), count + counts_for)
    }

    /// Clamps a colour to the range of the 3 × 3 nearest samples of this frame.
    fn clamp(&self, at: (u32, u32), color: &mut [f32; 3]) {
        // Decoding is monotonic, so it is enough to decode the bounds of the encoded values.
        let [mut least, mut greatest] = [[u8::MAX; 4], [u8::MIN; 4]];
        let (columns, rows) = self.neighbourhood(at);
        for y in rows {
            for color in &self.drawn.color.row(y)[columns.clone()] {
                for channel in 0..4 {
                    least[channel] = least[channel].min(color[channel]);
                    greatest[channel] = greatest[channel].max(color[channel]);
                }
            }
        }
        let [least, greatest] = [least, greatest].map(|color| color.map(|code| self.number(code)));
        for (channel, value) in color.iter_mut().enumerate() {
            *value = value.min(greatest[channel]).max(least[channel]);
        }
    }

    /// Returns the samples of this frame that contribute to an output pixel.
    fn present(&self, (x, y): (u32, u32)) -> PresentSamples {
        let Self { lattice, place, .. } = *self;
        let (width, height) = self.drawn.color.size();
        let inside = |index: i64, length: u32| index.clamp(0, i64::from(length) - 1) as u32;
        let alone = |x: u32, y: u32| {
            let taps = ArrayVec::from_iter([Tap { x, y, weight: 1.0 }]);
            PresentSamples { taps, counts_for: 1.0 }
        };
        if lattice.scale == Scale::ONE {
            return alone(x, y);
        }
        let [(column, right), (row, down)] = [lattice.coordinate(place[0], x), lattice.coordinate(place[1], y)];
        if let (Some(x), Some(y)) = (self.own(column, right, width), self.own(row, down, height)) {
            return alone(x, y);
        }
        let mut taps: ArrayVec<Tap, 4> = ArrayVec::new();
        for (dy, vertical) in [(0, 1.0 - down), (1, down)] {
            for (dx, horizontal) in [(0, 1.0 - right), (1, right)] {
                let (x, y, weight) = (inside(column + dx, width), inside(row + dy, height), horizontal * vertical);
                match taps.iter_mut().find(|tap| (tap.x, tap.y) == (x, y)) {
                    Some(tap) => tap.weight += weight,
                    None => taps.push(Tap { x, y, weight }),
                }
            }
        }
        PresentSamples { taps, counts_for: INTERPOLATED }
    }

    /// Returns the index of the sample that lies inside an output pixel along one axis, or `None` if there is no such
    /// sample. `cell` and `on` are the pixel's [`Lattice::coordinate`].
    fn own(&self, cell: i64, on: f32, samples: u32) -> Option<u32> {
        let half = (0.5 / self.lattice.scale.value()) as f32;
        let index = if on <= half { cell } else { cell + 1 };
        ((on <= half || 1.0 - on < half) && (0..i64::from(samples)).contains(&index)).then_some(index as u32)
    }

    /// Returns the columns and rows of the 3 × 3 samples of this frame around an output pixel; fewer at borders.
    fn neighbourhood(&self, (x, y): (u32, u32)) -> (Range<usize>, Range<u32>) {
        let (width, height) = self.drawn.color.size();
        let three = |place: f64, at: u32, length: u32| {
            let (cell, on) = self.lattice.coordinate(place, at);
            let nearest = cell + i64::from(on > 0.5);
            let inside = |at: i64| at.clamp(0, i64::from(length)) as u32;
            inside(nearest - 1)..inside(nearest + 2)
        };
        let (columns, rows) = (three(self.place[0], x, width), three(self.place[1], y, height));
        (columns.start as usize..columns.end as usize, rows)
    }
}
