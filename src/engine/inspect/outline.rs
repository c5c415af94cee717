//! Vector drawing of a frame: its triangles as lines or polygons that scale without aliasing.
//!
//! Hidden lines are removed by comparing each edge with the depth buffer, so a line ends at the pixel where it becomes
//! occluded. Polygons are the visible parts of triangles. The rasterizer finds them on a grid that is finer than the
//! pixels ([`visible`]). Between the samples of this grid, boundaries follow the edges and intersections of triangles
//! ([`crossing`], [`partition`]). No back-to-front sorting is needed, and triangles may intersect.

mod crossing;

mod parallel_step;

mod partition;

mod visible;

use std::collections::HashSet;
use std::sync::Arc;

use glam::DVec2;

use crossing::Surfaces;
use visible::Visibility;

use crate::chain::{Frame, KeepDepth, Recipe, RenderInputs, Renderer};
use crate::drawing::{Drawing, PartitionRegion, Rgb, Shape, Stroke};
use crate::flat2d::line::part_inside;
use crate::image::Image;
use crate::inspect::control::TaskControl;
use crate::pipeline::prepare;
use crate::pipeline::screen_triangle::ScreenTriangle;
use crate::pipeline::screen_vertex::ScreenVertex;
use crate::pipeline::settings::{Choice, DepthBias, DepthFormat, DepthTest, choice};
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, Scene};
use crate::upscale::Upscaling;

choice! {
    /// Kind of shapes in a vector drawing of a frame.
    pub OutlineKind {
        Wireframe = "wireframe", "Wireframe", "The edges of all drawn triangles.";
        HiddenLine = "hidden-line", "Hidden lines removed", "The parts of edges that no surface hides.";
        Polygons = "polygons", "Polygons", "The visible part of every triangle, in its mean colour in the picture.";
    }
}

const PAPER: Rgb = [255; 3];

const LINE: Stroke = Stroke { color: [20; 3], width: 0.7 };

/// Maximum number of samples along each side of a pixel for finding visible polygons. Details smaller than the sample
/// spacing are lost. Large pictures use fewer samples.
const MAX_SAMPLES_PER_PX: u32 = 5;

/// View of a scene to draw as shapes.
#[derive(Clone, Copy, Debug)]
pub struct OutlineRequest<'a> {
    /// Scene whose triangles become shapes.
    pub scene: &'a Arc<Scene>,
    /// Camera from which the scene is drawn.
    pub camera: &'a Camera,
    /// Settings of the frame. Drawings of lines ignore the upscaler, the wireframe setting and the depth settings.
    pub recipe: &'a Recipe,
    /// Size of the drawing, in pixels. One pixel is one unit of the drawing.
    pub viewport: Viewport,
    /// Kind of shapes in the vector drawing.
    pub kind: OutlineKind,
}

/// Draws a view of a scene as vector shapes; returns `None` if cancelled.
pub fn outline(request: &OutlineRequest<'_>, control: TaskControl<'_>) -> Option<Drawing> {
    let OutlineRequest { scene, camera, recipe, viewport, kind } = *request;
    let size = DVec2::new(viewport.width.into(), viewport.height.into());
    let frame =
        || Renderer::default().render(RenderInputs { scene, camera, recipe: &plain(recipe), viewport }, KeepDepth::Yes);
    let (background, shapes) = match kind {
        OutlineKind::Wireframe => (PAPER, edges(&frame()).map(whole).collect()),
        OutlineKind::HiddenLine => {
            let frame = frame();
            let depth = frame.drawn.depth.as_ref();
            (PAPER, edges(&frame).flat_map(|edge| visible_parts(edge, depth)).collect())
        }
        OutlineKind::Polygons => {
            let regions = polygons(request, control)?;
            (recipe.pipeline.background.resolve(scene.background), vec![Shape::Partition(regions)])
        }
    };
    control.check().map(|()| Drawing { size, background, shapes })
}

/// Returns the recipe adapted for drawing lines: every pixel drawn, no wireframe, and a depth test for hidden lines.
fn plain(recipe: &Recipe) -> Recipe {
    let mut recipe = Recipe { upscaler: Upscaling::NATIVE, wireframe: false, ..*recipe };
    recipe.pipeline.depth_test = DepthTest::Less;
    recipe.pipeline.depth_format = DepthFormat::F32;
    recipe.pipeline.depth_bias = DepthBias::default();
    recipe
}

