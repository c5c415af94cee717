//! From few drawn pixels to a full picture.
//!
//! Each method is one file and one entry of [`ALL`]; menus, command line, tests and reports read the registry.

use serde::{Deserialize, Serialize};

use crate::image::{Image, Rgba8};
use crate::pipeline::grid::SampleGrid;

mod native;

pub use native::NATIVE;

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

    /// Which pixels must be drawn for an enlargement by `scale` per axis.
    fn grid(&self, scale: u32) -> SampleGrid;

    /// Fills a picture of `width` × `height` px from `drawn`, packed as [`Upscaler::grid`] says. Whole picture, any
    /// size from 1 × 1 on. Filters sRGB codes and rounds half up once at the end.
    fn upscale(&self, drawn: &Image<Rgba8>, scale: u32, width: u32, height: u32) -> Image<Rgba8>;

    /// The drawn pixels that output pixel (x, y) is made of, each with its weight. Weights sum to one.
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
pub const ALL: &[&dyn Upscaler] = &[&NATIVE];

/// The choice of a method and an enlargement: part of a recipe. Always one that exists.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
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
