//! Messages between the program and an upscaler process. All numbers are little-endian; there is no padding.
//!
//! The chapter on upscalers in the manual documents the protocol. A change of any message changes [`VERSION`].

use super::failure::ProcessFault;
use super::spec::PixelFormat;
use crate::image::{Image, Rgba8};
use crate::upscale::Lattice;

/// First bytes of the opening message and of its answer.
pub(super) const MAGIC: [u8; 8] = *b"RSUPSCAL";

/// Version of the protocol.
pub(super) const VERSION: u32 = 1;

/// Length of the answer to the opening message, in bytes.
pub(super) const OPENING_ANSWER_BYTES: usize = 12;

/// Length of the header of an answer to a frame, in bytes.
pub(super) const FRAME_ANSWER_BYTES: usize = 12;

/// Returns the opening message: magic bytes, version, pixel format and whether depths follow the colours.
pub(super) fn opening(format: PixelFormat, depth: bool) -> Vec<u8> {
    let format: u32 = match format {
        PixelFormat::Rgba8 => 0,
        PixelFormat::RgbaF32 => 1,
    };
    let mut message = MAGIC.to_vec();
    [VERSION, format, u32::from(depth)].iter().for_each(|number| message.extend(number.to_le_bytes()));
    message
}

/// Checks the answer to the opening message: magic bytes and version.
pub(super) fn check_opening_answer(answer: &[u8]) -> Result<(), ProcessFault> {
    let version = answer.strip_prefix(&MAGIC).and_then(|rest| Some(u32::from_le_bytes(rest.try_into().ok()?)));
    match version {
        Some(VERSION) => Ok(()),
        Some(version) => Err(ProcessFault::Version(version)),
        None => Err(ProcessFault::NoHeader(answer.escape_ascii().to_string())),
    }
}

/// One frame to upscale.
#[derive(Clone, Copy, Debug)]
pub(super) struct FrameMessage<'a> {
    /// Number of the frame, counted from 0 for each process.
    pub(super) number: u32,
    /// Drawn samples.
    pub(super) color: &'a Image<Rgba8>,
    /// Distance of each sample along the view axis, row by row; `None` if the process reads no depths.
    pub(super) depth: Option<&'a [f32]>,
    /// Positions of the samples in the full picture.
    pub(super) lattice: Lattice,
    /// Width and height of the full picture, in pixels.
    pub(super) size: (u32, u32),
}

impl FrameMessage<'_> {
    /// Returns the message: the header, the colours and the depths, row by row.
    pub(super) fn encode(&self, format: PixelFormat) -> Vec<u8> {
        let (columns, rows) = self.color.size();
        let payload = self.color.pixels().len() * format.pixel_bytes() + self.depth.map_or(0, size_of_val);
        let mut message = Vec::with_capacity(payload + 36);
        let numbers = [self.number, columns, rows, self.size.0, self.size.1];
        numbers.iter().for_each(|number| message.extend(number.to_le_bytes()));
        let positions = [self.lattice.scale.value(), self.lattice.position_px(0)];
        positions.iter().for_each(|number| message.extend((*number as f32).to_le_bytes()));
        message.extend((payload as u64).to_le_bytes());
        match format {
            PixelFormat::Rgba8 => message.extend_from_slice(self.color.pixels().as_flattened()),
            PixelFormat::RgbaF32 => {
                let codes = self.color.pixels().as_flattened();
                codes.iter().for_each(|code| message.extend((f32::from(*code) / 255.0).to_le_bytes()));
            }
        }
        let depths = self.depth.unwrap_or_default();
        depths.iter().for_each(|depth| message.extend(depth.to_le_bytes()));
        message
    }
}

/// Checks the header of an answer: the number of the frame, and the size of the picture in pixels.
pub(super) fn check_frame_answer(answer: &[u8], frame: &FrameMessage<'_>) -> Result<(), ProcessFault> {
    let number = |place: usize| {
        answer.get(4 * place..4 * place + 4).and_then(|bytes| bytes.try_into().ok()).map_or(0, u32::from_le_bytes)
    };
    if number(0) != frame.number {
        return Err(ProcessFault::OutOfStep { expected: frame.number, found: number(0) });
    }
    let found = (number(1), number(2));
    if found != frame.size {
        return Err(ProcessFault::WrongSize { expected: frame.size, found });
    }
    Ok(())
}

