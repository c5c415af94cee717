//! `clip_tri`: clips, projects and rasterizes triangles in clip space (0 ≤ z ≤ w) that may extend behind the eye.

use serde::{Deserialize, Serialize};

use super::{Check, Control, Exactly, Float, Options, TriangleSpans, Unanswered, check_length, check_picture};
use crate::pipeline::clip_space::ClipVertex;
use crate::pipeline::from_clip_space;
use crate::pipeline::interpolate::{AttributeSelection, interpolate};
use crate::pipeline::raster::{AnyTriangle, Span};
use crate::pipeline::screen_triangle::{ScreenTriangle, depth_at};
use crate::pipeline::settings::{FillRule, Interpolation};
use crate::pipeline::viewport::Viewport;

/// Input of a `clip_tri` case: triangles in clip space and a picture size.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct ClipTri {
    /// Width of the picture in pixels.
    pub width: u32,
    /// Height of the picture in pixels.
    pub height: u32,
    /// Clip-space corners of each triangle as [x, y, z, w], in either winding order. A triangle with a non-finite
    /// corner is discarded.
    pub(crate) triangles: Vec<Exactly<Exactly<Float, 4>, 3>>,
}

impl Check for ClipTri {
    fn check(&self) -> Result<(), String> {
        check_picture(self.width, self.height)
    }
}

impl ClipTri {
    /// Returns the corners of one triangle as [x, y, z, w]; `None` if `triangle` is out of range.
    pub(crate) fn corners(&self, triangle: usize) -> Option<[[f32; 4]; 3]> {
        let Exactly(corners) = self.triangles.get(triangle)?;
        Some(corners.map(|Exactly(position)| position.map(|number| number.0)))
    }

    /// Returns the size of the picture, in pixels.
    pub(crate) fn viewport(&self) -> Viewport {
        Viewport { width: self.width, height: self.height }
    }

    /// Clips and projects one triangle, as the pipeline does with the output of its vertex stage.
    fn pieces(&self, triangle: usize, options: Options) -> Vec<ScreenTriangle> {
        let Some(corners) = self.corners(triangle) else { return Vec::new() };
        let vertices = corners.map(|position| ClipVertex::at(position.into()));
        from_clip_space(&vertices, &[[0, 1, 2]], options.arithmetic, self.viewport(), &mut ())
    }

    /// Clips one triangle and rasterizes each piece that clipping leaves. `take` receives the piece and its spans, one
    /// band of rows at a time, from the top of the picture.
    pub(crate) fn rasterize(
        &self,
        triangle: usize,
        options: Options,
        mut take: impl FnMut(&ScreenTriangle, &[Span]) -> Result<(), Unanswered>,
    ) -> Result<(), Unanswered> {
        let rules = options.coverage(FillRule::TopLeft);
        self.pieces(triangle, options).iter().try_for_each(|piece| {
            rules.cover_in_bands(piece.corners_px(), self.viewport(), |spans, _| take(piece, spans))
        })
    }

    /// Clips, projects, rasterizes and interpolates the triangles, as the pipeline does with the output of its vertex
    /// stage.
    pub(super) fn answer(&self, options: Options, control: &Control<'_>) -> Result<ClipTriAnswer, Unanswered> {
        let count = self.triangles.len();
        let mut answer = ClipTriAnswer { triangles: Vec::with_capacity(count), attr: Vec::new() };
        let mut listed = 0;
        for number in 0..count {
            // The samples of the whole triangle are counted against the limit before any of them is stored.
            self.rasterize(number, options, |_, spans| {
                listed += spans.iter().map(|span| u64::from(span.right - span.left)).sum::<u64>();
                check_length::<ClipSample>("samples", listed)?;
                control.check()
            })?;
            let before = answer.attr.len() as f64;
            let of = (listed as f64 - before).max(1.0);
            let mut covered = TriangleSpans::default();
            self.rasterize(number, options, |piece, spans| {
                let edges = AnyTriangle::new(options.arithmetic, piece.corners_px(), FillRule::TopLeft);
                for span in spans {
                    let samples = pixels(*span).filter_map(|pixel| Some(edges?.sample(pixel)));
                    answer.attr.extend(samples.map(|sample| {
                        let p = interpolate(piece, sample, AttributeSelection::all(Interpolation::Perspective))
                            .source_weights;
                        let z = depth_at(piece, &sample);
                        (number, sample.x, sample.y, p.x.into(), p.y.into(), p.z.into(), z.into())
                    }));
                    control.step((number as f64 + (answer.attr.len() as f64 - before) / of) / count as f64)?;
                }
                covered.add(spans);
                Ok(())
            })?;
            answer.triangles.push(covered);
        }
        Ok(answer)
    }
}

fn pixels(span: Span) -> impl Iterator<Item = (u32, u32)> {
    (span.left..span.right).map(move |x| (x, span.row))
}

/// Covered sample, as triangle index, column, row, perspective-correct weights p0, p1, p2 of the original triangle's
/// corners, and depth.
pub(crate) type ClipSample = (usize, u32, u32, f64, f64, f64, f64);

/// Answer to a [`ClipTri`] case: the covered samples, with barycentric weights and depths.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClipTriAnswer {
    /// Covered samples of each triangle, in input order.
    pub triangles: Vec<TriangleSpans>,
    /// Barycentric weights and depth of each covered sample.
    pub attr: Vec<ClipSample>,
}
