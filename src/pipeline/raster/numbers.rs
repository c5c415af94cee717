//! What the rasterizers ask of numbers, so that each is written once and runs in every arithmetic.
//!
//! A rasterizer knows columns and rows of pixels, and edges that answer three questions: on which side of you does this
//! pixel's centre lie; at which column does this row cross you; and what is your value there. How corners are held, and
//! whether the answers are exact, is the arithmetic's business.

use super::steps::EdgeSteps;
use crate::pipeline::settings::FillRule;

/// Numbers to rasterize with.
pub trait Numbers: Copy {
    /// A coordinate of a corner.
    type Coordinate: Copy + PartialOrd;
    /// An edge between two corners.
    type Edge: Edge;

    /// A screen coordinate in px, which must be finite, as this arithmetic holds it.
    fn coordinate(px: f32) -> Self::Coordinate;

    /// Doubled signed area of a triangle, positive if clockwise for the viewer (y down), and the power of two that brings
    /// it near 1 where the arithmetic has no unit of its own. NaN if the numbers do not suffice to tell.
    fn doubled_area(corners: [[Self::Coordinate; 2]; 3]) -> (f64, f64);

    /// The edge from one corner to the next of a triangle of this sign of the area. `scale` multiplies its values.
    fn edge(ends: [[Self::Coordinate; 2]; 2], sign: f64, scale: f64, rule: FillRule) -> Self::Edge;

    /// The first pixel whose centre is not before a coordinate.
    fn first_centre(coordinate: Self::Coordinate) -> i64;

    /// The last pixel whose centre is not after a coordinate.
    fn last_centre(coordinate: Self::Coordinate) -> i64;
}

/// One edge of a triangle. Values are positive inside the triangle and zero on the line.
pub trait Edge: Copy {
    /// Steps along the rows that the edge crosses.
    type Walk: Walk;

    /// Where the inside lies.
    fn inward(&self) -> Inward;

    /// Whether pixel centres on the line belong to the triangle.
    fn owned(&self) -> bool;

    /// The value at the centre of a pixel, scaled as the doubled area is.
    fn value(&self, column: i64, row: i64) -> f64;

    /// Whether the centre of a pixel is inside, or on the line and owned.
    fn contains(&self, column: i64, row: i64) -> bool;

    /// How the value at the centre of a pixel comes about.
    fn steps(&self, column: i64, row: i64) -> EdgeSteps;

    /// The first column of a row that lies beyond the edge: inside for a left edge, outside for a right one. Not for
    /// horizontal edges. Exact arithmetic clamps it to the columns that a picture can have.
    fn boundary(&self, row: i64) -> i64;

    /// A walk down the edge, starting on `row`.
    fn walk(&self, row: i64) -> Self::Walk;
}

/// The boundary of an edge, row after row.
pub trait Walk {
    /// [`Edge::boundary`] of the present row.
    fn boundary(&self) -> i64;

    /// Goes on to the next row.
    fn step(&mut self);
}

/// Direction from an edge to the inside of its triangle: horizontally and vertically.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Inward {
    /// −1 to the left (a right edge), 1 to the right (a left edge), 0 for a horizontal edge.
    pub right: i8,
    /// −1 upwards (a bottom edge), 1 downwards (a top edge), 0 for a vertical edge.
    pub down: i8,
}

impl Inward {
    /// From the signs of the edge function's derivatives.
    pub fn new<T: PartialOrd + Default>(by_x: T, by_y: T) -> Self {
        let sign = |v: T| i8::from(v > T::default()) - i8::from(v < T::default());
        Self { right: sign(by_x), down: sign(by_y) }
    }

    /// Whether the fill rule gives pixel centres on such an edge to the triangle.
    pub fn owned(self, rule: FillRule) -> bool {
        let Self { right, down } = self;
        match rule {
            FillRule::TopLeft => right > 0 || (right == 0 && down > 0),
            FillRule::TopRight => right < 0 || (right == 0 && down > 0),
            FillRule::BottomLeft => right > 0 || (right == 0 && down < 0),
            FillRule::BottomRight => right < 0 || (right == 0 && down < 0),
            FillRule::Inclusive => true,
            FillRule::Exclusive => false,
        }
    }

    /// Whether a pixel centre that lies exactly where a row crosses the edge is already beyond it: it is for a left edge
    /// that owns it, and for a right edge that does not.
    pub fn tie_is_beyond(self, owned: bool) -> bool {
        (self.right > 0) == owned
    }
}
