//! Polygons with shared boundaries, computed from the surfaces that samples show. The method is dual contouring with
//! one material per region (Ju, Losasso, Schaefer, Warren, "Dual Contouring of Hermite Data", 2002).
//!
//! Between two neighbouring samples of different regions lies a *crossing*, a point of the boundary. Its position and
//! the line that the boundary follows there are computed from the triangles. Four samples form a *cell*. A cell with
//! crossings has one *vertex*, at the point of the cell nearest to the lines of all its crossings. With one line, the
//! vertex lies on it; with several, it lies at the corner where they meet. Vertices of neighbouring cells are connected
//! across the crossing between them. By construction, regions meet without gaps or overlaps, and boundaries are as
//! straight as the triangles' edges at any zoom.

use std::ops::Range;

use glam::{DMat2, DVec2};
use rayon::prelude::*;

use super::crossing::{BoundaryPoint, Surfaces};
use super::parallel_step::ParallelStep;
use super::visible::{RegionId, StackId};
use crate::drawing::PartitionRegion;
use crate::inspect::control::TaskControl;

/// Maximum distance by which simplification may move a boundary, in px.
const STRAIGHT_PX: f64 = 0.01;

/// Maximum of sin²(α) / 4 at which two lines that meet at the angle α count as one line.
const PARALLEL: f64 = 1e-5;

/// Progress of the drawing before and after the vertices are computed, in percent.
const VERTICES_PERCENT: Range<usize> = 50..80;

/// Progress of the drawing before and after the boundaries are traced, in percent.
const BOUNDARIES_PERCENT: Range<usize> = 80..100;

/// A vertex on the boundary of regions, in the cell between four samples.
#[derive(Clone, Copy, Debug, PartialEq)]
struct BoundaryVertex {
    /// Column of the cell, which is also the column of the samples on its right side.
    column: u32,
    /// Position of the vertex on the screen, in samples.
    place: DVec2,
    /// Whether more than two boundaries meet at the vertex.
    is_junction: bool,
}

/// All vertices on boundaries, in reading order of their cells.
struct BoundaryVertices {
    all: Vec<BoundaryVertex>,
    /// Range of vertex indices of each row of cells.
    rows: Vec<Range<usize>>,
}

impl BoundaryVertices {
    /// Finds the vertices of all cells; `None` if cancelled.
    fn find(surfaces: &Surfaces<'_>, control: TaskControl<'_>) -> Option<Self> {
        let height = surfaces.visibility.height;
        let step = ParallelStep::new(control, VERTICES_PERCENT, height as usize + 1);
        let rows: Vec<Vec<BoundaryVertex>> = (0..=height)
            .into_par_iter()
            .map(|row| step.advance().map(|()| vertices_of(surfaces, row)))
            .collect::<Option<_>>()?;
        let mut ends = 0;
        let ranges = rows.iter().map(|row| {
            let start = ends;
            ends += row.len();
            start..ends
        });
        let ranges = ranges.collect();
        Some(Self { all: rows.concat(), rows: ranges })
    }

    /// Returns the index of the vertex in a cell. The cell must have a vertex.
    fn in_cell(&self, column: u32, row: u32) -> usize {
        let range = self.rows[row as usize].clone();
        range.start + self.all[range].partition_point(|vertex| vertex.column < column)
    }
}

/// Divides a picture into regions and returns their boundaries in pixels; returns `None` if cancelled. `samples_per_px`
/// is the number of samples along each side of a pixel.
pub(super) fn partition(
    surfaces: &Surfaces<'_>,
    samples_per_px: u32,
    control: TaskControl<'_>,
) -> Option<Vec<PartitionRegion>> {
    let per_px = f64::from(samples_per_px);
    let vertices = BoundaryVertices::find(surfaces, control)?;
    let mut outlines = Outlines {
        surfaces,
        kept: Simplification {
            vertices: &vertices.all,
            tolerance: STRAIGHT_PX * per_px,
            decided: vec![None; vertices.all.len()],
        },
        vertices: &vertices,
    };
    let colors = surfaces.visibility.colors();
    let mut regions: Vec<_> = colors.iter().map(|fill| PartitionRegion { contours: Vec::new(), fill: *fill }).collect();
    for (region, boundary) in outlines.all(control)? {
        let contour: Vec<_> = boundary.into_iter().map(|vertex| vertices.all[vertex].place / per_px).collect();
        regions[region as usize].contours.push(contour);
    }
    regions.retain(|region| !region.contours.is_empty());
    Some(regions)
}

