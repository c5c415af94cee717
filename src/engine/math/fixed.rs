//! 24.8 fixed point: the subpixel grid that vertices are snapped to.
//!
//! Once vertices lie on the grid, edge functions are integers and therefore exact. Two triangles that share an edge
//! compute the same values with opposite signs, so no cracks appear. D3D11 prescribes the same eight bits (functional
//! specification, 3.2.4.1 and 15.16).

/// Number of fraction bits of a snapped screen coordinate.
pub(crate) const SUBPIXEL_BITS: u32 = 8;

/// Number of grid steps per pixel.
pub const SUBPIXELS: i64 = 1 << SUBPIXEL_BITS;

/// Half a pixel in grid steps: the distance of a pixel's centre from its top-left corner along each axis.
pub const HALF_PIXEL: i64 = SUBPIXELS / 2;

/// Rounds a screen coordinate in pixels to the nearest grid step, ties to even.
///
/// The multiplication by 256 is exact (a power of two), so there is one rounding. Saturates for values beyond the range
/// of `i64` and returns 0 for NaN; the guard band prevents both.
pub fn snap(pixels: f32) -> i64 {
    (pixels * SUBPIXELS as f32).round_ties_even() as i64
}

/// Rounds a coordinate in pixels to the nearest grid position, ties to even, and returns it in pixels. No other
/// rounding occurs: the grid step is a power of two, and coordinates too large to have a fraction lie on the grid
/// already. Valid for magnitudes up to 2¹⁰⁰⁰.
pub(crate) fn snap_to_grid(pixels: f64) -> f64 {
    const STEPS_PER_PIXEL: f64 = SUBPIXELS as f64;
    (pixels * STEPS_PER_PIXEL).round_ties_even() / STEPS_PER_PIXEL
}

/// Converts a grid position to pixels. Exact inside the guard band.
pub(crate) fn to_pixels(subpixels: i64) -> f32 {
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
    fn both_ways_of_snapping_agree() {
        let mut random = fastrand::Rng::with_seed(43);
        for _ in 0..10_000 {
            // Ties are frequent at 1/1024 px.
            let pixels = random.i32(-(1 << 22)..1 << 22) as f32 / 1024.0;
            assert_eq!(snap_to_grid(pixels.into()), f64::from(to_pixels(snap(pixels))), "{pixels}");
        }
        assert_eq!(snap_to_grid(3e38), 3e38);
        assert_eq!(snap_to_grid(2.0_f64.powi(-149)), 0.0);
    }

    #[test]
    fn a_snapped_coordinate_reads_back_exactly() {
        for step in [-70_000_i64, -1, 0, 1, 127, 128, 1_000_003] {
            assert_eq!(snap(to_pixels(step)), step);
        }
    }
}
