//! Setup of triangles in a tile, eight at a time, with edge functions both in f64 and in i32.

use super::edge_number::EdgeNumber;
use super::geometry::PackedVertex;
use super::lattice::{TILE, TileLattice};
use super::record::{Record, Slot};
use super::setup::{EdgeFunctions, Origin, Setup, SnappedVertex, inside_thresholds};
use crate::math::lanes::*;
use crate::pipeline::depth::DepthScale;
use crate::pipeline::settings::FillRule;

/// Edge functions a·x + b·y + c of eight triangles, indexed by edge and lane.
#[derive(Clone, Debug, Default)]
#[repr(align(32))]
struct EdgeArrays<E> {
    a: [[E; LANES]; 3],
    b: [[E; LANES]; 3],
    c: [[E; LANES]; 3],
    /// Inside threshold: the least edge value that counts as inside the triangle.
    inside: [[E; LANES]; 3],
}

/// Batch of eight triangles that are set up together with SIMD.
#[derive(Clone, Debug, Default)]
#[repr(align(32))]
pub(super) struct TriangleBatch {
    doubles: EdgeArrays<f64>,
    integers: EdgeArrays<i32>,
    /// Bit mask of the triangles whose edge values fit into 32-bit integers in the whole tile.
    fit: u64,
    /// Minimum vertex depth of each triangle, including the depth bias.
    least: [f64; LANES],
    /// Maximum vertex depth of each triangle, including the depth bias.
    greatest: [f64; LANES],
    /// Depth terms of each edge (see [`Setup::rises`]): first in the edge order of `doubles`, then in the edge order of
    /// `integers`.
    rises: [[[f64; LANES]; 3]; 2],
    inv_w: [[f64; LANES]; 3],
    columns: [[i32; LANES]; 2],
    rows: [[i32; LANES]; 2],
    /// Bit mask of the triangles that cover all samples of the tile.
    cover_tile: u64,
    /// Bounding boxes: minimum and maximum coordinate along each axis, in steps of 1/256 px. Only valid if pixels have
    /// several samples.
    boxes: [[[f32; LANES]; 2]; 2],
}

/// Batch of triangles that are set up for one tile.
pub(super) trait Triangles {
    /// Returns `true` if the edge values of a triangle fit into 32-bit integers at all samples of the tile.
    fn fits(&self, lane: usize) -> bool;

    /// Returns the setup of one triangle. `E` may be `i32` only if [`Triangles::fits`] returns `true`.
    fn triangle<E: EdgeNumber>(&self, lane: usize, slot: Slot) -> Setup<E>;
}

