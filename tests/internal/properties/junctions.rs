//! Cracks and double hits at T-junctions and unwelded vertices, checked against hit counts that know nothing about
//! seams. Inside a flat surface every pixel should be hit once.

use glam::{DVec3, Mat4, Quat, Vec3};
use rasterscope::chain::{Frame, Recipe};
use rasterscope::inspect::{FaultKind, Hits, Survey, explain};
use rasterscope::scene::seams::{JunctionKind, SeamCounts, Seams};
use rasterscope::scene::{DepthMapping, Mesh, Projection, Scene};

use crate::internal::common::{SceneBuilder, for_seeds, mesh, recipe, render, signed};

const SIZE: (u32, u32) = (160, 120);

/// Distance from the outline below which a pixel may belong to either side, in pixels.
const OUTLINE_PX: f64 = 0.1;

/// Largest distance of vertices from the edge on which they should lie, in mesh units; well within the tolerance.
const OFF: f32 = 4e-5;

/// Returns fewer than `most` random numbers in (−1, 1), ascending and well separated.
fn stops(rng: &mut fastrand::Rng, most: u32) -> Vec<f32> {
    let count = rng.u32(1..most);
    (1..=count).map(|i| (2.0 * i as f32 + 0.6 * signed(rng)) / (count + 1) as f32 - 1.0).collect()
}

/// Returns a mesh whose upper half is one triangle and whose lower half is a fan along that triangle's edge from (−1,
/// 0) to (1, 0). The outline is convex.
fn fan(rng: &mut fastrand::Rng) -> Mesh {
    let inner: Vec<Vec3> = stops(rng, 40).into_iter().map(|x| Vec3::new(x, OFF * signed(rng), 0.0)).collect();
    let rim = [Vec3::NEG_X].into_iter().chain(inner).chain([Vec3::X]);
    let positions: Vec<_> = [Vec3::new(0.1, 0.9, 0.0), Vec3::new(-0.2, -0.9, 0.0)].into_iter().chain(rim).collect();
    let last = positions.len() as u32 - 1;
    let lower = (2..last).map(|i| [i, 1, i + 1]);
    mesh(positions, [[2, last, 0]].into_iter().chain(lower).collect())
}

