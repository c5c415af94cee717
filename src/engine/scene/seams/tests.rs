use glam::{Mat4, Vec3};

use super::*;
use crate::scene::builtin;
use crate::scene::mesh::MeshData;
use crate::scene::{Instance, Material, Mesh};

/// Returns a scene with one mesh for each entry of `parts` (positions and triangles), all with the same transform.
pub(crate) fn scene(parts: &[(Vec<Vec3>, Vec<[u32; 3]>)], world_from_model: Mat4) -> Scene {
    let mut scene = builtin::by_id("triangle").unwrap().build();
    scene.instances.clear();
    for (positions, triangles) in parts {
        let data = MeshData { positions: positions.clone(), triangles: triangles.clone(), ..MeshData::default() };
        let mesh = scene.library.add_mesh(Mesh::new(data).unwrap());
        let material = scene.library.add_material(Material::default());
        let (name, tint) = (String::new(), Vec3::ONE);
        scene.instances.push(Instance { name, mesh, material, world_from_model, tint });
    }
    scene
}

fn turned() -> impl Iterator<Item = Mat4> {
    let turns =
        [(0.0, Vec3::ZERO, 1.0), (0.7, Vec3::new(3.0, -2.0, 5.0), 40.0), (2.1, Vec3::new(-0.3, 9.0, 0.1), 0.01)];
    turns.into_iter().map(|(angle, shift, scale)| {
        let axis = Vec3::new(0.3, 0.8, -0.5).normalize();
        Mat4::from_scale_rotation_translation(Vec3::splat(scale), glam::Quat::from_axis_angle(axis, angle), shift)
    })
}

fn counts(scene: &Scene) -> [usize; 2] {
    let SeamCounts { t_junctions, unwelded } = Seams::of(scene).counts();
    [t_junctions, unwelded]
}

/// Returns the positions and triangles of a test mesh with a shared edge from (−1, 0) to (1, 0). One triangle lies
/// above it; below it lies a triangle fan with additional vertices on the edge, at the x coordinates `stops`.
pub(crate) fn fan(stops: &[f32]) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut positions = vec![Vec3::new(-1.0, 0.0, 0.0), Vec3::new(1.0, 0.0, 0.0), Vec3::Y, Vec3::new(0.1, -1.0, 0.2)];
    let mut rim = vec![0];
    for stop in stops {
        rim.push(positions.len() as u32);
        positions.push(Vec3::new(*stop, 0.0, 0.0));
    }
    rim.push(1);
    let lower = rim.windows(2).map(|pair| [pair[1], pair[0], 3]);
    let triangles = std::iter::once([0, 1, 2]).chain(lower).collect();
    (positions, triangles)
}

#[test]
fn every_vertex_within_an_open_edge_is_a_t_junction_wherever_the_mesh_lies() {
    for place in turned() {
        for stops in [&[][..], &[0.3], &[-0.9, -0.5, 0.0, 0.1, 0.95]] {
            let seams = Seams::of(&scene(&[fan(stops)], place));
            let found = seams.counts();
            assert_eq!((found.t_junctions, found.unwelded), (stops.len(), 0));
            assert_eq!(seams.seams().len(), if stops.is_empty() { 0 } else { stops.len() + 1 });
            for junction in seams.junctions() {
                assert_eq!(junction.edge, TriangleEdge { triangle: TriangleId(0), opposite: 2 });
                assert!(junction.distance < 1e-5 && junction.vertex.triangle.0 > 0, "{junction:?}");
            }
        }
    }
}

#[test]
fn the_corner_of_a_junction_is_the_vertex_on_the_edge() {
    let (positions, triangles) = fan(&[-0.4, 0.25]);
    let seams = Seams::of(&scene(&[(positions.clone(), triangles.clone())], Mat4::IDENTITY));
    let mut stops: Vec<f32> = seams
        .junctions()
        .iter()
        .map(|junction| {
            let TriangleCorner { triangle, corner } = junction.vertex;
            let at = positions[triangles[triangle.0 as usize][usize::from(corner)] as usize];
            assert_eq!((at.y, at.z), (0.0, 0.0));
            at.x
        })
        .collect();
    stops.sort_by(f32::total_cmp);
    assert_eq!(stops, [-0.4, 0.25]);
    let border: Vec<Vec3> = seams
        .border()
        .iter()
        .map(|corner| positions[triangles[corner.triangle.0 as usize][usize::from(corner.corner)] as usize])
        .collect();
    assert_eq!(border.len(), positions.len(), "the mesh is all border");
    assert!(positions.iter().all(|position| border.contains(position)));
}

#[test]
fn a_vertex_beyond_the_tolerance_is_no_t_junction() {
    let diagonal = 2.0_f64.hypot(2.0).hypot(0.2);
    let reach = tolerance(2.0, diagonal, 1.0) as f32;
    for (height, found) in [(0.9 * reach, 1), (-0.9 * reach, 1), (1.1 * reach, 0), (-1.1 * reach, 0)] {
        let (mut positions, triangles) = fan(&[0.3]);
        positions[4].y = height;
        assert_eq!(counts(&scene(&[(positions, triangles)], Mat4::IDENTITY)), [found, 0], "{height}");
    }
}

