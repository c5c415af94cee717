//! Fates of triangles and fragments, checked against an independent count. It evaluates coverage in integers, compares
//! all fragments of a pixel at once, and repeats clipping and culling in double precision.

use glam::{DVec4, Mat4, Vec3};
use rasterscope::chain::{Frame, Recipe, SettingKey, SettingStage};
use rasterscope::inspect::Fates;
use rasterscope::inspect::fates::{FragmentFate, TriangleFate};
use rasterscope::pipeline::raster::RasterSample;
use rasterscope::pipeline::screen_triangle::{ScreenTriangle, depth_at};
use rasterscope::pipeline::settings::{Choice as _, Culling, DepthTest};
use rasterscope::pipeline::shading::ShadingKind;
use rasterscope::scene::{DepthMapping, Scene, TriangleId};

use crate::internal::common::{SceneBuilder, for_seeds, render, soup};
use crate::internal::switches::{distinct, switches_of};

/// Size of the pictures, odd and small, because every triangle is tested at every pixel.
const SIZE: (u32, u32) = (37, 29);

/// Steps per pixel of the grid to which corners are snapped.
const STEPS: i128 = 256;

/// Returns a scene of intersecting triangles, some translucent, some around and behind the eye. They have no textures,
/// so transparency depends on opacity only.
fn scene(rng: &mut fastrand::Rng) -> Scene {
    let at = |x: f32, z: f32| Mat4::from_translation(Vec3::new(x, 0.0, z));
    SceneBuilder::new(Vec3::new(0.2, 0.3, 1.4))
        .with(soup(rng, 14), Mat4::from_scale(Vec3::splat(1.2)), None)
        .with(soup(rng, 6), at(-0.4, -0.6) * Mat4::from_scale(Vec3::splat(0.5)), None)
        .with_opacity(soup(rng, 9), at(0.2, -0.2), None, 0.5)
        .0
}

/// Returns the edge functions of a triangle at the centre of a pixel; `None` if the triangle does not cover the centre
/// under the top-left rule.
fn edges(triangle: &ScreenTriangle, x: u32, y: u32) -> Option<[f64; 3]> {
    let corners = triangle.vertices.each_ref().map(|v| [i128::from(v.x), i128::from(v.y)]);
    let [px, py] = [x, y].map(|at| i128::from(at) * STEPS + STEPS / 2);
    let cross =
        |a: [i128; 2], b: [i128; 2], p: [i128; 2]| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
    let sign = cross(corners[0], corners[1], corners[2]).signum();
    let mut values = [0.0; 3];
    for (opposite, value) in values.iter_mut().enumerate() {
        // Orients the edge so that the inside is on its right on the screen, where y points down.
        let (mut a, mut b) = (corners[(opposite + 1) % 3], corners[(opposite + 2) % 3]);
        if sign < 0 {
            (a, b) = (b, a);
        }
        let edge = cross(a, b, [px, py]);
        let is_top_or_left = (a[1] == b[1] && b[0] > a[0]) || b[1] < a[1];
        if edge < 0 || (edge == 0 && !is_top_or_left) {
            return None;
        }
        *value = edge as f64;
    }
    Some(values)
}

/// Fragment of the independent count.
struct Candidate {
    triangle: TriangleId,
    depth: f32,
    is_blended: bool,
}

/// Returns the fates of all fragments at one pixel, given in drawing order with blended ones last. A fragment passes
/// the depth test if it is nearer than every opaque one before it. It is overwritten if an opaque one after it passes.
fn endings(all: &[Candidate], tests_depth: bool) -> Vec<FragmentFate> {
    let passes = |place: usize| {
        let is_nearer = |other: &Candidate| other.is_blended || all[place].depth < other.depth;
        !tests_depth || (all[place].depth < 1.0 && all[..place].iter().all(is_nearer))
    };
    let ending = |place: usize| {
        let later = || (place + 1..all.len()).filter(|later| passes(*later));
        match (passes(place), later().any(|later| !all[later].is_blended), later().next().is_some()) {
            (false, ..) => FragmentFate::LostDepth,
            (true, true, _) => FragmentFate::Overwritten,
            (true, false, true) => FragmentFate::BlendedOver,
            (true, false, false) => FragmentFate::Visible,
        }
    };
    (0..all.len()).map(ending).collect()
}

