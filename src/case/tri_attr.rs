//! `tri_attr`: weights and attributes at the centres of some pixels, inside the triangle or not.

use serde::{Deserialize, Serialize, Serializer};

use super::{Check, Exactly, Real};

/// The case.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct TriAttr {
    /// The triangle's corners.
    pub vertices: Exactly<Vertex, 3>,
    /// Columns and rows of the pixels.
    pub eval: Vec<Exactly<i64, 2>>,
}

/// A corner of a triangle on the screen.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub struct Vertex {
    /// px.
    pub x: Real,
    /// px, down.
    pub y: Real,
    /// Depth, after the division by w.
    pub z: Real,
    /// w of clip space.
    pub w: Real,
    /// Texture coordinate.
    pub u: Real,
    /// Texture coordinate.
    pub v: Real,
}

impl Check for TriAttr {}

/// The answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TriAttrAnswer {
    /// One for each pixel asked for, in any order.
    pub pixels: Vec<SampleAttributes>,
}

/// What holds at the centre of a pixel. Written as one list of all numbers, in this order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleAttributes {
    /// Column and row.
    pub pixel: [i64; 2],
    /// Weights of the corners, affine in the screen.
    pub affine_weights: [f64; 3],
    /// Weights of the corners in perspective.
    pub perspective_weights: [f64; 3],
    /// z by the affine weights.
    pub depth: f64,
    /// u and v in perspective.
    pub uv: [f64; 2],
}

impl Serialize for SampleAttributes {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self { pixel: [x, y], affine_weights: [b0, b1, b2], perspective_weights: [p0, p1, p2], depth, uv: [u, v] } =
            self;
        (x, y, b0, b1, b2, p0, p1, p2, depth, u, v).serialize(serializer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sample_is_written_as_one_list() {
        let sample = SampleAttributes {
            pixel: [-1, 2],
            affine_weights: [0.5, 0.25, 0.25],
            perspective_weights: [1.0, 0.0, 0.0],
            depth: 0.75,
            uv: [3.5, -4.5],
        };
        assert_eq!(serde_json::to_string(&sample).unwrap(), "[-1,2,0.5,0.25,0.25,1.0,0.0,0.0,0.75,3.5,-4.5]");
    }
}
