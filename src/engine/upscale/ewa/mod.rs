//! Elliptical weighted average with a jinc kernel, also called EWA Lanczos.
//!
//! The weight of a sample depends on its distance from the output pixel, not on its horizontal and vertical offsets one
//! by one. Edges of all directions are therefore treated alike. With equal scales along both axes, the ellipse is a
//! circle of radius 3.24 samples, which holds 33 samples on average.
//!
//! Weights are multiples of 2⁻¹⁵, and sums are exact in 32-bit integers. A result therefore does not depend on the order
//! of the sum. It differs from exact arithmetic by less than 0.65 of an 8-bit step.

mod kernel;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use kernel::{BEFORE, POINT, TAPS, WeightTable, Weights};

use super::separable::SCALES;
use super::{Anchor, FilterSpace, Offers, Sampling, Tap, UpscaleInputs, Upscaler, Upscaling, bands};
use crate::image::{Image, Rgba8};
use crate::math::lanes::*;
use crate::pipeline::settings::Choice as _;

/// Radially symmetric Lanczos filter.
pub(crate) static EWA_LANCZOS: EwaLanczos = EwaLanczos;

/// [`Upscaler`] implementation of [`EWA_LANCZOS`].
pub(crate) struct EwaLanczos;

/// Number of border samples added on each side of a row.
const MARGIN: i32 = BEFORE + 1;

/// Number of pairs of adjacent rows, or columns, around an output pixel.
const PAIRS: usize = TAPS / 2;

/// Number of rows of sample pairs that are kept.
const RING: usize = 8;

/// Index of the first of the four nearest samples in a row or column of weights.
const INNER: usize = BEFORE as usize;

impl Upscaler for EwaLanczos {
    fn id(&self) -> &'static str {
        "ewa-lanczos"
    }

    fn name(&self) -> &'static str {
        "EWA Lanczos"
    }

    fn help(&self) -> &'static str {
        "A jinc windowed by a wider jinc, by the distance of each sample within 3.24 samples. Good on slanted edges and \
         fine detail: treats all directions alike, where Lanczos favours rows and columns. Rings beside hard edges \
         unless de-ringed, and softens the drawn pixels slightly. Sources: Greene and Heckbert, Creating Raster Omnimax \
         Images Using the Elliptical Weighted Average Filter (1986); the kernel as in ImageMagick's filter Lanczos."
    }

    fn artefacts(&self) -> &'static str {
        "ringing at hard edges"
    }

    fn offers(&self) -> Offers {
        Offers {
            scales: SCALES,
            anchors: Anchor::ALL,
            lights: &[FilterSpace::Bytes],
            deringing: true,
            sharpening: false,
            history: false,
        }
    }

    fn alters_samples(&self) -> bool {
        true
    }

    fn sampling(&self, how: Upscaling) -> Sampling {
        Sampling::of_lattice(how.lattice())
    }

    fn upscale(&self, how: Upscaling, drawn: &UpscaleInputs<'_>, full: &mut Image<Rgba8>) {
        fill(Lanes::best(), how, drawn.color, full);
    }

    fn pixel(&self, how: Upscaling, drawn: &UpscaleInputs<'_>, _size: (u32, u32), at: (u32, u32)) -> Rgba8 {
        let table = WeightTable::of(how.lattice());
        let terms = terms(how, table.at(at), at);
        std::array::from_fn(|channel| {
            let code = |x: i64, y: i64| i32::from(drawn.color.at_clamped(x, y)[channel]);
            let code = code_of(terms.iter().map(|(x, y, weight)| i32::from(*weight) * code(*x, *y)).sum());
            if !how.deringing() {
                return code;
            }
            let inner = inner_samples(how, at).map(|(x, y)| drawn.color.at_clamped(x, y)[channel]);
            inner.iter().fold(255, |least, code| least.min(*code)).max(code).min(inner.into_iter().fold(0, u8::max))
        })
    }

    fn taps(&self, how: Upscaling, drawn: &UpscaleInputs<'_>, _size: (u32, u32), at: (u32, u32)) -> Vec<Tap> {
        let (columns, rows) = drawn.color.size();
        let inside = |at: i64, length: u32| at.clamp(0, i64::from(length) - 1) as u32;
        let table = WeightTable::of(how.lattice());
        let mut sums: BTreeMap<(u32, u32), i32> = BTreeMap::new();
        // De-ringing reads the nearest samples even if they have no weight.
        let inner = inner_samples(how, at).map(|(x, y)| (x, y, 0));
        let terms = terms(how, table.at(at), at).into_iter().filter(|(.., weight)| *weight != 0);
        for (x, y, weight) in terms.chain(inner) {
            *sums.entry((inside(y, rows), inside(x, columns))).or_default() += i32::from(weight);
        }
        let tap = |((row, column), weight)| {
            let (x, y) = how.grid().pixel(column, row);
            Tap { x, y, weight: weight as f32 / (1 << POINT) as f32 }
        };
        sums.into_iter().map(tap).collect()
    }
}

/// Returns column, row and weight of the samples around an output pixel; samples may lie outside the image.
fn terms(how: Upscaling, weights: &Weights, (x, y): (u32, u32)) -> Vec<(i64, i64, i16)> {
    let [left, top] = [x, y].map(|at| i64::from(how.lattice().place(at).cell - BEFORE));
    let row = |(y, row): (i64, &[i16; TAPS])| (left..).zip(*row).map(move |(x, weight)| (x, y, weight));
    (top..).zip(weights).flat_map(row).collect()
}

/// Returns column and row of the four samples nearest to an output pixel.
fn inner_samples(how: Upscaling, (x, y): (u32, u32)) -> [(i64, i64); 4] {
    let [x, y] = [x, y].map(|at| i64::from(how.lattice().place(at).cell));
    [(x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)]
}

