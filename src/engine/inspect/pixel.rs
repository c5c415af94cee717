//! Report on one pixel: every fragment with its outcome and reason, and the computation of the final colour.

mod recorder;

use serde::Serialize;

use self::recorder::FragmentRecorder;
use super::depth::DepthRecord;
use super::history::{Absent, SampleState};
use super::hits::{Fault, fault_at};
use super::remedy::Remedy;
use super::temporal::PixelHistory;
use super::verdict::verdict;
use crate::antialias::{post, resolve};
use crate::chain::{Frame, Recipe, replay, samples};
use crate::image::{Image, Rgba8};
use crate::math::fixed::{HALF_PIXEL, SUBPIXELS, to_pixels};
use crate::pipeline::framebuffer::Framebuffer;
use crate::pipeline::observe::Observer;
use crate::pipeline::raster::Scissor;
use crate::pipeline::sample::TexelTap;
use crate::pipeline::settings::{Arithmetic, Choice, choice};
use crate::pipeline::viewport::Viewport;
use crate::pipeline::{DrawCall, Extent, wireframe};
use crate::scene::{Scene, Transparency, TriangleId};
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
    /// Triangles without a fragment at this pixel, each with its reason; filled in only by [`super::history::explain`].
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
    /// Changes that repair the pixel, as found by [`super::remedy::remedies`]; empty until they are searched for.
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

/// Replays pixel (x, y) of a frame and explains its colour. Returns `None` outside the picture.
///
/// # Examples
/// ```
/// use rasterscope_engine::chain::{Recipe, run};
/// use rasterscope_engine::inspect::{FragmentOutcome, inspect};
/// # use rasterscope_engine::pipeline::viewport::Viewport;
/// # use rasterscope_engine::scene::builtin;
///
/// let scene = builtin::by_id("interpenetrating").unwrap().build();
/// let (recipe, viewport) = (Recipe::default(), Viewport { width: 64, height: 36 });
/// let frame = run(&scene, &scene.home, &recipe, viewport, &mut ());
///
/// // Both triangles cover the pixel, and the one drawn last is nearer.
/// let report = inspect(&scene, &recipe, &frame, 32, 18).unwrap();
/// assert_eq!(report.color, frame.image().at(32, 18));
/// assert_eq!(report.fragments.len(), 2);
/// assert_eq!(report.fragments[0].outcome, FragmentOutcome::Overwritten);
/// assert_eq!(report.fragments[1].outcome, FragmentOutcome::Visible);
/// ```
pub fn inspect(scene: &Scene, recipe: &Recipe, frame: &Frame, x: u32, y: u32) -> Option<PixelReport> {
    let mut report = replayed(scene, recipe, frame, x, y)?;
    report.verdict = verdict(&report, scene, recipe, frame);
    Some(report)
}

/// Replays pixel (x, y) and returns its report with an empty verdict; `None` outside the picture.
pub(super) fn replayed(scene: &Scene, recipe: &Recipe, frame: &Frame, x: u32, y: u32) -> Option<PixelReport> {
    let Viewport { width, height } = frame.viewport;
    if x >= width || y >= height {
        return None;
    }
    let (how, upscaler) = (recipe.upscaler, recipe.upscaler.upscaler());
    let taps = upscaler.taps(how, &frame.as_drawn(&frame.drawn.color), (width, height), (x, y));
    let pixels: Vec<_> = taps.iter().map(|tap| (tap.x, tap.y)).collect();
    let replayed = replay::replay(scene, recipe, frame, &pixels);
    let sources: Vec<_> = taps.into_iter().zip(&replayed).map(|(tap, samples)| source(frame, tap, samples)).collect();
    let main = (0..sources.len()).max_by(|a, b| sources[*a].tap.weight.total_cmp(&sources[*b].tap.weight));
    // A frame of at most 2 × 2 pixels may draw no pixel at all. All its pixels then come from the history.
    let drawn_at = main.filter(|_| !frame.is_drawn(x, y)).map_or((x, y), |main| pixels[main]);
    let samples = pixels.iter().position(|pixel| *pixel == drawn_at).map_or_else(Vec::new, |place| {
        let places = samples::places(frame.antialias, drawn_at);
        places.into_iter().zip(&replayed[place]).map(|(place, color)| SampleRecord { place, color: *color }).collect()
    });
    let mut recorder = FragmentRecorder::new(scene, recipe, frame);
    let final_depth = replay(scene, recipe, frame, drawn_at, &mut recorder).flatten();

    let upscaled = if upscaler.is_opaque() {
        frame.unfiltered().at(x, y)
    } else {
        upscaler.pixel(how, &frame.as_drawn(&picture_of(&sources, frame)), (width, height), (x, y))
    };
    let filtered = filtered(recipe, frame, (x, y), upscaled);
    let below = filtered.unwrap_or(upscaled);
    let wireframe = recipe.wireframe.then(|| wireframe::crosses(frame.outlines(), (width, height), (x, y))).flatten();
    let color = if wireframe.is_some() { wireframe::line_color(below) } else { below };
    Some(PixelReport {
        x,
        y,
        verdict: String::new(),
        color,
        drawn_at: drawn_at.into(),
        samples: if frame.antialias.is_off() { Vec::new() } else { samples },
        clear: recorder.clear,
        fragments: recorder.finish(),
        absent: Vec::new(),
        final_depth: final_depth.map(|depth| DepthRecord::new(depth, frame.depth_scale())),
        sources,
        history: upscaler.history_steps(how, &frame.as_drawn(&frame.drawn.color))((x, y)),
        temporal: None,
        unfiltered: filtered.map(|_| upscaled),
        wireframe,
        fault: fault_at(frame, &recipe.pipeline, drawn_at.0, drawn_at.1).filter(|_| frame.is_drawn(x, y)),
        remedies: Vec::new(),
    })
}

