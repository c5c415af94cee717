//! Positions of the samples of a low-resolution image in the full one.
//!
//! Both axes are treated alike. The position of sample i in the full image, in pixels, is
//!
//! ```text
//!   corner    i · s + ½        the centre of the first pixel of its block
//!   centre    (i + ½) · s      the centre of its block: both images have the same outline
//! ```
//!
//! Every output pixel lies between the samples `cell` and `cell + 1`, at an offset of `phase` steps of `1 / phases`.

use serde::{Deserialize, Serialize};

use super::Scale;
use crate::pipeline::settings::{Choice, choice};

choice! {
    /// Position of a sample within its block.
    #[derive(PartialOrd, Ord)]
    pub Anchor {
        Corner = "corner", "Corner",
            "The sample lies on the first pixel of its block, which interpolating filters leave unchanged.";
        Centre = "centre", "Centre",
            "The sample lies at the centre of its block, as in image resizers: nothing moves, but a pixel coincides \
             with a sample only at ×3.";
    }
}

/// Regular spacing of samples along each axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Lattice {
    /// Number of output pixels per sample along each axis.
    pub(crate) scale: Scale,
    /// Position of a sample within its block.
    pub(crate) anchor: Anchor,
}

/// Position of an output pixel between two samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct LatticePosition {
    /// Index of the last sample at or before the pixel; −1 before the first.
    pub(crate) cell: i32,
    /// Offset from this sample towards the next one, in steps of 1 / [`Lattice::phases`].
    pub(crate) phase: u32,
}

/// Three adjacent samples along one axis around an output column or row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ThreeSamples {
    /// Indices of the samples, clamped to the image. The middle one is nearest to the centre of the output pixel.
    pub(super) index: [u32; 3],
    /// Index of the middle sample; −1 or the number of samples if it lies outside the image.
    pub(super) nearest: i64,
    /// Distance from the middle sample to the centre of the output pixel, in [−0.5, 0.5], relative to the distance between
    /// samples.
    pub(super) from_nearest: f32,
}

impl Lattice {
    /// Returns the number of samples along an axis of `length` output pixels.
    pub(crate) fn samples(self, length: u32) -> u32 {
        let (pixels, samples) = self.scale.ratio();
        (u64::from(length) * u64::from(samples)).div_ceil(u64::from(pixels)) as u32
    }

    /// Returns the number of phase steps between two samples.
    pub(crate) fn phases(self) -> u32 {
        let (pixels, _) = self.scale.ratio();
        match self.anchor {
            Anchor::Corner => pixels,
            Anchor::Centre => 2 * pixels,
        }
    }

    /// Returns the position of output pixel `at` between the samples: at `at / s` samples with corner anchor, and at
    /// `(at + ½) / s − ½` with centre anchor.
    pub(crate) fn place(self, at: u32) -> LatticePosition {
        self.place_beyond(i64::from(at))
    }

    /// Returns the position of output pixel `at` between the samples. Unlike in [`Lattice::place`], the pixel may lie
    /// outside the image.
    pub(super) fn place_beyond(self, at: i64) -> LatticePosition {
        let (pixels, samples) = self.scale.ratio();
        let (pixels, samples) = (i64::from(pixels), i64::from(samples));
        let (steps, phases) = match self.anchor {
            Anchor::Corner => (at * samples, pixels),
            Anchor::Centre => ((2 * at + 1) * samples - pixels, 2 * pixels),
        };
        LatticePosition { cell: steps.div_euclid(phases) as i32, phase: steps.rem_euclid(phases) as u32 }
    }

    /// Returns the positions of output pixel `first` and of all pixels after it; see [`Lattice::place`]. They are
    /// computed incrementally: thousands of divisions would take a tenth of the time of a fast kernel.
    pub(super) fn places_from(self, first: u32) -> impl Iterator<Item = LatticePosition> {
        let phases = self.phases();
        let (_, samples) = self.scale.ratio();
        let steps = match self.anchor {
            Anchor::Corner => samples,
            Anchor::Centre => 2 * samples,
        };
        std::iter::successors(Some(self.place(first)), move |LatticePosition { cell, phase }| {
            // A pixel is never wider than a sample, so it advances by at most one cell.
            let (phase, next) = (phase + steps, phase + steps >= phases);
            Some(LatticePosition { cell: cell + i32::from(next), phase: if next { phase - phases } else { phase } })
        })
    }

    /// Returns the position of sample `index` in the full image, in pixels.
    pub(crate) fn position_px(self, index: u32) -> f64 {
        let (pixels, samples) = self.scale.ratio();
        let (pixels, samples) = (f64::from(pixels), f64::from(samples));
        // Numerators are exact, so the position is rounded only once.
        match self.anchor {
            Anchor::Corner => f64::from(index) * pixels / samples + 0.5,
            Anchor::Centre => (f64::from(index) + 0.5) * pixels / samples,
        }
    }