impl TriangleBatch {
    /// Sets up eight triangles like [`Setup::new`], with edge functions in f64 and in i32, and fills their records.
    ///
    /// Returns two bit masks. The first selects the triangles that may cover a sample of the tile. The second selects
    /// those among them whose edge values may exceed 32 bits, either at a sample that they cover or at another sample
    /// of the same pixel.
    #[inline(never)]
    #[expect(
        clippy::too_many_arguments,
        reason = "eight triangles, their records, and the data common to all triangles"
    )]
    pub(super) fn set_up<S: Simd>(
        &mut self,
        simd: S,
        triangles: &[[&PackedVertex; 3]; LANES],
        (records, divides_by_w): (&mut [Record; LANES], u64),
        rule: FillRule,
        scale: &DepthScale,
        lattice: &TileLattice,
        (origin, first): Origin,
    ) -> (u64, u64) {
        simd.vectorize(
            #[inline(always)]
            || {
                let vertices = each!(corner in [0, 1, 2] => {
                    each!(lane in [0, 1, 2, 3, 4, 5, 6, 7] => triangles[lane][corner])
                });
                let corners = each!(corner in [0, 1, 2] => PackedVertex::positions_and_depths(simd, &vertices[corner]));
                let boxes = each!(axis in [0, 1] => {
                    let [a, b, c] = each!(i in [0, 1, 2] => corners[i].0[axis]);
                    [a.min(b).min(c), a.max(b).max(c)]
                });
                let mut alive = ranges_lanes(simd, boxes, lattice, first, [&mut self.columns, &mut self.rows]);
                let p =
                    each!(i in [0, 1, 2] => each!(axis in [0, 1] => widen(simd, corners[i].0[axis]) - origin[axis]));
                let area = (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[2][0] - p[0][0]) * (p[1][1] - p[0][1]);
                alive &= area.simd_ne(0.0).to_bitmask();
                if alive == 0 {
                    return (0, 0);
                }
                let turned = area.simd_lt(0.0);
                let doubled_area = area.abs();
                let zero_and_one = [F64::splat(simd, 0.0), F64::splat(simd, 1.0)];
                // These bounds are sums of magnitudes, so they also hold for every partial sum, in any order of
                // addition.
                let (mut greatest_value, mut greatest_in_tile) = (doubled_area, zero_and_one[0]);
                for (i, (from, to)) in [(1, 2), (2, 0), (0, 1)].into_iter().enumerate() {
                    let (a, b) = (p[from][1] - p[to][1], p[to][0] - p[from][0]);
                    let (a, b) = (turned.select(-a, a), turned.select(-b, b));
                    let c = -(a * p[from][0] + b * p[from][1]);
                    a.store_array(&mut self.doubles.a[i]);
                    b.store_array(&mut self.doubles.b[i]);
                    c.store_array(&mut self.doubles.c[i]);
                    inside_thresholds(zero_and_one, a, b, rule).store_array(&mut self.doubles.inside[i]);
                    let steepness = a.abs() + b.abs();
                    greatest_value = greatest_value.max(doubled_area + steepness * lattice.extent());
                    greatest_in_tile = greatest_in_tile.max(c.abs() + steepness * lattice.farthest());
                }
                self.cover_tile = 0;
                if self.fill_a_box(simd) {
                    let [meet, cover] = self.doubles.in_tile(simd, lattice);
                    (alive, self.cover_tile) = (alive & meet, cover);
                }
                self.fit = greatest_in_tile.simd_lt(f64::from(i32::MAX)).to_bitmask();
                let depths = each!(i in [0, 1, 2] => corners[i].1);
                let least = depths[0].min(depths[1]).min(depths[2]);
                least.store_array(&mut self.least);
                depths[0].max(depths[1]).max(depths[2]).store_array(&mut self.greatest);
                if scale.is_biased() {
                    self.offset_depths(triangles, scale);
                }
                let mut rises = each!(i in [0, 1, 2] => depths[i] - least);
                let is_least = if scale.is_linear_in_space() {
                    self.inv_w = each!(corner in [0, 1, 2] => {
                        each!(lane in [0, 1, 2, 3, 4, 5, 6, 7] => triangles[lane][corner].inv_w().into())
                    });
                    [mask64x8::from_bitmask(simd, 0); 2]
                } else {
                    rises = each!(i in [0, 1, 2] => rises[i] / doubled_area);
                    each!(i in [0, 1] => depths[i].simd_eq(least))
                };
                let in_turn = rotated(is_least, rises);
                for i in 0..3 {
                    rises[i].store_array(&mut self.rises[0][i]);
                    in_turn[i].store_array(&mut self.rises[1][i]);
                }
                let positions = each!(i in [0, 1, 2] => corners[i].0);
                let (edges, area) = integer_edges(simd, positions, origin, turned.to_bitmask());
                let attributes = each!(corner in [0, 1, 2] => PackedVertex::attributes(simd, &vertices[corner]));
                Record::fill_eight(simd, records, [edges[0], edges[1]], area, attributes, divides_by_w);
                let is_least = each!(i in [0, 1] => mask32x8::from_bitmask(simd, is_least[i].to_bitmask()));
                let edges = each!(term in [0, 1, 2] => {
                    rotated(is_least, each!(i in [0, 1, 2] => edges[i][term]))
                });
                self.integers.fill(simd, edges, rule);
                if lattice.extent() > 0.0 {
                    self.boxes = each!(axis in [0, 1] => each!(end in [0, 1] => boxes[axis][end].to_array()));
                }
                (alive, alive & greatest_value.simd_gt(f64::from(i32::MAX)).to_bitmask())
            },
        )
    }

    /// Adds the depth bias of each triangle to its minimum and maximum depth.
    #[cold]
    fn offset_depths(&mut self, triangles: &[[&PackedVertex; 3]; LANES], scale: &DepthScale) {
        for (lane, vertices) in triangles.iter().enumerate() {
            let corners = vertices.map(SnappedVertex::from);
            let offset = scale.offset(corners.map(|c| c.position_px()), corners.map(|c| c.depth));
            self.least[lane] += offset;
            self.greatest[lane] += offset;
        }
    }

    /// Counts the large triangles among those selected by `alive`. A triangle is large if it spans more than `least`
    /// columns or rows of samples.
    pub(super) fn count_large(&self, alive: u64, least: i32) -> u32 {
        let reaches = |range: &[[i32; LANES]; 2], lane: usize| range[1][lane] - range[0][lane] >= least;
        let is_large = |lane: &usize| reaches(&self.columns, *lane) || reaches(&self.rows, *lane);
        (0..LANES).filter(|lane| alive >> lane & 1 != 0).filter(is_large).count() as u32
    }

    /// Returns `true` if the bounding box of any triangle contains the whole tile.
    #[inline(always)]
    fn fill_a_box<S: Simd>(&self, simd: S) -> bool {
        let [columns, rows] = each!(ranges in [&self.columns, &self.rows] => each!(end in [0, 1] => i32x8::load_array(simd, ranges[end])));
        let last = columns[1].min(rows[1]);
        (columns[0].max(rows[0]).simd_eq(0) & last.simd_eq((TILE - 1) as i32)).any_true()
    }

    /// Translates the batch to a lattice with another sample offset. Returns the bit mask of the triangles that may
    /// cover a sample of the tile, and the translated batch. The translated batch differs from this one only in the
    /// constant terms of the edge functions and in the sample ranges.
    #[inline(always)]
    pub(super) fn moved<S: Simd>(&self, simd: S, lattice: &TileLattice, first: [f32; 2]) -> (u64, MovedBatch<'_>) {
        let boxes = each!(axis in [0, 1] => each!(end in [0, 1] => F32::load_array_ref(simd, &self.boxes[axis][end])));
        let [mut columns, mut rows] = [[[0; LANES]; 2]; 2];
        let alive = ranges_lanes(simd, boxes, lattice, first, [&mut columns, &mut rows]);
        let c = (self.doubles.moved(simd, lattice), self.integers.moved(simd, lattice));
        (alive, MovedBatch { batch: self, c, columns, rows })
    }
}

