//! Sweep-line triangulation of a polygon that does not touch itself, in O(n log n).
//!
//! The sweep line visits the corners from left to right. Each section of the line inside the polygon has a lower edge
//! and a chain of corners. The chain holds the corners on the left that are not yet cut off, from the lower to the
//! upper edge. A new corner cuts off the visible part of the chain (Hertel and Mehlhorn, "Fast Triangulation of Simple
//! Polygons", 1983). Neighbouring edges are tested for contact during the sweep (Shamos and Hoey, "Geometric
//! Intersection Problems", 1976), and an outline that touches itself is rejected. All decisions are exact, on an
//! integer grid.

use std::cmp::Ordering;
use std::collections::{BTreeMap, VecDeque};
use std::ops::Bound::{Excluded, Unbounded};

use super::grid::{GridPoint, crosses, dot, orientation};

/// Number of corners visited between cancellation checks.
const CORNERS_PER_TEST: usize = 1 << 12;

/// Edge of the polygon, with its endpoints in sweep order.
#[derive(Clone, Copy)]
struct SweepEdge {
    left: GridPoint,
    right: GridPoint,
    /// Index of the corner where the edge starts.
    number: usize,
}

impl SweepEdge {
    /// Returns the position of `point` relative to the edge: positive above, negative below, 0 on its line.
    fn side(&self, point: GridPoint) -> i64 {
        orientation(self.left, self.right, point)
    }

    /// Returns the vertical order of two edges. `later` must start at the same x or farther right. Compares the left
    /// endpoint of `later` with `self`, or the right endpoint if the left one lies on the line of `self`.
    fn order(&self, later: &Self) -> Ordering {
        let side = self.side(later.left);
        let side = if side == 0 { self.side(later.right) } else { side };
        0.cmp(&side)
    }
}

impl Ord for SweepEdge {
    fn cmp(&self, other: &Self) -> Ordering {
        if self.number == other.number {
            return Ordering::Equal;
        }
        let order = if self.left <= other.left { self.order(other) } else { other.order(self).reverse() };
        order.then(self.number.cmp(&other.number))
    }
}

impl PartialOrd for SweepEdge {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for SweepEdge {
    fn eq(&self, other: &Self) -> bool {
        self.number == other.number
    }
}

impl Eq for SweepEdge {}

/// Corners left of the sweep line that are not yet triangulated, between a lower and an upper edge, from bottom to top.
#[derive(Default)]
struct Chain {
    corners: VecDeque<usize>,
    /// Index in `corners` of the rightmost corner, which sees the whole section of the sweep line between the two
    /// edges.
    rightmost: usize,
}

/// Returns the triangles of a closed counter-clockwise polygon as corner indices. All triangles are counter-clockwise;
/// a polygon of n corners has n − 2 of them.
///
/// Returns `None` if edges touch anywhere but at a common corner, if the polygon is clockwise, or if the triangulation
/// is cancelled.
pub(super) fn triangulate(corners: &[GridPoint], is_cancelled: &dyn Fn() -> bool) -> Option<Vec<[u32; 3]>> {
    let count = corners.len();
    let is_spike = |i: usize| {
        let [a, b, c] = [(i + count - 1) % count, i, (i + 1) % count].map(|corner| corners[corner]);
        orientation(a, b, c) == 0 && dot(a, b, c) >= 0
    };
    let doubled_area: i128 =
        (1..count - 1).map(|i| i128::from(orientation(corners[0], corners[i], corners[i + 1]))).sum();
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_unstable_by_key(|corner| corners[*corner]);
    let has_equal = order.windows(2).any(|pair| corners[pair[0]] == corners[pair[1]]);
    if doubled_area <= 0 || has_equal || (0..count).any(is_spike) {
        return None;
    }
    let mut sweep = Sweep { corners, line: BTreeMap::new(), triangles: Vec::with_capacity(count - 2) };
    for (done, corner) in order.into_iter().enumerate() {
        if done % CORNERS_PER_TEST == 0 && is_cancelled() {
            return None;
        }
        sweep.visit(corner)?;
    }
    Some(sweep.triangles)
}

struct Sweep<'a> {
    corners: &'a [GridPoint],
    /// Edges that cross the sweep line, from bottom to top. If the inside of the polygon is above an edge, the value is
    /// the chain of the section of the line above the edge; otherwise, it is `None`.
    line: BTreeMap<SweepEdge, Option<Chain>>,
    triangles: Vec<[u32; 3]>,
}

