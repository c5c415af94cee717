//! Checks that no input breaks the pipeline: every triangle is drawn or has exactly one fate, and drawn triangles lie
//! at their exact position.

use std::collections::{HashMap, HashSet};

use glam::{DVec4, Mat4, Vec3, Vec4};
use rasterscope::chain::{Recipe, run};
use rasterscope::image::{Image, Rgba8};
use rasterscope::pipeline::clip_space::ClipVertex;
use rasterscope::pipeline::from_clip_space;
use rasterscope::pipeline::interpolate::{AttributeSelection, Fragment, interpolate};
use rasterscope::pipeline::observe::{Counters, Fate, Observer};
use rasterscope::pipeline::raster::cover;
use rasterscope::pipeline::screen_triangle::{ScreenTriangle, depth_at};
use rasterscope::pipeline::settings::{Arithmetic, Choice as _, FillRule, Interpolation, Rasterizer};
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::scene::{Camera, Scene, TriangleId};

use crate::internal::common::{
    SceneBuilder, covered, cube, for_seeds, in_cube, mesh, plane, render, screen_triangles, signed, soup,
};

const VIEW: Viewport = Viewport { width: 40, height: 30 };

/// Observer that records the fates of each rejected triangle.
#[derive(Default)]
struct Fates(HashMap<TriangleId, Vec<Fate>>);

impl Observer for Fates {
    fn rejected(&mut self, id: TriangleId, fate: Fate) {
        self.0.entry(id).or_default().push(fate);
    }
}

/// Panics unless every triangle is either drawn, completely or in pieces, or has exactly one fate.
fn assert_fates_add_up(triangle_count: usize, fates: &Fates, drawn: &[ScreenTriangle]) {
    for id in (0..triangle_count as u32).map(TriangleId) {
        let is_drawn = drawn.iter().any(|t| t.id == id);
        let fates = fates.0.get(&id).map_or(&[][..], Vec::as_slice);
        assert_eq!(usize::from(is_drawn) + fates.len(), 1, "{id:?}: drawn {is_drawn}, fates {fates:?}");
    }
}

fn fates_of(scene: &Scene, camera: &Camera, recipe: &Recipe) {
    let mut fates = Fates::default();
    let frame = run(scene, camera, recipe, VIEW, &mut fates);
    assert_fates_add_up(scene.triangle_count(), &fates, &frame.geometry().triangles);
    let mut counters = Counters::default();
    run(scene, camera, recipe, VIEW, &mut counters);
    let rejected: Vec<_> = Fate::ALL.iter().map(|f| fates.0.values().flatten().filter(|g| f == *g).count()).collect();
    assert_eq!(counters.rejected.map(|n| n as usize), *rejected);
}

#[test]
fn every_triangle_of_a_scene_is_drawn_or_has_exactly_one_fate() {
    for_seeds(60, |rng| {
        let scene = SceneBuilder::new(in_cube(rng) * 2.0)
            .with(soup(rng, 40), Mat4::IDENTITY, None)
            .with(plane(), Mat4::from_scale(Vec3::splat(100.0)), None)
            .with(plane(), Mat4::from_translation(Vec3::Y * 1e4), None)
            .0;
        for culling in ["none", "back", "front"] {
            let mut recipe = Recipe::default();
            recipe.set(&format!("culling={culling}")).unwrap();
            fates_of(&scene, &scene.home, &recipe);
        }
    });
}

/// Returns a random finite float of any magnitude and sign.
fn any_finite(rng: &mut fastrand::Rng) -> f32 {
    loop {
        let value = f32::from_bits(rng.u32(..));
        if value.is_finite() {
            return value;
        }
    }
}

#[test]
fn meshes_of_any_finite_coordinates_are_drawn_without_panic() {
    for_seeds(100, |rng| {
        let positions = (0..300).map(|_| {
            // One coordinate of any magnitude with two ordinary ones, or three of any magnitude.
            if rng.bool() {
                in_cube(rng).with_x(any_finite(rng))
            } else {
                Vec3::from_array([0; 3].map(|_| any_finite(rng)))
            }
        });
        let mesh = mesh(positions.collect(), (0..100).map(|i| [0, 1, 2].map(|c| i * 3 + c)).collect());
        let scene = SceneBuilder::new(Vec3::new(0.3, 0.4, 2.0)).with(mesh, Mat4::IDENTITY, None).0;
        for camera in [scene.home, scene.home.with_orthographic(true), Camera::fit(scene.bounds(), Vec3::ONE)] {
            fates_of(&scene, &camera, &Recipe::default());
        }
    });
}

/// Observer that panics if a fragment contains a number that is not finite, and counts fragments.
struct OnlyFinite(usize);

