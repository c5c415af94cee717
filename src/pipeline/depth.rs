//! Depth of a fragment, and the test against what is stored.
//!
//! z/w is an affine function of the screen, so it is interpolated with the screen-space weights, never with the
//! perspective-correct ones. The form z₀ + λ₁·(z₁ − z₀) + λ₂·(z₂ − z₀) returns a constant depth exactly.

use super::interpolate::affine_weights;
use super::raster::Sample;
use super::settings::{DepthTest, Settings};
use super::viewport::ScreenTriangle;

/// The comparison that is made on stored numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Comparison {
    /// Everything passes.
    Always,
    /// new < stored.
    Less,
    /// new ≤ stored.
    LessEqual,
    /// new > stored.
    Greater,
    /// new ≥ stored.
    GreaterEqual,
}

impl Comparison {
    /// What a setting means for the numbers that its depth format stores: reversed depth mirrors the comparison.
    pub fn of(settings: &Settings) -> Self {
        match (settings.depth_test, settings.reversed()) {
            (DepthTest::Off | DepthTest::Always, _) => Self::Always,
            (DepthTest::Less, false) | (DepthTest::Greater, true) => Self::Less,
            (DepthTest::Less, true) | (DepthTest::Greater, false) => Self::Greater,
            (DepthTest::LessEqual, false) => Self::LessEqual,
            (DepthTest::LessEqual, true) => Self::GreaterEqual,
        }
    }

    /// Whether a fragment passes.
    #[inline]
    pub fn passes(self, new: f32, stored: f32) -> bool {
        match self {
            Self::Always => true,
            Self::Less => new < stored,
            Self::LessEqual => new <= stored,
            Self::Greater => new > stored,
            Self::GreaterEqual => new >= stored,
        }
    }

    /// The sign between the new and the stored value of a fragment that passed, for people.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Always => "always",
            Self::Less => "<",
            Self::LessEqual => "≤",
            Self::Greater => ">",
            Self::GreaterEqual => "≥",
        }
    }
}

/// What the buffer holds before anything is drawn: the value that loses against everything.
pub fn clear_value(settings: &Settings) -> f32 {
    match Comparison::of(settings) {
        Comparison::Greater | Comparison::GreaterEqual => 0.0,
        Comparison::Less | Comparison::LessEqual => 1.0,
        Comparison::Always => f32::from(u8::from(!settings.reversed())),
    }
}

/// Depth of a covered sample.
#[inline]
pub fn depth_at(triangle: &ScreenTriangle, sample: &Sample) -> f32 {
    let [_, l1, l2] = affine_weights(triangle, sample);
    let [z0, z1, z2] = triangle.vertices.each_ref().map(|v| v.depth);
    z0 + l1 * (z1 - z0) + l2 * (z2 - z0)
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
                assert!(Comparison::of(&settings).passes(0.5, clear_value(&settings)), "{test:?} {format:?}");
            }
        }
    }
}
