//! Drawings and pictures in files of many formats, which is told by the name of the file.

use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::time::Duration;

use image::codecs::gif::{GifEncoder, Repeat};
use image::{Delay, Frame, ImageFormat, RgbImage, RgbaImage};
use thiserror::Error;

use super::{Drawing, bitmap, pdf, svg};
use crate::image::{Image, Rgba8};
use crate::{disk, text};

/// What a file holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Drawing commands as text.
    Svg,
    /// Drawing commands on a page.
    Pdf,
    /// Pixels.
    Pixels(PixelFormat),
}

/// How pixels are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PixelFormat {
    /// Without loss, compressed.
    Png,
    /// Without loss, plain.
    Bmp,
    /// With loss: made for photographs.
    Jpeg,
    /// At most 256 colours; may hold several pictures one after the other.
    Gif,
    /// Without loss, as scanners and printers use it.
    Tiff,
}

/// The ends of file names, and what they stand for.
pub const EXTENSIONS: [(&str, Format); 9] = [
    ("svg", Format::Svg),
    ("pdf", Format::Pdf),
    ("png", Format::Pixels(PixelFormat::Png)),
    ("bmp", Format::Pixels(PixelFormat::Bmp)),
    ("jpg", Format::Pixels(PixelFormat::Jpeg)),
    ("jpeg", Format::Pixels(PixelFormat::Jpeg)),
    ("gif", Format::Pixels(PixelFormat::Gif)),
    ("tif", Format::Pixels(PixelFormat::Tiff)),
    ("tiff", Format::Pixels(PixelFormat::Tiff)),
];

/// Why a drawing was not written.
#[derive(Debug, Error)]
pub enum DrawingFileError {
    /// The name ends in nothing that is known.
    #[error("{}: the name must end in one of {}", path.display(), EXTENSIONS.map(|(end, _)| end).join(", "))]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// The pixels cannot be kept in this format.
    #[error("{}: {reason}", path.display())]
    Unencodable {
        /// The file.
        path: PathBuf,
        /// What the encoder said.
        reason: String,
    },
    /// The file cannot be written.
    #[error("{}: cannot write it: {source}", path.display())]
    Unwritable {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
}

/// The format that the name of a file asks for.
pub fn format_of(path: &Path) -> Result<Format, DrawingFileError> {
    let end = path.extension().map(|end| end.to_string_lossy().to_lowercase()).unwrap_or_default();
    let known = EXTENSIONS.iter().find(|(known, _)| *known == end);
    known.map(|(_, format)| *format).ok_or_else(|| DrawingFileError::UnknownFormat { path: path.to_owned() })
}

/// Writes a drawing with `scale` pixels, or points of a page, per unit, in the format that the name asks for.
pub fn write(path: &Path, drawing: &Drawing, scale: f64) -> Result<(), DrawingFileError> {
    save(path, &encode(path, drawing, scale)?)
}

/// Returns the bytes of the file that [`write`] would write to `path`.
pub fn encode(path: &Path, drawing: &Drawing, scale: f64) -> Result<Vec<u8>, DrawingFileError> {
    Ok(match format_of(path)? {
        Format::Svg => svg::text(drawing, scale).into_bytes(),
        Format::Pdf => pdf::bytes(drawing, scale),
        Format::Pixels(format) => encoded(path, &bitmap::bitmap(drawing, scale), format)?,
    })
}

/// Returns the bytes of a GIF that shows the drawings one after the other in a loop, each for the duration `each`. Errors
/// name `path`.
pub fn encode_animation(
    path: &Path,
    drawings: impl Iterator<Item = Drawing>,
    scale: f64,
    each: Duration,
) -> Result<Vec<u8>, DrawingFileError> {
    let unencodable = |error: image::ImageError| DrawingFileError::Unencodable {
        path: path.to_owned(),
        reason: text::message(&error.to_string()),
    };
    let mut bytes = Vec::new();
    let mut encoder = GifEncoder::new(&mut bytes);
    encoder.set_repeat(Repeat::Infinite).map_err(unencodable)?;
    for drawing in drawings {
        let image = bitmap::bitmap(&drawing, scale);
        let frame = Frame::from_parts(rgba(&image), 0, 0, Delay::from_saturating_duration(each));
        encoder.encode_frame(frame).map_err(unencodable)?;
    }
    drop(encoder);
    Ok(bytes)
}

/// Writes the bytes of a drawing.
pub fn save(path: &Path, bytes: &[u8]) -> Result<(), DrawingFileError> {
    disk::write(path, bytes).map_err(|source| DrawingFileError::Unwritable { path: path.to_owned(), source })
}

fn encoded(path: &Path, image: &Image<Rgba8>, format: PixelFormat) -> Result<Vec<u8>, DrawingFileError> {
    let format = match format {
        PixelFormat::Png => ImageFormat::Png,
        PixelFormat::Bmp => ImageFormat::Bmp,
        PixelFormat::Jpeg => ImageFormat::Jpeg,
        PixelFormat::Gif => ImageFormat::Gif,
        PixelFormat::Tiff => ImageFormat::Tiff,
    };
    let mut bytes = Cursor::new(Vec::new());
    // JPEG has no alpha, and drawings need none.
    let written = if format == ImageFormat::Gif {
        rgba(image).write_to(&mut bytes, format)
    } else {
        let colors = image.pixels().iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect();
        let rgb = RgbImage::from_raw(image.width(), image.height(), colors).unwrap_or_default();
        rgb.write_to(&mut bytes, format)
    };
    let unencodable = |error: image::ImageError| DrawingFileError::Unencodable {
        path: path.to_owned(),
        reason: text::message(&error.to_string()),
    };
    written.map(|()| bytes.into_inner()).map_err(unencodable)
}

fn rgba(image: &Image<Rgba8>) -> RgbaImage {
    RgbaImage::from_raw(image.width(), image.height(), image.as_bytes().to_vec()).unwrap_or_default()
}
