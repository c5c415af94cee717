//! Triangle scenes: a single triangle, two interpenetrating ones, shared edges, and slivers.

use std::f32::consts::TAU;

use glam::{Mat4, Quat, Vec2, Vec3};

use super::draft::SceneDraft;
use super::textures::{hue, srgb};
use super::{Builtin, noise};
use crate::scene::{Camera, MeshData};

pub(super) const TRIANGLE: Builtin = Builtin {
    id: "triangle",
    title: "One triangle",
    summary: "One triangle with a red, a green and a blue corner, slightly rotated: the simplest way to follow \
              barycentric weights and perspective through all stages.",
    draft: draft_triangle,
};

pub(super) const INTERPENETRATING: Builtin = Builtin {
    id: "interpenetrating",
    title: "Two intersecting triangles",
    summary: "No drawing order is right for two intersecting triangles: only a depth test per pixel finds the line \
              where they meet.",
    draft: draft_interpenetrating,
};

pub(super) const SLIVERS: Builtin = Builtin {
    id: "slivers",
    title: "Slivers and needles",
    summary: "Triangles thinner than a pixel that share their edges: shows that the fill rule leaves no gap and draws \
              no pixel twice.",
    draft: draft_slivers,
};

pub(super) const SHARED_EDGES: Builtin = Builtin {
    id: "shared-edges",
    title: "Shared edges",
    summary: "Eight triangles around the middle of the picture whose edges run exactly through pixel centres: with the \
              inclusive fill rule they are drawn twice, with the exclusive one the background shows through.",
    draft: draft_shared_edges,
};

const BACKGROUND: [u8; 3] = [30, 32, 36];

fn draft_triangle() -> SceneDraft {
    let mut draft = SceneDraft::new(BACKGROUND, Camera::look_at(Vec3::new(0.0, 0.12, 3.2), Vec3::Y * 0.12));
    let mesh = draft.mesh(MeshData { colors: vec![Vec3::X, Vec3::Y, Vec3::Z], ..triangle() });
    let white = draft.plain("vertex colours", Vec3::ONE);
    draft.place("triangle", mesh, white, Mat4::from_rotation_y(0.7) * Mat4::from_rotation_x(-0.25));
    draft
}

fn draft_interpenetrating() -> SceneDraft {
    let home = Camera::look_at(Vec3::new(0.0, 0.35, 3.6), Vec3::ZERO);
    let mut draft = SceneDraft::new(BACKGROUND, home);
    let mesh = draft.mesh(triangle());
    let placements = [
        ("amber", srgb(0xF0_A8_3C), Mat4::from_rotation_y(0.8) * Mat4::from_rotation_x(-0.45)),
        ("blue", srgb(0x4A_90_E2), Mat4::from_rotation_y(-0.7) * Mat4::from_rotation_z(0.9)),
    ];
    for (name, diffuse, world_from_model) in placements {
        let material = draft.plain(name, diffuse);
        draft.place(name, mesh, material, world_from_model);
    }
    draft
}

/// Returns a triangle in the plane z = 0 with its centroid near the origin, facing +z.
fn triangle() -> MeshData {
    MeshData {
        name: "triangle".to_owned(),
        positions: vec![Vec3::new(0.0, 1.1, 0.0), Vec3::new(-1.2, -0.75, 0.0), Vec3::new(1.2, -0.75, 0.0)],
        normals: vec![Vec3::Z; 3],
        triangles: vec![[0, 1, 2]],
        ..MeshData::default()
    }
}

/// Creates a scene with a square that is divided into eight triangles by its diagonals and centre lines.
///
/// At any picture size, some of these edges run through pixel centres: the diagonals if width and height are both even,
/// a centre line if either is odd.
fn draft_shared_edges() -> SceneDraft {
    let mut draft = SceneDraft::new(BACKGROUND, Camera::look_at(Vec3::Z * 3.0, Vec3::ZERO));
    let rim = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)];
    let corner = |(x, y): (i8, i8)| Vec2::new(f32::from(x), f32::from(y));
    let mesh = draft.mesh(flat("square", rim.windows(2).map(|pair| [Vec2::ZERO, corner(pair[0]), corner(pair[1])])));
    let white = draft.plain("vertex colours", Vec3::ONE);
    draft.place("square", mesh, white, Mat4::IDENTITY);
    draft
}

fn draft_slivers() -> SceneDraft {
    let mut draft = SceneDraft::new(BACKGROUND, Camera::look_at(Vec3::new(0.0, 0.0, 3.7), Vec3::ZERO));
    let white = draft.plain("vertex colours", Vec3::ONE);
    let fan = draft.mesh(fan());
    let strip = draft.mesh(strip());
    let tilt = Quat::from_rotation_x(-0.3);
    for (name, mesh, x) in [("fan", fan, -1.12), ("strip", strip, 1.12)] {
        draft.place(name, mesh, white, Mat4::from_rotation_translation(tilt, Vec3::X * x));
    }
    draft
}

