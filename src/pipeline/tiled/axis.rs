//! Texel positions of texture coordinates along one axis: [`crate::pipeline::sample`] on lanes, bit for bit.

use crate::math::lanes::*;
use crate::pipeline::settings::AddressMode;

/// The two texels around a coordinate along one axis, and the weight of the second one.
pub(super) struct TexelNeighbours<S: Simd> {
    pub(super) first: i32x8<S>,
    pub(super) second: i32x8<S>,
    pub(super) weight: F32<S>,
}

/// Length in texels, along one axis, of the images that eight samples are read from.
#[derive(Clone, Copy)]
pub(super) struct TexelAxis<S: Simd> {
    /// Number of texels.
    pub(super) length: F64<S>,
    /// Index of the last texel.
    pub(super) last: i32x8<S>,
}

impl<S: Simd> TexelAxis<S> {
    /// Returns an axis with the same length for all samples.
    #[inline(always)]
    pub(super) fn splat(simd: S, length: u32) -> Self {
        Self { length: F64::splat(simd, length.into()), last: i32x8::splat(simd, length as i32 - 1) }
    }

    /// Returns an axis with a length for each sample.
    #[inline(always)]
    pub(super) fn of(simd: S, length: i32x8<S>) -> Self {
        Self { length: widen(simd, length.to_float()), last: length - 1 }
    }
}

/// Maps coordinates into [0, 1] by an addressing mode.
#[inline(always)]
pub(super) fn apply_address_mode<S: Simd>(simd: S, u: F32<S>, address: AddressMode) -> F64<S> {
    let unit = match address {
        AddressMode::Clamp => return widen(simd, u.max(0.0).min(1.0)),
        AddressMode::Repeat => widen(simd, u) - widen(simd, u.floor()),
        AddressMode::Mirror => {
            let period = widen(simd, u) - widen(simd, (u * 0.5).floor()) * 2.0;
            period.simd_gt(1.0).select(F64::splat(simd, 2.0) - period, period)
        }
    };
    unit.is_nan().select(F64::splat(simd, 0.0), unit)
}

/// Returns the index of the texel, of `size`, that contains each coordinate in [0, 1].
#[inline(always)]
pub(super) fn nearest<S: Simd>(simd: S, unit: F64<S>, size: u32) -> i32x8<S> {
    let place = (unit * f64::from(size)).trunc().min(f64::from(size - 1));
    narrow(simd, place).to_int()
}

/// Returns the two texels around coordinates in [0, 1], and the weight of the second one.
#[inline(always)]
pub(super) fn neighbours<S: Simd>(
    simd: S,
    unit: F64<S>,
    axis: TexelAxis<S>,
    address: AddressMode,
) -> TexelNeighbours<S> {
    let position = unit * axis.length - 0.5;
    let below = position.floor();
    let weight = narrow(simd, position - below);
    let below: i32x8<S> = narrow(simd, below).to_int();
    let (first, second) = (below, below + 1);
    let zero = i32x8::splat(simd, 0);
    let (before, after) = match address {
        AddressMode::Repeat => (axis.last, zero),
        AddressMode::Clamp | AddressMode::Mirror => (zero, axis.last),
    };
    TexelNeighbours {
        first: first.simd_lt(zero).select(before, first),
        second: second.simd_gt(axis.last).select(after, second),
        weight,
    }
}

/// Returns the first texel around each position of a repeated coordinate, and the weight of the texel after it.
/// Positions are in texels, along axes whose lengths are powers of two; texels may be off by multiples of the lengths.
/// Returns `None` if some positions are outside the range of this fast path. At the exact centre of a texel the result
/// may be the texel before it, which then has no weight.
#[inline(always)]
pub(super) fn below_repeated<S: Simd>([x, y]: [f32x16<S>; 2]) -> Option<[(i32x16<S>, f32x16<S>); 2]> {
    let are_exact = (are_small(x) & are_small(y)) || (are_moderate(x) & are_moderate(y));
    if are_exact { Some(each!(position in [x, y] => below(position))) } else { None }
}

/// Whether all positions are non-negative and small enough to have a fraction.
#[inline(always)]
fn are_small<S: Simd>(position: f32x16<S>) -> bool {
    // Bits of non-negative floats have the order of their values; bits of negative floats are greater.
    position.bitcast::<u32x16<S>>().simd_lt(ALL_INTEGERS.to_bits()).all_true()
}

/// Whether all positions are small enough to have a fraction, and none is so close below zero that [`neighbours`]
/// rounds it.
#[inline(always)]
fn are_moderate<S: Simd>(position: f32x16<S>) -> bool {
    let least_below_zero = (-LEAST_BELOW_ZERO).to_bits() as i32;
    // Bits of negative floats, as signed integers, begin with the least integer and grow away from zero.
    let far_enough = position.bitcast::<i32x16<S>>().simd_ge(least_below_zero);
    (position.abs().simd_lt(ALL_INTEGERS) & far_enough).all_true()
}

/// Returns the result of [`neighbours`] for the position of a repeated coordinate in texels, for a size that is a power
/// of two. The texel may be off by multiples of the size.
///
/// Every step is exact in f32 except the last sum, which rounds as f64 does at its end. The product with a power of two
/// is exact. So is the distance from the nearest integer, which whole repeats do not change. Halfway between two
/// integers either may be chosen: the texel then has all the weight, as the first or as the second of the two.
#[inline(always)]
fn below<S: Simd>(position: f32x16<S>) -> (i32x16<S>, f32x16<S>) {
    let nearest = position.round_ties_even();
    (nearest.to_int::<i32x16<S>>() - 1, (position - nearest) + 0.5)
}

/// Magnitude below which negative positions, in textures of up to 2¹⁶ texels, have digits that f64 cannot hold next to
/// 1.
pub(super) const LEAST_BELOW_ZERO: f32 = 1.0 / 16384.0;

/// Magnitude from which every float is an integer: 2²³.
pub(super) const ALL_INTEGERS: f32 = 8_388_608.0;
