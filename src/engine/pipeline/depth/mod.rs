//! Depth: from the distance of a vertex to the stored depth of a fragment, and the depth test.
//!
//! ```text
//! vertex ── DepthScale ──► depth in f64 ── DepthFunction ──► depth of a sample ── DepthEncoding ──► stored value
//! ```
//!
//! A [depth bias](bias) is added to all depths of a triangle. A depth is quantised before the depth test, so that the
//! test sees exactly what the buffer will hold.

mod bias;

mod function;

mod scale;

pub(crate) use bias::TriangleBias;
pub(crate) use function::DepthFunction;
pub(crate) use scale::DepthLaw;
pub use scale::DepthScale;
pub(crate) use scale::DepthSource;

use super::settings::{DepthTest, Settings};

/// Comparison function of the depth test, which compares the depth of a fragment (new) with the stored depth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum DepthComparison {
    /// Always passes.
    Always,
    /// Passes if new < stored.
    Less,
    /// Passes if new ≤ stored.
    LessEqual,
    /// Passes if new > stored.
    Greater,
    /// Passes if new ≥ stored.
    GreaterEqual,
}

impl DepthComparison {
    /// Returns the comparison function for the settings' depth test, mirrored if depth is reversed.
    pub(crate) fn of(settings: &Settings) -> Self {
        match (settings.depth_test, settings.reversed()) {
            (DepthTest::Off | DepthTest::Always, _) => Self::Always,
            (DepthTest::Less, false) | (DepthTest::Greater, true) => Self::Less,
            (DepthTest::Less, true) | (DepthTest::Greater, false) => Self::Greater,
            (DepthTest::LessEqual, false) => Self::LessEqual,
            (DepthTest::LessEqual, true) => Self::GreaterEqual,
        }
    }

    /// Returns whether a fragment of depth `new` passes the depth test against `stored`.
    #[inline]
    pub(crate) fn passes(self, new: f32, stored: f32) -> bool {
        match self {
            Self::Always => true,
            Self::Less => new < stored,
            Self::LessEqual => new <= stored,
            Self::Greater => new > stored,
            Self::GreaterEqual => new >= stored,
        }
    }

    /// Returns the comparison operator to display between the new and the stored depth of a fragment that passed.
    pub(crate) fn symbol(self) -> &'static str {
        match self {
            Self::Always => "always",
            Self::Less => "<",
            Self::LessEqual => "≤",
            Self::Greater => ">",
            Self::GreaterEqual => "≥",
        }
    }
}

/// Returns the clear value of the depth buffer. Every depth strictly between 0 and 1 passes the depth test against this
/// value.
pub(crate) fn clear_value(settings: &Settings) -> f32 {
    match DepthComparison::of(settings) {
        DepthComparison::Greater | DepthComparison::GreaterEqual => 0.0,
        DepthComparison::Less | DepthComparison::LessEqual => 1.0,
        DepthComparison::Always => f32::from(u8::from(!settings.reversed())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::settings::{Choice as _, DepthFormat};

    #[test]
    fn the_clear_value_loses_against_every_depth_inside() {
        for test in DepthTest::ALL {
            for format in DepthFormat::ALL {
                let settings = Settings { depth_test: *test, depth_format: *format, ..Settings::default() };
                assert!(DepthComparison::of(&settings).passes(0.5, clear_value(&settings)), "{test:?} {format:?}");
            }
        }
    }
}
