//! Texture sampling: from texture coordinates to texels and their weights.
//!
//! The addressing mode first maps a coordinate into [0, 1], so neither 10³⁰ nor infinity is converted to an integer;
//! NaN reads texel 0. The position among the texels is x = u·width − 0.5, so texel centres have integer positions.
//! Neighbours beyond the border are wrapped (repeat) or clamped (clamp, mirror). All of this is computed in f64,
//! because the fractional part of a coordinate and its position among the texels may need twice the precision of f32.
//! Rounding would be visible at texel borders.

use std::ops::{Add, Mul};

use glam::{Vec2, Vec3, Vec4};
use serde::Serialize;

use super::formulas::{bilinear_weights, weighted_sum};
use super::settings::{AddressMode, ColorSpace, TexelFilter};
use crate::image::color::Tables;
use crate::image::{Image, Rgba8};
use crate::math::floor;

/// Texel that a texture sample reads, with its weight.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct TexelTap {
    /// Column of the texel, from the left.
    pub x: u32,
    /// Row of the texel, from the top.
    pub y: u32,
    /// Weight of the texel; the weights of a sample sum to one.
    pub weight: f32,
}

/// Sampler: filter, addressing mode and colour space of texture reads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sampler {
    /// Texture filter, which selects and mixes texels.
    pub(crate) filter: TexelFilter,
    /// Addressing mode for texture coordinates outside of [0, 1].
    pub(crate) address: AddressMode,
    /// Lookup table from 8-bit codes to the values that the sampler mixes: linear light, or the codes themselves.
    number_of_code: &'static [f32; 256],
    /// Factor that maps mixed values into [0, 1].
    pub(crate) scale: f32,
}

impl Sampler {
    /// Returns a sampler that mixes texels in `color_space`.
    pub(crate) fn new(filter: TexelFilter, address: AddressMode, color_space: ColorSpace) -> Self {
        let tables = Tables::get();
        // Codes are mixed first and divided by 255 afterwards. Dividing every code before mixing would round each of
        // them.
        let (number_of_code, scale) = match color_space {
            ColorSpace::Linear => (&tables.linear_of_code.values, 1.0),
            ColorSpace::Bytes => (&tables.code.values, 1.0 / 255.0),
        };
        Self { filter, address, number_of_code, scale }
    }

    /// Returns the filtered colour at `uv` (v down), in [0, 1]: linear light or sRGB values, depending on the sampler's
    /// colour space.
    #[inline]
    pub(crate) fn sample(self, texture: &Image<Rgba8>, uv: Vec2) -> Vec3 {
        // The fourth component is unused: vectors of four components are mixed in a single register.
        self.mixed(texture, uv, |texel| self.number_of(texel).extend(0.0)).truncate() * self.scale
    }

    /// Returns the colour at `uv`, as [`Sampler::sample`] does, and the alpha from the same texels and weights, both in
    /// [0, 1]. The colour is straight: not multiplied by alpha.
    #[inline]
    pub(crate) fn sample_with_alpha(self, texture: &Image<Rgba8>, uv: Vec2) -> (Vec3, f32) {
        let mixed = self.mixed(texture, uv, |texel| self.number_of(texel).extend(alpha_of(texel)));
        (mixed.truncate() * self.scale, mixed.w * ALPHA_SCALE)
    }

    /// Returns the filtered alpha at `uv`, in [0, 1]: the same value as from [`Sampler::sample_with_alpha`].
    #[inline]
    pub(crate) fn alpha(self, texture: &Image<Rgba8>, uv: Vec2) -> f32 {
        self.mixed(texture, uv, alpha_of) * ALPHA_SCALE
    }

    /// Returns the filtered product of colour and alpha (xyz), and the filtered alpha (w), at `uv`. Both are unscaled:
    /// alpha is a code from 0 to 255, and colour consists of the values that the sampler mixes. Their quotient is a
    /// colour to which texels with alpha 0 do not contribute.
    #[inline]
    pub(crate) fn sample_premultiplied(self, texture: &Image<Rgba8>, uv: Vec2) -> Vec4 {
        self.mixed(texture, uv, |texel| {
            let alpha = alpha_of(texel);
            (self.number_of(texel) * alpha).extend(alpha)
        })
    }

