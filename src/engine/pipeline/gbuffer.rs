//! G-buffer: the visible object of every pixel and its distance, for upscalers that read more than colours.

use crate::image::{Image, Rgba8};

/// Visible surface of every pixel in the full image, determined without shading. Alpha-tested and transparent surfaces
/// count as opaque.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct GBuffer {
    /// Index of the instance in each pixel, as four bytes, least significant first; [`GBuffer::NO_OBJECT`] where there
    /// is none.
    pub(crate) object: Image<Rgba8>,
    /// Distance along the view axis, in world units. Where there is no surface, it is infinite or the distance of the
    /// far plane.
    pub(crate) distance: Image<f32>,
}

/// Relative difference up to which two distances count as equal: depths are rounded, and pixels sample slightly
/// different positions.
pub(crate) const SAME_DISTANCE: f32 = 0.02;

impl GBuffer {
    /// Value of [`GBuffer::object`] in pixels without a surface.
    pub(crate) const NO_OBJECT: Rgba8 = [u8::MAX; 4];

    /// Whether a pixel shows this object at about this distance.
    pub(crate) fn shows(&self, (x, y): (u32, u32), object: Rgba8, distance: f32) -> bool {
        let there = self.distance.at(x, y);
        let near = (there - distance).abs() <= SAME_DISTANCE * distance.abs();
        self.object.at(x, y) == object && (near || there == distance)
    }

    /// Returns the pixel with the nearest surface among the 3 × 3 pixels around a pixel; see [`NearestSearch::of`].
    #[inline(always)]
    pub(crate) fn nearest_around(&self, (x, y): (u32, u32)) -> (u32, u32) {
        NearestSearch::new(&self.distance, y).of(x)
    }

    /// Whether two pixels show the same object at about the same distance.
    pub(crate) fn same_surface(&self, a: (u32, u32), b: (u32, u32)) -> bool {
        self.shows(a, self.object.at(b.0, b.1), self.distance.at(b.0, b.1))
    }
}

/// Nearest surface among three vertically adjacent pixels.
#[derive(Clone, Copy, Debug)]
struct NearestInColumn {
    distance: f32,
    row: u32,
}

/// Search for the nearest surface among 3 × 3 pixels, along a row.
pub(crate) struct NearestSearch<'a> {
    /// Rows of distances: that of the pixel, the one above and the one below.
    distance: [&'a [f32]; 3],
    rows: [u32; 3],
    /// Nearest surfaces of the columns before, at and after the pixel with this index.
    held: Option<(u32, [NearestInColumn; 3])>,
}

impl<'a> NearestSearch<'a> {
    /// Prepares the search around the pixels of row `y`.
    #[inline(always)]
    pub(crate) fn new(distance: &'a Image<f32>, y: u32) -> Self {
        let rows = [y, y.saturating_sub(1), (y + 1).min(distance.height() - 1)];
        Self { distance: rows.map(|row| distance.row(row)), rows, held: None }
    }

    #[inline(always)]
    fn column(&self, x: u32) -> NearestInColumn {
        let [at, above, below] = self.distance.map(|row| row[x as usize]);
        let mut nearest = NearestInColumn { distance: at, row: self.rows[0] };
        for (distance, row) in [(above, self.rows[1]), (below, self.rows[2])] {
            if distance < nearest.distance {
                nearest = NearestInColumn { distance, row };
            }
        }
        nearest
    }

    /// Returns the pixel with the nearest surface around column `x`. The pixel's own column wins ties, and in a column the
    /// pixel's own row. Ascending columns are searched fastest.
    #[inline(always)]
    pub(crate) fn of(&mut self, x: u32) -> (u32, u32) {
        let last = self.distance[0].len() as u32 - 1;
        let (before, after) = (x.saturating_sub(1), (x + 1).min(last));
        let columns = match self.held {
            Some((held, [_, at, next])) if held + 1 == x => [at, next, self.column(after)],
            _ => [self.column(before), self.column(x), self.column(after)],
        };
        self.held = Some((x, columns));
        let [left, at, right] = columns;
        let (mut nearest, mut place) = (at, x);
        for (column, x) in [(left, before), (right, after)] {
            if column.distance < nearest.distance {
                (nearest, place) = (column, x);
            }
        }
        (place, nearest.row)
    }
}
