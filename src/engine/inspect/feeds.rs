//! Mapping between pixels of the full picture and the drawn samples that contribute to them, in both directions.

use crate::chain::Frame;
use crate::image::Rgba8;
use crate::image::color::{Tables, encode};
use crate::upscale::{FilterSpace, Tap, Upscaling};

/// Maximum distance from a sample to a pixel that it contributes to, in samples. The widest kernel has a radius of
/// three samples.
const REACH_SAMPLES: f64 = 3.0;

/// Part of the search radius around a sample that does not depend on the scale, in pixels. A checkerboard sample
/// contributes to pixels up to two pixels away even without upscaling.
const REACH_PX: u32 = 4;

/// One sample that contributes to a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContributingSample {
    /// Position and weight of the sample.
    pub tap: Tap,
    /// Colour of the sample, as sRGB codes.
    pub color: Rgba8,
}

/// The samples from which a pixel of the full picture is computed, and their weighted sum.
#[derive(Clone, Debug, PartialEq)]
pub struct Mixture {
    /// The contributing samples, each listed once.
    pub sources: Vec<ContributingSample>,
    /// Sum of the weights of all samples: 1 up to rounding.
    pub weight: f64,
    /// Weighted sums of red, green and blue as sRGB codes, neither clamped nor rounded.
    pub sum: [f64; 3],
    /// Colour of the pixel as computed by the upscaler, in sRGB codes.
    pub pixel: Rgba8,
    /// Whether the history (the previous frame) contributes to the pixel. The history is not among the samples.
    pub uses_history: bool,
}

impl Mixture {
    /// Returns the samples that contribute to a pixel of the frame; `None` outside the picture. `how` contains the
    /// upscaling settings of the frame.
    pub fn of(frame: &Frame, how: Upscaling, at: (u32, u32)) -> Option<Self> {
        let pixel = frame.image().get(at.0, at.1)?;
        let taps = taps(frame, how, at);
        let sources = taps.into_iter().map(|tap| Some(ContributingSample { tap, color: color_of(frame, tap)? }));
        let sources: Vec<ContributingSample> = sources.collect::<Option<_>>()?;
        let weight = sources.iter().map(|source| f64::from(source.tap.weight)).sum();
        let sum = [0, 1, 2].map(|channel| sum_of(&sources, how.light(), channel));
        let step = how.upscaler().history_steps(how, &frame.as_drawn(&frame.drawn.color))(at);
        Some(Self { sources, weight, sum, pixel, uses_history: step.is_some_and(|step| step.past.is_ok()) })
    }

    /// Returns the weighted sums clamped to the range of sRGB codes, [0, 255].
    pub fn clamped(&self) -> [f64; 3] {
        self.sum.map(|code| code.clamp(0.0, 255.0))
    }
}

fn taps(frame: &Frame, how: Upscaling, at: (u32, u32)) -> Vec<Tap> {
    let size = (frame.viewport.width, frame.viewport.height);
    how.upscaler().taps(how, &frame.as_drawn(&frame.drawn.color), size, at)
}

/// Returns the colour of a sample; `None` if the frame did not draw the sample.
fn color_of(frame: &Frame, tap: Tap) -> Option<Rgba8> {
    let (column, row) = frame.drawn.grid.sample_at(tap.x, tap.y)?;
    frame.drawn.color.get(column, row)
}

/// Returns the weighted sum of one channel as an sRGB code. Depending on `light`, the sum is computed in linear light
/// or directly on the codes.
fn sum_of(sources: &[ContributingSample], light: FilterSpace, channel: usize) -> f64 {
    let weighed = |value: fn(u8) -> f64| -> f64 {
        sources.iter().map(|source| f64::from(source.tap.weight) * value(source.color[channel])).sum()
    };
    match light {
        FilterSpace::Bytes => weighed(f64::from),
        FilterSpace::Linear => {
            let sum = weighed(|code| f64::from(Tables::get().linear_of_code.values[usize::from(code)]));
            255.0 * f64::from(encode(sum as f32))
        }
    }
}

/// Returns the pixels of the full picture that a drawn sample contributes to, with the sample's weight in each.
/// `sample` is given in the coordinates of a [`Tap`].
pub fn pixels_fed_by(frame: &Frame, how: Upscaling, sample: (u32, u32)) -> Vec<((u32, u32), f32)> {
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

/// Returns the pixel of the full picture nearest to a sample, and the radius in pixels within which to search for
/// pixels that the sample contributes to.
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
    fn weights_sum_to_one_and_plain_kernels_reproduce_the_pixel() {
        for how in Upscaling::every() {
            let frame = frame(how);
            for at in [(0, 0), (60, 46), (30, 22), (17, 40)] {
                let mixture = Mixture::of(&frame, how, at).unwrap();
                assert!((mixture.weight - 1.0).abs() < 1e-5, "{} {at:?}: {}", how.label(), mixture.weight);
                if ["fsr1", "nis", "fsr2", "sgsr2"].contains(&how.method()) {
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
    fn a_sample_contributes_to_exactly_the_pixels_that_list_it() {
        for how in [("nearest", 4), ("bilinear", 3), ("lanczos3", 4), ("checkerboard", 1)] {
            let plain = Upscaling::new(how.0, how.1).unwrap();
            for how in [plain, plain.with_anchor(Anchor::Centre)] {
                let frame = frame(how);
                let sample = Mixture::of(&frame, how, (30, 22)).unwrap().sources[0].tap;
                let sample = (sample.x, sample.y);
                let fed = pixels_fed_by(&frame, how, sample);
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
