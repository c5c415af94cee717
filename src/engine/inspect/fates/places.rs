//! Positions of triangles in the picture, whether visible or not.

use super::Fates;
use crate::image::Image;
use crate::inspect::selection::TriangleSelection;
use crate::pipeline::Geometry;
use crate::pipeline::grid::SampleGrid;
use crate::pipeline::raster::{SampleArea, Span};
use crate::pipeline::screen_triangle::ScreenTriangle;
use crate::pipeline::settings::Arithmetic;
use crate::pipeline::viewport::Viewport;
use crate::scene::TriangleId;
use crate::upscale::Sampling;

/// Screen-space shape of a triangle, or of one piece of a clipped triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct ScreenShape {
    id: TriangleId,
    /// Corners before snapping to the subpixel grid, in px.
    corners_px: [[f32; 2]; 3],
    /// Area in px², from the corners that determine coverage (snapped in fixed point).
    area_px: f64,
}

impl ScreenShape {
    fn new(triangle: &ScreenTriangle, arithmetic: Arithmetic) -> Self {
        let decisive = match arithmetic {
            Arithmetic::Fixed => triangle.snapped_px(),
            Arithmetic::F32 | Arithmetic::F64 | Arithmetic::Exact => triangle.corners_px(),
        };
        let [a, b, c] = decisive.map(|corner| corner.map(f64::from));
        let area_px = ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs() / 2.0;
        Self { id: triangle.id, corners_px: triangle.corners_px(), area_px }
    }

    fn centre_px(&self) -> [f64; 2] {
        let [a, b, c] = self.corners_px.map(|corner| corner.map(f64::from));
        [0, 1].map(|axis| (a[axis] + b[axis] + c[axis]) / 3.0)
    }
}

/// Returns the screen-space shapes of all triangles, in scene order.
pub(super) fn shapes(geometry: &Geometry, arithmetic: Arithmetic) -> Vec<ScreenShape> {
    let mut shapes: Vec<_> = geometry.triangles.iter().map(|triangle| ScreenShape::new(triangle, arithmetic)).collect();
    shapes.sort_by_key(|shape| shape.id);
    shapes
}

/// Visibility of selected triangles at a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SelectionVisibility {
    /// No selected triangle lies at the pixel.
    None,
    /// A selected triangle lies at the pixel, but is occluded or not drawn.
    Hidden,
    /// A selected triangle is the top triangle at the pixel.
    Shown,
}

impl Fates {
    /// Returns the screen area of a triangle in px², summed over its pieces if it is clipped. Returns `None` if no part
    /// of the triangle is on the screen.
    pub fn area_px(&self, triangle: TriangleId) -> Option<f64> {
        let shapes = self.shapes_of(triangle);
        (!shapes.is_empty()).then(|| shapes.iter().map(|shape| shape.area_px).sum())
    }

    /// Returns a pixel of the full picture that represents a triangle; `None` if the triangle is outside the picture.
    /// This is the most central pixel where the triangle is on top, or else the most central pixel that it covers. A
    /// triangle that covers no pixel is represented by the pixel that contains its centroid.
    pub fn representative_pixel(&self, triangle: TriangleId) -> Option<(u32, u32)> {
        let width = self.top_triangle.width();
        let on_top = self.top_triangle.pixels().iter().zip(0..).filter(|(shown, _)| **shown == triangle);
        let on_top: Vec<_> = on_top.map(|(_, place)| (place % width, place / width)).collect();
        let samples = if on_top.is_empty() { self.covered_by(self.shapes_of(triangle)) } else { on_top };
        let middle = middle(&samples).or_else(|| self.sample_at_middle(self.shapes_of(triangle).first()?));
        middle.map(|sample| self.sampling.pixel(sample, (self.viewport.width, self.viewport.height)))
    }

