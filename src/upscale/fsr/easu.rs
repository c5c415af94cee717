//! Edge-adaptive spatial upsampling.
//!
//! Around an output pixel stand the four nearest samples f, g, j, k and eight more:
//!
//! ```text
//!     b c            1. at each of the four: the slope of luma across and down, and how straight it runs (1 for an
//!   e f g h             even slope, 0 for a ridge), mixed by their nearness to the pixel
//!   i j k l          2. that gives the direction of the edge, and a kernel stretched along it: a polynomial that
//!     n o               resembles Lanczos's, narrower across a clear edge
//!                    3. the weighted mean, kept within the range of f, g, j, k
//! ```
//!
//! The publication writes the weight at a squared distance s from the pixel, measured along the edge and across it and cut
//! off at 1/λ for a lobe λ, as (25/16 (2/5 s − 1)² − 9/16) (λ s − 1)². That is λ²/4 · (s − 1) (s − 4) (s − 1/λ)², and as the
//! weights of a pixel are divided by their sum, λ²/4 is left out. The squared distance is a quadratic form in x and y.
//!
//! Channels are codes. Slopes belong to samples, so they are found once for each. Alpha is weighed like a colour.

use std::ops::Range;

use crate::image::{Image, Rgba8};
use crate::math::lanes::*;
use crate::upscale::lattice::{Lattice, Place};

/// Samples that are repeated around the picture: as far as the kernel reaches, and one more for slopes.
const MARGIN: usize = 3;

/// Samples across that a run of [`LANES`] pixels of one phase looks at.
const RUN: usize = LANES + 3;

/// Below this a squared slope has no direction: (1/181)² of the range of codes, less than a code over the width of the
/// kernel.
const LEAST_SLOPE: f32 = 255.0 * 255.0 / 32768.0;

/// What a clear edge takes off the lobe.
const LOBE_OF_EDGE: f32 = 0.25 - 0.04 - 0.5;

/// Places of the twelve samples relative to f, columns and rows.
const PLACES: [(i32, i32); 12] =
    [(0, -1), (1, -1), (-1, 0), (0, 0), (1, 0), (2, 0), (-1, 1), (0, 1), (1, 1), (2, 1), (0, 2), (1, 2)];

/// The four nearest, as places in [`PLACES`].
const NEAREST: [usize; 4] = [3, 4, 7, 8];

/// What is known about a sample: four channels, slope across and down, straightness, luma.
const PLANES: usize = 8;

/// Rows of samples, channel by channel, with a margin, and the slopes there.
struct Source {
    stride: usize,
    /// The sample row that the planes begin with; rows beyond the picture repeat its outermost.
    first_row: i32,
    planes: [Vec<f32>; PLANES],
    /// Whether alpha is full everywhere, so that nobody need weigh it.
    opaque: bool,
}

impl Source {
    /// These rows of samples, of a picture of at least one: from the one before the first cells to the third after the last, as
    /// rows are handed out in fours. Slopes are found in all of them but the first and the last.
    fn new(lanes: Lanes, drawn: &Image<Rgba8>, rows: Range<i32>) -> Self {
        let stride = drawn.width() as usize + 2 * MARGIN + 2 * LANES;
        let planes = std::array::from_fn(|_| vec![0.0; stride * rows.len()]);
        let mut source = Self { stride, first_row: rows.start, planes, opaque: true };
        let last = drawn.height() as i32 - 1;
        for (at, row) in rows.clone().enumerate() {
            let samples = drawn.row(row.clamp(0, last) as u32);
            source.opaque &= samples.iter().all(|sample| sample[3] == 255);
            on_lanes!(lanes, simd => source.spread(simd, samples, at));
        }
        for row in 1..rows.len() - 1 {
            on_lanes!(lanes, simd => source.find_slopes(simd, row));
        }
        source
    }

