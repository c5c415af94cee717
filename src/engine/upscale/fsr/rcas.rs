//! Robust contrast-adaptive sharpening (RCAS): a weighted sum of a cross of five pixels.
//!
//! The weight of the four outer pixels, called the lobe, is as negative as possible without any channel leaving [0, 1].
//!
//! Let mn and mx be the minimum and maximum of the four neighbours. A channel e of the centre stays in range for lobes
//! down to −min(mn, e) / (4 mx) and (1 − max(mx, e)) / (4 mn − 4). Of the limits of the three channels, the one nearest
//! to zero applies, but the lobe is at least −3/16, because −¼ would divide by zero. Alpha is unchanged.
//!
//! With the lobe l and the sum s of the four neighbours, (l s + e) / (4 l + 1) equals e + q (4 e − s), where q = −l /
//! (4 l + 1). Quotients are compared and sums computed in integers. q is a multiple of 2⁻¹⁵. Its product with 4 e − s
//! is rounded to 1/32 of an 8-bit step. Rounding changes a colour by less than 1/20 of a step.

use super::words::{self, times};
use crate::image::Rgba8;
use crate::math::lanes::*;

/// Maximum of −4 l, where l is the lobe.
const MAX_LOBE: f32 = 0.75;

/// Number of fractional bits of a sharpened 8-bit value.
const POINT: u32 = 5;

/// Half an 8-bit step, with [`POINT`] fractional bits.
const HALF: i16 = 1 << (POINT - 1);

/// Quotient of two 8-bit values, kept as a fraction: quotients are compared without a division, and only the smallest
/// one is computed.
#[derive(Clone, Copy)]
struct Quotient<T> {
    numerator: T,
    denominator: T,
}

impl Quotient<u16> {
    /// Returns the smaller quotient, or the first if they are equal.
    fn min(self, other: Self) -> Self {
        if self.numerator * other.denominator <= other.numerator * self.denominator { self } else { other }
    }

    /// Returns the upper limit of −4 l for one channel. It is the smaller of two limits: the first keeps the result
    /// from falling below 0, the second from exceeding 1. If a denominator is zero, so is its numerator; replacing the
    /// denominator by 1 makes the quotient zero.
    fn of_channel(above: u8, left: u8, own: u8, right: u8, below: u8) -> Self {
        let least = above.min(left).min(right.min(below));
        let greatest = above.max(left).max(right.max(below));
        let quotient = |numerator: u8, denominator: u8| Self {
            numerator: numerator.into(),
            denominator: denominator.max(1).into(),
        };
        quotient(least.min(own), greatest).min(quotient(!greatest.max(own), !least))
    }

    /// Returns the sharpening weight q for a strength in [0, 1], in units of 2⁻¹⁵.
    fn weight(self, strength: f32) -> i16 {
        let [numerator, denominator] = [self.numerator, self.denominator].map(f32::from);
        let numerator = numerator.min(denominator * MAX_LOBE) * strength;
        (numerator * 8192.0 / (denominator - numerator) + 0.5) as i16
    }
}

/// Returns the sharpening weight q from the pixels above, left, centre, right and below, in units of 2⁻¹⁵.
fn weight([above, left, own, right, below]: [Rgba8; 5], strength: f32) -> i16 {
    let [red, green, blue] = [0, 1, 2].map(|channel| {
        Quotient::of_channel(above[channel], left[channel], own[channel], right[channel], below[channel])
    });
    red.min(green).min(blue).weight(strength)
}

/// Sharpens one pixel, given the pixels above, left, centre, right and below.
pub(super) fn pixel(cross: [Rgba8; 5], strength: f32) -> Rgba8 {
    let weight = weight(cross, strength);
    let mut sharpened = cross[2];
    for (channel, code) in sharpened.iter_mut().enumerate().take(3) {
        let [above, left, own, right, below] = cross.map(|color| i16::from(color[channel]));
        let apart = own * 4 - ((above + left) + (right + below));
        let more = (words::times_one(weight, apart << POINT) + HALF) >> POINT;
        *code = (own + more).clamp(0, 255) as u8;
    }
    sharpened
}

/// Returns the weights of the five pixels in the sharpened pixel; they sum to 1.
pub(super) fn shares(cross: [Rgba8; 5], strength: f32) -> [f32; 5] {
    let weight = f32::from(weight(cross, strength)) / 32768.0;
    [-weight, -weight, 1.0 + 4.0 * weight, -weight, -weight]
}

/// RCAS sharpening with a given strength, on a SIMD instruction set.
pub(super) struct Sharpening {
    pub(super) lanes: Lanes,
    /// Strength in [0, 1].
    pub(super) strength: f32,
}

impl Sharpening {
    /// Sharpens rows of `width` px. The first sharpened row is row `above` of the input. Border rows are repeated.
    pub(super) fn fill(&self, rows: &[Rgba8], width: usize, above: usize, sharpened: &mut [Rgba8]) {
        let last = rows.len() / width - 1;
        for (row, y) in sharpened.chunks_exact_mut(width).zip(above..) {
            let around = [y.saturating_sub(1), y, (y + 1).min(last)].map(|y| &rows[y * width..][..width]);
            on_lanes!(self.lanes, simd => fill_row(simd, around, self.strength, row));
        }
    }
}

/// Number of 16-pixel runs whose weights are computed before any is used. Each weight is a dependency chain of products
/// and a division; interleaving runs hides its latency.
const RUNS: usize = 8;