    /// Returns the weighted mean of `value` over the texels that are read at `uv`.
    #[inline(always)] // One of several callers is the loop over opaque samples, where the cost of a call is measurable.
    fn mixed<T: Mul<f32, Output = T> + Add<Output = T>>(
        self,
        texture: &Image<Rgba8>,
        uv: Vec2,
        value: impl Fn(Rgba8) -> T,
    ) -> T {
        let (taps, _) = self.taps(texture.size(), uv);
        let value = |tap: &TexelTap| value(texture.at(tap.x, tap.y));
        match self.filter {
            TexelFilter::Point => value(&taps[0]) * taps[0].weight,
            TexelFilter::Bilinear | TexelFilter::Trilinear | TexelFilter::Anisotropic => {
                // Not by `map`, whose calls the compiler may leave standing.
                let [a, b, c, d] = &taps;
                let values = [value(a), value(b), value(c), value(d)];
                weighted_sum(values, [a.weight, b.weight, c.weight, d.weight])
            }
        }
    }

    /// Returns the texels that [`Sampler::sample`] reads at `uv` in a texture of this size. Also returns how many
    /// entries of the array are used.
    #[inline(always)] // One of several callers is the loop over opaque samples, where the cost of a call is measurable.
    pub(crate) fn taps(self, (width, height): (u32, u32), uv: Vec2) -> ([TexelTap; 4], usize) {
        let [u, v] = self.unit(uv);
        let mut taps = [TexelTap::default(); 4];
        match self.filter {
            TexelFilter::Point => {
                let (x, y) = (nearest(u, width), nearest(v, height));
                taps[0] = TexelTap { x, y, weight: 1.0 };
                (taps, 1)
            }
            TexelFilter::Bilinear | TexelFilter::Trilinear | TexelFilter::Anisotropic => {
                let ((x0, x1), tx) = neighbours(u, width, self.address);
                let ((y0, y1), ty) = neighbours(v, height, self.address);
                let [a, b, c, d] = bilinear_weights(1.0, [tx, ty]);
                let tap = |x, y, weight| TexelTap { x, y, weight };
                ([tap(x0, y0, a), tap(x1, y0, b), tap(x0, y1, c), tap(x1, y1, d)], 4)
            }
        }
    }

    /// Maps texture coordinates into [0, 1] by the sampler's addressing mode.
    #[inline(always)]
    pub(crate) fn unit(self, uv: Vec2) -> [f64; 2] {
        [apply_address_mode(uv.x, self.address), apply_address_mode(uv.y, self.address)]
    }

    /// Returns the bilinear weight of the second of the two texels around a coordinate, along an axis of `size` texels.
    /// `unit` is a coordinate from [`Sampler::unit`].
    pub(crate) fn share_of_next(self, unit: f64, size: u32) -> f32 {
        neighbours(unit, size, self.address).1
    }

    /// Converts a colour of sRGB codes to the sampler's colour space, in [0, 1]: linear light or sRGB values.
    #[inline]
    pub(crate) fn value_of(self, color: Rgba8) -> Vec3 {
        self.number_of(color) * self.scale
    }

    /// Converts a colour of sRGB codes to the unscaled values that the sampler mixes: linear light, or codes from 0 to
    /// 255.
    #[inline]
    pub(crate) fn number_of(self, [r, g, b, _]: Rgba8) -> Vec3 {
        let number = |code: u8| self.number_of_code[code as usize];
        Vec3::new(number(r), number(g), number(b))
    }
}

/// Factor that maps filtered alpha codes, 0 to 255, into [0, 1].
pub(crate) const ALPHA_SCALE: f32 = 1.0 / 255.0;

/// Returns the alpha of a texel as a code from 0 to 255. Alpha is not light, so it is never decoded.
#[inline]
fn alpha_of([_, _, _, code]: Rgba8) -> f32 {
    f32::from(code)
}

/// Maps a texture coordinate into [0, 1] by an addressing mode.
#[inline]
fn apply_address_mode(u: f32, address: AddressMode) -> f64 {
    let unit = match address {
        AddressMode::Clamp => f64::from(u.clamp(0.0, 1.0)),
        AddressMode::Repeat => f64::from(u) - f64::from(floor(u)),
        AddressMode::Mirror => {
            let period = f64::from(u) - 2.0 * f64::from(floor(u * 0.5));
            if period > 1.0 { 2.0 - period } else { period }
        }
    };
    // Both infinity minus infinity and a NaN coordinate give NaN.
    if unit.is_nan() { 0.0 } else { unit }
}

#[inline]
fn nearest(unit: f64, size: u32) -> u32 {
    ((unit * f64::from(size)) as u32).min(size - 1)
}

