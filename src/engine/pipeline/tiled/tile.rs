//! A tile of the picture while it is rasterized: the visible triangle and the depth of each sample.
//!
//! Samples are grouped in blocks of 8 × 8. A block is *uniform* if one triangle covers all of it, in front of
//! everything drawn before. For a uniform block, only that triangle is stored; the samples of the block are written
//! when another triangle first covers the block in part. Lower and upper bounds on the stored depths of each block are
//! kept, so a triangle that is entirely behind a block is skipped there (Greene, Kass and Miller, "Hierarchical
//! Z-buffer visibility", SIGGRAPH 1993). While the whole tile shows a single triangle, or nothing, these bounds are
//! stored once for the whole tile.

mod bounds;

use std::ops::{AddAssign, Range};

use bounds::FullTileOccluder;

use super::depths::{DepthPlane, DepthRules, compare_bounds, depth, passes};
use super::edge_number::EdgeNumber;
use super::lattice::{BLOCK, BLOCKS, TILE};
use super::record::Slot;
use super::sample_positions::{EdgeValueRows, SamplePositions, edge_values};
use super::setup::{EdgeFunctions, Setup};
use super::tested::TestedRows;
use crate::math::lanes::*;

/// Distance between adjacent rows of samples in memory. Rows may be read and written up to eight samples beyond the
/// last block.
pub(super) const STRIDE: usize = TILE + LANES;

/// Number of rows of samples in memory. One row is extra, because narrow triangles are drawn two rows at a time.
pub(super) const ROWS: usize = TILE + 1;

/// Rasterization work of a tile, in samples.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct TileCounts {
    /// Number of samples whose coverage was tested individually.
    pub(super) visited: u64,
    /// Number of samples in blocks that were accepted as a whole.
    pub(super) uniform: u64,
}

impl AddAssign for TileCounts {
    fn add_assign(&mut self, more: Self) {
        self.visited += more.visited;
        self.uniform += more.uniform;
    }
}

/// A tile while it is rasterized. Its memory is reused from tile to tile.
#[derive(Clone, Debug)]
pub(super) struct Tile {
    /// Slot of the visible triangle at each sample, row by row.
    ids: Vec<u32>,
    /// Stored depth of each sample, row by row.
    depths: Vec<f32>,
    /// Slot of the visible triangle in each uniform block.
    owners: [u32; BLOCKS * BLOCKS],
    /// Lower bound on the stored depths of each block. Not valid while there is a full-tile occluder.
    min_depths: [f32; BLOCKS * BLOCKS],
    /// Upper bound on the stored depths of each block. Not valid while there is a full-tile occluder.
    max_depths: [f32; BLOCKS * BLOCKS],
    /// Triangle that covers the whole tile in front of everything drawn before, or the background. `None` after another
    /// triangle was drawn into some of the blocks, or if no depth bounds are kept.
    occluder: Option<FullTileOccluder>,
    /// Bit mask of the uniform blocks, row by row.
    uniform: u64,
    /// Whether depth bounds of the blocks are kept. They cost more than they save if triangles are as small as blocks.
    bounded: bool,
    pub(super) counts: TileCounts,
}

impl Tile {
    pub(super) fn new() -> Self {
        Self {
            ids: vec![Slot::NONE.0; STRIDE * ROWS],
            depths: vec![0.0; STRIDE * ROWS],
            owners: [Slot::NONE.0; BLOCKS * BLOCKS],
            min_depths: [0.0; BLOCKS * BLOCKS],
            max_depths: [0.0; BLOCKS * BLOCKS],
            occluder: None,
            uniform: u64::MAX,
            bounded: true,
            counts: TileCounts::default(),
        }
    }

    /// Returns the memory use in bytes.
    pub(super) fn bytes(&self) -> usize {
        self.ids.capacity() * size_of::<u32>() + self.depths.capacity() * size_of::<f32>() + size_of::<Self>()
    }

