//! SMAA 1x post filter: smooths the edges of a finished picture by their shape.
//!
//! After J. Jimenez, J. I. Echevarria, T. Sousa and D. Gutierrez, "SMAA: Enhanced Subpixel Morphological Antialiasing"
//! (Eurographics 2012), with the preset “high”:
//!
//! 1. An edge lies between two pixels whose luma differs by at least 0.1 and at least half as much as that of any
//!    neighbouring pair ([`edges`]).
//! 2. Each line of edges is followed to its ends, where other edges cross it. The smoothed edge runs from the middle of
//!    these crossing edges. The areas that it cuts off are computed exactly ([`area`]), not read from a texture. Near a
//!    crossing edge longer than one pixel, which is a corner, they are reduced.
//! 3. Stairs of single pixels are smoothed along their diagonal instead ([`diagonals`]).
//! 4. Each pixel is blended with its neighbours across the edge, weighted by these areas.
//!
//! Edges are bits, so that lines are followed a word at a time.

mod area;
mod diagonals;
mod edges;
#[cfg(test)]
mod tests;

use std::cell::RefCell;
use std::ops::Range;

use area::{Corner, CutAreas, LineEnd, areas};
use diagonals::{DiagonalEdge, Diagonals};
use edges::{BitRows, Edges, MARGIN};
use rayon::prelude::*;

use crate::image::color::Tables;
use crate::image::{Image, Rgba8};
use crate::math::lanes::Lanes;

/// Maximum distance, in pixels, over which a line is followed in each direction from a pixel.
const SEARCH_PX: u32 = 32;

/// Maximum distance, in pixels, at which the filter reads neighbours of a pixel: the search, the crossing edge behind its
/// end, the pixels that decide about that edge, and the neighbour across the edge.
pub(crate) const REACH_PX: u32 = SEARCH_PX + 4;

/// Number of bands of rows per thread.
const BANDS_PER_THREAD: usize = 4;

/// Areas that neighbours cover of a pixel.
#[derive(Clone, Copy, Debug, Default)]
struct Covered {
    left: f32,
    right: f32,
    above: f32,
    below: f32,
}

/// Areas of the pixels of a band, valid where `touched` has a bit.
#[derive(Default)]
struct BandAreas {
    covered: Vec<Covered>,
    touched: Vec<u64>,
}

thread_local! {
    /// Buffer for the areas of a band. Reusing it for the next picture avoids page faults.
    static AREAS: RefCell<BandAreas> = RefCell::default();
}

/// Filters a picture, blending in linear light if `linear` is `true`, else in sRGB codes. Reuses `memory` for the
/// result.
pub(crate) fn apply(picture: &Image<Rgba8>, linear: bool, memory: Option<Image<Rgba8>>) -> Image<Rgba8> {
    apply_on(Lanes::best(), picture, linear, memory)
}

fn apply_on(lanes: Lanes, picture: &Image<Rgba8>, linear: bool, memory: Option<Image<Rgba8>>) -> Image<Rgba8> {
    let (width, height) = picture.size();
    let mut result = Image::reusing(memory, width, height, [0; 4]);
    if width == 0 || height == 0 {
        return result;
    }
    let edges = Edges::find(lanes, picture);
    let rows = (height as usize).div_ceil(BANDS_PER_THREAD * rayon::current_num_threads());
    let bands = result.pixels_mut().par_chunks_mut(width as usize * rows);
    bands.enumerate().for_each(|(index, pixels)| {
        AREAS.with_borrow_mut(|areas| {
            let mut band = Band { picture, edges: &edges, first: index * rows, areas };
            band.filter(linear, pixels);
        });
    });
    result
}

/// Lines of edges between two rows, or two columns, of pixels.
struct Lines<'a> {
    /// Edges of the lines, as bits.
    line: &'a [u64],
    /// Edges that cross a line from the pixels before it.
    before: &'a [u64],
    /// Edges that cross a line from the pixels after it.
    after: &'a [u64],
    /// Edges in line with those of `before`, one pixel farther from the line.
    beyond_before: &'a [u64],
    /// Edges in line with those of `after`, one pixel farther from the line.
    beyond_after: &'a [u64],
}

/// Returns whether a bit of a row is set. A line that leaves the margin has no end there; it is too far away to matter.
fn is_set(row: &[u64], at: usize) -> bool {
    row.get(at / 64).is_some_and(|word| word >> (at % 64) & 1 != 0)
}

