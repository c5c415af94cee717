//! Textures: images sampled by texture coordinates.

use std::sync::OnceLock;

use super::mips::{self, Levels, with_wrapped_border};
use crate::image::color::decode_byte;
use crate::image::{Image, Rgba8};

/// Classification of the alpha values that occur in an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Alpha {
    /// All texels have alpha 255.
    Opaque,
    /// All texels have alpha 0 or 255.
    AllOrNothing,
    /// Some texels have an alpha from 1 to 254.
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

/// Texture with at least one texel, and cached representations of it.
#[derive(Clone, Debug)]
pub struct Texture {
    image: Image<Rgba8>,
    alpha: Alpha,
    wrapped: OnceLock<Box<[u32]>>,
    wrapped_linear: OnceLock<Box<[[f32; 4]]>>,
    levels: OnceLock<Levels<u32>>,
    levels_linear: OnceLock<Levels<[f32; 4]>>,
    /// Mip levels below full size: at index 0 averaged as sRGB codes, at index 1 averaged in linear light.
    mip_levels: [OnceLock<Vec<Image<Rgba8>>>; 2],
}

impl Texture {
    /// Creates a texture from an image; `None` if the image has no pixels.
    pub fn new(image: Image<Rgba8>) -> Option<Self> {
        (image.width() > 0 && image.height() > 0).then(|| Self {
            alpha: Alpha::of(&image),
            image,
            wrapped: OnceLock::new(),
            wrapped_linear: OnceLock::new(),
            levels: OnceLock::new(),
            levels_linear: OnceLock::new(),
            mip_levels: [const { OnceLock::new() }; 2],
        })
    }

    /// Returns the texels row by row, with a wrapped border. A texel is one number with red in the lowest byte. Each
    /// row is followed by a copy of its first texel, and the last row by a copy of the first row.
    ///
    /// At any position of the repeated texture, the four texels for bilinear filtering are therefore two pairs of
    /// adjacent elements, one row apart. The result is computed at the first call and cached.
    pub(crate) fn wrapped(&self) -> &[u32] {
        self.wrapped.get_or_init(|| with_wrapped_border(&self.image, u32::from_le_bytes).collect())
    }

    /// Returns the texels of [`Texture::wrapped`] in linear light: red, green and blue as linear values in [0, 1], and
    /// alpha as a code from 0 to 255.
    pub(crate) fn wrapped_linear(&self) -> &[[f32; 4]] {
        self.wrapped_linear.get_or_init(|| with_wrapped_border(&self.image, linear).collect())
    }

    /// Returns all mip levels in the layout of [`Texture::wrapped`]. The smaller levels are averaged as sRGB codes.
    pub(crate) fn levels(&self) -> &Levels<u32> {
        self.levels.get_or_init(|| Levels::new(self.images(false), u32::from_le_bytes))
    }

    /// Returns all mip levels in the layout of [`Texture::wrapped_linear`]. The smaller levels are averaged in linear
    /// light.
    pub(crate) fn levels_linear(&self) -> &Levels<[f32; 4]> {
        self.levels_linear.get_or_init(|| Levels::new(self.images(true), linear))
    }

    /// Returns the images of all mip levels, from largest to smallest. The smaller levels are averaged in linear light
    /// if `linear` is `true`, otherwise as sRGB codes.
    fn images(&self, linear: bool) -> impl Iterator<Item = &Image<Rgba8>> {
        [&self.image].into_iter().chain(self.mip_levels(linear))
    }

    /// Returns the mip levels from half size down to one texel, averaged in linear light if `linear` is `true`,
    /// otherwise as sRGB codes. They are computed at the first call and cached.
    pub(crate) fn mip_levels(&self, linear: bool) -> &[Image<Rgba8>] {
        self.mip_levels[usize::from(linear)].get_or_init(|| mips::mip_levels(&self.image, linear))
    }

    /// Returns the memory currently used by the image and its cached representations, in bytes.
    pub(crate) fn bytes(&self) -> usize {
        let smaller = self.mip_levels.iter().filter_map(OnceLock::get).flatten();
        self.image.bytes()
            + self.wrapped.get().map_or(0, |texels| size_of_val(&**texels))
            + self.wrapped_linear.get().map_or(0, |texels| size_of_val(&**texels))
            + self.levels.get().map_or(0, Levels::bytes)
            + self.levels_linear.get().map_or(0, Levels::bytes)
            + smaller.map(Image::bytes).sum::<usize>()
    }

