//! Blended triangles of a tile, and their fragments, sorted by sample and depth before they are blended.

use super::classic::ClassicTriangle;
use super::slot::Slot;
use super::tested::{TestedRows, TestedSample};
use crate::pipeline::blending::nearness;
use crate::pipeline::raster::RasterSample;
use crate::pipeline::settings::Settings;

/// Blended triangle of a tile.
pub(super) struct BlendedTriangle<'a> {
    pub(super) slot: Slot,
    /// Index of the triangle's draw in the frame's list of draws.
    pub(super) draw: usize,
    pub(super) classic: ClassicTriangle<'a>,
}

/// Fragment that passed the depth test and is not yet blended.
#[derive(Clone, Copy, Debug)]
pub(super) struct SortedFragment {
    /// Index of the fragment's sample in the tile.
    pub(super) at: usize,
    nearness: f32,
    /// Index of the fragment's triangle in the list of blended triangles.
    pub(super) triangle: usize,
    /// Edge values at the shading position, one per edge.
    pub(super) edges: [f64; 3],
}

/// List of the blended fragments of a tile.
pub(super) struct SortedFragments<'a> {
    settings: &'a Settings,
    triangles: &'a [BlendedTriangle<'a>],
    fragments: Vec<SortedFragment>,
}

impl<'a> SortedFragments<'a> {
    pub(super) fn new(settings: &'a Settings, triangles: &'a [BlendedTriangle<'a>]) -> Self {
        Self { settings, triangles, fragments: Vec::new() }
    }

    /// Returns the number of fragments.
    pub(super) fn len(&self) -> usize {
        self.fragments.len()
    }

    /// Adds the fragments of a blended triangle, one for each sample selected by `shading.passed`.
    ///
    /// `shading` has the edge values at the shading positions, and `tested` has the edge values at the samples
    /// themselves. `number` is the index of the triangle, and `first` the index of the tile's first sample.
    pub(super) fn add(&mut self, number: usize, first: usize, tested: &TestedRows, shading: &TestedRows) {
        let triangle = &self.triangles[number].classic.triangle;
        let own = TestedRows { passed: shading.passed, ..*tested };
        for (TestedSample { place, edges, .. }, shaded) in own.samples().zip(shading.samples()) {
            // Column, row and position can all be zero, because depth depends only on the edge values.
            let sample = RasterSample { column: 0, row: 0, x: 0, y: 0, edges };
            self.fragments.push(SortedFragment {
                at: first + place.index(),
                nearness: nearness(self.settings, triangle, &sample),
                triangle: number,
                edges: shaded.edges,
            });
        }
    }

    /// Returns all fragments ordered by sample, and within each sample from far to near. Fragments of equal depth are
    /// in the order of their triangles.
    pub(super) fn sorted(mut self) -> impl Iterator<Item = SortedFragment> {
        let key = |one: &SortedFragment| (one.at, one.triangle);
        self.fragments
            .sort_unstable_by(|a, b| a.at.cmp(&b.at).then(a.nearness.total_cmp(&b.nearness)).then(key(a).cmp(&key(b))));
        self.fragments.into_iter()
    }
}