impl Sweep<'_> {
    /// Moves the sweep line over a corner. Returns `None` if edges touch.
    fn visit(&mut self, corner: usize) -> Option<()> {
        let count = self.corners.len();
        let (previous, next) = ((corner + count - 1) % count, (corner + 1) % count);
        let [a, b, c] = [previous, corner, next].map(|i| self.corners[i]);
        let (arriving, leaving) = (self.edge(previous), self.edge(corner));
        let is_convex = orientation(a, b, c) > 0;
        match (a < b, c < b) {
            // The corner ends one lower edge of a section and begins the next.
            (true, false) => {
                let mut chain = self.remove(&arriving)??;
                self.add_below(&mut chain, corner);
                self.insert(leaving, Some(chain))
            }
            // The corner ends one upper edge of a section and begins the next.
            (false, true) => {
                self.remove(&leaving)?;
                let mut chain = self.take_below(&leaving)?;
                self.add_above(&mut chain, corner);
                self.put_below(&leaving, chain)?;
                self.insert(arriving, None)
            }
            (false, false) if is_convex => {
                self.insert(leaving, Some(Chain { corners: [corner].into(), rightmost: 0 }))?;
                self.insert(arriving, None)
            }
            // The corner splits a section of the sweep line in two.
            (false, false) => {
                let mut lower = self.take_below(&arriving)?;
                let mut upper = lower.split();
                self.add_above(&mut lower, corner);
                self.add_below(&mut upper, corner);
                self.put_below(&arriving, lower)?;
                self.insert(arriving, None)?;
                self.insert(leaving, Some(upper))
            }
            (true, true) if is_convex => {
                let chain = self.remove(&arriving)??;
                self.remove(&leaving)?;
                for (low, high) in chain.corners.iter().zip(chain.corners.iter().skip(1)) {
                    self.triangles.push([*low, corner, *high].map(|i| i as u32));
                }
                Some(())
            }
            // The corner merges two sections of the sweep line.
            (true, true) => {
                let mut upper = self.remove(&arriving)??;
                self.remove(&leaving)?;
                let mut lower = self.take_below(&leaving)?;
                self.add_above(&mut lower, corner);
                self.add_below(&mut upper, corner);
                lower.join(upper);
                self.put_below(&leaving, lower)
            }
        }
    }

    fn edge(&self, number: usize) -> SweepEdge {
        let ends = [self.corners[number], self.corners[(number + 1) % self.corners.len()]];
        SweepEdge { left: ends[0].min(ends[1]), right: ends[0].max(ends[1]), number }
    }

    fn touch(&self, a: &SweepEdge, b: &SweepEdge) -> bool {
        let next = |number: usize| (number + 1) % self.corners.len();
        let are_neighbors = next(a.number) == b.number || next(b.number) == a.number;
        !are_neighbors && crosses([a.left, a.right], [b.left, b.right])
    }

    /// Removes an edge from the sweep line. Returns `None` if its neighbours touch, or if it is not found because
    /// crossing edges have changed their order.
    fn remove(&mut self, edge: &SweepEdge) -> Option<Option<Chain>> {
        let chain = self.line.remove(edge)?;
        let below = self.line.range(..edge).next_back();
        let above = self.line.range((Excluded(edge), Unbounded)).next();
        let is_free = !below.zip(above).is_some_and(|((below, _), (above, _))| self.touch(below, above));
        is_free.then_some(chain)
    }

    /// Inserts an edge into the sweep line. Returns `None` if it touches a neighbour.
    fn insert(&mut self, edge: SweepEdge, chain: Option<Chain>) -> Option<()> {
        let below = self.line.range(..&edge).next_back();
        let above = self.line.range(&edge..).next();
        if below.into_iter().chain(above).any(|(neighbor, _)| self.touch(neighbor, &edge)) {
            return None;
        }
        self.line.insert(edge, chain);
        Some(())
    }

    /// Removes and returns the chain of the section of the sweep line below `edge`. The edge must not be in the sweep
    /// line.
    fn take_below(&mut self, edge: &SweepEdge) -> Option<Chain> {
        self.line.range_mut(..edge).next_back()?.1.take()
    }

    /// Stores the chain of the section of the sweep line below `edge`. The edge must not be in the sweep line.
    fn put_below(&mut self, edge: &SweepEdge, chain: Chain) -> Option<()> {
        *self.line.range_mut(..edge).next_back()?.1 = Some(chain);
        Some(())
    }

    /// Adds a corner at the lower end of a chain, after cutting off the chain's corners that are visible from it.
    fn add_below(&mut self, chain: &mut Chain, corner: usize) {
        while let (Some(&low), Some(&high)) = (chain.corners.front(), chain.corners.get(1)) {
            if !self.cut(low, high, corner) {
                break;
            }
            chain.corners.pop_front();
        }
        chain.corners.push_front(corner);
        chain.rightmost = 0;
    }

    /// Adds a corner at the upper end of a chain, after cutting off the chain's corners that are visible from it.
    fn add_above(&mut self, chain: &mut Chain, corner: usize) {
        while let [Some(&low), Some(&high)] =
            [chain.corners.len().checked_sub(2).and_then(|i| chain.corners.get(i)), chain.corners.back()]
        {
            if !self.cut(low, high, corner) {
                break;
            }
            chain.corners.pop_back();
        }
        chain.corners.push_back(corner);
        chain.rightmost = chain.corners.len() - 1;
    }

    /// Cuts off the triangle formed by a new corner and an edge of a chain. Returns `false` if the edge is not visible
    /// from the corner.
    fn cut(&mut self, low: usize, high: usize, corner: usize) -> bool {
        let is_seen = orientation(self.corners[low], self.corners[corner], self.corners[high]) > 0;
        if is_seen {
            self.triangles.push([low, corner, high].map(|i| i as u32));
        }
        is_seen
    }
}

