//! `depth`: what a depth buffer stores for view depths.

use serde::{Deserialize, Serialize};

use super::{Check, Real};

/// The case.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Depth {
    /// From view depth to stored depth.
    pub mapping: Mapping,
    /// How depth is stored.
    pub format: DepthFormat,
    /// View depth of the near plane.
    pub near: Real,
    /// View depth of the far plane; `None` only where the mapping has none.
    pub far: Option<Real>,
    /// View depths, ascending.
    pub z: Vec<Real>,
}

/// From view depth z between the planes n and f to depth in [0, 1].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Mapping {
    /// f (z − n) / (z (f − n)).
    Standard,
    /// n (f − z) / (z (f − n)).
    Reversed,
    /// n / z.
    ReversedInf,
    /// 1 − n / z.
    StandardInf,
    /// (z − n) / (f − n).
    Linear,
}

/// How a depth in [0, 1] is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DepthFormat {
    /// A 32-bit float.
    F32,
    /// A 16-bit integer, as a share of the largest.
    Unorm16,
    /// A 24-bit integer, as a share of the largest.
    Unorm24,
}

impl Check for Depth {
    fn check(&self) -> Result<(), String> {
        let needs_far = matches!(self.mapping, Mapping::Standard | Mapping::Reversed | Mapping::Linear);
        if needs_far && self.far.is_none() {
            return Err("the mapping needs a `far` plane".to_owned());
        }
        Ok(())
    }
}

/// The answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DepthAnswer {
    /// Stored values in [0, 1].
    pub depth: Vec<f64>,
}
