//! Mip-mapping: from the footprint of a pixel on a texture to the mip levels that are read.
//!
//! The level of detail is λ = log₂ ρ + bias, where ρ is the longer side of the footprint in texels of the full-size
//! texture (Vulkan specification, "Level-of-Detail Operation"). λ is clamped to the existing levels. With bias 0, a
//! texel of level λ is as long as the longer side of the footprint, so no texel is missed.

use glam::Vec2;

use super::settings::Settings;
use crate::math::log2::log2;

/// Smallest squared length of a footprint whose logarithm is computed, in texels². Shorter footprints read the
/// full-size texture at any bias that [`MIP_BIAS`](super::settings::MIP_BIAS) allows.
pub(crate) const LEAST_SQUARED_LENGTH: f32 = f32::MIN_POSITIVE;

/// Rule that selects the mip levels for the footprint of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MipFilter {
    /// Number added to the level of detail: negative values read finer levels.
    pub(crate) bias: f32,
}

impl MipFilter {
    /// Returns the rule that the settings choose; `None` if the texture filter reads no mip levels.
    pub(crate) fn new(settings: &Settings) -> Option<Self> {
        settings.filter.reads_mip_levels().then_some(Self { bias: settings.mip_bias })
    }

    /// Returns the two mip levels that are read for a pixel, with their weights. `uv_gradient` holds the gradients of
    /// the texture coordinates: ∂(u, v)/∂x and ∂(u, v)/∂y, per pixel. Level 0 is the texture itself, level `copies`
    /// the smallest. The level of detail is a fractional number. The result is the next finer and the next coarser
    /// level, as far as they exist.
    pub(crate) fn levels(self, size: (u32, u32), copies: usize, uv_gradient: [Vec2; 2]) -> [(usize, f32); 2] {
        let [right, down] = in_texels(size, uv_gradient).map(Vec2::length_squared);
        self.levels_of(if down > right { down } else { right }, copies)
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

/// Converts gradients of texture coordinates to texels per pixel, for a texture of this size.
fn in_texels((width, height): (u32, u32), uv_gradient: [Vec2; 2]) -> [Vec2; 2] {
    uv_gradient.map(|change| change * Vec2::new(width as f32, height as f32))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the level of detail: the mean of the two levels, by their weights.
    fn level_of_detail(bias: f32, texels_per_px: f32) -> f32 {
        let gradient = [Vec2::new(texels_per_px / 64.0, 0.0), Vec2::new(0.0, 0.25 * texels_per_px / 64.0)];
        let [(fine, share), (coarse, rest)] = MipFilter { bias }.levels((64, 64), 6, gradient);
        assert_eq!(share + rest, 1.0);
        fine as f32 * share + coarse as f32 * rest
    }

    #[test]
    fn level_of_detail_is_the_logarithm_of_the_footprint_plus_the_bias_within_the_existing_levels() {
        for bias in [-4.0, -1.5, -1.0, 0.0, 0.25, 4.0] {
            for texels_per_px in [1e-30, 0.01, 0.5, 1.0, 1.3, 2.0, 7.0, 64.0, 1e30] {
                let expected = (f64::from(texels_per_px).log2() + f64::from(bias)).clamp(0.0, 6.0);
                let found = f64::from(level_of_detail(bias, texels_per_px));
                assert!((found - expected).abs() < 1e-5, "{bias} {texels_per_px}: {found} {expected}");
            }
        }
    }

    #[test]
    fn every_gradient_gives_existing_levels_with_finite_weights() {
        for length in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN_POSITIVE, 1e-40, -0.0] {
            for bias in [-4.0, 0.0, 4.0] {
                let gradient = [Vec2::splat(length), Vec2::new(length, 0.0)];
                let levels = MipFilter { bias }.levels((64, 64), 6, gradient);
                assert!(levels.iter().all(|(level, share)| *level <= 6 && (0.0..=1.0).contains(share)), "{levels:?}");
            }
        }
    }
}
