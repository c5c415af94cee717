//! A turning wheel in successive frames, which shows why wheels in films appear to turn backwards.
//!
//! Each frame is a separate wheel, from left to right and row by row, so that a still picture shows the motion. All
//! spokes look alike except one.

use std::f32::consts::TAU;

use glam::{Mat4, Vec2, Vec3};

use super::Builtin;
use super::draft::SceneDraft;
use super::textures::srgb;
use crate::scene::{Camera, MeshData};

pub(super) const WHEELS: Builtin = Builtin {
    id: "wheels",
    title: "A turning wheel",
    summary: "Eight frames of a wheel of twelve spokes that rotates by 27° per frame: its spokes seem to rotate \
              3° backwards, its painted spoke rotates forwards.",
    draft,
};

/// Number of spokes of the wheel. Apart from the painted spoke, the wheel looks the same after a twelfth of a turn.
pub(super) const SPOKES: u32 = 12;

/// Clockwise rotation of the wheel per frame, in degrees.
const TURN_DEGREES: f32 = 27.0;

/// Number of frames per row, and number of rows.
const FRAMES: [u32; 2] = [4, 2];

/// Distance between the centres of neighbouring wheels, in world units. A wheel has radius 1.
const SPACING: f32 = 2.3;

fn draft() -> SceneDraft {
    let mut draft = SceneDraft::new([30, 32, 36], Camera::look_at(Vec3::Z * 7.4, Vec3::ZERO));
    let (rim, spokes, marked) = (draft.mesh(rim()), draft.mesh(spokes(1..SPOKES)), draft.mesh(spokes(0..1)));
    let wood = draft.plain("wood", srgb(0xD9_C2_9A));
    let paint = draft.plain("paint", srgb(0xE5_48_3B));
    let [columns, rows] = FRAMES;
    for frame in 0..columns * rows {
        let cell = Vec2::new((frame % columns) as f32, (frame / columns) as f32);
        let middle = Vec2::new((columns - 1) as f32, (rows - 1) as f32) / 2.0;
        let center = (cell - middle) * SPACING;
        let world_from_model = Mat4::from_translation(Vec3::new(center.x, -center.y, 0.0))
            * Mat4::from_rotation_z(-(TURN_DEGREES * frame as f32).to_radians());
        for (part, mesh, material) in [("rim", rim, wood), ("spokes", spokes, wood), ("marked spoke", marked, paint)] {
            draft.place(format!("{part}, frame {}", frame + 1), mesh, material, world_from_model);
        }
    }
    draft
}

/// Returns the rim of a wheel: a ring from radius 0.88 to 1.
pub(super) fn rim() -> MeshData {
    const SEGMENTS: u32 = 72;
    let mut mesh = MeshData { name: "rim".to_owned(), ..MeshData::default() };
    for segment in 0..SEGMENTS {
        let (sin, cos) = (TAU * segment as f32 / SEGMENTS as f32).sin_cos();
        mesh.positions.extend([0.88, 1.0].map(|radius| Vec3::new(cos, sin, 0.0) * radius));
        let [inner, outer] = [2 * segment, 2 * segment + 1];
        let [next_inner, next_outer] = [inner, outer].map(|corner| (corner + 2) % (2 * SEGMENTS));
        mesh.triangles.extend([[inner, outer, next_outer], [inner, next_outer, next_inner]]);
    }
    mesh.normals = vec![Vec3::Z; mesh.positions.len()];
    mesh
}

/// Returns a mesh of the spokes with indices in `which`. Each spoke is a bar from the hub to the rim.
pub(super) fn spokes(which: std::ops::Range<u32>) -> MeshData {
    const HALF_WIDTH: f32 = 0.035;
    let mut mesh = MeshData { name: format!("spokes {} to {}", which.start + 1, which.end), ..MeshData::default() };
    for spoke in which {
        let along = Vec2::from_angle(TAU * (0.25 + spoke as f32 / SPOKES as f32));
        let across = along.perp() * HALF_WIDTH;
        let first = mesh.positions.len() as u32;
        let corners = [along * 0.04 - across, along * 0.9 - across, along * 0.9 + across, along * 0.04 + across];
        mesh.positions.extend(corners.map(|corner| corner.extend(0.0)));
        mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    mesh.normals = vec![Vec3::Z; mesh.positions.len()];
    mesh
}
