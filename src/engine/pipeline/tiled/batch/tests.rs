use super::super::layout::{SamplePlace, TILE_SAMPLES, TilePlace};
use super::*;
use crate::pipeline::depth::DepthScale;
use crate::pipeline::depth_format::DepthEncoding;
use crate::pipeline::grid::SampleGrid;
use crate::pipeline::settings::{Choice as _, FillRule};
use crate::scene::DepthMapping;

/// Tile in which the triangles are set up.
const PLACE: TilePlace = TilePlace { column: 3, row: 2, number: 0 };

/// Returns three random vertices near a position, at most `extent` steps of 1/256 px apart on each axis. Some of
/// their depths are often equal.
fn corners(random: &mut fastrand::Rng, around: [f64; 2], extent: i32) -> [PackedVertex; 3] {
    let place = around.map(|along| along as i32 + random.i32(-8192..8192));
    [(); 3].map(|()| {
        let position = place.map(|along| (along + random.i32(0..=extent)) as f32);
        let depth = if random.bool() { random.f64() } else { f64::from(random.u8(..3)) * 0.5 };
        PackedVertex::new(position, depth, 1.0, 0.0, [0.0; 2])
    })
}

/// Returns the exact edge values at an offset from the tile's first sample.
fn values<E: EdgeNumber>(triangle: &Setup<E>, [x, y]: [i64; 2]) -> [i64; 3] {
    let EdgeFunctions { a, b, c } = triangle.edges;
    std::array::from_fn(|i| a[i].double() as i64 * x + b[i].double() as i64 * y + c[i].double() as i64)
}

#[test]
fn integer_edges_fit_and_equal_the_double_edges_up_to_rotation() {
    let mut random = fastrand::Rng::with_seed(4);
    let (mut small, mut large) = (0, 0);
    let grids = [SampleGrid::Block { step: 1 }, SampleGrid::Block { step: 3 }, SampleGrid::Checkerboard];
    let linear = DepthScale::perspective(DepthMapping::LINEAR, DepthEncoding::F32, 0.1, 100.0);
    let scales = [(DepthScale::default(), false), (linear, true)];
    for (grid, lanes) in grids.into_iter().flat_map(|grid| Lanes::all().map(move |lanes| (grid, lanes))) {
        let offsets = [[-96, 32], [96, -32]];
        let centres = TileLattice::new(grid);
        let (lattice, sample) = (centres.with_samples(&offsets), centres.moved(offsets[1]));
        let origin = lattice.origin(PLACE);
        // Corners of the region in which edge values may be computed. It extends beyond the tile, because eight
        // columns and two rows are computed at a time, and is enlarged by at least the distance between the samples
        // of a pixel.
        let [right, _] = lattice.place(SamplePlace { column: TILE + LANES - 3, row: 2 });
        let [_, below] = lattice.place(SamplePlace { column: 0, row: TILE });
        let [left, right, below] = [-192, right + 384, below + 384].map(i64::from);
        let ends = [[left, left], [right, left], [left, below], [right, below]];
        for round in 0..400 {
            let vertices = [(); LANES].map(|()| corners(&mut random, origin.position, 1 << (round % 22)));
            let triangles = std::array::from_fn(|lane| vertices[lane].each_ref());
            let (mut batch, mut records) = (TriangleBatch::default(), [Record::default(); LANES]);
            let (rule, (scale, is_linear)) = (FillRule::ALL[round % FillRule::ALL.len()], &scales[round / 22 % 2]);
            let context = SetupContext { rule, scale, lattice: &lattice, origin };
            let vertices = BatchVertices { triangles: &triangles, divides_by_w: 0 };
            let (alive, _) = on_lanes!(lanes, simd => batch.set_up(simd, vertices, &mut records, &context));
            let (_, moved) = on_lanes!(lanes, simd => batch.moved(simd, &sample, origin.packed));
            for lane in (0..LANES).filter(|lane| alive >> lane & 1 != 0) {
                if !batch.fits(lane) {
                    large += 1;
                    continue;
                }
                small += 1;
                let doubles: (Setup<f64>, Setup<f64>) =
                    (batch.triangle(lane, Slot::NONE), moved.triangle(lane, Slot::NONE));
                let integers: (Setup<i32>, Setup<i32>) =
                    (batch.triangle(lane, Slot::NONE), moved.triangle(lane, Slot::NONE));
                let all = |of: [i64; 3]| of.into_iter().all(|value| i32::try_from(value).is_ok());
                assert!(ends.iter().all(|end| all(values(&doubles.0, *end)) && all(values(&doubles.1, *end))));
                let is_turned = |turn: &usize| {
                    (0..3).all(|i| {
                        ends.iter().all(|end| {
                            values(&integers.0, *end)[i] == values(&doubles.0, *end)[(i + turn) % 3]
                                && values(&integers.1, *end)[i] == values(&doubles.1, *end)[(i + turn) % 3]
                        })
                    })
                };
                let turn = (0..3).find(is_turned).expect("the integer edges are the double edges, rotated");
                for i in 0..3 {
                    assert_eq!(integers.0.rises[i], doubles.0.rises[(i + turn) % 3]);
                    assert_eq!(integers.0.inside[i].double(), doubles.0.inside[(i + turn) % 3]);
                }
                assert_eq!(integers.0.min_depth, doubles.0.min_depth);
                if *is_linear {
                    assert_eq!(turn, 0, "edges are not rotated if depth is linear in view space");
                } else {
                    assert_eq!(integers.0.rises[2], 0.0);
                }
            }
        }
    }
    assert!(small > 1000 && large > 500, "{small} triangles fit, {large} do not");
}

