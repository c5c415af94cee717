//! Where texture coordinates fall among the texels along one axis: [`crate::pipeline::sample`] on lanes, bit for bit.

use crate::math::lanes::*;
use crate::pipeline::settings::Address;

/// The two texels around a coordinate along one axis, and the weight of the second one.
pub(super) struct Neighbours<S: Simd> {
    pub(super) first: i32x8<S>,
    pub(super) second: i32x8<S>,
    pub(super) weight: F32<S>,
}

/// The texels along one axis of the images that eight samples are read from.
#[derive(Clone, Copy)]
pub(super) struct Axis<S: Simd> {
    /// How many there are.
    pub(super) length: F64<S>,
    /// Number of the last one.
    pub(super) last: i32x8<S>,
}

impl<S: Simd> Axis<S> {
    /// The same for all samples.
    #[inline(always)]
    pub(super) fn splat(simd: S, length: u32) -> Self {
        Self { length: F64::splat(simd, length.into()), last: i32x8::splat(simd, length as i32 - 1) }
    }

    /// Of a length for each sample.
    #[inline(always)]
    pub(super) fn of(simd: S, length: i32x8<S>) -> Self {
        Self { length: widen(simd, length.to_float()), last: length - 1 }
    }
}

/// Coordinates in [0, 1] that mean the same under an addressing mode.
#[inline(always)]
pub(super) fn bring_into_unit<S: Simd>(simd: S, u: F32<S>, address: Address) -> F64<S> {
    let unit = match address {
        Address::Clamp => return widen(simd, u.max(0.0).min(1.0)),
        Address::Repeat => widen(simd, u) - widen(simd, u.floor()),
        Address::Mirror => {
            let period = widen(simd, u) - widen(simd, (u * 0.5).floor()) * 2.0;
            period.simd_gt(1.0).select(F64::splat(simd, 2.0) - period, period)
        }
    };
    unit.is_nan().select(F64::splat(simd, 0.0), unit)
}

/// The texel that coordinates in [0, 1] lie in, of so many.
#[inline(always)]
pub(super) fn nearest<S: Simd>(simd: S, unit: F64<S>, size: u32) -> i32x8<S> {
    let place = (unit * f64::from(size)).trunc().min(f64::from(size - 1));
    narrow(simd, place).to_int()
}

/// The texels around coordinates in [0, 1].
#[inline(always)]
pub(super) fn neighbours<S: Simd>(simd: S, unit: F64<S>, axis: Axis<S>, address: Address) -> Neighbours<S> {
    let position = unit * axis.length - 0.5;
    let below = position.floor();
    let weight = narrow(simd, position - below);
    let below: i32x8<S> = narrow(simd, below).to_int();
    let (first, second) = (below, below + 1);
    let zero = i32x8::splat(simd, 0);
    let (before, after) = match address {
        Address::Repeat => (axis.last, zero),
        Address::Clamp | Address::Mirror => (zero, axis.last),
    };
    Neighbours {
        first: first.simd_lt(zero).select(before, first),
        second: second.simd_gt(axis.last).select(after, second),
        weight,
    }
}

/// For positions of repeated coordinates in texels, along axes that are powers of two, the texels at or before them, but for
/// multiples of the lengths, and the weights of the ones after those; none if some of them are out of the ordinary. Where a
/// position is the very centre of a texel this may be the one before, without any weight.
#[inline(always)]
pub(super) fn below_repeated<S: Simd>([x, y]: [f32x16<S>; 2]) -> Option<[(i32x16<S>, f32x16<S>); 2]> {
    let are_exact = (are_small(x) & are_small(y)) || (are_moderate(x) & are_moderate(y));
    if are_exact { Some(each!(position in [x, y] => below(position))) } else { None }
}

/// Whether positions are neither negative nor so large that they have no broken part: those of all samples.
#[inline(always)]
fn are_small<S: Simd>(position: f32x16<S>) -> bool {
    // Bits of floats that are not negative are in the order of what they stand for; those of others are greater.
    position.bitcast::<u32x16<S>>().simd_lt(ALL_INTEGERS.to_bits()).all_true()
}

/// Whether positions are of either sign, but not so near below zero that [`neighbours`] rounds them: those of all samples.
#[inline(always)]
fn are_moderate<S: Simd>(position: f32x16<S>) -> bool {
    let least_below_zero = (-LEAST_BELOW_ZERO).to_bits() as i32;
    // Bits of negative floats, taken as integers, begin with the least of these and grow away from zero.
    let far_enough = position.bitcast::<i32x16<S>>().simd_ge(least_below_zero);
    (position.abs().simd_lt(ALL_INTEGERS) & far_enough).all_true()
}

/// What [`neighbours`] finds for the position of a repeated coordinate in texels, with a size that is a power of two; the texel may
/// be off by multiples of the size.
///
/// Every step is exact in f32 but the last sum, which rounds what f64 rounds at its end: the product with a power of two is
/// exact, and so is the distance from the nearest whole number, which whole repeats do not change. Halfway between two of them
/// it does not matter which one is taken: the texel has all the weight as the first of two as well as as the second.
#[inline(always)]
fn below<S: Simd>(position: f32x16<S>) -> (i32x16<S>, f32x16<S>) {
    let nearest = position.round_ties_even();
    (nearest.to_int::<i32x16<S>>() - 1, (position - nearest) + 0.5)
}

/// Nearer to zero, negative positions in textures of up to 2¹⁶ texels have digits that f64 cannot hold together with one.
pub(super) const LEAST_BELOW_ZERO: f32 = 1.0 / 16384.0;

/// From here on every float is a whole number.
pub(super) const ALL_INTEGERS: f32 = 8_388_608.0;
