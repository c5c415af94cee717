//! A pixel of the full picture and the samples that it is made of, and the other way round.

use crate::chain::Frame;
use crate::image::Rgba8;
use crate::image::color::{Tables, encode};
use crate::upscale::{Light, Tap, Upscaling};

/// How far around a sample pixels are looked for that it feeds, in samples: the widest kernel reaches three.
const REACH_SAMPLES: f64 = 3.0;

/// Pixels around a sample that are looked at in any case: a checkerboard reaches two, with no enlargement.
const REACH_PX: u32 = 4;

/// One sample that a pixel is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Source {
    /// Where it lies and what it weighs.
    pub tap: Tap,
    /// Its colour.
    pub color: Rgba8,
}

/// What a pixel of the full picture is made of.
#[derive(Clone, Debug, PartialEq)]
pub struct Mixture {
    /// The samples, each once.
    pub sources: Vec<Source>,
    /// Sum of all weights: 1 but for rounding.
    pub weight: f64,
    /// Weighted sum in codes, not yet clamped nor rounded: red, green, blue.
    pub sum: [f64; 3],
    /// The pixel as the method made it.
    pub pixel: Rgba8,
    /// Whether a part of it comes from the frame before, which is no sample.
    pub remembers: bool,
}

impl Mixture {
    /// Of a pixel of the frame; `None` outside of it. `how` is what the frame was filled in by.
    pub fn of(frame: &Frame, how: Upscaling, at: (u32, u32)) -> Option<Self> {
        let pixel = frame.image().get(at.0, at.1)?;
        let taps = taps(frame, how, at);
        let sources = taps.into_iter().map(|tap| Some(Source { tap, color: color_of(frame, tap)? }));
        let sources: Vec<Source> = sources.collect::<Option<_>>()?;
        let weight = sources.iter().map(|source| f64::from(source.tap.weight)).sum();
        let sum = [0, 1, 2].map(|channel| sum_of(&sources, how.light(), channel));
        let size = (frame.viewport.width, frame.viewport.height);
        let before = how.upscaler().remembers(how, &frame.as_drawn(&frame.drawn.color), size, at);
        Some(Self { sources, weight, sum, pixel, remembers: before.is_some() })
    }

    /// The weighted sum within the codes that there are.
    pub fn clamped(&self) -> [f64; 3] {
        self.sum.map(|code| code.clamp(0.0, 255.0))
    }
}

fn taps(frame: &Frame, how: Upscaling, at: (u32, u32)) -> Vec<Tap> {
    let size = (frame.viewport.width, frame.viewport.height);
    how.upscaler().taps(how, &frame.as_drawn(&frame.drawn.color), size, at)
}

/// The colour of a drawn sample.
fn color_of(frame: &Frame, tap: Tap) -> Option<Rgba8> {
    let (column, row) = frame.drawn.grid.sample_at(tap.x, tap.y)?;
    frame.drawn.color.get(column, row)
}

/// Weighted sum of one channel, in codes.
fn sum_of(sources: &[Source], light: Light, channel: usize) -> f64 {
    let weighed = |value: fn(u8) -> f64| -> f64 {
        sources.iter().map(|source| f64::from(source.tap.weight) * value(source.color[channel])).sum()
    };
    match light {
        Light::Bytes => weighed(f64::from),
        Light::Linear => {
            let sum = weighed(|code| f64::from(Tables::get().linear_of_code[usize::from(code)]));
            255.0 * f64::from(encode(sum as f32))
        }
    }
}

/// The pixels of the full picture that a drawn sample is part of, with its weight in each. `sample` is where it lies as a
/// [`Tap`] has it.
pub fn fed_by(frame: &Frame, how: Upscaling, sample: (u32, u32)) -> Vec<((u32, u32), f32)> {
    let (middle, reach) = around(frame, how, sample);
    let range = |at: u32, size: u32| at.saturating_sub(reach)..at.saturating_add(reach + 1).min(size);
    let mut fed = Vec::new();
    for y in range(middle.1, frame.viewport.height) {
        for x in range(middle.0, frame.viewport.width) {
            let tap = taps(frame, how, (x, y)).into_iter().find(|tap| (tap.x, tap.y) == sample);
            fed.extend(tap.map(|tap| ((x, y), tap.weight)));
        }
    }
    fed
}

/// The pixel of the full picture that a sample lies on or next to, and how far around it the pixels may lie that it feeds.
fn around(frame: &Frame, how: Upscaling, (x, y): (u32, u32)) -> ((u32, u32), u32) {
    let scale = how.scale().value();
    let is_full = (frame.raster.width, frame.raster.height) == (frame.viewport.width, frame.viewport.height);
    let middle = if is_full { (x, y) } else { [x, y].map(|at| (f64::from(at) * scale + scale / 2.0) as u32).into() };
    (middle, ((REACH_SAMPLES + 1.0) * scale) as u32 + REACH_PX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::{Recipe, run};
    use crate::pipeline::viewport::Viewport;
    use crate::scene::builtin;
    use crate::upscale::Anchor;

    fn frame(how: Upscaling) -> Frame {
        let scene = builtin::by_id("cubes").unwrap().build();
        let recipe = Recipe { upscaler: how, ..Recipe::default() };
        run(&scene, &scene.home, &recipe, Viewport { width: 61, height: 47 }, &mut ())
    }

    #[test]
    fn weights_sum_to_one_and_plain_kernels_make_the_pixel() {
        for how in Upscaling::every() {
            let frame = frame(how);
            for at in [(0, 0), (60, 46), (30, 22), (17, 40)] {
                let mixture = Mixture::of(&frame, how, at).unwrap();
                assert!((mixture.weight - 1.0).abs() < 1e-5, "{} {at:?}: {}", how.label(), mixture.weight);
                if how.method() == "fsr1" {
                    continue;
                }
                for (code, made) in mixture.clamped().iter().zip(mixture.pixel) {
                    assert!((code - f64::from(made)).abs() <= 1.6, "{} {at:?}: {mixture:?}", how.label());
                }
            }
            assert_eq!(Mixture::of(&frame, how, (61, 0)), None);
        }
    }

    #[test]
    fn a_sample_feeds_exactly_the_pixels_that_name_it() {
        for how in [("nearest", 4), ("bilinear", 3), ("lanczos3", 4), ("checkerboard", 1)] {
            let plain = Upscaling::new(how.0, how.1).unwrap();
            for how in [plain, plain.with_anchor(Anchor::Centre)] {
                let frame = frame(how);
                let sample = Mixture::of(&frame, how, (30, 22)).unwrap().sources[0].tap;
                let sample = (sample.x, sample.y);
                let fed = fed_by(&frame, how, sample);
                let mut count = 0;
                for y in 0..47 {
                    for x in 0..61 {
                        let names = taps(&frame, how, (x, y)).iter().any(|tap| (tap.x, tap.y) == sample);
                        assert_eq!(fed.iter().any(|(at, _)| *at == (x, y)), names, "{} {x}, {y}", how.label());
                        count += usize::from(names);
                    }
                }
                assert!(count > 0 && fed.len() == count);
            }
        }
    }
}
