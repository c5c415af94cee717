//! The story of one pixel: every fragment that touched it, who won and why, and how the colour came about.

use serde::Serialize;

use super::depth::DepthRecord;
use super::hits::{Fault, fault_at};
use super::verdict::{fault_verdict, verdict};
use crate::chain::{Frame, Recipe};
use crate::image::{Image, Rgba8};
use crate::math::fixed::{HALF_PIXEL, SUBPIXELS, to_pixels};
use crate::pipeline::depth::{Comparison, depth_at};
use crate::pipeline::framebuffer::Framebuffer;
use crate::pipeline::interpolate::{Fragment, affine_weights, attribute_weights};
use crate::pipeline::observe::{DepthOutcome, Observer};
use crate::pipeline::plan::{DrawPlan, Part};
use crate::pipeline::raster::{Sample, Scissor};
use crate::pipeline::sample::TexelTap;
use crate::pipeline::settings::{Arithmetic, Interpolation};
use crate::pipeline::shade::Shader;
use crate::pipeline::viewport::{ScreenTriangle, Viewport};
use crate::pipeline::{Extent, Until, draw, wireframe};
use crate::scene::material::CUT_OUT_BELOW;
use crate::scene::{Scene, Transparency, TriangleId};
use crate::upscale::{Drawn, Tap};

/// What became of a fragment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// It is what the pixel shows.
    Visible,
    /// It was written, and a later fragment covered it.
    Overwritten,
    /// It was written, and is seen through what was blended over it.
    BlendedOver,
    /// It lost the depth test.
    DepthRejected,
    /// The alpha of its texture says that it is not there.
    CutOut,
}

impl Outcome {
    /// Whether the fragment was written, seen in the end or not.
    pub fn is_written(self) -> bool {
        matches!(self, Self::Visible | Self::Overwritten | Self::BlendedOver)
    }
}

/// One fragment: a triangle that covers the sample.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FragmentRecord {
    /// Triangle of the scene.
    pub triangle: TriangleId,
    /// Name of the instance that it belongs to.
    pub instance: String,
    /// Position in the list of rasterized triangles.
    pub submission: usize,
    /// How its surface meets what was drawn before.
    pub transparency: Transparency,
    /// What became of it.
    pub outcome: Outcome,
    /// Why, in one sentence with the numbers that decided.
    pub reason: String,
    /// The numbers that coverage was decided in.
    pub arithmetic: Arithmetic,
    /// Corners in px, snapped in fixed point.
    pub corners_px: [[f32; 2]; 3],
    /// Edge values in the unit of their [`Sample`].
    pub edges: [f64; 3],
    /// Doubled area in the same unit.
    pub doubled_area: f64,
    /// Screen-space weights λ.
    pub affine_weights: [f32; 3],
    /// Weights that attributes are interpolated with.
    pub attribute_weights: [f32; 3],
    /// 1/w at the corners.
    pub inv_w: [f32; 3],
    /// Depth at the corners, before it is quantised.
    pub corner_depths: [f32; 3],
    /// Depth of the fragment, as it is stored if the fragment wins.
    pub depth: DepthRecord,
    /// What the depth buffer held before; `None` without a depth test.
    pub stored_depth: Option<DepthRecord>,
    /// The alpha that decided, of opacity and texture: whether a cut-out surface is there, or how much of what lies behind
    /// a blended one covers. `None` for opaque surfaces, and where it did not come to that.
    pub alpha: Option<f32>,
    /// Shading, if it came to that.
    pub shading: Option<ShadingRecord>,
}

impl FragmentRecord {
    /// Whether nothing that was drawn before is seen through it, if it is written.
    pub fn covers_all(&self) -> bool {
        self.transparency != Transparency::Blended || self.alpha.is_some_and(|alpha| alpha >= 1.0)
    }
}

/// How a fragment got its colour. What its draw leaves out is `None`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ShadingRecord {
    /// Texture coordinates, v down.
    pub uv: Option<[f32; 2]>,
    /// Unit normal, world space.
    pub normal: Option<[f32; 3]>,
    /// N·L.
    pub cosine: Option<f32>,
    /// The factor that light contributes.
    pub light: Option<f32>,
    /// Texels read, with their weights.
    pub texels: Vec<TexelRecord>,
    /// The colour that it was blended with.
    pub below: Option<Rgba8>,
    /// The colour that was written.
    pub color: Rgba8,
}

