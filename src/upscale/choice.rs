//! The choice of a method and of what can be chosen about it: part of a recipe.

use serde::{Deserialize, Serialize};

use super::{ALL, Anchor, Drawn, Lattice, Sampling, Scale, Upscaler};
use crate::image::{Image, Rgba8};
use crate::pipeline::grid::SampleGrid;
use crate::pipeline::settings::{Choice, choice};

choice! {
    /// The numbers that are filtered.
    #[derive(PartialOrd, Ord)]
    Light {
        Bytes = "bytes", "Bytes", "sRGB codes, as most programs do: what looks even is treated as even.";
        Linear = "linear", "Linear", "Linear light: physically right averages, but dark edges ring more. Slower: each sample is decoded and each pixel encoded.";
    }
}

/// Greatest sharpening, in percent.
pub(super) const MOST_SHARPENING: u32 = 100;

/// The choice of a method and an enlargement. Always one that exists: what a method does not offer is set to what it does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "Written", into = "Written")]
pub struct Upscaling {
    /// Position in [`ALL`].
    method: usize,
    scale: Scale,
    anchor: Anchor,
    light: Light,
    deringing: bool,
    sharpening: u32,
}

/// [`Upscaling`] as written in files.
#[derive(Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    method: String,
    scale: Scale,
    /// The method's own default where absent.
    #[serde(default)]
    anchor: Option<Anchor>,
    /// The method's own default where absent.
    #[serde(default)]
    light: Option<Light>,
    #[serde(default)]
    deringing: bool,
    #[serde(default)]
    sharpening: u32,
}

impl Upscaling {
    /// Every pixel drawn: the first entry of [`ALL`].
    pub const NATIVE: Self = Self {
        method: 0,
        scale: Scale::ONE,
        anchor: Anchor::Corner,
        light: Light::Bytes,
        deringing: false,
        sharpening: 0,
    };

    /// A method by its id with an enlargement per axis, all else as the method has it first. The nearest enlargement that
    /// the method offers is taken.
    pub fn new(method: &str, scale: impl Into<Scale>) -> Option<Self> {
        let method = ALL.iter().position(|u| u.id() == method)?;
        let offers = ALL[method].offers();
        let (anchor, light) = (*offers.anchors.first()?, *offers.lights.first()?);
        Some(Self { method, scale: scale.into(), anchor, light, ..Self::NATIVE }.offered())
    }

    /// The same where the method offers it, else what it offers.
    fn offered(mut self) -> Self {
        let offers = self.upscaler().offers();
        let nearest = offers.scales.iter().min_by_key(|scale| scale.distance(self.scale));
        self.scale = nearest.copied().unwrap_or(Scale::ONE);
        self.anchor = kept_or_first(offers.anchors, self.anchor);
        self.light = kept_or_first(offers.lights, self.light);
        self.deringing &= offers.deringing;
        self.sharpening = if offers.sharpening { self.sharpening.min(MOST_SHARPENING) } else { 0 };
        self
    }

    /// Every method with every enlargement, all else as the method has it first.
    pub fn every() -> impl Iterator<Item = Self> {
        let choices = |u: &'static dyn Upscaler| u.offers().scales.iter().filter_map(|scale| Self::new(u.id(), *scale));
        ALL.iter().flat_map(move |u| choices(*u))
    }

    /// Returns another method in its default configuration at the nearest scale that it offers; `None` if there is no
    /// such method. The current method is returned unchanged, with everything that was chosen about it.
    pub fn with_method(self, method: &str) -> Option<Self> {
        if self.method() == method { Some(self) } else { Self::new(method, self.scale) }
    }

    /// Another enlargement, or the nearest that the method offers.
    pub fn with_scale(self, scale: impl Into<Scale>) -> Self {
        Self { scale: scale.into(), ..self }.offered()
    }

    /// Another anchor, if the method offers it.
    pub fn with_anchor(self, anchor: Anchor) -> Self {
        Self { anchor, ..self }.offered()
    }

    /// Other numbers to filter, if the method offers them.
    pub fn with_light(self, light: Light) -> Self {
        Self { light, ..self }.offered()
    }

    /// With overshoot cut off or not, if the method can.
    pub fn with_deringing(self, deringing: bool) -> Self {
        Self { deringing, ..self }.offered()
    }

