//! Rasterization: which samples lie inside a triangle, decided in exact integers.
//!
//! A rasterizer knows nothing of depth or colour. It takes [`EdgeFunctions`], walks the samples that may be inside, and
//! hands each covered [`Sample`] to a sink.

mod bounding_box;

mod edge;

mod scanline;

pub use edge::{EdgeFunctions, doubled_area};

use super::grid::SampleGrid;
use super::settings::Rasterizer;
use crate::math::fixed::{HALF_PIXEL, SUBPIXELS};

/// A covered sample: where it is, and the three edge values there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample {
    /// Column in the packed picture.
    pub column: u32,
    /// Row in the packed picture.
    pub row: u32,
    /// Edge values in units of 1/2¹⁶ px², each belonging to the vertex opposite; they sum to the doubled area.
    pub edges: [i64; 3],
}

/// A rectangle of full-picture pixels, half open. Nothing outside of it is visited.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scissor {
    /// First column.
    pub left: u32,
    /// First row.
    pub top: u32,
    /// One past the last column.
    pub right: u32,
    /// One past the last row.
    pub bottom: u32,
}

impl Scissor {
    /// A whole picture.
    pub fn full(width: u32, height: u32) -> Self {
        Self { left: 0, top: 0, right: width, bottom: height }
    }

    /// One pixel.
    pub fn pixel(x: u32, y: u32) -> Self {
        Self { left: x, top: y, right: x + 1, bottom: y + 1 }
    }
}

/// Hands every sample of `grid` within `scissor` that belongs to the triangle to `sink`, row by row from the top, left
/// to right. Returns how many samples were visited. All rasterizers find the same samples in the same order.
pub fn rasterize(
    rasterizer: Rasterizer,
    edges: &EdgeFunctions,
    grid: SampleGrid,
    scissor: Scissor,
    sink: impl FnMut(Sample),
) -> u64 {
    match rasterizer {
        Rasterizer::BoundingBox => bounding_box::rasterize(edges, grid, scissor, sink),
        Rasterizer::Scanline => scanline::rasterize(edges, grid, scissor, sink),
    }
}

/// Half-open range of the pixels whose centres lie within a range of grid steps (both ends included), clamped.
fn pixel_range((least, greatest): (i64, i64), from: u32, to: u32) -> (u32, u32) {
    let first = (least - HALF_PIXEL + SUBPIXELS - 1).div_euclid(SUBPIXELS);
    let last = (greatest - HALF_PIXEL).div_euclid(SUBPIXELS);
    let clamp = |pixel: i64| pixel.clamp(i64::from(from), i64::from(to)) as u32;
    let (first, end) = (clamp(first), clamp(last + 1));
    (first, end.max(first))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pixel_range_holds_exactly_the_centres_within() {
        for least in -700..700 {
            for extent in [0, 1, 127, 128, 255, 256, 400] {
                let greatest = least + extent;
                let (first, end) = pixel_range((least, greatest), 0, 3);
                let expected: Vec<u32> =
                    (0..3).filter(|p| (least..=greatest).contains(&(p * 256 + 128))).map(|p| p as u32).collect();
                assert_eq!((first..end).collect::<Vec<_>>(), expected, "{least}..={greatest}");
            }
        }
    }
}
