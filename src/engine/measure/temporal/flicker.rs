//! Flicker: change of the error from frame to frame, along the motion of the surfaces.
//!
//! Temporal stability is usually measured as the warping error: the difference between a frame and the previous frame
//! reprojected by the motion (Lai, Huang, Wang, Shechtman, Yumer and Yang, "Learning Blind Video Temporal Consistency",
//! 2018). A moving highlight also changes from frame to frame, so Chu, Xie, Mayer, Leal-Taixé and Thuerey ("Learning
//! Temporal Coherence via Self-Supervision for GAN-based Video Generation", 2020) subtract the change of the reference.
//! Here it is subtracted pixel by pixel and with its sign: true changes cancel, and so does a constant error.
//!
//! Values are sRGB-coded luma from 0 to 255, as in SSIM: equal steps are about equally visible.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::{MotionField, luma_of, mean_by_pixels, sample};
use crate::image::{Image, Rgba8};

/// Frame of a sequence with the previous frame, for the measured sequence and for its reference.
#[derive(Clone, Copy, Debug)]
pub struct FramePair<'a> {
    /// Picture of the frame by the measured method.
    pub picture: &'a Image<Rgba8>,
    /// Picture of the preceding frame by the measured method.
    pub picture_before: &'a Image<Rgba8>,
    /// Reference picture of the frame.
    pub reference: &'a Image<Rgba8>,
    /// Reference picture of the preceding frame.
    pub reference_before: &'a Image<Rgba8>,
}

/// Flicker of one frame, or of several: means of absolute differences of luma codes, in [0, 255].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Flicker {
    /// Change of the error from the previous frame, along the motion: 0 for a sequence equal to its reference, and for a
    /// constant error.
    pub flicker: f64,
    /// Warping error of the measured sequence, true changes included.
    pub warping_error: f64,
    /// Warping error of the reference: true changes, and the flicker of the reference itself.
    pub reference_warping_error: f64,
    /// Number of pixels whose surface the previous frame shows; only these are measured.
    pub pixels: u64,
}

impl Flicker {
    /// Measures one frame. Returns `None` if sizes differ, or if the previous frame shows no surface of this one.
    pub fn of(frames: &FramePair<'_>, motion: &MotionField) -> Option<Self> {
        let FramePair { picture, picture_before, reference, reference_before } = *frames;
        let pictures = [picture, picture_before, reference, reference_before];
        if pictures.iter().any(|picture| picture.size() != motion.size()) {
            return None;
        }
        let [picture, picture_before, reference, reference_before] = pictures.map(luma_of);
        // Row sums are added in order, so the result does not depend on the number of threads.
        let rows = (0..motion.height()).into_par_iter().map(|y| {
            let mut sums = Sums::default();
            for (x, before) in motion.row(y).iter().enumerate() {
                let before = before.map(f64::from);
                let change = |now: &Image<f64>, old| Some(now.row(y)[x] - sample(old, before)?);
                let changes = change(&picture, &picture_before).zip(change(&reference, &reference_before));
                if let Some((change, reference)) = changes {
                    sums.add([(change - reference).abs(), change.abs(), reference.abs()]);
                }
            }
            sums
        });
        Sums::total(rows.collect()).mean()
    }

    /// Returns the mean over several frames, weighted by their pixels. Returns `None` without a frame.
    pub fn over(frames: &[Self]) -> Option<Self> {
        let mean = |value: fn(&Self) -> f64| mean_by_pixels(frames.iter().map(|frame| (value(frame), frame.pixels)));
        Some(Self {
            flicker: mean(|frame| frame.flicker)?,
            warping_error: mean(|frame| frame.warping_error)?,
            reference_warping_error: mean(|frame| frame.reference_warping_error)?,
            pixels: frames.iter().map(|frame| frame.pixels).sum(),
        })
    }
}

/// Sums of the absolute differences of several pixels: change of the error, of the picture and of the reference.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    differences: [f64; 3],
    pixels: u64,
}

impl Sums {
    fn add(&mut self, differences: [f64; 3]) {
        self.differences.iter_mut().zip(differences).for_each(|(sum, difference)| *sum += difference);
        self.pixels += 1;
    }

    fn total(rows: Vec<Self>) -> Self {
        rows.into_iter().fold(Self::default(), |mut total, row| {
            total.differences.iter_mut().zip(row.differences).for_each(|(sum, difference)| *sum += difference);
            total.pixels += row.pixels;
            total
        })
    }