/// Returns the stacks of visible surfaces in a row of samples; `None` outside the picture.
fn row_of<'a>(surfaces: &Surfaces<'a>, row: Option<u32>) -> Option<&'a [StackId]> {
    row.filter(|row| *row < surfaces.visibility.height).map(|row| surfaces.visibility.row(row))
}

/// Returns the vertices of the cells between a row of samples and the row above it.
fn vertices_of(surfaces: &Surfaces<'_>, row: u32) -> Vec<BoundaryVertex> {
    let (above, below) = (row_of(surfaces, row.checked_sub(1)), row_of(surfaces, Some(row)));
    let width = surfaces.visibility.width;
    let at = |samples: Option<&[StackId]>, column: u32| samples?.get(column as usize).copied();
    let mut vertices = Vec::new();
    let mut left = [None, None];
    for column in 0..=width {
        let right = [at(above, column), at(below, column)];
        if left != right || left[0] != left[1] {
            let stacks = [left[0], right[0], right[1], left[1]];
            vertices.extend(vertex_of(surfaces, [column, row], stacks));
        }
        left = right;
    }
    vertices
}

/// Returns the vertex of a cell; `None` if all samples of the cell belong to one region. `stacks` holds the stack of
/// visible surfaces at each sample, clockwise from the upper left.
fn vertex_of(
    surfaces: &Surfaces<'_>,
    cell @ [column, row]: [u32; 2],
    stacks: [Option<StackId>; 4],
) -> Option<BoundaryVertex> {
    /// Positions of the samples of a cell, relative to its centre.
    const SAMPLES: [DVec2; 4] =
        [DVec2::new(-0.5, -0.5), DVec2::new(0.5, -0.5), DVec2::new(0.5, 0.5), DVec2::new(-0.5, 0.5)];
    let middle = DVec2::new(column.into(), row.into());
    let region = |stack: StackId| surfaces.visibility.region(stack);
    let (mut crossings, mut boundaries) = (Vec::with_capacity(2 * SAMPLES.len()), 0);
    for (first, second) in [(0, 1), (1, 2), (2, 3), (3, 0)] {
        let path = [middle + SAMPLES[first], middle + SAMPLES[second]];
        match (stacks[first], stacks[second]) {
            (Some(one), Some(other)) if region(one) != region(other) => {
                surfaces.find_crossings(path, [one, other], &mut crossings);
                boundaries += 1;
            }
            (Some(_), None) | (None, Some(_)) => {
                // The border of the picture lies halfway between a sample inside and one outside.
                crossings
                    .push(BoundaryPoint { place: (path[0] + path[1]) / 2.0, normal: Some((path[1] - path[0]).abs()) });
                boundaries += 1;
            }
            _ => {}
        }
    }
    let size = DVec2::new(surfaces.visibility.width.into(), surfaces.visibility.height.into());
    let bounds = [(middle - 0.5).max(DVec2::ZERO), (middle + 0.5).min(size)];
    let [column, _] = cell;
    let is_junction = boundaries > 2;
    (boundaries > 0).then(|| BoundaryVertex { column, place: nearest(&crossings, bounds), is_junction })
}

