//! Pixels that no cause explains, by the object that is drawn there.

use std::collections::BTreeMap;

use rasterscope_engine::antialias::settings::Antialiasing;
use rasterscope_engine::chain::{Recipe, Renderer, run_unobserved};
use rasterscope_engine::image::color::{decode, encode};
use rasterscope_engine::image::{Image, Rgba8};
use rasterscope_engine::inspect::capture;
use rasterscope_engine::scene::TriangleId;
use rasterscope_engine::upscale::Upscaling;
use serde::Serialize;

use crate::agreement::{Rounding, TOLERANCE, difference};
use crate::setup::Setup;

/// Differing pixels of one object that no cause explains.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Rest {
    /// Name of the object that our drawing with the causes shows there; `None` for the background.
    pub object: Option<String>,
    /// Number of pixels.
    pub pixels: u64,
    /// Number of them beside another triangle or the background, where rounded vertices decide.
    pub at_edges: u64,
    /// Number of them that are a lighter or darker shade of our colour: light or normals differ, not the surface.
    pub shades: u64,
}

impl Rest {
    /// Compares the other renderer's picture with the drawing of a setup; `differences` are those of all pixels, in
    /// codes. Returns the object with most differing pixels first.
    pub(crate) fn of(setup: &Setup, theirs: &Image<Rgba8>, differences: &Image<u8>) -> Vec<Self> {
        if differences.pixels().iter().all(|code| *code <= TOLERANCE) {
            return Vec::new();
        }
        let ours = setup.draw(&mut Renderer::default());
        let triangles = visible_triangles(setup);
        let first = setup.scene.first_triangles();
        let object = |triangle: TriangleId| {
            (triangle != TriangleId::NONE).then(|| first.partition_point(|start| *start <= triangle) - 1)
        };
        let mut rest: BTreeMap<Option<usize>, Self> = BTreeMap::new();
        let (width, height) = theirs.size();
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            if differences.at(x, y) <= TOLERANCE {
                continue;
            }
            let (theirs, ours) = (theirs.at(x, y), ours.at(x, y));
            let object = object(triangles.at(x, y));
            let name = || object.map(|index| setup.scene.instances[index].name.clone());
            let found =
                rest.entry(object).or_insert_with(|| Self { object: name(), pixels: 0, at_edges: 0, shades: 0 });
            found.pixels += 1;
            found.at_edges += u64::from(is_edge(&triangles, x, y));
            found.shades += u64::from(is_shade(theirs, ours));
        }
        let mut rest: Vec<_> = rest.into_values().collect();
        rest.sort_by_key(|object| std::cmp::Reverse(object.pixels));
        rest
    }
}

/// Returns the triangle at the centre of every pixel of the finished picture.
fn visible_triangles(setup: &Setup) -> Image<TriangleId> {
    // One sample per pixel, so that every pixel has one triangle.
    let (antialias, upscaler) = (Antialiasing::default(), Upscaling::NATIVE);
    let recipe = Recipe { antialias, upscaler, ..setup.recipe };
    let frame = run_unobserved(&setup.scene, &setup.camera, &recipe, setup.viewport);
    setup.placed(capture(&setup.scene, &recipe, &frame).triangle)
}

/// Returns whether a colour is another one times a factor, in linear light and within [`TOLERANCE`].
fn is_shade(color: Rgba8, of: Rgba8) -> bool {
    let linear = |color: Rgba8| [0, 1, 2].map(|channel| decode(f32::from(color[channel]) / 255.0));
    let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let (ours, theirs) = (linear(of), linear(color));
    let factor = dot(ours, theirs) / dot(ours, ours).max(f32::MIN_POSITIVE);
    let [r, g, b] = ours.map(|value| (encode(factor * value) * 255.0).round() as u8);
    difference(color, [r, g, b, color[3]], Rounding::Nearest) <= TOLERANCE
}

/// Returns whether one of the eight neighbours of a pixel shows another triangle.
fn is_edge(triangles: &Image<TriangleId>, x: u32, y: u32) -> bool {
    let here = triangles.at(x, y);
    let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (i64::from(x) + dx, i64::from(y) + dy)));
    around.into_iter().any(|(x, y)| triangles.at_clamped(x, y) != here)
}
