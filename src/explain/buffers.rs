//! Further pictures from the other renderer: depths, and ids of surfaces.

use std::collections::BTreeMap;

use rasterscope_engine::image::{Image, Rgba8};
use rasterscope_engine::scene::Camera;
use serde::Serialize;

use crate::depth_map::{DepthMap, bits, step};
use crate::window::Window;

/// Cost of a pixel whose depth or id disagrees, in nats: about that of a colour that disagrees.
const COST_OF_PIXEL: f64 = 8.0;

/// Cost of one more id, in nats: a picture of many ids may agree by chance.
const COST_OF_ID: f64 = 5.0;

/// Colour of pixels without a surface in our pictures of ids, which no surface has.
pub(crate) const NO_ID: Rgba8 = [0, 0, 0, 255];

/// Further pictures from the other renderer, of the size of its picture. They tell causes apart that look equal in
/// colour.
#[derive(Clone, Debug, Default)]
pub struct TheirBuffers {
    /// Depth of each pixel, in any linear, reciprocal or logarithmic mapping. Integers are divided by their largest
    /// value.
    pub depth: Option<Image<f32>>,
    /// Number of the triangle or object in each pixel, in any numbering.
    pub ids: Option<Image<u32>>,
}

/// Our buffers of the same pixels.
#[derive(Clone, Debug, Default)]
pub(crate) struct OurBuffers {
    /// Distance of each pixel along the line of sight, infinite where no depth is stored; empty if not needed.
    pub(crate) distances: Vec<f32>,
    /// Colour that stands for the object in each pixel; empty if not needed.
    pub(crate) objects: Vec<Rgba8>,
    /// Colour that stands for the triangle in each pixel; empty if not needed.
    pub(crate) triangles: Vec<Rgba8>,
}

/// Buffers of the other renderer in some windows, prepared for comparisons.
#[derive(Clone, Debug)]
pub(crate) struct BufferTarget {
    depths: Option<Vec<f32>>,
    /// Step between depths that can be stored.
    step: f64,
    ids: Option<Vec<u32>>,
}

/// Pixels whose depths or ids disagree, with the assumptions under which most agree.
#[derive(Clone, Debug, Default)]
pub(crate) struct BufferDifferences {
    /// Whether the depth of each pixel differs; empty if no depths were given.
    pub(crate) depth: Vec<bool>,
    /// Mapping of the depths.
    pub(crate) map: Option<DepthMap>,
    /// Whether the id of each pixel differs; empty if no ids were given.
    pub(crate) ids: Vec<bool>,
    /// Surfaces that the ids distinguish.
    pub(crate) level: Option<IdLevel>,
    /// Number of ids that were assigned.
    assigned: usize,
}

/// Surfaces that a picture of ids distinguishes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum IdLevel {
    /// One id per object, or for several objects.
    Objects,
    /// One id per triangle, or for several triangles.
    Triangles,
}

/// Agreement of the other renderer's depths.
#[derive(Clone, Debug, Serialize)]
pub struct DepthReport {
    /// Mapping from distances to the depths; `None` if no known mapping fits.
    pub mapping: Option<String>,
    /// Number of bits of the depths, 8 or 16; `None` if they are finer.
    pub bits: Option<u8>,
    /// Number of pixels whose depths disagree without the causes.
    pub differing_before: u64,
    /// Number of pixels whose depths disagree with the causes.
    pub differing_after: u64,
}

/// Agreement of the other renderer's ids.
#[derive(Clone, Debug, Serialize)]
pub struct IdReport {
    /// Surfaces that the ids distinguish.
    pub level: IdLevel,
    /// Number of pixels whose ids disagree without the causes.
    pub differing_before: u64,
    /// Number of pixels whose ids disagree with the causes.
    pub differing_after: u64,
}

impl TheirBuffers {
    /// Returns whether no further pictures are given.
    pub fn is_empty(&self) -> bool {
        self.depth.is_none() && self.ids.is_none()
    }

    /// Returns the sizes of the given pictures.
    pub(crate) fn sizes(&self) -> impl Iterator<Item = (u32, u32)> {
        self.depth.as_ref().map(Image::size).into_iter().chain(self.ids.as_ref().map(Image::size))
    }

    /// Prepares comparisons of windows, in their order.
    pub(crate) fn target(&self, windows: &[Window]) -> BufferTarget {
        let depths = self.depth.as_ref().map(|depth| joined(depth, windows));
        let all = self.depth.as_ref().map(Image::pixels).unwrap_or_default();
        BufferTarget { step: step(all, bits(all)), depths, ids: self.ids.as_ref().map(|ids| joined(ids, windows)) }
    }

    /// Describes the agreement of the depths, before and after.
    pub(crate) fn depth_report(&self, camera: &Camera, pair: [&BufferDifferences; 2]) -> Option<DepthReport> {
        let depth = self.depth.as_ref()?;
        let [differing_before, differing_after] = pair.map(|differences| count(&differences.depth));
        let mapping = pair[1].map.map(|map| map.name(camera));
        Some(DepthReport { mapping, bits: bits(depth.pixels()), differing_before, differing_after })
    }

