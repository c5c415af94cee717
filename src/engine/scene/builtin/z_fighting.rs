//! Pairs of parallel panels with a gap that shrinks from left to right, in rows of increasing distance.
//!
//! With the near plane at 0.1, one step of a standard f32 depth is about 2⁻²⁴·z²/near = 6e−7·z² world units: 6e−5 at
//! distance 10, 6e−3 at 100 and 0.6 at 1000. A pair with a smaller gap z-fights. In a more distant row, z-fighting
//! therefore begins at a wider gap, and the affected pairs form a staircase. Reversed depth has steps of about 2⁻²⁴·z,
//! as fine as the positions themselves, and nearly all panels are drawn correctly (Reed, "Depth Precision Visualized",
//! 2015). In the last column both panels are exactly coplanar.

use glam::{Mat4, Quat, Vec3};

use super::Builtin;
use super::draft::SceneDraft;
use super::{shapes, textures};
use crate::scene::{Camera, MaterialId, MeshId};
use textures::srgb;

pub(super) const Z_FIGHTING: Builtin = Builtin {
    id: "z-fighting",
    title: "Z-fighting",
    summary: "Pairs of panels whose gap shrinks to zero, near, far and farther: shows where depth runs out of \
              precision, and that reversed depth does so much farther away.",
    draft,
};

/// Gap between the two panels in each column, in world units, from left to right.
const GAPS: [f32; 6] = [1.0, 1e-1, 1e-2, 1e-3, 1e-4, 0.0];

/// Distance of each row from the eye, in world units, from bottom to top.
const DISTANCES: [f32; 3] = [10.0, 100.0, 1000.0];

/// Distance between the centres of neighbouring panels, relative to the distance of their row. All rows therefore look
/// equally large.
const PITCH: f32 = 0.2;

fn draft() -> SceneDraft {
    let home = Camera { near: 0.1, far: 1e5, ..Camera::look_at(Vec3::ZERO, Vec3::new(0.0, 0.0, -100.0)) };
    let mut draft = SceneDraft::new([30, 32, 36], home);
    let mesh = draft.mesh(shapes::grid(1));
    let back = draft.plain("back panel", srgb(0x2C_5F_8A));
    let front = draft.plain("front panel", srgb(0xF2_A6_3B));
    for (row, distance) in DISTANCES.into_iter().enumerate() {
        for (column, gap) in GAPS.into_iter().enumerate() {
            let x = (column as f32 - (GAPS.len() - 1) as f32 * 0.5) * PITCH;
            let y = (row as f32 - (DISTANCES.len() - 1) as f32 * 0.5) * PITCH * 1.2;
            add_pair(&mut draft, mesh, [back, front], Vec3::new(x, y, -1.0) * distance, gap);
        }
    }
    draft
}

/// Adds two panels at `center` that lean away from the eye. The front panel is smaller, rotated in its plane, and
/// nearer by `gap` world units.
fn add_pair(draft: &mut SceneDraft, mesh: MeshId, [back, front]: [MaterialId; 2], center: Vec3, gap: f32) {
    let distance = -center.z;
    let lean = Quat::from_rotation_y(0.5) * Quat::from_rotation_x(1.2);
    let size = PITCH * distance;
    let panel = |edge: f32, turn: f32, lift: f32| {
        let rotation = lean * Quat::from_rotation_y(turn);
        Mat4::from_scale_rotation_translation(Vec3::splat(edge * size), rotation, center + lean * Vec3::Y * lift)
    };
    draft.place(format!("back panel at {distance}"), mesh, back, panel(0.85, 0.0, 0.0));
    // The rotation gives the two panels different vertex positions, so that their depths are interpolated from
    // different values.
    draft.place(format!("front panel at {distance}, gap {gap}"), mesh, front, panel(0.5, 0.6, gap));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::DepthMapping;

    /// Returns the depths of two points on the line of sight: one at `distance`, and one nearer by `gap`.
    fn depths(mapping: DepthMapping, distance: f32, gap: f32) -> [f32; 2] {
        let clip_from_view = Z_FIGHTING.build().home.clip_from_view(1.6, mapping);
        [distance, distance - gap].map(|z| {
            let clip = clip_from_view * Vec3::new(0.0, 0.0, -z).extend(1.0);
            clip.z / clip.w
        })
    }

    #[test]
    fn far_gaps_vanish_in_standard_depth_and_survive_in_reversed_depth() {
        for (distance, gap) in [(100.0, 1e-3), (1000.0, 1e-1), (1000.0, 1e-2)] {
            let [standard, reversed] =
                [DepthMapping::STANDARD, DepthMapping::REVERSED].map(|mapping| depths(mapping, distance, gap));
            assert_eq!(standard[0], standard[1], "{distance} {gap}");
            assert!(reversed[0] < reversed[1], "{distance} {gap}");
        }
    }

    #[test]
    fn every_panel_faces_the_eye() {
        let scene = Z_FIGHTING.build();
        for instance in &scene.instances {
            let normal = instance.world_from_model.transform_vector3(Vec3::Y);
            let center = instance.world_from_model.transform_point3(Vec3::ZERO);
            assert!(normal.dot(scene.home.eye - center) > 0.0, "{}", instance.name);
        }
    }
}
