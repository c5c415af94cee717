//! Scanline filling of polygons with any number of contours, holes and self-intersections.
//!
//! The *edge table* lists all edges by the first row that they cross. The *active edge list* holds the edges that cross
//! the current row: an edge is active while y₀ ≤ yc < y₁, where yc is the height of the row's samples. This half-open
//! interval avoids special cases. A corner may lie exactly at the height of the samples. If the contour continues up or
//! down there, it crosses the row once; if the corner is a local top or bottom, it crosses the row twice or not at all.
//! Horizontal edges never cross a row. From left to right, the winding number starts at 0 and changes by one at each
//! crossing. The *inside rule* decides from its value at a sample whether the pixel is inside. The even-odd rule tests
//! whether the number is odd, which is equivalent to an odd count of crossings; the non-zero rule tests whether it
//! differs from 0.
//!
//! The textbook sorts the crossings of a row and fills between pairs. Only the column of a crossing matters, so this
//! implementation sums the windings per column, which sorts the crossings at no cost. Vertical edges, and nearly all
//! edges that reach far outside the picture, cross all their rows in a single column. Such an edge is added to its
//! column once and removed at its end. The edges are sorted only twice: by first row and by last row. The cost of a row
//! grows with the number of crossings by the other edges and with the number of columns between the outermost
//! crossings.

mod edge;

#[cfg(test)]
mod tests;

use std::mem;
use std::ops::Range;

use glam::DVec2;

use super::PixelSpan;
use crate::math::fixed::snap_to_grid;
use edge::{PolygonEdge, SampleRow, Slant};

/// Rule that decides from a sample's winding number whether the sample is inside the polygon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InsideRule {
    /// Samples with an odd winding number are inside: where contours overlap, inside and outside alternate.
    EvenOdd,
    /// Samples with a non-zero winding number are inside: an overlap is inside unless the contours have opposite
    /// orientations.
    NonZero,
}

/// Treatment of the corners before edges are built: used as given or snapped to a grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Corners {
    /// Corners are used as given.
    AsGiven,
    /// Corners are snapped to the nearest point of the pipeline's 1/256 px grid.
    Snapped,
}

/// Position within each pixel that is tested against the polygon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SamplePoint {
    /// Pixel centre, half a pixel right of and below the integer coordinates.
    Center,
    /// Integer coordinates, as in the pixel lattice of textbooks.
    Lattice,
}

impl SamplePoint {
    /// Returns the offset of the sample from the pixel's integer coordinates on both axes, px.
    fn offset(self) -> f64 {
        match self {
            Self::Center => 0.5,
            Self::Lattice => 0.0,
        }
    }
}

/// Parameters of a polygon fill.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FillParameters {
    /// Rule that decides from a sample's winding number whether the sample is inside the polygon.
    pub rule: InsideRule,
    /// Whether corners are used as given or snapped to the 1/256 px grid.
    pub corners: Corners,
    /// Sample position within each pixel.
    pub sample: SamplePoint,
    /// Width of the picture, px.
    pub width: u32,
    /// Height of the picture, px.
    pub height: u32,
}

/// Edge that crosses the current row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ActiveEdge {
    /// Upper endpoint of the edge, in pixels.
    pub(crate) top: DVec2,
    /// Lower endpoint of the edge, in pixels.
    pub(crate) bottom: DVec2,
    /// x coordinate at which the edge crosses the row of samples, in pixels, up to float rounding.
    pub(crate) crossing_px: f64,
    /// First column whose sample lies at or right of the crossing, computed exactly; the picture's width if there is
    /// none.
    pub(crate) column: u32,
    /// Change of the winding number at the crossing, from left to right: 1 if the edge was given from top to bottom,
    /// otherwise −1.
    pub(crate) winding: i32,
}

/// Active edge that crosses its rows in more than one column, with a copy of the data that is needed in each row.
#[derive(Clone, Debug)]
struct Slanted {
    slant: Slant,
    /// One past the last row of the edge.
    end: u32,
    winding: i32,
    /// Index of the edge in the edge table.
    place: u32,
}

