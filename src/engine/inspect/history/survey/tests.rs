use std::collections::BTreeSet;

use glam::{Mat4, Vec3};

use super::*;
use crate::chain::{redraw, run};
use crate::inspect::{PixelReport, explain};
use crate::pipeline::settings::{Arithmetic, Choice, DepthFormat};
use crate::pipeline::{Geometry, LastStage};
use crate::scene::{Instance, Library, Material, Mesh, MeshData, builtin};
use crate::upscale::{Anchor, Upscaling};

const VIEW: Viewport = Viewport { width: 40, height: 28 };

fn frame(scene: &Scene, recipe: &Recipe, camera: &Camera) -> Frame {
    run(scene, camera, recipe, VIEW, &mut ())
}

/// Builds a scene with one object of unconnected triangles, seen from (0, 0, 3).
fn scene_of(triangles: &[[Vec3; 3]], world_from_model: Mat4) -> Scene {
    let mut library = Library::default();
    let positions: Vec<Vec3> = triangles.concat();
    let numbers = (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let mesh = Mesh::new(MeshData { positions, triangles: numbers, ..MeshData::default() }).unwrap();
    let (mesh, material) = (library.add_mesh(mesh), library.add_material(Material::default()));
    let instance = Instance { name: "wall".into(), mesh, material, world_from_model, tint: Vec3::ONE };
    let home = Camera::look_at(Vec3::Z * 3.0, Vec3::ZERO);
    Scene {
        name: "test".into(),
        library,
        instances: vec![instance],
        background: [0; 3],
        home,
        views: Vec::new(),
        light: None,
        animation: None,
    }
}

fn soup(count: usize) -> Scene {
    let mut random = fastrand::Rng::with_seed(12);
    let mut place = || Vec3::new(random.f32(), random.f32(), random.f32()) * 2.0 - 1.0;
    let triangles: Vec<_> = (0..count).map(|_| [place(), place(), place()]).collect();
    scene_of(&triangles, Mat4::IDENTITY)
}

/// Explains all pixels of a frame, in reading order.
fn reports(scene: &Scene, recipe: &Recipe, frame: &Frame) -> Vec<PixelReport> {
    let survey = Survey::of(scene, recipe, frame);
    let pixels = (0..VIEW.height).flat_map(|y| (0..VIEW.width).map(move |x| (x, y)));
    pixels.filter_map(|pixel| explain(scene, recipe, frame, &survey, pixel)).collect()
}

fn absent(report: &PixelReport, cause: Cause) -> BTreeSet<TriangleId> {
    report.absent.iter().filter(|a| a.cause == cause).map(|a| a.triangle).collect()
}

fn there(report: &PixelReport) -> BTreeSet<TriangleId> {
    report.fragments.iter().map(|f| f.triangle).collect()
}

#[test]
fn surveyed_positions_match_the_rasterized_triangles_bit_for_bit() {
    let recipes = [
        Recipe::default(),
        Recipe { upscaler: Upscaling::new("bilinear", 2).unwrap(), ..Recipe::default() },
        Recipe { upscaler: Upscaling::new("bilinear", 2).unwrap().with_anchor(Anchor::Centre), ..Recipe::default() },
    ];
    let mut others = [Recipe::default(); 3];
    others[0].pipeline.culling = Culling::Front;
    others[1].pipeline.arithmetic = Arithmetic::F32;
    others[2].pipeline.depth_format = DepthFormat::ReversedInfinite;
    let mut count = 0;
    for id in ["near-plane", "stained-glass", "slivers"] {
        let scene = builtin::by_id(id).unwrap().build();
        for recipe in recipes.iter().chain(&others) {
            let mut frame = frame(&scene, recipe, &scene.home);
            let whole = Survey::of(&scene, recipe, &frame);
            assert!(whole.triangles.dropped.iter().all(|d| d.cause != Cause::NotDrawnYet), "{id}");
            let bits = |corners: [[f32; 2]; 3]| corners.map(|corner| corner.map(f32::to_bits));
            let mut drawn: Vec<_> = frame.geometry().triangles.iter().map(|t| (t.id, bits(t.corners_px()))).collect();
            frame.geometry_mut().triangles.clear();
            let survey = Survey::of(&scene, recipe, &frame);
            let mut kept: Vec<_> = survey.triangles.rasterized.iter().map(|d| (d.id, bits(d.corners_px))).collect();
            drawn.sort_unstable();
            kept.sort_unstable();
            count += kept.len();
            assert_eq!(kept, drawn, "{id} {recipe:?}");
        }
    }
    assert!(count > 10_000, "{count}");
}

#[test]
fn a_survey_is_valid_for_earlier_states_of_its_frame_but_not_for_another_view() {
    let scene = soup(60);
    let recipe = Recipe::default();
    let mut frame = frame(&scene, &recipe, &scene.home);
    let survey = Survey::of(&scene, &recipe, &frame);
    let half = frame.geometry().triangles.len() / 2;
    frame.geometry_mut().triangles.truncate(half);
    assert!(survey.fits(&recipe, &frame));
    let anew = Survey::of(&scene, &recipe, &frame);
    let mut later = 0;
    for pixel in (0..VIEW.height).flat_map(|y| (0..VIEW.width).map(move |x| (x, y))) {
        let [kept, anew] = [&survey, &anew].map(|survey| explain(&scene, &recipe, &frame, survey, pixel).unwrap());
        later += absent(&kept, Cause::NotDrawnYet).len();
        assert!(absent(&kept, Cause::NotDrawnYet).is_disjoint(&there(&kept)));
        assert_eq!(kept, anew);
    }
    assert!(later > 100, "{later}");
    let mut camera = scene.home;
    camera.orbit(0.1, 0.0);
    assert!(!survey.fits(&recipe, &run(&scene, &camera, &recipe, VIEW, &mut ())));
}

#[test]
fn back_faces_are_reported_exactly_where_they_would_have_a_fragment() {
    let scene = soup(60);
    for arithmetic in Arithmetic::ALL {
        let mut recipe = Recipe::default();
        recipe.pipeline.arithmetic = *arithmetic;
        let mut both_sides = recipe;
        both_sides.pipeline.culling = Culling::None;
        let culled = reports(&scene, &recipe, &frame(&scene, &recipe, &scene.home));
        let whole = reports(&scene, &both_sides, &frame(&scene, &both_sides, &scene.home));
        let mut count = 0;
        for (culled, whole) in culled.iter().zip(&whole) {
            let reported = absent(culled, Cause::BackFacing);
            count += reported.len();
            let all: BTreeSet<_> = there(culled).union(&reported).copied().collect();
            assert_eq!(all, there(whole), "{arithmetic:?} ({}, {})", culled.x, culled.y);
        }
        assert!(count > 500, "{count}");
    }
}

#[test]
fn the_near_plane_is_reported_exactly_where_a_nearer_plane_would_show_the_triangle() {
    let scene = builtin::by_id("near-plane").unwrap().build();
    for format in [DepthFormat::F32, DepthFormat::ReversedF32] {
        let mut recipe = Recipe::default();
        recipe.pipeline.depth_format = format;
        let nearer = Camera { near: 1e-3, ..scene.home };
        let cut = reports(&scene, &recipe, &frame(&scene, &recipe, &scene.home));
        let whole = reports(&scene, &recipe, &frame(&scene, &recipe, &nearer));
        let mut count = 0;
        for (cut, whole) in cut.iter().zip(&whole) {
            let reported = absent(cut, Cause::NearPlane);
            count += reported.len();
            let all: BTreeSet<_> = there(cut).union(&reported).copied().collect();
            // Snapping moves edges by a fraction of a pixel. If an edge moves across the pixel's centre, the triangle
            // is reported as a near miss.
            let beside = |id: &TriangleId| {
                let passes = |r: &PixelReport| {
                    r.absent.iter().any(|a| a.triangle == *id && a.distance_px.is_some_and(|d| d < 1.0 / 64.0))
                };
                passes(cut) || passes(whole)
            };
            let differing: Vec<_> = all.symmetric_difference(&there(whole)).copied().collect();
            assert!(differing.iter().all(beside), "{format:?} ({}, {}): {differing:?}", cut.x, cut.y);
        }
        assert!(count > 50, "{count}");
    }
}

#[test]
fn a_triangle_beyond_the_far_plane_is_reported_with_its_distance() {
    let triangle = [Vec3::new(-1.0, -1.0, 0.0), Vec3::new(1.0, -1.0, 0.0), Vec3::Y];
    let scene = scene_of(&[triangle], Mat4::IDENTITY);
    for format in [DepthFormat::F32, DepthFormat::ReversedF32, DepthFormat::WBuffer] {
        let mut recipe = Recipe::default();
        recipe.pipeline.depth_format = format;
        let camera = Camera { near: 0.5, far: 2.0, ..scene.home };
        let reports = reports(&scene, &recipe, &frame(&scene, &recipe, &camera));
        let middle = &reports[(14 * VIEW.width + 20) as usize];
        assert_eq!(
            middle.verdict,
            "Background: triangle 0 of “wall” would cover it 3.0000 units from the eye, beyond the far plane at 2, and \
             is clipped there: to show it, move the far plane."
        );
    }
}

#[test]
fn triangles_after_the_last_drawn_one_are_reported() {
    let scene = soup(30);
    let recipe = Recipe::default();
    let mut frame = frame(&scene, &recipe, &scene.home);
    let whole: Vec<_> = reports(&scene, &recipe, &frame).iter().map(there).collect();
    let half = frame.geometry().triangles.len() / 2;
    frame.geometry_mut().triangles.truncate(half);
    let drawn = redraw(&scene, &recipe, &frame, LastStage::Shade, &mut ());
    let frame = frame.at_moment(&recipe, drawn, Geometry::clone(frame.geometry()));
    let mut count = 0;
    for (cut, whole) in reports(&scene, &recipe, &frame).iter().zip(&whole) {
        let reported = absent(cut, Cause::NotDrawnYet);
        count += reported.len();
        assert_eq!(&there(cut).union(&reported).copied().collect::<BTreeSet<_>>(), whole);
    }
    assert!(count > 100, "{count}");
}

#[test]
fn a_triangle_with_a_non_finite_corner_is_reported_at_every_pixel() {
    let triangle = [Vec3::new(-1.0, -1.0, 0.0), Vec3::new(1.0, -1.0, 0.0), Vec3::Y];
    let mut scene = scene_of(&[triangle], Mat4::IDENTITY);
    let broken = Instance { world_from_model: Mat4::NAN, ..scene.instances[0].clone() };
    scene.instances.push(broken);
    let recipe = Recipe::default();
    let reports = reports(&scene, &recipe, &frame(&scene, &recipe, &scene.home));
    assert!(reports.iter().all(|r| absent(r, Cause::NotFinite) == BTreeSet::from([TriangleId(1)])));
    let corner = &reports[0].verdict;
    assert!(corner.starts_with("Background: the nearest triangle, 0 of “wall”, misses by "), "{corner}");
    assert!(
        corner.ends_with("But triangle 1 of “wall” has a NaN or infinite corner in clip space, so it is never drawn."),
        "{corner}"
    );
}

#[test]
fn a_triangle_without_area_is_reported_where_it_passes() {
    // A triangle seen edge-on.
    let edge_on = [Vec3::new(-1.0, 0.0, 0.0), Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 0.0, 1.0)];
    let scene = scene_of(&[edge_on], Mat4::IDENTITY);
    // With an odd number of rows, the horizon passes through pixel centres.
    let view = Viewport { width: 41, height: 27 };
    let recipe = Recipe::default();
    let frame = run(&scene, &scene.home, &recipe, view, &mut ());
    let survey = Survey::of(&scene, &recipe, &frame);
    let report = explain(&scene, &recipe, &frame, &survey, (20, 13)).unwrap();
    assert!(report.verdict.contains("passes through it, but its snapped corners are collinear"), "{}", report.verdict);
    let above = explain(&scene, &recipe, &frame, &survey, (20, 12)).unwrap();
    assert!(absent(&above, Cause::ZeroArea).is_empty());
}
