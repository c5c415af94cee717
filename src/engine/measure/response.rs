//! Response of an upscaler to test signals: a single bright sample, a step, and a zone plate.
//!
//! The signals use 8-bit values between 96 and 160, so that negative and positive lobes are visible and no value is
//! clamped.

use crate::image::{Image, Rgba8};
use crate::upscale::{UpscaleInputs, Upscaling};

/// 8-bit value of the dark parts of a signal.
const DARK: f64 = 96.0;

/// Difference between bright and dark, in 8-bit steps.
const HEIGHT: f64 = 64.0;

/// Number of samples along each axis of the impulse and step signals.
const SAMPLES: u32 = 16;

/// Side of the zone plate, in pixels.
pub(crate) const PLATE: u32 = 96;

/// Responses of an upscaler. Positions are in pixels from the bright sample or the edge; heights are 0 for dark and 1
/// for bright.
#[derive(Clone, Debug, PartialEq)]
pub struct Responses {
    /// Impulse response: positions and heights along a row through one bright sample among dark ones.
    pub impulse: Vec<[f64; 2]>,
    /// Step response: positions and heights across a vertical edge with the dark side on the left.
    pub step: Vec<[f64; 2]>,
    /// Upscaled zone plate: rings whose period falls from the centre to 2 px at the border.
    pub zone_plate: Image<Rgba8>,
    /// Zone plate at native resolution, for comparison.
    pub zone_plate_native: Image<Rgba8>,
}

impl Responses {
    /// Computes the responses of an upscaler.
    pub fn of(how: Upscaling) -> Self {
        let side = (f64::from(SAMPLES) * how.scale().value()) as u32;
        let middle = f64::from(side) / 2.0;
        let (nearest_x, nearest_y) = nearest_sample(how, side, middle);
        let is_bright = |x: f64, y: f64| f64::from(u8::from((x, y) == (nearest_x, nearest_y)));
        let impulse = respond(how, side, is_bright);
        let step = respond(how, side, |x, _| f64::from(u8::from(x > middle)));
        let row = |picture: &Image<Rgba8>, y: f64, zero: f64| {
            let row = picture.row((y as u32).min(side - 1)).iter().enumerate();
            row.map(|(x, code)| [x as f64 + 0.5 - zero, (f64::from(code[0]) - DARK) / HEIGHT]).collect()
        };
        Self {
            impulse: row(&impulse, nearest_y, nearest_x),
            step: row(&step, middle, middle),
            zone_plate: respond(how, PLATE, zone_plate),
            zone_plate_native: respond(Upscaling::NATIVE, PLATE, zone_plate),
        }
    }

    /// Returns the minimum height of the step response, at most 0, and its maximum height, at least 1. A minimum below
    /// 0 is an undershoot; a maximum above 1 is an overshoot.
    pub fn overshoot(&self) -> (f64, f64) {
        let heights = || self.step.iter().map(|[_, height]| *height);
        (heights().fold(0.0, f64::min), heights().fold(1.0, f64::max))
    }
}

/// Returns the value, in [0, 1], of a zone plate at the position (`x`, `y`) in pixels. The ring period falls to 2 px at
/// the border, the shortest period that pixels can represent.
fn zone_plate(x: f64, y: f64) -> f64 {
    let middle = f64::from(PLATE) / 2.0;
    let squared = (x - middle).powi(2) + (y - middle).powi(2);
    // The phase grows by π per pixel at the border.
    0.5 + 0.5 * (std::f64::consts::PI * squared / f64::from(PLATE)).cos()
}

/// Returns the numbers of sample columns and sample rows for a square image of `side` px.
fn samples(how: Upscaling, side: u32) -> (u32, u32) {
    let sampling = how.sampling();
    let (width, height) = sampling.raster_size(side, side);
    sampling.grid().packed_size(width, height)
}

/// Returns the position in pixels of the sample nearest to (`middle`, `middle`), in an image of `side` × `side` px.
fn nearest_sample(how: Upscaling, side: u32, middle: f64) -> (f64, f64) {
    let (columns, rows) = samples(how, side);
    let positions = (0..rows).flat_map(|row| (0..columns).map(move |column| how.sampling().position_px((column, row))));
    let distance = |(x, y): &(f64, f64)| (x - middle).powi(2) + (y - middle).powi(2);
    positions.min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or((0.5, 0.5))
}

/// Upscales samples of a signal, whose heights lie in [0, 1], to a square image of `side` px.
fn respond(how: Upscaling, side: u32, signal: impl Fn(f64, f64) -> f64) -> Image<Rgba8> {
    let (columns, rows) = samples(how, side);
    let drawn = Image::from_fn(columns, rows, |column, row| {
        let (x, y) = how.sampling().position_px((column, row));
        let code = (DARK + HEIGHT * signal(x, y)).round() as u8;
        [code, code, code, 255]
    });
    if how.is_native() { drawn } else { how.upscale(&UpscaleInputs::from(&drawn), side, side) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn responses(method: &str, scale: u32) -> Responses {
        Responses::of(Upscaling::new(method, scale).unwrap())
    }

    #[test]
    fn an_impulse_through_nearest_is_a_block_and_through_bilinear_a_tent() {
        let bright = |responses: &Responses| responses.impulse.iter().filter(|[_, height]| *height > 0.0).count();
        let nearest = responses("nearest", 4);
        assert_eq!(bright(&nearest), 4);
        assert!(nearest.impulse.iter().all(|[_, height]| *height == 0.0 || *height == 1.0));
        let tent = responses("bilinear", 4);
        assert_eq!(bright(&tent), 7);
        for [offset, height] in &tent.impulse {
            let expected = (1.0 - offset.abs() / 4.0).max(0.0);
            assert!((height - expected).abs() <= 0.5 / HEIGHT, "{offset}: {height}");
        }
    }

    #[test]
    fn kernels_with_negative_lobes_overshoot_as_theory_says() {
        // Known undershoots of a unit step; at ×4, some pixel lies close to the minimum.
        for (method, expected) in [("catmull-rom", 0.074), ("lanczos3", 0.118), ("bilinear", 0.0)] {
            let (low, high) = responses(method, 4).overshoot();
            let code = 1.0 / HEIGHT;
            assert!(-low <= expected + code && high - 1.0 <= expected + code, "{method}: {low} {high}");
            assert!(-low >= expected * 0.6 - code, "{method}: {low}");
        }
    }

    #[test]
    fn native_leaves_the_zone_plate_as_it_is() {
        let native = Responses::of(Upscaling::NATIVE);
        assert_eq!(native.zone_plate, native.zone_plate_native);
        let fewer = responses("bicubic", 4);
        assert_ne!(fewer.zone_plate, fewer.zone_plate_native);
        assert_eq!(fewer.zone_plate.size(), (PLATE, PLATE));
    }

    #[test]
    fn every_method_answers_with_as_many_pixels_as_samples_stand_for() {
        for how in Upscaling::every() {
            let responses = Responses::of(how);
            assert_eq!(responses.impulse.len(), (f64::from(SAMPLES) * how.scale().value()) as usize, "{}", how.label());
            assert_eq!(responses.step.len(), responses.impulse.len());
        }
    }
}
