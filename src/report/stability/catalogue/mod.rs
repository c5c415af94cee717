//! The catalogue of stiff and extreme cases: for each class what it stresses, and how its cases are made.
//!
//! Cases are random but for what makes them hard, and depend on the seed and on their class alone: a class gives the same
//! cases whether it runs by itself or with all others. A new class is a function that makes drafts, and a line in the
//! list of its family.

mod attributes;

mod clip_space;

mod depth;

mod dice;

mod mesh;

mod single;

mod throughput;

use serde::Serialize;

use super::case::{Body, Case};
use super::metric::{Bound, Metric};
use dice::Dice;

/// What a class is about, and so what is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Family {
    /// Triangles by themselves: which pixels are inside.
    Coverage,
    /// Triangles that share edges: every pixel once.
    Mesh,
    /// Triangles that reach beyond what can be projected.
    ClipSpace,
    /// What a pixel costs where triangles have an unfortunate shape.
    Throughput,
    /// Weights, attributes and depth within a triangle.
    Weights,
    /// What the depth buffer can tell apart.
    Depth,
}

impl Family {
    /// All families, in the order of the pipeline's report.
    pub const ALL: [Self; 6] =
        [Self::Coverage, Self::Mesh, Self::ClipSpace, Self::Throughput, Self::Weights, Self::Depth];

    /// The word in files.
    pub fn id(self) -> &'static str {
        match self {
            Self::Coverage => "coverage",
            Self::Mesh => "mesh",
            Self::ClipSpace => "clip-space",
            Self::Throughput => "throughput",
            Self::Weights => "weights",
            Self::Depth => "depth",
        }
    }

    /// What a person calls it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Coverage => "Single triangles",
            Self::Mesh => "Meshes",
            Self::ClipSpace => "Clip space",
            Self::Throughput => "Throughput",
            Self::Weights => "Weights and attributes",
            Self::Depth => "Depth buffer",
        }
    }
}

/// A class of cases.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Class {
    /// The word on the command line and in files.
    pub id: &'static str,
    /// What a person calls it.
    pub name: &'static str,
    /// What is measured.
    pub family: Family,
    /// One sentence: what it stresses, and what breaks.
    pub about: &'static str,
    /// The measure that says it best.
    pub headline: Metric,
    /// What must hold to pass.
    pub bounds: &'static [Bound],
    /// Makes the cases.
    #[serde(skip)]
    draft: fn(&mut Dice) -> Vec<Draft>,
}

/// A case without its name.
#[derive(Clone, Debug)]
struct Draft {
    note: String,
    body: Body,
}

impl Draft {
    fn new(note: impl Into<String>, body: Body) -> Self {
        Self { note: note.into(), body }
    }
}

impl Class {
    /// The cases for a seed.
    pub fn cases(&self, seed: u64) -> Vec<Case> {
        let mut dice = Dice::new(seed, self.id);
        let drafts = (self.draft)(&mut dice);
        let named = |(index, Draft { note, body })| Case {
            id: format!("{}-{index:02}-seed-{seed}", self.id),
            class: self.id.to_owned(),
            note,
            body,
        };
        drafts.into_iter().enumerate().map(named).collect()
    }
}

/// All classes, family by family.
pub fn all() -> impl Iterator<Item = &'static Class> {
    let families = [single::CLASSES, mesh::CLASSES, clip_space::CLASSES, throughput::CLASSES];
    families.into_iter().chain([attributes::CLASSES, depth::CLASSES]).flatten()
}

/// The class of this name.
pub fn by_id(id: &str) -> Option<&'static Class> {
    all().find(|class| class.id == id)
}

#[cfg(test)]
mod tests;
