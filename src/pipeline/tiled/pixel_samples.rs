//! How often pixels are sampled, and where.

use super::jitter::{Jittered, Jittering};
use super::multisample::{Multisampling, Planes};
use crate::pipeline::grid::SampleGrid;

/// How pixels are sampled.
#[derive(Clone, Copy)]
pub enum PixelSamples<'a> {
    /// Once, at their centres.
    Centre,
    /// Several times, all together.
    Multisampled(Multisampling<'a>),
    /// Several times, elsewhere in each, one sample after the other.
    Jittered(Jittering<'a>),
}

impl PixelSamples<'_> {
    /// Where samples may lie, in grid steps from the centres of their pixels; none if there is but the centre.
    pub(super) fn offsets(&self) -> Vec<[i32; 2]> {
        match self {
            Self::Centre => Vec::new(),
            Self::Multisampled(samples) => samples.offsets.to_vec(),
            Self::Jittered(samples) => samples.places.as_flattened().to_vec(),
        }
    }
}

/// The same, ready for tiles.
pub(super) enum Samples<'a> {
    Centre,
    Multisampled(Planes<'a>),
    Jittered(Jittered<'a>),
}

impl<'a> Samples<'a> {
    pub(super) fn new(samples: PixelSamples<'a>, grid: SampleGrid, keep_depth: bool) -> Self {
        match samples {
            PixelSamples::Centre => Self::Centre,
            PixelSamples::Multisampled(samples) => Self::Multisampled(Planes::new(samples, grid, keep_depth)),
            PixelSamples::Jittered(samples) => Self::Jittered(Jittered::new(samples, grid)),
        }
    }
}
