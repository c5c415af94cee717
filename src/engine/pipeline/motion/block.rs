//! Motion of the pixels of a block, and a cache of the triangles that they show.

use std::ops::Range;

use super::plane::BLOCK;
use super::{FrameMotion, TriangleMotion};
use crate::image::Rgba8;
use crate::pipeline::gbuffer::GBuffer;

/// Motion of the pixels of one block.
pub(super) struct Block {
    pub(super) across_px: [f32; BLOCK],
    pub(super) down_px: [f32; BLOCK],
    /// Distances in the preceding frame.
    pub(super) distance: [f32; BLOCK],
}

impl Block {
    /// Creates the block of still pixels with these distances.
    #[inline(always)]
    pub(super) fn still(distance: &[f32; BLOCK]) -> Self {
        Self { across_px: [0.0; BLOCK], down_px: [0.0; BLOCK], distance: *distance }
    }

    /// Sets the motion of the pixels in `range`, which show one triangle. The block starts at pixel `at`.
    #[inline(always)]
    pub(super) fn set(&mut self, motion: &TriangleMotion, range: Range<usize>, at: (u32, u32)) {
        let Some(plane) = &motion.plane else { return };
        let block = plane.block(at.0, at.1);
        let mut moved = Self { across_px: [0.0; BLOCK], down_px: [0.0; BLOCK], distance: [0.0; BLOCK] };
        for column in 0..BLOCK {
            let point = block.at(column as f32);
            moved.across_px[column] = point.across_px;
            moved.down_px[column] = point.down_px;
            moved.distance[column] = point.distance;
        }
        if motion.object == GBuffer::NO_OBJECT {
            moved.distance = self.distance;
        }
        if range == (0..BLOCK) {
            *self = moved;
            return;
        }
        for column in range {
            self.across_px[column] = moved.across_px[column];
            self.down_px[column] = moved.down_px[column];
            self.distance[column] = moved.distance[column];
        }
    }
}

/// Cache of triangle motions: neighbouring pixels and rows mostly show the same triangles.
pub(super) struct Cache {
    /// Entry of triangle `id` at `id % ENTRIES`, with the bytes of the id that it holds.
    entries: Vec<Option<(Rgba8, TriangleMotion)>>,
}

impl Cache {
    /// Number of cached triangles.
    const ENTRIES: usize = 512;

    #[inline]
    pub(super) fn get(&mut self, motion: &FrameMotion<'_>, id: Rgba8) -> &TriangleMotion {
        let entry = &mut self.entries[u32::from_le_bytes(id) as usize % Self::ENTRIES];
        if entry.is_none_or(|(cached, _)| cached != id) {
            *entry = None;
        }
        &entry.get_or_insert_with(|| (id, motion.of_triangle(id))).1
    }
}

impl Default for Cache {
    fn default() -> Self {
        Self { entries: vec![None; Self::ENTRIES] }
    }
}
