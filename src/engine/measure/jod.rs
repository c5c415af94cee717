//! ColorVideoVDP: visible differences of pictures and of frame sequences on a display, in just-objectionable differences.
//!
//! Mantiuk, Hanji, Ashraf, Asano and Chapiro, "ColorVideoVDP: A Visual Difference Predictor for Image, Video and Display
//! Distortions" (2024), by the crate `colorvideovdp`. The result is in JOD: 10 means no visible difference; of two
//! pictures that are 1 JOD apart, 75 % of observers prefer the one with the larger value. It can be below 0. The display
//! is the authors' `standard_4k` (200 cd/m² white, contrast 1000, office light of 250 lux) with selectable pixels per
//! degree. Sequences are seen at a frame rate, so that flicker counts.

use colorvideovdp::{Color, Cvvdp, DisplayModel, Geometry, Options, Prediction};
use serde::{Deserialize, Serialize};

use super::flip::PIXELS_PER_DEGREE;
use crate::image::{Image, Rgba8};

/// Limit of the memory of one prediction: about 10 million pixels.
const MEMORY_LIMIT_BYTES: usize = 4 << 30;

/// Memory for the frames of a sequence that are predicted at once, in bytes: 35 frames of 1920 × 1080 px at 30 frames per
/// second.
const BLOCK_BYTES: usize = 2 << 30;

/// Largest number of frames that are predicted at once.
const MAX_BLOCK: usize = 64;

/// Viewing conditions of an observer: size of a pixel and frame rate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Viewing {
    /// Pixels per degree of visual angle.
    pub pixels_per_degree: f64,
    /// Frame rate of sequences, in frames per second.
    pub frames_per_second: f64,
}

impl Viewing {
    /// Largest supported number of pixels per degree, and of frames per second.
    pub const MAX: f64 = 1000.0;

    /// Returns the evaluator for these conditions, or `None` if they are not positive or larger than [`Self::MAX`].
    fn evaluator(&self) -> Option<Cvvdp> {
        let Self { pixels_per_degree, frames_per_second } = *self;
        let is_supported = |value: f64| value > 0.0 && value <= Self::MAX;
        if !is_supported(pixels_per_degree) || !is_supported(frames_per_second) {
            return None;
        }
        let mut display = DisplayModel::from_name("standard_4k").ok()?;
        display.geometry = Geometry::from_ppd(display.geometry.resolution(), pixels_per_degree).ok()?;
        Cvvdp::new(display, Options::default().with_memory_limit_bytes(MEMORY_LIMIT_BYTES)).ok()
    }

    /// Returns the number of earlier frames that the temporal filters read: they are a quarter of a second long.
    fn frames_read(&self) -> usize {
        (0.125 * self.frames_per_second).ceil() as usize * 2
    }
}

impl Default for Viewing {
    /// Returns 67 pixels per degree, as FLIP assumes, and 30 frames per second.
    fn default() -> Self {
        Self { pixels_per_degree: PIXELS_PER_DEGREE.round(), frames_per_second: 30.0 }
    }
}

/// Returns the JOD of a picture against its reference. Alpha is ignored. Returns `None` if the sizes differ, if a side is
/// shorter than 4 px, if the pictures have more than about 10 million pixels, or if `viewing` is out of range.
///
/// # Examples
/// ```
/// use rasterscope_engine::image::Image;
/// use rasterscope_engine::measure::jod::{Viewing, of_pictures};
///
/// let grey = Image::filled(32, 16, [120, 120, 120, 255]);
/// assert_eq!(of_pictures(&grey, &grey, &Viewing::default()), Some(10.0));
/// ```
pub fn of_pictures(picture: &Image<Rgba8>, reference: &Image<Rgba8>, viewing: &Viewing) -> Option<f64> {
    let (picture, reference) = (encoded(picture)?, encoded(reference)?);
    viewing.evaluator()?.predict_image(&picture, &reference, Color::Srgb).ok().map(|prediction| prediction.jod.into())
}

