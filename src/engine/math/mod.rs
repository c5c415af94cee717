//! Conventions of the whole crate, and the arithmetic that they are based on.
//!
//! | thing | rule |
//! | --- | --- |
//! | world | right-handed, y up; the camera looks down −z |
//! | matrices | `target_from_source` names (`clip_from_world`), column vectors |
//! | clip space | z/w in [0, 1], near = 0 (reversed depth and w-buffer: near = 1), w > 0 in front of the eye |
//! | screen | x right, y **down**, pixel (i, j) has its centre at (i + 0.5, j + 0.5) |
//! | snapping | vertices are rounded to nearest, ties to even, onto a grid of 1/256 px before any edge is built |
//! | front face | counter-clockwise as the viewer sees it, so *negative* doubled area on the y-down screen |
//! | fill rule | top-left by default: a centre on an edge belongs to the triangle whose top or left edge it is |
//! | depth | z/w, affine in screen space, unless linear in w; nearer is smaller unless reversed |
//! | attributes | perspective-correct by default: λᵢ' = (λᵢ/wᵢ) / Σ(λⱼ/wⱼ) |
//! | colour | textures and the final image are 8-bit sRGB; shading works in linear light unless set otherwise |
//! | texel | the centre of texel i lies at u·width = i + 0.5; v is flipped once, on load |

pub(crate) mod double_double;

pub(crate) mod expansion;

pub mod fixed;

pub mod lanes;

pub(crate) mod log2;

pub(crate) mod prefetch;

pub(crate) mod real;

mod bounds;

pub(crate) use bounds::Aabb;

use glam::{DVec3, Vec3};

/// Returns `v` normalised, or `fallback` if its largest component is zero or not finite. Divides by that component
/// first, so no square overflows.
pub(crate) fn unit_or(v: DVec3, fallback: Vec3) -> Vec3 {
    let largest = v.abs().max_element();
    if largest > 0.0 && largest.is_finite() { (v / largest).normalize().as_vec3() } else { fallback }
}

/// Computes [`unit_or`] of eight vectors, given as x, y and z lanes.
#[inline(always)]
pub(crate) fn unit_or_lanes<S: lanes::Simd>(simd: S, v: [lanes::F64<S>; 3], fallback: Vec3) -> [lanes::F32<S>; 3] {
    if let Some(unit) = approximate_unit_lanes(simd, v) {
        return unit;
    }
    use lanes::{F64, Select as _, SimdBase as _, SimdFloat as _, narrow};
    let largest = v[0].abs().max(v[1].abs()).max(v[2].abs());
    let [x, y, z] = lanes::each!(i in [0, 1, 2] => v[i] / largest);
    let reciprocal = F64::splat(simd, 1.0) / (x * x + y * y + z * z).sqrt();
    let has_length = largest.simd_gt(0.0) & largest.is_finite();
    let fallback = fallback.as_dvec3().to_array();
    lanes::each!((part, otherwise) in [(x, fallback[0]), (y, fallback[1]), (z, fallback[2])] => {
        narrow(simd, has_length.select(part * reciprocal, F64::splat(simd, otherwise)))
    })
}

/// Returns the result of [`unit_or`] for eight vectors at a third of its cost, or `None` if that result is not certain.
///
/// The reciprocal square root in f32 has an error below 2.5 · 2⁻²⁴; one Newton step reduces it below 2⁻⁴⁴. The error of
/// [`unit_or`], all in f64, is below 2⁻⁴⁹. If u is the component computed here, the component that [`unit_or`] computes
/// before rounding to f32 therefore lies between (1 − 2⁻⁴²) u and (1 + 2⁻⁴²) u. If both bounds round to the same f32,
/// [`unit_or`] rounds to it as well. The two roundings differ in only about one of 100 000 cases.
#[inline(always)]
fn approximate_unit_lanes<S: lanes::Simd>(simd: S, v: [lanes::F64<S>; 3]) -> Option<[lanes::F32<S>; 3]> {
    use lanes::{F32, SimdBase as _, SimdFloat as _, SimdMask as _, narrow, widen};
    const SLACK: f64 = 1.0 / (1_u64 << 42) as f64;
    /// Range of squared lengths in which the square root and its reciprocal have full `f32` precision.
    const SQUARES: [f64; 2] = [1e-30, 1e30];
    let squares = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    let root = widen(simd, F32::splat(simd, 1.0) / narrow(simd, squares).sqrt());
    let reciprocal = root * (squares * -0.5 * root * root + 1.5);
    let (smaller, larger) = (reciprocal * (1.0 - SLACK), reciprocal * (1.0 + SLACK));
    let unit = lanes::each!(i in [0, 1, 2] => narrow(simd, v[i] * smaller));
    let [x, y, z] = lanes::each!(i in [0, 1, 2] => unit[i].simd_eq(narrow(simd, v[i] * larger)));
    let in_range = squares.simd_ge(SQUARES[0]) & squares.simd_le(SQUARES[1]);
    ((x & y & z).all_true() && in_range.all_true()).then_some(unit)
}

