//! Tests of posed scenes.

use std::sync::Arc;

use glam::{DMat4, DQuat, DVec3, DVec4, Mat4, Vec3};

use super::*;
use crate::scene::{Camera, Instance, Library, Material, Mesh, MeshData, builtin};

/// Scene of one triangle that a node carries: parent with translation and scale, child with rotation about z.
fn scene() -> Arc<Scene> {
    let mut library = Library::default();
    let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
    let data = MeshData { positions: corners, triangles: vec![[0, 1, 2]], ..MeshData::default() };
    let mesh = library.add_mesh(Mesh::new(data).unwrap());
    let [first, second] = ["a", "b"].map(|name| library.add_material(Material::plain(name, Vec3::ONE)));
    let object = |name: &str| Instance {
        name: name.into(),
        mesh,
        material: first,
        world_from_model: Mat4::from_translation(Vec3::Z),
        tint: Vec3::ONE,
    };
    let still = Scene {
        name: "test".into(),
        library,
        instances: vec![object("still"), object("moving")],
        background: [0; 3],
        home: Camera::look_at(Vec3::Z, Vec3::ZERO),
        views: Vec::new(),
        light: None,
        animation: None,
    };
    let mut animation = Animation::default();
    let parts = Parts { scale: DVec3::splat(3.0), ..Parts::default() };
    let parent = animation.rig.add_node(Node { parent: None, local: Local::Parts(parts), weights: Vec::new() });
    let local = Local::Parts(Parts { translation: DVec3::Y, ..Parts::default() });
    let child = animation.rig.add_node(Node { parent: Some(parent), local, weights: Vec::new() });
    let times = |times_s: &[f64]| KeyTimes::new(times_s.to_vec()).unwrap();
    let places = vec![DVec3::ZERO, DVec3::X * 4.0, DVec3::ZERO];
    let places = Sampler::new(times(&[0.0, 1.0, 2.0]), places, Interpolation::Linear).unwrap();
    let turns = [0.0, 1.0, 0.0].map(DQuat::from_rotation_z).to_vec();
    let turns = Sampler::new(times(&[0.0, 1.0, 2.0]), turns, Interpolation::Linear).unwrap();
    animation.rig.add_channel(Channel { node: parent, track: Track::Translation(places) });
    animation.rig.add_channel(Channel { node: child, track: Track::Rotation(turns) });
    let node_from_model = DMat4::from_translation(DVec3::Z);
    animation.attachments.push(Attachment { instance: 1, node: child, node_from_model, fallback: Mat4::IDENTITY });
    let exchange = MaterialTrack { instance: 0, times: times(&[0.0, 1.5]), materials: vec![first, second] };
    animation.materials.push(exchange);
    Arc::new(still.animated(animation))
}

#[test]
fn objects_follow_the_written_out_product_of_the_nodes() {
    let scene = scene();
    for (time_s, share) in [(0.0, 0.0), (0.25, 0.25), (1.0, 1.0), (1.75, 0.25), (3.5, 0.5), (-0.5, 0.5)] {
        let (sin, cos) = f64::sin_cos(share);
        // Scale 3 after rotation of (x, y), after the translations by y = 1 and z = 1.
        let expected = |x: f64, y: f64, z: f64| {
            DVec3::new(4.0 * share + 3.0 * (cos * x - sin * y), 3.0 * (1.0 + sin * x + cos * y), 3.0 * (z + 1.0))
        };
        let world_from_model = scene.at(time_s).instances[1].world_from_model.as_dmat4();
        for (x, y, z) in [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.3, -2.0, 5.0)] {
            let off = world_from_model.transform_point3(DVec3::new(x, y, z)).distance(expected(x, y, z));
            assert!(off < 1e-5, "{time_s} s: off by {off}");
        }
    }
}

#[test]
fn materials_are_exchanged_at_their_times() {
    let scene = scene();
    let name = |time_s: f64| {
        let posed = scene.at(time_s);
        posed.library.material(posed.instances[0].material).name.clone()
    };
    assert_eq!([0.0, 1.4, 1.5, 1.9, 2.0].map(name), ["a", "a", "b", "b", "a"]);
}

/// Returns all data that a pose may change, bit for bit.
fn bits(scene: &Scene) -> Vec<u32> {
    let meshes = scene.library.meshes().iter().flat_map(|mesh| mesh.positions.iter().chain(&mesh.normals));
    let matrices = scene.instances.iter().flat_map(|instance| instance.world_from_model.to_cols_array());
    let materials = scene.instances.iter().map(|instance| instance.material.index() as u32);
    meshes.flat_map(Vec3::to_array).chain(matrices).map(f32::to_bits).chain(materials).collect()
}

#[test]
fn a_pose_does_not_depend_on_the_pose_it_is_made_from() {
    let moving = builtin::ALL.iter().map(|builtin| Arc::new(builtin.build()));
    for scene in moving.filter(|scene| scene.animation.is_some()).chain([scene()]) {
        let duration_s = scene.animation.as_ref().unwrap().duration_s();
        let (early, late) = (duration_s * 0.21, duration_s * 0.74);
        let direct = scene.at(late);
        assert_eq!(bits(&scene.at(early).at(late)), bits(&direct), "{}", scene.name);
        assert_eq!(bits(&direct.at(0.0)), bits(&scene), "{}", scene.name);
        assert_eq!(bits(&scene.at(duration_s * 8.0)), bits(&scene), "{}", scene.name);
        assert_ne!(bits(&direct), bits(&scene), "{}", scene.name);
        assert_eq!(direct.first_triangles(), scene.first_triangles());
        assert!(direct.is_pose_of(&scene) && scene.is_pose_of(&scene.at(early)), "{}", scene.name);
        let shared = scene.library.textures().as_ptr() == direct.library.textures().as_ptr();
        assert!(shared, "{}: its textures are copied", scene.name);
        let meshes = scene.library.meshes().iter().zip(direct.library.meshes());
        let shared = meshes.filter(|(own, posed)| Arc::ptr_eq(own, posed)).count();
        let deformed = scene.animation.as_ref().unwrap().animation.deformations.len();
        assert_eq!(shared + deformed, scene.library.meshes().len(), "{}", scene.name);
    }
}

