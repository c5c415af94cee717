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
use super::depth::{DepthComparison, DepthScale, depth_at};
use super::framebuffer::Framebuffer;
use super::interpolate::{Fragment, interpolate};
use super::raster::numbers::Numbers;
use super::raster::{RasterSample, RasterTriangle, Span, cover_samples, doubled_area, with_arithmetic};
use super::settings::Settings;
use super::shade::Shader;
use super::viewport::{ScreenTriangle, ScreenVertex};
use super::{Extent, Geometry, LastStage, samples};
use crate::math::fixed::snap;
use crate::scene::{Scene, Transparency};

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

/// Draws the triangles of `extent`. `frames` holds one framebuffer for each sample within a pixel: the first holds the
/// first sample of every pixel, and so on. All framebuffers hold the same rectangle.
pub(crate) fn draw(
    scene: &Scene,
    geometry: &Geometry,
    settings: &Settings,
    extent: &Extent,
    (places, rate): (CandidatePositions<'_>, ShadingRate),
    frames: &mut [Framebuffer],
) {
    let job = DrawContext::new(scene, geometry, settings, extent, places);
    with_arithmetic!(settings.arithmetic, N => match rate {
        ShadingRate::Sample => job.per_sample::<N>(frames),
        ShadingRate::Pixel => job.per_pixel::<N>(frames),
    });
}

/// Inputs shared by all triangles of a draw.
struct DrawContext<'a> {
    geometry: &'a Geometry,
    settings: &'a Settings,
    extent: &'a Extent,
    places: CandidatePositions<'a>,
    comparison: DepthComparison,
    shaders: Vec<Shader<'a>>,
}

/// Covered sample: row and column in the packed picture, index of the sample within its pixel, and index of its
/// candidate position.
type CandidateSample = (u32, u32, usize, usize);

/// Triangle displaced for one candidate position, with its edges; `None` if the triangle has no area.
type DisplacedTriangle<N> = Option<(ScreenTriangle, RasterTriangle<N>)>;

impl<'a> DrawContext<'a> {
    fn new(
        scene: &'a Scene,
        geometry: &'a Geometry,
        settings: &'a Settings,
        extent: &'a Extent,
        places: CandidatePositions<'a>,
    ) -> Self {
        let draws = scene.instances.iter().zip(&geometry.plans);
        let shaders = draws.map(|(instance, plan)| Shader::new(settings, &scene.library, instance, plan)).collect();
        Self { geometry, settings, extent, places, comparison: DepthComparison::of(settings), shaders }
    }

    /// Returns the range of triangles drawn in order, and the range of those whose fragments are sorted by depth.
    fn split(&self) -> [Range<usize>; 2] {
        blending::split(self.geometry, self.settings, &self.extent.triangles, LastStage::Shade).into()
    }

    /// Returns the triangles of a range that may cover samples within the scissor, in drawing order, with their indices
    /// and shaders.
    fn triangles(&self, range: Range<usize>) -> impl Iterator<Item = (usize, &ScreenTriangle, &Shader<'a>)> {
        let all = &self.geometry.triangles;
        let near = range.filter(|place| self.extent.scissor.may_overlap_box(all.box_of(*place)));
        let near = near.map(|place| (place, &all[place]));
        near.map(|(place, triangle)| (place, triangle, &self.shaders[triangle.instance as usize]))
    }

