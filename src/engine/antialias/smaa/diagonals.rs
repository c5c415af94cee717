//! Diagonals: stairs whose steps are one pixel wide and high, and the areas that they cut off.
//!
//! A diagonal is a chain of top edges, each joined to the next by a left edge. At either end, a horizontal edge, a
//! vertical edge or both may continue it. The smoothed edge is the line through the corners of the stairs at which these
//! edges start. Two lines are averaged if both edges continue the diagonal, or if none does.

use super::area::CutAreas;
use super::edges::{BitRows, Edges, MARGIN};

/// Maximum number of top edges over which a diagonal is followed in each direction from a pixel.
const SEARCH_STEPS: u32 = 8;

/// Minimum number of left edges that join the top edges of a diagonal.
const LINKS: usize = 3;

/// End of a diagonal, by the edges that continue it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum DiagonalEnd {
    /// No edge continues the diagonal, or its end is too far away.
    Open,
    /// A left edge continues it.
    Vertical,
    /// A top edge continues it.
    Horizontal,
    /// A left edge and a top edge continue it.
    Both,
}

impl DiagonalEnd {
    /// Returns the end that the given edges continue.
    fn new(vertical: bool, horizontal: bool) -> Self {
        match (vertical, horizontal) {
            (false, false) => Self::Open,
            (true, false) => Self::Vertical,
            (false, true) => Self::Horizontal,
            (true, true) => Self::Both,
        }
    }

    /// Returns points of the two lines to average. A vertical edge and a horizontal edge start at the given corners.
    fn points(self, vertical: [f32; 2], horizontal: [f32; 2]) -> [[f32; 2]; 2] {
        match self {
            Self::Open => [[0.0, 0.0], [1.0, 0.0]],
            Self::Vertical => [vertical; 2],
            Self::Horizontal => [horizontal; 2],
            Self::Both => [[1.0, 1.0], [1.0, 0.0]],
        }
    }
}

/// Returns the areas at a top edge of a rising diagonal, with `distances[0]` top edges to its left and `distances[1]` to
/// its right. At least one of them is positive.
fn areas(distances: [u32; 2], ends: [DiagonalEnd; 2]) -> CutAreas {
    // The y axis points up. Top edge number i of the diagonal goes from (i + 1, i + 1) to (i + 2, i + 1).
    let (at, length) = (distances[0] as f32, (distances[0] + distances[1] + 1) as f32);
    let starts = ends[0].points([1.0, 0.0], [1.0, 1.0]);
    let stops = ends[1].points([1.0, 1.0], [1.0, 0.0]);
    let [one, other] =
        [0, 1].map(|line| areas_of_line(starts[line], stops[line].map(|coordinate| coordinate + length), at));
    let CutAreas { before, after } = one + other;
    CutAreas { before: before * 0.5, after: after * 0.5 }
}

/// Returns the areas between top edge number `at` and a rising line through two points.
fn areas_of_line(from: [f32; 2], to: [f32; 2], at: f32) -> CutAreas {
    let slope = (to[1] - from[1]) / (to[0] - from[0]);
    // Heights of the line above the ends of the top edge.
    let left = from[1] - 1.0 - at + slope * (at + 1.0 - from[0]);
    let right = left + slope;
    // Antiderivative of the height, limited to the pixel above the edge.
    let integral = |height: f32| {
        let limited = height.clamp(0.0, 1.0);
        limited * (height - limited * 0.5)
    };
    CutAreas { before: (integral(right) - integral(left)) / slope, after: (integral(-left) - integral(-right)) / slope }
}

/// Direction in which a diagonal is followed.
#[derive(Clone, Copy)]
struct Direction {
    is_right: bool,
    is_down: bool,
}

/// Top edge that is part of a diagonal, or of two that cross.
#[derive(Clone, Copy, Debug)]
pub(super) struct DiagonalEdge {
    /// Column of the pixel below the edge.
    pub(super) x: usize,
    /// Sum of the areas that the diagonals cut off.
    pub(super) areas: CutAreas,
    /// Whether the left edge of the pixel is part of a diagonal: it joins the top edge to the next one below.
    pub(super) has_left: bool,
    /// Whether the left edge of the pixel to the right is part of a diagonal.
    pub(super) has_right: bool,
}

