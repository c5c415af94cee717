//! Triangles that cross the view frustum, as other renderers cut them into triangles.
//!
//! Attributes that are interpolated linearly on the screen depend on the triangles into which a clipped polygon is
//! divided. Meshes that are cut beforehand, so that our pipeline has nothing to clip, have the triangles of the other
//! renderer.

use glam::{DVec4, Vec2, Vec3};
use rasterscope_engine::pipeline::settings::Interpolation;
use rasterscope_engine::scene::{DepthMapping, Instance, Mesh, MeshData};

use crate::geometry::ignore_near_plane;
use crate::setup::{Setup, edit};

/// Share of the distance of the near plane by which cuts lie behind it, so that our pipeline clips nothing.
const BEHIND_NEAR: f64 = 1e-6;

/// Distance beyond the far plane to which unclipped triangles reach, relative to the distance of the far plane.
const BEYOND_FAR: f64 = 1.001;

/// Half the width of the largest triangles on the screen, in half widths of the picture: our pipeline cuts larger ones.
const MOST_HALF_WIDTHS: f64 = 8.0;

/// Polygon into which another renderer clips a triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Clipping {
    /// Whether triangles are clipped at all planes of the frustum, not only at the near plane.
    pub(crate) is_at_all_planes: bool,
    /// Index of the vertex of the clipped polygon that all its triangles share.
    pub(crate) first: usize,
}

/// Corner of a triangle or polygon.
#[derive(Clone, Copy, Debug)]
struct Corner {
    clip: DVec4,
    position: Vec3,
    normal: Vec3,
    uv: Vec2,
    color: Vec3,
}

impl Corner {
    /// Returns the point at `position` on the line to `other`, with the attributes at `attributes`; both are 0 here and
    /// 1 there.
    fn on_line(&self, other: &Self, position: f64, attributes: f64) -> Self {
        let share = attributes as f32;
        Self {
            clip: self.clip + (other.clip - self.clip) * position,
            position: (self.position.as_dvec3() + (other.position - self.position).as_dvec3() * position).as_vec3(),
            normal: self.normal + (other.normal - self.normal) * share,
            uv: self.uv + (other.uv - self.uv) * share,
            color: self.color + (other.color - self.color) * share,
        }
    }
}

/// Signed distance from a plane through the eye or parallel to the picture: a linear function of clip space.
type Plane = fn(DVec4) -> f64;

/// Planes of the frustum except the near plane.
const SIDES_AND_FAR: [Plane; 5] = [|p| p.w - p.z, |p| p.w + p.x, |p| p.w - p.x, |p| p.w + p.y, |p| p.w - p.y];

/// Planes beside the picture that keep triangles so small that our pipeline does not cut them.
const AROUND: [Plane; 4] = [
    |p| MOST_HALF_WIDTHS * p.w + p.x,
    |p| MOST_HALF_WIDTHS * p.w - p.x,
    |p| MOST_HALF_WIDTHS * p.w + p.y,
    |p| MOST_HALF_WIDTHS * p.w - p.y,
];

/// Interpolates attributes linearly on the screen, within the triangles of another renderer's clipped polygons.
pub(crate) fn interpolate_affinely(setup: &mut Setup, clipping: Clipping) {
    setup.recipe.pipeline.interpolation = Interpolation::Affine;
    let near = f64::from(setup.camera.near) * BEHIND_NEAR;
    change_triangles(setup, |corners| {
        let is_before = |p: DVec4| p.z - near;
        let planes = SIDES_AND_FAR.iter().filter(|_| clipping.is_at_all_planes);
        let polygon =
            planes.fold(cut(corners, is_before, perspective), |polygon, plane| cut(&polygon, plane, perspective));
        let mut triangles = Vec::new();
        for triangle in fan(&polygon, clipping.first) {
            // Attributes that are cut linearly on the screen stay the same linear function.
            let part = AROUND.iter().fold(triangle.to_vec(), |part, plane| cut(&part, plane, affine));
            triangles.extend(fan(&part, 0));
        }
        triangles
    });
}

/// Draws triangles with corners behind the eye as without clipping: such a corner is projected through the eye, and the
/// triangle between the three projections shows the plane of the triangle, as far as it lies before the eye.
pub(crate) fn skip_near_clipping(setup: &mut Setup) {
    let far = f64::from(setup.camera.far) * BEYOND_FAR;
    change_triangles(setup, |corners| {
        let is_before = |corner: &Corner| corner.clip.w > 0.0;
        let first = match corners.iter().filter(|corner| is_before(corner)).count() {
            1 => corners.iter().position(is_before),
            2 => corners.iter().position(|corner| !is_before(corner)),
            _ => None,
        };
        let Some(first) = first else { return corners.windows(3).map(|all| [all[0], all[1], all[2]]).collect() };
        let [a, b, c] = [0, 1, 2].map(|next| &corners[(first + next) % 3]);
        // The line from a corner behind the eye through one before it leads on to the far plane.
        let onward = |behind: &Corner, before: &Corner| {
            let share = (far - before.clip.w) / (before.clip.w - behind.clip.w);
            before.on_line(behind, -share.max(0.0), -share.max(0.0))
        };
        let polygon =
            if is_before(a) { vec![*a, onward(b, a), onward(c, a)] } else { vec![*b, *c, onward(a, c), onward(a, b)] };
        fan(&polygon, 0).collect()
    });
}

