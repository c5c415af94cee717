//! Shared helpers of the integration tests: small scenes, and the geometry stages on bare clip-space vertices.

use std::f32::consts::{PI, TAU};
use std::sync::Arc;

use glam::{Mat4, Vec3};
use rasterscope::chain::{KeepDepth, Recipe, RenderInputs, Renderer};
use rasterscope::image::{Image, Rgba8};
use rasterscope::pipeline::clip_space::ClipVertex;
use rasterscope::pipeline::from_clip_space;
use rasterscope::pipeline::observe::Observer;
use rasterscope::pipeline::raster::{AnyTriangle, RasterSample, cover};
use rasterscope::pipeline::screen_triangle::ScreenTriangle;
use rasterscope::pipeline::settings::{Arithmetic, Choice, DepthBias, FillRule, Rasterizer};
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::scene::{Mesh, Scene};

pub(crate) use crate::internal::scene_builder::{
    SceneBuilder, cube, grid_triangles, ground_and_cube, in_cube, mesh, noise_texture, plane, render, signed,
    with_alpha,
};

/// Returns the four fill rules under which shared edges are drawn exactly once.
pub(crate) fn sound_fill_rules() -> impl Iterator<Item = FillRule> {
    FillRule::ALL.iter().copied().filter(|r| !matches!(r, FillRule::Inclusive | FillRule::Exclusive))
}

/// Depth biases of both signs: constant, slope-scaled, both at once, and large enough to clamp depths.
pub(crate) const DEPTH_BIASES: [DepthBias; 5] = [
    DepthBias { constant: 3.0, slope: 0.0 },
    DepthBias { constant: 0.0, slope: -1.5 },
    DepthBias { constant: -700.0, slope: 2.0 },
    DepthBias { constant: -5e6, slope: 0.0 },
    DepthBias { constant: 1e6, slope: 40.0 },
];

/// Runs `test` with the seeds 0 to `count` − 1, and prints the seed if it panics.
pub(crate) fn for_seeds(count: u64, mut test: impl FnMut(&mut fastrand::Rng)) {
    for seed in 0..count {
        let _named = NameSeedOnPanic(seed);
        test(&mut fastrand::Rng::with_seed(seed));
    }
}

struct NameSeedOnPanic(u64);

impl Drop for NameSeedOnPanic {
    #[expect(clippy::print_stderr, reason = "a failing random test must name its seed")]
    fn drop(&mut self) {
        if std::thread::panicking() {
            eprintln!("failed with seed {}", self.0);
        }
    }
}

/// Returns a clip-space vertex without attributes that projects to the position (x, y), in pixels of `viewport`.
pub(crate) fn clip_vertex(viewport: Viewport, (x, y): (f32, f32), depth: f32, w: f32) -> ClipVertex {
    let ndc = Vec3::new(x / viewport.width as f32 * 2.0 - 1.0, 1.0 - y / viewport.height as f32 * 2.0, depth);
    ClipVertex::at((ndc * w).extend(w))
}

/// Clips and projects clip-space triangles in fixed-point arithmetic.
pub(crate) fn screen_triangles(
    vertices: &[ClipVertex],
    triangles: &[[u32; 3]],
    viewport: Viewport,
    observer: &mut impl Observer,
) -> Vec<ScreenTriangle> {
    from_clip_space(vertices, triangles, Arithmetic::Fixed, viewport, observer)
}

/// Returns the samples of a picture that a triangle covers, in fixed-point arithmetic.
pub(crate) fn covered(
    triangle: &ScreenTriangle,
    rasterizer: Rasterizer,
    rule: FillRule,
    viewport: Viewport,
) -> Vec<RasterSample> {
    let corners_px = triangle.corners_px();
    let spans = cover(rasterizer, Arithmetic::Fixed, corners_px, rule, viewport);
    let pixels = spans.into_iter().flat_map(|span| (span.left..span.right).map(move |x| (x, span.row)));
    let triangle = AnyTriangle::new(Arithmetic::Fixed, corners_px, rule);
    triangle.map_or_else(Vec::new, |triangle| pixels.map(|pixel| triangle.sample(pixel)).collect())
}

/// Returns a mesh of `count` random triangles in [−1, 1]³ that intersect each other.
pub(crate) fn soup(rng: &mut fastrand::Rng, count: u32) -> Mesh {
    mesh((0..count * 3).map(|_| in_cube(rng)).collect(), (0..count).map(|i| [0, 1, 2].map(|c| i * 3 + c)).collect())
}

/// Returns a scene of intersecting triangles, some around and behind the eye, most of them without textures.
pub(crate) fn soup_scene() -> Scene {
    let mut rng = fastrand::Rng::with_seed(2);
    SceneBuilder::new(Vec3::new(0.2, 0.3, 1.1))
        .with(soup(&mut rng, 25), Mat4::from_scale(Vec3::splat(1.5)), None)
        .with(soup(&mut rng, 8), Mat4::from_translation(Vec3::NEG_Z), Some([(); 2].map(|()| noise_texture(&mut rng))))
        .0
}

