//! Textures: pictures in buffers, in URIs and in files, each decoded at its first use within the memory limit.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use gltf_json::{Index, Root, texture};

use super::Remarks;
use super::buffers::{self, Buffers};
use super::uris::{self, Target};
use crate::image::file::PictureFile;
use crate::image::{Image, Rgba8};
use crate::scene::load::{Load, texture_bytes};
use crate::scene::{Alpha, Library, Texture, TextureId};
use crate::text;

/// Use of a texture by a material.
#[derive(Clone, Copy)]
pub(super) struct TextureUse {
    /// Index of the texture in the file.
    pub(super) index: Index<texture::Texture>,
    /// Whether the material reads alpha; otherwise all texels are opaque.
    pub(super) keeps_alpha: bool,
}

/// Textures of a file, each decoded at its first use.
pub(super) struct Textures<'a> {
    path: &'a Path,
    root: &'a Root,
    buffers: &'a Buffers<'a>,
    /// Texture for each image, with and without its alpha; `None` if the picture is unusable.
    known: HashMap<(usize, bool), Option<TextureId>>,
}

impl<'a> Textures<'a> {
    /// Creates an empty collection for the file at `path`.
    pub(super) fn new(path: &'a Path, root: &'a Root, buffers: &'a Buffers<'a>) -> Self {
        Self { path, root, buffers, known: HashMap::new() }
    }

    /// Returns the texture for a use. Returns `None` with a warning if its picture cannot be read.
    pub(super) fn get(
        &mut self,
        TextureUse { index, keeps_alpha }: TextureUse,
        library: &mut Library,
        load: &mut Load<'_>,
        remarks: &mut Remarks<'_>,
    ) -> Option<TextureId> {
        let image = self.root.get(index).map(|texture| texture.source.value());
        let Some(image) = image.filter(|image| *image < self.root.images.len()) else {
            remarks.warn(format!("textures[{}]: it has no picture in a format that is read", index.value()));
            return None;
        };
        if let Some(known) = self.known.get(&(image, keeps_alpha)) {
            return *known;
        }
        let texture = match self.picture(image, load) {
            Ok(picture) => {
                let bytes = texture_bytes(picture.size());
                let texture = Texture::new(if keeps_alpha { picture } else { opaque(picture) });
                let texture = texture.map(|texture| library.add_texture(texture));
                if texture.is_none() {
                    load.release(bytes);
                }
                texture
            }
            Err(reason) => {
                remarks.warn(format!("images[{image}]: texture not loaded, the plain colour is used: {reason}"));
                None
            }
        };
        let is_opaque = texture.is_none_or(|id| library.texture(id).alpha() == Alpha::Opaque);
        self.known.insert((image, keeps_alpha), texture);
        if keeps_alpha && is_opaque {
            self.known.insert((image, false), texture);
        }
        texture
    }

    /// Decodes a picture. The error is one sentence.
    fn picture(&self, image: usize, load: &mut Load<'_>) -> Result<Image<Rgba8>, String> {
        let image = &self.root.images[image];
        let embedded = |bytes| PictureFile::of_bytes(&self.shown(), bytes).map_err(|error| error.to_string());
        let header = match (&image.uri, image.buffer_view) {
            (Some(uri), _) => match uris::target(uri, self.path)? {
                Target::Embedded(data) => {
                    load.charge(data.max_length())?;
                    let bytes = data.decode();
                    load.release(data.max_length());
                    embedded(bytes?)
                }
                Target::File(path) => PictureFile::read_header(&path).map_err(|error| error.to_string()),
            },
            (None, Some(view)) => {
                let (bytes, _) = buffers::view(self.root, self.buffers, view)?;
                load.charge(bytes.len() as u64)?;
                load.release(bytes.len() as u64);
                embedded(bytes.to_vec())
            }
            (None, None) => return Err("it has neither a `uri` nor a buffer view".to_owned()),
        };
        load.decode(header?)
    }

    /// Returns the path that names an embedded picture in messages.
    fn shown(&self) -> PathBuf {
        PathBuf::from(text::path(self.path.file_name().unwrap_or_default().as_ref()))
    }
}

/// Returns the picture with alpha 255 everywhere.
fn opaque(picture: Image<Rgba8>) -> Image<Rgba8> {
    if picture.pixels().iter().all(|[.., alpha]| *alpha == u8::MAX) {
        return picture;
    }
    let texels = picture.pixels().iter().map(|[r, g, b, _]| [*r, *g, *b, u8::MAX]).collect();
    Image::from_pixels(picture.width(), picture.height(), texels)
}
