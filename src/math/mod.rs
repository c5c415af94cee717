//! Conventions that hold everywhere in this crate, and the numbers they rest on.
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
//! | depth | z/w, an affine function of the screen, unless linear in w; nearer is smaller unless reversed |
//! | attributes | perspective-correct by default: λᵢ' = (λᵢ/wᵢ) / Σ(λⱼ/wⱼ) |
//! | colour | textures and the final image are 8-bit sRGB; shading works in linear light unless told otherwise |
//! | texel | texture coordinate u·width − 0.5, so texel centres sit at half-integers; v is flipped once, on load |

pub mod double_double;

pub mod expansion;

pub mod fixed;

pub mod lanes;
pub mod prefetch;

mod bounds;

pub use bounds::Aabb;

use glam::{DVec3, Vec3};

/// `v` at unit length, or `fallback` where it has none. Scaled by its largest component first, so no square overflows.
pub fn unit_or(v: DVec3, fallback: Vec3) -> Vec3 {
    let largest = v.abs().max_element();
    if largest > 0.0 && largest.is_finite() { (v / largest).normalize().as_vec3() } else { fallback }
}

/// [`unit_or`] for eight vectors, by component.
#[inline(always)]
pub fn unit_or_lanes<S: lanes::Simd>(simd: S, v: [lanes::F64<S>; 3], fallback: Vec3) -> [lanes::F32<S>; 3] {
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

/// The largest integer not above `x`, exactly as [`f32::floor`], which without SSE 4.1 is a function call of some thirty
/// instructions: a third of the time of a textured pixel.
#[inline]
pub fn floor(x: f32) -> f32 {
    /// From here on every float is an integer.
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