impl Triangles for TriangleBatch {
    #[inline(always)]
    fn fits(&self, lane: usize) -> bool {
        self.fit >> lane & 1 != 0
    }

    #[inline(always)]
    fn triangle<E: EdgeNumber>(&self, lane: usize, slot: Slot) -> Setup<E> {
        let Self { doubles, integers, .. } = self;
        let edges = EdgeFunctions {
            a: of_lane(E::pick(&doubles.a, &integers.a), lane),
            b: of_lane(E::pick(&doubles.b, &integers.b), lane),
            c: of_lane(E::pick(&doubles.c, &integers.c), lane),
        };
        Setup {
            slot,
            edges,
            inside: of_lane(E::pick(&doubles.inside, &integers.inside), lane),
            min_depth: self.least[lane],
            rises: of_lane(&self.rises[usize::from(E::LAST_HAS_MIN_DEPTH)], lane),
            max_depth: self.greatest[lane],
            inv_w: of_lane(&self.inv_w, lane),
            columns: range_of(&self.columns, lane),
            rows: range_of(&self.rows, lane),
            covers_tile: self.cover_tile >> lane & 1 != 0,
        }
    }
}

impl EdgeArrays<f64> {
    /// Returns two bit masks: the triangles that may cover a sample of the tile, and the triangles that cover all
    /// samples of all pixels of the tile.
    #[inline(always)]
    fn in_tile<S: Simd>(&self, simd: S, lattice: &TileLattice) -> [u64; 2] {
        let [width, height] = lattice.tile_extent();
        let (mut meet, mut cover) = (u64::MAX, u64::MAX);
        for i in 0..3 {
            let [a, b, c, inside] =
                each!(of in [&self.a, &self.b, &self.c, &self.inside] => F64::load_array_ref(simd, &of[i]));
            let beyond = (a.abs() + b.abs()) * lattice.extent();
            let least = c + a.min(0.0) * width + b.min(0.0) * height - beyond;
            let greatest = c + a.max(0.0) * width + b.max(0.0) * height + beyond;
            meet &= greatest.simd_ge(inside).to_bitmask();
            cover &= least.simd_ge(inside).to_bitmask();
        }
        [meet, cover]
    }
}

