//! Sampling modes: number and positions of the samples of a pixel.

use super::jitter::{Jittering, TileJitter};
use super::multisample::{Multisampling, SamplePlanes};
use crate::pipeline::grid::SampleGrid;

/// Sampling mode of a frame, with the sample positions in each pixel.
#[derive(Clone, Copy)]
pub(crate) enum PixelSamples<'a> {
    /// One sample at the centre of each pixel.
    Centre,
    /// Multisampling: several samples per pixel, drawn together and shaded once per visible triangle.
    Multisampled(Multisampling<'a>),
    /// Jittered supersampling: several samples at different positions in each pixel, drawn one after the other.
    Jittered(Jittering<'a>),
}

impl PixelSamples<'_> {
    /// Returns the possible sample offsets from the pixel centre, in steps of 1/256 px; empty if only centres are
    /// sampled.
    pub(super) fn offsets(&self) -> Vec<[i32; 2]> {
        match self {
            Self::Centre => Vec::new(),
            Self::Multisampled(samples) => samples.offsets.to_vec(),
            Self::Jittered(samples) => samples.places.as_flattened().to_vec(),
        }
    }
}

/// Sampling mode of a frame, with the lattices on which tiles are drawn.
pub(super) enum PreparedSamples<'a> {
    Centre,
    Multisampled(SamplePlanes<'a>),
    Jittered(TileJitter<'a>),
}

impl<'a> PreparedSamples<'a> {
    pub(super) fn new(samples: PixelSamples<'a>, grid: SampleGrid, keep_depth: bool) -> Self {
        match samples {
            PixelSamples::Centre => Self::Centre,
            PixelSamples::Multisampled(samples) => Self::Multisampled(SamplePlanes::new(samples, grid, keep_depth)),
            PixelSamples::Jittered(samples) => Self::Jittered(TileJitter::new(samples, grid)),
        }
    }
}
