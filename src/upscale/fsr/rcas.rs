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

/// Sixteen pixels at a time where all around them lie within the row, the others one by one. The last sixteen may overlap those
/// before.
#[inline(always)]
fn fill_row<S: Simd>(simd: S, [above, own, below]: [&[Rgba8]; 3], strength: f32, row: &mut [Rgba8]) {
    let last = row.len() - 1;
    let inner = if last > WIDE { 1..last } else { 1..1 };
    for x in inner.clone().step_by(WIDE) {
        let x = x.min(last - WIDE);
        let around = [run(simd, above, x), run(simd, own, x - 1), run(simd, own, x + 1), run(simd, below, x)];
        let codes = lanes(simd, run(simd, own, x), around, strength).bitcast::<u8x64<S>>();
        codes.store_slice(row[x..x + WIDE].as_flattened_mut());
    }
    for x in (0..1).chain(inner.end..last + 1) {
        let (left, right) = (own[x.saturating_sub(1)], own[(x + 1).min(last)]);
        row[x] = pixel([above[x], left, own[x], right, below[x]], strength);
    }
}

/// Sixteen pixels from place `at` on.
#[inline(always)]
fn run<S: Simd>(simd: S, of: &[Rgba8], at: usize) -> u8x64<S> {
    u8x64::from_slice(simd, of[at..at + WIDE].as_flattened())
}

/// A channel of sixteen pixels.
#[inline(always)]
fn channel<S: Simd>(of: u8x64<S>, channel: u32) -> f32x16<S> {
    float_of((of.bitcast::<u32x16<S>>() >> (8 * channel)) & 255)
}

/// Quotients, not divided yet: of those that are compared but one counts.
#[derive(Clone, Copy)]
struct Quotient<S: Simd> {
    above: f32x16<S>,
    below: f32x16<S>,
}

impl<S: Simd> Quotient<S> {
    /// The smaller ones. The products are of codes, so they are exact, and rounding keeps the order of quotients: the smallest
    /// one divided is the smallest of all divided.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        let less = (other.above * self.below).simd_lt(self.above * other.below);
        Self { above: less.select(other.above, self.above), below: less.select(other.below, self.below) }
    }
}

/// The steps of [`pixel`] in lanes: the same divisions, of those that decide, and the same sums.
#[inline(always)]
fn lanes<S: Simd>(simd: S, own: u8x64<S>, [above, left, right, below]: [u8x64<S>; 4], strength: f32) -> u32x16<S> {
    let (zero, full) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 255.0));
    let least = above.min(left).min(right.min(below));
    let greatest = above.max(left).max(right.max(below));
    // How far the middle may sink and how far it may rise, over four times the greatest and four times what the least lacks.
    // Where that is nothing the other is, too, and one in its place makes the quotient nothing.
    let one = u8x64::splat(simd, 1);
    let (black, white) = (least.min(own), !greatest.max(own));
    let (of_black, of_white) = (greatest.max(one), (!least).max(one));
    let [red, green, blue] = each!(index in [0, 1, 2] => {
        let black = Quotient { above: channel(black, index), below: channel(of_black, index) };
        black.min(Quotient { above: channel(white, index), below: channel(of_white, index) })
    });
    let limit = red.min(green).min(blue);
    let lobe = f32x16::splat(simd, MOST).max(limit.above / (limit.below * -4.0));
    let lobe = lobe.min(zero) * strength;
    let share = f32x16::splat(simd, 1.0) / (lobe * 4.0 + 1.0);
    let mut codes = own.bitcast::<u32x16<S>>() & 0xff00_0000;
    // Sums of codes are exact in any order: two channels at a time.
    let even = (pairs(above, 0) + pairs(left, 0)) + (pairs(right, 0) + pairs(below, 0));
    let odd = (pairs(above, 8) + pairs(left, 8)) + (pairs(right, 8) + pairs(below, 8));
    let sums = [even & 0xffff, odd & 0xffff, even >> 16];
    for (index, around) in (0..3).zip(sums) {
        let value = (lobe * float_of(around) + channel(own, index)) * share;
        codes |= whole_part(value.max(zero).min(full) + 0.5) << (8 * index);
    }
    codes
}

/// Every other channel of sixteen pixels, in sixteen bits each: from bit `first` on.
#[inline(always)]
fn pairs<S: Simd>(of: u8x64<S>, first: u32) -> u32x16<S> {
    (of.bitcast::<u32x16<S>>() >> first) & 0x00ff_00ff
}
