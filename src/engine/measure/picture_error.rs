//! Error metrics between two pictures from files, computed from their exact samples.
//!
//! Integer colours are compared as sRGB codes from 0 to 255; 16-bit samples are divided by 257 and not rounded. If one
//! of two colours is linear light, both are compared as linear light, in which white is 1. Data such as depths are
//! compared as stored. FLIP, and SSIM of linear light, are defined for displayed pictures and are computed from the
//! 8-bit sRGB codes after tone mapping. Alpha is ignored.

use serde::Serialize;

use super::difference::{self, Difference};
use super::error::{self, ssim};
use super::flip;
use super::tone::Tone;
use crate::image::color;
use crate::image::picture::{Layer, Picture};
use crate::image::{Image, Rgba8};
use crate::pipeline::settings::{Choice, choice};

/// Constant that keeps relative errors of black pixels finite.
const RELATIVE_FLOOR: f64 = 0.01;

choice! {
    /// Error metric between two pictures.
    pub Metric {
        Psnr = "psnr", "PSNR", "Peak signal-to-noise ratio in dB; the peak is 255 for sRGB codes and 1 for linear light.";
        Ssim = "ssim", "SSIM", "Structural similarity, 1 for identical pictures; linear light is tone mapped first.";
        Flip = "flip", "FLIP", "Mean perceived difference (LDR-FLIP), 0 to 1; linear light is tone mapped first.";
        Mse = "mse", "MSE", "Mean squared error over all pixels and channels.";
        RelativeMse = "relmse", "Relative MSE",
            "Mean of (a − b)² / (b² + 0.01) in linear light, where b is the second picture or the reference.";
        Max = "max", "Largest difference", "Largest absolute difference of a channel.";
        Changed = "changed", "Changed pixels", "Number of pixels that differ in any channel except alpha.";
    }
}

impl Metric {
    /// Whether larger values mean a smaller error.
    pub fn is_larger_better(self) -> bool {
        matches!(self, Self::Psnr | Self::Ssim)
    }

    /// Formats a value with its unit and at least four significant digits.
    pub fn format(self, value: f64) -> String {
        match self {
            Self::Changed => format!("{value}"),
            Self::Psnr => format!("{value:.4} dB"),
            _ if value == 0.0 || (1e-3..1e7).contains(&value.abs()) => format!("{value:.6}"),
            _ => format!("{value:.6e}"),
        }
    }

    /// Whether the metric is defined for data, such as depths and ids, and not only for colours.
    pub fn measures_data(self) -> bool {
        matches!(self, Self::Mse | Self::Max | Self::Changed)
    }
}

choice! {
    /// Scale of the compared values.
    pub ValueScale {
        Codes = "codes", "sRGB codes, white is 255", "Integer colours; 16-bit samples are divided by 257.";
        Linear = "linear", "linear light, white is 1", "Float colours; integer colours are converted to linear light.";
        Stored = "stored", "values as stored", "Data that are no colours, such as depths and ids.";
    }
}

/// Layer of a picture that takes part in a comparison.
#[derive(Clone, Copy, Debug)]
pub struct PictureLayer<'a> {
    /// Picture with the layer.
    pub picture: &'a Picture,
    /// Compared layer.
    pub layer: &'a Layer,
}

/// Reason why two layers cannot be compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Incomparable {
    /// The pictures have different sizes.
    #[error("the pictures have different sizes: {} × {} px and {} × {} px", .0.0, .0.1, .1.0, .1.1)]
    Sizes((u32, u32), (u32, u32)),
    /// One layer is a colour and the other is not.
    #[error("one layer is a colour and the other is not")]
    Kinds,
}

/// Two layers of the same size, which are compared on a common scale.
#[derive(Clone, Copy, Debug)]
pub struct LayerPair<'a> {
    layers: [PictureLayer<'a>; 2],
    scale: ValueScale,
    tone: Tone,
}

/// Differences of values, accumulated over all pixels.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    squares: f64,
    relative: f64,
    max: f64,
    changed: u64,
    /// Number of pixels without finite differences.
    non_finite: u64,
}

impl<'a> LayerPair<'a> {
    /// Prepares a comparison of two layers. `tone` converts linear light for metrics of displayed pictures.
    ///
    /// # Errors
    /// Returns the reason if the layers cannot be compared.
    pub fn new(a: PictureLayer<'a>, b: PictureLayer<'a>, tone: Tone) -> Result<Self, Incomparable> {
        if a.picture.size() != b.picture.size() {
            return Err(Incomparable::Sizes(a.picture.size(), b.picture.size()));
        }
        if a.layer.is_color != b.layer.is_color {
            return Err(Incomparable::Kinds);
        }
        let is_linear = [a, b].iter().any(|of| of.picture.is_float(of.layer));
        let scale = match a.layer.is_color {
            false => ValueScale::Stored,
            true if is_linear => ValueScale::Linear,
            true => ValueScale::Codes,
        };
        Ok(Self { layers: [a, b], scale, tone })
    }

