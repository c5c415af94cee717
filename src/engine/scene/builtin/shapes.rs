//! Procedural meshes: solids around the origin, a floor and a knot.
//!
//! All functions return indexed [`MeshData`] with unit normals, texture coordinates (v pointing down) and
//! counter-clockwise front faces. Solids are closed. Vertices along a seam are duplicated with bitwise equal positions.
//! If vertices with equal positions are merged, every edge belongs to exactly two triangles. Round solids are profiles
//! revolved around the y axis (see `revolve`).

use std::f32::consts::TAU;

use glam::{Vec2, Vec3};

use super::revolve::Profile;
use crate::scene::MeshData;

/// Returns a cube from −1 to 1 on each axis. Each face shows the whole texture upright.
pub(super) fn cube() -> MeshData {
    // Outward normal and right direction of each face; up is their cross product.
    const FACES: [(Vec3, Vec3); 6] = [
        (Vec3::Z, Vec3::X),
        (Vec3::X, Vec3::NEG_Z),
        (Vec3::NEG_Z, Vec3::NEG_X),
        (Vec3::NEG_X, Vec3::Z),
        (Vec3::Y, Vec3::X),
        (Vec3::NEG_Y, Vec3::X),
    ];
    let mut positions = Vec::with_capacity(24);
    for (normal, right) in FACES {
        let up = normal.cross(right);
        positions.extend([up - right, -up - right, right - up, right + up].map(|corner| normal + corner));
    }
    MeshData {
        name: "cube".to_owned(),
        positions,
        normals: FACES.iter().flat_map(|(normal, _)| [*normal; 4]).collect(),
        uvs: FACES.iter().flat_map(|_| [Vec2::ZERO, Vec2::Y, Vec2::ONE, Vec2::X]).collect(),
        colors: Vec::new(),
        triangles: (0..6).flat_map(|face| [[0, 1, 2], [0, 2, 3]].map(|t: [u32; 3]| t.map(|i| face * 4 + i))).collect(),
    }
}

/// Returns a sphere of radius 1 with `segments` slices around and half as many rings from pole to pole.
pub(super) fn sphere(segments: u32) -> MeshData {
    Profile::from(0.0, 1.0).arc_to(0.0, -1.0, 180.0, segments / 2).revolve("sphere", segments)
}

/// Returns a torus around the y axis with major radius 1 and minor radius `tube`.
pub(super) fn torus(tube: f32, segments: u32, sides: u32) -> MeshData {
    Profile::from(1.0, tube)
        .arc_to(1.0, -tube, 180.0, sides / 2)
        .arc_to(1.0, tube, 180.0, sides / 2)
        .revolve("torus", segments)
}

/// Returns a solid cone with base radius 1 on y = 0 and its tip at y = `height`.
pub(super) fn cone(height: f32, segments: u32) -> MeshData {
    Profile::from(0.0, height).line_to(1.0, 0.0).line_to(0.0, 0.0).revolve("cone", segments)
}

/// Returns a capsule of radius 1 along the y axis, centred at the origin. The centres of its two hemispheres are
/// `length` apart.
pub(super) fn capsule(length: f32, segments: u32) -> MeshData {
    let middle = length * 0.5;
    Profile::from(0.0, middle + 1.0)
        .arc_to(1.0, middle, 90.0, segments / 4)
        .line_to(1.0, -middle)
        .arc_to(0.0, -middle - 1.0, 90.0, segments / 4)
        .revolve("capsule", segments)
}

/// Returns a flat unit square around the origin in the plane y = 0, facing up, divided into `cells` × `cells` squares.
pub(super) fn grid(cells: u32) -> MeshData {
    let place = move |i: u32| i as f32 / cells as f32;
    let corners = || (0..=cells).flat_map(move |z| (0..=cells).map(move |x| Vec2::new(place(x), place(z))));
    let row = cells + 1;
    MeshData {
        name: "grid".to_owned(),
        positions: corners().map(|p| Vec3::new(p.x - 0.5, 0.0, p.y - 0.5)).collect(),
        normals: corners().map(|_| Vec3::Y).collect(),
        uvs: corners().collect(),
        colors: Vec::new(),
        triangles: (0..cells)
            .flat_map(|z| (0..cells).map(move |x| z * row + x))
            .flat_map(|a| [[a, a + row, a + row + 1], [a, a + row + 1, a + 1]])
            .collect(),
    }
}