    /// Clears the tile. If `bounded` is `false`, clears all samples at once and keeps no depth bounds.
    pub(super) fn clear(&mut self, rules: &DepthRules, bounded: bool) {
        self.bounded = bounded;
        self.counts = TileCounts::default();
        if bounded {
            self.uniform = u64::MAX;
            self.owners = [Slot::NONE.0; BLOCKS * BLOCKS];
            self.occluder = Some(FullTileOccluder { min_depth: rules.clear, max_depth: rules.clear, plane: None });
        } else {
            self.uniform = 0;
            self.occluder = None;
            self.ids.fill(Slot::NONE.0);
            if rules.stored {
                self.depths.fill(rules.clear);
            }
            self.min_depths = [f32::NEG_INFINITY; BLOCKS * BLOCKS];
            self.max_depths = [f32::INFINITY; BLOCKS * BLOCKS];
        }
    }

    /// Returns the slot of the visible triangle in a uniform block; `None` if the block is not uniform.
    #[inline(always)]
    pub(super) fn owner(&self, block: usize) -> Option<Slot> {
        (self.uniform >> block & 1 != 0).then(|| Slot(self.owners[block]))
    }

    /// Returns the indices of the uniform blocks, whose samples are not yet written, and the slots of their triangles.
    pub(super) fn uniform_blocks(&self) -> impl Iterator<Item = (usize, Slot)> + use<> {
        let (plain, owners) = (self.uniform, self.owners);
        (0..BLOCKS * BLOCKS).filter(move |block| plain >> block & 1 != 0).map(move |block| (block, Slot(owners[block])))
    }

    /// Returns the slots of the visible triangles at eight samples of a row. Their block must not be uniform.
    #[inline(always)]
    pub(super) fn slots(&self, column: usize, row: usize) -> &[u32] {
        &self.ids[row * STRIDE + column..][..LANES]
    }

    /// Returns the slots of the visible triangles at eight samples of a row and the eight below. Their block must not
    /// be uniform.
    #[inline(always)]
    pub(super) fn slots_of_two_rows<S: Simd>(&self, simd: S, column: usize, row: usize) -> u32x16<S> {
        let [upper, lower] = each!(y in [row, row + 1] => u32x8::from_slice(simd, self.slots(column, y)));
        upper.combine(lower)
    }

    /// Returns the slots of the visible triangles at eight samples of a row, whether or not their block is uniform.
    #[inline(always)]
    pub(super) fn visible_slots<S: Simd>(&self, simd: S, column: usize, row: usize) -> u32x8<S> {
        match self.owner(row / BLOCK * BLOCKS + column / BLOCK) {
            Some(slot) => u32x8::splat(simd, slot.0),
            None => u32x8::from_slice(simd, self.slots(column, row)),
        }
    }

    /// Marks a block as uniform, with `owner` as its only visible triangle, or as not uniform if `owner` is `None`.
    pub(super) fn set_owner(&mut self, block: usize, owner: Option<Slot>) {
        match owner {
            Some(slot) => {
                self.uniform |= 1 << block;
                self.owners[block] = slot.0;
            }
            None => self.uniform &= !(1 << block),
        }
    }

    /// Stores the slots of the visible triangles at eight samples of a row.
    #[inline(always)]
    pub(super) fn set_seen<S: Simd>(&mut self, column: usize, row: usize, slots: u32x8<S>) {
        slots.store_slice(&mut self.ids[row * STRIDE + column..][..LANES]);
    }

    /// Returns the stored depths of the samples in a row.
    pub(super) fn depths(&self, row: usize) -> &[f32] {
        &self.depths[row * STRIDE..][..TILE]
    }

    /// Draws a triangle. `owner` sets up the triangle of a uniform block again if that block must be expanded.
    ///
    /// The code is compiled separately for the [most common depth rules](DepthRules::are_common): branches on the rules
    /// in every row would take a tenth of the time.
    #[inline(always)]
    pub(super) fn draw<S: Simd, E: EdgeNumber>(
        &mut self,
        simd: S,
        triangle: &Setup<E>,
        locations: impl SamplePositions,
        rules: &DepthRules,
        owner: &impl Fn(Slot) -> Option<Setup>,
    ) {
        let [first, last] = triangle.columns;
        let start = first & !1;
        let is_small = last < start + 2 * LANES && triangle.rows[1] < triangle.rows[0] + 2 * BLOCK;
        match (is_small, rules.are_common()) {
            (true, true) => self.draw_small::<_, _, true>(simd, triangle, start, locations, rules, owner),
            (true, false) => self.draw_small::<_, _, false>(simd, triangle, start, locations, rules, owner),
            (false, true) => self.draw_large::<_, _, true>(simd, triangle, locations, rules, owner),
            (false, false) => self.draw_large::<_, _, false>(simd, triangle, locations, rules, owner),
        }
    }

