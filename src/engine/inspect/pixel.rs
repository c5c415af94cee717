//! Report on one pixel: every fragment with its outcome and reason, and the computation of the final colour.

mod absent;

mod recorder;

mod replay;

pub use absent::Absent;
pub use absent::Cause;
pub use absent::Kind;
pub(super) use replay::centre_color;
pub(super) use replay::replayed;

use serde::Serialize;

use super::depth::DepthRecord;
use super::hits::Fault;
use super::remedy::Remedy;
use super::temporal::PixelHistory;
use crate::image::Rgba8;
use crate::math::fixed::{HALF_PIXEL, SUBPIXELS, to_pixels};
use crate::pipeline::sample::TexelTap;
use crate::pipeline::settings::{Arithmetic, Choice, choice};
use crate::scene::{Transparency, TriangleId};
use crate::upscale::{HistoryStep, Tap};

/// Final outcome of a fragment: visible, covered by later fragments, or rejected by a test.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FragmentOutcome {
    /// The fragment is visible in the pixel.
    Visible,
    /// The fragment was written, but a later fragment covered it.
    Overwritten,
    /// The fragment was written and remains visible through fragments blended over it.
    BlendedOver,
    /// The fragment failed the depth test.
    DepthRejected,
    /// The alpha test discarded the fragment.
    AlphaRejected,
}

impl FragmentOutcome {
    /// Whether the fragment was written to the framebuffer, even if later fragments covered it.
    pub fn is_written(self) -> bool {
        matches!(self, Self::Visible | Self::Overwritten | Self::BlendedOver)
    }
}

/// Colour and depth of a sample before or after a fragment.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SampleState {
    /// Colour of the sample (sRGB codes).
    pub color: Rgba8,
    /// Stored depth of the sample; `None` without a depth buffer.
    pub depth: Option<DepthRecord>,
}

/// Record of one fragment at the inspected sample.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FragmentRecord {
    /// Triangle that produced the fragment.
    pub triangle: TriangleId,
    /// Name of the instance that contains the triangle.
    pub instance: String,
    /// Index of the triangle in the list of rasterized triangles.
    pub submission: usize,
    /// Transparency of the triangle's surface: opaque, alpha-tested or blended.
    pub transparency: Transparency,
    /// Final outcome: visible, overwritten, blended over, or rejected by the depth or alpha test.
    pub outcome: FragmentOutcome,
    /// Reason for the outcome, as one sentence with the deciding numbers.
    pub reason: String,
    /// Arithmetic with which coverage was computed.
    pub arithmetic: Arithmetic,
    /// Corners of the triangle in px, snapped to the subpixel grid in fixed-point arithmetic.
    pub corners_px: [[f32; 2]; 3],
    /// Values of the three edge functions at the sample, in the unit that [`crate::pipeline::raster::RasterSample`]
    /// uses.
    pub edges: [f64; 3],
    /// Doubled area of the triangle, in the unit of `edges`.
    pub doubled_area: f64,
    /// Barycentric weights λ of the corners, linear in screen space.
    pub affine_weights: [f32; 3],
    /// Weights of the corners for interpolating attributes, according to the interpolation setting.
    pub attribute_weights: [f32; 3],
    /// 1/w of each corner, from clip space.
    pub inv_w: [f32; 3],
    /// Depth of each corner, before depth bias and quantisation.
    pub corner_depths: [f32; 3],
    /// Offset that the depth bias adds to all depths of the triangle; `None` if no bias is set.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub depth_bias: Option<f32>,
    /// Depth of the fragment, in the format of the depth buffer.
    pub depth: DepthRecord,
    /// Depth in the depth buffer before the fragment; `None` without a depth test.
    pub stored_depth: Option<DepthRecord>,
    /// Product of opacity and texture alpha, as used for the alpha test or blending. `None` for opaque surfaces and for
    /// fragments that failed the depth test.
    pub alpha: Option<f32>,
    /// Intermediate values of shading; `None` if the fragment was not shaded.
    pub shading: Option<ShadingRecord>,
    /// Colour and depth of the sample before the fragment.
    pub before: SampleState,
    /// Colour and depth of the sample after the fragment; unchanged if the fragment was rejected.
    pub after: SampleState,
}

