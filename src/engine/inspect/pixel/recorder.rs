//! Observer that records every fragment while one pixel is replayed.

use super::{FragmentOutcome, FragmentRecord, SampleState, ShadingRecord, TexelRecord, TextureMap};
use crate::chain::{Frame, Recipe};
use crate::image::Rgba8;
use crate::inspect::depth::DepthRecord;
use crate::pipeline::depth::{DepthComparison, clear_value};
use crate::pipeline::footprint::TextureRead;
use crate::pipeline::interpolate::{Fragment, affine_weights, attribute_weights};
use crate::pipeline::observe::{DepthOutcome, Observer};
use crate::pipeline::plan::{DrawPlan, PipelinePart};
use crate::pipeline::raster::RasterSample;
use crate::pipeline::sample::{Sampler, TexelTap};
use crate::pipeline::screen_triangle::{ScreenTriangle, depth_at};
use crate::pipeline::settings::{Arithmetic, Choice as _, DepthTest, Interpolation};
use crate::pipeline::shade::{NormalMap, Readable, Shader};
use crate::scene::{Scene, Transparency};

/// Observer that records every fragment at the sample of a replayed pixel.
pub(super) struct FragmentRecorder<'a> {
    scene: &'a Scene,
    shaders: Vec<Shader<'a>>,
    frame: &'a Frame,
    comparison: DepthComparison,
    arithmetic: Arithmetic,
    interpolation: Interpolation,
    records: Vec<FragmentRecord>,
    /// Colour and depth of the sample before the first fragment.
    pub(super) clear: SampleState,
    /// Colour and depth of the sample after the fragments recorded so far.
    state: SampleState,
}

impl<'a> FragmentRecorder<'a> {
    /// Creates a recorder for a pixel of `frame`, which was drawn from `scene` with `recipe`.
    pub(super) fn new(scene: &'a Scene, recipe: &'a Recipe, frame: &'a Frame) -> Self {
        let shaders = scene.instances.iter().zip(frame.plans.iter());
        let [r, g, b] = recipe.pipeline.background.resolve(scene.background);
        let has_depth = recipe.pipeline.depth_test != DepthTest::Off;
        let depth = has_depth.then(|| DepthRecord::new(clear_value(&recipe.pipeline), frame.depth_scale()));
        let clear = SampleState { color: [r, g, b, 255], depth };
        Self {
            scene,
            shaders: shaders.map(|(i, plan)| Shader::new(&recipe.pipeline, &scene.library, i, plan)).collect(),
            frame,
            comparison: DepthComparison::of(&recipe.pipeline),
            arithmetic: recipe.pipeline.arithmetic,
            interpolation: recipe.pipeline.interpolation,
            records: Vec::new(),
            clear,
            state: clear,
        }
    }

    /// Returns the recorded fragments with their final outcomes. The last written fragment is visible. An earlier
    /// written fragment is overwritten if a fragment written after it hides it completely; otherwise it is blended
    /// over.
    pub(super) fn finish(mut self) -> Vec<FragmentRecord> {
        let written: Vec<usize> = (0..self.records.len()).filter(|i| self.records[*i].outcome.is_written()).collect();
        let mut is_covered = false;
        for pair in written.windows(2).rev() {
            let next = &self.records[pair[1]];
            is_covered |= next.covers_all();
            let ending = match next.alpha.filter(|_| next.transparency == Transparency::Blended) {
                Some(alpha) => format!("blended over by triangle {} with alpha {alpha}", next.triangle.0),
                None => format!("overwritten by triangle {} at depth {}", next.triangle.0, next.depth),
            };
            let previous = &mut self.records[pair[0]];
            previous.outcome = if is_covered { FragmentOutcome::Overwritten } else { FragmentOutcome::BlendedOver };
            previous.reason = format!("{}, then {ending}", verb(previous.transparency));
        }
        self.records
    }

    fn depth(&self, stored: f32) -> DepthRecord {
        DepthRecord::new(stored, self.frame.depth_scale())
    }
}