    /// Returns the position of output pixel `at` among samples that lie at `place` within their areas, in [0, 1]. The
    /// integer is the index of the last sample at or before the pixel; it may lie outside the image. The fraction, in
    /// [0, 1), is the distance from that sample to the pixel, relative to the distance between samples.
    pub(super) fn coordinate(self, place: f64, at: u32) -> (i64, f32) {
        let index = (f64::from(at) + 0.5 - self.position_px(0)) / self.scale.value() - (place - 0.5);
        (index.floor() as i64, (index - index.floor()) as f32)
    }

    /// Returns the two of `samples` samples between which output column or row `at` lies, and whether the second one is
    /// closer. Outside the image, they are its first or last sample.
    pub(super) fn between(self, at: u32, samples: u32) -> ([u32; 2], bool) {
        let LatticePosition { cell, phase } = self.place(at);
        let two = [cell, cell + 1].map(|index| index.clamp(0, samples as i32 - 1) as u32);
        (two, 2 * phase > self.phases())
    }

    /// Returns the three samples around output column or row `at`, out of `samples` samples that lie at `place` within
    /// their areas.
    pub(super) fn three_around(self, place: f64, at: u32, samples: u32) -> ThreeSamples {
        let (cell, on) = self.coordinate(place, at);
        let nearest = cell + i64::from(on > 0.5);
        let inside = |index: i64| index.clamp(0, i64::from(samples) - 1) as u32;
        ThreeSamples {
            index: [-1, 0, 1].map(|number| inside(nearest + number)),
            nearest,
            from_nearest: (cell - nearest) as f32 + on,
        }
    }

    /// Returns the origin of the sample grid in the full image, in pixels: sample i lies at (i + ½) · s from this
    /// origin.
    pub(crate) fn origin_px(self) -> f64 {
        self.position_px(0) - 0.5 * self.scale.value()
    }

    /// Returns the index of the sample nearest to output pixel `at`, out of `samples` samples; the first one if two are
    /// equally near.
    pub(crate) fn nearest(self, at: u32, samples: u32) -> u32 {
        self.nearest_to(self.place(at), samples)
    }

    /// Returns the index of the sample nearest to a position, out of `samples` samples; see [`Lattice::nearest`].
    pub(super) fn nearest_to(self, LatticePosition { cell, phase }: LatticePosition, samples: u32) -> u32 {
        let index = cell + i32::from(2 * phase > self.phases());
        (index.max(0) as u32).min(samples.saturating_sub(1))
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Returns all lattices, one for each scale and anchor.
    pub(in crate::upscale) fn every() -> impl Iterator<Item = Lattice> {
        let tenths = [10, 13, 15, 17, 20, 26, 30, 40].map(|tenths| Scale::from(f64::from(tenths) / 10.0));
        tenths.into_iter().flat_map(|scale| Anchor::ALL.iter().map(move |anchor| Lattice { scale, anchor: *anchor }))
    }

    #[test]
    fn places_equal_rational_arithmetic() {
        for lattice in every() {
            let (pixels, samples) = lattice.scale.ratio();
            let (pixels, samples) = (i64::from(pixels), i64::from(samples));
            // All positions are multiples of 1 / (2 · samples) px.
            let sample_at = |index: i64| match lattice.anchor {
                Anchor::Corner => 2 * index * pixels + samples,
                Anchor::Centre => (2 * index + 1) * pixels,
            };
            for at in 0..200 {
                let LatticePosition { cell, phase } = lattice.place(at);
                let (one, next) = (sample_at(cell.into()), sample_at(i64::from(cell) + 1));
                let pixel = (2 * i64::from(at) + 1) * samples;
                assert!(one <= pixel && pixel < next, "{lattice:?} {at} lies in cell {cell}");
                let (phase, phases) = (i64::from(phase), i64::from(lattice.phases()));
                assert_eq!((pixel - one) * phases, phase * (next - one), "{lattice:?} {at}: {phase} / {phases}");
                let position = lattice.position_px(at) * 2.0 * samples as f64;
                assert!((position - sample_at(at.into()) as f64).abs() < 1e-9, "{lattice:?} {at}");
            }
        }
    }

    #[test]
    fn incremental_positions_equal_divided_ones() {
        for lattice in every() {
            for first in [0, 1, 7, 1000] {
                for (at, place) in (first..first + 50).zip(lattice.places_from(first)) {
                    assert_eq!(place, lattice.place(at), "{lattice:?} {at}");
                }
            }
        }
    }

    #[test]
    fn no_pixel_is_farther_than_its_block_from_the_nearest_sample() {
        for lattice in every() {
            for length in 1..40 {
                let samples = lattice.samples(length);
                for at in 0..length {
                    let nearest = lattice.nearest(at, samples);
                    let apart = |sample: u32| (lattice.position_px(sample) - f64::from(at) - 0.5).abs();
                    assert!((0..samples).all(|other| apart(other) >= apart(nearest)), "{lattice:?} {at} of {length}");
                    assert!(apart(nearest) < lattice.scale.value(), "{lattice:?} {at} of {length}");
                    let (two, is_second_closer) = lattice.between(at, samples);
                    assert_eq!(two[usize::from(is_second_closer)], nearest, "{lattice:?} {at} of {length}");
                }
            }
        }
    }
}