impl<'a> Lines<'a> {
    /// Returns the lines before row (or column) `at`.
    fn new(lines: &'a BitRows, crossing: &'a BitRows, at: usize) -> Self {
        let at = at as isize;
        Self {
            line: lines.row(at),
            before: crossing.row(at - 1),
            after: crossing.row(at),
            beyond_before: crossing.row(at - 2),
            beyond_after: crossing.row(at + 1),
        }
    }

    /// Returns the bits of a word at whose left side a line ends or starts.
    fn stops(&self, word: usize) -> u64 {
        let line = self.line[word];
        let before = word.checked_sub(1).map_or(0, |word| self.line[word] >> 63);
        self.before[word] | self.after[word] | !(line & (line << 1 | before))
    }

    /// Returns the first and the last bit of the line through bit `at`. Instead of a bit in another than the adjacent
    /// words, it returns one that is more than [`SEARCH_PX`] away from all bits of this word.
    fn range(&self, at: usize) -> [usize; 2] {
        let (word, bit) = (at / 64, at % 64);
        let own = self.stops(word);
        let back = own & (u64::MAX >> (63 - bit));
        let start = if back != 0 {
            word * 64 + 63 - back.leading_zeros() as usize
        } else {
            (word * 64).saturating_sub(self.stops(word - 1).leading_zeros() as usize + 1)
        };
        let ahead = own & (!1 << bit);
        let end = if ahead != 0 {
            word * 64 + ahead.trailing_zeros() as usize
        } else {
            (word + 1) * 64 + self.stops(word + 1).trailing_zeros() as usize
        };
        [start, end - 1]
    }

    /// Returns the kind of end that the line has at the left side of bit `at`.
    fn end(&self, at: usize) -> LineEnd {
        LineEnd::new(is_set(self.before, at), is_set(self.after, at))
    }

    /// Returns the sides on which the end at the left side of bit `at` is a corner.
    fn corner(&self, at: usize) -> Corner {
        Corner { before: is_set(self.beyond_before, at), after: is_set(self.beyond_after, at) }
    }

    /// Calls `found` for every pixel of `range` with an edge, and its areas.
    fn for_each(&self, range: Range<usize>, mut found: impl FnMut(usize, CutAreas)) {
        let mut at = range.start + MARGIN;
        let stop = range.end + MARGIN;
        while at < stop {
            let rest = self.line[at / 64] >> (at % 64);
            if rest == 0 {
                at = (at / 64 + 1) * 64;
                continue;
            }
            at += rest.trailing_zeros() as usize;
            if at >= stop {
                break;
            }
            let [start, last] = self.range(at);
            let ends = [self.end(start), self.end(last + 1)];
            let corners = [self.corner(start), self.corner(last + 1)];
            // The ends are known for the pixels of this word only; see `range`.
            let rest = at..stop.min(last + 1).min((at / 64 + 1) * 64);
            at = rest.end;
            for pixel in rest {
                let distances = [pixel - start, last - pixel].map(|distance| distance as u32);
                let is_near = distances.map(|distance| distance <= SEARCH_PX);
                let seen = [0, 1].map(|side| if is_near[side] { ends[side] } else { LineEnd::Open });
                let areas = areas(distances.map(|distance| distance.min(SEARCH_PX)), seen);
                if areas != CutAreas::default() {
                    found(pixel - MARGIN, areas.sharpened(distances, corners));
                }
            }
        }
    }
}

/// A band of rows to filter.
struct Band<'a> {
    picture: &'a Image<Rgba8>,
    edges: &'a Edges,
    /// Index of its first row.
    first: usize,
    areas: &'a mut BandAreas,
}

