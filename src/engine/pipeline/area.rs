//! Pixels of a picture that are drawn.

use super::grid::SampleGrid;
use super::viewport::Viewport;

/// Drawn part of a rasterized picture.
#[derive(Clone, Copy, Debug)]
pub struct DrawnArea {
    /// Grid that selects the drawn pixels of the rasterized picture.
    pub grid: SampleGrid,
    /// Size of the rasterized picture, in pixels.
    pub raster: Viewport,
}

impl DrawnArea {
    /// Selects all pixels of a picture.
    pub(crate) fn full(raster: Viewport) -> Self {
        Self { grid: SampleGrid::FULL, raster }
    }

    /// Returns the size of the packed picture of the drawn pixels.
    pub(crate) fn packed_size(self) -> (u32, u32) {
        self.grid.packed_size(self.raster.width, self.raster.height)
    }
}
