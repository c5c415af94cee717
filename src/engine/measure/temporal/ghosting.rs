//! Ghosting: error of surfaces that have just come into view, compared with the error of all others.
//!
//! Temporal methods blend each frame with earlier ones. A surface that was hidden has no past; a method that blends it
//! all the same shows a ghost of what hid it (Yang, Liu and Salvi, "A Survey of Temporal Antialiasing Techniques",
//! 2020). The metric is the mean FLIP error of recently disoccluded pixels minus the mean FLIP error of all
//! other pixels: a method that blurs everything alike has no ghosts. Pixels count as recently disoccluded in the frame
//! in which they come into view and in a number of frames after it, because ghosts fade slowly; the pixels are followed
//! along the motion. Pixels that enter at the border of the picture are disoccluded as well.

use serde::{Deserialize, Serialize};

use super::{MotionField, is_inside, mean_by_pixels};
use crate::image::Image;

/// Number of frames for which every pixel's surface has been in view.
#[derive(Clone, Debug, PartialEq)]
pub struct Visibility {
    /// 0 for a surface that came into view in this frame.
    frames_in_view: Image<u32>,
}

impl Visibility {
    /// Returns the visibility in the first frame of a sequence: all surfaces count as in view since long before.
    pub fn first(width: u32, height: u32) -> Self {
        Self { frames_in_view: Image::filled(width, height, u32::MAX) }
    }

    /// Returns the visibility in the next frame, whose motion field is given, or `None` if it has another size.
    pub fn next(&self, motion: &MotionField) -> Option<Self> {
        let before = &self.frames_in_view;
        if before.size() != motion.size() {
            return None;
        }
        let frames_in_view = motion.map(|at| {
            let at = at.map(f64::from);
            if is_inside(before.size(), at) { before.at(at[0] as u32, at[1] as u32).saturating_add(1) } else { 0 }
        });
        Some(Self { frames_in_view })
    }

    /// Returns the pixels that came into view in this frame or in one of the `follow` frames before it.
    pub fn recently_disoccluded(&self, follow: u32) -> Image<bool> {
        self.frames_in_view.map(|frames| frames <= follow)
    }
}

/// Ghosting of one frame, or of several.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ghosting {
    /// Error of the recently disoccluded pixels minus the error of all others, in [−1, 1]. 0 for a picture equal to its
    /// reference; negative if surfaces with a past have the larger error.
    pub ghosting: f64,
    /// Mean FLIP error of the recently disoccluded pixels, in [0, 1].
    pub disoccluded_error: f64,
    /// Mean FLIP error of all other pixels, in [0, 1].
    pub other_error: f64,
    /// Number of recently disoccluded pixels.
    pub disoccluded_pixels: u64,
    /// Number of all other pixels.
    pub other_pixels: u64,
}

impl Ghosting {
    /// Measures one frame from the FLIP errors of its pixels against its reference ([`crate::measure::flip::map`]) and its
    /// recently disoccluded pixels. Returns `None` if sizes differ, or if no pixel, or every pixel, is disoccluded.
    pub fn of(errors: &Image<f32>, disoccluded: &Image<bool>) -> Option<Self> {
        if errors.size() != disoccluded.size() {
            return None;
        }
        let (mut sums, mut pixels) = ([0.0; 2], [0; 2]);
        for (error, is_disoccluded) in errors.pixels().iter().zip(disoccluded.pixels()) {
            let group = usize::from(*is_disoccluded);
            sums[group] += f64::from(*error);
            pixels[group] += 1;
        }
        Self::new(pixels, [0, 1].map(|group| sums[group] / pixels[group] as f64))
    }

    /// Returns the ghosting over several frames, weighted by their pixels. Returns `None` without a frame.
    pub fn over(frames: &[Self]) -> Option<Self> {
        let mean = |of: fn(&Self) -> (f64, u64)| mean_by_pixels(frames.iter().map(of));
        let other = mean(|frame| (frame.other_error, frame.other_pixels))?;
        let disoccluded = mean(|frame| (frame.disoccluded_error, frame.disoccluded_pixels))?;
        let count = |of: fn(&Self) -> u64| frames.iter().map(of).sum();
        let pixels = [count(|frame| frame.other_pixels), count(|frame| frame.disoccluded_pixels)];
        Self::new(pixels, [other, disoccluded])
    }