#[test]
fn a_filler_triangle_closes_a_t_junction() {
    let (positions, mut triangles) = fan(&[0.3]);
    triangles.push([1, 0, 4]);
    assert_eq!(counts(&scene(&[(positions, triangles)], Mat4::IDENTITY)), [0, 0]);
}

#[test]
fn rows_that_are_shifted_against_each_other_have_t_junctions_on_both_sides() {
    // Two rows of four quads each, with the upper row shifted by half a quad.
    let row = |low: f32, shift: f32| {
        let at = |i: u32, y: f32| Vec3::new(i as f32 + shift, y, 0.0);
        let positions: Vec<Vec3> = (0..5).map(|i| at(i, low)).chain((0..5).map(|i| at(i, low + 1.0))).collect();
        let triangles = (0..4).flat_map(|i| [[i, i + 1, i + 6], [i, i + 6, i + 5]]).collect();
        (positions, triangles)
    };
    for place in turned() {
        // Each row has five vertices on the seam, and one of them lies beyond the end of the other row.
        assert_eq!(counts(&scene(&[row(0.0, 0.0), row(1.0, 0.5)], place)), [8, 0]);
        // Without the shift, both rows share their vertices.
        assert_eq!(counts(&scene(&[row(0.0, 0.0), row(1.0, 0.0)], place)), [0, 0]);
    }
}

#[test]
fn vertices_that_differ_in_the_last_bits_are_unwelded_and_equal_ones_are_not() {
    let quads = |moved: f32| {
        let left = vec![Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y];
        let right: Vec<Vec3> = left.iter().map(|p| *p + Vec3::X + Vec3::new(moved, 0.0, 0.0)).collect();
        let triangles = vec![[0, 1, 2], [0, 2, 3]];
        [(left, triangles.clone()), (right, triangles)]
    };
    assert_eq!(counts(&scene(&quads(0.0), Mat4::IDENTITY)), [0, 0]);
    for moved in [f32::EPSILON, -1e-6, 1e-5] {
        assert_eq!(counts(&scene(&quads(moved), Mat4::IDENTITY)), [0, 2], "{moved}");
    }
    assert_eq!(counts(&scene(&quads(0.01), Mat4::IDENTITY)), [0, 0], "a gap that is meant");
}

#[test]
fn seams_of_texture_coordinates_and_materials_are_closed() {
    let mut rng = fastrand::Rng::with_seed(2);
    // A grid whose triangles share only positions, distributed over three meshes.
    let at = |x: u32, y: u32| Vec3::new(x as f32 * 0.37, y as f32 * 0.21, (x * y) as f32 * 0.05);
    let mut parts = vec![(Vec::new(), Vec::new()); 3];
    for (x, y) in (0..9).flat_map(|x| (0..7).map(move |y| (x, y))) {
        for corners in [[(x, y), (x + 1, y), (x + 1, y + 1)], [(x, y), (x + 1, y + 1), (x, y + 1)]] {
            let (positions, triangles): &mut (Vec<Vec3>, Vec<[u32; 3]>) = &mut parts[rng.usize(..3)];
            let first = positions.len() as u32;
            positions.extend(corners.map(|(x, y)| at(x, y)));
            triangles.push([first, first + 1, first + 2]);
        }
    }
    for place in turned() {
        let scene = scene(&parts, place);
        let seams = Seams::of(&scene);
        assert_eq!((seams.counts(), seams.border().len()), (SeamCounts::default(), 2 * (9 + 7)));
    }
}

#[test]
fn both_rims_of_a_thin_strip_are_no_seam() {
    for stagger in [0.0, 0.4] {
        let positions: Vec<Vec3> =
            (0..10).flat_map(|i| [Vec3::new(i as f32, 0.0, 0.0), Vec3::new(i as f32 + stagger, 1e-4, 0.0)]).collect();
        let triangles = (0..9).flat_map(|i| [[2 * i, 2 * i + 2, 2 * i + 3], [2 * i, 2 * i + 3, 2 * i + 1]]).collect();
        assert_eq!(counts(&scene(&[(positions, triangles)], Mat4::IDENTITY)), [0, 0], "{stagger}");
    }
}

#[test]
fn triangles_that_are_not_finite_or_have_no_area_are_ignored() {
    let (mut positions, mut triangles) = fan(&[0.3]);
    positions.extend([Vec3::NAN, Vec3::new(0.2, f32::INFINITY, 0.0)]);
    triangles.extend([[0, 5, 1], [6, 0, 4], [0, 0, 1], [1, 4, 4]]);
    assert_eq!(counts(&scene(&[(positions, triangles)], Mat4::IDENTITY)), [1, 0]);
    assert_eq!(Seams::of(&scene(&[], Mat4::IDENTITY)), Seams::default());
}

#[test]
fn the_search_can_be_stopped() {
    let scene = scene(&[fan(&[0.3])], Mat4::IDENTITY);
    assert_eq!(Seams::find(&scene, &AtomicBool::new(true)), None);
}

#[test]
fn built_in_scenes_have_no_open_seams() {
    for builtin in builtin::ALL {
        let seams = Seams::of(&builtin.build());
        assert_eq!(seams.counts(), SeamCounts::default(), "{}: {:?}", builtin.id, seams.junctions());
    }
}
