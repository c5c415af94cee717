//! Areas that a smoothed edge cuts off from the pixels beside it.
//!
//! A line of edges between two rows of pixels ends where another edge crosses it. There, the smoothed edge starts at the
//! middle of the crossing edge, half a pixel off the line. Heights are positive towards the pixels after the line, those
//! whose edge it is, and negative towards the pixels before it.

use std::cmp::Ordering;
use std::ops::Add;
use std::sync::LazyLock;

use super::SEARCH_PX;
use super::lines::LinePart;

/// Length in pixels up to which the areas of a line with both ends on one side are enlarged.
const SMOOTHED_PX: f32 = 32.0;

/// Share of the areas that is kept near a corner.
const CORNER_ROUNDING: f32 = 0.25;

/// Number of distances from an end of a line at which the end matters.
const DISTANCES: usize = SEARCH_PX as usize + 1;

/// End of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LineEnd {
    /// No edge crosses the line, or its end is too far away.
    Open,
    /// An edge crosses from the pixels before the line.
    Before,
    /// An edge crosses from the pixels after the line.
    After,
    /// Edges cross from both sides.
    Both,
}

impl LineEnd {
    const ALL: [Self; 4] = [Self::Open, Self::Before, Self::After, Self::Both];

    /// Returns the end at which edges cross on the given sides.
    pub(super) fn new(before: bool, after: bool) -> Self {
        match (before, after) {
            (false, false) => Self::Open,
            (true, false) => Self::Before,
            (false, true) => Self::After,
            (true, true) => Self::Both,
        }
    }

    /// Returns the height of the smoothed edge at this end, if it is on one side.
    fn height(self) -> Option<f32> {
        match self {
            Self::Open | Self::Both => None,
            Self::Before => Some(-0.5),
            Self::After => Some(0.5),
        }
    }
}

/// Sides of a line on which its end is a corner: the crossing edge on that side is longer than one pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Corner {
    pub(super) before: bool,
    pub(super) after: bool,
}

/// Areas between a line of edges and the smoothed edge within a pair of pixels, as fractions of a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct CutAreas {
    /// Area in the pixel before the line.
    pub(super) before: f32,
    /// Area in the pixel after the line.
    pub(super) after: f32,
}

/// Part of a smoothed edge: a straight segment from one point to another.
struct Segment {
    from: [f32; 2],
    to: [f32; 2],
}

impl Segment {
    /// Returns the areas between the segment and the line, from position `x` to `x` + 1.
    fn areas(&self, x: f32) -> CutAreas {
        let Self { from, to } = *self;
        let (start, end) = (x.max(from[0]), (x + 1.0).min(to[0]));
        if end <= start {
            return CutAreas::default();
        }
        let slope = (to[1] - from[1]) / (to[0] - from[0]);
        let [first, last] = [start, end].map(|x| from[1] + slope * (x - from[0]));
        if first * last < 0.0 {
            let crossing = first / (first - last) * (end - start);
            let areas = [first * crossing, last * (end - start - crossing)].map(|doubled| doubled * 0.5);
            return CutAreas { before: -areas[0].min(areas[1]), after: areas[0].max(areas[1]) };
        }
        let area = (first + last) * 0.5 * (end - start);
        CutAreas { before: (-area).max(0.0), after: area.max(0.0) }
    }
}

impl Add for CutAreas {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { before: self.before + other.before, after: self.after + other.after }
    }
}

impl CutAreas {
    /// Reduces the areas of a pixel if the nearer end of its line is a corner. A pixel in the middle of a line is affected
    /// half as much by each end.
    pub(super) fn sharpened(self, distances: [usize; 2], corners: [Corner; 2]) -> Self {
        let [start, end] = match distances[0].cmp(&distances[1]) {
            Ordering::Less => [1.0, 0.0],
            Ordering::Equal => [0.5, 0.5],
            Ordering::Greater => [0.0, 1.0],
        };
        let kept = |is_corner: fn(Corner) -> bool| {
            let [first, last] = corners.map(|corner| f32::from(u8::from(is_corner(corner))));
            1.0 - (1.0 - CORNER_ROUNDING) * (start * first + end * last)
        };
        Self { before: self.before * kept(|corner| corner.before), after: self.after * kept(|corner| corner.after) }
    }

    /// Enlarges the areas on a line of `length` px: small arcs would hardly be visible otherwise.
    fn enlarged(self, length: f32) -> Self {
        let share = (length / SMOOTHED_PX).min(1.0);
        let enlarged = |area: f32| {
            let root = (2.0 * area).sqrt() * 0.5;
            root + (area - root) * share
        };
        Self { before: enlarged(self.before), after: enlarged(self.after) }
    }
}