/// Draws triangles without clipping, and also what is nearer than the near plane.
pub(crate) fn skip_near_clipping_and_test(setup: &mut Setup) {
    skip_near_clipping(setup);
    ignore_near_plane(setup);
}

/// Returns the part of a polygon on the inner side of a plane (Sutherland and Hodgman 1974). `attributes` returns where
/// the attributes of a cut edge are taken, from where it is cut.
fn cut(
    polygon: &[Corner],
    plane: impl Fn(DVec4) -> f64,
    attributes: impl Fn(&Corner, &Corner, f64) -> f64,
) -> Vec<Corner> {
    let mut inside = Vec::with_capacity(polygon.len() + 1);
    for (index, from) in polygon.iter().enumerate() {
        let to = &polygon[(index + 1) % polygon.len()];
        let (here, there) = (plane(from.clip), plane(to.clip));
        if here >= 0.0 {
            inside.push(*from);
        }
        if (here >= 0.0) != (there >= 0.0) {
            let share = here / (here - there);
            inside.push(from.on_line(to, share, attributes(from, to, share)));
        }
    }
    inside
}

/// Attributes that are linear in space.
fn perspective(_: &Corner, _: &Corner, share: f64) -> f64 {
    share
}

/// Attributes that are linear on the screen.
fn affine(from: &Corner, to: &Corner, share: f64) -> f64 {
    let (from, to) = ((1.0 - share) * from.clip.w, share * to.clip.w);
    to / (from + to)
}

/// Returns the triangles of a convex polygon, all of which have the vertex `first`.
fn fan(polygon: &[Corner], first: usize) -> impl Iterator<Item = [Corner; 3]> {
    let mut corners = polygon.to_vec();
    if !corners.is_empty() {
        let first = first % corners.len();
        corners.rotate_left(first);
    }
    (2..corners.len()).map(move |last| [corners[0], corners[last - 1], corners[last]])
}

/// Replaces each triangle that is not wholly inside the frustum by the triangles that `change` returns.
fn change_triangles(setup: &mut Setup, change: impl Fn(&[Corner]) -> Vec<[Corner; 3]>) {
    let aspect = setup.camera.sub_view.map_or(setup.viewport.aspect(), |view| view.aspect);
    let clip_from_world = setup.camera.clip_from_world_f64(aspect, DepthMapping::STANDARD);
    let scene = edit(&mut setup.scene);
    for instance in &mut scene.instances {
        let clip_from_model = clip_from_world * instance.world_from_model.as_dmat4();
        let mesh = scene.library.mesh(instance.mesh);
        let clip: Vec<_> =
            mesh.positions.iter().map(|position| clip_from_model * position.as_dvec3().extend(1.0)).collect();
        let is_inside = |p: DVec4| p.z >= 0.0 && SIDES_AND_FAR.iter().all(|plane| plane(p) >= 0.0);
        let crosses = |corners: &[u32; 3]| corners.iter().any(|corner| !is_inside(clip[*corner as usize]));
        if !mesh.triangles.iter().any(crosses) {
            continue;
        }
        let mut changed = MeshData { triangles: Vec::with_capacity(mesh.triangles.len()), ..(**mesh).clone() };
        for corners in &mesh.triangles {
            if !crosses(corners) {
                changed.triangles.push(*corners);
                continue;
            }
            let corner = |vertex: &u32| corner(mesh, &clip, *vertex as usize);
            for triangle in change(&corners.iter().map(corner).collect::<Vec<_>>()) {
                push(&mut changed, &triangle);
            }
        }
        if let Ok(mesh) = Mesh::new(changed) {
            let mesh = scene.library.add_mesh(mesh);
            *instance = Instance { mesh, ..instance.clone() };
        }
    }
}

/// Returns a vertex of a mesh; attributes that the mesh lacks are 0.
fn corner(mesh: &MeshData, clip: &[DVec4], vertex: usize) -> Corner {
    Corner {
        clip: clip[vertex],
        position: mesh.positions[vertex],
        normal: mesh.normals[vertex],
        uv: mesh.uvs.get(vertex).copied().unwrap_or_default(),
        color: mesh.colors.get(vertex).copied().unwrap_or_default(),
    }
}

/// Adds a triangle with three vertices of its own.
fn push(mesh: &mut MeshData, triangle: &[Corner; 3]) {
    let first = mesh.positions.len() as u32;
    let (has_uvs, has_colors) = (!mesh.uvs.is_empty(), !mesh.colors.is_empty());
    for corner in triangle {
        mesh.positions.push(corner.position);
        mesh.normals.push(corner.normal);
        mesh.uvs.extend(has_uvs.then_some(corner.uv));
        mesh.colors.extend(has_colors.then_some(corner.color));
    }
    mesh.triangles.push([first, first + 1, first + 2]);
}
