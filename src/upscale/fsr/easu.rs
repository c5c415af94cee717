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
//! Channels are codes / 255. Slopes belong to samples, so they are found once for each. Alpha is weighed like a colour.

use rayon::prelude::*;

use crate::image::{Image, Rgba8};
use crate::math::lanes::*;
use crate::upscale::lattice::{Lattice, Place};

/// Samples that are repeated around the picture: as far as the kernel reaches, and one more for slopes.
const MARGIN: usize = 3;

/// Samples across that a run of [`LANES`] pixels of one phase looks at.
const RUN: usize = LANES + 3;

/// Below this a slope has no direction: (1/181)², less than a code over the width of the kernel.
const LEAST_SLOPE: f32 = 1.0 / 32768.0;

/// What a clear edge takes off the lobe.
const LOBE_OF_EDGE: f32 = 0.25 - 0.04 - 0.5;

/// Places of the twelve samples relative to f, columns and rows.
const PLACES: [(i32, i32); 12] =
    [(0, -1), (1, -1), (-1, 0), (0, 0), (1, 0), (2, 0), (-1, 1), (0, 1), (1, 1), (2, 1), (0, 2), (1, 2)];

/// The four nearest, as places in [`PLACES`].
const NEAREST: [usize; 4] = [3, 4, 7, 8];

/// What is known about a sample: four channels, slope across and down, straightness.
const PLANES: usize = 7;

/// Samples, channel by channel, with a margin, and the slopes there.
pub(super) struct Source {
    stride: usize,
    planes: [Vec<f32>; PLANES],
}

impl Source {
    /// From samples, at least one.
    pub(super) fn new(drawn: &Image<Rgba8>) -> Self {
        let (width, height) = (drawn.width() as usize, drawn.height() as usize);
        let (stride, rows) = (width + 2 * MARGIN + 2 * LANES, height + 2 * MARGIN + 1);
        let mut source = Self { stride, planes: std::array::from_fn(|_| vec![0.0; stride * rows]) };
        for row in 0..rows {
            for column in 0..stride {
                let code = drawn.at_clamped(column as i64 - MARGIN as i64, row as i64 - MARGIN as i64);
                for (plane, code) in source.planes.iter_mut().zip(code) {
                    plane[row * stride + column] = f32::from(code) / 255.0;
                }
            }
        }
        source.find_slopes(rows);
        source
    }

    fn find_slopes(&mut self, rows: usize) {
        let stride = self.stride;
        let [red, green, blue, _, across, down, straightness] = &mut self.planes;
        let luma: Vec<f32> =
            red.iter().zip(blue.iter()).zip(green.iter()).map(|((r, b), g)| 0.5 * (r + b) + g).collect();
        for row in 1..rows - 1 {
            for at in row * stride + 1..(row + 1) * stride - 1 {
                let (dx, along_x) = slope(luma[at - 1], luma[at], luma[at + 1]);
                let (dy, along_y) = slope(luma[at - stride], luma[at], luma[at + stride]);
                (across[at], down[at], straightness[at]) = (dx, dy, along_x + along_y);
            }
        }
    }

    /// Four rows of a plane, `before` rows before the cells' own and on, from the sample before a group of cells on.
    #[inline(always)]
    fn rows(&self, plane: usize, column: i32, row: i32, before: i32) -> Rows<'_> {
        let [column, row] = [column - 1, row - before].map(|at| (at + MARGIN as i32) as usize);
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

/// The kernel at a pixel, turned along the edge and scaled along both of its axes: distances along and across the edge are
/// sums of multiples of the distances in x and y.
#[derive(Clone, Copy)]
struct Shape {
    along: (f32, f32),
    across: (f32, f32),
    lobe: f32,
    cut: f32,
}

impl Shape {
    /// From the mixed slopes and straightness.
    fn new(across: f32, down: f32, straightness: f32) -> Self {
        let squared = across * across + down * down;
        let (x, y) = if squared < LEAST_SLOPE {
            (1.0, 0.0)
        } else {
            let length = squared.sqrt();
            (across / length, down / length)
        };
        let half = straightness * 0.5;
        let edge = half * half;
        let stretch = (x * x + y * y) / x.abs().max(y.abs());
        let (scale_along, scale_across) = ((stretch - 1.0) * edge + 1.0, 1.0 - edge * 0.5);
        // A lobe of ½ is a plain blob; near ¼ the kernel resembles Lanczos with two lobes.
        let lobe = edge * LOBE_OF_EDGE + 0.5;
        Self {
            along: (x * scale_along, y * scale_along),
            across: (x * scale_across, y * scale_across),
            lobe,
            cut: 1.0 / lobe,
        }
    }

