//! Exact weights, depth and attributes at a pixel centre.

use num_rational::BigRational;
use num_traits::Zero as _;

use super::number::exact;

/// Screen-space vertex with attributes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ScreenCorner {
    /// Horizontal position in pixels, increasing to the right.
    pub(crate) x: f32,
    /// Vertical position in pixels, increasing downwards.
    pub(crate) y: f32,
    /// Depth after the perspective division, z/w.
    pub(crate) z: f32,
    /// Clip-space w, which must be positive.
    pub(crate) w: f32,
    /// Texture coordinates.
    pub(crate) uv: [f32; 2],
}

/// Exact interpolated values at a pixel centre.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct ExactSample {
    /// Screen-space (affine) weights of the vertices.
    pub(crate) affine: [BigRational; 3],
    /// Perspective-correct weights of the vertices.
    pub(crate) perspective: [BigRational; 3],
    /// Depth, an affine function of screen position.
    pub(crate) depth: BigRational,
    /// Perspective-correct texture coordinates.
    pub(crate) uv: [BigRational; 2],
}

/// Computes the exact values at a pixel centre, without snapping vertices. Returns `None` for a triangle without area,
/// with a non-finite number, or with w = 0.
pub(crate) fn exact_sample(corners: &[ScreenCorner; 3], column: u32, row: u32) -> Option<ExactSample> {
    let places = all(corners.map(|c| all([c.x, c.y].map(exact))))?;
    let half = BigRational::new(1.into(), 2.into());
    let centre = [column, row].map(|pixel| BigRational::from_integer(pixel.into()) + &half);
    let edge = |from: usize, to: usize| doubled_area(&places[from], &places[to], &centre);
    let edges = [edge(1, 2), edge(2, 0), edge(0, 1)];
    let area: BigRational = edges.iter().sum();
    if area.is_zero() {
        return None;
    }
    let affine = edges.map(|e| e / &area);
    let ws = all(corners.map(|c| exact(c.w).filter(|w| !w.is_zero())))?;
    let over_w = [0, 1, 2].map(|i| &affine[i] / &ws[i]);
    let sum: BigRational = over_w.iter().sum();
    if sum.is_zero() {
        return None;
    }
    let perspective = over_w.map(|share| share / &sum);
    let depth = mean(&affine, all(corners.map(|c| exact(c.z)))?);
    let [u, v] = [0, 1].map(|axis| Some(mean(&perspective, all(corners.map(|c| exact(c.uv[axis])))?)));
    Some(ExactSample { affine, perspective, depth, uv: [u?, v?] })
}

/// Computes the doubled signed area of a triangle.
fn doubled_area(a: &[BigRational; 2], b: &[BigRational; 2], c: &[BigRational; 2]) -> BigRational {
    (&b[0] - &a[0]) * (&c[1] - &a[1]) - (&c[0] - &a[0]) * (&b[1] - &a[1])
}

fn mean(weights: &[BigRational; 3], values: [BigRational; 3]) -> BigRational {
    weights.iter().zip(values).map(|(weight, value)| weight * value).sum()
}

/// Returns the values, or `None` if any of them is `None`.
fn all<T, const N: usize>(values: [Option<T>; N]) -> Option<[T; N]> {
    let found: Vec<T> = values.into_iter().collect::<Option<_>>()?;
    found.try_into().ok()
}

#[cfg(test)]
mod tests {
    use num_traits::One as _;

    use super::*;

    fn rational(numerator: i64, denominator: i64) -> BigRational {
        BigRational::new(numerator.into(), denominator.into())
    }

    fn corner([x, y]: [f32; 2], z: f32, w: f32, uv: [f32; 2]) -> ScreenCorner {
        ScreenCorner { x, y, z, w, uv }
    }

    #[test]
    fn weights_reproduce_the_place_and_the_plane_through_the_corners() {
        // z is an affine function of the screen position: x / 16 + y / 32. Texture coordinates are the screen position
        // times w.
        let at = |p: [f32; 2], w: f32| corner(p, p[0] / 16.0 + p[1] / 32.0, w, [p[0] * w, p[1] * w]);
        let corners = [at([1.0, 0.5], 1.0), at([9.0, 2.25], 4.0), at([3.5, 8.0], 0.5)];
        let sample = exact_sample(&corners, 4, 3).unwrap();
        assert_eq!(sample.affine.iter().sum::<BigRational>(), BigRational::one());
        assert_eq!(sample.perspective.iter().sum::<BigRational>(), BigRational::one());
        assert_eq!(sample.depth, rational(9, 32) + rational(7, 64), "4.5 / 16 + 3.5 / 32");
        // u = x·w at the vertices, so u divided by the interpolated w is the screen position.
        let w = mean(&sample.perspective, corners.map(|c| exact(c.w).unwrap()));
        assert_eq!(&sample.uv[0] / &w, rational(9, 2));
        assert_eq!(&sample.uv[1] / &w, rational(7, 2));
    }

    #[test]
    fn equal_w_makes_both_kinds_of_weights_the_same() {
        let corners = [[1.0, 0.5], [9.0, 2.25], [3.5, 8.0]].map(|p| corner(p, 0.5, 3.0, p));
        let sample = exact_sample(&corners, 4, 3).unwrap();
        assert_eq!(sample.affine, sample.perspective);
        assert_eq!(sample.uv, [rational(9, 2), rational(7, 2)]);
    }

    #[test]
    fn degenerate_triangles_have_no_sample() {
        let line = [[1.0, 1.0], [2.0, 2.0], [3.0, 3.0]].map(|p| corner(p, 0.5, 1.0, p));
        assert_eq!(exact_sample(&line, 0, 0), None);
        let mut broken = [[1.0, 1.0], [2.0, 7.0], [3.0, 3.0]].map(|p| corner(p, 0.5, 1.0, p));
        assert!(exact_sample(&broken, 0, 0).is_some());
        broken[1].w = 0.0;
        assert_eq!(exact_sample(&broken, 0, 0), None);
    }
}
