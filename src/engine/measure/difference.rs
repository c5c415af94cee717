//! Difference image of two images: per-pixel values, mapped to colours over an adjustable range.

use super::flip;
use crate::image::color::{SIGNAL, luma};
use crate::image::{Image, Rgba8};
use crate::pipeline::settings::{Choice, choice};

choice! {
    /// Quantity that a difference image shows.
    pub Difference {
        Absolute = "absolute", "Absolute",
            "The largest of the absolute differences of red, green and blue, in sRGB codes.";
        Signed = "signed", "Signed", "The difference of luma, A − B, in sRGB codes: positive if A is lighter.";
        Squared = "squared", "Squared",
            "The mean of the squared differences of red, green and blue in sRGB codes, as in MSE and PSNR.";
        Changed = "changed", "Changed pixels", "Whether red, green or blue differ at all: 1 if so, otherwise 0.";
        Flip = "flip", "FLIP", "The difference that is perceived when flipping between both pictures, 0 to 1.";
    }
}

/// Available gains; a gain divides the range of values that the colour map spans.
pub const GAINS: [u32; 9] = [1, 2, 4, 8, 16, 32, 64, 128, 256];

/// Largest 8-bit channel value, as a float.
const CODES: f64 = 255.0;

impl Difference {
    /// Whether a gain changes the difference image.
    pub fn has_gain(self) -> bool {
        self != Self::Changed
    }

    /// Returns the values at the two ends of the colour map, in the unit of [`values`].
    pub fn range(self, gain: u32) -> (f64, f64) {
        let gain = f64::from(gain.max(1));
        match self {
            Self::Absolute => (0.0, CODES / gain),
            Self::Signed => (-CODES / gain, CODES / gain),
            Self::Squared => (0.0, CODES * CODES / gain),
            Self::Flip => (0.0, 1.0 / gain),
            Self::Changed => (0.0, 1.0),
        }
    }

    /// Returns the colour at a position in the colour map. `share` is clamped to [0, 1]; for signed differences, 0.5 is
    /// zero.
    pub fn color(self, share: f64) -> Rgba8 {
        let share = share.clamp(0.0, 1.0);
        /// Colour of equal pixels.
        const EQUAL: [u8; 3] = [24; 3];
        let [r, g, b] = match self {
            Self::Changed if share > 0.0 => [SIGNAL[0], SIGNAL[1], SIGNAL[2]],
            Self::Changed => EQUAL,
            // Orange where B is lighter, violet where A is lighter: the interface uses the same colours for A and B.
            Self::Signed => colorous::PURPLE_ORANGE.eval_continuous(1.0 - share).as_array(),
            Self::Absolute | Self::Squared => colorous::VIRIDIS.eval_continuous(share).as_array(),
            Self::Flip => colorous::MAGMA.eval_continuous(share).as_array(),
        };
        [r, g, b, 255]
    }
}

/// Computes the difference of every pixel, in 8-bit steps, squared 8-bit steps or FLIP. Returns `None` if the sizes
/// differ or there are no pixels.
///
/// # Examples
/// ```
/// use rasterscope_engine::image::Image;
/// use rasterscope_engine::measure::difference::{Difference, picture, values};
///
/// let a = Image::filled(64, 36, [10, 200, 7, 255]);
/// let b = Image::filled(64, 36, [13, 190, 7, 255]);
/// let absolute = values(Difference::Absolute, &a, &b).unwrap();
/// assert_eq!(absolute, Image::filled(64, 36, 10.0));
///
/// let none = values(Difference::Absolute, &a, &a).unwrap();
/// assert_eq!(picture(Difference::Absolute, 1, &none).at(0, 0), Difference::Absolute.color(0.0));
/// ```
pub fn values(kind: Difference, a: &Image<Rgba8>, b: &Image<Rgba8>) -> Option<Image<f32>> {
    if kind == Difference::Flip {
        return flip::map(a, b);
    }
    if a.size() != b.size() || a.pixels().is_empty() {
        return None;
    }
    let pixels = a.pixels().iter().zip(b.pixels()).map(|(a, b)| value(kind, *a, *b));
    Some(Image::from_pixels(a.width(), a.height(), pixels.collect()))
}

fn value(kind: Difference, a: Rgba8, b: Rgba8) -> f32 {
    let steps = [0, 1, 2].map(|channel: usize| a[channel].abs_diff(b[channel]));
    match kind {
        Difference::Signed => luma(a) - luma(b),
        Difference::Squared => steps.map(|step| f32::from(step).powi(2)).iter().sum::<f32>() / 3.0,
        Difference::Changed => f32::from(u8::from(steps != [0; 3])),
        Difference::Absolute | Difference::Flip => steps.into_iter().max().map_or(0.0, f32::from),
    }
}

/// Maps difference values to colours, over the range that `gain` selects.
pub fn picture(kind: Difference, gain: u32, values: &Image<f32>) -> Image<Rgba8> {
    let (low, high) = kind.range(gain);
    values.map(|value| kind.color((f64::from(value) - low) / (high - low)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one_pixel(code: [u8; 3]) -> Image<Rgba8> {
        Image::filled(1, 1, [code[0], code[1], code[2], 255])
    }

    fn value_of(kind: Difference, a: [u8; 3], b: [u8; 3]) -> f32 {
        values(kind, &one_pixel(a), &one_pixel(b)).unwrap().at(0, 0)
    }

    #[test]
    fn values_by_hand() {
        assert_eq!(value_of(Difference::Absolute, [10, 200, 7], [13, 190, 7]), 10.0);
        assert_eq!(value_of(Difference::Squared, [10, 200, 7], [13, 190, 7]), 109.0 / 3.0);
        assert!((value_of(Difference::Signed, [20; 3], [50; 3]) + 30.0).abs() < 1e-4, "B is lighter");
        assert_eq!(value_of(Difference::Changed, [10, 200, 7], [10, 200, 8]), 1.0);
        assert_eq!(value_of(Difference::Changed, [10, 200, 7], [10, 200, 7]), 0.0);
        assert!(value_of(Difference::Flip, [0; 3], [255; 3]) > 0.9);
        assert_eq!(values(Difference::Absolute, &one_pixel([0; 3]), &Image::filled(2, 1, [0; 4])), None);
    }

    #[test]
    fn equal_pictures_show_the_colour_of_none_at_every_gain() {
        let picture_of = |kind: Difference, gain| {
            let values = values(kind, &one_pixel([9, 80, 200]), &one_pixel([9, 80, 200])).unwrap();
            picture(kind, gain, &values).at(0, 0)
        };
        for kind in Difference::ALL {
            let none = kind.color(if *kind == Difference::Signed { 0.5 } else { 0.0 });
            assert!(GAINS.iter().all(|gain| picture_of(*kind, *gain) == none), "{}", kind.name());
        }
    }

    #[test]
    fn signed_differences_have_the_colours_of_a_and_b() {
        let ([r, _, b, _], [red, _, blue, _]) = (Difference::Signed.color(0.9), Difference::Signed.color(0.1));
        assert!(b > r && red > blue, "violet where A is lighter, orange where B is");
    }

    #[test]
    fn a_gain_brings_small_differences_to_the_end_of_the_map() {
        let values = values(Difference::Absolute, &one_pixel([100; 3]), &one_pixel([101; 3])).unwrap();
        let shown = |gain| picture(Difference::Absolute, gain, &values).at(0, 0);
        assert_eq!(shown(256), Difference::Absolute.color(1.0));
        assert_ne!(shown(1), shown(64));
    }
}
