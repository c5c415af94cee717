//! Bilinear interpolation between the four samples around a pixel.

use super::separable::{KernelWeights, Separable};

/// Separable linear interpolation.
pub(crate) static BILINEAR: Separable = Separable {
    id: "bilinear",
    name: "Bilinear",
    help: "Interpolates linearly, along rows and then columns. Good on smooth shading: never leaves the range of its \
           neighbours, so it cannot ring. Blurs texture, and the kinks at the samples show as a lattice of faint \
           crosses. Values are rounded, and the picture is filled in up to the border.",
    artefacts: "blur",
    weights: KernelWeights::Linear,
    deringing: false,
    #[cfg(test)]
    published: |x| (1.0 - x).max(0.0),
};
