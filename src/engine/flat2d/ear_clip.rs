//! Triangulation of a simple polygon by ear clipping (Meisters 1975).
//!
//! An *ear* is a convex corner whose triangle with its two neighbours contains no other corner of the polygon. Every
//! simple polygon has at least two ears, so cutting off one ear after the other leaves a single triangle in the end.
//! The worst-case time grows with the cube of the number of corners, so ear clipping suits only small polygons. Model
//! loading uses the crate `earcut` instead.

use std::cmp::Ordering;

use glam::DVec2;

use super::side;

/// Iterator over the triangles that ear clipping cuts off a polygon; see [`clip_ears`].
#[derive(Clone, Debug)]
pub(crate) struct EarClip<'a> {
    points: &'a [DVec2],
    /// Indices of the corners not yet cut off, in the order of the polygon.
    left: Vec<usize>,
    turn: Ordering,
}

/// Returns the triangles of a simple polygon, as indices of its corners. For a self-intersecting polygon, the iterator
/// ends as soon as no ear is left.
pub(crate) fn clip_ears(points: &[DVec2]) -> EarClip<'_> {
    let from = |i: usize| points[i] - points[0];
    let doubled_area: f64 = (2..points.len()).map(|i| from(i - 1).perp_dot(from(i))).sum();
    EarClip { points, left: (0..points.len()).collect(), turn: doubled_area.total_cmp(&0.0) }
}

impl EarClip<'_> {
    /// Returns the indices of the corners not yet cut off, in the order of the polygon. Fewer than three remain if the
    /// whole polygon was triangulated.
    pub(crate) fn remaining(&self) -> &[usize] {
        &self.left
    }

    fn corner(&self, place: usize) -> [usize; 3] {
        let count = self.left.len();
        [(place + count - 1) % count, place, (place + 1) % count].map(|place| self.left[place])
    }

    fn turns(&self, [a, b, c]: [usize; 3]) -> Ordering {
        side(self.points[a], self.points[b], self.points[c])
    }

    fn is_ear(&self, corner: [usize; 3]) -> bool {
        let [a, b, c] = corner;
        let outside = |p: usize| {
            let opposite = self.turn.reverse();
            [[a, b, p], [b, c, p], [c, a, p]].into_iter().any(|triangle| self.turns(triangle) == opposite)
        };
        let is_a_corner = |p: usize| corner.iter().any(|q| self.points[*q] == self.points[p]);
        self.turns(corner) == self.turn && self.left.iter().all(|p| is_a_corner(*p) || outside(*p))
    }
}

impl Iterator for EarClip<'_> {
    type Item = [usize; 3];

    fn next(&mut self) -> Option<[usize; 3]> {
        while self.left.len() >= 3 && self.turn != Ordering::Equal {
            // Collinear and duplicate corners form no triangle.
            if let Some(flat) = (0..self.left.len()).find(|place| self.turns(self.corner(*place)) == Ordering::Equal) {
                self.left.remove(flat);
                continue;
            }
            let ear = (0..self.left.len()).find(|place| self.is_ear(self.corner(*place)))?;
            let triangle = self.corner(ear);
            self.left.remove(ear);
            return Some(triangle);
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn doubled_area(points: &[DVec2], corners: &[usize]) -> f64 {
        (0..corners.len()).map(|i| points[corners[i]].perp_dot(points[corners[(i + 1) % corners.len()]])).sum()
    }

    #[test]
    fn triangles_sum_to_the_polygon_and_turn_as_it_does() {
        let mut random = fastrand::Rng::with_seed(63);
        for _ in 0..300 {
            let count = random.usize(3..24);
            // The polygon is star-shaped around the origin, so it never intersects itself. It is usually concave.
            let mut points: Vec<_> = (0..count)
                .map(|i| {
                    let angle = (i as f64 + 0.8 * random.f64()) / count as f64 * std::f64::consts::TAU;
                    DVec2::from_angle(angle) * (1.0 + 9.0 * random.f64())
                })
                .collect();
            if random.bool() {
                points.reverse();
            }
            let all: Vec<_> = (0..count).collect();
            let whole = doubled_area(&points, &all);
            let triangles: Vec<_> = clip_ears(&points).collect();
            if count > 3 {
                assert_eq!(triangles.len(), count - 2);
            }
            assert!(triangles.iter().all(|t| doubled_area(&points, t) * whole > 0.0));
            let sum: f64 = triangles.iter().map(|t| doubled_area(&points, t)).sum();
            assert!((sum - whole).abs() < 1e-9 * whole.abs(), "{points:?}");
        }
    }

    #[test]
    fn polygons_without_area_have_no_triangles_and_self_intersecting_ones_terminate() {
        let line = [(0.0, 0.0), (1.0, 1.0), (2.0, 2.0)].map(DVec2::from);
        assert_eq!(clip_ears(&line).count(), 0);
        assert_eq!(clip_ears(&[]).count(), 0);
        let bow_tie = [(0.0, 0.0), (4.0, 4.0), (4.0, 0.0), (0.0, 5.0)].map(DVec2::from);
        assert!(clip_ears(&bow_tie).count() <= 2);
        let square = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)].map(DVec2::from);
        assert_eq!(clip_ears(&square).count(), 2, "the corner on a side is none");
    }
}