/// Returns a picture as sRGB-encoded values in [0, 1], or `None` if a side is shorter than 4 px.
fn encoded(picture: &Image<Rgba8>) -> Option<colorvideovdp::Image> {
    let values = picture.pixels().iter().flat_map(|[r, g, b, _]| [*r, *g, *b].map(|code| f32::from(code) / 255.0));
    colorvideovdp::Image::new(picture.width() as usize, picture.height() as usize, 3, values.collect()).ok()
}

/// JOD of a frame sequence, measured block by block.
pub struct SequenceJod {
    viewing: Viewing,
    evaluator: Cvvdp,
    /// Frames of the current block, after the earlier frames that its filters read.
    pictures: Vec<colorvideovdp::Image>,
    /// References of these frames.
    references: Vec<colorvideovdp::Image>,
    /// Number of leading frames that belong to earlier blocks.
    measured: usize,
    /// Memory for a block and the frames before it that it reads.
    block_bytes: usize,
    /// Difference of each frame of the earlier blocks, pooled over space, bands and channels.
    differences: Vec<f64>,
}

impl std::fmt::Debug for SequenceJod {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SequenceJod").field("viewing", &self.viewing).field("frames", &self.frames()).finish()
    }
}

impl SequenceJod {
    /// Prepares a measurement. Returns `None` if `viewing` is out of range.
    pub fn new(viewing: Viewing) -> Option<Self> {
        let evaluator = viewing.evaluator()?;
        let (pictures, references, differences) = Default::default();
        Some(Self { viewing, evaluator, pictures, references, measured: 0, block_bytes: BLOCK_BYTES, differences })
    }

    /// Returns the number of frames so far.
    pub fn frames(&self) -> usize {
        self.differences.len() + self.pictures.len() - self.measured
    }

    /// Adds the next frame with its reference. Returns `None` if the frames cannot be measured: see [`of_pictures`]. All
    /// frames must have the same size.
    pub fn add(&mut self, picture: &Image<Rgba8>, reference: &Image<Rgba8>) -> Option<()> {
        let (test, original) = (encoded(picture)?, encoded(reference)?);
        self.pictures.push(test);
        self.references.push(original);
        let waiting = self.pictures.len() - self.measured;
        if waiting >= self.block(picture.pixels().len()) { self.measure_block() } else { Some(()) }
    }

    /// Returns the JOD of the whole sequence, or `None` without a frame or if the frames cannot be measured.
    pub fn finish(mut self) -> Option<f64> {
        if self.frames() == 1 {
            let (picture, reference) = (self.pictures.first()?, self.references.first()?);
            let prediction = self.evaluator.predict_image(picture, reference, Color::Srgb);
            return prediction.ok().map(|prediction| prediction.jod.into());
        }
        if self.pictures.len() > self.measured {
            self.measure_block()?;
        }
        (!self.differences.is_empty()).then(|| pooling::jod(&self.differences))
    }

    /// Returns the number of frames of a block, for frames with a number of pixels. A block is at least as long as the
    /// frames before it that it reads, because these are measured once more.
    fn block(&self, pixels: usize) -> usize {
        let earlier = self.viewing.frames_read();
        let pair_bytes = 2 * 3 * size_of::<f32>() * pixels;
        (self.block_bytes / pair_bytes.max(1)).saturating_sub(earlier).min(MAX_BLOCK).max(earlier)
    }

    /// Measures the frames of the current block and keeps those that the next block reads.
    fn measure_block(&mut self) -> Option<()> {
        let rate = self.viewing.frames_per_second as f32;
        let prediction = self.evaluator.predict_video(&self.pictures, &self.references, rate, Color::Srgb).ok()?;
        self.differences.extend((self.measured..prediction.frames).map(|frame| difference(&prediction, frame)));
        let outdated = self.pictures.len().saturating_sub(self.viewing.frames_read());
        self.pictures.drain(..outdated);
        self.references.drain(..outdated);
        self.measured = self.pictures.len();
        Some(())
    }
}

