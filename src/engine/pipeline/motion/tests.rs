use std::sync::Arc;

use glam::{DVec3, Mat4, Vec3};

use super::*;
use crate::pipeline::framebuffer::Framebuffer;
use crate::pipeline::grid::SampleGrid;
use crate::pipeline::settings::{Settings, Shading};
use crate::pipeline::{DrawCall, Extent, prepare};
use crate::scene::builtin;

const SIZE: Viewport = Viewport { width: 128, height: 72 };

/// Scene and camera of the current frame, and those of the preceding one.
struct Pair {
    name: &'static str,
    now: (Scene, Camera),
    before: (Scene, Camera),
}

impl Pair {
    fn views(&self) -> [FrameView<'_>; 2] {
        [&self.now, &self.before].map(|(scene, camera)| FrameView { scene, camera })
    }
}

/// Returns pairs of frames with moving cameras, a moving object, and a deformed mesh.
fn pairs() -> Vec<Pair> {
    let cubes = builtin::by_id("cubes").unwrap().build();
    let chess = builtin::by_id("chess").unwrap().build();
    let home = cubes.home;
    let mut orbited = home;
    orbited.orbit(0.12, 0.04);
    let mut near = chess.home;
    near.dolly(0.3);
    let mut nearer = near;
    nearer.fly(Vec3::new(0.01, 0.0, 0.02));
    let tilted = Camera { up: Vec3::new(0.05, 1.0, 0.0), ..chess.home };
    let mut moved = cubes.clone();
    let turn = Mat4::from_rotation_y(0.3) * Mat4::from_translation(Vec3::new(0.3, 0.1, -0.2));
    moved.instances.iter_mut().for_each(|instance| instance.world_from_model = turn * instance.world_from_model);
    let mut bent = cubes.clone();
    bent.library = bent.library.with_meshes(|mesh| {
        let mut data = (**mesh).clone();
        data.positions.iter_mut().for_each(|position| position.x += 0.2 * position.y * position.y + 0.03);
        Mesh::new(data).unwrap()
    });
    let flat = |camera: Camera| camera.with_orthographic(true);
    let pair = |name, now: (&Scene, Camera), before: (&Scene, Camera)| Pair {
        name,
        now: (now.0.clone(), now.1),
        before: (before.0.clone(), before.1),
    };
    vec![
        pair("camera orbit", (&cubes, home), (&cubes, orbited)),
        pair("camera flight through clipped geometry", (&chess, near), (&chess, nearer)),
        pair("camera roll", (&chess, chess.home), (&chess, tilted)),
        pair("orthographic orbit", (&cubes, flat(home)), (&cubes, flat(orbited))),
        pair("change of projection", (&cubes, home), (&cubes, flat(home))),
        pair("moving object", (&moved, home), (&cubes, home)),
        pair("deformed mesh and moving camera", (&bent, home), (&cubes, orbited)),
    ]
}

/// Returns the triangle ids and distances that a view shows.
fn shown(view: FrameView<'_>, size: Viewport) -> (Image<Rgba8>, Image<f32>) {
    let settings = Settings { shading: Shading::TriangleId, exact_ids: true, ..Settings::default() };
    let geometry = prepare(view.scene, view.camera, &settings, size, &mut ());
    let mut drawn = Framebuffer::new(SampleGrid::FULL, size.width, size.height, view.scene.background, &settings);
    DrawCall::new(view.scene, &geometry, &settings, &Extent::all(&geometry, size)).draw(&mut drawn, &mut ());
    let distances = drawn.depth.unwrap().map(|depth| geometry.depth_scale.distance_of(depth) as f32);
    (drawn.color, distances)
}

fn gbuffer(view: FrameView<'_>, size: Viewport) -> GBuffer {
    let (mut object, distance) = shown(view, size);
    FrameMotion::new(view, None, object.size()).resolve(Lanes::best(), &mut object, &distance, None);
    GBuffer { object, distance }
}

/// Eye and axes of a camera, computed without its matrices.
struct Eye {
    eye: DVec3,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    /// Half of the visible width and height, at distance 1 in perspective.
    half: [f64; 2],
    in_perspective: bool,
    size_px: [f64; 2],
}

impl Eye {
    fn new(camera: &Camera, size: Viewport) -> Self {
        let eye = camera.eye.as_dvec3();
        let forward = (camera.target.as_dvec3() - eye).normalize();
        let right = forward.cross(camera.up.as_dvec3()).normalize();
        let (height, in_perspective) = match camera.projection {
            Projection::Perspective { fov_y } => ((f64::from(fov_y) / 2.0).tan(), true),
            Projection::Orthographic { height } => (f64::from(height) / 2.0, false),
        };
        let size_px = [f64::from(size.width), f64::from(size.height)];
        let aspect = size_px[0] / size_px[1];
        Self { eye, right, up: right.cross(forward), forward, half: [height * aspect, height], in_perspective, size_px }
    }