    fn sorting(&self) -> Sorting<'_> {
        Sorting { geometry: self.geometry, settings: self.settings, shaders: &self.shaders }
    }

    /// Returns one displaced triangle for each candidate position of one sample.
    fn displaced_to<N: Numbers>(&self, triangle: &ScreenTriangle, places: &[[f32; 2]]) -> Vec<DisplacedTriangle<N>> {
        let moved = |offset_px: &[f32; 2]| {
            let moved = displaced(triangle, *offset_px, self.settings, &self.geometry.depth_scale)?;
            let edges = RasterTriangle::<N>::new(moved.corners_in(self.settings.arithmetic), self.settings.fill_rule)?;
            Some((moved, edges))
        };
        places.iter().map(moved).collect()
    }

    /// Computes one displaced triangle for each candidate position of each sample.
    fn displace_all<N: Numbers>(&self, triangle: &ScreenTriangle, out: &mut Vec<Vec<DisplacedTriangle<N>>>) {
        out.clear();
        out.extend(self.places.candidates.iter().map(|places| self.displaced_to(triangle, places)));
    }

    /// Finds the pixels in which a displaced triangle covers the sample with index `sample`. Pixels for which this
    /// sample has another candidate position than `place` are left out.
    fn cover<N: Numbers>(
        &self,
        (triangle, edges): (&ScreenTriangle, &RasterTriangle<N>),
        (sample, place): (usize, usize),
        frame: &Framebuffer,
        spans: &mut Vec<Span>,
    ) {
        spans.clear();
        let area = (frame.grid, self.extent.scissor);
        cover_samples(self.settings.rasterizer, edges, triangle.corners_px(), area, spans);
        if self.places.candidates[sample].len() > 1 {
            let all = std::mem::take(spans);
            let columns =
                all.into_iter().flat_map(|span| (span.left..span.right).map(move |column| (column, span.row)));
            for (column, row) in columns {
                if (self.places.chosen)(frame.grid.pixel(column, row), sample) == place {
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
                    let Some((moved, edges)) = seen else { continue };
                    self.cover((moved, edges), (sample, place), frame, &mut spans);
                    let how = (self.comparison, LastStage::Shade);
                    samples::draw((moved, edges), &spans, shader, how, frame, &mut ());
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
                    let Some((moved, edges)) = seen else { continue };
                    self.cover((moved, edges), (sample, place), frame, &mut spans);
                    self.sorting().collect((moved, edges, index), &spans, frame, &mut list, &mut ());
                }
            }
            self.sorting().blend(&mut list, std::slice::from_mut(frame), &mut ());
        }
    }

    fn per_pixel<N: Numbers>(&self, frames: &mut [Framebuffer]) {
        let (mut spans, mut moved, mut covered) = (Vec::new(), Vec::new(), Vec::<CandidateSample>::new());
        let [in_order, to_sort] = self.split();
        let mut list = FragmentList::default();
        for (index, triangle, shader) in self.triangles(in_order.start..to_sort.end) {
            self.displace_all::<N>(triangle, &mut moved);
            covered.clear();
            for ((sample, frame), places) in frames.iter().enumerate().zip(&moved) {
                for (place, seen) in places.iter().enumerate() {
                    let Some((moved, edges)) = seen else { continue };
                    self.cover((moved, edges), (sample, place), frame, &mut spans);
                    for span in &spans {
                        covered.extend((span.left..span.right).map(|column| (span.row, column, sample, place)));
                    }
                }
            }
            covered.sort_unstable();
            let centre = RasterTriangle::<N>::new(triangle.corners_px(), self.settings.fill_rule);
            for pixel in covered.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
                let Some((seen, fragment)) = self.fragment((triangle, centre.as_ref()), &moved, pixel, frames) else {
                    continue;
                };
                if index < to_sort.start {
                    self.shade_pixel((seen, &fragment), &moved, pixel, shader, frames);
                } else {
                    self.collect_pixel((index, &fragment), &moved, pixel, frames, &mut list);
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
        (triangle, centre): (&'t ScreenTriangle, Option<&RasterTriangle<N>>),
        moved: &'t [Vec<DisplacedTriangle<N>>],
        covered: &[CandidateSample],
        frames: &[Framebuffer],
    ) -> Option<(&'t ScreenTriangle, Fragment)> {
        let first @ (row, column, sample, _) = *covered.first()?;
        let pixel = frames[sample].grid.pixel(column, row);
        let centre = centre.filter(|edges| edges.contains(pixel.0.into(), pixel.1.into()));
        let in_the_middle = centre.map(|edges| (triangle, edges.sample((column, row), pixel)));
        let (seen, shaded_at) = in_the_middle.or_else(|| sample_of(moved, first, pixel))?;
        let attributes = self.shaders[triangle.instance as usize].attributes();
        Some((seen, interpolate(seen, shaded_at, attributes)))
    }

    /// Depth-tests the covered samples of one pixel and collects those that pass.
    fn collect_pixel<N: Numbers>(
        &self,
        (index, fragment): (usize, &Fragment),
        moved: &[Vec<DisplacedTriangle<N>>],
        covered: &[CandidateSample],
        frames: &[Framebuffer],
        list: &mut FragmentList,
    ) {
        list.shade(*fragment);
        let pixel = (fragment.sample.x, fragment.sample.y);
        for covered in covered {
            let Some((moved, at)) = sample_of(moved, *covered, pixel) else { continue };
            let (row, column, sample, _) = *covered;
            let frame = &frames[sample];
            let (x, y) = (column - frame.origin.0, row - frame.origin.1);
            if let Some(depths) = &frame.depth
                && !self.comparison.passes(depth_at(moved, &at), depths.at(x, y))
            {
                continue;
            }
            let place = y as usize * frame.color.width() as usize + x as usize;
            let nearness = blending::nearness(self.settings, moved, &at);
            list.add(sample * frame.color.pixels().len() + place, nearness, index);
        }
    }

    /// Depth-tests the covered samples of one pixel, shades once, and writes that colour to the samples that pass.
    fn shade_pixel<N: Numbers>(
        &self,
        (seen, fragment): (&ScreenTriangle, &Fragment),
        moved: &[Vec<DisplacedTriangle<N>>],
        covered: &[CandidateSample],
        shader: &Shader<'_>,
        frames: &mut [Framebuffer],
    ) {
        let RasterSample { column, row, x, y, .. } = fragment.sample;
        let pixel = (x, y);
        let transparency = shader.transparency();
        if transparency == Transparency::AlphaTested && shader.fails_alpha_test(fragment) {
            return;
        }
        let opaque = (transparency != Transparency::Blended).then(|| shader.shade(fragment, seen));
        for sample in covered {
            let Some((moved, at)) = sample_of(moved, *sample, pixel) else { continue };
            let frame = &mut frames[sample.2];
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

/// Returns a covered sample, and the triangle displaced for that sample's position.
fn sample_of<N: Numbers>(
    moved: &[Vec<DisplacedTriangle<N>>],
    (row, column, sample, place): CandidateSample,
    pixel: (u32, u32),
) -> Option<(&ScreenTriangle, RasterSample)> {
    let (seen, edges) = moved[sample][place].as_ref()?;
    Some((seen, edges.sample((column, row), pixel)))
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