/// Returns an orthographic scene of two planes at exactly the same depth, and a cube that intersects them.
pub(crate) fn coplanar_scene() -> Scene {
    let mut rng = fastrand::Rng::with_seed(3);
    let mut scene = SceneBuilder::new(Vec3::new(0.0, 0.0, 4.0))
        .with(plane(), Mat4::IDENTITY, None)
        .with(
            plane(),
            Mat4::from_translation(Vec3::new(0.4, 0.3, 0.0)),
            Some([(); 2].map(|()| noise_texture(&mut rng))),
        )
        .with(cube(), Mat4::from_scale(Vec3::splat(0.5)) * Mat4::from_rotation_x(0.7), None)
        .0;
    scene.home = scene.home.with_orthographic(true);
    scene
}

/// Returns a scene of opaque, alpha-tested and blended surfaces that intersect and cover each other. Their transparency
/// comes from textures and from opacity.
pub(crate) fn transparency_scene() -> Scene {
    let mut rng = fastrand::Rng::with_seed(4);
    let soup = soup(&mut rng, 8);
    let mut textures = |codes: &[u8]| {
        Some([(); 2].map(|()| {
            let image = noise_texture(&mut rng);
            with_alpha(&mut rng, &image, codes)
        }))
    };
    let at = |z: f32, turn: f32| Mat4::from_translation(Vec3::Z * z) * Mat4::from_rotation_y(turn);
    SceneBuilder::new(Vec3::new(0.3, 0.4, 3.4))
        .with_opacity(cube(), at(0.5, 0.5) * Mat4::from_scale(Vec3::splat(0.5)), None, 0.4)
        .with(plane(), at(0.9, -0.2), textures(&[0, 255]))
        .with(plane(), at(-0.8, 0.1), textures(&[255]))
        .with(plane(), at(0.1, 0.3), textures(&[0, 90, 200, 255]))
        .with_opacity(plane(), at(-0.2, -0.4), textures(&[0, 255]), 0.7)
        .with_opacity(soup, Mat4::from_scale(Vec3::splat(2.0)), None, 0.25)
        .0
}

/// Returns a sphere of radius 1 around the origin, with 2 · `cells`² triangles in rows parallel to the equator.
pub(crate) fn sphere(cells: u32) -> Mesh {
    let side = cells + 1;
    let at = |i: u32| {
        let (longitude, latitude) = ((i % side) as f32 / cells as f32 * TAU, (i / side) as f32 / cells as f32 * PI);
        Vec3::new(latitude.sin() * longitude.cos(), -latitude.cos(), -latitude.sin() * longitude.sin())
    };
    mesh((0..side * side).map(at).collect(), grid_triangles(cells, cells))
}

/// Returns a parallelogram of 512 triangles that `edges` span from `corner`. Rows of triangles run along the first
/// edge.
pub(crate) fn sheet(corner: Vec3, edges: [Vec3; 2]) -> Mesh {
    const CELLS: u32 = 16;
    let side = CELLS + 1;
    let share = |i: u32| i as f32 / CELLS as f32;
    let at = |i: u32| corner + edges[0] * share(i % side) + edges[1] * share(i / side);
    mesh((0..side * side).map(at).collect(), grid_triangles(CELLS, CELLS))
}

/// Returns the scenes of this module, each with its name.
pub(crate) fn scenes() -> [(&'static str, Scene); 4] {
    [
        ("ground and cube", ground_and_cube()),
        ("soup", soup_scene()),
        ("coplanar", coplanar_scene()),
        ("transparency", transparency_scene()),
    ]
}

/// Returns the default recipe changed by `assignments` such as `culling=none`.
pub(crate) fn recipe(assignments: &[&str]) -> Recipe {
    let mut recipe = Recipe::default();
    for assignment in assignments {
        recipe.set(assignment).expect("test recipes are valid");
    }
    recipe
}

/// Number of frames of [`picture_in_motion`] with an upscaler that reads earlier frames.
const FRAMES: u8 = 3;

/// Angle by which the camera of [`picture_in_motion`] orbits between two frames, in radians.
const TURN: f32 = 0.02;

/// Returns the picture of the home view; with history, the last of several frames of an orbiting camera.
pub(crate) fn picture_in_motion(scene: &Arc<Scene>, recipe: &Recipe, size: Viewport) -> Image<Rgba8> {
    let mut renderer = Renderer::default();
    let frames = if recipe.upscaler.upscaler().reads().history { FRAMES } else { 1 };
    let pictures = (0..frames).rev().map(|frames_left| {
        let mut camera = scene.home;
        camera.orbit(TURN * f32::from(frames_left), 0.0);
        renderer.render(RenderInputs { scene, camera: &camera, recipe, viewport: size }, KeepDepth::Yes).image().clone()
    });
    pictures.last().expect("at least one frame")
}
