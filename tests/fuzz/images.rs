//! Fuzz target: damaged picture files of every format.

use std::io::Cursor;
use std::path::Path;

use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, ImageAttributes, IntegerBounds, Layer,
    LayerAttributes, LineOrder, SmallVec, Text, Vec2, WritableImage as _, f16,
};
use fastrand::Rng;
use image::{DynamicImage, ImageFormat};
use rasterscope::image::pfm::Floats;
use rasterscope::image::picture::Picture;
use rasterscope::image::{Image, file};

use crate::fuzz::driver::{Failure, Target};
use crate::fuzz::input::Input;
use crate::fuzz::{mutate, seeds};

/// Largest width and height of a generated picture, in pixels.
const MOST_SIDE: u32 = 24;

/// Encoder of a generated picture.
#[derive(Clone, Copy)]
enum Encoder {
    /// Encoder of the crate `image`.
    Image(ImageFormat),
    /// OpenEXR.
    Exr,
    /// PFM.
    Pfm,
}

/// Picture formats, each with its suffix and the byte offsets of width and height in its header, if these are fixed.
const FORMATS: [(Encoder, &str, &[usize]); 9] = [
    (Encoder::Image(ImageFormat::Png), "png", &[16, 20]),
    (Encoder::Image(ImageFormat::Jpeg), "jpg", &[]),
    (Encoder::Image(ImageFormat::Bmp), "bmp", &[18, 22]),
    (Encoder::Image(ImageFormat::Tga), "tga", &[12, 14]),
    (Encoder::Image(ImageFormat::Gif), "gif", &[6, 8]),
    (Encoder::Image(ImageFormat::Tiff), "tiff", &[]),
    (Encoder::Image(ImageFormat::Hdr), "hdr", &[]),
    (Encoder::Exr, "exr", &[]),
    (Encoder::Pfm, "pfm", &[]),
];

/// Fuzz target that reads damaged picture files.
pub(crate) struct Images;

impl Target for Images {
    fn name(&self) -> &'static str {
        "images"
    }

    fn generate(&self, rng: &mut Rng) -> Input {
        let (name, mut bytes) = match seeds::files("images", seeds::is_picture) {
            [] => picture(rng),
            _ if rng.u8(..3) > 0 => picture(rng),
            saved => mutate::pick(rng, saved).clone(),
        };
        damage(rng, &name, &mut bytes);
        Input::file(&name, bytes)
    }

    fn run(&self, folder: &Path) -> Result<(), Failure> {
        for name in Input::read(folder).map_err(|error| Failure::Wrong(error.to_string()))?.0.keys() {
            check(&folder.join(name), name)?;
        }
        Ok(())
    }
}

/// Checks that reading a picture, as a texture and with its exact samples, gives a valid size, or an error of one line
/// that names the file.
fn check(path: &Path, name: &str) -> Result<(), Failure> {
    let texture = file::read(path);
    let exact = Picture::read(path);
    for size in [texture.as_ref().ok().map(Image::size), exact.as_ref().ok().map(Picture::size)] {
        if size.is_some_and(|(width, height)| width == 0 || height == 0) {
            return Err(Failure::Wrong(format!("size: {size:?}")));
        }
    }
    if let Ok(picture) = &exact {
        let layers: usize = picture.layers().iter().map(|layer| picture.channels_of(layer).count()).sum();
        if layers != picture.channels().len() {
            return Err(Failure::Wrong(format!("layers: {layers} of {} channels", picture.channels().len())));
        }
    }
    for error in [texture.err(), exact.err()].into_iter().flatten() {
        check_message(&error.to_string(), name)?;
    }
    Ok(())
}

/// Checks that a message is one short line that contains `name`.
pub(crate) fn check_message(message: &str, name: &str) -> Result<(), Failure> {
    /// Length of the longest message, in characters.
    const LONGEST: usize = 1000;
    let is_one_line = !message.contains(char::is_control) && message.chars().count() <= LONGEST;
    if !is_one_line {
        Err(Failure::Wrong(format!("message is not one line: {message:?}")))
    } else if !message.contains(name) {
        Err(Failure::Wrong(format!("message names no file: {message:?} without {name}")))
    } else {
        Ok(())
    }
}

