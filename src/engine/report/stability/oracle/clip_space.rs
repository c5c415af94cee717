//! Exact coverage, weights and depth of clip-space triangles, computed without clipping and without dividing by w.
//!
//! For vertices (xᵢ, yᵢ, zᵢ, wᵢ), let λ(p) be the numbers with Σ λᵢ·(xᵢ, yᵢ, wᵢ) = (x, y, 1), where (x, y) is the point
//! p in normalised device coordinates. They are affine functions of p, and the triangle is visible at p exactly if none
//! of them is negative (Olano and Greer, "Triangle Scan Conversion using 2D Homogeneous Coordinates", 1997). Points
//! behind the eye have negative λ, so vertices with w ≤ 0 need no special case. z/w at p is Σ λᵢ·zᵢ, and the
//! perspective-correct weights of the vertices are λᵢ / Σ λⱼ.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed as _, Zero as _};

use super::number::{places, scaled};
use super::region::{ExactHalfPlane, ExactRegion};
use crate::pipeline::settings::FillRule;
use crate::pipeline::viewport::Viewport;

/// Exact clip-space triangle, as seen in a viewport.
#[derive(Clone, Debug)]
pub(crate) struct ClipTriangle {
    /// Numbers λ₀, λ₁ and λ₂ (see the module documentation) as affine functions of pixel column and row, multiplied by
    /// `unit`.
    weights: [ExactHalfPlane; 3],
    /// z/w as an affine function of pixel column and row, multiplied by `unit`.
    depth: ExactHalfPlane,
    /// Common denominator of `weights` and `depth`, greater than 0.
    unit: BigInt,
}

impl ClipTriangle {
    /// Creates a triangle from clip-space vertices (x, y, z, w), with y pointing up and 0 ≤ z ≤ w inside the view
    /// volume. Returns `None` if a coordinate is not finite, or if the plane of the triangle contains the eye, so that
    /// the triangle is seen edge-on.
    pub(crate) fn new(corners: [[f32; 4]; 3], viewport: Viewport) -> Option<Self> {
        if corners.iter().flatten().any(|c| !c.is_finite()) {
            return None;
        }
        let scale = corners.iter().flatten().map(|c| places(*c)).fold(0, u32::max);
        let [a, b, c] = corners.map(|corner| corner.map(|value| scaled(value, scale)));
        let adjoint = [cross(&b, &c), cross(&c, &a), cross(&a, &b)];
        let determinant = &a[0] * &adjoint[0][0] + &a[1] * &adjoint[0][1] + &a[3] * &adjoint[0][2];
        if determinant.is_zero() {
            return None;
        }
        let sign = determinant.signum();
        let weights = adjoint.map(|form| over_pixels(form.map(|f| f * &sign), viewport));
        let depth = combined(&weights, [&a[2], &b[2], &c[2]]);
        let unit = determinant.abs() * viewport.width * viewport.height;
        Some(Self { weights, depth, unit })
    }

    /// Returns the visible region of the triangle between the near and far planes, inclusive.
    pub(crate) fn region(&self, rule: FillRule) -> ExactRegion {
        let edges = self.weights.iter().map(|w| ExactHalfPlane { closed: w.owns_its_line(rule), ..w.clone() });
        let near = ExactHalfPlane { closed: true, ..self.depth.clone() };
        let far = ExactHalfPlane {
            by_column: -&self.depth.by_column,
            by_row: -&self.depth.by_row,
            origin: &self.unit - &self.depth.origin,
            closed: true,
        };
        ExactRegion::new(edges.chain([near, far]).collect())
    }

    /// Returns the perspective-correct weights of the three vertices, and z/w, at a pixel centre. Returns `None` if the
    /// line of sight through the pixel centre does not meet the plane of the triangle in front of the eye.
    pub(crate) fn at(&self, column: u32, row: u32) -> Option<([BigRational; 3], BigRational)> {
        let [a, b, c] = [0, 1, 2].map(|i| self.weights[i].at(column, row));
        let sum = &a + &b + &c;
        if !sum.is_positive() {
            return None;
        }
        let depth = BigRational::new(self.depth.at(column, row), self.unit.clone());
        Some(([a, b, c].map(|weight| BigRational::new(weight, sum.clone())), depth))
    }
}

