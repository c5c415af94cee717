//! `upscale`: enlarges a picture of 8-bit codes with the renderer's upscalers.

use serde::{Deserialize, Serialize};

use super::texture::codes;
use super::{Check, Control, Real, Refusal, Unanswered, check_length, check_picture, json};
use crate::image::{Image, Rgba8};
use crate::text;
use crate::upscale::{Anchor, Scale, UpscaleInputs, Upscaling};

/// Input of an `upscale` case: a picture and an upscaling method.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Upscale {
    /// Samples of the picture as 8-bit codes, row by row from the top.
    #[serde(deserialize_with = "json::rows")]
    pub(crate) image: Image<Real>,
    /// Scale factor per axis, such as 1.3, 1.5 or 2.
    pub(crate) scale: Real,
    /// Name of the filter kernel, such as `lanczos2`.
    pub(crate) kernel: String,
    /// Alignment of output and input: `corner` maps input sample k to output pixel `scale` · k along each axis;
    /// `center` aligns the centres of both pictures.
    pub(crate) phase: String,
}

/// Kernel names in case files, each with the id of the upscaling method that implements the kernel.
const METHOD_OF_KERNEL: [(&str, &str); 8] = [
    ("nearest_floor", "nearest"),
    ("nearest", "nearest"),
    ("bilinear", "bilinear"),
    ("lagrange", "bicubic"),
    ("catmull_rom", "catmull-rom"),
    ("mitchell", "mitchell"),
    ("lanczos2", "lanczos2"),
    ("lanczos3", "lanczos3"),
];

/// Phase names in case files, each with the corresponding anchor.
const ANCHOR_OF_PHASE: [(&str, Anchor); 2] = [("corner", Anchor::Corner), ("center", Anchor::Centre)];

impl Check for Upscale {}

impl Upscale {
    pub(super) fn answer(&self, control: &Control<'_>) -> Result<UpscaleAnswer, Unanswered> {
        let how = self.choice()?;
        let drawn = codes(&self.image)?;
        let (pixels, samples) = how.scale().ratio();
        let enlarged = |side: u32| u32::try_from(u64::from(side) * u64::from(pixels) / u64::from(samples));
        let [width, height] = [drawn.width(), drawn.height()].map(|side| enlarged(side).unwrap_or(u32::MAX));
        check_picture(width, height).map_err(Refusal)?;
        // Memory per pixel: the value, the code, and the pixel of the enlarged picture.
        check_length::<(f64, u8, Rgba8)>("pixels", u64::from(width) * u64::from(height))?;
        if self.kernel == "nearest" && self.phase == "corner" {
            return nearest_at_corner(how.scale(), &drawn, (width, height), control);
        }
        let full = how.upscale(&UpscaleInputs::from(&drawn), width, height);
        let codes = |y: u32| full.row(y).iter().map(|pixel| pixel[0]).collect();
        let mut values = Vec::with_capacity(height as usize);
        for y in 0..height {
            let row = (0..width).map(|x| Some(weighted(how, &drawn, full.size(), (x, y))));
            let pixels = u64::from(width) * u64::from(height);
            values.push(control.collect("pixels", (u64::from(y) * u64::from(width), pixels), row)?);
        }
        Ok(UpscaleAnswer { quantized: false, values, codes: (0..height).map(codes).collect() })
    }

    fn choice(&self) -> Result<Upscaling, Refusal> {
        let Self { kernel, phase, scale, .. } = self;
        let id = METHOD_OF_KERNEL.iter().find(|(known, _)| known == kernel).map(|(_, id)| *id);
        let how = id.and_then(|id| Upscaling::new(id, scale.0));
        let how = how.ok_or_else(|| Refusal(format!("no upscaler has the kernel `{}`", text::message(kernel))))?;
        let anchor = ANCHOR_OF_PHASE.iter().find(|(known, _)| known == phase).map(|(_, anchor)| *anchor);
        let anchor = anchor.ok_or_else(|| Refusal(format!("no upscaler has the phase `{}`", text::message(phase))))?;
        if how.scale().value() != scale.0 {
            let scales: Vec<_> = how.upscaler().offers().scales.iter().map(Scale::to_string).collect();
            let scales = scales.join(", ");
            return Err(Refusal(format!(
                "the upscaler `{}` does not scale by {}, only by {scales}",
                how.method(),
                scale.0
            )));
        }
        if kernel == "nearest_floor" && anchor != Anchor::Corner {
            return Err(Refusal("the kernel `nearest_floor` needs the phase `corner`".to_owned()));
        }
        Ok(how.with_anchor(anchor))
    }
}

/// Enlarges a picture with corner alignment: output pixel x takes the sample nearest to x / scale along each axis. Of
/// two equally near samples, it takes the right or the lower one.
///
/// With this alignment, the upscaler `nearest` rounds the position down instead. In case files, that kernel is called
/// `nearest_floor`.
fn nearest_at_corner(
    scale: Scale,
    drawn: &Image<Rgba8>,
    (width, height): (u32, u32),
    control: &Control<'_>,
) -> Result<UpscaleAnswer, Unanswered> {
    let (pixels, samples) = scale.ratio();
    let nearest = |at: u32, count: u32| ((2 * at * samples + pixels) / (2 * pixels)).min(count - 1);
    let code = |x: u32, y: u32| drawn.at(nearest(x, drawn.width()), nearest(y, drawn.height()))[0];
    let (mut values, mut codes) = (Vec::new(), Vec::new());
    for y in 0..height {
        control.step(f64::from(y) / f64::from(height))?;
        let row: Vec<u8> = (0..width).map(|x| code(x, y)).collect();
        values.push(row.iter().copied().map(f64::from).collect());
        codes.push(row);
    }
    Ok(UpscaleAnswer { quantized: false, values, codes })
}

