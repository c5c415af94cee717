//! Pixels of a picture that are drawn.

use crate::pipeline::grid::SampleGrid;
use crate::pipeline::viewport::Viewport;

/// Pixels that are drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct DrawnArea {
    /// Grid that selects the drawn pixels of the rasterized picture.
    pub(super) grid: SampleGrid,
    /// Size of the rasterized picture.
    pub(super) raster: Viewport,
}

impl DrawnArea {
    /// Selects all pixels of a picture.
    pub(super) fn full(raster: Viewport) -> Self {
        Self { grid: SampleGrid::FULL, raster }
    }

    /// Returns the size of the packed picture of the drawn pixels.
    pub(super) fn packed_size(self) -> (u32, u32) {
        self.grid.packed_size(self.raster.width, self.raster.height)
    }
}
