//! Counts of the pixels that change between runs of the stability probe.

use super::draw::ProbeImages;
use super::{Fragile, Probe, ProbeResult, ProbedView};
use crate::image::Image;
use crate::scene::TriangleId;

/// Running counts of changes relative to the picture without jitter.
pub(super) struct ProbeTally {
    baseline: ProbeImages,
    owner: Image<u16>,
    depth: Option<Image<u16>>,
    color: Image<u16>,
    /// Pixels gained or lost by each triangle, in scene order.
    triangles: Vec<TriangleChanges>,
}

/// Pixels that one triangle gained or lost in the runs so far.
#[derive(Clone, Copy, Default)]
struct TriangleChanges {
    changes: u64,
    worst_pixel: (u32, u32),
    worst_changes: u16,
}

impl ProbeTally {
    /// Creates zeroed counts for a scene of `triangles` triangles.
    pub(super) fn new(baseline: ProbeImages, triangles: usize) -> Self {
        let none = Image::filled(baseline.color.width(), baseline.color.height(), 0);
        Self {
            owner: none.clone(),
            depth: baseline.depth.is_some().then(|| none.clone()),
            color: none,
            baseline,
            triangles: vec![TriangleChanges::default(); triangles],
        }
    }

    /// Adds the changes of one run to the counts.
    pub(super) fn add(&mut self, drawn: &ProbeImages) {
        count(&mut self.color, &self.baseline.color, &drawn.color, |a, b| a == b);
        if let (Some(counts), Some(still), Some(new)) = (&mut self.depth, &self.baseline.depth, &drawn.depth) {
            count(counts, still, new, |a, b| a.to_bits() == b.to_bits());
        }
        count(&mut self.owner, &self.baseline.owner, &drawn.owner, |a, b| a == b);
        let width = self.owner.width();
        for (index, (before, after)) in self.baseline.owner.pixels().iter().zip(drawn.owner.pixels()).enumerate() {
            if before == after {
                continue;
            }
            let pixel = (index as u32 % width, index as u32 / width);
            let changes = self.owner.pixels()[index];
            for id in [before, after].into_iter().filter(|id| **id != TriangleId::NONE) {
                let share = &mut self.triangles[id.0 as usize];
                share.changes += 1;
                if changes > share.worst_changes {
                    (share.worst_pixel, share.worst_changes) = (pixel, changes);
                }
            }
        }
    }

    /// Returns the result of the probe, with the triangles ranked from most to least fragile.
    pub(super) fn finish(self, subject: ProbedView, probe: Probe) -> ProbeResult {
        let named = self.triangles.iter().zip(0..).filter(|(share, _)| share.changes > 0);
        let mut ranking: Vec<Fragile> = named
            .map(|(share, id)| Fragile {
                triangle: TriangleId(id),
                changes: share.changes,
                worst_pixel: share.worst_pixel,
                // Includes later runs in which the pixel changed without involving this triangle.
                worst_changes: self.owner.at(share.worst_pixel.0, share.worst_pixel.1),
            })
            .collect();
        ranking.sort_by_key(|fragile| (std::cmp::Reverse(fragile.changes), fragile.triangle));
        ProbeResult {
            probe,
            subject,
            owner_changes: self.owner,
            depth_changes: self.depth,
            color_changes: self.color,
            owners: self.baseline.owner,
            picture: self.baseline.color,
            ranking,
        }
    }
}

fn count<T: Copy>(counts: &mut Image<u16>, still: &Image<T>, new: &Image<T>, same: impl Fn(&T, &T) -> bool) {
    for ((count, still), new) in counts.pixels_mut().iter_mut().zip(still.pixels()).zip(new.pixels()) {
        *count += u16::from(!same(still, new));
    }
}