impl Band<'_> {
    /// Filters the band into `pixels`.
    fn filter(&mut self, linear: bool, pixels: &mut [Rgba8]) {
        let width = self.picture.width() as usize;
        let rows = self.first..self.first + pixels.len() / width;
        pixels.copy_from_slice(&self.picture.pixels()[rows.start * width..rows.end * width]);
        self.areas.clear(pixels.len());
        self.cover_along_lines(rows.clone());
        self.cover_along_diagonals(rows);
        self.blend(linear, pixels);
    }

    /// Adds the areas of the horizontal and vertical lines of edges.
    fn cover_along_lines(&mut self, rows: Range<usize>) {
        let width = self.picture.width() as usize;
        let BandAreas { covered, touched } = &mut *self.areas;
        let index = |x: usize, y: usize| (y - rows.start) * width + x;
        // The line below the last row belongs to the row after it.
        for y in rows.start..=rows.end {
            Lines::new(&self.edges.top, &self.edges.left, y).for_each(0..width, |x, areas| {
                if y < rows.end {
                    entry(covered, touched, index(x, y)).above = areas.after;
                }
                if y > rows.start {
                    entry(covered, touched, index(x, y - 1)).below = areas.before;
                }
            });
        }
        for x in 0..width {
            Lines::new(&self.edges.left_columns, &self.edges.top_columns, x).for_each(rows.clone(), |y, areas| {
                entry(covered, touched, index(x, y)).left = areas.after;
                if x > 0 {
                    entry(covered, touched, index(x - 1, y)).right = areas.before;
                }
            });
        }
    }

    /// Replaces the areas at the edges of diagonals. Also removes those at the left edges between the top edges. The
    /// publication keeps these areas on falling diagonals; without them, mirrored pictures have mirrored results.
    fn cover_along_diagonals(&mut self, rows: Range<usize>) {
        let width = self.picture.width() as usize;
        let BandAreas { covered, touched } = &mut *self.areas;
        let index = |x: usize, y: usize| (y - rows.start) * width + x;
        let diagonals = Diagonals::new(self.edges);
        for y in rows.start..=rows.end {
            diagonals.for_each(y, width, |DiagonalEdge { x, areas, has_left, has_right }| {
                if y < rows.end {
                    entry(covered, touched, index(x, y)).above = areas.after;
                    if has_left && x > 0 {
                        entry(covered, touched, index(x - 1, y)).right = 0.0;
                        entry(covered, touched, index(x, y)).left = 0.0;
                    }
                    if has_right && x + 1 < width {
                        entry(covered, touched, index(x, y)).right = 0.0;
                        entry(covered, touched, index(x + 1, y)).left = 0.0;
                    }
                }
                if y > rows.start {
                    entry(covered, touched, index(x, y - 1)).below = areas.before;
                }
            });
        }
    }

    /// Blends the touched pixels with their neighbours.
    fn blend(&self, linear: bool, pixels: &mut [Rgba8]) {
        let (tables, offset) = (Tables::get(), self.first * self.picture.width() as usize);
        for (word, bits) in self.areas.touched.iter().enumerate() {
            let mut left = *bits;
            while left != 0 {
                let at = word * 64 + left.trailing_zeros() as usize;
                left &= left - 1;
                pixels[at] = self.blended(tables, linear, offset + at, self.areas.covered[at]);
            }
        }
    }

    /// Returns pixel number `at` of the picture, blended along the axis on which it is covered most.
    fn blended(&self, tables: &Tables, linear: bool, at: usize, covered: Covered) -> Rgba8 {
        let Covered { left, right, above, below } = covered;
        let is_across = left.max(right) > above.max(below);
        let (step, shares) =
            if is_across { (1, [left, right]) } else { (self.picture.width() as usize, [above, below]) };
        let pixels = self.picture.pixels();
        let own = pixels[at];
        // Neighbours with a share exist: no edge separates the picture from its continuation.
        let neighbours =
            [at.wrapping_sub(step), at + step].map(|neighbour| pixels.get(neighbour).copied().unwrap_or(own));
        let sum = shares[0] + shares[1];
        let weights = shares.map(|share| if sum > 0.0 { share * share / sum } else { 0.0 });
        let values = if linear { &tables.linear_of_code } else { &tables.code };
        let mut result = own;
        for (channel, code) in result.iter_mut().enumerate().take(3) {
            let [own, before, after] = [own, neighbours[0], neighbours[1]].map(|pixel| values[pixel[channel] as usize]);
            let value = own + ((before - own) * weights[0] + (after - own) * weights[1]);
            *code = if linear { tables.encode(value) } else { (value + 0.5) as u8 };
        }
        result
    }
}

impl BandAreas {
    /// Forgets all areas and makes room for `pixels` of them.
    fn clear(&mut self, pixels: usize) {
        if self.covered.len() < pixels {
            self.covered.resize(pixels, Covered::default());
        }
        self.touched.clear();
        self.touched.resize(pixels.div_ceil(64), 0);
    }
}

/// Returns the areas of a pixel, which are zero at first.
fn entry<'a>(covered: &'a mut [Covered], touched: &mut [u64], at: usize) -> &'a mut Covered {
    let (word, bit) = (&mut touched[at / 64], 1 << (at % 64));
    if *word & bit == 0 {
        *word |= bit;
        covered[at] = Covered::default();
    }
    &mut covered[at]
}
