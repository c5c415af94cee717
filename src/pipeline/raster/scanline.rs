//! Scan conversion: a triangle is split at its middle corner, and on each row the columns between its two sides are
//! covered.
//!
//! The textbook splits by constructing a fourth corner on the long edge and steps both sides from corner to corner. The
//! constructed corner is rounded, so the long edge bends and neighbours crack; and stepping from the corner instead of
//! from the first row's centre shifts every row. Here the long edge stays whole, every row asks both edges where it
//! crosses them, and a flat edge is never divided by.

use super::numbers::{Edge, Numbers};
use super::{Canvas, Triangle};

/// Finds the samples of a triangle, row by row.
pub(super) fn cover<N: Numbers>(triangle: &Triangle<N>, canvas: &mut Canvas<'_>) {
    let sides = triangle.sides();
    for row in canvas.rows(sides.rows) {
        let y = canvas.pixel_row(row);
        let (long, short) = (sides.long.boundary(y), sides.short(y).boundary(y));
        let (left, right) = if sides.long_is_left() { (long, short) } else { (short, long) };
        let samples = canvas.columns(row, left, right);
        canvas.visit(samples.len());
        canvas.emit(row, samples);
    }
}
