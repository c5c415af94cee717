//! `depth`: what a depth buffer stores for view depths.

use serde::{Deserialize, Serialize};

use super::{Check, Control, Real, Refusal, Unanswered};
use crate::pipeline::depth::{DepthEncoding, DepthScale};
use crate::scene::DepthMapping;

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
        let (near, far) = (self.near.0, self.far.map_or(f64::INFINITY, |far| far.0));
        if near <= 0.0 || near >= far {
            return Err("the planes must lie at 0 < `near` < `far`".to_owned());
        }
        if self.z.iter().any(|z| z.0 <= 0.0) {
            return Err("every `z` must be positive: the rest lies behind the eye".to_owned());
        }
        Ok(())
    }
}

impl Depth {
    /// What the depth buffer stores for vertices at these distances.
    pub(super) fn answer(&self, control: &Control<'_>) -> Result<DepthAnswer, Unanswered> {
        let mapping = match self.mapping {
            Mapping::Standard => DepthMapping::Standard,
            Mapping::Reversed => DepthMapping::Reversed,
            Mapping::ReversedInf => DepthMapping::ReversedInfinite,
            Mapping::Linear => DepthMapping::Linear,
            Mapping::StandardInf => {
                let reason = "there is no depth format whose far plane is infinitely far and stored as 1";
                return Err(Refusal(reason.to_owned()).into());
            }
        };
        let encoding = match self.format {
            DepthFormat::F32 => DepthEncoding::F32,
            DepthFormat::Unorm16 => DepthEncoding::Unorm16,
            DepthFormat::Unorm24 => DepthEncoding::Unorm24,
        };
        let far = self.far.map_or(f32::INFINITY, |far| far.0 as f32);
        let scale = DepthScale::perspective(mapping, encoding, self.near.0 as f32, far);
        // Codes as exactly as their quotient can be written; the buffer holds its nearest float.
        let value = |stored: f32| match encoding.code(stored).zip(encoding.largest_code()) {
            Some((code, largest)) => f64::from(code) / f64::from(largest),
            None => stored.into(),
        };
        let depth = self.z.iter().map(|z| Some(value(scale.stored(z.0 as f32))));
        Ok(DepthAnswer { depth: control.collect("values", (0, self.z.len() as u64), depth)? })
    }
}

/// The answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DepthAnswer {
    /// Stored values in [0, 1].
    pub depth: Vec<f64>,
}
