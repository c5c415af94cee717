//! Choice of an upscaler and its options: part of a recipe.

use serde::{Deserialize, Serialize};

use super::{Anchor, HistoryOptions, Lattice, Sampling, Scale, UpscaleInputs, Upscaler, all, registry};
use crate::image::{Image, Rgba8};
use crate::pipeline::grid::SampleGrid;
use crate::pipeline::settings::{Choice, choice};

choice! {
    /// Colour space in which an upscaler filters.
    #[derive(PartialOrd, Ord)]
    pub FilterSpace {
        Bytes = "bytes", "sRGB", "Filters sRGB codes, as most programs do: steps that look equal count as equal.";
        Linear = "linear", "Linear",
            "Filters linear light: physically correct averages, but dark edges ring more. Slower: each sample is \
             decoded and each pixel encoded.";
    }
}

/// Maximum of [`Upscaling::sharpening`], in percent.
pub(crate) const MAX_SHARPENING: u32 = 100;

/// Upscaler with its scale and options. It is always valid: options that the upscaler does not offer are replaced by
/// offered ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "Written", into = "Written")]
pub struct Upscaling {
    /// Index of the upscaler in the registry, [`all`].
    method: usize,
    scale: Scale,
    anchor: Anchor,
    light: FilterSpace,
    deringing: bool,
    sharpening: u32,
    history: HistoryOptions,
}

/// Serialised form of [`Upscaling`].
#[derive(Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    method: String,
    scale: Scale,
    /// Sample position within its block; the upscaler's default if absent.
    #[serde(default)]
    anchor: Option<Anchor>,
    /// Filtering colour space; the upscaler's default if absent.
    #[serde(default)]
    light: Option<FilterSpace>,
    #[serde(default)]
    deringing: bool,
    #[serde(default)]
    sharpening: u32,
    #[serde(default)]
    history: HistoryOptions,
}

impl Upscaling {
    /// Native rendering: the first entry of the registry.
    pub const NATIVE: Self = Self {
        method: 0,
        scale: Scale::ONE,
        anchor: Anchor::Corner,
        light: FilterSpace::Bytes,
        deringing: false,
        sharpening: 0,
        history: HistoryOptions::DEFAULT,
    };

    /// Creates the upscaler with this id at the nearest scale that it offers, with its default options. Returns `None`
    /// for an unknown id.
    ///
    /// # Examples
    /// ```
    /// use rasterscope_engine::upscale::{Scale, Upscaling};
    ///
    /// let upscaling = Upscaling::new("bilinear", 2).unwrap();
    /// assert_eq!((upscaling.method(), upscaling.scale()), ("bilinear", Scale::TWO));
    ///
    /// // Native rendering offers only ×1, and there is no upscaler “dlss”.
    /// assert_eq!(Upscaling::new("native", 4).unwrap().scale(), Scale::ONE);
    /// assert_eq!(Upscaling::new("dlss", 2), None);
    /// ```
    pub fn new(method: &str, scale: impl Into<Scale>) -> Option<Self> {
        let method = registry::index_of(method)?;
        let offers = registry::at(method).offers();
        let (anchor, light) = (*offers.anchors.first()?, *offers.lights.first()?);
        Some(Self { method, scale: scale.into(), anchor, light, ..Self::NATIVE }.offered())
    }

    /// Replaces every option that the upscaler does not offer by an offered one.
    fn offered(mut self) -> Self {
        let offers = self.upscaler().offers();
        let nearest = offers.scales.iter().min_by_key(|scale| scale.distance(self.scale));
        self.scale = nearest.copied().unwrap_or(Scale::ONE);
        self.anchor = kept_or_first(offers.anchors, self.anchor);
        self.light = kept_or_first(offers.lights, self.light);
        self.deringing &= offers.deringing;
        self.sharpening = if offers.sharpening { self.sharpening.min(MAX_SHARPENING) } else { 0 };
        self.history = if offers.history { self.history } else { HistoryOptions::DEFAULT };
        self
    }

    /// Returns every upscaler at every scale it offers, with its default options.
    pub fn every() -> impl Iterator<Item = Self> {
        let choices = |u: &'static dyn Upscaler| u.offers().scales.iter().filter_map(|scale| Self::new(u.id(), *scale));
        all().into_iter().flat_map(choices)
    }

    /// Returns the upscaler with this id and its default options, at the offered scale nearest to the current one, or at
    /// its default scale if every pixel is drawn now. Returns `None` for an unknown id. If the id is that of the current
    /// upscaler, returns `self` unchanged.
    pub fn with_method(self, method: &str) -> Option<Self> {
        if self.method() == method {
            return Some(self);
        }
        let scale =
            if self.is_native() { registry::at(registry::index_of(method)?).default_scale() } else { self.scale };
        Self::new(method, scale)
    }

    /// Returns a copy with another scale per axis, or the offered scale nearest to it.
    pub fn with_scale(self, scale: impl Into<Scale>) -> Self {
        Self { scale: scale.into(), ..self }.offered()
    }

    /// Returns a copy with another anchor, or with the default one if the upscaler does not offer it.
    pub fn with_anchor(self, anchor: Anchor) -> Self {
        Self { anchor, ..self }.offered()
    }

    /// Returns a copy with another filtering colour space, or with the default one if the upscaler does not offer it.
    pub fn with_light(self, light: FilterSpace) -> Self {
        Self { light, ..self }.offered()
    }