/// Returns the number of fragments of each triangle by fate.
fn expected_fragments(scene: &Scene, recipe: &Recipe, frame: &Frame) -> Vec<[u64; FragmentFate::ALL.len()]> {
    let tests_depth = recipe.pipeline.depth_test == DepthTest::Less;
    // Shadings of all other kinds make surfaces opaque.
    let blends = recipe.pipeline.shading.kind() == ShadingKind::Material;
    let mut counts = vec![[0; FragmentFate::ALL.len()]; scene.triangle_count()];
    let translucent = scene.instances.len() as u32 - 1;
    for (x, y) in (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (x, y))) {
        let covering = frame.geometry().triangles.iter().filter_map(|triangle| {
            let sample = RasterSample { column: x, row: y, x, y, edges: edges(triangle, x, y)? };
            let (depth, is_blended) = (depth_at(triangle, &sample), blends && triangle.instance == translucent);
            Some(Candidate { triangle: triangle.id, depth, is_blended })
        });
        let covering: Vec<_> = covering.collect();
        for (fragment, ending) in covering.iter().zip(endings(&covering, tests_depth)) {
            counts[fragment.triangle.0 as usize][ending as usize] += 1;
        }
    }
    counts
}

/// Returns twice the signed screen area of the part of a triangle between the near and the far plane, with y down;
/// `None` if the triangle is outside the view.
fn in_double_precision(corners: [DVec4; 3]) -> Option<f64> {
    let planes: [fn(DVec4) -> f64; 6] =
        [|p| p.z, |p| p.w - p.z, |p| p.w + p.x, |p| p.w - p.x, |p| p.w + p.y, |p| p.w - p.y];
    if planes.iter().any(|plane| corners.iter().all(|corner| plane(*corner) < 0.0)) {
        return None;
    }
    let mut polygon = corners.to_vec();
    for plane in &planes[..2] {
        let mut cut = Vec::new();
        for (place, a) in polygon.iter().enumerate() {
            let b = polygon[(place + 1) % polygon.len()];
            let (from, to) = (plane(*a), plane(b));
            if from >= 0.0 {
                cut.push(*a);
            }
            if (from >= 0.0) != (to >= 0.0) {
                cut.push(*a + (b - *a) * (from / (from - to)));
            }
        }
        polygon = cut;
    }
    let on_screen: Vec<_> = polygon.iter().map(|p| [p.x / p.w, -p.y / p.w]).collect();
    let next = |place: usize| on_screen[(place + 1) % on_screen.len()];
    Some(on_screen.iter().enumerate().map(|(place, [x, y])| x * next(place)[1] - y * next(place)[0]).sum())
}

/// Returns the expected fate of each triangle that the geometry stages reject, and `None` for the others.
fn expected_rejections(scene: &Scene, culling: Culling) -> Vec<Option<TriangleFate>> {
    let aspect = SIZE.0 as f32 / SIZE.1 as f32;
    let clip_from_world =
        scene.home.clip_from_view(aspect, DepthMapping::STANDARD).as_dmat4() * scene.home.view_from_world_f64();
    let of_instance = |instance: &rasterscope::scene::Instance| {
        let mesh = scene.library.mesh(instance.mesh);
        let clip_from_model = clip_from_world * instance.world_from_model.as_dmat4();
        let corner = |vertex: u32| clip_from_model * mesh.positions[vertex as usize].as_dvec3().extend(1.0);
        let fate = |triangle: &[u32; 3]| match (in_double_precision(triangle.map(corner)), culling) {
            (None, _) => Some(TriangleFate::Outside),
            (Some(area), Culling::Back) if area > 0.0 => Some(TriangleFate::BackFacing),
            (Some(area), Culling::Front) if area < 0.0 => Some(TriangleFate::FrontFacing),
            _ => None,
        };
        mesh.triangles.iter().map(fate).collect::<Vec<_>>()
    };
    scene.instances.iter().flat_map(of_instance).collect()
}

