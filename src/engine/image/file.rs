//! Image files: bounded reading of untrusted files, and writing of PNG.
//!
//! Reading a path gives 8-bit RGBA (sRGB codes and straight alpha), or an error that names the file and the cause;
//! [`super::picture`] gives the exact samples. The format is recognised by content, not by name, because wrong suffixes
//! are common; only TGA has no signature and needs its suffix. Sizes are checked after the header and before any
//! allocation, so a small file cannot cause a large allocation. 16-bit channels are rounded to 8 bits, linear light is
//! clamped to [0, 1] and encoded as sRGB, grey becomes RGB, and only the first frame of an animation is read. Colour
//! profiles and orientation tags are ignored, because a texture needs its texels unchanged.

use std::path::{Path, PathBuf};

use image::codecs::png::PngEncoder;
use image::{DynamicImage, ExtendedColorType, ImageEncoder as _, ImageFormat};
use thiserror::Error;

use super::decoder::{MAX_PIXELS, MAX_SIDE, reader};
use super::picture::formats::{self, Codec, Format};
use super::picture::{Picture, standard};
use super::{Image, Rgba8};
use crate::{disk, text};

/// Maximum size of an image file that can be read, in bytes.
const MAX_FILE_BYTES: u64 = 256 << 20;

/// Error from reading or writing an image file.
#[derive(Debug, Error)]
pub enum ImageFileError {
    /// The file cannot be read.
    #[error("{}: cannot read it: {source}", path.display())]
    Unreadable {
        /// Path of the file.
        path: PathBuf,
        /// Error from the operating system.
        source: std::io::Error,
    },
    /// The content is not in a supported image format.
    #[error("{}: not a supported picture ({}); {hint}", path.display(), formats::names())]
    Unsupported {
        /// Path of the file.
        path: PathBuf,
        /// Likely content of the file, such as `it looks like text`.
        hint: String,
    },
    /// The image is too wide, too high, or has too many pixels in total.
    #[error("{}: {width} × {height} pixels are too many (at most {MAX_SIDE} per side and {MAX_PIXELS} in total)", path.display())]
    TooManyPixels {
        /// Path of the file.
        path: PathBuf,
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
    },
    /// The content is damaged, or decoding it needs more memory than is allowed.
    #[error("{}: cannot decode this {kind} file: {reason}", path.display())]
    Undecodable {
        /// Path of the file.
        path: PathBuf,
        /// Name of the format, such as `PNG`.
        kind: &'static str,
        /// Error message of the decoder.
        reason: String,
    },
    /// A path names no sequence of pictures.
    #[error("{}: {reason}", path.display())]
    NoSequence {
        /// Folder, or path with a pattern in its file name.
        path: PathBuf,
        /// Reason, such as `the folder has no pictures`.
        reason: String,
    },
    /// The file cannot be written.
    #[error("{}: cannot write it: {source}", path.display())]
    Unwritable {
        /// Path of the file.
        path: PathBuf,
        /// Error from the operating system.
        source: std::io::Error,
    },
}

/// Reads an image file. The image is never empty, and has at most 16 384 pixels per side and 8192 × 8192 in total.
pub fn read(path: &Path) -> Result<Image<Rgba8>, ImageFileError> {
    PictureFile::read_header(path)?.decode()
}

/// Image file whose header has been read.
#[derive(Debug)]
pub(crate) struct PictureFile {
    path: PathBuf,
    bytes: Vec<u8>,
    format: &'static Format,
    width: u32,
    height: u32,
}

impl PictureFile {
    /// Reads a file, and the size of its image from the header. The image is never empty, and has at most 16 384 pixels
    /// per side and 8192 × 8192 in total.
    pub(crate) fn read_header(path: &Path) -> Result<Self, ImageFileError> {
        let bytes = disk::read(path, MAX_FILE_BYTES)
            .map_err(|source| ImageFileError::Unreadable { path: path.to_owned(), source })?;
        Self::of_bytes(path, bytes)
    }

