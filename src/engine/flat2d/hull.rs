//! Convex hull of points (Andrew 1979), the shape of a rubber band stretched around them.
//!
//! The algorithm visits the points from left to right and back, and keeps a chain of corners. If the chain, extended to
//! the next point, would not turn right at its last corner (as seen on a screen, y down), that corner cannot be on the
//! hull and is dropped. Every point inside the hull is Σ tᵢ Pᵢ with all tᵢ ≥ 0 and Σ tᵢ = 1; [`convex_weights`]
//! computes such weights.

use std::cmp::Ordering;

use glam::DVec2;

use super::side;

/// Step of the hull algorithm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum HullStep {
    /// The point with this index was appended to the chain.
    Added(usize),
    /// The point with this index was removed from the end of the chain, because the chain does not turn right there.
    Dropped(usize),
}

/// Iterator over the steps of the hull algorithm; see [`convex_hull`].
#[derive(Clone, Debug)]
pub(crate) struct ConvexHull<'a> {
    points: &'a [DVec2],
    /// Indices of the points in the order in which they are visited: from left to right, then back again. Of several
    /// points at the same position, only one is visited.
    tour: Vec<usize>,
    /// Index into `tour` of the next point.
    next: usize,
    chain: Vec<usize>,
}

/// Computes the hull of finite points step by step. [`ConvexHull::corners`] returns the hull at the end.
pub(crate) fn convex_hull(points: &[DVec2]) -> ConvexHull<'_> {
    let mut tour: Vec<_> = (0..points.len()).collect();
    tour.sort_by(|a, b| points[*a].x.total_cmp(&points[*b].x).then(points[*a].y.total_cmp(&points[*b].y)));
    tour.dedup_by_key(|point| points[*point].to_array().map(f64::to_bits));
    let back: Vec<_> = tour.iter().rev().skip(1).copied().collect();
    tour.extend(back);
    ConvexHull { points, tour, next: 0, chain: Vec::new() }
}

impl ConvexHull<'_> {
    /// Returns the indices of the corners found so far, clockwise on a screen.
    pub(crate) fn corners(&self) -> &[usize] {
        // The tour ends at the point where it began.
        let closed = self.next == self.tour.len() && self.chain.len() > 1;
        &self.chain[..self.chain.len() - usize::from(closed)]
    }

    /// Returns an index into the chain: only corners after this one may be dropped. On the way back from the rightmost
    /// point, this is the index of the rightmost point; before, it is 0.
    fn droppable_from(&self) -> usize {
        let turning = self.tour.len() / 2;
        if self.next <= turning {
            return 0;
        }
        self.chain.iter().position(|point| *point == self.tour[turning]).unwrap_or(0)
    }
}

impl Iterator for ConvexHull<'_> {
    type Item = HullStep;

    fn next(&mut self) -> Option<HullStep> {
        let next = *self.tour.get(self.next)?;
        if let [.., before, last] = self.chain[self.droppable_from()..]
            && side(self.points[before], self.points[last], self.points[next]) != Ordering::Greater
        {
            self.chain.pop();
            return Some(HullStep::Dropped(last));
        }
        self.chain.push(next);
        self.next += 1;
        Some(HullStep::Added(next))
    }
}

/// Returns weights t of a convex polygon's corners with tᵢ ≥ 0, Σ tᵢ = 1 and Σ tᵢ Pᵢ = `point`. Returns `None` if the
/// point lies outside the polygon.
///
/// Such weights are not unique. The function splits the polygon into a fan of triangles around the first corner, and
/// returns the barycentric weights in the triangle that contains the point.
pub(crate) fn convex_weights(corners: &[DVec2], point: DVec2) -> Option<Vec<f64>> {
    (1..corners.len().saturating_sub(1)).find_map(|i| {
        let [a, b, c] = [corners[0], corners[i], corners[i + 1]];
        let area = (b - a).perp_dot(c - a);
        let [alpha, beta, gamma] =
            [(b - point).perp_dot(c - point), (c - point).perp_dot(a - point), (a - point).perp_dot(b - point)]
                .map(|part| part / area);
        (alpha >= 0.0 && beta >= 0.0 && gamma >= 0.0).then(|| {
            let mut weights = vec![0.0; corners.len()];
            (weights[0], weights[i], weights[i + 1]) = (alpha, beta, gamma);
            weights
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hull(points: &[DVec2]) -> Vec<usize> {
        let mut walk = convex_hull(points);
        walk.by_ref().for_each(drop);
        walk.corners().to_vec()
    }

    fn random_points(random: &mut fastrand::Rng, count: usize) -> Vec<DVec2> {
        // A coarse grid makes duplicates and collinear points frequent.
        (0..count).map(|_| DVec2::new(random.i32(0..12).into(), random.i32(0..12).into())).collect()
    }

    #[test]
    fn no_point_lies_outside_and_every_corner_turns_right() {
        let mut random = fastrand::Rng::with_seed(61);
        for _ in 0..2_000 {
            let count = random.usize(3..20);
            let points = random_points(&mut random, count);
            let corners = hull(&points);
            if corners.len() < 3 {
                let [a, b] = [corners[0], corners[corners.len() - 1]].map(|corner| points[corner]);
                assert!(points.iter().all(|p| side(a, b, *p) == Ordering::Equal), "{points:?}");
                continue;
            }
            for (i, corner) in corners.iter().enumerate() {
                let [next, after] = [1, 2].map(|k| points[corners[(i + k) % corners.len()]]);
                assert_eq!(side(points[*corner], next, after), Ordering::Greater, "{points:?}: {corners:?}");
                assert!(points.iter().all(|p| side(points[*corner], next, *p) != Ordering::Less));
            }
        }
    }

    #[test]
    fn weights_are_convex_and_give_the_point_back() {
        let corners = [(0.0, 0.0), (4.0, 0.0), (5.0, 3.0), (2.0, 6.0), (-1.0, 2.0)].map(DVec2::from);
        let mut random = fastrand::Rng::with_seed(62);
        for _ in 0..500 {
            let point = DVec2::new(random.f64() * 8.0 - 2.0, random.f64() * 8.0 - 1.0);
            let inside = (0..5).all(|i| side(corners[i], corners[(i + 1) % 5], point) != Ordering::Less);
            let weights = convex_weights(&corners, point);
            assert_eq!(weights.is_some(), inside, "{point}");
            if let Some(weights) = weights {
                assert!(weights.iter().all(|t| *t >= 0.0) && (weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
                let back: DVec2 = corners.iter().zip(&weights).map(|(corner, t)| *corner * *t).sum();
                assert!((back - point).length() < 1e-12);
            }
        }
    }

    #[test]
    fn one_and_no_point_have_a_hull() {
        assert_eq!(hull(&[DVec2::ONE, DVec2::ONE]), [0]);
        assert_eq!(hull(&[]), Vec::<usize>::new());
    }
}
