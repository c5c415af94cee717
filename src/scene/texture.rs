//! Textures: pictures that are read by texture coordinate.

use crate::image::{Image, Rgba8};

/// A texture. Never empty.
#[derive(Clone, Debug)]
pub struct Texture {
    name: String,
    image: Image<Rgba8>,
}

impl Texture {
    /// Takes a picture; `None` if it has no pixel.
    pub fn new(name: impl Into<String>, image: Image<Rgba8>) -> Option<Self> {
        (image.width() > 0 && image.height() > 0).then(|| Self { name: name.into(), image })
    }

    /// File name, or a given one.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Texels, row 0 at the top (v = 0 after the flip on load).
    pub fn image(&self) -> &Image<Rgba8> {
        &self.image
    }
}
