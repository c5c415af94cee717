//! A frame as drawing commands: its triangles as lines or polygons that can be enlarged without stairs.
//!
//! Lines hidden by surfaces are found by asking the depth buffer along each edge, so a line is cut where it goes behind
//! something, to the pixel. Polygons are painted from far to near; where triangles pass through each other no order is
//! right.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use glam::DVec2;

use super::buffers::capture;
use crate::chain::{Frame, KeepDepth, Recipe, Renderer};
use crate::drawing::{Drawing, Rgb, Shape, Stroke};
use crate::flat2d::line::part_inside;
use crate::image::{Image, Rgba8};
use crate::pipeline::settings::{Choice, DepthBias, DepthFormat, DepthTest, choice};
use crate::pipeline::viewport::{ScreenTriangle, ScreenVertex, Viewport};
use crate::scene::{Camera, Scene, TriangleId};
use crate::upscale::Upscaling;

choice! {
    /// What is drawn of a scene.
    OutlineKind {
        Wireframe = "wireframe", "Wireframe", "The edges of all drawn triangles.";
        HiddenLine = "hidden-line", "Hidden lines removed", "Those parts of edges that nothing hides.";
        Polygons = "polygons", "Polygons", "Every visible triangle as a polygon of the mean colour that it has in the picture.";
    }
}

const PAPER: Rgb = [255; 3];

const LINE: Stroke = Stroke { color: [20; 3], width: 0.7 };

/// A line between triangles of one surface would show the paper through the seam; polygons are drawn a little larger.
const SEAM_WIDTH: f64 = 0.4;

/// The drawing of a view; one unit per pixel of a picture of `viewport`'s size.
pub fn outline(scene: &Arc<Scene>, camera: &Camera, recipe: &Recipe, viewport: Viewport, kind: OutlineKind) -> Drawing {
    let recipe = plain(recipe);
    let frame = Renderer::default().render(scene, camera, &recipe, viewport, KeepDepth::Yes);
    let size = DVec2::new(viewport.width.into(), viewport.height.into());
    match kind {
        OutlineKind::Wireframe => Drawing { size, background: PAPER, shapes: edges(&frame).map(whole).collect() },
        OutlineKind::HiddenLine => {
            let depth = frame.drawn.depth.as_ref();
            let shapes = edges(&frame).flat_map(|edge| visible_parts(edge, depth)).collect();
            Drawing { size, background: PAPER, shapes }
        }
        OutlineKind::Polygons => {
            let background = recipe.pipeline.background.resolve(scene.background);
            Drawing { size, background, shapes: polygons(scene, &recipe, &frame) }
        }
    }
}

/// The recipe with what a drawing needs: every pixel drawn, no lines over it, and depths that can be compared.
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

/// The triangles that won a pixel, from far to near.
fn polygons(scene: &Arc<Scene>, recipe: &Recipe, frame: &Frame) -> Vec<Shape> {
    let colors = mean_colors(&capture(scene, recipe, frame).triangle, frame.image());
    let mut visible: Vec<_> =
        frame.geometry.triangles.iter().filter_map(|t| colors.get(&t.id).map(|color| (t, *color))).collect();
    let mean_depth = |triangle: &ScreenTriangle| triangle.vertices.iter().map(|vertex| vertex.depth).sum::<f64>();
    visible.sort_by(|a, b| mean_depth(b.0).total_cmp(&mean_depth(a.0)));
    let polygon = |(triangle, color): (&ScreenTriangle, Rgb)| {
        let corners = triangle.vertices.iter().map(|vertex| end(vertex).0).collect();
        Shape::Polygon { corners, fill: Some(color), stroke: Some(Stroke { color, width: SEAM_WIDTH }) }
    };
    visible.into_iter().map(polygon).collect()
}

