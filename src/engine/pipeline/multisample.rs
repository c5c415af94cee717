//! Drawing of several samples per pixel, for jittered supersampling and multisampling.
//!
//! A sample that does not lie at the centre of its pixel is drawn by moving the triangle by the opposite offset, after
//! projection. Edges, depth and attributes are then computed as for a pixel centre, in any arithmetic and by any
//! rasterizer. In fixed point, sample positions lie on the grid that corners are snapped to (as in D3D11), so a
//! triangle has the same shape at every sample position.
//!
//! Supersampling shades every sample. Multisampling shades a triangle once per pixel, at the pixel's centre if the
//! triangle covers it and at the first covered sample otherwise. All covered samples get that colour (Akeley,
//! "RealityEngine Graphics", 1993).

use std::ops::Range;

use super::blending::{self, FragmentList, Sorting};
use super::depth::{DepthComparison, DepthScale};
use super::framebuffer::Framebuffer;
use super::grid::SampleGrid;
use super::interpolate::{Fragment, interpolate};
use super::raster::numbers::Numbers;
use super::raster::{RasterSample, RasterTriangle, SampleArea, Span, cover_samples, doubled_area, with_arithmetic};
use super::samples::{RasterizedTriangle, SampleStages};
use super::screen_triangle::{ScreenTriangle, depth_at};
use super::screen_vertex::ScreenVertex;
use super::settings::Settings;
use super::shade::Shader;
use super::{DrawCall, LastStage};
use crate::math::fixed::snap;
use crate::scene::Transparency;

/// Candidate positions of the samples in a pixel, and the function that chooses one per sample.
#[derive(Clone, Copy)]
pub(crate) struct CandidatePositions<'a> {
    /// Candidate positions of each sample, as offsets (right, down) from the pixel's centre, in pixels.
    pub(crate) candidates: &'a [Vec<[f32; 2]>],
    /// Function that returns the index of a sample's candidate position. Its arguments are the pixel's column and row
    /// in the full picture, and the sample's index.
    pub(crate) chosen: &'a (dyn Fn((u32, u32), usize) -> usize + Sync),
}

/// Shading frequency of a triangle within a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ShadingRate {
    /// Once per covered sample.
    Sample,
    /// Once per pixel, whatever the number of covered samples.
    Pixel,
}

/// Draws triangles with all stages. `frames` holds one framebuffer for each sample within a pixel: the first holds the
/// first sample of every pixel, and so on. All framebuffers hold the same rectangle.
pub(crate) fn draw(call: DrawCall<'_>, places: CandidatePositions<'_>, rate: ShadingRate, frames: &mut [Framebuffer]) {
    let job = DrawContext { call, places, comparison: DepthComparison::of(call.settings), shaders: call.shaders() };
    with_arithmetic!(call.settings.arithmetic, N => match rate {
        ShadingRate::Sample => job.per_sample::<N>(frames),
        ShadingRate::Pixel => job.per_pixel::<N>(frames),
    });
}

/// Inputs shared by all triangles of a draw.
struct DrawContext<'a> {
    call: DrawCall<'a>,
    places: CandidatePositions<'a>,
    comparison: DepthComparison,
    shaders: Vec<Shader<'a>>,
}

/// Candidate position of a sample in its pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct CandidatePosition {
    /// Index of the sample within its pixel.
    sample: usize,
    /// Index of the candidate position of the sample.
    place: usize,
}

/// Covered sample. The order is that of the rows of the packed picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct CandidateSample {
    /// Row in the packed picture.
    row: u32,
    /// Column in the packed picture.
    column: u32,
    /// Position of the sample.
    position: CandidatePosition,
}

/// Triangle displaced for one candidate position, with its edges.
struct DisplacedTriangle<N: Numbers> {
    triangle: ScreenTriangle,
    edges: RasterTriangle<N>,
}

impl<N: Numbers> DisplacedTriangle<N> {
    /// Returns the triangle with the samples that it covers.
    fn covering<'a>(&'a self, spans: &'a [Span]) -> RasterizedTriangle<'a, N> {
        RasterizedTriangle { triangle: &self.triangle, edges: &self.edges, spans }
    }
}

