//! Textures: pictures that are read by texture coordinate.

use std::sync::OnceLock;

use crate::image::{Image, Rgba8};

/// A texture. Never empty.
#[derive(Clone, Debug)]
pub struct Texture {
    name: String,
    image: Image<Rgba8>,
    wrapped: OnceLock<Box<[u32]>>,
}

impl Texture {
    /// Takes a picture; `None` if it has no pixel.
    pub fn new(name: impl Into<String>, image: Image<Rgba8>) -> Option<Self> {
        (image.width() > 0 && image.height() > 0).then(|| Self { name: name.into(), image, wrapped: OnceLock::new() })
    }

    /// File name, or a given one.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Texels as little-endian numbers, each row followed by its first texel: neighbours along a row of the repeated texture
    /// are neighbours in memory. Made when first asked for.
    pub fn wrapped(&self) -> &[u32] {
        self.wrapped.get_or_init(|| {
            let rows = (0..self.image.height()).map(|y| self.image.row(y));
            rows.flat_map(|row| row.iter().chain(row.first()).map(|texel| u32::from_le_bytes(*texel))).collect()
        })
    }

    /// Texels, row 0 at the top (v = 0 after the flip on load).
    pub fn image(&self) -> &Image<Rgba8> {
        &self.image
    }
}
