//! `coplanar_pair`: evaluates barycentric weights and attributes of two coplanar triangles at the same pixels.

use serde::{Deserialize, Serialize};

use super::tri_attr::{TriangleSamples, check_pixels, check_vertices};
use super::{AttributeVertex, Check, Control, Exactly, SampleAttributes, Unanswered, check_length};
use crate::pipeline::settings::Arithmetic;

/// Input of a `coplanar_pair` case: two coplanar triangles and the pixels to evaluate.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct CoplanarPair {
    /// Screen-space corners of the first triangle.
    pub(crate) first: Exactly<AttributeVertex, 3>,
    /// Screen-space corners of the second triangle.
    pub(crate) second: Exactly<AttributeVertex, 3>,
    /// Column and row of each pixel to evaluate.
    pub(crate) eval: Vec<Exactly<i64, 2>>,
}

impl Check for CoplanarPair {
    fn check(&self) -> Result<(), String> {
        check_vertices(&self.first)?;
        check_vertices(&self.second)?;
        check_pixels(&self.eval)
    }
}

impl CoplanarPair {
    /// Interpolates the attributes of both triangles with the code that renders frames.
    pub(super) fn answer(
        &self,
        arithmetic: Arithmetic,
        control: &Control<'_>,
    ) -> Result<CoplanarPairAnswer, Unanswered> {
        let count = self.eval.len() as u64;
        check_length::<SampleAttributes>("pixels", 2 * count)?;
        let sampled = |vertices, done: u64| {
            let samples = TriangleSamples::new(vertices, arithmetic)?;
            control.collect("pixels", (done, 2 * count), self.eval.iter().map(|pixel| samples.at(*pixel)))
        };
        Ok(CoplanarPairAnswer { first: sampled(&self.first, 0)?, second: sampled(&self.second, count)? })
    }
}

/// Answer to a [`CoplanarPair`] case: one entry per triangle and requested pixel.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CoplanarPairAnswer {
    /// Attributes of the first triangle at the requested pixels.
    pub(crate) first: Vec<SampleAttributes>,
    /// Attributes of the second triangle at the requested pixels.
    pub(crate) second: Vec<SampleAttributes>,
}
