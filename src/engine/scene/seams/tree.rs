//! Bounding-box tree over points, which finds all points near a line segment.

use glam::DVec3;

/// Maximum number of points in a leaf.
const LEAF: usize = 8;

/// Maximum number of points that are ordered without splitting the work between threads.
const SERIAL: usize = 8192;

/// Balanced binary tree of points. Each node splits its points at their median along the longest axis of the bounding
/// box.
#[derive(Debug)]
pub(super) struct PointTree {
    /// Points in the order of the leaves.
    points: Vec<DVec3>,
    /// Index of each point in the slice from which the tree was built.
    numbers: Vec<u32>,
    /// Minimum and maximum corner of each node's bounding box. The children of node i are nodes 2i + 1 and 2i + 2.
    boxes: Vec<[DVec3; 2]>,
}

impl PointTree {
    /// Builds the tree. All coordinates must be finite.
    pub(super) fn new(points: &[DVec3]) -> Self {
        let mut numbers: Vec<u32> = (0..points.len() as u32).collect();
        order(points, &mut numbers);
        let points: Vec<DVec3> = numbers.iter().map(|number| points[*number as usize]).collect();
        let leaves = points.len().div_ceil(LEAF).next_power_of_two();
        let mut tree = Self { boxes: vec![[DVec3::INFINITY, DVec3::NEG_INFINITY]; 2 * leaves], points, numbers };
        tree.surround(0, 0, tree.points.len());
        tree
    }

    /// Computes the bounding boxes of `node`, which contains the points `first..end`, and of its descendants. Returns
    /// the box of `node`.
    fn surround(&mut self, node: usize, first: usize, end: usize) -> [DVec3; 2] {
        let own = if end - first <= LEAF {
            bounds(self.points[first..end].iter().copied())
        } else {
            let middle = first + (end - first) / 2;
            let [a, b] = self.surround(2 * node + 1, first, middle);
            let [c, d] = self.surround(2 * node + 2, middle, end);
            [a.min(c), b.max(d)]
        };
        self.boxes[node] = own;
        own
    }

    /// Calls `sink` with the index of every point whose distance from the segment is at most `reach`. Indices refer to
    /// the slice from which the tree was built.
    pub(super) fn near(&self, segment: [DVec3; 2], reach: f64, mut sink: impl FnMut(u32)) {
        let mut waiting = vec![(0, 0, self.points.len())];
        while let Some((node, first, end)) = waiting.pop() {
            if !may_be_near(self.boxes[node], segment, reach) {
                continue;
            }
            if end - first > LEAF {
                let middle = first + (end - first) / 2;
                waiting.extend([(2 * node + 1, first, middle), (2 * node + 2, middle, end)]);
                continue;
            }
            for (point, number) in self.points[first..end].iter().zip(&self.numbers[first..end]) {
                if distance(*point, segment) <= reach {
                    sink(*number);
                }
            }
        }
    }
}

/// Sorts point indices into the order of the leaves, by splitting them recursively at the median along the longest
/// axis.
fn order(points: &[DVec3], numbers: &mut [u32]) {
    if numbers.len() <= LEAF {
        return;
    }
    let [least, greatest] = bounds(numbers.iter().map(|number| points[*number as usize]));
    let sides = greatest - least;
    let axis = (0..3).max_by(|a, b| sides[*a].total_cmp(&sides[*b])).unwrap_or(0);
    let middle = numbers.len() / 2;
    let key = |number: &u32| points[*number as usize][axis];
    numbers.select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)));
    let is_large = numbers.len() > SERIAL;
    let (low, high) = numbers.split_at_mut(middle);
    if is_large {
        rayon::join(|| order(points, low), || order(points, high));
    } else {
        order(points, low);
        order(points, high);
    }
}

fn bounds(points: impl Iterator<Item = DVec3>) -> [DVec3; 2] {
    points.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[least, greatest], point| {
        [least.min(point), greatest.max(point)]
    })
}

/// Whether the segment intersects the box after it is expanded by `reach` on all sides. Conservative: near the corners
/// of the box, the result may be `true` for a segment farther away than `reach`.
fn may_be_near([least, greatest]: [DVec3; 2], [from, to]: [DVec3; 2], reach: f64) -> bool {
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for axis in 0..3 {
        let (low, high) = (least[axis] - reach, greatest[axis] + reach);
        let (start, run) = (from[axis], to[axis] - from[axis]);
        if run == 0.0 {
            if start < low || start > high {
                return false;
            }
            continue;
        }
        let (a, b) = ((low - start) / run, (high - start) / run);
        enter = enter.max(a.min(b));
        leave = leave.min(a.max(b));
    }
    enter <= leave
}

fn distance(point: DVec3, [from, to]: [DVec3; 2]) -> f64 {
    let run = to - from;
    let t = ((point - from).dot(run) / run.length_squared()).clamp(0.0, 1.0);
    point.distance(from + run * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tree_finds_the_same_points_as_a_linear_search() {
        let mut rng = fastrand::Rng::with_seed(5);
        for count in [1, 7, 8, 9, 100, 1000, 20_000] {
            let mut point = || DVec3::new(rng.f64(), rng.f64(), rng.f64() * 0.1);
            let points: Vec<DVec3> = (0..count).map(|_| point()).collect();
            let tree = PointTree::new(&points);
            let mut found_at_all = 0;
            for _ in 0..20 {
                let mut segment = [point(), point()];
                segment[1].x = if count % 2 == 0 { segment[0].x } else { segment[1].x };
                let mut found = Vec::new();
                tree.near(segment, 0.03, |number| found.push(number));
                found.sort_unstable();
                let expected: Vec<u32> =
                    (0..count).filter(|number| distance(points[*number as usize], segment) <= 0.03).collect();
                assert_eq!(found, expected);
                found_at_all += found.len();
            }
            assert!(count < 100 || found_at_all > 0);
        }
    }
}
