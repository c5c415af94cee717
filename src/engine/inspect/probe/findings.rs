//! Findings of the stability probe: how often each pixel changed, and which triangles lost or gained pixels.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use serde::Serialize;

use super::counts::ProbeCounts;
use super::{Heat, Probe};
use crate::image::{Image, Rgba8};
use crate::scene::TriangleId;

/// Triangle that gained or lost pixels during a stability probe.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Fragile {
    /// Triangle that gained or lost pixels.
    pub triangle: TriangleId,
    /// Number of pixels that the triangle gained or lost, summed over all runs.
    pub changes: u64,
    /// Column and row of the pixel whose owner changed in the most runs, among the pixels that the triangle gained or
    /// lost; the first of several, row by row from the top.
    pub worst_pixel: (u32, u32),
    /// Number of runs in which `worst_pixel` had a different owner.
    pub worst_changes: u16,
}

/// Findings of a stability probe. All images have the size of the probed view, and all counts are numbers of runs.
#[derive(Clone, Debug)]
pub struct ProbeFindings {
    /// Parameters of the probe.
    pub probe: Probe,
    /// Number of runs in which the owner of each pixel differed from the owner without jitter. A pixel that has an
    /// owner in only one of the two pictures counts as different.
    pub(crate) owner_changes: Image<u16>,
    /// Number of runs in which the stored depth of each pixel differed from the depth without jitter, even by one step;
    /// `None` without a depth test.
    pub(crate) depth_changes: Option<Image<u16>>,
    /// Number of runs in which the colour of each pixel differed from the colour without jitter.
    pub(crate) color_changes: Image<u16>,
    /// Picture that is drawn without jitter, as sRGB codes.
    pub(crate) picture: Image<Rgba8>,
    /// Triangles that lost or gained pixels, most fragile first.
    pub ranking: Vec<Fragile>,
}

/// Summary of the pixels that changed in one aspect, such as depth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Changed {
    /// Number of pixels that changed in at least one run.
    pub pixels: u64,
    /// Number of runs in which the most frequently changed pixel changed.
    pub most: u16,
}

/// Summary of the result of a stability probe.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct ProbeSummary {
    /// Number of pixels in the picture.
    pub pixels: u64,
    /// Changes of the triangle that owns a pixel.
    pub owner: Changed,
    /// Changes of the stored depth; `None` without a depth test.
    pub depth: Option<Changed>,
    /// Changes of the pixel colour.
    pub color: Changed,
    /// Number of triangles that lost or gained pixels.
    pub fragile_triangles: usize,
}

impl ProbeFindings {
    /// Evaluates the counts of all runs. `picture` is the picture without jitter.
    pub fn new(probe: Probe, picture: Image<Rgba8>, counts: &ProbeCounts) -> Self {
        let (width, height) = picture.size();
        let image = |runs: &mut dyn Iterator<Item = (u32, u16)>| {
            let mut image = Image::filled(width, height, 0);
            runs.for_each(|(pixel, runs)| image.pixels_mut()[pixel as usize] = runs);
            image
        };
        let changed = |runs: &BTreeMap<u32, u16>| image(&mut runs.iter().map(|(pixel, runs)| (*pixel, *runs)));
        Self {
            probe,
            owner_changes: image(&mut counts.owner.iter().map(|(pixel, owners)| (*pixel, owners.changes()))),
            depth_changes: counts.depth.as_ref().map(changed),
            color_changes: changed(&counts.color),
            ranking: ranking(counts, width),
            picture,
        }
    }

    /// Returns width and height of the probed view, in pixels.
    pub fn size(&self) -> (u32, u32) {
        self.picture.size()
    }

    /// Summarises the changes over all pixels.
    pub fn summary(&self) -> ProbeSummary {
        let changed = |counts: &Image<u16>| Changed {
            pixels: counts.pixels().iter().filter(|count| **count > 0).count() as u64,
            most: counts.pixels().iter().copied().max().unwrap_or(0),
        };
        ProbeSummary {
            pixels: self.owner_changes.pixels().len() as u64,
            owner: changed(&self.owner_changes),
            depth: self.depth_changes.as_ref().map(changed),
            color: changed(&self.color_changes),
            fragile_triangles: self.ranking.len(),
        }
    }

    /// Returns, for each pixel, the number of runs in which one aspect changed; `None` for depth without a depth test.
    pub fn counts(&self, heat: Heat) -> Option<&Image<u16>> {
        match heat {
            Heat::Owner => Some(&self.owner_changes),
            Heat::Depth => self.depth_changes.as_ref(),
            Heat::Color => Some(&self.color_changes),
        }
    }
}

/// Returns the triangles that gained or lost pixels, from most to least fragile. `width` is the width of the picture.
fn ranking(counts: &ProbeCounts, width: u32) -> Vec<Fragile> {
    let mut triangles: BTreeMap<TriangleId, Fragile> = BTreeMap::new();
    for (pixel, owners) in &counts.owner {
        let (worst_pixel, worst_changes) = ((pixel % width, pixel / width), owners.changes());
        // The owner without jitter loses the pixel in every run in which another triangle owns it.
        let lost = std::iter::once((owners.still, worst_changes));
        let gained = owners.others.iter().map(|(triangle, runs)| (*triangle, *runs));
        for (triangle, runs) in lost.chain(gained).filter(|(triangle, _)| *triangle != TriangleId::NONE) {
            let first = Fragile { triangle, changes: 0, worst_pixel, worst_changes };
            let fragile = triangles.entry(triangle).or_insert(first);
            fragile.changes += u64::from(runs);
            if worst_changes > fragile.worst_changes {
                (fragile.worst_pixel, fragile.worst_changes) = (worst_pixel, worst_changes);
            }
        }
    }
    let mut ranking: Vec<Fragile> = triangles.into_values().collect();
    ranking.sort_by_key(|fragile| (Reverse(fragile.changes), fragile.triangle));
    ranking
}