/// Iterator over the spans of a polygon; see [`fill`].
#[derive(Clone, Debug)]
pub struct PolygonFill {
    filling: FillParameters,
    /// Edge table: all edges, sorted by first row. The first `started` of them have been activated.
    edges: Vec<PolygonEdge>,
    started: usize,
    /// Indices of all edges in the edge table, sorted by the edges' last rows. The first `ended` of these edges have
    /// ended.
    by_end: Vec<u32>,
    ended: usize,
    slanted: Vec<Slanted>,
    /// Sum of the windings of the active edges in each column, for edges that cross all their rows in a single column.
    /// The last entry stands for everything right of the picture. `crossing` has the same layout, but sums the windings
    /// of slanted edges in the current row; scanning the row resets its entries to zero.
    column_winding: Vec<i32>,
    crossing: Vec<i32>,
    /// Range from the first to the last column that any crossing has touched so far.
    touched: Range<u32>,
    row: u32,
    /// Next column to test; `winding` is the winding number of the column before it.
    column: u32,
    winding: i32,
}

/// Returns the spans of the polygon that these closed contours bound, row by row from the top and from left to right.
///
/// Spans in the same row never touch each other.
///
/// # Examples
/// ```
/// use glam::DVec2;
/// use rasterscope_engine::flat2d::PixelSpan;
/// use rasterscope_engine::flat2d::polygon::{Corners, FillParameters, InsideRule, SamplePoint, fill};
///
/// let outline = [(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0)].map(DVec2::from).to_vec();
/// let hole = [(1.0, 1.0), (3.0, 1.0), (3.0, 3.0), (1.0, 3.0)].map(DVec2::from).to_vec();
/// let (rule, corners, sample) = (InsideRule::EvenOdd, Corners::AsGiven, SamplePoint::Center);
/// let filling = FillParameters { rule, corners, sample, width: 64, height: 36 };
///
/// let spans: Vec<_> = fill(&[outline, hole], filling).take(3).collect();
/// assert_eq!(spans[0], PixelSpan { y: 0, x0: 0, x1: 4 });
/// assert_eq!(spans[1..], [PixelSpan { y: 1, x0: 0, x1: 1 }, PixelSpan { y: 1, x0: 3, x1: 4 }]);
/// ```
pub fn fill(contours: &[Vec<DVec2>], filling: FillParameters) -> PolygonFill {
    let corner = |point: DVec2| match filling.corners {
        Corners::AsGiven => point,
        Corners::Snapped => DVec2::new(snap_to_grid(point.x), snap_to_grid(point.y)),
    };
    let sides = contours.iter().flat_map(|contour| contour.iter().zip(contour.iter().cycle().skip(1)));
    let mut edges: Vec<_> = sides
        .filter_map(|(from, to)| PolygonEdge::new(corner(*from), corner(*to), filling.sample, filling.height))
        .collect();
    edges.sort_unstable_by_key(|edge| edge.rows.start);
    let mut by_end: Vec<_> = (0..edges.len() as u32).collect();
    by_end.sort_unstable_by_key(|place| edges[*place as usize].rows.end);
    PolygonFill {
        filling,
        edges,
        started: 0,
        by_end,
        ended: 0,
        slanted: Vec::new(),
        column_winding: vec![0; filling.width as usize + 1],
        crossing: vec![0; filling.width as usize + 1],
        touched: filling.width..0,
        row: 0,
        column: filling.width,
        winding: 0,
    }
}

impl PolygonFill {
    /// Returns the edge table: all edges sorted by the first row that they cross, each as (row, upper endpoint, lower
    /// endpoint).
    pub(crate) fn edge_table(&self) -> impl Iterator<Item = (u32, DVec2, DVec2)> {
        self.edges.iter().map(|edge| (edge.rows.start, edge.top, edge.bottom))
    }

    /// Returns the row of the most recent span.
    pub(crate) fn row(&self) -> u32 {
        self.row
    }

    /// Returns the active edge list: all edges that cross the current row, in the order of the edge table.
    pub(crate) fn active_edges(&self) -> impl Iterator<Item = ActiveEdge> {
        let row = self.row;
        let active = self.edges[..self.started].iter().filter(move |edge| edge.rows.contains(&row));
        active.map(move |edge| ActiveEdge {
            top: edge.top,
            bottom: edge.bottom,
            crossing_px: Slant::new(edge).crossing_px(self.row_of_samples(row)),
            column: edge.column_at(self.row_of_samples(row)),
            winding: edge.winding,
        })
    }