/// One texel that was read.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TexelRecord {
    /// Where, and its share.
    #[serde(flatten)]
    pub tap: TexelTap,
    /// Its codes.
    pub color: Rgba8,
}

/// A drawn pixel that an upscaler read.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SourceRecord {
    /// Where in the picture that was drawn, and its share.
    #[serde(flatten)]
    pub tap: Tap,
    /// Its replayed colour.
    pub color: Rgba8,
}

/// Everything about one pixel.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PixelReport {
    /// Column.
    pub x: u32,
    /// Row.
    pub y: u32,
    /// What happened, in one sentence.
    pub verdict: String,
    /// The colour that the replay arrives at.
    pub color: Rgba8,
    /// The pixel whose fragments are listed, in the picture that was drawn: this one if it was drawn itself, else the one
    /// with the largest share.
    pub drawn_at: [u32; 2],
    /// Every fragment there, in drawing order.
    pub fragments: Vec<FragmentRecord>,
    /// What the depth buffer holds in the end.
    pub final_depth: Option<DepthRecord>,
    /// The drawn pixels that this one was made of; one with weight 1 if it was drawn itself.
    pub sources: Vec<SourceRecord>,
    /// The triangle whose edge the wireframe draws over this pixel.
    pub wireframe: Option<TriangleId>,
    /// A crack or a double hit along a shared edge, if the pixel was drawn.
    pub fault: Option<Fault>,
}

impl PixelReport {
    /// The fragment that the pixel shows; if it is blended, the nearest of those that it shows.
    pub fn visible(&self) -> Option<&FragmentRecord> {
        self.fragments.iter().find(|f| f.outcome == Outcome::Visible)
    }
}

/// Replays pixel (x, y) of a frame. `None` outside of the picture.
pub fn inspect(scene: &Scene, recipe: &Recipe, frame: &Frame, x: u32, y: u32) -> Option<PixelReport> {
    let Viewport { width, height } = frame.viewport;
    if x >= width || y >= height {
        return None;
    }
    let (how, upscaler) = (recipe.upscaler, recipe.upscaler.upscaler());
    let taps = upscaler.taps(how, &Drawn::from(&frame.drawn.color), (width, height), (x, y));
    let sources: Vec<SourceRecord> =
        taps.into_iter().map(|tap| source(scene, recipe, frame, tap)).collect::<Option<_>>()?;
    let main = sources.iter().max_by(|a, b| a.tap.weight.total_cmp(&b.tap.weight))?.tap;
    let drawn_at = if frame.is_drawn(x, y) { (x, y) } else { (main.x, main.y) };
    let mut recorder = Recorder::new(scene, recipe, frame);
    let (_, final_depth) = replay(scene, recipe, frame, drawn_at, &mut recorder)?;

    let below = upscaler.pixel(how, &Drawn::from(&picture_of(&sources, frame)), (width, height), (x, y));
    let wireframe = recipe.wireframe.then(|| wireframe::crosses(frame.outlines(), (width, height), (x, y))).flatten();
    let color = if wireframe.is_some() { wireframe::line_color(below) } else { below };
    let mut report = PixelReport {
        x,
        y,
        verdict: String::new(),
        color,
        drawn_at: drawn_at.into(),
        fragments: recorder.finish(),
        final_depth: final_depth.map(|depth| DepthRecord::new(depth, frame.depth_scale())),
        sources,
        wireframe,
        fault: fault_at(frame, &recipe.pipeline, drawn_at.0, drawn_at.1).filter(|_| frame.is_drawn(x, y)),
    };
    let story = verdict(&report, frame.is_drawn(x, y), Comparison::of(&recipe.pipeline));
    let fault = report.fault.as_ref().map(|fault| fault_verdict(fault, &recipe.pipeline) + " ");
    report.verdict = fault.unwrap_or_default() + &story;
    Some(report)
}