impl EdgeArrays<i32> {
    /// Stores edge functions, given as a, b and c of all three edges, and computes their inside thresholds.
    #[inline(always)]
    fn fill<S: Simd>(&mut self, simd: S, [a, b, c]: [[i32x8<S>; 3]; 3], rule: FillRule) {
        let zero_and_one = [i32x8::splat(simd, 0), i32x8::splat(simd, 1)];
        for i in 0..3 {
            a[i].store_array(&mut self.a[i]);
            b[i].store_array(&mut self.b[i]);
            c[i].store_array(&mut self.c[i]);
            inside_thresholds(zero_and_one, a[i], b[i], rule).store_array(&mut self.inside[i]);
        }
    }
}

impl<E: EdgeNumber> EdgeArrays<E> {
    /// Returns the constant terms c of the edge functions, translated to a lattice with another sample offset.
    #[inline(always)]
    fn moved<S: Simd>(&self, simd: S, lattice: &TileLattice) -> [[E; LANES]; 3] {
        let [right, down] = lattice.offset().map(E::of);
        each!(i in [0, 1, 2] => {
            let [a, b, c] = each!(of in [&self.a, &self.b, &self.c] => E::load(simd, &of[i]));
            E::store(a * right + b * down + c)
        })
    }
}

/// Batch of triangles that is translated to a lattice with another sample offset.
#[derive(Debug)]
#[repr(align(32))]
pub(super) struct MovedBatch<'a> {
    batch: &'a TriangleBatch,
    c: ([[f64; LANES]; 3], [[i32; LANES]; 3]),
    columns: [[i32; LANES]; 2],
    rows: [[i32; LANES]; 2],
}

impl Triangles for MovedBatch<'_> {
    #[inline(always)]
    fn fits(&self, lane: usize) -> bool {
        self.batch.fits(lane)
    }

    #[inline(always)]
    fn triangle<E: EdgeNumber>(&self, lane: usize, slot: Slot) -> Setup<E> {
        let mut triangle = self.batch.triangle::<E>(lane, slot);
        triangle.edges.c = of_lane(E::pick(&self.c.0, &self.c.1), lane);
        triangle.columns = range_of(&self.columns, lane);
        triangle.rows = range_of(&self.rows, lane);
        triangle
    }
}

/// Returns the three values (one per edge or per vertex) of the triangle in lane `lane`.
#[inline(always)]
fn of_lane<T: Copy>(values: &[[T; LANES]; 3], lane: usize) -> [T; 3] {
    each!(i in [0, 1, 2] => values[i][lane])
}

/// Rotates the three values of a lane so that one of them becomes the last: the first value in lanes that the first
/// mask selects, and the second value in lanes that only the second mask selects. All other lanes are unchanged.
#[inline(always)]
fn rotated<S: Simd, V: SimdBase<S>>([first, second]: [V::Mask; 2], [a, b, c]: [V; 3]) -> [V; 3] {
    each!((of_first, of_second, of_third) in [(b, c, a), (c, a, b), (a, b, c)] => {
        first.select(of_first, second.select(of_second, of_third))
    })
}

/// Returns the first and last column or row of the triangle in a lane.
#[inline(always)]
fn range_of(ranges: &[[i32; LANES]; 2], lane: usize) -> [usize; 2] {
    [ranges[0][lane] as usize, ranges[1][lane] as usize]
}

/// Computes the columns and rows of a tile in which each of eight triangles may cover samples. `boxes` are the bounding
/// boxes of the triangles in steps of 1/256 px. Returns the bit mask of the triangles with nonempty ranges.
#[inline(always)]
fn ranges_lanes<S: Simd>(
    simd: S,
    boxes: [[F32<S>; 2]; 2],
    lattice: &TileLattice,
    first: [f32; 2],
    ranges: [&mut [[i32; LANES]; 2]; 2],
) -> u64 {
    let mut alive = u64::MAX;
    for (axis, out) in ranges.into_iter().enumerate() {
        let [from, to] = lattice.range_lanes(simd, axis, boxes[axis][0], boxes[axis][1]);
        let (from, to) = ((from - first[axis]).max(0.0), (to - first[axis]).min((TILE - 1) as f32));
        alive &= from.simd_le(to).to_bitmask();
        from.to_int::<i32x8<S>>().store_array(&mut out[0]);
        to.to_int::<i32x8<S>>().store_array(&mut out[1]);
    }
    alive
}