    /// Returns the full-size image, with row 0 at the top (v = 0 after the flip on load).
    pub fn image(&self) -> &Image<Rgba8> {
        &self.image
    }

    /// Returns the classification of the texels' alpha values, determined at construction.
    pub(crate) fn alpha(&self) -> Alpha {
        self.alpha
    }
}

fn linear([r, g, b, alpha]: Rgba8) -> [f32; 4] {
    [decode_byte(r), decode_byte(g), decode_byte(b), alpha.into()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_contain_the_wrapped_rows_of_all_mip_levels() {
        let mut random = fastrand::Rng::with_seed(13);
        for (width, height) in [(16, 16), (5, 7), (1, 9), (12, 3), (1, 1)] {
            let image = Image::from_fn(width, height, |_, _| [(); 4].map(|()| random.u8(..)));
            let texture = Texture::new(image).unwrap();
            let (codes, linear) = (texture.levels(), texture.levels_linear());
            assert_eq!(codes.offsets, linear.offsets);
            assert_eq!(codes.offsets.count as usize, texture.mip_levels(false).len() + 1);
            let all = codes.offsets.first;
            assert!(
                all.iter()
                    .skip(codes.offsets.count as usize)
                    .all(|last| *last == all[codes.offsets.count as usize - 1])
            );
            let (stride, mut taken) = (width as usize + 1, vec![false; codes.texels.len()]);
            for (level, first) in all.into_iter().enumerate().take(codes.offsets.count as usize) {
                let [first, width, height] =
                    [first, (width >> level).max(1), (height >> level).max(1)].map(|number| number as usize);
                assert!(first % stride + width < stride, "its rows do not break");
                for (x, y) in (0..=height).flat_map(|y| (0..=width).map(move |x| (x, y))) {
                    let texel = |linear: bool| {
                        let image =
                            level.checked_sub(1).map_or(texture.image(), |copy| &texture.mip_levels(linear)[copy]);
                        assert_eq!(image.size(), (width as u32, height as u32));
                        image.at((x % width) as u32, (y % height) as u32)
                    };
                    let place = first + y * stride + x;
                    assert!(!std::mem::replace(&mut taken[place], true), "levels do not overlap");
                    assert_eq!(codes.texels[place], u32::from_le_bytes(texel(false)));
                    let [r, g, b, alpha] = texel(true);
                    assert_eq!(linear.texels[place][..3], [r, g, b].map(decode_byte));
                    assert_eq!(linear.texels[place][3], f32::from(alpha));
                }
            }
            assert_eq!(codes.texels.len(), linear.texels.len());
        }
    }

    #[test]
    fn cached_representations_count_as_memory() {
        let texture = Texture::new(Image::filled(8, 4, [9; 4])).unwrap();
        assert_eq!(texture.bytes(), 8 * 4 * 4);
        texture.wrapped();
        assert_eq!(texture.bytes(), 8 * 4 * 4 + 9 * 5 * 4);
        texture.wrapped_linear();
        assert_eq!(texture.bytes(), 8 * 4 * 4 + 9 * 5 * (4 + 16));
        texture.levels();
        // Smaller levels of 4 × 2, 2 × 1 and 1 × 1 texels, and the array of all levels.
        let copies = (4 * 2 + 2 + 1) * 4;
        // The two smallest levels are stacked beside the first smaller level and extend one row below it.
        let levels = 9 * (5 + 3 + 1) * 4;
        assert_eq!(texture.bytes(), 8 * 4 * 4 + 9 * 5 * (4 + 16) + copies + levels);
    }

    #[test]
    fn a_texture_knows_which_alpha_it_has() {
        let alpha = |codes: &[u8]| {
            let image = Image::from_fn(codes.len() as u32, 1, |x, _| [9, 9, 9, codes[x as usize]]);
            Texture::new(image).unwrap().alpha()
        };
        assert_eq!(alpha(&[255, 255]), Alpha::Opaque);
        assert_eq!(alpha(&[255, 0, 255]), Alpha::AllOrNothing);
        assert_eq!(alpha(&[0]), Alpha::AllOrNothing);
        for graded in [1, 128, 254] {
            assert_eq!(alpha(&[255, graded, 0]), Alpha::Graded);
        }
    }
}
