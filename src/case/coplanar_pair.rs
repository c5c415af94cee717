//! `coplanar_pair`: weights and attributes of two triangles of one plane at the same pixels.

use serde::{Deserialize, Serialize};

use super::{Check, Exactly, Refusal, SampleAttributes, TriAttr, Vertex};
use crate::pipeline::settings::Arithmetic;

/// The case.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct CoplanarPair {
    /// Corners of the first triangle.
    pub first: Exactly<Vertex, 3>,
    /// Corners of the second.
    pub second: Exactly<Vertex, 3>,
    /// Columns and rows of the pixels.
    pub eval: Vec<Exactly<i64, 2>>,
}

impl Check for CoplanarPair {
    fn check(&self) -> Result<(), String> {
        self.halves().iter().try_for_each(Check::check)
    }
}

impl CoplanarPair {
    fn halves(&self) -> [TriAttr; 2] {
        [&self.first, &self.second].map(|vertices| TriAttr { vertices: *vertices, eval: self.eval.clone() })
    }

    /// What the pipeline interpolates in each.
    pub(super) fn answer(&self, arithmetic: Arithmetic) -> Result<CoplanarPairAnswer, Refusal> {
        let [first, second] = self.halves().map(|half| half.answer(arithmetic));
        Ok(CoplanarPairAnswer { first: first?.pixels, second: second?.pixels })
    }
}

/// The answer: for each triangle one entry for each pixel asked for.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CoplanarPairAnswer {
    /// In the first triangle.
    pub first: Vec<SampleAttributes>,
    /// In the second.
    pub second: Vec<SampleAttributes>,
}
