//! Separable interpolation, along rows and then along columns: every upscaler that is defined by weights alone.
//!
//! Weights are a function of the position t between two samples; border samples are repeated. For sRGB-encoded values,
//! linear interpolation is exact, and longer kernels use 16-bit fixed point. Linear light is filtered in floats.

mod cells;
mod exact;
#[cfg(target_arch = "x86_64")]
mod exact_avx2;
mod fixed;
#[cfg(target_arch = "x86_64")]
mod fixed_avx2;
mod light;
#[cfg(test)]
mod tests;

use cells::{fill, pixel};
use exact::ExactScalar;
use fearless_simd::Level;
use fixed::{FixedScalar, PhaseWeights};
use light::Linear;

#[cfg(target_arch = "x86_64")]
use super::lanes::pixels_to_alignment;
use super::lattice::{Anchor, Lattice, LatticePosition};
use super::{FilterSpace, Offers, Sampling, Scale, Tap, UpscaleInputs, Upscaler, Upscaling};
use crate::image::{Image, Rgba8};
use crate::pipeline::settings::Choice as _;

/// An upscaler that is defined by the weights of adjacent samples alone.
pub(crate) struct Separable {
    /// Id of the upscaler; see [`Upscaler::id`].
    pub(super) id: &'static str,
    /// Display name of the upscaler; see [`Upscaler::name`].
    pub(super) name: &'static str,
    /// Description of the upscaler; see [`Upscaler::help`].
    pub(super) help: &'static str,
    /// Artefacts of the pictures; see [`Upscaler::artefacts`].
    pub(super) artefacts: &'static str,
    /// Function that computes the weights of the surrounding samples.
    pub(super) weights: KernelWeights,
    /// Whether de-ringing is available: only for interpolating kernels, where overshoot can be distinguished from
    /// smoothing.
    pub(super) deringing: bool,
    /// Kernel as it is published: the weight of a sample as a function of its distance ≥ 0, in samples. The tests compare
    /// pictures with exact sums of it, so it must not share code with `weights`.
    #[cfg(test)]
    pub(super) published: fn(f64) -> f64,
}

/// Weights of the surrounding samples, in order, at t in [0, 1) between the inner two. The weights sum to 1.
#[derive(Clone, Copy)]
pub(super) enum KernelWeights {
    /// Linear interpolation: weights 1 − t and t of one sample on each side. It is computed exactly in sRGB codes.
    Linear,
    /// Weights of two samples on each side. A kernel with one sample on each side that is not linear interpolation sets
    /// the outer weights to 0.
    Four(fn(f64) -> [f64; 4]),
    /// Weights of three samples on each side.
    Six(fn(f64) -> [f64; 6]),
}

impl KernelWeights {
    /// Returns the weights of the surrounding samples at t in [0, 1) between the inner two.
    fn at(self, t: f64) -> Vec<f64> {
        match self {
            Self::Linear => linear(t).to_vec(),
            Self::Four(weights) => weights(t).to_vec(),
            Self::Six(weights) => weights(t).to_vec(),
        }
    }
}

/// Returns the weights of linear interpolation.
fn linear(t: f64) -> [f64; 2] {
    [1.0 - t, t]
}

/// Returns the weights at every phase of a lattice.
fn table<const N: usize>(weights: fn(f64) -> [f64; N], lattice: Lattice) -> Vec<[f64; N]> {
    let phases = lattice.phases();
    (0..phases).map(|phase| weights(f64::from(phase) / f64::from(phases))).collect()
}

/// Returns the positions of the output columns of an image between the samples.
fn columns(lattice: Lattice, width: u32) -> Vec<LatticePosition> {
    lattice.places_from(0).take(width as usize).collect()
}

/// Returns the fixed-point weights at every phase of a lattice.
fn phases<const N: usize, const H: usize>(weights: fn(f64) -> [f64; N], lattice: Lattice) -> Vec<PhaseWeights<H>> {
    table(weights, lattice).iter().map(|weights| PhaseWeights::new(weights)).collect()
}

