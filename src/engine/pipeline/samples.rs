//! Per-sample stages for one triangle: depth test, alpha test, interpolation, shading and framebuffer write.
//!
//! The loop is compiled once per [`Transparency`], so the loop for opaque triangles has no branches for transparency.
//! An alpha-tested fragment is interpolated twice, for its alpha and for its colour, because keeping the first result
//! would slow down the other modes.

use std::hint::black_box;

use super::LastStage;
use super::depth::DepthComparison;
use super::framebuffer::Framebuffer;
use super::interpolate::interpolate;
use super::observe::{DepthOutcome, Observer};
use super::raster::numbers::Numbers;
use super::raster::{RasterTriangle, Span};
use super::screen_triangle::{ScreenTriangle, depth_at};
use super::shade::Shader;
use crate::image::Image;
use crate::scene::Transparency;

/// Triangle with its edges and the samples that it covers.
pub(super) struct RasterizedTriangle<'a, N: Numbers> {
    pub(super) triangle: &'a ScreenTriangle,
    pub(super) edges: &'a RasterTriangle<N>,
    pub(super) spans: &'a [Span],
}

/// Stages that process the samples of a triangle.
#[derive(Clone, Copy)]
pub(super) struct SampleStages {
    pub(super) comparison: DepthComparison,
    /// Last stage that runs.
    pub(super) until: LastStage,
}

impl SampleStages {
    /// Processes the samples that a triangle covers. All samples must lie within `frame`.
    pub(super) fn draw<N: Numbers, O: Observer>(
        self,
        what: RasterizedTriangle<'_, N>,
        shader: &Shader<'_>,
        frame: &mut Framebuffer,
        observer: &mut O,
    ) {
        match shader.transparency() {
            Transparency::Opaque => self.draw_as::<N, O, false, false>(what, shader, frame, observer),
            Transparency::AlphaTested => self.draw_as::<N, O, true, false>(what, shader, frame, observer),
            Transparency::Blended => self.draw_as::<N, O, false, true>(what, shader, frame, observer),
        }
    }

    /// Implements [`SampleStages::draw`] for one [`Transparency`], which is known at compile time.
    fn draw_as<N: Numbers, O: Observer, const CUT_OUT: bool, const BLENDED: bool>(
        self,
        RasterizedTriangle { triangle, edges, spans }: RasterizedTriangle<'_, N>,
        shader: &Shader<'_>,
        frame: &mut Framebuffer,
        observer: &mut O,
    ) {
        let Self { comparison, until } = self;
        let Framebuffer { grid, origin, color, depth, .. } = frame;
        // Slices let the compiler keep pointers and lengths in registers, because no write can alias them.
        let width = color.width() as usize;
        let (colors, mut depths) = (color.pixels_mut(), depth.as_mut().map(Image::pixels_mut));
        let attributes = shader.attributes();
        for (column, row) in spans.iter().flat_map(|span| (span.left..span.right).map(|column| (column, span.row))) {
            let sample = edges.sample((column, row), grid.pixel(column, row));
            observer.covered(triangle, &sample);
            let place = (row - origin.1) as usize * width + (column - origin.0) as usize;
            if until == LastStage::Coverage {
                // `black_box` prevents dead-code elimination. Passing a whole sample would store it to memory, which costs
                // more than finding the sample, so only the column is passed.
                black_box(sample.column);
                continue;
            }
            let mut new_depth = None;
            if let Some(depths) = &mut depths {
                let new = depth_at(triangle, &sample);
                let stored = depths[place];
                let passed = comparison.passes(new, stored);
                observer.depth_tested(triangle, &sample, DepthOutcome { new, stored, passed });
                if !passed {
                    continue;
                }
                if !CUT_OUT && !BLENDED {
                    depths[place] = new;
                    observer.depth_stored(triangle, &sample);
                }
                new_depth = Some(new);
            }
            if CUT_OUT {
                let fragment = interpolate(triangle, sample, attributes);
                if shader.fails_alpha_test(&fragment) {
                    observer.alpha_rejected(triangle, &fragment);
                    continue;
                }
                if let (Some(depths), Some(new)) = (&mut depths, new_depth) {
                    depths[place] = new;
                    observer.depth_stored(triangle, &sample);
                }
            }
            if until == LastStage::Depth {
                continue;
            }
            let fragment = interpolate(triangle, sample, attributes);
            if until == LastStage::Interpolate {
                black_box(fragment);
                continue;
            }
            let rgba = if BLENDED {
                shader.blend(&fragment, triangle, colors[place])
            } else {
                shader.shade(&fragment, triangle)
            };
            colors[place] = rgba;
            observer.shaded(triangle, &fragment, rgba);
        }
    }
}
