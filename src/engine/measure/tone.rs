//! Tone mapping: conversion of linear light of any range to sRGB codes, for display and for metrics of displayed
//! pictures.

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};

use crate::image::color::{Tables, quantize};
use crate::image::picture::{Layer, Picture};
use crate::image::{Image, Rgba8};
use crate::pipeline::settings::{Choice, choice};

choice! {
    /// Curve that maps linear light of any range to [0, 1], channel by channel.
    pub ToneCurve {
        Clamp = "clamp", "Clamp", "Values above 1 are shown as 1.";
        Reinhard = "reinhard", "Reinhard", "x / (1 + x): compresses all values, reaches 1 at infinity.";
        Aces = "aces", "ACES (fit)", "Narkowicz's fit to the ACES film curve: more contrast, saturates at about 10.";
    }
}

impl ToneCurve {
    /// Maps a non-negative value to [0, 1].
    fn map(self, x: f32) -> f32 {
        match self {
            Self::Clamp => x,
            Self::Reinhard if x.is_infinite() => 1.0,
            Self::Reinhard => x / (1.0 + x),
            // Beyond 1e4 the curve is constant, and the squares of large values overflow.
            Self::Aces => {
                let x = x.min(1e4);
                x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)
            }
        }
    }
}

/// Exposure and tone curve. They apply to float pictures; integer pictures are already sRGB codes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tone {
    /// Exposure in stops: linear light is multiplied by 2 to this power.
    pub exposure: f32,
    /// Tone curve after the exposure.
    pub curve: ToneCurve,
}

impl Default for Tone {
    fn default() -> Self {
        Self { exposure: 0.0, curve: ToneCurve::Clamp }
    }
}

impl Tone {
    /// Returns a layer as opaque sRGB codes. Integer colours are rounded to 8 bits and not changed otherwise. Values of
    /// data, such as depths, become grey from the smallest finite value to the largest. NaN is black.
    pub fn displayed(&self, picture: &Picture, layer: &Layer) -> Image<Rgba8> {
        self.displayed_in(picture, layer, None)
    }

    /// Returns a layer as opaque sRGB codes, as [`Self::displayed`] does, but shows the values of data from black to white
    /// over `range`; `None` means the range of all finite values.
    pub fn displayed_in(&self, picture: &Picture, layer: &Layer, range: Option<RangeInclusive<f64>>) -> Image<Rgba8> {
        let (width, height) = picture.size();
        let draw = |code: &dyn Fn(f64) -> u8| {
            Image::from_fn(width, height, |x, y| {
                let [r, g, b] = picture.value(layer, x, y).map(code);
                [r, g, b, 255]
            })
        };
        if !layer.is_color {
            let (low, high) = range.map_or_else(|| finite_range(picture, layer), RangeInclusive::into_inner);
            let span = if high > low { high - low } else { 1.0 };
            return draw(&|value| quantize(((value - low) / span) as f32));
        }
        if !picture.is_float(layer) {
            return draw(&|value| quantize((value / 255.0) as f32));
        }
        let (tables, gain) = (Tables::get(), self.exposure.exp2());
        draw(&|value| tables.encode(self.curve.map((value as f32 * gain).max(0.0))))
    }
}

/// Returns the smallest and the largest finite value of a layer.
fn finite_range(picture: &Picture, layer: &Layer) -> (f64, f64) {
    let (width, height) = picture.size();
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let finite = pixels.map(|(x, y)| picture.value(layer, x, y)[0]).filter(|value| value.is_finite());
    finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_are_monotonic_and_end_within_the_range_of_a_display() {
        for curve in ToneCurve::ALL {
            let values: Vec<f32> =
                [0.0, 1e-6, 0.18, 0.5, 1.0, 4.0, 100.0, 1e30, f32::INFINITY].map(|x| curve.map(x).min(1.0)).to_vec();
            assert!(values.windows(2).all(|pair| pair[0] <= pair[1]), "{}: {values:?}", curve.name());
            assert_eq!((values[0], values[8]), (0.0, 1.0), "{}", curve.name());
        }
        assert_eq!(ToneCurve::Reinhard.map(1.0), 0.5);
    }
}
