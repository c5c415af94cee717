//! SIMD computation of sample depths and of bounds on them, by the same operations in the same order as in
//! [`crate::pipeline::depth`].

use super::edge_number::EdgeNumber;
use super::setup::{EdgeFunctions, Setup};
use crate::math::lanes::*;
use crate::pipeline::depth::{DepthComparison, DepthScale, clear_value};
use crate::pipeline::depth_format::DepthEncoding;
use crate::pipeline::settings::Settings;

/// Rules for storing and comparing depths. They are the same in all tiles of a frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct DepthRules {
    pub(super) comparison: DepthComparison,
    pub(super) encoding: DepthEncoding,
    /// Whether depth is linear in view space instead of in screen space.
    pub(super) linear_in_space: bool,
    /// Whether there is a depth bias. It may move depths below 0 or above 1, so they are clamped.
    pub(super) biased: bool,
    /// Depth of all samples before anything is drawn.
    pub(super) clear: f32,
    /// Whether depths are computed and stored at all.
    pub(super) stored: bool,
}

impl DepthRules {
    /// Creates the depth rules of a frame. `asked_for` is `true` if the caller needs the frame's depths, so that
    /// they must be stored.
    pub(super) fn new(settings: &Settings, scale: &DepthScale, asked_for: bool) -> Self {
        let comparison = DepthComparison::of(settings);
        Self {
            comparison,
            encoding: scale.encoding(),
            linear_in_space: scale.is_linear_in_space(),
            biased: scale.is_biased(),
            clear: clear_value(settings),
            stored: comparison != DepthComparison::Always || asked_for,
        }
    }

    /// Returns the rules. If `COMMON` is `true`, those that the code branches on are compile-time constants, so the
    /// compiler removes the branches. `COMMON` may be `true` only if [`DepthRules::are_common`] returns `true`.
    #[inline(always)]
    pub(super) fn known<const COMMON: bool>(self) -> Self {
        if COMMON {
            Self {
                comparison: DepthComparison::Less,
                encoding: DepthEncoding::F32,
                linear_in_space: false,
                biased: false,
                stored: true,
                ..self
            }
        } else {
            self
        }
    }

    /// Returns `true` if these are the rules of most frames, for which there is specialised code.
    #[inline(always)]
    pub(super) fn are_common(&self) -> bool {
        let Self { comparison, encoding, linear_in_space, biased, stored, .. } = *self;
        comparison == DepthComparison::Less && encoding == DepthEncoding::F32 && !linear_in_space && !biased && stored
    }
}

/// Returns the mask of the lanes whose new depth passes the depth test against the stored one.
#[inline(always)]
pub(super) fn passes<S: Simd>(new: F32<S>, stored: F32<S>, comparison: DepthComparison) -> mask32x8<S> {
    match comparison {
        DepthComparison::Always => mask32x8::splat(new.simd, true),
        DepthComparison::Less => new.simd_lt(stored),
        DepthComparison::LessEqual => new.simd_le(stored),
        DepthComparison::Greater => new.simd_gt(stored),
        DepthComparison::GreaterEqual => new.simd_ge(stored),
    }
}

/// Computes the stored depths of eight samples from their edge values, like
/// [`crate::pipeline::screen_triangle::depth_at`]. Valid only for samples that the triangle covers.
#[inline(always)]
pub(super) fn depth<S: Simd, E: EdgeNumber>(
    simd: S,
    triangle: &Setup<E>,
    e: [E::Eight<S>; 3],
    rules: &DepthRules,
) -> F32<S> {
    let Setup { rises, inv_w, min_depth: least, .. } = triangle;
    let rise = if rules.linear_in_space {
        let weights = each!(i in [0, 1, 2] => E::doubles(simd, e[i]).max(0.0) * inv_w[i]);
        let sum = weights[0] + weights[1] + weights[2];
        let zero = F64::splat(simd, 0.0);
        let weighted = weights[0] * rises[0] + weights[1] * rises[1] + weights[2] * rises[2];
        sum.simd_gt(0.0).select(weighted / sum, zero)
    } else {
        let [first, second] = each!(i in [0, 1] => E::doubles(simd, e[i]) * rises[i]);
        // The third term is zero. The sum of the other two does not depend on their order.
        if E::LAST_HAS_MIN_DEPTH { first + second } else { first + second + E::doubles(simd, e[2]) * rises[2] }
    };
    let depth = (rise + *least).min(1.0);
    // At covered samples, only a bias can make a depth negative.
    quantize(simd, if rules.biased { depth.max(0.0) } else { depth }, rules.encoding)
}

/// Quantises eight depths like [`DepthEncoding::quantize`].
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

/// Bound on the rounding error of a computed depth or depth bound, relative to the sum of the magnitudes of the added
/// terms. The error accumulates over about 23 operations, each with a relative error of at most 2⁻⁵³.
const ROUNDING: f64 = 1.0 / (1_u64 << 48) as f64;

