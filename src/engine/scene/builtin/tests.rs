//! Tests that apply to every built-in scene.

use std::collections::HashSet;

use glam::Vec3;

use super::*;
use crate::scene::{DepthMapping, Material};

fn scenes() -> impl Iterator<Item = (&'static Builtin, Scene)> {
    ALL.iter().map(|builtin| (builtin, builtin.build()))
}

#[test]
fn ids_are_unique_kebab_case_and_found() {
    let mut seen = HashSet::new();
    for builtin in ALL {
        assert!(seen.insert(builtin.id), "{} twice", builtin.id);
        let words_are_plain = builtin.id.split('-').all(|w| !w.is_empty() && w.chars().all(|c| c.is_ascii_lowercase()));
        assert!(words_are_plain, "{}", builtin.id);
        assert_eq!(by_id(builtin.id).map(|b| b.title), Some(builtin.title));
    }
    assert!(by_id("teapot").is_none());
    assert_eq!(ALL[0].id, "chess", "the default");
}

#[test]
fn summaries_are_one_sentence() {
    for builtin in ALL {
        assert!(builtin.summary.ends_with('.') && !builtin.summary.contains(". "), "{}", builtin.id);
    }
}

#[test]
fn every_scene_is_named_and_has_triangles_within_a_budget() {
    for (builtin, scene) in scenes() {
        assert_eq!(scene.name, builtin.title);
        let count = scene.triangle_count();
        assert!((1..20_000).contains(&count), "{}: {count} triangles", builtin.id);
    }
}

#[test]
fn every_mesh_has_unit_normals_that_agree_with_its_faces() {
    for (builtin, scene) in scenes() {
        for mesh in scene.library.meshes() {
            let given = mesh.normals.iter().filter(|normal| mesh.lost_normals() == 0 || **normal != Vec3::ZERO);
            let off = given.clone().map(|n| (n.length() - 1.0).abs()).fold(0.0, f32::max);
            assert!(off < 1e-5, "{}: {} is off by {off}", builtin.id, mesh.name);
            assert_eq!(given.count() + mesh.lost_normals(), mesh.normals.len(), "{}", builtin.id);
            if mesh.lost_normals() == 0 {
                shapes::tests::assert_faces_agree(mesh);
            }
        }
    }
}

#[test]
fn objects_with_textures_have_texture_coordinates() {
    for (builtin, scene) in scenes() {
        for instance in &scene.instances {
            let textured = scene.library.material(instance.material).texture.is_some();
            assert!(
                !textured || !scene.library.mesh(instance.mesh).uvs.is_empty(),
                "{}: {}",
                builtin.id,
                instance.name
            );
        }
    }
}

#[test]
fn colours_are_srgb_values_between_zero_and_one() {
    let valid = |c: Vec3| c.cmpge(Vec3::ZERO).all() && c.cmple(Vec3::ONE).all();
    for (builtin, scene) in scenes() {
        assert!(scene.instances.iter().all(|i| valid(i.tint)), "{}", builtin.id);
        assert!(scene.library.materials().iter().all(|m| valid(m.diffuse)), "{}", builtin.id);
        assert!(scene.library.meshes().iter().flat_map(|m| &m.colors).all(|c| valid(*c)), "{}", builtin.id);
    }
}

#[test]
fn the_home_view_sees_the_middle_of_the_scene() {
    for (builtin, scene) in scenes() {
        let clip = scene.home.clip_from_world(1.6, DepthMapping::STANDARD) * scene.bounds().center().extend(1.0);
        let inside = clip.w > 0.0 && clip.x.abs() < clip.w && clip.y.abs() < clip.w && (0.0..clip.w).contains(&clip.z);
        assert!(inside, "{}: {clip}", builtin.id);
    }
}

#[test]
fn no_mesh_material_or_texture_is_unused() {
    for (builtin, scene) in scenes() {
        let library = &scene.library;
        let meshes: HashSet<_> = scene.instances.iter().map(|i| i.mesh).collect();
        let exchanged = scene.animation.iter().flat_map(|motion| &motion.animation.materials);
        let exchanged = exchanged.flat_map(|track| track.materials.iter().copied());
        let materials: HashSet<_> = scene.instances.iter().map(|i| i.material).chain(exchanged).collect();
        let of_material =
            |m: &Material| [m.texture, m.dark_texture, m.alpha_texture, m.normal_texture, m.emission_texture];
        let textures: HashSet<_> = library.materials().iter().flat_map(of_material).flatten().collect();
        let used = [meshes.len(), materials.len(), textures.len()];
        assert_eq!(
            used,
            [library.meshes().len(), library.materials().len(), library.textures().len()],
            "{}",
            builtin.id
        );
    }
}

#[test]
fn building_twice_gives_the_same_scene() {
    for (builtin, scene) in scenes() {
        let again = builtin.build();
        assert_eq!(scene.library.meshes(), again.library.meshes(), "{}", builtin.id);
        let images = |s: &Scene| s.library.textures().iter().map(|t| t.image().clone()).collect::<Vec<_>>();
        assert_eq!(images(&scene), images(&again), "{}", builtin.id);
        assert_eq!(format!("{:?}", scene.instances), format!("{:?}", again.instances), "{}", builtin.id);
        assert_eq!((scene.home, scene.background), (again.home, again.background));
    }
}