/// Returns the weighted sum of the 8-bit sample codes at an output pixel, neither rounded nor clamped.
fn weighted(how: Upscaling, drawn: &Image<Rgba8>, size: (u32, u32), at: (u32, u32)) -> f64 {
    let grid = how.grid();
    let taps = how.upscaler().taps(how, &UpscaleInputs::from(drawn), size, at);
    let samples = taps.iter().filter_map(|tap| Some((tap.weight, grid.sample_at(tap.x, tap.y)?)));
    samples.map(|(weight, (column, row))| f64::from(weight) * f64::from(drawn.at(column, row)[0])).sum()
}

/// Answer to an [`Upscale`] case: the enlarged picture.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct UpscaleAnswer {
    /// Whether `values` are rounded to whole 8-bit codes.
    pub(crate) quantized: bool,
    /// Weighted sum of 8-bit sample codes at each output pixel, row by row from the top.
    pub values: Vec<Vec<f64>>,
    /// 8-bit code that the upscaler outputs at each pixel, row by row from the top.
    pub codes: Vec<Vec<u8>>,
}

#[cfg(test)]
mod tests {
    use crate::case::{Answer, Case, Control, Options, answer};

    fn enlarged(row: &str, scale: &str, kernel: &str, phase: &str) -> Result<Vec<Vec<f64>>, String> {
        let text = format!(
            r#"{{"id":"u","kind":"upscale","image":[{row}],"scale":{scale},"kernel":"{kernel}","phase":"{phase}"}}"#
        );
        let case = Case::parse(text.as_bytes(), "u.json".as_ref()).map_err(|error| error.to_string())?;
        let answer = answer(&case, Options::default(), &Control::default()).map_err(|refusal| refusal.to_string())?;
        let Answer::Upscale(picture) = answer else { unreachable!("the case is an upscale case") };
        for (values, codes) in picture.values.iter().zip(&picture.codes) {
            assert!(values.iter().zip(codes).all(|(value, code)| (value - f64::from(*code)).abs() <= 0.6), "{text}");
        }
        Ok(picture.values)
    }

    #[test]
    fn the_nearest_sample_from_the_corner_changes_halfway_between_samples() {
        let row = |scale| enlarged("[0,30,60,90]", scale, "nearest", "corner").unwrap()[0].clone();
        assert_eq!(row("3"), [0, 0, 30, 30, 30, 60, 60, 60, 90, 90, 90, 90].map(f64::from));
        assert_eq!(row("2"), [0, 30, 30, 60, 60, 90, 90, 90].map(f64::from));
        assert_eq!(row("4"), [0, 0, 30, 30, 30, 30, 60, 60, 60, 60, 90, 90, 90, 90, 90, 90].map(f64::from));
        // Sample positions: 0, 2/3, 4/3, 2, 8/3 and 10/3.
        assert_eq!(row("1.5"), [0, 30, 30, 60, 90, 90].map(f64::from));
        let floor = enlarged("[0,30,60,90]", "3", "nearest_floor", "corner").unwrap();
        assert_eq!(floor[0], [0, 0, 0, 30, 30, 30, 60, 60, 60, 90, 90, 90].map(f64::from));
    }

    #[test]
    fn an_enlargement_by_one_and_a_half_is_exact_between_its_samples() {
        for (phase, places) in [
            ("corner", [0.0, 2.0 / 3.0, 4.0 / 3.0, 2.0, 8.0 / 3.0, 3.0]),
            ("center", [0.0, 0.5, 7.0 / 6.0, 11.0 / 6.0, 2.5, 3.0]),
        ] {
            let row = enlarged("[0,30,60,90],[0,30,60,90]", "1.5", "bilinear", phase).unwrap();
            assert_eq!(row.len(), 3, "two rows become three");
            for row in row {
                assert_eq!(row.len(), 6);
                assert!(row.iter().zip(places).all(|(value, place)| (value - 30.0 * place).abs() < 1e-4), "{row:?}");
            }
        }
        let part_of_a_pixel = enlarged("[0,30,60]", "1.5", "nearest", "corner").unwrap();
        assert_eq!(part_of_a_pixel[0].len(), 4, "four whole pixels");
    }

    #[test]
    fn enlargements_that_no_upscaler_offers_are_refused() {
        for scale in ["2.5", "0.5", "-3", "5", "1.4999", "1e30"] {
            let refusal = enlarged("[0,30]", scale, "bilinear", "corner").unwrap_err();
            assert!(refusal.starts_with("the upscaler `bilinear` does not scale by "), "{refusal}");
        }
    }

    #[test]
    fn a_refusal_quotes_no_control_characters() {
        for (kernel, phase) in [(r"a\u001b[2Jb", "corner"), ("bilinear", r"a\u001b[2Jb")] {
            let refusal = enlarged("[0,30]", "2", kernel, phase).unwrap_err();
            assert!(refusal.ends_with("`a\u{fffd}[2Jb`"), "{refusal}");
        }
    }
}