/// Writes the pixels of an answer to `full`. Values of the format `f32` must lie in [0, 1].
pub(super) fn decode(pixels: &[u8], format: PixelFormat, full: &mut Image<Rgba8>) -> Result<(), ProcessFault> {
    let width = full.width() as usize;
    let codes = full.pixels_mut().as_flattened_mut();
    match format {
        PixelFormat::Rgba8 => codes.copy_from_slice(pixels),
        PixelFormat::RgbaF32 => {
            let (values, _) = pixels.as_chunks::<4>();
            for (place, (code, value)) in codes.iter_mut().zip(values).enumerate() {
                let value = f32::from_le_bytes(*value);
                if !(0.0..=1.0).contains(&value) {
                    let (pixel, channel) = (place / 4, place % 4);
                    let at = (pixel % width, pixel / width);
                    return Err(ProcessFault::BadValue {
                        at,
                        channel: ["red", "green", "blue", "alpha"][channel],
                        value,
                    });
                }
                *code = (value * 255.0).round() as u8;
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::upscale::{Anchor, Scale};

    const LATTICE: Lattice = Lattice { scale: Scale::TWO, anchor: Anchor::Centre };

    #[test]
    fn messages_have_the_documented_bytes() {
        assert_eq!(opening(PixelFormat::RgbaF32, true), b"RSUPSCAL\x01\0\0\0\x01\0\0\0\x01\0\0\0");
        let color = Image::from_pixels(1, 1, vec![[1, 2, 3, 255]]);
        let depth = [2.0];
        let frame = FrameMessage { number: 7, color: &color, depth: Some(&depth), lattice: LATTICE, size: (2, 1) };
        let head = b"\x07\0\0\0\x01\0\0\0\x01\0\0\0\x02\0\0\0\x01\0\0\0\0\0\0\x40\0\0\x80\x3f";
        let bytes = [&head[..], b"\x08\0\0\0\0\0\0\0", b"\x01\x02\x03\xff", b"\0\0\0\x40"].concat();
        assert_eq!(frame.encode(PixelFormat::Rgba8), bytes);
        let floats = FrameMessage { depth: None, ..frame }.encode(PixelFormat::RgbaF32);
        assert_eq!((floats.len(), floats[28], &floats[48..]), (36 + 16, 16, &b"\0\0\x80\x3f"[..]));
    }

    #[test]
    fn answers_are_checked() {
        assert_eq!(check_opening_answer(b"RSUPSCAL\x01\0\0\0"), Ok(()));
        assert_eq!(check_opening_answer(b"RSUPSCAL\x02\0\0\0"), Err(ProcessFault::Version(2)));
        assert_eq!(check_opening_answer(b"hello world\n"), Err(ProcessFault::NoHeader("hello world\\n".to_owned())));
        let color = Image::from_pixels(1, 1, vec![[0; 4]]);
        let frame = FrameMessage { number: 1, color: &color, depth: None, lattice: LATTICE, size: (2, 2) };
        let answer = |numbers: [u32; 3]| check_frame_answer(&numbers.map(u32::to_le_bytes).concat(), &frame);
        assert_eq!(answer([1, 2, 2]), Ok(()));
        assert_eq!(answer([1, 2, 3]), Err(ProcessFault::WrongSize { expected: (2, 2), found: (2, 3) }));
        assert_eq!(answer([9, 2, 2]), Err(ProcessFault::OutOfStep { expected: 1, found: 9 }));
    }

    #[test]
    fn colours_survive_both_formats_and_other_values_are_refused() {
        let color = Image::from_fn(16, 16, |x, y| [(16 * y + x) as u8, 0, 128, 255]);
        let frame = FrameMessage { number: 0, color: &color, depth: None, lattice: LATTICE, size: (16, 16) };
        for format in [PixelFormat::Rgba8, PixelFormat::RgbaF32] {
            let mut back = Image::filled(16, 16, [9; 4]);
            decode(&frame.encode(format)[36..], format, &mut back).unwrap();
            assert_eq!(back, color, "{format:?}");
        }
        for bad in [f32::NAN, -0.01, 1.01, f32::INFINITY] {
            let values = [0.0, 0.5, 1.0, 1.0, 0.0, bad, 0.0, 1.0_f32];
            let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
            let fault = decode(&bytes, PixelFormat::RgbaF32, &mut Image::filled(1, 2, [0; 4])).unwrap_err();
            assert!(matches!(fault, ProcessFault::BadValue { at: (0, 1), channel: "green", .. }), "{fault:?}");
        }
    }
}