/// Returns a mesh of six rows of quads in the square [−1, 1]², with T-junctions where quads of two rows do not match.
fn bricks(rng: &mut fastrand::Rng) -> Mesh {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for row in 0..6 {
        let stops: Vec<f32> = [-1.0].into_iter().chain(stops(rng, 12)).chain([1.0]).collect();
        let y = [row, row + 1].map(|y| y as f32 / 3.0 - 1.0 + if y % 6 == 0 { 0.0 } else { OFF * signed(rng) });
        for pair in stops.windows(2) {
            let first = positions.len() as u32;
            let corners = [(pair[0], y[0]), (pair[1], y[0]), (pair[1], y[1]), (pair[0], y[1])];
            positions.extend(corners.map(|(x, y)| Vec3::new(x, y, 0.0)));
            triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
    }
    mesh(positions, triangles)
}

/// Returns a mesh of quads that share no vertices; each inner vertex is moved by less than the tolerance.
fn unwelded(rng: &mut fastrand::Rng) -> Mesh {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for (x, y) in (0..5).flat_map(|x| (0..5).map(move |y| (x, y))) {
        let first = positions.len() as u32;
        for (dx, dy) in [(0, 0), (1, 0), (1, 1), (0, 1)] {
            let at = Vec3::new((x + dx) as f32, (y + dy) as f32, 0.0) * 0.4 - Vec3::new(1.0, 1.0, 0.0);
            let on_outline = |c: f32| c.abs() > 0.99;
            let moved = Vec3::new(signed(rng), signed(rng), 0.0) * 8e-5;
            positions.push(if on_outline(at.x) || on_outline(at.y) { at } else { at + moved });
        }
        triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    mesh(positions, triangles)
}

/// Returns a scene of the mesh at a random position and orientation, with a random camera in front of it.
fn seen(rng: &mut fastrand::Rng, mesh: Mesh) -> Scene {
    let turn = Quat::from_euler(glam::EulerRot::XYZ, signed(rng), signed(rng), 3.0 * signed(rng));
    let shift = Vec3::new(signed(rng), signed(rng), signed(rng));
    let place = Mat4::from_scale_rotation_translation(Vec3::splat(0.5 + rng.f32()), turn, shift);
    let aside = Vec3::new(signed(rng), signed(rng), 2.0 + 2.0 * rng.f32());
    let mut scene = SceneBuilder::new(Vec3::Z).with(mesh, place, None).0;
    scene.home.eye = place.transform_point3(aside);
    scene.home.target = place.transform_point3(Vec3::new(0.2 * signed(rng), 0.02 * signed(rng), 0.0));
    scene.home.up = turn * Vec3::Y;
    if rng.bool() {
        // The view ranges from a close-up, in which gaps are a tenth of a pixel wide, to the whole mesh.
        scene.home.projection = Projection::Orthographic { height: 0.05 * 40.0_f32.powf(rng.f32()) };
    }
    scene
}

/// Returns points of the mesh projected into the picture, in pixels.
fn projected(scene: &Scene, points: &[Vec3]) -> Vec<DVec3> {
    let clip_from_world = scene.home.clip_from_world_f64(SIZE.0 as f32 / SIZE.1 as f32, DepthMapping::STANDARD);
    let clip_from_model = clip_from_world * scene.instances[0].world_from_model.as_dmat4();
    let px = |point: &Vec3| {
        let ndc = clip_from_model.project_point3(point.as_dvec3());
        DVec3::new((ndc.x + 1.0) * 0.5 * f64::from(SIZE.0), (1.0 - ndc.y) * 0.5 * f64::from(SIZE.1), 0.0)
    };
    points.iter().map(px).collect()
}

/// Returns the pixels that lie well inside the projected convex outline and not close to the avoided points. The
/// outline is counter-clockwise in the mesh.
fn within(scene: &Scene, outline: &[Vec3], avoided: &[Vec3]) -> Vec<(u32, u32)> {
    let (corners, avoided) = (projected(scene, outline), projected(scene, avoided));
    let distance = |from: DVec3, to: DVec3, at: DVec3| -(to - from).normalize().cross(at - from).z;
    let is_within = |(x, y): &(u32, u32)| {
        let centre = DVec3::new(f64::from(*x) + 0.5, f64::from(*y) + 0.5, 0.0);
        let ends = (0..corners.len()).map(|i| (corners[i], corners[(i + 1) % corners.len()]));
        ends.into_iter().all(|(from, to)| distance(from, to, centre) > OUTLINE_PX)
            && avoided.iter().all(|point| point.distance(centre) > 2.0)
    };
    (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (x, y))).filter(is_within).collect()
}

/// Checks the faults found in one view against the hit counts. Returns the numbers of cracks and double hits.
fn check(scene: &Scene, outline: &[Vec3], avoided: &[Vec3], settings: &[&str]) -> [usize; 2] {
    let recipe = recipe(&[&["culling=none"], settings].concat());
    let frame = render(scene, &recipe, SIZE);
    let seams = Seams::of(scene);
    let hits = Hits::of(&frame, &recipe.pipeline).with_seams(scene, &recipe, &frame, &seams);
    let inside = within(scene, outline, avoided);
    let with_count = |wanted: fn(u32) -> bool| -> Vec<(u32, u32)> {
        inside.iter().copied().filter(|(x, y)| wanted(hits.counts.at(*x, *y))).collect()
    };
    let found = |kind| -> Vec<(u32, u32)> {
        let faults = hits.faults.iter().filter(|fault| fault.kind == kind).map(|fault| (fault.x, fault.y));
        faults.filter(|pixel| inside.contains(pixel)).collect()
    };
    let (cracks, doubles) = (with_count(|count| count == 0), with_count(|count| count > 1));
    assert_eq!(found(FaultKind::Crack), cracks);
    assert_eq!(found(FaultKind::DoubleHit), doubles);
    for fault in &hits.faults {
        let count = hits.counts.at(fault.x, fault.y) as usize;
        assert_eq!(fault.hit_by.len(), count);
        assert_eq!(count < fault.due.len(), fault.kind == FaultKind::Crack, "{fault:?}");
        assert!(fault.junction.is_some(), "{fault:?}");
    }
    alone(scene, &recipe, &frame, &seams, &hits);
    [cracks.len(), doubles.len()]
}

/// Checks that pixels with faults, and pixels beside them, get the same result when they are examined alone.
fn alone(scene: &Scene, recipe: &Recipe, frame: &Frame, seams: &Seams, hits: &Hits) {
    let mut survey = Survey::of(scene, recipe, frame);
    survey.set_seams(std::sync::Arc::new(seams.clone()));
    for (x, y) in hits.faults.iter().take(3).flat_map(|fault| [(fault.x, fault.y), (fault.x, fault.y + 1)]) {
        let Some(report) = explain(scene, recipe, frame, &survey, (x, y)) else { continue };
        assert_eq!(report.fault.as_ref(), hits.faults.iter().find(|fault| (fault.x, fault.y) == (x, y)), "{x},{y}");
        if let Some(fault) = &report.fault {
            let name = match fault.junction.map(|junction| junction.kind) {
                Some(JunctionKind::TJunction) => "T-junction: v",
                _ => "Unwelded vertex: v",
            };
            assert!(report.verdict.contains(name), "{}", report.verdict);
        }
    }
}

const SQUARE: [Vec3; 4] =
    [Vec3::new(-1.0, -1.0, 0.0), Vec3::new(1.0, -1.0, 0.0), Vec3::new(1.0, 1.0, 0.0), Vec3::new(-1.0, 1.0, 0.0)];

fn sum([a, b]: &mut [usize; 2], [c, d]: [usize; 2]) {
    (*a, *b) = (*a + c, *b + d);
}

#[test]
fn faults_at_t_junctions_are_exactly_the_pixels_that_are_not_hit_once() {
    let outline = [Vec3::new(-1.0, 0.0, 0.0), Vec3::new(-0.2, -0.9, 0.0), Vec3::X, Vec3::new(0.1, 0.9, 0.0)];
    let mut found = [0; 2];
    for_seeds(150, |rng| {
        let mesh = fan(rng);
        let scene = seen(rng, mesh);
        for settings in [&[][..], &["arithmetic=exact"]] {
            sum(&mut found, check(&scene, &outline, &[], settings));
        }
    });
    assert!(found[0] > 20 && found[1] > 20, "{found:?}");
}

#[test]
fn rows_that_are_shifted_against_each_other_crack_between_all_their_edges() {
    let mut found = [0; 2];
    for_seeds(60, |rng| {
        let mesh = bricks(rng);
        let scene = seen(rng, mesh);
        sum(&mut found, check(&scene, &SQUARE, &[], &[]));
    });
    assert!(found[0] > 20 && found[1] > 20, "{found:?}");
}

#[test]
fn pixels_between_unwelded_vertices_are_found_and_named() {
    // The hole between the corners of four quads belongs to no edge.
    let corners: Vec<_> =
        (1..25).map(|i| Vec3::new((i % 5) as f32, (i / 5) as f32, 0.0) * 0.4 - Vec3::new(1.0, 1.0, 0.0)).collect();
    let mut found = [0; 2];
    for_seeds(60, |rng| {
        let mesh = unwelded(rng);
        let mut scene = seen(rng, mesh);
        assert_eq!(Seams::of(&scene).counts().t_junctions, 0);
        sum(&mut found, check(&scene, &SQUARE, &corners, &[]));
        // Close enough that the gaps are wider than a pixel.
        scene.home.projection = Projection::Orthographic { height: 2e-3 };
        scene.home.target = scene.instances[0].world_from_model.transform_point3(Vec3::new(0.2, 0.0, 0.0));
        sum(&mut found, check(&scene, &SQUARE, &corners, &[]));
    });
    assert!(found[0] > 100 && found[1] > 100, "{found:?}");
}

#[test]
fn faults_are_found_at_seams_that_the_near_plane_clips() {
    let mut found = [0; 2];
    for_seeds(60, |rng| {
        let mesh = bricks(rng);
        let mut scene = SceneBuilder::new(Vec3::Z).with(mesh, Mat4::from_scale(Vec3::splat(3.0)), None).0;
        scene.home.eye = Vec3::new(signed(rng), -1.0 + 0.3 * signed(rng), 0.2 + 0.1 * rng.f32());
        scene.home.target = scene.home.eye + Vec3::new(0.4 * signed(rng), 1.0, -0.1);
        (scene.home.up, scene.home.near) = (Vec3::Z, 0.5);
        let recipe = recipe(&["culling=none"]);
        let frame = render(&scene, &recipe, SIZE);
        let hits = Hits::of(&frame, &recipe.pipeline).with_seams(&scene, &recipe, &frame, &Seams::of(&scene));
        for y in 2..SIZE.1 - 2 {
            for x in 0..SIZE.0 {
                // The surface continues above and below: neither the horizon nor the cut is near.
                let is_within =
                    [-2, -1, 1, 2].iter().all(|step| hits.counts.at(x, y.saturating_add_signed(*step)) == 1);
                let fault = hits.faults.iter().find(|fault| (fault.x, fault.y) == (x, y));
                let expected = match hits.counts.at(x, y) {
                    0 => Some(FaultKind::Crack),
                    1 => None,
                    _ => Some(FaultKind::DoubleHit),
                };
                if is_within {
                    assert_eq!(fault.map(|fault| fault.kind), expected, "{x},{y}");
                    found[usize::from(expected == Some(FaultKind::DoubleHit))] += usize::from(expected.is_some());
                }
            }
        }
    });
    assert!(found[0] > 5 && found[1] > 5, "{found:?}");
}

#[test]
fn an_outline_along_a_seam_is_no_crack_and_culled_triangles_are_ignored() {
    // Both surfaces lie on the same side: a sheet folded along the seam.
    let positions =
        vec![Vec3::NEG_X, Vec3::X, Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 1.0, -0.5), Vec3::new(0.1, 0.0, 0.0)];
    let folded = mesh(positions, vec![[0, 1, 2], [1, 4, 3], [4, 0, 3]]);
    let scene = SceneBuilder::new(Vec3::new(0.3, 0.2, 4.0)).with(folded, Mat4::from_rotation_z(0.4), None).0;
    let seams = Seams::of(&scene);
    assert_eq!(seams.counts(), SeamCounts { t_junctions: 1, unwelded: 0 });
    for culling in ["none", "back", "front"] {
        let recipe = recipe(&[&format!("culling={culling}")]);
        for width in 50..150 {
            let frame = render(&scene, &recipe, (width, 90));
            let hits = Hits::of(&frame, &recipe.pipeline).with_seams(&scene, &recipe, &frame, &seams);
            assert_eq!(hits.faults, []);
        }
    }
}
