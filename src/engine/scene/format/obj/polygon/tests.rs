use super::*;

fn triangulate(corners: &[Vec3]) -> (Vec<[u32; 3]>, TriangulationOutcome) {
    let mut result = Triangulation::default();
    let outcome = Triangulator::default().triangulate(corners, &mut result, &|| false);
    assert!(result.crossings.is_empty());
    (result.triangles, outcome)
}

/// Returns the triangles of a polygon as positions in space. Their vertices are the polygon's corners and
/// self-intersection points.
fn triangles_in_space(corners: &[Vec3]) -> (Vec<[Vec3; 3]>, TriangulationOutcome) {
    let mut result = Triangulation::default();
    let outcome = Triangulator::default().triangulate(corners, &mut result, &|| false);
    let crossing = |crossing: &OutlineCrossing| {
        let edge = crossing.edge as usize;
        corners[edge].lerp(corners[(edge + 1) % corners.len()], crossing.place as f32)
    };
    let points: Vec<Vec3> = corners.iter().copied().chain(result.crossings.iter().map(crossing)).collect();
    (result.triangles.iter().map(|triangle| triangle.map(|corner| points[corner as usize])).collect(), outcome)
}

/// Returns the winding number of a polygon in the plane z = 0 around a point.
fn winding(corners: &[Vec3], point: Vec3) -> i32 {
    let edges = corners.iter().zip(corners.iter().cycle().skip(1));
    let crossing = |(a, b): (&Vec3, &Vec3)| {
        let side = (*b - *a).truncate().perp_dot((point - *a).truncate());
        match (a.y <= point.y, b.y <= point.y) {
            (true, false) if side > 0.0 => 1,
            (false, true) if side < 0.0 => -1,
            _ => 0,
        }
    };
    edges.map(crossing).sum()
}

/// Returns two flags: whether upward-facing triangles in the plane z = 0 cover a point, and whether downward-facing
/// ones do.
fn covered(triangles: &[[Vec3; 3]], point: Vec3) -> [bool; 2] {
    let sides = |[a, b, c]: &[Vec3; 3]| {
        [(a, b), (b, c), (c, a)].map(|(a, b)| (*b - *a).truncate().perp_dot((point - *a).truncate()))
    };
    let all = |sign: f32| triangles.iter().any(|triangle| sides(triangle).iter().all(|side| sign * side > 0.0));
    [all(1.0), all(-1.0)]
}

fn area_vector(corners: &[Vec3], triangles: &[[u32; 3]]) -> Vec3 {
    let corner = |i: u32| corners[i as usize];
    triangles.iter().map(|[a, b, c]| (corner(*b) - corner(*a)).cross(corner(*c) - corner(*a)) * 0.5).sum()
}

fn area(corners: &[Vec3], triangles: &[[u32; 3]]) -> f32 {
    let one = |t: &[u32; 3]| area_vector(corners, std::slice::from_ref(t)).length();
    triangles.iter().map(one).sum()
}

fn flat(points: &[[f32; 2]]) -> Vec<Vec3> {
    points.iter().map(|[x, y]| Vec3::new(*x, *y, 0.0)).collect()
}

#[test]
fn a_concave_polygon_keeps_its_area_and_its_side_in_every_direction() {
    let arrow = flat(&[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 1.0], [0.0, 4.0]]);
    for turn in 0..24 {
        let rotation = glam::Quat::from_scaled_axis(Vec3::new(0.3, 0.5, 0.8) * turn as f32);
        let corners: Vec<_> = arrow.iter().map(|c| rotation * *c).collect();
        let (triangles, outcome) = triangulate(&corners);
        assert_eq!((triangles.len(), outcome), (3, TriangulationOutcome::Whole));
        assert!((area(&corners, &triangles) - 10.0).abs() < 1e-4);
        assert!((area_vector(&corners, &triangles) - rotation * Vec3::Z * 10.0).length() < 1e-4);
    }
}

#[test]
fn a_corner_in_the_middle_of_an_edge_is_kept() {
    let (triangles, _) = triangulate(&flat(&[[1.0, 0.0], [2.0, 0.0], [0.0, 2.0], [0.0, 0.0]]));
    let used = |corner: u32| triangles.iter().flatten().any(|c| *c == corner);
    assert!((0..4).all(used), "{triangles:?}");
}

#[test]
fn a_convex_polygon_is_a_fan_from_its_first_corner() {
    let square = flat(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    assert_eq!(triangulate(&square), (vec![[0, 1, 2], [0, 2, 3]], TriangulationOutcome::Whole));
}

#[test]
fn corners_on_a_line_or_a_point_give_no_triangles() {
    for points in [[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]], [[1.0, 1.0]; 3], [[0.0, 0.0], [1.0, 0.0], [1.0, 0.0]]] {
        assert_eq!(triangulate(&flat(&points)), (vec![], TriangulationOutcome::NoArea));
    }
}

