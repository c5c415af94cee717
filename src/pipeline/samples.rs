//! What is done with every covered sample of one triangle: depth, cut-out, interpolate, shade, write.
//!
//! Compiled once for each way to meet what was drawn before, so that samples of opaque triangles do not ask.

use std::hint::black_box;

use super::Until;
use super::depth::{Comparison, depth_at};
use super::framebuffer::Framebuffer;
use super::interpolate::interpolate;
use super::observe::{DepthOutcome, Observer};
use super::raster::numbers::Numbers;
use super::raster::{Span, Triangle};
use super::shade::Shader;
use super::viewport::ScreenTriangle;
use crate::scene::Transparency;

/// Draws the samples of `spans`, which all lie in `frame`, as far as `until` says.
pub(super) fn draw<N: Numbers, O: Observer>(
    (triangle, edges): (&ScreenTriangle, &Triangle<N>),
    spans: &[Span],
    shader: &Shader<'_>,
    (comparison, until): (Comparison, Until),
    frame: &mut Framebuffer,
    observer: &mut O,
) {
    let draw = match shader.transparency() {
        Transparency::Opaque => draw_as::<N, O, false, false>,
        Transparency::CutOut => draw_as::<N, O, true, false>,
        Transparency::Blended => draw_as::<N, O, false, true>,
    };
    draw((triangle, edges), spans, shader, (comparison, until), frame, observer);
}

/// [`draw`], compiled for one way to meet what was drawn before.
fn draw_as<N: Numbers, O: Observer, const CUT_OUT: bool, const BLENDED: bool>(
    (triangle, edges): (&ScreenTriangle, &Triangle<N>),
    spans: &[Span],
    shader: &Shader<'_>,
    (comparison, until): (Comparison, Until),
    frame: &mut Framebuffer,
    observer: &mut O,
) {
    let Framebuffer { grid, origin, color, depth, .. } = frame;
    for (column, row) in spans.iter().flat_map(|span| (span.left..span.right).map(|column| (column, span.row))) {
        let sample = edges.sample((column, row), grid.pixel(column, row));
        observer.covered(triangle, &sample);
        let (column, row) = (column - origin.0, row - origin.1);
        if until == Until::Coverage {
            // A whole sample would have to be stored to be looked at, which costs more than finding it.
            black_box(sample.column);
            continue;
        }
        let mut to_store = None;
        if let Some(buffer) = depth {
            let new = depth_at(triangle, &sample);
            let stored = buffer.at(column, row);
            let passed = comparison.passes(new, stored);
            observer.depth_tested(triangle, &sample, DepthOutcome { new, stored, passed });
            if !passed {
                continue;
            }
            to_store = Some((buffer, new));
        }
        let mut interpolated = None;
        if CUT_OUT {
            let fragment = interpolate(triangle, sample, shader.attributes());
            if shader.cuts_out(&fragment) {
                observer.cut_out(triangle, &fragment);
                continue;
            }
            interpolated = Some(fragment);
        }
        if let Some((buffer, new)) = to_store.filter(|_| !BLENDED) {
            buffer.set(column, row, new);
            observer.depth_stored(triangle, &sample);
        }
        if until == Until::Depth {
            continue;
        }
        let fragment = interpolated.unwrap_or_else(|| interpolate(triangle, sample, shader.attributes()));
        if until == Until::Interpolate {
            black_box(fragment);
            continue;
        }
        let rgba = if BLENDED {
            shader.blend(&fragment, triangle, color.at(column, row))
        } else {
            shader.shade(&fragment, triangle)
        };
        color.set(column, row, rgba);
        observer.shaded(triangle, &fragment, rgba);
    }
}
