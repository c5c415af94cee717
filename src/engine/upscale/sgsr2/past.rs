//! History of sixteen pixels.

use super::super::history::{PastPlaces, centers};
use super::super::quads::{self, Quad};
use super::super::row_parts::RowBlock;
use crate::image::Image;
use crate::math::lanes::*;

/// Motion of the samples nearest to sixteen pixels.
#[derive(Clone, Copy)]
pub(super) struct MotionLanes<S: Simd> {
    /// Motion vectors, in pixels to the right and downwards; NaN if the previous frame does not show the surface.
    pub(super) vector_px: [f32x16<S>; 2],
    /// Share of depth edges around the sample, in [0, 1].
    pub(super) depth_clip: f32x16<S>,
}

/// Histories of sixteen pixels. A lane without history holds zeros.
pub(super) struct Past<S: Simd> {
    pub(super) color: [f32x16<S>; 3],
    /// Accumulated weight, at least 0.
    pub(super) weight: f32x16<S>,
    pub(super) is_known: mask32x16<S>,
    /// Position in the previous frame, in pixels.
    pub(super) place: [f32x16<S>; 2],
    pub(super) speed_px: f32x16<S>,
    pub(super) depth_clip: f32x16<S>,
}

impl<S: Simd> MotionLanes<S> {
    /// Returns the motion of surfaces that the previous frame does not show.
    #[inline(always)]
    pub(super) fn unknown(simd: S) -> Self {
        Self { vector_px: [f32x16::splat(simd, f32::NAN); 2], depth_clip: f32x16::splat(simd, 0.0) }
    }
}

impl<S: Simd> Past<S> {
    /// Returns the state of pixels without history.
    #[inline(always)]
    pub(super) fn none(simd: S) -> Self {
        let zero = f32x16::splat(simd, 0.0);
        Self {
            color: [zero; 3],
            weight: zero,
            is_known: zero.simd_gt(zero),
            place: [zero; 2],
            speed_px: zero,
            depth_clip: zero,
        }
    }

    /// Returns the history of sixteen pixels in a still view.
    #[inline(always)]
    pub(super) fn still(simd: S, history: &Image<Quad>, at: RowBlock) -> Self {
        let [y, co, cg, weight] = quads::columns(simd, &padded(&history.row(at.y)[at.from..], [0.0; 4]));
        let zero = f32x16::splat(simd, 0.0);
        Self {
            color: [y, co, cg],
            weight: weight.max(zero),
            is_known: zero.simd_eq(zero),
            place: centers(simd, at),
            speed_px: zero,
            depth_clip: zero,
        }
    }

    /// Returns the history of sixteen pixels.
    #[inline(always)]
    pub(super) fn moved(simd: S, history: &Image<Quad>, at: RowBlock, motion: &MotionLanes<S>) -> Self {
        let places = PastPlaces::new(simd, at, motion.vector_px, history.size());
        let mut quads = [[0.0; 4]; WIDE];
        places.read_bilinear(simd, history, &mut quads);
        let [y, co, cg, weight] = quads::columns(simd, &quads);
        let center = centers(simd, at);
        let [across, down] = each!(axis in [0, 1] => places.place[axis] - center[axis]);
        let (zero, is_known) = (f32x16::splat(simd, 0.0), places.is_known);
        Self {
            color: [y, co, cg],
            weight: weight.max(zero),
            is_known,
            place: places.place,
            speed_px: is_known.select((across * across + down * down).sqrt(), zero),
            depth_clip: is_known.select(motion.depth_clip, zero),
        }
    }
}
