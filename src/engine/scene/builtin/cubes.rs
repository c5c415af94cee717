//! 128 cubes that share one mesh and one texture and differ in placement and tint.

use glam::{EulerRot, Mat4, Quat, Vec3};

use super::Builtin;
use super::draft::SceneDraft;
use super::{shapes, textures};
use crate::scene::Camera;
use textures::srgb;

pub(super) const CUBES: Builtin = Builtin {
    id: "cubes",
    title: "128 cubes",
    summary: "128 instances of one cube, each with its own rotation and tint: shows what sharing a mesh saves.",
    draft,
};

/// Number of cubes along x, y and z.
const COUNT: [u32; 3] = [8, 4, 4];

/// Distance between the centres of neighbouring cubes, in world units. A cube has an edge length of 1.
const SPACING: f32 = 1.75;

fn draft() -> SceneDraft {
    let home =
        Camera { near: 1.0, far: 100.0, ..Camera::look_at(Vec3::new(5.7, 6.3, 16.2), Vec3::new(0.3, -0.4, 0.0)) };
    let mut draft = SceneDraft::new([30, 32, 36], home);
    let mesh = draft.mesh(shapes::cube());
    let card = draft.textured("test card", textures::test_card(64));
    let [columns, rows, layers] = COUNT;
    for number in 0..columns * rows * layers {
        let cell = [number % columns, number / columns % rows, number / columns / rows];
        draft.place(format!("cube {number}"), mesh, card, placement(cell)).tint = tint(cell);
    }
    draft
}

/// Returns the model matrix of the cube at grid position `cell`. The rotation changes from cube to cube, so that rows
/// look twisted.
fn placement(cell: [u32; 3]) -> Mat4 {
    let from_middle = |axis: usize| (cell[axis] as f32 - (COUNT[axis] - 1) as f32 * 0.5) * SPACING;
    let [along, up, near] = cell.map(|c| c as f32);
    let rotation = Quat::from_euler(EulerRot::YXZ, 0.2 * along + 0.1 * near, 0.12 * along - 0.15 * up, 0.1 * up);
    let center = Vec3::new(from_middle(0), from_middle(1), from_middle(2));
    Mat4::from_scale_rotation_translation(Vec3::splat(0.5), rotation, center)
}

/// Returns the tint of the cube at grid position `cell`, as sRGB values: from teal through sand to coral along x, paler
/// towards the top and darker towards the back.
fn tint(cell: [u32; 3]) -> Vec3 {
    let [along, up, near] = [0, 1, 2].map(|axis| cell[axis] as f32 / (COUNT[axis] - 1) as f32);
    let [teal, sand, coral] = [srgb(0x2F_B5_AC), srgb(0xF4_DD_A6), srgb(0xEE_6A_50)];
    let color = if along < 0.5 { teal.lerp(sand, along * 2.0) } else { sand.lerp(coral, along * 2.0 - 1.0) };
    color.lerp(Vec3::ONE, 0.25 * up) * (0.8 + 0.2 * near)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cubes_share_one_mesh_and_so_a_fraction_of_the_memory() {
        let scene = CUBES.build();
        assert_eq!((scene.instances.len(), scene.library.meshes().len()), (128, 1));
        let memory = scene.memory();
        // 17,296 bytes, of which the texture takes 16,384, against 116,736 with a separate mesh per cube.
        assert!(memory.shared_bytes * 6 < memory.unshared_bytes, "{memory:?}");
    }

    #[test]
    fn no_two_cubes_are_tinted_and_placed_alike() {
        let scene = CUBES.build();
        for (i, a) in scene.instances.iter().enumerate() {
            let twin =
                scene.instances[..i].iter().find(|b| a.world_from_model == b.world_from_model || a.tint == b.tint);
            assert_eq!(twin.map(|b| &b.name), None, "{}", a.name);
        }
    }
}