#[test]
fn a_bow_tie_is_two_triangles_that_face_apart() {
    for points in [[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]], [[0.0, 0.0], [4.0, 4.0], [4.0, 0.0], [0.0, 2.0]]] {
        for turn in 0..12 {
            let rotation = glam::Quat::from_scaled_axis(Vec3::new(0.3, 0.5, 0.8) * turn as f32);
            let corners: Vec<Vec3> = flat(&points).iter().map(|corner| rotation * *corner).collect();
            let (triangles, outcome) = triangles_in_space(&corners);
            assert_eq!((triangles.len(), outcome), (2, TriangulationOutcome::Crossing), "{points:?} {turn}");
            let [first, second] = [0, 1].map(|i| area_vector(&triangles[i], &[[0, 1, 2]]));
            assert!(first.dot(second) < 0.0);
            let newell: Vec3 = (0..4).map(|i| corners[i].cross(corners[(i + 1) % 4]) * 0.5).sum();
            assert!((first + second - newell).length() < 1e-5, "{points:?} {turn}");
        }
    }
}

#[test]
fn regions_are_covered_by_the_sign_of_their_winding_number() {
    let mut random = fastrand::Rng::with_seed(11);
    let mut seen = std::collections::BTreeSet::new();
    for round in 0..300 {
        let count = [5, 8, 20, 90][round % 4];
        // On a small lattice, many corners coincide or lie on other edges, and edges overlap.
        let size = [4, 1000][round / 4 % 2];
        let corners: Vec<Vec3> =
            (0..count).map(|_| Vec3::new(random.i32(0..=size) as f32, random.i32(0..=size) as f32, 0.0)).collect();
        let (triangles, outcome) = triangles_in_space(&corners);
        if outcome == TriangulationOutcome::TooManyCrossings {
            continue;
        }
        // The projection makes the larger part of the polygon counter-clockwise, which may reverse all signs.
        let mut agree = [true; 2];
        for _ in 0..200 {
            let inside = |random: &mut fastrand::Rng| (random.f32() * size as f32 * 64.0).floor() / 64.0 + 0.007;
            let point = Vec3::new(inside(&mut random), inside(&mut random) + 0.0013, 0.0);
            let distance = |(a, b): (&Vec3, &Vec3)| {
                let along = (*b - *a).normalize_or_zero();
                let place = (point - *a).dot(along).clamp(0.0, (*b - *a).length());
                (*a + along * place - point).length()
            };
            let edges = || corners.iter().zip(corners.iter().cycle().skip(1));
            let seams = || triangles.iter().flat_map(|[a, b, c]| [(a, b), (b, c), (c, a)]);
            if edges().map(distance).chain(seams().map(distance)).any(|d| d < 1e-5 * size as f32) {
                continue;
            }
            let winding = winding(&corners, point);
            seen.insert(winding.signum());
            for (agree, sign) in agree.iter_mut().zip([1, -1]) {
                *agree &= covered(&triangles, point) == [sign * winding > 0, sign * winding < 0];
            }
        }
        assert!(agree.contains(&true), "{corners:?}");
    }
    assert_eq!(seen.len(), 3);
}

#[test]
fn a_pentagram_is_covered_completely() {
    let star: Vec<_> = (0..5)
        .map(|i| (i as f32 * 2.0 * std::f32::consts::TAU / 5.0).sin_cos())
        .map(|(y, x)| Vec3::new(x, y, 0.0))
        .collect();
    let (triangles, outcome) = triangles_in_space(&star);
    assert_eq!(outcome, TriangulationOutcome::Crossing);
    assert_eq!(covered(&triangles, Vec3::new(0.01, 0.02, 0.0)), [true, false]);
}

