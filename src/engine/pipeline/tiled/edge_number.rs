//! Number types for the edge values of a triangle within a tile.
//!
//! All edge values are integers. A double can hold the edge values of any triangle; a 32-bit integer can hold those of
//! most triangles. A register holds twice as many 32-bit integers as doubles.

use std::ops::{Add, Mul, Sub};

use super::lattice::{LatticeSteps, TileLattice};
use crate::math::lanes::*;

/// Number type for edge values: a scalar, and a vector of eight.
pub(super) trait EdgeNumber: Copy + From<i32> + Add<Output = Self> + Mul<Output = Self> {
    /// Vector of eight numbers.
    type Eight<S: Simd>: Copy
        + Add<Output = Self::Eight<S>>
        + Sub<Output = Self::Eight<S>>
        + Add<Self, Output = Self::Eight<S>>
        + Mul<Output = Self::Eight<S>>
        + Mul<Self, Output = Self::Eight<S>>;

    /// Whether edges are reordered to make the last one opposite the vertex of least depth. The depth term of this edge
    /// is zero. If depth is linear in view space, edges are never reordered.
    const LAST_HAS_MIN_DEPTH: bool;

    /// Converts the number to a double, without rounding.
    fn double(self) -> f64;

    /// Returns the minimum and the maximum of a·x + b·y for x from 0 to `width` and y from 0 to `height`.
    fn reach(a: Self, b: Self, width: Self, height: Self) -> [Self; 2];

    /// Returns the distances between neighbouring samples of a lattice, as numbers of this type.
    fn steps(lattice: &TileLattice) -> &LatticeSteps<Self>;

    /// Returns whichever of the two arrays has elements of this type.
    fn pick<'a>(doubles: &'a [[f64; LANES]; 3], integers: &'a [[i32; LANES]; 3]) -> &'a [[Self; LANES]; 3];

    /// Loads eight numbers into a vector.
    fn load<S: Simd>(simd: S, numbers: &[Self; LANES]) -> Self::Eight<S>;

    /// Returns the numbers of a vector as an array.
    fn store<S: Simd>(numbers: Self::Eight<S>) -> [Self; LANES];

    /// Returns a vector with a number in all eight lanes.
    fn repeat<S: Simd>(simd: S, number: Self) -> Self::Eight<S>;

    /// Converts floats with integer values to this type.
    fn of_floats<S: Simd>(simd: S, floats: F32<S>) -> Self::Eight<S>;

    /// Converts eight numbers to doubles, without rounding.
    fn doubles<S: Simd>(simd: S, numbers: Self::Eight<S>) -> F64<S>;

    /// Returns the mask of the lanes inside the triangle: each of the three edge values is at least its threshold in
    /// `least`.
    fn inside<S: Simd>(values: [Self::Eight<S>; 3], least: [Self::Eight<S>; 3]) -> mask32x8<S>;

    /// Returns the mask of [`EdgeNumber::inside`] as the bits of an integer.
    fn inside_bits<S: Simd>(values: [Self::Eight<S>; 3], least: [Self::Eight<S>; 3]) -> u64;
}

impl EdgeNumber for f64 {
    type Eight<S: Simd> = F64<S>;

    const LAST_HAS_MIN_DEPTH: bool = false;

    #[inline(always)]
    fn double(self) -> f64 {
        self
    }

    #[inline(always)]
    fn reach(a: Self, b: Self, width: Self, height: Self) -> [Self; 2] {
        [a.min(0.0) * width + b.min(0.0) * height, a.max(0.0) * width + b.max(0.0) * height]
    }

    #[inline(always)]
    fn steps(lattice: &TileLattice) -> &LatticeSteps<Self> {
        &lattice.doubles
    }

    #[inline(always)]
    fn pick<'a>(doubles: &'a [[f64; LANES]; 3], _: &'a [[i32; LANES]; 3]) -> &'a [[Self; LANES]; 3] {
        doubles
    }

    #[inline(always)]
    fn load<S: Simd>(simd: S, numbers: &[Self; LANES]) -> F64<S> {
        F64::load_array_ref(simd, numbers)
    }

    #[inline(always)]
    fn store<S: Simd>(numbers: F64<S>) -> [Self; LANES] {
        numbers.to_array()
    }

    #[inline(always)]
    fn repeat<S: Simd>(simd: S, number: Self) -> F64<S> {
        F64::splat(simd, number)
    }

    #[inline(always)]
    fn of_floats<S: Simd>(simd: S, floats: F32<S>) -> F64<S> {
        widen(simd, floats)
    }

    #[inline(always)]
    fn doubles<S: Simd>(_: S, numbers: F64<S>) -> F64<S> {
        numbers
    }

    #[inline(always)]
    fn inside<S: Simd>(values: [F64<S>; 3], least: [F64<S>; 3]) -> mask32x8<S> {
        mask32x8::from_bitmask(values[0].simd, Self::inside_bits(values, least))
    }

    #[inline(always)]
    fn inside_bits<S: Simd>(values: [F64<S>; 3], least: [F64<S>; 3]) -> u64 {
        let all = values[0].simd_ge(least[0]) & values[1].simd_ge(least[1]) & values[2].simd_ge(least[2]);
        all.to_bitmask()
    }
}

impl EdgeNumber for i32 {
    type Eight<S: Simd> = i32x8<S>;

    const LAST_HAS_MIN_DEPTH: bool = true;

    #[inline(always)]
    fn double(self) -> f64 {
        self.into()
    }

    #[inline(always)]
    fn reach(a: Self, b: Self, width: Self, height: Self) -> [Self; 2] {
        [a.min(0) * width + b.min(0) * height, a.max(0) * width + b.max(0) * height]
    }

    #[inline(always)]
    fn steps(lattice: &TileLattice) -> &LatticeSteps<Self> {
        &lattice.integers
    }

    #[inline(always)]
    fn pick<'a>(_: &'a [[f64; LANES]; 3], integers: &'a [[i32; LANES]; 3]) -> &'a [[Self; LANES]; 3] {
        integers
    }

    #[inline(always)]
    fn load<S: Simd>(simd: S, numbers: &[Self; LANES]) -> i32x8<S> {
        i32x8::load_array_ref(simd, numbers)
    }

    #[inline(always)]
    fn store<S: Simd>(numbers: i32x8<S>) -> [Self; LANES] {
        numbers.to_array()
    }

    #[inline(always)]
    fn repeat<S: Simd>(simd: S, number: Self) -> i32x8<S> {
        i32x8::splat(simd, number)
    }

    #[inline(always)]
    fn of_floats<S: Simd>(_: S, floats: F32<S>) -> i32x8<S> {
        floats.to_int()
    }

    #[inline(always)]
    fn doubles<S: Simd>(simd: S, numbers: i32x8<S>) -> F64<S> {
        doubles_of(simd, numbers)
    }

    #[inline(always)]
    fn inside<S: Simd>(values: [i32x8<S>; 3], least: [i32x8<S>; 3]) -> mask32x8<S> {
        // There is an instruction for integer “greater”, but none for “greater or equal”.
        let outside = least[0].simd_gt(values[0]) | least[1].simd_gt(values[1]) | least[2].simd_gt(values[2]);
        !outside
    }

    #[inline(always)]
    fn inside_bits<S: Simd>(values: [i32x8<S>; 3], least: [i32x8<S>; 3]) -> u64 {
        Self::inside(values, least).to_bitmask()
    }
}
