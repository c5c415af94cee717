//! Weights of the EWA Lanczos filter: a jinc windowed by a wider jinc.
//!
//! With jinc(x) = 2 J₁(πx) / (πx), the weight of a sample at distance x is jinc(x) · jinc(x · z₁ / z₃) for x < z₃, where z₁
//! and z₃ are the first and the third zero of jinc. It is the radial counterpart of the Lanczos filter with three lobes.
//! Jinc is a power series in x², so weights need only sums, products and quotients and are equal on every processor.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

use crate::upscale::Lattice;

/// First zero of jinc, in samples.
const FIRST_ZERO: f64 = 1.219_669_891_266_504_5;

/// Third zero of jinc, in samples: radius of the filter.
pub(super) const RADIUS: f64 = 3.238_315_484_166_236;

/// Number of terms of the power series. The last one is below 10⁻²³ at the radius.
const TERMS: u32 = 30;

/// Number of samples along each axis around an output pixel.
pub(super) const TAPS: usize = 8;

/// Number of samples before an output pixel along each axis, besides that at or before it.
pub(super) const BEFORE: i32 = 3;

/// Number of fractional bits of a weight.
pub(super) const POINT: u32 = 15;

/// Weights of the samples around an output pixel, row by row, in units of 2⁻¹⁵. They sum to exactly 1.
pub(super) type Weights = [[i16; TAPS]; TAPS];

/// Computes jinc at a distance given by its square: Σ (−q)ᵏ / (k! (k + 1)!) with q = (πx / 2)².
fn jinc(squared: f64) -> f64 {
    let q = PI * PI / 4.0 * squared;
    let (mut term, mut sum) = (1.0, 1.0);
    for k in 1..=TERMS {
        term *= -q / f64::from(k * (k + 1));
        sum += term;
    }
    sum
}

/// Computes the weight of a sample at a distance given by its square, before normalisation.
fn lanczos(squared: f64) -> f64 {
    /// Square of the ratio by which the window is wider.
    const WINDOW: f64 = FIRST_ZERO / RADIUS * (FIRST_ZERO / RADIUS);
    if squared < RADIUS * RADIUS { jinc(squared) * jinc(squared * WINDOW) } else { 0.0 }
}

/// Computes the weights around a pixel at `x` and `y` in [0, 1) between two samples along each axis.
fn weights(x: f64, y: f64) -> Weights {
    let offsets = |at: f64| std::array::from_fn::<f64, TAPS, _>(|tap| tap as f64 - f64::from(BEFORE) - at);
    let (across, down) = (offsets(x), offsets(y));
    let real = down.map(|dy| across.map(|dx| lanczos(dx * dx + dy * dy)));
    let sum: f64 = real.as_flattened().iter().sum();
    let one = f64::from(1 << POINT);
    let mut fixed = real.map(|row| row.map(|weight| (weight / sum * one).round() as i16));
    let total: i32 = fixed.as_flattened().iter().map(|weight| i32::from(*weight)).sum();
    // The rounding error goes to the largest weight, so that uniform colours are preserved.
    if let Some(largest) = fixed.as_flattened_mut().iter_mut().max() {
        *largest += ((1 << POINT) - total) as i16;
    }
    fixed
}

/// Weights of all pixels in a period of a lattice.
pub(super) struct WeightTable {
    /// Number of output pixels in a period along each axis.
    pixels: u32,
    /// Weights of the pixels of a period, row by row.
    all: Vec<Weights>,
}

impl WeightTable {
    /// Returns the table of a lattice. Tables are kept, because computing one takes up to some milliseconds.
    pub(super) fn of(lattice: Lattice) -> Arc<Self> {
        static TABLES: LazyLock<Mutex<BTreeMap<Lattice, Arc<WeightTable>>>> = LazyLock::new(Mutex::default);
        let mut tables = TABLES.lock().unwrap_or_else(PoisonError::into_inner);
        tables.entry(lattice).or_insert_with(|| Arc::new(Self::new(lattice))).clone()
    }

    fn new(lattice: Lattice) -> Self {
        let (pixels, _) = lattice.scale.ratio();
        let place = |at: u32| f64::from(lattice.place(at).phase) / f64::from(lattice.phases());
        let all = (0..pixels).flat_map(|y| (0..pixels).map(move |x| weights(place(x), place(y)))).collect();
        Self { pixels, all }
    }

    /// Returns the weights of the pixels of a period in output row `y`.
    pub(super) fn row(&self, y: u32) -> &[Weights] {
        &self.all[(y % self.pixels * self.pixels) as usize..][..self.pixels as usize]
    }

    /// Returns the weights of output pixel (x, y).
    pub(super) fn at(&self, (x, y): (u32, u32)) -> &Weights {
        &self.row(y)[(x % self.pixels) as usize]
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Computes J₁ from Bessel's integral, (1/π) ∫ cos(τ − z sin τ) dτ over [0, π]. The trapezoidal rule converges
    /// exponentially, because the integrand is periodic.
    fn bessel_j1(z: f64) -> f64 {
        const STEPS: u32 = 64;
        let value = |step: u32| {
            let angle = 2.0 * PI * f64::from(step) / f64::from(STEPS);
            (angle - z * angle.sin()).cos()
        };
        (0..STEPS).map(value).sum::<f64>() / f64::from(STEPS)
    }

    /// Computes the published kernel at distance `x`, in samples.
    pub(in super::super) fn published(x: f64) -> f64 {
        let jinc = |x: f64| if x == 0.0 { 1.0 } else { 2.0 * bessel_j1(PI * x) / (PI * x) };
        if x < 3.238_315_5 { jinc(x) * jinc(x * 1.219_669_9 / 3.238_315_5) } else { 0.0 }
    }

    #[test]
    fn the_series_agrees_with_the_integral_of_bessel() {
        for step in 0..330 {
            let x = f64::from(step) / 100.0;
            assert!((lanczos(x * x) - published(x)).abs() < 1e-7, "{x}: {}", lanczos(x * x));
        }
        // Zeros of J₁ divided by π: 3.8317, 7.0156 and 10.1735.
        for zero in [FIRST_ZERO, 2.233_130_594_3, RADIUS] {
            assert!(jinc(zero * zero).abs() < 1e-9, "{zero}");
        }
    }

    #[test]
    fn weights_sum_to_one_and_turn_with_the_position() {
        for (x, y) in [(0.0, 0.0), (0.25, 0.5), (3.0 / 26.0, 25.0 / 26.0), (0.5, 0.5)] {
            let (one, turned) = (weights(x, y), weights(y, x));
            assert_eq!(one.as_flattened().iter().map(|weight| i32::from(*weight)).sum::<i32>(), 1 << POINT);
            for (row, column) in (0..TAPS).flat_map(|row| (0..TAPS).map(move |column| (row, column))) {
                assert!(one[row][column].abs_diff(turned[column][row]) <= 2, "{x} {y}: {row} {column}");
            }
        }
    }
}