impl Chain {
    /// Splits the chain at its rightmost corner, which both parts keep, and returns the upper part. Only the shorter
    /// part is moved.
    fn split(&mut self) -> Self {
        let shared = self.corners[self.rightmost];
        let mut upper = if self.rightmost > self.corners.len() / 2 {
            self.corners.split_off(self.rightmost + 1)
        } else {
            let lower: VecDeque<usize> = self.corners.drain(..=self.rightmost).collect();
            std::mem::replace(&mut self.corners, lower)
        };
        upper.push_front(shared);
        Self { corners: upper, rightmost: 0 }
    }

    /// Appends a chain that starts with this chain's last corner. That corner becomes the rightmost one. Only the
    /// shorter chain is moved.
    fn join(&mut self, mut upper: Self) {
        self.rightmost = self.corners.len() - 1;
        self.corners.pop_back();
        if self.corners.len() < upper.corners.len() {
            while let Some(corner) = self.corners.pop_back() {
                upper.corners.push_front(corner);
            }
            self.corners = upper.corners;
        } else {
            self.corners.append(&mut upper.corners);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::*;

    fn triangulate(corners: &[GridPoint]) -> Option<Vec<[u32; 3]>> {
        super::triangulate(corners, &|| false)
    }

    /// Whether no two edges touch, except at common corners. Compares all pairs.
    fn is_simple(corners: &[GridPoint]) -> bool {
        let count = corners.len();
        let edge = |i: usize| [corners[i], corners[(i + 1) % count]];
        (0..count).all(|i| {
            let [a, b] = edge(i);
            let c = edge((i + 1) % count)[1];
            let is_spike = orientation(a, b, c) == 0 && dot(a, b, c) >= 0;
            a != b && !is_spike && (i + 2..count).filter(|j| (j + 1) % count != i).all(|j| !crosses(edge(i), edge(j)))
        })
    }

    fn doubled_area(corners: &[GridPoint]) -> i64 {
        (1..corners.len() - 1).map(|i| orientation(corners[0], corners[i], corners[i + 1])).sum()
    }

    /// Asserts that triangles have the winding and the total area of a simple polygon and share each inner edge. These
    /// conditions suffice for a valid triangulation.
    fn assert_cut(corners: &[GridPoint], triangles: &[[u32; 3]]) {
        assert_eq!(triangles.len(), corners.len() - 2, "{corners:?}");
        let mut open: HashMap<[u32; 2], i32> = HashMap::new();
        let mut area = 0;
        for &[a, b, c] in triangles {
            let own = orientation(corners[a as usize], corners[b as usize], corners[c as usize]);
            assert!(own > 0, "{corners:?}");
            area += own;
            for edge in [[a, b], [b, c], [c, a]] {
                *open.entry(edge).or_default() += 1;
                *open.entry([edge[1], edge[0]]).or_default() -= 1;
            }
        }
        assert_eq!(area, doubled_area(corners));
        for i in 0..corners.len() as u32 {
            let edge = [i, (i + 1) % corners.len() as u32];
            assert_eq!(open.remove(&edge), Some(1));
            assert_eq!(open.remove(&[edge[1], edge[0]]), Some(-1));
        }
        assert!(open.values().all(|count| *count == 0));
    }

    #[test]
    fn the_sweep_triangulates_simple_polygons_only() {
        let mut random = fastrand::Rng::with_seed(7);
        let mut simple = 0;
        for round in 0..100_000 {
            let (count, size) = (random.usize(3..10), [2, 3, 5, 20, 1 << 29][round % 5]);
            let mut corners: Vec<_> =
                (0..count).map(|_| GridPoint::new(random.i32(-size..=size), random.i32(-size..=size))).collect();
            let expected = is_simple(&corners);
            if expected && doubled_area(&corners) < 0 {
                assert_eq!(triangulate(&corners), None, "it is clockwise: {corners:?}");
                corners.reverse();
            }
            let found = triangulate(&corners);
            assert_eq!(found.is_some(), expected, "{corners:?}");
            if let Some(triangles) = found {
                assert_cut(&corners, &triangles);
                simple += 1;
            }
        }
        assert!(simple > 5_000, "{simple}");
    }

    /// Returns a simple polygon around the origin with corners at random distances and a random rotation.
    fn star(count: usize, random: &mut fastrand::Rng) -> Vec<GridPoint> {
        let turn = random.f64() * std::f64::consts::TAU;
        (0..count)
            .map(|i| {
                let (y, x) = (turn + i as f64 / count as f64 * std::f64::consts::TAU).sin_cos();
                let radius = f64::from(1 << 28) * (0.1 + 0.9 * random.f64());
                GridPoint::new((x * radius) as i32, (y * radius) as i32)
            })
            .collect()
    }

    #[test]
    fn parts_are_split_and_joined_in_every_order() {
        let mut random = fastrand::Rng::with_seed(8);
        for _ in 0..2_000 {
            let count = random.usize(3..80);
            let mut corners = star(count, &mut random);
            corners.rotate_left(random.usize(0..count));
            assert_cut(&corners, &triangulate(&corners).unwrap());
        }
    }

    #[test]
    fn long_straight_and_hollow_sides_take_no_quadratic_time() {
        let count = 200_000;
        // A straight or concave side is visible as a whole only from the last corner.
        let straight = |x: i32| GridPoint::new(x, 1000);
        let hollow = |x: i32| GridPoint::new(x, (i64::from(x - count / 2).pow(2) / 40) as i32 + 1000);
        for side in [&straight as &dyn Fn(i32) -> GridPoint, &hollow] {
            let mut corners: Vec<_> = (0..count).rev().map(side).collect();
            corners.extend([GridPoint::new(-1, 0), GridPoint::new(count, 0)]);
            corners.rotate_left(count as usize / 3);
            assert_cut(&corners, &triangulate(&corners).unwrap());
        }
    }

    #[test]
    fn it_ends_when_it_is_cancelled() {
        let corners = star(1000, &mut fastrand::Rng::with_seed(9));
        assert_eq!(super::triangulate(&corners, &|| true), None);
    }
}
