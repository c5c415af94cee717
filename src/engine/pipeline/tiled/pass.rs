//! Pass over the triangles of a tile.

use super::TiledFrame;
use super::depths::DepthRules;
use super::lattice::TileOrigin;
use super::record::TileBin;
use super::sample_positions::SamplePositions;
use super::setup::{Setup, SetupContext};
use super::slot::Slot;

/// Pass over the triangles of a tile at one sample position per pixel, with all data that drawing them reads.
#[derive(Clone, Copy)]
pub(super) struct TilePass<'a, L> {
    pub(super) frame: &'a TiledFrame<'a>,
    pub(super) bin: &'a TileBin,
    pub(super) locations: L,
    /// Place of the tile's first lattice point.
    pub(super) origin: TileOrigin,
}

impl<'a, L: SamplePositions> TilePass<'a, L> {
    #[inline(always)]
    pub(super) fn new(frame: &'a TiledFrame<'a>, bin: &'a TileBin, locations: L) -> Self {
        Self { frame, bin, locations, origin: locations.lattice().origin(bin.place) }
    }

    #[inline(always)]
    pub(super) fn rules(&self) -> &'a DepthRules {
        &self.frame.rules
    }

    /// Sets up a triangle of the bin; `None` if it covers no sample of the tile.
    #[inline(always)]
    pub(super) fn set_up(&self, slot: Slot) -> Option<Setup> {
        let Self { frame, bin, locations, origin } = self;
        let entry = bin.get(slot);
        let corners = frame.corners(entry.key, entry.draw as usize);
        let context = SetupContext {
            rule: frame.settings.fill_rule,
            scale: &frame.scale,
            lattice: locations.lattice(),
            origin: *origin,
        };
        Setup::new(slot, &corners, &context)
    }
}
