//! Triangulation of a self-intersecting polygon by its winding numbers.
//!
//! Regions that the outline encloses counter-clockwise face like the polygon, clockwise regions face the other way, and
//! regions where the windings cancel are empty. The crate `i_overlay` finds the regions, and `i_triangle` triangulates
//! them. The run time of both crates grows with the number of crossings. Crossings are therefore counted first, and too
//! many are rejected.

use std::collections::HashMap;

use i_triangle::i_overlay::core::fill_rule::FillRule;
use i_triangle::i_overlay::core::overlay::IntOverlayOptions;
use i_triangle::int::triangulation::IntTriangulation;
use i_triangle::int::triangulator::IntTriangulator;
use i_triangle::int::validation::Validation;

use super::grid::{GridPoint, crosses, dot, orientation};

/// Maximum number of crossings per corner, in addition to [`FREE_CROSSINGS`].
const CROSSINGS_PER_CORNER: usize = 8;

/// Number of crossings allowed for any polygon.
const FREE_CROSSINGS: usize = 1000;

/// Maximum number of crossings of any polygon. Triangulating that many takes about 100 MB.
const MAX_CROSSINGS: usize = 200_000;

/// Maximum number of edge pairs that the search for crossings compares. Comparing that many takes about 0.2 s.
const MAX_PAIRS: usize = 100_000_000;

/// Point where the outline crosses itself, on the edge from corner `edge` to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::scene::format::obj) struct OutlineCrossing {
    /// Index of the corner where the edge starts.
    pub(in crate::scene::format::obj) edge: u32,
    /// Position on the edge, from 0 at its start to 1 at its end.
    pub(in crate::scene::format::obj) place: f64,
}

/// Returns the triangles of the regions with a non-zero winding number. Appends the points where edges cross each other
/// to `crossings`.
///
/// Indices from `corners.len()` on refer to `crossings`. Returns `None` if the outline crosses itself too often or if
/// the triangulation is cancelled.
pub(super) fn triangulate(
    corners: &[GridPoint],
    crossings: &mut Vec<OutlineCrossing>,
    is_cancelled: &dyn Fn() -> bool,
) -> Option<Vec<[u32; 3]>> {
    let outline = Outline::new(corners, is_cancelled)?;
    let mut numbers: HashMap<GridPoint, u32> = HashMap::with_capacity(corners.len());
    for (number, corner) in (0..).zip(corners) {
        numbers.entry(*corner).or_insert(number);
    }
    let mut triangles = Vec::new();
    for rule in [FillRule::Positive, FillRule::Negative] {
        let mut cutter = cutter(corners.len());
        cutter.fill_rule = rule;
        let IntTriangulation { points, indices } = cutter.triangulate_contour(&corners.to_vec());
        for triangle in indices.as_chunks::<3>().0 {
            let [a, b, c] = triangle.map(|index| {
                let point = points[index as usize];
                *numbers.entry(point).or_insert_with(|| {
                    crossings.push(outline.crossing_at(point));
                    (corners.len() + crossings.len() - 1) as u32
                })
            });
            // The crate makes all triangles counter-clockwise.
            triangles.push(if rule == FillRule::Positive { [a, b, c] } else { [a, c, b] });
        }
    }
    Some(triangles)
}

fn cutter(corners: usize) -> IntTriangulator<i32, u32> {
    // Corners in the middle of an edge are kept, because they may also belong to a neighbouring face.
    let validation = Validation { options: IntOverlayOptions::keep_all_points(), ..Validation::default() };
    IntTriangulator::new(corners, validation, Default::default())
}

/// Number of edges visited between cancellation checks.
const EDGES_PER_TEST: usize = 1 << 10;

/// Binary logarithm of the cell size in grid steps. The cell size is the maximum distance between the true crossing of
/// two edges and the rounded point that the crate returns.
const CELL_BITS: u32 = 4;

/// Edges of a polygon and their crossings.
struct Outline<'a> {
    corners: &'a [GridPoint],
    /// Indices of edges that cross another edge, keyed by the cell that contains the crossing.
    cells: HashMap<[i32; 2], Vec<u32>>,
}

