//! Decoding of PFM files, whose format [`crate::image::pfm`] describes.

use super::standard::of_planes;
use super::{Picture, Samples};

/// Header of a PFM file.
struct Header {
    /// Number of floats per pixel: 1 or 3.
    channels: usize,
    width: u32,
    height: u32,
    is_little_endian: bool,
    /// Offset of the first sample in the file, in bytes.
    start: usize,
}

impl Header {
    /// Reads four words. A single white space follows the last of them.
    fn read(bytes: &[u8]) -> Result<Self, String> {
        let mut at = 0;
        let mut word = || {
            at += bytes[at..].iter().take_while(|byte| byte.is_ascii_whitespace()).count();
            let length = bytes[at..].iter().take_while(|byte| !byte.is_ascii_whitespace()).count();
            let word = std::str::from_utf8(&bytes[at..at + length]).unwrap_or_default();
            at += length;
            word
        };
        let channels = if word() == "PF" { 3 } else { 1 };
        let mut side = || word().parse().map_err(|_| "its width or height is not a number".to_owned());
        let (width, height) = (side()?, side()?);
        let scale: f32 = word().parse().map_err(|_| "its scale is not a number".to_owned())?;
        if scale == 0.0 || !scale.is_finite() {
            return Err("its scale must be a finite number other than 0".to_owned());
        }
        Ok(Self { channels, width, height, is_little_endian: scale < 0.0, start: at + 1 })
    }
}

/// Returns the width and height of a PFM file in pixels.
pub(super) fn size(bytes: &[u8]) -> Result<(u32, u32), String> {
    Header::read(bytes).map(|Header { width, height, .. }| (width, height))
}

/// Decodes a PFM file. The scale only gives the byte order; samples are not multiplied by it.
pub(in crate::image) fn decode(bytes: &[u8]) -> Result<Picture, String> {
    let Header { channels, width, height, is_little_endian, start } = Header::read(bytes)?;
    let row = width as usize * channels;
    let (words, _) = bytes.get(start..).unwrap_or_default().as_chunks::<4>();
    if words.len() < row * height as usize {
        return Err("it ends before its last sample".to_owned());
    }
    let float = |word: &[u8; 4]| if is_little_endian { f32::from_le_bytes(*word) } else { f32::from_be_bytes(*word) };
    let plane = |channel: usize| {
        let rows = words[..row * height as usize].chunks_exact(row).rev();
        Samples::F32(rows.flat_map(|row| row.iter().skip(channel).step_by(channels).map(float)).collect())
    };
    Ok(of_planes("PFM", (width, height), (0..channels).map(plane).collect()))
}
