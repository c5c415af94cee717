//! Loading of the textures of materials: locates each picture and reads it at its first use, within the memory limit of
//! the load.
//!
//! A picture may lie outside the model's folder (`../textures/x.png` is common), because only its pixels are shown. An
//! absolute path on the exporter's machine (`C:\work\x.png`) is replaced by the file of that name beside the library.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::path::{Path, PathBuf};

use super::attributes::quoted;
use super::mtl::{PictureChannel, PictureReference};
use crate::disk;
use crate::image::file::PictureFile;
use crate::image::{Image, Rgba8};
use crate::scene::file_names::{self, NameDifference};
use crate::scene::load::{Load, texture_bytes};
use crate::scene::warnings::Warnings;
use crate::scene::{Alpha, Library, SceneError, Texture, TextureId};

/// Use of a picture in a material.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Use {
    /// Colour texture with alpha (`map_Kd`), or emission texture (`map_Ke`).
    Color,
    /// Opacity texture (`map_d`): one channel of the picture, which is copied to alpha. If no channel is given, the
    /// alpha channel is used if any texel is not opaque, otherwise luminance.
    Opacity(Option<PictureChannel>),
    /// Normal map that is declared as one (`norm`).
    Normals,
    /// Normal map or height map (`map_Bump`). A height map is not rendered.
    Bumps,
}

/// Textures of one model, each read at its first use.
pub(super) struct Textures<'a> {
    /// Texture for each file and use; `None` if the picture was unusable.
    known: HashMap<(PathBuf, Use), Option<TextureId>>,
    load: Load<'a>,
}

/// Context for reading pictures: the path of the model, the library to fill, and the warnings.
pub(super) struct Reading<'a> {
    pub(super) model: &'a Path,
    pub(super) library: &'a mut Library,
    pub(super) warnings: &'a mut Warnings,
}

impl<'a> Textures<'a> {
    /// Creates an empty collection, which may use the remaining memory of `load`.
    pub(super) fn new(load: Load<'a>) -> Self {
        Self { known: HashMap::new(), load }
    }

    /// Reports the completed fraction of all materials, from 0 to 1.
    ///
    /// # Errors
    /// Returns an error if the load is cancelled.
    pub(super) fn advance(&self, completed: f32) -> Result<(), SceneError> {
        self.load.advance(completed)
    }

    /// Returns the texture of a picture, reading it at the first use. Returns `None` with a warning if it cannot be
    /// read or used.
    pub(super) fn get(
        &mut self,
        picture: &PictureReference,
        purpose: Use,
        reading: &mut Reading<'_>,
    ) -> Option<TextureId> {
        let (path, difference) = locate(picture, reading.model);
        let mut warn = |text: String| reading.warnings.add(&picture.library, Some(picture.line), text);
        if difference == NameDifference::Case {
            let found = quoted(&path.file_name().unwrap_or_default().to_string_lossy());
            warn(format!("texture {} is read from {found}: the names differ in case", quoted(&picture.name)));
        }
        let same_file = path.canonicalize().unwrap_or_else(|_| path.clone());
        let place = match self.known.entry((same_file, purpose)) {
            Entry::Occupied(known) => return *known.get(),
            Entry::Vacant(place) => place,
        };
        let texture = match read(&path, &mut self.load) {
            Ok(image) => {
                let bytes = texture_bytes(image.size());
                let texture = adapt(image, purpose, &path, &mut warn)
                    .and_then(|image| Some(reading.library.add_texture(Texture::new(image)?)));
                if texture.is_none() {
                    self.load.release(bytes);
                }
                texture
            }
            Err(reason) if purpose == Use::Color => {
                warn(format!("texture not loaded, the plain colour is used: {reason}"));
                None
            }
            Err(reason) => {
                warn(format!("texture not loaded: {reason}"));
                None
            }
        };
        *place.insert(texture)
    }
}

/// Reads and decodes a picture within the memory limit.
fn read(path: &Path, load: &mut Load<'_>) -> Result<Image<Rgba8>, String> {
    if load.is_cancelled() {
        return Err("loading was cancelled".to_owned());
    }
    load.decode(PictureFile::read_header(path).map_err(|e| e.to_string())?)
}

/// Converts a picture for its use in a material; `None` if it is unusable.
fn adapt(image: Image<Rgba8>, purpose: Use, path: &Path, warn: &mut impl FnMut(String)) -> Option<Image<Rgba8>> {
    let name = quoted(&path.file_name().unwrap_or_default().to_string_lossy());
    match purpose {
        Use::Color if image.pixels().iter().all(|[.., alpha]| *alpha == 0) => {
            if may_lack_alpha(path) {
                warn(format!(
                    "texture {name} has alpha 0 everywhere; drawn opaque, as its format may hold unused alpha"
                ));
                Some(mapped(&image, |[r, g, b, _]| [r, g, b, u8::MAX]))
            } else {
                warn(format!("texture {name} has alpha 0 everywhere: surfaces of this material are invisible"));
                Some(image)
            }
        }
        Use::Color => Some(image),
        Use::Opacity(channel) => {
            let channel = channel.unwrap_or_else(|| default_channel(&image));
            Some(mapped(&image, |texel| [u8::MAX, u8::MAX, u8::MAX, value(channel, texel)]))
        }
        Use::Normals => {
            if !looks_like_normals(&image) {
                warn(format!("texture {name} does not look like a tangent-space normal map; rendered as one"));
            }
            Some(image)
        }
        Use::Bumps => {
            let is_normal_map = looks_like_normals(&image);
            if !is_normal_map {
                warn(format!("texture {name} is a height map, which is not rendered; use `norm` for a normal map"));
            }
            is_normal_map.then_some(image)
        }
    }
}

