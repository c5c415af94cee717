//! A snowman and two firs in cel-animation style. Every material has one picture for its lit side and another for its
//! unlit side, with a hard boundary between them.

use std::f32::consts::FRAC_PI_2;

use glam::{EulerRot, Mat4, Quat, Vec2, Vec3};

use super::Builtin;
use super::draft::SceneDraft;
use super::revolve::Profile;
use super::{shapes, textures};
use crate::scene::{Camera, MaterialId, MeshData};
use textures::{cel_pair, srgb};

pub(super) const CEL: Builtin = Builtin {
    id: "cel",
    title: "Cel-shaded snowman",
    summary: "A snowman whose materials have a light and a dark texture: shows cel shading, which picks one of the \
              two by the light and has no gradient.",
    draft,
};

fn draft() -> SceneDraft {
    let home = Camera { near: 0.5, far: 60.0, ..Camera::look_at(Vec3::new(-1.6, 3.6, 9.4), Vec3::new(0.0, 1.35, 0.0)) };
    let mut draft = SceneDraft::new([38, 46, 62], home);
    let snow = draft.cel("snow", cel_pair(16, |_| srgb(0xF4_F7_FB)));
    let coal = draft.cel("coal", cel_pair(16, |_| srgb(0x3A_3D_48)));
    add_ground(&mut draft, snow);
    add_body(&mut draft, snow, coal);
    add_clothes(&mut draft, coal);
    add_limbs(&mut draft);
    draft
}

fn add_ground(draft: &mut SceneDraft, snow: MaterialId) {
    let hill = draft.mesh(Profile::from(0.0, 0.0).arc_to(1.0, -0.12, 24.0, 6).line_to(0.0, -0.2).revolve("hill", 64));
    draft.place("hill", hill, snow, Mat4::from_scale(Vec3::new(3.9, 2.6, 3.9)));
    let fir = draft.mesh(fir());
    let needles = draft.cel("fir", cel_pair(64, |uv| fir_color(uv.y)));
    draft.place("left fir", fir, needles, at(Vec3::new(-2.5, -0.15, -1.6), Vec3::splat(1.15)));
    draft.place("right fir", fir, needles, at(Vec3::new(2.7, -0.15, -0.9), Vec3::splat(0.85)));
}

fn add_body(draft: &mut SceneDraft, snow: MaterialId, coal: MaterialId) {
    let ball = draft.mesh(shapes::sphere(40));
    let small_ball = draft.mesh(shapes::sphere(12));
    for (name, y, radius) in [("bottom", 0.85, 1.0), ("middle", 2.05, 0.74), ("head", 3.0, 0.54)] {
        draft.place(name, ball, snow, at(Vec3::Y * y, Vec3::splat(radius)));
    }
    // Name, position on the head in degrees to the right and upwards, and radius.
    let head = [("left eye", -20.0, 12.0, 0.065), ("right eye", 20.0, 12.0, 0.065)];
    for (name, right, up, radius) in head {
        draft.place(name, small_ball, coal, at(Vec3::Y * 3.0 + on_ball(0.54, right, up), Vec3::splat(radius)));
    }
    for step in 0..5 {
        let right = (step as f32 - 2.0) * 13.0;
        let place = Vec3::Y * 3.0 + on_ball(0.54, right, -28.0 + right.abs() * 0.45);
        draft.place(format!("mouth {step}"), small_ball, coal, at(place, Vec3::splat(0.035)));
    }
    for (step, up) in [24.0, 0.0, -24.0].into_iter().enumerate() {
        let place = Vec3::Y * 2.05 + on_ball(0.74, 0.0, up);
        draft.place(format!("button {step}"), small_ball, coal, at(place, Vec3::splat(0.075)));
    }
    let cone = draft.mesh(shapes::cone(1.0, 20));
    let carrot = draft.cel("carrot", cel_pair(32, |uv| stripes(uv.y * 6.0, srgb(0xF5_8A_2E), srgb(0xE0_74_1F), 0.25)));
    let forward = Mat4::from_translation(Vec3::new(0.0, 3.0, 0.48)) * Mat4::from_rotation_x(FRAC_PI_2);
    draft.place("nose", cone, carrot, forward * Mat4::from_scale(Vec3::new(0.1, 0.62, 0.1)));
}

