//! Writes drawings to files, in the format given by the file name extension.

use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::time::Duration;

use image::codecs::gif::{GifEncoder, Repeat};
use image::{Delay, Frame, ImageFormat, RgbImage, RgbaImage};
use thiserror::Error;

use super::{Drawing, bitmap, pdf, svg};
use crate::image::{Image, Rgba8};
use crate::{disk, text};

/// File format of a drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DrawingFormat {
    /// SVG: drawing commands as text.
    Svg,
    /// PDF: drawing commands on one page.
    Pdf,
    /// Bitmap in one of the pixel formats.
    Pixels(PixelFormat),
}

/// File format of a bitmap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PixelFormat {
    /// PNG: lossless, compressed.
    Png,
    /// BMP: lossless, uncompressed.
    Bmp,
    /// JPEG: lossy, made for photographs.
    Jpeg,
    /// GIF: at most 256 colours; may hold an animation.
    Gif,
    /// TIFF: lossless, common for scanners and printers.
    Tiff,
}

/// File name extensions in lower case, each with its format.
pub const EXTENSIONS: [(&str, DrawingFormat); 9] = [
    ("svg", DrawingFormat::Svg),
    ("pdf", DrawingFormat::Pdf),
    ("png", DrawingFormat::Pixels(PixelFormat::Png)),
    ("bmp", DrawingFormat::Pixels(PixelFormat::Bmp)),
    ("jpg", DrawingFormat::Pixels(PixelFormat::Jpeg)),
    ("jpeg", DrawingFormat::Pixels(PixelFormat::Jpeg)),
    ("gif", DrawingFormat::Pixels(PixelFormat::Gif)),
    ("tif", DrawingFormat::Pixels(PixelFormat::Tiff)),
    ("tiff", DrawingFormat::Pixels(PixelFormat::Tiff)),
];

/// Error from writing a drawing to a file.
#[derive(Debug, Error)]
pub enum DrawingFileError {
    /// The file name has no known extension.
    #[error("{}: the name must end in one of {}", path.display(), EXTENSIONS.map(|(end, _)| end).join(", "))]
    UnknownFormat {
        /// Path of the file.
        path: PathBuf,
    },
    /// The bitmap cannot be encoded in this format.
    #[error("{}: {reason}", path.display())]
    Unencodable {
        /// Path of the file.
        path: PathBuf,
        /// Error message of the encoder.
        reason: String,
    },
    /// The file cannot be written.
    #[error("{}: cannot write it: {source}", path.display())]
    Unwritable {
        /// Path of the file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
}

/// Returns the format given by the extension of a file name.
pub fn format_of(path: &Path) -> Result<DrawingFormat, DrawingFileError> {
    let end = path.extension().map(|end| end.to_string_lossy().to_lowercase()).unwrap_or_default();
    let known = EXTENSIONS.iter().find(|(known, _)| *known == end);
    known.map(|(_, format)| *format).ok_or_else(|| DrawingFileError::UnknownFormat { path: path.to_owned() })
}

/// Writes a drawing to a file, in the format given by the file name extension. One unit of the drawing becomes `scale`
/// pixels or, in a PDF, `scale` points.
///
/// # Examples
/// ```
/// use glam::DVec2;
/// use rasterscope_engine::drawing::Drawing;
/// use rasterscope_engine::drawing::file::write;
///
/// let mut drawing = Drawing { size: DVec2::new(64.0, 36.0), background: [255; 3], shapes: Vec::new() };
/// drawing.square(8.0, 8.0, 16.0, [200, 30, 30]);
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("square.svg");
/// write(&path, &drawing, 1.0)?;
/// let svg = std::fs::read_to_string(&path)?;
/// assert!(svg.contains("<polygon") && svg.contains("#c81e1e"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write(path: &Path, drawing: &Drawing, scale: f64) -> Result<(), DrawingFileError> {
    save(path, &encode(path, drawing, scale)?)
}

/// Returns the bytes of the file that [`write()`] would write to `path`.
pub fn encode(path: &Path, drawing: &Drawing, scale: f64) -> Result<Vec<u8>, DrawingFileError> {
    Ok(match format_of(path)? {
        DrawingFormat::Svg => svg::text(drawing, scale).into_bytes(),
        DrawingFormat::Pdf => pdf::bytes(drawing, scale),
        DrawingFormat::Pixels(format) => encoded(path, &bitmap::bitmap(drawing, scale), format)?,
    })
}

/// Encodes drawings as the frames of a looping GIF. Each frame is shown for the duration `each`. `path` appears only in
/// error messages.
pub(crate) fn encode_animation(
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

/// Writes the encoded bytes of a drawing to a file.
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