/// Settings that decide which fragments there are and which are visible. The independent count knows two of them, and assumes
/// the defaults of the others.
const RULES: [SettingKey; 9] = [
    SettingKey::Arithmetic,
    SettingKey::BlendingOrder,
    SettingKey::Culling,
    SettingKey::DepthBiasConstant,
    SettingKey::DepthBiasSlope,
    SettingKey::DepthFormat,
    SettingKey::DepthTest,
    SettingKey::FillRule,
    SettingKey::Rasterizer,
];

/// Returns a recipe for each culling mode, with and without a depth test.
fn rules() -> Vec<Recipe> {
    let with = |culling: Culling, depth_test: DepthTest| {
        let mut recipe = Recipe::default();
        (recipe.pipeline.culling, recipe.pipeline.depth_test) = (culling, depth_test);
        recipe
    };
    Culling::ALL.iter().flat_map(|culling| [DepthTest::Less, DepthTest::Off].map(|test| with(*culling, test))).collect()
}

/// Returns the recipes of all other settings that affect the drawn samples.
fn other_switches() -> Vec<Recipe> {
    let others = SettingKey::ALL.iter().filter(|key| key.stage() != SettingStage::Upscale && !RULES.contains(key));
    distinct(others.copied().flat_map(switches_of))
}

/// Compares the fates of a frame with the independent count. Returns the fates of the triangles.
fn check(scene: &Scene, recipe: &Recipe) -> Vec<TriangleFate> {
    let frame = render(scene, recipe, SIZE);
    let fates = Fates::of(scene, recipe, &frame);
    let fragments = expected_fragments(scene, recipe, &frame);
    let rejections = expected_rejections(scene, recipe.pipeline.culling);
    for (id, (expected, rejected)) in fragments.iter().zip(&rejections).enumerate() {
        let counted = FragmentFate::ALL.iter().map(|fate| fates.fragments[id].of(*fate));
        assert_eq!(counted.collect::<Vec<_>>(), expected, "triangle {id}, {recipe:?}");
        let best = FragmentFate::ALL.iter().rev().find(|fate| expected[**fate as usize] > 0);
        let fate = rejected.unwrap_or(match best {
            None => TriangleFate::NoCentre,
            Some(FragmentFate::LostDepth) => TriangleFate::LostDepth,
            Some(FragmentFate::AlphaRejected) => TriangleFate::AlphaRejected,
            Some(FragmentFate::Overwritten) => TriangleFate::Overwritten,
            Some(FragmentFate::BlendedOver) => TriangleFate::BlendedOver,
            Some(FragmentFate::Visible) => TriangleFate::Visible,
        });
        assert_eq!(fates.triangles[id], fate, "triangle {id}, {recipe:?}");
    }
    fates.triangles
}

#[test]
fn fates_of_triangles_and_fragments_equal_an_independent_count() {
    let mut met = [false; TriangleFate::ALL.len()];
    for_seeds(12, |rng| {
        let scene = scene(rng);
        for fate in rules().iter().flat_map(|recipe| check(&scene, recipe)) {
            met[fate as usize] = true;
        }
    });
    for fate in [
        TriangleFate::Outside,
        TriangleFate::BackFacing,
        TriangleFate::FrontFacing,
        TriangleFate::NoCentre,
        TriangleFate::LostDepth,
        TriangleFate::Overwritten,
        TriangleFate::BlendedOver,
        TriangleFate::Visible,
    ] {
        assert!(met[fate as usize], "no triangle has the fate {fate:?}");
    }
}

#[test]
fn settings_that_are_no_rules_of_visibility_change_no_fate() {
    let recipes = other_switches();
    for_seeds(2, |rng| {
        let scene = scene(rng);
        recipes.iter().for_each(|recipe| drop(check(&scene, recipe)));
    });
}
