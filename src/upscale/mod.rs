//! From few drawn pixels to a full picture.
//!
//! In: the pixels that were drawn, packed as [`SampleGrid`] says. Out: the whole picture, of any size from 1 × 1 on, in
//! which every drawn pixel stands unchanged where it was drawn (corner phase: of a block it is the top-left pixel).
//!
//! Methods filter sRGB codes, as the source article does: interpolating in linear light rings darker at edges. All
//! arithmetic is exact until the one rounding at the end, half up, so a picture is the same bit for bit whatever the
//! number of threads, and [`Upscaler::taps`] tells the whole truth about a pixel.
//!
//! Each method is one file and one entry of [`ALL`]; menus, command line, tests and reports read the registry.

use serde::{Deserialize, Serialize};

use crate::image::{Image, Rgba8};
use crate::pipeline::grid::SampleGrid;

mod bicubic;
mod bilinear;
mod checkerboard;
mod kernel;
mod native;
mod nearest;

pub use bicubic::BICUBIC;
pub use bilinear::BILINEAR;
pub use checkerboard::CHECKERBOARD;
pub use native::NATIVE;
pub use nearest::NEAREST;

/// A method that fills in the pixels that were not drawn.
pub trait Upscaler: Sync {
    /// Word by which recipes and the command line name it; kebab case.
    fn id(&self) -> &'static str;

    /// What a person calls it.
    fn name(&self) -> &'static str;

    /// One or two sentences: what it does, where it is good, which artefact it makes, and the source.
    fn help(&self) -> &'static str;

    /// Enlargements per axis that it can do, smallest first; `[1]` if it has none to choose.
    fn scales(&self) -> &'static [u32];

    /// Which pixels must be drawn for an enlargement by `scale` per axis, one of [`Upscaler::scales`] here and below.
    fn grid(&self, scale: u32) -> SampleGrid;

    /// Fills a picture of `width` × `height` px from `drawn`, packed as [`Upscaler::grid`] says for that size; may panic
    /// if it is packed otherwise.
    fn upscale(&self, drawn: &Image<Rgba8>, scale: u32, width: u32, height: u32) -> Image<Rgba8>;

    /// The drawn pixels that output pixel (x, y) is made of: each once, with its exact weight, none of them zero. Weights
    /// sum to one; the weighted sum of codes, rounded half up and clamped, is the pixel.
    fn taps(&self, x: u32, y: u32, scale: u32, width: u32, height: u32) -> Vec<Tap>;
}

/// One drawn pixel and its share in an output pixel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Tap {
    /// Column in the full picture.
    pub x: u32,
    /// Row in the full picture.
    pub y: u32,
    /// Its share; negative ones sharpen.
    pub weight: f32,
}

/// All methods, in the order in which menus list them.
pub const ALL: &[&dyn Upscaler] = &[&NATIVE, &CHECKERBOARD, &NEAREST, &BILINEAR, &BICUBIC];

/// The choice of a method and an enlargement: part of a recipe. Always one that exists.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "Choice", into = "Choice")]
pub struct Upscaling {
    /// Position in [`ALL`].
    method: usize,
    scale: u32,
}

/// [`Upscaling`] as written in files.
#[derive(Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Choice {
    method: String,
    scale: u32,
}

impl Upscaling {
    /// Every pixel drawn: the first entry of [`ALL`].
    pub const NATIVE: Self = Self { method: 0, scale: 1 };

    /// A method by its id with an enlargement per axis. The nearest enlargement that the method offers is taken.
    pub fn new(method: &str, scale: u32) -> Option<Self> {
        let method = ALL.iter().position(|u| u.id() == method)?;
        let scale = *ALL[method].scales().iter().min_by_key(|s| s.abs_diff(scale))?;
        Some(Self { method, scale })
    }

    /// Every method with every enlargement.
    pub fn every() -> impl Iterator<Item = Self> {
        ALL.iter()
            .enumerate()
            .flat_map(|(method, u)| u.scales().iter().map(move |scale| Self { method, scale: *scale }))
    }

    /// Whether every pixel is drawn and none filled in.
    pub fn is_native(self) -> bool {
        self == Self::NATIVE
    }