/// Returns a flat rectangle of this size around the origin in the plane y = 0, facing up. Its texture repeats every
/// `tile` world units.
pub(super) fn tiled(size: Vec2, tile: f32) -> MeshData {
    let mut mesh = grid(4);
    mesh.positions.iter_mut().for_each(|position| *position *= Vec3::new(size.x, 1.0, size.y));
    mapped(mesh, |position, _| Vec2::new(position.x, position.z) / tile)
}

/// Returns a trefoil knot: a tube that winds twice around the y axis and three times through the hole of a ring of
/// radius 1.
///
/// u runs along the tube, v around it. The mesh has `segments` along the tube and `sides` around it.
pub(super) fn trefoil(tube: f32, segments: u32, sides: u32) -> MeshData {
    const RING: f32 = 0.45;
    // Point on the core circle of the ring, and unit vector from that point to the curve of the knot.
    let outward = |segment: u32| {
        let angle = (segment % segments) as f32 / segments as f32 * TAU;
        let (sin, cos) = (2.0 * angle).sin_cos();
        let (lift, reach) = (3.0 * angle).sin_cos();
        (Vec3::new(cos, 0.0, sin), Vec3::new(cos * reach, lift, sin * reach))
    };
    let curve = |segment: u32| {
        let (core, outward) = outward(segment);
        core + outward * RING
    };
    let mut mesh = MeshData { name: "trefoil".to_owned(), ..MeshData::default() };
    for segment in 0..=segments {
        let tangent = (curve(segment + 1) - curve(segment + segments - 1)).normalize();
        let side = tangent.cross(outward(segment).1).normalize();
        let up = side.cross(tangent);
        for around in 0..=sides {
            let (sin, cos) = ((around % sides) as f32 / sides as f32 * TAU).sin_cos();
            let normal = up * cos + side * sin;
            mesh.positions.push(curve(segment) + normal * tube);
            mesh.normals.push(normal.normalize());
            mesh.uvs.push(Vec2::new(segment as f32 / segments as f32, around as f32 / sides as f32));
        }
    }
    let row = sides + 1;
    mesh.triangles = (0..segments)
        .flat_map(|segment| (0..sides).map(move |around| segment * row + around))
        .flat_map(|a| [[a, a + 1, a + row + 1], [a, a + row + 1, a + row]])
        .collect();
    mesh
}

/// Returns the surface with reversed normals and winding, so that it is visible from inside.
pub(super) fn inside_out(mut mesh: MeshData) -> MeshData {
    mesh.normals.iter_mut().for_each(|n| *n = -*n);
    mesh.triangles.iter_mut().for_each(|[_, b, c]| std::mem::swap(b, c));
    mesh
}

/// Returns the mesh with a copy of opposite orientation in the same place, so that both sides are visible.
pub(super) fn two_sided(mut mesh: MeshData) -> MeshData {
    let back = inside_out(mesh.clone());
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(back.positions);
    mesh.normals.extend(back.normals);
    mesh.uvs.extend(back.uvs);
    mesh.colors.extend(back.colors);
    mesh.triangles.extend(back.triangles.iter().map(|t| t.map(|corner| first + corner)));
    mesh
}

/// Returns the mesh with new texture coordinates, which `uv` computes from position and normal.
pub(super) fn mapped(mut mesh: MeshData, uv: impl Fn(Vec3, Vec3) -> Vec2) -> MeshData {
    mesh.uvs = mesh.positions.iter().zip(&mesh.normals).map(|(position, normal)| uv(*position, *normal)).collect();
    mesh
}

