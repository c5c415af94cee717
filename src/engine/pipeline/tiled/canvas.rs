//! Target of a tile: its rows of the picture, and the queue of samples that wait for their texels.

use super::TiledFrame;
use super::finish::{finish_blended, finish_codes, finish_light, finish_mipmapped};
use super::layout::TilePlace;
use super::queue::{FilledRows, Queue, Reserved};
use super::target::ColorRows;
use crate::math::lanes::*;
use crate::pipeline::settings::ColorSpace;

/// Destination of the colours of one tile.
pub(super) struct Canvas<'a> {
    pub(super) frame: &'a TiledFrame<'a>,
    pub(super) place: TilePlace,
    /// Queue of the samples that are not yet written to the picture.
    pub(super) queue: &'a mut Queue,
    pub(super) picture: ColorRows<'a>,
}

impl Canvas<'_> {
    /// Reborrows the canvas for a shorter lifetime.
    #[inline(always)]
    pub(super) fn reborrow(&mut self) -> Canvas<'_> {
        Canvas { queue: self.queue, picture: self.picture.reborrow(), ..*self }
    }

    /// Reserves space in the queue for `pairs` pairs of rows of one shader, given by its index in the frame's list of
    /// shaders. Flushes the queue first if it is full or holds rows of another shader.
    #[inline(always)]
    pub(super) fn reserve<S: Simd>(&mut self, simd: S, shader: usize, pairs: usize) -> Reserved<'_> {
        if self.queue.is_full(shader, pairs) {
            self.flush(simd);
            self.queue.shader = shader;
        }
        self.queue.reserve(pairs, self.frame.shaders[shader].plan.mipmapped)
    }

    /// Reads the texels of all rows in the queue, computes their final colours and writes them to the picture.
    #[inline(never)]
    pub(super) fn flush<S: Simd>(&mut self, simd: S) {
        simd.vectorize(
            #[inline(always)]
            || {
                let Self { frame, queue, picture, .. } = self;
                let len = std::mem::take(&mut queue.len);
                if len == 0 {
                    return;
                }
                let (shader, pixels) = (&frame.shaders[queue.shader], &mut *picture.values);
                let coarse: &[_] = if shader.plan.mipmapped { &queue.coarse[..len] } else { &[] };
                let rows = FilledRows { pairs: &queue.pairs[..len], taps: &queue.taps[..len], coarse };
                // Uses loops: a closure passed to `for_each` might be compiled without the selected instruction set.
                match shader.plan {
                    plan if plan.mipmapped => {
                        queue.coarse_texels += finish_mipmapped(simd, shader, rows, pixels);
                    }
                    plan if plan.blended => finish_blended(simd, shader, rows, pixels),
                    plan if plan.space == ColorSpace::Linear => finish_light(simd, shader, rows, pixels),
                    _ => finish_codes(simd, shader, rows, pixels),
                }
            },
        );
    }

    /// Flushes the queue. Returns the number of texels that were read from coarser mip levels since the last call.
    #[inline(always)]
    pub(super) fn finish<S: Simd>(&mut self, simd: S) -> u64 {
        self.flush(simd);
        std::mem::take(&mut self.queue.coarse_texels)
    }
}
