//! Mip-mapping and anisotropic filtering: from the footprint of a pixel on a texture to the mip levels that are read, and
//! the positions at which they are read.
//!
//! The level of detail is λ = log₂ ρ + bias, where ρ is the longer side of the footprint in texels of the full-size
//! texture (Vulkan specification, "Level-of-Detail Operation"). λ is clamped to the existing levels. With bias 0, a
//! texel of level λ is as long as the longer side of the footprint, so no texel is missed.
//!
//! The anisotropic filter treats the footprint as an ellipse (Heckbert, "Fundamentals of Texture Mapping and Image
//! Warping", 1989), whose axes are the singular vectors of the Jacobian of the texture coordinates. It takes N probes,
//! evenly spaced along the major axis, where N is the ratio of the axes rounded up, and at most the chosen maximum
//! (`GL_EXT_texture_filter_anisotropic`). ρ is then the N-th part of the major axis. The specification approximates the
//! axes by ∂(u, v)/∂x and ∂(u, v)/∂y, which blurs surfaces that recede along a diagonal of the screen.

use glam::Vec2;

use super::settings::{Settings, TexelFilter};
use crate::math::log2::log2;

/// Smallest squared length of a footprint whose logarithm is computed, in texels². Shorter footprints read the
/// full-size texture at any bias that [`MIP_BIAS`](super::settings::MIP_BIAS) allows.
pub(crate) const LEAST_SQUARED_LENGTH: f32 = f32::MIN_POSITIVE;

/// Excess of the ratio of the axes over an integer that takes no additional probe. It absorbs the rounding errors of the
/// ratio, so that a round footprint takes a single probe.
pub(crate) const RATIO_TOLERANCE: f32 = 1.0 / 64.0;

/// Rule that selects the mip levels and the positions of probes for the footprint of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MipFilter {
    /// Number added to the level of detail: negative values read finer levels.
    pub(crate) bias: f32,
    /// Maximum number of probes; 1 for the trilinear filter.
    pub(crate) max_probes: u32,
}

/// Mip levels and positions at which a texture is read for a pixel. The colour is the mean over all probes of the
/// weighted mean over the levels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TextureReads {
    /// Mip levels, with weights that sum to 1. Only the first one is used without mip-mapping.
    pub(crate) levels: [(usize, f32); 2],
    /// Number of used entries of `levels`.
    pub(crate) level_count: usize,
    /// Number of probes, at least 1.
    pub(crate) probes: u32,
    /// Major axis of the footprint, in texture coordinates; zero for a single probe.
    pub(crate) major_axis: Vec2,
}

/// Read of one mip level at one position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TextureRead {
    /// Index of the probe.
    pub(crate) probe: u32,
    /// Texture coordinates of the probe.
    pub(crate) uv: Vec2,
    /// Mip level; 0 is the texture itself.
    pub(crate) level: usize,
    /// Weight of the level among the levels of the probe.
    pub(crate) share: f32,
}

/// Probes along the major axis of a footprint.
struct Probes {
    count: u32,
    /// Major axis as a combination of the gradients in x and in y.
    direction: Vec2,
    /// Squared length of the part of the major axis that a probe covers, in texels².
    squared_length: f32,
}

impl TextureReads {
    /// Read of the texture itself at the position of the fragment.
    pub(crate) const WITHOUT_MIP_LEVELS: Self =
        Self { levels: [(0, 1.0); 2], level_count: 1, probes: 1, major_axis: Vec2::ZERO };

    /// Returns the position of a probe on the major axis, relative to its length: 0 at the centre, in (−0.5, 0.5).
    pub(crate) fn offset(&self, probe: u32) -> f32 {
        (2 * probe + 1) as f32 / (2 * self.probes) as f32 - 0.5
    }

    /// Returns the texture coordinates of a probe of the fragment at `uv`.
    pub(crate) fn position(&self, uv: Vec2, probe: u32) -> Vec2 {
        if self.probes == 1 { uv } else { uv + self.major_axis * self.offset(probe) }
    }

