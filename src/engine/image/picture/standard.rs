//! Exact samples of pictures that the crates `image` and `tiff` decode.

use std::io::Cursor;

use image::{DynamicImage, GenericImageView as _, ImageFormat};
use tiff::ColorType;
use tiff::decoder::{Decoder, DecodingResult, Limits};

use super::{Channel, DataWindow, Picture, Samples};
use crate::image::decoder::{MAX_DECODER_BYTES, reader};

/// Converts a decoded image to a picture of the format named `format`.
///
/// # Errors
/// Returns an error for a type of samples that no supported format has.
pub(in crate::image) fn of_dynamic(format: &'static str, decoded: DynamicImage) -> Result<Picture, String> {
    let size = decoded.dimensions();
    let channels = usize::from(decoded.color().channel_count());
    let samples = match decoded {
        DynamicImage::ImageLuma8(image) => planes(&image, channels, Samples::U8),
        DynamicImage::ImageLumaA8(image) => planes(&image, channels, Samples::U8),
        DynamicImage::ImageRgb8(image) => planes(&image, channels, Samples::U8),
        DynamicImage::ImageRgba8(image) => planes(&image, channels, Samples::U8),
        DynamicImage::ImageLuma16(image) => planes(&image, channels, Samples::U16),
        DynamicImage::ImageLumaA16(image) => planes(&image, channels, Samples::U16),
        DynamicImage::ImageRgb16(image) => planes(&image, channels, Samples::U16),
        DynamicImage::ImageRgba16(image) => planes(&image, channels, Samples::U16),
        DynamicImage::ImageRgb32F(image) => planes(&image, channels, Samples::F32),
        DynamicImage::ImageRgba32F(image) => planes(&image, channels, Samples::F32),
        other => return Err(format!("samples of the type {:?} are not supported", other.color())),
    };
    Ok(of_planes(format, size, samples))
}

/// Returns the width and height of the first picture of a TIFF file, in pixels.
pub(super) fn tiff_size(bytes: &[u8]) -> Result<(u32, u32), String> {
    Decoder::new(Cursor::new(bytes)).and_then(|mut decoder| decoder.dimensions()).map_err(|error| error.to_string())
}

/// Decodes the first picture of a TIFF file. The crate `image` reads the colours of 8 and 16 bits; floats and 32-bit
/// integers, which it does not read or reads with a loss, are read here.
pub(super) fn decode_tiff(bytes: &[u8]) -> Result<Picture, String> {
    if let Some(wide) = wide_tiff(bytes) {
        return wide;
    }
    let decoded = reader(bytes, ImageFormat::Tiff).decode().map_err(|error| error.to_string())?;
    of_dynamic("TIFF", decoded)
}

/// Decodes floats and 32-bit integers. Returns `None` for all other TIFF files.
fn wide_tiff(bytes: &[u8]) -> Option<Result<Picture, String>> {
    let mut limits = Limits::default();
    let max_bytes = MAX_DECODER_BYTES as usize;
    (limits.decoding_buffer_size, limits.intermediate_buffer_size) = (max_bytes, max_bytes);
    let mut decoder = Decoder::new(Cursor::new(bytes)).ok()?.with_limits(limits);
    let kind = decoder.colortype().ok()?;
    let is_wide = kind.bit_depth() >= 32 || kind.bit_depth() == 16 && is_float(&mut decoder);
    let count = match kind {
        ColorType::Gray(_) => 1,
        ColorType::GrayA(_) => 2,
        ColorType::RGB(_) => 3,
        ColorType::RGBA(_) => 4,
        _ => return None,
    };
    is_wide.then(|| {
        let size = decoder.dimensions().map_err(|error| error.to_string())?;
        let decoded = decoder.read_image().map_err(|error| error.to_string())?;
        let expected = size.0 as usize * size.1 as usize * count;
        let samples = match decoded {
            DecodingResult::F16(values) if values.len() == expected => planes(&values, count, Samples::F16),
            DecodingResult::F32(values) if values.len() == expected => planes(&values, count, Samples::F32),
            DecodingResult::U32(values) if values.len() == expected && count == 1 => planes(&values, 1, Samples::U32),
            _ => return Err("its type of samples is not supported".to_owned()),
        };
        Ok(of_planes("TIFF", size, samples))
    })
}

fn is_float(decoder: &mut Decoder<Cursor<&[u8]>>) -> bool {
    /// Value of the tag `SampleFormat` for floats.
    const FLOAT: u16 = 3;
    let formats = decoder.find_tag_unsigned_vec::<u16>(tiff::tags::Tag::SampleFormat);
    formats.is_ok_and(|formats| formats.is_some_and(|formats| formats.first() == Some(&FLOAT)))
}

/// Separates interleaved samples into one list per channel.
fn planes<T: Copy>(interleaved: &[T], channels: usize, wrap: fn(Vec<T>) -> Samples) -> Vec<Samples> {
    (0..channels).map(|channel| wrap(interleaved.iter().skip(channel).step_by(channels).copied().collect())).collect()
}

/// Returns a picture of grey, grey and alpha, colour, or colour and alpha, according to the number of channels.
pub(in crate::image) fn of_planes(format: &'static str, (width, height): (u32, u32), planes: Vec<Samples>) -> Picture {
    let names: &[&str] = match planes.len() {
        1 if matches!(planes[0], Samples::U32(_)) => &["id"],
        1 => &["Y"],
        2 => &["Y", "A"],
        3 => &["R", "G", "B"],
        _ => &["R", "G", "B", "A"],
    };
    let window = DataWindow { left: 0, top: 0, width, height };
    let channels = names.iter().zip(planes).map(|(name, samples)| Channel::new((*name).to_owned(), samples, window));
    Picture::new(format, (width, height), channels.collect())
}
