//! The arithmetic of [`super`] for sixteen pixels at a time: those of one phase in neighbouring cells, which look at
//! neighbouring samples. The same sums in the same order, so the same bits.
//!
//! Written without closures: those that the standard library calls would be compiled without the wide lanes' features.

use super::source::{AHEAD, MARGIN, RowOfCells, Source, TILE, values};
use super::{LEAST_SLOPE, LOBE_OF_EDGE, Spot, WHOLE};
use crate::image::{Image, Rgba8};
use crate::math::lanes::*;
use crate::upscale::lanes::window;
use crate::upscale::lattice::{Lattice, Place};

/// Samples across that a run of [`WIDE`] pixels of one phase looks at.
const RUN: usize = WIDE + 3;

/// Runs whose kernels are found before any of them is used. One kernel is a chain of divisions and a root, each of which waits for
/// the one before: those of neighbouring runs fill the time.
const RUNS: usize = AHEAD / WIDE;

/// Samples across that so many runs look at.
const SPAN: usize = AHEAD + 3;

/// Fills rows of `width` px, the first of which is row `first` of the picture, from samples, at least one.
pub(in super::super) fn fill(
    lanes: Lanes,
    drawn: &Image<Rgba8>,
    lattice: Lattice,
    (first, width): (u32, usize),
    rows: &mut [Rgba8],
    scratch: &mut Scratch,
) {
    let places: Vec<_> = lattice.places_from(first).take(rows.len() / width).collect();
    let [Some(top), Some(bottom)] = [places.first(), places.last()] else { return };
    let Scratch { source, row_of_cells } = scratch;
    source.read(lanes, drawn, top.cell - 1..bottom.cell + 4);
    let (pixels, samples) = lattice.scale.ratio();
    let cells = width.div_ceil(pixels as usize) * samples as usize;
    row_of_cells.prepare(source);
    let mut codes = [[0; TILE]; 3];
    for from in (0..cells).step_by(TILE) {
        row_of_cells.begin(from);
        for (row, place) in rows.chunks_exact_mut(width).zip(&places) {
            on_lanes!(lanes, simd => {
                row_of_cells.find(simd, source, lattice, *place);
                let of = Row::new(source, row_of_cells, *place);
                let row = &mut row[from / samples as usize * pixels as usize..];
                fill_tile(simd, &of, (lattice, *place), (from, cells.min(from + TILE)), &mut codes, row);
            });
        }
    }
}

/// Memory for what is found about samples.
#[derive(Default)]
pub(in super::super) struct Scratch {
    source: Source,
    row_of_cells: RowOfCells,
}

/// What a row of pixels is made of.
struct Row<'a> {
    /// Of each channel four rows of samples, from the one before the cells' own on.
    samples: [[&'a [f32]; 4]; 4],
    of_cells: &'a RowOfCells,
    opaque: bool,
}

impl<'a> Row<'a> {
    fn new(source: &'a Source, of_cells: &'a RowOfCells, place: Place) -> Self {
        let samples = each!(channel in [0, 1, 2, 3] => source.channel(channel, place.cell));
        Self { samples, of_cells, opaque: source.opaque }
    }

    /// What is looked at for the cells whose first samples stand at place `at` of the rows and after it.
    #[inline(always)]
    fn part(&self, at: usize) -> Part<'a> {
        let [red, green, blue, alpha] = each!(channel in [0, 1, 2, 3] => {
            let [least, greatest] = self.of_cells.bounds(channel);
            Channel {
                samples: each!(row in [0, 1, 2, 3] => window(self.samples[channel][row], at - 1)),
                least: window(least, at),
                greatest: window(greatest, at),
            }
        });
        Part {
            slopes: each!(of in [0, 1, 2] => window(self.of_cells.slopes(of), at)),
            colors: [red, green, blue],
            alpha: if self.opaque { None } else { Some(alpha) },
        }
    }
}

/// Part of a row: what [`RUNS`] runs look at.
struct Part<'a> {
    slopes: [&'a [f32; AHEAD + 1]; 3],
    colors: [Channel<'a>; 3],
    /// None if all are opaque.
    alpha: Option<Channel<'a>>,
}

impl Part<'_> {
    /// Whether in all cells of a run the four nearest samples are the same, and so the pixels between them.
    #[inline(always)]
    fn is_plain<S: Simd>(&self, simd: S, at: usize) -> bool {
        let [red, green, blue] = each!(channel in [0, 1, 2] => self.colors[channel].is_plain(simd, at));
        let plain = red & green & blue;
        match &self.alpha {
            None => plain.all_true(),
            Some(alpha) => (plain & alpha.is_plain(simd, at)).all_true(),
        }
    }

    /// The pixels of such a run.
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
}

