//! Depths of samples on lanes, and their bounds: by the operations of [`crate::pipeline::depth`], in their order.

use super::edge_number::EdgeNumber;
use super::setup::{Edges, Setup};
use crate::math::lanes::*;
use crate::pipeline::depth::{Comparison, DepthEncoding};

/// How depths are stored and compared in all tiles of a frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct DepthRules {
    pub(super) comparison: Comparison,
    pub(super) encoding: DepthEncoding,
    /// Depth is linear in space rather than on the screen.
    pub(super) linear_in_space: bool,
    /// What samples hold before anything is drawn.
    pub(super) clear: f32,
    /// Depths are computed and kept at all.
    pub(super) stored: bool,
}

/// The depths that pass.
#[inline(always)]
pub(super) fn passes<S: Simd>(new: F32<S>, stored: F32<S>, comparison: Comparison) -> mask32x8<S> {
    match comparison {
        Comparison::Always => mask32x8::splat(new.simd, true),
        Comparison::Less => new.simd_lt(stored),
        Comparison::LessEqual => new.simd_le(stored),
        Comparison::Greater => new.simd_gt(stored),
        Comparison::GreaterEqual => new.simd_ge(stored),
    }
}

/// Depths as they are stored: [`crate::pipeline::depth::depth_at`] for eight samples. Right only where the triangle covers them.
#[inline(always)]
pub(super) fn depth<S: Simd, E: EdgeNumber>(
    simd: S,
    triangle: &Setup<E>,
    e: [E::Eight<S>; 3],
    rules: &DepthRules,
) -> F32<S> {
    let Setup { rises, inv_w, least, .. } = triangle;
    let rise = if rules.linear_in_space {
        let weights = each!(i in [0, 1, 2] => E::doubles(simd, e[i]).max(0.0) * inv_w[i]);
        let sum = weights[0] + weights[1] + weights[2];
        let zero = F64::splat(simd, 0.0);
        let weighted = weights[0] * rises[0] + weights[1] * rises[1] + weights[2] * rises[2];
        sum.simd_gt(0.0).select(weighted / sum, zero)
    } else {
        let [first, second] = each!(i in [0, 1] => E::doubles(simd, e[i]) * rises[i]);
        // Without the one that is zero, the sum of three is that of the other two, whatever their order.
        if E::LAST_IS_LEAST { first + second } else { first + second + E::doubles(simd, e[2]) * rises[2] }
    };
    // Where the triangle covers the sample nothing is negative.
    quantize(simd, (rise + *least).min(1.0), rules.encoding)
}

/// Depth of a triangle's plane at the first sample of the tile, as it would be stored without rounding. Nothing that means
/// anything if depths are linear in space.
#[inline(always)]
pub(super) fn depth_at_first<E: EdgeNumber>(Setup { edges: Edges { c, .. }, rises, least, .. }: &Setup<E>) -> f64 {
    c[0].double() * rises[0] + c[1].double() * rises[1] + c[2].double() * rises[2] + least
}

/// [`DepthEncoding::quantize`] for eight depths.
#[inline(always)]
fn quantize<S: Simd>(simd: S, depth: F64<S>, encoding: DepthEncoding) -> F32<S> {
    match encoding.largest_code() {
        None => narrow(simd, depth),
        Some(largest) => {
            let largest = f64::from(largest);
            narrow(simd, (depth * largest + 0.5).trunc() / largest)
        }
    }
}

/// Rounding errors of a depth relative to the sum of the magnitudes that it is the sum of: some ten operations of 2⁻⁵³ each.
const ROUNDING: f64 = 1.0 / (1_u64 << 49) as f64;

/// Bounds of the stored depths of a triangle in eight rectangles, from its edge values at their first samples and the way from
/// those to their last samples.
#[inline(always)]
pub(super) fn depth_bounds<S: Simd, E: EdgeNumber>(
    simd: S,
    triangle: &Setup<E>,
    first: [E::Eight<S>; 3],
    [width, height]: [f64; 2],
    rules: &DepthRules,
) -> [F32<S>; 2] {
    let Setup { edges, rises, least, greatest, .. } = triangle;
    let (low, high) = (F64::splat(simd, *least), F64::splat(simd, *greatest));
    let slack = ROUNDING * greatest;
    if rules.linear_in_space {
        return each!(d in [low - slack, high + slack] => quantize(simd, clamp_f64(d, 0.0, 1.0), rules.encoding));
    }
    let [a, b] = each!(of in [edges.a, edges.b] => each!(i in [0, 1, 2] => of[i].double()));
    let across = a[0] * rises[0] + a[1] * rises[1] + a[2] * rises[2];
    let down = b[0] * rises[0] + b[1] * rises[1] + b[2] * rises[2];
    let steepest = each!(i in [0, 1, 2] => (a[i].abs() * width + b[i].abs() * height) * rises[i]);
    let terms = each!(i in [0, 1] => E::doubles(simd, first[i]) * rises[i]);
    let (mut sum, mut magnitude) = (terms[0] + terms[1], terms[0].abs() + terms[1].abs());
    if !E::LAST_IS_LEAST {
        let last = E::doubles(simd, first[2]) * rises[2];
        (sum, magnitude) = (sum + last, magnitude + last.abs());
    }
    let slack = magnitude * ROUNDING + (slack + (steepest[0] + steepest[1] + steepest[2]) * ROUNDING);
    let at_first = sum + *least;
    let nearest = at_first + (across.min(0.0) * width + down.min(0.0) * height);
    let farthest = at_first + (across.max(0.0) * width + down.max(0.0) * height);
    each!(d in [nearest.max(low) - slack, farthest.min(high) + slack] => quantize(simd, clamp_f64(d, 0.0, 1.0), rules.encoding))
}

/// Bits of the rectangles in which no depth within some bounds passes against those stored, and of those in which all do.
#[inline(always)]
pub(super) fn compare_bounds<S: Simd>(
    [low, high]: [F32<S>; 2],
    stored: [F32<S>; 2],
    comparison: Comparison,
) -> (u64, u64) {
    let [least, greatest] = stored;
    match comparison {
        Comparison::Always => (0, 0xFF),
        Comparison::Less => (low.simd_ge(greatest).to_bitmask(), high.simd_lt(least).to_bitmask()),
        Comparison::LessEqual => (low.simd_gt(greatest).to_bitmask(), high.simd_le(least).to_bitmask()),
        Comparison::Greater => (high.simd_le(least).to_bitmask(), low.simd_gt(greatest).to_bitmask()),
        Comparison::GreaterEqual => (high.simd_lt(least).to_bitmask(), low.simd_ge(greatest).to_bitmask()),
    }
}

/// Bounds of the stored depths of a triangle anywhere.
#[inline(always)]
pub(super) fn whole_depths<E: EdgeNumber>(triangle: &Setup<E>, rules: &DepthRules) -> [f32; 2] {
    let slack = ROUNDING * triangle.greatest;
    each!(d in [triangle.least - slack, triangle.greatest + slack] => rules.encoding.quantize(d.clamp(0.0, 1.0)))
}