    /// Returns all reads for the fragment at `uv`, probe by probe.
    pub(crate) fn all(self, uv: Vec2) -> impl Iterator<Item = TextureRead> {
        let levels = self.levels.into_iter().take(self.level_count);
        let of_probe = move |probe| {
            let uv = self.position(uv, probe);
            levels.clone().map(move |(level, share)| TextureRead { probe, uv, level, share })
        };
        (0..self.probes).flat_map(of_probe)
    }
}

impl MipFilter {
    /// Returns the rule that the settings choose; `None` if the texture filter reads no mip levels.
    pub(crate) fn new(settings: &Settings) -> Option<Self> {
        let is_anisotropic = settings.filter == TexelFilter::Anisotropic;
        let max_probes = if is_anisotropic { settings.max_anisotropy.samples() } else { 1 };
        settings.filter.reads_mip_levels().then_some(Self { bias: settings.mip_bias, max_probes })
    }

    /// Returns the mip levels and positions that are read for a pixel. `uv_gradient` holds the gradients of the texture
    /// coordinates: ∂(u, v)/∂x and ∂(u, v)/∂y, per pixel. Level 0 is the texture itself, level `copies` the smallest. The
    /// level of detail is a fractional number. The next finer and the next coarser level are read, as far as they exist.
    pub(crate) fn reads(self, size: (u32, u32), copies: usize, uv_gradient: [Vec2; 2]) -> TextureReads {
        let (width, height) = size;
        let [right, down] = uv_gradient.map(|change| change * Vec2::new(width as f32, height as f32));
        if let Some(Probes { count, direction, squared_length }) = self.probes(right, down) {
            return TextureReads {
                levels: self.levels_of(squared_length, copies),
                level_count: 2,
                probes: count,
                major_axis: uv_gradient[0] * direction.x + uv_gradient[1] * direction.y,
            };
        }
        let [right, down] = [right, down].map(Vec2::length_squared);
        TextureReads {
            levels: self.levels_of(if down > right { down } else { right }, copies),
            level_count: 2,
            ..TextureReads::WITHOUT_MIP_LEVELS
        }
    }

    /// Returns the probes for a footprint with these gradients, in texels per pixel; `None` if one probe is enough.
    fn probes(self, right: Vec2, down: Vec2) -> Option<Probes> {
        if self.max_probes == 1 {
            return None;
        }
        // The squared lengths of the axes are the eigenvalues of the symmetric matrix [[a, b], [b, c]].
        let (a, b, c) = (right.length_squared(), right.dot(down), down.length_squared());
        let half_difference = 0.5 * (a - c);
        let root = (half_difference * half_difference + b * b).sqrt();
        let major_squared = 0.5 * (a + c) + root;
        // The area of the parallelogram of the gradients is the product of both axes.
        let ratio = major_squared / right.perp_dot(down).abs();
        // Probes less than a texel apart would read the same texels.
        let texels = major_squared.sqrt().ceil();
        let wanted = (ratio - RATIO_TOLERANCE).ceil().min(texels).min(self.max_probes as f32);
        if !major_squared.is_finite() || ratio.is_nan() || wanted <= 1.0 {
            return None;
        }
        // Of both forms of the eigenvector, this one has no cancellation.
        let direction =
            if a >= c { Vec2::new(half_difference + root, b) } else { Vec2::new(b, root - half_difference) };
        Some(Probes {
            count: wanted as u32,
            direction: direction / direction.length(),
            squared_length: major_squared / (wanted * wanted),
        })
    }

    /// Returns the two mip levels, with their weights, for a footprint of the given squared length in texels².
    fn levels_of(self, squared_length: f32, copies: usize) -> [(usize, f32); 2] {
        // NaN is treated as the shortest footprint.
        let squared_length = if squared_length > LEAST_SQUARED_LENGTH { squared_length } else { LEAST_SQUARED_LENGTH };
        let level = 0.5 * log2(squared_length) + self.bias;
        let level = (if level > 0.0 { level } else { 0.0 }).min(copies as f32);
        let finer = level as usize;
        let share = level - finer as f32;
        [(finer, 1.0 - share), ((finer + 1).min(copies), share)]
    }
}

#[cfg(test)]
mod tests;
