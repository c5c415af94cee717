//! Rasterization: finds the samples that lie inside a triangle.
//!
//! A rasterizer knows nothing of depth or colour. It takes a [`RasterTriangle`] and emits the covered samples as
//! [`Span`]s. Each declares its names beside its algorithm. Five algorithms run in four kinds of arithmetic ([`numbers`]). In fixed point and in
//! exact arithmetic all five find exactly the same samples; in floats they differ by rounding.

pub(crate) mod numbers;

mod active_edge;

mod any;

mod arithmetic;

mod bounding_box;

mod edge_walk;

mod exact;

pub(super) mod fill_rule;

mod fixed;

mod float;

pub(crate) mod inward;

mod published;

mod scanline;

pub(crate) mod steps;

mod tiled;

mod triangle;

pub(crate) use any::AnyTriangle;
pub use arithmetic::Arithmetic;
pub(crate) use exact::Exact;
pub use fill_rule::FillRule;
pub(crate) use fixed::Fixed;
pub(crate) use float::Floating;
pub(crate) use triangle::RasterTriangle;

use numbers::Numbers;

use super::choice::{Choice as _, Label, registry};
use super::grid::SampleGrid;
use super::pixel_box::{PixelBox, box_around};
use super::viewport::Viewport;
use crate::math::fixed::{snap, to_pixels};

/// Declares the rasterizers: whether the algorithm is correct or published, its facts, and its function. Correct ones
/// take the triangle in any arithmetic, published ones the corners in pixels.
macro_rules! rasterizers {
    ($($variant:ident = $kind:ident $facts:expr, $cover:path;)+) => {
        registry! {
            /// Algorithm that finds the samples inside a triangle. All except the published ones find the same samples,
            /// up to the rounding errors of floats, but with different amounts of work.
            pub Rasterizer: RasterizerFacts {
                $($variant = $facts;)+
            }
        }

        impl Rasterizer {
            /// Returns whether the rasterizer deliberately reproduces the faults of a commonly published version.
            pub(crate) fn is_published(self) -> bool {
                match self { $(Self::$variant => is_published!($kind)),+ }
            }

            /// Emits the covered samples of a triangle.
            fn cover<N: Numbers>(
                self,
                triangle: &RasterTriangle<N>,
                corners_px: [[f32; 2]; 3],
                canvas: &mut RasterTarget<'_>,
            ) {
                match self { $(Self::$variant => cover!($kind, $cover, triangle, corners_px, canvas)),+ }
            }
        }
    };
}

macro_rules! is_published {
    (correct) => {
        false
    };
    (published) => {
        true
    };
}

macro_rules! cover {
    (correct, $cover:path, $triangle:ident, $corners_px:ident, $canvas:ident) => {
        $cover($triangle, $canvas)
    };
    (published, $cover:path, $triangle:ident, $corners_px:ident, $canvas:ident) => {
        $cover($corners_px, $canvas)
    };
}

rasterizers! {
    BoundingBox = correct bounding_box::FACTS, bounding_box::cover;
    Scanline = correct scanline::FACTS, scanline::cover;
    EdgeWalk = correct edge_walk::FACTS, edge_walk::cover;
    ActiveEdge = correct active_edge::FACTS, active_edge::cover;
    Tiled = correct tiled::FACTS, tiled::cover;
    BoundingBoxPublished = published published::BOUNDING_BOX, published::bounding_box;
    ScanlinePublished = published published::SCANLINE, published::scanline;
}

/// Facts that a rasterizer declares about itself.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RasterizerFacts {
    label: Label,
}

impl Rasterizer {
    /// Returns the rasterizers that have no deliberate faults.
    pub fn correct() -> impl Iterator<Item = Self> {
        Self::ALL.iter().copied().filter(|rasterizer| !rasterizer.is_published())
    }
}