/// Returns the difference of one frame of a prediction, pooled over bands and channels.
fn difference(prediction: &Prediction, frame: usize) -> f64 {
    let bands = prediction.band_frequencies.len();
    let channel = |channel: usize| {
        let first = (channel * prediction.frames + frame) * bands;
        prediction.quality_per_channel.get(first..first + bands).unwrap_or_default()
    };
    pooling::frame(&[0, 1, 2, 3].map(channel))
}

/// Pooling of differences over bands, channels and frames, and its mapping to JOD, as in the paper, with the
/// parameters of version 0.5.7. The crate pools whole sequences only, which would have to fit into memory.
mod pooling {
    /// Exponent of the norms over bands and over channels.
    const BETA: f64 = 4.0;

    /// Exponent of the norm over frames.
    const BETA_FRAMES: f64 = 2.0;

    /// Weights of the sustained achromatic, red–green, yellow–violet and transient achromatic channels.
    const CHANNEL_WEIGHTS: [f64; 4] = [1.0, 1.0, 1.0, 0.808_113_455_772_399_9];

    /// Additional weights of the coarsest band of each channel.
    const COARSEST_WEIGHTS: [f64; 4] =
        [0.003_633_448_621_258_139_6, 1.662_772_417_068_481_4, 4.118_745_326_995_85, 25.259_698_867_797_85];

    /// Factor and exponent of the mapping to JOD. It is linear below [`LINEAR_BELOW`].
    const JOD_FACTOR: f64 = 0.043_956_939_131_021_5;
    const JOD_EXPONENT: f64 = 0.930_204_272_270_202_6;
    const LINEAR_BELOW: f64 = 0.1;

    /// Constant that keeps the derivative of powers finite at 0.
    const EPSILON: f64 = 1e-5;

    fn power(value: f64, exponent: f64) -> f64 {
        (value + EPSILON).powf(exponent) - EPSILON.powf(exponent)
    }

    /// Pools the differences of one frame, per channel and band.
    pub(super) fn frame(channels: &[&[f32]; 4]) -> f64 {
        let band = |channel: usize, band: usize| {
            let is_coarsest = band + 1 == channels[channel].len();
            let weight = CHANNEL_WEIGHTS[channel] * if is_coarsest { COARSEST_WEIGHTS[channel] } else { 1.0 };
            power(f64::from(channels[channel][band]) * weight, BETA)
        };
        let channel = |channel: usize| {
            let sum: f64 = (0..channels[channel].len()).map(|index| band(channel, index)).sum();
            power(power(sum, 1.0 / BETA), BETA)
        };
        power((0..channels.len()).map(channel).sum(), 1.0 / BETA)
    }

    /// Pools the differences of all frames, at least one, and maps them to JOD.
    pub(super) fn jod(frames: &[f64]) -> f64 {
        let mean = frames.iter().map(|frame| power(*frame, BETA_FRAMES)).sum::<f64>() / frames.len() as f64;
        let difference = power(mean, 1.0 / BETA_FRAMES);
        let slope = LINEAR_BELOW.powf(JOD_EXPONENT - 1.0);
        let scaled = if difference <= LINEAR_BELOW { slope * difference } else { difference.powf(JOD_EXPONENT) };
        10.0 - JOD_FACTOR * scaled
    }
}

#[cfg(test)]
mod tests {
    use colorvideovdp::TemporalPadding;

    use super::*;

    const SIZE: (u32, u32) = (32, 24);

    /// Returns a textured picture with noise of up to ±`amplitude` codes; different in every frame `seed`.
    fn noisy(amplitude: u8, seed: u64) -> Image<Rgba8> {
        let mut random = fastrand::Rng::with_seed(seed);
        Image::from_fn(SIZE.0, SIZE.1, |x, y| {
            let base = [60 + x * 4, 70 + y * 5, 120 + (x + y) % 7 * 6];
            let channel = |code: u32| {
                let noise = i32::from(random.u8(0..=2 * amplitude)) - i32::from(amplitude);
                (code as i32 + noise).clamp(0, 255) as u8
            };
            let [r, g, b] = base.map(channel);
            [r, g, b, 255]
        })
    }