impl<'a> Outline<'a> {
    /// Finds all crossings of an outline. Returns `None` if there are too many or if the search is cancelled.
    fn new(corners: &'a [GridPoint], is_cancelled: &dyn Fn() -> bool) -> Option<Self> {
        let mut this = Self { corners, cells: HashMap::new() };
        // Repeated edges are dropped, so that each of their crossings is counted once.
        let mut known = HashMap::with_capacity(corners.len());
        let mut edges: Vec<_> = (0..corners.len() as u32)
            .map(|number| (this.edge(number), number))
            .filter(|([a, b], number)| {
                a != b && *known.entry([a.min(b), a.max(b)].map(|p| *p)).or_insert(*number) == *number
            })
            .collect();
        // The sweep line meets the fewest edges at once if it moves along the axis in which the edges are shorter.
        let extent = |pick: fn(GridPoint) -> i32| -> u64 {
            edges.iter().map(|([a, b], _)| u64::from(pick(*a).abs_diff(pick(*b)))).sum()
        };
        let by_x = extent(|point| point.x) <= extent(|point| point.y);
        let range = |[a, b]: [GridPoint; 2], x: bool| {
            let [a, b] = [a, b].map(|point| if x { point.x } else { point.y });
            [a.min(b), a.max(b)]
        };
        edges.sort_unstable_by_key(|(edge, number)| (range(*edge, by_x)[0], *number));
        let (mut pairs, mut found) = (0, 0);
        let limit = (FREE_CROSSINGS + CROSSINGS_PER_CORNER * corners.len()).min(MAX_CROSSINGS);
        let mut active: Vec<([GridPoint; 2], u32)> = Vec::new();
        for (done, (edge, number)) in edges.into_iter().enumerate() {
            pairs += active.len();
            if pairs > MAX_PAIRS || (done % EDGES_PER_TEST == 0 && is_cancelled()) {
                return None;
            }
            let ([start, _], across) = (range(edge, by_x), range(edge, !by_x));
            active.retain(|(other, _)| range(*other, by_x)[1] >= start);
            for (other, other_number) in &active {
                let other_across = range(*other, !by_x);
                let is_apart = other_across[0] > across[1] || other_across[1] < across[0];
                if is_apart || !crosses_inside(edge, *other) {
                    continue;
                }
                found += 1;
                if found > limit {
                    return None;
                }
                let cell = intersection(edge, *other).map(|x| x >> CELL_BITS);
                this.cells.entry(cell).or_default().push(number.min(*other_number));
            }
            active.push((edge, number));
        }
        Some(this)
    }

    fn edge(&self, number: u32) -> [GridPoint; 2] {
        let number = number as usize;
        [self.corners[number], self.corners[(number + 1) % self.corners.len()]]
    }

    /// Returns the crossing at `point`. Its edge is the nearest edge with a crossing in the cells around `point`, or,
    /// if there is none, the nearest edge of the outline.
    fn crossing_at(&self, point: GridPoint) -> OutlineCrossing {
        let [x, y] = [point.x >> CELL_BITS, point.y >> CELL_BITS];
        let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| [x + dx, y + dy]));
        let nearby = around.filter_map(|cell| self.cells.get(&cell)).flatten().copied();
        let nearest = |edges: &mut dyn Iterator<Item = u32>| {
            edges.min_by(|a, b| self.distance(*a, point).total_cmp(&self.distance(*b, point)))
        };
        let found = nearest(&mut nearby.into_iter()).or_else(|| nearest(&mut (0..self.corners.len() as u32)));
        let edge = found.unwrap_or(0);
        OutlineCrossing { edge, place: self.place(edge, point) }
    }

    /// Returns the position on an edge that is nearest to `point`, from 0 at its start to 1 at its end.
    fn place(&self, edge: u32, point: GridPoint) -> f64 {
        let [start, end] = self.edge(edge);
        let length = dot(end, start, end);
        if length == 0 { 0.0 } else { (dot(end, start, point) as f64 / length as f64).clamp(0.0, 1.0) }
    }

    /// Returns the distance of `point` from an edge, in grid steps.
    fn distance(&self, edge: u32, point: GridPoint) -> f64 {
        let [start, end] = self.edge(edge);
        let place = self.place(edge, point);
        let offset =
            |from: i32, to: i32, at: i32| f64::from(from) + (f64::from(to) - f64::from(from)) * place - f64::from(at);
        offset(start.x, end.x, point.x).hypot(offset(start.y, end.y, point.y))
    }
}

/// Whether two segments meet anywhere except at one common endpoint.
fn crosses_inside([a, b]: [GridPoint; 2], [c, d]: [GridPoint; 2]) -> bool {
    let runs_back = |joint: GridPoint, end: GridPoint, other: GridPoint| {
        orientation(joint, end, other) == 0 && dot(end, joint, other) > 0
    };
    match (a, b) {
        _ if a == c => runs_back(a, b, d),
        _ if a == d => runs_back(a, b, c),
        _ if b == c => runs_back(b, a, d),
        _ if b == d => runs_back(b, a, c),
        _ => crosses([a, b], [c, d]),
    }
}

/// Returns the rounded intersection of two crossing segments; for parallel segments, an endpoint that lies on both.
fn intersection([a, b]: [GridPoint; 2], [c, d]: [GridPoint; 2]) -> [i32; 2] {
    let (from, to) = (orientation(c, d, a) as f64, orientation(c, d, b) as f64);
    if from == to {
        let end = a.max(c);
        return [end.x, end.y];
    }
    let place = from / (from - to);
    [(a.x, b.x), (a.y, b.y)]
        .map(|(from, to)| (f64::from(from) + (f64::from(to) - f64::from(from)) * place).round() as i32)
}