/// Displaced triangles of all candidate positions of all samples; `None` where the triangle has no area.
type DisplacedTriangles<N> = Vec<Vec<Option<DisplacedTriangle<N>>>>;

/// Samples of one pixel that a triangle covers.
struct CoveredPixel<'t, N: Numbers> {
    /// The triangle, displaced for every sample.
    moved: &'t DisplacedTriangles<N>,
    samples: &'t [CandidateSample],
}

impl<'t, N: Numbers> CoveredPixel<'t, N> {
    /// Returns a covered sample, and the triangle displaced for that sample's position. `pixel` is the column and row of
    /// the pixel in the full picture.
    fn displaced(&self, at: CandidateSample, pixel: (u32, u32)) -> Option<(&'t ScreenTriangle, RasterSample)> {
        let DisplacedTriangle { triangle, edges } = self.moved[at.position.sample][at.position.place].as_ref()?;
        Some((triangle, edges.sample((at.column, at.row), pixel)))
    }
}

impl<'a> DrawContext<'a> {
    /// Returns the range of triangles drawn in order, and the range of those whose fragments are sorted by depth.
    fn split(&self) -> [Range<usize>; 2] {
        self.call.split().into()
    }

    /// Returns the triangles of a range that may cover samples within the scissor, in drawing order, with their indices
    /// and shaders.
    fn triangles(&self, range: Range<usize>) -> impl Iterator<Item = (usize, &ScreenTriangle, &Shader<'a>)> {
        let all = &self.call.geometry.triangles;
        let near = range.filter(|place| self.call.extent.scissor.may_overlap_box(all.box_of(*place)));
        let near = near.map(|place| (place, &all[place]));
        near.map(|(place, triangle)| (place, triangle, &self.shaders[triangle.instance as usize]))
    }

