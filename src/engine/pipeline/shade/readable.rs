//! Textures as the settings read them: with their colour space, addressing, filter and treatment of alpha.

use std::ops::{Add, Div, Mul};

use glam::{Vec2, Vec3};

use crate::image::{Image, Rgba8};
use crate::pipeline::footprint::{MipFilter, TextureReads};
use crate::pipeline::interpolate::Fragment;
use crate::pipeline::sample::Sampler;
use crate::pipeline::settings::{AlphaMode, ColorSpace, Settings, TexelFilter};
use crate::scene::{Alpha, Texture};

/// Texture with the mip levels that its filter reads.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Readable<'a> {
    image: &'a Image<Rgba8>,
    /// Mip levels from level 1 on, each half as wide and high as the one before; empty unless the filter reads them.
    mip_levels: &'a [Image<Rgba8>],
    /// Rule that selects mip levels; `None` if the filter reads only the texture itself.
    mip_filter: Option<MipFilter>,
    /// Whether colours are weighted by alpha when texels are mixed.
    premultiplied: bool,
}

impl<'a> Readable<'a> {
    pub(super) fn new(texture: &'a Texture, settings: &Settings) -> Self {
        Self {
            // Weighting by alpha is not needed if the filter reads a single texel, which keeps its colour whatever its
            // alpha. Nor is it needed for opaque textures, whose texels all have the same alpha.
            premultiplied: settings.alpha == AlphaMode::Premultiplied
                && settings.filter != TexelFilter::Point
                && texture.alpha() != Alpha::Opaque,
            ..Self::straight(texture, settings, settings.color_space)
        }
    }

    /// Creates a texture whose texels are mixed in the colour space `space` with straight alpha: alpha does not weight
    /// the colours.
    pub(super) fn straight(texture: &'a Texture, settings: &Settings, space: ColorSpace) -> Self {
        let mip_filter = MipFilter::new(settings);
        let mip_levels = mip_filter.map_or(&[][..], |_| texture.mip_levels(space == ColorSpace::Linear));
        Self { image: texture.image(), mip_levels, mip_filter, premultiplied: false }
    }

    /// Returns whether colours are weighted by alpha when texels are mixed.
    pub(crate) fn is_premultiplied(&self) -> bool {
        self.premultiplied
    }

    /// Returns the filtered colour at a fragment, in [0, 1]. Each texel contributes in proportion to its alpha; the
    /// result is black if all texels have alpha 0.
    #[cold]
    fn premultiplied_color(&self, sampler: Sampler, fragment: &Fragment) -> Vec3 {
        let mixed = if self.mip_filter.is_some() {
            self.mixed(fragment, |image, uv| sampler.sample_premultiplied(image, uv))
        } else {
            sampler.sample_premultiplied(self.image, fragment.uv)
        };
        if mixed.w > 0.0 { mixed.truncate() / mixed.w * sampler.scale } else { Vec3::ZERO }
    }

    /// Returns the image of a mip level; level 0 is the texture itself.
    pub(crate) fn level(&self, level: usize) -> &'a Image<Rgba8> {
        level.checked_sub(1).and_then(|level| self.mip_levels.get(level)).unwrap_or(self.image)
    }

    /// Returns the mip levels and the positions at which they are read for a fragment.
    pub(crate) fn reads(&self, fragment: &Fragment) -> TextureReads {
        match self.mip_filter {
            Some(filter) => filter.reads(self.image.size(), self.mip_levels.len(), fragment.uv_gradient),
            None => TextureReads::WITHOUT_MIP_LEVELS,
        }
    }

    /// Returns the weighted mean of `read` over the mip levels and positions that are read for a fragment.
    #[cold]
    fn mixed<T: Mul<f32, Output = T> + Div<f32, Output = T> + Add<Output = T>>(
        &self,
        fragment: &Fragment,
        read: impl Fn(&Image<Rgba8>, Vec2) -> T,
    ) -> T {
        let reads = self.reads(fragment);
        let [(fine, share), (coarse, rest)] = reads.levels;
        let probe = |number: u32| {
            let uv = reads.position(fragment.uv, number);
            read(self.level(fine), uv) * share + read(self.level(coarse), uv) * rest
        };
        let first = probe(0);
        match reads.probes {
            1 => first,
            probes => (1..probes).fold(first, |sum, number| sum + probe(number)) / probes as f32,
        }
    }

    #[inline(always)] // One of several callers is the loop over opaque samples, where the cost of a call is measurable.
    pub(super) fn color(&self, sampler: Sampler, fragment: &Fragment) -> Vec3 {
        if self.premultiplied {
            return self.premultiplied_color(sampler, fragment);
        }
        if self.mip_filter.is_some() {
            return self.mixed(fragment, |image, uv| sampler.sample(image, uv));
        }
        sampler.sample(self.image, fragment.uv)
    }

    #[inline(always)]
    pub(super) fn alpha(&self, sampler: Sampler, fragment: &Fragment) -> f32 {
        if self.mip_filter.is_some() {
            return self.mixed(fragment, |image, uv| sampler.alpha(image, uv));
        }
        sampler.alpha(self.image, fragment.uv)
    }

    #[inline(always)]
    pub(super) fn color_and_alpha(&self, sampler: Sampler, fragment: &Fragment) -> (Vec3, f32) {
        if self.mip_filter.is_some() || self.premultiplied {
            return (self.color(sampler, fragment), self.alpha(sampler, fragment));
        }
        sampler.sample_with_alpha(self.image, fragment.uv)
    }
}
