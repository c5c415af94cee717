//! Shapes around the origin, to be placed by a transformation.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};

use super::mesh::{Mesh, MeshCorner};

/// Returns a square from −½ to ½ in x and y that faces +z, with its texture once.
pub(crate) fn card() -> Mesh {
    Mesh::surface(1, 1, |u, v| MeshCorner {
        position: DVec3::new(u - 0.5, v - 0.5, 0.0),
        uv: DVec2::new(u, v),
        normal: DVec3::Z,
    })
}

/// Returns a cube from −½ to ½ with the texture once on every side.
pub(crate) fn cube() -> Mesh {
    let mut mesh = Mesh::default();
    for (right, up) in [
        (DVec3::X, DVec3::Y),
        (DVec3::NEG_Z, DVec3::Y),
        (DVec3::NEG_X, DVec3::Y),
        (DVec3::Z, DVec3::Y),
        (DVec3::X, DVec3::NEG_Z),
        (DVec3::X, DVec3::Z),
    ] {
        let normal = right.cross(up);
        let side = Mesh::surface(1, 1, |u, v| MeshCorner {
            position: right * (u - 0.5) + up * (v - 0.5) + normal * 0.5,
            uv: DVec2::new(u, v),
            normal,
        });
        mesh.triangles.extend(side.triangles);
    }
    mesh
}

/// Returns a smooth sphere of radius 1.
pub(crate) fn sphere(segments: usize, rings: usize) -> Mesh {
    Mesh::surface(segments, rings, |u, v| {
        let (longitude, latitude) = (u * TAU, (v - 0.5) * PI);
        // Cosines below the rounding error would give the poles a circumference.
        let radius = if v == 0.0 || v == 1.0 { 0.0 } else { latitude.cos() };
        let normal = DVec3::new(longitude.sin() * radius, latitude.sin(), longitude.cos() * radius).normalize();
        MeshCorner { position: normal, uv: DVec2::new(u, v), normal }
    })
}

/// Returns the smooth side of a cylinder of radius 1 from y = 0 to y = 1.
pub(crate) fn column(segments: usize) -> Mesh {
    Mesh::surface(segments, 1, |u, v| {
        let normal = DVec3::new((u * TAU).sin(), 0.0, (u * TAU).cos());
        MeshCorner { position: normal + DVec3::Y * v, uv: DVec2::new(u, v), normal }
    })
}

/// Returns a smooth tube of the given radius around a trefoil knot of radius about 1.5.
pub(crate) fn knot(segments: usize, sides: usize, radius: f64) -> Mesh {
    let center = |t: f64| {
        let (angle, ring) = (2.0 * t * TAU, 1.0 + 0.45 * (3.0 * t * TAU).cos());
        DVec3::new(angle.cos() * ring, angle.sin() * ring, 0.45 * (3.0 * t * TAU).sin())
    };
    Mesh::surface(segments, sides, |u, v| {
        let along = (center(u + 1e-5) - center(u - 1e-5)).normalize();
        let across = along.cross(DVec3::Z).normalize();
        let normal = across * (v * TAU).cos() + across.cross(along) * (v * TAU).sin();
        MeshCorner { position: center(u) + normal * radius, uv: DVec2::new(u, v), normal }
    })
}

/// Returns smooth terrain over the square from −½ to ½ in x and z, with the given height at each point.
pub(crate) fn terrain(cells: usize, height: impl Fn(f64, f64) -> f64) -> Mesh {
    Mesh::surface(cells, cells, |u, v| {
        let (x, z) = (u - 0.5, 0.5 - v);
        let slope_x = (height(x + 1e-5, z) - height(x - 1e-5, z)) / 2e-5;
        let slope_z = (height(x, z + 1e-5) - height(x, z - 1e-5)) / 2e-5;
        MeshCorner {
            position: DVec3::new(x, height(x, z), z),
            uv: DVec2::new(u, v),
            normal: DVec3::new(-slope_x, 1.0, -slope_z).normalize(),
        }
    })
}

/// Returns the part of a fan between two of its rim points in the plane z = 0, facing +z, with the texture coordinates
/// of the whole fan of the given radius.
pub(crate) fn wedge(from: DVec2, to: DVec2, radius: f64) -> Mesh {
    let corner =
        |point: DVec2| MeshCorner { position: point.extend(0.0), uv: point / (2.0 * radius) + 0.5, normal: DVec3::Z };
    Mesh { triangles: vec![[corner(DVec2::ZERO), corner(from), corner(to)]] }
}

#[cfg(test)]
mod tests {
    use super::super::mesh::face_normal;
    use super::*;

    #[test]
    fn normals_are_unit_vectors_on_the_front_of_their_triangles() {
        let bump = terrain(6, |x, z| 0.1 * (9.0 * x).sin() * (7.0 * z).cos());
        let wedge = wedge(DVec2::new(2.0, 1.0), DVec2::new(1.0, 2.0), 2.0);
        for (name, mesh) in [
            ("card", card()),
            ("cube", cube()),
            ("sphere", sphere(12, 8)),
            ("column", column(9)),
            ("knot", knot(64, 8, 0.3)),
            ("terrain", bump),
            ("wedge", wedge),
            ("flat", sphere(12, 8).flat()),
            ("inverted", sphere(12, 8).inverted()),
        ] {
            for triangle in &mesh.triangles {
                let face = face_normal(triangle).normalize();
                for corner in triangle {
                    assert!((corner.normal.length() - 1.0).abs() < 1e-9, "{name}: {corner:?}");
                    assert!(corner.normal.dot(face) > 0.5, "{name}: {corner:?} {face}");
                }
            }
        }
    }
}
