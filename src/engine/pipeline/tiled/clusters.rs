//! Cluster culling: finds the clusters of a mesh that cannot be visible, and the ranges of the mesh that remain. A
//! cluster is culled if it is outside the view or back-facing. With front-face culling, “back-facing” refers to the
//! culled side.
//!
//! A cluster is culled only if the classic (scalar) path also drops every triangle of it, *with the rounded numbers
//! that the pipeline computes*. Vertices that overflow need no special treatment, because their triangles are dropped
//! anyway.
//!
//! **Outside**: all vertices are beyond the same plane. Computed coordinates differ from the exact ones by rounding.
//! Let u = 2⁻²⁴ be the unit roundoff of f32. A clip-space component of a vertex v is a sum of four terms. Each term is
//! rounded once as a product and at most three times in sums. The component is off by at most 4u (1 + O(u)) · M, where
//! M = Σ |mᵢ| |vᵢ| is that sum with every term positive. If products underflow, it is off by 3 · 2⁻¹⁵⁰ more. The
//! distance from a plane is a single component or the difference of two. The difference is computed in doubles, so it
//! has the sign of the exact difference of these components. Therefore, if the exact distance is less than −8u · max M
//! − 2⁻¹⁴⁷ for every point of a box, every vertex in the box is outside according to the pipeline's computation.
//! [`ROUNDING`] and [`UNDERFLOW`] exceed these terms by at least a factor of four. This covers the rounding of the
//! culling test itself, which is computed in doubles. Over a box, an affine function has its maximum at the corner that
//! the signs of its coefficients select. M has its maximum where the magnitude of each coordinate is largest.
//!
//! **Back-facing**: the doubled area of the snapped vertices has the sign of the culled side, or is zero. In a picture
//! of W × H px, the exact doubled area on the screen, before snapping, is S = −(W·H/4) · D / (w₀ w₁ w₂). D is the
//! determinant of the clip-space x, y and w of the three vertices. By the Cauchy–Binet formula, D = 2A · (n·e + d·f)
//! for a triangle of area A in the plane n·p = d. (e, f) are the minors of the three rows of the matrix: the
//! homogeneous position of the eye, if there is one. Bounds of n and d give a lower bound of |n·e + d·f| over a
//! cluster. Snapped vertices differ from the exact ones by at most δ on each axis: half a step of 1/256 px plus
//! rounding. This changes S by at most √2 δ times the perimeter plus 8δ². An edge of length ℓ is at most κℓ/w px long
//! on the screen. With the longest edge ℓ and the altitude h = 2A/ℓ, the sign is certain if
//!
//! ```text
//! (W·H/4) · h · |n·e + d·f| / w_max³  >  3 √2 δ κ / w_min + 8δ² / h
//! ```
//!
//! The condition can only hold for triangles whose altitude on the screen is at least about a hundredth of a pixel. The
//! triangles must not be clipped, because the pieces are snapped again: the box must lie between the depth planes and
//! within the guard band.

use std::ops::Range;

use glam::{Mat4, Vec4, Vec4Swizzles};

use super::super::clip::{ClipPlane, GUARD_BAND_PX};
use super::super::plan::{Containment, CullStats};
use super::super::settings::Culling;
use super::super::vertex::{ROUNDING, UNDERFLOW};
use super::super::viewport::{MAX_SIDE_PX, Viewport};
use crate::math::fixed::SUBPIXELS;
use crate::math::lanes::*;
use crate::scene::Mesh;
use crate::scene::clusters::{BLOCK, Boxes, ClusterPlanes, Clusters};

/// Disjoint index ranges in ascending order; in most cases there is only one.
#[derive(Clone, Debug)]
pub(super) enum Ranges {
    One(Range<usize>),
    Some(Vec<Range<usize>>),
}

impl Ranges {
    /// Returns the ranges as a slice.
    pub(super) fn as_slice(&self) -> &[Range<usize>] {
        match self {
            Self::One(range) => std::slice::from_ref(range),
            Self::Some(ranges) => ranges,
        }
    }

