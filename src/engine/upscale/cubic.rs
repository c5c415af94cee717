//! Two-parameter cubic filters of Mitchell and Netravali, "Reconstruction Filters in Computer Graphics" (1988).
//!
//! B blurs and C sharpens. The Catmull-Rom spline, (0, ½), interpolates the samples with a continuous slope and
//! reproduces quadratics. Mitchell and Netravali's own choice, (⅓, ⅓), trades some blur for less ringing and reproduces
//! linear ramps.

use super::separable::{KernelWeights, Separable};

/// Catmull-Rom spline (B = 0, C = ½).
pub(crate) static CATMULL_ROM: Separable = Separable {
    id: "catmull-rom",
    name: "Catmull-Rom",
    help: "A spline through the samples with a continuous slope, along rows and then columns; Pillow calls it bicubic. \
           Good on natural images: without the kinks of the Lagrange cubic of Bicubic. Overshoots at hard edges by up \
           to 7.5 % of their height. Source: Catmull and Rom (1974), in the form of Mitchell and Netravali (1988), B = \
           0, C = ½.",
    artefacts: "overshoot at hard edges",
    weights: KernelWeights::Four(|t| weights(t, 0.0, 0.5)),
    deringing: true,
    #[cfg(test)]
    published: |x| tests::keys(x, -0.5),
};

/// Mitchell-Netravali filter (B = C = ⅓), the compromise that viewers preferred in the authors' study.
pub(crate) static MITCHELL: Separable = Separable {
    id: "mitchell",
    name: "Mitchell",
    help: "A cubic that balances blur, ringing and stair-stepping. Good where hard edges meet smooth shading: \
           overshoots by up to 4 % of an edge's height. It does not pass through the samples, so the picture becomes \
           slightly softer, including the drawn pixels. Source: Mitchell and Netravali, Reconstruction Filters in \
           Computer Graphics (1988), B = C = ⅓.",
    artefacts: "slight blur, slight overshoot at hard edges",
    weights: KernelWeights::Four(|t| weights(t, 1.0 / 3.0, 1.0 / 3.0)),
    deringing: false,
    #[cfg(test)]
    published: tests::mitchell,
};

fn weights(t: f64, b: f64, c: f64) -> [f64; 4] {
    [1.0 + t, t, 1.0 - t, 2.0 - t].map(|distance| cubic(distance, b, c))
}

/// Evaluates the cubic at distance `x` ≥ 0, in samples.
fn cubic(x: f64, b: f64, c: f64) -> f64 {
    let sixfold = if x < 1.0 {
        ((12.0 - 9.0 * b - 6.0 * c) * x + (-18.0 + 12.0 * b + 6.0 * c)) * x * x + (6.0 - 2.0 * b)
    } else if x < 2.0 {
        (((-b - 6.0 * c) * x + (6.0 * b + 30.0 * c)) * x + (-12.0 * b - 48.0 * c)) * x + (8.0 * b + 24.0 * c)
    } else {
        0.0
    };
    sixfold / 6.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cubic convolution of Keys (1981); Catmull-Rom for a = −½.
    pub(super) fn keys(x: f64, a: f64) -> f64 {
        match x {
            _ if x <= 1.0 => (a + 2.0) * x.powi(3) - (a + 3.0) * x * x + 1.0,
            _ if x < 2.0 => a * (x.powi(3) - 5.0 * x * x + 8.0 * x - 4.0),
            _ => 0.0,
        }
    }

    /// Mitchell and Netravali's cubic with B = C = ⅓, in eighteenths as published.
    pub(super) fn mitchell(x: f64) -> f64 {
        match x {
            _ if x < 1.0 => (21.0 * x.powi(3) - 36.0 * x * x + 16.0) / 18.0,
            _ if x < 2.0 => (-7.0 * x.powi(3) + 36.0 * x * x - 60.0 * x + 32.0) / 18.0,
            _ => 0.0,
        }
    }

    #[test]
    fn at_a_quarter_the_weights_are_those_of_the_printed_polynomials() {
        let t: f64 = 0.25;
        let catmull_rom = [
            (-t + 2.0 * t * t - t.powi(3)) / 2.0,
            (2.0 - 5.0 * t * t + 3.0 * t.powi(3)) / 2.0,
            (t + 4.0 * t * t - 3.0 * t.powi(3)) / 2.0,
            (-t * t + t.powi(3)) / 2.0,
        ];
        for (own, printed) in weights(t, 0.0, 0.5).into_iter().zip(catmull_rom) {
            assert!((own - printed).abs() < 1e-15, "{own} is not {printed}");
        }
        // Mitchell weights at a sample: 1/18, 8/9, 1/18.
        let mitchell = weights(0.0, 1.0 / 3.0, 1.0 / 3.0);
        for (own, printed) in mitchell.into_iter().zip([1.0 / 18.0, 8.0 / 9.0, 1.0 / 18.0, 0.0]) {
            assert!((own - printed).abs() < 1e-15, "{own} is not {printed}");
        }
    }
}
