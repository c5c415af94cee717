//! Drawing with a test of the samples that pass the depth test.

use super::super::depths::{depth, passes};
use super::super::edge_number::EdgeNumber as _;
use super::super::layout::{BLOCK, Block, SamplePlace};
use super::super::pass::TilePass;
use super::super::sample_positions::{SamplePositions, edge_values};
use super::super::setup::Setup;
use super::super::tested::TestedRows;
use super::Tile;
use super::samples::{CoveredSamples, rows_in};
use crate::math::lanes::*;

impl Tile {
    /// Draws a triangle with an additional test of its samples, such as the alpha test. `keep` receives the samples
    /// that pass the depth test, two rows at a time, and returns the bit mask of those to store.
    #[inline(never)]
    pub(in crate::pipeline::tiled) fn draw_kept<S: Simd>(
        &mut self,
        simd: S,
        triangle: &Setup,
        pass: &TilePass<'_, impl SamplePositions>,
        mut keep: impl FnMut(&TestedRows) -> u64,
    ) {
        simd.vectorize(
            #[inline(always)]
            || {
                let rules = pass.rules();
                self.replace_occluder(simd, pass.locations.lattice(), rules);
                for block in blocks(triangle) {
                    if !self.may_show(triangle, block, rules) {
                        continue;
                    }
                    self.expand_block(simd, block, pass);
                    for row in rows_in(triangle, block).step_by(2) {
                        let place = SamplePlace { column: block.first_column(), row };
                        let mut tested = TestedRows { place, ..TestedRows::default() };
                        self.test(simd, triangle, pass, &mut tested);
                        let kept = if tested.passed == 0 { 0 } else { keep(&tested) };
                        for (below, edges) in tested.edges.iter().enumerate() {
                            let kept = kept >> (below * LANES) & 0xFF;
                            if kept != 0 {
                                let e = each!(i in [0, 1, 2] => F64::load_array_ref(simd, &edges[i]));
                                let covered = mask32x8::from_bitmask(simd, kept);
                                let place = SamplePlace { row: row + below, ..place };
                                self.write(simd, triangle, CoveredSamples { place, e, covered }, rules);
                            }
                        }
                    }
                    self.counts.visited += (BLOCK * BLOCK) as u64;
                    if self.bounded && rules.stored {
                        self.measure_bounds(simd, block);
                    }
                }
            },
        );
    }

    /// Tests the coverage and the depth of the samples of `tested`. Skips the lower row if it lies outside the block or
    /// below the triangle. Stores the edge values in `tested`, and selects the samples that pass.
    #[inline(never)]
    fn test<S: Simd>(
        &self,
        simd: S,
        triangle: &Setup,
        pass: &TilePass<'_, impl SamplePositions>,
        tested: &mut TestedRows,
    ) {
        simd.vectorize(
            #[inline(always)]
            || {
                let (rules, first) = (pass.rules(), tested.place);
                let rows_left = rows_in(triangle, Block::around(first)).end - first.row;
                for below in 0..rows_left.min(2) {
                    let place = SamplePlace { row: first.row + below, ..first };
                    let e = edge_values(simd, &triangle.edges, place, pass.locations);
                    let mut passed = f64::inside_bits(e, triangle.inside_thresholds(simd));
                    if rules.stored {
                        let stored = F32::from_slice(simd, &self.depths[place.memory_index()..][..LANES]);
                        passed &= passes(depth(simd, triangle, e, rules), stored, rules.comparison).to_bitmask();
                    }
                    tested.edges[below] = each!(i in [0, 1, 2] => e[i].to_array());
                    tested.passed |= passed << (below * LANES);
                }
            },
        );
    }
}

/// Returns the blocks that a triangle may overlap.
fn blocks(triangle: &Setup) -> impl Iterator<Item = Block> + use<> {
    let Setup { columns: [left, right], rows: [top, bottom], .. } = *triangle;
    let around = |column, row| Block::around(SamplePlace { column, row });
    let (first, last) = (around(left, top), around(right, bottom));
    (first.row..=last.row).flat_map(move |row| (first.column..=last.column).map(move |column| Block { column, row }))
}