    /// Returns the picture with all codes multiplied by 1 + `percent` / 100.
    fn brightened(picture: &Image<Rgba8>, percent: f64) -> Image<Rgba8> {
        let scaled = |code: u8| (f64::from(code) * (1.0 + percent / 100.0)).round().min(255.0) as u8;
        picture.map(|[r, g, b, a]| [scaled(r), scaled(g), scaled(b), a])
    }

    /// Measures a sequence in blocks of 8 frames.
    fn of_sequence(frames: usize, picture: impl Fn(usize) -> Image<Rgba8>) -> f64 {
        let mut sequence = SequenceJod::new(Viewing::default()).unwrap();
        sequence.block_bytes = 0;
        let reference = noisy(0, 0);
        (0..frames).for_each(|frame| sequence.add(&picture(frame), &reference).unwrap());
        assert_eq!(sequence.frames(), frames);
        sequence.finish().unwrap()
    }

    #[test]
    fn the_crate_has_the_parameters_of_its_authors() {
        assert_eq!(Cvvdp::MODEL_VERSION, "0.5.7");
        // 30 inches diagonal at 16 : 9, 3840 px wide, seen from 0.7472 m: the authors' 75.4 pixels per degree.
        let display = DisplayModel::from_name("standard_4k").unwrap();
        let pixel_m = 30.0 * 0.0254 * 16.0 / 337_f64.sqrt() / 3840.0;
        let expected = 1.0 / (2.0 * (0.5 * pixel_m / 0.7472).atan().to_degrees());
        assert!((display.geometry.pixels_per_degree() - expected).abs() < 1e-9 && (75.3..75.5).contains(&expected));
    }