    /// Returns the scale of the compared values.
    pub fn scale(&self) -> ValueScale {
        self.scale
    }

    /// Measures all `metrics`. Returns one value for each of them, or `None` for a metric that is not defined for data.
    pub fn measure(&self, metrics: &[Metric]) -> PictureErrors {
        let sums = self.sums(self.scale);
        // Pixels without a finite difference have no part in the means.
        let (width, height) = self.size();
        let pixels = u64::from(width) * u64::from(height) - sums.non_finite;
        let mean = |sum: f64| sum / (3 * pixels.max(1)) as f64;
        let value = |metric: Metric| match metric {
            Metric::Psnr => 10.0 * (self.peak().powi(2) / mean(sums.squares)).log10(),
            Metric::Ssim => self.ssim(),
            Metric::Flip => {
                let [a, b] = self.displayed();
                flip::map(&a, &b).map_or(f64::NAN, |map| flip::mean(&map))
            }
            Metric::Mse => mean(sums.squares),
            Metric::RelativeMse => {
                let linear = if self.scale == ValueScale::Codes { self.sums(ValueScale::Linear) } else { sums };
                mean(linear.relative)
            }
            Metric::Max => sums.max,
            Metric::Changed => sums.changed as f64,
        };
        let measured =
            |metric: &Metric| (self.scale != ValueScale::Stored || metric.measures_data()).then(|| value(*metric));
        PictureErrors {
            metrics: metrics.iter().map(|metric| (*metric, measured(metric))).collect(),
            non_finite_pixels: sums.non_finite,
        }
    }

    /// Returns the difference of every pixel in the unit of [`difference::values`]: 8-bit steps for sRGB codes, and
    /// 1/255 for linear light. Data are scaled so that their largest difference is 255. FLIP is computed from the
    /// displayed pictures.
    pub fn difference(&self, kind: Difference) -> Image<f32> {
        if kind == Difference::Flip {
            let [a, b] = self.displayed();
            return difference::values(kind, &a, &b).unwrap_or_else(|| Image::filled(0, 0, 0.0));
        }
        let factor = match self.scale {
            ValueScale::Codes => 1.0,
            ValueScale::Linear => 255.0,
            ValueScale::Stored => 255.0 / self.sums(self.scale).max.max(f64::MIN_POSITIVE),
        };
        let (width, height) = self.size();
        Image::from_fn(width, height, |x, y| {
            let [a, b] = self.layers.map(|of| value(of, self.scale, x, y));
            let steps = [0, 1, 2].map(|channel: usize| channel_difference(a[channel], b[channel]) * factor);
            let largest = steps
                .iter()
                .fold(0.0_f64, |most, step| if step.is_finite() { most.max(step.abs()) } else { f64::INFINITY });
            let value = match kind {
                Difference::Changed => f64::from(u8::from(largest > 0.0)),
                Difference::Signed => 0.2126 * steps[0] + 0.7152 * steps[1] + 0.0722 * steps[2],
                Difference::Squared => steps.iter().map(|step| step * step).sum::<f64>() / 3.0,
                Difference::Absolute | Difference::Flip => largest,
            };
            value as f32
        })
    }

    /// Returns both layers as opaque sRGB codes, as they are displayed.
    pub fn displayed(&self) -> [Image<Rgba8>; 2] {
        self.layers.map(|PictureLayer { picture, layer }| self.tone.displayed(picture, layer))
    }

    /// Returns the width and height of both pictures in pixels.
    fn size(&self) -> (u32, u32) {
        self.layers[0].picture.size()
    }

    /// Returns the value of white.
    fn peak(&self) -> f64 {
        if self.scale == ValueScale::Codes { 255.0 } else { 1.0 }
    }

    fn ssim(&self) -> f64 {
        let (width, height) = self.size();
        let luma = |of| Image::from_fn(width, height, |x, y| error::luma(value(of, self.scale, x, y)));
        match self.scale {
            ValueScale::Codes => ssim(&luma(self.layers[0]), &luma(self.layers[1])),
            _ => {
                let [a, b] = self.displayed().map(|shown| shown.map(error::luma_of_codes));
                ssim(&a, &b)
            }
        }
    }

    fn sums(&self, scale: ValueScale) -> Sums {
        let (width, height) = self.size();
        let mut sums = Sums::default();
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            let [a, b] = self.layers.map(|of| value(of, scale, x, y));
            let differences = [0, 1, 2].map(|channel: usize| channel_difference(a[channel], b[channel]));
            sums.changed += u64::from(differences.iter().any(|difference| *difference != 0.0));
            if !differences.iter().all(|difference| difference.is_finite()) {
                sums.non_finite += 1;
                continue;
            }
            for (difference, b) in differences.iter().zip(&b).filter(|(difference, _)| **difference != 0.0) {
                sums.squares += difference * difference;
                sums.relative += difference * difference / (b * b + RELATIVE_FLOOR);
                sums.max = sums.max.max(difference.abs());
            }
        }
        sums
    }
}

