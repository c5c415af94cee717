//! The bounding-box rasterizer: every sample of the box around a triangle is tested against its three edges.
//!
//! The plainest algorithm, and the reference for all others. It visits two samples for each covered one of a large
//! triangle, and many more for slivers that lie across; the clamp to the scissor bounds it by the picture's size.

use super::{EdgeFunctions, Sample, Scissor};
use crate::math::fixed::{HALF_PIXEL, SUBPIXELS};
use crate::pipeline::grid::SampleGrid;

/// Hands every sample of `grid` within `scissor` that belongs to the triangle to `sink`, row by row from the top, left
/// to right. Returns how many samples were visited.
pub fn rasterize(edges: &EdgeFunctions, grid: SampleGrid, scissor: Scissor, mut sink: impl FnMut(Sample)) -> u64 {
    let (left, right) = pixel_range(edges.x_range(), scissor.left, scissor.right);
    let (top, bottom) = pixel_range(edges.y_range(), scissor.top, scissor.bottom);
    let mut visited = 0;
    for row in grid.rows(top, bottom) {
        let columns = grid.columns(row, left, right);
        visited += columns.len() as u64;
        for column in columns {
            let values = edges.at(grid.position(column, row));
            if edges.contains(values) {
                sink(Sample { column, row, edges: values });
            }
        }
    }
    visited
}

/// Half-open range of the pixels whose centres lie within a range of grid steps (both ends included), clamped.
fn pixel_range((least, greatest): (i32, i32), from: u32, to: u32) -> (u32, u32) {
    let first = (i64::from(least) - HALF_PIXEL + SUBPIXELS - 1).div_euclid(SUBPIXELS);
    let last = (i64::from(greatest) - HALF_PIXEL).div_euclid(SUBPIXELS);
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