impl Observer for FragmentRecorder<'_> {
    fn covered(&mut self, triangle: &ScreenTriangle, sample: &RasterSample) {
        let submission = self.frame.geometry().index_of(triangle);
        let transparency = self.frame.plans[triangle.instance as usize].transparency();
        self.records.push(FragmentRecord {
            triangle: triangle.id,
            instance: self.scene.instances[triangle.instance as usize].name.clone(),
            submission,
            transparency,
            outcome: FragmentOutcome::Visible,
            reason: format!("{}: the depth test is off", verb(transparency)),
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
            depth_bias: self.frame.geometry().depth_scale.bias_of(&triangle.vertices).map(|bias| bias.offset as f32),
            depth: self.depth(depth_at(triangle, sample)),
            stored_depth: None,
            alpha: None,
            shading: None,
            before: self.state,
            after: self.state,
        });
    }

    fn depth_tested(&mut self, _triangle: &ScreenTriangle, _sample: &RasterSample, outcome: DepthOutcome) {
        let [new, stored] = [outcome.new, outcome.stored].map(|depth| self.depth(depth));
        let Some(record) = self.records.last_mut() else { return };
        record.stored_depth = Some(stored);
        let (symbol, verb) = (self.comparison.symbol(), verb(record.transparency));
        if outcome.passed {
            record.reason = match self.comparison {
                DepthComparison::Always => format!("{verb}: the depth test always passes ({new} over {stored})"),
                _ => format!("{verb}: {new} {symbol} {stored}"),
            };
        } else {
            record.outcome = FragmentOutcome::DepthRejected;
            record.reason = if outcome.new == outcome.stored {
                format!("failed the depth test: {new} equals the stored depth, and the test is {symbol}")
            } else {
                format!("failed the depth test: not {new} {symbol} {stored}")
            };
        }
    }

    fn depth_stored(&mut self, _triangle: &ScreenTriangle, _sample: &RasterSample) {
        let Some(record) = self.records.last_mut() else { return };
        self.state.depth = Some(record.depth);
        record.after = self.state;
    }

    fn alpha_rejected(&mut self, triangle: &ScreenTriangle, fragment: &Fragment) {
        let shader = &self.shaders[triangle.instance as usize];
        let (alpha, cutoff) = (shader.alpha(fragment), shader.alpha_cutoff());
        let Some(record) = self.records.last_mut() else { return };
        record.alpha = Some(alpha);
        record.outcome = FragmentOutcome::AlphaRejected;
        record.reason = format!("failed the alpha test: alpha {alpha} < {cutoff}");
    }

    fn shaded(&mut self, triangle: &ScreenTriangle, fragment: &Fragment, color: Rgba8) {
        let instance = triangle.instance as usize;
        let (shader, plan) = (&self.shaders[instance], &self.frame.plans[instance]);
        let below = std::mem::replace(&mut self.state.color, color);
        let Some(record) = self.records.last_mut() else { return };
        record.after = self.state;
        let mut shading = shading_record(shader, plan, fragment, color);
        record.alpha = (record.transparency != Transparency::Opaque).then(|| shader.alpha(fragment));
        shading.below = (record.transparency == Transparency::Blended).then_some(below);
        record.shading = Some(shading);
    }
}

/// Returns the past-tense verb for a fragment that passes its tests: "blended" or "written".
fn verb(transparency: Transparency) -> &'static str {
    if transparency == Transparency::Blended { "blended" } else { "written" }
}

/// Returns the texture and the sampler that the shader uses for one map of a fragment; `None` if it reads no texture.
fn texture_of<'a>(map: TextureMap, shader: &Shader<'a>, fragment: &Fragment) -> Option<(Readable<'a>, Sampler)> {
    let texture = match map {
        TextureMap::Color => shader.texture_for(fragment),
        TextureMap::Opacity => shader.alpha_texture(),
        TextureMap::Normal => return shader.normal_map().map(NormalMap::texture),
        TextureMap::Emission => shader.emission_texture(),
    };
    texture.map(|texture| (texture, shader.sampler()))
}

/// Returns the texels that the sampler reads from one map for a fragment, with their filter weights.
fn texels_of(map: TextureMap, texture: Readable<'_>, sampler: Sampler, fragment: &Fragment) -> Vec<TexelRecord> {
    let reads = texture.reads(fragment);
    let of_read = |TextureRead { uv, level, share, .. }| {
        let image = texture.level(level);
        let (taps, count) = sampler.taps(image.size(), uv);
        taps.into_iter().take(count).map(move |tap| {
            let tap = TexelTap { weight: tap.weight * share / reads.probes as f32, ..tap };
            TexelRecord { map, level, tap, color: image.at(tap.x, tap.y) }
        })
    };
    reads.all(fragment.uv).flat_map(of_read).collect()
}

fn shading_record(shader: &Shader<'_>, plan: &DrawPlan, fragment: &Fragment, color: Rgba8) -> ShadingRecord {
    let lit = plan.runs(PipelinePart::Light);
    let read = |map: &TextureMap| {
        let (texture, sampler) = texture_of(*map, shader, fragment)?;
        Some(texels_of(*map, texture, sampler, fragment))
    };
    let texels = TextureMap::ALL.iter().filter_map(read).flatten().collect();
    ShadingRecord {
        uv: plan.runs(PipelinePart::TextureCoordinates).then(|| fragment.uv.into()),
        normal: plan.runs(PipelinePart::Normals).then(|| shader.unit_normal(fragment).into()),
        vertex_color: plan.runs(PipelinePart::VertexColors).then(|| fragment.color.into()),
        cosine: lit.then(|| shader.cosine(fragment)),
        light: lit.then(|| shader.light(fragment)),
        highlight: plan.runs(PipelinePart::Highlight).then(|| shader.highlight_factor(fragment)),
        emission: plan.runs(PipelinePart::Emission).then(|| shader.emitted(fragment).into()),
        texels,
        below: None,
        color,
    }
}