/// Returns a, b and c of the edge functions of eight triangles, and their doubled areas, all as the low 32 bits of the
/// exact integers. Vertex positions are in steps of 1/256 px.
#[inline(always)]
fn integer_edges<S: Simd>(
    simd: S,
    corners: [[F32<S>; 2]; 3],
    origin: [f64; 2],
    turned: u64,
) -> ([[i32x8<S>; 3]; 3], i32x8<S>) {
    let p =
        each!(i in [0, 1, 2] => each!(axis in [0, 1] => corners[i][axis].to_int::<i32x8<S>>() - origin[axis] as i32));
    let turned = mask32x8::from_bitmask(simd, turned);
    let [first, second] = each!((from, to) in [(1, 2), (2, 0)] => {
        let (from, to) = (p[from], p[to]);
        let (a, b) = (from[1] - to[1], to[0] - from[0]);
        let (a, b) = (turned.select(-a, a), turned.select(-b, b));
        [a, b, -(a * from[0] + b * from[1])]
    });
    let area = (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[2][0] - p[0][0]) * (p[1][1] - p[0][1]);
    let area = turned.select(-area, area);
    // Edge values sum to the doubled area everywhere, so the third edge follows from the other two.
    let zero = i32x8::splat(simd, 0);
    let third = each!((of_all, i) in [(zero, 0), (zero, 1), (area, 2)] => of_all - first[i] - second[i]);
    ([first, second, third], area)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::depth::DepthEncoding;
    use crate::pipeline::grid::SampleGrid;
    use crate::pipeline::settings::Choice as _;
    use crate::scene::DepthMapping;

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
            let (origin, first) = (lattice.origin((3, 2)), [3.0 * TILE as f32, 2.0 * TILE as f32]);
            // Corners of the region in which edge values may be computed. It extends beyond the tile, because eight
            // columns and two rows are computed at a time, and is enlarged by at least the distance between the samples
            // of a pixel.
            let [right, _] = lattice.place((TILE + LANES - 3, 2));
            let [_, below] = lattice.place((0, TILE));
            let [left, right, below] = [-192, right + 384, below + 384].map(i64::from);
            let ends = [[left, left], [right, left], [left, below], [right, below]];
            for round in 0..400 {
                let vertices = [(); LANES].map(|()| corners(&mut random, origin, 1 << (round % 22)));
                let triangles = std::array::from_fn(|lane| vertices[lane].each_ref());
                let (mut batch, mut records) = (TriangleBatch::default(), [Record::default(); LANES]);
                let (rule, (scale, is_linear)) = (FillRule::ALL[round % FillRule::ALL.len()], &scales[round / 22 % 2]);
                let (alive, _) = on_lanes!(lanes, simd => {
                    batch.set_up(simd, &triangles, (&mut records, 0), rule, scale, &lattice, (origin, first))
                });
                let (_, moved) = on_lanes!(lanes, simd => batch.moved(simd, &sample, first));
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
                let (origin, first) = (lattice.origin((3, 2)), [3.0 * TILE as f32, 2.0 * TILE as f32]);
                for round in 0..40 {
                    let size = 1 << (15 + round % 4);
                    let mut along = |from: f64| (from as i32 + random.i32(-size..size)) as f32;
                    let mut corner = || PackedVertex::new(origin.map(&mut along), 0.5, 1.0, 0.0, [0.0; 2]);
                    let vertices = [(); LANES].map(|()| [(); 3].map(|()| corner()));
                    let triangles = std::array::from_fn(|lane| vertices[lane].each_ref());
                    let (mut batch, mut records) = (TriangleBatch::default(), [Record::default(); LANES]);
                    let (rule, scale) = (FillRule::ALL[round % FillRule::ALL.len()], DepthScale::default());
                    let (alive, _) = on_lanes!(lanes, simd => {
                        batch.set_up(simd, &triangles, (&mut records, 0), rule, &scale, &lattice, (origin, first))
                    });
                    for (lane, vertices) in vertices.iter().enumerate() {
                        let corners = vertices.each_ref().map(SnappedVertex::from);
                        let boxed = Setup::new(Slot::NONE, &corners, rule, &scale, &lattice, (origin, first));
                        let Some(triangle) = boxed else {
                            continue;
                        };
                        let covers = |place: [i32; 2]| {
                            let values = triangle.edges.at(place);
                            values.iter().zip(triangle.inside).all(|(value, least)| *value >= least)
                        };
                        let samples = || {
                            let all = (0..TILE).flat_map(|row| (0..TILE).map(move |column| (column, row)));
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
}