    /// Reads the header of a picture that is part of another file. `path` names it in messages. The limits of
    /// [`PictureFile::read_header`] apply.
    pub(crate) fn of_bytes(path: &Path, bytes: Vec<u8>) -> Result<Self, ImageFileError> {
        let format = Format::of(path, &bytes)
            .ok_or_else(|| ImageFileError::Unsupported { path: path.to_owned(), hint: hint(&bytes) })?;
        let size = match format.codec {
            Codec::Image(codec) => reader(&bytes, codec).into_dimensions().map_err(|error| error.to_string()),
            Codec::Own(size, _) => size(&bytes),
        };
        let (width, height) = size.map_err(|error| undecodable(path, format, &error))?;
        if width == 0 || height == 0 {
            return Err(undecodable(path, format, "it has no pixels"));
        }
        if width.max(height) > MAX_SIDE || u64::from(width) * u64::from(height) > MAX_PIXELS {
            return Err(ImageFileError::TooManyPixels { path: path.to_owned(), width, height });
        }
        Ok(Self { path: path.to_owned(), bytes, format, width, height })
    }

    /// Returns the path that names the picture in messages.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the width and height of the image, in pixels.
    pub(crate) fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// Decodes the pixels to 8-bit RGBA with straight alpha.
    pub(crate) fn decode(self) -> Result<Image<Rgba8>, ImageFileError> {
        let decoded = match self.format.codec {
            Codec::Image(codec) => reader(&self.bytes, codec).decode().map_err(|error| error.to_string()),
            Codec::Own(..) => return self.decode_samples().map(|picture| picture.to_rgba8()),
        };
        match decoded {
            Ok(DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_)) => {
                self.decode_samples().map(|picture| picture.to_rgba8())
            }
            Ok(decoded) => Ok(to_rgba(decoded)),
            Err(error) => Err(undecodable(&self.path, self.format, &error)),
        }
    }

    /// Decodes the exact samples of all channels.
    fn decode_samples(self) -> Result<Picture, ImageFileError> {
        let Self { path, bytes, format, .. } = self;
        let decoded = match format.codec {
            Codec::Own(_, decode) => decode(&bytes),
            Codec::Image(codec) => {
                let decoded = reader(&bytes, codec).decode().map_err(|error| error.to_string());
                decoded.and_then(|decoded| standard::of_dynamic(format.name, decoded))
            }
        };
        decoded.map_err(|error| undecodable(&path, format, &error))
    }
}

impl Picture {
    /// Reads a picture file of any supported format. The picture is never empty, and has at most 16 384 pixels per side
    /// and 8192 × 8192 in total. Reading takes less than a gigabyte of memory.
    pub fn read(path: &Path) -> Result<Self, ImageFileError> {
        PictureFile::read_header(path)?.decode_samples()
    }
}

fn undecodable(path: &Path, format: &Format, reason: &str) -> ImageFileError {
    ImageFileError::Undecodable { path: path.to_owned(), kind: format.name, reason: text::message(reason) }
}

/// Returns whether a path has the extension of a known image format, supported or not.
pub fn is_named_picture(path: &Path) -> bool {
    formats::ALL.iter().any(|format| format.has_suffix_of(path))
        || path.extension().and_then(ImageFormat::from_extension).is_some()
}

/// Returns the likely content of a file that is in no supported format.
fn hint(bytes: &[u8]) -> String {
    match image::guess_format(bytes) {
        Ok(other) => format!("it looks like {other:?}"),
        Err(_) if bytes.is_empty() => "it is empty".to_owned(),
        Err(_) if bytes.iter().all(|b| b.is_ascii_graphic() || b.is_ascii_whitespace()) => {
            "it looks like text".to_owned()
        }
        Err(_) => "its format is unknown".to_owned(),
    }
}

fn to_rgba(decoded: DynamicImage) -> Image<Rgba8> {
    let rgba = decoded.into_rgba8();
    let (width, height) = rgba.dimensions();
    let pixels = rgba.into_raw().chunks_exact(4).map(|p| [p[0], p[1], p[2], p[3]]).collect();
    Image::from_pixels(width, height, pixels)
}

/// Writes an image as PNG: RGB if every pixel is opaque, otherwise RGBA. Replaces an existing file, but creates no
/// folders.
///
/// # Examples
/// ```
/// use rasterscope_engine::image::Image;
/// use rasterscope_engine::image::file::{encode_png, read, write_png};
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("gradient.png");
/// let image = Image::from_fn(64, 36, |x, y| [x as u8, y as u8, 0, 255]);
/// write_png(&path, &image)?;
///
/// assert_eq!(read(&path)?, image);
/// assert_eq!(std::fs::read(&path)?, encode_png(&image)?);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_png(path: &Path, image: &Image<Rgba8>) -> Result<(), ImageFileError> {
    encode_png(image)
        .and_then(|bytes| disk::write(path, &bytes))
        .map_err(|source| ImageFileError::Unwritable { path: path.to_owned(), source })
}

