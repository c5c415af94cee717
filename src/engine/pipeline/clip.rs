//! Clipping in homogeneous space, before the division by w. Without it, a triangle that reaches behind the eye would be
//! mirrored, which no per-pixel test could correct.
//!
//! Uses the polygon clipping of Sutherland and Hodgman (CACM 17(1), 1974), plane by plane, and only against planes that
//! a triangle crosses. The left, right, top and bottom planes are moved outwards to a guard band. Parts of a triangle
//! that are off screen but inside the guard band are left to the rasterizer, which clamps to the picture. Clipping at
//! the guard band keeps coordinates small enough for exact edge functions.
//!
//! A cut is always computed from the inside vertex towards the outside one, so two triangles that share an edge get
//! bit-identical new vertices and stay watertight. Distances and cuts are computed in f64, and the new vertex is placed
//! exactly on the plane, because an edge may be 10³⁸ times longer than its part inside.

use glam::Vec3;

use super::clip_space::{ClipPlane, ClipVertex};
use super::observe::{Fate, Observer};
use crate::scene::TriangleId;

/// Half the width of the guard band in pixels: screen coordinates stay within ±2¹⁵ px of the picture's centre. f32
/// still resolves 1/256 px there, and edge functions of such coordinates need 49 bits of an i64.
pub(crate) const GUARD_BAND_PX: f32 = 32_768.0;

/// Triangle inside the guard band: a whole triangle of the scene, or a piece of one that was cut.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ClippedTriangle {
    /// Identifier of the original triangle in the scene.
    pub(crate) id: TriangleId,
    /// Corners in clip space.
    pub(crate) vertices: [ClipVertex; 3],
}

/// Returns the factor by which the guard band moves the four side planes outwards, for a picture of `width` × `height`
/// px.
pub(crate) fn guard_band_widening(width: u32, height: u32) -> f32 {
    (2.0 * GUARD_BAND_PX / width.max(height) as f32).max(1.0)
}

/// Clips all triangles of a draw, in order. `first` is the identifier of the first triangle.
pub(crate) fn clip<O: Observer>(
    vertices: &[ClipVertex],
    triangles: &[[u32; 3]],
    first: TriangleId,
    widening: f32,
    observer: &mut O,
) -> Vec<ClippedTriangle> {
    let mut out = Vec::with_capacity(triangles.len());
    let mut polygon = Polygon::default();
    for (index, corners) in triangles.iter().enumerate() {
        let id = TriangleId(first.0 + index as u32);
        let mut triangle = corners.map(|c| vertices[c as usize]);
        for (corner, vertex) in triangle.iter_mut().enumerate() {
            vertex.varyings.source_weights = Vec3::AXES[corner];
        }
        match polygon.clip(&triangle, widening) {
            Err(fate) => observer.rejected(id, fate),
            Ok(Cut::Whole) => out.push(ClippedTriangle { id, vertices: triangle }),
            Ok(Cut::Pieces) => {
                observer.clipped(id, polygon.vertices.len() - 2);
                out.extend(polygon.fan().map(|vertices| ClippedTriangle { id, vertices }));
            }
        }
    }
    out
}

/// Result of clipping a triangle that was not rejected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Cut {
    /// The triangle crosses no plane and is unchanged.
    Whole,
    /// The triangle was cut; the polygon holds the part that remains.
    Pieces,
}

/// Intersection of an edge with a clipping plane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EdgeCut {
    /// Plane that cuts the edge.
    pub(crate) plane: ClipPlane,
    /// Endpoint of the edge on the inner side of the plane.
    pub(crate) inside: ClipVertex,
    /// Endpoint of the edge on the outer side of the plane.
    pub(crate) outside: ClipVertex,
    /// Signed distances of the endpoints from the plane: ≥ 0 for `inside`, < 0 for `outside`.
    pub(crate) distances: [f64; 2],
    /// Parameter of the intersection along the edge, from 0 at `inside` to 1 at `outside`.
    pub(crate) t: f64,
    /// Vertex that the cut creates on the plane.
    pub(crate) vertex: ClipVertex,
}

/// Polygon being clipped, with buffers reused from triangle to triangle.
#[derive(Clone, Debug, Default)]
pub(crate) struct Polygon {
    vertices: Vec<ClipVertex>,
    next: Vec<ClipVertex>,
}

impl Polygon {
    /// Clips one triangle to the view frustum, whose side planes are moved outwards by the factor `widening`. Returns
    /// the triangle's [`Fate`] as an error if the triangle is rejected.
    pub(crate) fn clip(&mut self, triangle: &[ClipVertex; 3], widening: f32) -> Result<Cut, Fate> {
        self.clip_watched(triangle, widening, &mut |_| {})
    }

