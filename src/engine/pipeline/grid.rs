//! Sample grids: the subset of the full picture's pixels that is drawn.
//!
//! An upscaler that shades a quarter of the pixels must also *visit* only a quarter of them: skipping inside the pixel
//! loop saves shading but still walks every pixel. The rasterizer therefore walks a [`SampleGrid`]: the drawn samples,
//! packed into a smaller picture. Every sample keeps its position in the full picture, and vertices are snapped at full
//! resolution. Each drawn sample is therefore bit-identical to the same sample of the full picture.

/// Subset of the picture's pixels that is drawn, packed into a smaller picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SampleGrid {
    /// One sample per block of `step` × `step` pixels; the packed size is `ceil(size / step)`.
    ///
    /// `step` 1 draws every pixel. The sample lies at the centre of the block's top-left pixel.
    Block {
        /// Side length of the block in pixels, at least 1.
        step: u32,
    },
    /// Checkerboard of squares of 2 × 2 pixels. Draws the squares that have the same colour as the top-left one. Of
    /// every four consecutive pixels, a row of the packed picture holds the two that are drawn.
    Checkerboard,
    /// Checkerboard of squares of 2 × 2 pixels. Draws the squares that [`SampleGrid::Checkerboard`] does not draw.
    OddCheckerboard,
}

impl SampleGrid {
    /// Grid that draws every pixel.
    pub(crate) const FULL: Self = Self::Block { step: 1 };

    /// Returns the size of the packed picture for a full picture of `width` × `height` px.
    pub(crate) fn packed_size(self, width: u32, height: u32) -> (u32, u32) {
        match self {
            Self::Block { step } => (width.div_ceil(step), height.div_ceil(step)),
            // Rows that start with a drawn square have the most samples: 2 of each 4 pixels, and up to 2 of the
            // remainder.
            Self::Checkerboard | Self::OddCheckerboard => (width / 4 * 2 + (width % 4).min(2), height),
        }
    }

    /// Returns the pixel of the full picture to which the sample at `column` and `row` of the packed picture belongs.
    #[inline]
    pub fn pixel(self, column: u32, row: u32) -> (u32, u32) {
        match self {
            Self::Block { step } => (column * step, row * step),
            Self::Checkerboard | Self::OddCheckerboard => (column / 2 * 4 + column % 2 + self.first_drawn(row), row),
        }
    }

    /// Returns the column and row in the packed picture of pixel (x, y) of the full picture, or `None` if that pixel is
    /// not drawn.
    #[inline]
    pub fn sample_at(self, x: u32, y: u32) -> Option<(u32, u32)> {
        match self {
            Self::Block { step } => (x.is_multiple_of(step) && y.is_multiple_of(step)).then(|| (x / step, y / step)),
            Self::Checkerboard | Self::OddCheckerboard => {
                let within = x.checked_sub(self.first_drawn(y))?;
                (within % 4 < 2).then_some((within / 4 * 2 + within % 4, y))
            }
        }
    }

    /// Returns the half-open range of rows of the packed picture whose samples may lie within the pixel rows `from..to`
    /// of the full picture.
    pub(crate) fn rows(self, from: u32, to: u32) -> std::ops::Range<u32> {
        match self {
            Self::Block { step } => from.div_ceil(step)..to.div_ceil(step),
            Self::Checkerboard | Self::OddCheckerboard => from..to,
        }
    }

    /// Returns the half-open range of columns, in row `row` of the packed picture, whose samples lie within the pixel
    /// columns `from..to` of the full picture.
    pub(crate) fn columns(self, row: u32, from: u32, to: u32) -> std::ops::Range<u32> {
        match self {
            Self::Block { step } => from.div_ceil(step)..to.div_ceil(step),
            Self::Checkerboard | Self::OddCheckerboard => {
                let drawn_before = |x: u32| {
                    let within = x.saturating_sub(self.first_drawn(row));
                    within / 4 * 2 + (within % 4).min(2)
                };
                drawn_before(from)..drawn_before(to)
            }
        }
    }

    /// Returns the number of drawn pixels in a picture of `width` × `height` px.
    pub(crate) fn drawn_pixels(self, width: u32, height: u32) -> u64 {
        self.rows(0, height).map(|row| self.columns(row, 0, width).len() as u64).sum()
    }

    /// Returns the column of the first drawn pixel of a checkerboard row: 0 or 2, alternating every two rows.
    #[inline]
    pub(super) fn first_drawn(self, y: u32) -> u32 {
        if self == Self::OddCheckerboard { !y & 2 } else { y & 2 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRIDS: [SampleGrid; 5] = [
        SampleGrid::FULL,
        SampleGrid::Block { step: 2 },
        SampleGrid::Block { step: 4 },
        SampleGrid::Checkerboard,
        SampleGrid::OddCheckerboard,
    ];

    #[test]
    fn every_drawn_pixel_has_one_place_in_the_packed_picture() {
        for grid in GRIDS {
            for (width, height) in [(1, 1), (2, 3), (5, 4), (7, 9), (16, 8)] {
                let (packed_width, packed_height) = grid.packed_size(width, height);
                let mut drawn = 0;
                for y in 0..height {
                    for x in 0..width {
                        if let Some((column, row)) = grid.sample_at(x, y) {
                            assert!(column < packed_width && row < packed_height, "{grid:?} {width}×{height} {x},{y}");
                            assert_eq!(grid.pixel(column, row), (x, y), "{grid:?}");
                            drawn += 1;
                        }
                    }
                }
                assert_eq!(drawn, grid.drawn_pixels(width, height), "{grid:?} {width}×{height}");
            }
        }
    }

    #[test]
    fn ranges_hold_exactly_the_samples_within_them() {
        for grid in GRIDS {
            for y in 0..9 {
                for from in 0..12 {
                    for to in from..12 {
                        let inside: Vec<_> = (from..to).filter_map(|x| grid.sample_at(x, y)).collect();
                        for (_, row) in &inside {
                            assert!(grid.rows(y, y + 1).contains(row));
                            let columns: Vec<_> = grid.columns(*row, from, to).collect();
                            assert_eq!(
                                columns,
                                inside.iter().map(|s| s.0).collect::<Vec<_>>(),
                                "{grid:?} {from}..{to}"
                            );
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn the_checkerboard_draws_half() {
        assert_eq!(SampleGrid::Checkerboard.drawn_pixels(16, 16), 128);
        for (x, y) in (0..9).flat_map(|y| (0..9).map(move |x| (x, y))) {
            let drawn =
                [SampleGrid::Checkerboard, SampleGrid::OddCheckerboard].map(|grid| grid.sample_at(x, y).is_some());
            assert!(drawn[0] != drawn[1], "({x}, {y})");
        }
    }
}
