//! SIMD version of [`super`] for 16 pixels at a time: pixels of one phase in adjacent cells, which read adjacent
//! samples. Floats are added in the same order, and integer sums are exact, so results are bit-identical.
//!
//! The code avoids closures: a closure called by the standard library would be compiled without the CPU features of the
//! wide lanes.

use super::source::{AHEAD, CellRow, MARGIN, SourceRows, TILE, values};
use super::{Distances, EDGE_LOBE, FACTOR, MIN_SLOPE, ONE, ONE_DOUBLED, ONE_SQUARED, Spot, WHOLE};
use crate::image::{Image, Rgba8};
use crate::math::lanes::*;
use crate::upscale::fsr::words::{pairs, rounded, times};
use crate::upscale::lanes::window;
use crate::upscale::lattice::{Lattice, LatticePosition};

/// Number of sample columns read by a run, which is [`WIDE`] pixels of one phase in adjacent cells.
const RUN: usize = WIDE + 3;

/// Number of runs whose computation is interleaved.
const RUNS: usize = AHEAD / WIDE;

/// Number of sample columns read by [`RUNS`] runs.
const SPAN: usize = AHEAD + 3;

/// Upscales a non-empty image of samples into `rows` of `width` px. The first of these is row `first` of the full
/// image.
pub(in super::super) fn fill(
    lanes: Lanes,
    drawn: &Image<Rgba8>,
    lattice: Lattice,
    (first, width): (u32, usize),
    rows: &mut [Rgba8],
    scratch: &mut EasuScratch,
) {
    let places: Vec<_> = lattice.places_from(first).take(rows.len() / width).collect();
    let [Some(top), Some(bottom)] = [places.first(), places.last()] else { return };
    let EasuScratch { source, cell_row: row_of_cells, runs } = scratch;
    source.read(lanes, drawn, top.cell - 1..bottom.cell + 3);
    let phases = Phases::new(lattice);
    let cells = width.div_ceil(phases.pixels) * phases.samples;
    row_of_cells.prepare(source);
    let mut codes = [[0; TILE]; 3];
    for from in (0..cells).step_by(TILE) {
        row_of_cells.begin(from);
        for ((row, place), y) in rows.chunks_exact_mut(width).zip(&places).zip(first..) {
            on_lanes!(lanes, simd => {
                row_of_cells.find(simd, source, lattice, *place);
                let of = RowInputs::new(source, row_of_cells, *place);
                let row = &mut row[from / phases.samples * phases.pixels..];
                fill_tile(simd, &of, (&phases, y), (from, cells.min(from + TILE)), (runs, &mut codes), row);
            });
        }
    }
}

/// Data shared by all pixels of a phase.
struct PixelPhase {
    /// Horizontal index of the cell that contains the first pixel of the phase.
    cell: i32,
    spot: Spot,
    distances: WideDistances,
}

/// All phases of a lattice. Along each axis, a period has `pixels` output pixels and `samples` samples.
struct Phases {
    pixels: usize,
    samples: usize,
    /// Phases in row-major order.
    all: Vec<PixelPhase>,
}

impl Phases {
    fn new(lattice: Lattice) -> Self {
        let (pixels, samples) = lattice.scale.ratio();
        let phase = |(row, column): (u32, u32)| {
            let (column, row) = (lattice.place(column), lattice.place(row));
            let spot = Spot::new(lattice, column.phase, row.phase);
            PixelPhase { cell: column.cell, spot, distances: WideDistances::new(Distances::new(spot)) }
        };
        let all = (0..pixels).flat_map(|row| (0..pixels).map(move |column| (row, column))).map(phase).collect();
        Self { pixels: pixels as usize, samples: samples as usize, all }
    }

    /// Returns the phases of the pixels in output row `row`.
    fn of_row(&self, row: u32) -> &[PixelPhase] {
        &self.all[row as usize % self.pixels * self.pixels..][..self.pixels]
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
    /// Whether the pixels need no filtering; see [`RunInputs::is_plain`].
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

    /// Returns the inputs of [`RUNS`] adjacent runs of cells, of which the first starts at index `at` of the rows.
    #[inline(always)]
    fn part(&self, at: usize) -> RunInputs<'a> {
        let [red, green, blue, alpha] = each!(channel in [0, 1, 2, 3] => {
            let [least, greatest] = self.of_cells.bounds(channel);
            ChannelRows {
                samples: each!(row in [0, 1, 2, 3] => window(self.samples[channel][row], at - 1)),
                least: window(least, at),
                greatest: window(greatest, at),
            }
        });
        RunInputs {
            slopes: each!(of in [0, 1, 2] => window(self.of_cells.slopes(of), at)),
            colors: [red, green, blue],
            alpha: if self.opaque { None } else { Some(alpha) },
        }
    }
}