/// Codes of one channel: from the sample before the first cell on, and what bounds them in each cell.
struct Channel<'a> {
    samples: [&'a [f32; SPAN]; 4],
    least: &'a [f32; AHEAD],
    greatest: &'a [f32; AHEAD],
}

/// Fills the pixels of a row from cell `from` on, phase after phase. `codes` are those of one phase, cell after cell, a pixel as its
/// four codes, the first in the lowest byte.
#[inline(always)]
fn fill_tile<S: Simd>(
    simd: S,
    of: &Row<'_>,
    (lattice, place): (Lattice, Place),
    (from, end): (usize, usize),
    codes: &mut [[u32; TILE]; 3],
    row: &mut [Rgba8],
) {
    let (pixels, samples) = lattice.scale.ratio();
    let (pixels, samples) = (pixels as usize, samples as usize);
    let parts = (end - from).div_ceil(AHEAD);
    for (first, codes) in codes.iter_mut().enumerate().take(pixels) {
        let column = lattice.place(first as u32);
        let spot = Spot::new(lattice, column.phase, place.phase);
        let mut at = from + (column.cell + MARGIN as i32) as usize;
        for codes in codes.as_chunks_mut::<AHEAD>().0.iter_mut().take(parts) {
            runs(simd, &of.part(at), spot, codes);
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

/// Makes the pixels of a part of a row.
#[inline(always)]
fn runs<S: Simd>(simd: S, of: &Part<'_>, spot: Spot, codes: &mut [u32; AHEAD]) {
    let mut shapes = [[[0.0; WIDE]; 5]; RUNS];
    let mut plain = [false; RUNS];
    for run in 0..RUNS {
        if of.is_plain(simd, run * WIDE) {
            plain[run] = true;
            continue;
        }
        let [across, down, straightness] =
            each!(slopes in [0, 1, 2] => mixed(simd, of.slopes[slopes], run * WIDE, spot));
        Shape::new(simd, across, down, straightness).store(&mut shapes[run]);
    }
    for run in 0..RUNS {
        if plain[run] {
            of.plain(simd, run * WIDE).store_slice(&mut codes[run * WIDE..][..WIDE]);
            continue;
        }
        let (weights, share) = Shape::load(simd, &shapes[run]).weights(simd, spot);
        let [red, green, blue] =
            each!(channel in [0, 1, 2] => of.colors[channel].codes(simd, run * WIDE, &weights, share));
        // What stands above the last byte of the first is overwritten, that of the others is shifted out or overwritten.
        let color = red | green << 8 | blue << 16;
        let color = match &of.alpha {
            None => color | 0xff00_0000,
            Some(alpha) => (color & 0x00ff_ffff) | alpha.codes(simd, run * WIDE, &weights, share) << 24,
        };
        color.store_slice(&mut codes[run * WIDE..][..WIDE]);
    }
}

/// [`Spot::mix`], its second half.
#[inline(always)]
fn mixed<S: Simd>(simd: S, row: &[f32], at: usize, spot: Spot) -> f32x16<S> {
    values(simd, row, at) * (1.0 - spot.x) + values(simd, row, at + 1) * spot.x
}

impl Channel<'_> {
    #[inline(always)]
    fn is_plain<S: Simd>(&self, simd: S, at: usize) -> mask32x16<S> {
        values(simd, self.least, at).simd_eq(values(simd, self.greatest, at))
    }

    /// [`super::code`]: floats whose last bytes are the codes, as their bits.
    #[inline(always)]
    fn codes<S: Simd>(&self, simd: S, at: usize, weights: &[f32x16<S>; 12], share: f32x16<S>) -> u32x16<S> {
        let [above, upper, lower, below]: [&[f32; RUN]; 4] =
            each!(row in [0, 1, 2, 3] => window(self.samples[row], at));
        let [b, c, e, f, g, h, i, j, k, l, n, o] = *weights;
        let above = b * values(simd, above, 1) + c * values(simd, above, 2);
        let upper = e * values(simd, upper, 0)
            + f * values(simd, upper, 1)
            + g * values(simd, upper, 2)
            + h * values(simd, upper, 3);
        let lower = i * values(simd, lower, 0)
            + j * values(simd, lower, 1)
            + k * values(simd, lower, 2)
            + l * values(simd, lower, 3);
        let below = n * values(simd, below, 1) + o * values(simd, below, 2);
        let value = ((above + upper) + (lower + below)) * share;
        let value = value.max(values(simd, self.least, at)).min(values(simd, self.greatest, at));
        (value + WHOLE).bitcast()
    }
}

/// [`super::Shape`] in lanes.
struct Shape<S: Simd> {
    xx: f32x16<S>,
    xy: f32x16<S>,
    yy: f32x16<S>,
    slope: f32x16<S>,
    rest: f32x16<S>,
}

impl<S: Simd> Shape<S> {
    #[inline(always)]
    fn new(simd: S, across: f32x16<S>, down: f32x16<S>, straightness: f32x16<S>) -> Self {
        let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
        let flat = (across * across + down * down).simd_lt(f32x16::splat(simd, LEAST_SLOPE));
        let (across, down) = (flat.select(one, across), flat.select(zero, down));
        let (xx, yy) = (across * across, down * down);
        let (squared, most) = (xx + yy, xx.max(yy));
        let inverse = one / (squared * most);
        let stretch = ((squared * squared) * inverse).sqrt();
        let inverse = most * inverse;
        let (xx, xy, yy) = (xx * inverse, (across * down) * inverse, yy * inverse);
        let half = straightness * 0.5;
        let edge = half * half;
        let (along, across) = ((stretch - 1.0) * edge + 1.0, one - edge * 0.5);
        let (along, across) = (along * along, across * across);
        let lobe = edge * LOBE_OF_EDGE + 0.5;
        let (blob, turned) = (across * lobe, (along - across) * lobe);
        Self {
            xx: blob + turned * xx,
            xy: (turned + turned) * xy,
            yy: blob + turned * yy,
            slope: f32x16::splat(simd, 2.0) - lobe * 5.0,
            rest: (one - lobe) * (one - lobe * 4.0),
        }
    }

    #[inline(always)]
    fn store(self, to: &mut [[f32; WIDE]; 5]) {
        let [xx, xy, yy, slope, rest] = to;
        self.xx.store_array(xx);
        self.xy.store_array(xy);
        self.yy.store_array(yy);
        self.slope.store_array(slope);
        self.rest.store_array(rest);
    }

    #[inline(always)]
    fn load(simd: S, from: &[[f32; WIDE]; 5]) -> Self {
        let [xx, xy, yy, slope, rest] = each!(of in [0, 1, 2, 3, 4] => f32x16::load_array_ref(simd, &from[of]));
        Self { xx, xy, yy, slope, rest }
    }

    /// Weights of the twelve samples, but for a factor that all have, and the share of a weight of one.
    #[inline(always)]
    fn weights(&self, simd: S, Spot { x, y }: Spot) -> ([f32x16<S>; 12], f32x16<S>) {
        let columns = each!(column in [-1.0, 0.0, 1.0, 2.0] => {
            let dx: f32 = column - x;
            self.xx * (dx * dx) - 1.0
        });
        let [[_, b, c, _], [e, f, g, h], [i, j, k, l], [_, n, o, _]] = each!(row in [-1.0, 0.0, 1.0, 2.0] => {
            let dy: f32 = row - y;
            let step = self.xy * dy;
            let own = self.yy * (dy * dy) - step * x;
            let places = [own - step, own, own + step, (own + step) + step];
            each!(column in [0, 1, 2, 3] => self.weight(simd, columns[column] + places[column]))
        });
        let total = ((b + c) + (e + f + g + h)) + ((i + j + k + l) + (n + o));
        ([b, c, e, f, g, h, i, j, k, l, n, o], f32x16::splat(simd, 1.0) / total)
    }

    #[inline(always)]
    fn weight(&self, simd: S, w: f32x16<S>) -> f32x16<S> {
        let w = w.min(f32x16::splat(simd, 0.0));
        let squared = w * w;
        squared * ((squared + w * self.slope) + self.rest)
    }
}
