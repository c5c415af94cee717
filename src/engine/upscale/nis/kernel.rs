//! Filters of luma: interpolation along rows and columns, and interpolation with sharpening in four directions.
//!
//! Everything is computed on 16 output pixels at a time. A single pixel is replayed by the same code, so both agree bit
//! for bit.

use super::coefficients::{self, PHASES, TAPS};
use crate::math::lanes::*;
use crate::upscale::Lattice;
use crate::upscale::runs::RunCells;

/// Number of directions in which edges are detected: 0°, 90°, 45° and 135°.
pub(super) const DIRECTIONS: usize = 4;

/// Luma of the 6 × 6 samples around each of 16 pixels, row by row.
pub(super) type Patch<S> = [[f32x16<S>; TAPS]; TAPS];

/// Amount of sharpening as a function of luma: it falls linearly between two luma values.
#[derive(Clone, Copy)]
pub(super) struct Sharpness {
    /// Factor of the unsharp mask at dark pixels, and at bright ones.
    strength: [f32; 2],
    /// Limit of the unsharp mask, relative to luma, at dark pixels and at bright ones.
    limit: [f32; 2],
}

impl Sharpness {
    /// No sharpening at all.
    pub(super) const NONE: Self = Self { strength: [0.0; 2], limit: [0.0; 2] };

    /// Returns the sharpness that the SDK derives from its slider, from 0 to 1.
    pub(super) fn new(slider: f32) -> Self {
        let by = slider - 0.5;
        let [dark, bright] = if by >= 0.0 { [1.25, 1.25] } else { [1.75, 1.0] };
        Self {
            strength: [1.6 + by * dark * 1.8, (0.4 + by * bright * 1.2).max(0.0)],
            limit: [0.5 + by * bright * 0.6, (0.14 + by * bright * 0.32).max(0.1)],
        }
    }
}

/// Luma at which sharpening starts to fall, and reciprocal of the luma range over which it falls.
const FALL: [f32; 2] = [0.45, 1.0 / 0.45];

/// Ratio of contrasts above which sharpening is reduced to avoid ringing, and reciprocal of the range of reduction.
const RINGING: [f32; 2] = [2.0, 1.0 / 8.0];

/// Offset of contrasts in their ratio, which avoids a division by zero.
const CONTRAST_OFFSET: f32 = 1.0 / 255.0;

/// Coefficients of both filters at the phases of 16 pixels.
struct PhaseTaps {
    scale: [[f32; WIDE]; TAPS],
    unsharp: [[f32; WIDE]; TAPS],
    /// 1 for phases past the middle between two samples, otherwise 0.
    late: [f32; WIDE],
}

impl PhaseTaps {
    fn new(phases: [u32; WIDE]) -> Self {
        let transposed = |table: fn(u32) -> [f32; TAPS]| {
            let rows = phases.map(table);
            std::array::from_fn(|tap| rows.map(|row| row[tap]))
        };
        let late = phases.map(|phase| if phase > PHASES / 2 { 1.0 } else { 0.0 });
        Self { scale: transposed(coefficients::scale), unsharp: transposed(coefficients::unsharp), late }
    }
}

/// Position of 16 pixels in the diagonal direction of a filter.
struct Diagonal {
    /// Position across the direction, in half diagonals between samples; from 0 to 1.
    across: [f32; WIDE],
    /// 1 where the filter starts at the second of its seven values along the direction, otherwise 0.
    shifted: [f32; WIDE],
    taps: PhaseTaps,
}

/// Positions and coefficients of a run of [`WIDE`] output pixels.
pub(super) struct RunPhase {
    pub(super) cells: RunCells,
    /// Horizontal positions between the samples, in [0, 1).
    pub(super) x: [f32; WIDE],
    /// Vertical position between the samples, in [0, 1).
    pub(super) y: f32,
    columns: PhaseTaps,
    rows: PhaseTaps,
    rising: Diagonal,
    falling: Diagonal,
}

impl RunPhase {
    /// Prepares the run whose first pixel is (x, y).
    pub(super) fn new(lattice: Lattice, x: u32, y: u32) -> Self {
        let steps = lattice.phases();
        let (down, across) = (lattice.place(y).phase, (x..).map(|x| lattice.place(x).phase));
        let mut columns = [0; WIDE];
        columns.iter_mut().zip(across).for_each(|(column, phase)| *column = phase);
        let discrete = |phase: u32| phase * PHASES / steps;
        // Positions along the diagonals, from 0 to 2.
        let (rising, falling) = (columns.map(|column| column + down), columns.map(|column| steps + column - down));
        let diagonal = |along: [u32; WIDE], across: [u32; WIDE]| Diagonal {
            across: across.map(|across| across as f32 / (2 * steps) as f32),
            shifted: along.map(|along| if along >= steps { 1.0 } else { 0.0 }),
            taps: PhaseTaps::new(along.map(|along| discrete(along % steps))),
        };
        Self {
            cells: RunCells::new(lattice, x),
            x: columns.map(|column| column as f32 / steps as f32),
            y: down as f32 / steps as f32,
            columns: PhaseTaps::new(columns.map(discrete)),
            rows: PhaseTaps::new([discrete(down); WIDE]),
            rising: diagonal(rising, falling),
            falling: diagonal(falling, rising),
        }
    }
}

