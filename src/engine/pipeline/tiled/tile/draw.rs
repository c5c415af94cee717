//! Drawing of opaque triangles into a tile.

use super::super::depths::{DepthPlane, EightPositions, compare_bounds};
use super::super::edge_number::EdgeNumber;
use super::super::layout::{BLOCK, BLOCKS, Block, SamplePlace};
use super::super::pass::TilePass;
use super::super::sample_positions::{EdgeValueRows, SamplePositions};
use super::super::setup::{EdgeFunctions, Setup};
use super::Tile;
use super::samples::{CoveredSamples, TileDepthTest, rows_in};
use crate::math::lanes::*;

impl Tile {
    /// Draws a triangle.
    ///
    /// The code is compiled separately for the [most common depth rules]: branches on the rules in every row would take a
    /// tenth of the time.
    ///
    /// [most common depth rules]: super::super::depths::DepthRules::are_common
    #[inline(always)]
    pub(in crate::pipeline::tiled) fn draw<S: Simd, E: EdgeNumber>(
        &mut self,
        simd: S,
        triangle: &Setup<E>,
        pass: &TilePass<'_, impl SamplePositions>,
    ) {
        let [first, last] = triangle.columns;
        let is_small = last < (first & !1) + 2 * LANES && triangle.rows[1] < triangle.rows[0] + 2 * BLOCK;
        match (is_small, pass.rules().are_common()) {
            (true, true) => self.draw_small::<_, _, true>(simd, triangle, pass),
            (true, false) => self.draw_small::<_, _, false>(simd, triangle, pass),
            (false, true) => self.draw_large::<_, _, true>(simd, triangle, pass),
            (false, false) => self.draw_large::<_, _, false>(simd, triangle, pass),
        }
    }

    /// Draws a triangle at most 16 samples wide and high, in strips eight samples wide. Triangles at most four samples
    /// wide are drawn two rows at a time if the samples of all rows are vertically aligned.
    #[inline(never)]
    fn draw_small<S: Simd, E: EdgeNumber, const COMMON: bool>(
        &mut self,
        simd: S,
        triangle: &Setup<E>,
        pass: &TilePass<'_, impl SamplePositions>,
    ) {
        simd.vectorize(
            #[inline(always)]
            || {
                let (rules, locations) = (&pass.rules().known::<COMMON>(), pass.locations);
                let ([top, bottom], [first, last]) = (triangle.rows, triangle.columns);
                let start = first & !1;
                let end = start + LANES * (1 + (last - start) / LANES);
                if self.bounded {
                    self.replace_occluder(simd, locations.lattice(), rules);
                    let columns = [start / BLOCK, last / BLOCK];
                    let mut in_sight = false;
                    for by in top / BLOCK..=bottom / BLOCK {
                        for bx in columns[0]..=columns[1].min(BLOCKS - 1) {
                            in_sight |= self.may_show(triangle, Block { column: bx, row: by }, rules);
                        }
                    }
                    if !in_sight {
                        return;
                    }
                    // The last strip of eight columns may extend into one more block than the triangle does.
                    for by in top / BLOCK..=bottom / BLOCK {
                        for bx in columns[0]..=((end - 1) / BLOCK).min(BLOCKS - 1) {
                            let block = Block { column: bx, row: by };
                            self.expand_block(simd, block, pass);
                            self.widen_bounds(triangle, block, rules);
                        }
                    }
                }
                let (Setup { edges, .. }, lattice) = (triangle, locations.lattice());
                let steps = E::steps(lattice);
                if steps.are_straight && last < start + LANES / 2 {
                    self.draw_narrow(simd, triangle, start, TileDepthTest { locations, rules });
                    return;
                }
                let least_inside = triangle.inside_thresholds(simd);
                let mut column = start;
                while column < end {
                    let x = E::load(simd, &steps.lanes) + steps.column(column);
                    let mut rows = EdgeValueRows::new(simd, edges, x, top, lattice);
                    for row in top..bottom + 1 {
                        let place = SamplePlace { column, row };
                        let e = locations.jittered(simd, edges, rows.next(edges, row, lattice), place);
                        let samples = CoveredSamples { place, e, covered: E::inside(e, least_inside) };
                        if samples.are_worth_storing() {
                            self.write(simd, triangle, samples, rules);
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
        TileDepthTest { locations, rules }: TileDepthTest<'_, impl SamplePositions>,
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
            let place = SamplePlace { column: start, row };
            let e = locations.jittered_in_two_rows(simd, edges, next, place);
            let samples = CoveredSamples { place, e, covered: E::inside(e, least_inside) };
            if samples.are_worth_storing() {
                self.write_two(simd, triangle, samples, rules);
            }
            next = each!(i in [0, 1, 2] => next[i] + step[i]);
            row += 2;
        }
        self.counts.visited += ((row - top) * LANES / 2) as u64;
    }

    /// Draws a large triangle, block by block.
    #[inline(never)]
    fn draw_large<S: Simd, E: EdgeNumber, const COMMON: bool>(
        &mut self,
        simd: S,
        triangle: &Setup<E>,
        pass: &TilePass<'_, impl SamplePositions>,
    ) {
        simd.vectorize(
            #[inline(always)]
            || {
                let (rules, locations) = (&pass.rules().known::<COMMON>(), pass.locations);
                let lattice = locations.lattice();
                let plane = DepthPlane::new(triangle, lattice.tile_extent(), rules);
                let test = TileDepthTest { locations, rules };
                if self.test_occluder(simd, triangle, &plane, test) || self.hides(simd, &plane, lattice, rules) {
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
                    let places = EightPositions { x: block_places, y: lattice.doubles.row(by * BLOCK) };
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
                        let block = Block { column: bx, row: by };
                        self.expand_block(simd, block, pass);
                        self.draw_block(simd, triangle, block, test);
                    }
                }
            },
        );
    }

    /// Draws the part of a triangle that lies in one block.
    #[inline(always)]
    fn draw_block<S: Simd, E: EdgeNumber>(
        &mut self,
        simd: S,
        triangle: &Setup<E>,
        block: Block,
        TileDepthTest { locations, rules }: TileDepthTest<'_, impl SamplePositions>,
    ) {
        let (Setup { edges, .. }, lattice) = (triangle, locations.lattice());
        let (steps, least_inside) = (E::steps(lattice), triangle.inside_thresholds(simd));
        let x = E::load(simd, &steps.lanes) + steps.blocks[block.column];
        let touched = rows_in(triangle, block);
        self.counts.visited += (touched.len() * BLOCK) as u64;
        let mut rows = EdgeValueRows::new(simd, edges, x, touched.start, lattice);
        let mut written = false;
        for row in touched {
            let place = SamplePlace { column: block.first_column(), row };
            let e = locations.jittered(simd, edges, rows.next(edges, row, lattice), place);
            let samples = CoveredSamples { place, e, covered: E::inside(e, least_inside) };
            if samples.are_worth_storing() {
                written |= self.write(simd, triangle, samples, rules);
            }
        }
        if written && self.bounded && rules.stored {
            self.measure_bounds(simd, block);
        }
    }
}
