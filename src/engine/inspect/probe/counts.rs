//! Counts of the pixels that change between runs of the stability probe.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::ProbePlan;
use super::draw::ProbeImages;
use crate::image::Image;
use crate::measure::shard::ShardRun;
use crate::scene::TriangleId;

/// Changes relative to the picture without jitter, counted over some runs. Pixels are numbered row by row from the top;
/// those that never changed are absent. Neither the order of the runs nor their division into shards matters.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ProbeCounts {
    /// Owners of each pixel whose owner changed.
    pub(super) owner: BTreeMap<u32, PixelOwners>,
    /// Number of runs in which the stored depth of each pixel differed; `None` without a depth test.
    pub(super) depth: Option<BTreeMap<u32, u16>>,
    /// Number of runs in which the colour of each pixel differed.
    pub(super) color: BTreeMap<u32, u16>,
}

/// Triangles that own one pixel.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct PixelOwners {
    /// Triangle that owns the pixel without jitter.
    pub(super) still: TriangleId,
    /// Number of runs in which each other triangle, or none, owned the pixel.
    pub(super) others: BTreeMap<TriangleId, u16>,
}

impl PixelOwners {
    /// Returns the number of runs in which the owner differed from the owner without jitter.
    pub(super) fn changes(&self) -> u16 {
        self.others.values().sum()
    }
}

impl ProbeCounts {
    /// Creates counts of no runs.
    pub(super) fn new(has_depth: bool) -> Self {
        Self { owner: BTreeMap::new(), depth: has_depth.then(BTreeMap::new), color: BTreeMap::new() }
    }

    /// Adds the changes of one run.
    pub(super) fn add(&mut self, still: &ProbeImages, drawn: &ProbeImages) {
        count(&mut self.color, &still.color, &drawn.color, |a, b| a == b);
        if let (Some(counts), Some(still), Some(new)) = (&mut self.depth, &still.depth, &drawn.depth) {
            count(counts, still, new, |a, b| a.to_bits() == b.to_bits());
        }
        for (pixel, (before, after)) in (0..).zip(still.owner.pixels().iter().zip(drawn.owner.pixels())) {
            if before != after {
                let owners = self.owner.entry(pixel);
                let owners = owners.or_insert_with(|| PixelOwners { still: *before, others: BTreeMap::new() });
                *owners.others.entry(*after).or_default() += 1;
            }
        }
    }

    /// Adds the changes of other runs.
    pub fn join(&mut self, more: Self) {
        for (pixel, owners) in more.owner {
            let here = self.owner.entry(pixel);
            let here = here.or_insert_with(|| PixelOwners { still: owners.still, others: BTreeMap::new() });
            owners.others.into_iter().for_each(|(triangle, runs)| *here.others.entry(triangle).or_default() += runs);
        }
        let join = |all: &mut BTreeMap<u32, u16>, more: BTreeMap<u32, u16>| {
            more.into_iter().for_each(|(pixel, runs)| *all.entry(pixel).or_default() += runs);
        };
        join(&mut self.color, more.color);
        if let Some((all, more)) = self.depth.as_mut().zip(more.depth) {
            join(all, more);
        }
    }

    /// Returns the first contradiction between the counts of a shard and the plan, in words.
    ///
    /// # Errors
    /// Returns an error if a pixel lies outside of the picture, or changed in more runs than the shard has.
    pub fn check(plan: &ProbePlan, run: &ShardRun<Self>) -> Result<(), String> {
        let runs = (0..plan.probe.runs).filter(|number| run.shard.owns((*number).into())).count() as u64;
        let pixels = plan.picture.pixels().len() as u64;
        let Self { owner, depth, color } = &run.results;
        let of_owner =
            owner.iter().map(|(pixel, owners)| (*pixel, owners.others.values().map(|n| u64::from(*n)).sum()));
        let others = depth.iter().flatten().chain(color).map(|(pixel, count)| (*pixel, u64::from(*count)));
        match of_owner.chain(others).find(|(pixel, count)| u64::from(*pixel) >= pixels || *count > runs) {
            Some((pixel, count)) => Err(format!("pixel {pixel} of {pixels} changed in {count} of {runs} runs")),
            None => Ok(()),
        }
    }
}

fn count<T: Copy>(counts: &mut BTreeMap<u32, u16>, still: &Image<T>, new: &Image<T>, same: impl Fn(&T, &T) -> bool) {
    for (pixel, (still, new)) in (0..).zip(still.pixels().iter().zip(new.pixels())) {
        if !same(still, new) {
            *counts.entry(pixel).or_default() += 1;
        }
    }
}
