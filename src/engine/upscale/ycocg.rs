//! YCoCg: the colour space in which temporal upscalers compare colours, because chroma and luminance are separate in it.

use super::{BlendSpace, FilterSpace};
use crate::image::Rgba8;
use crate::image::color::Tables;

/// Y, Co, Cg and a fourth number: alpha of a sample as an 8-bit value, or the accumulated weight of a pixel.
pub(super) type Quad = [f32; 4];

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
        let table = match self.light {
            FilterSpace::Linear => &self.tables.linear_of_code,
            FilterSpace::Bytes => &self.tables.code,
        };
        let [r, g, b] = [r, g, b].map(|code| table[usize::from(code)]);
        [0.25 * r + 0.5 * g + 0.25 * b, 0.5 * r - 0.5 * b, 0.5 * g - 0.25 * r - 0.25 * b, f32::from(a)]
    }

    /// Returns the space of the colours.
    pub(super) fn space(self) -> BlendSpace {
        BlendSpace::YCoCg(self.light)
    }

    /// Returns the codes of a colour with the given alpha, an 8-bit value. Ignores the fourth number.
    #[inline(always)]
    pub(super) fn encoded(self, [y, co, cg, _]: Quad, alpha: f32) -> Rgba8 {
        let [r, g, b] = self.space().encoded(self.tables, [y, co, cg]);
        [r, g, b, (alpha + 0.5) as u8]
    }
}
