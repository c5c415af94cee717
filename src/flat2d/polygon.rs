//! Filling polygons row by row: any number of contours, holes, self-intersections.
//!
//! The *edge table* lists all edges by the first row that they cross. Going down, the *active edge list* keeps those that
//! cross the current row: an edge is active while y₀ ≤ yc < y₁, where yc is the height of the row's samples. That
//! half-open rule counts the corner between two edges once, a tip twice or not at all, and horizontal edges never, so
//! none of them is a special case. Walking the row from the left, each crossing at or before a sample changes the
//! winding number by one, and the *inside rule* makes a pixel of it: even-odd asks whether the number is odd, which is
//! the same as an odd count of crossings, and non-zero whether it differs from 0.
//!
//! The textbook sorts the crossings of a row and fills between pairs. As only the column counts that a crossing falls
//! into, the windings are summed up per column here, which sorts them at no cost. An edge that crosses all its rows in one
//! and the same column, as do upright ones and nearly all that reach far outside, is put there once and taken out at its
//! end. All in all the edges are sorted twice, and each row costs its crossings by other edges, and the columns between
//! the outermost ones.

mod edge;

#[cfg(test)]
mod tests;

use std::mem;
use std::ops::Range;

use glam::DVec2;

use super::Span;
use crate::math::fixed::snap_to_grid;
use edge::{Edge, Row, Slant};

/// What counts as inside, by the winding number around a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InsideRule {
    /// Odd numbers: where contours overlap, inside and outside alternate.
    EvenOdd,
    /// All but zero: where contours overlap, the overlap is inside unless they turn opposite ways.
    NonZero,
}

/// Where the corners are when edges are built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Corners {
    /// Where they were given.
    AsGiven,
    /// On the nearest point of the pipeline's 1/256 px grid.
    Snapped,
}

/// The point of a pixel that must be inside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SamplePoint {
    /// Its centre, half a pixel right and down of its whole coordinates.
    Center,
    /// Its whole coordinates, as in the lattice of textbooks.
    Lattice,
}

impl SamplePoint {
    /// Distance from a pixel's whole coordinates, in x as in y.
    fn offset(self) -> f64 {
        match self {
            Self::Center => 0.5,
            Self::Lattice => 0.0,
        }
    }
}

/// How a polygon is filled, and into what.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Filling {
    /// What counts as inside.
    pub rule: InsideRule,
    /// Where the corners are.
    pub corners: Corners,
    /// What is inside of a pixel.
    pub sample: SamplePoint,
    /// Width of the picture, px.
    pub width: u32,
    /// Height of the picture, px.
    pub height: u32,
}

/// An edge that crosses the current row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActiveEdge {
    /// Upper end, px.
    pub top: DVec2,
    /// Lower end, px.
    pub bottom: DVec2,
    /// Where it crosses, px, to within the rounding of floats.
    pub crossing_px: f64,
    /// The first column whose sample lies at or right of the crossing, exactly; the picture's width if none does.
    pub column: u32,
    /// What crossing it from the left adds to the winding number: 1 if it was given from top to bottom, otherwise −1.
    pub winding: i32,
}

/// An active edge that crosses its rows in several columns: a copy of what each row needs of it.
#[derive(Clone, Debug)]
struct Slanted {
    slant: Slant,
    /// One past its last row.
    end: u32,
    winding: i32,
    /// Its place in the edge table.
    place: u32,
}

/// The walk down a polygon; see [`fill`].
#[derive(Clone, Debug)]
pub struct PolygonFill {
    filling: Filling,
    /// The edge table, in the order of first rows, and how many of it have been active.
    edges: Vec<Edge>,
    started: usize,
    /// Places in the edge table: in the order of last rows, and how many of those edges have ended.
    by_end: Vec<u32>,
    ended: usize,
    slanted: Vec<Slanted>,
    /// For each column, and at last for all beyond the picture, the sum of windings: of the active edges that have no
    /// other column, and of the crossings of the row by the slanted ones; those are zero again behind the walk.
    standing: Vec<i32>,
    crossing: Vec<i32>,
    /// From the first to the last column that has had a crossing so far.
    touched: Range<u32>,
    row: u32,
    /// The column that is looked at next, and the winding number up to there.
    column: u32,
    winding: i32,
}