    /// Clips one triangle as [`Polygon::clip`] does, and calls `watch` for each cut edge.
    #[inline]
    pub(crate) fn clip_watched(
        &mut self,
        triangle: &[ClipVertex; 3],
        widening: f32,
        watch: &mut impl FnMut(&EdgeCut),
    ) -> Result<Cut, Fate> {
        if !triangle.iter().all(|v| v.position.is_finite()) {
            return Err(Fate::NotFinite);
        }
        let all_beyond = |plane: &ClipPlane| triangle.iter().all(|v| plane.distance(v.position, 1.0) < 0.0);
        if ClipPlane::ALL.iter().any(all_beyond) {
            return Err(Fate::Outside);
        }
        let crosses = |plane: &ClipPlane| triangle.iter().any(|v| plane.distance(v.position, widening) < 0.0);
        if !ClipPlane::ALL.iter().any(crosses) {
            return Ok(Cut::Whole);
        }
        self.vertices.clear();
        self.vertices.extend_from_slice(triangle);
        for plane in ClipPlane::ALL.into_iter().filter(crosses) {
            self.cut(plane, widening, watch);
        }
        if self.vertices.len() >= 3 { Ok(Cut::Pieces) } else { Err(Fate::ClippedAway) }
    }

    /// Returns the polygon's vertices, in the winding order of the triangle.
    pub(crate) fn vertices(&self) -> &[ClipVertex] {
        &self.vertices
    }

    /// Returns the triangles of the convex polygon, as a fan around its first vertex.
    pub(crate) fn fan(&self) -> impl Iterator<Item = [ClipVertex; 3]> {
        let first = self.vertices[0];
        self.vertices[1..].windows(2).map(move |pair| [first, pair[0], pair[1]])
    }

    fn cut(&mut self, plane: ClipPlane, widening: f32, watch: &mut impl FnMut(&EdgeCut)) {
        self.next.clear();
        for (i, a) in self.vertices.iter().enumerate() {
            let b = &self.vertices[(i + 1) % self.vertices.len()];
            let (da, db) = (plane.distance(a.position, widening), plane.distance(b.position, widening));
            if da >= 0.0 {
                self.next.push(*a);
            }
            let (inside, outside, distances) = match (da >= 0.0, db >= 0.0) {
                (true, false) => (a, b, (da, db)),
                (false, true) => (b, a, (db, da)),
                _ => continue,
            };
            let t = share_beyond(distances);
            let crossing = between(inside, outside, distances);
            let position = plane.pin(crossing.position, widening);
            let cut_at = if plane.is_of_depth() { Some(plane) } else { crossing.cut_at };
            let vertex = ClipVertex { position, cut_at, ..crossing };
            watch(&EdgeCut { plane, inside: *inside, outside: *outside, distances: distances.into(), t, vertex });
            self.next.push(vertex);
        }
        std::mem::swap(&mut self.vertices, &mut self.next);
    }
}

/// Returns the position along an edge at which the edge intersects a plane: from 0 at the inside endpoint to 1 at the
/// outside endpoint. The arguments are the signed distances of the endpoints from the plane: `da` ≥ 0 for the inside
/// endpoint, `db` < 0 for the outside endpoint.
fn share_beyond((da, db): (f64, f64)) -> f64 {
    da / (da - db)
}

