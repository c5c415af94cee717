//! Encoders of animations: GIF and APNG.

use std::io;
use std::mem;

use image::codecs::gif::{GifEncoder, Repeat};
use image::{Delay, RgbaImage};

use super::{AnimationFormat, AnimationPlan};
use crate::image::{Image, Rgba8};

/// Speed of the choice of colours of a GIF from 1 (best colours) to 30.
const GIF_SPEED: i32 = 10;

/// Encoder of the frames of one animation.
pub(super) enum Encoder {
    Gif(Gif),
    Apng(Box<png::Writer<Shared>>, Shared),
}

/// GIF that is being written.
pub(super) struct Gif {
    encoder: GifEncoder<Shared>,
    bytes: Shared,
    delay: Delay,
}

/// Bytes that an encoder writes, and that are taken from it at the end.
#[derive(Clone, Default)]
pub(super) struct Shared(std::rc::Rc<std::cell::RefCell<Vec<u8>>>);

impl io::Write for Shared {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.borrow_mut().extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Encoder {
    /// Writes the header of an animation with frames of a size in pixels.
    pub(super) fn new(plan: &AnimationPlan, (width, height): (u32, u32)) -> io::Result<Self> {
        let (bytes, rate) = (Shared::default(), plan.shot.frames_per_second);
        match plan.format {
            AnimationFormat::Gif => {
                let mut encoder = GifEncoder::new_with_speed(bytes.clone(), GIF_SPEED);
                encoder.set_repeat(Repeat::Infinite).map_err(io::Error::other)?;
                let delay = Delay::from_saturating_duration(std::time::Duration::from_secs_f64(1.0 / rate));
                Ok(Self::Gif(Gif { encoder, bytes, delay }))
            }
            AnimationFormat::Apng => {
                let mut encoder = png::Encoder::new(bytes.clone(), width, height);
                encoder.set_color(png::ColorType::Rgb);
                encoder.set_depth(png::BitDepth::Eight);
                encoder.set_animated(plan.total(), 0)?;
                let (numerator, denominator) = delay_fraction(rate);
                encoder.set_frame_delay(numerator, denominator)?;
                Ok(Self::Apng(Box::new(encoder.write_header()?), bytes))
            }
        }
    }

    /// Encodes a frame after the earlier ones. All frames must have the size that the encoder was created with.
    pub(super) fn add(&mut self, frame: &Image<Rgba8>) -> io::Result<()> {
        match self {
            Self::Gif(gif) => {
                let (width, height) = frame.size();
                let buffer = RgbaImage::from_raw(width, height, frame.as_bytes().to_vec()).unwrap_or_default();
                let frame = image::Frame::from_parts(buffer, 0, 0, gif.delay);
                gif.encoder.encode_frame(frame).map_err(io::Error::other)
            }
            Self::Apng(writer, _) => {
                let rgb: Vec<u8> = frame.pixels().iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect();
                Ok(writer.write_image_data(&rgb)?)
            }
        }
    }

    /// Completes the file and returns its bytes.
    pub(super) fn finish(self) -> io::Result<Vec<u8>> {
        let bytes = match self {
            Self::Gif(Gif { encoder, bytes, .. }) => {
                // The encoder writes the end of the file when it is dropped.
                drop(encoder);
                bytes
            }
            Self::Apng(writer, bytes) => {
                writer.finish()?;
                bytes
            }
        };
        Ok(mem::take(&mut *bytes.0.borrow_mut()))
    }
}

/// Returns the time of a frame at a number of frames per second, as a fraction of a second.
fn delay_fraction(rate: f64) -> (u16, u16) {
    let scale = if rate * 100.0 <= f64::from(u16::MAX) { 100 } else { 1 };
    let denominator = (rate * f64::from(scale)).round().clamp(1.0, f64::from(u16::MAX));
    (scale, denominator as u16)
}
