//! A stored depth and what it means in the world.

use std::fmt;

use serde::Serialize;

use crate::pipeline::depth::DepthScale;

/// A depth as the buffer stores it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DepthRecord {
    /// The depth, in [0, 1].
    pub value: f32,
    /// The whole number that the buffer holds for it, where it does not hold floats.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub code: Option<u32>,
    /// Distance along the line of sight between this depth and the next that can be stored, world units. Infinite, in JSON
    /// null, where the next one is infinitely far.
    pub resolution: f64,
}

impl DepthRecord {
    /// For a value that a buffer of this scale stores.
    pub fn new(value: f32, scale: &DepthScale) -> Self {
        Self { value, code: scale.encoding().code(value), resolution: scale.resolution(value) }
    }

    /// How many of the buffer's steps lie between two depths of one scale.
    pub fn steps_from(&self, other: &Self) -> u32 {
        match self.code.zip(other.code) {
            Some((a, b)) => a.abs_diff(b),
            None => self.value.to_bits().abs_diff(other.value.to_bits()),
        }
    }
}

/// The value with every digit that tells it apart, and the code if there is one.
impl fmt::Display for DepthRecord {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.code {
            Some(code) => write!(f, "{:?} (code {code})", self.value),
            None => write!(f, "{:?}", self.value),
        }
    }
}