/// Inputs of [`RUNS`] adjacent runs.
struct RunInputs<'a> {
    slopes: [&'a [f32; AHEAD + 1]; 3],
    colors: [ChannelRows<'a>; 3],
    /// Alpha channel; `None` if all samples are opaque.
    alpha: Option<ChannelRows<'a>>,
}

impl RunInputs<'_> {
    /// Whether the four nearest samples are equal in every cell of a run, so that its pixels need no filtering.
    #[inline(always)]
    fn is_plain<S: Simd>(&self, simd: S, at: usize) -> bool {
        let [red, green, blue] = each!(channel in [0, 1, 2] => self.colors[channel].is_plain(simd, at));
        let plain = red & green & blue;
        match &self.alpha {
            None => plain.all_true(),
            Some(alpha) => (plain & alpha.is_plain(simd, at)).all_true(),
        }
    }

    /// Returns the colours of a run in which every cell is uniform; see [`Self::is_plain`].
    #[inline(always)]
    fn plain<S: Simd>(&self, simd: S, at: usize) -> u32x16<S> {
        let [red, green, blue] =
            each!(channel in [0, 1, 2] => whole_part(values(simd, self.colors[channel].least, at)));
        let alpha = match &self.alpha {
            None => u32x16::splat(simd, 255),
            Some(alpha) => whole_part(values(simd, alpha.least, at)),
        };
        red | green << 8 | blue << 16 | alpha << 24
    }

    /// Computes the colours of a run with the given sample weights.
    #[inline(always)]
    fn codes<S: Simd>(&self, simd: S, at: usize, weights: &TapWeights<S>) -> u32x16<S> {
        let [red, green, blue] = each!(channel in [0, 1, 2] => self.colors[channel].codes(simd, at, weights));
        // Besides the low byte, each value has bits only in its top byte. Those of green and blue are shifted out;
        // alpha replaces those of red.
        let color = red | green << 8 | blue << 16;
        match &self.alpha {
            None => color | 0xff00_0000,
            Some(alpha) => (color & 0x00ff_ffff) | alpha.codes(simd, at, weights) << 24,
        }
    }
}

/// Inputs of one channel: pairs of adjacent samples, starting one sample before the first cell, and the minimum and
/// maximum in each cell.
struct ChannelRows<'a> {
    samples: [&'a [u32; SPAN]; 4],
    least: &'a [f32; AHEAD],
    greatest: &'a [f32; AHEAD],
}

/// Fills the pixels of a row from cell `from` to cell `end`, phase by phase. `codes` is scratch space for the packed
/// RGBA pixels of each phase, cell by cell, with red in the lowest byte.
#[inline(always)]
fn fill_tile<S: Simd>(
    simd: S,
    of: &RowInputs<'_>,
    (phases, y): (&Phases, u32),
    (from, end): (usize, usize),
    (work, codes): (&mut [PixelRun; RUNS], &mut [[u32; TILE]; 3]),
    row: &mut [Rgba8],
) {
    let parts = (end - from).div_ceil(AHEAD);
    let (pixels, samples) = (phases.pixels, phases.samples);
    for (phase, codes) in phases.of_row(y).iter().zip(codes.iter_mut()) {
        let mut at = from + (phase.cell + MARGIN as i32) as usize;
        for codes in codes.as_chunks_mut::<AHEAD>().0.iter_mut().take(parts) {
            fill_runs(simd, &of.part(at), phase, work, codes);
            at += AHEAD;
        }
    }
    let length = row.len().min((end - from) / samples * pixels);
    let row = &mut row[..length];
    if (pixels, samples) == (2, 1) {
        let [even, odd, _] = codes;
        let (pairs, last) = row.as_chunks_mut::<2>();
        for (pair, (even, odd)) in pairs.iter_mut().zip(even.iter().zip(odd.iter())) {
            *pair = [even.to_le_bytes(), odd.to_le_bytes()];
        }
        for pixel in last {
            *pixel = even[pairs.len()].to_le_bytes();
        }
        return;
    }
    for (first, codes) in codes[..pixels.min(length)].iter().enumerate() {
        for (pixel, code) in row[first..].iter_mut().step_by(pixels).zip(codes.iter().step_by(samples)) {
            *pixel = code.to_le_bytes();
        }
    }
}

