//! Temporal accumulation: every frame samples its pixels elsewhere, and what the frames before found is kept.
//!
//! With n samples remembered at a pixel, a new one counts for 1 / (n + 1), until n has reached the most that is remembered;
//! from then on the past fades. While the view stands still nothing fades before all places of the pattern were drawn once,
//! so that the picture becomes the mean of as many samples as the pattern has; further frames leave it as it is. In motion the past is looked up where the frame
//! before showed the same surface, and kept between the least and the greatest of the nine samples around: what is no longer
//! true is cut off there, and sometimes what is still true, too.
//!
//! Enlarged, a sample that lies within the output pixel counts in full; where none does, the four around are interpolated,
//! and count for little.

use std::ops::Range;

use arrayvec::ArrayVec;

use super::{Anchor, Before, Drawn, Lattice, Light, Motion, Offers, Reads, Sampling, Scale, Tap, Upscaler, Upscaling};
use crate::antialias::pattern::Pattern;
use crate::image::color::Tables;
use crate::image::{Image, Rgba8};
use crate::math::lanes::Lanes;

mod rows;

/// Samples gathered over frames.
pub static ACCUMULATION: Accumulation = Accumulation;

/// See [`ACCUMULATION`].
pub struct Accumulation;

/// Places of a pixel's samples, one a frame.
const PLACES: u32 = 16;

/// What the interpolated colour of a pixel without a sample of its own counts for.
const INTERPOLATED: f32 = 0.05;

impl Upscaler for Accumulation {
    fn id(&self) -> &'static str {
        "accumulation"
    }

    fn name(&self) -> &'static str {
        "Temporal accumulation"
    }

    fn help(&self) -> &'static str {
        "Moves the samples by a fraction of a pixel in every frame and keeps the mean of what the frames before found, \
         looked up where they showed the same surface. Still pictures become the mean of 16 samples of each pixel, one \
         a frame, and then change no more; enlarged ones regain the detail that one frame has not. In motion it softens, and where the remembered \
         colour is cut off to what is around, fine detail flickers. TAA, in the way of B. Karis, “High Quality Temporal \
         Supersampling”, 2014."
    }

    fn offers(&self) -> Offers {
        Offers {
            scales: &[Scale::ONE, Scale::TWO],
            anchors: &[Anchor::Centre],
            lights: &[Light::Linear, Light::Bytes],
            deringing: false,
            sharpening: false,
        }
    }

    fn reads(&self) -> Reads {
        Reads { surfaces: true, past: true }
    }

    fn settles_after(&self, _how: Upscaling) -> u32 {
        PLACES
    }

    fn sampling(&self, how: Upscaling) -> Sampling {
        Sampling::Lattice(how.lattice())
    }

    fn sampling_of(&self, how: Upscaling, frames: u32) -> (Sampling, [f64; 2]) {
        (self.sampling(how), place(frames))
    }

    fn upscale(&self, how: Upscaling, drawn: &Drawn<'_>, full: &mut Image<Rgba8>) {
        self.upscale_and_remember(how, drawn, full, None);
    }

    fn upscale_and_remember(
        &self,
        how: Upscaling,
        drawn: &Drawn<'_>,
        full: &mut Image<Rgba8>,
        memory: Option<Image<[f32; 4]>>,
    ) -> Option<Image<[f32; 4]>> {
        let (width, height) = full.size();
        let mut memory = Image::reusing(memory, width, height, [0.0; 4]);
        rows::fill(Lanes::best(), &Now::new(how, drawn, (width, height)), full, &mut memory);
        Some(memory)
    }

    fn pixel(&self, how: Upscaling, drawn: &Drawn<'_>, size: (u32, u32), at: (u32, u32)) -> Rgba8 {
        Now::new(how, drawn, size).pixel(at)
    }

    /// The samples of this frame; what the frames before add is no sample.
    fn taps(&self, how: Upscaling, drawn: &Drawn<'_>, size: (u32, u32), at: (u32, u32)) -> Vec<Tap> {
        let now = Now::new(how, drawn, size);
        let mut taps = now.present(at).0.to_vec();
        if drawn.seen.is_some_and(|seen| seen.before(size, at).is_some_and(|before| !before.is_still)) {
            let (columns, rows) = now.nine(at);
            for (x, y) in rows.flat_map(|y| columns.clone().map(move |x| (x as u32, y))) {
                if taps.iter().all(|tap| (tap.x, tap.y) != (x, y)) {
                    taps.push(Tap { x, y, weight: 0.0 });
                }
            }
        }
        taps
    }

    fn remembers(&self, _how: Upscaling, drawn: &Drawn<'_>, size: (u32, u32), at: (u32, u32)) -> Option<Before> {
        let seen = drawn.seen?;
        seen.past?.memory.as_ref().and_then(|_| seen.before(size, at))
    }
}

/// Where in its pixel a frame samples, when so many came before.
fn place(frames: u32) -> [f64; 2] {
    let places = Pattern::LowDiscrepancy { count: PLACES }.offsets(0, 0);
    places[(frames % PLACES) as usize]
}

/// Where an output pixel lies among the samples of this frame: the sample before it on an axis, which may be outside, and how
/// far on.
fn among(lattice: Lattice, place: f64, at: u32) -> (i64, f32) {
    let (scale, origin) = (lattice.scale.value(), lattice.position_px(0));
    let index = (f64::from(at) + 0.5 - origin) / scale - (place - 0.5);
    (index.floor() as i64, (index - index.floor()) as f32)
}

