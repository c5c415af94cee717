//! A check that every triangle and fragment is counted exactly once.

use serde::Serialize;

use super::rejections::Rejections;
use super::tally::FateTally;
use crate::pipeline::Geometry;
use crate::scene::TriangleId;

/// Numbers of triangles and fragments at the input and output of the pipeline. Inputs are counted independently, not
/// summed from the outcomes.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Account {
    /// Number of triangles that entered the pipeline.
    pub(crate) triangles_in: u64,
    /// Number of rejections by the geometry stages plus the number of triangles passed to the rasterizer.
    pub(crate) triangles_out: u64,
    /// Triangles that were neither rejected nor rasterized.
    pub(crate) without_fate: Vec<TriangleId>,
    /// Triangles that were rejected twice, or both rejected and rasterized.
    pub(crate) with_two_fates: Vec<TriangleId>,
    /// Number of fragments that the rasterizer generated.
    pub(crate) fragments_in: u64,
    /// Number of fragments with a recorded fate.
    pub(crate) fragments_out: u64,
}

impl Account {
    pub(super) fn of(geometry: &Geometry, rejections: &Rejections, tally: &FateTally<'_>) -> Self {
        let mut rasterized = vec![false; rejections.fates.len()];
        geometry.triangles.iter().for_each(|triangle| rasterized[triangle.id.0 as usize] = true);
        let both = || rejections.fates.iter().zip(&rasterized).zip(0..).map(|(fates, id)| (fates, TriangleId(id)));
        let twice = both().filter(|((fate, rasterized), _)| fate.is_some() && **rasterized).map(|(_, id)| id);
        let never = both().filter(|((fate, rasterized), _)| fate.is_none() && !**rasterized).map(|(_, id)| id);
        let rejected = rejections.fates.iter().flatten().count() + rejections.rejected_again.len();
        Self {
            triangles_in: geometry.triangles_in as u64,
            triangles_out: (rejected + rasterized.iter().filter(|r| **r).count()) as u64,
            with_two_fates: twice.chain(rejections.rejected_again.iter().copied()).collect(),
            without_fate: never.collect(),
            fragments_in: tally.generated,
            fragments_out: super::sum(&tally.fragments).sum(),
        }
    }

    /// Whether all sums match and every triangle has exactly one fate.
    pub fn is_balanced(&self) -> bool {
        self.complaints().is_empty()
    }

    /// Returns one sentence for each mismatch; empty if all counts match.
    pub fn complaints(&self) -> Vec<String> {
        let Self { triangles_in, triangles_out, fragments_in, fragments_out, .. } = self;
        let mut complaints = Vec::new();
        if triangles_in != triangles_out {
            complaints.push(format!("{triangles_in} triangles entered the pipeline, but {triangles_out} have a fate"));
        }
        if let Some(first) = self.without_fate.first() {
            complaints.push(format!("{} triangles have no fate, triangle {} first", self.without_fate.len(), first.0));
        }
        if let Some(first) = self.with_two_fates.first() {
            complaints.push(format!(
                "{} triangles have two fates, triangle {} first",
                self.with_two_fates.len(),
                first.0
            ));
        }
        if fragments_in != fragments_out {
            complaints.push(format!("{fragments_in} fragments were generated, but {fragments_out} have a fate"));
        }
        complaints
    }
}
