//! Stained glass, a bottle and a wreath of leaves in front of a knot on a marble floor: blending and alpha test.
//!
//! The panes are added from near to far, the wrong order for blending, which exposes a pipeline that does not sort
//! them. Leaves are squares with an alpha-tested texture; they occlude and are occluded like opaque surfaces.

use std::f32::consts::{FRAC_PI_2, TAU};

use glam::{EulerRot, Mat4, Quat, Vec2, Vec3};

use super::Builtin;
use super::draft::SceneDraft;
use super::revolve::Profile;
use super::{noise, shapes, textures};
use crate::scene::{Camera, MeshData};
use textures::srgb;

pub(super) const STAINED_GLASS: Builtin = Builtin {
    id: "stained-glass",
    title: "Stained glass",
    summary: "Panes of coloured glass, a bottle and a wreath of leaves: shows blending from far to near, and leaves cut \
              out of squares by the alpha test.",
    draft,
};

fn draft() -> SceneDraft {
    let home = Camera { near: 0.5, far: 60.0, ..Camera::look_at(Vec3::new(0.8, 2.4, 7.2), Vec3::new(-0.05, 1.4, 0.0)) };
    let mut draft = SceneDraft::new([196, 208, 220], home);
    add_room(&mut draft);
    add_glass(&mut draft);
    add_wreath(&mut draft);
    draft
}

/// Adds the opaque objects.
fn add_room(draft: &mut SceneDraft) {
    let floor = draft.mesh(shapes::mapped(shapes::grid(4), |position, _| Vec2::new(position.x, position.z) * 3.0));
    let stone = draft.textured("floor tiles", textures::chess(256, srgb(0xE8_E0_D2), srgb(0x8C_7B_6E)));
    draft.place("floor", floor, stone, at(Vec3::NEG_Z * 4.0, Quat::IDENTITY, Vec3::splat(20.0)));
    let knot = draft.mesh(shapes::trefoil(0.26, 120, 12));
    let brass = draft.plain("brass", srgb(0xE3_B0_4B));
    let upright = Quat::from_rotation_y(0.4) * Quat::from_rotation_x(1.3);
    draft.place("knot", knot, brass, at(Vec3::new(-0.5, 2.2, -2.4), upright, Vec3::splat(1.1)));
}

fn add_glass(draft: &mut SceneDraft) {
    let bottle = draft.mesh(bottle());
    let green = draft.translucent("bottle glass", srgb(0x2E_8B_57), 0.55);
    draft.place("bottle", bottle, green, at(Vec3::new(2.0, 0.0, 2.6), Quat::IDENTITY, Vec3::splat(1.0)));
    let pane = draft.mesh(shapes::two_sided(shapes::grid(1)));
    // From near to far: name, position, rotation in radians, hue.
    let panes = [
        ("blue pane", Vec3::new(1.5, 1.5, 0.9), -0.3, 0.6),
        ("green pane", Vec3::new(0.1, 1.5, 0.0), 0.0, 0.35),
        ("red pane", Vec3::new(-1.4, 1.5, -0.9), 0.3, 0.02),
    ];
    for (name, place, turn, hue) in panes {
        let glass = draft.textured(name, textures::stained_glass(128, hue));
        let standing = Quat::from_rotation_y(turn) * Quat::from_rotation_x(FRAC_PI_2);
        draft.place(name, pane, glass, at(place, standing, Vec3::new(2.4, 1.0, 3.0)));
    }
}

/// Adds leaves around a ring that leans against the panes.
fn add_wreath(draft: &mut SceneDraft) {
    const LEAVES: u32 = 22;
    let square = draft.mesh(shapes::two_sided(shapes::grid(1)));
    let green = draft.textured("leaf", textures::leaf(128, textures::LEAF_GREEN));
    for leaf in 0..LEAVES {
        let random = |seed: u32| noise::hash(leaf, 0, seed) - 0.5;
        let around = leaf as f32 / LEAVES as f32 * TAU;
        let out = Vec3::new(around.sin(), around.cos(), 0.0);
        let place = Vec3::new(-1.75, 1.25, 1.7) + out * (0.85 + 0.12 * random(1));
        // The tips point outwards, with random tilt.
        let tilt = Quat::from_euler(EulerRot::XYZ, 1.1 * random(2), 1.1 * random(3), -around + 0.6 * random(4));
        let turn = tilt * Quat::from_rotation_x(FRAC_PI_2);
        let size = 0.62 + 0.2 * random(5);
        let instance = draft.place(format!("leaf {leaf}"), square, green, at(place, turn, Vec3::splat(size)));
        instance.tint = Vec3::new(1.0, 0.96 + 0.08 * random(6), 0.9) * (0.9 + 0.2 * random(7));
    }
}

/// Returns a bottle standing on y = 0.
fn bottle() -> MeshData {
    Profile::from(0.0, 1.9)
        .line_to(0.16, 1.9)
        .line_to(0.16, 1.35)
        .arc_to(0.45, 0.95, 70.0, 6)
        .line_to(0.45, 0.0)
        .line_to(0.0, 0.0)
        .revolve("bottle", 32)
}

fn at(place: Vec3, turn: Quat, scale: Vec3) -> Mat4 {
    Mat4::from_scale_rotation_translation(scale, turn, place)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Transparency;
    use crate::scene::builtin::shapes::tests::{assert_closed, assert_faces_agree};

    #[test]
    fn the_bottle_is_a_closed_solid() {
        assert_closed(&bottle());
        assert_faces_agree(&bottle());
    }

    #[test]
    fn every_kind_of_surface_is_there() {
        let scene = STAINED_GLASS.build();
        let kinds = scene.library.materials().iter().map(|m| m.transparency(&scene.library, m.texture));
        let kinds: Vec<_> = kinds.collect();
        for (kind, count) in [(Transparency::Opaque, 2), (Transparency::AlphaTested, 1), (Transparency::Blended, 4)] {
            assert_eq!(kinds.iter().filter(|k| **k == kind).count(), count, "{kind:?}");
        }
    }
}
