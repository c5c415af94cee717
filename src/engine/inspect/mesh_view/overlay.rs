//! Overlay of the mesh view: lines, polygons and dots, in pixels of the mesh view. They mark the frustum, the ray
//! through the picked pixel, and clipped and culled triangles.

use glam::{DMat4, DVec3, DVec4, Vec3};

use super::hatch::{ScreenPoint, hatch};
use super::{Inner, corners};
use crate::inspect::fates::GeometryOutcome;
use crate::pipeline::clip::{Cut, Polygon, guard_band_widening};
use crate::pipeline::clip_space::ClipVertex;
use crate::pipeline::observe::Fate;
use crate::pipeline::vertex::DrawMatrices;
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, DepthMapping, Projection, Scene, TriangleId};

/// Number of clipped triangles, or of culled triangles, above which only the selected one is marked.
const MAX_MARKED: usize = 200;

/// Distance between neighbouring hatching lines along each axis, in px.
const HATCH_PX: f32 = 7.0;

/// Minimum clip-space w of a projected point, as a fraction of the second camera's near distance.
const MIN_W: f64 = 1e-6;

/// Kind of a mark in the overlay of the mesh view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MarkKind {
    /// An edge of the render camera's frustum.
    Frustum,
    /// The near rectangle of the frustum, as a polygon.
    NearPlane,
    /// The eye of the render camera, as a dot.
    Eye,
    /// The ray from the eye through the picked pixel to the visible surface, or to the end of the frustum.
    Ray,
    /// The part of the ray behind the surface that it hits.
    RayBehind,
    /// The point where the ray hits a surface, as a dot.
    Hit,
    /// The selected triangle, as a polygon.
    Selected,
    /// Outline of the remaining part of a clipped triangle.
    RemainingPart,
    /// A hatching line over the clipped part of a triangle.
    CutAway,
    /// A vertex created by clipping, as a dot. The value is its position along an edge of the triangle, in [0, 1];
    /// `None` if it does not lie on an edge.
    NewVertex(Option<f32>),
    /// Outline of a triangle that was culled as back-facing or front-facing.
    Culled,
    /// The tracked vertex, as a dot.
    Vertex,
}

/// A mark in the mesh view: a dot (one point), a line (two points) or a closed polygon (more points).
#[derive(Clone, Debug, PartialEq)]
pub struct MeshMark {
    /// Kind of the mark, which determines how it is drawn.
    pub kind: MarkKind,
    /// Points of the mark, in px of the mesh view.
    pub points: Vec<ScreenPoint>,
}

/// Parts of the scene that the overlay of the mesh view marks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OverlayInputs {
    /// Picked pixel of the render camera's picture.
    pub pixel: Option<(u32, u32)>,
    /// Distance along the view axis to the surface at the picked pixel, in world units; `None` for the background.
    pub hit_distance: Option<f64>,
    /// Selected triangle, marked as a polygon.
    pub selected: Option<TriangleId>,
    /// Position of the tracked vertex, in world space.
    pub vertex: Option<DVec3>,
    /// Whether culled triangles are outlined.
    pub culled: bool,
    /// Factor by which triangles are moved apart; see [`super::exploded`].
    pub explode: f32,
}

/// Returns all marks of the mesh view's overlay, in drawing order.
pub fn drawn(scene: &Scene, inner: &Inner, look: &OverlayInputs, outside: &Camera, size: Viewport) -> Vec<MeshMark> {
    let mut canvas = MarkProjector::new(outside, size);
    let eye = CameraFrustum::new(inner, scene);
    // Clipped and culled triangles are marked at their original positions only.
    if look.explode == 0.0 {
        cut_and_culled(scene, inner, look, &mut canvas);
    }
    if let Some(corners) = look.selected.and_then(|id| corners(scene, id, look.explode)) {
        canvas.polygon(MarkKind::Selected, &corners.map(Vec3::as_dvec3));
    }
    eye.frustum(&mut canvas);
    eye.ray(look, &mut canvas);
    if let Some(vertex) = look.vertex.filter(|_| look.explode == 0.0) {
        canvas.dot(MarkKind::Vertex, vertex);
    }
    canvas.marks
}

/// Projection of the second camera, and the marks projected so far.
struct MarkProjector {
    clip_from_world: DMat4,
    size: Viewport,
    least_w: f64,
    marks: Vec<MeshMark>,
}

impl MarkProjector {
    fn new(outside: &Camera, size: Viewport) -> Self {
        let clip_from_view = outside.clip_from_view(size.aspect(), DepthMapping::REVERSED).as_dmat4();
        Self {
            clip_from_world: clip_from_view * outside.view_from_world_f64(),
            size,
            least_w: f64::from(outside.near) * MIN_W,
            marks: Vec::new(),
        }
    }

