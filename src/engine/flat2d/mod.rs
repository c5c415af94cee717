//! Two-dimensional algorithms: shapes as iterators of pixels or spans, independent of images and depth buffers.
//!
//! Each iterator advances one step per item, and its state can be inspected between items. Whether a pixel belongs to a
//! shape is decided exactly, except in the modules that demonstrate float arithmetic. Exactness requires real
//! coordinates to be 0 or to have a magnitude from 2⁻¹⁴⁹ to 2¹²⁸, like all finite f32 values. The coordinates may have
//! more significant digits than f32.

pub(crate) mod barycentric;

pub mod circle;

pub(crate) mod circle_forms;

pub(crate) mod convolve;

pub(crate) mod ellipse;

pub(crate) mod distance_line;

pub(crate) mod slope_line;

pub mod line;

pub mod polygon;

pub(crate) mod ear_clip;

pub(crate) mod hull;

pub(crate) mod primitives;

pub(crate) mod real_line;

pub(crate) mod seed_fill;

pub(crate) mod stack_fill;

use std::cmp::Ordering;
use std::ops::Range;

use glam::DVec2;
use robust::{Coord, orient2d};

/// Non-empty run of pixels in one row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelSpan {
    /// Row of the run.
    pub y: u32,
    /// First column of the run.
    pub x0: u32,
    /// One past the last column of the run.
    pub x1: u32,
}

/// Returns the side of the directed line from `a` to `b` on which `p` lies, with y down.
///
/// `Greater` is right of the line, as seen when walking from `a` to `b`; `Equal` is on it.
pub(crate) fn side(a: DVec2, b: DVec2, p: DVec2) -> Ordering {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    // The crate `robust` assumes y up, so its left is right here. `orient2d` may return −0 for a point on the line;
    // adding 0.0 turns −0 into +0.
    (orient2d(coord(a), coord(b), coord(p)) + 0.0).total_cmp(&0.0)
}

/// Returns the range of whole numbers in [0, `length`) that lie in the closed interval from `least` to `greatest`.
pub(crate) fn whole_numbers_within(least: f64, greatest: f64, length: u32) -> Range<u32> {
    // Float-to-integer casts saturate.
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