    /// Puts a row of samples into the planes.
    #[inline(always)]
    fn spread<S: Simd>(&mut self, _simd: S, samples: &[Rgba8], row: usize) {
        for channel in 0..4 {
            let plane = &mut self.planes[channel][row * self.stride..][..self.stride];
            let (left, rest) = plane.split_at_mut(MARGIN);
            let (middle, right) = rest.split_at_mut(samples.len());
            left.fill(f32::from(samples[0][channel]));
            for (value, sample) in middle.iter_mut().zip(samples) {
                *value = f32::from(sample[channel]);
            }
            right.fill(f32::from(samples[samples.len() - 1][channel]));
        }
        let of_row = row * self.stride..(row + 1) * self.stride;
        let [red, green, blue, .., luma] = &mut self.planes;
        let [red, green, blue] = [red, green, blue].map(|plane| &plane[of_row.clone()]);
        for (((luma, r), g), b) in luma[of_row.clone()].iter_mut().zip(red).zip(green).zip(blue) {
            *luma = 0.5 * (r + b) + g;
        }
    }

    /// Finds the slopes of a row of the planes that has one above and one below.
    #[inline(always)]
    fn find_slopes<S: Simd>(&mut self, _simd: S, row: usize) {
        let (stride, inner) = (self.stride, self.stride - 2);
        let [.., across, down, straightness, luma] = &mut self.planes;
        let from = |row: usize, column: usize| &luma[row * stride + column..][..inner];
        let (left, own, right) = (from(row, 0), from(row, 1), from(row, 2));
        let (above, below) = (from(row - 1, 1), from(row + 1, 1));
        let [across, down, straightness] =
            [across, down, straightness].map(|plane| &mut plane[row * stride + 1..][..inner]);
        for at in 0..inner {
            let (dx, along_x) = slope(left[at], own[at], right[at]);
            let (dy, along_y) = slope(above[at], own[at], below[at]);
            (across[at], down[at], straightness[at]) = (dx, dy, along_x + along_y);
        }
    }

    /// Four rows of a plane, `before` rows before the cells' own and on, from the sample before a group of cells on.
    #[inline(always)]
    fn rows(&self, plane: usize, column: i32, row: i32, before: i32) -> Rows<'_> {
        let (column, row) = ((column - 1 + MARGIN as i32) as usize, (row - before - self.first_row) as usize);
        let rows = &self.planes[plane][row * self.stride + column..];
        [0, 1, 2, 3].map(|below| window(rows, below * self.stride))
    }
}

/// The [`RUN`] values from place `at` on. Panics if there are fewer.
#[inline(always)]
fn window(values: &[f32], at: usize) -> &[f32; RUN] {
    values[at..].first_chunk().unwrap_or_else(|| panic!("{RUN} values from {at} on of {}", values.len()))
}

/// The slope at a value between two, and how straight it runs: 1 where both sides share it, 0 at a ridge.
#[inline(always)]
fn slope(before: f32, at: f32, after: f32) -> (f32, f32) {
    let slope = after - before;
    let steepest = (after - at).abs().max((at - before).abs());
    let straight = if steepest > 0.0 { (slope.abs() / steepest).min(1.0) } else { 0.0 };
    (slope, straight * straight)
}

/// Where the pixel lies between f and its neighbours, and how much of each of the four nearest it is.
#[derive(Clone, Copy)]
struct Spot {
    x: f32,
    y: f32,
    shares: [f32; 4],
}

impl Spot {
    fn new(lattice: Lattice, x: u32, y: u32) -> Self {
        let [x, y] = [x, y].map(|phase| phase as f32 / lattice.phases() as f32);
        Self { x, y, shares: [(1.0 - x) * (1.0 - y), x * (1.0 - y), (1.0 - x) * y, x * y] }
    }
}

/// The kernel at a pixel, turned along the edge and scaled along both of its axes.
#[derive(Clone, Copy)]
struct Shape {
    /// Factors of x², xy and y² in the squared distance.
    xx: f32,
    xy: f32,
    yy: f32,
    /// The squared distance at which the kernel ends.
    cut: f32,
}

impl Shape {
    /// From the mixed slopes and straightness.
    fn new(across: f32, down: f32, straightness: f32) -> Self {
        let squared = across * across + down * down;
        let (x, y) = if squared < LEAST_SLOPE {
            (1.0, 0.0)
        } else {
            let inverse = 1.0 / squared.sqrt();
            (across * inverse, down * inverse)
        };
        let half = straightness * 0.5;
        let edge = half * half;
        let stretch = 1.0 / x.abs().max(y.abs());
        let (along, across) = ((stretch - 1.0) * edge + 1.0, 1.0 - edge * 0.5);
        let (along, across) = (along * along, across * across);
        // A lobe of ½ is a plain blob; near ¼ the kernel resembles Lanczos with two lobes.
        let lobe = edge * LOBE_OF_EDGE + 0.5;
        let (x_squared, y_squared) = (x * x, y * y);
        Self {
            xx: along * x_squared + across * y_squared,
            xy: (along - across) * (x * y) * 2.0,
            yy: along * y_squared + across * x_squared,
            cut: 1.0 / lobe,
        }
    }