/// Returns a valid picture file of random size, colours and format, and its name.
pub(crate) fn picture(rng: &mut Rng) -> (String, Vec<u8>) {
    let (width, height) = (rng.u32(1..=MOST_SIDE), rng.u32(1..=MOST_SIDE));
    let (encoder, suffix, _) = *mutate::pick(rng, &FORMATS);
    let name = format!("picture.{suffix}");
    let format = match encoder {
        Encoder::Image(format) => format,
        Encoder::Exr => return (name, exr(rng, width, height)),
        Encoder::Pfm if rng.bool() => {
            return (name, Floats::One(Image::from_fn(width, height, |_, _| rng.f32())).encode());
        }
        Encoder::Pfm => {
            let floats = Image::from_fn(width, height, |_, _| [rng.f32(), f32::from_bits(rng.u32(..)), 1.0]);
            return (name, Floats::Three(floats).encode());
        }
    };
    let mut rgba = image::RgbaImage::new(width, height);
    for pixel in rgba.pixels_mut() {
        *pixel = image::Rgba([rng.u8(..), rng.u8(..), rng.u8(..), *mutate::pick(rng, &[255, 255, 0, 128])]);
    }
    let rgba = DynamicImage::ImageRgba8(rgba);
    let mut file = Cursor::new(Vec::new());
    let kinds: [fn(&DynamicImage) -> DynamicImage; 8] = [
        DynamicImage::clone,
        |image| image.to_rgb8().into(),
        |image| image.to_luma8().into(),
        |image| image.to_luma_alpha8().into(),
        |image| image.to_rgb16().into(),
        |image| image.to_rgba16().into(),
        |image| image.to_rgb32f().into(),
        |image| image.to_rgba32f().into(),
    ];
    // Colours that a format does not support are written as 8-bit colours.
    if mutate::pick(rng, &kinds)(&rgba).write_to(&mut file, format).is_err() {
        file = Cursor::new(Vec::new());
        let plain = match format {
            ImageFormat::Jpeg => rgba.to_rgb8().into(),
            ImageFormat::Hdr => rgba.to_rgb32f().into(),
            _ => rgba,
        };
        plain.write_to(&mut file, format).expect("every format holds these colours");
    }
    (name, file.into_inner())
}

/// Returns an OpenEXR file with one to three layers of random channels, windows and compression.
fn exr(rng: &mut Rng, width: u32, height: u32) -> Vec<u8> {
    let pixels = (width * height) as usize;
    let compressions = [
        Compression::Uncompressed,
        Compression::RLE,
        Compression::ZIP1,
        Compression::ZIP16,
        Compression::PIZ,
        Compression::PXR24,
        Compression::B44,
        Compression::B44A,
        Compression::DWAA(None),
        Compression::DWAB(None),
    ];
    let mut layer = |index: usize| {
        let names = ["R", "G", "B", "A", "Z", "id", "diffuse.R"];
        let channel = |name: &&str, rng: &mut Rng| AnyChannel {
            name: Text::from(*name),
            sample_data: match rng.u8(..3) {
                0 => FlatSamples::F16((0..pixels).map(|_| f16::from_bits(rng.u16(..))).collect()),
                1 => FlatSamples::F32((0..pixels).map(|_| rng.f32()).collect()),
                _ => FlatSamples::U32((0..pixels).map(|_| rng.u32(..)).collect()),
            },
            quantize_linearly: false,
            sampling: Vec2(1, 1),
        };
        let count = rng.usize(1..=names.len());
        let channels: Vec<_> = names[..count].iter().map(|name| channel(name, rng)).collect();
        let encoding = Encoding {
            compression: *mutate::pick(rng, &compressions),
            blocks: *mutate::pick(rng, &[Blocks::ScanLines, Blocks::Tiles(Vec2(8, 8))]),
            line_order: LineOrder::Increasing,
        };
        let position = Vec2(rng.i32(-4..4), rng.i32(-4..4));
        let attributes =
            LayerAttributes { layer_position: position, ..LayerAttributes::named(format!("layer{index}").as_str()) };
        let channels = AnyChannels::sort(SmallVec::from_vec(channels));
        Layer::new((width as usize, height as usize), attributes, encoding, channels)
    };
    let count = *mutate::pick(&mut Rng::with_seed(u64::from(width * height)), &[1, 1, 2, 3]);
    let layers: SmallVec<[_; 2]> = (0..count).map(&mut layer).collect();
    let window = IntegerBounds { position: Vec2(0, 0), size: Vec2(width as usize, height as usize) };
    let mut bytes = Cursor::new(Vec::new());
    let image = exr::prelude::Image::from_layers(ImageAttributes::new(window), layers);
    image.write().non_parallel().to_buffered(&mut bytes).expect("valid layers");
    bytes.into_inner()
}