    /// Draws a triangle at most 16 samples wide and high, in strips eight samples wide. Triangles at most four samples
    /// wide are drawn two rows at a time if the samples of all rows are vertically aligned.
    #[inline(never)]
    fn draw_small<S: Simd, E: EdgeNumber, const COMMON: bool>(
        &mut self,
        simd: S,
        triangle: &Setup<E>,
        start: usize,
        locations: impl SamplePositions,
        rules: &DepthRules,
        owner: &impl Fn(Slot) -> Option<Setup>,
    ) {
        simd.vectorize(
            #[inline(always)]
            || {
                let rules = &rules.known::<COMMON>();
                let ([top, bottom], last) = (triangle.rows, triangle.columns[1]);
                let end = start + LANES * (1 + (last - start) / LANES);
                if self.bounded {
                    self.replace_occluder(simd, locations.lattice(), rules);
                    let columns = [start / BLOCK, last / BLOCK];
                    let mut in_sight = false;
                    for by in top / BLOCK..=bottom / BLOCK {
                        for bx in columns[0]..=columns[1].min(BLOCKS - 1) {
                            in_sight |= self.may_show(triangle, by * BLOCKS + bx, rules);
                        }
                    }
                    if !in_sight {
                        return;
                    }
                    // The last strip of eight columns may extend into one more block than the triangle does.
                    for by in top / BLOCK..=bottom / BLOCK {
                        for bx in columns[0]..=((end - 1) / BLOCK).min(BLOCKS - 1) {
                            let block = by * BLOCKS + bx;
                            self.expand_block(simd, block, locations, rules, owner);
                            self.widen_bounds(triangle, block, rules);
                        }
                    }
                }
                let (Setup { edges, .. }, lattice) = (triangle, locations.lattice());
                let steps = E::steps(lattice);
                if steps.are_straight && last < start + LANES / 2 {
                    self.draw_narrow(simd, triangle, start, locations, rules);
                    return;
                }
                let least_inside = triangle.inside_thresholds(simd);
                let mut column = start;
                while column < end {
                    let x = E::load(simd, &steps.lanes) + steps.column(column);
                    let mut rows = EdgeValueRows::new(simd, edges, x, top, lattice);
                    for row in top..bottom + 1 {
                        let e = locations.jittered(simd, edges, rows.next(edges, row, lattice), (column, row));
                        let covered = E::inside(e, least_inside);
                        if is_worth_storing(covered) {
                            self.write(simd, triangle, e, covered, (column, row), rules);
                        }
                    }
                    column += LANES;
                }
                self.counts.visited += ((bottom - top + 1) * (end - start)) as u64;
            },
        );
    }

    /// Draws a triangle at most four samples wide, two rows at a time.
    #[inline(always)]
    fn draw_narrow<S: Simd, E: EdgeNumber>(
        &mut self,
        simd: S,
        triangle: &Setup<E>,
        start: usize,
        locations: impl SamplePositions,
        rules: &DepthRules,
    ) {
        let Setup { edges: edges @ EdgeFunctions { a, b, c }, rows: [top, bottom], .. } = triangle;
        let lattice = locations.lattice();
        let (steps, least_inside) = (E::steps(lattice), triangle.inside_thresholds(simd));
        let x = E::load(simd, &steps.two_rows[0]) + steps.column(start);
        let y = E::load(simd, &steps.two_rows[1]) + steps.row(*top);
        let mut next = each!(i in [0, 1, 2] => x * a[i] + c[i] + y * b[i]);
        let step = each!(i in [0, 1, 2] => E::repeat(simd, b[i]) * E::load(simd, &steps.row_after_next));
        let mut row = *top;
        while row <= *bottom {
            let e = locations.jittered_in_two_rows(simd, edges, next, (start, row));
            let covered = E::inside(e, least_inside);
            if is_worth_storing(covered) {
                self.write_two(simd, triangle, e, covered, (start, row), rules);
            }
            next = each!(i in [0, 1, 2] => next[i] + step[i]);
            row += 2;
        }
        self.counts.visited += ((row - top) * LANES / 2) as u64;
    }