    /// Weight of a sample at a distance from the pixel, but for a factor that all have.
    fn weight(&self, dx: f32, dy: f32) -> f32 {
        let squared = self.xx * (dx * dx) + self.yy * (dy * dy) + self.xy * (dx * dy);
        let squared = squared.min(self.cut);
        let window = squared - self.cut;
        (squared - 1.0) * (squared - 4.0) * (window * window)
    }
}

/// One channel of a pixel from weights and the twelve samples, within the range of the four nearest, as a code.
#[inline(always)]
fn code(weights: &[f32; 12], share: f32, samples: &[f32; 12]) -> f32 {
    let mut sum = weights[0] * samples[0];
    for (weight, sample) in weights.iter().zip(samples).skip(1) {
        sum += weight * sample;
    }
    let [f, g, j, k] = NEAREST.map(|place| samples[place]);
    let (least, greatest) = (f.min(g).min(j.min(k)), f.max(g).max(j.max(k)));
    (sum * share).max(least).min(greatest)
}

/// Weights of the twelve samples, and the share of a weight of one.
#[inline(always)]
fn weights(spot: Spot, slopes: [[f32; 4]; 3]) -> ([f32; 12], f32) {
    let [across, down, straightness] = slopes.map(|of| {
        let [f, g, j, k] = spot.shares;
        f * of[0] + g * of[1] + j * of[2] + k * of[3]
    });
    let shape = Shape::new(across, down, straightness);
    let mut weights = [0.0; 12];
    let mut total = 0.0;
    for (weight, (column, row)) in weights.iter_mut().zip(PLACES) {
        *weight = shape.weight(column as f32 - spot.x, row as f32 - spot.y);
        total += *weight;
    }
    (weights, 1.0 / total)
}

/// Weights at one pixel, by the cell that it lies in.
fn weights_at(drawn: &Image<Rgba8>, lattice: Lattice, (x, y): (u32, u32)) -> (Place, Place, [f32; 12], f32) {
    let (column, row) = (lattice.place(x), lattice.place(y));
    let luma = |x: i32, y: i32| {
        let [r, g, b, _] = drawn.at_clamped(x.into(), y.into()).map(f32::from);
        0.5 * (r + b) + g
    };
    let mut slopes = [[0.0; 4]; 3];
    for (index, place) in NEAREST.into_iter().enumerate() {
        let (x, y) = (column.cell + PLACES[place].0, row.cell + PLACES[place].1);
        let (dx, along_x) = slope(luma(x - 1, y), luma(x, y), luma(x + 1, y));
        let (dy, along_y) = slope(luma(x, y - 1), luma(x, y), luma(x, y + 1));
        (slopes[0][index], slopes[1][index], slopes[2][index]) = (dx, dy, along_x + along_y);
    }
    let (weights, share) = weights(Spot::new(lattice, column.phase, row.phase), slopes);
    (column, row, weights, share)
}

/// One pixel, by the arithmetic that fills the whole picture.
pub(super) fn pixel(drawn: &Image<Rgba8>, lattice: Lattice, at: (u32, u32)) -> Rgba8 {
    let (column, row, weights, share) = weights_at(drawn, lattice, at);
    let samples = PLACES.map(|(x, y)| drawn.at_clamped((column.cell + x).into(), (row.cell + y).into()));
    std::array::from_fn(|channel| {
        (code(&weights, share, &samples.map(|sample| f32::from(sample[channel]))) + 0.5) as u8
    })
}

