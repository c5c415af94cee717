//! Horizontal and vertical lines of edges, followed to their ends.

use std::ops::Range;

use super::area::{AreaTable, Corner, CutAreas, DISTANCES, LineEnd};
use super::edges::{BitRows, MARGIN};

/// Lines of edges between two rows, or two columns, of pixels.
pub(super) struct Lines<'a> {
    /// Areas at the edges of a line.
    pub(super) table: &'a AreaTable,
    /// Edges along the lines.
    pub(super) along: &'a BitRows,
    /// Edges that cross the lines.
    pub(super) crossing: &'a BitRows,
}

/// Part of a line of edges within one word of bits.
struct LinePart {
    /// Bits of the whole line. An end that is not in the same or an adjacent word as the part is replaced by one that is
    /// more than [`SEARCH_PX`](super::SEARCH_PX) away from the part.
    line: Range<usize>,
    /// Ends of the line.
    ends: [LineEnd; 2],
    /// Sides on which these ends are corners.
    corners: [Corner; 2],
    /// Bits of the part.
    part: Range<usize>,
}

impl LinePart {
    /// Calls `found` for the edges of the part, except where it is known that nothing is cut off.
    #[inline(always)]
    fn for_each(self, table: &AreaTable, mut found: impl FnMut(usize, CutAreas)) {
        let Self { line, ends, corners, part } = self;
        if !(ends[0].is_one_sided() || ends[1].is_one_sided()) {
            return;
        }
        let is_sharpened = corners.iter().any(|corner| corner.before | corner.after);
        let near = table.of_pair(ends);
        for at in part {
            let distances = [at - line.start, line.end - 1 - at];
            let areas = match distances.map(|distance| distance < DISTANCES) {
                [true, true] => near[distances[0]][distances[1]],
                [true, false] => table.of_pair([ends[0], LineEnd::Open])[distances[0]][DISTANCES - 1],
                [false, true] => table.of_pair([LineEnd::Open, ends[1]])[DISTANCES - 1][distances[1]],
                [false, false] => continue,
            };
            found(at, if is_sharpened { areas.sharpened(distances, corners) } else { areas });
        }
    }
}

impl Lines<'_> {
    /// Calls `found` for the edges in `range` of the lines before row (or column) `at`, except where it is known that
    /// nothing is cut off.
    #[inline(always)]
    pub(super) fn for_each(&self, at: usize, range: Range<usize>, mut found: impl FnMut(usize, CutAreas)) {
        let along = self.along.row(at as isize);
        let bits = range.start + MARGIN..range.end + MARGIN;
        let mut words = bits.start / 64..bits.end.div_ceil(64);
        let Some(first) = words.find(|word| along[*word] != 0) else { return };
        let row = Row::new(self, at as isize);
        for (word, edges) in (first..words.end).zip(&along[first..]) {
            if *edges != 0 {
                row.for_each_part(word, &bits, |part| {
                    part.for_each(self.table, |bit, areas| found(bit - MARGIN, areas));
                });
            }
        }
    }
}

/// Lines of edges before one row (or column), and the edges around them, as bits.
struct Row<'a> {
    along: &'a [u64],
    /// Edges that cross a line from the pixels before it.
    before: &'a [u64],
    /// Edges that cross a line from the pixels after it.
    after: &'a [u64],
    /// Edges in line with those of `before`, one pixel farther from the line.
    beyond_before: &'a [u64],
    /// Edges in line with those of `after`, one pixel farther from the line.
    beyond_after: &'a [u64],
}

impl<'a> Row<'a> {
    #[inline(always)]
    fn new(lines: &Lines<'a>, at: isize) -> Self {
        Self {
            along: lines.along.row(at),
            before: lines.crossing.row(at - 1),
            after: lines.crossing.row(at),
            beyond_before: lines.crossing.row(at - 2),
            beyond_after: lines.crossing.row(at + 1),
        }
    }

    /// Returns the bits of a word at whose left side a line ends or starts.
    #[inline(always)]
    fn stops(&self, word: usize) -> u64 {
        let along = self.along[word];
        let carried = word.checked_sub(1).map_or(0, |word| self.along[word] >> 63);
        self.before[word] | self.after[word] | !(along & (along << 1 | carried))
    }

    /// Returns the edges around the left side of bit `at`. A line that leaves the margin has none there; that is too far
    /// away to matter.
    #[inline(always)]
    fn around(&self, at: usize) -> Around {
        let is_set = |row: &[u64]| row.get(at / 64).is_some_and(|word| word >> (at % 64) & 1 != 0);
        Around([self.before, self.after, self.beyond_before, self.beyond_after].map(is_set))
    }

