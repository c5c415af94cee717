use super::*;
use crate::pipeline::settings::Arithmetic;

const SIDE: u32 = 48;
const PICTURE: Viewport = Viewport { width: SIDE, height: SIDE };

/// Number of grid steps per pixel in the reference: fine enough for all vertices of these tests, and for pixel centres.
const STEPS: f32 = 65_536.0;

/// Returns the pixels that a triangle covers, computed by three integer cross products per pixel.
fn truth(corners_px: [[f32; 2]; 3], rule: FillRule) -> Vec<(u32, u32)> {
    let corners = corners_px.map(|corner| corner.map(|c| (c * STEPS) as i128));
    let cross =
        |a: [i128; 2], b: [i128; 2], p: [i128; 2]| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
    let area = cross(corners[0], corners[1], corners[2]);
    let centre = |pixel: u32| i128::from(pixel) * STEPS as i128 + STEPS as i128 / 2;
    let inside = |x: u32, y: u32| {
        [(0, 1), (1, 2), (2, 0)].into_iter().all(|(from, to)| {
            let (a, b) = (corners[from], corners[to]);
            let value = cross(a, b, [centre(x), centre(y)]) * area.signum();
            let (right, down) = ((a[1] - b[1]) * area.signum(), (b[0] - a[0]) * area.signum());
            let owned = match rule {
                FillRule::TopLeft => right > 0 || (right == 0 && down > 0),
                FillRule::TopRight => right < 0 || (right == 0 && down > 0),
                FillRule::BottomLeft => right > 0 || (right == 0 && down < 0),
                FillRule::BottomRight => right < 0 || (right == 0 && down < 0),
                FillRule::Inclusive => true,
                FillRule::Exclusive => false,
            };
            value > 0 || (value == 0 && owned)
        })
    };
    let all = (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y)));
    if area == 0 { Vec::new() } else { all.filter(|(x, y)| inside(*x, *y)).collect() }
}

/// Returns the pixels of the spans in row-major order. Panics if a pixel is covered twice.
fn pixels(spans: &[Span]) -> Vec<(u32, u32)> {
    let mut pixels: Vec<_> = spans.iter().flat_map(|s| (s.left..s.right).map(|x| (x, s.row))).collect();
    pixels.sort_unstable_by_key(|(x, y)| (*y, *x));
    let count = pixels.len();
    pixels.dedup();
    assert_eq!(pixels.len(), count, "covered twice: {spans:?}");
    pixels
}

/// Returns random triangles whose vertices lie on a grid of `step` px. On a coarser grid, more pixel centres lie
/// exactly on edges.
fn triangles(seed: u64, count: usize, step: f32) -> impl Iterator<Item = [[f32; 2]; 3]> {
    let mut random = fastrand::Rng::with_seed(seed);
    std::iter::repeat_with(move || {
        let mut coordinate = || (random.f32() * 96.0 - 24.0) / step;
        let corners = [[0; 2]; 3].map(|corner| corner.map(|_: i32| coordinate().round() * step));
        // Make half of them slivers.
        let [a, b, c] = corners;
        if random.bool() { [a, b, c] } else { [a, b, [b[0] + (a[0] - c[0]).signum() * step, b[1]]] }
    })
    .take(count)
}