    /// Returns the total length of the ranges.
    pub(super) fn count(&self) -> usize {
        self.as_slice().iter().map(Range::len).sum()
    }
}

/// Parts of a mesh that remain after cluster culling.
#[derive(Clone, Debug)]
pub(super) struct VisibleClusters {
    pub(super) triangles: Ranges,
    /// Ranges of vertices that include all vertices of the remaining triangles, and possibly others.
    pub(super) vertices: Ranges,
}

impl VisibleClusters {
    /// Returns all triangles and vertices of a mesh.
    pub(super) fn all(mesh: &Mesh) -> Self {
        Self { triangles: Ranges::One(0..mesh.triangles.len()), vertices: Ranges::One(0..mesh.positions.len()) }
    }

    /// Culls the clusters of a mesh. Returns the parts that remain, and the number of clusters culled for each reason.
    pub(super) fn cull_clusters(mesh: &Mesh, view: &ClusterCulling, lanes: Lanes) -> (Self, CullStats) {
        let clusters = mesh.clusters();
        let fates = fates(clusters, view, lanes);
        let count = |fate| fates.iter().filter(|other| **other == fate).count();
        let unseen = CullStats {
            outside: count(ClusterFate::Outside),
            turned_away: count(ClusterFate::BackFacing),
            all: clusters.len(),
        };
        if unseen.culled() == 0 {
            return (Self::all(mesh), unseen);
        }
        let kept = || (0..clusters.len()).filter(|cluster| fates[*cluster] == ClusterFate::Kept);
        let mut triangles: Vec<Range<usize>> = Vec::new();
        for next in kept().map(|cluster| clusters.triangles(cluster)) {
            match triangles.last_mut() {
                Some(last) if last.end == next.start => last.end = next.end,
                _ => triangles.push(next),
            }
        }
        let vertices = union(kept().flat_map(|cluster| clusters.blocks(cluster)), mesh.positions.len());
        (Self { triangles: Ranges::Some(triangles), vertices: Ranges::Some(vertices) }, unseen)
    }
}

/// Result of the culling tests of a cluster.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ClusterFate {
    /// The cluster may be visible, so its triangles are processed.
    Kept,
    /// The cluster lies entirely beyond one clip plane.
    Outside,
    /// All triangles of the cluster are removed by face culling.
    BackFacing,
}

/// Merges ranges of vertex blocks, which may overlap, into disjoint ranges of vertices. The mesh has `len` vertices.
/// The running time is proportional to the number of ranges plus the number of blocks in the mesh.
fn union(ranges: impl Iterator<Item = Range<usize>>, len: usize) -> Vec<Range<usize>> {
    // For each block, the number of ranges that begin with it minus the number of ranges whose last block is the one
    // before it.
    let mut changes = vec![0_i32; len.div_ceil(BLOCK) + 1];
    for range in ranges {
        changes[range.start] += 1;
        changes[range.end] -= 1;
    }
    let (mut out, mut open): (Vec<Range<usize>>, i32) = (Vec::new(), 0);
    for (block, change) in changes.into_iter().enumerate() {
        let before = open > 0;
        open += change;
        let at = (block * BLOCK).min(len);
        match (before, open > 0) {
            (false, true) => out.push(at..len),
            (true, false) => {
                if let Some(last) = out.last_mut() {
                    last.end = at;
                }
            }
            _ => {}
        }
    }
    out
}

/// An affine function of a model-space position, such as the distance from a plane, with magnitudes that bound its
/// rounding error.
#[derive(Clone, Copy, Debug)]
struct Affine {
    coefficients: [f64; 4],
    magnitudes: [f64; 4],
}