    /// Returns the next span of the current row. At the end of a row, advances to the next row and returns
    /// `Some(None)`. Returns `None` after the last row.
    pub(crate) fn step(&mut self) -> Option<Option<PixelSpan>> {
        let span = self.next_span();
        if span.is_none() {
            self.next_row()?;
        }
        Some(span)
    }

    /// Returns the next span of the current row, or `None` at the end of the row.
    fn next_span(&mut self) -> Option<PixelSpan> {
        let x0 = self.next_column_where(true)?;
        let x1 = self.next_column_where(false).unwrap_or(self.filling.width);
        Some(PixelSpan { y: self.row, x0, x1 })
    }

    /// Returns the next column that is inside the polygon or, if `inside` is `false`, outside, and advances past it.
    /// Returns `None` if there is no such column up to the last crossing.
    fn next_column_where(&mut self, inside: bool) -> Option<u32> {
        while self.column < self.touched.end.min(self.filling.width) {
            let column = self.column;
            self.column += 1;
            self.winding += self.column_winding[column as usize] + mem::take(&mut self.crossing[column as usize]);
            if self.is_inside() == inside {
                return Some(column);
            }
        }
        None
    }

    fn is_inside(&self) -> bool {
        match self.filling.rule {
            InsideRule::EvenOdd => self.winding & 1 != 0,
            InsideRule::NonZero => self.winding != 0,
        }
    }

    /// Advances to the next row that can have active edges. Returns `None` if there is none.
    fn next_row(&mut self) -> Option<()> {
        let active = self.started - self.ended;
        self.row = if active > 0 { self.row + 1 } else { self.edges.get(self.started)?.rows.start };
        self.end_edges();
        self.start_edges();
        self.cross_slanted();
        (self.column, self.winding) = (self.touched.start, 0);
        Some(())
    }

    fn row_of_samples(&self, row: u32) -> SampleRow {
        SampleRow::new(row, self.filling.sample, self.filling.width)
    }

    /// Returns the column of an edge that crosses all its rows in one column; `None` otherwise. Comparing the first and
    /// last rows suffices, because x is monotonic along an edge.
    fn single_column(&self, edge: &PolygonEdge) -> Option<u32> {
        let first = edge.column_at(self.row_of_samples(edge.rows.start));
        let last = edge.column_at(self.row_of_samples(edge.rows.end - 1));
        (first == last).then_some(first)
    }

    /// Removes the edges that end above the current row.
    fn end_edges(&mut self) {
        while let Some(edge) = self.by_end.get(self.ended).map(|place| &self.edges[*place as usize])
            && edge.rows.end <= self.row
        {
            if let Some(column) = self.single_column(edge) {
                self.column_winding[column as usize] -= edge.winding;
            }
            self.ended += 1;
        }
        self.slanted.retain(|slanted| self.row < slanted.end);
    }

    /// Adds the edges that start at the current row.
    fn start_edges(&mut self) {
        while let Some(edge) = self.edges.get(self.started)
            && edge.rows.start <= self.row
        {
            let PolygonEdge { rows: Range { end, .. }, winding, .. } = *edge;
            if let Some(column) = self.single_column(edge) {
                self.column_winding[column as usize] += winding;
                self.touched = with(&self.touched, column);
            } else {
                let (slant, place) = (Slant::new(edge), self.started as u32);
                self.slanted.push(Slanted { slant, end, winding, place });
            }
            self.started += 1;
        }
    }

    /// Adds the crossings of slanted edges to the columns of the current row.
    fn cross_slanted(&mut self) {
        let row = self.row_of_samples(self.row);
        let mut touched = self.touched.clone();
        for slanted in &self.slanted {
            let exact = || self.edges[slanted.place as usize].search(&slanted.slant, row);
            let column = slanted.slant.column_at(row).unwrap_or_else(exact);
            self.crossing[column as usize] += slanted.winding;
            touched = with(&touched, column);
        }
        self.touched = touched;
        // The scan of a row never reaches the entry right of the picture, so that entry is reset here.
        self.crossing[self.filling.width as usize] = 0;
    }
}

/// Returns `range`, extended to include `column`.
fn with(range: &Range<u32>, column: u32) -> Range<u32> {
    range.start.min(column)..range.end.max(column + 1)
}

impl Iterator for PolygonFill {
    type Item = PixelSpan;

    fn next(&mut self) -> Option<PixelSpan> {
        loop {
            if let Some(span) = self.step()? {
                return Some(span);
            }
        }
    }
}
