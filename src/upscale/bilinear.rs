//! Straight lines between samples: 1 − t and t.

use super::separable::{Separable, Weights};

/// Straight lines between samples.
pub static BILINEAR: Separable = Separable {
    id: "bilinear",
    name: "Bilinear",
    help: "Joins samples by straight lines, along rows and then columns. Good on smooth shading: never leaves the range of \
           its neighbours, so it cannot ring. Blurs texture, and bends at every sample show as a lattice of faint \
           crosses. Rounded, and filled in up to the border.",
    weights: Weights::Two(weights),
    deringing: false,
};

fn weights(t: f64) -> [f64; 2] {
    [1.0 - t, t]
}
