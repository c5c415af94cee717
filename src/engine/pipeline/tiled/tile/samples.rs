//! Depth test of a tile's samples, and stores of those that pass.

use std::ops::Range;

use super::super::depths::{DepthRules, depth, passes};
use super::super::edge_number::EdgeNumber;
use super::super::layout::{Block, STRIDE, SamplePlace};
use super::super::pass::TilePass;
use super::super::sample_positions::{SamplePositions, edge_values};
use super::super::setup::Setup;
use super::super::slot::Slot;
use super::Tile;
use crate::math::lanes::*;

/// Eight samples, of which a triangle covers some: eight of a row, or four of a row and the four below.
#[derive(Clone, Copy)]
pub(super) struct CoveredSamples<S: Simd, E: EdgeNumber> {
    /// Place of the first sample.
    pub(super) place: SamplePlace,
    /// Edge values of the triangle.
    pub(super) e: [E::Eight<S>; 3],
    pub(super) covered: mask32x8<S>,
}

impl<S: Simd, E: EdgeNumber> CoveredSamples<S, E> {
    /// Returns `true` if the covered samples should be tested and stored.
    #[inline(always)]
    pub(super) fn are_worth_storing(&self) -> bool {
        is_worth_storing(self.covered)
    }
}

/// Depth test of the samples of a tile.
#[derive(Clone, Copy)]
pub(super) struct TileDepthTest<'a, L> {
    /// Positions of the samples.
    pub(super) locations: L,
    /// Rules of the depth test.
    pub(super) rules: &'a DepthRules,
}

impl Tile {
    /// Depth-tests the covered samples in a group of four samples of a row and the four below, and stores those that
    /// pass.
    #[inline(always)]
    pub(super) fn write_two<S: Simd, E: EdgeNumber>(
        &mut self,
        simd: S,
        triangle: &Setup<E>,
        CoveredSamples { place, e, covered }: CoveredSamples<S, E>,
        rules: &DepthRules,
    ) {
        const HALF: usize = LANES / 2;
        let upper = place.memory_index();
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

    /// Depth-tests the covered samples in a group of eight samples of a row, and stores those that pass. Returns `true`
    /// if any passed.
    #[inline(always)]
    pub(super) fn write<S: Simd, E: EdgeNumber>(
        &mut self,
        simd: S,
        triangle: &Setup<E>,
        CoveredSamples { place, e, covered }: CoveredSamples<S, E>,
        rules: &DepthRules,
    ) -> bool {
        let at = place.memory_index();
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
    pub(in crate::pipeline::tiled) fn expand_block<S: Simd>(
        &mut self,
        simd: S,
        block: Block,
        pass: &TilePass<'_, impl SamplePositions>,
    ) {
        simd.vectorize(
            #[inline(always)]
            || {
                let (index, rules) = (block.index(), pass.rules());
                if self.uniform >> index & 1 == 0 {
                    return;
                }
                self.uniform &= !(1 << index);
                let slot = Slot(self.owners[index]);
                let triangle = if slot == Slot::NONE || !rules.stored { None } else { pass.set_up(slot) };
                for row in block.rows() {
                    let place = SamplePlace { column: block.first_column(), row };
                    let at = place.memory_index();
                    self.ids[at..at + LANES].fill(slot.0);
                    if rules.stored {
                        let depths = &mut self.depths[at..at + LANES];
                        match &triangle {
                            None => depths.fill(rules.clear),
                            Some(triangle) => {
                                let e = edge_values(simd, &triangle.edges, place, pass.locations);
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

/// Returns the range of a triangle's rows that lie in the row of a block.
pub(super) fn rows_in<E>(triangle: &Setup<E>, block: Block) -> Range<usize> {
    let ([top, bottom], rows) = (triangle.rows, block.rows());
    top.max(rows.start)..(bottom + 1).min(rows.end)
}
