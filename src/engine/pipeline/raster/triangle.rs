//! Triangle set up for rasterization: its three edges, and the rows and columns that they enclose.

use super::fill_rule::FillRule;
use super::numbers::{Numbers, RasterEdge};
use super::{PixelRange, RasterSample};

/// Triangle of nonzero area, set up for rasterization in one kind of arithmetic.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RasterTriangle<N: Numbers> {
    corners: [[N::Coordinate; 2]; 3],
    /// Edges, in the order of the vertices opposite them.
    edges: [N::Edge; 3],
    doubled_area: f64,
}

impl<N: Numbers> RasterTriangle<N> {
    /// Sets up the edges of a triangle from its vertices in pixels. Returns `None` if a coordinate is not finite or if
    /// the triangle has no area.
    pub(crate) fn new(corners_px: [[f32; 2]; 3], rule: FillRule) -> Option<Self> {
        let (area, scale) = doubled_area::<N>(corners_px)?;
        let corners = corners_px.map(|corner| corner.map(N::coordinate));
        let edge = |from: usize, to: usize| N::edge([corners[from], corners[to]], area.signum(), scale, rule);
        let edges = [edge(1, 2), edge(2, 0), edge(0, 1)];
        Some(Self { corners, edges, doubled_area: (area * scale).abs() })
    }

    /// Returns the doubled area of the triangle, which is positive, in the unit of its edge values.
    pub(crate) fn doubled_area(&self) -> f64 {
        self.doubled_area
    }

    /// Returns whether the triangle covers the centre of a pixel, by its fill rule.
    #[inline]
    pub(crate) fn contains(&self, column: i64, row: i64) -> bool {
        self.edges.iter().all(|edge| edge.contains(column, row))
    }

    /// Returns the sample at pixel (x, y) with its edge values, whether or not it is covered. `packed` is its column
    /// and row in the packed picture of drawn samples.
    #[inline]
    pub(crate) fn sample(&self, packed: (u32, u32), (x, y): (u32, u32)) -> RasterSample {
        let edges = self.edges.each_ref().map(|edge| edge.value(x.into(), y.into()));
        RasterSample { column: packed.0, row: packed.1, x, y, edges }
    }

    /// Returns the three edges, in the order of the vertices opposite them.
    pub(super) fn edges(&self) -> &[N::Edge; 3] {
        &self.edges
    }

    /// Returns the columns and rows of pixels whose centres lie within the bounding box.
    pub(super) fn bounds(&self) -> [PixelRange; 2] {
        [0, 1].map(|axis| {
            let [a, b, c] = self.corners.map(|corner| corner[axis]);
            let least = |a, b| if b < a { b } else { a };
            let greatest = |a, b| if b > a { b } else { a };
            PixelRange {
                first: N::first_centre(least(least(a, b), c)),
                last: N::last_centre(greatest(greatest(a, b), c)),
            }
        })
    }

    /// Returns the two sides between which rows are filled: one is the long edge, the other consists of the two short
    /// edges.
    pub(super) fn sides(&self) -> Sides<N::Edge> {
        let mut order = [0, 1, 2];
        let y = |corner: usize| self.corners[corner][1];
        if y(order[1]) < y(order[0]) {
            order.swap(0, 1);
        }
        if y(order[2]) < y(order[1]) {
            order.swap(1, 2);
        }
        if y(order[1]) < y(order[0]) {
            order.swap(0, 1);
        }
        let [top, middle, bottom] = order;
        let (upper, lower) = (self.edges[bottom], self.edges[top]);
        let (above, below) = (N::last_centre, N::first_centre);
        let long = self.edges[middle];
        // A row whose centres lie exactly on a horizontal edge belongs to the triangle that owns the edge. A row that
        // touches only a tip is kept; it can have a covered sample only under the inclusive fill rule.
        let first = if y(top) == y(middle) && !upper.owned() { above(y(top)) + 1 } else { below(y(top)) };
        let last = if y(middle) == y(bottom) && !lower.owned() { below(y(bottom)) - 1 } else { above(y(bottom)) };
        let last_upper = if y(middle) == y(bottom) { last } else { below(y(middle)) - 1 };
        Sides { long, upper, lower, rows: PixelRange { first, last }, last_upper }
    }
}

/// Returns the doubled signed area of a triangle, and the factor by which its edge values are scaled. The area is
/// positive if the triangle is clockwise for the viewer (y down). Returns `None` if the triangle has no area.
pub(super) fn doubled_area<N: Numbers>(corners_px: [[f32; 2]; 3]) -> Option<(f64, f64)> {
    if !corners_px.as_flattened().iter().all(|c| c.is_finite()) {
        return None;
    }
    let (area, scale) = N::doubled_area(corners_px.map(|corner| corner.map(N::coordinate)));
    (area != 0.0 && !area.is_nan()).then_some((area, scale))
}

/// Two sides of a triangle: the long edge, which spans all rows, and the two short edges opposite it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sides<E> {
    /// Edge from the top to the bottom vertex.
    pub(super) long: E,
    /// Edge from the top to the middle vertex. A horizontal edge bounds no row.
    pub(super) upper: E,
    /// Edge from the middle to the bottom vertex. A horizontal edge bounds no row.
    pub(super) lower: E,
    /// Pixel rows that may contain covered samples.
    pub(super) rows: PixelRange,
    /// Last pixel row that is bounded by the upper short edge.
    pub(super) last_upper: i64,
}

impl<E: RasterEdge> Sides<E> {
    /// Returns the short edge that a row crosses.
    pub(super) fn short(&self, row: i64) -> E {
        if row <= self.last_upper { self.upper } else { self.lower }
    }

    /// Returns whether the long edge is the left side.
    pub(super) fn long_is_left(&self) -> bool {
        self.long.inward().right > 0
    }
}