    /// Weight of a sample at a distance from the pixel.
    fn weight(&self, dx: f32, dy: f32) -> f32 {
        let along = self.along.0 * dx + self.along.1 * dy;
        let across = self.across.0 * dy - self.across.1 * dx;
        let squared = (along * along + across * across).min(self.cut);
        let base = squared * 0.4 - 1.0;
        let window = self.lobe * squared - 1.0;
        (base * base * (25.0 / 16.0) - 9.0 / 16.0) * (window * window)
    }
}

/// One channel of a pixel from weights and the twelve samples, within the range of the four nearest, as a code.
#[inline(always)]
fn code(weights: &[f32; 12], total: f32, samples: &[f32; 12]) -> f32 {
    let mut sum = weights[0] * samples[0];
    for (weight, sample) in weights.iter().zip(samples).skip(1) {
        sum += weight * sample;
    }
    let [f, g, j, k] = NEAREST.map(|place| samples[place]);
    let (least, greatest) = (f.min(g).min(j.min(k)), f.max(g).max(j.max(k)));
    255.0 * (sum / total).max(least).min(greatest)
}

/// Weights of the twelve samples, and their sum.
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
    (weights, total)
}

/// Weights at one pixel, by the cell that it lies in.
fn weights_at(drawn: &Image<Rgba8>, lattice: Lattice, (x, y): (u32, u32)) -> (Place, Place, [f32; 12], f32) {
    let (column, row) = (lattice.place(x), lattice.place(y));
    let luma = |x: i32, y: i32| {
        let [r, g, b, _] = drawn.at_clamped(x.into(), y.into()).map(|code| f32::from(code) / 255.0);
        0.5 * (r + b) + g
    };
    let mut slopes = [[0.0; 4]; 3];
    for (index, place) in NEAREST.into_iter().enumerate() {
        let (x, y) = (column.cell + PLACES[place].0, row.cell + PLACES[place].1);
        let (dx, along_x) = slope(luma(x - 1, y), luma(x, y), luma(x + 1, y));
        let (dy, along_y) = slope(luma(x, y - 1), luma(x, y), luma(x, y + 1));
        (slopes[0][index], slopes[1][index], slopes[2][index]) = (dx, dy, along_x + along_y);
    }
    let (weights, total) = weights(Spot::new(lattice, column.phase, row.phase), slopes);
    (column, row, weights, total)
}

/// One pixel, by the arithmetic that fills the whole picture.
pub(super) fn pixel(drawn: &Image<Rgba8>, lattice: Lattice, at: (u32, u32)) -> Rgba8 {
    let (column, row, weights, total) = weights_at(drawn, lattice, at);
    let samples = PLACES.map(|(x, y)| drawn.at_clamped((column.cell + x).into(), (row.cell + y).into()));
    std::array::from_fn(|channel| {
        (code(&weights, total, &samples.map(|sample| f32::from(sample[channel]) / 255.0)) + 0.5) as u8
    })
}