fn mapped(image: &Image<Rgba8>, map: impl Fn(Rgba8) -> Rgba8) -> Image<Rgba8> {
    Image::from_pixels(image.width(), image.height(), image.pixels().iter().map(|texel| map(*texel)).collect())
}

/// Returns the channel from which opacity is read by default: alpha if any texel is not opaque, otherwise luminance.
pub(super) fn default_channel(image: &Image<Rgba8>) -> PictureChannel {
    let has_alpha = image.pixels().iter().any(|[.., alpha]| *alpha != u8::MAX);
    if has_alpha { PictureChannel::Matte } else { PictureChannel::Luminance }
}

fn value(channel: PictureChannel, [r, g, b, alpha]: Rgba8) -> u8 {
    match channel {
        PictureChannel::Red => r,
        PictureChannel::Green => g,
        PictureChannel::Blue => b,
        PictureChannel::Matte => alpha,
        // Rec. 709 weights, which sum to 10 000.
        PictureChannel::Luminance => {
            ((2126 * u32::from(r) + 7152 * u32::from(g) + 722 * u32::from(b) + 5000) / 10_000) as u8
        }
    }
}

/// Whether a picture with 32 bits per pixel may lack an alpha channel. TGA and BMP files often leave the fourth byte
/// unused.
fn may_lack_alpha(path: &Path) -> bool {
    let is_named = |extension: &str| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(extension));
    is_named("tga") || disk::starts_with(path, b"BM")
}

/// A picture counts as a normal map if at least this fraction of its texels are unit vectors that point out of the
/// surface.
const MIN_NORMAL_SHARE: f64 = 0.9;

/// Whether nearly all texels decode to vectors of about unit length with z > 0. A grey texel, as in a height map, never
/// counts as such a vector.
fn looks_like_normals(image: &Image<Rgba8>) -> bool {
    let is_normal = |[r, g, b, _]: &Rgba8| {
        let [x, y, z] = [r, g, b].map(|code| f32::from(*code) / 127.5 - 1.0);
        let length = (x * x + y * y + z * z).sqrt();
        !(r == g && g == b) && z > 0.0 && (0.8..=1.2).contains(&length)
    };
    let normals = image.pixels().iter().filter(|texel| is_normal(texel)).count();
    normals as f64 >= MIN_NORMAL_SHARE * image.pixels().len() as f64
}

/// Whether `map_d` selects the alpha channel of the same file as `map_Kd`. The colour texture already applies this
/// alpha.
pub(super) fn repeats_alpha(
    color: TextureId,
    opacity: &PictureReference,
    picture: &PictureReference,
    reading: &Reading<'_>,
) -> bool {
    let same_file = locate(opacity, reading.model).0 == locate(picture, reading.model).0;
    let has_alpha = reading.library.texture(color).alpha() != Alpha::Opaque;
    same_file && has_alpha && opacity.options.channel.is_none_or(|channel| channel == PictureChannel::Matte)
}

/// Returns the path of a picture, and how its name differs from the name in the library. Tries several paths. Of the
/// existing files, the one whose name differs least is chosen; if none exists, the first path.
fn locate(picture: &PictureReference, model: &Path) -> (PathBuf, NameDifference) {
    let folder = |file: &Path| file.parent().map_or_else(PathBuf::new, Path::to_owned);
    let (beside_library, beside_model) = (folder(&picture.library), folder(model));
    let written = Path::new(&picture.name);
    let is_foreign = written.is_absolute() || picture.name.chars().nth(1) == Some(':');
    let bare = beside_library.join(written.file_name().unwrap_or_default());
    let candidates =
        if is_foreign { vec![bare] } else { vec![beside_library.join(written), beside_model.join(written), bare] };
    let found =
        candidates.iter().filter_map(|path| file_names::existing(path)).min_by_key(|(_, difference)| *difference);
    found.unwrap_or_else(|| (candidates[0].clone(), NameDifference::None))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(texels: &[Rgba8]) -> Image<Rgba8> {
        Image::from_pixels(texels.len() as u32, 1, texels.to_vec())
    }

    #[test]
    fn normal_maps_and_height_maps_are_distinguished_by_their_texels() {
        let normals = [[128, 128, 255, 255], [200, 128, 232, 255], [90, 60, 229, 255]];
        assert!(looks_like_normals(&image(&normals)));
        for level in 0..=u8::MAX {
            assert!(!looks_like_normals(&image(&[[level, level, level, 255]; 4])), "{level}");
        }
        assert!(!looks_like_normals(&image(&[[255, 0, 0, 255], [0, 255, 0, 255]])));
    }

    #[test]
    fn opacity_is_read_from_the_channel_that_is_named() {
        let texel = [10, 20, 30, 40];
        let read = |channel| {
            let mut warn = |text: String| panic!("{text}");
            adapt(image(&[texel]), Use::Opacity(channel), Path::new("a.png"), &mut warn).unwrap().pixels()[0][3]
        };
        let channels = [PictureChannel::Red, PictureChannel::Green, PictureChannel::Blue, PictureChannel::Matte]
            .map(|c| read(Some(c)));
        assert_eq!(channels, [10, 20, 30, 40]);
        // 0.2126 · 10 + 0.7152 · 20 + 0.0722 · 30 = 18.596.
        assert_eq!(read(Some(PictureChannel::Luminance)), 19);
        assert_eq!(read(None), 40);
    }
}