/// Returns a disc of radius 1, with 12, 48, 192 and 768 slices in successive quarters.
fn fan() -> MeshData {
    const SLICES: [u32; 4] = [12, 48, 192, 768];
    let mut angles = vec![0.0];
    for (quarter, slices) in SLICES.into_iter().enumerate() {
        angles.extend((1..=slices).map(|i| (quarter as f32 + i as f32 / slices as f32) * 0.25));
    }
    let rim = |turn: f32| {
        let (sin, cos) = (turn.fract() * TAU).sin_cos();
        Vec2::new(cos, sin)
    };
    flat("fan", angles.windows(2).map(|pair| [Vec2::ZERO, rim(pair[0]), rim(pair[1])]))
}

/// Returns a strip of needle-shaped triangles between two parallel lines. The width of the triangles decreases to the
/// right, from 0.05 to 0.0001 units.
fn strip() -> MeshData {
    let mut triangles = Vec::new();
    let (mut width, mut left) = (0.05_f32, -0.9_f32);
    let [mut bottom, mut top] = [-1.0, 1.0].map(|y| Vec2::new(left, y));
    while width > 1e-4 {
        left += width;
        width *= 0.945;
        triangles.push([bottom, Vec2::new(left, -1.0), top]);
        bottom.x = left;
        left += width;
        triangles.push([top, bottom, Vec2::new(left, 1.0)]);
        top.x = left;
    }
    flat("strip", triangles.into_iter())
}

/// Returns a mesh in the plane z = 0, without shared vertices. Neighbouring triangles have different colours.
fn flat(name: &str, triangles: impl Iterator<Item = [Vec2; 3]>) -> MeshData {
    let positions: Vec<Vec3> = triangles.flatten().map(|p| p.extend(0.0)).collect();
    let count = positions.len() as u32;
    MeshData {
        name: name.to_owned(),
        normals: vec![Vec3::Z; positions.len()],
        colors: (0..count / 3).flat_map(|triangle| [sliver_color(triangle); 3]).collect(),
        triangles: (0..count / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
        positions,
        ..MeshData::default()
    }
}

/// Returns the colour of a triangle, as sRGB values. The hue advances by the golden angle per triangle, so that
/// neighbours differ and colours do not repeat in a short cycle.
fn sliver_color(triangle: u32) -> Vec3 {
    const GOLDEN_TURN: f32 = 0.381_966;
    hue(triangle as f32 * GOLDEN_TURN % 1.0) * (0.75 + 0.25 * noise::hash(triangle, 0, 3))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Aabb;
    use crate::scene::DepthMapping;
    use crate::scene::builtin::shapes::tests::edge_uses;

    #[test]
    fn the_corners_of_the_triangle_have_different_depths() {
        let scene = TRIANGLE.build();
        let clip_from_world = scene.home.clip_from_world(1.6, DepthMapping::STANDARD);
        let [a, b, c] = [0, 1, 2].map(|i| {
            let world = scene.instances[0].world_from_model * scene.library.meshes()[0].positions[i].extend(1.0);
            (clip_from_world * world).w
        });
        assert!((a - b).abs() > 0.1 && (b - c).abs() > 0.1 && (c - a).abs() > 0.1, "{a} {b} {c}");
    }

    #[test]
    fn both_triangles_cross_the_plane_of_the_other() {
        let scene = INTERPENETRATING.build();
        let [this, that] = [0, 1].map(|i| scene.instances[i].world_from_model);
        for (from, to) in [(this, that), (that, this)] {
            let here_from_there = from.inverse() * to;
            let seen = Aabb::around(triangle().positions.iter().map(|p| here_from_there.transform_point3(*p)));
            assert!(seen.min.z < -0.1 && seen.max.z > 0.1, "{seen:?}");
        }
    }

    #[test]
    fn slivers_share_all_edges_but_the_outline() {
        let fan = fan();
        let strip = strip();
        for (outline_edges, mesh) in [(fan.triangles.len(), &fan), (strip.triangles.len() + 2, &strip)] {
            let uses = edge_uses(mesh);
            assert!(uses.values().all(|uses| *uses <= 2), "{}", mesh.name);
            assert_eq!(uses.values().filter(|uses| **uses == 1).count(), outline_edges, "{}", mesh.name);
        }
    }

    #[test]
    fn neighbouring_slivers_differ_in_colour() {
        for mesh in [fan(), strip()] {
            for pair in mesh.triangles.windows(2) {
                let [this, next] = [0, 1].map(|i| mesh.colors[pair[i][0] as usize]);
                assert!(this.distance(next) > 0.3);
            }
        }
    }
}
