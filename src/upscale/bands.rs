//! The rows of a picture, shared among threads.

use rayon::prelude::*;

use super::Scale;
use crate::image::{Image, Rgba8};

/// Fewest rows of a band: enough to make good the few rows of samples that neighbouring bands both look at.
const LEAST_ROWS: usize = 48;

/// Bands per thread, so that a thread that was held up does not hold up all.
const BANDS_PER_THREAD: usize = 2;

/// Rows of a band. Bands begin where the blocks of a `scale` do, as what is found for a block would be found twice. One thread
/// has one band, and is the caller's own: to wake another takes as long as a quarter of a fast kernel.
fn rows_of_band(height: usize, scale: Scale) -> usize {
    let bands = match rayon::current_num_threads() {
        1 => 1,
        threads => threads * BANDS_PER_THREAD,
    };
    let (pixels, _) = scale.ratio();
    height.div_ceil(bands).max(LEAST_ROWS).next_multiple_of(pixels as usize)
}

/// Calls `fill` for every band of a picture, on the threads of the present rayon pool: with its first row, how many there
/// are, and their pixels.
pub(super) fn fill(full: &mut Image<Rgba8>, scale: Scale, fill: impl Fn(u32, usize, &mut [Rgba8]) + Sync) {
    let (width, height) = (full.width() as usize, full.height() as usize);
    if width == 0 || height == 0 {
        return;
    }
    let rows = rows_of_band(height, scale);
    full.pixels_mut()
        .par_chunks_mut(rows * width)
        .enumerate()
        .for_each(|(band, pixels)| fill((band * rows) as u32, pixels.len() / width, pixels));
}

/// [`fill`] for two pictures of one size: with the first row of a band and its pixels in both.
pub(super) fn fill_both<A: Copy + Send, B: Copy + Send>(
    one: &mut Image<A>,
    other: &mut Image<B>,
    fill: impl Fn(u32, &mut [A], &mut [B]) + Sync,
) {
    let (width, height) = (one.width() as usize, one.height() as usize);
    if width == 0 || height == 0 {
        return;
    }
    let rows = rows_of_band(height, Scale::ONE);
    let (one, other) = (one.pixels_mut(), other.pixels_mut());
    one.par_chunks_mut(rows * width)
        .zip(other.par_chunks_mut(rows * width))
        .enumerate()
        .for_each(|(band, (one, other))| fill((band * rows) as u32, one, other));
}
