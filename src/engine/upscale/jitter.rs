//! Jitter: positions of samples within their areas that change from frame to frame, and the history of earlier ones.

use super::{Accumulated, CENTRE, Motion, Scale, UpscaleInputs};
use crate::antialias::pattern::Pattern;

/// Sequence of sample positions within the area of a sample, one per frame. It repeats after all of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Jitter {
    sequence: Sequence,
    /// Number of positions.
    positions: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sequence {
    /// [`Pattern::LowDiscrepancy`].
    LowDiscrepancy,
    /// Points of Halton's sequence with the bases 2 and 3.
    Halton,
}

impl Jitter {
    /// Returns the given number of positions of a low-discrepancy pattern.
    pub(super) fn low_discrepancy(positions: u32) -> Self {
        Self { sequence: Sequence::LowDiscrepancy, positions }
    }

    /// Returns the given number of points of Halton's sequence.
    pub(super) fn halton(positions: u32) -> Self {
        Self { sequence: Sequence::Halton, positions }
    }

    /// Returns the number of positions with which every pixel of the picture has eight in its area.
    pub(super) fn eight_per_pixel(scale: Scale) -> u32 {
        (8.0 * scale.value() * scale.value()).ceil() as u32
    }

    /// Returns the number of positions.
    pub(super) fn positions(self) -> u32 {
        self.positions
    }

    /// Returns the position after `frames` earlier frames, in [0, 1]² of the sample's area.
    pub(super) fn place(self, frames: u32) -> [f64; 2] {
        let number = frames % self.positions;
        match self.sequence {
            Sequence::LowDiscrepancy => {
                Pattern::LowDiscrepancy { count: self.positions }.offsets(0, 0)[number as usize]
            }
            Sequence::Halton => [2, 3].map(|base| radical_inverse(number + 1, base)),
        }
    }
}

/// Returns the number in [0, 1) whose digits after the point are those of `index` in reverse order.
fn radical_inverse(mut index: u32, base: u32) -> f64 {
    let (mut digits, mut power) = (0, 1);
    while index > 0 {
        digits = digits * base + index % base;
        power *= base;
        index /= base;
    }
    f64::from(digits) / f64::from(power)
}

/// What a jittered frame continues.
pub(super) struct Continuation<'a> {
    /// Position of the samples of the frame within their areas, in [0, 1]².
    pub(super) place: [f64; 2],
    /// Motion since the previous frame, and the history that it stored; `None` if there is none.
    pub(super) history: Option<(Motion<'a>, &'a Accumulated)>,
    /// Whether every position has been drawn since the view became still; the image then no longer changes.
    pub(super) is_settled: bool,
}

impl<'a> Continuation<'a> {
    /// Returns what a frame with these inputs continues.
    pub(super) fn new(drawn: &UpscaleInputs<'a>, jitter: Jitter) -> Self {
        let history = drawn.frame.and_then(|seen| Some((seen.reprojection()?, seen.history?.accumulated.as_ref()?)));
        let is_settled =
            |(motion, _): &(Motion<'_>, _)| motion.is_still() && motion.history.still_frames >= jitter.positions();
        Self {
            place: drawn.frame.map_or(CENTRE, |seen| jitter.place(seen.frames())),
            is_settled: history.as_ref().is_some_and(is_settled),
            history,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halton_points_are_the_published_ones_and_repeat() {
        let jitter = Jitter::halton(32);
        let first = [[0.5, 1.0 / 3.0], [0.25, 2.0 / 3.0], [0.75, 1.0 / 9.0], [0.125, 4.0 / 9.0], [0.625, 7.0 / 9.0]];
        for (frame, point) in (0..).zip(first) {
            assert_eq!(jitter.place(frame), point);
            assert_eq!(jitter.place(frame + 32), point);
        }
    }

    #[test]
    fn larger_scales_have_more_positions() {
        for (scale, count) in [(Scale::ONE_AND_A_HALF, 18), (Scale::TWO, 32), (Scale::THREE, 72)] {
            assert_eq!(Jitter::eight_per_pixel(scale), count);
        }
    }
}