fn add_clothes(draft: &mut SceneDraft, coal: MaterialId) {
    let red = srgb(0xD8_3A_42);
    let wool = draft.cel("scarf", cel_pair(64, |uv| stripes(uv.x * 12.0, red, srgb(0xF6_E7_D2), 0.35)));
    let ring = draft.mesh(shapes::torus(0.32, 40, 14));
    draft.place("scarf", ring, wool, at(Vec3::Y * 2.6, Vec3::new(0.5, 0.5, 0.5)));
    let capsule = draft.mesh(shapes::mapped(shapes::capsule(4.0, 16), |position, _| Vec2::splat(0.1 * position.y)));
    let end = Quat::from_euler(EulerRot::YXZ, 0.0, -0.32, -0.18);
    let place = Vec3::new(0.3, 2.22, 0.72);
    draft.place(
        "end of the scarf",
        capsule,
        wool,
        Mat4::from_scale_rotation_translation(Vec3::new(0.15, 0.13, 0.07), end, place),
    );
    let hat = draft.mesh(hat());
    let tilted = Mat4::from_translation(Vec3::new(-0.06, 3.42, 0.0)) * Mat4::from_rotation_z(0.16);
    draft.place("hat", hat, coal, tilted);
    let band = draft.mesh(Profile::from(0.365, 0.2).line_to(0.385, 0.04).revolve("band", 32));
    let ribbon = draft.cel("ribbon", cel_pair(16, |_| red));
    draft.place("hat band", band, ribbon, tilted);
}

fn add_limbs(draft: &mut SceneDraft) {
    let stick = draft.mesh(shapes::capsule(20.0, 12));
    let bark = draft.cel("bark", cel_pair(32, |uv| stripes(uv.y * 16.0, srgb(0x8A_5E_3C), srgb(0x74_4D_31), 0.4)));
    let mitten = draft.mesh(shapes::sphere(20));
    let wool = draft.cel("mitten", cel_pair(16, |_| srgb(0x2E_8C_8C)));
    for (side, name) in [(-1.0, "left"), (1.0, "right")] {
        // One arm is raised, the other hangs down.
        let lift: f32 = if side < 0.0 { 0.75 } else { -0.35 };
        let along = Vec3::new(side * lift.cos(), lift.sin(), 0.12).normalize();
        let shoulder = Vec3::new(side * 0.6, 2.25, 0.0);
        let turn = Quat::from_rotation_arc(Vec3::Y, along);
        let arm = Mat4::from_scale_rotation_translation(Vec3::splat(0.05), turn, shoulder + along * 0.5);
        draft.place(format!("{name} arm"), stick, bark, arm);
        draft.place(format!("{name} mitten"), mitten, wool, at(shoulder + along * 1.1, Vec3::splat(0.17)));
    }
}

/// Returns a top hat that stands on y = 0.
fn hat() -> MeshData {
    Profile::from(0.0, 0.66)
        .line_to(0.34, 0.62)
        .line_to(0.36, 0.04)
        .line_to(0.62, 0.03)
        .arc_to(0.62, -0.03, 180.0, 4)
        .line_to(0.0, -0.03)
        .revolve("hat", 32)
}

/// Returns a fir of three cones over a trunk, standing on y = 0.
fn fir() -> MeshData {
    Profile::from(0.0, 3.0)
        .line_to(0.55, 2.1)
        .line_to(0.28, 2.05)
        .line_to(0.8, 1.25)
        .line_to(0.4, 1.2)
        .line_to(1.0, 0.4)
        .line_to(0.2, 0.35)
        .line_to(0.2, 0.0)
        .line_to(0.0, 0.0)
        .revolve("fir", 24)
}

/// Returns the colour of a fir: green with a snowy top and a brown trunk. `v` runs down its profile from 0 to 1.
fn fir_color(v: f32) -> Vec3 {
    match v {
        0.0..0.08 => srgb(0xF4_F7_FB),
        0.0..0.84 => srgb(0x2F_7A_58),
        _ => srgb(0x7A_52_36),
    }
}

/// Returns the colour of a striped pattern at position `along`. Every unit begins with a stripe of colour `other`; the
/// rest has colour `main`. `share` is the width of a stripe as a fraction of the unit.
fn stripes(along: f32, main: Vec3, other: Vec3, share: f32) -> Vec3 {
    if along.fract() < share { other } else { main }
}

/// Returns the position on a ball around the origin that lies `right` degrees to the right of its front (+z) and `up`
/// degrees above it.
fn on_ball(radius: f32, right: f32, up: f32) -> Vec3 {
    let (right, up) = (right.to_radians(), up.to_radians());
    Vec3::new(right.sin() * up.cos(), up.sin(), right.cos() * up.cos()) * radius
}

/// Returns the model matrix for a position and a scale, without rotation.
fn at(place: Vec3, scale: Vec3) -> Mat4 {
    Mat4::from_scale_rotation_translation(scale, Quat::IDENTITY, place)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin::shapes::tests::{assert_closed, assert_faces_agree};

    #[test]
    fn hat_and_fir_are_closed_solids() {
        for mesh in [hat(), fir()] {
            assert_closed(&mesh);
            assert_faces_agree(&mesh);
        }
    }

    #[test]
    fn every_material_has_a_light_and_a_dark_texture() {
        let scene = CEL.build();
        assert!(scene.library.materials().iter().all(|m| m.texture.is_some() && m.dark_texture.is_some()));
    }
}
