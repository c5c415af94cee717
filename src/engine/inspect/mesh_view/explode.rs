//! Exploded view: triangles moved apart to show shared vertices and hidden surfaces.

use glam::Vec3;

use crate::inspect::vertices::corners_of;
use crate::scene::mesh::MeshData;
use crate::scene::{Mesh, Scene, TriangleId};

/// Returns a scene whose triangles are moved away from the centre of their mesh. Each triangle moves by `apart` times
/// its distance from the centre. At 0, triangles stay in place but no longer share vertices. Triangles keep their
/// numbers; texture coordinates and vertex colours are dropped.
pub(crate) fn exploded(scene: &Scene, apart: f32) -> Scene {
    let library = scene.library.with_meshes(|mesh| {
        let corners = mesh.triangles.iter().flat_map(|corners| moved(mesh, *corners, apart));
        let positions: Vec<Vec3> = corners.collect();
        let triangles = (0..mesh.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let normals = mesh.triangles.iter().flatten().filter_map(|v| mesh.normals.get(*v as usize)).copied().collect();
        let data =
            MeshData { name: mesh.name.clone(), positions, normals, uvs: Vec::new(), colors: Vec::new(), triangles };
        // The arrays have the lengths and indices of a valid mesh.
        Mesh::new(data).unwrap_or_else(|_| mesh.clone())
    });
    Scene { library, animation: None, ..scene.clone() }
}

/// Returns the corners of an exploded triangle in model space; the original corners if a coordinate would overflow.
fn moved(mesh: &Mesh, corners: [u32; 3], apart: f32) -> [Vec3; 3] {
    let corners = corners.map(|corner| mesh.positions.get(corner as usize).copied().unwrap_or_default());
    let offset = ((corners[0] + corners[1] + corners[2]) / 3.0 - mesh.bounds().center()) * apart;
    let moved = corners.map(|corner| corner + offset);
    if moved.iter().all(|corner| corner.is_finite()) { moved } else { corners }
}

/// Returns the corners of a triangle in world space, moved apart as by [`exploded`]. `None` if the scene has no such
/// triangle.
pub(crate) fn corners(scene: &Scene, triangle: TriangleId, apart: f32) -> Option<[Vec3; 3]> {
    let (instance, corners) = corners_of(scene, triangle)?;
    let instance = scene.instances.get(instance)?;
    let moved = moved(scene.library.mesh(instance.mesh), corners, apart);
    Some(moved.map(|corner| instance.world_from_model.transform_point3(corner)))
}
