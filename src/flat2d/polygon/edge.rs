//! One edge of a polygon, and which column it falls into.

use std::cmp::Ordering;
use std::ops::Range;

use glam::DVec2;

use super::SamplePoint;
use crate::flat2d::side;

/// An edge that crosses rows of the picture, from top to bottom.
#[derive(Clone, Debug)]
pub(super) struct Edge {
    pub(super) top: DVec2,
    pub(super) bottom: DVec2,
    /// The rows that it crosses, at least one.
    pub(super) rows: Range<u32>,
    /// 1 if it was given from top to bottom, −1 otherwise.
    pub(super) winding: i32,
}

/// Samples along a row of the picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    row: u32,
    offset: f64,
    width: u32,
}

impl Row {
    pub(super) fn new(row: u32, sample: SamplePoint, width: u32) -> Self {
        Self { row, offset: sample.offset(), width }
    }

    /// Height of its samples, px.
    fn y(self) -> f64 {
        f64::from(self.row) + self.offset
    }
}

impl Edge {
    /// `None` if it crosses no row of samples in a picture of this height.
    pub(super) fn new(from: DVec2, to: DVec2, sample: SamplePoint, height: u32) -> Option<Self> {
        let (top, bottom, winding) = if from.y <= to.y { (from, to, 1) } else { (to, from, -1) };
        // Casts saturate; above row 0 rounding does no harm, and from there on the difference has none.
        let row_at_or_below = |y: f64| ((y - sample.offset()).ceil() as u32).min(height);
        let rows = row_at_or_below(top.y)..row_at_or_below(bottom.y);
        (!rows.is_empty()).then_some(Self { top, bottom, rows, winding })
    }

    /// The first column whose sample lies at or right of where it crosses a row, exactly; the width if none does.
    pub(super) fn column_at(&self, row: Row) -> u32 {
        let slant = Slant::new(self);
        slant.column_at(row).unwrap_or_else(|| self.search(&slant, row))
    }

    /// The same where floats are not sure, by asking for single samples exactly.
    #[cold]
    pub(super) fn search(&self, slant: &Slant, row: Row) -> u32 {
        let crossing = slant.crossing_px(row) - row.offset;
        let within = |column: f64| ceil(column.clamp(0.0, f64::from(row.width))).1;
        let (mut least, mut greatest) = (within(crossing - slant.error_px), within(crossing + slant.error_px));
        while least < greatest {
            let middle = least + (greatest - least) / 2;
            let sample = DVec2::new(f64::from(middle) + row.offset, row.y());
            // Going down, what lies to the right on the screen is on the left.
            if side(self.top, self.bottom, sample) == Ordering::Greater {
                least = middle + 1;
            } else {
                greatest = middle;
            }
        }
        greatest
    }
}

/// Where an edge crosses rows, in floats.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slant {
    top: DVec2,
    /// Change of x per row.
    slope: f64,
    /// How far a crossing may be off, px.
    error_px: f64,
}

/// A crossing computed in floats is off by less than this times the magnitudes of both ends' x: the slope and the
/// distance below the top have four roundings of half an ε together, their product is at most the edge's width and has
/// one more, and so have the sum and the shift to the sample. The rest is margin.
const ERROR_OF_CROSSING: f64 = 16.0 * f64::EPSILON;

impl Slant {
    pub(super) fn new(edge: &Edge) -> Self {
        let Edge { top, bottom, .. } = edge;
        Self {
            top: *top,
            slope: (bottom.x - top.x) / (bottom.y - top.y),
            error_px: ERROR_OF_CROSSING * (top.x.abs() + bottom.x.abs()),
        }
    }

    /// Where the edge crosses a row, px, to within rounding.
    #[inline]
    pub(super) fn crossing_px(&self, row: Row) -> f64 {
        self.top.x + (row.y() - self.top.y) * self.slope
    }

    /// The first column whose sample lies at or right of the crossing, the width if none does; `None` where the crossing
    /// is too close to a sample for floats to tell.
    #[inline]
    pub(super) fn column_at(&self, row: Row) -> Option<u32> {
        // How far left or right outside makes no difference.
        let crossing = (self.crossing_px(row) - row.offset).clamp(-0.5, f64::from(row.width) - 0.5);
        let (nearest, column) = ceil(crossing);
        ((crossing - nearest).abs() > self.error_px).then_some(column)
    }
}

/// The whole number nearest to `x` and the least one not below it; `x` from −½ to 2³¹.
#[inline]
fn ceil(x: f64) -> (f64, u32) {
    /// Here floats are 1 apart, so that adding it rounds, and the last bits hold the whole number. Without SSE 4.1 rounding
    /// by the standard library is a function call.
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
