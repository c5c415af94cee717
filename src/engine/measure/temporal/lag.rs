//! Lag: number of frames by which a picture is behind its reference, estimated from the shift of its surfaces.
//!
//! A surface that moves by v px per frame is shown s · v px behind its true position by a picture that lags s frames. The
//! lag is the s at which the picture, read s · v px behind, differs least from the reference (mean squared difference of
//! sRGB-coded luma). The minimum among sampled lags is refined by the parabola through it and its two neighbours, as is
//! usual in sub-pixel block matching (Tian and Huhns, "Algorithms for Subpixel Registration", 1986).

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::{MotionField, luma_of, mean_by_pixels, sample};
use crate::image::{Image, Rgba8};

/// Lags that are tried, in frames. A negative lag is ahead of the reference, as extrapolated pictures can be.
const RANGE: std::ops::RangeInclusive<i32> = -1..=4;

/// Smallest motion that is measured, in pixels per frame: slower surfaces say little about the lag.
const MIN_MOTION_PX: f64 = 0.5;

/// Distance of sampled lags in pixels along typical motion: short enough not to miss the minimum of fine detail.
const STEP_PX: f64 = 0.5;

/// Largest number of sampled lags per frame of motion, for fast motion.
const MAX_STEPS: i32 = 32;

/// Lag of one frame, or of several.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Lag {
    /// Frames by which the picture is behind its reference, from −1 to 4.
    pub frames: f64,
    /// Number of pixels whose surfaces move, which the lag is estimated from.
    pub pixels: u64,
}

impl Lag {
    /// Estimates the lag of a picture against its reference. Returns `None` if sizes differ, or if nothing moves that the
    /// whole range of lags can be tried for.
    pub fn of(picture: &Image<Rgba8>, reference: &Image<Rgba8>, motion: &MotionField) -> Option<Self> {
        if picture.size() != reference.size() || picture.size() != motion.size() {
            return None;
        }
        let moving = MovingPixels::new(&luma_of(reference), motion);
        let speed = moving.mean_speed_px()?;
        let steps = ((speed / STEP_PX).ceil() as i32).clamp(4, MAX_STEPS);
        let lags: Vec<f64> =
            (RANGE.start() * steps..=RANGE.end() * steps).map(|step| f64::from(step) / f64::from(steps)).collect();
        let picture = luma_of(picture);
        let errors: Vec<f64> = lags.par_iter().map(|lag| moving.error(&picture, *lag)).collect();
        let best = smallest(&lags, &errors)?;
        let frames = lags[best] + offset_of_minimum(&errors, best) / f64::from(steps);
        Some(Self { frames, pixels: moving.pixels.len() as u64 })
    }

    /// Returns the mean lag of several frames, weighted by their pixels. Returns `None` without a frame.
    pub fn over(frames: &[Self]) -> Option<Self> {
        let mean = mean_by_pixels(frames.iter().map(|frame| (frame.frames, frame.pixels)))?;
        Some(Self { frames: mean, pixels: frames.iter().map(|frame| frame.pixels).sum() })
    }
}

/// Pixel of a moving surface.
#[derive(Clone, Copy, Debug)]
struct MovingPixel {
    /// Luma of the reference.
    reference: f64,
    /// Centre of the pixel, in pixels.
    center: [f64; 2],
    /// Motion since the previous frame, in pixels.
    motion_px: [f64; 2],
}

impl MovingPixel {
    /// Returns the position at which a picture with a lag shows this surface.
    fn position(&self, lag: f64) -> [f64; 2] {
        [0, 1].map(|axis: usize| self.center[axis] - lag * self.motion_px[axis])
    }

    fn speed_px(&self) -> f64 {
        self.motion_px[0].hypot(self.motion_px[1])
    }
}

/// Pixels of all moving surfaces that stay inside the picture for the whole range of lags.
struct MovingPixels {
    pixels: Vec<MovingPixel>,
}

impl MovingPixels {
    fn new(reference: &Image<f64>, motion: &MotionField) -> Self {
        let pixel = |x: u32, y: u32| {
            let center = [x, y].map(|at| f64::from(at) + 0.5);
            let before = motion.at(x, y).map(f64::from);
            let motion_px = [0, 1].map(|axis: usize| center[axis] - before[axis]);
            MovingPixel { reference: reference.at(x, y), center, motion_px }
        };
        let is_usable = |pixel: &MovingPixel| {
            let ends = [*RANGE.start(), *RANGE.end()].map(|lag| pixel.position(lag.into()));
            pixel.speed_px() >= MIN_MOTION_PX && ends.into_iter().all(|at| super::is_inside(reference.size(), at))
        };
        let all = (0..reference.height()).flat_map(|y| (0..reference.width()).map(move |x| (x, y)));
        Self { pixels: all.map(|(x, y)| pixel(x, y)).filter(is_usable).collect() }
    }