#[test]
fn a_still_scene_is_its_own_pose() {
    let scene = Arc::new(builtin::ALL[0].build());
    let other = Arc::new(builtin::ALL[0].build());
    assert!(Arc::ptr_eq(&scene.at(3.0), &scene));
    assert!(scene.is_pose_of(&scene.at(1.0)) && !scene.is_pose_of(&other));
}

#[test]
fn scenes_that_were_built_separately_or_edited_are_not_poses_of_each_other() {
    let scene = scene();
    assert!(!scene.is_pose_of(&super::tests::scene()) && !scene.is_pose_of(&scene.mirrored_z()));
    let edited = Scene { animation: None, ..Scene::clone(&scene) };
    assert!(!edited.is_pose_of(&scene) && !scene.is_pose_of(&edited));
}

#[test]
fn the_pose_of_a_mirrored_scene_is_the_mirrored_pose() {
    for scene in [scene(), Arc::new(builtin::by_id("chess-motion").unwrap().build())] {
        let mirrored = Arc::new(scene.mirrored_z());
        assert_eq!(bits(&mirrored.at(0.7)), bits(&scene.at(0.7).mirrored_z()), "{}", scene.name);
    }
}

#[test]
fn a_transform_that_is_too_large_is_replaced_by_the_fallback() {
    let mut still = Scene { animation: None, ..Scene::clone(&scene()) };
    let mut animation = Animation::default();
    let node = animation.rig.add_node(Node {
        parent: None,
        local: Local::Parts(Parts { scale: DVec3::splat(1e300), ..Parts::default() }),
        weights: Vec::new(),
    });
    let fallback = Mat4::from_translation(Vec3::X);
    animation.attachments.push(Attachment { instance: 1, node, node_from_model: DMat4::IDENTITY, fallback });
    still = still.animated(animation);
    assert_eq!(still.instances[1].world_from_model, fallback);
    assert!(still.animation.is_none(), "a motion without key frames has no duration");
}

#[test]
fn rotations_are_interpolated_along_the_shorter_arc_at_constant_speed() {
    let times = KeyTimes::new(vec![0.0, 2.0]).unwrap();
    for sign in [1.0, -1.0] {
        let ends = vec![DQuat::IDENTITY, DQuat::from_rotation_y(1.2) * sign];
        let sampler = Sampler::new(times.clone(), ends, Interpolation::Linear).unwrap();
        for time_s in [0.0, 0.3, 1.1, 2.0] {
            let off = sampler.at(time_s).dot(DQuat::from_rotation_y(0.6 * time_s)).abs() - 1.0;
            assert!(off.abs() < 1e-14, "{time_s}: {off}");
        }
    }
}

#[test]
fn a_cubic_spline_reproduces_a_cubic_polynomial_and_passes_through_its_keys() {
    let (value, slope) = (|t: f64| t * t * t - 2.0 * t + 5.0, |t: f64| 3.0 * t * t - 2.0);
    let keys_s = [0.5, 1.0, 3.0];
    let values = keys_s.iter().flat_map(|t| [slope(*t), value(*t), slope(*t)]).collect();
    let sampler = Sampler::new(KeyTimes::new(keys_s.to_vec()).unwrap(), values, Interpolation::CubicSpline).unwrap();
    for time_s in [0.5, 0.75, 1.0, 1.3, 2.9, 3.0] {
        assert!((sampler.at(time_s) - value(time_s)).abs() < 1e-12, "{time_s}");
    }
    assert_eq!([0.0, 9.0].map(|time_s| sampler.at(time_s)), [value(0.5), value(3.0)]);
}

#[test]
fn steps_keep_the_earlier_value_and_invalid_key_frames_are_refused() {
    let times = KeyTimes::new(vec![1.0, 2.0]).unwrap();
    let sampler = Sampler::new(times.clone(), vec![4.0, 7.0], Interpolation::Step).unwrap();
    assert_eq!([0.0, 1.0, 1.99, 2.0, 3.0].map(|time_s| sampler.at(time_s)), [4.0, 4.0, 4.0, 7.0, 7.0]);
    for bad in [vec![], vec![-1.0], vec![0.0, 0.0], vec![1.0, f64::NAN], vec![0.0, f64::INFINITY], vec![2.0, 1.0]] {
        assert!(KeyTimes::new(bad.clone()).is_err(), "{bad:?}");
    }
    assert!(Sampler::new(times.clone(), vec![1.0], Interpolation::Step).is_err());
    assert!(Sampler::new(times.clone(), vec![1.0, f64::NAN], Interpolation::Linear).is_err());
    assert!(Sampler::new(times, vec![1.0, 2.0], Interpolation::CubicSpline).is_err());
    assert_eq!(unit(DVec4::ZERO), DQuat::IDENTITY);
}
