//! Meshes in the space of an object.

use glam::{DVec2, DVec3};

/// Corner of a triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MeshCorner {
    pub(crate) position: DVec3,
    /// Texture coordinates, v upwards.
    pub(crate) uv: DVec2,
    /// Unit normal.
    pub(crate) normal: DVec3,
}

/// Triangles, counter-clockwise from their front.
#[derive(Clone, Debug, Default)]
pub(crate) struct Mesh {
    pub(crate) triangles: Vec<[MeshCorner; 3]>,
}

impl Mesh {
    /// Adds a quadrilateral from its corners, counter-clockwise from its front, split between the first and the third.
    pub(crate) fn quad(&mut self, [a, b, c, d]: [MeshCorner; 4]) {
        self.triangles.extend([[a, b, c], [a, c, d]]);
    }

    /// Returns a surface over a grid of `columns` × `rows` cells, from a function of two parameters, 0…1. The front is
    /// where the first parameter runs right and the second one up.
    pub(crate) fn surface(columns: usize, rows: usize, corner: impl Fn(f64, f64) -> MeshCorner) -> Self {
        let at = |x: usize, y: usize| corner(x as f64 / columns as f64, y as f64 / rows as f64);
        let mut mesh = Self::default();
        for y in 0..rows {
            for x in 0..columns {
                mesh.quad([at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)]);
            }
        }
        mesh.triangles.retain(|triangle| face_normal(triangle).length() > 1e-12);
        mesh
    }

    /// Returns the mesh with the normal of its triangle in every corner.
    pub(crate) fn flat(mut self) -> Self {
        for triangle in &mut self.triangles {
            let normal = face_normal(triangle).normalize();
            triangle.iter_mut().for_each(|corner| corner.normal = normal);
        }
        self
    }

    /// Returns the mesh turned inside out.
    pub(crate) fn inverted(mut self) -> Self {
        for triangle in &mut self.triangles {
            triangle.swap(1, 2);
            triangle.iter_mut().for_each(|corner| corner.normal = -corner.normal);
        }
        self
    }

    /// Returns the mesh with its texture repeated `u` × `v` times as often.
    pub(crate) fn repeated(mut self, u: f64, v: f64) -> Self {
        self.triangles.iter_mut().flatten().for_each(|corner| corner.uv *= DVec2::new(u, v));
        self
    }
}

/// Returns the normal of a triangle, with twice its area as length.
pub(crate) fn face_normal([a, b, c]: &[MeshCorner; 3]) -> DVec3 {
    (b.position - a.position).cross(c.position - a.position)
}
