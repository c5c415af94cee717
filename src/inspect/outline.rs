//! A frame as drawing commands: its triangles as lines or polygons that can be enlarged without stairs.
//!
//! Lines hidden by surfaces are found by asking the depth buffer along each edge, so a line is cut where it goes behind
//! something, to the pixel. Polygons are the visible parts of triangles. The rasterizer finds them on a grid finer than
//! pixels ([`visible`]), and their boundaries follow the edges and intersections of triangles between its samples
//! ([`crossing`], [`partition`]): no order of painting is needed, and triangles may pass through each other.

mod control;

mod crossing;

mod partition;

mod visible;

use std::collections::HashSet;
use std::sync::Arc;

use glam::DVec2;

pub use control::OutlineControl;

use crossing::Surfaces;
use visible::Visibility;

use crate::chain::{Frame, KeepDepth, Recipe, Renderer};
use crate::drawing::{Drawing, Region, Rgb, Shape, Stroke};
use crate::flat2d::line::part_inside;
use crate::image::Image;
use crate::pipeline::prepare;
use crate::pipeline::settings::{Choice, DepthBias, DepthFormat, DepthTest, choice};
use crate::pipeline::viewport::{ScreenTriangle, ScreenVertex, Viewport};
use crate::scene::{Camera, Scene};
use crate::upscale::Upscaling;

choice! {
    /// What is drawn of a scene.
    OutlineKind {
        Wireframe = "wireframe", "Wireframe", "The edges of all drawn triangles.";
        HiddenLine = "hidden-line", "Hidden lines removed", "Those parts of edges that nothing hides.";
        Polygons = "polygons", "Polygons", "The visible part of every triangle, in the mean colour that it has in the picture.";
    }
}

const PAPER: Rgb = [255; 3];

const LINE: Stroke = Stroke { color: [20; 3], width: 0.7 };

/// Greatest number of samples along each side of a pixel by which visible polygons are found: details smaller than their
/// distance are lost. Large pictures get fewer.
const MOST_SAMPLES_PER_PX: u32 = 5;

/// View of a scene to draw as shapes.
#[derive(Clone, Copy, Debug)]
pub struct OutlineRequest<'a> {
    /// Scene whose triangles become shapes.
    pub scene: &'a Arc<Scene>,
    /// Camera that the scene is seen by.
    pub camera: &'a Camera,
    /// Settings. Lines ignore the upscaler and the depth settings.
    pub recipe: &'a Recipe,
    /// Size of the drawing, one unit per pixel.
    pub viewport: Viewport,
    /// Kind of shapes.
    pub kind: OutlineKind,
}

/// Returns the drawing of a view; `None` if it was cancelled.
pub fn outline(request: &OutlineRequest<'_>, control: OutlineControl<'_>) -> Option<Drawing> {
    let OutlineRequest { scene, camera, recipe, viewport, kind } = *request;
    let size = DVec2::new(viewport.width.into(), viewport.height.into());
    let frame = || Renderer::default().render(scene, camera, &plain(recipe), viewport, KeepDepth::Yes);
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

/// The recipe with what lines need: every pixel drawn, no lines over it, and depths that can be compared.
fn plain(recipe: &Recipe) -> Recipe {
    let mut recipe = Recipe { upscaler: Upscaling::NATIVE, wireframe: false, ..*recipe };
    recipe.pipeline.depth_test = DepthTest::Less;
    recipe.pipeline.depth_format = DepthFormat::F32;
    recipe.pipeline.depth_bias = DepthBias::default();
    recipe
}

/// An edge on the screen: two ends, each with its depth.
type Edge = [(DVec2, f64); 2];

fn end(vertex: &ScreenVertex) -> (DVec2, f64) {
    (DVec2::new(vertex.position_px[0].into(), vertex.position_px[1].into()), vertex.depth)
}

/// The edges of all triangles, each once though two triangles share it.
fn edges(frame: &Frame) -> impl Iterator<Item = Edge> {
    let mut seen = HashSet::new();
    let sides =
        frame.geometry.triangles.iter().flat_map(|ScreenTriangle { vertices: [a, b, c], .. }| [(a, b), (b, c), (c, a)]);
    sides.filter_map(move |(from, to)| {
        let key = |vertex: &ScreenVertex| (vertex.x, vertex.y, vertex.depth.to_bits());
        let (low, high) = (key(from).min(key(to)), key(from).max(key(to)));
        seen.insert((low, high)).then(|| [end(from), end(to)])
    })
}

fn whole([from, to]: Edge) -> Shape {
    Shape::Line { from: from.0, to: to.0, stroke: LINE }
}

/// The stretches of an edge that no stored depth is nearer than. It is asked once per pixel.
fn visible_parts([from, to]: Edge, depth: Option<&Image<f32>>) -> Vec<Shape> {
    let Some(depth) = depth else { return vec![whole([from, to])] };
    // What reaches outside is not walked; the picture's diagonal bounds the rest.
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

/// Whether one of the pixels around a place holds no nearer surface: the surfaces beside an edge are stored at the centres of
/// pixels beside it.
fn is_visible(depth: &Image<f32>, place: DVec2, z: f64) -> bool {
    let (x, y) = (place.x.floor() as i64, place.y.floor() as i64);
    let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (x + dx, y + dy)));
    let stored = around.filter_map(|(x, y)| depth.get(u32::try_from(x).ok()?, u32::try_from(y).ok()?));
    stored.map(f64::from).any(|stored| z <= stored)
}

/// Returns the visible parts of all triangles and of the background, which together fill the picture; `None` if cancelled.
fn polygons(request: &OutlineRequest<'_>, control: OutlineControl<'_>) -> Option<Vec<Region>> {
    let OutlineRequest { scene, camera, recipe, viewport, .. } = *request;
    let settings = &recipe.pipeline;
    let magnified = |by: u32| Viewport { width: viewport.width * by, height: viewport.height * by };
    let samples_per_px = (2..=MOST_SAMPLES_PER_PX).rev().find(|by| magnified(*by).check().is_ok()).unwrap_or(1);
    let size = magnified(samples_per_px);
    let geometry = prepare(scene, camera, settings, size, &mut ());
    let visibility = Visibility::of(scene, &geometry, settings, size, control)?;
    partition::partition(&Surfaces { visibility: &visibility, geometry: &geometry, settings }, samples_per_px, control)
}

#[cfg(test)]
mod tests;