fn source(scene: &Scene, recipe: &Recipe, frame: &Frame, tap: Tap) -> Option<SourceRecord> {
    let (color, _) = replay(scene, recipe, frame, (tap.x, tap.y), &mut ())?;
    Some(SourceRecord { tap, color })
}

/// What was drawn, as far as the replayed sources tell: all that the upscaler may look at.
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

/// Draws the sample of one drawn pixel alone: its colour and its stored depth.
fn replay<O: Observer>(
    scene: &Scene,
    recipe: &Recipe,
    frame: &Frame,
    (x, y): (u32, u32),
    observer: &mut O,
) -> Option<(Rgba8, Option<f32>)> {
    let grid = frame.drawn.grid;
    let sample = grid.sample_at(x, y)?;
    let mut one = Framebuffer::one_sample(grid, sample, scene.background, &recipe.pipeline);
    let extent = Extent { triangles: 0..frame.geometry.triangles.len(), scissor: Scissor::pixel(x, y) };
    draw(scene, &frame.geometry, &recipe.pipeline, &extent, Until::Shade, &mut one, observer);
    Some((one.color.at(0, 0), one.depth.map(|d| d.at(0, 0))))
}

/// Writes down every fragment of a replay.
struct Recorder<'a> {
    scene: &'a Scene,
    shaders: Vec<Shader<'a>>,
    frame: &'a Frame,
    comparison: Comparison,
    arithmetic: Arithmetic,
    interpolation: Interpolation,
    records: Vec<FragmentRecord>,
    /// What has been drawn so far.
    color: Rgba8,
}

impl<'a> Recorder<'a> {
    fn new(scene: &'a Scene, recipe: &'a Recipe, frame: &'a Frame) -> Self {
        let shaders = scene.instances.iter().zip(&frame.plans);
        let [r, g, b] = scene.background;
        Self {
            scene,
            shaders: shaders.map(|(i, plan)| Shader::new(&recipe.pipeline, &scene.library, i, plan)).collect(),
            frame,
            comparison: Comparison::of(&recipe.pipeline),
            arithmetic: recipe.pipeline.arithmetic,
            interpolation: recipe.pipeline.interpolation,
            records: Vec::new(),
            color: [r, g, b, 255],
        }
    }

    /// The fragments with their outcomes: of those that were written, the last one is visible, and those before it are seen
    /// through it down to the first that covers all.
    fn finish(mut self) -> Vec<FragmentRecord> {
        let written: Vec<usize> = (0..self.records.len()).filter(|i| self.records[*i].outcome.is_written()).collect();
        let mut is_covered = false;
        for pair in written.windows(2).rev() {
            let next = &self.records[pair[1]];
            is_covered |= next.covers_all();
            let ending = match next.alpha.filter(|_| next.transparency == Transparency::Blended) {
                Some(alpha) => format!("blended over by triangle {} with alpha {alpha}", next.triangle.0),
                None => format!("replaced by triangle {} at depth {}", next.triangle.0, next.depth),
            };
            let previous = &mut self.records[pair[0]];
            previous.outcome = if is_covered { Outcome::Overwritten } else { Outcome::BlendedOver };
            previous.reason = format!("{}, then {ending}", verb(previous.transparency));
        }
        self.records
    }

    fn depth(&self, stored: f32) -> DepthRecord {
        DepthRecord::new(stored, self.frame.depth_scale())
    }
}