/// Interpolates linearly between `from`, at 0, and `to`, at 1.
#[inline(always)]
pub(super) fn lerp<S: Simd>(from: f32x16<S>, to: f32x16<S>, at: f32x16<S>) -> f32x16<S> {
    from + (to - from) * at
}

/// Clamps values to [0, 1].
#[inline(always)]
fn saturated<S: Simd>(value: f32x16<S>) -> f32x16<S> {
    value.max(0.0).min(1.0)
}

#[inline(always)]
fn dot<S: Simd>(simd: S, values: &[f32x16<S>; TAPS], coefficients: &[[f32; WIDE]; TAPS]) -> f32x16<S> {
    let mut sum = values[0] * f32x16::load_array_ref(simd, &coefficients[0]);
    for tap in 1..TAPS {
        sum += values[tap] * f32x16::load_array_ref(simd, &coefficients[tap]);
    }
    sum
}

/// Interpolates six values in one direction, and sharpens.
#[inline(always)]
fn sharpened<S: Simd>(simd: S, values: &[f32x16<S>; TAPS], taps: &PhaseTaps, sharpness: &Sharpness) -> f32x16<S> {
    let one = f32x16::splat(simd, 1.0);
    let luma = dot(simd, values, &taps.scale);
    let darkness = one - saturated((luma - FALL[0]) * FALL[1]);
    let [strength, limit] = each!(range in [sharpness.strength, sharpness.limit] => {
        darkness * (range[0] - range[1]) + range[1]
    });
    let limit = limit * luma;
    let mask = (dot(simd, values, &taps.unsharp) * strength).max(-limit).min(limit);
    luma + mask * smoothness(simd, values, f32x16::load_array_ref(simd, &taps.late))
}

/// Returns the factor of the unsharp mask that avoids ringing: it falls from 1 to 0 as the contrasts on both sides of a
/// pixel become more unequal.
#[inline(always)]
fn smoothness<S: Simd>(simd: S, values: &[f32x16<S>; TAPS], late: f32x16<S>) -> f32x16<S> {
    let late = late.simd_gt(0.5);
    let [a, b, c, d, e] = each!(tap in [0, 1, 2, 3, 4] => late.select(values[tap + 1], values[tap]));
    let before = a.max(b).max(c) - a.min(b).min(c);
    let after = c.max(d).max(e) - c.min(d).min(e);
    let ratio = before.max(after) / (before.min(after) + CONTRAST_OFFSET);
    f32x16::splat(simd, 1.0) - saturated((ratio - RINGING[0]) * RINGING[1])
}

/// Values of the samples along a diagonal, seven at steps of half a diagonal. `outer` holds the samples on both sides of
/// the even steps: first those towards `across` = 1, then those towards 0. `inner` holds the pairs around the odd steps.
struct DiagonalSamples<S: Simd> {
    on: [f32x16<S>; 4],
    outer: [[f32x16<S>; 4]; 2],
    inner: [[f32x16<S>; 2]; 3],
}

impl<S: Simd> DiagonalSamples<S> {
    /// Interpolates across the direction, and filters along it.
    #[inline(always)]
    fn filtered(&self, simd: S, diagonal: &Diagonal, sharpness: &Sharpness) -> f32x16<S> {
        let across = f32x16::load_array_ref(simd, &diagonal.across);
        let off = across - 0.5;
        let (side, distance) = (off.simd_ge(0.0), off.abs());
        let [v0, v2, v4, v6] = each!(step in [0, 1, 2, 3] => {
            lerp(self.on[step], side.select(self.outer[0][step], self.outer[1][step]), distance)
        });
        let [v1, v3, v5] = each!(step in [0, 1, 2] => lerp(self.inner[step][0], self.inner[step][1], across));
        let shifted = f32x16::load_array_ref(simd, &diagonal.shifted).simd_gt(0.5);
        let values = each!((own, next) in [(v0, v1), (v1, v2), (v2, v3), (v3, v4), (v4, v5), (v5, v6)] => {
            shifted.select(next, own)
        });
        sharpened(simd, &values, &diagonal.taps, sharpness)
    }
}

