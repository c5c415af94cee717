//! SIMD mapping of texture coordinates to texels along one axis. Results equal those of [`crate::pipeline::sample`] bit
//! for bit.

use crate::math::lanes::*;
use crate::pipeline::settings::AddressMode;

/// The two texels nearest to each of eight texture coordinates along one axis, and the weight of the second texel.
pub(super) struct TexelNeighbours<S: Simd> {
    pub(super) first: i32x8<S>,
    pub(super) second: i32x8<S>,
    pub(super) weight: F32<S>,
}

/// Number of texels along one axis, per lane: each of eight samples may read an image of a different size.
#[derive(Clone, Copy)]
pub(super) struct TexelAxis<S: Simd> {
    /// Number of texels along the axis.
    pub(super) length: F64<S>,
    /// Index of the last texel along the axis.
    pub(super) last: i32x8<S>,
}

impl<S: Simd> TexelAxis<S> {
    /// Creates an axis with the same number of texels in all lanes.
    #[inline(always)]
    pub(super) fn splat(simd: S, length: u32) -> Self {
        Self { length: F64::splat(simd, length.into()), last: i32x8::splat(simd, length as i32 - 1) }
    }

    /// Creates an axis from the number of texels in each lane.
    #[inline(always)]
    pub(super) fn of(simd: S, length: i32x8<S>) -> Self {
        Self { length: widen(simd, length.to_float()), last: length - 1 }
    }
}

/// Maps texture coordinates into [0, 1] according to an addressing mode.
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

/// Returns the index of the texel that contains each coordinate. Coordinates lie in [0, 1], and the axis has `size`
/// texels.
#[inline(always)]
pub(super) fn nearest<S: Simd>(simd: S, unit: F64<S>, size: u32) -> i32x8<S> {
    let place = (unit * f64::from(size)).trunc().min(f64::from(size - 1));
    narrow(simd, place).to_int()
}

/// Returns the two texels around each coordinate in [0, 1], and the weight of the second texel.
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

/// Finds the two texels around each position in a repeating texture. Returns, for each axis, the index of the lower
/// texel and the weight of the upper one; `None` if a position is outside the range of this fast path.
///
/// Positions are in texels, along axes whose lengths are powers of two. Texel indices may be off by multiples of the
/// length. If a position is the exact centre of a texel, this texel may be the upper one, with weight 1.
#[inline(always)]
pub(super) fn below_repeated<S: Simd>([x, y]: [f32x16<S>; 2]) -> Option<[(i32x16<S>, f32x16<S>); 2]> {
    let are_exact = (are_small(x) & are_small(y)) || (are_moderate(x) & are_moderate(y));
    if are_exact { Some(each!(position in [x, y] => below(position))) } else { None }
}

/// Returns `true` if all positions, in texels, are non-negative and less than [`ALL_INTEGERS`].
#[inline(always)]
fn are_small<S: Simd>(position: f32x16<S>) -> bool {
    // As unsigned integers, the bits of non-negative floats are ordered like their values. The bits of negative floats
    // are greater than the bits of all non-negative floats.
    position.bitcast::<u32x16<S>>().simd_lt(ALL_INTEGERS.to_bits()).all_true()
}

/// Returns `true` if the magnitudes of all positions, in texels, are less than [`ALL_INTEGERS`], and no position is
/// −0.0 or lies between −[`LEAST_BELOW_ZERO`] and zero.
#[inline(always)]
fn are_moderate<S: Simd>(position: f32x16<S>) -> bool {
    let least_below_zero = (-LEAST_BELOW_ZERO).to_bits() as i32;
    // As signed integers, the bits of −0.0 are the least integer, and the bits of negative floats increase with their
    // magnitude.
    let far_enough = position.bitcast::<i32x16<S>>().simd_ge(least_below_zero);
    (position.abs().simd_lt(ALL_INTEGERS) & far_enough).all_true()
}

/// Returns the index of the lower of the two texels around each position, and the weight of the upper one, as
/// [`neighbours`] computes them for a repeating texture. Positions are in texels, along an axis whose length is a power
/// of two. The index may be off by multiples of the length.
///
/// Every step is exact in f32 except the last sum, which rounds like the final conversion from f64 in [`neighbours`].
/// The position is exact, because it is a product with a power of two. Its distance from the nearest integer is also
/// exact, and does not depend on how often the texture has been repeated. If the position is halfway between two
/// integers, rounding may choose either: both choices give all the weight to the same texel.
#[inline(always)]
fn below<S: Simd>(position: f32x16<S>) -> (i32x16<S>, f32x16<S>) {
    let nearest = position.round_ties_even();
    (nearest.to_int::<i32x16<S>>() - 1, (position - nearest) + 0.5)
}

/// Least magnitude, in texels, of a negative position for which [`below_repeated`] is exact. As axes have at most 2¹⁶
/// texels, the texture coordinate has at least the magnitude 2⁻³⁰, and adding 1 to it in f64 is exact.
pub(super) const LEAST_BELOW_ZERO: f32 = 1.0 / 16384.0;

/// Magnitude at and above which every f32 is an integer: 2²³.
pub(super) const ALL_INTEGERS: f32 = 8_388_608.0;
