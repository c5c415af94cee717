//! Vertices at every pipeline stage, from the mesh to the pixel grid.
//!
//! Clip-space position, screen position and snapped position are computed by the same functions that draw. The pipeline
//! never computes world and view positions: it multiplies the matrices first, in f64, and rounds the product once.
//! World and view positions are therefore reported in f64, unrounded.

use glam::{DMat4, DVec3, Vec2, Vec3, Vec4};
use serde::Serialize;

use crate::pipeline::clip_space::{ClipPlane, ClipVertex, MIN_W};
use crate::pipeline::depth::DepthScale;
use crate::pipeline::settings::Settings;
use crate::pipeline::vertex::DrawMatrices;
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, Mesh, Scene, TriangleId};

/// Set of frustum planes beyond which a vertex lies, with one bit for each of [`ClipPlane::ALL`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(transparent)]
pub struct Outcode(u8);

impl Outcode {
    /// Computes the outcode of a clip-space position. `has_zero_at_far` states whether z = 0 is the far plane. A NaN
    /// distance counts as inside its plane.
    pub(crate) fn of(position: Vec4, has_zero_at_far: bool) -> Self {
        let beyond = |plane: &ClipPlane| plane.of_view(has_zero_at_far).distance(position, 1.0) < 0.0;
        Self(
            ClipPlane::ALL
                .iter()
                .enumerate()
                .filter(|(_, plane)| beyond(plane))
                .fold(0, |bits, (bit, _)| bits | 1 << bit),
        )
    }

    /// Returns the planes beyond which the vertex lies, in clipping order.
    pub fn planes(self) -> impl Iterator<Item = ClipPlane> {
        ClipPlane::ALL.into_iter().enumerate().filter(move |(bit, _)| self.0 >> bit & 1 == 1).map(|(_, plane)| plane)
    }

    /// Whether the vertex lies inside the frustum.
    pub(crate) fn is_inside(self) -> bool {
        self.0 == 0
    }
}

/// Returns the display name of a clip plane.
pub fn plane_name(plane: ClipPlane) -> &'static str {
    match plane {
        ClipPlane::Near => "near",
        ClipPlane::Eye => "eye",
        ClipPlane::Far => "far",
        ClipPlane::Left => "left",
        ClipPlane::Right => "right",
        ClipPlane::Bottom => "bottom",
        ClipPlane::Top => "top",
    }
}

/// Position of a vertex after the perspective division.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct OnScreen {
    /// Normalised device coordinates: x/w, y/w, z/w.
    pub ndc: Vec3,
    /// Screen position before snapping, in px.
    pub px: [f32; 2],
    /// Screen position snapped to the subpixel grid, in units of 1/256 px.
    pub snapped: [i32; 2],
    /// Depth before quantisation, in [0, 1].
    pub(crate) depth: f64,
    /// 1/w of the clip-space position.
    pub(crate) inv_w: f32,
}

/// One vertex at every pipeline stage.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct VertexStages {
    /// Index of the vertex in the mesh.
    pub index: u32,
    /// Position in model space.
    pub model: Vec3,
    /// Normal in model space.
    pub normal: Vec3,
    /// Texture coordinates (u, v), with v pointing down; `None` if the mesh has none.
    pub uv: Option<Vec2>,
    /// Colour as sRGB-encoded values in [0, 1]; `None` if the mesh has none.
    pub color: Option<Vec3>,
    /// Position in world space.
    pub world: DVec3,
    /// Position in view space.
    pub view: DVec3,
    /// Position in clip space.
    pub clip: Vec4,
    /// Frustum planes beyond which the vertex lies.
    pub outcode: Outcode,
    /// Screen position; `None` if w is below the minimum or the clip position is not finite. Triangles with such a
    /// vertex are clipped before the division.
    pub screen: Option<OnScreen>,
}

/// Vertices of one object, transformed for a camera and a viewport.
#[derive(Clone, Copy, Debug)]
pub struct ObjectVertices<'a> {
    mesh: &'a Mesh,
    matrices: DrawMatrices,
    world_from_model: DMat4,
    view_from_world: DMat4,
    viewport: Viewport,
    depth_scale: DepthScale,
    has_zero_at_far: bool,
}