/// A screen-space edge: the position in px and the depth of both endpoints.
type DepthEdge = [(DVec2, f64); 2];

fn end(vertex: &ScreenVertex) -> (DVec2, f64) {
    (DVec2::new(vertex.position_px[0].into(), vertex.position_px[1].into()), vertex.depth)
}

/// Returns the screen edges of all triangles; an edge shared by two triangles occurs once.
fn edges(frame: &Frame) -> impl Iterator<Item = DepthEdge> {
    let mut seen = HashSet::new();
    let sides = frame
        .geometry()
        .triangles
        .iter()
        .flat_map(|ScreenTriangle { vertices: [a, b, c], .. }| [(a, b), (b, c), (c, a)]);
    sides.filter_map(move |(from, to)| {
        let key = |vertex: &ScreenVertex| (vertex.x, vertex.y, vertex.depth.to_bits());
        let (low, high) = (key(from).min(key(to)), key(from).max(key(to)));
        seen.insert((low, high)).then(|| [end(from), end(to)])
    })
}

fn whole([from, to]: DepthEdge) -> Shape {
    Shape::Line { from: from.0, to: to.0, stroke: LINE }
}

/// Returns the visible parts of an edge as lines, tested against the depth buffer about once per pixel.
fn visible_parts([from, to]: DepthEdge, depth: Option<&Image<f32>>) -> Vec<Shape> {
    let Some(depth) = depth else { return vec![whole([from, to])] };
    // The part outside the picture is skipped, so the diagonal of the picture bounds the number of steps.
    let inside = part_inside(from.0.into(), to.0.into(), depth.width(), depth.height());
    let Some((enter, leave)) = inside else { return Vec::new() };
    let length = (to.0 - from.0).length() * (leave - enter);
    let steps = length.ceil().max(1.0) as usize;
    let at = |step: usize| {
        let t = enter + (leave - enter) * (step as f64 / steps as f64);
        (from.0.lerp(to.0, t), from.1 + (to.1 - from.1) * t)
    };
    let mut parts = Vec::new();
    let mut start = None;
    for step in 0..=steps {
        let (place, z) = at(step);
        match (is_visible(depth, place, z), start) {
            (true, None) => start = Some(place),
            (false, Some(first)) => {
                parts.push(Shape::Line { from: first, to: at(step - 1).0, stroke: LINE });
                start = None;
            }
            _ => {}
        }
    }
    parts.extend(start.map(|first| Shape::Line { from: first, to: at(steps).0, stroke: LINE }));
    parts
}

/// Whether a point with depth `z` is visible: at least one of the 3×3 pixels around it stores no nearer depth. The
/// neighbours are tested because an edge usually lies between the pixel centres at which its surfaces are stored.
fn is_visible(depth: &Image<f32>, place: DVec2, z: f64) -> bool {
    let (x, y) = (place.x.floor() as i64, place.y.floor() as i64);
    let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (x + dx, y + dy)));
    let stored = around.filter_map(|(x, y)| depth.get(u32::try_from(x).ok()?, u32::try_from(y).ok()?));
    stored.map(f64::from).any(|stored| z <= stored)
}

/// Returns the visible parts of all triangles and of the background as regions that together fill the picture. Returns
/// `None` if cancelled.
fn polygons(request: &OutlineRequest<'_>, control: TaskControl<'_>) -> Option<Vec<PartitionRegion>> {
    let OutlineRequest { scene, camera, recipe, viewport, .. } = *request;
    let settings = &recipe.pipeline;
    let magnified = |by: u32| Viewport { width: viewport.width * by, height: viewport.height * by };
    let samples_per_px = (2..=MAX_SAMPLES_PER_PX).rev().find(|by| magnified(*by).check().is_ok()).unwrap_or(1);
    let size = magnified(samples_per_px);
    let geometry = prepare(scene, camera, settings, size, &mut ());
    let visibility = Visibility::of(scene, &geometry, settings, size, control)?;
    partition::partition(&Surfaces { visibility: &visibility, geometry: &geometry, settings }, samples_per_px, control)
}

#[cfg(test)]
mod tests;