/// Returns the vertex at which an edge intersects a plane. The edge runs from `a`, at signed distance `da` ≥ 0 from the
/// plane, to `b`, at `db` < 0. The vertex is a weighted mean of the endpoints, so it never leaves their range. Neither
/// weight is computed as 1 minus the other, so even a tiny weight is accurate. This matters if one endpoint lies at the
/// eye and the other is up to 10³⁸ units away: the weight of the far endpoint is tiny, but this endpoint alone
/// determines the direction in which the vertex is seen.
fn between(a: &ClipVertex, b: &ClipVertex, (da, db): (f64, f64)) -> ClipVertex {
    let t = share_beyond((da, db));
    let position = a.position.as_dvec4() * (db / (db - da)) + b.position.as_dvec4() * t;
    ClipVertex {
        position: position.as_vec4(),
        // The new vertex lies on the near or far plane only if both endpoints do.
        cut_at: a.cut_at.filter(|plane| b.cut_at == Some(*plane)),
        varyings: a.varyings.lerp(&b.varyings, t as f32),
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec4;

    use super::*;

    fn vertex(x: f32, y: f32, z: f32, w: f32) -> ClipVertex {
        ClipVertex::at(Vec4::new(x, y, z, w))
    }

    fn clip_one(triangle: [ClipVertex; 3]) -> (Result<Cut, Fate>, Vec<ClipVertex>) {
        let mut polygon = Polygon::default();
        let cut = polygon.clip(&triangle, 2.0);
        (cut, polygon.vertices)
    }

    #[test]
    fn inside_stays_whole_and_outside_goes() {
        let inside = [vertex(0.0, 0.0, 0.5, 1.0), vertex(0.5, 0.0, 0.5, 1.0), vertex(0.0, 0.5, 0.5, 1.0)];
        assert_eq!(clip_one(inside).0, Ok(Cut::Whole));
        let beyond = inside.map(|v| vertex(v.position.x, v.position.y, -0.1, 1.0));
        assert_eq!(clip_one(beyond).0, Err(Fate::Outside));
    }

    #[test]
    fn one_vertex_behind_the_near_plane_leaves_a_quad_in_front() {
        let (cut, left) =
            clip_one([vertex(0.0, 0.0, 0.5, 1.0), vertex(0.5, 0.0, 0.5, 1.0), vertex(0.0, 0.5, -0.5, -0.1)]);
        assert_eq!(cut, Ok(Cut::Pieces));
        assert_eq!(left.len(), 4);
        assert!(left.iter().all(|v| v.position.z >= -1e-7 && v.position.w > 0.0));
    }

    #[test]
    fn a_shared_edge_is_cut_at_the_same_bits_from_both_sides() {
        let (a, b) = (vertex(0.1, 0.2, 0.7, 1.1), vertex(-0.3, 0.9, -0.37, 0.6));
        let (c, d) = (vertex(0.4, 0.4, 0.3, 1.0), vertex(-0.5, 0.1, 0.2, 1.3));
        let on_plane = |vertices: Vec<ClipVertex>| -> Vec<[u32; 4]> {
            vertices
                .iter()
                .filter(|v| v.position.z.abs() < 1e-6)
                .map(|v| v.position.to_array().map(f32::to_bits))
                .collect()
        };
        let (one, two) = (on_plane(clip_one([a, b, c]).1), on_plane(clip_one([b, a, d]).1));
        assert!(one.iter().any(|p| two.contains(p)), "{one:?} {two:?}");
    }

    #[test]
    fn nan_and_infinity_have_a_fate() {
        for bad in [f32::NAN, f32::INFINITY] {
            let triangle = [vertex(bad, 0.0, 0.5, 1.0), vertex(0.5, 0.0, 0.5, 1.0), vertex(0.0, 0.5, 0.5, 1.0)];
            assert_eq!(clip_one(triangle).0, Err(Fate::NotFinite));
        }
    }

    #[test]
    fn the_largest_coordinates_come_out_within_the_guard_band() {
        let (cut, left) =
            clip_one([vertex(0.0, 0.0, 0.5, 1.0), vertex(3e38, 0.0, 0.5, 1.0), vertex(0.0, 3e38, 0.5, 1.0)]);
        assert_eq!(cut, Ok(Cut::Pieces));
        let widest = left.iter().map(|v| (v.position.x / v.position.w).abs().max((v.position.y / v.position.w).abs()));
        assert!(widest.fold(0.0, f32::max) <= 2.0001);
    }

    #[test]
    fn an_edge_of_the_largest_length_is_cut_exactly_at_the_guard_band() {
        let (cut, left) =
            clip_one([vertex(-3e38, 0.0, 0.5, 1.0), vertex(3e38, 0.0, 0.5, 1.0), vertex(0.0, 0.5, 0.5, 1.0)]);
        assert_eq!(cut, Ok(Cut::Pieces));
        let xs = || left.iter().map(|v| v.position.x);
        assert_eq!((xs().fold(0.0, f32::min), xs().fold(0.0, f32::max)), (-2.0, 2.0));
    }

    #[test]
    fn the_largest_w_does_not_overflow() {
        let (cut, left) =
            clip_one([vertex(0.0, 0.0, 0.5, 3e38), vertex(-3e38, 0.0, 0.5, 1.0), vertex(0.0, 0.5, 0.5, 1.0)]);
        assert_eq!(cut, Ok(Cut::Pieces));
        assert!(left.iter().all(|v| v.position.is_finite()), "{left:?}");
    }

    #[test]
    fn a_corner_at_the_eye_is_seen_in_the_direction_of_the_others() {
        // The plane of such a triangle contains the eye, so what is left of the triangle projects onto a line.
        let (cut, left) =
            clip_one([vertex(0.0, 0.0, 0.0, 0.0), vertex(1.0, 0.0, 0.5, 1.0), vertex(0.0, 1.0, 0.5, 1.0)]);
        assert_eq!(cut, Ok(Cut::Pieces));
        let on_line = |v: &ClipVertex| ((v.position.x + v.position.y) / v.position.w - 1.0).abs() < 1e-6;
        assert!(left.iter().all(on_line), "{left:?}");
    }

    #[test]
    fn a_corner_whose_w_rounding_made_negative_is_cut_off_and_the_rest_stays() {
        // The z of the first vertex places it on the near plane, but its w places it behind the eye. Only rounding
        // errors create such a vertex.
        let (cut, left) =
            clip_one([vertex(0.0, 0.0, 0.0, -1e-6), vertex(0.5, 0.0, 0.5, 1.0), vertex(0.0, 0.5, 0.5, 1.0)]);
        assert_eq!(cut, Ok(Cut::Pieces));
        assert!(left.iter().all(|v| (1.0 / v.position.w).is_finite()), "{left:?}");
    }
}
