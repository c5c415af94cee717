//! Intermediate values of the pipeline, from triangle to colour, as buffers over the whole picture.
//!
//! The frame is drawn again with an observer. The last written fragment of each sample provides the value, computed by
//! the same functions that draw.

use super::view::{Range, Value};
use crate::chain::{Frame, Recipe, redraw};
use crate::image::{Image, Rgba8};
use crate::pipeline::LastStage;
use crate::pipeline::depth::DepthScale;
use crate::pipeline::depth_format::DepthEncoding;
use crate::pipeline::interpolate::{Fragment, affine_weights, uv_gradient};
use crate::pipeline::observe::Observer;
use crate::pipeline::plan::{DrawPlan, PipelinePart};
use crate::pipeline::raster::{AnyTriangle, RasterSample};
use crate::pipeline::screen_triangle::{ScreenTriangle, depth_at};
use crate::pipeline::settings::{Choice, Settings, choice};
use crate::pipeline::shade::Shader;
use crate::scene::Scene;

choice! {
    /// An intermediate value of the pipeline that can be displayed as a buffer.
    pub Intermediate {
        Edge0 = "edge-0", "Edge value 0", "Edge function opposite to corner 0: positive inside, 0 on the edge; in 1/65536 px² (fixed point) or px² times a power of two.";
        Edge1 = "edge-1", "Edge value 1", "Edge function opposite to corner 1: positive inside, 0 on the edge; in 1/65536 px² (fixed point) or px² times a power of two.";
        Edge2 = "edge-2", "Edge value 2", "Edge function opposite to corner 2: positive inside, 0 on the edge; in 1/65536 px² (fixed point) or px² times a power of two.";
        Lambda0 = "lambda-0", "λ0 on screen", "Screen-space weight of corner 0: its edge value divided by twice the triangle’s area.";
        Lambda1 = "lambda-1", "λ1 on screen", "Screen-space weight of corner 1: its edge value divided by twice the triangle’s area.";
        Lambda2 = "lambda-2", "λ2 on screen", "Screen-space weight of corner 2: its edge value divided by twice the triangle’s area.";
        Weight0 = "weight-0", "Weight 0", "Weight of corner 0 in the interpolation of attributes.";
        Weight1 = "weight-1", "Weight 1", "Weight of corner 1 in the interpolation of attributes.";
        Weight2 = "weight-2", "Weight 2", "Weight of corner 2 in the interpolation of attributes.";
        InvW = "inv-w", "1/w", "Reciprocal of the view distance; varies linearly in screen space.";
        Distance = "distance", "View distance", "Distance along the view axis, in world units; 1 without perspective.";
        Depth = "fragment-depth", "Fragment depth", "Depth of the fragment in the format of the depth buffer, also for blended fragments.";
        DepthSlope = "depth-slope", "Depth per pixel", "Depth difference to the right neighbour on the same triangle, in steps of the depth buffer; 0 if both depths are equal.";
        DepthStep = "depth-step", "Depth resolution", "Distance to the next depth that can be stored, in world units: surfaces closer together may tie.";
        U = "u", "u", "The first texture coordinate, before addressing.";
        V = "v", "v", "The second texture coordinate, downwards, before addressing.";
        DuDx = "du-dx", "du/dx", "Change in u from a pixel to its right neighbour.";
        DvDx = "dv-dx", "dv/dx", "Change in v from a pixel to its right neighbour.";
        DuDy = "du-dy", "du/dy", "Change in u from a pixel to the one below.";
        DvDy = "dv-dy", "dv/dy", "Change in v from a pixel to the one below.";
        Footprint = "footprint", "Texels per pixel", "Longer side of a pixel's footprint on the texture, in texels; above 1, texels are skipped.";
        Cosine = "cosine", "N·L", "Cosine of the angle between normal and light direction.";
        Light = "light", "Light", "Factor by which light multiplies the surface colour.";
        Alpha = "alpha", "Alpha", "Opacity with which the fragment covers the surfaces behind it.";
    }
}

/// Returns the interpolated 1/w of a triangle at a sample.
pub(crate) fn inv_w_at(triangle: &ScreenTriangle, sample: &RasterSample) -> f32 {
    let lambda = affine_weights(triangle, sample);
    lambda.iter().zip(&triangle.vertices).map(|(lambda, vertex)| lambda * vertex.inv_w).sum()
}

/// One intermediate value at every sample of a frame.
#[derive(Clone, Debug)]
pub struct Captured {
    /// The intermediate value that was captured.
    pub which: Intermediate,
    /// Values in the packed layout of the frame's framebuffer; `None` where nothing was drawn or the value was not
    /// computed.
    pub(crate) values: Image<Option<f32>>,
}

impl Captured {
    /// Returns the captured value at a pixel of the full picture.
    pub fn value(&self, frame: &Frame, x: u32, y: u32) -> Value {
        let Some((column, row)) = frame.sample_at(x, y) else { return Value::NotDrawn };
        self.values.at(column, row).map_or(Value::Nothing, Value::Number)
    }