impl Observer for OnlyFinite {
    fn shaded(&mut self, triangle: &ScreenTriangle, fragment: &Fragment, _color: Rgba8) {
        let all = interpolate(triangle, fragment.sample, AttributeSelection::all(Interpolation::Perspective));
        let finite = fragment.weights.iter().all(|w| w.is_finite())
            && depth_at(triangle, &fragment.sample).is_finite()
            && all.source_weights.is_finite();
        assert!(finite, "{fragment:?} of {triangle:?}");
        self.0 += 1;
    }
}

#[test]
fn no_fragment_of_any_finite_triangle_carries_a_nan() {
    let mut watch = OnlyFinite(0);
    for_seeds(100, |rng| {
        let size = 10.0_f32.powi(rng.i32(-20..30));
        let positions = (0..90).map(|_| in_cube(rng) * if rng.u8(..4) == 0 { any_finite(rng) } else { size });
        let mesh = mesh(positions.collect(), (0..30).map(|i| [0, 1, 2].map(|c| i * 3 + c)).collect());
        let mut scene = SceneBuilder::new(in_cube(rng) * size).with(mesh, Mat4::IDENTITY, None).0;
        scene.home.near = scene.home.distance() * 10.0_f32.powi(rng.i32(-12..0));
        let mut recipe = Recipe::default();
        recipe.set("culling=none").unwrap();
        recipe.set("depth-test=off").unwrap();
        run(&scene, &scene.home, &recipe, VIEW, &mut watch);
    });
    assert!(watch.0 > 100_000, "only {} fragments", watch.0);
}

/// Returns a random clip-space coordinate: any bit pattern, a limit such as 0 or the largest float, or an ordinary
/// number.
fn hostile(rng: &mut fastrand::Rng) -> f32 {
    match rng.u8(..6) {
        0 => f32::from_bits(rng.u32(..)),
        1 => *rng.choice(&[0.0, -0.0, 1.0, -1.0, f32::MAX, f32::MIN, f32::MIN_POSITIVE, 1e-45, -1e-45]).unwrap_or(&0.0),
        2 => any_finite(rng),
        _ => signed(rng) * 2.0,
    }
}

#[test]
fn clip_vertices_of_any_bits_end_in_one_fate_or_inside_the_guard_band() {
    const TRIANGLES: u32 = 100_000;
    let mut rng = fastrand::Rng::with_seed(1);
    let vertices: Vec<_> =
        (0..TRIANGLES * 3).map(|_| ClipVertex::at(Vec4::from_array([0; 4].map(|_| hostile(&mut rng))))).collect();
    let triangles: Vec<_> = (0..TRIANGLES).map(|i| [0, 1, 2].map(|c| i * 3 + c)).collect();
    let mut fates = Fates::default();
    let drawn = screen_triangles(&vertices, &triangles, VIEW, &mut fates);
    for triangle in &drawn {
        for v in &triangle.vertices {
            let (x, y) = (f64::from(v.x) / 256.0, f64::from(v.y) / 256.0);
            let reach = 32_768.0 + 1.0;
            assert!((x - 20.0).abs() <= reach && (y - 15.0).abs() <= reach, "({x}, {y}) px");
            assert!((0.0..=1.0).contains(&v.depth) && v.inv_w > 0.0 && v.inv_w.is_finite(), "{v:?}");
            assert!(v.varyings.source_weights.is_finite(), "{v:?}");
        }
        assert!(triangle.relative_inv_w.iter().all(|r| *r > 0.0 && *r <= 1.0), "{triangle:?}");
    }
    assert!(drawn.len() > 5_000, "only {} drawn", drawn.len());
    let ids: HashSet<_> = drawn.iter().map(|t| t.id).collect();
    assert!(fates.0.iter().all(|(id, fates)| fates.len() == 1 && !ids.contains(id)));
    assert_eq!(fates.0.len() + ids.len(), TRIANGLES as usize);
}

#[test]
fn a_million_triangles_of_random_bits_are_drawn_within_the_picture_or_have_a_fate() {
    const TRIANGLES: u32 = 1_000_000;
    let ways: Vec<_> = Rasterizer::ALL.iter().flat_map(|r| Arithmetic::ALL.iter().map(move |a| (*r, *a))).collect();
    let (mut drawn, mut rejected, mut covered) = (0_u64, 0_u64, 0_u64);
    let mut rng = fastrand::Rng::with_seed(29);
    for number in 0..TRIANGLES {
        let vertices = [0; 3].map(|_| ClipVertex::at(Vec4::from_array([0; 4].map(|_| f32::from_bits(rng.u32(..))))));
        let (rasterizer, arithmetic) = ways[number as usize % ways.len()];
        let mut fates = Counters::default();
        let triangles = from_clip_space(&vertices, &[[0, 1, 2]], arithmetic, VIEW, &mut fates);
        let fated: u64 = fates.rejected.iter().sum();
        assert_eq!(fated, u64::from(triangles.is_empty()), "{vertices:?}");
        rejected += fated;
        drawn += triangles.len() as u64;
        // Also uses the same bits as screen positions, without clipping.
        let untamed = vertices.map(|v| [v.position.x, v.position.y]);
        for corners_px in triangles.iter().map(ScreenTriangle::corners_px).chain([untamed]) {
            for span in cover(rasterizer, arithmetic, corners_px, FillRule::TopLeft, VIEW) {
                assert!(span.row < VIEW.height && span.left < span.right && span.right <= VIEW.width, "{vertices:?}");
                covered += u64::from(span.right - span.left);
            }
        }
    }
    assert!(rejected > 500_000 && drawn > 10_000 && covered > 1_000_000, "{rejected} {drawn} {covered}");
}