    /// Creates the result from the pixel counts and mean errors of other and of disoccluded pixels.
    fn new([other_pixels, disoccluded_pixels]: [u64; 2], [other_error, disoccluded_error]: [f64; 2]) -> Option<Self> {
        let ghosting = disoccluded_error - other_error;
        let has_both = other_pixels > 0 && disoccluded_pixels > 0;
        has_both.then_some(Self { ghosting, disoccluded_error, other_error, disoccluded_pixels, other_pixels })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Rgba8;
    use crate::measure::flip;

    const SIZE: (u32, u32) = (64, 32);

    /// Column at which a bar of 12 px starts in a frame; it moves to the right by 6 px per frame.
    fn bar(number: u32) -> std::ops::Range<u32> {
        8 + 6 * number..20 + 6 * number
    }

    /// Returns frame `number` of a bright bar in front of a still background.
    fn reference(number: u32) -> Image<Rgba8> {
        Image::from_fn(SIZE.0, SIZE.1, |x, y| {
            if bar(number).contains(&x) { [230, 180, 60, 255] } else { [40, (60 + y) as u8, 90, 255] }
        })
    }

    /// Returns the motion field of frame `number`, at least 1.
    fn motion(number: u32) -> MotionField {
        Image::from_fn(SIZE.0, SIZE.1, |x, y| {
            let [across, down] = [x, y].map(|at| at as f32 + 0.5);
            match x {
                x if bar(number).contains(&x) => [across - 6.0, down],
                x if bar(number - 1).contains(&x) => [f32::NAN; 2],
                _ => [across, down],
            }
        })
    }

    /// Returns frame `number` with a ghost of the bar of the frame before.
    fn ghosted(number: u32, opacity: f64) -> Image<Rgba8> {
        let (now, before) = (reference(number), reference(number - 1));
        Image::from_fn(SIZE.0, SIZE.1, |x, y| {
            if bar(number).contains(&x) {
                return now.at(x, y);
            }
            let blend = |a: u8, b: u8| (f64::from(a) + (f64::from(b) - f64::from(a)) * opacity).round() as u8;
            std::array::from_fn(|channel| blend(now.at(x, y)[channel], before.at(x, y)[channel]))
        })
    }

    fn ghosting_of(picture: impl Fn(u32) -> Image<Rgba8>) -> Ghosting {
        let mut visibility = Visibility::first(SIZE.0, SIZE.1);
        let frames: Vec<_> = (1..4)
            .map(|number| {
                visibility = visibility.next(&motion(number)).unwrap();
                let errors = flip::map(&picture(number), &reference(number)).unwrap();
                Ghosting::of(&errors, &visibility.recently_disoccluded(0)).unwrap()
            })
            .collect();
        Ghosting::over(&frames).unwrap()
    }

    #[test]
    fn ghosting_grows_with_the_opacity_of_a_planted_ghost() {
        let scores: Vec<f64> =
            (0..=8).map(|eighths| ghosting_of(|number| ghosted(number, f64::from(eighths) / 8.0)).ghosting).collect();
        assert_eq!(scores[0], 0.0, "no ghost");
        assert!(scores.windows(2).all(|pair| pair[0] < pair[1]), "{scores:?}");
        assert!(scores[1] > 0.02 && scores[8] > 0.3, "{scores:?}");
    }

    #[test]
    fn an_error_of_all_pixels_is_no_ghost() {
        let measured = ghosting_of(|number| reference(number).map(|[r, g, b, a]| [r, g + 20, b, a]));
        assert!(measured.other_error > 0.05, "{measured:?}");
        assert!(measured.ghosting.abs() < 0.3 * measured.other_error, "{measured:?}");
    }

    #[test]
    fn disoccluded_pixels_are_followed_along_the_motion_for_some_frames() {
        let first = Visibility::first(6, 1);
        // Everything moves to the right by 1 px; pixel 3 comes into view in the first of the frames.
        let shift = |hidden: Option<u32>| {
            Image::from_fn(6, 1, |x, _| if Some(x) == hidden { [f32::NAN; 2] } else { [x as f32 - 0.5, 0.5] })
        };
        let mut visibility = first.next(&shift(Some(3))).unwrap();
        assert_eq!(visibility.frames_in_view.pixels(), [0, u32::MAX, u32::MAX, 0, u32::MAX, u32::MAX]);
        visibility = visibility.next(&shift(None)).unwrap();
        assert_eq!(visibility.frames_in_view.pixels()[..5], [0, 1, u32::MAX, u32::MAX, 1]);
        assert_eq!(visibility.recently_disoccluded(0).pixels(), [true, false, false, false, false, false]);
        assert_eq!(visibility.recently_disoccluded(1).pixels(), [true, true, false, false, true, false]);
        assert_eq!(visibility.next(&Image::filled(5, 1, [0.5; 2])), None, "another size");
    }

    #[test]
    fn frames_without_disoccluded_pixels_have_no_ghosting() {
        let errors = Image::filled(4, 4, 0.5);
        assert_eq!(Ghosting::of(&errors, &Image::filled(4, 4, false)), None);
        assert_eq!(Ghosting::of(&errors, &Image::filled(4, 4, true)), None);
        assert_eq!(Ghosting::of(&errors, &Image::filled(4, 3, true)), None);
        let half = Image::from_fn(4, 4, |x, _| x < 2);
        let measured = Ghosting::of(&Image::from_fn(4, 4, |x, _| if x < 2 { 0.5 } else { 0.125 }), &half).unwrap();
        assert_eq!((measured.ghosting, measured.disoccluded_pixels, measured.other_pixels), (0.375, 8, 8));
    }
}
