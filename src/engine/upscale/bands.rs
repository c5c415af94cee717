//! Bands of image rows, distributed among threads.

use rayon::prelude::*;

use super::Scale;
use crate::image::{Image, Rgba8};

/// Minimum number of rows in a band. Adjacent bands both process the sample rows at their boundary; bands of this size
/// make that extra work small.
const MIN_ROWS: usize = 48;

/// Number of bands per thread. With more than one, a delayed thread does not delay the whole image.
const BANDS_PER_THREAD: usize = 2;

/// Returns the number of rows in a band. Bands start at block boundaries of `scale`, so that per-block work is not
/// duplicated. With one thread there is a single band on the calling thread, because waking another thread takes a
/// quarter of the time of a fast kernel.
fn rows_of_band(height: usize, scale: Scale) -> usize {
    let bands = match rayon::current_num_threads() {
        1 => 1,
        threads => threads * BANDS_PER_THREAD,
    };
    let (pixels, _) = scale.ratio();
    height.div_ceil(bands).max(MIN_ROWS).next_multiple_of(pixels as usize)
}

/// Calls `fill` for every band of an image on the current rayon pool, with the band's first row, row count and pixels.
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

/// Calls `fill` for every band of two images of equal size, like [`fill`]. The arguments are the first row of the band
/// and its pixels in both images.
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

/// Calls `fill` for every band of three images of equal size, like [`fill_both`].
pub(super) fn fill_three<A: Copy + Send, B: Copy + Send, C: Copy + Send>(
    one: &mut Image<A>,
    two: &mut Image<B>,
    three: &mut Image<C>,
    fill: impl Fn(u32, &mut [A], &mut [B], &mut [C]) + Sync,
) {
    let (width, height) = (one.width() as usize, one.height() as usize);
    if width == 0 || height == 0 {
        return;
    }
    let rows = rows_of_band(height, Scale::ONE);
    let (two, three) = (two.pixels_mut(), three.pixels_mut());
    one.pixels_mut()
        .par_chunks_mut(rows * width)
        .zip(two.par_chunks_mut(rows * width).zip(three.par_chunks_mut(rows * width)))
        .enumerate()
        .for_each(|(band, (one, (two, three)))| fill((band * rows) as u32, one, two, three));
}
