//! YCoCg: the colour space in which temporal upscalers compare colours, because chroma and luminance are separate in it.

use super::planes::Planes;
use super::quads::Quad;
use super::{BlendSpace, FilterSpace};
use crate::image::Rgba8;
use crate::image::color::{CodeValues, Tables};
use crate::math::lanes::*;

/// Conversion between sRGB codes and YCoCg of linear light, in [0, 1], or of sRGB codes, in [0, 255].
#[derive(Clone, Copy)]
pub(super) struct YCoCg {
    pub(super) light: FilterSpace,
    tables: &'static Tables,
}

impl YCoCg {
    pub(super) fn new(light: FilterSpace) -> Self {
        Self { light, tables: Tables::get() }
    }

    /// Returns the luminance of white.
    pub(super) fn white(self) -> f32 {
        if self.light == FilterSpace::Bytes { 255.0 } else { 1.0 }
    }

    /// Converts the codes of a sample. The fourth number is alpha as an 8-bit value.
    #[inline(always)]
    pub(super) fn decoded(self, [r, g, b, a]: Rgba8) -> Quad {
        let [r, g, b] = [r, g, b].map(|code| self.values_of_codes().values[usize::from(code)]);
        [0.25 * r + 0.5 * g + 0.25 * b, 0.5 * r - 0.5 * b, 0.5 * g - 0.25 * r - 0.25 * b, f32::from(a)]
    }

    /// Returns the values of the sRGB codes in the working space.
    fn values_of_codes(self) -> &'static CodeValues {
        match self.light {
            FilterSpace::Linear => &self.tables.linear_of_code,
            FilterSpace::Bytes => &self.tables.code,
        }
    }

    /// Converts the codes of adjacent samples, with the results of [`Self::decoded`], and stores them from an index on.
    #[inline(always)]
    pub(super) fn decode_row<S: Simd>(self, simd: S, codes: &[Rgba8], planes: &mut Planes, from: usize) {
        let (runs, rest) = codes.as_chunks::<WIDE>();
        for (codes, at) in runs.iter().zip((from..).step_by(WIDE)) {
            let words = u8x64::from_slice(simd, codes.as_flattened()).bitcast::<u32x16<S>>();
            let [r, g, b] = self.values_of_codes().of_pixels(simd, words);
            let y = r * 0.25 + g * 0.5 + b * 0.25;
            let colors = [y, r * 0.5 - b * 0.5, g * 0.5 - r * 0.25 - b * 0.25, float_of(words >> 24)];
            for (plane, numbers) in planes.iter_mut().zip(colors) {
                numbers.store_slice(&mut plane[at..at + WIDE]);
            }
        }
        for (codes, at) in rest.iter().zip(from + runs.len() * WIDE..) {
            for (plane, number) in planes.iter_mut().zip(self.decoded(*codes)) {
                plane[at] = number;
            }
        }
    }

    /// Returns the codes of 16 colours with the given alpha, an 8-bit value.
    #[inline(always)]
    pub(super) fn encode<S: Simd>(self, simd: S, [y, co, cg]: [f32x16<S>; 3], alpha: f32x16<S>) -> [Rgba8; WIDE] {
        let colors = [y - cg + co, y + cg, y - cg - co];
        let colors = match self.light {
            FilterSpace::Linear => self.tables.encode_pixels(simd, colors),
            FilterSpace::Bytes => {
                let zero = f32x16::splat(simd, 0.0);
                let [r, g, b] = each!(c in [0, 1, 2] => whole_part((colors[c] + 0.5).max(zero).min(255.0)));
                r | g << 8 | b << 16
            }
        };
        let words = colors | whole_part(alpha + 0.5) << 24;
        let mut codes = [[0; 4]; WIDE];
        words.bitcast::<u8x64<S>>().store_slice(codes.as_flattened_mut());
        codes
    }

    /// Returns the codes of a colour with the given alpha, an 8-bit value. Ignores the fourth number.
    #[inline(always)]
    pub(super) fn encoded(self, [y, co, cg, _]: Quad, alpha: f32) -> Rgba8 {
        let [r, g, b] = self.space().encoded(self.tables, [y, co, cg]);
        [r, g, b, (alpha + 0.5) as u8]
    }

    /// Returns the space of the colours.
    pub(super) fn space(self) -> BlendSpace {
        BlendSpace::YCoCg(self.light)
    }
}