impl Affine {
    /// Creates the function that gives the signed distance from a clip plane. `widening`, a power of two, is the factor
    /// by which the side planes are moved outward.
    fn distance(plane: ClipPlane, clip_from_model: Mat4, widening: f32) -> Self {
        let columns: [Vec4; 4] = std::array::from_fn(|column| clip_from_model.col(column));
        let factor = f64::from(widening);
        Self {
            coefficients: columns.map(|column| plane.distance(column, widening)),
            magnitudes: columns.map(|column| plane.magnitude(column.abs().as_dvec4()) * factor),
        }
    }

    /// Creates the function that gives a clip-space coordinate, selected by `axis`: 0 to 3 for x, y, z and w.
    fn component(axis: usize, clip_from_model: Mat4) -> Self {
        let row = clip_from_model.row(axis).as_dvec4();
        Self { coefficients: row.to_array(), magnitudes: row.abs().to_array() }
    }

    /// Returns the maximum of the exact function over each of eight boxes.
    #[inline(always)]
    fn greatest<S: Simd>(&self, simd: S, [least, greatest]: &[[F64<S>; 3]; 2]) -> F64<S> {
        let mut most = F64::splat(simd, self.coefficients[3]);
        for axis in 0..3 {
            let corner = if self.coefficients[axis] > 0.0 { greatest[axis] } else { least[axis] };
            most += corner * self.coefficients[axis];
        }
        most
    }

    /// Returns the minimum of the exact function over each of eight boxes.
    #[inline(always)]
    fn least<S: Simd>(&self, simd: S, [least, greatest]: &[[F64<S>; 3]; 2]) -> F64<S> {
        self.greatest(simd, &[*greatest, *least])
    }

    /// Returns an upper bound on the sum of the magnitudes of the function's terms in each of eight boxes. `farthest`
    /// has the largest magnitude of each coordinate in these boxes.
    #[inline(always)]
    fn magnitude<S: Simd>(&self, simd: S, farthest: &[F64<S>; 3]) -> F64<S> {
        let [x, y, z, one] = self.magnitudes;
        let [far_x, far_y, far_z] = *farthest;
        far_x * x + far_y * y + far_z * z + F64::splat(simd, one)
    }

    /// Returns, for each of eight boxes, a bound on the difference between the function value that the pipeline
    /// computes and the exact one.
    #[inline(always)]
    fn slack<S: Simd>(&self, simd: S, farthest: &[F64<S>; 3]) -> F64<S> {
        self.magnitude(simd, farthest) * ROUNDING + UNDERFLOW
    }
}

/// Clip planes that clusters are tested against. The eye plane is redundant next to the depth planes, because z ≥ 0 and
/// z ≤ w imply w ≥ 0.
const PLANES: [ClipPlane; 6] =
    [ClipPlane::Near, ClipPlane::Far, ClipPlane::Left, ClipPlane::Right, ClipPlane::Bottom, ClipPlane::Top];

/// Cluster culling tests of one mesh in one view.
#[derive(Clone, Debug)]
pub(super) struct ClusterCulling {
    /// Whether all of the mesh is inside the view, so that no cluster is outside and no triangle is clipped.
    all_inside: bool,
    distances: [Affine; PLANES.len()],
    /// Back-facing test; `None` if face culling is off.
    side: Option<BackFacingTest>,
}

impl ClusterCulling {
    pub(super) fn new(clip_from_model: Mat4, containment: Containment, culling: Culling, viewport: Viewport) -> Self {
        Self {
            all_inside: containment == Containment::Inside,
            distances: PLANES.map(|plane| Affine::distance(plane, clip_from_model, 1.0)),
            side: match culling {
                Culling::None => None,
                Culling::Back => Some(BackFacingTest::new(clip_from_model, viewport, -1.0)),
                Culling::Front => Some(BackFacingTest::new(clip_from_model, viewport, 1.0)),
            },
        }
    }
}