    /// Calls `found` for the parts of lines in a word, as far as they are within `bits`.
    #[inline(always)]
    fn for_each_part(&self, word: usize, bits: &Range<usize>, mut found: impl FnMut(LinePart)) {
        let (first, stops) = (word * 64, self.stops(word));
        let words = [self.before, self.after, self.beyond_before, self.beyond_after].map(|row| row[word]);
        let around = |at: usize| {
            if at / 64 == word { Around(words.map(|word| word >> (at % 64) & 1 != 0)) } else { self.around(at) }
        };
        let mut rest = self.along[word] & within(first, bits);
        while rest != 0 {
            let bit = rest.trailing_zeros();
            let back = stops & (u64::MAX >> (63 - bit));
            let start = if back != 0 {
                first + 63 - back.leading_zeros() as usize
            } else {
                first.saturating_sub(self.stops(word - 1).leading_zeros() as usize + 1)
            };
            let ahead = stops & (!1 << bit);
            let stop = if ahead != 0 {
                first + ahead.trailing_zeros() as usize
            } else {
                first + 64 + self.stops(word + 1).trailing_zeros() as usize
            };
            let part = first + bit as usize..stop.min(first + 64).min(bits.end);
            let ends = [around(start), around(stop)];
            found(LinePart { line: start..stop, ends: ends.map(Around::end), corners: ends.map(Around::corner), part });
            rest &= u64::MAX.checked_shl(ahead.trailing_zeros()).unwrap_or(0);
        }
    }
}

/// Whether each row of edges around a line, in the order of [`Row`], has an edge at the left side of a bit: `before`,
/// `after`, `beyond_before`, `beyond_after`.
#[derive(Clone, Copy)]
struct Around([bool; 4]);

impl Around {
    #[inline(always)]
    fn end(self) -> LineEnd {
        LineEnd::new(self.0[0], self.0[1])
    }

    #[inline(always)]
    fn corner(self) -> Corner {
        Corner { before: self.0[2], after: self.0[3] }
    }
}

/// Returns the bits of a word that are in `range`. The word starts at bit `first`.
#[inline(always)]
fn within(first: usize, range: &Range<usize>) -> u64 {
    let from = |bit: usize| u64::MAX.checked_shl(bit.saturating_sub(first) as u32).unwrap_or(0);
    from(range.start) & !from(range.end)
}

#[cfg(test)]
mod tests {
    use super::super::SEARCH_PX;
    use super::super::area::areas;
    use super::super::edges::Edges;
    use super::*;
    use crate::image::Image;
    use crate::math::lanes::Lanes;

    /// Returns the areas at the top edge of a pixel, by following its line edge by edge.
    fn followed(edges: &Edges, [x, y]: [isize; 2]) -> CutAreas {
        let (top, left) = (
            |x: isize| edges.top.has(x + MARGIN as isize, y),
            |x: isize, y: isize| edges.left.has(x + MARGIN as isize, y),
        );
        let is_crossed = |x: isize| left(x, y - 1) || left(x, y);
        let search = 0..=SEARCH_PX as isize;
        let back = search.clone().find(|step| is_crossed(x - step) || !top(x - step - 1)).unwrap_or(search.end() + 1);
        let ahead =
            search.clone().find(|step| is_crossed(x + step + 1) || !top(x + step + 1)).unwrap_or(search.end() + 1);
        let places = [(back, x - back), (ahead, x + ahead + 1)];
        let ends = places.map(|(distance, at)| {
            let is_near = distance <= SEARCH_PX as isize;
            LineEnd::new(is_near && left(at, y - 1), is_near && left(at, y))
        });
        let corners = places.map(|(_, at)| Corner { before: left(at, y - 2), after: left(at, y + 1) });
        let distances = [back, ahead].map(|distance| distance as usize);
        areas(distances.map(|distance| distance.min(SEARCH_PX as usize) as u32), ends).sharpened(distances, corners)
    }

    #[test]
    fn parts_of_words_have_the_areas_of_whole_lines() {
        let mut random = fastrand::Rng::with_seed(6);
        // Lines of all lengths up to 47 px, with crossing edges.
        let picture = Image::from_fn(200, 90, |x, y| {
            let is_light = (y / 3 + x / (1 + y / 2)) % 2 == 0;
            [if is_light != (random.u8(..) < 4) { 255 } else { 0 }; 4]
        });
        let mut edges = Edges::default();
        edges.find(Lanes::best(), &picture);
        let lines = Lines { table: AreaTable::get(), along: &edges.top, crossing: &edges.left };
        let mut cut = 0;
        for (y, range) in (0..90).flat_map(|y| [0..200, 70..130].map(|range| (y, range))) {
            let mut found = [CutAreas::default(); 200];
            lines.for_each(y, range.clone(), |x, areas| found[x] = areas);
            for x in range {
                let at = [x as isize, y as isize];
                let is_edge = edges.top.has(at[0] + MARGIN as isize, at[1]);
                let expected = if is_edge { followed(&edges, at) } else { CutAreas::default() };
                assert_eq!(found[x], expected, "{at:?}");
                cut += u32::from(expected != CutAreas::default());
            }
        }
        assert!(cut > 1000, "{cut}");
    }
}
