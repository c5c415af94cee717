//! Luma of pixels as 16-bit integers, from which FXAA and SMAA find edges.

use crate::image::Rgba8;
use crate::math::lanes::*;

/// Number of pixels filtered together, one per 16-bit SIMD lane.
pub(super) const BLOCK: usize = 32;

/// Computes the luma of a row, which starts at index `before`, and repeats its first and last values in the margins.
#[inline(always)]
pub(super) fn fill_luma<S: Simd>(simd: S, pixels: &[Rgba8], before: usize, luma: &mut [i16]) {
    let (blocks, rest) = pixels.as_chunks::<BLOCK>();
    let within = &mut luma[before..];
    for (block, luma) in blocks.iter().zip(within.as_chunks_mut::<BLOCK>().0) {
        luma_of_block(simd, block).store_array(luma);
    }
    if !rest.is_empty() {
        let mut block = [[0; 4]; BLOCK];
        block[..rest.len()].copy_from_slice(rest);
        luma_of_block(simd, &block).store_slice(&mut within[blocks.len() * BLOCK..][..BLOCK]);
    }
    let (left, right) = (luma[before], luma[before + pixels.len() - 1]);
    luma[..before].fill(left);
    luma[before + pixels.len()..].fill(right);
}

/// Computes the luma of pixels: (54 r + 183 g + 19 b + 128) / 256, rounded down. The factors are the Rec. 709 weights
/// in units of 1/256.
#[inline(always)]
fn luma_of_block<S: Simd>(simd: S, pixels: &[Rgba8; BLOCK]) -> i16x32<S> {
    let halves = pixels.as_chunks::<WIDE>().0;
    let [low, high] = each!(half in [&halves[0], &halves[1]] => {
        let codes = u8x64::from_slice(simd, half.as_flattened()).bitcast::<u32x16<S>>();
        // One multiplication for red and blue: 54 r + 19 b lies in the upper half of the product, 19 r in the lower.
        let red_and_blue = ((codes & 0x00FF_00FF) * (54 << 16 | 19)) >> 16;
        (red_and_blue + (codes >> 8 & 0xFF) * 183 + 128) >> 8
    });
    low.narrow(high).bitcast()
}