    /// Depth-tests the covered samples in a group of four samples of a row and the four below, and stores those that
    /// pass.
    #[inline(always)]
    fn write_two<S: Simd, E: EdgeNumber>(
        &mut self,
        simd: S,
        triangle: &Setup<E>,
        e: [E::Eight<S>; 3],
        covered: mask32x8<S>,
        (column, row): (usize, usize),
        rules: &DepthRules,
    ) {
        const HALF: usize = LANES / 2;
        let upper = row * STRIDE + column;
        let lower = upper + STRIDE;
        let mut passed = covered;
        if rules.stored {
            let depths = &mut self.depths[upper..lower + HALF];
            let new = depth(simd, triangle, e, rules);
            let low = f32x4::from_slice(simd, &depths[..HALF]);
            let stored = low.combine(f32x4::from_slice(simd, &depths[STRIDE..]));
            passed &= passes(new, stored, rules.comparison);
            if !is_worth_storing(passed) {
                return;
            }
            let (low, high) = passed.select(new, stored).split();
            low.store_slice(&mut depths[..HALF]);
            high.store_slice(&mut depths[STRIDE..]);
        }
        let ids = &mut self.ids[upper..lower + HALF];
        let slot = u32x8::splat(simd, triangle.slot.0);
        let stored = u32x4::from_slice(simd, &ids[..HALF]).combine(u32x4::from_slice(simd, &ids[STRIDE..]));
        let (low, high) = passed.select(slot, stored).split();
        low.store_slice(&mut ids[..HALF]);
        high.store_slice(&mut ids[STRIDE..]);
    }

    /// Draws a large triangle, block by block.
    #[inline(never)]
    fn draw_large<S: Simd, E: EdgeNumber, const COMMON: bool>(
        &mut self,
        simd: S,
        triangle: &Setup<E>,
        locations: impl SamplePositions,
        rules: &DepthRules,
        owner: &impl Fn(Slot) -> Option<Setup>,
    ) {
        simd.vectorize(
            #[inline(always)]
            || {
                let rules = &rules.known::<COMMON>();
                let lattice = locations.lattice();
                let plane = DepthPlane::new(triangle, lattice.tile_extent(), rules);
                if self.test_occluder(simd, triangle, &plane, lattice, rules)
                    || self.hides(simd, &plane, lattice, rules)
                {
                    return;
                }
                let Setup { edges, columns, rows, .. } = triangle;
                let (steps, least_inside) = (E::steps(lattice), triangle.inside_thresholds(simd));
                let [across, down] = steps.block;
                let reach = each!(i in [0, 1, 2] => E::reach(edges.a[i], edges.b[i], across, down));
                let touched = (u64::MAX >> (63 - columns[1] / BLOCK)) & (u64::MAX << (columns[0] / BLOCK));
                let blocks = E::load(simd, &steps.blocks);
                let block_places = F64::load_array_ref(simd, &lattice.doubles.blocks);
                let along = each!(i in [0, 1, 2] => blocks * edges.a[i] + edges.c[i]);
                for by in rows[0] / BLOCK..=rows[1] / BLOCK {
                    let (mut candidates, mut accepted) = (0xFF, 0xFF);
                    if !triangle.covers_tile {
                        let y = steps.row(by * BLOCK);
                        let first = each!(i in [0, 1, 2] => along[i] + edges.b[i] * y);
                        let [least, greatest] =
                            each!(end in [0, 1] => each!(i in [0, 1, 2] => first[i] + reach[i][end]));
                        candidates = touched & E::inside_bits(greatest, least_inside);
                        accepted = E::inside_bits(least, least_inside);
                        if candidates == 0 {
                            continue;
                        }
                    }
                    let here = by * BLOCKS..(by + 1) * BLOCKS;
                    let places = (block_places, lattice.doubles.row(by * BLOCK));
                    let [low, high] = plane.bounds(simd, places, lattice.doubles.block, rules);
                    let stored = [
                        F32::from_slice(simd, &self.min_depths[here.clone()]),
                        F32::from_slice(simd, &self.max_depths[here.clone()]),
                    ];
                    let (hidden, in_front) = compare_bounds([low, high], stored, rules.comparison);
                    candidates &= !hidden;
                    let whole = if self.bounded { candidates & accepted & in_front } else { 0 };
                    if whole != 0 {
                        let mask = mask32x8::from_bitmask(simd, whole);
                        mask.select(low, stored[0]).store_slice(&mut self.min_depths[here.clone()]);
                        mask.select(high, stored[1]).store_slice(&mut self.max_depths[here.clone()]);
                        let (slot, owners) = (u32x8::splat(simd, triangle.slot.0), &mut self.owners[here]);
                        mask.select(slot, u32x8::from_slice(simd, owners)).store_slice(owners);
                        self.uniform |= whole << (by * BLOCKS);
                        self.counts.uniform += u64::from(whole.count_ones()) * (BLOCK * BLOCK) as u64;
                    }
                    let mut partial = candidates & !whole;
                    while partial != 0 {
                        let bx = partial.trailing_zeros() as usize;
                        partial &= partial - 1;
                        self.expand_block(simd, by * BLOCKS + bx, locations, rules, owner);
                        self.draw_block(simd, triangle, (bx, by), locations, rules);
                    }
                }
            },
        );
    }