/// Returns six named test outlines of `count` corners each.
fn large(count: usize) -> [(&'static str, Vec<[f32; 2]>); 6] {
    let half = count / 2;
    let there_and_back = |lower: &dyn Fn(usize) -> [f32; 2], upper: &dyn Fn(usize) -> [f32; 2]| {
        (0..half).map(lower).chain((0..half).rev().map(upper)).collect::<Vec<_>>()
    };
    let around = |i: usize, radius: f32| {
        let (y, x) = (f64::from(i as u32) / count as f64 * std::f64::consts::TAU).sin_cos();
        [x as f32 * radius, y as f32 * radius]
    };
    let turned = |i: usize, radius: f32| {
        let angle = i as f32 * 0.01;
        [angle.cos() * (radius + angle), angle.sin() * (radius + angle)]
    };
    let mut random = fastrand::Rng::with_seed(5);
    [
        ("strip", there_and_back(&|i| [i as f32, 0.0], &|i| [i as f32, 0.01])),
        ("zigzag", there_and_back(&|i| [i as f32, (i % 2) as f32], &|i| [i as f32, (i % 2) as f32 + 0.5])),
        ("comb", there_and_back(&|i| [i as f32, 0.0], &|i| [i as f32, if i % 2 == 0 { 1.0 } else { 5000.0 }])),
        ("gear", (0..count).map(|i| around(i, if i / 2 % 2 == 0 { 0.9 } else { 1.0 })).collect()),
        ("star", (0..count).map(|i| around(i, 0.2 + 0.8 * random.f32())).collect()),
        ("spiral", there_and_back(&|i| turned(i, 1.0), &|i| turned(i, 1.5)).into_iter().rev().collect()),
    ]
}

#[test]
fn large_outlines_are_triangulated_completely() {
    for (name, points) in large(20_000) {
        let corners = flat(&points);
        let (triangles, outcome) = triangulate(&corners);
        assert_eq!(outcome, TriangulationOutcome::Whole, "{name}");
        let newell: Vec3 = (0..corners.len())
            .map(|i| (corners[i].cross(corners[(i + 1) % corners.len()]) * 0.5).as_dvec3())
            .sum::<DVec3>()
            .as_vec3();
        let found: DVec3 = triangles.iter().map(|t| area_vector(&corners, std::slice::from_ref(t)).as_dvec3()).sum();
        assert!((found.as_vec3() - newell).length() < 1e-3 * newell.length(), "{name}: {found} {newell}");
        let mut used = vec![false; corners.len()];
        triangles.iter().flatten().for_each(|corner| used[*corner as usize] = true);
        assert!(used.iter().filter(|used| !**used).count() < corners.len() / 100, "{name}");
    }
}

#[test]
fn an_outline_that_repeats_the_same_corners_many_times_terminates() {
    let around = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::new(1.0, 1.5, 0.0)];
    let corners: Vec<Vec3> = (0..65_536).map(|i| around[i % 4]).collect();
    let (triangles, outcome) = triangles_in_space(&corners);
    assert_eq!((triangles.len(), outcome), (2, TriangulationOutcome::Crossing));
}

#[test]
fn an_outline_that_crosses_itself_a_million_times_becomes_a_fan() {
    let zigzag = (0..4_000_u64).map(|i| [(i * 7919 % 10_007) as f32, (i * 104_729 % 10_009) as f32]);
    let (triangles, outcome) = triangulate(&flat(&zigzag.collect::<Vec<_>>()));
    assert_eq!(outcome, TriangulationOutcome::TooManyCrossings);
    assert!(triangles.len() > 3_900);
}

#[test]
fn a_hairline_frame_is_cut_whichever_side_its_largest_triangle_is_on() {
    let wall = 1e-5;
    for steps in [1, 23] {
        let along = |from: [f32; 2], to: [f32; 2]| {
            (0..steps).map(move |i| [0, 1].map(|k| from[k] + (to[k] - from[k]) * i as f32 / steps as f32))
        };
        let outer = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let mut points: Vec<[f32; 2]> = (0..3).flat_map(|i| along(outer[i], outer[i + 1])).collect();
        points.extend([outer[3], [0.0, 1.0 - wall], [1.0 - wall, 1.0 - wall], [1.0 - wall, wall], [0.0, wall]]);
        let corners = flat(&points);
        let (triangles, outcome) = triangulate(&corners);
        assert_eq!((triangles.len(), outcome), (corners.len() - 2, TriangulationOutcome::Whole));
        assert!(area_vector(&corners, &triangles).z > 0.0);
    }
}

#[test]
fn a_bent_outline_that_crosses_itself_is_reported_as_not_flat() {
    let corners = [[0.0, 0.0, 0.0], [4.0, 4.0, 0.0], [4.0, 0.0, 0.5], [0.0, 2.0, 0.0]].map(Vec3::from_array);
    assert_eq!(triangulate(&corners).1, TriangulationOutcome::NotFlat);
}

#[test]
fn a_keyhole_only_touches_itself() {
    let square = |size: f32| [[size, size], [-size, size], [-size, -size], [size, -size]];
    let mut points = square(3.0).to_vec();
    points.push(points[0]);
    points.extend(square(1.0).iter().rev().cycle().skip(3).take(5));
    let ring = flat(&points);
    let (triangles, outcome) = triangulate(&ring);
    assert_eq!(outcome, TriangulationOutcome::Whole);
    assert!((area(&ring, &triangles) - 32.0).abs() < 1e-4);
}

#[test]
fn extreme_sizes_neither_overflow_nor_vanish() {
    for scale in [1e-38, 1e38] {
        let corners = flat(&[[0.0, 0.0], [scale, 0.0], [scale, scale], [0.5 * scale, 0.1 * scale], [0.0, scale]]);
        assert_eq!(triangulate(&corners).0.len(), 3);
    }
}

#[test]
fn a_comb_with_twenty_thousand_corners_is_whole() {
    let teeth = (0..10_000).flat_map(|i| [[i as f32, 0.0], [i as f32 + 0.5, 5.0]]);
    let corners: Vec<_> = teeth.chain([[10_000.0, -1.0], [0.0, -1.0]]).collect::<Vec<_>>();
    let reversed: Vec<_> = flat(&corners).into_iter().rev().collect();
    let (triangles, outcome) = triangulate(&reversed);
    assert_eq!((triangles.len(), outcome), (20_000, TriangulationOutcome::Whole));
}