    /// The method.
    pub fn upscaler(self) -> &'static dyn Upscaler {
        ALL[self.method]
    }

    /// Id of the method.
    pub fn method(self) -> &'static str {
        self.upscaler().id()
    }

    /// Enlargement per axis.
    pub fn scale(self) -> u32 {
        self.scale
    }

    /// Which pixels are drawn.
    pub fn grid(self) -> SampleGrid {
        self.upscaler().grid(self.scale)
    }

    /// Name with the enlargement, such as "Bicubic ×4".
    pub fn label(self) -> String {
        match self.upscaler().scales() {
            [_] => self.upscaler().name().to_owned(),
            _ => format!("{} ×{}", self.upscaler().name(), self.scale),
        }
    }
}

impl TryFrom<Choice> for Upscaling {
    type Error = String;

    fn try_from(Choice { method, scale }: Choice) -> Result<Self, String> {
        Self::new(&method, scale).ok_or_else(|| {
            let known: Vec<_> = ALL.iter().map(|u| format!("`{}`", u.id())).collect();
            format!("unknown upscaler `{method}`, expected one of {}", known.join(", "))
        })
    }
}

impl From<Upscaling> for Choice {
    fn from(upscaling: Upscaling) -> Self {
        Self { method: upscaling.method().to_owned(), scale: upscaling.scale }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(random: &mut fastrand::Rng, width: u32, height: u32) -> Image<Rgba8> {
        // Extremes half of the time: they make cubics overshoot.
        Image::from_fn(width, height, |_, _| {
            std::array::from_fn(|_| if random.bool() { random.u8(..) } else { 255 * random.u8(..2) })
        })
    }

    /// What the rasterizer hands over: drawn pixels of `full`, and rubbish where the packed picture has no sample.
    fn draw(full: &Image<Rgba8>, grid: SampleGrid) -> Image<Rgba8> {
        let (width, height) = grid.packed_size(full.width(), full.height());
        Image::from_fn(width, height, |column, row| {
            let (x, y) = grid.pixel(column, row);
            full.get(x, y).unwrap_or([255, 0, 173, 1])
        })
    }

    /// Runs `check` with a method, its picture and the noise that was drawn, for every method and small size.
    fn for_every_method_and_size(mut check: impl FnMut(Upscaling, &Image<Rgba8>, &Image<Rgba8>)) {
        let mut random = fastrand::Rng::with_seed(17);
        for (width, height) in (1..=13).flat_map(|width| (1..=9).map(move |height| (width, height))) {
            let native = noise(&mut random, width, height);
            for method in Upscaling::every() {
                let drawn = draw(&native, method.grid());
                let full = method.upscaler().upscale(&drawn, method.scale(), width, height);
                assert_eq!(full.size(), (width, height), "{}", method.label());
                check(method, &full, &native);
            }
        }
    }

    fn places(image: &Image<Rgba8>) -> impl Iterator<Item = (u32, u32)> + use<> {
        let (width, height) = image.size();
        (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)))
    }

    #[test]
    fn every_pixel_is_the_rounded_sum_of_its_taps() {
        for_every_method_and_size(|method, full, native| {
            for (x, y) in places(full) {
                let taps = method.upscaler().taps(x, y, method.scale(), full.width(), full.height());
                let expected: Rgba8 = std::array::from_fn(|c| {
                    let sum: f64 = taps.iter().map(|t| f64::from(t.weight) * f64::from(native.at(t.x, t.y)[c])).sum();
                    (sum + 0.5).floor().clamp(0.0, 255.0) as u8
                });
                assert_eq!(full.at(x, y), expected, "{} {:?} ({x}, {y}): {taps:?}", method.label(), full.size());
            }
        });
    }

    #[test]
    fn taps_are_distinct_drawn_pixels_whose_weights_sum_to_one() {
        for_every_method_and_size(|method, full, _| {
            for (x, y) in places(full) {
                let taps = method.upscaler().taps(x, y, method.scale(), full.width(), full.height());
                let context = || format!("{} {:?} ({x}, {y}): {taps:?}", method.label(), full.size());
                assert_eq!(taps.iter().map(|t| f64::from(t.weight)).sum::<f64>(), 1.0, "{}", context());
                for (i, tap) in taps.iter().enumerate() {
                    assert!(tap.weight != 0.0 && tap.x < full.width() && tap.y < full.height(), "{}", context());
                    assert!(method.grid().sample_at(tap.x, tap.y).is_some(), "not drawn: {}", context());
                    assert!(taps[..i].iter().all(|t| (t.x, t.y) != (tap.x, tap.y)), "twice: {}", context());
                }
            }
        });
    }

    #[test]
    fn drawn_pixels_come_out_unchanged() {
        for_every_method_and_size(|method, full, native| {
            for (x, y) in places(full).filter(|(x, y)| method.grid().sample_at(*x, *y).is_some()) {
                assert_eq!(full.at(x, y), native.at(x, y), "{} {:?} ({x}, {y})", method.label(), full.size());
            }
        });
    }

    #[test]
    fn a_picture_of_one_colour_stays_so() {
        for method in Upscaling::every() {
            for colour in [[0; 4], [255; 4], [1, 127, 128, 254]] {
                let native = Image::filled(11, 7, colour);
                let full = method.upscaler().upscale(&draw(&native, method.grid()), method.scale(), 11, 7);
                assert_eq!(full, native, "{}", method.label());
            }
        }
    }

    #[test]
    fn bands_of_rows_meet_without_a_seam() {
        let native = noise(&mut fastrand::Rng::with_seed(3), 5, 150);
        for method in Upscaling::every() {
            let full = method.upscaler().upscale(&draw(&native, method.grid()), method.scale(), 5, 150);
            let upper = Image::from_fn(5, 60, |x, y| native.at(x, y));
            let alone = method.upscaler().upscale(&draw(&upper, method.grid()), method.scale(), 5, 60);
            // The cubic looks two samples ahead.
            for y in 0..60 - 2 * 4 {
                assert_eq!(full.row(y), alone.row(y), "{} row {y}", method.label());
            }
            let lower = Image::from_fn(5, 102, |x, y| native.at(x, y + 48));
            let alone = method.upscaler().upscale(&draw(&lower, method.grid()), method.scale(), 5, 102);
            for y in 2 * 4..102 {
                assert_eq!(full.row(y + 48), alone.row(y), "{} row {y} + 48", method.label());
            }
        }
    }

    #[test]
    fn an_empty_picture_stays_empty() {
        for method in Upscaling::every() {
            for (width, height) in [(0, 0), (0, 5), (5, 0)] {
                let (packed_width, packed_height) = method.grid().packed_size(width, height);
                let drawn = Image::filled(packed_width, packed_height, [9; 4]);
                let full = method.upscaler().upscale(&drawn, method.scale(), width, height);
                assert_eq!(full.size(), (width, height), "{}", method.label());
            }
        }
    }

    #[test]
    fn the_nearest_enlargement_on_offer_is_taken() {
        let labels = [("checkerboard", 4), ("bilinear", 1), ("bicubic", 99)]
            .map(|(method, scale)| Upscaling::new(method, scale).map(Upscaling::label).unwrap_or_default());
        assert_eq!(labels, ["Checkerboard", "Bilinear ×2", "Bicubic ×4"]);
        assert_eq!(Upscaling::new("lanczos", 2), None);
    }

    #[test]
    fn a_choice_reads_back_as_written_and_an_unknown_one_names_the_known() {
        for method in Upscaling::every() {
            let written = serde_json::to_string(&method).unwrap();
            assert_eq!(serde_json::from_str::<Upscaling>(&written).unwrap(), method, "{written}");
        }
        let error = serde_json::from_str::<Upscaling>(r#"{"method":"dlss","scale":2}"#).unwrap_err().to_string();
        assert!(error.contains("`dlss`") && error.contains("`bicubic`"), "{error}");
    }

    #[test]
    fn ids_are_distinct_and_lead_back_to_their_method() {
        for upscaler in ALL {
            let choice = Upscaling::new(upscaler.id(), 1).map(Upscaling::method);
            assert_eq!(choice, Some(upscaler.id()));
        }
    }
}
