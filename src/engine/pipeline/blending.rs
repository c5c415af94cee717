//! Order-independent transparency by an A-buffer (Carpenter, "The A-buffer, an Antialiased Hidden Surface Method",
//! 1984), which holds the blended fragments of a few rows at a time.
//!
//! Blended triangles are drawn after the opaque ones and store no depth, so the result of a depth test does not depend
//! on the order of the blended triangles. Fragments that pass are collected, sorted by sample and depth, and blended
//! from far to near. Fragments of equal depth stay in submission order. The observer receives each fragment when it is
//! blended, so a pixel's history lists fragments in blending order.

use super::depth::DepthComparison;
use super::framebuffer::Framebuffer;
use super::interpolate::{Fragment, interpolate};
use super::observe::{DepthOutcome, Observer};
use super::raster::numbers::Numbers;
use super::raster::{RasterSample, RasterTriangle, SampleArea, Scissor, cover_samples};
use super::samples::RasterizedTriangle;
use super::screen_triangle::{ScreenTriangle, depth_at, unquantised_depth_at};
use super::settings::Settings;
use super::shade::Shader;
use super::{Extent, Geometry, partial};
use crate::image::Image;

/// Number of pixel rows whose fragments are collected at a time. It limits the memory that the fragment list uses.
const ROWS: u32 = 16;

/// Returns the depth of a sample as a sort key that grows towards the viewer. The key is not quantised, because the
/// steps of the depth format may be coarser than the distances between surfaces.
#[inline]
pub(super) fn nearness(settings: &Settings, triangle: &ScreenTriangle, sample: &RasterSample) -> f32 {
    let depth = unquantised_depth_at(triangle, sample) as f32;
    if settings.reversed() { depth } else { -depth }
}

/// Fragment of a blended triangle that passed the depth test and is not yet blended.
#[derive(Clone, Copy, Debug)]
struct Collected {
    /// Index of the sample, counted through all framebuffers one after the other.
    sample: usize,
    nearness: f32,
    /// Index of the triangle in [`Geometry::triangles`].
    triangle: usize,
    /// Index of the attributes in [`FragmentList::fragments`].
    fragment: usize,
}

/// Blended fragments collected for a set of samples, to be sorted by depth.
#[derive(Clone, Debug, Default)]
pub(super) struct FragmentList {
    collected: Vec<Collected>,
    /// Interpolated attributes. If a pixel is shaded only once, all its samples share an entry.
    fragments: Vec<Fragment>,
    /// Index in [`Geometry::triangles`] of the triangle to which added samples belong.
    triangle: usize,
}

impl FragmentList {
    /// Removes all fragments.
    pub(super) fn clear(&mut self) {
        self.collected.clear();
        self.fragments.clear();
    }

    /// Begins with a triangle, given by its index in [`Geometry::triangles`]. Samples added afterwards belong to it.
    pub(super) fn begin(&mut self, triangle: usize) {
        self.triangle = triangle;
    }

    /// Adds the attributes of a fragment. Samples added afterwards belong to this fragment.
    pub(super) fn shade(&mut self, fragment: Fragment) {
        self.fragments.push(fragment);
    }

    /// Adds a sample of the most recently added fragment. `sample` is its index, counted through all framebuffers one
    /// after the other.
    pub(super) fn add(&mut self, sample: usize, nearness: f32) {
        let fragment = self.fragments.len() - 1;
        self.collected.push(Collected { sample, nearness, triangle: self.triangle, fragment });
    }

    /// Sorts the fragments by sample, and the fragments of each sample from far to near. Returns each fragment with the
    /// index of its sample and the index of its triangle.
    pub(super) fn sorted(&mut self) -> impl Iterator<Item = (usize, usize, &Fragment)> {
        let Self { collected, fragments, .. } = self;
        collected.sort_by(|a, b| a.sample.cmp(&b.sample).then(a.nearness.total_cmp(&b.nearness)));
        collected.iter().map(|one| (one.sample, one.triangle, &fragments[one.fragment]))
    }
}