/// Computes the cross product of two vertices, taken as vectors (x, y, w).
fn cross(p: &[BigInt; 4], q: &[BigInt; 4]) -> [BigInt; 3] {
    [&p[1] * &q[3] - &p[3] * &q[1], &p[3] * &q[0] - &p[0] * &q[3], &p[0] * &q[1] - &p[1] * &q[0]]
}

/// Converts a·x + b·y + c in normalised device coordinates to a function of pixel column and row, multiplied by the
/// number of pixels. A pixel centre is at x = (2·column + 1 − width) / width and y = (height − 2·row − 1) / height.
fn over_pixels([a, b, c]: [BigInt; 3], viewport: Viewport) -> ExactHalfPlane {
    let (width, height) = (BigInt::from(viewport.width), BigInt::from(viewport.height));
    ExactHalfPlane {
        origin: &a * &height * (1 - &width) + &b * &width * (&height - 1) + c * &width * &height,
        by_column: a * height * 2,
        by_row: b * width * -2,
        closed: false,
    }
}

/// Computes the linear combination Σ `forms`ᵢ · `factors`ᵢ of affine functions.
fn combined(forms: &[ExactHalfPlane; 3], factors: [&BigInt; 3]) -> ExactHalfPlane {
    let sum = |part: fn(&ExactHalfPlane) -> &BigInt| {
        forms.iter().zip(factors).map(|(form, factor)| part(form) * factor).sum()
    };
    ExactHalfPlane {
        by_column: sum(|f| &f.by_column),
        by_row: sum(|f| &f.by_row),
        origin: sum(|f| &f.origin),
        closed: true,
    }
}

#[cfg(test)]
mod tests {
    use num_traits::{One as _, ToPrimitive as _};

    use super::*;
    use crate::report::stability::oracle::{Snap, exact};

    const VIEW: Viewport = Viewport { width: 9, height: 7 };

    type ClipCorner = [BigRational; 4];

    /// Clips a polygon to the half-space where a linear function of its vertices is not negative.
    fn cut(polygon: &[ClipCorner], side: impl Fn(&ClipCorner) -> BigRational) -> Vec<ClipCorner> {
        let mut left = Vec::new();
        for (index, p) in polygon.iter().enumerate() {
            let q = &polygon[(index + 1) % polygon.len()];
            let (at_p, at_q) = (side(p), side(q));
            if !at_p.is_negative() {
                left.push(p.clone());
            }
            if (&at_p * &at_q).is_negative() {
                let t = &at_p / (&at_p - &at_q);
                left.push([0, 1, 2, 3].map(|axis| &p[axis] + (&q[axis] - &p[axis]) * &t));
            }
        }
        left
    }

    /// Returns the position of a pixel centre relative to a triangle that was clipped and projected as a polygon: 1
    /// inside, −1 outside, 0 on its border.
    fn side_of_polygon(corners: [[f32; 4]; 3], column: u32, row: u32) -> i32 {
        let polygon = corners.map(|corner| corner.map(|c| exact(c).unwrap()));
        let polygon = cut(&cut(&polygon, |p| p[2].clone()), |p| &p[3] - &p[2]);
        if polygon.iter().any(|p| !p[3].is_positive()) {
            return 0;
        }
        let rational = |n: u32| BigRational::from_integer(n.into());
        let half = BigRational::new(1.into(), 2.into());
        let to_pixels = |p: &ClipCorner| {
            let one = BigRational::one();
            let x = (&p[0] / &p[3] + &one) * rational(VIEW.width) * &half;
            [x, (one - &p[1] / &p[3]) * rational(VIEW.height) * &half]
        };
        let points: Vec<_> = polygon.iter().map(to_pixels).collect();
        let centre = [rational(column) + &half, rational(row) + &half];
        let turn = |a: &[BigRational; 2], b: &[BigRational; 2]| {
            let area = (&b[0] - &a[0]) * (&centre[1] - &a[1]) - (&b[1] - &a[1]) * (&centre[0] - &a[0]);
            area.signum().to_i32().unwrap()
        };
        let turns: Vec<_> = points.iter().zip(points.iter().cycle().skip(1)).map(|(a, b)| turn(a, b)).collect();
        match (turns.iter().any(|t| *t > 0), turns.iter().any(|t| *t < 0)) {
            (true, true) | (false, false) => -1,
            _ if turns.contains(&0) => 0,
            _ => 1,
        }
    }