/// Damages a picture file by changing random bytes or the size in its header. In half of the cases, corrects the
/// checksums of PNG chunks, so that the damage reaches the decoder.
pub(crate) fn damage(rng: &mut Rng, name: &str, bytes: &mut Vec<u8>) {
    if name.ends_with("exr") && rng.u8(..4) > 0 {
        return damage_exr(rng, bytes);
    }
    let sizes = FORMATS.iter().find(|(_, suffix, _)| name.ends_with(suffix)).map_or(&[][..], |(.., sizes)| sizes);
    if !sizes.is_empty() && rng.bool() {
        let stated = *mutate::pick(rng, &[0, 1, 2, 255, 256, 4096, 16_384, 16_385, 65_535, u32::MAX, 1 << 31]);
        let is_big_endian = name.ends_with("png");
        let length = if sizes[1] - sizes[0] == 4 { 4 } else { 2 };
        let stated = if is_big_endian { stated.to_be_bytes() } else { stated.to_le_bytes() };
        let at = *mutate::pick(rng, sizes);
        if let Some(field) = bytes.get_mut(at..at + length) {
            field.copy_from_slice(&stated[..length]);
        }
    } else if rng.u8(..16) > 0 {
        mutate::bytes(rng, bytes);
    }
    if bytes.starts_with(b"\x89PNG") && rng.bool() {
        correct_checksums(bytes);
    }
}

/// Damages an OpenEXR file by changing bytes in place, so that the positions of its blocks stay valid. Half of the changes
/// are in the header.
fn damage_exr(rng: &mut Rng, bytes: &mut [u8]) {
    for _ in 0..rng.usize(1..=4) {
        let end = if rng.bool() { bytes.len() } else { bytes.len().min(512) };
        if let Some(byte) = bytes.get_mut(rng.usize(..end.max(1))) {
            *byte = *mutate::pick(rng, &[0, 1, 2, 3, 0x7F, 0x80, 0xFF, byte.wrapping_add(1), *byte ^ 0x10]);
        }
    }
}

/// Corrects the checksum of every complete chunk of a PNG file.
fn correct_checksums(png: &mut [u8]) {
    let mut at = 8;
    while let Some(length) = png.get(at..at + 4) {
        let length = u32::from_be_bytes([length[0], length[1], length[2], length[3]]) as usize;
        let (Some(content), end) = (png.get(at + 4..at.saturating_add(8 + length)), at.saturating_add(8 + length))
        else {
            return;
        };
        let checksum = crc32(content).to_be_bytes();
        let Some(field) = png.get_mut(end..end + 4) else { return };
        field.copy_from_slice(&checksum);
        at = end + 4;
    }
}

/// Returns the CRC-32 of ISO 3309, as in PNG (W3C, "Portable Network Graphics", annex D).
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| if crc & 1 == 1 { crc >> 1 ^ 0xEDB8_8320 } else { crc >> 1 })
    })
}