#[test]
fn coverage_of_random_clip_triangles_agrees_with_homogeneous_edge_functions() {
    let (mut inside, mut undecided) = (0, 0);
    for_seeds(3_000, |rng| {
        let scale = 10.0_f32.powi(rng.i32(-3..4));
        let vertices = [0; 3].map(|_| {
            let stretch = 10.0_f32.powi(rng.i32(0..6)) * scale;
            ClipVertex::at(Vec4::new(
                signed(rng) * stretch,
                signed(rng) * stretch,
                signed(rng) * scale,
                signed(rng) * scale,
            ))
        });
        let drawn = screen_triangles(&vertices, &[[0, 1, 2]], VIEW, &mut ());
        let exact = vertices.map(|v| v.position.as_dvec4());
        let mut hits = Image::filled(VIEW.width, VIEW.height, 0);
        for sample in drawn.iter().flat_map(|t| covered(t, Rasterizer::Tiled, FillRule::TopLeft, VIEW)) {
            hits.set(sample.x, sample.y, hits.at(sample.x, sample.y) + 1);
        }
        for y in 0..VIEW.height {
            for x in 0..VIEW.width {
                let count = hits.at(x, y);
                match homogeneous_coverage(exact, (f64::from(x) + 0.5, f64::from(y) + 0.5)) {
                    Some(expected) => assert_eq!(count, usize::from(expected), "({x}, {y}) {vertices:?}"),
                    None => undecided += 1,
                }
                inside += count;
            }
        }
    });
    assert!(inside > 100_000 && undecided < inside, "{inside} inside, {undecided} too close to an edge to decide");
}

/// Returns whether the ray through a pixel position hits the triangle in front of the eye and between near and far
/// (Olano and Greer, "Triangle Scan Conversion using 2D Homogeneous Coordinates", 1997). Returns `None` within a
/// fiftieth of a pixel of any boundary, where snapping and rounding may decide.
fn homogeneous_coverage(triangle: [DVec4; 3], (px, py): (f64, f64)) -> Option<bool> {
    let side = |x: f64, y: f64| {
        let ray = glam::DVec3::new(x / 20.0 - 1.0, 1.0 - y / 15.0, 1.0);
        let [a, b, c] = triangle.map(|v| glam::DVec3::new(v.x, v.y, v.w));
        // Weights of the homogeneous point of the triangle on the ray, up to a common factor.
        let q = [b.cross(c).dot(ray), c.cross(a).dot(ray), a.cross(b).dot(ray)];
        let volume = a.dot(b.cross(c)).signum();
        let weights = q.map(|q| q * volume);
        let z: f64 = (0..3).map(|i| triangle[i].z * weights[i]).sum();
        let w: f64 = (0..3).map(|i| triangle[i].w * weights[i]).sum();
        weights.iter().all(|q| *q > 0.0) && z > 0.0 && z < w
    };
    let center = side(px, py);
    let steps = [-0.02, 0.0, 0.02];
    let around = steps.into_iter().flat_map(|dx| steps.map(|dy| side(px + dx, py + dy)));
    around.into_iter().all(|beside| beside == center).then_some(center)
}

#[test]
fn an_object_far_from_the_origin_looks_as_at_the_origin() {
    // The vertices of the distant cube are exact: integer coordinates and an integer offset.
    let picture = |offset: Vec3| {
        let mut scene = SceneBuilder::new(Vec3::ZERO).with(cube(), Mat4::from_translation(offset), None).0;
        scene.home = Camera::look_at(offset + Vec3::new(2.0, 3.0, 4.0), offset);
        render(&scene, &Recipe::default(), (VIEW.width, VIEW.height)).image().clone()
    };
    assert_eq!(picture(Vec3::new(3e6, -1e6, 2e6)), picture(Vec3::ZERO));
}

#[test]
fn tiny_pictures_are_drawn() {
    let scene = crate::internal::common::ground_and_cube();
    for size in [(1, 1), (1, 7), (7, 1), (2, 3)] {
        assert_eq!(render(&scene, &Recipe::default(), size).image().size(), size);
    }
}
