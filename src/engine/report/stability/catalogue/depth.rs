//! Test cases for the resolution of depth buffers.

use super::rng::Rng;
use super::{CaseDraft, Class, Family};
use crate::report::stability::case::{Body, DepthCase, DepthPairs};
use crate::report::stability::metric::{Bound, Metric};
use crate::report::stability::oracle::{DepthMapping, DepthStorage};

/// Number of pairs of nearly equal distances per case. The class that repeats a published experiment uses
/// [`PUBLISHED_PAIRS`] instead.
const PAIRS: usize = 150;

/// Number of random pairs per case in the class that repeats a published experiment.
const PUBLISHED_PAIRS: u32 = 200_000;

/// Bounds: the stored depths of every pair differ and are in the correct order, and all depths are finite and between
/// 0 and 1.
const KEPT_APART: &[Bound] =
    &[Bound::none(Metric::Lost), Bound::none(Metric::NotFinite), Bound::none(Metric::OutOfRange)];

pub(super) const CLASSES: &[Class] = &[
    Class {
        id: "depth-ranges",
        name: "Near and far planes",
        family: Family::Depth,
        about: "Distances between planes from 1e-6 to 1e9, with close neighbours: depths that crowd at the near plane \
                leave no precision for far surfaces, so different surfaces get the same depth.",
        headline: Metric::Lost,
        bounds: KEPT_APART,
        draft: ranges,
    },
    Class {
        id: "depth-thin",
        name: "Thin slice of depth",
        family: Family::Depth,
        about: "Near and far planes close together, such as 10 and 10.5: far − near cancels, and a matrix rounded to \
                f32 puts every depth off by hundreds of units in the last place.",
        headline: Metric::Lost,
        bounds: KEPT_APART,
        draft: thin,
    },
    Class {
        id: "depth-published",
        name: "Published experiment",
        family: Family::Depth,
        about: "Random pairs of points on one line of sight, z and z · (1 + gap), as in Upchurch and Desbrun (2012) \
                and Reed (2015): share of pairs that get the same depth or swap their order.",
        headline: Metric::Lost,
        bounds: KEPT_APART,
        draft: published,
    },
];

fn draft(near: f64, far: f64, z: Vec<f32>) -> CaseDraft {
    // Placeholders: the depth format under test determines mapping and storage.
    let (mapping, format) = (DepthMapping::Standard, DepthStorage::F32);
    let (near, far) = (near as f32, far as f32);
    CaseDraft::new(
        format!("near {near:e}, far {far:e}"),
        Body::Depth(DepthCase { mapping, format, near, far: Some(far), z }),
    )
}

/// Returns log-uniform distances between the near and the far plane, each with a close neighbour, in ascending order.
fn distances(dice: &mut Rng, near: f64, far: f64) -> Vec<f32> {
    let mut distances: Vec<f32> = (0..PAIRS)
        .flat_map(|_| {
            let z = dice.log_uniform(near, far);
            let gap = 2.0_f64.powi(-dice.integer(12..23));
            [z, z * (1.0 + gap)]
        })
        .map(|z| z as f32)
        .filter(|z| (near as f32..=far as f32).contains(z))
        .collect();
    distances.sort_by(f32::total_cmp);
    distances.dedup();
    distances
}

fn between(dice: &mut Rng, planes: &[(f64, f64)]) -> Vec<CaseDraft> {
    planes.iter().map(|(near, far)| draft(*near, *far, distances(dice, *near, *far))).collect()
}

fn ranges(dice: &mut Rng) -> Vec<CaseDraft> {
    between(dice, &[(0.1, 1e3), (0.01, 1e4), (1e-3, 1e6), (1.0, 1e9), (1e-6, 1.0), (1e-6, 1e9)])
}

fn thin(dice: &mut Rng) -> Vec<CaseDraft> {
    between(dice, &[(10.0, 10.5), (1.0, 1.01), (1000.0, 1001.0)])
}

fn published(dice: &mut Rng) -> Vec<CaseDraft> {
    let settings = [(0.1, 1e4, 1e-3), (0.1, 1e4, 1e-4), (0.1, 1e4, 1e-5), (0.1, 1e4, 1e-6), (1e-3, 1e6, 1e-4)];
    let draft = |(near, far, gap): (f64, f64, f64)| {
        let pairs = DepthPairs {
            mapping: DepthMapping::Standard,
            format: DepthStorage::F32,
            near: near as f32,
            far: far as f32,
            gap,
            pairs: PUBLISHED_PAIRS,
            seed: dice.seed(),
        };
        CaseDraft::new(format!("near {near:e}, far {far:e}, gap {gap:e}"), Body::DepthPairs(pairs))
    };
    settings.map(draft).into()
}