impl<'a> ObjectVertices<'a> {
    /// Prepares the vertices of the object with index `instance`. Returns `None` if the scene has no such object.
    pub fn new(
        scene: &'a Scene,
        camera: &Camera,
        settings: &Settings,
        viewport: Viewport,
        instance: usize,
    ) -> Option<Self> {
        let instance = scene.instances.get(instance)?;
        let mapping = settings.depth_format.mapping();
        Some(Self {
            mesh: scene.library.mesh(instance.mesh),
            matrices: DrawMatrices::new(instance, camera.clip_from_world_f64(viewport.aspect(), mapping)),
            world_from_model: instance.world_from_model.as_dmat4(),
            view_from_world: camera.view_from_world_f64(),
            viewport,
            depth_scale: DepthScale::new(settings.depth_format, camera),
            has_zero_at_far: camera.has_zero_at_far(mapping),
        })
    }

    /// Returns the number of vertices in the object's mesh.
    pub fn count(&self) -> usize {
        self.mesh.positions.len()
    }

    /// Returns the vertex with this index at every pipeline stage; `None` if `index` is out of range.
    pub fn stages(&self, index: u32) -> Option<VertexStages> {
        let place = index as usize;
        let model = *self.mesh.positions.get(place)?;
        let world = self.world_from_model.transform_point3(model.as_dvec3());
        let clip = self.matrices.clip_position(model);
        Some(VertexStages {
            index,
            model,
            normal: self.mesh.normals.get(place).copied().unwrap_or_default(),
            uv: self.mesh.uvs.get(place).copied(),
            color: self.mesh.colors.get(place).copied(),
            world,
            view: self.view_from_world.transform_point3(world),
            clip,
            outcode: Outcode::of(clip, self.has_zero_at_far),
            screen: (clip.is_finite() && clip.w >= MIN_W).then(|| self.on_screen(clip)),
        })
    }

    fn on_screen(&self, clip: Vec4) -> OnScreen {
        let projected = self.viewport.project_vertex(&ClipVertex::at(clip), &self.depth_scale);
        OnScreen {
            ndc: clip.truncate() * projected.inv_w,
            px: projected.position_px,
            snapped: [projected.x, projected.y],
            depth: projected.depth,
            inv_w: projected.inv_w,
        }
    }
}

/// Returns the object index of a triangle, and the mesh indices of its corners. `None` if the scene has no such
/// triangle.
pub fn corners_of(scene: &Scene, triangle: TriangleId) -> Option<(usize, [u32; 3])> {
    let firsts = scene.first_triangles();
    // Last object that begins at or before the triangle; an object without triangles begins where the next one does.
    let instance = firsts.partition_point(|first| *first <= triangle).checked_sub(1)?;
    let mesh = scene.library.mesh(scene.instances.get(instance)?.mesh);
    let corners = mesh.triangles.get((triangle.0 - firsts[instance].0) as usize)?;
    Some((instance, *corners))
}

#[cfg(test)]
mod tests {
    use glam::{Mat4, Quat, Vec3};

    use super::*;
    use crate::pipeline::prepare;
    use crate::pipeline::settings::{Choice as _, Culling, DepthFormat};
    use crate::scene::builtin;

    const SIZE: Viewport = Viewport { width: 160, height: 120 };

    #[test]
    fn every_unclipped_corner_matches_the_drawn_vertex() {
        for id in ["chess", "near-plane", "z-fighting"] {
            let scene = builtin::by_id(id).unwrap().build();
            let settings = Settings { culling: Culling::None, ..Settings::default() };
            let geometry = prepare(&scene, &scene.home, &settings, SIZE, &mut ());
            let mut compared = 0;
            for triangle in &geometry.triangles {
                let (instance, corners) = corners_of(&scene, triangle.id).unwrap();
                assert_eq!(instance, triangle.instance as usize);
                let object = ObjectVertices::new(&scene, &scene.home, &settings, SIZE, instance).unwrap();
                for drawn in &triangle.vertices {
                    // Corners created by clipping are not vertices.
                    let weights = drawn.varyings.source_weights.to_array();
                    let Some(corner) = weights.iter().position(|weight| *weight == 1.0) else { continue };
                    let index = corners[corner];
                    let reported = object.stages(index).unwrap().screen.unwrap();
                    let position = drawn.position_px.map(f32::to_bits);
                    assert_eq!(
                        (reported.px.map(f32::to_bits), reported.snapped),
                        (position, [drawn.x, drawn.y]),
                        "{id}"
                    );
                    assert_eq!((reported.inv_w, reported.depth), (drawn.inv_w, drawn.depth), "{id}");
                    compared += 1;
                }
            }
            assert!(compared > 30, "{id}: {compared}");
        }
    }

