//! `depth`: computes the values that a depth buffer stores for given view depths.

use serde::{Deserialize, Serialize};

use super::{Check, Control, Real, Refusal, Unanswered};
use crate::pipeline::depth::DepthScale;
use crate::pipeline::depth_format::DepthEncoding;
use crate::scene::DepthMapping;

/// Input of a `depth` case: view depths, and the mapping and format that encode them.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Depth {
    /// Mapping from view depth to normalised depth.
    pub(crate) mapping: Mapping,
    /// Storage format of the depth buffer.
    pub(crate) format: DepthFormat,
    /// View depth of the near plane, > 0.
    pub(crate) near: Real,
    /// View depth of the far plane. `None` is valid only for a mapping without a far plane.
    pub(crate) far: Option<Real>,
    /// View depths to encode, all > 0, in ascending order.
    pub(crate) z: Vec<Real>,
}

/// Mapping from view depth z, between the planes n (near) and f (far), to depth in [0, 1].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Mapping {
    /// Depth f (z − n) / (z (f − n)) of view depth z: 0 at the near plane n, 1 at the far plane f.
    Standard,
    /// Depth n (f − z) / (z (f − n)) of view depth z: 1 at the near plane n, 0 at the far plane f.
    Reversed,
    /// Depth n / z of view depth z: 1 at the near plane n, 0 at infinity.
    ReversedInf,
    /// Depth 1 − n / z of view depth z: 0 at the near plane n, 1 at infinity.
    StandardInf,
    /// Depth (z − n) / (f − n) of view depth z: 0 at the near plane n, 1 at the far plane f.
    Linear,
}

/// Storage format of a depth in [0, 1].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum DepthFormat {
    /// Depth stored as a 32-bit float.
    F32,
    /// Depth stored as a 16-bit normalised integer.
    Unorm16,
    /// Depth stored as a 24-bit normalised integer.
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
            return Err("the planes must satisfy 0 < `near` < `far`".to_owned());
        }
        if self.z.iter().any(|z| z.0 <= 0.0) {
            return Err("every `z` must be positive: other values lie behind the eye".to_owned());
        }
        Ok(())
    }
}

impl Depth {
    /// Returns the values that the depth buffer stores for the view depths.
    pub(super) fn answer(&self, control: &Control<'_>) -> Result<DepthAnswer, Unanswered> {
        let mapping = match self.mapping {
            Mapping::Standard => DepthMapping::STANDARD,
            Mapping::Reversed => DepthMapping::REVERSED,
            Mapping::ReversedInf => DepthMapping::REVERSED_INFINITE,
            Mapping::Linear => DepthMapping::LINEAR,
            Mapping::StandardInf => {
                let reason = "`standard_inf` is not supported: no depth format stores an infinitely far plane as 1";
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
        // Integer formats are reported as the exact quotient in f64; the buffer itself holds the nearest f32.
        let value = |stored: f32| match encoding.code(stored).zip(encoding.largest_code()) {
            Some((code, largest)) => f64::from(code) / f64::from(largest),
            None => stored.into(),
        };
        let depth = self.z.iter().map(|z| Some(value(scale.stored(z.0 as f32))));
        Ok(DepthAnswer { depth: control.collect("values", (0, self.z.len() as u64), depth)? })
    }
}

/// Answer to a [`Depth`] case: the stored depth values.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DepthAnswer {
    /// Values that the depth buffer stores, in [0, 1], one per view depth.
    pub(crate) depth: Vec<f64>,
}
