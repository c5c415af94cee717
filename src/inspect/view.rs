//! Buffers as pictures: which colour stands for which value, and the range between the ends of the map.

use serde::Serialize;

use super::buffers::{Buffer, Buffers};
use super::stages::NOT_DRAWN;
use crate::chain::Frame;
use crate::image::color::quantize;
use crate::image::{Image, Rgba8};
use crate::pipeline::shade::id_color;
use crate::scene::TriangleId;

/// The values that the two ends of a colour map stand for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Range {
    /// Start of the map.
    pub low: f32,
    /// End of the map.
    pub high: f32,
}

impl Range {
    /// From the least to the greatest of finite `values`; `None` if there is none.
    pub fn fit(values: impl Iterator<Item = f32>) -> Option<Self> {
        values.filter(|v| v.is_finite()).fold(None, |range: Option<Self>, v| {
            Some(range.map_or(Self { low: v, high: v }, |r| Self { low: r.low.min(v), high: r.high.max(v) }))
        })
    }

    /// Where a value lies between the ends, in [0, 1].
    pub fn position(self, value: f32) -> f32 {
        let width = self.high - self.low;
        if width > 0.0 { ((value - self.low) / width).clamp(0.0, 1.0) } else { 0.0 }
    }
}

/// Colour of a position in [0, 1] on the map for magnitudes (viridis: even steps, safe for the colour-blind).
pub fn magnitude_color(position: f32) -> Rgba8 {
    let [r, g, b] = colorous::VIRIDIS.eval_continuous(f64::from(position.clamp(0.0, 1.0))).as_array();
    [r, g, b, 255]
}

/// What the depth buffer is cleared to, by its format and test; nothing was drawn there.
const CLEARED_NEAR: f32 = 0.0;
const CLEARED_FAR: f32 = 1.0;

/// The value of a buffer at a pixel of the full picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// The pixel is left to the upscaler.
    NotDrawn,
    /// Drawn, but no triangle is there.
    Nothing,
    /// Red, green, blue.
    Color(Rgba8),
    /// One number.
    Number(f32),
    /// A whole number.
    Count(u32),
    /// Three weights.
    Weights([f32; 3]),
    /// A triangle.
    Triangle(TriangleId),
}

/// Reads a buffer at a pixel inside the picture. `buffers` may be missing for colour and depth.
pub fn value(buffer: Buffer, frame: &Frame, buffers: Option<&Buffers>, x: u32, y: u32) -> Value {
    if buffer == Buffer::Color {
        return frame.image.get(x, y).map_or(Value::NotDrawn, Value::Color);
    }
    let Some((column, row)) = frame.drawn.grid.sample_at(x, y) else {
        return Value::NotDrawn;
    };
    if buffer == Buffer::Depth {
        return frame.drawn.depth.as_ref().map_or(Value::Nothing, |d| Value::Number(d.at(column, row)));
    }
    let Some(buffers) = buffers else {
        return Value::Nothing;
    };
    let id = buffers.triangle.at(column, row);
    match buffer {
        Buffer::Overdraw => Value::Count(buffers.overdraw.at(column, row)),
        Buffer::Shaded => Value::Count(buffers.shaded.at(column, row)),
        _ if id == TriangleId::NONE => Value::Nothing,
        Buffer::Lambda => Value::Weights(buffers.lambda.at(column, row)),
        Buffer::PerspectiveLambda => Value::Weights(buffers.perspective_lambda.at(column, row)),
        Buffer::TriangleId | Buffer::Color | Buffer::Depth => Value::Triangle(id),
    }
}

/// The range of a buffer that is shown by a colour map: least to greatest, for depth without the cleared pixels.
pub fn range(buffer: Buffer, frame: &Frame, buffers: Option<&Buffers>) -> Option<Range> {
    match buffer {
        Buffer::Depth => {
            let depth = frame.drawn.depth.as_ref()?;
            Range::fit(depth.pixels().iter().copied().filter(|d| *d > CLEARED_NEAR && *d < CLEARED_FAR))
        }
        Buffer::Overdraw | Buffer::Shaded => {
            let buffers = buffers?;
            let counts = if buffer == Buffer::Overdraw { &buffers.overdraw } else { &buffers.shaded };
            Range::fit(counts.pixels().iter().map(|c| *c as f32)).map(|r| Range { low: 0.0, ..r })
        }
        _ => None,
    }
}

/// A buffer as a full picture.
pub fn picture(buffer: Buffer, frame: &Frame, buffers: Option<&Buffers>, range: Option<Range>) -> Image<Rgba8> {
    let range = range.unwrap_or(Range { low: 0.0, high: 1.0 });
    let (width, height) = frame.image.size();
    Image::from_fn(width, height, |x, y| match value(buffer, frame, buffers, x, y) {
        Value::NotDrawn | Value::Nothing | Value::Number(CLEARED_NEAR | CLEARED_FAR) => NOT_DRAWN,
        Value::Color(color) => color,
        Value::Number(number) => magnitude_color(range.position(number)),
        Value::Count(count) => magnitude_color(range.position(count as f32)),
        Value::Weights([a, b, c]) => [quantize(a), quantize(b), quantize(c), 255],
        Value::Triangle(id) => id_color(id),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_ignore_what_is_not_finite_and_survive_constants() {
        assert_eq!(Range::fit([f32::NAN, f32::INFINITY].into_iter()), None);
        let flat = Range::fit([0.5, f32::NAN, 0.5].into_iter()).unwrap();
        assert_eq!(flat, Range { low: 0.5, high: 0.5 });
        assert_eq!(flat.position(0.5), 0.0);
        assert_eq!(Range { low: 1.0, high: 3.0 }.position(2.5), 0.75);
    }
}