impl FragmentRecord {
    /// Whether the fragment completely hides earlier fragments once it is written.
    pub(crate) fn covers_all(&self) -> bool {
        self.transparency != Transparency::Blended || self.alpha.is_some_and(|alpha| alpha >= 1.0)
    }
}

/// Intermediate values from which a fragment's colour was computed. Values that the draw plan skips are `None`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ShadingRecord {
    /// Texture coordinates (u, v), with v pointing down.
    pub uv: Option<[f32; 2]>,
    /// Unit normal, in world space.
    pub normal: Option<[f32; 3]>,
    /// Interpolated vertex colour, in the colour space of lighting.
    pub(crate) vertex_color: Option<[f32; 3]>,
    /// N·L, the cosine of the angle between the normal and the light direction.
    pub cosine: Option<f32>,
    /// Light factor, which multiplies the surface colour.
    pub light: Option<f32>,
    /// Specular factor max(0, N·H)^Ns, which multiplies the specular colour.
    pub highlight: Option<f32>,
    /// Emitted light, in the colour space of lighting.
    pub emission: Option<[f32; 3]>,
    /// Texels read from all maps of the material, with weights that sum to 1 for each map.
    pub texels: Vec<TexelRecord>,
    /// Framebuffer colour over which the fragment was blended, as sRGB codes; `None` without blending.
    pub below: Option<Rgba8>,
    /// Colour written to the framebuffer, as sRGB codes.
    pub color: Rgba8,
}

impl ShadingRecord {
    /// Returns the texels read from one texture map.
    pub(crate) fn texels_of(&self, map: TextureMap) -> impl Iterator<Item = &TexelRecord> {
        self.texels.iter().filter(move |texel| texel.map == map)
    }
}

choice! {
    /// Purpose of a texture in a material.
    pub TextureMap {
        Color = "color", "Colour", "Colour of the surface (`map_Kd`).";
        Opacity = "opacity", "Opacity", "Factor of the opacity, in alpha (`map_d`).";
        Normal = "normal", "Normal", "Tangent-space normal (`norm`, `map_Bump`).";
        Emission = "emission", "Emission", "Emitted light (`map_Ke`).";
    }
}

/// One texel read for a fragment.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TexelRecord {
    /// Texture map that contains the texel.
    pub map: TextureMap,
    /// Mip level: 0 is the full texture, and each further level has half the side lengths.
    pub level: usize,
    /// Position of the texel in the mip level, and its filter weight.
    #[serde(flatten)]
    pub tap: TexelTap,
    /// Colour of the texel, as 8-bit codes.
    pub color: Rgba8,
}

/// Drawn pixel that the upscaler read to compute the inspected pixel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SourceRecord {
    /// Position of the drawn pixel, and its weight in the upscaled pixel.
    #[serde(flatten)]
    pub tap: Tap,
    /// Replayed colour of the drawn pixel, as sRGB codes.
    pub color: Rgba8,
}

/// Anti-aliasing sample of a drawn pixel. The colour of the pixel is the mean of its samples.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SampleRecord {
    /// Position of the sample relative to the pixel's top-left corner, in px.
    pub place: [f64; 2],
    /// Replayed colour of the sample, as sRGB codes.
    pub color: Rgba8,
}