    /// Describes the agreement of the ids, before and after.
    pub(crate) fn id_report(&self, pair: [&BufferDifferences; 2]) -> Option<IdReport> {
        let [differing_before, differing_after] = pair.map(|differences| count(&differences.ids));
        Some(IdReport { level: pair[1].level?, differing_before, differing_after })
    }
}

impl OurBuffers {
    /// Appends the buffers of another window.
    pub(crate) fn append(&mut self, mut other: Self) {
        self.distances.append(&mut other.distances);
        self.objects.append(&mut other.objects);
        self.triangles.append(&mut other.triangles);
    }
}

impl BufferTarget {
    /// Whether depths are given.
    pub(crate) fn has_depths(&self) -> bool {
        self.depths.is_some()
    }

    /// Whether ids are given.
    pub(crate) fn has_ids(&self) -> bool {
        self.ids.is_some()
    }

    /// Compares our buffers of the same windows.
    pub(crate) fn differences(&self, ours: &OurBuffers) -> BufferDifferences {
        let mut differences = BufferDifferences::default();
        if let Some(theirs) = &self.depths {
            (differences.depth, differences.map) = differing_depths(theirs, &ours.distances, self.step);
        }
        if let Some(theirs) = &self.ids {
            let [objects, triangles] = [&ours.objects, &ours.triangles].map(|ours| Assignment::of(ours, theirs));
            let (level, better) = if objects.cost() <= triangles.cost() {
                (IdLevel::Objects, objects)
            } else {
                (IdLevel::Triangles, triangles)
            };
            differences.level = Some(level);
            (differences.ids, differences.assigned) = (better.differs, better.ids);
        }
        differences
    }
}

impl BufferDifferences {
    /// Returns the cost of the disagreements, in nats.
    pub(crate) fn cost(&self) -> f64 {
        let pixels = count(&self.depth) + count(&self.ids);
        COST_OF_PIXEL * pixels as f64 + COST_OF_ID * self.assigned as f64
    }
}

/// Assignment of the other renderer's ids to our surfaces, and the pixels that contradict it.
struct Assignment {
    differs: Vec<bool>,
    ids: usize,
}

impl Assignment {
    /// Assigns to each of our surfaces the id of most of its pixels.
    fn of(ours: &[Rgba8], theirs: &[u32]) -> Self {
        let mut counts: BTreeMap<(Rgba8, u32), u64> = BTreeMap::new();
        let mut pairs: Vec<_> = ours.iter().copied().zip(theirs.iter().copied()).collect();
        pairs.sort_unstable();
        for run in pairs.chunk_by(|a, b| a == b) {
            counts.insert(run[0], run.len() as u64);
        }
        let most = |surface: Rgba8, without: Option<u32>| {
            let of_surface =
                counts.range((surface, 0)..=(surface, u32::MAX)).filter(|((_, id), _)| Some(*id) != without);
            of_surface.max_by_key(|(_, count)| **count).map(|((_, id), _)| *id)
        };
        let background = most(NO_ID, None);
        let mut assigned: BTreeMap<Rgba8, Option<u32>> = BTreeMap::new();
        for (surface, _) in counts.keys() {
            let without = background.filter(|_| *surface != NO_ID);
            assigned.entry(*surface).or_insert_with(|| most(*surface, without));
        }
        let differs = ours.iter().zip(theirs).map(|(surface, id)| assigned[surface] != Some(*id)).collect();
        Self { differs, ids: assigned.len() }
    }

    fn cost(&self) -> f64 {
        COST_OF_PIXEL * count(&self.differs) as f64 + COST_OF_ID * self.ids as f64
    }
}

/// Returns the pixels whose depths differ, and the mapping under which most agree.
fn differing_depths(theirs: &[f32], ours: &[f32], step: f64) -> (Vec<bool>, Option<DepthMap>) {
    let pairs = || theirs.iter().zip(ours).map(|(depth, distance)| [f64::from(*distance), f64::from(*depth)]);
    let drawn: Vec<_> = pairs().filter(|pair| pair.iter().all(|value| value.is_finite())).collect();
    let map = DepthMap::fit(&drawn, step);
    let mut cleared: Vec<f64> = pairs().filter(|[distance, _]| !distance.is_finite()).map(|[_, depth]| depth).collect();
    cleared.sort_unstable_by(f64::total_cmp);
    let runs = cleared.chunk_by(|a, b| a.to_bits() == b.to_bits());
    let clear = runs.max_by_key(|run| run.len()).map(|run| run[0]);
    let differs = |[distance, depth]: [f64; 2]| match (&map, clear) {
        (Some(map), _) if distance.is_finite() => map.differs(distance, depth),
        (_, Some(clear)) if !distance.is_finite() => {
            // Infinite depths have no difference.
            let is_near = (depth - clear).abs() <= step;
            !is_near && depth.to_bits() != clear.to_bits()
        }
        _ => true,
    };
    (pairs().map(differs).collect(), map)
}

/// Returns the pixels of all windows, one window after the other.
fn joined<T: Copy>(picture: &Image<T>, windows: &[Window]) -> Vec<T> {
    windows.iter().flat_map(|window| window.of(picture).pixels().to_vec()).collect()
}

/// Returns the number of `true` values.
pub(crate) fn count(differs: &[bool]) -> u64 {
    differs.iter().filter(|differs| **differs).count() as u64
}