/// Factor by which the side planes are moved outward for the back-facing test. The moved planes lie within the guard
/// band for every picture size.
const BAND: f32 = 2.0;
const _: () = assert!(BAND * MAX_SIDE_PX as f32 <= 2.0 * GUARD_BAND_PX);

/// Conservative bound on the rounding error of an affine function computed in doubles, relative to its magnitude.
const DOUBLE_ROUNDING: f64 = 1e-12;

/// Back-facing test of the clusters of one mesh in one view.
#[derive(Clone, Debug)]
struct BackFacingTest {
    /// Signed distances from the clip planes, with the side planes moved outward. Triangles inside all of these planes
    /// are never clipped.
    distances: [Affine; PLANES.len()],
    x: Affine,
    y: Affine,
    w: Affine,
    /// Coefficients of D / 2A as a linear function of n and d, which the module documentation defines. The function is
    /// positive for culled triangles. The second array has, for each coefficient, the sum of the magnitudes of its
    /// terms.
    seen_from: ([f64; 4], [f64; 4]),
    /// Factor κ: an edge of model-space length ℓ is at most κℓ/w px long on the screen.
    stretch: f64,
    /// Length of the longer side of the picture, in pixels.
    longer_px: f64,
    /// A quarter of the picture's area W·H, in px².
    quarter: f64,
}

impl BackFacingTest {
    /// Creates the back-facing test of a mesh in one view. `sign` is the sign of the determinant D (see the module
    /// documentation) for culled triangles.
    fn new(clip_from_model: Mat4, Viewport { width, height }: Viewport, sign: f64) -> Self {
        let (width, height) = (f64::from(width), f64::from(height));
        let rows = [0, 1, 3].map(|row| clip_from_model.row(row).as_dvec4().to_array());
        // Determinant of all columns except `without`, and the sum of the magnitudes of its terms.
        let minor = |without: usize| {
            let [i, j, k] = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]][without];
            let [x, y, w] = &rows;
            let products = [
                x[i] * y[j] * w[k],
                x[j] * y[k] * w[i],
                x[k] * y[i] * w[j],
                -x[k] * y[j] * w[i],
                -x[j] * y[i] * w[k],
                -x[i] * y[k] * w[j],
            ];
            (products.iter().sum::<f64>(), products.iter().map(|product| product.abs()).sum::<f64>())
        };
        let [x, y, z, one] = [0, 1, 2, 3].map(minor);
        // `along` bounds the length, along one screen axis, of an edge with ℓ = 1 at w = 1. The term with row 3
        // accounts for the change of w along the edge.
        let length = |row: usize| clip_from_model.row(row).xyz().as_dvec3().length();
        let along = |row: usize, size: f64| 0.5 * size * (length(row) + f64::from(BAND) * length(3));
        Self {
            distances: PLANES.map(|plane| Affine::distance(plane, clip_from_model, BAND)),
            x: Affine::component(0, clip_from_model),
            y: Affine::component(1, clip_from_model),
            w: Affine::component(3, clip_from_model),
            seen_from: ([sign * x.0, -sign * y.0, sign * z.0, sign * one.0], [x.1, y.1, z.1, one.1]),
            stretch: along(0, width).hypot(along(1, height)),
            longer_px: width.max(height),
            quarter: width * height / 4.0,
        }
    }

    /// Returns the bit mask that selects, among eight clusters, those whose triangles are all removed by face culling.
    #[inline(always)]
    fn back_facing<S: Simd>(
        &self,
        simd: S,
        (bounds, farthest): (&[[F64<S>; 3]; 2], &[F64<S>; 3]),
        planes: &ClusterPlanes,
        may_be_cut: bool,
    ) -> u64 {
        let normals = each!(end in [0, 1] => {
            each!(axis in [0, 1, 2] => widen(simd, F32::load_array(simd, planes.normals[end][axis])))
        });
        let offsets = each!(end in [0, 1] => widen(simd, F32::load_array(simd, planes.offsets[end])));
        let (coefficients, magnitudes) = self.seen_from;
        let offset = if coefficients[3] > 0.0 { offsets[0] } else { offsets[1] };
        let mut least = offset * coefficients[3];
        let mut magnitude = offsets[0].abs().max(offsets[1].abs()) * magnitudes[3];
        for axis in 0..3 {
            let normal = if coefficients[axis] > 0.0 { normals[0][axis] } else { normals[1][axis] };
            least += normal * coefficients[axis];
            magnitude += magnitudes[axis];
        }
        let least = least - magnitude * DOUBLE_ROUNDING;
        let mut bits = least.simd_gt(0.0).to_bitmask();
        if bits == 0 {
            return 0;
        }
        for distance in self.distances.iter().filter(|_| may_be_cut) {
            bits &= distance.least(simd, bounds).simd_gt(distance.slack(simd, farthest)).to_bitmask();
        }
        let slack = self.w.slack(simd, farthest);
        let (w_min, w_max) = (self.w.least(simd, bounds) - slack, self.w.greatest(simd, bounds) + slack);
        // Within these limits, floats neither underflow nor overflow.
        bits &= (w_min.simd_gt(MIN_W) & w_max.simd_lt(MAX_W)).to_bitmask();
        if bits == 0 {
            return 0;
        }
        // x/w ± 1 is off by 4u (M_x + 2 M_w) / w. The quotient and later steps are off by less than 6u.
        let of_x = self.x.magnitude(simd, farthest).max(self.y.magnitude(simd, farthest));
        let relative = (of_x + self.w.magnitude(simd, farthest) * 2.0) / w_min + 1.0;
        let off_px = relative * (SCREEN_ROUNDING * self.longer_px) + 0.5 / SUBPIXELS as f64;
        let altitude = widen(simd, F32::load_array(simd, planes.altitudes));
        let area = altitude * least * self.quarter / (w_max * w_max * w_max);
        let changed =
            off_px * (3.0 * std::f64::consts::SQRT_2 * self.stretch) / w_min + off_px * off_px * 8.0 / altitude;
        bits & (area.simd_gt(changed) & altitude.simd_gt(0.0)).to_bitmask()
    }
}