#[test]
fn all_algorithms_find_the_same_pixels_in_fixed_and_in_exact_arithmetic() {
    for step in [0.5, 1.0 / 256.0] {
        for corners in triangles(3, 150, step) {
            for rule in FillRule::ALL {
                let expected = truth(corners, *rule);
                for rasterizer in Rasterizer::correct() {
                    for arithmetic in [Arithmetic::Fixed, Arithmetic::Exact] {
                        let found = pixels(&cover(rasterizer, arithmetic, corners, *rule, PICTURE));
                        assert_eq!(found, expected, "{rasterizer:?} {arithmetic:?} {rule:?} {corners:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn exact_arithmetic_needs_no_grid() {
    for corners in triangles(5, 150, 1.0 / 65_536.0) {
        let expected = truth(corners, FillRule::TopLeft);
        for rasterizer in Rasterizer::correct() {
            let found = pixels(&cover(rasterizer, Arithmetic::Exact, corners, FillRule::TopLeft, PICTURE));
            assert_eq!(found, expected, "{rasterizer:?} {corners:?}");
        }
    }
}

#[test]
fn floats_are_right_where_they_resolve_the_numbers() {
    // With vertices on half pixels, every product is small and exact, so any difference is an error of the algorithm.
    // Algorithms that step by a rounded slope drift and are not tested.
    for corners in triangles(7, 300, 0.5) {
        let expected = truth(corners, FillRule::TopLeft);
        for rasterizer in [Rasterizer::BoundingBox, Rasterizer::Tiled] {
            for arithmetic in [Arithmetic::F32, Arithmetic::F64] {
                let found = pixels(&cover(rasterizer, arithmetic, corners, FillRule::TopLeft, PICTURE));
                assert_eq!(found, expected, "{rasterizer:?} {arithmetic:?} {corners:?}");
            }
        }
    }
}

#[test]
fn two_triangles_of_a_shared_edge_draw_each_pixel_once_in_every_arithmetic() {
    let mut random = fastrand::Rng::with_seed(13);
    for _ in 0..100 {
        // Four triangles that share the vertex `pin` inside the picture and together cover all of it.
        let pin = [[0; 2]; 1].map(|p| p.map(|_: i32| random.f32() * SIDE as f32))[0];
        let (low, high) = (-50.0 - random.f32(), SIDE as f32 + 50.0 + random.f32());
        let around = [[low, low], [high, low], [high, high], [low, high]];
        for rasterizer in Rasterizer::correct() {
            for arithmetic in Arithmetic::ALL {
                let spans: Vec<Span> = (0..4)
                    .flat_map(|i| {
                        cover(
                            rasterizer,
                            *arithmetic,
                            [pin, around[i], around[(i + 1) % 4]],
                            FillRule::TopLeft,
                            PICTURE,
                        )
                    })
                    .collect();
                assert_eq!(pixels(&spans).len(), (SIDE * SIDE) as usize, "{rasterizer:?} {arithmetic:?} {pin:?}");
            }
        }
    }
}

#[test]
fn what_a_pixel_shows_does_not_depend_on_the_scissor() {
    for corners in triangles(17, 60, 1.0 / 4096.0) {
        for rasterizer in Rasterizer::ALL {
            for arithmetic in Arithmetic::ALL {
                with_arithmetic!(*arithmetic, N => {
                    let Some(triangle) = RasterTriangle::<N>::new(corners, FillRule::TopLeft) else { continue };
                    let run = |grid, scissor| {
                        let mut spans = Vec::new();
                        cover_samples(*rasterizer, &triangle, corners, SampleArea { grid, scissor }, &mut spans);
                        let samples = spans.iter().flat_map(|s| (s.left..s.right).map(|column| (column, s.row)));
                        let mut pixels: Vec<_> = samples.map(|(column, row)| grid.pixel(column, row)).collect();
                        pixels.sort_unstable();
                        pixels
                    };
                    let whole = run(SampleGrid::FULL, Scissor::full(SIDE, SIDE));
                    let alone = (0..SIDE)
                        .flat_map(|x| (0..SIDE).map(move |y| (x, y)))
                        .filter(|(x, y)| !run(SampleGrid::FULL, Scissor::pixel(*x, *y)).is_empty());
                    assert_eq!(alone.collect::<Vec<_>>(), whole, "{rasterizer:?} {arithmetic:?} {corners:?}");
                    for grid in [SampleGrid::Block { step: 4 }, SampleGrid::Checkerboard, SampleGrid::OddCheckerboard] {
                        let drawn = whole.iter().copied().filter(|(x, y)| grid.sample_at(*x, *y).is_some());
                        let sparse = run(grid, Scissor::full(SIDE, SIDE));
                        assert_eq!(sparse, drawn.collect::<Vec<_>>(), "{grid:?} {rasterizer:?} {arithmetic:?} {corners:?}");
                    }
                });
            }
        }
    }
}

#[test]
fn bands_of_rows_give_the_spans_of_the_whole_picture_in_the_same_order() {
    let viewport = Viewport { width: 70, height: 5 * BAND_ROWS / 2 };
    let far = [[[-3e38, -1.0], [3e38, 70.0], [5.0, 3e38]], [[f32::NAN, 0.0], [9.0, 9.0], [1.0, 90.0]]];
    let corners = triangles(29, 150, 1.0 / 64.0).map(|corners| corners.map(|[x, y]| [x, y * 2.0]));
    let mut several = 0;
    for corners in corners.chain(far) {
        for rasterizer in Rasterizer::ALL {
            for arithmetic in Arithmetic::ALL {
                let (mut spans, mut bands) = (Vec::new(), 0);
                let mut take = |band: &[Span], _| {
                    spans.extend_from_slice(band);
                    bands += 1;
                    Ok::<_, ()>(())
                };
                let (rasterizer, arithmetic, fill_rule) = (*rasterizer, *arithmetic, FillRule::TopLeft);
                let rules = CoverageRules { rasterizer, arithmetic, fill_rule };
                rules.cover_in_bands(corners, viewport, &mut take).unwrap();
                let whole = cover(rasterizer, arithmetic, corners, fill_rule, viewport);
                assert_eq!(spans, whole, "{rasterizer:?} {arithmetic:?} {corners:?}");
                several += u32::from(bands > 1);
            }
        }
    }
    assert!(several > 100, "only {several} drawn in several bands");
}

#[test]
fn edge_values_sum_to_the_doubled_area_everywhere() {
    for corners in triangles(19, 100, 1.0 / 256.0) {
        for arithmetic in Arithmetic::ALL {
            with_arithmetic!(*arithmetic, N => {
                let Some(triangle) = RasterTriangle::<N>::new(corners, FillRule::TopLeft) else { continue };
                for pixel in [(0, 0), (17, 31), (47, 5)] {
                    let sum: f64 = triangle.sample(pixel, pixel).edges.iter().sum();
                    // Bound on the rounding errors of products of coordinates up to 2⁷ px, in the unit of the doubled
                    // area.
                    let (area, scale) = super::doubled_area(*arithmetic, corners);
                    let unit = if *arithmetic == Arithmetic::F32 { f64::from(f32::EPSILON) } else { f64::EPSILON };
                    let slack = if *arithmetic == Arithmetic::Fixed { 0.0 } else { 3.0 * unit * scale * 32_768.0 };
                    let off = (sum - triangle.doubled_area()).abs();
                    assert!(off <= slack, "{arithmetic:?} {corners:?}: {off} of {area} × {scale}");
                }
            });
        }
    }
}

#[test]
fn extreme_corners_give_consistent_coverage() {
    let hostile = [f32::NAN, f32::INFINITY, f32::MAX, f32::MIN, 1e30, -1e30, 1e-45, -0.0, f32::MIN_POSITIVE, 1e7, 20.3];
    let mut random = fastrand::Rng::with_seed(23);
    for _ in 0..2000 {
        let corners = [[0; 2]; 3].map(|corner| corner.map(|_: i32| hostile[random.usize(..hostile.len())]));
        for arithmetic in Arithmetic::ALL {
            let sets =
                Rasterizer::ALL.iter().map(|r| pixels(&cover(*r, *arithmetic, corners, FillRule::TopLeft, PICTURE)));
            let sets: Vec<_> = sets.collect();
            if matches!(arithmetic, Arithmetic::Fixed | Arithmetic::Exact) {
                let sound = Rasterizer::correct().count();
                assert!(sets[..sound].windows(2).all(|pair| pair[0] == pair[1]), "{arithmetic:?} {corners:?}");
            }
            if !corners.as_flattened().iter().all(|c| c.is_finite()) {
                assert!(sets.iter().all(Vec::is_empty), "{corners:?}");
            }
        }
    }
}

#[test]
fn large_triangles_are_the_same_in_fixed_point_and_beyond_its_reach() {
    // Two edges at 45° from (24, 24) to vertices at 2³⁰ px, far beyond the range of 64-bit edge functions. Both are
    // left edges and own the pixel centres exactly on them.
    let far = 1_073_741_824.0;
    let corners = [[24.0, 24.0], [far, far], [far, -far]];
    let inside = |x: u32, y: u32| (2 * i64::from(x) - 47) >= (2 * i64::from(y) - 47).abs();
    let expected: Vec<_> =
        (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y))).filter(|(x, y)| inside(*x, *y)).collect();
    for rasterizer in Rasterizer::correct() {
        let found = pixels(&cover(rasterizer, Arithmetic::Fixed, corners, FillRule::TopLeft, PICTURE));
        assert_eq!(found, expected, "{rasterizer:?}");
    }
}

#[test]
fn work_is_bounded_by_what_an_algorithm_promises() {
    let corners = [[1.0, 1.0], [47.0, 1.5], [1.5, 47.0]];
    let visits = |rasterizer| {
        let triangle = RasterTriangle::<Fixed>::new(corners, FillRule::TopLeft).unwrap();
        let area = SampleArea { grid: SampleGrid::FULL, scissor: Scissor::full(SIDE, SIDE) };
        let mut spans = Vec::new();
        let visited = cover_samples(rasterizer, &triangle, corners, area, &mut spans);
        (visited, pixels(&spans).len() as u64)
    };
    let (boxed, covered) = visits(Rasterizer::BoundingBox);
    assert!(boxed > covered);
    assert_eq!(visits(Rasterizer::Scanline).0, covered);
    assert_eq!(visits(Rasterizer::ActiveEdge).0, covered);
    let (walked, _) = visits(Rasterizer::EdgeWalk);
    assert!(walked >= covered && walked <= covered + u64::from(SIDE), "one sample beyond the end of each row");
    assert!(visits(Rasterizer::Tiled).0 < boxed);
}
