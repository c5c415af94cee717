//! Setup of triangles in a tile, eight at a time, with edge functions both in f64 and in i32.

use super::edge_number::EdgeNumber;
use super::lattice::TileLattice;
use super::layout::{BLOCK, TILE};
use super::packed::PackedVertex;
use super::record::{IntegerEdges, Record};
use super::setup::{EdgeFunctions, Setup, SetupContext, SnappedVertex, inside_thresholds};
use super::slot::Slot;
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

/// Vertices of the triangles in a batch.
#[derive(Clone, Copy, Debug)]
pub(super) struct BatchVertices<'a> {
    pub(super) triangles: &'a [[&'a PackedVertex; 3]; LANES],
    /// Bit mask of the triangles with perspective division.
    pub(super) divides_by_w: u64,
}

/// Number of triangle batches whose vertices are fetched together.
pub(super) const BATCHES: usize = 4;

/// Number of triangles in [`BATCHES`] batches.
pub(super) const GROUP: usize = BATCHES * LANES;

/// Group of up to [`GROUP`] triangles of a tile, after setup.
#[derive(Clone, Debug, Default)]
pub(super) struct TriangleGroup {
    /// Index of the group's first triangle in the bin of the tile.
    pub(super) first: usize,
    pub(super) batches: [TriangleBatch; BATCHES],
    /// For each batch, the bit mask of the triangles that may cover a sample of the tile.
    pub(super) alive: [u64; BATCHES],
    /// For each batch, the bit mask of the triangles whose edge values may exceed 32 bits.
    pub(super) large: [u64; BATCHES],
}

/// Number of triangles in a tile at or above which hierarchical Z is disabled, unless most of them are large.
const HIZ_MAX_TRIANGLES: usize = 96;

/// Number of columns or rows above which a triangle counts as large: the width of two blocks.
const LARGE: i32 = 2 * BLOCK as i32;

impl TriangleGroup {
    /// Returns the slot of a triangle, given by the number of its batch and its lane.
    #[inline(always)]
    pub(super) fn slot(&self, batch: usize, lane: usize) -> Slot {
        Slot::new(self.first + batch * LANES + lane, self.large[batch] >> lane & 1 != 0)
    }

    /// Returns `true` if a tile with this number of triangles uses hierarchical Z, that is, keeps depth bounds of its
    /// blocks. The decision depends on the sizes of the first triangles of the tile, which are those of this group.
    #[inline(always)]
    pub(super) fn uses_hiz(&self, triangles: usize) -> bool {
        let Self { batches, alive, .. } = self;
        let large = || batches.iter().zip(alive).map(|(batch, alive)| batch.count_large(*alive, LARGE)).sum::<u32>();
        triangles < HIZ_MAX_TRIANGLES || 2 * large() > alive.iter().map(|alive| alive.count_ones()).sum()
    }
}

/// Batch of triangles that are set up for one tile.
pub(super) trait Triangles {
    /// Returns `true` if the edge values of a triangle fit into 32-bit integers at all samples of the tile.
    fn fits(&self, lane: usize) -> bool;

    /// Returns the setup of one triangle. `E` may be `i32` only if [`Triangles::fits`] returns `true`.
    fn triangle<E: EdgeNumber>(&self, lane: usize, slot: Slot) -> Setup<E>;
}

/// Triangle of a batch.
#[derive(Debug)]
pub(super) struct BinnedTriangle<'a, B> {
    pub(super) batch: &'a B,
    pub(super) lane: usize,
    pub(super) slot: Slot,
}

impl<B: Triangles> BinnedTriangle<'_, B> {
    /// Returns `true` if the edge values fit into 32-bit integers at all samples of the tile.
    #[inline(always)]
    pub(super) fn fits(&self) -> bool {
        self.batch.fits(self.lane)
    }

    /// Returns the setup of the triangle. `E` may be `i32` only if [`BinnedTriangle::fits`] returns `true`.
    #[inline(always)]
    pub(super) fn setup<E: EdgeNumber>(&self) -> Setup<E> {
        self.batch.triangle(self.lane, self.slot)
    }
}

impl TriangleBatch {
    /// Sets up eight triangles like [`Setup::new`], with edge functions in f64 and in i32, and fills their records.
    ///
    /// Returns two bit masks. The first selects the triangles that may cover a sample of the tile. The second selects
    /// those among them whose edge values may exceed 32 bits, either at a sample that they cover or at another sample
    /// of the same pixel.
    #[inline(never)]
    pub(super) fn set_up<S: Simd>(
        &mut self,
        simd: S,
        BatchVertices { triangles, divides_by_w }: BatchVertices<'_>,
        records: &mut [Record; LANES],
        context: &SetupContext<'_>,
    ) -> (u64, u64) {
        simd.vectorize(
            #[inline(always)]
            || {
                let SetupContext { rule, scale, lattice, origin } = *context;
                let vertices = each!(corner in [0, 1, 2] => {
                    each!(lane in [0, 1, 2, 3, 4, 5, 6, 7] => triangles[lane][corner])
                });
                let corners = each!(corner in [0, 1, 2] => PackedVertex::positions_and_depths(simd, &vertices[corner]));
                let boxes = each!(axis in [0, 1] => {
                    let [a, b, c] = each!(i in [0, 1, 2] => corners[i].0[axis]);
                    [a.min(b).min(c), a.max(b).max(c)]
                });
                let mut alive = ranges_lanes(simd, boxes, lattice, origin.packed, [&mut self.columns, &mut self.rows]);
                let p =
                    each!(i in [0, 1, 2] => each!(axis in [0, 1] => widen(simd, corners[i].0[axis]) - origin.position[axis]));
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
                let integers = integer_edges(simd, positions, origin.position, turned.to_bitmask());
                let attributes = each!(corner in [0, 1, 2] => PackedVertex::attributes(simd, &vertices[corner]));
                Record::fill_eight(simd, records, integers, attributes, divides_by_w);
                let is_least = each!(i in [0, 1] => mask32x8::from_bitmask(simd, is_least[i].to_bitmask()));
                let edges = each!(term in [0, 1, 2] => {
                    rotated(is_least, each!(i in [0, 1, 2] => integers.edges[i][term]))
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
        let [right, down] = lattice.offset().map(E::from);
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

/// Returns the edge functions of eight triangles in 32-bit integers. Vertex positions are in steps of 1/256 px.
#[inline(always)]
fn integer_edges<S: Simd>(simd: S, corners: [[F32<S>; 2]; 3], origin: [f64; 2], turned: u64) -> IntegerEdges<S> {
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
    IntegerEdges { edges: [first, second, third], doubled_area: area }
}

#[cfg(test)]
mod tests;