/// Lower limit of clip-space w for clusters that the back-facing test may cull.
const MIN_W: f64 = 1e-20;

/// Upper limit of clip-space w for clusters that the back-facing test may cull.
const MAX_W: f64 = 1e20;

/// Bound on the rounding error of a screen position, relative to the longer side of the picture and to the magnitudes
/// of its terms: 8u with u = 2⁻²⁴.
const SCREEN_ROUNDING: f64 = 4.0 * f32::EPSILON as f64;

/// Returns the culling result of each cluster.
fn fates(clusters: &Clusters, view: &ClusterCulling, lanes: Lanes) -> Vec<ClusterFate> {
    let mut out = vec![ClusterFate::Kept; clusters.len()];
    on_lanes!(lanes, simd => {
        for ((boxes, planes), out) in clusters.boxes().iter().zip(clusters.planes()).zip(out.chunks_mut(LANES)) {
            let [outside, turned_away] = eight_fates(simd, boxes, planes, view);
            if outside | turned_away == 0 {
                continue;
            }
            for (lane, out) in out.iter_mut().enumerate() {
                if outside >> lane & 1 != 0 {
                    *out = ClusterFate::Outside;
                } else if turned_away >> lane & 1 != 0 {
                    *out = ClusterFate::BackFacing;
                }
            }
        }
    });
    out
}