    /// Returns the visibility of a selection at every pixel of the full picture. A triangle that covers no sample marks
    /// the pixel that contains its centroid.
    pub fn visibility_of(&self, selection: &TriangleSelection) -> Image<SelectionVisibility> {
        let (width, height) = self.top_triangle.size();
        let mut marks = Image::filled(width, height, SelectionVisibility::None);
        let selected: Vec<_> = self.shapes.iter().filter(|shape| selection.contains(shape.id)).collect();
        for shape in selected {
            let mut samples = self.covered_by(std::slice::from_ref(shape));
            if samples.is_empty() {
                samples.extend(self.sample_at_middle(shape));
            }
            samples.iter().for_each(|(column, row)| marks.set(*column, *row, SelectionVisibility::Hidden));
        }
        for (mark, shown) in marks.pixels_mut().iter_mut().zip(self.top_triangle.pixels()) {
            if *shown != TriangleId::NONE && selection.contains(*shown) {
                *mark = SelectionVisibility::Shown;
            }
        }
        let sample = |x, y| nearest_sample(self.sampling, self.raster, (x, y));
        Image::from_fn(self.viewport.width, self.viewport.height, |x, y| {
            let (column, row) = sample(x, y);
            marks.at(column.min(width - 1), row.min(height - 1))
        })
    }

    fn shapes_of(&self, triangle: TriangleId) -> &[ScreenShape] {
        let first = self.shapes.partition_point(|shape| shape.id < triangle);
        let count = self.shapes[first..].partition_point(|shape| shape.id == triangle);
        &self.shapes[first..first + count]
    }

    /// Returns the samples that the shapes cover, regardless of occlusion, as columns and rows of the packed
    /// framebuffer.
    fn covered_by(&self, shapes: &[ScreenShape]) -> Vec<(u32, u32)> {
        let rules = self.recipe.pipeline.coverage_rules();
        let area = SampleArea::full(self.sampling.grid(), self.raster);
        let mut spans: Vec<Span> = Vec::new();
        shapes.iter().for_each(|shape| rules.cover_within(shape.corners_px, area, &mut spans));
        spans.iter().flat_map(|span| (span.left..span.right).map(|column| (column, span.row))).collect()
    }

    /// Returns the sample nearest to the centroid of a shape, as column and row of the packed framebuffer. Returns
    /// `None` if the centroid is outside the picture.
    fn sample_at_middle(&self, shape: &ScreenShape) -> Option<(u32, u32)> {
        let [x, y] = shape.centre_px();
        let Viewport { width, height } = self.raster;
        let inside = (0.0..f64::from(width)).contains(&x) && (0.0..f64::from(height)).contains(&y);
        inside.then(|| nearest_of_grid(self.sampling.grid(), self.raster, (x as u32, y as u32)))
    }
}

/// Returns the sample nearest to the mean position of `samples`; `None` if there are none.
fn middle(samples: &[(u32, u32)]) -> Option<(u32, u32)> {
    let count = samples.len() as u64;
    let sum = samples.iter().fold((0, 0), |(x, y), s| (x + u64::from(s.0), y + u64::from(s.1)));
    let mean = ((sum.0.checked_div(count)?) as u32, (sum.1.checked_div(count)?) as u32);
    let distance = |s: &(u32, u32)| u64::from(s.0.abs_diff(mean.0)).pow(2) + u64::from(s.1.abs_diff(mean.1)).pow(2);
    samples.iter().min_by_key(|sample| distance(sample)).copied()
}

/// Returns the sample nearest to a pixel of the full picture, as column and row of the packed framebuffer.
fn nearest_sample(sampling: Sampling, raster: Viewport, (x, y): (u32, u32)) -> (u32, u32) {
    match sampling {
        Sampling::Grid(grid) => nearest_of_grid(grid, raster, (x, y)),
        Sampling::Lattice(lattice) => (lattice.nearest(x, raster.width), lattice.nearest(y, raster.height)),
    }
}

fn nearest_of_grid(grid: SampleGrid, raster: Viewport, (x, y): (u32, u32)) -> (u32, u32) {
    match grid {
        SampleGrid::Block { step } => (x / step, y / step),
        SampleGrid::Checkerboard | SampleGrid::OddCheckerboard => {
            // Drawn and undrawn squares of 2×2 pixels alternate, so a drawn pixel is at most two columns away.
            let beside = [x.checked_sub(1), Some(x + 1), x.checked_sub(2), Some(x + 2)];
            let drawn = |x: u32| (x < raster.width).then(|| grid.sample_at(x, y)).flatten();
            drawn(x).or_else(|| beside.into_iter().flatten().find_map(drawn)).unwrap_or((0, y))
        }
    }
}