/// Returns the largest integer not above `x`, exactly as [`f32::floor`]. Without SSE 4.1, [`f32::floor`] is a function
/// call of about thirty instructions, a third of the cost of a textured pixel.
#[inline]
pub(crate) fn floor(x: f32) -> f32 {
    /// Magnitude from which every float is an integer: 2²³.
    const ALL_INTEGERS: f32 = 8_388_608.0;
    if x.abs() < ALL_INTEGERS {
        let truncated = x as i32 as f32;
        if truncated > x { truncated - 1.0 } else { truncated }
    } else {
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Normalises eight vectors with [`unit_or_lanes`], once for each instruction set of this processor.
    fn units(vectors: [Vec3; lanes::LANES], fallback: Vec3) -> Vec<[Vec3; lanes::LANES]> {
        use lanes::{F32, Lanes, SimdBase as _, each, on_lanes, widen};
        let columns: [[f32; lanes::LANES]; 3] = std::array::from_fn(|axis| vectors.map(|v| v[axis]));
        let unit = |lanes| {
            let unit = on_lanes!(lanes, simd => {
                let wide = each!(axis in [0, 1, 2] => widen(simd, F32::load_array(simd, columns[axis])));
                let unit = unit_or_lanes(simd, wide, fallback);
                each!(axis in [0, 1, 2] => unit[axis].to_array())
            });
            std::array::from_fn(|i| Vec3::from_array(unit.map(|axis| axis[i])))
        };
        Lanes::all().map(unit).collect()
    }

    #[test]
    fn eight_vectors_become_the_same_units_as_one_by_one() {
        let mut random = fastrand::Rng::with_seed(5);
        let fallback = Vec3::new(0.25, -3.0, 0.0);
        for round in 0..100_000 {
            let mut number = || match (round % 4, random.u32(..8)) {
                // Any bit pattern.
                (0, _) => f32::from_bits(random.u32(..)),
                // Small integers: the components of their unit vectors lie near rounding boundaries more often.
                (1, _) => random.i32(-20..20) as f32,
                (_, 0) => 0.0,
                _ => random.f32() * 2.0 - 1.0,
            };
            let vectors: [Vec3; lanes::LANES] = std::array::from_fn(|_| Vec3::new(number(), number(), number()));
            let expected = vectors.map(|v| unit_or(v.as_dvec3(), fallback).to_array().map(f32::to_bits));
            for found in units(vectors, fallback) {
                for (i, expected) in expected.iter().enumerate() {
                    if !vectors[i].is_nan() {
                        assert_eq!(found[i].to_array().map(f32::to_bits), *expected, "{}", vectors[i]);
                    }
                }
            }
        }
    }

    #[test]
    fn floor_is_the_standard_one() {
        let special = [0.0, -1e-30, 1e-30, -0.5, 0.999_999_94, -1.0, 8_388_607.5, -8_388_607.5, 1e30, f32::INFINITY];
        let random = std::iter::repeat_with({
            let mut random = fastrand::Rng::with_seed(7);
            move || f32::from_bits(random.u32(..))
        });
        for x in special.into_iter().chain(random.filter(|x| !x.is_nan()).take(100_000)) {
            assert_eq!(floor(x), x.floor(), "{x}");
        }
        assert!(floor(f32::NAN).is_nan());
    }
}