/// Returns two bit masks over eight clusters. The first selects clusters whose vertices all lie beyond one clip plane
/// when the pipeline transforms them. The second selects clusters that are back-facing.
#[inline(always)]
fn eight_fates<S: Simd>(simd: S, boxes: &Boxes, planes: &ClusterPlanes, view: &ClusterCulling) -> [u64; 2] {
    let bounds = each!(end in [0, 1] => {
        each!(axis in [0, 1, 2] => widen(simd, F32::load_array(simd, boxes[end][axis])))
    });
    let farthest = each!(axis in [0, 1, 2] => bounds[0][axis].abs().max(bounds[1][axis].abs()));
    let mut outside = 0;
    for distance in view.distances.iter().filter(|_| !view.all_inside) {
        let slack = distance.slack(simd, &farthest);
        outside |= distance.greatest(simd, &bounds).simd_lt(-slack).to_bitmask();
    }
    let turned_away = match &view.side {
        Some(side) if outside != ALL => side.back_facing(simd, (&bounds, &farthest), planes, !view.all_inside),
        _ => 0,
    };
    [outside, turned_away]
}

/// Bit mask that selects all eight clusters.
const ALL: u64 = (1 << LANES) - 1;

#[cfg(test)]
mod tests {
    use glam::{EulerRot, Quat, Vec2, Vec3};

    use super::*;
    use crate::pipeline::clip::guard_band_widening;
    use crate::pipeline::cull::cull;
    use crate::pipeline::depth::DepthScale;
    use crate::pipeline::raster::doubled_area;
    use crate::pipeline::settings::Arithmetic;
    use crate::pipeline::vertex::{ClipVertex, containment};
    use crate::scene::{Camera, DepthMapping, MeshData};

    const VIEWPORT: Viewport = Viewport { width: 640, height: 360 };

    /// Returns eight boxes, each spanned by two opposite corners.
    fn boxes(corners: &[[Vec3; 2]; LANES]) -> Boxes {
        let end = |end: fn(Vec3, Vec3) -> Vec3| -> [[f32; LANES]; 3] {
            std::array::from_fn(|axis| corners.map(|[a, b]| end(a, b)[axis]))
        };
        [end(Vec3::min), end(Vec3::max)]
    }

    fn bits(corners: &[[Vec3; 2]; LANES], matrix: Mat4, lanes: Lanes) -> u64 {
        let view = ClusterCulling::new(matrix, Containment::Crossing, Culling::None, VIEWPORT);
        let boxes = boxes(corners);
        let planes =
            ClusterPlanes { normals: [[[0.0; LANES]; 3]; 2], offsets: [[0.0; LANES]; 2], altitudes: [0.0; LANES] };
        let [outside, turned_away] = on_lanes!(lanes, simd => eight_fates(simd, &boxes, &planes, &view));
        assert_eq!(turned_away, 0);
        outside
    }

    /// Returns `true` if all `vertices`, transformed as in the pipeline, lie beyond the same plane.
    fn is_outside(vertices: &[Vec3], matrix: Mat4) -> bool {
        let clip = || vertices.iter().map(|vertex| matrix * vertex.extend(1.0));
        ClipPlane::ALL.iter().any(|plane| clip().all(|position| plane.distance(position, 1.0) < 0.0))
    }