/// Rounds a weighted sum to the nearest 8-bit value.
#[inline(always)]
fn code_of(sum: i32) -> u8 {
    ((sum + (1 << (POINT - 1))) >> POINT).clamp(0, 255) as u8
}

/// Sample of one row and sample below it, channel by channel.
type SamplePair = [i16; 8];

/// Weights of an output pixel, repeated for all channels: for each pair of rows and each pair of columns.
type WideWeights = [[[i16; 16]; PAIRS]; PAIRS];

/// Repeats weights for all channels.
fn widened(weights: &Weights) -> WideWeights {
    let word = |rows: usize, columns: usize, index: usize| weights[2 * rows + index % 2][2 * columns + index / 8];
    std::array::from_fn(|rows| std::array::from_fn(|columns| std::array::from_fn(|index| word(rows, columns, index))))
}

/// Pairs two rows of samples, extended by [`MARGIN`] copies of their border samples.
fn fill_pairs(upper: &[Rgba8], lower: &[Rgba8], pairs: &mut Vec<SamplePair>) {
    let last = upper.len() as i32 - 1;
    let sample = |at: i32| at.clamp(0, last) as usize;
    let pair =
        |at: usize| std::array::from_fn(|index| i16::from(if index % 2 == 0 { upper } else { lower }[at][index / 2]));
    pairs.clear();
    pairs.extend((-MARGIN..0).map(|at| pair(sample(at))));
    pairs.extend(
        upper
            .iter()
            .zip(lower)
            .map(|([r, g, b, a], lower)| [*r, lower[0], *g, lower[1], *b, lower[2], *a, lower[3]].map(i16::from)),
    );
    pairs.extend((last + 1..=last + MARGIN).map(|at| pair(sample(at))));
}

/// Upscales samples into an image. The result does not depend on `lanes`.
fn fill(lanes: Lanes, how: Upscaling, drawn: &Image<Rgba8>, full: &mut Image<Rgba8>) {
    let lattice = how.lattice();
    let places = lattice.places_from(0).take(full.width() as usize);
    let columns: Vec<_> = places.map(|place| (place.cell + MARGIN - BEFORE) as usize).collect();
    let job = FillJob { how, drawn, table: &WeightTable::of(lattice), columns: &columns };
    bands::fill(full, lattice.scale, |first, _, band| on_lanes!(lanes, simd => job.fill_band(simd, first, band)));
}

/// Inputs of an image to fill, shared by its bands.
struct FillJob<'a> {
    how: Upscaling,
    drawn: &'a Image<Rgba8>,
    table: &'a WeightTable,
    /// Index of the first sample that each output column reads, in a row with margins.
    columns: &'a [usize],
}

impl FillJob<'_> {
    /// Fills a band, which starts at row `first` of the image. Each row of samples is paired with the next one once.
    #[inline(always)]
    fn fill_band<S: Simd>(&self, simd: S, first: u32, band: &mut [Rgba8]) {
        let last = self.drawn.height() as i32 - 1;
        let row_of = |at: i32| self.drawn.row(at.clamp(0, last) as u32);
        let slot = |at: i32| at.rem_euclid(RING as i32) as usize;
        let mut ring: [Vec<SamplePair>; RING] = Default::default();
        let mut next = i32::MIN;
        let rows = band.chunks_exact_mut(self.columns.len());
        for ((row, place), y) in rows.zip(self.how.lattice().places_from(first)).zip(first..) {
            next = next.max(place.cell - BEFORE);
            while next <= place.cell + BEFORE {
                fill_pairs(row_of(next), row_of(next + 1), &mut ring[slot(next)]);
                next += 1;
            }
            let around = [0, 2, 4, 6].map(|tap| ring[slot(place.cell - BEFORE + tap)].as_slice());
            let weights: Vec<_> = self.table.row(y).iter().map(widened).collect();
            let inner = self.how.deringing().then(|| ring[slot(place.cell)].as_slice());
            for ((pixel, start), weights) in row.iter_mut().zip(self.columns).zip(weights.iter().cycle()) {
                *pixel = mean(simd, around, weights, *start);
                if let Some(inner) = inner {
                    *pixel = clamped(*pixel, &inner[start + INNER], &inner[start + INNER + 1]);
                }
            }
        }
    }
}

/// Computes the weighted mean of the samples from column `start` on.
#[inline(always)]
fn mean<S: Simd>(simd: S, around: [&[SamplePair]; PAIRS], weights: &WideWeights, start: usize) -> Rgba8 {
    let mut sum = i32x8::splat(simd, 0);
    for rows in 0..PAIRS {
        let samples = around[rows][start..start + TAPS].as_flattened();
        for columns in 0..PAIRS {
            let samples = i16x16::from_slice(simd, &samples[16 * columns..16 * columns + 16]);
            sum += samples.pairwise_dot_product(i16x16::load_array_ref(simd, &weights[rows][columns]));
        }
    }
    let sum = sum.to_array();
    std::array::from_fn(|channel| code_of(sum[channel] + sum[channel + 4]))
}

/// Clamps a pixel to the range of four samples, given as two pairs.
#[inline(always)]
fn clamped(pixel: Rgba8, left: &SamplePair, right: &SamplePair) -> Rgba8 {
    std::array::from_fn(|channel| {
        let [upper_left, lower_left] = [left[2 * channel], left[2 * channel + 1]];
        let [upper_right, lower_right] = [right[2 * channel], right[2 * channel + 1]];
        let least = upper_left.min(lower_left).min(upper_right.min(lower_right));
        let greatest = upper_left.max(lower_left).max(upper_right.max(lower_right));
        i16::from(pixel[channel]).max(least).min(greatest) as u8
    })
}