/// Encodes an image as the bytes of a PNG file: RGB if every pixel is opaque, otherwise RGBA. Fails if the image has no
/// pixels.
pub fn encode_png(image: &Image<Rgba8>) -> std::io::Result<Vec<u8>> {
    let (width, height) = image.size();
    let mut file = Vec::new();
    let encoder = PngEncoder::new(&mut file);
    let written = if image.pixels().iter().all(|p| p[3] == 255) {
        let rgb: Vec<u8> = image.pixels().iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect();
        encoder.write_image(&rgb, width, height, ExtendedColorType::Rgb8)
    } else {
        encoder.write_image(image.as_bytes(), width, height, ExtendedColorType::Rgba8)
    };
    written.map(|()| file).map_err(std::io::Error::other)
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;

    fn picture(alpha: u8) -> Image<Rgba8> {
        Image::from_fn(5, 3, |x, y| [x as u8 * 50, y as u8 * 100, 7, if x == 2 { alpha } else { 255 }])
    }

    fn written(name: &str, bytes: &[u8]) -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        (folder, path)
    }

    #[test]
    fn a_written_picture_reads_back_unchanged() {
        for alpha in [255, 0] {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("picture.png");
            write_png(&path, &picture(alpha)).unwrap();
            assert_eq!(read(&path).unwrap(), picture(alpha));
        }
    }

    #[test]
    fn opaque_pictures_are_written_without_alpha() {
        const COLOR_TYPE_OFFSET: usize = 25;
        assert_eq!(encode_png(&picture(255)).unwrap()[COLOR_TYPE_OFFSET], 2, "RGB");
        assert_eq!(encode_png(&picture(0)).unwrap()[COLOR_TYPE_OFFSET], 6, "RGBA");
    }

    #[test]
    fn the_content_counts_and_not_the_name() {
        let (_folder, path) = written("picture.jpg", &encode_png(&picture(255)).unwrap());
        assert_eq!(read(&path).unwrap(), picture(255));
    }

    #[test]
    fn every_format_without_loss_reads_as_the_same_picture() {
        let rgb: Vec<u8> = picture(255).pixels().iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect();
        let rgb = image::RgbImage::from_raw(5, 3, rgb).unwrap();
        for (name, format) in [
            ("picture.png", ImageFormat::Png),
            ("picture.bmp", ImageFormat::Bmp),
            ("picture.tga", ImageFormat::Tga),
            ("picture.tiff", ImageFormat::Tiff),
        ] {
            let mut bytes = Cursor::new(Vec::new());
            rgb.write_to(&mut bytes, format).unwrap();
            let (_folder, path) = written(name, bytes.get_ref());
            assert_eq!(read(&path).unwrap(), picture(255), "{name}");
        }
    }

    #[test]
    fn other_content_is_named() {
        for (bytes, hint) in [
            (b"RIFF\x10\0\0\0WEBPVP8 ".as_slice(), "it looks like WebP"),
            (b"".as_slice(), "it is empty"),
            (b"newmtl red\nKd 1 0 0\n".as_slice(), "it looks like text"),
        ] {
            let (_folder, path) = written("picture.png", bytes);
            let message = read(&path).unwrap_err().to_string();
            assert!(message.contains("picture.png") && message.ends_with(hint), "{message}");
        }
    }

    #[test]
    fn a_header_that_asks_for_too_much_is_refused_before_decoding() {
        let mut bmp = b"BM\x3a\0\0\0\0\0\0\0\x36\0\0\0\x28\0\0\0".to_vec();
        bmp.extend(20_000_i32.to_le_bytes());
        bmp.extend(20_000_i32.to_le_bytes());
        bmp.extend(b"\x01\0\x18\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0");
        let (_folder, path) = written("huge.bmp", &bmp);
        assert!(matches!(read(&path), Err(ImageFileError::TooManyPixels { width: 20_000, height: 20_000, .. })));
    }

    #[test]
    fn a_picture_cut_anywhere_is_an_error_or_a_picture_but_no_panic() {
        let whole = encode_png(&picture(0)).unwrap();
        for end in 0..whole.len() {
            let (_folder, path) = written("cut.png", &whole[..end]);
            let _ = read(&path).map_err(|e| assert!(e.to_string().contains("cut.png")));
        }
    }
}