    /// Tests boxes whose exact distance from a clip plane is zero or nearly zero. The scale of the matrix varies from
    /// underflowing products to huge ones.
    #[test]
    fn clusters_culled_as_outside_have_all_vertices_beyond_a_plane() {
        let mut random = fastrand::Rng::with_seed(21);
        let (mut left_out, mut kept_though_outside) = (0, 0);
        for round in 0..6000 {
            let mut number = || random.f32() * 2.0 - 1.0;
            let mut matrix = Mat4::from_cols_array(&std::array::from_fn(|_| number()));
            let (plane, scale) =
                (PLANES[round % PLANES.len()], [1e-42_f32, 1e-30, 1e-4, 1.0, 1e3, 1e18][round / 6 % 6]);
            let corners: [[Vec3; 2]; LANES] = std::array::from_fn(|_| {
                let a = Vec3::from_array(std::array::from_fn(|_| number()));
                let edge = Vec3::from_array(std::array::from_fn(|_| number())) * 1e-6;
                [a, a + edge]
            });
            // Translates the plane so that it passes through a corner of the first box, or very close to that corner.
            let at = matrix * corners[0][0].extend(1.0);
            let off = plane.distance(at, 1.0) as f32 * [1.0, 1.000_001, 0.999_999][round / 36 % 3];
            match plane {
                ClipPlane::Near => matrix.w_axis.z -= off,
                ClipPlane::Left => matrix.w_axis.x -= off,
                ClipPlane::Right => matrix.w_axis.x += off,
                ClipPlane::Bottom => matrix.w_axis.y -= off,
                ClipPlane::Top => matrix.w_axis.y += off,
                _ => matrix.w_axis.z += off,
            }
            let matrix = matrix * scale;
            for lanes in Lanes::all() {
                let bits = bits(&corners, matrix, lanes);
                for (lane, [a, b]) in corners.iter().enumerate() {
                    let mix = |t: f32| *a + (*b - *a) * t;
                    let all = [*a, *b, Vec3::new(a.x, b.y, a.z), Vec3::new(b.x, a.y, b.z), mix(0.25), mix(0.5)];
                    let outside = is_outside(&all, matrix);
                    if bits >> lane & 1 != 0 {
                        assert!(outside, "{} {plane:?} {matrix:?} {a:?} {b:?}", lanes.name());
                        left_out += 1;
                    } else if outside {
                        kept_though_outside += 1;
                    }
                }
            }
        }
        // Some boxes next to a plane or with underflowing numbers are kept, but far fewer than are culled.
        assert!(left_out > 3 * kept_though_outside && kept_though_outside > 0, "{left_out} {kept_though_outside}");
    }

    /// Tests sheets of triangles that are bent, creased and squeezed, down to far less than a pixel. The views mirror
    /// and shear them.
    #[test]
    fn clusters_culled_as_back_facing_have_only_culled_triangles() {
        let mut random = fastrand::Rng::with_seed(22);
        let (mut turned_away, mut kept_though_culled, mut smallest) = (0, 0, f64::INFINITY);
        for round in 0..1500 {
            let mut number = || random.f32() * 2.0 - 1.0;
            let size = 10.0_f32.powf(number() * 2.0 - 1.2);
            let (bend, crease, squeeze) = (number(), number() * 0.2 * number(), 10.0_f32.powf(number() * 1.5 - 1.5));
            let mut data = MeshData::default();
            for i in 0..17 * 17 {
                let at = Vec2::new((i % 17) as f32 / 8.0 - 1.0, (i / 17) as f32 / 8.0 - 1.0);
                let height = bend * at.length_squared() + crease * number() / 8.0;
                data.positions.push(Vec3::new(at.x, at.y * squeeze, height * squeeze) * size);
            }
            for i in (0..16 * 17_u32).filter(|i| i % 17 < 16) {
                data.triangles.extend([[i, i + 1, i + 18], [i, i + 18, i + 17]]);
            }
            let mesh = Mesh::new(data).unwrap();
            let turn = Quat::from_euler(EulerRot::XYZ, number() * 3.2, number() * 3.2, number() * 3.2);
            let shear = Mat4::from_cols(Vec4::X, Vec4::new(number(), 1.0, 0.0, 0.0), Vec4::Z, Vec4::W);
            let mirror = Vec3::new(if round % 3 == 0 { -1.0 } else { 1.0 }, 1.0, 1.0);
            let place = Vec3::new(number(), number(), -1.5 + number());
            let camera = Camera { near: 0.01, far: 10.0, ..Camera::look_at(Vec3::ZERO, Vec3::NEG_Z) };
            let camera = camera.with_orthographic(round % 5 == 0);
            let projection = camera.clip_from_view(VIEWPORT.aspect(), DepthMapping::STANDARD);
            let matrix =
                projection * Mat4::from_translation(place) * Mat4::from_quat(turn) * shear * Mat4::from_scale(mirror);
            for culling in [Culling::Back, Culling::Front] {
                let containment = containment(mesh.visible_bounds(), matrix);
                let view = ClusterCulling::new(matrix, containment, culling, VIEWPORT);
                for lanes in Lanes::all() {
                    let fates = fates(mesh.clusters(), &view, lanes);
                    for (cluster, fate) in fates.into_iter().enumerate() {
                        let triangles = &mesh.triangles[mesh.clusters().triangles(cluster)];
                        let fate_of = |triangle: &[u32; 3]| {
                            fate_of(triangle.map(|i| mesh.positions[i as usize]), matrix, culling)
                        };
                        let all_culled = triangles.iter().all(|triangle| fate_of(triangle).is_some());
                        if fate == ClusterFate::BackFacing {
                            assert!(all_culled, "{} {culling:?} round {round} cluster {cluster}", lanes.name());
                            turned_away += 1;
                            let areas = triangles.iter().filter_map(fate_of);
                            smallest = areas.fold(smallest, f64::min);
                        } else if all_culled && fate == ClusterFate::Kept {
                            kept_though_culled += 1;
                        }
                    }
                }
            }
        }
        // Some culled triangles are smaller than a pixel, and many clusters remain uncertain.
        assert!(turned_away > 1000 && kept_though_culled > 200, "{turned_away} {kept_though_culled}");
        assert!(smallest < 0.25, "{smallest}");
    }