    /// Returns the range of the finite values, which the colour map spans; `None` if there are none.
    pub fn range(&self) -> Option<Range> {
        Range::fit(self.values.pixels().iter().filter_map(|value| *value))
    }
}

/// Draws the frame again and records one intermediate value at every sample.
pub fn capture(scene: &Scene, recipe: &Recipe, frame: &Frame, which: Intermediate) -> Captured {
    let (width, height) = frame.drawn.color.size();
    let shaders = scene.instances.iter().zip(frame.plans.iter());
    let mut capture = Capture {
        which,
        settings: &recipe.pipeline,
        scale: frame.depth_scale(),
        shaders: shaders.map(|(i, plan)| Shader::new(&recipe.pipeline, &scene.library, i, plan)).collect(),
        plans: &frame.plans,
        edges: None,
        values: Image::filled(width, height, None),
    };
    redraw(scene, recipe, frame, LastStage::Shade, &mut capture);
    Captured { which, values: capture.values }
}

/// An observer that records one intermediate value of each shaded fragment.
struct Capture<'a> {
    which: Intermediate,
    settings: &'a Settings,
    scale: &'a DepthScale,
    shaders: Vec<Shader<'a>>,
    plans: &'a [DrawPlan],
    /// Triangle of the previous fragment and its edge functions, cached for the next fragment.
    edges: Option<(ScreenTriangle, AnyTriangle)>,
    values: Image<Option<f32>>,
}

impl Capture<'_> {
    fn value(&mut self, triangle: &ScreenTriangle, fragment: &Fragment) -> Option<f32> {
        let sample = &fragment.sample;
        let instance = triangle.instance as usize;
        let shader = &self.shaders[instance];
        let has = |part| self.plans[instance].runs(part);
        let uv = |value: f32| has(PipelinePart::TextureCoordinates).then_some(value);
        let lambda = || affine_weights(triangle, sample);
        let arithmetic = self.settings.arithmetic;
        let gradient = || has(PipelinePart::TextureCoordinates).then(|| uv_gradient(triangle, sample, arithmetic));
        match self.which {
            Intermediate::Edge0 => Some(sample.edges[0] as f32),
            Intermediate::Edge1 => Some(sample.edges[1] as f32),
            Intermediate::Edge2 => Some(sample.edges[2] as f32),
            Intermediate::Lambda0 => Some(lambda()[0]),
            Intermediate::Lambda1 => Some(lambda()[1]),
            Intermediate::Lambda2 => Some(lambda()[2]),
            Intermediate::Weight0 => Some(fragment.weights[0]),
            Intermediate::Weight1 => Some(fragment.weights[1]),
            Intermediate::Weight2 => Some(fragment.weights[2]),
            Intermediate::InvW => Some(inv_w_at(triangle, sample)),
            Intermediate::Distance => Some(1.0 / inv_w_at(triangle, sample)),
            Intermediate::Depth => Some(depth_at(triangle, sample)),
            Intermediate::DepthSlope => self.depth_slope(triangle, sample),
            Intermediate::DepthStep => Some(self.scale.resolution(depth_at(triangle, sample)) as f32),
            Intermediate::U => uv(fragment.uv.x),
            Intermediate::V => uv(fragment.uv.y),
            Intermediate::DuDx => Some(gradient()?[0].x),
            Intermediate::DvDx => Some(gradient()?[0].y),
            Intermediate::DuDy => Some(gradient()?[1].x),
            Intermediate::DvDy => Some(gradient()?[1].y),
            Intermediate::Footprint => {
                let (width, height) = shader.texture_for(fragment)?.level(0).size();
                let texels = glam::Vec2::new(width as f32, height as f32);
                gradient()?.into_iter().map(|change| (change * texels).length()).reduce(f32::max)
            }
            Intermediate::Cosine => has(PipelinePart::Normals).then(|| shader.cosine(fragment)),
            Intermediate::Light => has(PipelinePart::Light).then(|| shader.light(fragment)),
            Intermediate::Alpha => Some(shader.alpha(fragment)),
        }
    }

    /// Returns the change in depth from the sample to its right neighbour, in signed steps of the depth buffer; `None`
    /// if the triangle has no area.
    fn depth_slope(&mut self, triangle: &ScreenTriangle, sample: &RasterSample) -> Option<f32> {
        let Settings { arithmetic, fill_rule, .. } = *self.settings;
        if self.edges.as_ref().is_none_or(|(known, _)| known != triangle) {
            self.edges = Some((*triangle, AnyTriangle::new(arithmetic, triangle.corners_px(), fill_rule)?));
        }
        let (_, edges) = self.edges.as_ref()?;
        let here = depth_at(triangle, sample);
        let beside = depth_at(triangle, &edges.sample((sample.x + 1, sample.y)));
        Some(signed_steps(self.scale.encoding(), here, beside))
    }
}