/// The samples of one pixel, each once: row, column and weight.
pub(super) fn taps(drawn: &Image<Rgba8>, lattice: Lattice, at: (u32, u32)) -> Vec<(u32, u32, f32)> {
    let (column, row, weights, share) = weights_at(drawn, lattice, at);
    let inside = |at: i32, length: u32| at.clamp(0, length as i32 - 1) as u32;
    let mut taps: Vec<(u32, u32, f32)> = Vec::with_capacity(PLACES.len());
    for ((x, y), weight) in PLACES.into_iter().zip(weights) {
        let (x, y) = (inside(column.cell + x, drawn.width()), inside(row.cell + y, drawn.height()));
        match taps.iter_mut().find(|tap| (tap.0, tap.1) == (y, x)) {
            Some(tap) => tap.2 += weight * share,
            None => taps.push((y, x, weight * share)),
        }
    }
    taps
}

/// Fills rows of `width` px, the first of which is row `first` of the picture, from samples, at least one.
pub(super) fn fill(
    lanes: Lanes,
    drawn: &Image<Rgba8>,
    lattice: Lattice,
    (first, width): (u32, usize),
    rows: &mut [Rgba8],
) {
    let places: Vec<_> = lattice.places_from(first).take(rows.len() / width).collect();
    let [Some(top), Some(bottom)] = [places.first(), places.last()] else { return };
    let source = Source::new(lanes, drawn, top.cell - 1..bottom.cell + 4);
    for (row, place) in rows.chunks_exact_mut(width).zip(places) {
        let phases = Phases { lattice, row: place };
        on_lanes!(lanes, simd => fill_lanes(simd, &source, phases, row));
    }
}

/// Where the pixels of a row lie.
#[derive(Clone, Copy)]
struct Phases {
    lattice: Lattice,
    row: Place,
}

/// Fills a row, phase after phase: in neighbouring cells the pixels of one phase look at neighbouring samples.
#[inline(always)]
fn fill_lanes<S: Simd>(simd: S, source: &Source, Phases { lattice, row: place }: Phases, row: &mut [Rgba8]) {
    let (pixels, samples) = lattice.scale.ratio();
    let (pixels, samples) = (pixels as usize, samples as usize);
    for first in 0..pixels.min(row.len()) {
        let column = lattice.place(first as u32);
        let spot = Spot::new(lattice, column.phase, place.phase);
        let (mut cell, mut at) = (column.cell, first);
        while at < row.len() {
            let codes: [u32; LANES] = lanes(simd, source, (cell, place.cell), spot).into();
            for (pixel, color) in row[at..].iter_mut().step_by(pixels).zip(codes.iter().step_by(samples)) {
                *pixel = color.to_le_bytes();
            }
            at += pixels * LANES / samples;
            cell += LANES as i32;
        }
    }
}

/// Eight pixels of one phase in neighbouring cells, from `cell` on: the steps of [`weights`] and [`code`] in lanes, with
/// the same sums in the same order. A pixel is its four codes, the first in the lowest byte. Written without closures: those
/// that the standard library calls would be compiled without the wide lanes' features.
#[inline(always)]
fn lanes<S: Simd>(simd: S, source: &Source, (column, row): (i32, i32), spot: Spot) -> u32x8<S> {
    let across = mixed(simd, source.rows(4, column, row, 0), spot);
    let down = mixed(simd, source.rows(5, column, row, 0), spot);
    let shape = Shape8::new(simd, across, down, mixed(simd, source.rows(6, column, row, 0), spot));
    let (weights, share) = shape.weights(simd, spot);
    let mut codes = channel(simd, &weights, share, source.rows(0, column, row, 1));
    codes |= channel(simd, &weights, share, source.rows(1, column, row, 1)) << 8;
    codes |= channel(simd, &weights, share, source.rows(2, column, row, 1)) << 16;
    if source.opaque {
        return codes | 0xff00_0000;
    }
    codes | channel(simd, &weights, share, source.rows(3, column, row, 1)) << 24
}

/// Neighbouring rows of a plane, from the sample before a group of cells on.
type Rows<'a> = [&'a [f32; RUN]; 4];

/// Eight values from place `at` of a row on.
#[inline(always)]
fn run<S: Simd>(simd: S, row: &[f32; RUN], at: usize) -> f32x8<S> {
    f32x8::from_slice(simd, &row[at..at + LANES])
}