/// Computes the pixels of [`RUNS`] runs, and performs each step for all runs before the next step. A step is a
/// dependency chain that contains a division or a square root; interleaving runs hides its latency.
#[inline(always)]
fn fill_runs<S: Simd>(
    simd: S,
    of: &RunInputs<'_>,
    phase: &PixelPhase,
    runs: &mut [PixelRun; RUNS],
    codes: &mut [u32; AHEAD],
) {
    for (index, run) in runs.iter_mut().enumerate() {
        run.is_plain = of.is_plain(simd, index * WIDE);
        if !run.is_plain {
            let [across, down, straightness] =
                each!(slopes in [0, 1, 2] => mixed(simd, of.slopes[slopes], index * WIDE, phase.spot));
            EdgeDirection::new(simd, across, down, straightness).store(&mut run.direction);
        }
    }
    for run in runs.iter_mut() {
        if !run.is_plain {
            EasuKernelLanes::new(simd, EdgeDirection::load(simd, &run.direction)).store(&mut run.shape);
        }
    }
    for (index, run) in runs.iter().enumerate() {
        let color = if run.is_plain {
            of.plain(simd, index * WIDE)
        } else {
            of.codes(simd, index * WIDE, &TapWeights::new(simd, &run.shape, &phase.distances))
        };
        color.store_slice(&mut codes[index * WIDE..][..WIDE]);
    }
}

/// Interpolates 16 pixels horizontally between vertically interpolated values, as in [`Spot::mix`].
#[inline(always)]
fn mixed<S: Simd>(simd: S, row: &[f32], at: usize, spot: Spot) -> f32x16<S> {
    values(simd, row, at) * (1.0 - spot.x) + values(simd, row, at + 1) * spot.x
}

impl ChannelRows<'_> {
    #[inline(always)]
    fn is_plain<S: Simd>(&self, simd: S, at: usize) -> mask32x16<S> {
        values(simd, self.least, at).simd_eq(values(simd, self.greatest, at))
    }

    /// Computes one channel of 16 pixels; see [`super::code`]. Returns the bits of floats whose low byte is the 8-bit
    /// value.
    #[inline(always)]
    fn codes<S: Simd>(&self, simd: S, at: usize, weights: &TapWeights<S>) -> u32x16<S> {
        let [above, upper, lower, below]: [&[u32; RUN]; 4] =
            each!(row in [0, 1, 2, 3] => window(self.samples[row], at));
        let [low, high] = each!((half, pixels) in [(0, 0), (1, LANES)] => {
            let [bc, ef, gh, ij, kl, no] = each!(
                (pair, row, column) in [(0, above, 1), (1, upper, 0), (2, upper, 2), (3, lower, 0), (4, lower, 2), (5, below, 1)] => {
                    let samples = u32x8::from_slice(simd, &row[column + pixels..column + pixels + LANES]);
                    weights.pairs[pair][half].pairwise_dot_product(samples.bitcast::<i16x16<S>>())
                }
            );
            ((bc + no) + (ef + gh)) + (ij + kl)
        });
        let value = low.combine(high).to_float::<f32x16<S>>() * weights.share;
        let value = value.max(values(simd, self.least, at)).min(values(simd, self.greatest, at));
        (value + WHOLE).bitcast()
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

/// Offsets of the samples from a pixel, each repeated for 16 pixels; see [`Distances`].
struct WideDistances {
    xx: [[i16; WIDE]; 4],
    yy: [[i16; WIDE]; 4],
    xy: [[i16; WIDE]; 12],
}

impl WideDistances {
    fn new(Distances { xx, yy, xy }: Distances) -> Self {
        Self { xx: xx.map(|of| [of; WIDE]), yy: yy.map(|of| [of; WIDE]), xy: xy.map(|of| [of; WIDE]) }
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
