//! The rows of a picture, shared among threads.

use rayon::prelude::*;

use super::Scale;
use crate::image::{Image, Rgba8};

/// Fewest rows of a band: enough to make good the few rows of samples that neighbouring bands both look at.
const LEAST_ROWS: usize = 48;

/// Bands per thread, so that a thread that was held up does not hold up all.
const BANDS_PER_THREAD: usize = 2;

/// Calls `fill` for every band of a picture, on the threads of the present rayon pool: with its first row, how many there
/// are, and their pixels. Bands begin where the blocks of a `scale` do, as what is found for a block would be found twice.
/// One thread has one band, and is the caller's own: to wake another takes as long as a quarter of a fast kernel.
pub(super) fn fill(full: &mut Image<Rgba8>, scale: Scale, fill: impl Fn(u32, usize, &mut [Rgba8]) + Sync) {
    let (width, height) = (full.width() as usize, full.height() as usize);
    if width == 0 || height == 0 {
        return;
    }
    let bands = match rayon::current_num_threads() {
        1 => 1,
        threads => threads * BANDS_PER_THREAD,
    };
    let (pixels, _) = scale.ratio();
    let rows = height.div_ceil(bands).max(LEAST_ROWS).next_multiple_of(pixels as usize);
    full.pixels_mut()
        .par_chunks_mut(rows * width)
        .enumerate()
        .for_each(|(band, pixels)| fill((band * rows) as u32, pixels.len() / width, pixels));
}

/// Fills a picture pixel by pixel, from column and row, on all threads.
pub(super) fn fill_pixels<T: Copy + Send>(full: &mut Image<T>, pixel: impl Fn((u32, u32)) -> T + Sync) {
    let (width, height) = full.size();
    let rows = full.pixels_mut().par_chunks_mut((width as usize).max(1));
    rows.zip(0..height).for_each(|(row, y)| {
        for (into, x) in row.iter_mut().zip(0..) {
            *into = pixel((x, y));
        }
    });
}
