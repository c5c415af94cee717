//! Values of quantities at a pixel, and ranges of values.

use serde::Serialize;

use crate::image::Rgba8;
use crate::scene::TriangleId;

/// Value of a buffer at a pixel of the full picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// The pixel was not drawn; the upscaler filled it in.
    NotDrawn,
    /// The pixel was drawn but has no value in the buffer.
    Nothing,
    /// Red, green, blue and alpha, as sRGB codes.
    Color(Rgba8),
    /// Floating-point value, such as a depth.
    Number(f32),
    /// Integer count, such as overdraw.
    Count(u32),
    /// Barycentric weights of the triangle's corners.
    Weights([f32; 3]),
    /// Triangle that is visible at the pixel.
    Triangle(TriangleId),
}

/// Range of values that a colour map spans.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Range {
    /// Value at the start of the colour map.
    pub low: f32,
    /// Value at the end of the colour map.
    pub high: f32,
}

impl Range {
    /// Returns the range from minimum to maximum of the finite `values`; `None` if there are none.
    pub(crate) fn fit(values: impl Iterator<Item = f32>) -> Option<Self> {
        values.filter(|v| v.is_finite()).fold(None, |range: Option<Self>, v| {
            Some(range.map_or(Self { low: v, high: v }, |r| Self { low: r.low.min(v), high: r.high.max(v) }))
        })
    }

    /// Returns the position of a value within the range, clamped to [0, 1].
    pub fn position(self, value: f32) -> f32 {
        let width = self.high - self.low;
        if width > 0.0 { ((value - self.low) / width).clamp(0.0, 1.0) } else { 0.0 }
    }
}