/// Returns the areas at a pixel with `distances[0]` pixels before it and `distances[1]` pixels after it on the line.
pub(super) fn areas(distances: [u32; 2], ends: [LineEnd; 2]) -> CutAreas {
    let (x, length) = (distances[0] as f32, (distances[0] + distances[1] + 1) as f32);
    let middle = length * 0.5;
    let first = |height: f32| Segment { from: [0.0, height], to: [middle, 0.0] }.areas(x);
    let second = |height: f32| Segment { from: [middle, 0.0], to: [length, height] }.areas(x);
    let whole = |heights: [f32; 2]| Segment { from: [0.0, heights[0]], to: [length, heights[1]] }.areas(x);
    match (ends.map(LineEnd::height), ends) {
        ([Some(from), Some(to)], _) if from == to => {
            let [first, second] = [first(from), second(to)].map(|areas| areas.enlarged(length));
            first + second
        }
        ([Some(from), Some(to)], _) => whole([from, to]),
        // Where edges cross from both sides, the smoothed edge takes the side that makes it continue.
        ([Some(from), None], [_, LineEnd::Both]) => whole([from, -from]),
        ([None, Some(to)], [LineEnd::Both, _]) => whole([-to, to]),
        ([Some(from), None], _) => first(from),
        ([None, Some(to)], _) => second(to),
        ([None, None], _) => CutAreas::default(),
    }
}

/// Areas for all pairs of ends and all distances at which they matter.
pub(super) struct AreaTable {
    /// Areas by the first and the second end.
    areas: [[AreasOfPair; LineEnd::ALL.len()]; LineEnd::ALL.len()],
}

/// Areas for a pair of ends, by the distance from the first and the distance from the second.
type AreasOfPair = [[CutAreas; DISTANCES]; DISTANCES];

static TABLE: LazyLock<AreaTable> = LazyLock::new(|| {
    let of_pair = |ends: [LineEnd; 2]| -> AreasOfPair {
        std::array::from_fn(|start| std::array::from_fn(|stop| areas([start as u32, stop as u32], ends)))
    };
    AreaTable { areas: LineEnd::ALL.map(|first| LineEnd::ALL.map(|second| of_pair([first, second]))) }
});

impl AreaTable {
    /// Returns the shared table, computed on first use.
    pub(super) fn get() -> &'static Self {
        &TABLE
    }

    /// Calls `found` for the edges of a part of a line, except where it is known that nothing is cut off.
    #[inline(always)]
    pub(super) fn for_each(&self, part: LinePart, mut found: impl FnMut(usize, CutAreas)) {
        let LinePart { line, ends: kinds, corners, part } = part;
        if kinds.iter().all(|kind| matches!(kind, LineEnd::Open | LineEnd::Both)) {
            return;
        }
        let is_sharpened = corners.iter().any(|corner| corner.before | corner.after);
        let of_pair = |ends: [LineEnd; 2]| &self.areas[ends[0] as usize][ends[1] as usize];
        let near = of_pair(kinds);
        for at in part {
            let distances = [at - line.start, line.end - 1 - at];
            let areas = match distances.map(|distance| distance < DISTANCES) {
                [true, true] => near[distances[0]][distances[1]],
                [true, false] => of_pair([kinds[0], LineEnd::Open])[distances[0]][DISTANCES - 1],
                [false, true] => of_pair([LineEnd::Open, kinds[1]])[DISTANCES - 1][distances[1]],
                [false, false] => continue,
            };
            found(at, if is_sharpened { areas.sharpened(distances, corners) } else { areas });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Integrates the height of the smoothed edge over a pixel with many steps, in f64.
    fn integrated(x: u32, length: u32, height: impl Fn(f64) -> f64) -> [f64; 2] {
        const STEPS: u32 = 2000;
        let mut areas = [0.0; 2];
        for step in 0..STEPS {
            let at = f64::from(x) + (f64::from(step) + 0.5) / f64::from(STEPS);
            let height = height(at / f64::from(length)) / f64::from(STEPS);
            areas[usize::from(height > 0.0)] += height.abs();
        }
        areas
    }

    /// Height of a line over a position from 0 to 1 along it.
    type Height = fn(f64) -> f64;

    #[test]
    fn areas_are_integrals_of_the_smoothed_edge() {
        use LineEnd::{After, Before, Both, Open};
        let cases: [([LineEnd; 2], Height); 7] = [
            ([After, Before], |at| 0.5 - at),
            ([Before, After], |at| at - 0.5),
            ([After, Both], |at| 0.5 - at),
            ([Both, After], |at| at - 0.5),
            ([After, Open], |at| (0.5 - at).max(0.0)),
            ([Open, Before], |at| -(at - 0.5).max(0.0)),
            ([Both, Open], |_| 0.0),
        ];
        for (ends, height) in cases {
            for length in [1, 2, 5, 8, 31] {
                for x in 0..length {
                    let CutAreas { before, after } = areas([x, length - 1 - x], ends);
                    let exact = integrated(x, length, height);
                    for (area, exact) in [before, after].into_iter().zip(exact) {
                        assert!(
                            (f64::from(area) - exact).abs() < 1e-4,
                            "{ends:?} {x} of {length}: {area}, not {exact}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn long_lines_with_both_ends_on_one_side_have_plain_areas() {
        let ends = [LineEnd::After; 2];
        let CutAreas { before, after } = areas([0, 39], ends);
        assert_eq!(before, 0.0);
        assert!((after - (0.5 - 0.5 / 40.0)).abs() < 1e-6, "{after}: triangle from ½ to 0 over 20 px");
        assert!(areas([1, 2], ends).after > 0.125 / 2.0, "short ones are enlarged");
    }
}