    #[test]
    fn homogeneous_coordinates_agree_with_clipping_and_projecting() {
        let mut random = fastrand::Rng::with_seed(31);
        let (mut inside, mut behind) = (0, 0);
        for _ in 0..100 {
            let corners: [[f32; 4]; 3] = std::array::from_fn(|_| {
                let w = random.f32() * 4.0 - 1.5;
                let side = |random: &mut fastrand::Rng| random.f32() * 6.0 - 3.0;
                [side(&mut random), side(&mut random), w * 1.01 - 0.1, w]
            });
            behind += u32::from(corners.iter().any(|c| c[3] < 0.0));
            let region = ClipTriangle::new(corners, VIEW).map(|t| t.region(FillRule::TopLeft)).unwrap_or_default();
            for row in 0..VIEW.height {
                for column in 0..VIEW.width {
                    let side = side_of_polygon(corners, column, row);
                    inside += u32::from(side > 0);
                    assert!(side == 0 || region.contains(column, row) == (side > 0), "{corners:?} {column},{row}");
                }
            }
        }
        assert!(inside > 400 && behind > 40, "{inside} inside, {behind} reach behind the eye");
    }

    #[test]
    fn with_equal_w_the_region_is_the_screen_space_triangle() {
        let corners = [[-1.5, 0.5, 1.0, 2.0], [1.0, 1.75, 1.0, 2.0], [0.25, -1.5, 1.0, 2.0]];
        let on_screen = corners.map(|[x, y, _, w]| [(x / w + 1.0) * 4.5, (1.0 - y / w) * 3.5]);
        let expected = ExactRegion::triangle(on_screen, Snap::Unsnapped, FillRule::TopLeft).spans(VIEW);
        let triangle = ClipTriangle::new(corners, VIEW).unwrap();
        assert_eq!(triangle.region(FillRule::TopLeft).spans(VIEW), expected);
        assert!(!expected.is_empty());
    }

    #[test]
    fn weights_are_those_of_the_visible_point() {
        let corners = [[-1.5, 0.5, 0.5, 1.0], [4.0, 3.0, 3.5, 4.0], [0.25, -1.5, 1.0, 2.0]];
        let triangle = ClipTriangle::new(corners, VIEW).unwrap();
        let ([a, b, c], depth) = triangle.at(4, 3).unwrap();
        assert_eq!(&a + &b + &c, BigRational::one());
        let point = [0, 1, 2, 3].map(|axis| {
            [&a, &b, &c].into_iter().zip(corners).map(|(weight, corner)| weight * exact(corner[axis]).unwrap()).sum()
        });
        let [x, y, z, w]: [BigRational; 4] = point;
        // The centre of the image of 9 × 7 px.
        assert!(x.is_zero() && y.is_zero());
        assert_eq!(z / w, depth);
    }

    #[test]
    fn edge_on_and_non_finite_triangles_are_rejected() {
        let edge_on = [[0.0, -1.0, 0.9, 1.0], [0.0, 1.0, 0.9, 1.0], [0.0, 1.0, 4.9, 5.0]];
        assert!(ClipTriangle::new(edge_on, VIEW).is_none());
        let broken = [[0.0, -1.0, 0.9, f32::INFINITY], [1.0, 1.0, 0.9, 1.0], [0.0, 1.0, 4.9, 5.0]];
        assert!(ClipTriangle::new(broken, VIEW).is_none());
    }
}