/// The spans of the polygon within these closed contours, row by row from the top, left to right; two spans of a row
/// never touch.
pub fn fill(contours: &[Vec<DVec2>], filling: Filling) -> PolygonFill {
    let corner = |point: DVec2| match filling.corners {
        Corners::AsGiven => point,
        Corners::Snapped => DVec2::new(snap_to_grid(point.x), snap_to_grid(point.y)),
    };
    let sides = contours.iter().flat_map(|contour| contour.iter().zip(contour.iter().cycle().skip(1)));
    let mut edges: Vec<_> =
        sides.filter_map(|(from, to)| Edge::new(corner(*from), corner(*to), filling.sample, filling.height)).collect();
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
        standing: vec![0; filling.width as usize + 1],
        crossing: vec![0; filling.width as usize + 1],
        touched: filling.width..0,
        row: 0,
        column: filling.width,
        winding: 0,
    }
}

impl PolygonFill {
    /// The edge table: all edges by the first row that they cross, as (row, upper end, lower end).
    pub fn edge_table(&self) -> impl Iterator<Item = (u32, DVec2, DVec2)> {
        self.edges.iter().map(|edge| (edge.rows.start, edge.top, edge.bottom))
    }

    /// The row of the last span.
    pub fn row(&self) -> u32 {
        self.row
    }

    /// The active edge list: all edges that cross the row, in the order of the table.
    pub fn active_edges(&self) -> impl Iterator<Item = ActiveEdge> {
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

    /// Returns the next span of the row, or `None` and goes on to the next row; the outer `None` is the end.
    pub fn step(&mut self) -> Option<Option<Span>> {
        let span = self.next_span();
        if span.is_none() {
            self.next_row()?;
        }
        Some(span)
    }

    /// The rest of the row's spans, one by one.
    fn next_span(&mut self) -> Option<Span> {
        let x0 = self.next_column_where(true)?;
        let x1 = self.next_column_where(false).unwrap_or(self.filling.width);
        Some(Span { y: self.row, x0, x1 })
    }

    /// Walks on to the first column that is inside, or outside; `None` if there is none up to the last crossing.
    fn next_column_where(&mut self, inside: bool) -> Option<u32> {
        while self.column < self.touched.end.min(self.filling.width) {
            let column = self.column;
            self.column += 1;
            self.winding += self.standing[column as usize] + mem::take(&mut self.crossing[column as usize]);
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

    /// Goes down to the next row that has crossings; `None` below the last.
    fn next_row(&mut self) -> Option<()> {
        let active = self.started - self.ended;
        self.row = if active > 0 { self.row + 1 } else { self.edges.get(self.started)?.rows.start };
        self.end_edges();
        self.start_edges();
        self.cross_slanted();
        (self.column, self.winding) = (self.touched.start, 0);
        Some(())
    }

    fn row_of_samples(&self, row: u32) -> Row {
        Row::new(row, self.filling.sample, self.filling.width)
    }

    /// The column of an edge that has only one; from its first row to its last an edge moves one way only.
    fn only_column(&self, edge: &Edge) -> Option<u32> {
        let first = edge.column_at(self.row_of_samples(edge.rows.start));
        let last = edge.column_at(self.row_of_samples(edge.rows.end - 1));
        (first == last).then_some(first)
    }

    /// Takes out the edges that do not reach the row.
    fn end_edges(&mut self) {
        while let Some(edge) = self.by_end.get(self.ended).map(|place| &self.edges[*place as usize])
            && edge.rows.end <= self.row
        {
            if let Some(column) = self.only_column(edge) {
                self.standing[column as usize] -= edge.winding;
            }
            self.ended += 1;
        }
        self.slanted.retain(|slanted| self.row < slanted.end);
    }

    /// Puts in the edges that start at the row.
    fn start_edges(&mut self) {
        while let Some(edge) = self.edges.get(self.started)
            && edge.rows.start <= self.row
        {
            let Edge { rows: Range { end, .. }, winding, .. } = *edge;
            if let Some(column) = self.only_column(edge) {
                self.standing[column as usize] += winding;
                self.touched = with(&self.touched, column);
            } else {
                let (slant, place) = (Slant::new(edge), self.started as u32);
                self.slanted.push(Slanted { slant, end, winding, place });
            }
            self.started += 1;
        }
    }

    /// Finds the columns where slanted edges cross the row.
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
        // Beyond the picture the walk does not come by.
        self.crossing[self.filling.width as usize] = 0;
    }
}

/// A range widened to hold one more column.
fn with(range: &Range<u32>, column: u32) -> Range<u32> {
    range.start.min(column)..range.end.max(column + 1)
}

impl Iterator for PolygonFill {
    type Item = Span;

    fn next(&mut self) -> Option<Span> {
        loop {
            if let Some(span) = self.step()? {
                return Some(span);
            }
        }
    }
}
