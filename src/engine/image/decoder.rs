//! Decoder of untrusted images, and limits on their size and on the memory that decoding takes.

use std::io::Cursor;

use image::{ImageFormat, ImageReader, Limits};

/// Maximum width and height of an image that can be read, in pixels.
pub(super) const MAX_SIDE: u32 = 16_384;

/// Maximum number of pixels of an image that can be read (8192 × 8192). Decoding and converting such an image takes
/// well under a gigabyte of memory.
pub(super) const MAX_PIXELS: u64 = 1 << 26;

/// Maximum number of bytes that an image decoder may allocate.
pub(super) const MAX_DECODER_BYTES: u64 = 256 << 20;

/// Returns an image reader for the bytes of a file, with a limit on the memory that decoding may allocate.
pub(super) fn reader(bytes: &[u8], format: ImageFormat) -> ImageReader<Cursor<&[u8]>> {
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut limits = Limits::default();
    limits.max_image_width = None;
    limits.max_image_height = None;
    limits.max_alloc = Some(MAX_DECODER_BYTES);
    reader.limits(limits);
    reader
}