/// Context for drawing blended triangles whose fragments are sorted by depth.
pub(super) struct Sorting<'a> {
    pub(super) geometry: &'a Geometry,
    pub(super) settings: &'a Settings,
    /// Shaders, one per instance of the scene.
    pub(super) shaders: &'a [Shader<'a>],
}

impl Sorting<'_> {
    /// Draws the triangles of `extent`, all of which must be blended.
    pub(super) fn draw<N: Numbers, O: Observer>(&self, extent: &Extent, frame: &mut Framebuffer, observer: &mut O) {
        let Scissor { top, bottom, .. } = extent.scissor;
        let mut list = FragmentList::default();
        let mut spans = Vec::new();
        for first in (top..bottom).step_by(ROWS as usize) {
            let band = Scissor { top: first, bottom: bottom.min(first + ROWS), ..extent.scissor };
            let area = SampleArea { grid: frame.grid, scissor: band };
            list.clear();
            for place in extent.triangles.clone() {
                if !band.may_overlap_box(self.geometry.triangles.box_of(place)) {
                    continue;
                }
                let triangle = &self.geometry.triangles[place];
                let corners_px = triangle.corners_px();
                let Some(edges) = RasterTriangle::<N>::new(corners_px, self.settings.fill_rule) else { continue };
                spans.clear();
                let visited = match &self.geometry.partial {
                    Some(samples) if place + 1 == self.geometry.triangles.len() => {
                        partial::within(samples, area, &mut spans)
                    }
                    _ => cover_samples(self.settings.rasterizer, &edges, corners_px, area, &mut spans),
                };
                list.begin(place);
                let rasterized = RasterizedTriangle { triangle, edges: &edges, spans: &spans };
                self.collect(rasterized, frame, &mut list, observer);
                observer.visited(visited);
            }
            self.blend(&mut list, std::slice::from_mut(frame), observer);
        }
    }

    /// Collects the samples of a blended triangle that pass the depth test. Reports the others to the observer.
    pub(super) fn collect<N: Numbers, O: Observer>(
        &self,
        RasterizedTriangle { triangle, edges, spans }: RasterizedTriangle<'_, N>,
        frame: &Framebuffer,
        list: &mut FragmentList,
        observer: &mut O,
    ) {
        let comparison = DepthComparison::of(self.settings);
        let attributes = self.shaders[triangle.instance as usize].attributes();
        let (width, depths) = (frame.color.width() as usize, frame.depth.as_ref().map(Image::pixels));
        for (column, row) in spans.iter().flat_map(|span| (span.left..span.right).map(|column| (column, span.row))) {
            let sample = edges.sample((column, row), frame.grid.pixel(column, row));
            let index = (row - frame.origin.1) as usize * width + (column - frame.origin.0) as usize;
            if let Some(depths) = depths {
                let (new, stored) = (depth_at(triangle, &sample), depths[index]);
                if !comparison.passes(new, stored) {
                    observer.covered(triangle, &sample);
                    observer.depth_tested(triangle, &sample, DepthOutcome { new, stored, passed: false });
                    continue;
                }
            }
            list.shade(interpolate(triangle, sample, attributes));
            list.add(index, nearness(self.settings, triangle, &sample));
        }
    }

    /// Blends all collected fragments over framebuffers of equal size, from far to near.
    pub(super) fn blend<O: Observer>(&self, list: &mut FragmentList, frames: &mut [Framebuffer], observer: &mut O) {
        let samples_each = frames.first().map_or(1, |frame| frame.color.pixels().len().max(1));
        for (index, place, fragment) in list.sorted() {
            let (frame, index) = (&mut frames[index / samples_each], index % samples_each);
            let triangle = &self.geometry.triangles[place];
            observer.covered(triangle, &fragment.sample);
            if let Some(depths) = &frame.depth {
                let (new, stored) = (depth_at(triangle, &fragment.sample), depths.pixels()[index]);
                observer.depth_tested(triangle, &fragment.sample, DepthOutcome { new, stored, passed: true });
            }
            let color = &mut frame.color.pixels_mut()[index];
            *color = self.shaders[triangle.instance as usize].blend(fragment, triangle, *color);
            observer.shaded(triangle, fragment, *color);
        }
    }
}