/// Diagonals of a picture. Columns are numbers of bits, which include the margin.
pub(super) struct Diagonals<'a> {
    top: &'a BitRows,
    left: &'a BitRows,
}

impl<'a> Diagonals<'a> {
    /// Returns the diagonals among `edges`.
    pub(super) fn new(edges: &'a Edges) -> Self {
        Self { top: &edges.top, left: &edges.left }
    }

    /// Calls `found` for every top edge of row `y`, of `width` px, that is part of a diagonal.
    pub(super) fn for_each(&self, y: usize, width: usize, mut found: impl FnMut(DiagonalEdge)) {
        let columns = MARGIN..MARGIN + width;
        let y = y as isize;
        let (top, rows) = (self.top.row(y), Rows::around(self, y));
        for word in columns.start / 64..columns.end.div_ceil(64) {
            if top[word] == 0 {
                continue;
            }
            let (rising, falling) = (rows.members::<false>(word), rows.members::<true>(word));
            let mut rest = rising | falling;
            while rest != 0 {
                let bit = rest.trailing_zeros() as usize;
                rest &= rest - 1;
                let at = word * 64 + bit;
                if columns.contains(&at) {
                    let mut edge =
                        DiagonalEdge { x: at - MARGIN, areas: CutAreas::default(), has_left: false, has_right: false };
                    if rising >> bit & 1 != 0 {
                        self.add_rising([at as isize, y], &mut edge);
                    }
                    if falling >> bit & 1 != 0 {
                        self.add_falling([at as isize, y], &mut edge);
                    }
                    found(edge);
                }
            }
        }
    }

    /// Adds the rising diagonal at the top edge of pixel `at`.
    fn add_rising(&self, at: [isize; 2], edge: &mut DiagonalEdge) {
        let left = self.follow(at, Direction { is_right: false, is_down: true });
        let right = self.follow(at, Direction { is_right: true, is_down: false });
        edge.areas = edge.areas + areas([left.0, right.0], [left.1, right.1]);
        edge.has_left |= left.0 > 0;
    }

    /// Adds the falling diagonal at the top edge of pixel `at`. Turned upside down, it rises.
    fn add_falling(&self, at: [isize; 2], edge: &mut DiagonalEdge) {
        let left = self.follow(at, Direction { is_right: false, is_down: false });
        let right = self.follow(at, Direction { is_right: true, is_down: true });
        let CutAreas { before, after } = areas([left.0, right.0], [left.1, right.1]);
        edge.areas = edge.areas + CutAreas { before: after, after: before };
        edge.has_right |= right.0 > 0;
    }

    /// Returns the number of top edges that follow that of pixel `at` in a direction, and the end of the diagonal there.
    fn follow(&self, at: [isize; 2], direction: Direction) -> (u32, DiagonalEnd) {
        let Direction { is_right, is_down } = direction;
        let [across, down] = [is_right, is_down].map(|is_positive| if is_positive { 1 } else { -1 });
        let [mut x, mut y] = at;
        let joint = |x: isize, y: isize| self.left.has(x + isize::from(is_right), y - isize::from(!is_down));
        for steps in 0..SEARCH_STEPS {
            if !(joint(x, y) && self.top.has(x + across, y + down)) {
                return (steps, DiagonalEnd::new(joint(x, y), self.top.has(x + across, y)));
            }
            (x, y) = (x + across, y + down);
        }
        (SEARCH_STEPS, DiagonalEnd::Open)
    }
}

