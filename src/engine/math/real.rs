//! Numbers that a formula is written for once: floats that draw pictures, lanes that draw several samples at a time,
//! and expressions that explain the result.

use std::ops::{Add, Div, Mul, Sub};

use super::lanes::{Select as _, Simd, SimdBase, SimdFloat, f32x8, f32x16, f64x8};

/// Real number of a generic formula.
///
/// Every operation of a formula is rounded separately, so floats and lanes give the same bits. Functions that are
/// generic over `Real` are `#[inline(always)]`, because lanes need the instruction set of their caller.
pub(crate) trait Real:
    Clone + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// Returns the constant `value`, as a number of the same kind as `self`.
    fn constant(&self, value: f32) -> Self;

    /// Returns the greater of two numbers.
    fn max(self, other: Self) -> Self;

    /// Returns the largest integer that does not exceed the number.
    fn floor(self) -> Self;

    /// Returns `then` if `self` > `limit`, and `otherwise` if not or if either is NaN.
    fn choose_above(&self, limit: &Self, then: Self, otherwise: Self) -> Self;
}

macro_rules! floats_are_real {
    ($($float:ident),+) => {
        $(impl Real for $float {
            #[inline(always)]
            fn constant(&self, value: f32) -> Self {
                value.into()
            }

            #[inline(always)]
            fn max(self, other: Self) -> Self {
                Self::max(self, other)
            }

            #[inline(always)]
            fn floor(self) -> Self {
                Self::floor(self)
            }

            #[inline(always)]
            fn choose_above(&self, limit: &Self, then: Self, otherwise: Self) -> Self {
                if self > limit { then } else { otherwise }
            }
        })+
    };
}

floats_are_real!(f32, f64);

macro_rules! lanes_are_real {
    ($($lanes:ident),+) => {
        $(impl<S: Simd> Real for $lanes<S> {
            #[inline(always)]
            fn constant(&self, value: f32) -> Self {
                Self::splat(self.simd, value.into())
            }

            #[inline(always)]
            fn max(self, other: Self) -> Self {
                SimdBase::max(self, other)
            }

            #[inline(always)]
            fn floor(self) -> Self {
                SimdFloat::floor(self)
            }

            #[inline(always)]
            fn choose_above(&self, limit: &Self, then: Self, otherwise: Self) -> Self {
                self.simd_gt(*limit).select(then, otherwise)
            }
        })+
    };
}

lanes_are_real!(f32x8, f32x16, f64x8);

/// Returns the dot product of two vectors.
#[inline(always)]
pub(crate) fn dot<N: Real>([ax, ay, az]: &[N; 3], [bx, by, bz]: &[N; 3]) -> N {
    ax.clone() * bx.clone() + ay.clone() * by.clone() + az.clone() * bz.clone()
}
