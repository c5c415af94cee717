//! Vertex and face normals as lines on the screen.
//!
//! A line starts at its vertex, or at the centroid of its triangle, and points along the normal in world space. It is
//! clipped at the near and far planes, but not occluded by surfaces.

use std::collections::BTreeMap;

use glam::{DMat4, DVec3, DVec4};

use crate::math::unit_or;
use crate::pipeline::vertex::DrawMatrices;
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, DepthMapping, Instance, Scene, TriangleId};

/// Default length of drawn normals, as a fraction of the diagonal of the scene's bounding box. It suits small objects
/// on a floor many times their size.
pub(crate) const DEFAULT_LENGTH: f32 = 0.005;

/// Minimum clip-space w of a projected point: lines are clipped there, which avoids a division by zero.
const MIN_W: f64 = f32::MIN_POSITIVE as f64;

/// Kind of normals to draw.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NormalKind {
    /// Vertex normals, which shading interpolates.
    Vertex,
    /// Face normals at the centroids of triangles, towards the side from which the winding is counter-clockwise.
    Face,
}

/// Normals projected to the screen as lines.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct NormalLines {
    /// Start and end of each line in px, clipped at the near and far planes.
    pub(crate) lines: Vec<[[f64; 2]; 2]>,
    /// Number of vertices or triangles in view whose normal has zero length.
    pub(crate) without: usize,
}

/// Projection of world-space lines to the screen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Projector {
    clip_from_world: DMat4,
    viewport: Viewport,
}

impl Projector {
    /// Creates the projection of a camera to a picture of this size, in pixels.
    pub(crate) fn new(camera: &Camera, viewport: Viewport) -> Self {
        Self { clip_from_world: camera.clip_from_world_f64(viewport.aspect(), DepthMapping::STANDARD), viewport }
    }

    /// Projects a line segment from world space and returns its endpoints in px; `None` if no part of it lies between
    /// the near and far planes.
    fn line(&self, from: DVec3, to: DVec3) -> Option<[[f64; 2]; 2]> {
        let [a, b] = [from, to].map(|at| self.clip_from_world * at.extend(1.0));
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        for distance in [|p: DVec4| p.z, |p: DVec4| p.w - p.z, |p: DVec4| p.w - MIN_W] {
            let (start, end) = (distance(a), distance(b));
            if start < 0.0 && end < 0.0 {
                return None;
            }
            if start < 0.0 {
                enter = enter.max(start / (start - end));
            } else if end < 0.0 {
                leave = leave.min(start / (start - end));
            }
        }
        let px = |t: f64| {
            let p = a + (b - a) * t;
            let Viewport { width, height } = self.viewport;
            [(p.x / p.w * 0.5 + 0.5) * f64::from(width), (0.5 - p.y / p.w * 0.5) * f64::from(height)]
        };
        let ends = [px(enter), px(leave)];
        (enter < leave && ends.as_flattened().iter().all(|c| c.is_finite())).then_some(ends)
    }
}

/// Projects the normals of `triangles` as lines of `length` world units. The normal of a shared vertex is included once
/// per object.
pub(crate) fn normal_lines(
    scene: &Scene,
    kind: NormalKind,
    length: f64,
    triangles: impl Iterator<Item = TriangleId>,
    projector: &Projector,
) -> NormalLines {
    let first_triangles = scene.first_triangles();
    let mut objects: BTreeMap<usize, Object<'_>> = BTreeMap::new();
    let mut found = NormalLines::default();
    for triangle in triangles {
        let Some(index) = first_triangles.partition_point(|first| *first <= triangle).checked_sub(1) else { continue };
        let object = objects.entry(index).or_insert_with(|| Object::new(scene, &scene.instances[index]));
        let Some(corners) = object.mesh.triangles.get((triangle.0 - first_triangles[index].0) as usize) else {
            continue;
        };
        let mut add = |at: DVec3, normal: DVec3| {
            if normal == DVec3::ZERO {
                found.without += usize::from(projector.line(at, at + DVec3::splat(length)).is_some());
            } else {
                found.lines.extend(projector.line(at, at + normal * length));
            }
        };
        match kind {
            NormalKind::Vertex => {
                for corner in corners.map(|corner| corner as usize) {
                    if !std::mem::replace(&mut object.seen[corner], true) {
                        add(object.position(corner), object.normal(corner));
                    }
                }
            }
            NormalKind::Face => {
                let [a, b, c] = corners.map(|corner| object.position(corner as usize));
                add((a + b + c) / 3.0, unit_or((b - a).cross(c - a), glam::Vec3::ZERO).as_dvec3());
            }
        }
    }
    found
}

/// An object whose normals are drawn.
struct Object<'a> {
    mesh: &'a crate::scene::Mesh,
    world_from_model: DMat4,
    matrices: DrawMatrices,
    /// Whether the normal of each vertex was already added.
    seen: Vec<bool>,
}

impl<'a> Object<'a> {
    fn new(scene: &'a Scene, instance: &'a Instance) -> Self {
        let mesh = scene.library.mesh(instance.mesh);
        Self {
            mesh,
            world_from_model: instance.world_from_model.as_dmat4(),
            // Only the normal matrix is used, which does not depend on the view.
            matrices: DrawMatrices::new(instance, DMat4::IDENTITY),
            seen: vec![false; mesh.positions.len()],
        }
    }