    /// If the classic (scalar) path culls a triangle without clipping it, returns the doubled area of the triangle in
    /// px². Otherwise returns `None`.
    fn fate_of(corners: [Vec3; 3], matrix: Mat4, culling: Culling) -> Option<f64> {
        let widening = guard_band_widening(VIEWPORT.width, VIEWPORT.height);
        let corners = corners.map(|corner| ClipVertex::at(matrix * corner.extend(1.0)));
        if corners
            .iter()
            .any(|corner| ClipPlane::ALL.iter().any(|plane| plane.distance(corner.position, widening) < 0.0))
        {
            return None;
        }
        let corners = corners.map(|corner| VIEWPORT.project_vertex(&corner, &DepthScale::default()).position_px);
        let (area, scale) = doubled_area(Arithmetic::Fixed, corners);
        cull(area, culling).map(|_| area.abs() * scale / (SUBPIXELS * SUBPIXELS) as f64)
    }

    #[test]
    fn matrices_that_are_not_finite_cull_nothing() {
        let corners = [[Vec3::splat(5.0), Vec3::splat(6.0)]; LANES];
        for lanes in Lanes::all() {
            assert_eq!(bits(&corners, Mat4::IDENTITY, lanes), 0xff);
            assert_eq!(bits(&corners, Mat4::IDENTITY * f32::NAN, lanes), 0);
            assert_eq!(bits(&corners, Mat4::IDENTITY * f32::INFINITY, lanes), 0);
        }
    }

    #[test]
    fn blocks_are_joined() {
        /// Calls [`union`] with ranges given as pairs of start and end, and returns the result in the same form.
        fn joined<const N: usize>(ranges: [[usize; 2]; N], len: usize) -> Vec<[usize; 2]> {
            let joined = union(ranges.into_iter().map(|[start, end]| start..end), len);
            joined.into_iter().map(|range| [range.start, range.end]).collect()
        }
        let len = 10 * BLOCK + 1;
        assert_eq!(joined([], len), [[0; 2]; 0]);
        assert_eq!(joined([[0, 1]], len), [[0, BLOCK]]);
        assert_eq!(joined([[9, 11], [0, 1]], len), [[0, BLOCK], [9 * BLOCK, len]]);
        assert_eq!(joined([[0, 2], [2, 3]], len), [[0, 3 * BLOCK]]);
        assert_eq!(joined([[0, 9], [2, 3], [4, 5]], len), [[0, 9 * BLOCK]]);
        assert_eq!(joined([[0, 1]], 5), [[0, 5]]);
    }
}
