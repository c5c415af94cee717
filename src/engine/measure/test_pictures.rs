//! Pictures of 192 × 176 px for which other programs were run once; integer formulas, so that any language can draw them.

use crate::image::{Image, Rgba8};

/// Width and height in pixels.
const SIZE: (u32, u32) = (192, 176);

/// Change of the original picture.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Distortion {
    /// Mean of 3 × 3 px, rounded down; border pixels are repeated.
    Blur,
    /// Noise of ±16 codes, the same in all channels.
    Noise,
    /// Nine tenths of every code.
    Dim,
}

/// Returns the picture without distortion: gradients, a grid and fine texture.
pub(crate) fn original() -> Image<Rgba8> {
    Image::from_fn(SIZE.0, SIZE.1, |x, y| {
        let red = (x * x + 3 * x * y + y * y) / 97 % 256;
        let green = (5 * x + y * y / 31) % 256;
        let blue = (x / 16 + y / 16) % 2 * 140 + x * y / 173 % 100;
        [red as u8, green as u8, blue as u8, 255]
    })
}

impl Distortion {
    /// Returns the distorted picture.
    pub(crate) fn applied(self) -> Image<Rgba8> {
        let original = original();
        Image::from_fn(SIZE.0, SIZE.1, |x, y| {
            let channel = |channel: usize| match self {
                Self::Blur => {
                    let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy)));
                    let codes = around
                        .map(|(dx, dy)| u32::from(original.at_clamped(i64::from(x) + dx, i64::from(y) + dy)[channel]));
                    (codes.sum::<u32>() / 9) as u8
                }
                Self::Noise => {
                    let noise = ((u64::from(x) * 73_856_093) ^ (u64::from(y) * 19_349_663)) % 33;
                    (u64::from(original.at(x, y)[channel]) + noise).saturating_sub(16).min(255) as u8
                }
                Self::Dim => (u32::from(original.at(x, y)[channel]) * 9 / 10) as u8,
            };
            [channel(0), channel(1), channel(2), 255]
        })
    }
}
