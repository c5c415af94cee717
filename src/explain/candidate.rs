//! Candidates: the changes that a search tries, with the values that are measured in the picture.

use rasterscope_engine::chain::Renderer;
use rasterscope_engine::image::{Image, Rgba8};

use crate::agreement::TOLERANCE;
use crate::fault::{Change, Fault};
use crate::faults::ALL;
use crate::query::Query;
use crate::setup::{OutputChange, Setup};

/// Smallest share of the pixels without a surface that must have the measured colour of the background.
const LEAST_SAME: f64 = 0.5;

/// Change that a search tries.
#[derive(Clone, Debug)]
pub(crate) struct Candidate {
    /// The fault that has this effect.
    pub(crate) fault: &'static Fault,
    /// The change, with measured values.
    pub(crate) change: Change,
}

impl Candidate {
    /// Returns all changes to try for a query, in the order of the registry.
    pub(crate) fn all(query: &Query) -> Vec<Self> {
        let is_considered = |fault: &&Fault| query.without.iter().all(|id| id != fault.id);
        let mut candidates = Vec::new();
        for fault in ALL.iter().filter(is_considered) {
            if let Change::Background(_) = fault.change {
                let color = background(&query.correct, &query.theirs);
                candidates.extend(color.map(|color| Self { fault, change: Change::Background(Some(color)) }));
                continue;
            }
            let changes = [fault.change].into_iter().chain(fault.variants.iter().copied());
            candidates.extend(changes.map(|change| Self { fault, change }));
        }
        candidates
    }

    /// Whether both may be part of one set.
    pub(crate) fn is_compatible(&self, other: &Self) -> bool {
        self.fault.slot != other.fault.slot
    }

    /// Returns the measured background colour, as sRGB codes.
    pub(crate) fn background(&self) -> Option<[u8; 3]> {
        match self.change {
            Change::Background(color) => color,
            Change::Settings(_) | Change::Setup(_) | Change::Output(_) | Change::Rounding(_) => None,
        }
    }
}

/// Returns the most frequent colour of a picture where our drawing shows no surface; `None` if it is the colour of our
/// background, or if most of these pixels have other colours. The picture may be mirrored.
fn background(correct: &Setup, theirs: &Image<Rgba8>) -> Option<[u8; 3]> {
    const MIRRORINGS: [&[OutputChange]; 4] = [
        &[],
        &[OutputChange::FlipRows],
        &[OutputChange::FlipColumns],
        &[OutputChange::FlipRows, OutputChange::FlipColumns],
    ];
    let mut renderer = Renderer::default();
    let [black, white] =
        [[0; 3], [255; 3]].map(|color| correct.changed([Change::Background(Some(color))]).draw(&mut renderer));
    let (width, height) = theirs.size();
    let is_empty = Image::from_fn(width, height, |x, y| black.at(x, y) == [0, 0, 0, 255] && white.at(x, y) == [255; 4]);
    let of_mirroring = |mirroring: &&[OutputChange]| {
        let is_empty = mirroring.iter().fold(is_empty.clone(), |mask, change| change.place(mask));
        let empty = theirs.pixels().iter().zip(is_empty.pixels()).filter(|(_, is_empty)| **is_empty);
        let mut colors: Vec<_> = empty.map(|([r, g, b, _], _)| [*r, *g, *b]).collect();
        colors.sort_unstable();
        let longest = colors.chunk_by(|a, b| a == b).max_by_key(|run| run.len())?;
        Some((longest.len() as f64 / colors.len() as f64, longest[0]))
    };
    let (share, color) = MIRRORINGS.iter().filter_map(of_mirroring).max_by(|(a, _), (b, _)| a.total_cmp(b))?;
    let ours = correct.recipe.pipeline.background.resolve(correct.scene.background);
    let is_ours = color.iter().zip(ours).all(|(theirs, ours)| theirs.abs_diff(ours) <= TOLERANCE);
    (share >= LEAST_SAME && !is_ours).then_some(color)
}