/// Sharpens the interior of a row 16 pixels at a time and the border pixels one by one. The last group of 16 may
/// overlap the previous one.
#[inline(always)]
fn fill_row<S: Simd>(simd: S, rows: [&[Rgba8]; 3], strength: f32, row: &mut [Rgba8]) {
    let last = row.len() - 1;
    let inner = if last > WIDE { 1..last } else { 1..1 };
    for first in inner.clone().step_by(RUNS * WIDE) {
        let places = (first..inner.end.min(first + RUNS * WIDE)).step_by(WIDE);
        let mut weights = [[0; WIDE]; RUNS];
        for (weights, x) in weights.iter_mut().zip(places.clone()) {
            let (own, around) = cross(simd, rows, x.min(last - WIDE));
            wide_weight(simd, own, around, strength).store_array(weights);
        }
        for (weights, x) in weights.iter().zip(places) {
            let x = x.min(last - WIDE);
            let (own, around) = cross(simd, rows, x);
            let codes = wide_pixels(own, around, u32x16::load_array_ref(simd, weights));
            codes.store_slice(row[x..x + WIDE].as_flattened_mut());
        }
    }
    let [above, own, below] = rows;
    for x in (0..1).chain(inner.end..last + 1) {
        let (left, right) = (own[x.saturating_sub(1)], own[(x + 1).min(last)]);
        row[x] = pixel([above[x], left, own[x], right, below[x]], strength);
    }
}

/// Loads 16 pixels from index `at` on, and their neighbours above, left, right and below.
#[inline(always)]
fn cross<S: Simd>(simd: S, [above, own, below]: [&[Rgba8]; 3], at: usize) -> (u8x64<S>, [u8x64<S>; 4]) {
    (run(simd, own, at), [run(simd, above, at), run(simd, own, at - 1), run(simd, own, at + 1), run(simd, below, at)])
}

/// Loads 16 pixels from index `at` on.
#[inline(always)]
fn run<S: Simd>(simd: S, of: &[Rgba8], at: usize) -> u8x64<S> {
    u8x64::from_slice(simd, of[at..at + WIDE].as_flattened())
}

/// Extracts red and blue of 16 pixels as 16-bit values.
#[inline(always)]
fn even<S: Simd>(of: u8x64<S>) -> u16x32<S> {
    of.bitcast::<u16x32<S>>() & 255
}

/// Extracts green and alpha of 16 pixels as 16-bit values.
#[inline(always)]
fn odd<S: Simd>(of: u8x64<S>) -> u16x32<S> {
    of.bitcast::<u16x32<S>>() >> 8
}

impl<S: Simd> Quotient<u16x32<S>> {
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        let keep = (self.numerator * other.denominator).simd_le(other.numerator * self.denominator);
        Self {
            numerator: keep.select(self.numerator, other.numerator),
            denominator: keep.select(self.denominator, other.denominator),
        }
    }
}

/// Computes the sharpening weights q of 16 pixels, bit-identical to [`weight`].
#[inline(always)]
fn wide_weight<S: Simd>(
    simd: S,
    own: u8x64<S>,
    [above, left, right, below]: [u8x64<S>; 4],
    strength: f32,
) -> u32x16<S> {
    let least = above.min(left).min(right.min(below));
    let greatest = above.max(left).max(right.max(below));
    // The numerator of alpha is 255, so its quotient is at least 1: never smaller than those of the colours, and never
    // chosen.
    let (one, alpha) = (u8x64::splat(simd, 1), u32x16::splat(simd, 0xff00_0000).bitcast::<u8x64<S>>());
    let (black, white) = (least.min(own) | alpha, !greatest.max(own) | alpha);
    let (of_black, of_white) = (greatest.max(one), (!least).max(one));
    let red_blue = Quotient { numerator: even(black), denominator: even(of_black) }
        .min(Quotient { numerator: even(white), denominator: even(of_white) });
    let green = Quotient { numerator: odd(black), denominator: odd(of_black) }
        .min(Quotient { numerator: odd(white), denominator: odd(of_white) });
    // Green occupies the positions of red here, so the other positions hold blue.
    let red_or_green = red_blue.min(green);
    let blue = Quotient {
        numerator: (red_or_green.numerator.bitcast::<u32x16<S>>() >> 16).bitcast(),
        denominator: (red_or_green.denominator.bitcast::<u32x16<S>>() >> 16).bitcast(),
    };
    let limit = red_or_green.min(blue);
    let [numerator, denominator] =
        each!(of in [limit.numerator, limit.denominator] => float_of(of.bitcast::<u32x16<S>>() & 0xffff));
    let numerator = numerator.min(denominator * MAX_LOBE) * strength;
    whole_part(numerator * 8192.0 / (denominator - numerator) + 0.5)
}

/// Sharpens 16 pixels, given their weights q; bit-identical to [`pixel`].
#[inline(always)]
fn wide_pixels<S: Simd>(own: u8x64<S>, [above, left, right, below]: [u8x64<S>; 4], weight: u32x16<S>) -> u8x64<S> {
    let red_blue = sharpened(
        even(own),
        (even(above) + even(left)) + (even(right) + even(below)),
        (weight | weight << 16).bitcast(),
    );
    let green = sharpened(odd(own), (odd(above) + odd(left)) + (odd(right) + odd(below)), weight.bitcast());
    (red_blue | green << 8).bitcast()
}

/// Sharpens 32 8-bit values, given the sums of their four neighbours and the weights q.
#[inline(always)]
fn sharpened<S: Simd>(own: u16x32<S>, around: u16x32<S>, weight: i16x32<S>) -> u16x32<S> {
    let (own, around) = (own.bitcast::<i16x32<S>>(), around.bitcast::<i16x32<S>>());
    let (low, high) = ((own * 4 - around) << POINT).split();
    let (low_weight, high_weight) = weight.split();
    let more = (times(low, low_weight).combine(times(high, high_weight)) + HALF) >> POINT;
    (own + more).max(0).min(255).bitcast()
}
