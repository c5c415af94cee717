//! A corridor around the eye, with long triangles that begin behind the eye and end far ahead.
//!
//! Dividing by w before clipping would turn geometry behind the eye inside out, so this scene exposes every pipeline
//! that does not clip. A beam crosses the near plane within the picture and is cut open there. A hoop passes around the
//! eye. A ball lies entirely behind the eye and must not be visible.

use std::f32::consts::FRAC_PI_2;

use glam::{Mat4, Quat, Vec2, Vec3};

use super::Builtin;
use super::draft::SceneDraft;
use super::{shapes, textures};
use crate::scene::Camera;
use textures::srgb;

pub(super) const NEAR_PLANE: Builtin = Builtin {
    id: "near-plane",
    title: "Through the near plane",
    summary: "The eye stands inside a corridor whose triangles reach behind it: shows clipping against the near plane.",
    draft,
};

/// Half extents of the corridor, in world units.
const HALF_SIZE: Vec3 = Vec3::new(2.0, 1.6, 16.0);

fn draft() -> SceneDraft {
    let home =
        Camera { near: 0.6, far: 80.0, ..Camera::look_at(Vec3::new(0.2, 0.1, 0.0), Vec3::new(0.0, -0.05, -6.0)) };
    let mut draft = SceneDraft::new([30, 32, 36], home);
    add_corridor(&mut draft);
    add_obstacles(&mut draft);
    draft
}

fn add_corridor(draft: &mut SceneDraft) {
    let walls =
        shapes::mapped(shapes::inside_out(shapes::cube()), |position, normal| wall_uv(position * HALF_SIZE, normal));
    let mesh = draft.mesh(walls);
    let bricks = draft.textured("bricks", textures::bricks(256, srgb(0xB8_6A_50), srgb(0xA8_A2_98)));
    let place = Mat4::from_translation(Vec3::Z * -8.0) * Mat4::from_scale(HALF_SIZE);
    draft.place("corridor", mesh, bricks, place);
}

/// Returns the texture coordinates of a wall. Bricks run along the corridor and have the same size everywhere.
fn wall_uv(position: Vec3, normal: Vec3) -> Vec2 {
    const TEXTURE_SIZE: f32 = 1.6;
    let along = if normal.z == 0.0 { position.z } else { position.x };
    let across = if normal.y == 0.0 { -position.y } else { position.x };
    Vec2::new(along, across) / TEXTURE_SIZE
}

fn add_obstacles(draft: &mut SceneDraft) {
    let cube = draft.mesh(shapes::cube());
    let coral = draft.plain("coral", srgb(0xE8_6A_58));
    // The beam begins far ahead on the right and ends behind the eye; the near plane cuts it inside the picture.
    let along = Quat::from_rotation_arc(Vec3::Z, Vec3::new(-0.12, 0.06, 1.0).normalize());
    let beam = Mat4::from_rotation_translation(along, Vec3::new(0.62, -0.35, -3.0));
    draft.place("beam", cube, coral, beam * Mat4::from_scale(Vec3::new(0.12, 0.12, 4.0)));

    let ring = draft.mesh(shapes::torus(0.08, 64, 14));
    let upright = Mat4::from_rotation_x(FRAC_PI_2);
    for (number, (z, code)) in [(-5.0, 0x5D_B0_A4), (-9.0, 0x4A_90_E2), (-14.0, 0x8E_6C_C8)].into_iter().enumerate() {
        let paint = draft.plain(&format!("ring {number}"), srgb(code));
        let place = Mat4::from_translation(Vec3::Z * z) * upright * Mat4::from_scale(Vec3::splat(1.4));
        draft.place(format!("ring {number}"), ring, paint, place);
    }
    let yellow = draft.plain("hoop", srgb(0xF0_C8_58));
    let around_the_eye = Mat4::from_translation(Vec3::Y * -0.42) * Mat4::from_rotation_x(0.08);
    draft.place("hoop around the eye", ring, yellow, around_the_eye * Mat4::from_scale(Vec3::splat(1.5)));

    let ball = draft.mesh(shapes::sphere(32));
    let red = draft.plain("red", srgb(0xD8_4A_42));
    draft.place("ball behind the eye", ball, red, Mat4::from_translation(Vec3::new(0.0, 0.0, 4.0)));
    let ivory = draft.plain("ivory", srgb(0xF3_E7_CF));
    let ahead = Mat4::from_translation(Vec3::new(-0.6, -0.9, -7.0)) * Mat4::from_scale(Vec3::splat(0.7));
    draft.place("ball ahead", ball, ivory, ahead);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Instance, Scene};

    /// Returns the view-space depths of an instance's vertices, positive in front of the eye.
    fn depths(scene: &Scene, instance: &Instance) -> Vec<f32> {
        let view_from_model = scene.home.view_from_world() * instance.world_from_model;
        scene.library.mesh(instance.mesh).positions.iter().map(|p| -view_from_model.transform_point3(*p).z).collect()
    }

    #[test]
    fn the_scene_has_objects_across_and_behind_the_near_plane() {
        let scene = NEAR_PLANE.build();
        let fate = |instance: &Instance| {
            let depths = depths(&scene, instance);
            let ahead = depths.iter().filter(|d| **d > scene.home.near).count();
            (ahead > 0, ahead < depths.len())
        };
        let count = |wanted| scene.instances.iter().filter(|i| fate(i) == wanted).count();
        assert!(count((true, true)) >= 3, "across");
        assert!(count((false, true)) >= 1, "behind");
        assert!(count((true, false)) >= 2, "ahead");
    }
}
