//! Where the samples of a small picture lie in the full one.
//!
//! Both axes are alike. Sample i lies, in px of the full picture,
//!
//! ```text
//!   corner    at  i · s + ½        on the centre of the first pixel of its block
//!   centre    at (i + ½) · s       in the middle of its block: the two pictures have their outlines in common
//! ```
//!
//! so between the samples `cell` and `cell + 1` every output pixel has its place, `phase` steps of `1 / phases` on.

use serde::{Deserialize, Serialize};

use super::Scale;
use crate::pipeline::settings::{Choice, choice};

choice! {
    /// Where in its block a sample lies.
    #[derive(PartialOrd, Ord)]
    Anchor {
        Corner = "corner", "Corner", "On the block's first pixel, which comes out unchanged.";
        Centre = "centre", "Centre", "In the block's middle, as resizing programs have it: nothing moves, but no pixel is drawn itself.";
    }
}

/// A row or column of samples spread over pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Lattice {
    /// Pixels per sample.
    pub scale: Scale,
    /// Where in its block a sample lies.
    pub anchor: Anchor,
}

/// Where an output pixel lies between samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// The sample at or before it; −1 before the first.
    pub cell: i32,
    /// How far towards the next sample, in steps of 1 / [`Lattice::phases`].
    pub phase: u32,
}

impl Lattice {
    /// How many samples there are for `length` px.
    pub fn samples(self, length: u32) -> u32 {
        let (pixels, samples) = self.scale.ratio();
        (u64::from(length) * u64::from(samples)).div_ceil(u64::from(pixels)) as u32
    }

    /// Steps from one sample to the next.
    pub fn phases(self) -> u32 {
        let (pixels, _) = self.scale.ratio();
        match self.anchor {
            Anchor::Corner => pixels,
            Anchor::Centre => 2 * pixels,
        }
    }

    /// Where output pixel `at` lies: at `at / s` or `(at + ½) / s − ½` samples.
    pub fn place(self, at: u32) -> Place {
        self.place_beyond(i64::from(at))
    }

    /// [`Lattice::place`] for pixels outside of the picture, too.
    pub(super) fn place_beyond(self, at: i64) -> Place {
        let (pixels, samples) = self.scale.ratio();
        let (pixels, samples) = (i64::from(pixels), i64::from(samples));
        let (steps, phases) = match self.anchor {
            Anchor::Corner => (at * samples, pixels),
            Anchor::Centre => ((2 * at + 1) * samples - pixels, 2 * pixels),
        };
        Place { cell: steps.div_euclid(phases) as i32, phase: steps.rem_euclid(phases) as u32 }
    }

    /// [`Lattice::place`] of output pixel `first` and of all after it: by adding up, as thousands of divisions would take a
    /// tenth of the time of a fast kernel.
    pub(super) fn places_from(self, first: u32) -> impl Iterator<Item = Place> {
        let phases = self.phases();
        let (_, samples) = self.scale.ratio();
        let steps = match self.anchor {
            Anchor::Corner => samples,
            Anchor::Centre => 2 * samples,
        };
        std::iter::successors(Some(self.place(first)), move |Place { cell, phase }| {
            // A pixel is never wider than a sample, so at most one cell is left.
            let (phase, next) = (phase + steps, phase + steps >= phases);
            Some(Place { cell: cell + i32::from(next), phase: if next { phase - phases } else { phase } })
        })
    }

    /// Where sample `index` lies in the full picture, px.
    pub fn position_px(self, index: u32) -> f64 {
        match self.anchor {
            Anchor::Corner => f64::from(index) * self.scale.value() + 0.5,
            Anchor::Centre => (f64::from(index) + 0.5) * self.scale.value(),
        }
    }

    /// Where the outline of the samples begins in the full picture, px: sample i is seen at (i + ½) · s from there.
    pub fn origin_px(self) -> f64 {
        self.position_px(0) - 0.5 * self.scale.value()
    }

    /// The sample nearest to output pixel `at`, the first of two equally near; of `samples` samples.
    pub fn nearest(self, at: u32, samples: u32) -> u32 {
        self.nearest_to(self.place(at), samples)
    }

    /// [`Lattice::nearest`] to a place.
    pub(super) fn nearest_to(self, Place { cell, phase }: Place, samples: u32) -> u32 {
        let index = cell + i32::from(2 * phase > self.phases());
        (index.max(0) as u32).min(samples.saturating_sub(1))
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Every lattice.
    pub(in crate::upscale) fn every() -> impl Iterator<Item = Lattice> {
        let scales = [Scale::ONE, Scale::ONE_AND_A_HALF, Scale::TWO, Scale::THREE, Scale::FOUR];
        scales.into_iter().flat_map(|scale| Anchor::ALL.iter().map(move |anchor| Lattice { scale, anchor: *anchor }))
    }

    #[test]
    fn places_agree_with_the_positions_of_samples() {
        for lattice in every() {
            for at in 0..50 {
                let Place { cell, phase } = lattice.place(at);
                let origin = lattice.position_px(0);
                let place = (f64::from(at) + 0.5 - origin) / lattice.scale.value();
                let told = f64::from(cell) + f64::from(phase) / f64::from(lattice.phases());
                assert!(
                    (place - told).abs() < 1e-12 && phase < lattice.phases(),
                    "{lattice:?} {at}: {told}, not {place}"
                );
            }
        }
    }

    #[test]
    fn places_add_up_to_what_divisions_say() {
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
                }
            }
        }
    }
}