impl Separable {
    /// Upscales samples into an image. `level` selects the instruction set, which does not affect the result.
    fn fill(&self, level: Level, how: Upscaling, drawn: &Image<Rgba8>, full: &mut Image<Rgba8>) {
        match (how.light(), self.weights) {
            (FilterSpace::Linear, KernelWeights::Linear) => fill_linear(level, linear, how, drawn, full),
            (FilterSpace::Linear, KernelWeights::Four(weights)) => fill_linear(level, weights, how, drawn, full),
            (FilterSpace::Linear, KernelWeights::Six(weights)) => fill_linear(level, weights, how, drawn, full),
            (FilterSpace::Bytes, KernelWeights::Linear) => fill_exact(level, how.lattice(), drawn, full),
            (FilterSpace::Bytes, KernelWeights::Four(weights)) => {
                let phases = phases::<4, 2>(weights, how.lattice());
                #[cfg(target_arch = "x86_64")]
                if let Some(avx2) = level.as_avx2() {
                    let pass = fixed_avx2::FixedAvx2::new(
                        avx2,
                        &phases,
                        how,
                        full.width(),
                        pixels_to_alignment(full.pixels()),
                    );
                    return fill(&pass, drawn, how.lattice(), full);
                }
                fill_fixed(&phases, how, drawn, full);
            }
            (FilterSpace::Bytes, KernelWeights::Six(weights)) => {
                let phases = phases::<6, 3>(weights, how.lattice());
                #[cfg(target_arch = "x86_64")]
                if let Some(avx2) = level.as_avx2() {
                    let pass = fixed_avx2::FixedAvx2::new(
                        avx2,
                        &phases,
                        how,
                        full.width(),
                        pixels_to_alignment(full.pixels()),
                    );
                    return fill(&pass, drawn, how.lattice(), full);
                }
                fill_fixed(&phases, how, drawn, full);
            }
        }
    }
}

fn fill_linear<const N: usize>(
    level: Level,
    weights: fn(f64) -> [f64; N],
    how: Upscaling,
    drawn: &Image<Rgba8>,
    full: &mut Image<Rgba8>,
) {
    let lattice = how.lattice();
    let pass =
        Linear::new(level, &table(weights, lattice), lattice.scale, columns(lattice, full.width()), how.deringing());
    fill(&pass, drawn, lattice, full);
}

fn fill_exact(level: Level, lattice: Lattice, drawn: &Image<Rgba8>, full: &mut Image<Rgba8>) {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = level.as_avx2().filter(|_| lattice.phases() <= exact_avx2::MAX_PHASES) {
        let pass = exact_avx2::ExactAvx2::new(avx2, lattice, full.width(), pixels_to_alignment(full.pixels()));
        return fill(&pass, drawn, lattice, full);
    }
    fill(
        &ExactScalar { steps: lattice.phases() as u16, columns: columns(lattice, full.width()) },
        drawn,
        lattice,
        full,
    );
}

fn fill_fixed<const H: usize>(
    phases: &[PhaseWeights<H>],
    how: Upscaling,
    drawn: &Image<Rgba8>,
    full: &mut Image<Rgba8>,
) {
    let columns = columns(how.lattice(), full.width());
    fill(&FixedScalar { phases, columns, deringing: how.deringing() }, drawn, how.lattice(), full);
}

/// Computes one output pixel, bit-identical to the whole-image kernel.
fn pixel_of(weights: KernelWeights, how: Upscaling, drawn: &Image<Rgba8>, (x, y): (u32, u32)) -> Rgba8 {
    let (lattice, deringing) = (how.lattice(), how.deringing());
    let columns = vec![lattice.place(x)];
    match (how.light(), weights) {
        (FilterSpace::Linear, KernelWeights::Linear) => pixel(
            &Linear::new(Level::new(), &table(linear, lattice), lattice.scale, columns, deringing),
            drawn,
            lattice,
            y,
        ),
        (FilterSpace::Linear, KernelWeights::Four(w)) => {
            pixel(&Linear::new(Level::new(), &table(w, lattice), lattice.scale, columns, deringing), drawn, lattice, y)
        }
        (FilterSpace::Linear, KernelWeights::Six(w)) => {
            pixel(&Linear::new(Level::new(), &table(w, lattice), lattice.scale, columns, deringing), drawn, lattice, y)
        }
        (FilterSpace::Bytes, KernelWeights::Linear) => {
            pixel(&ExactScalar { steps: lattice.phases() as u16, columns }, drawn, lattice, y)
        }
        (FilterSpace::Bytes, KernelWeights::Four(w)) => {
            pixel(&FixedScalar { phases: &phases::<4, 2>(w, lattice), columns, deringing }, drawn, lattice, y)
        }
        (FilterSpace::Bytes, KernelWeights::Six(w)) => {
            pixel(&FixedScalar { phases: &phases::<6, 3>(w, lattice), columns, deringing }, drawn, lattice, y)
        }
    }
}