    #[test]
    fn outcodes_name_the_planes_beyond_which_a_vertex_lies() {
        let names = |position| Outcode::of(position, false).planes().map(plane_name).collect::<Vec<_>>();
        assert_eq!(names(Vec4::new(0.0, 0.0, 0.5, 1.0)), [""; 0]);
        assert_eq!(names(Vec4::new(-2.0, 0.0, 0.5, 1.0)), ["left"]);
        assert_eq!(names(Vec4::new(2.0, 3.0, 2.0, 1.0)), ["far", "right", "top"]);
        assert_eq!(names(Vec4::new(0.0, 0.0, -0.5, 1.0)), ["near"]);
        assert!(names(Vec4::new(0.0, 0.0, -2.0, -1.0)).contains(&"eye"));
        assert!(Outcode::of(Vec4::new(0.0, 0.0, 0.5, 1.0), false).is_inside());
    }

    #[test]
    fn outcodes_name_near_and_far_correctly_in_every_depth_format() {
        let mut scene = builtin::by_id("triangle").unwrap().build();
        for (format, orthographic) in DepthFormat::ALL.iter().flat_map(|format| [(format, false), (format, true)]) {
            let settings = Settings { depth_format: *format, ..Settings::default() };
            let camera = Camera { near: 1.0, far: 2.0, ..scene.home.with_orthographic(orthographic) };
            for (distance, expected) in [(0.5, "near"), (1.5, ""), (4.0, "far")] {
                // Scales the object to a single point in the middle of the picture.
                let place = camera.eye + camera.forward() * distance;
                scene.instances[0].world_from_model =
                    Mat4::from_scale_rotation_translation(Vec3::ZERO, Quat::IDENTITY, place);
                let object = ObjectVertices::new(&scene, &camera, &settings, SIZE, 0).unwrap();
                let names: Vec<_> = object.stages(0).unwrap().outcode.planes().map(plane_name).collect();
                let has_far_plane = orthographic || format.mapping().has_far_plane();
                let expected = if has_far_plane || expected == "near" { expected } else { "" };
                assert_eq!(names.join(" "), expected, "{format:?} {orthographic} {distance}");
            }
        }
    }

    #[test]
    fn a_vertex_behind_the_eye_has_no_screen_position() {
        let scene = builtin::by_id("near-plane").unwrap().build();
        let settings = Settings::default();
        let mut behind = 0;
        for instance in 0..scene.instances.len() {
            let object = ObjectVertices::new(&scene, &scene.home, &settings, SIZE, instance).unwrap();
            for index in 0..object.count() as u32 {
                let reported = object.stages(index).unwrap();
                assert_eq!(reported.screen.is_none(), reported.clip.w < MIN_W);
                // In perspective, w is the distance along the line of sight.
                assert!((f64::from(reported.clip.w) + reported.view.z).abs() <= 1e-5 * reported.view.z.abs().max(1.0));
                behind += usize::from(reported.screen.is_none());
            }
            assert_eq!(object.stages(object.count() as u32), None);
        }
        assert!(behind > 0);
    }

    #[test]
    fn a_missing_triangle_has_no_corners() {
        let scene = builtin::by_id("cubes").unwrap().build();
        assert!(corners_of(&scene, TriangleId(scene.triangle_count() as u32 - 1)).is_some());
        assert_eq!(corners_of(&scene, TriangleId(scene.triangle_count() as u32)), None);
        assert_eq!(corners_of(&scene, TriangleId::NONE), None);
    }
}
