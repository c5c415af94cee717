//! Light of interpolated normals that are not normalised, as light computed at vertices.
//!
//! Without normalisation, N·L is linear across a triangle, like the light that is computed at its corners. Both differ
//! only where N·L changes its sign inside a triangle: negative values count as 0 after the interpolation, not before.
//! So all triangles are cut along N·L = 0.

use std::collections::HashMap;

use glam::{Mat3, Vec3};
use rasterscope_engine::pipeline::settings::Shading;
use rasterscope_engine::scene::{Mesh, MeshData};

use crate::setup::{Setup, edit};

/// Lights the scene as without normalisation of interpolated normals. Changes nothing unless the shading is Lambert.
pub(crate) fn skip_normalisation(setup: &mut Setup) {
    if setup.recipe.pipeline.shading != Shading::Lambert {
        return;
    }
    setup.recipe.pipeline.shading = Shading::Gouraud;
    let light = setup.recipe.pipeline.light.direction;
    let scene = edit(&mut setup.scene);
    for instance in &mut scene.instances {
        let transform = Mat3::from_mat4(instance.world_from_model);
        // N·L of a normal n in model space, up to a positive factor: the transform of n is the inverse transpose.
        let light = transform.inverse() * light;
        if !light.is_finite() {
            continue;
        }
        let cut = cut_along(scene.library.mesh(instance.mesh), |normal| normal.dot(light));
        if let Ok(mesh) = Mesh::new(cut) {
            instance.mesh = scene.library.add_mesh(mesh);
        }
    }
}

/// Returns the mesh with every triangle cut where `cosine`, a linear function of the normal, is 0.
fn cut_along(mesh: &Mesh, cosine: impl Fn(Vec3) -> f32) -> MeshData {
    let mut cut = Cut { data: (**mesh).clone(), of_edge: HashMap::new() };
    let cosines: Vec<f32> = mesh.normals.iter().map(|normal| cosine(*normal)).collect();
    let triangles = std::mem::take(&mut cut.data.triangles);
    for corners in triangles {
        let of = corners.map(|corner| cosines[corner as usize]);
        if of.iter().all(|cosine| *cosine >= 0.0) || of.iter().all(|cosine| *cosine <= 0.0) {
            cut.data.triangles.push(corners);
            continue;
        }
        for sign in [1.0, -1.0] {
            let side = cut.side(corners, of.map(|cosine| cosine * sign));
            for next in 1..side.len() - 1 {
                cut.data.triangles.push([side[0], side[next], side[next + 1]]);
            }
        }
    }
    cut.data
}

/// A mesh while its triangles are cut.
struct Cut {
    data: MeshData,
    /// New vertex on each edge that was cut, by its ends in ascending order.
    of_edge: HashMap<[u32; 2], u32>,
}

impl Cut {
    /// Returns the corners of the part of a triangle in which the linear function with the given values is positive.
    fn side(&mut self, corners: [u32; 3], values: [f32; 3]) -> Vec<u32> {
        let mut side = Vec::with_capacity(4);
        for (this, next) in [(0, 1), (1, 2), (2, 0)] {
            if values[this] >= 0.0 {
                side.push(corners[this]);
            }
            if values[this] * values[next] < 0.0 {
                side.push(self.vertex([corners[this], corners[next]], [values[this], values[next]]));
            }
        }
        side
    }

    /// Returns the vertex at which the linear function is 0 on an edge.
    fn vertex(&mut self, ends: [u32; 2], values: [f32; 2]) -> u32 {
        // Both triangles at an edge, and both sides of a triangle, compute the same vertex.
        let [(a, from), (b, to)] = match [(ends[0], values[0]), (ends[1], values[1])] {
            [first, second] if first.0 < second.0 => [first, second],
            [first, second] => [second, first],
        };
        let data = &mut self.data;
        *self.of_edge.entry([a, b]).or_insert_with(|| {
            let (a, b, share) = (a as usize, b as usize, from / (from - to));
            data.positions.push(data.positions[a].lerp(data.positions[b], share));
            data.normals.push(data.normals[a].lerp(data.normals[b], share).normalize_or(Vec3::Z));
            if !data.uvs.is_empty() {
                data.uvs.push(data.uvs[a].lerp(data.uvs[b], share));
            }
            if !data.colors.is_empty() {
                data.colors.push(data.colors[a].lerp(data.colors[b], share));
            }
            data.positions.len() as u32 - 1
        })
    }
}