    fn position(&self, vertex: usize) -> DVec3 {
        self.world_from_model.transform_point3(self.mesh.positions[vertex].as_dvec3())
    }

    /// Returns the unit normal of a vertex in world space; zero if the vertex has no normal.
    fn normal(&self, vertex: usize) -> DVec3 {
        let normal = self.matrices.world_from_model_normal * self.mesh.normals[vertex];
        unit_or(normal.as_dvec3(), glam::Vec3::ZERO).as_dvec3()
    }
}

/// Converts a fraction of the diagonal of the scene's bounding box to world units.
pub(crate) fn world_length(scene: &Scene, share: f32) -> f64 {
    let bounds = scene.bounds();
    if bounds.is_empty() { 0.0 } else { f64::from(share) * bounds.min.as_dvec3().distance(bounds.max.as_dvec3()) }
}

#[cfg(test)]
mod tests {
    use glam::{Mat4, Vec3};

    use super::*;
    use crate::scene::builtin;

    const VIEW: Viewport = Viewport { width: 80, height: 60 };

    fn cubes() -> Scene {
        builtin::by_id("cubes").unwrap().build()
    }

    fn all(scene: &Scene) -> impl Iterator<Item = TriangleId> {
        (0..scene.triangle_count() as u32).map(TriangleId)
    }

    fn lines(scene: &Scene, kind: NormalKind, length: f64) -> NormalLines {
        normal_lines(scene, kind, length, all(scene), &Projector::new(&scene.home, VIEW))
    }

    #[test]
    fn lines_start_at_projected_vertices_and_centroids_and_end_along_the_normal() {
        let mut scene = cubes();
        scene.instances.truncate(1);
        // Non-uniform scale: normals transform by the inverse transpose.
        scene.instances[0].world_from_model *= Mat4::from_scale(Vec3::new(1.0, 0.3, 2.0));
        let clip_from_world = scene.home.clip_from_world(VIEW.aspect(), DepthMapping::STANDARD);
        let px = |at: Vec3| VIEW.pixels_from_ndc(clip_from_world.project_point3(at));
        let place = scene.instances[0].world_from_model;
        let mesh = scene.library.mesh(scene.instances[0].mesh);
        let normal_from_model = Mat4::from_mat3(glam::Mat3::from_mat4(place).inverse().transpose());
        let is_there = |found: &NormalLines, ends: [Vec3; 2]| {
            let [(ax, ay), (bx, by)] = ends.map(px);
            let expected = [[ax, ay], [bx, by]].map(|end| end.map(f64::from));
            let same = |line: &[[f64; 2]; 2]| {
                line.as_flattened().iter().zip(expected.as_flattened()).all(|(a, b)| (a - b).abs() < 1e-2)
            };
            found.lines.iter().any(same)
        };
        let (vertices, faces) = (lines(&scene, NormalKind::Vertex, 0.2), lines(&scene, NormalKind::Face, 0.2));
        assert_eq!((vertices.lines.len(), faces.lines.len()), (mesh.positions.len(), mesh.triangles.len()));
        for (position, normal) in mesh.positions.iter().zip(&mesh.normals) {
            let (at, normal) = (place.transform_point3(*position), normal_from_model.transform_vector3(*normal));
            assert!(is_there(&vertices, [at, at + normal.normalize() * 0.2]));
        }
        for corners in &mesh.triangles {
            let [a, b, c] = corners.map(|corner| place.transform_point3(mesh.positions[corner as usize]));
            let (at, normal) = ((a + b + c) / 3.0, (b - a).cross(c - a).normalize());
            assert!(is_there(&faces, [at, at + normal * 0.2]));
        }
    }

    #[test]
    fn lines_are_cut_at_the_near_plane_and_none_lies_behind() {
        let camera = Camera { near: 1.0, far: 10.0, ..Camera::look_at(Vec3::ZERO, Vec3::NEG_Z) };
        let projector = Projector::new(&camera, VIEW);
        let at = |x: f64, z: f64| DVec3::new(x, 0.0, z);
        let whole = projector.line(at(0.1, -2.0), at(0.1, -4.0)).unwrap();
        let cut = projector.line(at(0.1, -2.0), at(0.1, 5.0)).unwrap();
        assert_eq!(cut[0], whole[0]);
        let at_plane = projector.line(at(0.1, -1.0), at(0.1, -2.0)).unwrap()[0];
        assert!(
            (cut[1][0] - at_plane[0]).abs() < 1e-3 && (cut[1][1] - at_plane[1]).abs() < 1e-3,
            "{cut:?} {at_plane:?}"
        );
        assert_eq!(projector.line(at(0.1, -0.5), at(0.1, 5.0)), None);
        assert_eq!(projector.line(at(0.1, -11.0), at(0.1, -20.0)), None);
        assert!(projector.line(at(0.1, -20.0), at(0.1, 20.0)).is_some(), "from beyond the far plane to behind the eye");
    }

    #[test]
    fn vertices_without_a_normal_are_counted() {
        let scene = builtin::by_id("nan-normal").unwrap().build();
        assert!(lines(&scene, NormalKind::Vertex, 0.1).without > 0);
        assert_eq!(lines(&scene, NormalKind::Face, 0.1).without, 0);
    }
}
