//! A picket fence that passes before a brick wall.
//!
//! Each picket covers and uncovers details of the wall in every frame. The fence moves by one picket per loop, so that
//! the loop is seamless although the fence never turns back.

use glam::{DMat4, DVec3, Mat4, Quat, Vec2, Vec3};

use super::Builtin;
use super::draft::SceneDraft;
use super::motion::{add_node, move_node, sampled};
use super::{shapes, textures};
use crate::scene::animation::Track;
use crate::scene::{Camera, MeshData};
use textures::srgb;

pub(super) const FENCE: Builtin = Builtin {
    id: "fence",
    title: "Passing fence",
    summary: "A picket fence passes before a brick wall: shows how a method with history treats details that appear \
              behind a moving edge.",
    draft,
};

/// Time in which the fence moves by one picket, in seconds.
const DURATION_S: f64 = 1.0;

/// Number of pickets. The outermost ones are outside the picture.
const PICKETS: u32 = 28;

/// Distance between the middles of neighbouring pickets, in world units.
const SPACING: f32 = 0.62;

fn draft() -> SceneDraft {
    let home = Camera { near: 0.5, far: 60.0, ..Camera::look_at(Vec3::new(0.0, 1.5, 7.0), Vec3::new(0.0, 1.25, 0.0)) };
    let mut draft = SceneDraft::new([126, 158, 190], home);
    add_background(&mut draft);
    add_fence(&mut draft);
    draft
}

fn add_background(draft: &mut SceneDraft) {
    let plane = draft.mesh(shapes::tiled(Vec2::new(18.0, 7.0), 2.5));
    let wall = draft.textured("bricks", textures::bricks(256, srgb(0xB4_5C_48), srgb(0xC9_C2_B6)));
    let upright = Quat::from_rotation_x(std::f32::consts::FRAC_PI_2);
    draft.place("wall", plane, wall, Mat4::from_rotation_translation(upright, Vec3::new(0.0, 2.0, -2.5)));
    let pavement = draft.textured("pavement", textures::chess(256, srgb(0xB9_B4_A8), srgb(0x8C_88_80)));
    draft.place("pavement", plane, pavement, Mat4::from_translation(Vec3::Z));
    let sphere = draft.mesh(shapes::sphere(28));
    let marble = draft.textured("blue marble", textures::marble(256, srgb(0x35_6A_A8), srgb(0xE4_EC_F4)));
    for (number, x) in (1..).zip([-3.4_f32, 0.2, 3.1]) {
        let place =
            Mat4::from_scale_rotation_translation(Vec3::splat(0.8), Quat::from_rotation_y(x), Vec3::new(x, 0.8, -1.2));
        draft.place(format!("ball {number}"), sphere, marble, place);
    }
}

fn add_fence(draft: &mut SceneDraft) {
    let (picket, cube) = (draft.mesh(picket()), draft.mesh(shapes::cube()));
    let white = draft.plain("white paint", srgb(0xF2_EE_E4));
    let fence = add_node(&mut draft.animation, None, DVec3::ZERO);
    let left = -SPACING * (PICKETS - 1) as f32 * 0.5;
    for number in 0..PICKETS {
        let place = Mat4::from_translation(Vec3::new(left + SPACING * number as f32, 0.0, 1.4));
        draft.place(format!("picket {}", number + 1), picket, white, place);
    }
    let half_length = SPACING * (PICKETS + 1) as f32 * 0.5;
    for (name, height) in [("lower rail", 0.55), ("upper rail", 1.35)] {
        let place = Mat4::from_scale_rotation_translation(
            Vec3::new(half_length, 0.07, 0.03),
            Quat::IDENTITY,
            Vec3::new(0.0, height, 1.35),
        );
        draft.place(name, cube, white, place);
    }
    for number in 0..PICKETS {
        let object = draft.object(&format!("picket {}", number + 1));
        let node_from_model: DMat4 = draft.transform(object);
        draft.attach(object, fence, node_from_model);
    }
    // Rails look the same at every place, so they need not move with their pickets.
    let places = sampled(DURATION_S, 1, |share| DVec3::X * (f64::from(SPACING) * share));
    move_node(&mut draft.animation, fence, Track::Translation(places));
}

/// Returns a picket standing on y = 0: a board of 0.3 × 1.7 × 0.06 world units with a pointed top.
fn picket() -> MeshData {
    const OUTLINE: [Vec2; 5] = [
        Vec2::new(-0.15, 0.1),
        Vec2::new(0.15, 0.1),
        Vec2::new(0.15, 1.55),
        Vec2::new(0.0, 1.8),
        Vec2::new(-0.15, 1.55),
    ];
    let mut mesh = MeshData { name: "picket".to_owned(), ..MeshData::default() };
    for (side, normal) in [(0.03, Vec3::Z), (-0.03, Vec3::NEG_Z)] {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(OUTLINE.map(|point| point.extend(side)));
        mesh.normals.extend([normal; 5]);
        let fan = [[0, 1, 2], [0, 2, 3], [0, 3, 4]].map(|corners: [u32; 3]| corners.map(|corner| first + corner));
        mesh.triangles.extend(fan.map(|[a, b, c]| if side > 0.0 { [a, b, c] } else { [a, c, b] }));
    }
    for (index, from) in OUTLINE.into_iter().enumerate() {
        let to = OUTLINE[(index + 1) % OUTLINE.len()];
        let first = mesh.positions.len() as u32;
        mesh.positions.extend([from.extend(0.03), from.extend(-0.03), to.extend(-0.03), to.extend(0.03)]);
        mesh.normals.extend([-(to - from).perp().normalize().extend(0.0); 4]);
        mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin::shapes::tests::{assert_closed, assert_faces_agree};

    #[test]
    fn a_picket_is_a_closed_solid() {
        assert_closed(&picket());
        assert_faces_agree(&picket());
    }
}
