//! Polygon edges and the columns in which they cross rows.

use std::cmp::Ordering;
use std::ops::Range;

use glam::DVec2;

use super::SamplePoint;
use crate::flat2d::side;

/// Polygon edge that crosses at least one row of samples, stored from top to bottom.
#[derive(Clone, Debug)]
pub(super) struct PolygonEdge {
    pub(super) top: DVec2,
    pub(super) bottom: DVec2,
    /// Rows whose samples lie between the endpoints; at least one.
    pub(super) rows: Range<u32>,
    /// Orientation: 1 if the edge was given from top to bottom, −1 otherwise.
    pub(super) winding: i32,
}

/// Sample positions in one row of the picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct SampleRow {
    row: u32,
    offset: f64,
    width: u32,
}

impl SampleRow {
    pub(super) fn new(row: u32, sample: SamplePoint, width: u32) -> Self {
        Self { row, offset: sample.offset(), width }
    }

    /// Returns the y coordinate of the samples, px.
    fn y(self) -> f64 {
        f64::from(self.row) + self.offset
    }
}

impl PolygonEdge {
    /// Creates an edge between two corners; `None` if it crosses no row of samples in a picture of this height.
    pub(super) fn new(from: DVec2, to: DVec2, sample: SamplePoint, height: u32) -> Option<Self> {
        let (top, bottom, winding) = if from.y <= to.y { (from, to, 1) } else { (to, from, -1) };
        // Casts saturate. A negative difference gives row 0, so its rounding is harmless; other differences are exact.
        let row_at_or_below = |y: f64| ((y - sample.offset()).ceil() as u32).min(height);
        let rows = row_at_or_below(top.y)..row_at_or_below(bottom.y);
        (!rows.is_empty()).then_some(Self { top, bottom, rows, winding })
    }

    /// Returns the first column whose sample lies at or right of the crossing with a row, or the picture's width if
    /// there is none. The result is exact.
    pub(super) fn column_at(&self, row: SampleRow) -> u32 {
        let slant = Slant::new(self);
        slant.column_at(row).unwrap_or_else(|| self.search(&slant, row))
    }

    /// Computes [`PolygonEdge::column_at`] by a binary search with exact tests of single samples, for crossings that
    /// floats cannot decide.
    #[cold]
    pub(super) fn search(&self, slant: &Slant, row: SampleRow) -> u32 {
        let crossing = slant.crossing_px(row) - row.offset;
        let within = |column: f64| ceil(column.clamp(0.0, f64::from(row.width))).1;
        let (mut least, mut greatest) = (within(crossing - slant.error_px), within(crossing + slant.error_px));
        while least < greatest {
            let middle = least + (greatest - least) / 2;
            let sample = DVec2::new(f64::from(middle) + row.offset, row.y());
            // The edge points down, so its left side is the right side of the screen.
            if side(self.top, self.bottom, sample) == Ordering::Greater {
                least = middle + 1;
            } else {
                greatest = middle;
            }
        }
        greatest
    }
}

/// Float approximation of an edge, for its crossings with rows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slant {
    top: DVec2,
    /// Change of x per row, in pixels.
    slope: f64,
    /// Upper bound on the rounding error of a crossing, in pixels.
    error_px: f64,
}

/// Error bound of a crossing computed in floats, relative to |x₀| + |x₁|, where x₀ and x₁ are the endpoints' x
/// coordinates.
///
/// Computing the slope and the distance below the top takes four roundings of at most ε/2 each. The product of slope
/// and distance, which is at most the edge's width, adds one rounding. Adding x at the top and subtracting the sample's
/// offset add one rounding each. The rest is margin.
const ERROR_OF_CROSSING: f64 = 16.0 * f64::EPSILON;

impl Slant {
    pub(super) fn new(edge: &PolygonEdge) -> Self {
        let PolygonEdge { top, bottom, .. } = edge;
        Self {
            top: *top,
            slope: (bottom.x - top.x) / (bottom.y - top.y),
            error_px: ERROR_OF_CROSSING * (top.x.abs() + bottom.x.abs()),
        }
    }

    /// Returns the x coordinate, in pixels, at which the edge crosses a row, up to rounding.
    #[inline]
    pub(super) fn crossing_px(&self, row: SampleRow) -> f64 {
        self.top.x + (row.y() - self.top.y) * self.slope
    }

    /// Returns the first column whose sample lies at or right of the crossing with a row, or the picture's width if
    /// there is none. Returns `None` if the crossing is too close to a sample for floats to decide.
    #[inline]
    pub(super) fn column_at(&self, row: SampleRow) -> Option<u32> {
        // The distance outside the picture is irrelevant, so the crossing is clamped to the picture.
        let crossing = (self.crossing_px(row) - row.offset).clamp(-0.5, f64::from(row.width) - 0.5);
        let (nearest, column) = ceil(crossing);
        ((crossing - nearest).abs() > self.error_px).then_some(column)
    }
}

/// Returns the whole number nearest to `x`, and the smallest whole number that is at least `x`. `x` must lie in [−½,
/// 2³¹].
#[inline]
fn ceil(x: f64) -> (f64, u32) {
    /// Magnitude at which adjacent floats differ by 1. Adding it rounds a float to a whole number, which is then in the
    /// low bits of the sum. This avoids the standard library's rounding, which compiles to a function call without SSE
    /// 4.1.
    const ROUNDING: f64 = 1.5 * (1_u64 << 52) as f64;
    let shifted = x + ROUNDING;
    let nearest = shifted - ROUNDING;
    (nearest, shifted.to_bits() as u32 + u32::from(nearest < x))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ceil_is_the_standard_one() {
        let mut random = fastrand::Rng::with_seed(64);
        for round in 0..100_000 {
            let x = random.f64() * [1.0, 100.0, 20_000.0][round % 3] - 0.5;
            let x = if round % 7 == 0 { x.round() + 0.0 } else { x };
            let (nearest, column) = ceil(x);
            assert_eq!(f64::from(column), x.ceil(), "{x}");
            assert!((x - nearest).abs() <= 0.5 && nearest.fract() == 0.0, "{x}: {nearest}");
        }
        assert_eq!([-0.5, 0.5, 16_383.5].map(|x| ceil(x).1), [0, 1, 16_384]);
    }
}
