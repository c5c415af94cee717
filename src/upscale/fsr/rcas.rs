//! Robust contrast-adaptive sharpening: a cross of five pixels whose outer weight is as negative as it may be without a
//! channel leaving [0, 1].
//!
//! With the least and the greatest of the four around, mn and mx, a channel of the middle e stays within bounds for lobes
//! down to −min(mn, e) / (4 mx) and (1 − max(mx, e)) / (4 mn − 4); the weakest of the three channels decides. Alpha stays.

use crate::image::{Image, Rgba8};
use crate::math::lanes::*;

/// The most negative weight, relative to the middle: ¼ would divide by nothing.
const MOST: f32 = -(0.25 - 1.0 / 16.0);

/// The weight of the four around relative to the middle's, from codes in the order above, left, middle, right, below.
fn lobe(cross: [[f32; 3]; 5], strength: f32) -> f32 {
    let [above, left, middle, right, below] = cross;
    let mut lobe = MOST;
    for channel in 0..3 {
        let (a, b, c, d, e) = (above[channel], left[channel], right[channel], below[channel], middle[channel]);
        let least = a.min(b).min(c.min(d));
        let greatest = a.max(b).max(c.max(d));
        // Where these divide by zero the channel is at its end already, and is not to be sharpened.
        let to_black = if greatest > 0.0 { least.min(e) / (greatest * -4.0) } else { 0.0 };
        let to_white = if least < 255.0 { (255.0 - greatest.max(e)) / (least * 4.0 - 1020.0) } else { 0.0 };
        lobe = lobe.max(to_black.max(to_white));
    }
    lobe.min(0.0) * strength
}

fn colors([r, g, b, _]: Rgba8) -> [f32; 3] {
    [r, g, b].map(f32::from)
}

/// One pixel, from above, left, itself, right and below.
pub(super) fn pixel(cross: [Rgba8; 5], strength: f32) -> Rgba8 {
    let values = cross.map(colors);
    let lobe = lobe(values, strength);
    let share = 1.0 / (lobe * 4.0 + 1.0);
    let mut sharpened = cross[2];
    for (channel, code) in sharpened.iter_mut().enumerate().take(3) {
        let around = (values[0][channel] + values[1][channel]) + (values[3][channel] + values[4][channel]);
        let value = (lobe * around + values[2][channel]) * share;
        *code = (value.clamp(0.0, 255.0) + 0.5) as u8;
    }
    sharpened
}

/// What the five count for in the result; they sum to one.
pub(super) fn shares(cross: [Rgba8; 5], strength: f32) -> [f32; 5] {
    let lobe = lobe(cross.map(colors), strength);
    let total = lobe * 4.0 + 1.0;
    [lobe / total, lobe / total, 1.0 / total, lobe / total, lobe / total]
}

/// Sharpens the rows of a picture from row `above` on into others; where the picture ends its outermost pixels repeat.
pub(super) fn fill(lanes: Lanes, picture: &Image<Rgba8>, above: u32, strength: f32, sharpened: &mut [Rgba8]) {
    let last = picture.height() - 1;
    for (row, y) in sharpened.chunks_exact_mut(picture.width() as usize).zip(above..) {
        let around = [y.saturating_sub(1), y, (y + 1).min(last)].map(|y| picture.row(y));
        on_lanes!(lanes, simd => fill_row(simd, around, strength, row));
    }
}

/// Eight pixels at a time where all around them lie within the row, the others one by one.
#[inline(always)]
fn fill_row<S: Simd>(simd: S, [above, own, below]: [&[Rgba8]; 3], strength: f32, row: &mut [Rgba8]) {
    let last = row.len() - 1;
    let mut x = 1;
    while x + LANES <= last {
        let beside = (run(simd, own, x - 1), run(simd, own, x + 1));
        let codes = lanes(simd, run(simd, own, x), (run(simd, above, x), run(simd, below, x)), beside, strength);
        let codes: [u32; LANES] = codes.into();
        for index in 0..LANES {
            row[x + index] = codes[index].to_le_bytes();
        }
        x += LANES;
    }
    for x in (0..1).chain(x..last + 1) {
        let (left, right) = (own[x.saturating_sub(1)], own[(x + 1).min(last)]);
        row[x] = pixel([above[x], left, own[x], right, below[x]], strength);
    }
}

/// Eight pixels from place `at` on, each as its four codes, the first in the lowest byte.
#[inline(always)]
fn run<S: Simd>(simd: S, of: &[Rgba8], at: usize) -> u32x8<S> {
    let colors = &of[at..at + LANES];
    let mut codes = [0; LANES];
    for index in 0..LANES {
        codes[index] = u32::from_le_bytes(colors[index]);
    }
    u32x8::simd_from(simd, codes)
}

/// A channel of eight pixels.
#[inline(always)]
fn channel<S: Simd>(of: u32x8<S>, channel: u32) -> f32x8<S> {
    f32x8::float_from((of >> (8 * channel)) & 255)
}

/// The least lobe that a channel allows.
#[inline(always)]
fn limit<S: Simd>(simd: S, [above, left, own, right, below]: [u32x8<S>; 5], index: u32) -> f32x8<S> {
    let (zero, full) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 255.0));
    let (a, b, c, d) = (channel(above, index), channel(left, index), channel(right, index), channel(below, index));
    let e = channel(own, index);
    let least = a.min(b).min(c.min(d));
    let greatest = a.max(b).max(c.max(d));
    let to_black = zero.simd_lt(greatest).select(least.min(e) / (greatest * -4.0), zero);
    let to_white = least.simd_lt(full).select((full - greatest.max(e)) / (least * 4.0 - 1020.0), zero);
    to_black.max(to_white)
}

/// The steps of [`pixel`] in lanes, with the same sums in the same order.
#[inline(always)]
fn lanes<S: Simd>(
    simd: S,
    own: u32x8<S>,
    (above, below): (u32x8<S>, u32x8<S>),
    (left, right): (u32x8<S>, u32x8<S>),
    strength: f32,
) -> u32x8<S> {
    let (zero, full) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 255.0));
    let cross = [above, left, own, right, below];
    let limits = limit(simd, cross, 0).max(limit(simd, cross, 1)).max(limit(simd, cross, 2));
    let lobe = f32x8::splat(simd, MOST).max(limits);
    let lobe = lobe.min(zero) * strength;
    let share = f32x8::splat(simd, 1.0) / (lobe * 4.0 + 1.0);
    let mut codes = own & 0xff00_0000;
    for index in 0..3 {
        let around = (channel(above, index) + channel(left, index)) + (channel(right, index) + channel(below, index));
        let value = (lobe * around + channel(own, index)) * share;
        codes |= u32x8::truncate_from(value.max(zero).min(full) + 0.5) << (8 * index);
    }
    codes
}
