//! `clip_tri`: triangles in clip space (0 ≤ z ≤ w), which may reach behind the eye, all the way to covered samples.

use serde::{Deserialize, Serialize};

use super::{Check, Covered, Exactly, Float, Options, check_picture};
use crate::pipeline::depth::depth_at;
use crate::pipeline::from_clip_space;
use crate::pipeline::interpolate::{Attributes, interpolate};
use crate::pipeline::raster::{AnyTriangle, Span, cover};
use crate::pipeline::settings::{FillRule, Interpolation};
use crate::pipeline::vertex::ClipVertex;
use crate::pipeline::viewport::{ScreenTriangle, Viewport};

/// The case.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct ClipTri {
    /// Width of the picture, px.
    pub width: u32,
    /// Height of the picture, px.
    pub height: u32,
    /// Corners as [x, y, z, w], of either winding. A corner that is not finite costs the triangle.
    pub triangles: Vec<Exactly<Exactly<Float, 4>, 3>>,
}

impl Check for ClipTri {
    fn check(&self) -> Result<(), String> {
        check_picture(self.width, self.height)
    }
}

impl ClipTri {
    /// Corners of one of the triangles as x, y, z, w.
    pub fn corners(&self, triangle: usize) -> Option<[[f32; 4]; 3]> {
        let Exactly(corners) = self.triangles.get(triangle)?;
        Some(corners.map(|Exactly(position)| position.map(|number| number.0)))
    }

    /// Clips, projects, covers and interpolates, as the pipeline does with what its vertex stage gives.
    pub(super) fn answer(&self, options: Options) -> ClipTriAnswer {
        let mut answer = ClipTriAnswer { triangles: Vec::new(), attr: Vec::new() };
        for (number, corners) in (0..self.triangles.len()).filter_map(|n| Some((n, self.corners(n)?))) {
            let vertices = corners.map(|position| ClipVertex::at(position.into()));
            let mut spans = Vec::new();
            for piece in from_clip_space(&vertices, &[[0, 1, 2]], options.arithmetic, self.viewport(), &mut ()) {
                let covered = self.cover(&piece, options);
                let edges = AnyTriangle::new(options.arithmetic, piece.corners_px(), FillRule::TopLeft);
                let samples =
                    covered.iter().flat_map(|span| pixels(*span)).filter_map(|pixel| Some(edges?.sample(pixel)));
                answer.attr.extend(samples.map(|sample| {
                    let p = interpolate(&piece, sample, Attributes::all(Interpolation::Perspective)).source_weights;
                    let z = depth_at(&piece, &sample);
                    (number, sample.x, sample.y, p.x.into(), p.y.into(), p.z.into(), z.into())
                }));
                spans.extend(covered);
            }
            answer.triangles.push(Covered::new(&spans));
        }
        answer
    }

    fn cover(&self, piece: &ScreenTriangle, options: Options) -> Vec<Span> {
        cover(options.rasterizer, options.arithmetic, piece.corners_px(), FillRule::TopLeft, self.viewport())
    }

    fn viewport(&self) -> Viewport {
        Viewport { width: self.width, height: self.height }
    }
}

fn pixels(span: Span) -> impl Iterator<Item = (u32, u32)> {
    (span.left..span.right).map(move |x| (x, span.row))
}

/// The answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClipTriAnswer {
    /// One for each triangle.
    pub triangles: Vec<Covered>,
    /// For each covered pixel the number of the triangle; column and row; perspective-correct weights p0, p1, p2 of the
    /// triangle's own corners; and depth.
    pub attr: Vec<(usize, u32, u32, f64, f64, f64, f64)>,
}
