//! Windows: rectangles of a large picture on which the search draws, instead of the whole picture.
//!
//! A window shows exactly the pixels of the whole picture, unlike a reduced picture, in which fill rules, antialiasing
//! and mip levels differ.

use rasterscope_engine::image::Image;
use rasterscope_engine::pipeline::viewport::Viewport;

/// Largest number of pixels of a picture that is searched as a whole.
const MOST_PIXELS: u32 = 640 * 480;

/// Number of windows in a larger picture.
const WINDOWS: usize = 4;

/// Largest width and height of a window, in pixels.
const SIDE_PX: [u32; 2] = [320, 192];

/// Multiple to which the corners of windows are aligned, in pixels, so that reduced pictures have the same samples.
const ALIGNMENT_PX: u32 = 16;

/// Factor by which the number of differing pixels counts less in a window that touches one chosen before.
const BESIDE: u64 = 4;

/// Rectangle of pixels in a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Window {
    /// Column of the left edge.
    pub(crate) x: u32,
    /// Row of the top edge.
    pub(crate) y: u32,
    /// Width in pixels.
    pub(crate) width: u32,
    /// Height in pixels.
    pub(crate) height: u32,
}

impl Window {
    /// Returns the window that is the whole picture.
    pub(crate) fn whole(Viewport { width, height }: Viewport) -> Self {
        Self { x: 0, y: 0, width, height }
    }

    /// Returns the windows on which a search draws: the whole picture, or those parts of a large one with most
    /// differing pixels, spread over the picture. `differs` says for each pixel whether it differs.
    pub(crate) fn sample(viewport: Viewport, differs: &Image<bool>) -> Vec<Self> {
        if viewport.width.saturating_mul(viewport.height) <= MOST_PIXELS {
            return vec![Self::whole(viewport)];
        }
        let mut cells: Vec<_> = Self::cells(viewport)
            .into_iter()
            .map(|cell| (cell.of(differs).pixels().iter().filter(|differs| **differs).count() as u64, cell))
            .collect();
        let mut chosen: Vec<Self> = Vec::new();
        while chosen.len() < WINDOWS {
            let Some(best) = (0..cells.len()).max_by_key(|index| cells[*index].0) else { break };
            let (_, window) = cells.swap_remove(best);
            cells.iter_mut().filter(|(_, cell)| cell.touches(window)).for_each(|(count, _)| *count /= BESIDE);
            chosen.push(window);
        }
        chosen
    }

    /// Divides a picture into windows of equal size; those at its right and bottom edges overlap their neighbours.
    fn cells(viewport: Viewport) -> Vec<Self> {
        let [width, height] = [viewport.width.min(SIDE_PX[0]), viewport.height.min(SIDE_PX[1])];
        let starts =
            |whole: u32, side: u32| (0..whole - side).step_by(side as usize).chain([whole - side]).collect::<Vec<_>>();
        let (columns, rows) = (starts(viewport.width, width), starts(viewport.height, height));
        rows.iter().flat_map(|y| columns.iter().map(|x| Self { x: *x, y: *y, width, height })).collect()
    }

    fn touches(self, other: Self) -> bool {
        let beside =
            |from: u32, side: u32, other: u32, other_side: u32| from <= other + other_side && other <= from + side;
        beside(self.x, self.width, other.x, other.width) && beside(self.y, self.height, other.y, other.height)
    }

    /// Returns the window extended by a multiple of the alignment on each side, as far as the picture reaches.
    pub(crate) fn extended(self, viewport: Viewport) -> Self {
        let (x, y) = (self.x.saturating_sub(ALIGNMENT_PX), self.y.saturating_sub(ALIGNMENT_PX));
        let right = (self.x + self.width + ALIGNMENT_PX).min(viewport.width);
        let bottom = (self.y + self.height + ALIGNMENT_PX).min(viewport.height);
        Self { x, y, width: right - x, height: bottom - y }
    }

    /// Returns the part of a picture inside the window.
    pub(crate) fn of<T: Copy>(self, picture: &Image<T>) -> Image<T> {
        Image::from_fn(self.width, self.height, |x, y| picture.at(self.x + x, self.y + y))
    }

    /// Returns the window in the coordinates of another one that contains it.
    pub(crate) fn within(self, outer: Self) -> Self {
        Self { x: self.x - outer.x, y: self.y - outer.y, ..self }
    }
}
