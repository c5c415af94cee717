//! Arithmetic interface of the rasterizers: each algorithm is written once and runs in every arithmetic.
//!
//! A rasterizer deals with columns and rows of pixels, and with three operations on an edge: whether a pixel's centre
//! is inside, at which column a row crosses the edge, and the edge value at a pixel's centre. The arithmetic decides
//! how vertices are represented and whether results are exact.

use super::fill_rule::FillRule;
use super::inward::Inward;
use super::steps::EdgeSteps;

/// Arithmetic in which triangles are rasterized.
pub(crate) trait Numbers: Copy {
    /// Coordinate of a vertex in this arithmetic.
    type Coordinate: Copy + PartialOrd;
    /// Edge between two vertices in this arithmetic.
    type Edge: RasterEdge;

    /// Converts a finite screen coordinate in pixels to this arithmetic.
    fn coordinate(px: f32) -> Self::Coordinate;

    /// Returns the doubled signed area of a triangle, and the factor by which its edge values are scaled. The area is
    /// positive if the triangle is clockwise for the viewer (y down), and NaN if an overflow leaves it undefined. The
    /// factor is a power of two that brings the magnitude of the area near 1; in fixed point it is 1.
    fn doubled_area(corners: [[Self::Coordinate; 2]; 3]) -> (f64, f64);

    /// Returns the edge between two consecutive vertices of a triangle. `sign` is the sign of the triangle's area.
    /// `scale` is the factor by which edge values are scaled.
    fn edge(ends: [[Self::Coordinate; 2]; 2], sign: f64, scale: f64, rule: FillRule) -> Self::Edge;

    /// Returns the index of the first pixel along one axis whose centre lies at or after a coordinate.
    fn first_centre(coordinate: Self::Coordinate) -> i64;

    /// Returns the index of the last pixel along one axis whose centre lies at or before a coordinate.
    fn last_centre(coordinate: Self::Coordinate) -> i64;
}

/// Edge of a triangle. Values of its edge function are positive inside the triangle and zero on the edge.
pub(crate) trait RasterEdge: Copy {
    /// Type that steps down the edge from row to row.
    type Walk: BoundaryWalk;

    /// Returns the direction from the edge to the inside of the triangle.
    fn inward(&self) -> Inward;

    /// Returns whether pixel centres exactly on the edge belong to the triangle, according to the fill rule.
    fn owned(&self) -> bool;

    /// Returns the value of the edge function at the centre of a pixel, in the unit of the triangle's doubled area.
    fn value(&self, column: i64, row: i64) -> f64;

    /// Returns whether the centre of a pixel lies on the inner side of the edge, or exactly on the edge if the triangle
    /// owns it.
    fn contains(&self, column: i64, row: i64) -> bool;

    /// Returns the intermediate values of the edge function at the centre of a pixel.
    fn steps(&self, column: i64, row: i64) -> EdgeSteps;

    /// Returns, for a row, the first column whose pixel centre lies to the right of the edge. For a left edge, this is
    /// the first column inside the edge; for a right edge, the first column outside. Not defined for horizontal edges.
    /// Exact arithmetic clamps the result to the columns that a picture can have.
    fn boundary(&self, row: i64) -> i64;

    /// Starts a row-by-row walk down the edge, at `row`.
    fn walk(&self, row: i64) -> Self::Walk;
}

/// Row-by-row walk down an edge, which gives the edge's boundary column on each row.
pub(crate) trait BoundaryWalk {
    /// Returns the boundary column of the edge on the current row: see [`RasterEdge::boundary`].
    fn boundary(&self) -> i64;

    /// Advances to the next row.
    fn step(&mut self);
}
