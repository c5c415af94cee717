use glam::{EulerRot, Quat, Vec2, Vec3, Vec4};

use super::*;
use crate::math::fixed::SUBPIXELS;
use crate::pipeline::clip::guard_band_widening;
use crate::pipeline::clip_space::{ClipPlane, ClipVertex};
use crate::pipeline::cull::cull;
use crate::pipeline::depth::DepthScale;
use crate::pipeline::raster::doubled_area;
use crate::pipeline::settings::Arithmetic;
use crate::pipeline::vertex::containment;
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
    let planes = ClusterPlanes { normals: [[[0.0; LANES]; 3]; 2], offsets: [[0.0; LANES]; 2], altitudes: [0.0; LANES] };
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
        let (plane, scale) = (PLANES[round % PLANES.len()], [1e-42_f32, 1e-30, 1e-4, 1.0, 1e3, 1e18][round / 6 % 6]);
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
                    let fate_of =
                        |triangle: &[u32; 3]| fate_of(triangle.map(|i| mesh.positions[i as usize]), matrix, culling);
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
    if corners.iter().any(|corner| ClipPlane::ALL.iter().any(|plane| plane.distance(corner.position, widening) < 0.0)) {
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
