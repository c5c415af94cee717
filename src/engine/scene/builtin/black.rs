//! Five scenes with a black spot, each with a different cause, for practising how to find out why a pixel is black.
//!
//! Each scene is minimal and resembles a user's bug report: a missing panel, a floor that ends too early, stripes on a
//! poster, a dark patch on a ball, and a crate without its picture.

use std::f32::consts::{FRAC_PI_2, PI};

use glam::{Mat4, Quat, Vec3};

use super::Builtin;
use super::draft::SceneDraft;
use super::{shapes, textures};
use crate::scene::Camera;
use textures::srgb;

pub(super) const BACK_FACING: Builtin = Builtin {
    id: "back-facing",
    title: "Black: a missing panel",
    summary: "Three panels of one mesh, the middle one reversed by mistake: shows that culling removes back-facing \
              triangles.",
    draft: draft_back_facing,
};

pub(super) const NEAR_CLIPPED: Builtin = Builtin {
    id: "near-clipped",
    title: "Black: a floor that ends too early",
    summary: "A floor that begins below the eye, and a near plane three units ahead: shows what the near plane clips \
              away.",
    draft: draft_near_clipped,
};

pub(super) const Z_FOUGHT: Builtin = Builtin {
    id: "z-fought",
    title: "Black: stripes on a poster",
    summary: "A white poster slightly in front of a black wall, and a near plane too close to the eye: shows two \
              surfaces that the depth buffer cannot separate.",
    draft: draft_z_fought,
};

pub(super) const NAN_NORMAL: Builtin = Builtin {
    id: "nan-normal",
    title: "Black: a dark patch on a ball",
    summary: "A ball some of whose normals are NaN, as if a zero-length vector had been normalised: they receive no \
              direct light.",
    draft: draft_nan_normal,
};

pub(super) const MISSING_TEXTURE: Builtin = Builtin {
    id: "missing-texture",
    title: "Black: a crate without its texture",
    summary: "Two crates, one with a texture that cannot be read: the fallback is the colour of its material, which is \
              black.",
    draft: draft_missing_texture,
};

/// Black background, as sRGB codes, of the scenes in which it shows through a hole and looks like a black spot.
const NIGHT: [u8; 3] = [0, 0, 0];

/// Grey background, as sRGB codes, of the scenes in which a surface looks black.
const DUSK: [u8; 3] = [30, 32, 36];

fn draft_back_facing() -> SceneDraft {
    let mut draft = SceneDraft::new(NIGHT, Camera::look_at(Vec3::new(0.0, 0.15, 2.9), Vec3::ZERO));
    let panel = draft.mesh(shapes::grid(1));
    let bricks = draft.textured("bricks", textures::bricks(128, srgb(0xB8_6A_50), srgb(0xA8_A2_98)));
    let upright = Quat::from_rotation_x(FRAC_PI_2);
    for (name, x, turn) in [("left panel", -1.15, 0.25), ("middle panel", 0.0, PI), ("right panel", 1.15, -0.25)] {
        let rotation = Quat::from_rotation_y(turn) * upright;
        draft.place(name, panel, bricks, Mat4::from_rotation_translation(rotation, Vec3::X * x));
    }
    draft
}

fn draft_near_clipped() -> SceneDraft {
    let home = Camera { near: 3.0, far: 60.0, ..Camera::look_at(Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.2, -6.0)) };
    let mut draft = SceneDraft::new(NIGHT, home);
    let floor = draft.mesh(shapes::grid(4));
    let tiles = draft.textured("tiles", textures::chess(128, srgb(0xE8_E0_D0), srgb(0x6E_86_9A)));
    let place = Mat4::from_translation(Vec3::Z * -6.0) * Mat4::from_scale(Vec3::splat(14.0));
    draft.place("floor", floor, tiles, place);
    let cube = draft.mesh(shapes::cube());
    let wood = draft.textured("wood", textures::crate_side(128, srgb(0xC0_90_58)));
    let crate_place = Mat4::from_translation(Vec3::new(0.6, 0.5, -6.5))
        * Mat4::from_rotation_y(0.5)
        * Mat4::from_scale(Vec3::splat(0.5));
    draft.place("crate", cube, wood, crate_place);
    draft
}

fn draft_z_fought() -> SceneDraft {
    const DISTANCE: f32 = 10.0;
    /// Near-plane distance, in world units. It is so small that one depth step at the poster, 2⁻²⁴ · distance² / near,
    /// is 0.3 units. The stripes are then wide enough to click.
    const NEAR: f32 = 2e-5;
    /// Distance of the poster from the wall, in world units. The gap is a third of a depth step, so that poster and
    /// wall have equal depths at about half of the pixels.
    const GAP: f32 = 0.1;
    let home = Camera { near: NEAR, far: 1e5, ..Camera::look_at(Vec3::ZERO, Vec3::Z * -DISTANCE) };
    let mut draft = SceneDraft::new(DUSK, home);
    let sheet = draft.mesh(shapes::grid(1));
    let paper = draft.plain("white paper", srgb(0xF4_F0_E6));
    let black = draft.plain("black paint", Vec3::ZERO);
    let plane = Quat::from_rotation_y(0.6) * Quat::from_rotation_x(0.9);
    let at = |edge: f32, turn: f32, before: f32| {
        let place = Vec3::Z * -DISTANCE + plane * Vec3::Y * before;
        Mat4::from_scale_rotation_translation(Vec3::splat(edge), plane * Quat::from_rotation_y(turn), place)
    };
    // The wall is drawn first, so it is visible where the poster has the same depth.
    draft.place("wall", sheet, black, at(7.5, 0.0, 0.0));
    draft.place("poster", sheet, paper, at(4.5, 0.6, GAP));
    draft
}

fn draft_nan_normal() -> SceneDraft {
    let mut draft = SceneDraft::new(DUSK, Camera::look_at(Vec3::new(0.0, 0.3, 4.2), Vec3::ZERO));
    let mut broken = shapes::sphere(48);
    let patch = Vec3::new(0.3, 0.45, 0.85).normalize();
    for normal in broken.normals.iter_mut().filter(|normal| normal.dot(patch) > 0.94) {
        *normal = Vec3::ZERO / 0.0;
    }
    let broken = draft.repaired_mesh(broken);
    let whole = draft.mesh(shapes::sphere(48));
    let coral = draft.plain("coral", srgb(0xF0_8A_78));
    let teal = draft.plain("teal", srgb(0x66_C0_B4));
    draft.place("broken ball", broken, coral, Mat4::from_translation(Vec3::X * -1.1));
    draft.place("whole ball", whole, teal, Mat4::from_translation(Vec3::X * 1.1));
    draft
}

fn draft_missing_texture() -> SceneDraft {
    let mut draft = SceneDraft::new(DUSK, Camera::look_at(Vec3::new(0.0, 1.4, 4.6), Vec3::ZERO));
    let cube = draft.mesh(shapes::cube());
    let wood = draft.textured("wood", textures::crate_side(128, srgb(0xC0_90_58)));
    // Some exporters write a black colour because the texture is meant to replace it.
    let lost = draft.without_texture("lost wood", Vec3::ZERO, "crate-side.png");
    for (name, material, x, turn) in [("left crate", wood, -1.1, 0.5), ("right crate", lost, 1.1, -0.4)] {
        let place = Mat4::from_translation(Vec3::X * x) * Mat4::from_rotation_y(turn);
        draft.place(name, cube, material, place * Mat4::from_scale(Vec3::splat(0.75)));
    }
    draft
}
