//! Cutting a simple polygon into triangles, ear by ear (Meisters 1975).
//!
//! An *ear* is a corner whose neighbours can see each other: it turns the way the polygon does, and no other corner lies in
//! its triangle. Every simple polygon has two of them, so cutting one off at a time ends with a single triangle. Time grows
//! with the cube of the number of corners at worst: for pictures that one looks at; models use the crate `earcut`.

use std::cmp::Ordering;

use glam::DVec2;

use super::side;

/// The walk that cuts off ears; see [`clip_ears`].
#[derive(Clone, Debug)]
pub struct EarClip<'a> {
    points: &'a [DVec2],
    /// Corners that are left, in order.
    left: Vec<usize>,
    turn: Ordering,
}

/// The triangles of a simple polygon, as numbers of its corners. Of one that crosses itself it finds what ears there are.
pub fn clip_ears(points: &[DVec2]) -> EarClip<'_> {
    let from = |i: usize| points[i] - points[0];
    let doubled_area: f64 = (2..points.len()).map(|i| from(i - 1).perp_dot(from(i))).sum();
    EarClip { points, left: (0..points.len()).collect(), turn: doubled_area.total_cmp(&0.0) }
}

impl EarClip<'_> {
    /// Corners that are left, in order. Fewer than three if all of the polygon was cut.
    pub fn remaining(&self) -> &[usize] {
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
            // Corners on a straight side, and double ones, have no triangle.
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
            // Star-shaped around the origin, so never crossing itself, and mostly concave.
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
    fn what_has_no_area_has_no_triangles_and_a_crossing_one_ends() {
        let line = [(0.0, 0.0), (1.0, 1.0), (2.0, 2.0)].map(DVec2::from);
        assert_eq!(clip_ears(&line).count(), 0);
        assert_eq!(clip_ears(&[]).count(), 0);
        let bow_tie = [(0.0, 0.0), (4.0, 4.0), (4.0, 0.0), (0.0, 5.0)].map(DVec2::from);
        assert!(clip_ears(&bow_tie).count() <= 2);
        let square = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)].map(DVec2::from);
        assert_eq!(clip_ears(&square).count(), 2, "the corner on a side is none");
    }
}