/// Returns the two texels around a coordinate in [0, 1], and the weight of the second one.
#[inline]
fn neighbours(unit: f64, size: u32, address: AddressMode) -> ((u32, u32), f32) {
    let position = unit * f64::from(size) - 0.5;
    let truncated = position as i32;
    let below = truncated - i32::from(f64::from(truncated) > position);
    let weight = (position - f64::from(below)) as f32;
    let last = size as i32 - 1;
    let (i0, i1) = (below, below + 1);
    let bring_inside = |i: i32| match address {
        AddressMode::Repeat if i < 0 => last,
        AddressMode::Repeat if i > last => 0,
        _ => i.clamp(0, last),
    };
    ((bring_inside(i0) as u32, bring_inside(i1) as u32), weight)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::settings::Choice as _;

    fn ramp() -> Image<Rgba8> {
        Image::from_fn(4, 1, |x, _| [x as u8 * 80, 0, 0, 255])
    }

    fn red(filter: TexelFilter, address: AddressMode, u: f32) -> f32 {
        Sampler::new(filter, address, ColorSpace::Bytes).sample(&ramp(), Vec2::new(u, 0.5)).x * 255.0
    }

    #[test]
    fn texel_centres_read_the_texel_itself() {
        for filter in TexelFilter::ALL {
            for address in AddressMode::ALL {
                for texel in 0..4 {
                    let read = red(*filter, *address, (texel as f32 + 0.5) / 4.0);
                    assert!((read - texel as f32 * 80.0).abs() < 1e-3, "{filter:?} {address:?} {texel}: {read}");
                }
            }
        }
    }

    #[test]
    fn halfway_between_centres_is_the_mean() {
        assert!((red(TexelFilter::Bilinear, AddressMode::Clamp, 0.25) - 40.0).abs() < 1e-3);
        assert!(
            (red(TexelFilter::Bilinear, AddressMode::Repeat, 0.0) - 120.0).abs() < 1e-3,
            "first and last texel meet"
        );
        assert!((red(TexelFilter::Bilinear, AddressMode::Mirror, 0.0) - 0.0).abs() < 1e-3, "the border meets itself");
    }

    #[test]
    fn addressing_outside() {
        assert_eq!(red(TexelFilter::Point, AddressMode::Clamp, 7.0).round(), 240.0);
        assert_eq!(red(TexelFilter::Point, AddressMode::Repeat, -0.1).round(), 240.0);
        assert_eq!(red(TexelFilter::Point, AddressMode::Mirror, -0.1).round(), 0.0);
        assert_eq!(red(TexelFilter::Point, AddressMode::Mirror, 1.1).round(), 240.0);
    }

    #[test]
    fn a_coordinate_just_before_a_border_reads_the_texel_before_it() {
        // The f32 −0.2 is slightly less than −1/5, so it lies in the fourth of five repeated texels. If 1 − 0.2 were
        // computed in f32, it would round to 0.8, which lies in the fifth texel.
        let texture = Image::from_fn(5, 1, |x, _| [x as u8; 4]);
        let read = |u: f32| {
            let ([tap, ..], _) = Sampler::new(TexelFilter::Point, AddressMode::Repeat, ColorSpace::Bytes)
                .taps(texture.size(), Vec2::new(u, 0.5));
            tap.x
        };
        assert!(f64::from(-0.2_f32) < -0.2);
        assert_eq!([-0.2, 0.8, (-0.2_f32).next_up()].map(read), [3, 4, 4]);
        assert_eq!([-1e-30, 0.0, -3.0, 1e30].map(read), [4, 0, 0, 0]);
    }

    #[test]
    fn alpha_is_mixed_like_colour_and_does_not_change_it() {
        let mut rng = fastrand::Rng::with_seed(5);
        // Alpha equals the red code, so both results must agree where codes are mixed directly.
        let texture = Image::from_fn(5, 7, |_, _| {
            let code = rng.u8(..);
            [code, rng.u8(..), rng.u8(..), code]
        });
        for _ in 0..1000 {
            let uv = Vec2::new(rng.f32() * 4.0 - 2.0, rng.f32() * 4.0 - 2.0);
            for (filter, address) in
                TexelFilter::ALL.iter().flat_map(|f| AddressMode::ALL.iter().map(move |a| (*f, *a)))
            {
                for space in ColorSpace::ALL {
                    let sampler = Sampler::new(filter, address, *space);
                    let (color, alpha) = sampler.sample_with_alpha(&texture, uv);
                    assert_eq!(color, sampler.sample(&texture, uv));
                    assert_eq!(alpha, sampler.alpha(&texture, uv));
                    assert_eq!(alpha, Sampler::new(filter, address, ColorSpace::Bytes).sample(&texture, uv).x);
                }
            }
        }
    }

    #[test]
    fn every_coordinate_gives_a_finite_colour() {
        for u in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30, -1e30, f32::MIN_POSITIVE, -1e-30] {
            for filter in TexelFilter::ALL {
                for address in AddressMode::ALL {
                    assert!(red(*filter, *address, u).is_finite(), "{u} {filter:?} {address:?}");
                }
            }
        }
    }
}