/// Sample of a triangle: its position and its three edge values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RasterSample {
    /// Column of the sample in the packed picture, which holds only the drawn samples.
    pub column: u32,
    /// Row of the sample in the packed picture, which holds only the drawn samples.
    pub row: u32,
    /// Column of the sample's pixel in the full picture.
    pub x: u32,
    /// Row of the sample's pixel in the full picture.
    pub y: u32,
    /// Values of the three edge functions, in the order of the vertices opposite the edges. Up to rounding they sum to
    /// the doubled area. In fixed point they are integers in units of 1/2¹⁶ px². In the other kinds of arithmetic they
    /// are in px², times a power of two that brings the doubled area near 1.
    pub edges: [f64; 3],
}

/// Run of adjacent covered samples in a row of the packed picture, which holds only the drawn samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Span {
    /// Row of the run in the packed picture of drawn samples.
    pub(crate) row: u32,
    /// First column of the run in the packed picture of drawn samples.
    pub(crate) left: u32,
    /// One past the last column of the run in the packed picture of drawn samples.
    pub(crate) right: u32,
}

/// Scissor rectangle, in pixels of the full picture. Pixels outside are not visited.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Scissor {
    /// First pixel column inside the rectangle.
    pub(crate) left: u32,
    /// First pixel row inside the rectangle.
    pub(crate) top: u32,
    /// One past the last pixel column inside the rectangle.
    pub(crate) right: u32,
    /// One past the last pixel row inside the rectangle.
    pub(crate) bottom: u32,
}

impl Scissor {
    /// Returns the scissor that contains a whole picture of `width` × `height` px.
    pub(crate) fn full(width: u32, height: u32) -> Self {
        Self { left: 0, top: 0, right: width, bottom: height }
    }

    /// Returns the scissor that contains only pixel (x, y).
    pub(crate) fn pixel(x: u32, y: u32) -> Self {
        Self { left: x, top: y, right: x + 1, bottom: y + 1 }
    }

    /// Returns whether a triangle may cover samples inside the scissor in any of the rasterizers, judged by its
    /// bounding box. Triangles that fail this test need not be set up: nearly all triangles if a single pixel is drawn.
    pub(crate) fn may_overlap(&self, corners_px: [[f32; 2]; 3]) -> bool {
        self.may_overlap_box(box_around(corners_px))
    }

    /// Returns whether a triangle with this bounding box, in pixels, may cover samples inside the scissor.
    pub(crate) fn may_overlap_box(&self, [left, right, top, bottom]: PixelBox) -> bool {
        /// Margin around the scissor, in pixels: snapping moves vertices by a fraction of a pixel, and the rasterizers
        /// "as published" shift triangles by up to a whole pixel.
        const MARGIN_PX: f32 = 2.0;
        let meets = |[least, greatest]: [f32; 2], first: u32, end: u32| {
            greatest >= first as f32 - MARGIN_PX && least <= end as f32 + MARGIN_PX
        };
        meets([left, right], self.left, self.right) && meets([top, bottom], self.top, self.bottom)
    }
}

/// Inclusive range of pixel columns or rows; empty if `last` is less than `first`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PixelRange {
    first: i64,
    last: i64,
}

impl PixelRange {
    fn contains(self, pixel: i64) -> bool {
        (self.first..=self.last).contains(&pixel)
    }

    fn is_empty(self) -> bool {
        self.last < self.first
    }

    fn within(self, other: Self) -> Self {
        Self { first: self.first.max(other.first), last: self.last.min(other.last) }
    }
}

/// Target of a rasterizer: the sample grid and the scissor that limit the visited samples, and the list that receives
/// the covered spans.
#[derive(Debug)]
pub(crate) struct RasterTarget<'a> {
    grid: SampleGrid,
    scissor: Scissor,
    spans: &'a mut Vec<Span>,
    visited: u64,
}