#[test]
fn triangles_that_miss_or_cover_the_tile_are_detected() {
    let mut random = fastrand::Rng::with_seed(6);
    let (mut missing, mut covering) = (0, 0);
    let grids = [SampleGrid::Block { step: 1 }, SampleGrid::Checkerboard];
    for (grid, lanes) in grids.into_iter().flat_map(|grid| Lanes::all().map(move |lanes| (grid, lanes))) {
        let offsets = [[-96, 32], [96, -32]];
        let centres = TileLattice::new(grid);
        for (lattice, offsets) in [(centres, &[[0; 2]][..]), (centres.with_samples(&offsets), &offsets[..])] {
            let origin = lattice.origin(PLACE);
            for round in 0..40 {
                let size = 1 << (15 + round % 4);
                let mut along = |from: f64| (from as i32 + random.i32(-size..size)) as f32;
                let mut corner = || PackedVertex::new(origin.position.map(&mut along), 0.5, 1.0, 0.0, [0.0; 2]);
                let vertices = [(); LANES].map(|()| [(); 3].map(|()| corner()));
                let triangles = std::array::from_fn(|lane| vertices[lane].each_ref());
                let (mut batch, mut records) = (TriangleBatch::default(), [Record::default(); LANES]);
                let (rule, scale) = (FillRule::ALL[round % FillRule::ALL.len()], DepthScale::default());
                let context = SetupContext { rule, scale: &scale, lattice: &lattice, origin };
                let batched = BatchVertices { triangles: &triangles, divides_by_w: 0 };
                let (alive, _) = on_lanes!(lanes, simd => batch.set_up(simd, batched, &mut records, &context));
                for (lane, vertices) in vertices.iter().enumerate() {
                    let corners = vertices.each_ref().map(SnappedVertex::from);
                    let boxed = Setup::new(Slot::NONE, &corners, &context);
                    let Some(triangle) = boxed else {
                        continue;
                    };
                    let covers = |place: [i32; 2]| {
                        let values = triangle.edges.at(place);
                        values.iter().zip(triangle.inside).all(|(value, least)| *value >= least)
                    };
                    let samples = || {
                        let all = (0..TILE_SAMPLES).map(SamplePlace::of);
                        all.map(|place| lattice.place(place))
                            .flat_map(|[x, y]| offsets.iter().map(move |[right, down]| [x + right, y + down]))
                    };
                    let is_alive = alive >> lane & 1 != 0;
                    assert!(is_alive || !samples().any(covers), "the triangle has a sample in the tile");
                    missing += usize::from(!is_alive);
                    if is_alive && batch.triangle::<f64>(lane, Slot::NONE).covers_tile {
                        covering += 1;
                        assert!(samples().all(covers), "the triangle does not cover all samples of the tile");
                    }
                }
            }
        }
    }
    assert!(missing > 100 && covering > 100, "{missing} miss the tile, {covering} cover it");
}