    /// Returns a copy with de-ringing on or off; it stays off if the upscaler does not support it.
    pub fn with_deringing(self, deringing: bool) -> Self {
        Self { deringing, ..self }.offered()
    }

    /// Returns a copy with the sharpening set to `sharpening` percent, clamped to 100; 0 if the upscaler does not
    /// support sharpening.
    pub fn with_sharpening(self, sharpening: u32) -> Self {
        Self { sharpening, ..self }.offered()
    }

    /// Returns a copy with other history options, or with the default ones if the upscaler does not offer them.
    pub fn with_history(self, history: HistoryOptions) -> Self {
        Self { history, ..self }.offered()
    }

    /// Whether this is native rendering, with every pixel drawn.
    pub fn is_native(self) -> bool {
        self.method == Self::NATIVE.method
    }

    /// Returns the selected upscaler, an entry of the registry.
    pub fn upscaler(self) -> &'static dyn Upscaler {
        registry::at(self.method)
    }

    /// Returns the index of the selected upscaler in the registry, [`all`]; 0 is native rendering.
    pub fn place(self) -> usize {
        self.method
    }

    /// Returns the id of the selected upscaler, in kebab case.
    pub fn method(self) -> &'static str {
        self.upscaler().id()
    }

    /// Returns the upscaling factor per axis.
    pub fn scale(self) -> Scale {
        self.scale
    }

    /// Returns the position of a sample within its block.
    pub fn anchor(self) -> Anchor {
        self.anchor
    }

    /// Returns the position of a sample within its block. Returns `None` at ×1, where a block is a single pixel and all
    /// anchors are equivalent.
    pub fn block_anchor(self) -> Option<Anchor> {
        (self.scale != Scale::ONE).then_some(self.anchor)
    }

    /// Returns the colour space in which the upscaler filters.
    pub fn light(self) -> FilterSpace {
        self.light
    }

    /// Whether de-ringing is on: each pass clamps its result to the range of the two adjacent samples.
    pub fn deringing(self) -> bool {
        self.deringing
    }

    /// Returns the sharpening strength, in percent of the maximum. Even at the maximum, every channel stays in range.
    pub fn sharpening(self) -> u32 {
        self.sharpening
    }

    /// Returns the options of blending with the history.
    pub fn history(self) -> HistoryOptions {
        self.history
    }

    /// Returns the lattice of sample positions, for upscalers with evenly spaced samples.
    pub fn lattice(self) -> Lattice {
        Lattice { scale: self.scale, anchor: self.anchor }
    }

    /// Returns the samples to draw. For upscalers with history, these are the samples of the first frame.
    pub fn sampling(self) -> Sampling {
        self.upscaler().sampling(self)
    }

    /// Returns the grid of samples to draw, in pixels of the rasterized image.
    pub(crate) fn grid(self) -> SampleGrid {
        self.sampling().grid()
    }

    /// Upscales drawn samples to an image of `width` × `height` px.
    ///
    /// # Examples
    /// ```
    /// use rasterscope_engine::image::Image;
    /// use rasterscope_engine::upscale::{UpscaleInputs, Upscaling};
    ///
    /// let upscaling = Upscaling::new("nearest", 2).unwrap();
    /// let drawn = Image::from_fn(32, 18, |x, y| [x as u8, y as u8, 0, 255]);
    /// let full = upscaling.upscale(&UpscaleInputs::from(&drawn), 64, 36);
    /// assert_eq!(full.size(), (64, 36));
    /// assert_eq!(full.at(11, 7), drawn.at(5, 3));
    /// ```
    pub fn upscale(self, drawn: &UpscaleInputs<'_>, width: u32, height: u32) -> Image<Rgba8> {
        let mut full = Image::filled(width, height, [0; 4]);
        self.upscaler().upscale(self, drawn, &mut full);
        full
    }

    /// Returns the display name with the scale and all non-default options, such as "Bicubic ×4" or "Lanczos 3 ×1.5,
    /// centre, linear".
    pub fn label(self) -> String {
        let default_anchor = self.upscaler().offers().anchors.first();
        self.label_with(Some(self.anchor).filter(|anchor| default_anchor != Some(anchor)))
    }

    /// Returns the display name with the anchor even if it is the default, such as "FSR 1 ×2, centre"; otherwise like
    /// [`Upscaling::label`].
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
        let HistoryOptions { rectification, filter, luminance_weighting } = self.history;
        if rectification != HistoryOptions::DEFAULT.rectification {
            label += &format!(", rectification {}", rectification.id());
        }
        if filter != HistoryOptions::DEFAULT.filter {
            label += &format!(", {} history", filter.id());
        }
        if luminance_weighting {
            label += ", luminance-weighted";
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
        let Written { method, scale, anchor, light, deringing, sharpening, history } = written;
        let default = Self::new(&method, scale).ok_or_else(|| {
            let known: Vec<_> = all().iter().map(|u| format!("`{}`", u.id())).collect();
            format!("unknown upscaler `{method}`, expected one of {}", known.join(", "))
        })?;
        let (anchor, light) = (anchor.unwrap_or(default.anchor), light.unwrap_or(default.light));
        Ok(Self { anchor, light, deringing, sharpening, history, ..default }.offered())
    }
}

impl From<Upscaling> for Written {
    fn from(upscaling: Upscaling) -> Self {
        let Upscaling { scale, anchor, light, deringing, sharpening, history, .. } = upscaling;
        let (anchor, light) = (Some(anchor), Some(light));
        Self { method: upscaling.method().to_owned(), scale, anchor, light, deringing, sharpening, history }
    }
}