impl RasterTarget<'_> {
    /// Returns the rows of the packed picture whose samples lie in a range of pixel rows, clamped to the scissor.
    fn rows(&self, rows: PixelRange) -> std::ops::Range<u32> {
        let (top, bottom) = (self.scissor.top, self.scissor.bottom);
        let clamp = |row: i64| row.clamp(top.into(), bottom.into()) as u32;
        self.grid.rows(clamp(rows.first), clamp(rows.last.saturating_add(1)))
    }

    /// Returns the pixel row of the full picture that corresponds to a row of the packed picture.
    fn pixel_row(&self, row: u32) -> i64 {
        self.grid.pixel(0, row).1.into()
    }

    /// Returns the columns of row `row` of the packed picture whose samples lie in the pixel columns `left..right`,
    /// clamped to the scissor.
    fn columns(&self, row: u32, left: i64, right: i64) -> std::ops::Range<u32> {
        let clamp = |column: i64| column.clamp(self.scissor.left.into(), self.scissor.right.into()) as u32;
        let (left, right) = (clamp(left), clamp(right));
        self.grid.columns(row, left, right.max(left))
    }

    /// Returns the pixel columns and the pixel rows inside the scissor.
    fn scissor(&self) -> [PixelRange; 2] {
        let Scissor { left, top, right, bottom } = self.scissor;
        [(left, right), (top, bottom)].map(|(first, end)| PixelRange { first: first.into(), last: i64::from(end) - 1 })
    }

    /// Adds `samples` to the number of visited samples.
    fn visit(&mut self, samples: usize) {
        self.visited += samples as u64;
    }

    /// Appends a span of covered samples to the output; does nothing if `columns` is empty.
    fn emit(&mut self, row: u32, columns: std::ops::Range<u32>) {
        if !columns.is_empty() {
            self.spans.push(Span { row, left: columns.start, right: columns.end });
        }
    }
}

/// Samples that a rasterizer may visit: those of a grid inside a scissor.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SampleArea {
    pub(crate) grid: SampleGrid,
    pub(crate) scissor: Scissor,
}

impl SampleArea {
    /// Returns the area of a whole picture.
    pub(crate) fn full(grid: SampleGrid, viewport: Viewport) -> Self {
        Self { grid, scissor: Scissor::full(viewport.width, viewport.height) }
    }

    /// Returns the area that contains only pixel (x, y) of the full picture.
    pub(crate) fn pixel((x, y): (u32, u32)) -> Self {
        Self { grid: SampleGrid::FULL, scissor: Scissor::pixel(x, y) }
    }
}

/// Rasterizes a triangle: appends the covered samples of an area to `spans`, each once. The order of the spans depends on
/// the algorithm. Returns the number of visited samples.
pub(super) fn cover_samples<N: Numbers>(
    rasterizer: Rasterizer,
    triangle: &RasterTriangle<N>,
    corners_px: [[f32; 2]; 3],
    SampleArea { grid, scissor }: SampleArea,
    spans: &mut Vec<Span>,
) -> u64 {
    let mut canvas = RasterTarget { grid, scissor, spans, visited: 0 };
    rasterizer.cover(triangle, corners_px, &mut canvas);
    canvas.visited
}

/// Evaluates `$body`, in which the type `$numbers` is the arithmetic that the setting `$chosen` selects.
macro_rules! with_arithmetic {
    ($chosen:expr, $numbers:ident => $body:expr) => {
        match $chosen {
            $crate::pipeline::settings::Arithmetic::Fixed => {
                type $numbers = $crate::pipeline::raster::Fixed;
                $body
            }
            $crate::pipeline::settings::Arithmetic::F32 => {
                type $numbers = $crate::pipeline::raster::Floating<f32>;
                $body
            }
            $crate::pipeline::settings::Arithmetic::F64 => {
                type $numbers = $crate::pipeline::raster::Floating<f64>;
                $body
            }
            $crate::pipeline::settings::Arithmetic::Exact => {
                type $numbers = $crate::pipeline::raster::Exact;
                $body
            }
        }
    };
}

pub(crate) use with_arithmetic;

/// Returns the doubled signed area of a triangle, computed in `arithmetic`, and the factor by which its edge values are
/// scaled. The area is positive if the triangle is clockwise for the viewer (y down), and 0 if a vertex is not finite.
pub(crate) fn doubled_area(arithmetic: Arithmetic, corners_px: [[f32; 2]; 3]) -> (f64, f64) {
    with_arithmetic!(arithmetic, N => triangle::doubled_area::<N>(corners_px)).unwrap_or((0.0, 1.0))
}