    fn pixel(&self, clip: DVec4) -> ScreenPoint {
        let Viewport { width, height } = self.size;
        let x = (clip.x / clip.w * 0.5 + 0.5) * f64::from(width);
        let y = (0.5 - clip.y / clip.w * 0.5) * f64::from(height);
        [x as f32, y as f32]
    }

    /// Returns the part of a polygon in front of the second camera, in px.
    fn projected(&self, points: &[DVec3]) -> Vec<ScreenPoint> {
        let clip: Vec<DVec4> = points.iter().map(|point| self.clip_from_world * point.extend(1.0)).collect();
        let mut seen = Vec::with_capacity(points.len() + 1);
        for (index, a) in clip.iter().enumerate() {
            let b = clip[(index + 1) % clip.len()];
            let (da, db) = (a.w - self.least_w, b.w - self.least_w);
            if da >= 0.0 {
                seen.push(self.pixel(*a));
            }
            if (da >= 0.0) != (db >= 0.0) {
                seen.push(self.pixel(*a + (b - *a) * (da / (da - db))));
            }
        }
        seen.retain(|point| point.iter().all(|c| c.is_finite()));
        seen
    }

    fn polygon(&mut self, kind: MarkKind, points: &[DVec3]) {
        let points = self.projected(points);
        if points.len() >= 3 {
            self.marks.push(MeshMark { kind, points });
        }
    }

    fn line(&mut self, kind: MarkKind, from: DVec3, to: DVec3) {
        let mut points = self.projected(&[from, to]);
        // The line was clipped as a polygon with one edge in each direction, so a clipped end appears twice.
        points.truncate(2);
        if points.len() == 2 {
            self.marks.push(MeshMark { kind, points });
        }
    }

    fn dot(&mut self, kind: MarkKind, at: DVec3) {
        let clip = self.clip_from_world * at.extend(1.0);
        if clip.w >= self.least_w {
            self.marks.push(MeshMark { kind, points: vec![self.pixel(clip)] });
        }
    }
}

/// The render camera's frustum and ray in world space.
struct CameraFrustum<'a> {
    inner: &'a Inner,
    /// Distance at which the drawn frustum ends, in world units: the far plane, or the farthest point of the scene if
    /// nearer.
    far: f64,
}

impl<'a> CameraFrustum<'a> {
    fn new(inner: &'a Inner, scene: &Scene) -> Self {
        let camera = &inner.camera;
        let forward = camera.forward().as_dvec3();
        let depth = |corner: Vec3| forward.dot(corner.as_dvec3() - camera.eye.as_dvec3());
        let end = scene.bounds().corners().map(depth).into_iter().fold(f64::from(camera.near) * 4.0, f64::max);
        Self { inner, far: end.min(f64::from(camera.far)) }
    }

    /// Returns a point in world space, given its position in the render camera's picture and its distance from the eye.
    /// The position is in [−1, 1] with y up. The distance is in world units, along the view axis.
    fn at(&self, [x, y]: [f64; 2], distance: f64) -> DVec3 {
        let camera = &self.inner.camera;
        let (right, forward) = (camera.right().as_dvec3(), camera.forward().as_dvec3());
        let up = right.cross(forward);
        let aspect = camera.sub_view.map_or_else(|| self.inner.viewport.aspect(), |window| window.aspect);
        let half_height = match camera.projection {
            Projection::Perspective { fov_y } => (f64::from(fov_y) * 0.5).tan() * distance,
            Projection::Orthographic { height } => f64::from(height) * 0.5,
        };
        let aside = right * (x * half_height * f64::from(aspect)) + up * (y * half_height);
        camera.eye.as_dvec3() + forward * distance + aside
    }

    fn frustum(&self, canvas: &mut MarkProjector) {
        const CORNERS: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let near = CORNERS.map(|corner| self.at(corner, self.inner.camera.near.into()));
        let far = CORNERS.map(|corner| self.at(corner, self.far));
        canvas.polygon(MarkKind::NearPlane, &near);
        for side in 0..4 {
            canvas.line(MarkKind::Frustum, near[side], far[side]);
            canvas.line(MarkKind::Frustum, near[side], near[(side + 1) % 4]);
            canvas.line(MarkKind::Frustum, far[side], far[(side + 1) % 4]);
            if matches!(self.inner.camera.projection, Projection::Perspective { .. }) {
                canvas.line(MarkKind::Frustum, self.inner.camera.eye.as_dvec3(), near[side]);
            }
        }
        canvas.dot(MarkKind::Eye, self.inner.camera.eye.as_dvec3());
    }