/// The samples of one pixel, each once: row, column and weight.
pub(super) fn taps(drawn: &Image<Rgba8>, lattice: Lattice, at: (u32, u32)) -> Vec<(u32, u32, f32)> {
    let (column, row, weights, total) = weights_at(drawn, lattice, at);
    let inside = |at: i32, length: u32| at.clamp(0, length as i32 - 1) as u32;
    let mut taps: Vec<(u32, u32, f32)> = Vec::with_capacity(PLACES.len());
    for ((x, y), weight) in PLACES.into_iter().zip(weights) {
        let (x, y) = (inside(column.cell + x, drawn.width()), inside(row.cell + y, drawn.height()));
        match taps.iter_mut().find(|tap| (tap.0, tap.1) == (y, x)) {
            Some(tap) => tap.2 += weight / total,
            None => taps.push((y, x, weight / total)),
        }
    }
    taps
}

/// Fills a picture of at least one pixel.
pub(super) fn fill(lanes: Lanes, source: &Source, lattice: Lattice, full: &mut Image<Rgba8>) {
    let width = full.width() as usize;
    full.pixels_mut().par_chunks_mut(width).enumerate().for_each(|(y, row)| {
        let phases = Phases { lattice, row: lattice.place(y as u32) };
        on_lanes!(lanes, simd => fill_lanes(simd, source, phases, row));
    });
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
            for color in codes.iter().step_by(samples) {
                if let Some(pixel) = row.get_mut(at) {
                    *pixel = color.to_le_bytes();
                }
                at += pixels;
            }
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
    let (weights, total) = shape.weights(spot);
    let mut codes = u32x8::splat(simd, 0);
    codes |= channel(simd, &weights, total, source.rows(0, column, row, 1));
    codes |= channel(simd, &weights, total, source.rows(1, column, row, 1)) << 8;
    codes |= channel(simd, &weights, total, source.rows(2, column, row, 1)) << 16;
    codes | channel(simd, &weights, total, source.rows(3, column, row, 1)) << 24
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
fn channel<S: Simd>(simd: S, weights: &[f32x8<S>; 12], total: f32x8<S>, rows: Rows<'_>) -> u32x8<S> {
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
    u32x8::truncate_from((sum / total).max(least).min(greatest) * 255.0 + 0.5)
}

/// [`Shape`] in lanes.
struct Shape8<S: Simd> {
    along: (f32x8<S>, f32x8<S>),
    across: (f32x8<S>, f32x8<S>),
    lobe: f32x8<S>,
    cut: f32x8<S>,
}

impl<S: Simd> Shape8<S> {
    #[inline(always)]
    fn new(simd: S, across: f32x8<S>, down: f32x8<S>, straightness: f32x8<S>) -> Self {
        let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
        let squared = across * across + down * down;
        let flat = squared.simd_lt(f32x8::splat(simd, LEAST_SLOPE));
        let length = squared.sqrt();
        let (x, y) = (flat.select(one, across / length), flat.select(zero, down / length));
        let half = straightness * 0.5;
        let edge = half * half;
        let stretch = (x * x + y * y) / x.abs().max(y.abs());
        let (scale_along, scale_across) = ((stretch - 1.0) * edge + 1.0, one - edge * 0.5);
        let lobe = edge * LOBE_OF_EDGE + 0.5;
        Self {
            along: (x * scale_along, y * scale_along),
            across: (x * scale_across, y * scale_across),
            lobe,
            cut: one / lobe,
        }
    }

    /// Weights of the twelve samples, and their sum.
    #[inline(always)]
    fn weights(&self, Spot { x, y, .. }: Spot) -> ([f32x8<S>; 12], f32x8<S>) {
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
        (weights, b + c + e + f + g + h + i + j + k + l + n + o)
    }

    #[inline(always)]
    fn weight(&self, dx: f32, dy: f32) -> f32x8<S> {
        let along = self.along.0 * dx + self.along.1 * dy;
        let across = self.across.0 * dy - self.across.1 * dx;
        let squared = (along * along + across * across).min(self.cut);
        let base = squared * 0.4 - 1.0;
        let window = self.lobe * squared - 1.0;
        (base * base * (25.0 / 16.0) - 9.0 / 16.0) * (window * window)
    }
}
