//! Positions of the pixels of a G-buffer in the full picture.

use arrayvec::ArrayVec;

use crate::pipeline::gbuffer::GBuffer;
use crate::upscale::{Lattice, Sampling, Scale};

/// Positions of the pixels of a G-buffer in the full picture.
#[derive(Clone, Copy, Debug)]
pub(in crate::upscale) struct SurfaceGrid {
    /// Size of the G-buffer, in pixels.
    size: (u32, u32),
    /// Lattice of the pixels; `None` if they are those of the full picture.
    lattice: Option<Lattice>,
}

/// Columns or rows of a G-buffer around an output column or row, the closest one first. There are three if the G-buffer has
/// the pixels of the full picture, and two otherwise. Those outside are clamped.
pub(in crate::upscale) type Around = ArrayVec<u32, 3>;

impl SurfaceGrid {
    /// Returns the positions for a G-buffer of `size` px, with one pixel per sample of a lattice and otherwise the pixels of
    /// the full picture.
    pub(super) fn new(sampling: Sampling, size: (u32, u32)) -> Self {
        let lattice = match sampling {
            Sampling::Lattice(lattice) if lattice.scale != Scale::ONE => Some(lattice),
            Sampling::Lattice(_) | Sampling::Grid(_) => None,
        };
        Self { size, lattice }
    }

    /// Returns the columns of the G-buffer around output column `x`.
    #[inline(always)]
    pub(in crate::upscale) fn columns(&self, x: u32) -> Around {
        self.around(x, self.size.0)
    }

    /// Returns the rows of the G-buffer around output row `y`.
    #[inline(always)]
    pub(in crate::upscale) fn rows(&self, y: u32) -> Around {
        self.around(y, self.size.1)
    }

    #[inline(always)]
    fn around(&self, at: u32, length: u32) -> Around {
        match self.lattice {
            Some(lattice) => {
                let (mut two, is_second_closer) = lattice.between(at, length);
                if is_second_closer {
                    two.reverse();
                }
                ArrayVec::from_iter(two)
            }
            None => ArrayVec::from([at, at.saturating_sub(1), (at + 1).min(length - 1)]),
        }
    }

    /// Returns the columns of the G-buffer to the left and to the right of output column `x`, and whether the right one is
    /// closer. Returns `None` if the G-buffer has the pixels of the full picture.
    pub(super) fn left_and_right(&self, x: u32) -> Option<([u32; 2], bool)> {
        Some(self.lattice?.between(x, self.size.0))
    }

    /// Returns the pixel of the G-buffer that is nearest to pixel `at` of the full picture.
    #[inline(always)]
    pub(super) fn nearest(&self, (x, y): (u32, u32)) -> (u32, u32) {
        let Some(lattice) = self.lattice else { return (x, y) };
        (lattice.nearest(x, self.size.0), lattice.nearest(y, self.size.1))
    }

    /// Returns the pixel of the G-buffer with the nearest of the surfaces around pixel `at` of the full picture. The first
    /// column wins ties, and in a column the first row.
    #[inline(always)]
    pub(super) fn nearest_surface(&self, gbuffer: &GBuffer, (x, y): (u32, u32)) -> (u32, u32) {
        let rows = self.rows(y);
        let candidates = self.columns(x).into_iter().flat_map(|column| rows.iter().map(move |row| (column, *row)));
        let nearer = |a: (u32, u32), b: (u32, u32)| {
            let is_nearer = gbuffer.distance.at(b.0, b.1) < gbuffer.distance.at(a.0, a.1);
            if is_nearer { b } else { a }
        };
        candidates.reduce(nearer).unwrap_or((x, y))
    }
}
