//! A stored depth and its resolution in world units.

use std::fmt;

use serde::Serialize;

use crate::pipeline::depth::DepthScale;

/// A depth as stored in the depth buffer.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DepthRecord {
    /// Stored depth, in [0, 1].
    pub value: f32,
    /// Integer code in the depth buffer; `None` for a floating-point buffer.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub code: Option<u32>,
    /// Distance along the view axis between this depth and the next representable depth, in world units. Infinite (null
    /// in JSON) if the next depth is infinitely far away.
    pub resolution: f64,
}

impl DepthRecord {
    /// Creates the record of a depth that is stored in a depth buffer with this scale.
    pub(crate) fn new(value: f32, scale: &DepthScale) -> Self {
        Self { value, code: scale.encoding().code(value), resolution: scale.resolution(value) }
    }

    /// Returns the number of depth-buffer steps between two depths of the same scale.
    pub(crate) fn steps_from(&self, other: &Self) -> u32 {
        match self.code.zip(other.code) {
            Some((a, b)) => a.abs_diff(b),
            None => self.value.to_bits().abs_diff(other.value.to_bits()),
        }
    }
}

/// Writes the shortest decimal that identifies the stored depth, followed by the integer code if there is one.
impl fmt::Display for DepthRecord {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.code {
            Some(code) => write!(f, "{:?} (code {code})", self.value),
            None => write!(f, "{:?}", self.value),
        }
    }
}