    /// Draws a triangle with an additional test of its samples, such as the alpha test. `keep` receives the samples
    /// that pass the depth test, two rows at a time, and returns the bit mask of those to store.
    #[inline(never)]
    pub(super) fn draw_kept<S: Simd>(
        &mut self,
        simd: S,
        triangle: &Setup,
        locations: impl SamplePositions,
        rules: &DepthRules,
        owner: &impl Fn(Slot) -> Option<Setup>,
        mut keep: impl FnMut(&TestedRows) -> u64,
    ) {
        simd.vectorize(
            #[inline(always)]
            || {
                self.replace_occluder(simd, locations.lattice(), rules);
                for (bx, by) in blocks(triangle) {
                    let block = by * BLOCKS + bx;
                    if !self.may_show(triangle, block, rules) {
                        continue;
                    }
                    self.expand_block(simd, block, locations, rules, owner);
                    let rows = rows_in(triangle, by);
                    for row in rows.clone().step_by(2) {
                        let mut tested = TestedRows { place: (bx * BLOCK, row), ..TestedRows::default() };
                        for (below, row) in (row..rows.end).take(2).enumerate() {
                            let place = (bx * BLOCK, row);
                            let passed = self.test(simd, triangle, place, locations, rules, &mut tested.edges[below]);
                            tested.passed |= passed << (below * LANES);
                        }
                        let kept = if tested.passed == 0 { 0 } else { keep(&tested) };
                        for (below, edges) in tested.edges.iter().enumerate() {
                            let kept = kept >> (below * LANES) & 0xFF;
                            if kept != 0 {
                                let e = each!(i in [0, 1, 2] => F64::load_array_ref(simd, &edges[i]));
                                let kept = mask32x8::from_bitmask(simd, kept);
                                self.write(simd, triangle, e, kept, (bx * BLOCK, row + below), rules);
                            }
                        }
                    }
                    self.counts.visited += (BLOCK * BLOCK) as u64;
                    if self.bounded && rules.stored {
                        self.measure_bounds(simd, (bx, by));
                    }
                }
            },
        );
    }

    /// Computes the edge values at eight samples of a row into `edges`. Returns the bit mask of the samples that are
    /// covered and pass the depth test.
    #[inline(never)]
    fn test<S: Simd>(
        &self,
        simd: S,
        triangle: &Setup,
        (column, row): (usize, usize),
        locations: impl SamplePositions,
        rules: &DepthRules,
        edges: &mut [[f64; LANES]; 3],
    ) -> u64 {
        simd.vectorize(
            #[inline(always)]
            || {
                let e = edge_values(simd, &triangle.edges, (column, row), locations);
                let mut passed = f64::inside_bits(e, triangle.inside_thresholds(simd));
                if rules.stored {
                    let stored = F32::from_slice(simd, &self.depths[row * STRIDE + column..][..LANES]);
                    passed &= passes(depth(simd, triangle, e, rules), stored, rules.comparison).to_bitmask();
                }
                *edges = each!(i in [0, 1, 2] => e[i].to_array());
                passed
            },
        )
    }