/// Mean colour of the pixels that each triangle won, of codes as they are.
fn mean_colors(winners: &Image<TriangleId>, picture: &Image<Rgba8>) -> HashMap<TriangleId, Rgb> {
    let mut sums: HashMap<TriangleId, ([u64; 3], u64)> = HashMap::new();
    for (id, [red, green, blue, _]) in
        winners.pixels().iter().zip(picture.pixels()).filter(|(id, _)| **id != TriangleId::NONE)
    {
        let (sum, count) = sums.entry(*id).or_default();
        for (channel, code) in sum.iter_mut().zip([red, green, blue]) {
            *channel += u64::from(*code);
        }
        *count += 1;
    }
    sums.into_iter().map(|(id, (sum, count))| (id, sum.map(|channel| ((channel + count / 2) / count) as u8))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::bitmap::bitmap;
    use crate::scene::builtin;

    const SIZE: Viewport = Viewport { width: 200, height: 150 };

    fn drawn(id: &str, kind: OutlineKind) -> Drawing {
        let scene = Arc::new(builtin::ALL.iter().find(|scene| scene.id == id).unwrap().build());
        outline(&scene, &scene.home, &Recipe::default(), SIZE, kind)
    }

    fn length(drawing: &Drawing) -> f64 {
        let length = |shape: &Shape| if let Shape::Line { from, to, .. } = shape { from.distance(*to) } else { 0.0 };
        drawing.shapes.iter().map(length).sum()
    }

    #[test]
    fn one_triangle_has_three_edges_and_all_are_visible() {
        let (all, visible) = (drawn("triangle", OutlineKind::Wireframe), drawn("triangle", OutlineKind::HiddenLine));
        assert_eq!(all.shapes.len(), 3);
        assert!((length(&all) - length(&visible)).abs() < 1e-9, "{} and {}", length(&all), length(&visible));
    }

    #[test]
    fn hidden_lines_are_a_part_of_all_and_shared_edges_come_once() {
        let (all, visible) = (drawn("cubes", OutlineKind::Wireframe), drawn("cubes", OutlineKind::HiddenLine));
        assert!(length(&visible) < 0.9 * length(&all) && length(&visible) > 0.1 * length(&all));
        let mut ends: Vec<_> = all
            .shapes
            .iter()
            .filter_map(|shape| if let Shape::Line { from, to, .. } = shape { Some([from, to]) } else { None })
            .map(|ends| ends.map(|end| end.to_array().map(f64::to_bits)))
            .collect();
        let before = ends.len();
        ends.sort_unstable();
        ends.dedup();
        assert!(ends.len() > before * 9 / 10, "{} of {before}", ends.len());
    }

    #[test]
    fn an_edge_that_reaches_far_outside_is_hidden_to_the_pixel() {
        let depth = Image::from_fn(100, 10, |x, _| if (40..50).contains(&x) { 0.2 } else { 1.0 });
        let parts = visible_parts([(DVec2::new(-16_000.0, 5.5), 0.5), (DVec2::new(16_000.0, 5.5), 0.5)], Some(&depth));
        let ends: Vec<_> = parts
            .iter()
            .filter_map(|part| if let Shape::Line { from, to, .. } = part { Some((from.x, to.x)) } else { None })
            .collect();
        let [(left, hidden), (shown, right)] = ends[..] else { panic!("{ends:?}") };
        assert!(left.abs() < 1e-6 && (right - 100.0).abs() < 1e-6, "{ends:?}");
        // A pixel beside what hides it still shows the line.
        assert!((hidden - 40.5).abs() <= 1.0 && (shown - 49.5).abs() <= 1.0, "{ends:?}");
    }

    #[test]
    fn polygons_lie_on_the_background_that_the_settings_ask_for() {
        let scene = Arc::new(builtin::by_id("triangle").unwrap().build());
        let size = Viewport { width: 32, height: 24 };
        for (setting, expected) in [("background=scene", scene.background), ("background=#d04010", [0xd0, 0x40, 0x10])]
        {
            let mut recipe = Recipe::default();
            recipe.set(setting).unwrap();
            let drawing = outline(&scene, &scene.home, &recipe, size, OutlineKind::Polygons);
            assert_eq!(drawing.background, expected, "{setting}");
        }
    }

    #[test]
    fn polygons_show_the_picture() {
        let scene = Arc::new(builtin::ALL.iter().find(|scene| scene.id == "cubes").unwrap().build());
        let mut recipe = Recipe::default();
        // One colour per triangle, so that the mean colour of each is its own.
        recipe.set("shading=triangle-id").unwrap();
        let size = Viewport { width: 320, height: 240 };
        let picture = Renderer::default().render(&scene, &scene.home, &recipe, size, KeepDepth::Yes);
        let drawing = bitmap(&outline(&scene, &scene.home, &recipe, size, OutlineKind::Polygons), 1.0);
        let off = |(a, b): &(&Rgba8, &Rgba8)| (0..3).any(|channel| a[channel].abs_diff(b[channel]) > 24);
        let pixels = drawing.pixels().iter().zip(picture.image().pixels());
        let wrong = pixels.filter(off).count() as f64 / f64::from(size.width * size.height);
        let drawn = picture.image().pixels().iter().filter(|pixel| pixel[..3] != scene.background).count() as f64;
        assert!(drawn / f64::from(size.width * size.height) > 0.2, "there is much to be wrong about");
        // Pixels that an edge runs through are mixed in the one and not in the other.
        assert!(wrong < 0.1, "{wrong} of the picture");
    }
}
