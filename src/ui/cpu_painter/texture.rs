//! Textures of the CPU painter, with nearest and bilinear sampling.

use eframe::egui::{Color32, ImageData, TextureFilter, TextureOptions, TextureWrapMode, epaint::ImageDelta};
use glam::{Vec2, Vec4, vec4};

/// Texture of premultiplied, gamma-encoded texels, row by row from the top. An empty texture reads as transparent
/// black.
#[derive(Default)]
pub(super) struct UiTexture {
    size: [usize; 2],
    texels: Vec<Color32>,
    options: TextureOptions,
}

impl UiTexture {
    /// Replaces the texture or a part of it. A part that is too wide for the texture is ignored, and rows below the
    /// texture are dropped.
    pub(super) fn apply(&mut self, change: ImageDelta) {
        let ImageData::Color(image) = change.image;
        self.options = change.options;
        let Some([x, y]) = change.pos else {
            self.size = image.size;
            self.texels.clear();
            self.texels.extend_from_slice(&image.pixels);
            return;
        };
        let [width, rows] = image.size;
        if width == 0 || x + width > self.size[0] {
            return;
        }
        let targets = self.texels.chunks_exact_mut(self.size[0]).skip(y).take(rows);
        for (target, source) in targets.zip(image.pixels.chunks_exact(width)) {
            target[x..x + width].copy_from_slice(source);
        }
    }

    /// Returns width and height in texels.
    pub(super) fn size(&self) -> [f32; 2] {
        self.size.map(|texels| texels as f32)
    }

    /// Returns the filter for a triangle on which one pixel covers an area of `texels_per_pixel` texels: the
    /// minification filter above 1, the magnification filter otherwise.
    pub(super) fn filter(&self, texels_per_pixel: f64) -> TextureFilter {
        if texels_per_pixel > 1.0 { self.options.minification } else { self.options.magnification }
    }

    /// Returns the texel that contains (u, v), both in texels. Channels are in [0, 255].
    #[inline(always)]
    pub(super) fn nearest(&self, uv: Vec2) -> Vec4 {
        self.texel(floor(uv.x), floor(uv.y))
    }

    /// Returns the bilinear interpolation of the four texels around (u, v), both in texels. Texel centres lie at
    /// half-integers; channels are in [0, 255].
    #[inline(always)]
    pub(super) fn bilinear(&self, uv: Vec2) -> Vec4 {
        let (u, v) = (uv.x - 0.5, uv.y - 0.5);
        let (x, y) = (floor(u), floor(v));
        let (right, down) = (u - x as f32, v - y as f32);
        let upper = mix(self.texel(x, y), self.texel(x + 1, y), right);
        let lower = mix(self.texel(x, y + 1), self.texel(x + 1, y + 1), right);
        mix(upper, lower, down)
    }

    #[inline(always)]
    fn texel(&self, x: i64, y: i64) -> Vec4 {
        let column = wrap(x, self.size[0], self.options.wrap_mode);
        let row = wrap(y, self.size[1], self.options.wrap_mode);
        self.texels.get(row * self.size[0] + column).map_or(Vec4::ZERO, |texel| channels(texel.to_array()))
    }
}

/// Converts four bytes to floats in [0, 255].
#[inline(always)]
pub(super) fn channels([red, green, blue, alpha]: [u8; 4]) -> Vec4 {
    vec4(f32::from(red), f32::from(green), f32::from(blue), f32::from(alpha))
}

/// Returns the largest integer not above `value`. Avoids the library call that `f32::floor` needs on older processors.
#[inline(always)]
fn floor(value: f32) -> i64 {
    let truncated = value as i64;
    truncated - i64::from(value < truncated as f32)
}

/// Maps a texel index to [0, `length`) according to the wrap mode.
#[inline(always)]
fn wrap(index: i64, length: usize, mode: TextureWrapMode) -> usize {
    let last = (length as i64 - 1).max(0);
    let wrapped = match mode {
        TextureWrapMode::ClampToEdge => index.clamp(0, last),
        TextureWrapMode::Repeat => index.rem_euclid(last + 1),
        TextureWrapMode::MirroredRepeat => {
            let position = index.rem_euclid(2 * (last + 1));
            position.min(2 * last + 1 - position)
        }
    };
    wrapped as usize
}

#[inline(always)]
fn mix(from: Vec4, to: Vec4, weight: f32) -> Vec4 {
    from + (to - from) * weight
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_wrap_mode_maps_indices_as_its_name_says() {
        let fold = |mode| (-4..8).map(|index| wrap(index, 3, mode)).collect::<Vec<_>>();
        assert_eq!(fold(TextureWrapMode::ClampToEdge), [0, 0, 0, 0, 0, 1, 2, 2, 2, 2, 2, 2]);
        assert_eq!(fold(TextureWrapMode::Repeat), [2, 0, 1, 2, 0, 1, 2, 0, 1, 2, 0, 1]);
        assert_eq!(fold(TextureWrapMode::MirroredRepeat), [2, 2, 1, 0, 0, 1, 2, 2, 1, 0, 0, 1]);
    }

    #[test]
    fn floor_rounds_down_on_both_sides_of_zero() {
        assert_eq!([-1.5, -1.0, -0.25, 0.0, 0.75, 3.0].map(floor), [-2, -1, -1, 0, 0, 3]);
    }

    #[test]
    fn an_empty_texture_reads_as_transparent() {
        assert_eq!(UiTexture::default().bilinear(Vec2::new(0.3, 0.7)), Vec4::ZERO);
    }
}
