//! SIMD version of [`super`] for 16 adjacent output pixels at a time. Floats are added in the same order, and integer sums
//! are exact, so results are bit-identical.
//!
//! The code avoids closures: a closure called by the standard library would be compiled without the CPU features of the
//! wide lanes.

use super::phases::{Phases, RunPhase, WideDistances};
use super::source::{AHEAD, CellRow, SourceRows, values};
use super::{EDGE_LOBE, FACTOR, MIN_SLOPE, ONE, ONE_DOUBLED, ONE_SQUARED, WHOLE};
use crate::image::{Image, Rgba8};
use crate::math::lanes::*;
use crate::upscale::fsr::words::{pairs, rounded, times};
use crate::upscale::lattice::LatticePosition;
use crate::upscale::runs::{Run, Runs, column_of};

/// Number of runs, of [`WIDE`] pixels each, whose computation is interleaved.
const RUNS: usize = AHEAD / WIDE;

/// Number of pixels in a tile, small enough that the data of its samples stays in the L1 cache from row to row.
const TILE: usize = 6 * AHEAD;

/// Image to upscale.
pub(in super::super) struct EasuFrame<'a> {
    /// Samples; at least one.
    pub(in super::super) drawn: &'a Image<Rgba8>,
    pub(in super::super) phases: Phases,
    /// Width of the full image, in pixels.
    pub(in super::super) width: usize,
}

impl EasuFrame<'_> {
    /// Computes rows of the full image; the first of them is row `first`.
    pub(in super::super) fn fill(&self, first: u32, rows: &mut [Rgba8], scratch: &mut EasuScratch) {
        let Self { drawn, phases, width } = self;
        let (lanes, lattice, width) = (phases.lanes, phases.lattice, *width);
        let places: Vec<_> = lattice.places_from(first).take(rows.len() / width).collect();
        let [Some(top), Some(bottom)] = [places.first(), places.last()] else { return };
        let EasuScratch { source, cell_row, runs } = scratch;
        source.read(lanes, drawn, top.cell - 1..bottom.cell + 3);
        cell_row.prepare(source);
        for from in (0..width).step_by(TILE) {
            let end = width.min(from + TILE);
            let [low, high] = [from, end - 1].map(|at| column_of(lattice.place(at as u32).cell));
            cell_row.begin(low..high + 2);
            for ((row, place), y) in rows.chunks_exact_mut(width).zip(&places).zip(first..) {
                on_lanes!(lanes, simd => {
                    cell_row.find(simd, source, lattice, *place);
                    let of = RowInputs::new(source, cell_row, *place);
                    fill_tile(simd, &of, phases.runs(from, y), runs, &mut row[from..end]);
                });
            }
        }
    }
}

/// Scratch buffers, reused between calls.
#[derive(Default)]
pub(in super::super) struct EasuScratch {
    source: SourceRows,
    cell_row: CellRow,
    runs: [PixelRun; RUNS],
}

/// Intermediate values of a run of pixels.
#[derive(Default)]
struct PixelRun {
    /// Whether the pixels need no filtering; see [`RowInputs::is_plain`].
    is_plain: bool,
    /// [`EdgeDirection`] of the pixels, stored field by field.
    direction: [[f32; WIDE]; 4],
    /// [`EasuKernelLanes`] of the pixels: each coefficient rounded, in the pixel order that [`rounded`] produces.
    shape: [[i16; WIDE]; 5],
}