    /// Returns the picture of the authors' program for whose frames its values were published: smooth waves that move to
    /// the left.
    fn waves(width: usize, height: usize, frame: usize) -> Vec<[f32; 3]> {
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x as f64 + 0.7 * frame as f64, y as f64)));
        let color = |(x, y): (f64, f64)| {
            let red = 0.48 + 0.25 * (x * 0.19).sin() * (y * 0.13).cos();
            [red, 0.48 + 0.24 * (x * 0.11 + y * 0.15).cos(), 0.48 + 0.24 * (x * 0.07 - y * 0.17).sin()]
        };
        pixels.map(|place| color(place).map(|value| value as f32)).collect()
    }

    fn image((width, height): (usize, usize), pixels: &[[f32; 3]]) -> colorvideovdp::Image {
        colorvideovdp::Image::new(width, height, 3, pixels.as_flattened().to_vec()).unwrap()
    }

    /// The values are those of the authors' PyTorch program at revision 2a268bc (version 0.5.7), as published in
    /// `tests/data/oracle.json` of <https://github.com/Tavrin/colorvideovdp-rs>; the pictures follow the formulas in its
    /// `parity/reference.py`.
    #[test]
    fn values_are_those_of_the_authors_program() {
        let display = DisplayModel::from_name("standard_4k").unwrap();
        let viewing = Viewing { pixels_per_degree: display.geometry.pixels_per_degree(), frames_per_second: 29.97 };
        let reference = waves(16, 16, 0);
        let block = |index: usize| reference[index / 64 * 64 + index % 16 / 4 * 4];
        let blocks: Vec<_> = (0..256).map(|index| block(index).map(|v| (v * 24.0).round_ties_even() / 24.0)).collect();
        let [test, reference] = [&blocks, &reference].map(|pixels| image((16, 16), pixels));
        let still = viewing.evaluator().unwrap().predict_image(&test, &reference, Color::Srgb).unwrap().jod;
        assert!((still - 8.836_059).abs() < 1e-4, "{still}");

        let options = Options::default().with_temporal_padding(TemporalPadding::Symmetric);
        let references: Vec<_> = (0..8).map(|frame| waves(17, 16, frame)).collect();
        let flickering = references.iter().zip([1.055, 0.945].into_iter().cycle());
        let flickering = flickering.map(|(pixels, factor): (&Vec<[f32; 3]>, f32)| {
            pixels.iter().map(|color| color.map(|value| value * factor)).collect::<Vec<_>>()
        });
        let tests: Vec<_> = flickering.map(|pixels| image((17, 16), &pixels)).collect();
        let references: Vec<_> = references.iter().map(|pixels| image((17, 16), pixels)).collect();
        let evaluator = Cvvdp::new(display, options).unwrap();
        let flicker = evaluator.predict_video(&tests, &references, 29.97, Color::Srgb).unwrap().jod;
        assert!((flicker - 7.745_632).abs() < 1e-4, "{flicker}");
    }

    #[test]
    fn more_noise_and_fewer_pixels_per_degree_lower_the_jod() {
        let reference = noisy(0, 0);
        let of = |amplitude, pixels_per_degree| {
            let viewing = Viewing { pixels_per_degree, ..Viewing::default() };
            of_pictures(&noisy(amplitude, 1), &reference, &viewing).unwrap()
        };
        let values = [0, 4, 8, 16, 32, 64].map(|amplitude| of(amplitude, 60.0));
        assert_eq!(values[0], 10.0);
        assert!(values.windows(2).all(|pair| pair[0] > pair[1]), "{values:?}");
        assert!(of(16, 30.0) < of(16, 120.0), "details are larger at fewer pixels per degree");
    }

    #[test]
    fn flicker_is_worse_than_a_still_error_of_the_same_size() {
        let reference = noisy(0, 0);
        let [brighter, darker] = [3.0, -3.0].map(|percent| brightened(&reference, percent));
        let still = of_sequence(12, |_| brighter.clone());
        let flicker = of_sequence(12, |frame| if frame % 2 == 0 { brighter.clone() } else { darker.clone() });
        assert_eq!(of_sequence(12, |_| reference.clone()), 10.0);
        assert!(flicker < still && still < 10.0, "flicker {flicker}, still {still}");
    }

    #[test]
    fn blocks_have_the_jod_of_the_whole_sequence() {
        for frames in [1, 2, 8, 9, 19] {
            let picture = |frame: usize| noisy(if frame < 8 { 3 } else { 12 }, frame as u64);
            let pictures: Vec<_> = (0..frames).map(|frame| encoded(&picture(frame)).unwrap()).collect();
            let references = vec![encoded(&noisy(0, 0)).unwrap(); frames];
            let whole = Viewing::default().evaluator().unwrap();
            let whole = whole.predict_video(&pictures, &references, 30.0, Color::Srgb).unwrap();
            let blocks = of_sequence(frames, picture);
            assert!((blocks - f64::from(whole.jod)).abs() < 1e-5, "{frames} frames: {blocks} and {}", whole.jod);
        }
    }

    #[test]
    fn what_cannot_be_measured_has_no_jod() {
        let viewing = Viewing::default();
        let picture = noisy(0, 0);
        assert_eq!(of_pictures(&picture, &Image::filled(9, 9, [0; 4]), &viewing), None);
        assert_eq!(of_pictures(&Image::filled(3, 9, [0; 4]), &Image::filled(3, 9, [0; 4]), &viewing), None);
        for pixels_per_degree in [0.0, -1.0, f64::NAN, 1e9] {
            assert_eq!(of_pictures(&picture, &picture, &Viewing { pixels_per_degree, ..viewing }), None);
        }
        assert!(SequenceJod::new(Viewing { frames_per_second: 0.0, ..viewing }).is_none());
        assert_eq!(SequenceJod::new(viewing).unwrap().finish(), None, "no frame");
        let mut sequence = SequenceJod::new(viewing).unwrap();
        assert_eq!(sequence.add(&Image::filled(2, 2, [0; 4]), &picture), None);
        // At 1920 × 1080 px, 43 pairs fit, of which 8 belong to the block before.
        assert_eq!([1920 * 1080, 64 * 64, 1 << 30].map(|pixels| sequence.block(pixels)), [35, 64, 8]);
    }
}
