//! Lanczos filter, a windowed sinc: sinc(x) · sinc(x / a) for |x| < a.
//!
//! The weights as published do not sum to 1 (for a = 2, their sum is 1.019 halfway between samples), which would show
//! as a lattice on uniform colours. They are therefore divided by their sum.

use std::array;
use std::f64::consts::PI;

use super::separable::{KernelWeights, Separable};

/// Lanczos filter with a = 2 (four taps).
pub(crate) static LANCZOS2: Separable = Separable {
    id: "lanczos2",
    name: "Lanczos 2",
    help: "A sinc windowed by a wider sinc that ends after two samples, along rows and then columns. Good on fine \
           detail. Overshoots at hard edges by up to 9 % of their height. Source: Duchon, Lanczos Filtering in One and \
           Two Dimensions (1979); weights divided by their sum.",
    artefacts: "overshoot at hard edges",
    weights: KernelWeights::Four(lanczos),
    deringing: true,
    #[cfg(test)]
    published: |x| tests::windowed_sinc(x, 2.0),
};

/// Lanczos filter with a = 3 (six taps).
pub(crate) static LANCZOS3: Separable = Separable {
    id: "lanczos3",
    name: "Lanczos 3",
    help: "A sinc windowed by a wider sinc that ends after three samples, along rows and then columns. Good on natural \
           images that were low-pass filtered. Rings: up to 12 % of an edge's height beside it, with a second wave. \
           Source: Duchon, Lanczos Filtering in One and Two Dimensions (1979); weights divided by their sum.",
    artefacts: "ringing at hard edges",
    weights: KernelWeights::Six(lanczos),
    deringing: true,
    #[cfg(test)]
    published: |x| tests::windowed_sinc(x, 3.0),
};

fn lanczos<const N: usize>(t: f64) -> [f64; N] {
    let lobes = N as f64 / 2.0;
    let weights: [f64; N] = array::from_fn(|tap| {
        let x = t + lobes - 1.0 - tap as f64;
        if x.abs() < lobes { sinc(x) * sinc(x / lobes) } else { 0.0 }
    });
    let sum: f64 = weights.iter().sum();
    weights.map(|weight| weight / sum)
}

/// Computes sin(πx) / (πx), exactly 0 at all integers except 0.
fn sinc(x: f64) -> f64 {
    if x == 0.0 {
        1.0
    } else if x.fract() == 0.0 {
        0.0
    } else {
        (PI * x).sin() / (PI * x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sinc windowed by a sinc of `lobes` times its width (Duchon 1979).
    pub(super) fn windowed_sinc(x: f64, lobes: f64) -> f64 {
        let sinc =
            |x: f64| if x.abs() < 1e-9 { 1.0 } else { (std::f64::consts::PI * x).sin() / (std::f64::consts::PI * x) };
        if x < lobes { sinc(x) * sinc(x / lobes) } else { 0.0 }
    }

    #[test]
    fn weights_sum_to_one_and_a_sample_keeps_its_value() {
        assert_eq!(lanczos::<4>(0.0), [0.0, 1.0, 0.0, 0.0]);
        assert_eq!(lanczos::<6>(0.0), [0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
        for t in [0.125, 0.25, 0.5, 0.875] {
            assert!((lanczos::<4>(t).iter().sum::<f64>() - 1.0).abs() < 1e-15);
            assert!((lanczos::<6>(t).iter().sum::<f64>() - 1.0).abs() < 1e-15);
        }
        // Halfway with a = 2: sinc(½) sinc(¼) = 0.5732, sinc(1½) sinc(¾) = −0.0637; twice their sum is 1.0190.
        let halfway = lanczos::<4>(0.5);
        assert!((halfway[1] - 0.5732 / 1.0190).abs() < 1e-4 && (halfway[0] + 0.0637 / 1.0190).abs() < 1e-4);
    }
}
