//! Error metrics between two pictures from files, computed from their exact samples.
//!
//! Integer colours are compared as sRGB codes from 0 to 255; 16-bit samples are divided by 257 and not rounded. If one
//! of two colours is linear light, both are compared as linear light, in which white is 1. Data such as depths are
//! compared as stored. Perceptual metrics, and SSIM and MS-SSIM of linear light, are defined for displayed pictures and
//! are computed from the 8-bit sRGB codes after tone mapping. Alpha is ignored.

use std::cell::OnceCell;

use serde::Serialize;

use super::difference::{self, Difference};
use super::error::{self, ssim};
use super::jod::{self, Viewing};
use super::metric::Metric;
use super::ms_ssim::ms_ssim;
use super::tone::Tone;
use super::{flip, ssimulacra2};
use crate::image::color;
use crate::image::picture::{Layer, Picture};
use crate::image::{Image, Rgba8};
use crate::pipeline::settings::{Choice, choice};

/// Constant that keeps relative errors of black pixels finite.
const RELATIVE_FLOOR: f64 = 0.01;

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
    viewing: Viewing,
}

/// Differences of values, accumulated over all pixels.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    pixels: u64,
    squares: f64,
    relative: f64,
    max: f64,
    changed: u64,
    /// Number of pixels without finite differences.
    non_finite: u64,
}

impl Sums {
    /// Returns the mean of a sum over all channels of the pixels with a finite difference.
    fn mean(&self, sum: f64) -> f64 {
        sum / (3 * (self.pixels - self.non_finite).max(1)) as f64
    }
}

/// Computes a metric that observers' judgements define from two displayed pictures, or returns `None` for other metrics
/// and for pictures of an unsupported size. The second picture is the reference.
fn perceptual(metric: Metric, [a, b]: &[Image<Rgba8>; 2], viewing: &Viewing) -> Option<f64> {
    match metric {
        Metric::Flip => flip::map(a, b).map(|map| flip::mean(&map)),
        Metric::Ssimulacra2 => ssimulacra2::score(a, b),
        Metric::Jod => jod::of_pictures(a, b, viewing),
        _ => None,
    }
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
        Ok(Self { layers: [a, b], scale, tone, viewing: Viewing::default() })
    }

    /// Sets the viewing conditions of ColorVideoVDP.
    pub fn seen_at(self, viewing: Viewing) -> Self {
        Self { viewing, ..self }
    }

    /// Returns the scale of the compared values.
    pub fn scale(&self) -> ValueScale {
        self.scale
    }

    /// Measures all `metrics`. Returns one value for each of them, or `None` for a metric that is not defined for data or
    /// for pictures of this size.
    pub fn measure(&self, metrics: &[Metric]) -> PictureErrors {
        let sums = self.sums(self.scale);
        // Several metrics read the displayed pictures.
        let displayed = OnceCell::new();
        let displayed = || displayed.get_or_init(|| self.displayed());
        let value = |metric: Metric| match metric {
            _ if self.scale == ValueScale::Stored && !metric.measures_data() => None,
            Metric::Psnr => Some(10.0 * (self.peak().powi(2) / sums.mean(sums.squares)).log10()),
            Metric::Ssim => Some(self.structural(ssim, displayed())),
            Metric::MsSsim => Some(self.structural(ms_ssim, displayed())),
            Metric::Mse => Some(sums.mean(sums.squares)),
            Metric::RelativeMse if self.scale == ValueScale::Codes => {
                let linear = self.sums(ValueScale::Linear);
                Some(linear.mean(linear.relative))
            }
            Metric::RelativeMse => Some(sums.mean(sums.relative)),
            Metric::Max => Some(sums.max),
            Metric::Changed => Some(sums.changed as f64),
            Metric::Flip | Metric::Ssimulacra2 | Metric::Jod => perceptual(metric, displayed(), &self.viewing),
        };
        PictureErrors {
            metrics: metrics.iter().map(|metric| (*metric, value(*metric))).collect(),
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

    /// Computes a metric of luma, from exact sRGB codes or, for other scales, from the displayed pictures.
    fn structural(&self, of_luma: fn(&Image<f64>, &Image<f64>) -> f64, [a, b]: &[Image<Rgba8>; 2]) -> f64 {
        let (width, height) = self.size();
        let luma = |of| Image::from_fn(width, height, |x, y| error::luma(value(of, self.scale, x, y)));
        match self.scale {
            ValueScale::Codes => of_luma(&luma(self.layers[0]), &luma(self.layers[1])),
            _ => of_luma(&a.map(error::luma_of_codes), &b.map(error::luma_of_codes)),
        }
    }

    fn sums(&self, scale: ValueScale) -> Sums {
        let (width, height) = self.size();
        let mut sums = Sums { pixels: u64::from(width) * u64::from(height), ..Sums::default() };
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

/// Computes a metric of two 8-bit pictures; the second one is the reference. Returns `None` if the sizes differ, or if the
/// metric is not defined for pictures of this size.
pub(super) fn error_of_codes(metric: Metric, a: &Image<Rgba8>, b: &Image<Rgba8>) -> Option<f64> {
    let pictures = [a, b].map(Picture::of_codes);
    let [a, b] = pictures.each_ref().map(|picture| Some(PictureLayer { picture, layer: picture.layers().first()? }));
    let pair = LayerPair::new(a?, b?, Tone::default()).ok()?;
    pair.measure(&[metric]).metrics.first()?.1
}

/// Values of metrics for two pictures.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PictureErrors {
    /// Each metric with its value; `None` if the metric is not defined for data or for pictures of this size.
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
