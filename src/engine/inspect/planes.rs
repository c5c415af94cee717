//! Export of the displayed quantity as exact floats.

use super::view::Value;
use crate::image::Image;
use crate::image::pfm::Floats;

/// Returns the exact values of a picture of `size` pixels as floats. Colours (codes from 0 to 255) and weights give
/// three floats per pixel, and other quantities give one. Pixels without a value are NaN. Triangle ids are exact up to
/// 2²⁴.
pub fn planes(size: (u32, u32), value: impl Fn(u32, u32) -> Value) -> Floats {
    let three = |x, y| match value(x, y) {
        Value::Color([r, g, b, _]) => Some([r, g, b].map(f32::from)),
        Value::Weights(weights) => Some(weights),
        _ => None,
    };
    let mut pixels = (0..size.1).flat_map(|y| (0..size.0).map(move |x| (x, y)));
    if pixels.any(|(x, y)| three(x, y).is_some()) {
        return Floats::Three(Image::from_fn(size.0, size.1, |x, y| three(x, y).unwrap_or([f32::NAN; 3])));
    }
    Floats::One(Image::from_fn(size.0, size.1, |x, y| match value(x, y) {
        Value::Number(number) => number,
        Value::Count(count) => count as f32,
        Value::Triangle(id) => id.0 as f32,
        Value::NotDrawn | Value::Nothing | Value::Color(_) | Value::Weights(_) => f32::NAN,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_give_three_floats_per_pixel_and_numbers_give_one() {
        let one = planes((2, 1), |x, _| if x == 0 { Value::Number(0.1) } else { Value::Nothing });
        let Floats::One(image) = one else { panic!("one number") };
        assert!(image.at(0, 0) == 0.1 && image.at(1, 0).is_nan());
        let three = planes((2, 1), |x, _| if x == 1 { Value::Color([1, 2, 255, 9]) } else { Value::NotDrawn });
        let Floats::Three(image) = three else { panic!("three numbers") };
        assert!(image.at(1, 0) == [1.0, 2.0, 255.0] && image.at(0, 0)[0].is_nan());
    }
}