impl Observer for Recorder<'_> {
    fn covered(&mut self, triangle: &ScreenTriangle, sample: &Sample) {
        let submission = self.frame.geometry.place_of(triangle);
        let transparency = self.frame.plans[triangle.instance as usize].transparency();
        self.records.push(FragmentRecord {
            triangle: triangle.id,
            instance: self.scene.instances[triangle.instance as usize].name.clone(),
            submission,
            transparency,
            outcome: Outcome::Visible,
            reason: format!("{}: there is no depth test", verb(transparency)),
            arithmetic: self.arithmetic,
            corners_px: match self.arithmetic {
                Arithmetic::Fixed => triangle.snapped_px(),
                Arithmetic::F32 | Arithmetic::F64 | Arithmetic::Exact => triangle.corners_px(),
            },
            edges: sample.edges,
            doubled_area: triangle.doubled_area,
            affine_weights: affine_weights(triangle, sample),
            attribute_weights: attribute_weights(triangle, sample, self.interpolation),
            inv_w: triangle.vertices.each_ref().map(|v| v.inv_w),
            corner_depths: triangle.vertices.each_ref().map(|v| v.depth as f32),
            depth: self.depth(depth_at(triangle, sample)),
            stored_depth: None,
            alpha: None,
            shading: None,
        });
    }

    fn depth_tested(&mut self, _triangle: &ScreenTriangle, _sample: &Sample, outcome: DepthOutcome) {
        let [new, stored] = [outcome.new, outcome.stored].map(|depth| self.depth(depth));
        let Some(record) = self.records.last_mut() else { return };
        record.stored_depth = Some(stored);
        let (symbol, verb) = (self.comparison.symbol(), verb(record.transparency));
        if outcome.passed {
            record.reason = match self.comparison {
                Comparison::Always => format!("{verb}: the test lets everything pass ({new} over {stored})"),
                _ => format!("{verb}: {new} {symbol} {stored}"),
            };
        } else {
            record.outcome = Outcome::DepthRejected;
            record.reason = format!("lost the depth test: not {new} {symbol} {stored}");
        }
    }

    fn cut_out(&mut self, triangle: &ScreenTriangle, fragment: &Fragment) {
        let alpha = self.shaders[triangle.instance as usize].alpha(fragment);
        let Some(record) = self.records.last_mut() else { return };
        record.alpha = Some(alpha);
        record.outcome = Outcome::CutOut;
        record.reason = format!("cut out: alpha {alpha} < {CUT_OUT_BELOW}");
    }

    fn shaded(&mut self, triangle: &ScreenTriangle, fragment: &Fragment, color: Rgba8) {
        let instance = triangle.instance as usize;
        let (shader, plan) = (&self.shaders[instance], &self.frame.plans[instance]);
        let below = std::mem::replace(&mut self.color, color);
        let Some(record) = self.records.last_mut() else { return };
        let mut shading = shading_record(shader, plan, fragment, color);
        record.alpha = (record.transparency != Transparency::Opaque).then(|| shader.alpha(fragment));
        shading.below = (record.transparency == Transparency::Blended).then_some(below);
        record.shading = Some(shading);
    }
}

/// What is done with a fragment that passes.
fn verb(transparency: Transparency) -> &'static str {
    if transparency == Transparency::Blended { "blended" } else { "written" }
}

fn shading_record(shader: &Shader<'_>, plan: &DrawPlan, fragment: &Fragment, color: Rgba8) -> ShadingRecord {
    let lit = plan.runs(Part::Light);
    let texels = shader.texture_for(fragment).map_or_else(Vec::new, |texture| {
        let (taps, count) = shader.sampler().taps(texture.size(), fragment.uv);
        taps[..count].iter().map(|tap| TexelRecord { tap: *tap, color: texture.at(tap.x, tap.y) }).collect()
    });
    ShadingRecord {
        uv: plan.runs(Part::TextureCoordinates).then(|| fragment.uv.into()),
        normal: plan.runs(Part::Normals).then(|| shader.unit_normal(fragment).into()),
        cosine: lit.then(|| shader.cosine(fragment)),
        light: lit.then(|| shader.light(fragment)),
        texels,
        below: None,
        color,
    }
}

/// Where the sample of a full-picture pixel lies, in px.
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
    fn a_record_tells_only_what_its_shading_reads() {
        let scene = builtin::by_id("chess").unwrap().build();
        // Which of texture coordinates, normal, N·L and light there are.
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
            let told: Vec<_> = records
                .iter()
                .map(|s| [s.uv.is_some(), s.normal.is_some(), s.cosine.is_some(), s.light.is_some()])
                .collect();
            assert!(told.contains(&expected), "{shading:?}");
            // Meshes without texture coordinates tell less, none tells more.
            assert!(told.iter().flat_map(|t| t.iter().zip(expected)).all(|(t, e)| e || !t), "{shading:?}");
        }
    }
}