/// Returns the mesh with vertex colours (sRGB values) computed from its texture coordinates.
pub(super) fn painted(mut mesh: MeshData, color: impl Fn(Vec2) -> Vec3) -> MeshData {
    mesh.colors = mesh.uvs.iter().map(|uv| color(*uv)).collect();
    mesh
}

#[cfg(test)]
pub(super) mod tests {
    use std::collections::HashMap;

    use super::*;

    fn solids() -> Vec<MeshData> {
        vec![cube(), sphere(24), torus(0.4, 24, 12), cone(2.0, 24), capsule(1.5, 16), trefoil(0.2, 120, 12)]
    }

    /// Returns the number of triangles that use each edge, after merging vertices with the same position.
    pub(in super::super) fn edge_uses(mesh: &MeshData) -> HashMap<[[u32; 3]; 2], u32> {
        // Adding zero turns −0 into +0, so that equal positions have equal bits.
        let key = |i: u32| (mesh.positions[i as usize] + Vec3::ZERO).to_array().map(f32::to_bits);
        let mut uses = HashMap::new();
        for [a, b, c] in &mesh.triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let mut edge = [key(*from), key(*to)];
                edge.sort_unstable();
                *uses.entry(edge).or_default() += 1;
            }
        }
        uses
    }

    pub(in super::super) fn assert_closed(mesh: &MeshData) {
        for (edge, uses) in edge_uses(mesh) {
            assert_eq!(uses, 2, "{}: edge {:?}", mesh.name, edge.map(|p| p.map(f32::from_bits)));
        }
    }

    /// Asserts that every triangle has a non-zero area and faces in the direction of its vertex normals.
    pub(in super::super) fn assert_faces_agree(mesh: &MeshData) {
        for corners in &mesh.triangles {
            let [a, b, c] = corners.map(|i| mesh.positions[i as usize]);
            let face = (b - a).cross(c - a);
            assert!(face.length() > 0.0, "{}: degenerate {corners:?}", mesh.name);
            for i in corners {
                assert!(face.dot(mesh.normals[*i as usize]) > 0.0, "{}: {corners:?} faces away", mesh.name);
            }
        }
    }

    #[test]
    fn solids_are_closed() {
        solids().iter().for_each(assert_closed);
    }

    #[test]
    fn a_missing_triangle_opens_a_solid() {
        let mut mesh = sphere(8);
        mesh.triangles.pop();
        assert!(edge_uses(&mesh).values().any(|uses| *uses != 2));
    }

    #[test]
    fn faces_agree_with_normals() {
        solids().iter().for_each(assert_faces_agree);
        assert_faces_agree(&grid(3));
        assert_faces_agree(&inside_out(cube()));
        assert_faces_agree(&two_sided(grid(2)));
    }

    /// Returns six times the signed volume of a closed mesh, positive if its faces point outwards.
    fn sixfold_volume(mesh: &MeshData) -> f32 {
        let corner = |i: u32| mesh.positions[i as usize];
        mesh.triangles.iter().map(|[a, b, c]| corner(*a).dot(corner(*b).cross(corner(*c)))).sum()
    }

    #[test]
    fn solids_face_outwards() {
        for mesh in solids() {
            assert!(sixfold_volume(&mesh) > 0.0, "{}", mesh.name);
            assert!(sixfold_volume(&inside_out(mesh)) < 0.0);
        }
        assert_eq!(sixfold_volume(&cube()), 48.0);
    }

    #[test]
    fn a_picture_on_the_front_face_of_a_cube_is_upright() {
        let cube = cube();
        for (corner, uv) in [(Vec3::new(-1.0, 1.0, 1.0), Vec2::ZERO), (Vec3::new(1.0, -1.0, 1.0), Vec2::ONE)] {
            let seen = (0..4).find(|i| cube.positions[*i] == corner).map(|i| cube.uvs[i]);
            assert_eq!(seen, Some(uv));
        }
    }
}