    fn mean(self) -> Option<Flicker> {
        let [flicker, warping_error, reference_warping_error] = self.differences.map(|sum| sum / self.pixels as f64);
        let Self { pixels, .. } = self;
        (pixels > 0).then_some(Flicker { flicker, warping_error, reference_warping_error, pixels })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: (u32, u32) = (24, 16);

    /// Returns frame `number` of a pattern that moves to the right by 2 px per frame.
    fn moving(number: u32) -> Image<Rgba8> {
        Image::from_fn(SIZE.0, SIZE.1, |x, y| {
            let across = (x + 100 - 2 * number) * 37 % 200;
            [across as u8, (y * 11) as u8, 90, 255]
        })
    }

    fn motion() -> MotionField {
        Image::from_fn(SIZE.0, SIZE.1, |x, y| [x as f32 + 0.5 - 2.0, y as f32 + 0.5])
    }

    /// Measures frames 1 and later of a sequence against the moving pattern.
    fn flicker(frame: impl Fn(u32) -> Image<Rgba8>) -> Flicker {
        let frames: Vec<_> = (1..5)
            .map(|number| {
                let [picture, picture_before] = [number, number - 1].map(&frame);
                let [reference, reference_before] = [number, number - 1].map(moving);
                let frames = FramePair {
                    picture: &picture,
                    picture_before: &picture_before,
                    reference: &reference,
                    reference_before: &reference_before,
                };
                Flicker::of(&frames, &motion()).unwrap()
            })
            .collect();
        Flicker::over(&frames).unwrap()
    }

    fn grey(code: u8) -> Image<Rgba8> {
        Image::filled(SIZE.0, SIZE.1, [code, code, code, 255])
    }

    #[test]
    fn the_reference_itself_and_a_constant_error_do_not_flicker() {
        let same = flicker(moving);
        assert_eq!((same.flicker, same.warping_error, same.reference_warping_error), (0.0, 0.0, 0.0));
        assert_eq!(same.pixels, 4 * u64::from((SIZE.0 - 2) * SIZE.1), "pixels that enter at the left have no past");
        let brighter = flicker(|number| moving(number).map(|[r, g, b, a]| [r + 20, g + 20, b + 20, a]));
        assert!(brighter.flicker < 1e-9 && brighter.warping_error < 1e-9, "{brighter:?}");
    }

    #[test]
    fn flicker_is_proportional_to_the_change_of_brightness() {
        // Grey 200 ± 3 % alternates between 194 and 206, against a still reference: a change of 12 codes.
        let of = |percent: i32| {
            let still = grey(200);
            let frame = |number: u32| grey((200 + 2 * percent * if number.is_multiple_of(2) { 1 } else { -1 }) as u8);
            let [picture, picture_before] = [1, 2].map(frame);
            let frames = FramePair {
                picture: &picture,
                picture_before: &picture_before,
                reference: &still,
                reference_before: &still,
            };
            Flicker::of(&frames, &motion()).unwrap().flicker
        };
        for percent in [0, 1, 2, 3, 6] {
            assert!((of(percent) - 4.0 * f64::from(percent)).abs() < 1e-9, "{percent} %: {}", of(percent));
        }
    }

    #[test]
    fn true_changes_cancel() {
        // The whole scene grows brighter by 10 codes per frame, in the picture and in its reference.
        let [dark, bright] = [100, 110].map(grey);
        let frames = FramePair { picture: &bright, picture_before: &dark, reference: &bright, reference_before: &dark };
        let measured = Flicker::of(&frames, &motion()).unwrap();
        assert_eq!(measured.flicker, 0.0);
        assert!((measured.warping_error - 10.0).abs() < 1e-9 && (measured.reference_warping_error - 10.0).abs() < 1e-9);
    }

    #[test]
    fn disoccluded_pixels_and_other_sizes_are_not_measured() {
        let (dark, bright) = (grey(0), grey(255));
        let frames = FramePair { picture: &bright, picture_before: &dark, reference: &dark, reference_before: &dark };
        let hidden = Image::filled(SIZE.0, SIZE.1, [f32::NAN; 2]);
        assert_eq!(Flicker::of(&frames, &hidden), None);
        assert_eq!(Flicker::of(&frames, &Image::filled(3, 3, [1.0; 2])), None);
        assert_eq!(Flicker::over(&[]), None);
    }
}