/// A frame and what is known of those before.
struct Now<'a> {
    light: Light,
    lattice: Lattice,
    drawn: &'a Drawn<'a>,
    /// Of the full picture.
    size: (u32, u32),
    /// Where in its pixel this frame samples.
    place: [f64; 2],
    /// Whether all places were drawn since the view stands still: then the picture stays.
    is_settled: bool,
    /// What the frames before found, and where.
    past: Option<(Motion<'a>, &'a Image<[f32; 4]>)>,
    tables: &'static Tables,
}

impl<'a> Now<'a> {
    fn new(how: Upscaling, drawn: &'a Drawn<'a>, size: (u32, u32)) -> Self {
        let place = drawn.seen.map_or(super::CENTRE, |seen| place(seen.frames()));
        let past: Option<(Motion<'_>, _)> =
            drawn.seen.and_then(|seen| Some((seen.motion(size)?, seen.past?.memory.as_ref()?)));
        let is_settled = past.as_ref().is_some_and(|(motion, _)| motion.is_still() && motion.past.still >= PLACES);
        Self { light: how.light(), lattice: how.lattice(), drawn, size, place, is_settled, past, tables: Tables::get() }
    }

    fn number(&self, code: u8) -> f32 {
        match self.light {
            Light::Linear => self.tables.linear_of_code[code as usize],
            Light::Bytes => f32::from(code),
        }
    }

    fn pixel(&self, at: (u32, u32)) -> Rgba8 {
        let present = self.present(at);
        let [r, g, b, _] = self.mixed(at, &present);
        let encode = |value: f32| match self.light {
            Light::Linear => self.tables.encode(value),
            Light::Bytes => (value + 0.5) as u8,
        };
        let alpha = self.mean(&present.0)[3];
        [encode(r), encode(g), encode(b), (alpha + 0.5) as u8]
    }

    /// The light of samples, weighed, and the code of their alpha.
    fn mean(&self, taps: &[Tap]) -> [f32; 4] {
        let mut mean = [0.0; 4];
        for tap in taps {
            let [r, g, b, a] = self.drawn.color.at(tap.x, tap.y);
            let sample = [self.number(r), self.number(g), self.number(b), f32::from(a)];
            (0..4).for_each(|channel| mean[channel] += tap.weight * sample[channel]);
        }
        mean
    }

    /// The mean at a pixel, with this frame, and how many samples it is of: from what [`Self::present`] says.
    fn mixed(&self, at: (u32, u32), (taps, counts_for): &(ArrayVec<Tap, 4>, f32)) -> [f32; 4] {
        let counts_for = *counts_for;
        let now = self.mean(taps);
        let remembered = self.past.and_then(|(motion, memory)| {
            let before = motion.before(at)?;
            Some((before, before.read(self.size, |x, y| memory.at(x, y))))
        });
        let Some((before, [mut r, mut g, mut b, count])) = remembered else {
            return [now[0], now[1], now[2], counts_for];
        };
        if !before.is_still {
            // Light grows with codes, so that the bounds of one are those of the other.
            let [mut least, mut greatest] = [[u8::MAX; 4], [u8::MIN; 4]];
            let (columns, rows) = self.nine(at);
            for y in rows {
                for color in &self.drawn.color.row(y)[columns.clone()] {
                    for channel in 0..4 {
                        least[channel] = least[channel].min(color[channel]);
                        greatest[channel] = greatest[channel].max(color[channel]);
                    }
                }
            }
            let [least, greatest] = [least, greatest].map(|color| color.map(|code| self.number(code)));
            for (channel, value) in [&mut r, &mut g, &mut b].into_iter().enumerate() {
                *value = value.min(greatest[channel]).max(least[channel]);
            }
        }
        let count = count.min((PLACES - 1) as f32);
        let share = if self.is_settled { 0.0 } else { counts_for / (count + counts_for) };
        let mix = |past: f32, now: f32| past + (now - past) * share;
        [mix(r, now[0]), mix(g, now[1]), mix(b, now[2]), count + counts_for]
    }

    /// The samples of this frame that make an output pixel, and what they count for.
    fn present(&self, (x, y): (u32, u32)) -> (ArrayVec<Tap, 4>, f32) {
        let Self { lattice, place, .. } = *self;
        let (width, height) = self.drawn.color.size();
        let inside = |index: i64, length: u32| index.clamp(0, i64::from(length) - 1) as u32;
        let alone = |x: u32, y: u32| (ArrayVec::from_iter([Tap { x, y, weight: 1.0 }]), 1.0);
        if lattice.scale == Scale::ONE {
            return alone(x, y);
        }
        let [(column, right), (row, down)] = [among(lattice, place[0], x), among(lattice, place[1], y)];
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
        (taps, INTERPOLATED)
    }

    /// The sample of an axis that lies within half an output pixel of its centre, if one does: from what [`among`] says.
    fn own(&self, cell: i64, on: f32, samples: u32) -> Option<u32> {
        let half = (0.5 / self.lattice.scale.value()) as f32;
        let index = if on <= half { cell } else { cell + 1 };
        ((on <= half || 1.0 - on < half) && (0..i64::from(samples)).contains(&index)).then_some(index as u32)
    }

    /// Columns and rows of the nine samples of this frame around an output pixel, fewer at borders.
    fn nine(&self, (x, y): (u32, u32)) -> (Range<usize>, Range<u32>) {
        let (width, height) = self.drawn.color.size();
        let three = |place: f64, at: u32, length: u32| {
            let (cell, on) = among(self.lattice, place, at);
            let nearest = cell + i64::from(on > 0.5);
            let inside = |at: i64| at.clamp(0, i64::from(length)) as u32;
            inside(nearest - 1)..inside(nearest + 2)
        };
        let (columns, rows) = (three(self.place[0], x, width), three(self.place[1], y, height));
        (columns.start as usize..columns.end as usize, rows)
    }
}