impl Upscaler for Separable {
    fn id(&self) -> &'static str {
        self.id
    }

    fn name(&self) -> &'static str {
        self.name
    }

    fn help(&self) -> &'static str {
        self.help
    }

    fn artefacts(&self) -> &'static str {
        self.artefacts
    }

    fn offers(&self) -> Offers {
        Offers {
            scales: SCALES,
            anchors: Anchor::ALL,
            lights: FilterSpace::ALL,
            deringing: self.deringing,
            sharpening: false,
            history: false,
        }
    }

    fn alters_samples(&self) -> bool {
        /// Difference from weight 1 that is due to rounding in the weights of an interpolating kernel.
        const ROUNDING: f64 = 1e-9;
        let at_a_sample = self.weights.at(0.0);
        (at_a_sample[at_a_sample.len() / 2 - 1] - 1.0).abs() > ROUNDING
    }

    #[cfg(test)]
    fn as_separable(&self) -> Option<&dyn std::any::Any> {
        Some(self)
    }

    fn sampling(&self, how: Upscaling) -> Sampling {
        Sampling::of_lattice(how.lattice())
    }

    fn upscale(&self, how: Upscaling, drawn: &UpscaleInputs<'_>, full: &mut Image<Rgba8>) {
        self.fill(Level::new(), how, drawn.color, full);
    }

    fn pixel(&self, how: Upscaling, drawn: &UpscaleInputs<'_>, _size: (u32, u32), at: (u32, u32)) -> Rgba8 {
        pixel_of(self.weights, how, drawn.color, at)
    }

    fn taps(&self, how: Upscaling, drawn: &UpscaleInputs<'_>, _size: (u32, u32), (x, y): (u32, u32)) -> Vec<Tap> {
        let (columns, rows) = drawn.color.size();
        let across = axis_taps(self.weights, how.lattice(), x, columns);
        let down = axis_taps(self.weights, how.lattice(), y, rows);
        let grid = how.grid();
        let tap = |(row, weight_y): (u32, f64), (column, weight_x): (u32, f64)| {
            let (x, y) = grid.pixel(column, row);
            Tap { x, y, weight: (weight_x * weight_y) as f32 }
        };
        down.iter().flat_map(|down| across.iter().map(|across| tap(*down, *across))).collect()
    }
}

/// Scales that all separable upscalers offer.
pub(super) const SCALES: &[Scale] = &[
    Scale::ONE_AND_THREE_TENTHS,
    Scale::ONE_AND_A_HALF,
    Scale::ONE_AND_SEVEN_TENTHS,
    Scale::TWO,
    Scale::THREE,
    Scale::FOUR,
];

/// Returns the distinct samples that contribute to output pixel `at` along one axis, with their weights.
fn axis_taps(weights: KernelWeights, lattice: Lattice, at: u32, samples: u32) -> Vec<(u32, f64)> {
    let LatticePosition { cell, phase } = lattice.place(at);
    let weights = weights.at(f64::from(phase) / f64::from(lattice.phases()));
    if weights[weights.len() / 2 - 1] == 1.0 {
        return vec![(cell.clamp(0, samples as i32 - 1) as u32, 1.0)];
    }
    let first = cell - (weights.len() as i32 / 2 - 1);
    let mut taps: Vec<(u32, f64)> = Vec::with_capacity(weights.len());
    for (place, weight) in (first..).zip(weights) {
        let place = place.clamp(0, samples as i32 - 1) as u32;
        match taps.last_mut() {
            Some((same, sum)) if *same == place => *sum += weight,
            _ => taps.push((place, weight)),
        }
    }
    taps
}
