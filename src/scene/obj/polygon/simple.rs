//! Whether a polygon touches itself, decided exactly on an integer grid.
//!
//! A sweep over the corners keeps the edges that the sweep line meets in order and tests neighbours only (Shamos and
//! Hoey, "Geometric Intersection Problems", 1976): O(n log n), whatever the outline.

use std::cmp::Ordering;
use std::collections::BTreeSet;
use std::ops::Bound::{Excluded, Unbounded};

use super::grid::{GridPoint, crosses, dot, orientation};

/// An edge of the polygon with its ends in the order of the sweep.
#[derive(Clone, Copy)]
struct Edge {
    left: GridPoint,
    right: GridPoint,
    /// Number of the corner that the edge starts from.
    number: usize,
}

impl Edge {
    /// Position of `point` relative to the edge: positive above, negative below, 0 on its line.
    fn side(&self, point: GridPoint) -> i64 {
        orientation(self.left, self.right, point)
    }

    /// Position of an edge that starts no farther left: by its left end, or by its right end if that lies on the line.
    fn order(&self, later: &Self) -> Ordering {
        let side = self.side(later.left);
        let side = if side == 0 { self.side(later.right) } else { side };
        0.cmp(&side)
    }
}

impl Ord for Edge {
    fn cmp(&self, other: &Self) -> Ordering {
        let order = if self.left <= other.left { self.order(other) } else { other.order(self).reverse() };
        order.then(self.number.cmp(&other.number))
    }
}

impl PartialOrd for Edge {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Edge {
    fn eq(&self, other: &Self) -> bool {
        self.number == other.number
    }
}

impl Eq for Edge {}

/// Returns whether no edges of the closed polygon touch but neighbours at their common corner.
pub(super) fn is_simple(corners: &[GridPoint]) -> bool {
    let count = corners.len();
    let next = |i: usize| (i + 1) % count;
    let previous = |i: usize| (i + count - 1) % count;
    let is_spike = |i: usize| {
        let [a, b, c] = [previous(i), i, next(i)].map(|corner| corners[corner]);
        orientation(a, b, c) == 0 && dot(a, b, c) >= 0
    };
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_unstable_by_key(|corner| corners[*corner]);
    let has_equal = order.windows(2).any(|pair| corners[pair[0]] == corners[pair[1]]);
    if has_equal || (0..count).any(is_spike) {
        return false;
    }
    let edge = |number: usize| {
        let ends = [corners[number], corners[next(number)]];
        Edge { left: ends[0].min(ends[1]), right: ends[0].max(ends[1]), number }
    };
    let are_neighbors = |a: &Edge, b: &Edge| next(a.number) == b.number || next(b.number) == a.number;
    let touch = |a: &Edge, b: &Edge| !are_neighbors(a, b) && crosses([a.left, a.right], [b.left, b.right]);
    let mut active = BTreeSet::new();
    for corner in order {
        let around = [edge(previous(corner)), edge(corner)];
        let (ending, starting) = around.iter().partition::<Vec<_>, _>(|edge| edge.right == corners[corner]);
        for edge in ending {
            // An edge that is not found has changed places with another one, which crosses it.
            if !active.remove(edge) {
                return false;
            }
            let below = active.range(..edge).next_back();
            let above = active.range((Excluded(edge), Unbounded)).next();
            if below.zip(above).is_some_and(|(below, above)| touch(below, above)) {
                return false;
            }
        }
        for edge in starting {
            let below = active.range(..edge).next_back();
            let above = active.range(edge..).next();
            if below.into_iter().chain(above).any(|neighbor| touch(neighbor, edge)) {
                return false;
            }
            active.insert(*edge);
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares every edge with every other.
    fn is_simple_by_pairs(corners: &[GridPoint]) -> bool {
        let count = corners.len();
        let edge = |i: usize| [corners[i], corners[(i + 1) % count]];
        (0..count).all(|i| {
            let [a, b] = edge(i);
            let c = edge((i + 1) % count)[1];
            let is_spike = orientation(a, b, c) == 0 && dot(a, b, c) >= 0;
            let others = (i + 2..count).filter(|j| (j + 1) % count != i);
            a != b && !is_spike && others.into_iter().all(|j| !crosses(edge(i), edge(j)))
        })
    }

    #[test]
    fn the_sweep_agrees_with_a_test_of_all_pairs() {
        let mut random = fastrand::Rng::with_seed(7);
        let mut simple = 0;
        for round in 0..60_000 {
            let (count, size) = (random.usize(3..9), [3, 5, 20, 1 << 29][round % 4]);
            let corners: Vec<_> =
                (0..count).map(|_| GridPoint::new(random.i32(-size..=size), random.i32(-size..=size))).collect();
            let expected = is_simple_by_pairs(&corners);
            assert_eq!(is_simple(&corners), expected, "{corners:?}");
            simple += usize::from(expected);
        }
        assert!(simple > 5_000, "{simple}");
    }
}
