//! SMAA 1x post filter: smooths the edges of a finished picture by their shape.
//!
//! After J. Jimenez, J. I. Echevarria, T. Sousa and D. Gutierrez, "SMAA: Enhanced Subpixel Morphological Antialiasing"
//! (Eurographics 2012), with the preset “high”:
//!
//! 1. An edge lies between two pixels whose luma differs by at least 0.1 and at least half as much as that of any
//!    neighbouring pair ([`edges`]).
//! 2. Each line of edges is followed to its ends, where other edges cross it. The smoothed edge runs from the middle of
//!    these crossing edges. The areas that it cuts off are exact ([`area`]). Near a crossing edge longer than one pixel,
//!    which is a corner, they are reduced.
//! 3. Stairs of single pixels are smoothed along their diagonal instead ([`diagonals`]).
//! 4. Each pixel is blended with its neighbours across the edge, weighted by these areas.
//!
//! Edges are bits, so that lines are followed a word at a time.

mod area;
mod blend;
mod cuts;
mod diagonals;
mod edges;
mod lines;
#[cfg(test)]
mod tests;

use std::cell::{Cell, RefCell};
use std::ops::Range;

use area::AreaTable;
use blend::{Blender, Covered};
use cuts::Cuts;
use diagonals::{DiagonalEdge, Diagonals};
use edges::{Edges, MARGIN};
use lines::Lines;
use rayon::prelude::*;

use crate::image::{Image, Rgba8};
use crate::math::lanes::Lanes;

/// Maximum distance, in pixels, over which a line is followed in each direction from a pixel.
const SEARCH_PX: u32 = 32;

/// Maximum distance, in pixels, at which the filter reads neighbours of a pixel: the search, the crossing edge behind its
/// end, the pixels that decide about that edge, and the neighbour across the edge.
pub(crate) const REACH_PX: u32 = SEARCH_PX + 4;

/// Number of rows that are filtered together. The areas at their edges fit in the second-level cache.
const BAND: usize = 32;

/// Areas at the edges of a band of rows.
#[derive(Default)]
struct BandCuts {
    /// Areas at the top edges, with those of the row after the band.
    top: Cuts,
    /// Areas at the left edges.
    left: Cuts,
}

thread_local! {
    /// Buffer for the edges of a picture. Reusing it for the next one avoids page faults.
    static EDGES: Cell<Edges> = Cell::default();

    /// Buffer for the areas of a band, reused likewise.
    static CUTS: RefCell<BandCuts> = RefCell::default();
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
    // Taken instead of borrowed: while this thread waits for others, it may filter another picture.
    let mut edges = EDGES.take();
    edges.find(lanes, picture);
    let bands = result.pixels_mut().par_chunks_mut(width as usize * BAND);
    bands.enumerate().for_each(|(index, pixels)| {
        CUTS.with_borrow_mut(|cuts| {
            let blender = Blender::new(lanes, picture, linear);
            Band { picture, edges: &edges, first: index * BAND, cuts }.filter(blender, pixels);
        });
    });
    EDGES.set(edges);
    result
}

/// A band of rows to filter.
struct Band<'a> {
    picture: &'a Image<Rgba8>,
    edges: &'a Edges,
    /// Index of its first row.
    first: usize,
    cuts: &'a mut BandCuts,
}

impl Band<'_> {
    /// Filters the band into `pixels`.
    fn filter(&mut self, blender: Blender<'_>, pixels: &mut [Rgba8]) {
        let width = self.picture.width() as usize;
        let rows = self.first..self.first + pixels.len() / width;
        pixels.copy_from_slice(&self.picture.pixels()[rows.start * width..rows.end * width]);
        self.cuts.top.clear(width, rows.len() + 1);
        self.cuts.left.clear(width, rows.len());
        self.cut_along_lines(rows.clone());
        self.cut_along_diagonals(rows);
        self.blend(blender, pixels);
    }

    /// Finds the areas of the horizontal and vertical lines of edges.
    fn cut_along_lines(&mut self, rows: Range<usize>) {
        let (width, table) = (self.picture.width() as usize, AreaTable::get());
        let BandCuts { top, left } = &mut *self.cuts;
        let Edges { top: top_edges, left: left_edges, top_columns, left_columns } = self.edges;
        let lines = Lines { table, along: top_edges, crossing: left_edges };
        // The line below the last row belongs to the row after it.
        for y in rows.start..=rows.end {
            lines.for_each(y, 0..width, |x, areas| top.set(x, y - rows.start, areas));
        }
        let lines = Lines { table, along: left_columns, crossing: top_columns };
        let columns = left_edges.columns_in(rows.clone()).map(|bit| bit - MARGIN).filter(|x| *x < width);
        for x in columns {
            lines.for_each(x, rows.clone(), |y, areas| left.set(x, y - rows.start, areas));
        }
    }

    /// Replaces the areas at the edges of diagonals. Also removes those at the left edges between the top edges. The
    /// publication keeps these areas on falling diagonals; without them, mirrored pictures have mirrored results.
    fn cut_along_diagonals(&mut self, rows: Range<usize>) {
        let width = self.picture.width() as usize;
        let BandCuts { top, left } = &mut *self.cuts;
        let diagonals = Diagonals::new(self.edges);
        for y in rows.start..=rows.end {
            let row = y - rows.start;
            diagonals.for_each(y, width, |DiagonalEdge { x, areas, has_left, has_right }| {
                top.remove(x, row);
                top.set(x, row, areas);
                if has_left && y < rows.end {
                    left.remove(x, row);
                }
                if has_right && y < rows.end {
                    left.remove(x + 1, row);
                }
            });
        }
    }

    /// Blends the pixels at whose edges areas are cut off with their neighbours.
    fn blend(&self, mut blender: Blender<'_>, pixels: &mut [Rgba8]) {
        let width = self.picture.width() as usize;
        let first = self.first * width;
        for row in 0..pixels.len() / width {
            let (top, bottom) = (self.cuts.top.row(row), self.cuts.top.row(row + 1));
            let left = self.cuts.left.row(row);
            for word in MARGIN / 64..(MARGIN + width).div_ceil(64) {
                let right = left.before[word] >> 1 | left.before[word + 1] << 63;
                let mut rest = top.after[word] | bottom.before[word] | left.after[word] | right;
                while rest != 0 {
                    let bit = word * 64 + rest.trailing_zeros() as usize;
                    rest &= rest - 1;
                    let covered = Covered {
                        left: left.after(bit),
                        right: left.before(bit + 1),
                        above: top.after(bit),
                        below: bottom.before(bit),
                    };
                    blender.add(first + row * width + bit - MARGIN, covered, first, pixels);
                }
            }
        }
        blender.finish(first, pixels);
    }
}
