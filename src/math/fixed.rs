//! 24.8 fixed point: the grid that vertices are snapped to.
//!
//! Once vertices lie on the grid, edge functions are integers and therefore exact: two triangles that share an edge
//! see the same number with opposite signs, and nothing can crack. D3D11 prescribes the same eight bits
//! (functional specification, 3.2.4.1 and 15.16).

/// Fraction bits of a snapped screen coordinate.
pub const SUBPIXEL_BITS: u32 = 8;

/// Grid steps per pixel.
pub const SUBPIXELS: i64 = 1 << SUBPIXEL_BITS;

/// Half a pixel in grid steps: where a pixel's centre lies.
pub const HALF_PIXEL: i64 = SUBPIXELS / 2;

/// Rounds a screen coordinate in pixels to the nearest grid step, ties to even.
///
/// The multiplication by 256 is exact (a power of two), so there is one rounding. Saturates for values beyond the
/// grid and gives 0 for NaN; the guard band keeps both from happening.
pub fn snap(pixels: f32) -> i64 {
    (pixels * SUBPIXELS as f32).round_ties_even() as i64
}

/// The pixel coordinate of a grid position. Exact for everything inside the guard band.
pub fn to_pixels(subpixels: i64) -> f32 {
    subpixels as f32 / SUBPIXELS as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn snapping_rounds_to_nearest_with_ties_to_even() {
        assert_eq!(snap(1.0), 256);
        assert_eq!(snap(0.5 / 256.0), 0, "a tie goes to the even neighbour below");
        assert_eq!(snap(1.5 / 256.0), 2, "a tie goes to the even neighbour above");
        assert_eq!(snap(-0.6 / 256.0), -1);
    }

    #[test]
    fn a_snapped_coordinate_reads_back_exactly() {
        for step in [-70_000_i64, -1, 0, 1, 127, 128, 1_000_003] {
            assert_eq!(snap(to_pixels(step)), step);
        }
    }
}
