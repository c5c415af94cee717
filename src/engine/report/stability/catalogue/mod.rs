//! Catalogue of numerically hard test cases: for each class, a description of the difficulty and a generator of its
//! cases.
//!
//! Cases are random except for the property that makes them hard. They depend only on the seed and their class, so a
//! class yields the same cases alone or together with all others. To add a class, write a function that creates its
//! cases, and add an entry to the list of its family.

mod attributes;

mod clip_space;

mod depth;

mod rng;

mod mesh;

mod single;

mod throughput;

use serde::Serialize;

use super::case::{Body, StabilityCase};
use super::metric::{Bound, Metric};
use rng::Rng;

/// Group of classes that test the same part of the engine and share the same metrics.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Family {
    /// Coverage of individual screen-space triangles.
    Coverage,
    /// Triangles that share edges, so that every pixel is covered exactly once.
    Mesh,
    /// Clip-space triangles that must be clipped or rejected before projection.
    ClipSpace,
    /// Cost per pixel of triangles with unfavourable shapes.
    Throughput,
    /// Weights, attributes and depth inside a triangle.
    Weights,
    /// Resolution of depth buffer formats.
    Depth,
}

impl Family {
    /// All families, in report order.
    pub const ALL: [Self; 6] =
        [Self::Coverage, Self::Mesh, Self::ClipSpace, Self::Throughput, Self::Weights, Self::Depth];

    /// Returns the id of the family, as used in files.
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

    /// Returns the display name of the family.
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

/// Class of test cases that share one numerical difficulty.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Class {
    /// Id used on the command line and in files.
    pub id: &'static str,
    /// Display name of the class.
    pub name: &'static str,
    /// Family of the class, which determines the metrics.
    pub family: Family,
    /// One-sentence description of the difficulty and the typical failure.
    pub about: &'static str,
    /// Most informative metric of the class.
    pub headline: Metric,
    /// Bounds on the metrics that a configuration must meet to pass.
    pub(crate) bounds: &'static [Bound],
    /// Function that generates the test cases, without their ids.
    #[serde(skip)]
    draft: fn(&mut Rng) -> Vec<CaseDraft>,
}

/// Test case without its id and class.
#[derive(Clone, Debug)]
struct CaseDraft {
    note: String,
    body: Body,
}

impl CaseDraft {
    fn new(note: impl Into<String>, body: Body) -> Self {
        Self { note: note.into(), body }
    }
}

impl Class {
    /// Generates the test cases of this class for a seed.
    pub(crate) fn cases(&self, seed: u64) -> Vec<StabilityCase> {
        let mut dice = Rng::new(seed, self.id);
        let drafts = (self.draft)(&mut dice);
        let named = |(index, CaseDraft { note, body })| StabilityCase {
            id: format!("{}-{index:02}-seed-{seed}", self.id),
            class: self.id.to_owned(),
            note,
            body,
        };
        drafts.into_iter().enumerate().map(named).collect()
    }
}

/// Returns all classes of the catalogue, grouped by family.
pub fn all() -> impl Iterator<Item = &'static Class> {
    let families = [single::CLASSES, mesh::CLASSES, clip_space::CLASSES, throughput::CLASSES];
    families.into_iter().chain([attributes::CLASSES, depth::CLASSES]).flatten()
}

/// Returns the class with this id, or `None` if there is none.
pub fn by_id(id: &str) -> Option<&'static Class> {
    all().find(|class| class.id == id)
}

#[cfg(test)]
mod tests;