/// Computes the luma of 16 pixels. `edges` holds the weights of the filters in the four directions; the rest of 1 is the
/// weight of the filter along rows and columns.
#[inline(always)]
pub(super) fn luma<S: Simd>(
    simd: S,
    patch: &Patch<S>,
    phase: &RunPhase,
    edges: [f32x16<S>; DIRECTIONS],
    sharpness: &Sharpness,
) -> f32x16<S> {
    let mut columns = [f32x16::splat(simd, 0.0); TAPS];
    for column in 0..TAPS {
        let values = each!(row in [0, 1, 2, 3, 4, 5] => patch[row][column]);
        columns[column] = dot(simd, &values, &phase.rows.scale);
    }
    let plain = dot(simd, &columns, &phase.columns.scale);
    let total = (edges[0] + edges[1]) + (edges[2] + edges[3]);
    if !total.simd_gt(0.0).any_true() {
        return plain;
    }
    let p = patch;
    let (x, y) = (f32x16::load_array_ref(simd, &phase.x), f32x16::splat(simd, phase.y));
    let across_rows = each!(row in [0, 1, 2, 3, 4, 5] => lerp(p[row][2], p[row][3], x));
    let across_columns = each!(column in [0, 1, 2, 3, 4, 5] => lerp(p[2][column], p[3][column], y));
    let rising = DiagonalSamples {
        on: [p[1][1], p[2][2], p[3][3], p[4][4]],
        outer: [[p[0][2], p[1][3], p[2][4], p[3][5]], [p[2][0], p[3][1], p[4][2], p[5][3]]],
        inner: [[p[2][1], p[1][2]], [p[3][2], p[2][3]], [p[4][3], p[3][4]]],
    };
    let falling = DiagonalSamples {
        on: [p[4][1], p[3][2], p[2][3], p[1][4]],
        outer: [[p[5][2], p[4][3], p[3][4], p[2][5]], [p[3][0], p[2][1], p[1][2], p[0][3]]],
        inner: [[p[3][1], p[4][2]], [p[2][2], p[3][3]], [p[1][3], p[2][4]]],
    };
    let horizontal = sharpened(simd, &across_rows, &phase.rows, sharpness);
    let vertical = sharpened(simd, &across_columns, &phase.columns, sharpness);
    let rising = rising.filtered(simd, &phase.rising, sharpness);
    let falling = falling.filtered(simd, &phase.falling, sharpness);
    let directed = (horizontal * edges[0] + vertical * edges[1]) + (rising * edges[2] + falling * edges[3]);
    directed + plain * (f32x16::splat(simd, 1.0) - total)
}

/// Ratio of the gradients in two perpendicular directions above which there is an edge.
const EDGE_RATIO: f32 = 2.0 * 1127.0 / 1024.0;

/// Minimum gradient of an edge: sum of three luma differences.
const MIN_GRADIENT: f32 = 64.0 / 1024.0;

/// Returns the weights of the four directions for 16 samples, from the luma of the 3 × 3 samples around each. At most one
/// of the first two weights and one of the last two are positive, and all sum to at most 1.
#[inline(always)]
pub(super) fn edges<S: Simd>(simd: S, [above, own, below]: [[f32x16<S>; 3]; 3]) -> [f32x16<S>; DIRECTIONS] {
    let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
    let down = (above[0] + above[1] + above[2] - below[0] - below[1] - below[2]).abs();
    let across = (above[0] + own[0] + below[0] - above[2] - own[2] - below[2]).abs();
    let rising = (own[0] + above[0] + above[1] - below[1] - below[2] - own[2]).abs();
    let falling = (own[0] + below[0] + below[1] - above[1] - above[2] - own[2]).abs();
    let (most, least) = (down.max(across), down.min(across));
    let (diagonal, least_diagonal) = (rising.max(falling), rising.min(falling));
    let sum = most + diagonal;
    let share = sum.simd_gt(0.0).select((most / sum).min(1.0), zero);
    let is_edge = most.simd_gt(least * EDGE_RATIO) & most.simd_gt(MIN_GRADIENT) & most.simd_gt(least_diagonal);
    let is_diagonal =
        diagonal.simd_gt(least_diagonal * EDGE_RATIO) & diagonal.simd_gt(MIN_GRADIENT) & diagonal.simd_gt(least);
    let straight = is_edge.select(is_diagonal.select(share, one), zero);
    let slanted = is_diagonal.select(is_edge.select(one - share, one), zero);
    let (is_down, is_rising) = (down.simd_ge(across), rising.simd_ge(falling));
    [
        is_down.select(straight, zero),
        is_down.select(zero, straight),
        is_rising.select(slanted, zero),
        is_rising.select(zero, slanted),
    ]
}