/// Returns the spans of pixels that one triangle covers in a picture, for case files and reports. Vertices are in
/// pixels and may be any finite f32; a triangle with a vertex that is not finite covers nothing. Front- and back-facing
/// triangles are both drawn.
pub(crate) fn cover(
    rasterizer: Rasterizer,
    arithmetic: Arithmetic,
    corners_px: [[f32; 2]; 3],
    rule: FillRule,
    viewport: Viewport,
) -> Vec<Span> {
    let mut spans = Vec::new();
    let rules = CoverageRules { rasterizer, arithmetic, fill_rule: rule };
    rules.cover_within(corners_px, SampleArea::full(SampleGrid::FULL, viewport), &mut spans);
    spans
}

/// Height in rows of the bands that [`CoverageRules::cover_in_bands`] processes: a multiple of the side of the tiled
/// rasterizer's largest squares.
const BAND_ROWS: u32 = 64;

/// Rules that decide which samples a triangle covers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CoverageRules {
    pub(crate) rasterizer: Rasterizer,
    pub(crate) arithmetic: Arithmetic,
    pub(crate) fill_rule: FillRule,
}

impl CoverageRules {
    /// Rasterizes a triangle like [`cover()`], but in bands of rows from top to bottom; the spans and their order are
    /// the same. `take` receives the spans of each band and the first row below the band. Bands far from the triangle
    /// are skipped. Stops at the first error that `take` returns.
    pub(crate) fn cover_in_bands<E>(
        self,
        corners_px: [[f32; 2]; 3],
        viewport: Viewport,
        mut take: impl FnMut(&[Span], u32) -> Result<(), E>,
    ) -> Result<(), E> {
        let Viewport { width, height } = viewport;
        let [.., top, bottom] = box_around(corners_px);
        // The rows extend one band beyond the triangle on each side, because of the margin of `may_overlap`. Casts to
        // integers saturate.
        let row = |px: f32| (px.max(0.0) as u32).min(height);
        let (first, end) = (row(top - BAND_ROWS as f32) / BAND_ROWS * BAND_ROWS, row(bottom + BAND_ROWS as f32));
        let mut spans = Vec::new();
        for top in (first..end).step_by(BAND_ROWS as usize) {
            let scissor = Scissor { left: 0, top, right: width, bottom: (top + BAND_ROWS).min(height) };
            if scissor.may_overlap(corners_px) {
                spans.clear();
                self.cover_within(corners_px, SampleArea { grid: SampleGrid::FULL, scissor }, &mut spans);
                take(&spans, scissor.bottom)?;
            }
        }
        Ok(())
    }

    /// Rasterizes a triangle like [`cover()`], restricted to the samples of an area. Appends the covered spans to
    /// `spans`.
    pub(crate) fn cover_within(self, corners_px: [[f32; 2]; 3], area: SampleArea, spans: &mut Vec<Span>) {
        let (corners_px, arithmetic) = within_fixed_point(corners_px, self.arithmetic);
        with_arithmetic!(arithmetic, N => {
            if let Some(triangle) = RasterTriangle::<N>::new(corners_px, self.fill_rule) {
                cover_samples(self.rasterizer, &triangle, corners_px, area, spans);
            }
        });
    }
}

/// Replaces fixed point where its integers could overflow: if a coordinate exceeds [`fixed::LIMIT_PX`], returns the
/// snapped vertices and exact arithmetic, which give the same coverage. Otherwise, returns the arguments unchanged.
fn within_fixed_point(corners_px: [[f32; 2]; 3], arithmetic: Arithmetic) -> ([[f32; 2]; 3], Arithmetic) {
    let reach = corners_px.as_flattened().iter().all(|c| c.abs() <= fixed::LIMIT_PX);
    if arithmetic != Arithmetic::Fixed || reach {
        return (corners_px, arithmetic);
    }
    // Floats this large are already multiples of the grid step.
    let snapped = |px: f32| if px.abs() <= fixed::LIMIT_PX { to_pixels(snap(px)) } else { px };
    (corners_px.map(|corner| corner.map(snapped)), Arithmetic::Exact)
}

#[cfg(test)]
mod tests;