/// Depth of a triangle as a linear function of the sample position in a tile, before quantisation.
#[derive(Clone, Copy, Debug)]
pub(super) struct DepthPlane {
    /// Depth of the plane at the tile's first sample.
    at_first: f64,
    /// Change of depth per 1/256 px to the right, and per 1/256 px down.
    rise: [f64; 2],
    /// Largest difference between the plane and the depth of a sample, before quantisation. Infinite if depth is linear
    /// in view space, because depth is then not linear in screen space.
    slack: f64,
    /// Lower bound on all depths of the triangle, in [0, 1].
    least: f64,
    /// Upper bound on all depths of the triangle, in [0, 1].
    greatest: f64,
}

/// Positions of eight samples in a row, relative to the tile's first sample, in steps of 1/256 px.
pub(super) struct EightPositions<S: Simd> {
    pub(super) x: F64<S>,
    pub(super) y: f64,
}

impl<S: Simd> EightPositions<S> {
    /// Returns the position of the tile's first sample in all lanes.
    #[inline(always)]
    pub(super) fn first(simd: S) -> Self {
        Self { x: F64::splat(simd, 0.0), y: 0.0 }
    }
}

impl DepthPlane {
    /// Creates the depth plane of a triangle in a tile. Width and height are the distances from the tile's first sample
    /// to its last one, in steps of 1/256 px.
    #[inline(always)]
    pub(super) fn new<E: EdgeNumber>(triangle: &Setup<E>, [width, height]: [f64; 2], rules: &DepthRules) -> Self {
        let Setup { edges: EdgeFunctions { a, b, c }, rises, .. } = triangle;
        let [a, b, c] = each!(of in [a, b, c] => each!(i in [0, 1, 2] => of[i].double() * rises[i]));
        let [at_first, across, down] = each!(of in [c, a, b] => of[0] + of[1] + of[2]);
        let magnitudes = each!(i in [0, 1, 2] => c[i].abs() + a[i].abs() * width + b[i].abs() * height);
        let slack = (magnitudes[0] + magnitudes[1] + magnitudes[2] + magnitude(triangle)) * ROUNDING;
        let [least, greatest] =
            each!(d in [triangle.min_depth - slack, triangle.max_depth + slack] => d.clamp(0.0, 1.0));
        let slack = if rules.linear_in_space { f64::INFINITY } else { slack };
        Self { at_first: at_first + triangle.min_depth, rise: [across, down], slack, least, greatest }
    }

    /// Returns the depth of the plane at the tile's first sample. Meaningless if depth is linear in view space.
    #[inline(always)]
    pub(super) fn at_first(&self) -> f64 {
        self.at_first
    }

    /// Returns a lower and an upper bound on the stored depths in each of eight rectangles of samples, given the
    /// position of the first sample of each. Width and height are the distances from the first to the last sample, in
    /// steps of 1/256 px.
    ///
    /// If the triangle covers no sample of a rectangle, the bounds may lie outside the triangle's range of depths.
    #[inline(always)]
    pub(super) fn bounds<S: Simd>(
        &self,
        simd: S,
        EightPositions { x, y }: EightPositions<S>,
        [width, height]: [f64; 2],
        rules: &DepthRules,
    ) -> [F32<S>; 2] {
        let Self { at_first, rise: [across, down], slack, least, greatest } = *self;
        let nearest = across.min(0.0) * width + down.min(0.0) * height - slack;
        let farthest = across.max(0.0) * width + down.max(0.0) * height + slack;
        let at = x * across + (down * y + at_first);
        let mut ends = [(at + nearest).max(least), (at + farthest).min(greatest)];
        if rules.biased {
            // A bias may move all depths of a rectangle below 0 or above 1, where they are clamped. Each bound is
            // therefore clamped to the range from `least` to `greatest`.
            ends = [ends[0].min(greatest), ends[1].max(least)];
        }
        each!(i in [0, 1] => quantize(simd, ends[i], rules.encoding))
    }
}

/// Compares the bounds of new depths in eight rectangles with the bounds of the depths stored there. Returns two bit
/// masks: the rectangles in which every new depth fails the depth test, and those in which every new depth passes.
#[inline(always)]
pub(super) fn compare_bounds<S: Simd>(
    [low, high]: [F32<S>; 2],
    stored: [F32<S>; 2],
    comparison: DepthComparison,
) -> (u64, u64) {
    let [least, greatest] = stored;
    match comparison {
        DepthComparison::Always => (0, 0xFF),
        DepthComparison::Less => (low.simd_ge(greatest).to_bitmask(), high.simd_lt(least).to_bitmask()),
        DepthComparison::LessEqual => (low.simd_gt(greatest).to_bitmask(), high.simd_le(least).to_bitmask()),
        DepthComparison::Greater => (high.simd_le(least).to_bitmask(), low.simd_gt(greatest).to_bitmask()),
        DepthComparison::GreaterEqual => (high.simd_lt(least).to_bitmask(), low.simd_ge(greatest).to_bitmask()),
    }
}

