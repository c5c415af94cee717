//! The two-dimensional chapter: shapes as iterators of pixels or spans, with no picture and no depth behind them.
//!
//! Each is stepped by asking for the next item, and between two items its state can be read. Whether a pixel belongs to
//! a shape is decided without rounding. For that, real coordinates must be 0 or have a magnitude from 2⁻¹⁴⁹ to 2¹²⁸, as
//! all finite values of f32 have; more digits than those of f32 do no harm.

pub mod barycentric;

pub mod circle;

pub mod circle_forms;

pub mod convolve;

pub mod ellipse;

pub mod distance_line;

pub mod slope_line;

pub mod line;

pub mod polygon;

pub mod ear_clip;

pub mod hull;

pub mod primitives;

pub mod real_line;

pub mod seed_fill;

pub mod stack_fill;

use std::cmp::Ordering;
use std::ops::Range;

use glam::DVec2;
use robust::{Coord, orient2d};

/// A run of pixels in one row; never empty.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    /// Row.
    pub y: u32,
    /// First column.
    pub x0: u32,
    /// One past the last column.
    pub x1: u32,
}

/// Which side of the line from `a` to `b` the point `p` lies on, with y down: greater is right of it for one who walks
/// along, equal is on it.
pub(crate) fn side(a: DVec2, b: DVec2, p: DVec2) -> Ordering {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    // The crate looks at axes with y up, where what is right here is left. It may answer −0, which is on the line, too.
    (orient2d(coord(a), coord(b), coord(p)) + 0.0).total_cmp(&0.0)
}

/// Those of `length` pixels in a row or column whose whole numbers lie in the closed range.
pub(crate) fn whole_numbers_within(least: f64, greatest: f64, length: u32) -> Range<u32> {
    // Casts saturate.
    let first = (least.ceil() as u32).min(length);
    let end = ((greatest.floor() + 1.0) as u32).min(length);
    first..end.max(first)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_are_those_of_a_walker_on_a_screen() {
        let (a, b) = (DVec2::new(1.0, 1.0), DVec2::new(5.0, 1.0));
        assert_eq!(side(a, b, DVec2::new(3.0, 2.0)), Ordering::Greater, "below, y down");
        assert_eq!(side(a, b, DVec2::new(3.0, 0.0)), Ordering::Less);
        assert_eq!(side(a, b, DVec2::new(300.0, 1.0)), Ordering::Equal);
        let lattice = || (-3..=3).map(f64::from);
        for (x, y) in lattice().flat_map(|x| lattice().map(move |y| (x, y))) {
            let (from, to) = (DVec2::new(x, y), DVec2::new(-x, y));
            assert_eq!(side(from, to, DVec2::new(0.5, y)), Ordering::Equal, "zero has no sign: {from} {to}");
        }
        let tiny = 2.0_f64.powi(-149);
        assert_eq!(side(DVec2::ZERO, DVec2::new(3e38, tiny), DVec2::new(1.0, 0.0)), Ordering::Less);
        assert_eq!(side(DVec2::ZERO, DVec2::new(-3e38, tiny), DVec2::new(-1.0, 0.0)), Ordering::Greater);
    }

    #[test]
    fn ranges_are_cut_to_the_picture() {
        assert_eq!(whole_numbers_within(0.5, 3.0, 8), 1..4);
        assert_eq!(whole_numbers_within(-7.0, 1e300, 8), 0..8);
        assert_eq!(whole_numbers_within(3.2, 3.4, 8), 4..4);
        assert_eq!(whole_numbers_within(1e300, 1e301, 8), 8..8);
        assert_eq!(whole_numbers_within(-9.0, -8.0, 8), 0..0);
    }
}
