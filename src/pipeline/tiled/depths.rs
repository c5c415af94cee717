//! Depths of samples on lanes, and their bounds: by the operations of [`crate::pipeline::depth`], in their order.

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

/// Bits of the depths that pass.
#[inline(always)]
pub(super) fn passes<S: Simd>(new: F32<S>, stored: F32<S>, comparison: Comparison) -> u64 {
    match comparison {
        Comparison::Always => 0xFF,
        Comparison::Less => new.simd_lt(stored).to_bitmask(),
        Comparison::LessEqual => new.simd_le(stored).to_bitmask(),
        Comparison::Greater => new.simd_gt(stored).to_bitmask(),
        Comparison::GreaterEqual => new.simd_ge(stored).to_bitmask(),
    }
}

/// Depths as they are stored: [`crate::pipeline::depth::depth_at`] for eight samples.
#[inline(always)]
pub(super) fn depth<S: Simd>(simd: S, triangle: &Setup, e: [F64<S>; 3], rules: &DepthRules) -> F32<S> {
    let Setup { rises, inv_w, least, .. } = triangle;
    let rise = if rules.linear_in_space {
        let weights = each!(i in [0, 1, 2] => e[i].max(0.0) * inv_w[i]);
        let sum = weights[0] + weights[1] + weights[2];
        let zero = F64::splat(simd, 0.0);
        sum.simd_gt(0.0).select(weighted(weights, rises) / sum, zero)
    } else {
        weighted(e, rises)
    };
    quantize(simd, clamp_f64(rise + *least, 0.0, 1.0), rules.encoding)
}

#[inline(always)]
fn weighted<S: Simd>(v: [F64<S>; 3], rises: &[f64; 3]) -> F64<S> {
    v[0] * rises[0] + v[1] * rises[1] + v[2] * rises[2]
}

/// Depth of a triangle's plane at the first sample of the tile, as it would be stored without rounding. Nothing that means
/// anything if depths are linear in space.
#[inline(always)]
pub(super) fn depth_at_first(Setup { edges: Edges { c, .. }, rises, least, .. }: &Setup) -> f64 {
    c[0] * rises[0] + c[1] * rises[1] + c[2] * rises[2] + least
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
pub(super) fn depth_bounds<S: Simd>(
    simd: S,
    triangle: &Setup,
    first: [F64<S>; 3],
    [width, height]: [f64; 2],
    rules: &DepthRules,
) -> [F32<S>; 2] {
    let Setup { edges, rises, least, greatest, .. } = triangle;
    let (low, high) = (F64::splat(simd, *least), F64::splat(simd, *greatest));
    let slack = ROUNDING * greatest;
    if rules.linear_in_space {
        return each!(d in [low - slack, high + slack] => quantize(simd, clamp_f64(d, 0.0, 1.0), rules.encoding));
    }
    let terms = each!(i in [0, 1, 2] => first[i] * rises[i]);
    let across = edges.a[0] * rises[0] + edges.a[1] * rises[1] + edges.a[2] * rises[2];
    let down = edges.b[0] * rises[0] + edges.b[1] * rises[1] + edges.b[2] * rises[2];
    let steepest = each!(i in [0, 1, 2] => (edges.a[i].abs() * width + edges.b[i].abs() * height) * rises[i]);
    let slack = (terms[0].abs() + terms[1].abs() + terms[2].abs()) * ROUNDING
        + (slack + (steepest[0] + steepest[1] + steepest[2]) * ROUNDING);
    let at_first = terms[0] + terms[1] + terms[2] + *least;
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
pub(super) fn whole_depths(triangle: &Setup, rules: &DepthRules) -> [f32; 2] {
    let slack = ROUNDING * triangle.greatest;
    each!(d in [triangle.least - slack, triangle.greatest + slack] => rules.encoding.quantize(d.clamp(0.0, 1.0)))
}