    /// Returns the mean speed in pixels per frame, or `None` if nothing moves.
    fn mean_speed_px(&self) -> Option<f64> {
        mean_by_pixels(self.pixels.iter().map(|pixel| (pixel.speed_px(), 1)))
    }

    /// Returns the mean squared difference between the picture, read at a lag, and the reference.
    fn error(&self, picture: &Image<f64>, lag: f64) -> f64 {
        let square = |pixel: &MovingPixel| Some((sample(picture, pixel.position(lag))? - pixel.reference).powi(2));
        self.pixels.iter().filter_map(square).sum::<f64>() / self.pixels.len() as f64
    }
}

/// Returns the index of the smallest error; of equal errors, the one with the smallest absolute lag.
fn smallest(lags: &[f64], errors: &[f64]) -> Option<usize> {
    let key = |index: &usize| (errors[*index], lags[*index].abs());
    (0..errors.len()).min_by(|a, b| {
        let ((error_a, lag_a), (error_b, lag_b)) = (key(a), key(b));
        error_a.total_cmp(&error_b).then(lag_a.total_cmp(&lag_b))
    })
}

/// Returns the offset of the minimum of the parabola through the smallest value and its neighbours, in [−0.5, 0.5] steps.
/// It is 0 for an exact match, which no other lag can improve, and at the ends of the range.
fn offset_of_minimum(errors: &[f64], smallest: usize) -> f64 {
    let Some([before, at, after]) = smallest.checked_sub(1).and_then(|first| errors.get(first..first + 3)) else {
        return 0.0;
    };
    let bend = before - 2.0 * at + after;
    if *at == 0.0 || bend <= 0.0 { 0.0 } else { (0.5 * (before - after) / bend).clamp(-0.5, 0.5) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: (u32, u32) = (96, 24);

    /// Velocity of the two halves of the picture, in pixels per frame.
    fn velocity(y: u32) -> f64 {
        if y < SIZE.1 / 2 { 3.0 } else { -2.0 }
    }

    /// Returns a frame in which both halves move apart; numbers may be fractions.
    fn frame(number: f64) -> Image<Rgba8> {
        Image::from_fn(SIZE.0, SIZE.1, |x, y| {
            let along = f64::from(x) - velocity(y) * number;
            let wave = (along * 0.35).sin() * 60.0 + (along * 0.9 + f64::from(y)).sin() * 40.0;
            let code = (128.0 + wave).round() as u8;
            [code, code, code, 255]
        })
    }

    fn motion() -> MotionField {
        Image::from_fn(SIZE.0, SIZE.1, |x, y| [x as f32 + 0.5 - velocity(y) as f32, y as f32 + 0.5])
    }

    fn lag_of(picture: &Image<Rgba8>) -> f64 {
        Lag::of(picture, &frame(5.0), &motion()).unwrap().frames
    }

    #[test]
    fn the_reference_itself_has_no_lag() {
        assert_eq!(lag_of(&frame(5.0)), 0.0);
    }

    #[test]
    fn delayed_and_extrapolated_pictures_have_the_lag_of_their_time() {
        for lag in [1.0, 2.0, 0.5, 0.25, 1.4, -0.5, 3.0] {
            let measured = lag_of(&frame(5.0 - lag));
            assert!((measured - lag).abs() <= 0.05, "{measured} instead of {lag}");
        }
    }

    #[test]
    fn a_blend_with_the_previous_frame_lags_in_between() {
        let (now, before) = (frame(5.0), frame(4.0));
        let blend = Image::from_fn(SIZE.0, SIZE.1, |x, y| {
            std::array::from_fn(|channel| now.at(x, y)[channel].midpoint(before.at(x, y)[channel]))
        });
        let measured = lag_of(&blend);
        assert!((0.35..0.65).contains(&measured), "{measured}");
    }

    #[test]
    fn still_surfaces_and_other_sizes_have_no_lag() {
        let still = Image::from_fn(SIZE.0, SIZE.1, |x, y| [x as f32 + 0.5, y as f32 + 0.5]);
        assert_eq!(Lag::of(&frame(4.0), &frame(5.0), &still), None);
        assert_eq!(Lag::of(&frame(4.0), &frame(5.0), &Image::filled(SIZE.0, SIZE.1, [f32::NAN; 2])), None);
        assert_eq!(Lag::of(&frame(4.0), &frame(5.0), &Image::filled(3, 3, [0.0; 2])), None);
        assert_eq!(Lag::over(&[]), None);
        let lags = [(1.0, 30), (2.0, 10)].map(|(frames, pixels)| Lag { frames, pixels });
        assert_eq!(Lag::over(&lags), Some(Lag { frames: 1.25, pixels: 40 }));
    }
}