    /// Returns origin and direction of the ray through a position in pixels.
    fn ray(&self, x: f64, y: f64) -> (DVec3, DVec3) {
        let [x, y] = [2.0 * x / self.size_px[0] - 1.0, 1.0 - 2.0 * y / self.size_px[1]];
        let offset = self.right * (x * self.half[0]) + self.up * (y * self.half[1]);
        if self.in_perspective { (self.eye, self.forward + offset) } else { (self.eye + offset, self.forward) }
    }

    /// Projects a point to a position in pixels and a distance along the view axis.
    fn project(&self, point: DVec3) -> ([f64; 2], f64) {
        let from_eye = point - self.eye;
        let distance = from_eye.dot(self.forward);
        let spread = if self.in_perspective { distance } else { 1.0 };
        let x = from_eye.dot(self.right) / (self.half[0] * spread);
        let y = from_eye.dot(self.up) / (self.half[1] * spread);
        ([(x + 1.0) / 2.0 * self.size_px[0], (1.0 - y) / 2.0 * self.size_px[1]], distance)
    }
}

/// Returns the corners of every triangle in world space, in the order of the ids.
fn world_triangles(scene: &Scene) -> Vec<[DVec3; 3]> {
    let of = |instance: &crate::scene::Instance| {
        let (mesh, world) = (scene.library.mesh(instance.mesh), instance.world_from_model.as_dmat4());
        let corner = |vertex: u32| world.transform_point3(mesh.positions[vertex as usize].as_dvec3());
        mesh.triangles.iter().map(|corners| corners.map(corner)).collect::<Vec<_>>()
    };
    scene.instances.iter().flat_map(of).collect()
}

/// Intersects a ray with the plane of a triangle: returns the ray parameter and the weights of the second and third
/// corner (Möller and Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", 1997).
fn hit((origin, direction): (DVec3, DVec3), [a, b, c]: [DVec3; 3]) -> Option<(f64, [f64; 2])> {
    let (ab, ac) = (b - a, c - a);
    let p = direction.cross(ac);
    let det = ab.dot(p);
    let s = origin - a;
    let q = s.cross(ab);
    (det != 0.0).then(|| (ac.dot(q) / det, [s.dot(p) / det, direction.dot(q) / det]))
}

#[test]
fn vectors_agree_with_an_independent_projection() {
    for pair in pairs() {
        let [now, before] = pair.views();
        let gbuffer = gbuffer(before, SIZE);
        let (mut ids, distances) = shown(now, SIZE);
        let drawn = ids.clone();
        let motion = FrameMotion::new(now, Some(FrameBefore { view: before, gbuffer: &gbuffer }), ids.size());
        let vectors = motion.resolve(Lanes::best(), &mut ids, &distances, None).unwrap();
        let (eye, eye_before) = (Eye::new(now.camera, SIZE), Eye::new(before.camera, SIZE));
        let (triangles, triangles_before) = (world_triangles(now.scene), world_triangles(before.scene));
        let (mut largest_px, mut measured): (f64, u32) = (0.0, 0);
        for (x, y) in (0..SIZE.height).flat_map(|y| (0..SIZE.width).map(move |x| (x, y))) {
            let Some(triangle) = triangles.get(u32::from_le_bytes(drawn.at(x, y)) as usize) else { continue };
            let center = [f64::from(x) + 0.5, f64::from(y) + 0.5];
            let (_, [v, w]) = hit(eye.ray(center[0], center[1]), *triangle).unwrap();
            let [a, b, c] = triangles_before[u32::from_le_bytes(drawn.at(x, y)) as usize];
            let ([place_x, place_y], distance) = eye_before.project(a + (b - a) * v + (c - a) * w);
            let vector = [vectors.across_px.at(x, y), vectors.down_px.at(x, y)].map(f64::from);
            let error = (vector[0] + center[0] - place_x).hypot(vector[1] + center[1] - place_y);
            largest_px = largest_px.max(error);
            let found = motion.of_pixel((x, y), drawn.at(x, y), distances.at(x, y)).distance;
            // The distance of a still point is that of its rounded depth.
            let expected = if vector == [0.0; 2] { f64::from(distances.at(x, y)) } else { distance };
            assert!((f64::from(found) - expected).abs() < 1e-5 * distance, "{} ({x}, {y})", pair.name);
            measured += 1;
        }
        assert!(measured > 1600, "{}: {measured}", pair.name);
        assert!(largest_px < 1.0 / 256.0, "{}: {largest_px} px", pair.name);
    }
}

/// Disoccluded pixels: found and true ones, found ones, and true ones.
#[derive(Debug, Default)]
struct Counts {
    both: u32,
    found: u32,
    exact: u32,
}