/// Report on one pixel of the full picture.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PixelReport {
    /// Column of the pixel in the full picture.
    pub x: u32,
    /// Row of the pixel in the full picture.
    pub y: u32,
    /// Short text that explains the pixel's colour.
    pub verdict: String,
    /// Replayed colour of the pixel, as sRGB codes.
    pub color: Rgba8,
    /// Pixel of the drawn picture whose fragments are listed: this pixel if it was drawn, or else the source with the
    /// largest weight.
    pub drawn_at: [u32; 2],
    /// Samples whose mean is the colour of the drawn pixel; empty without anti-aliasing.
    pub samples: Vec<SampleRecord>,
    /// Colour and depth of the sample at the pixel's centre before the first fragment.
    pub clear: SampleState,
    /// All fragments at the pixel's centre, in drawing order.
    pub fragments: Vec<FragmentRecord>,
    /// Triangles without a fragment at this pixel, each with its reason; filled in only by [`super::explain()`].
    pub absent: Vec<Absent>,
    /// Final depth in the depth buffer; `None` without a depth buffer.
    pub final_depth: Option<DepthRecord>,
    /// Drawn pixels from which this pixel is computed: only itself, with weight 1, if it was drawn.
    pub sources: Vec<SourceRecord>,
    /// Blending of the pixel with the history; `None` if the upscaler reads no history for it. `sources` does not
    /// include the history.
    pub history: Option<HistoryStep>,
    /// Contribution of earlier frames, as found by [`super::temporal::TemporalSearch`]; `None` until it is searched for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub temporal: Option<PixelHistory>,
    /// Colour of the pixel before the post filter; `None` without a post filter.
    pub unfiltered: Option<Rgba8>,
    /// Triangle whose edge the wireframe draws over this pixel, if any.
    pub(crate) wireframe: Option<TriangleId>,
    /// Crack or double hit along a shared edge at this pixel, if any; `None` for pixels that were not drawn.
    pub fault: Option<Fault>,
    /// Changes that repair the pixel, as found by [`super::remedy_search::remedies`]; empty until they are searched for.
    pub remedies: Vec<Remedy>,
}

impl PixelReport {
    /// Returns the colour and depth of the sample at the pixel's centre after its last fragment.
    pub fn last(&self) -> SampleState {
        self.fragments.last().map_or(self.clear, |fragment| fragment.after)
    }

    /// Returns the visible fragment; of several blended ones, the last written.
    pub fn visible(&self) -> Option<&FragmentRecord> {
        self.fragments.iter().find(|f| f.outcome == FragmentOutcome::Visible)
    }
}

/// Returns the centre of a pixel in the full picture, in px.
pub fn sample_position_px(x: u32, y: u32) -> [f32; 2] {
    [x, y].map(|c| to_pixels(i64::from(c) * SUBPIXELS + HALF_PIXEL))
}

#[cfg(test)]
mod tests {
    use crate::chain::{Recipe, run};
    use crate::inspect::inspect;
    use crate::pipeline::settings::Shading;
    use crate::pipeline::viewport::Viewport;
    use crate::scene::builtin;

    #[test]
    fn records_contain_only_values_that_the_shading_reads() {
        let scene = builtin::by_id("chess").unwrap().build();
        // Whether texture coordinates, normal, N·L and light are recorded, in that order.
        for (shading, expected) in [
            (Shading::TriangleId, [false, false, false, false]),
            (Shading::Uv, [true, false, false, false]),
            (Shading::Normals, [false, true, false, false]),
            (Shading::Lambert, [true, true, true, true]),
        ] {
            let mut recipe = Recipe::default();
            recipe.pipeline.shading = shading;
            let frame = run(&scene, &scene.home, &recipe, Viewport { width: 32, height: 24 }, &mut ());
            let reports = (0..32 * 24).filter_map(|i| inspect(&scene, &recipe, &frame, i % 32, i / 32));
            let records: Vec<_> = reports.filter_map(|r| r.visible()?.shading.clone()).collect();
            let reported: Vec<_> = records
                .iter()
                .map(|s| [s.uv.is_some(), s.normal.is_some(), s.cosine.is_some(), s.light.is_some()])
                .collect();
            assert!(reported.contains(&expected), "{shading:?}");
            // Meshes without texture coordinates record fewer values; no record contains additional values.
            assert!(reported.iter().flat_map(|t| t.iter().zip(expected)).all(|(t, e)| e || !t), "{shading:?}");
        }
    }
}