/// Returns the point within bounds that minimises the sum of squared distances to the lines of all crossings. If there
/// are several, returns the one nearest to the mean position of the crossings.
fn nearest(crossings: &[BoundaryPoint], [low, high]: [DVec2; 2]) -> DVec2 {
    let mean = crossings.iter().map(|crossing| crossing.place).sum::<DVec2>() / crossings.len() as f64;
    // Σ n nᵀ and Σ n (n · c), with positions relative to the mean.
    let (mut matrix, mut vector) = (DMat2::ZERO, DVec2::ZERO);
    for BoundaryPoint { place, normal } in crossings {
        let Some(normal) = normal else { continue };
        matrix += DMat2::from_cols(*normal * normal.x, *normal * normal.y);
        vector += *normal * normal.dot(*place - mean);
    }
    let (trace, determinant) = (matrix.x_axis.x + matrix.y_axis.y, matrix.determinant());
    if trace <= 0.0 {
        return mean.clamp(low, high);
    }
    if determinant <= PARALLEL * trace * trace {
        // All lines are nearly parallel. Their common normal is the longer column of the matrix.
        let along_x = matrix.x_axis.length_squared() >= matrix.y_axis.length_squared();
        let normal = if along_x { matrix.x_axis } else { matrix.y_axis }.normalize();
        return (mean + normal * normal.dot(vector) / trace).clamp(low, high);
    }
    let corner = mean + matrix.inverse() * vector;
    if corner.cmpge(low).all() && corner.cmple(high).all() {
        return corner;
    }
    // The minimum lies outside the bounds. Searches each side for the point at which the derivative along the side is
    // zero, clamped to the side.
    let error = |place: DVec2| {
        let offset = place - mean;
        offset.dot(matrix * offset) - 2.0 * vector.dot(offset)
    };
    let on_sides = [low.x, high.x].into_iter().map(|x| {
        let y = mean.y + (vector.y - matrix.x_axis.y * (x - mean.x)) / matrix.y_axis.y;
        DVec2::new(x, if y.is_finite() { y.clamp(low.y, high.y) } else { mean.y.clamp(low.y, high.y) })
    });
    let on_ends = [low.y, high.y].into_iter().map(|y| {
        let x = mean.x + (vector.x - matrix.x_axis.y * (y - mean.y)) / matrix.x_axis.x;
        DVec2::new(if x.is_finite() { x.clamp(low.x, high.x) } else { mean.x.clamp(low.x, high.x) }, y)
    });
    on_sides.chain(on_ends).min_by(|a, b| error(*a).total_cmp(&error(*b))).unwrap_or(mean)
}

/// State for tracing the boundaries of regions along the sides of samples.
struct Outlines<'a> {
    surfaces: &'a Surfaces<'a>,
    vertices: &'a BoundaryVertices,
    kept: Simplification<'a>,
}

/// A side of the unit square around a sample, traversed with the sample on the right.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct SampleSide {
    sample: [u32; 2],
    /// Unit step along the side, in samples to the right and down.
    step: [i32; 2],
}

impl SampleSide {
    /// Returns the unit step from the sample to its neighbour across the side.
    fn outward(self) -> [i32; 2] {
        [self.step[1], -self.step[0]]
    }

    /// Returns the column and row of the cell at the end of the side.
    fn end_cell(self) -> [u32; 2] {
        let [right, down] = self.step;
        let [x, y] = self.sample;
        [x + u32::from(right == 1 || down == 1), y + u32::from(down == 1 || right == -1)]
    }
}

impl Outlines<'_> {
    /// Returns all closed boundaries as vertex indices, each with the region inside. Boundaries that simplification
    /// reduces to fewer than three vertices are omitted. Returns `None` if cancelled.
    fn all(&mut self, control: TaskControl<'_>) -> Option<Vec<(RegionId, Vec<usize>)>> {
        let visibility = self.surfaces.visibility;
        let (width, height) = (visibility.width, visibility.height);
        let mut boundaries = Vec::new();
        // Every boundary contains the top side of some sample.
        let mut walked = vec![false; width as usize * height as usize];
        let step = ParallelStep::new(control, BOUNDARIES_PERCENT, height as usize);
        for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
            if x == 0 {
                step.advance()?;
            }
            let top = SampleSide { sample: [x, y], step: [1, 0] };
            let region = visibility.region(visibility.stack(x, y));
            if walked[y as usize * width as usize + x as usize] || self.beyond([x, y], top.outward()) == Some(region) {
                continue;
            }
            let mut boundary = Vec::new();
            let mut side = top;
            loop {
                if side.step == top.step {
                    let [x, y] = side.sample;
                    walked[y as usize * width as usize + x as usize] = true;
                }
                let [column, row] = side.end_cell();
                boundary.push(self.vertices.in_cell(column, row));
                side = self.next(side, region);
                if side == top {
                    break;
                }
            }
            let kept = self.kept.of(boundary);
            if kept.len() > 2 {
                boundaries.push((region, kept));
            }
        }
        Some(boundaries)
    }

    /// Returns the region of the sample one step away from a sample; `None` outside the picture.
    fn beyond(&self, [x, y]: [u32; 2], [right, down]: [i32; 2]) -> Option<RegionId> {
        let visibility = self.surfaces.visibility;
        let (x, y) = (x.checked_add_signed(right)?, y.checked_add_signed(down)?);
        (x < visibility.width && y < visibility.height).then(|| visibility.region(visibility.stack(x, y)))
    }

    /// Returns the next side on the boundary of a region. Samples that touch only at a corner are not connected.
    fn next(&self, side: SampleSide, region: RegionId) -> SampleSide {
        let SampleSide { sample, step } = side;
        let outward = side.outward();
        let moved = |by: [i32; 2]| [0, 1].map(|axis| sample[axis].saturating_add_signed(by[axis]));
        let diagonal = [step[0] + outward[0], step[1] + outward[1]];
        if self.beyond(sample, step) != Some(region) {
            SampleSide { sample, step: outward.map(|across| -across) }
        } else if self.beyond(sample, diagonal) != Some(region) {
            SampleSide { sample: moved(step), step }
        } else {
            SampleSide { sample: moved(diagonal), step: outward }
        }
    }
}

