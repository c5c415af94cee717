//! Textures: pictures that are read by texture coordinate.

use std::sync::OnceLock;

use crate::image::{Image, Rgba8};

/// A texture. Never empty.
#[derive(Clone, Debug)]
pub struct Texture {
    name: String,
    image: Image<Rgba8>,
    pairs: OnceLock<Box<[u64]>>,
}

impl Texture {
    /// Takes a picture; `None` if it has no pixel.
    pub fn new(name: impl Into<String>, image: Image<Rgba8>) -> Option<Self> {
        (image.width() > 0 && image.height() > 0).then(|| Self { name: name.into(), image, pairs: OnceLock::new() })
    }

    /// File name, or a given one.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Each texel with its right neighbour in the repeated texture, as little-endian numbers, the neighbour in the upper half:
    /// one read gives both. Made when first asked for.
    pub fn pairs(&self) -> &[u64] {
        self.pairs.get_or_init(|| {
            let number = |texel: &Rgba8| u64::from(u32::from_le_bytes(*texel));
            let pairs_of = |row| {
                let row: &[Rgba8] = self.image.row(row);
                let neighbours = row.iter().skip(1).chain(row.first());
                row.iter().zip(neighbours).map(move |(texel, neighbour)| number(texel) | number(neighbour) << 32)
            };
            (0..self.image.height()).flat_map(pairs_of).collect()
        })
    }

    /// Texels, row 0 at the top (v = 0 after the flip on load).
    pub fn image(&self) -> &Image<Rgba8> {
        &self.image
    }
}
