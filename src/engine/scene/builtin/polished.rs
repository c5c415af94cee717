//! Polished stones and a lamp on a cobbled square at night: specular highlights, a normal map and emission.

use std::f32::consts::FRAC_PI_2;

use glam::{Mat4, Quat, Vec2, Vec3};

use super::Builtin;
use super::draft::SceneDraft;
use super::revolve::Profile;
use super::{shapes, textures};
use crate::image::{Image, Rgba8};
use crate::scene::{Camera, Material, MeshData};
use textures::srgb;

pub(super) const POLISHED: Builtin = Builtin {
    id: "polished",
    title: "Polished stones",
    summary: "Spheres and a knot of rising shininess around a lamp on embossed tiles: shows Blinn–Phong highlights, a \
              normal map and emission.",
    draft,
};

/// Number of embossed studs along each axis of the normal map.
const STUDS: f32 = 4.0;

/// Maximum slope of the studs.
const STEEPNESS: f32 = 0.9;

fn draft() -> SceneDraft {
    let home = Camera { near: 0.5, far: 60.0, ..Camera::look_at(Vec3::new(0.6, 3.0, 7.4), Vec3::new(0.0, 0.75, 0.0)) };
    let mut draft = SceneDraft::new([18, 22, 34], home);
    add_floor(&mut draft);
    add_stones(&mut draft);
    add_lamp(&mut draft);
    draft
}

fn add_floor(draft: &mut SceneDraft) {
    let floor = draft.mesh(shapes::mapped(shapes::grid(8), |position, _| Vec2::new(position.x, position.z) * 3.0));
    let texture = draft.texture(textures::chess(256, srgb(0x9A_A4_B4), srgb(0x4C_56_68)));
    let normal_texture = Some(draft.texture(studs(256)));
    let tiles = draft.material(Material {
        normal_texture,
        specular: srgb(0x9A_A0_AA),
        shininess: 60.0,
        ..Material::textured("tiles", texture)
    });
    draft.place("floor", floor, tiles, Mat4::from_scale(Vec3::splat(12.0)));
}

/// Adds stones whose specular highlights shrink from left to right.
fn add_stones(draft: &mut SceneDraft) {
    let ball = draft.mesh(shapes::sphere(40));
    let stones = [("jasper", 0xA8_3A32, 8.0, -2.3), ("jade", 0x3F_8F_68, 40.0, 0.2), ("lapis", 0x2F_55_A8, 400.0, 2.4)];
    for (name, color, shininess, x) in stones {
        let specular = srgb(0xB8_B8_B8);
        let stone = draft.material(Material { specular, shininess, ..Material::plain(name, srgb(color)) });
        draft.place(name, ball, stone, at(Vec3::new(x, 0.8, 1.4 - 0.2 * x * x), 0.8));
    }
    let knot = draft.mesh(shapes::trefoil(0.26, 120, 14));
    let brass = draft.material(Material {
        specular: srgb(0xFF_E0_9A),
        shininess: 90.0,
        ..Material::plain("brass", srgb(0x8E_68_20))
    });
    let upright = Quat::from_rotation_y(0.5) * Quat::from_rotation_x(1.2);
    let placed = Mat4::from_scale_rotation_translation(Vec3::splat(0.75), upright, Vec3::new(1.7, 1.75, -1.9));
    draft.place("knot", knot, brass, placed);
}

/// Adds a lamp with an emissive shade. A texture modulates the emission in bands.
fn add_lamp(draft: &mut SceneDraft) {
    let post = draft.mesh(post());
    let iron = draft.material(Material {
        specular: srgb(0x70_70_78),
        shininess: 24.0,
        ..Material::plain("iron", srgb(0x2A_2C32))
    });
    let foot = Vec3::new(-1.15, 0.0, -1.7);
    draft.place("lamp post", post, iron, at(foot, 1.0));
    let globe = draft.mesh(shapes::sphere(32));
    let bands = textures::picture(64, |uv| {
        let glow = 0.72 + 0.28 * (uv.y * 8.0 * std::f32::consts::TAU).cos();
        Vec3::splat(glow)
    });
    let emission_texture = Some(draft.texture(bands));
    let shade = draft.material(Material {
        emission: srgb(0xFF_C2_5E),
        emission_texture,
        ..Material::plain("lamp shade", srgb(0x3A_2A_14))
    });
    draft.place("lamp shade", globe, shade, at(foot + Vec3::Y * 2.45, 0.55));
}

/// Returns a lamp post that stands on y = 0.
fn post() -> MeshData {
    Profile::from(0.0, 2.0)
        .line_to(0.1, 1.95)
        .line_to(0.07, 0.3)
        .line_to(0.34, 0.12)
        .line_to(0.34, 0.0)
        .line_to(0.0, 0.0)
        .revolve("lamp post", 24)
}

/// Returns a normal map of round studs, with y up in the picture.
fn studs(size: u32) -> Image<Rgba8> {
    textures::picture(size, |uv| {
        let cell = (uv * STUDS).fract() - 0.5;
        let distance = cell.length() * 2.0;
        // Slope of a bump of height (1 + cos(π·distance)) / 2, which ends at a distance of 1.
        let slope = if distance < 1.0 { STEEPNESS * (distance * FRAC_PI_2 * 2.0).sin() } else { 0.0 };
        let outwards = if distance > 0.0 { cell * 2.0 / distance } else { Vec2::ZERO };
        Vec3::new(outwards.x * slope, -outwards.y * slope, 1.0).normalize() * 0.5 + 0.5
    })
}

fn at(place: Vec3, scale: f32) -> Mat4 {
    Mat4::from_scale_rotation_translation(Vec3::splat(scale), Quat::IDENTITY, place)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::color::quantize;

    #[test]
    fn it_has_highlights_a_normal_map_and_emission() {
        let scene = POLISHED.build();
        let materials = scene.library.materials();
        assert!(materials.iter().filter(|material| material.specular != Vec3::ZERO).count() >= 5);
        assert!(materials.iter().any(|material| material.normal_texture.is_some()));
        assert!(materials.iter().any(|material| material.emission_texture.is_some()));
    }

    #[test]
    fn studs_are_unit_vectors_that_lean_away_from_their_middle() {
        let map = studs(64);
        for (x, y) in (0..64).flat_map(|y| (0..64).map(move |x| (x, y))) {
            let [r, g, b, _] = map.at(x, y).map(|code| f32::from(code) / 255.0 * 2.0 - 1.0);
            assert!((Vec3::new(r, g, b).length() - 1.0).abs() < 0.01, "{x},{y}");
        }
        let [left, up] = [map.at(3, 8), map.at(8, 3)];
        assert!(left[0] < quantize(0.5) && up[1] > quantize(0.5), "{left:?} {up:?}");
    }
}