fn signed_steps(encoding: DepthEncoding, from: f32, to: f32) -> f32 {
    let steps = encoding.steps_between(from, to) as f32;
    if to < from { -steps } else { steps }
}

impl Observer for Capture<'_> {
    fn shaded(&mut self, triangle: &ScreenTriangle, fragment: &Fragment, _color: Rgba8) {
        let value = self.value(triangle, fragment);
        self.values.set(fragment.sample.column, fragment.sample.row, value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::run;
    use crate::inspect::display::{Display, NOT_A_NUMBER};
    use crate::inspect::trace::Trace;
    use crate::inspect::{Buffer, inspect};
    use crate::pipeline::settings::{DepthFormat, Interpolation, TexelFilter};
    use crate::pipeline::viewport::Viewport;
    use crate::scene::builtin;

    const VIEW: Viewport = Viewport { width: 28, height: 20 };

    #[test]
    fn ids_and_names_differ_from_those_of_buffers() {
        for number in Intermediate::ALL {
            assert!(Buffer::ALL.iter().all(|buffer| buffer.id() != number.id() && buffer.name() != number.name()));
        }
    }

    #[test]
    fn captured_values_match_the_lines_of_the_trace() {
        let mut recipe = Recipe::default();
        recipe.pipeline.filter = TexelFilter::Trilinear;
        for id in ["cubes", "stained-glass"] {
            let scene = builtin::by_id(id).unwrap().build();
            let frame = run(&scene, &scene.home, &recipe, VIEW, &mut ());
            let captured: Vec<_> = Intermediate::ALL.iter().map(|n| capture(&scene, &recipe, &frame, *n)).collect();
            let mut compared = 0;
            for (x, y) in (0..VIEW.height).flat_map(|y| (0..VIEW.width).map(move |x| (x, y))) {
                let report = inspect(&scene, &recipe, &frame, x, y).unwrap();
                let trace = Trace::of(&scene, &recipe, &frame, &report, None);
                if report.visible().is_none() {
                    assert!(captured.iter().all(|c| c.value(&frame, x, y) == Value::Nothing), "{id} {x},{y}");
                    continue;
                }
                for line in &trace.lines {
                    let Some(captured) = captured.iter().find(|c| Some(c.which) == line.buffer) else { continue };
                    let Value::Number(value) = captured.value(&frame, x, y) else { panic!("{id} {line:?}") };
                    assert_eq!(
                        f64::from(value),
                        line.number().unwrap().to_f64() as f32 as f64,
                        "{id} {x},{y} {line:?}"
                    );
                    compared += 1;
                }
            }
            assert!(compared > 1000, "{id}: {compared}");
        }
    }

    #[test]
    fn depth_slope_is_the_step_to_the_right_neighbour() {
        let scene = builtin::by_id("triangle").unwrap().build();
        let mut recipe = Recipe::default();
        recipe.pipeline.depth_format = DepthFormat::Unorm24;
        let frame = run(&scene, &scene.home, &recipe, VIEW, &mut ());
        let slope = capture(&scene, &recipe, &frame, Intermediate::DepthSlope);
        let depth = frame.drawn.depth.as_ref().unwrap();
        let encoding = frame.depth_scale().encoding();
        let mut compared = 0;
        for (x, y) in (0..VIEW.height).flat_map(|y| (0..VIEW.width - 1).map(move |x| (x, y))) {
            let pair = [slope.values.at(x, y), slope.values.at(x + 1, y)];
            let [Some(step), Some(_)] = pair else { continue };
            assert_eq!(step, signed_steps(encoding, depth.at(x, y), depth.at(x + 1, y)), "{x},{y}");
            compared += 1;
        }
        assert!(compared > 50, "{compared}");
    }

    #[test]
    fn nan_values_have_a_colour_of_their_own() {
        let scene = builtin::by_id("triangle").unwrap().build();
        let mut recipe = Recipe::default();
        recipe.pipeline.interpolation = Interpolation::Published;
        let frame = run(&scene, &scene.home, &recipe, VIEW, &mut ());
        let mut captured = capture(&scene, &recipe, &frame, Intermediate::Weight0);
        let place = captured.values.pixels().iter().position(Option::is_some).unwrap();
        captured.values.pixels_mut()[place] = Some(f32::NAN);
        let range = captured.range();
        assert!(range.is_some_and(|range| range.low.is_finite() && range.high.is_finite()));
        let picture =
            Display::default().picture_of(None, frame.image().size(), range, |x, y| captured.value(&frame, x, y));
        assert_eq!(picture.pixels()[place], NOT_A_NUMBER);
        assert_eq!(picture.pixels().iter().filter(|pixel| **pixel == NOT_A_NUMBER).count(), 1);
    }
}