#[test]
fn disocclusion_agrees_with_rays_to_all_triangles() {
    const LARGE: Viewport = Viewport { width: 960, height: 540 };
    let mut counts = Counts::default();
    for pair in pairs().into_iter().filter(|pair| !pair.name.contains("clipped") && !pair.name.contains("roll")) {
        let [now, before] = pair.views();
        let gbuffer = gbuffer(before, LARGE);
        let (mut ids, distances) = shown(now, LARGE);
        let drawn = ids.clone();
        let motion = FrameMotion::new(now, Some(FrameBefore { view: before, gbuffer: &gbuffer }), ids.size());
        let vectors = motion.resolve(Lanes::best(), &mut ids, &distances, None).unwrap();
        let (eye, eye_before) = (Eye::new(now.camera, LARGE), Eye::new(before.camera, LARGE));
        let (triangles, triangles_before) = (world_triangles(now.scene), world_triangles(before.scene));
        let every = |length: u32| (1..length).step_by(4);
        for (x, y) in every(LARGE.height).flat_map(|y| every(LARGE.width).map(move |x| (x, y))) {
            let id = u32::from_le_bytes(drawn.at(x, y)) as usize;
            let Some(triangle) = triangles.get(id) else { continue };
            let (_, [v, w]) = hit(eye.ray(f64::from(x) + 0.5, f64::from(y) + 0.5), *triangle).unwrap();
            let [a, b, c] = triangles_before[id];
            let point = a + (b - a) * v + (c - a) * w;
            let ([place_x, place_y], _) = eye_before.project(point);
            let (origin, direction) = eye_before.ray(place_x, place_y);
            let distance = (point - origin).dot(direction) / direction.length_squared();
            let hides = |triangle: &[DVec3; 3]| {
                hit((origin, direction), *triangle).is_some_and(|(t, [v, w])| {
                    t > 0.0 && t < distance * (1.0 - 1e-6) && v >= 0.0 && w >= 0.0 && v + w <= 1.0
                })
            };
            let is_inside =
                (0.0..f64::from(LARGE.width)).contains(&place_x) && (0.0..f64::from(LARGE.height)).contains(&place_y);
            let exact = !is_inside || triangles_before.iter().any(hides);
            let found = vectors.visible.at(x, y) == 0;
            counts.found += u32::from(found);
            counts.exact += u32::from(exact);
            counts.both += u32::from(found && exact);
        }
    }
    let share = |of: u32| f64::from(counts.both) / f64::from(of);
    assert!(counts.exact > 1000, "{counts:?}");
    assert!(share(counts.found) > 0.95 && share(counts.exact) > 0.95, "{counts:?}");
}

#[test]
fn every_instruction_set_and_single_pixels_give_the_same_bits() {
    for pair in pairs() {
        let [now, before] = pair.views();
        let gbuffer = gbuffer(before, SIZE);
        let (ids, distances) = shown(now, SIZE);
        let motion = FrameMotion::new(now, Some(FrameBefore { view: before, gbuffer: &gbuffer }), ids.size());
        for lanes in Lanes::all() {
            let vectors = motion.resolve(lanes, &mut ids.clone(), &distances, None).unwrap();
            for (x, y) in (0..SIZE.height).flat_map(|y| (0..SIZE.width).map(move |x| (x, y))) {
                let alone = motion.of_pixel((x, y), ids.at(x, y), distances.at(x, y));
                let together = [vectors.across_px.at(x, y), vectors.down_px.at(x, y)];
                assert_eq!(together.map(f32::to_bits), alone.vector_px.map(f32::to_bits), "{} ({x}, {y})", pair.name);
                assert_eq!(vectors.visible.at(x, y) != 0, alone.is_visible, "{} ({x}, {y})", pair.name);
            }
        }
    }
}

#[test]
fn still_objects_and_pixels_without_history_need_no_vectors() {
    let scene = Arc::new(builtin::by_id("cubes").unwrap().build());
    let view = FrameView { scene: &scene, camera: &scene.home };
    let gbuffer = gbuffer(view, SIZE);
    let (mut ids, distances) = shown(view, SIZE);
    let motion = FrameMotion::new(view, Some(FrameBefore { view, gbuffer: &gbuffer }), ids.size());
    assert!(motion.background.is_none() && motion.instances.iter().all(|instance| instance.before.is_none()));
    let vectors = motion.resolve(Lanes::best(), &mut ids, &distances, None).unwrap();
    assert!(vectors.across_px.pixels().iter().chain(vectors.down_px.pixels()).all(|px| *px == 0.0));
    assert!(vectors.visible.pixels().iter().all(|visible| *visible == MotionVectors::VISIBLE));
    assert_eq!(ids, gbuffer.object);
    assert!(FrameMotion::new(view, None, ids.size()).resolve(Lanes::best(), &mut ids, &distances, None).is_none());
}