    fn ray(&self, look: &OverlayInputs, canvas: &mut MarkProjector) {
        let Some((x, y)) = look.pixel else { return };
        let Viewport { width, height } = self.inner.viewport;
        let across = |pixel: u32, size: u32| (f64::from(pixel) + 0.5) / f64::from(size) * 2.0 - 1.0;
        let place = [across(x, width), -across(y, height)];
        let end = self.at(place, self.far);
        let hit = look.hit_distance.filter(|distance| distance.is_finite()).map(|distance| self.at(place, distance));
        canvas.line(MarkKind::Ray, self.at(place, 0.0), hit.unwrap_or(end));
        if let Some(hit) = hit {
            canvas.line(MarkKind::RayBehind, hit, end);
            canvas.dot(MarkKind::Hit, hit);
        }
    }
}

/// Marks the triangles that were clipped, and outlines the triangles that were culled.
fn cut_and_culled(scene: &Scene, inner: &Inner, look: &OverlayInputs, canvas: &mut MarkProjector) {
    let rejections = inner.rejections(scene, inner.settings.culling);
    let that_met = |wanted: fn(GeometryOutcome) -> bool| {
        let found: Vec<_> =
            rejections.outcomes().zip(0..).filter(|(met, _)| wanted(*met)).map(|(_, id)| TriangleId(id)).collect();
        let few = found.len() <= MAX_MARKED;
        found.into_iter().filter(move |id| few || look.selected == Some(*id))
    };
    if look.culled {
        let is_culled = |met| matches!(met, GeometryOutcome::Rejected(Fate::BackFacing | Fate::FrontFacing));
        for corners in that_met(is_culled).filter_map(|id| corners(scene, id, 0.0)) {
            canvas.polygon(MarkKind::Culled, &corners.map(Vec3::as_dvec3));
        }
    }
    let is_cut = |met| matches!(met, GeometryOutcome::Cut | GeometryOutcome::Rejected(Fate::ClippedAway));
    for id in that_met(is_cut) {
        cut(scene, inner, id, canvas);
    }
}

/// Marks one clipped triangle: the remaining part, the removed part, and the new vertices.
fn cut(scene: &Scene, inner: &Inner, id: TriangleId, canvas: &mut MarkProjector) {
    let Some((polygon, corners)) = clipped(scene, inner, id) else { return };
    let world = |vertex: &ClipVertex| {
        let [a, b, c] = vertex.varyings.source_weights.to_array().map(f64::from);
        corners[0] * a + corners[1] * b + corners[2] * c
    };
    let kept: Vec<DVec3> = polygon.iter().map(world).collect();
    let (outer, inner_part) = (canvas.projected(&corners), canvas.projected(&kept));
    let lines = hatch(&outer, &inner_part, HATCH_PX);
    canvas.marks.extend(lines.into_iter().map(|line| MeshMark { kind: MarkKind::CutAway, points: line.to_vec() }));
    canvas.polygon(MarkKind::RemainingPart, &kept);
    for (vertex, place) in polygon.iter().zip(kept) {
        let weights = vertex.varyings.source_weights;
        if weights.max_element() < 1.0 {
            canvas.dot(MarkKind::NewVertex(along_edge(weights)), place);
        }
    }
}

/// Clips a triangle with the pipeline's own clipper. Returns the remaining polygon in clip space, and the corners of
/// the whole triangle in world space.
fn clipped(scene: &Scene, inner: &Inner, id: TriangleId) -> Option<(Vec<ClipVertex>, [DVec3; 3])> {
    let (instance, indices) = crate::inspect::vertices::corners_of(scene, id)?;
    let instance = scene.instances.get(instance)?;
    let mesh = scene.library.mesh(instance.mesh);
    let Inner { camera, settings, viewport } = inner;
    let matrices =
        DrawMatrices::new(instance, camera.clip_from_world_f64(viewport.aspect(), settings.depth_format.mapping()));
    let mut corner = 0;
    let triangle = indices.map(|index| {
        let mut vertex = ClipVertex::at(matrices.clip_position(mesh.positions[index as usize]));
        vertex.varyings.source_weights = Vec3::AXES[corner];
        corner += 1;
        vertex
    });
    let mut polygon = Polygon::default();
    let cut = polygon.clip(&triangle, guard_band_widening(viewport.width, viewport.height));
    let left = if cut == Ok(Cut::Pieces) { polygon.vertices().to_vec() } else { Vec::new() };
    let corners = corners(scene, id, 0.0)?.map(Vec3::as_dvec3);
    Some((left, corners))
}

/// Returns the position along an edge of a vertex that clipping created: 0 at the end with the lower corner index, 1 at
/// the other end. Returns `None` if the vertex lies inside the triangle.
fn along_edge(weights: Vec3) -> Option<f32> {
    match weights.to_array() {
        [0.0, _, t] | [_, 0.0, t] | [_, t, 0.0] => Some(t),
        _ => None,
    }
}
