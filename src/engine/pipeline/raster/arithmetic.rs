//! Kinds of arithmetic in which triangles are rasterized.

use crate::pipeline::choice::{Choice, choice};

choice! {
    /// Arithmetic in which edge functions are computed to decide coverage.
    pub Arithmetic {
        Fixed = "fixed", "24.8 fixed point",
            "Vertices are snapped to 1/256 px; from there on, everything is exact integer arithmetic, as in hardware.";
        F32 = "f32", "f32",
            "Single-precision floats on unsnapped vertices: a pixel centre close to an edge may fall on the wrong \
             side.";
        F64 = "f64", "f64",
            "Double-precision floats on unsnapped vertices: wrong only where numbers differ by many orders of \
             magnitude.";
        Exact = "exact", "Exact",
            "Unsnapped vertices, with every decision exact by adaptive predicates: the ground truth, but slower.";
    }
}