/// Returns the sum of the magnitudes of a triangle's least and greatest depth. No term in the computation of a sample's
/// depth exceeds it.
#[inline(always)]
fn magnitude<E>(triangle: &Setup<E>) -> f64 {
    triangle.min_depth.abs() + triangle.max_depth.abs()
}

/// Returns a lower and an upper bound on the stored depths at all samples of a triangle.
#[inline(always)]
pub(super) fn whole_depths<E: EdgeNumber>(triangle: &Setup<E>, rules: &DepthRules) -> [f32; 2] {
    let slack = ROUNDING * magnitude(triangle);
    each!(d in [triangle.min_depth - slack, triangle.max_depth + slack] => rules.encoding.quantize(d.clamp(0.0, 1.0)))
}

#[cfg(test)]
mod tests {
    use super::super::lattice::TileLattice;
    use super::super::layout::{BLOCK, BLOCKS, SamplePlace, TilePlace};
    use super::super::setup::{SetupContext, SnappedVertex};
    use super::super::slot::Slot;
    use super::*;
    use crate::pipeline::depth::DepthScale;
    use crate::pipeline::grid::SampleGrid;
    use crate::pipeline::settings::FillRule;

    /// Returns the depths at eight sample positions, and the bit mask of the samples that the triangle covers.
    #[inline(always)]
    fn depths_at<S: Simd>(
        simd: S,
        triangle: &Setup,
        places: [[i32; 2]; LANES],
        rules: &DepthRules,
    ) -> ([f32; LANES], u64) {
        let values = places.map(|place| triangle.edges.at(place));
        let e = each!(i in [0, 1, 2] => F64::load_array(simd, std::array::from_fn(|lane| values[lane][i])));
        (depth(simd, triangle, e, rules).to_array(), f64::inside_bits(e, triangle.inside_thresholds(simd)))
    }

    #[test]
    fn depth_bounds_hold_and_are_tight() {
        let mut random = fastrand::Rng::with_seed(9);
        let mut tested = 0;
        let encodings = [DepthEncoding::F32, DepthEncoding::Unorm16];
        let grids = [SampleGrid::Block { step: 1 }, SampleGrid::Checkerboard];
        for (encoding, grid) in encodings.into_iter().flat_map(|encoding| grids.map(|grid| (encoding, grid))) {
            let rules = DepthRules {
                comparison: DepthComparison::Less,
                encoding,
                linear_in_space: false,
                biased: false,
                clear: 1.0,
                stored: true,
            };
            let lattice = TileLattice::new(grid);
            let origin = lattice.origin(TilePlace { column: 1, row: 2, number: 0 });
            for _ in 0..200 {
                let thickness = 1 << random.u32(0..20);
                let corners = [(); 3].map(|()| {
                    let along = random.f64() * 40_000.0 - 12_000.0;
                    let place = origin
                        .position
                        .map(|from| (from + along + f64::from(random.i32(-thickness..thickness))).round());
                    SnappedVertex { position: place, depth: random.f64(), inv_w: 1.0 }
                });
                let scale = DepthScale::default();
                let context = SetupContext { rule: FillRule::TopLeft, scale: &scale, lattice: &lattice, origin };
                let set_up = Setup::new(Slot::NONE, &corners, &context);
                let Some(triangle) = set_up else { continue };
                let plane = DepthPlane::new(&triangle, lattice.tile_extent(), &rules);
                for lanes in Lanes::all() {
                    for by in 0..BLOCKS {
                        let [low, high] = on_lanes!(lanes, simd => {
                            let x = F64::load_array(simd, lattice.doubles.blocks);
                            let places = EightPositions { x, y: lattice.doubles.row(by * BLOCK) };
                            plane.bounds(simd, places, lattice.doubles.block, &rules).map(SimdBase::to_array)
                        });
                        let [width, height] = lattice.doubles.block;
                        let range = plane.rise[0].abs() * width + plane.rise[1].abs() * height;
                        for (column, row) in
                            (0..BLOCK).flat_map(|row| (0..BLOCKS).map(move |bx| (bx, by * BLOCK + row)))
                        {
                            let places = std::array::from_fn(|lane| {
                                lattice.place(SamplePlace { column: column * BLOCK + lane, row })
                            });
                            let (depths, covered) =
                                on_lanes!(lanes, simd => depths_at(simd, &triangle, places, &rules));
                            for lane in (0..LANES).filter(|lane| covered >> lane & 1 != 0) {
                                let [low, high] = [low[column], high[column]];
                                assert!((low..=high).contains(&depths[lane]), "{} in {low} to {high}", depths[lane]);
                                assert!(f64::from(high) - f64::from(low) < range + 4e-5, "{low} to {high}, {range}");
                                tested += 1;
                            }
                        }
                    }
                }
            }
        }
        assert!(tested > 100_000, "{tested} samples were covered");
    }
}