/// Simplification of nearly straight boundaries (Douglas and Peucker, 1973). The decision to keep or remove a vertex is
/// made once and applies to the regions on both sides.
struct Simplification<'a> {
    vertices: &'a [BoundaryVertex],
    /// Maximum distance of a removed vertex from the simplified boundary, in samples.
    tolerance: f64,
    decided: Vec<Option<bool>>,
}

impl Simplification<'_> {
    /// Simplifies a closed boundary and returns the remaining vertices.
    fn of(&mut self, mut boundary: Vec<usize>) -> Vec<usize> {
        let place = |vertex: &usize| self.vertices[*vertex].place;
        let first_in_place = |a: &usize, b: &usize| {
            place(a).x.total_cmp(&place(b).x).then(place(a).y.total_cmp(&place(b).y)).then(a.cmp(b))
        };
        // Without a junction, starts at a corner of the convex hull, which is the same for the regions on both sides.
        let start = boundary
            .iter()
            .position(|vertex| self.vertices[*vertex].is_junction)
            .or_else(|| (0..boundary.len()).min_by(|a, b| first_in_place(&boundary[*a], &boundary[*b])));
        boundary.rotate_left(start.unwrap_or(0));
        let count = boundary.len();
        boundary.extend(boundary.first().copied());
        let mut chain_start = 0;
        for end in 1..=count {
            if end == count || self.vertices[boundary[end]].is_junction {
                self.decide(&boundary[chain_start..=end]);
                chain_start = end;
            }
        }
        boundary.pop();
        boundary.retain(|vertex| self.decided[*vertex] == Some(true));
        boundary
    }

    /// Decides which inner vertices of a chain are kept; the first and last vertices are always kept.
    fn decide(&mut self, chain: &[usize]) {
        let [first, inner @ .., last] = chain else { return };
        self.decided[*first] = Some(true);
        self.decided[*last] = Some(true);
        if inner.first().is_none_or(|vertex| self.decided[*vertex].is_some()) {
            return;
        }
        inner.iter().for_each(|vertex| self.decided[*vertex] = Some(false));
        let mut open = vec![(0, chain.len() - 1)];
        while let Some((start, end)) = open.pop() {
            let [from, to] = [start, end].map(|at| self.vertices[chain[at]].place);
            let distance = |at: usize| distance_squared(self.vertices[chain[at]].place, from, to);
            let farthest = (start + 1..end).max_by(|a, b| distance(*a).total_cmp(&distance(*b)));
            if let Some(at) = farthest.filter(|at| distance(*at) > self.tolerance * self.tolerance) {
                self.decided[chain[at]] = Some(true);
                open.extend([(start, at), (at, end)]);
            }
        }
    }
}

/// Returns the squared distance from `point` to the segment between two points, which may coincide.
fn distance_squared(point: DVec2, from: DVec2, to: DVec2) -> f64 {
    let along = to - from;
    let share = ((point - from).dot(along) / along.length_squared()).clamp(0.0, 1.0);
    let nearest = if share.is_nan() { from } else { from + along * share };
    point.distance_squared(nearest)
}
