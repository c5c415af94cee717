//! Textures: pictures that are read by texture coordinate.

use std::sync::OnceLock;

use super::mips;
use crate::image::color::decode_byte;
use crate::image::{Image, Rgba8};

/// Which alpha codes a picture has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Alpha {
    /// 255 alone.
    Opaque,
    /// 0 and 255 alone.
    AllOrNothing,
    /// Others, too.
    Graded,
}

impl Alpha {
    fn of(image: &Image<Rgba8>) -> Self {
        let of_code = |code| match code {
            u8::MAX => Self::Opaque,
            0 => Self::AllOrNothing,
            _ => Self::Graded,
        };
        image.pixels().iter().map(|[_, _, _, alpha]| of_code(*alpha)).max().unwrap_or(Self::Opaque)
    }
}

/// A texture. Never empty.
#[derive(Clone, Debug)]
pub struct Texture {
    name: String,
    image: Image<Rgba8>,
    alpha: Alpha,
    wrapped: OnceLock<Box<[u32]>>,
    wrapped_linear: OnceLock<Box<[[f32; 4]]>>,
    /// Means of codes, means of linear light.
    smaller: [OnceLock<Vec<Image<Rgba8>>>; 2],
}

impl Texture {
    /// Takes a picture; `None` if it has no pixel.
    pub fn new(name: impl Into<String>, image: Image<Rgba8>) -> Option<Self> {
        (image.width() > 0 && image.height() > 0).then(|| Self {
            name: name.into(),
            alpha: Alpha::of(&image),
            image,
            wrapped: OnceLock::new(),
            wrapped_linear: OnceLock::new(),
            smaller: [const { OnceLock::new() }; 2],
        })
    }

    /// File name, or a given one.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Texels as little-endian numbers, each row followed by its first texel: neighbours along a row of the repeated texture
    /// are neighbours in memory. Made when first asked for.
    pub fn wrapped(&self) -> &[u32] {
        self.wrapped.get_or_init(|| self.wrap(u32::from_le_bytes))
    }

    /// The same in linear light: red, green and blue, and a fourth number that means nothing.
    pub fn wrapped_linear(&self) -> &[[f32; 4]] {
        self.wrapped_linear.get_or_init(|| self.wrap(|texel| texel.map(decode_byte)))
    }

    fn wrap<T>(&self, value: impl Fn(Rgba8) -> T) -> Box<[T]> {
        let rows = (0..self.image.height()).map(|y| self.image.row(y));
        rows.flat_map(|row| row.iter().chain(row.first()).map(|texel| value(*texel))).collect()
    }

    /// Copies of half the length, a quarter, and so on down to one texel, by means of linear light or of codes. Made when
    /// first asked for.
    pub fn smaller(&self, linear: bool) -> &[Image<Rgba8>] {
        self.smaller[usize::from(linear)].get_or_init(|| mips::smaller(&self.image, linear))
    }

    /// Texels, row 0 at the top (v = 0 after the flip on load).
    pub fn image(&self) -> &Image<Rgba8> {
        &self.image
    }

    /// What alpha its texels have; found out once, when the texture was made.
    pub fn alpha(&self) -> Alpha {
        self.alpha
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_texture_knows_which_alpha_it_has() {
        let alpha = |codes: &[u8]| {
            let image = Image::from_fn(codes.len() as u32, 1, |x, _| [9, 9, 9, codes[x as usize]]);
            Texture::new("codes", image).unwrap().alpha()
        };
        assert_eq!(alpha(&[255, 255]), Alpha::Opaque);
        assert_eq!(alpha(&[255, 0, 255]), Alpha::AllOrNothing);
        assert_eq!(alpha(&[0]), Alpha::AllOrNothing);
        for graded in [1, 128, 254] {
            assert_eq!(alpha(&[255, graded, 0]), Alpha::Graded);
        }
    }
}