/// Values of metrics for two pictures.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PictureErrors {
    /// Each metric with its value; `None` if the metric is not defined for data.
    pub metrics: Vec<(Metric, Option<f64>)>,
    /// Number of pixels with NaN or infinity in one picture where the other has another value. Means and the largest
    /// difference leave them out.
    pub non_finite_pixels: u64,
}

/// Returns a − b, or 0 if both are NaN or the same infinity.
fn channel_difference(a: f64, b: f64) -> f64 {
    if a == b || a.is_nan() && b.is_nan() { 0.0 } else { a - b }
}

/// Returns the values of a layer at a pixel on a scale.
fn value(PictureLayer { picture, layer }: PictureLayer<'_>, scale: ValueScale, x: u32, y: u32) -> [f64; 3] {
    let value = picture.value(layer, x, y);
    let is_converted = scale == ValueScale::Linear && !picture.is_float(layer);
    if is_converted { value.map(|code| color::decode((code / 255.0) as f32).into()) } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::picture::{Channel, DataWindow, Samples};

    fn picture(samples: Vec<Samples>) -> Picture {
        let window = DataWindow { left: 0, top: 0, width: 2, height: 1 };
        let channel = |(name, samples): (&&str, Samples)| Channel::new((*name).to_owned(), samples, window);
        let names = if samples.len() == 1 { &["Z"][..] } else { &["R", "G", "B"][..] };
        Picture::new("test", (2, 1), names.iter().zip(samples).map(channel).collect())
    }

    fn measured(a: &Picture, b: &Picture) -> (ValueScale, PictureErrors) {
        let [a, b] = [a, b].map(|picture| PictureLayer { picture, layer: &picture.layers()[0] });
        let pair = LayerPair::new(a, b, Tone::default()).unwrap();
        (pair.scale(), pair.measure(Metric::ALL))
    }

    fn value(errors: &PictureErrors, wanted: Metric) -> Option<f64> {
        errors.metrics.iter().find(|(metric, _)| *metric == wanted).and_then(|(_, value)| *value)
    }

    #[test]
    fn sixteen_bit_codes_are_not_rounded() {
        let of = |first: u16| {
            picture(vec![Samples::U16(vec![first, 9]), Samples::U16(vec![0; 2]), Samples::U16(vec![0; 2])])
        };
        let (scale, errors) = measured(&of(1000), &of(1001));
        assert_eq!((scale, value(&errors, Metric::Changed)), (ValueScale::Codes, Some(1.0)));
        let step = 1001.0 / 257.0 - 1000.0 / 257.0;
        assert_eq!(value(&errors, Metric::Max), Some(step));
        assert_eq!(value(&errors, Metric::Mse), Some(step * step / 6.0));
    }

    #[test]
    fn floats_are_compared_as_linear_light_even_with_integers() {
        let white = picture(vec![Samples::U8(vec![255; 2]), Samples::U8(vec![255; 2]), Samples::U8(vec![0; 2])]);
        let bright =
            picture(vec![Samples::F32(vec![1.0, 3.0]), Samples::F32(vec![1.0; 2]), Samples::F32(vec![0.0; 2])]);
        let (scale, errors) = measured(&white, &bright);
        assert_eq!((scale, value(&errors, Metric::Max)), (ValueScale::Linear, Some(2.0)));
        assert_eq!(value(&errors, Metric::Psnr), Some(10.0 * (6.0_f64 / 4.0).log10()));
        assert_eq!(value(&errors, Metric::RelativeMse), Some(4.0 / 9.01 / 6.0));
        assert_eq!(value(&errors, Metric::Flip), Some(0.0), "both are displayed as the same colour");
    }

    #[test]
    fn equal_values_that_are_not_finite_do_not_differ_and_others_are_counted() {
        let of = |red: [f32; 2]| {
            picture(vec![Samples::F32(red.to_vec()), Samples::F32(vec![0.0; 2]), Samples::F32(vec![0.0; 2])])
        };
        let (_, same) = measured(&of([f32::NAN, f32::INFINITY]), &of([f32::NAN, f32::INFINITY]));
        assert_eq!(
            (same.non_finite_pixels, value(&same, Metric::Changed), value(&same, Metric::Mse)),
            (0, Some(0.0), Some(0.0))
        );
        let (_, other) = measured(&of([f32::NAN, 0.5]), &of([1.0, 0.25]));
        assert_eq!((other.non_finite_pixels, value(&other, Metric::Changed)), (1, Some(2.0)));
        assert_eq!(value(&other, Metric::Mse), Some(0.0625 / 3.0));
    }

    #[test]
    fn ids_are_compared_as_stored_and_have_no_psnr() {
        let of = |first: u32| picture(vec![Samples::U32(vec![first, 7])]);
        let (scale, errors) = measured(&of(u32::MAX), &of(u32::MAX - 1));
        assert_eq!(
            (scale, value(&errors, Metric::Max), value(&errors, Metric::Psnr)),
            (ValueScale::Stored, Some(1.0), None)
        );
    }
}