    /// Sharpened by a share in percent, if the method can.
    pub fn with_sharpening(self, sharpening: u32) -> Self {
        Self { sharpening, ..self }.offered()
    }

    /// Whether every pixel is drawn and none filled in.
    pub fn is_native(self) -> bool {
        self.method == Self::NATIVE.method
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
    pub fn scale(self) -> Scale {
        self.scale
    }

    /// Where in its block a sample lies.
    pub fn anchor(self) -> Anchor {
        self.anchor
    }

    /// Returns where in their blocks samples lie; `None` if blocks are single pixels, where all anchors agree.
    pub fn block_anchor(self) -> Option<Anchor> {
        (self.scale != Scale::ONE).then_some(self.anchor)
    }

    /// What is filtered.
    pub fn light(self) -> Light {
        self.light
    }

    /// Whether overshoot is cut off: after each pass a value is kept between the two samples that it lies between.
    pub fn deringing(self) -> bool {
        self.deringing
    }

    /// How much the result is sharpened, in percent of the most that makes no new extremes.
    pub fn sharpening(self) -> u32 {
        self.sharpening
    }

    /// Where samples lie if they are evenly spread.
    pub fn lattice(self) -> Lattice {
        Lattice { scale: self.scale, anchor: self.anchor }
    }

    /// What is drawn.
    pub fn sampling(self) -> Sampling {
        self.upscaler().sampling(self)
    }

    /// Which pixels are drawn of the picture that is drawn.
    pub fn grid(self) -> SampleGrid {
        self.sampling().grid()
    }

    /// A full picture of `width` × `height` px from what was drawn for it.
    pub fn upscale(self, drawn: &Drawn<'_>, width: u32, height: u32) -> Image<Rgba8> {
        let mut full = Image::filled(width, height, [0; 4]);
        self.upscaler().upscale(self, drawn, &mut full);
        full
    }

    /// Returns the name with the scale and every choice that is not the method's default, such as "Bicubic ×4" or
    /// "Lanczos 3 ×1.5, centre, linear".
    pub fn label(self) -> String {
        let default_anchor = self.upscaler().offers().anchors.first();
        self.label_with(Some(self.anchor).filter(|anchor| default_anchor != Some(anchor)))
    }

    /// Returns [`Upscaling::label`] with the anchor even if it is the method's default, such as "FSR 1 ×2, centre".
    pub fn label_with_anchor(self) -> String {
        self.label_with(self.block_anchor())
    }

    fn label_with(self, anchor: Option<Anchor>) -> String {
        let offers = self.upscaler().offers();
        let mut label = self.upscaler().name().to_owned();
        if offers.scales.len() > 1 {
            label += &format!(" ×{}", self.scale);
        }
        if let Some(anchor) = anchor {
            label += &format!(", {}", anchor.id());
        }
        if offers.lights.first() != Some(&self.light) {
            label += &format!(", {}", self.light.id());
        }
        if self.deringing {
            label += ", de-ringed";
        }
        if self.sharpening > 0 {
            label += &format!(", sharpened {} %", self.sharpening);
        }
        label
    }
}

fn kept_or_first<T: Copy + PartialEq>(offered: &[T], wanted: T) -> T {
    offered.iter().find(|value| **value == wanted).or(offered.first()).copied().unwrap_or(wanted)
}

impl TryFrom<Written> for Upscaling {
    type Error = String;

    fn try_from(written: Written) -> Result<Self, String> {
        let Written { method, scale, anchor, light, deringing, sharpening } = written;
        let default = Self::new(&method, scale).ok_or_else(|| {
            let known: Vec<_> = ALL.iter().map(|u| format!("`{}`", u.id())).collect();
            format!("unknown upscaler `{method}`, expected one of {}", known.join(", "))
        })?;
        let (anchor, light) = (anchor.unwrap_or(default.anchor), light.unwrap_or(default.light));
        Ok(Self { anchor, light, deringing, sharpening, ..default }.offered())
    }
}

impl From<Upscaling> for Written {
    fn from(upscaling: Upscaling) -> Self {
        let Upscaling { scale, anchor, light, deringing, sharpening, .. } = upscaling;
        let (anchor, light) = (Some(anchor), Some(light));
        Self { method: upscaling.method().to_owned(), scale, anchor, light, deringing, sharpening }
    }
}