/// Rows of edges around a row of pixels, from the top. The row of the pixels has the index [`LINKS`].
struct Rows<'a> {
    top: [&'a [u64]; 2 * LINKS + 1],
    left: [&'a [u64]; 2 * LINKS],
}

impl<'a> Rows<'a> {
    /// Returns the rows around row `y`.
    fn around(diagonals: &Diagonals<'a>, y: isize) -> Self {
        let row = |index: usize| y + index as isize - LINKS as isize;
        Self {
            top: std::array::from_fn(|index| diagonals.top.row(row(index))),
            left: std::array::from_fn(|index| diagonals.left.row(row(index))),
        }
    }

    /// Returns the bits of a word whose top edges are part of a diagonal with at least [`LINKS`] left edges.
    #[inline(always)]
    fn members<const IS_FALLING: bool>(&self, word: usize) -> u64 {
        let along = |row: isize| if IS_FALLING { row } else { -row };
        let index = |row: isize| (row + LINKS as isize) as usize;
        let top = |row: isize| shifted(self.top[index(row)], word, along(row));
        // Bits whose top edge in a row below them is joined to the next one by a left edge.
        let linked = |row: isize| {
            let left = shifted(self.left[index(row)], word, along(row) + isize::from(IS_FALLING));
            left & top(row) & top(row + 1)
        };
        let (below, above) = (linked(0), linked(-1));
        if below | above == 0 {
            return 0;
        }
        let (two_below, two_above) = (below & linked(1), above & linked(-2));
        two_below & (linked(2) | above) | two_above & (linked(-3) | below)
    }
}

/// Returns a word of a row of bits, moved so that every bit comes from `columns` bits after it.
#[inline(always)]
fn shifted(row: &[u64], word: usize, columns: isize) -> u64 {
    let first = if columns < 0 { word - 1 } else { word };
    let pair = u128::from(row[first]) | u128::from(row[first + 1]) << 64;
    (pair >> columns.rem_euclid(64)) as u64
}

#[cfg(test)]
mod tests {
    use super::DiagonalEnd::{Both, Horizontal, Open, Vertical};
    use super::*;
    use crate::image::Image;
    use crate::math::lanes::Lanes;

    /// Start of a line, and its end relative to the number of top edges.
    type Line = [[f64; 2]; 2];

    /// Lines to average for every pattern, as in the publication's program for the area texture.
    const PATTERNS: [([DiagonalEnd; 2], [Line; 2]); 16] = [
        ([Open, Open], [[[1.0, 1.0], [1.0, 1.0]], [[1.0, 0.0], [1.0, 0.0]]]),
        ([Vertical, Open], [[[1.0, 0.0], [0.0, 0.0]], [[1.0, 0.0], [1.0, 0.0]]]),
        ([Open, Horizontal], [[[0.0, 0.0], [1.0, 0.0]], [[1.0, 0.0], [1.0, 0.0]]]),
        ([Vertical, Horizontal], [[[1.0, 0.0], [1.0, 0.0]], [[1.0, 0.0], [1.0, 0.0]]]),
        ([Horizontal, Open], [[[1.0, 1.0], [0.0, 0.0]], [[1.0, 1.0], [1.0, 0.0]]]),
        ([Both, Open], [[[1.0, 1.0], [0.0, 0.0]], [[1.0, 0.0], [1.0, 0.0]]]),
        ([Horizontal, Horizontal], [[[1.0, 1.0], [1.0, 0.0]], [[1.0, 1.0], [1.0, 0.0]]]),
        ([Both, Horizontal], [[[1.0, 1.0], [1.0, 0.0]], [[1.0, 0.0], [1.0, 0.0]]]),
        ([Open, Vertical], [[[0.0, 0.0], [1.0, 1.0]], [[1.0, 0.0], [1.0, 1.0]]]),
        ([Vertical, Vertical], [[[1.0, 0.0], [1.0, 1.0]], [[1.0, 0.0], [1.0, 1.0]]]),
        ([Open, Both], [[[0.0, 0.0], [1.0, 1.0]], [[1.0, 0.0], [1.0, 0.0]]]),
        ([Vertical, Both], [[[1.0, 0.0], [1.0, 1.0]], [[1.0, 0.0], [1.0, 0.0]]]),
        ([Horizontal, Vertical], [[[1.0, 1.0], [1.0, 1.0]], [[1.0, 1.0], [1.0, 1.0]]]),
        ([Both, Vertical], [[[1.0, 1.0], [1.0, 1.0]], [[1.0, 0.0], [1.0, 1.0]]]),
        ([Horizontal, Both], [[[1.0, 1.0], [1.0, 1.0]], [[1.0, 1.0], [1.0, 0.0]]]),
        ([Both, Both], [[[1.0, 1.0], [1.0, 1.0]], [[1.0, 0.0], [1.0, 0.0]]]),
    ];

    /// Returns the share of the unit square at `corner` that lies below the line, by columns of its points.
    fn below([from, to]: Line, corner: [f64; 2]) -> f64 {
        const STEPS: u32 = 2000;
        let height = |step: u32| {
            let x = corner[0] + (f64::from(step) + 0.5) / f64::from(STEPS);
            let share = (x - from[0]) / (to[0] - from[0]);
            (from[1] + (to[1] - from[1]) * share - corner[1]).clamp(0.0, 1.0)
        };
        (0..STEPS).map(height).sum::<f64>() / f64::from(STEPS)
    }

    #[test]
    fn areas_are_integrals_of_the_published_lines() {
        for (ends, lines) in PATTERNS {
            for distances in (0..=SEARCH_STEPS).flat_map(|left| (0..=SEARCH_STEPS).map(move |right| [left, right])) {
                if distances[0] + distances[1] < 3 {
                    continue;
                }
                let (at, length) = (f64::from(distances[0]), f64::from(distances[0] + distances[1] + 1));
                let lines = lines.map(|[from, to]| [from, [to[0] + length, to[1] + length]]);
                let mean = |area: &dyn Fn(Line) -> f64| lines.iter().map(|line| area(*line)).sum::<f64>() / 2.0;
                let before = mean(&|line| below(line, [at + 1.0, at + 1.0]));
                let after = mean(&|line| 1.0 - below(line, [at + 1.0, at]));
                let found = areas(distances, ends);
                for (area, exact) in [(found.before, before), (found.after, after)] {
                    assert!((f64::from(area) - exact).abs() < 1e-4, "{ends:?} {distances:?}: {area}, not {exact}");
                }
            }
        }
    }

    #[test]
    fn members_are_the_top_edges_of_chains_of_at_least_four() {
        let mut random = fastrand::Rng::with_seed(4);
        // Mostly diagonal edges in both directions, disturbed by single pixels.
        let picture = Image::from_fn(150, 60, |x, y| {
            let is_light = if y < 30 { (x + y) % 23 < 11 } else { (x + 97 - y) % 19 < 9 };
            [if is_light != (random.u8(..) < 20) { 255 } else { 0 }; 4]
        });
        let mut edges = Edges::default();
        edges.find(Lanes::best(), &picture);
        let (top, left) = (
            |x: isize, y: isize| edges.top.has(x + MARGIN as isize, y),
            |x: isize, y: isize| edges.left.has(x + MARGIN as isize, y),
        );
        let (mut members, mut others) = (0, 0);
        for y in 0..=60 {
            let mut found = Vec::new();
            Diagonals::new(&edges).for_each(y, 150, |edge| found.push(edge.x));
            for x in 0..150 {
                let (column, y) = (x as isize, y as isize);
                // Numbers of top edges in a row, each joined to the next, towards the left and the right.
                let rising = [
                    (0..).take_while(|i| left(column - i, y + i) && top(column - i - 1, y + i + 1)).count(),
                    (0..).take_while(|i| left(column + i + 1, y - i - 1) && top(column + i + 1, y - i - 1)).count(),
                ];
                let falling = [
                    (0..).take_while(|i| left(column - i, y - i - 1) && top(column - i - 1, y - i - 1)).count(),
                    (0..).take_while(|i| left(column + i + 1, y + i) && top(column + i + 1, y + i + 1)).count(),
                ];
                let is_member = [rising, falling].iter().any(|[left, right]| left + right >= 3) && top(column, y);
                assert_eq!(found.contains(&x), is_member, "({x}, {y})");
                *(if is_member { &mut members } else { &mut others }) += u32::from(top(column, y));
            }
        }
        assert!(members > 100 && others > 100, "{members} {others}");
    }
}