    fn sorting(&self) -> Sorting<'_> {
        Sorting { geometry: self.call.geometry, settings: self.call.settings, shaders: &self.shaders }
    }

    /// Returns one displaced triangle for each candidate position of one sample.
    fn displaced_to<N: Numbers>(
        &self,
        triangle: &ScreenTriangle,
        places: &[[f32; 2]],
    ) -> Vec<Option<DisplacedTriangle<N>>> {
        let DrawCall { geometry, settings, .. } = self.call;
        let moved = |offset_px: &[f32; 2]| {
            let triangle = displaced(triangle, *offset_px, settings, &geometry.depth_scale)?;
            let edges = RasterTriangle::<N>::new(triangle.corners_in(settings.arithmetic), settings.fill_rule)?;
            Some(DisplacedTriangle { triangle, edges })
        };
        places.iter().map(moved).collect()
    }

    /// Computes one displaced triangle for each candidate position of each sample.
    fn displace_all<N: Numbers>(&self, triangle: &ScreenTriangle, out: &mut DisplacedTriangles<N>) {
        out.clear();
        out.extend(self.places.candidates.iter().map(|places| self.displaced_to(triangle, places)));
    }

    /// Finds the pixels in which a displaced triangle covers a sample. Pixels for which this sample has another
    /// candidate position are left out.
    fn cover<N: Numbers>(
        &self,
        DisplacedTriangle { triangle, edges }: &DisplacedTriangle<N>,
        CandidatePosition { sample, place }: CandidatePosition,
        grid: SampleGrid,
        spans: &mut Vec<Span>,
    ) {
        spans.clear();
        let area = SampleArea { grid, scissor: self.call.extent.scissor };
        cover_samples(self.call.settings.rasterizer, edges, triangle.corners_px(), area, spans);
        if self.places.candidates[sample].len() > 1 {
            let all = std::mem::take(spans);
            let columns =
                all.into_iter().flat_map(|span| (span.left..span.right).map(move |column| (column, span.row)));
            for (column, row) in columns {
                if (self.places.chosen)(grid.pixel(column, row), sample) == place {
                    spans.push(Span { row, left: column, right: column + 1 });
                }
            }
        }
    }

    fn per_sample<N: Numbers>(&self, frames: &mut [Framebuffer]) {
        let (mut spans, mut moved) = (Vec::new(), Vec::new());
        let [in_order, to_sort] = self.split();
        for (_, triangle, shader) in self.triangles(in_order) {
            self.displace_all::<N>(triangle, &mut moved);
            for ((sample, frame), places) in frames.iter_mut().enumerate().zip(&moved) {
                for (place, seen) in places.iter().enumerate() {
                    let Some(moved) = seen else { continue };
                    self.cover(moved, CandidatePosition { sample, place }, frame.grid, &mut spans);
                    let stages = SampleStages { comparison: self.comparison, until: LastStage::Shade };
                    stages.draw(moved.covering(&spans), shader, frame, &mut ());
                }
            }
        }
        if !to_sort.is_empty() {
            self.sort_per_sample::<N>(&to_sort, frames);
        }
    }

    /// Draws blended triangles whose fragments are sorted by depth, and shades every sample. Processes one sample index
    /// at a time.
    fn sort_per_sample<N: Numbers>(&self, triangles: &Range<usize>, frames: &mut [Framebuffer]) {
        let (mut list, mut spans) = (FragmentList::default(), Vec::new());
        for ((sample, frame), candidates) in frames.iter_mut().enumerate().zip(self.places.candidates) {
            list.clear();
            for (index, triangle, _) in self.triangles(triangles.clone()) {
                for (place, seen) in self.displaced_to::<N>(triangle, candidates).iter().enumerate() {
                    let Some(moved) = seen else { continue };
                    self.cover(moved, CandidatePosition { sample, place }, frame.grid, &mut spans);
                    list.begin(index);
                    self.sorting().collect(moved.covering(&spans), frame, &mut list, &mut ());
                }
            }
            self.sorting().blend(&mut list, std::slice::from_mut(frame), &mut ());
        }
    }

    fn per_pixel<N: Numbers>(&self, frames: &mut [Framebuffer]) {
        let (mut spans, mut moved, mut covered) = (Vec::new(), Vec::new(), Vec::new());
        let [in_order, to_sort] = self.split();
        let mut list = FragmentList::default();
        for (index, triangle, _) in self.triangles(in_order.start..to_sort.end) {
            self.displace_all::<N>(triangle, &mut moved);
            covered.clear();
            for ((sample, frame), places) in frames.iter().enumerate().zip(&moved) {
                for (place, seen) in places.iter().enumerate() {
                    let Some(moved) = seen else { continue };
                    let position = CandidatePosition { sample, place };
                    self.cover(moved, position, frame.grid, &mut spans);
                    for Span { row, left, right } in spans.iter().copied() {
                        covered.extend((left..right).map(|column| CandidateSample { row, column, position }));
                    }
                }
            }
            covered.sort_unstable();
            let centre = RasterTriangle::<N>::new(triangle.corners_px(), self.call.settings.fill_rule);
            for samples in covered.chunk_by(|a, b| (a.row, a.column) == (b.row, b.column)) {
                let pixel = CoveredPixel { moved: &moved, samples };
                let Some((seen, fragment)) = self.fragment(triangle, centre.as_ref(), &pixel, frames) else {
                    continue;
                };
                if index < to_sort.start {
                    self.shade_pixel(seen, &fragment, &pixel, frames);
                } else {
                    list.begin(index);
                    self.collect_pixel(&fragment, &pixel, frames, &mut list);
                }
            }
        }
        self.sorting().blend(&mut list, frames, &mut ());
    }

    /// Returns the fragment that is shaded for all covered samples of a pixel, and the triangle that contains it. This
    /// is the original triangle if it covers the pixel's centre, otherwise the triangle displaced for the first covered
    /// sample.
    fn fragment<'t, N: Numbers>(
        &self,
        triangle: &'t ScreenTriangle,
        centre: Option<&RasterTriangle<N>>,
        covered: &CoveredPixel<'t, N>,
        frames: &[Framebuffer],
    ) -> Option<(&'t ScreenTriangle, Fragment)> {
        let first @ CandidateSample { row, column, position } = *covered.samples.first()?;
        let pixel = frames[position.sample].grid.pixel(column, row);
        let centre = centre.filter(|edges| edges.contains(pixel.0.into(), pixel.1.into()));
        let in_the_middle = centre.map(|edges| (triangle, edges.sample((column, row), pixel)));
        let (seen, shaded_at) = in_the_middle.or_else(|| covered.displaced(first, pixel))?;
        let attributes = self.shaders[triangle.instance as usize].attributes();
        Some((seen, interpolate(seen, shaded_at, attributes)))
    }

    /// Depth-tests the covered samples of one pixel and collects those that pass.
    fn collect_pixel<N: Numbers>(
        &self,
        fragment: &Fragment,
        covered: &CoveredPixel<'_, N>,
        frames: &[Framebuffer],
        list: &mut FragmentList,
    ) {
        list.shade(*fragment);
        let pixel = (fragment.sample.x, fragment.sample.y);
        for covered_sample in covered.samples {
            let Some((moved, at)) = covered.displaced(*covered_sample, pixel) else { continue };
            let CandidateSample { row, column, position: CandidatePosition { sample, .. } } = *covered_sample;
            let frame = &frames[sample];
            let (x, y) = (column - frame.origin.0, row - frame.origin.1);
            if let Some(depths) = &frame.depth
                && !self.comparison.passes(depth_at(moved, &at), depths.at(x, y))
            {
                continue;
            }
            let place = y as usize * frame.color.width() as usize + x as usize;
            let nearness = blending::nearness(self.call.settings, moved, &at);
            list.add(sample * frame.color.pixels().len() + place, nearness);
        }
    }

    /// Depth-tests the covered samples of one pixel, shades once, and writes that colour to the samples that pass. The
    /// fragment is one of the triangle `seen`.
    fn shade_pixel<N: Numbers>(
        &self,
        seen: &ScreenTriangle,
        fragment: &Fragment,
        covered: &CoveredPixel<'_, N>,
        frames: &mut [Framebuffer],
    ) {
        let RasterSample { column, row, x, y, .. } = fragment.sample;
        let pixel = (x, y);
        let shader = &self.shaders[seen.instance as usize];
        let transparency = shader.transparency();
        if transparency == Transparency::AlphaTested && shader.fails_alpha_test(fragment) {
            return;
        }
        let opaque = (transparency != Transparency::Blended).then(|| shader.shade(fragment, seen));
        for sample in covered.samples {
            let Some((moved, at)) = covered.displaced(*sample, pixel) else { continue };
            let frame = &mut frames[sample.position.sample];
            let (x, y) = (column - frame.origin.0, row - frame.origin.1);
            if let Some(depths) = &mut frame.depth {
                let new = depth_at(moved, &at);
                if !self.comparison.passes(new, depths.at(x, y)) {
                    continue;
                }
                if opaque.is_some() {
                    depths.set(x, y, new);
                }
            }
            let below = frame.color.at(x, y);
            frame.color.set(x, y, opaque.unwrap_or_else(|| shader.blend(fragment, seen, below)));
        }
    }
}

/// Moves a triangle by −`offset`, in pixels. Returns `None` if the moved triangle has no area in the arithmetic that
/// the settings select.
fn displaced(
    triangle: &ScreenTriangle,
    offset @ [right, down]: [f32; 2],
    settings: &Settings,
    scale: &DepthScale,
) -> Option<ScreenTriangle> {
    let [right_steps, down_steps] = offset.map(|px| snap(px) as i32);
    let vertices = triangle.vertices.map(|vertex| {
        let [x, y] = vertex.position_px;
        let position_px = [x - right, y - down];
        ScreenVertex { position_px, x: vertex.x - right_steps, y: vertex.y - down_steps, ..vertex }
    });
    let moved = ScreenTriangle { vertices, ..*triangle };
    let positions_px = moved.corners_in(settings.arithmetic);
    let (area, unit) = doubled_area(settings.arithmetic, positions_px);
    let doubled_area = (area * unit).abs();
    (doubled_area > 0.0).then(|| ScreenTriangle { doubled_area, depth: scale.over(&vertices, doubled_area), ..moved })
}
