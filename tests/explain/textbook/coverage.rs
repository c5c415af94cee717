//! Coverage of a triangle: edge functions at the sample of every pixel (Pineda 1988).

use glam::{DVec2, DVec3};

use super::{Fault, Faults, Size};

/// Covered pixel of a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Covered {
    /// Column, from the left.
    pub(crate) x: usize,
    /// Row, from the top.
    pub(crate) y: usize,
    /// Screen-space weights of the three corners at the sample; their sum is 1.
    pub(crate) weights: DVec3,
}

/// Returns twice the signed area of a triangle in px²: positive if it is clockwise on the screen, where y points down.
pub(crate) fn doubled_area([a, b, c]: [DVec2; 3]) -> f64 {
    (b - a).perp_dot(c - a)
}

/// Whether an edge of a triangle that is clockwise on the screen is a top or a left edge.
fn is_top_left(edge: DVec2) -> bool {
    edge.y < 0.0 || (edge.y == 0.0 && edge.x > 0.0)
}

/// Returns the pixels that a triangle of either winding covers, with corners in pixels.
pub(crate) fn covered(corners: [DVec2; 3], size: Size, faults: Faults) -> Vec<Covered> {
    let area = doubled_area(corners);
    if area == 0.0 || !area.is_finite() {
        return Vec::new();
    }
    let offset = DVec2::splat(if faults.has(Fault::PixelCorners) { 0.0 } else { 0.5 });
    let is_inside = |value: f64, edge: DVec2| {
        value > 0.0
            || value == 0.0
                && !faults.has(Fault::FillExclusive)
                && (faults.has(Fault::FillInclusive) || is_top_left(edge))
    };
    let low = corners[0].min(corners[1]).min(corners[2]).floor().max(DVec2::ZERO);
    let high = corners[0].max(corners[1]).max(corners[2]).ceil();
    let (right, bottom) = (high.x.min(size.width as f64 - 1.0), high.y.min(size.height as f64 - 1.0));
    let mut pixels = Vec::new();
    for y in low.y as i64..=bottom as i64 {
        for x in low.x as i64..=right as i64 {
            let sample = DVec2::new(x as f64, y as f64) + offset;
            // Edge i lies opposite to corner i; `signum` makes the inside positive for both windings.
            let edge = |i: usize| (corners[(i + 2) % 3] - corners[(i + 1) % 3]) * area.signum();
            let value = |i: usize| edge(i).perp_dot(sample - corners[(i + 1) % 3]);
            if x < 0 || y < 0 || !(0..3).all(|i| is_inside(value(i), edge(i))) {
                continue;
            }
            let weights = DVec3::new(value(0), value(1), value(2)) / area.abs();
            pixels.push(Covered { x: x as usize, y: y as usize, weights });
        }
    }
    pixels
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: Size = Size { width: 6, height: 5 };

    /// Draws the coverage of triangles as rows of digits: the number of triangles that cover each pixel.
    fn drawn(triangles: &[[[f64; 2]; 3]], faults: &[Fault]) -> [String; 5] {
        let mut counts = [[0; 6]; 5];
        for corners in triangles {
            for pixel in covered(corners.map(DVec2::from_array), SIZE, Faults::new(faults)) {
                counts[pixel.y][pixel.x] += 1;
            }
        }
        counts.map(|row| row.map(|count: i32| count.to_string()).concat())
    }

    #[test]
    fn a_triangle_covers_the_centres_found_by_hand() {
        // The hypotenuse runs from (0.5, 0.5) to (4.5, 4.5) through five centres; it is a right edge.
        let lower = [[0.5, 0.5], [4.5, 4.5], [0.5, 4.5]];
        assert_eq!(drawn(&[lower], &[]), ["000000", "100000", "110000", "111000", "000000"]);
        assert_eq!(drawn(&[lower], &[Fault::FillInclusive]), ["100000", "110000", "111000", "111100", "111110"]);
        assert_eq!(drawn(&[lower], &[Fault::FillExclusive]), ["000000", "000000", "010000", "011000", "000000"]);
        assert_eq!(drawn(&[lower], &[Fault::PixelCorners]), ["000000", "000000", "010000", "011000", "011100"]);
    }

    #[test]
    fn two_triangles_of_either_winding_cover_a_square_once() {
        let lower = [[0.5, 0.5], [4.5, 4.5], [0.5, 4.5]];
        for upper in [[[0.5, 0.5], [4.5, 0.5], [4.5, 4.5]], [[0.5, 0.5], [4.5, 4.5], [4.5, 0.5]]] {
            assert_eq!(drawn(&[lower, upper], &[]), ["111100", "111100", "111100", "111100", "000000"]);
        }
    }

    #[test]
    fn weights_are_those_of_the_corners() {
        let corners = [[0.5, 0.5], [4.5, 0.5], [0.5, 4.5]].map(DVec2::from_array);
        let pixels = covered(corners, SIZE, Faults::default());
        let pixel = pixels.iter().find(|pixel| (pixel.x, pixel.y) == (1, 2)).unwrap();
        assert_eq!(pixel.weights, DVec3::new(0.25, 0.25, 0.5));
    }

    #[test]
    fn pixels_outside_the_picture_are_left_out() {
        assert_eq!(drawn(&[[[-99.0, -99.0], [99.0, -99.0], [-99.0, 99.0]]], &[])[0], "000000");
        assert_eq!(drawn(&[[[-99.0, -99.0], [299.0, -99.0], [-99.0, 299.0]]], &[])[4], "111111");
        assert!(covered([DVec2::ZERO, DVec2::ONE, DVec2::ONE * 3.0], SIZE, Faults::default()).is_empty());
    }
}
