//! Rasterization: which samples lie inside a triangle, decided in exact integers.
//!
//! A rasterizer knows nothing of depth or colour. It takes [`EdgeFunctions`], walks the samples that may be inside, and
//! hands each covered [`Sample`] to a sink.

mod bounding_box;

mod edge;

pub use bounding_box::rasterize;
pub use edge::{EdgeFunctions, doubled_area};

/// A covered sample: where it is, and the three edge values there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample {
    /// Column in the packed picture.
    pub column: u32,
    /// Row in the packed picture.
    pub row: u32,
    /// Edge values in units of 1/2¹⁶ px², each belonging to the vertex opposite; they sum to the doubled area.
    pub edges: [i64; 3],
}

/// A rectangle of full-picture pixels, half open. Nothing outside of it is visited.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scissor {
    /// First column.
    pub left: u32,
    /// First row.
    pub top: u32,
    /// One past the last column.
    pub right: u32,
    /// One past the last row.
    pub bottom: u32,
}

impl Scissor {
    /// A whole picture.
    pub fn full(width: u32, height: u32) -> Self {
        Self { left: 0, top: 0, right: width, bottom: height }
    }

    /// One pixel.
    pub fn pixel(x: u32, y: u32) -> Self {
        Self { left: x, top: y, right: x + 1, bottom: y + 1 }
    }
}