fn source(frame: &Frame, tap: Tap, samples: &[Rgba8]) -> SourceRecord {
    let color = match samples {
        [only] if frame.antialias.is_off() => *only,
        samples => resolve::mean(samples, frame.antialias.light),
    };
    SourceRecord { tap, color }
}

/// Returns the colour of a pixel after the post filter, computed from its replayed colour `own` and its neighbours in
/// the frame; `None` without a filter.
fn filtered(recipe: &Recipe, frame: &Frame, (x, y): (u32, u32), own: Rgba8) -> Option<Rgba8> {
    let reach = i64::from(post::reach(&recipe.post)?);
    let around = |at: u32| (i64::from(at) - reach, 2 * reach as u32 + 1);
    let ((left, width), (top, height)) = (around(x), around(y));
    let neighbours = Image::from_fn(width, height, |column, row| {
        let (i, j) = (left + i64::from(column), top + i64::from(row));
        let is_own = |at: i64, length: u32, own: u32| at.clamp(0, i64::from(length) - 1) == i64::from(own);
        if is_own(i, frame.viewport.width, x) && is_own(j, frame.viewport.height, y) {
            own
        } else {
            frame.unfiltered().at_clamped(i, j)
        }
    });
    post::apply(&recipe.post, &neighbours, None).map(|patch| patch.at(reach as u32, reach as u32))
}

/// Returns the packed drawn picture with only the replayed sources filled in. The upscaler reads no other pixels.
fn picture_of(sources: &[SourceRecord], frame: &Frame) -> Image<Rgba8> {
    let (width, height) = frame.drawn.color.size();
    let mut picture = Image::filled(width, height, [0; 4]);
    for source in sources {
        if let Some((column, row)) = frame.drawn.grid.sample_at(source.tap.x, source.tap.y) {
            picture.set(column, row, source.color);
        }
    }
    picture
}

/// Draws only the sample at the centre of one drawn pixel and returns its colour.
pub(super) fn centre_color(scene: &Scene, recipe: &Recipe, frame: &Frame, pixel: (u32, u32)) -> Option<Rgba8> {
    Some(draw_centre(scene, recipe, frame, pixel, &mut ())?.color.at(0, 0))
}

/// Draws only the sample at the centre of one drawn pixel with an observer, and returns its final depth, if any.
fn replay<O: Observer>(
    scene: &Scene,
    recipe: &Recipe,
    frame: &Frame,
    pixel: (u32, u32),
    observer: &mut O,
) -> Option<Option<f32>> {
    let one = draw_centre(scene, recipe, frame, pixel, observer)?;
    Some(one.depth.map(|d| d.at(0, 0)))
}

fn draw_centre<O: Observer>(
    scene: &Scene,
    recipe: &Recipe,
    frame: &Frame,
    (x, y): (u32, u32),
    observer: &mut O,
) -> Option<Framebuffer> {
    let grid = frame.drawn.grid;
    let sample = grid.sample_at(x, y)?;
    let mut one = Framebuffer::one_sample(grid, sample, scene.background, &recipe.pipeline);
    let extent = Extent { triangles: 0..frame.geometry().triangles.len(), scissor: Scissor::pixel(x, y) };
    DrawCall::new(scene, frame.geometry(), &recipe.pipeline, &extent).draw(&mut one, observer);
    Some(one)
}

/// Returns the centre of a pixel in the full picture, in px.
pub fn sample_position_px(x: u32, y: u32) -> [f32; 2] {
    [x, y].map(|c| to_pixels(i64::from(c) * SUBPIXELS + HALF_PIXEL))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::run;
    use crate::pipeline::settings::Shading;
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
