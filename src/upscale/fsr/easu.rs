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

use fearless_simd::Level;
#[cfg(target_arch = "x86_64")]
use fearless_simd::kernel;
use rayon::prelude::*;

use crate::image::{Image, Rgba8};
use crate::upscale::lattice::{Lattice, Place};

/// Samples that are repeated around the picture: as far as the kernel reaches, and one more for slopes.
const MARGIN: usize = 3;

/// Pixels that are made at a time: as many as there are lanes.
const LANES: usize = 8;

/// Samples across that a run of [`LANES`] pixels of one phase looks at.
const RUN: usize = LANES + 3;

/// Below this a slope has no direction: (1/181)², less than a code over the width of the kernel.
const LEAST_SLOPE: f32 = 1.0 / 32768.0;

/// Places of the twelve samples relative to f, columns and rows.
const PLACES: [(i32, i32); 12] =
    [(0, -1), (1, -1), (-1, 0), (0, 0), (1, 0), (2, 0), (-1, 1), (0, 1), (1, 1), (2, 1), (0, 2), (1, 2)];

/// The four nearest, as places in [`PLACES`].
const NEAREST: [usize; 4] = [3, 4, 7, 8];

/// What is known about a sample: four channels, slope across and down, straightness.
const PLANES: usize = 7;

/// Samples, channel by channel, with a margin, and the slopes there.
pub(super) struct Source {
    width: usize,
    stride: usize,
    planes: [Vec<f32>; PLANES],
}

impl Source {
    /// From samples, at least one.
    pub(super) fn new(drawn: &Image<Rgba8>) -> Self {
        let (width, height) = (drawn.width() as usize, drawn.height() as usize);
        let (stride, rows) = (width + 2 * MARGIN + LANES, height + 2 * MARGIN);
        let mut source = Self { width, stride, planes: std::array::from_fn(|_| vec![0.0; stride * rows]) };
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

    /// `N` values of a plane from the sample in this column and row on.
    fn run<const N: usize>(&self, plane: usize, column: i32, row: i32) -> &[f32] {
        let [column, row] = [column, row].map(|at| (at + MARGIN as i32) as usize);
        &self.planes[plane][row * self.stride + column..][..N]
    }
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

/// The kernel at a pixel: turned by `direction`, scaled along both of its axes.
#[derive(Clone, Copy)]
struct Shape {
    direction: (f32, f32),
    scale: (f32, f32),
    lobe: f32,
}

impl Shape {
    /// From the mixed slopes and straightness.
    #[inline(always)]
    fn new(across: f32, down: f32, straightness: f32) -> Self {
        let squared = across * across + down * down;
        let flat = squared < LEAST_SLOPE;
        let length = if flat { 1.0 } else { squared.sqrt() };
        let x = if flat { 1.0 } else { across / length };
        let y = if flat { 0.0 } else { down / length };
        let edge = (0.5 * straightness) * (0.5 * straightness);
        let stretch = (x * x + y * y) / x.abs().max(y.abs());
        Self {
            direction: (x, y),
            scale: (1.0 + (stretch - 1.0) * edge, 1.0 - 0.5 * edge),
            // A lobe of ½ is a plain blob; near ¼ the kernel resembles Lanczos with two lobes.
            lobe: 0.5 + (0.25 - 0.04 - 0.5) * edge,
        }
    }

    /// Weight of a sample at a distance from the pixel.
    #[inline(always)]
    fn weight(&self, dx: f32, dy: f32) -> f32 {
        let along = (dx * self.direction.0 + dy * self.direction.1) * self.scale.0;
        let across = (dy * self.direction.0 - dx * self.direction.1) * self.scale.1;
        let squared = (along * along + across * across).min(1.0 / self.lobe);
        let base = 0.4 * squared - 1.0;
        let window = self.lobe * squared - 1.0;
        (25.0 / 16.0 * (base * base) - 9.0 / 16.0) * (window * window)
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
pub(super) fn fill(level: Level, source: &Source, lattice: Lattice, full: &mut Image<Rgba8>) {
    let width = full.width() as usize;
    let (pixels, samples) = lattice.scale.ratio();
    let (pixels, samples) = (pixels as usize, samples as usize);
    let columns: Vec<Place> = (0..pixels.min(width)).map(|at| lattice.place(at as u32)).collect();
    full.pixels_mut().par_chunks_mut(width).enumerate().for_each(|(y, row)| {
        let place = lattice.place(y as u32);
        for (first, column) in columns.iter().enumerate() {
            let spot = Spot::new(lattice, column.phase, place.phase);
            let mut cell = column.cell;
            let mut at = first;
            while at < width && cell < source.width as i32 {
                let mut codes = [[0; 4]; LANES];
                lanes(level, source, (cell, place.cell), spot, &mut codes);
                for color in codes.iter().step_by(samples) {
                    if let Some(pixel) = row.get_mut(at) {
                        *pixel = *color;
                    }
                    at += pixels;
                }
                cell += LANES as i32;
            }
        }
    });
}

/// Pixels of one phase in neighbouring cells, from `cell` on.
fn lanes(level: Level, source: &Source, cell: (i32, i32), spot: Spot, codes: &mut [Rgba8; LANES]) {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = level.as_avx2() {
        return lanes_avx2(avx2, source, cell, spot, codes);
    }
    lanes_plain(source, cell, spot, codes);
}

#[cfg(target_arch = "x86_64")]
kernel! {
    /// [`lanes_plain`], compiled for eight lanes.
    fn lanes_avx2(avx2: Avx2, source: &Source, cell: (i32, i32), spot: Spot, codes: &mut [Rgba8; LANES]) {
        let _ = avx2;
        lanes_plain(source, cell, spot, codes);
    }
}

/// Lane by lane in loops of fixed length, which a compiler turns into lanes.
#[inline(always)]
fn lanes_plain(source: &Source, (column, row): (i32, i32), spot: Spot, codes: &mut [Rgba8; LANES]) {
    let mut slopes = [[[0.0_f32; RUN]; 2]; 3];
    for (plane, of) in slopes.iter_mut().enumerate() {
        for (below, run) in of.iter_mut().enumerate() {
            run.copy_from_slice(source.run::<RUN>(4 + plane, column - 1, row + below as i32));
        }
    }
    let mut all_weights = [[0.0_f32; LANES]; 12];
    let mut totals = [0.0_f32; LANES];
    for lane in 0..LANES {
        let at = |of: &[[f32; RUN]; 2]| [of[0][lane + 1], of[0][lane + 2], of[1][lane + 1], of[1][lane + 2]];
        let (weights, total) = weights(spot, [at(&slopes[0]), at(&slopes[1]), at(&slopes[2])]);
        for (all, weight) in all_weights.iter_mut().zip(weights) {
            all[lane] = weight;
        }
        totals[lane] = total;
    }
    for channel in 0..4 {
        let mut runs = [[0.0_f32; RUN]; 4];
        for (index, run) in runs.iter_mut().enumerate() {
            run.copy_from_slice(source.run::<RUN>(channel, column - 1, row + index as i32 - 1));
        }
        let mut values = [0.0_f32; LANES];
        for (lane, value) in values.iter_mut().enumerate() {
            let mut samples = [0.0; 12];
            let mut weights = [0.0; 12];
            for (index, (x, y)) in PLACES.into_iter().enumerate() {
                samples[index] = runs[(y + 1) as usize][lane + (x + 1) as usize];
                weights[index] = all_weights[index][lane];
            }
            *value = code(&weights, totals[lane], &samples) + 0.5;
        }
        for (code, value) in codes.iter_mut().zip(values) {
            code[channel] = value as u8;
        }
    }
}
