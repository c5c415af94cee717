//! Fuzz target: damaged picture files of every format.

use std::io::Cursor;
use std::path::Path;

use fastrand::Rng;
use image::{DynamicImage, ImageFormat};
use rasterscope::image::file;

use crate::fuzz::driver::{Failure, Target};
use crate::fuzz::input::Input;
use crate::fuzz::{mutate, seeds};

/// Largest width and height of a generated picture, in pixels.
const MOST_SIDE: u32 = 24;

/// Picture formats, each with its suffix and the byte offsets of width and height in its header, if these are fixed.
const FORMATS: [(ImageFormat, &str, &[usize]); 6] = [
    (ImageFormat::Png, "png", &[16, 20]),
    (ImageFormat::Jpeg, "jpg", &[]),
    (ImageFormat::Bmp, "bmp", &[18, 22]),
    (ImageFormat::Tga, "tga", &[12, 14]),
    (ImageFormat::Gif, "gif", &[6, 8]),
    (ImageFormat::Tiff, "tiff", &[]),
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

/// Checks that reading a picture gives a valid size, or an error of one line that names the file.
fn check(path: &Path, name: &str) -> Result<(), Failure> {
    match file::read(path) {
        Ok(picture) => {
            let (width, height) = picture.size();
            let is_sound = width > 0 && height > 0 && picture.pixels().len() == (width * height) as usize;
            if is_sound { Ok(()) } else { Err(Failure::Wrong(format!("size: {width} × {height}"))) }
        }
        Err(error) => check_message(&error.to_string(), name),
    }
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
    let (format, suffix, _) = *mutate::pick(rng, &FORMATS);
    let mut rgba = image::RgbaImage::new(width, height);
    for pixel in rgba.pixels_mut() {
        *pixel = image::Rgba([rng.u8(..), rng.u8(..), rng.u8(..), *mutate::pick(rng, &[255, 255, 0, 128])]);
    }
    let rgba = DynamicImage::ImageRgba8(rgba);
    let mut file = Cursor::new(Vec::new());
    let kinds: [fn(&DynamicImage) -> DynamicImage; 6] = [
        DynamicImage::clone,
        |image| image.to_rgb8().into(),
        |image| image.to_luma8().into(),
        |image| image.to_luma_alpha8().into(),
        |image| image.to_rgb16().into(),
        |image| image.to_rgba16().into(),
    ];
    // Colours that a format does not support are written as 8-bit colours.
    if mutate::pick(rng, &kinds)(&rgba).write_to(&mut file, format).is_err() {
        file = Cursor::new(Vec::new());
        let plain = if format == ImageFormat::Jpeg { rgba.to_rgb8().into() } else { rgba };
        plain.write_to(&mut file, format).expect("every format holds 8-bit colours");
    }
    (format!("picture.{suffix}"), file.into_inner())
}

/// Damages a picture file by changing random bytes or the size in its header. In half of the cases, corrects the
/// checksums of PNG chunks, so that the damage reaches the decoder.
pub(crate) fn damage(rng: &mut Rng, name: &str, bytes: &mut Vec<u8>) {
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