/// Inputs for a row of output pixels.
struct RowInputs<'a> {
    /// Four rows of samples per channel, starting one row above the cells.
    samples: [[&'a [u32]; 4]; 4],
    of_cells: &'a CellRow,
    opaque: bool,
}

impl<'a> RowInputs<'a> {
    fn new(source: &'a SourceRows, of_cells: &'a CellRow, place: LatticePosition) -> Self {
        let samples = each!(channel in [0, 1, 2, 3] => source.channel(channel, place.cell));
        Self { samples, of_cells, opaque: source.opaque }
    }

    /// Whether the four nearest samples are equal in every cell of a run, and in some cells after it, so that its pixels
    /// need no filtering.
    #[inline(always)]
    fn is_plain<S: Simd>(&self, simd: S, run: &Run<'_, RunPhase>) -> bool {
        let at = run.phase.cells.first().wrapping_add_signed(run.offset);
        let [red, green, blue] = each!(channel in [0, 1, 2] => self.is_plain_in(simd, channel, at));
        let plain = red & green & blue;
        if self.opaque { plain.all_true() } else { (plain & self.is_plain_in(simd, 3, at)).all_true() }
    }

    #[inline(always)]
    fn is_plain_in<S: Simd>(&self, simd: S, channel: usize, at: usize) -> mask32x16<S> {
        let [least, greatest] = self.of_cells.bounds(channel);
        values(simd, least, at).simd_eq(values(simd, greatest, at))
    }

    /// Returns the colours of a run in which every cell is uniform; see [`Self::is_plain`].
    #[inline(always)]
    fn plain<S: Simd>(&self, simd: S, run: &Run<'_, RunPhase>) -> u32x16<S> {
        let [red, green, blue] = each!(channel in [0, 1, 2] => {
            whole_part(run.phase.cells.pick(simd, self.of_cells.bounds(channel)[0], run.offset))
        });
        let alpha = if self.opaque {
            u32x16::splat(simd, 255)
        } else {
            whole_part(run.phase.cells.pick(simd, self.of_cells.bounds(3)[0], run.offset))
        };
        red | green << 8 | blue << 16 | alpha << 24
    }

    /// Computes the colours of a run with the given sample weights.
    #[inline(always)]
    fn codes<S: Simd>(&self, simd: S, run: &Run<'_, RunPhase>, weights: &TapWeights<S>) -> u32x16<S> {
        let [red, green, blue] = each!(channel in [0, 1, 2] => self.channel(simd, channel, run, weights));
        // Besides the low byte, each value has bits only in its top byte. Those of green and blue are shifted out;
        // alpha replaces those of red.
        let color = red | green << 8 | blue << 16;
        if self.opaque {
            return color | 0xff00_0000;
        }
        (color & 0x00ff_ffff) | self.channel(simd, 3, run, weights) << 24
    }

    /// Computes one channel of 16 pixels; see [`super::code`]. Returns the bits of floats whose low byte is the 8-bit
    /// value.
    #[inline(always)]
    fn channel<S: Simd>(&self, simd: S, channel: usize, run: &Run<'_, RunPhase>, weights: &TapWeights<S>) -> u32x16<S> {
        let [above, upper, lower, below] = self.samples[channel];
        let [low, high] = each!(half in [0, 1] => {
            let [bc, ef, gh, ij, kl, no] = each!(
                (pair, row, column) in [(0, above, 1), (1, upper, 0), (2, upper, 2), (3, lower, 0), (4, lower, 2), (5, below, 1)] => {
                    let samples = run.phase.cells.pick_words(simd, half, row, run.offset + column - 1);
                    weights.pairs[pair][half].pairwise_dot_product(samples.bitcast::<i16x16<S>>())
                }
            );
            ((bc + no) + (ef + gh)) + (ij + kl)
        });
        let [least, greatest] = self.of_cells.bounds(channel);
        let [least, greatest] = each!(bound in [least, greatest] => run.phase.cells.pick(simd, bound, run.offset));
        let value = low.combine(high).to_float::<f32x16<S>>() * weights.share;
        (value.max(least).min(greatest) + WHOLE).bitcast()
    }
}

/// Fills the pixels of a row.
#[inline(always)]
fn fill_tile<S: Simd>(
    simd: S,
    of: &RowInputs<'_>,
    mut runs: Runs<'_, RunPhase>,
    work: &mut [PixelRun; RUNS],
    row: &mut [Rgba8],
) {
    let mut codes = [0; AHEAD];
    for pixels in row.chunks_mut(AHEAD) {
        fill_runs(simd, of, &mut runs, work, &mut codes);
        for (pixel, code) in pixels.iter_mut().zip(&codes) {
            *pixel = code.to_le_bytes();
        }
    }
}

/// Computes the pixels of the next [`RUNS`] runs, and performs each step for all runs before the next step. A step is a
/// dependency chain that contains a division or a square root; interleaving runs hides its latency.
#[inline(always)]
fn fill_runs<S: Simd>(
    simd: S,
    of: &RowInputs<'_>,
    runs: &mut Runs<'_, RunPhase>,
    work: &mut [PixelRun; RUNS],
    codes: &mut [u32; AHEAD],
) {
    let next = each!(_ in [0, 1, 2, 3] => runs.advance());
    for (run, pixels) in next.iter().zip(work.iter_mut()) {
        pixels.is_plain = of.is_plain(simd, run);
        if !pixels.is_plain {
            let [across, down, straightness] =
                each!(which in [0, 1, 2] => run.phase.mixed(simd, of.of_cells.slopes(which), run.offset));
            EdgeDirection::new(simd, across, down, straightness).store(&mut pixels.direction);
        }
    }
    for pixels in work.iter_mut() {
        if !pixels.is_plain {
            EasuKernelLanes::new(simd, EdgeDirection::load(simd, &pixels.direction)).store(&mut pixels.shape);
        }
    }
    for (index, (run, pixels)) in next.iter().zip(work.iter()).enumerate() {
        let color = if pixels.is_plain {
            of.plain(simd, run)
        } else {
            of.codes(simd, run, &TapWeights::new(simd, &pixels.shape, &run.phase.distances))
        };
        color.store_slice(&mut codes[index * WIDE..][..WIDE]);
    }
}

/// Edge directions of 16 pixels: intermediate values of [`super::EasuKernel::new`], up to and including its division.
struct EdgeDirection<S: Simd> {
    across: f32x16<S>,
    down: f32x16<S>,
    inverse: f32x16<S>,
    edge: f32x16<S>,
}

impl<S: Simd> EdgeDirection<S> {
    #[inline(always)]
    fn new(simd: S, across: f32x16<S>, down: f32x16<S>, straightness: f32x16<S>) -> Self {
        let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
        let flat = (across * across + down * down).simd_lt(f32x16::splat(simd, MIN_SLOPE));
        let (across, down) = (flat.select(one, across), flat.select(zero, down));
        let (xx, yy) = (across * across, down * down);
        let half = straightness * 0.5;
        Self { across, down, inverse: one / ((xx + yy) * xx.max(yy)), edge: half * half }
    }

    #[inline(always)]
    fn store(self, to: &mut [[f32; WIDE]; 4]) {
        let [across, down, inverse, edge] = to;
        self.across.store_array(across);
        self.down.store_array(down);
        self.inverse.store_array(inverse);
        self.edge.store_array(edge);
    }

    #[inline(always)]
    fn load(simd: S, from: &[[f32; WIDE]; 4]) -> Self {
        let [across, down, inverse, edge] = each!(of in [0, 1, 2, 3] => f32x16::load_array_ref(simd, &from[of]));
        Self { across, down, inverse, edge }
    }
}

/// Kernels of 16 pixels; see [`super::EasuKernel`].
struct EasuKernelLanes<S: Simd> {
    xx: f32x16<S>,
    xy: f32x16<S>,
    yy: f32x16<S>,
    slope: f32x16<S>,
    rest: f32x16<S>,
}

impl<S: Simd> EasuKernelLanes<S> {
    /// Computes the kernels from the edge directions, which is the second half of [`super::EasuKernel::new`].
    #[inline(always)]
    fn new(simd: S, EdgeDirection { across, down, inverse, edge }: EdgeDirection<S>) -> Self {
        let one = f32x16::splat(simd, 1.0);
        let (xx, yy) = (across * across, down * down);
        let (squared, most) = (xx + yy, xx.max(yy));
        let stretch = ((squared * squared) * inverse).sqrt();
        let inverse = most * inverse;
        let (xx, xy, yy) = (xx * inverse, (across * down) * inverse, yy * inverse);
        let (along, across) = ((stretch - 1.0) * edge + 1.0, one - edge * 0.5);
        let (along, across) = (along * along, across * across);
        let lobe = edge * EDGE_LOBE + 0.5;
        let factor = lobe * FACTOR;
        let (blob, turned) = (across * factor, (along - across) * factor);
        Self {
            xx: blob + turned * xx,
            xy: (turned + turned) * xy,
            yy: blob + turned * yy,
            slope: f32x16::splat(simd, 2.0 * ONE_DOUBLED) - lobe * (5.0 * ONE_DOUBLED),
            rest: (f32x16::splat(simd, ONE_SQUARED) - lobe * ONE_SQUARED) * (one - lobe * 4.0),
        }
    }

    /// Rounds and stores the coefficients, one vector after the other.
    #[inline(always)]
    fn store(self, to: &mut [[i16; WIDE]; 5]) {
        let [xx, xy, yy, slope, rest] = to;
        rounded(self.xx).store_array(xx);
        rounded(self.xy).store_array(xy);
        rounded(self.yy).store_array(yy);
        rounded(self.slope).store_array(slope);
        rounded(self.rest).store_array(rest);
    }
}

/// Weights of the twelve samples up to a common factor, interleaved in pairs of adjacent samples, and the factor that
/// normalises them.
struct TapWeights<S: Simd> {
    pairs: [[i16x16<S>; 2]; 6],
    share: f32x16<S>,
}

impl<S: Simd> TapWeights<S> {
    /// Computes the weights from a stored [`EasuKernelLanes`].
    #[inline(always)]
    fn new(simd: S, shape: &[[i16; WIDE]; 5], distances: &WideDistances) -> Self {
        let [xx, xy, yy, slope, rest] = each!(of in [0, 1, 2, 3, 4] => i16x16::load_array_ref(simd, &shape[of]));
        let one = i16x16::splat(simd, ONE);
        let columns = each!(column in [0, 1, 2, 3] => {
            one - times(xx, i16x16::load_array_ref(simd, &distances.xx[column]))
        });
        let rows = each!(row in [0, 1, 2, 3] => times(yy, i16x16::load_array_ref(simd, &distances.yy[row])));
        let [b, c, e, f, g, h, i, j, k, l, n, o] = each!((place, column, row) in [
            (0, 1, 0), (1, 2, 0), (2, 0, 1), (3, 1, 1), (4, 2, 1), (5, 3, 1),
            (6, 0, 2), (7, 1, 2), (8, 2, 2), (9, 3, 2), (10, 1, 3), (11, 2, 3),
        ] => {
            let turned = times(xy, i16x16::load_array_ref(simd, &distances.xy[place]));
            let w = ((columns[column] - rows[row]) - turned).max(0);
            let w = w + w;
            let squared = times(w, w);
            times(squared, squared + (rest - times(w, slope)))
        });
        let total = ((b + c) + (n + o)) + ((e + f) + (g + h)) + ((i + j) + (k + l));
        let [low, high]: [i32x8<S>; 2] = {
            let total = pairs(total, i16x16::splat(simd, 0));
            each!(half in [0, 1] => total[half].bitcast())
        };
        Self {
            pairs: [pairs(b, c), pairs(e, f), pairs(g, h), pairs(i, j), pairs(k, l), pairs(n, o)],
            share: f32x16::splat(simd, 1.0) / low.combine(high).to_float::<f32x16<S>>(),
        }
    }
}
