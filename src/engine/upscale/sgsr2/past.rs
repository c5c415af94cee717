//! History of sixteen pixels.

use super::super::history::{PastPlaces, centers};
use super::super::quads::{self, Quad};
use crate::image::Image;
use crate::math::lanes::*;

/// Motion of a sample, and of the pixels nearest to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SampleMotion {
    /// Motion vector, in pixels to the right and downwards; NaN if the previous frame does not show the surface.
    pub(super) vector_px: [f32; 2],
    /// Share of depth edges around the sample, in [0, 1].
    pub(super) depth_clip: f32,
}

/// Histories of sixteen pixels, one per lane. A lane without history holds zeros.
pub(super) struct PastLanes {
    /// Colour and accumulated weight.
    pub(super) color: [[f32; WIDE]; 4],
    /// 1 where there is a history, otherwise 0.
    is_known: [f32; WIDE],
    /// Position in the previous frame, in pixels.
    pub(super) place: [[f32; WIDE]; 2],
    speed_px: [f32; WIDE],
    depth_clip: [f32; WIDE],
}

/// Histories of eight pixels.
pub(super) struct Past<S: Simd> {
    pub(super) color: [F32<S>; 3],
    /// Accumulated weight, at least 0.
    pub(super) weight: F32<S>,
    pub(super) is_known: mask32x8<S>,
    pub(super) speed_px: F32<S>,
    pub(super) depth_clip: F32<S>,
}

impl SampleMotion {
    /// Motion of a surface that the previous frame does not show.
    pub(super) const UNKNOWN: Self = Self { vector_px: [f32::NAN; 2], depth_clip: 0.0 };
}

impl PastLanes {
    /// Pixels without history.
    pub(super) const NONE: Self = Self {
        color: [[0.0; WIDE]; 4],
        is_known: [0.0; WIDE],
        place: [[0.0; WIDE]; 2],
        speed_px: [0.0; WIDE],
        depth_clip: [0.0; WIDE],
    };

    /// Returns the history of sixteen pixels from pixel `at` on in a still view.
    #[inline(always)]
    pub(super) fn still<S: Simd>(simd: S, history: &Image<Quad>, at: (usize, u32)) -> Self {
        let (quads, center) = (padded(&history.row(at.1)[at.0..], [0.0; 4]), centers(simd, at));
        let place = each!(axis in [0, 1] => center[axis].to_array());
        Self { color: columns(simd, &quads), is_known: [1.0; WIDE], place, ..Self::NONE }
    }

    /// Returns the history of sixteen pixels from pixel `at` on. `motion` is the motion of their nearest samples.
    #[inline(always)]
    pub(super) fn moved<S: Simd>(
        simd: S,
        history: &Image<Quad>,
        at: (usize, u32),
        motion: &[SampleMotion; WIDE],
    ) -> Self {
        let (mut vectors, mut depth_clip) = ([[0.0; WIDE]; 2], [0.0; WIDE]);
        for (lane, motion) in motion.iter().enumerate() {
            [vectors[0][lane], vectors[1][lane]] = motion.vector_px;
            depth_clip[lane] = motion.depth_clip;
        }
        let vectors = each!(axis in [0, 1] => f32x16::load_array(simd, vectors[axis]));
        let places = PastPlaces::new(simd, at, vectors, history.size());
        let mut quads = [[0.0; 4]; WIDE];
        places.read_bilinear(simd, history, &mut quads);
        let center = centers(simd, at);
        let [across, down] = each!(axis in [0, 1] => places.place[axis] - center[axis]);
        let speed_px = (across * across + down * down).sqrt();
        let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
        Self {
            color: columns(simd, &quads),
            is_known: places.is_known.select(one, zero).to_array(),
            place: each!(axis in [0, 1] => places.place[axis].to_array()),
            speed_px: places.is_known.select(speed_px, zero).to_array(),
            depth_clip: places.is_known.select(f32x16::load_array(simd, depth_clip), zero).to_array(),
        }
    }

    /// Returns eight lanes from lane `first` on.
    #[inline(always)]
    pub(super) fn eight<S: Simd>(&self, simd: S, first: usize) -> Past<S> {
        let [y, co, cg, weight] = &self.color;
        let [y, co, cg, weight, is_known, speed_px, depth_clip] = each!(numbers in [y, co, cg, weight, &self.is_known, &self.speed_px, &self.depth_clip] => {
            F32::from_slice(simd, &numbers[first..first + LANES])
        });
        let zero = F32::splat(simd, 0.0);
        Past { color: [y, co, cg], weight: weight.max(zero), is_known: is_known.simd_gt(zero), speed_px, depth_clip }
    }
}

/// Returns the four numbers of sixteen quads, each as an array.
#[inline(always)]
fn columns<S: Simd>(simd: S, quads: &[Quad; WIDE]) -> [[f32; WIDE]; 4] {
    let columns = quads::columns(simd, quads);
    each!(i in [0, 1, 2, 3] => columns[i].to_array())
}
