//! `clip_tri`: triangles in clip space (0 ≤ z ≤ w), which may reach behind the eye, all the way to covered samples.

use serde::{Deserialize, Serialize};

use super::{Check, Covered, Exactly, Real, check_picture};

/// The case.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct ClipTri {
    /// Width of the picture, px.
    pub width: u32,
    /// Height of the picture, px.
    pub height: u32,
    /// Corners as [x, y, z, w], of either winding.
    pub triangles: Vec<Exactly<Exactly<Real, 4>, 3>>,
}

impl Check for ClipTri {
    fn check(&self) -> Result<(), String> {
        check_picture(self.width, self.height)
    }
}

/// The answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClipTriAnswer {
    /// One for each triangle.
    pub triangles: Vec<Covered>,
    /// For each covered pixel the number of the triangle; column and row; perspective-correct weights p0, p1, p2 of the
    /// triangle's own corners; and depth.
    pub attr: Vec<(usize, u32, u32, f64, f64, f64, f64)>,
}
