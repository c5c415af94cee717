//! Robust contrast-adaptive sharpening: a cross of five pixels whose outer weight is as negative as it may be without a
//! channel leaving [0, 1].
//!
//! With the least and the greatest of the four around, mn and mx, a channel of the middle e stays within bounds for lobes
//! down to −min(mn, e) / (4 mx) and (1 − max(mx, e)) / (4 mn − 4); the weakest of the three channels decides. Alpha stays.

use fearless_simd::Level;
#[cfg(target_arch = "x86_64")]
use fearless_simd::kernel;
use rayon::prelude::*;

use crate::image::{Image, Rgba8};

/// The most negative weight, relative to the middle: ¼ would divide by nothing.
const MOST: f32 = -(0.25 - 1.0 / 16.0);

/// The weight of the four around relative to the middle's, from their channels in [0, 1] in the order above, left, middle,
/// right, below.
#[inline(always)]
fn lobe(cross: [[f32; 3]; 5], strength: f32) -> f32 {
    let [above, left, middle, right, below] = cross;
    let mut lobe = MOST;
    for channel in 0..3 {
        let (a, b, c, d, e) = (above[channel], left[channel], right[channel], below[channel], middle[channel]);
        let least = a.min(b).min(c.min(d));
        let greatest = a.max(b).max(c.max(d));
        // Where these divide by zero the channel is at its end already, and is not to be sharpened.
        let to_black = if greatest > 0.0 { -least.min(e) / (4.0 * greatest) } else { 0.0 };
        let to_white = if least < 1.0 { (1.0 - greatest.max(e)) / (4.0 * least - 4.0) } else { 0.0 };
        lobe = lobe.max(to_black.max(to_white));
    }
    lobe.min(0.0) * strength
}

/// The sharpened pixel.
#[inline(always)]
fn sharpen(cross: [Rgba8; 5], strength: f32) -> Rgba8 {
    let values = cross.map(|[r, g, b, _]| [f32::from(r) / 255.0, f32::from(g) / 255.0, f32::from(b) / 255.0]);
    let lobe = lobe(values, strength);
    let mut sharpened = cross[2];
    for (channel, code) in sharpened.iter_mut().enumerate().take(3) {
        let around = (values[0][channel] + values[1][channel]) + (values[3][channel] + values[4][channel]);
        let value = (lobe * around + values[2][channel]) / (4.0 * lobe + 1.0);
        *code = (255.0 * value.clamp(0.0, 1.0) + 0.5) as u8;
    }
    sharpened
}

/// One pixel, from above, left, itself, right and below.
pub(super) fn pixel(cross: [Rgba8; 5], strength: f32) -> Rgba8 {
    sharpen(cross, strength)
}

/// What the five count for in the result; they sum to one.
pub(super) fn shares(cross: [Rgba8; 5], strength: f32) -> [f32; 5] {
    let lobe = lobe(cross.map(|[r, g, b, _]| [r, g, b].map(|code| f32::from(code) / 255.0)), strength);
    let total = 4.0 * lobe + 1.0;
    [lobe / total, lobe / total, 1.0 / total, lobe / total, lobe / total]
}

/// Sharpens a picture of at least one pixel into another of its size; the outermost pixels repeat.
pub(super) fn fill(level: Level, picture: &Image<Rgba8>, strength: f32, sharpened: &mut Image<Rgba8>) {
    let last = picture.height() - 1;
    let rows = sharpened.pixels_mut().par_chunks_mut(picture.width() as usize);
    rows.enumerate().for_each(|(y, row)| {
        let y = y as u32;
        let around = [y.saturating_sub(1), y, (y + 1).min(last)].map(|y| picture.row(y));
        fill_row(level, around, strength, row);
    });
}

fn fill_row(level: Level, around: [&[Rgba8]; 3], strength: f32, row: &mut [Rgba8]) {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = level.as_avx2() {
        return fill_row_avx2(avx2, around, strength, row);
    }
    fill_row_plain(around, strength, row);
}

#[cfg(target_arch = "x86_64")]
kernel! {
    /// [`fill_row_plain`], compiled for eight lanes.
    fn fill_row_avx2(avx2: Avx2, around: [&[Rgba8]; 3], strength: f32, row: &mut [Rgba8]) {
        let _ = avx2;
        fill_row_plain(around, strength, row);
    }
}

#[inline(always)]
fn fill_row_plain([above, own, below]: [&[Rgba8]; 3], strength: f32, row: &mut [Rgba8]) {
    let last = row.len() - 1;
    for x in [0, last] {
        let (left, right) = (own[x.saturating_sub(1)], own[(x + 1).min(last)]);
        row[x] = sharpen([above[x], left, own[x], right, below[x]], strength);
    }
    let inner = last.saturating_sub(1);
    let (Some(row), Some(right)) = (row.get_mut(1..1 + inner), own.get(2..2 + inner)) else { return };
    let (above, below) = (&above[1..][..inner], &below[1..][..inner]);
    let (left, middle) = (&own[..inner], &own[1..][..inner]);
    for x in 0..inner {
        row[x] = sharpen([above[x], left[x], middle[x], right[x], below[x]], strength);
    }
}