/// What is known about the four nearest samples, by their nearness; rows from the cells' own on.
#[inline(always)]
fn mixed<S: Simd>(simd: S, rows: Rows<'_>, spot: Spot) -> f32x8<S> {
    let [f, g, j, k] = spot.shares;
    let upper = run(simd, rows[0], 1) * f + run(simd, rows[0], 2) * g;
    upper + run(simd, rows[1], 1) * j + run(simd, rows[1], 2) * k
}

/// [`code`] in lanes, of one channel; rows from the one before the cells' own on.
#[inline(always)]
fn channel<S: Simd>(simd: S, weights: &[f32x8<S>; 12], share: f32x8<S>, rows: Rows<'_>) -> u32x8<S> {
    let (f, g) = (run(simd, rows[1], 1), run(simd, rows[1], 2));
    let (j, k) = (run(simd, rows[2], 1), run(simd, rows[2], 2));
    let mut sum = weights[0] * run(simd, rows[0], 1);
    sum += weights[1] * run(simd, rows[0], 2);
    sum += weights[2] * run(simd, rows[1], 0);
    sum += weights[3] * f;
    sum += weights[4] * g;
    sum += weights[5] * run(simd, rows[1], 3);
    sum += weights[6] * run(simd, rows[2], 0);
    sum += weights[7] * j;
    sum += weights[8] * k;
    sum += weights[9] * run(simd, rows[2], 3);
    sum += weights[10] * run(simd, rows[3], 1);
    sum += weights[11] * run(simd, rows[3], 2);
    let (least, greatest) = (f.min(g).min(j.min(k)), f.max(g).max(j.max(k)));
    u32x8::truncate_from((sum * share).max(least).min(greatest) + 0.5)
}

/// [`Shape`] in lanes.
struct Shape8<S: Simd> {
    xx: f32x8<S>,
    xy: f32x8<S>,
    yy: f32x8<S>,
    cut: f32x8<S>,
}

impl<S: Simd> Shape8<S> {
    #[inline(always)]
    fn new(simd: S, across: f32x8<S>, down: f32x8<S>, straightness: f32x8<S>) -> Self {
        let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
        let squared = across * across + down * down;
        let flat = squared.simd_lt(f32x8::splat(simd, LEAST_SLOPE));
        let inverse = one / squared.sqrt();
        let (x, y) = (flat.select(one, across * inverse), flat.select(zero, down * inverse));
        let half = straightness * 0.5;
        let edge = half * half;
        let stretch = one / x.abs().max(y.abs());
        let (along, across) = ((stretch - 1.0) * edge + 1.0, one - edge * 0.5);
        let (along, across) = (along * along, across * across);
        let lobe = edge * LOBE_OF_EDGE + 0.5;
        let (x_squared, y_squared) = (x * x, y * y);
        Self {
            xx: along * x_squared + across * y_squared,
            xy: (along - across) * (x * y) * 2.0,
            yy: along * y_squared + across * x_squared,
            cut: one / lobe,
        }
    }

    /// Weights of the twelve samples, and the share of a weight of one.
    #[inline(always)]
    fn weights(&self, simd: S, Spot { x, y, .. }: Spot) -> ([f32x8<S>; 12], f32x8<S>) {
        let weights = [
            self.weight(-x, -1.0 - y),
            self.weight(1.0 - x, -1.0 - y),
            self.weight(-1.0 - x, -y),
            self.weight(-x, -y),
            self.weight(1.0 - x, -y),
            self.weight(2.0 - x, -y),
            self.weight(-1.0 - x, 1.0 - y),
            self.weight(-x, 1.0 - y),
            self.weight(1.0 - x, 1.0 - y),
            self.weight(2.0 - x, 1.0 - y),
            self.weight(-x, 2.0 - y),
            self.weight(1.0 - x, 2.0 - y),
        ];
        let [b, c, e, f, g, h, i, j, k, l, n, o] = weights;
        let total = b + c + e + f + g + h + i + j + k + l + n + o;
        (weights, f32x8::splat(simd, 1.0) / total)
    }

    #[inline(always)]
    fn weight(&self, dx: f32, dy: f32) -> f32x8<S> {
        let squared = self.xx * (dx * dx) + self.yy * (dy * dy) + self.xy * (dx * dy);
        let squared = squared.min(self.cut);
        let window = squared - self.cut;
        (squared - 1.0) * (squared - 4.0) * (window * window)
    }
}