    /// Draws the part of a triangle that lies in one block.
    #[inline(always)]
    fn draw_block<S: Simd, E: EdgeNumber>(
        &mut self,
        simd: S,
        triangle: &Setup<E>,
        (bx, by): (usize, usize),
        locations: impl SamplePositions,
        rules: &DepthRules,
    ) {
        let (Setup { edges, .. }, lattice) = (triangle, locations.lattice());
        let (steps, least_inside) = (E::steps(lattice), triangle.inside_thresholds(simd));
        let x = E::load(simd, &steps.lanes) + steps.blocks[bx];
        let touched = rows_in(triangle, by);
        self.counts.visited += (touched.len() * BLOCK) as u64;
        let mut rows = EdgeValueRows::new(simd, edges, x, touched.start, lattice);
        let mut written = false;
        for row in touched {
            let e = locations.jittered(simd, edges, rows.next(edges, row, lattice), (bx * BLOCK, row));
            let covered = E::inside(e, least_inside);
            if is_worth_storing(covered) {
                written |= self.write(simd, triangle, e, covered, (bx * BLOCK, row), rules);
            }
        }
        if written && self.bounded && rules.stored {
            self.measure_bounds(simd, (bx, by));
        }
    }

    /// Depth-tests the covered samples in a group of eight samples of a row, and stores those that pass. Returns `true`
    /// if any passed.
    #[inline(always)]
    fn write<S: Simd, E: EdgeNumber>(
        &mut self,
        simd: S,
        triangle: &Setup<E>,
        e: [E::Eight<S>; 3],
        covered: mask32x8<S>,
        (column, row): (usize, usize),
        rules: &DepthRules,
    ) -> bool {
        let at = row * STRIDE + column;
        let ids = &mut self.ids[at..at + LANES];
        let mut passed = covered;
        if rules.stored {
            let depths = &mut self.depths[at..at + LANES];
            let new = depth(simd, triangle, e, rules);
            let stored = F32::from_slice(simd, depths);
            passed &= passes(new, stored, rules.comparison);
            if !is_worth_storing(passed) {
                return false;
            }
            passed.select(new, stored).store_slice(depths);
        }
        let slot = u32x8::splat(simd, triangle.slot.0);
        passed.select(slot, u32x8::from_slice(simd, ids)).store_slice(ids);
        passed.any_true()
    }

    /// Expands a uniform block: writes the slot and the depth of each of its samples. Does nothing for other blocks.
    #[inline(never)]
    pub(super) fn expand_block<S: Simd>(
        &mut self,
        simd: S,
        block: usize,
        locations: impl SamplePositions,
        rules: &DepthRules,
        owner: &impl Fn(Slot) -> Option<Setup>,
    ) {
        simd.vectorize(
            #[inline(always)]
            || {
                if self.uniform >> block & 1 == 0 {
                    return;
                }
                self.uniform &= !(1 << block);
                let (bx, by) = (block % BLOCKS, block / BLOCKS);
                let slot = Slot(self.owners[block]);
                let triangle = if slot == Slot::NONE || !rules.stored { None } else { owner(slot) };
                for row in by * BLOCK..(by + 1) * BLOCK {
                    let at = row * STRIDE + bx * BLOCK;
                    self.ids[at..at + LANES].fill(slot.0);
                    if rules.stored {
                        let depths = &mut self.depths[at..at + LANES];
                        match &triangle {
                            None => depths.fill(rules.clear),
                            Some(triangle) => {
                                let e = edge_values(simd, &triangle.edges, (bx * BLOCK, row), locations);
                                depth(simd, triangle, e, rules).store_slice(depths);
                            }
                        }
                    }
                }
            },
        );
    }
}

/// Returns `true` if the selected lanes should be stored: if any lane is selected, or always with AVX-512. With
/// AVX-512, it is faster to store even if no lane is selected: an empty masked store costs less than a mispredicted
/// branch.
#[inline(always)]
fn is_worth_storing<S: Simd>(some: mask32x8<S>) -> bool {
    S::f32s::LEN >= WIDE || some.any_true()
}

/// Returns the columns and rows of the blocks that a triangle may overlap.
fn blocks(triangle: &Setup) -> impl Iterator<Item = (usize, usize)> + use<> {
    let Setup { columns: [left, right], rows: [top, bottom], .. } = *triangle;
    (top / BLOCK..=bottom / BLOCK).flat_map(move |by| (left / BLOCK..=right / BLOCK).map(move |bx| (bx, by)))
}

/// Returns the range of a triangle's rows that lie in the row of blocks `by`.
fn rows_in<E>(triangle: &Setup<E>, by: usize) -> Range<usize> {
    let [top, bottom] = triangle.rows;
    top.max(by * BLOCK)..(bottom + 1).min((by + 1) * BLOCK)
}
