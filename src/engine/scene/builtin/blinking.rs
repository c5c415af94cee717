//! Signs whose textures change: a sign that blinks, an arrow that runs, and a sign that fails irregularly.
//!
//! Nothing moves, so a method that detects motion by positions and depths sees no change.

use glam::{Mat4, Quat, Vec2, Vec3};

use super::Builtin;
use super::draft::SceneDraft;
use super::{shapes, textures};
use crate::image::{Image, Rgba8};
use crate::scene::animation::{KeyTimes, MaterialTrack};
use crate::scene::{Camera, Material, MaterialId};
use textures::{smoothstep, srgb};

pub(super) const BLINKING: Builtin = Builtin {
    id: "blinking",
    title: "Blinking signs",
    summary: "Signs change their textures while nothing moves: shows whether a method with history follows a change \
              that has no motion.",
    draft,
};

/// Length of the loop, in seconds.
const DURATION_S: f64 = 2.0;

/// Colour factor of lamps that are off.
const OFF: f32 = 0.16;

fn draft() -> SceneDraft {
    let home = Camera { near: 0.5, far: 60.0, ..Camera::look_at(Vec3::new(0.0, 1.9, 7.4), Vec3::new(0.0, 1.7, 0.0)) };
    let mut draft = SceneDraft::new([24, 26, 34], home);
    draft.animation.least_duration_s = DURATION_S;
    add_street(&mut draft);
    let square = draft.mesh(shapes::mapped(shapes::grid(1), |position, _| Vec2::new(position.x, position.z) + 0.5));
    let blinking = [1.0, OFF].map(|light| add_lamp(&mut draft, &rings(srgb(0xF2_4A_3A), light)));
    let arrows = [0, 1, 2, 3].map(|step| add_lamp(&mut draft, &arrow(step)));
    let failing = [1.0, OFF].map(|light| add_lamp(&mut draft, &rings(srgb(0x46_D8_8A), light)));
    let signs: [(&str, f32, &[MaterialId], &[f64]); 3] = [
        ("blinking sign", -2.8, &blinking, &[0.0, 0.5, 1.0, 1.5]),
        ("running arrow", 0.0, &arrows, &[0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75]),
        ("failing sign", 2.8, &failing, &[0.0, 0.9, 1.0, 1.1, 1.3, 1.4]),
    ];
    for (name, x, materials, times_s) in signs {
        let upright = Quat::from_rotation_x(std::f32::consts::FRAC_PI_2);
        let place = Mat4::from_scale_rotation_translation(Vec3::splat(2.2), upright, Vec3::new(x, 1.9, 0.0));
        draft.place(name, square, materials[0], place);
        let shown = materials.iter().cycle().take(times_s.len()).copied().collect();
        let times = KeyTimes::new(times_s.to_vec()).expect("times ascend");
        let instance = draft.object(name);
        draft.animation.materials.push(MaterialTrack { instance, times, materials: shown });
    }
    draft
}

fn add_street(draft: &mut SceneDraft) {
    let plane = draft.mesh(shapes::tiled(Vec2::new(16.0, 8.0), 2.5));
    let bricks = draft.textured("bricks", textures::bricks(256, srgb(0x5C_44_4C), srgb(0x50_4C_54)));
    let upright = Quat::from_rotation_x(std::f32::consts::FRAC_PI_2);
    draft.place("wall", plane, bricks, Mat4::from_rotation_translation(upright, Vec3::new(0.0, 2.0, -0.6)));
    let tiles = draft.textured("pavement", textures::chess(256, srgb(0x58_56_5E), srgb(0x44_44_4C)));
    draft.place("pavement", plane, tiles, Mat4::from_translation(Vec3::new(0.0, -0.2, 3.0)));
    let cube = draft.mesh(shapes::cube());
    let steel = draft.plain("steel", srgb(0x8A_90_98));
    for (number, x) in (1..).zip([-2.8_f32, 0.0, 2.8]) {
        let frame =
            Mat4::from_scale_rotation_translation(Vec3::new(1.22, 1.22, 0.08), Quat::IDENTITY, Vec3::new(x, 1.9, -0.1));
        draft.place(format!("frame {number}"), cube, steel, frame);
        let post =
            Mat4::from_scale_rotation_translation(Vec3::new(0.09, 0.5, 0.09), Quat::IDENTITY, Vec3::new(x, 0.3, -0.1));
        draft.place(format!("post {number}"), cube, steel, post);
    }
}

/// Adds the material of a sign that shows a picture and emits it, so that it is bright without light.
fn add_lamp(draft: &mut SceneDraft, picture: &Image<Rgba8>) -> MaterialId {
    let texture = draft.texture(picture.clone());
    let emission = Vec3::splat(0.6);
    draft.material(Material { emission, emission_texture: Some(texture), ..Material::textured("sign", texture) })
}

/// Returns a picture of lit rings around a disc on a dark board.
fn rings(color: Vec3, light: f32) -> Image<Rgba8> {
    textures::picture(128, |uv| {
        let radius = (uv - 0.5).length() * 10.0;
        let wave = (radius - radius.round()).abs();
        let lamp = if radius < 4.5 { 1.0 - smoothstep(0.2, 0.3, wave) } else { 0.0 };
        board(uv).lerp(color * light, lamp)
    })
}

/// Returns a picture of four chevrons that point to the right, of which one is lit.
fn arrow(lit: u32) -> Image<Rgba8> {
    const AMBER: Vec3 = srgb(0xFF_C2_3C);
    textures::picture(128, |uv| {
        let along = (uv.x + 0.4 * (uv.y - 0.5).abs() - 0.2) * 5.0;
        let (number, within) = (along.floor(), along - along.floor());
        let is_lamp = (0.0..4.0).contains(&number) && within < 0.55 && (uv.y - 0.5).abs() < 0.3;
        let light = if number as u32 == lit { 1.0 } else { OFF };
        if is_lamp { AMBER * light } else { board(uv) }
    })
}

/// Returns the colour of a dark board with a bright border.
fn board(uv: Vec2) -> Vec3 {
    let to_edge = uv.min(1.0 - uv).min_element();
    if (0.02..0.045).contains(&to_edge) { srgb(0xD8_D8_D0) } else { srgb(0x1C_1E_24) }
}
