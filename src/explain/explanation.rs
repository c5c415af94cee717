//! Explanation: the faults that a search found, what each of them explains, and what remains.

use rasterscope_engine::chain::Renderer;
use rasterscope_engine::image::{Image, Rgba8};
use rasterscope_engine::inspect::what_if::Changes;
use serde::Serialize;
use thiserror::Error;

use crate::agreement::{TOLERANCE, difference};
use crate::fault::{Fault, Slot};
use crate::faults::ALL;
use crate::rest::Rest;
use crate::search::{FaultSet, Interrupted, Search, extended, reduced};
use crate::setup::Setup;

/// Smallest number of pixels that only one fault must explain to be named.
const LEAST_PIXELS: f64 = 20.0;

/// Smallest share of the picture that only one fault must explain to be named.
const LEAST_SHARE: f64 = 2e-4;

/// Smallest share of the pixels that a fault changes towards or away from agreement that must change towards it.
const LEAST_PRECISION: f64 = 0.9;

/// Smallest share of the pixels that differ without a fault that the fault must explain. An unknown fault can look like a
/// known one in a few of its pixels.
const LEAST_OF_DIFFERING: f64 = 0.15;

/// Smallest share of the explained pixels that must agree exactly. Of a chance agreement within the tolerance of two
/// codes either way, a fifth is exact.
const LEAST_EXACT: f64 = 0.3;

/// Smallest share of the picture whose codes another rounding must explain.
const LEAST_ROUNDED: f64 = 0.05;

/// Greatest share of pixels of the picture that may differ between two correct renderers.
const NOISE: f64 = 0.005;

/// Greatest share of differing pixels, of those without faults, that may remain in a complete explanation.
const COMPLETE: f64 = 0.05;

/// Question: which faults turn our drawing into another renderer's picture?
#[derive(Clone, Debug)]
pub struct Query {
    /// What the picture should show: our inputs without faults.
    pub correct: Setup,
    /// The other renderer's picture, of the size of the setup.
    pub theirs: Image<Rgba8>,
    /// Ids of faults that are not considered.
    pub without: Vec<String>,
}

/// Reason why there is no explanation.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum ExplainError {
    /// The picture and the view have different sizes.
    #[error("the picture has {theirs:?} px, the view {ours:?} px")]
    Size {
        /// Width and height of the picture.
        theirs: (u32, u32),
        /// Width and height of the view.
        ours: (u32, u32),
    },
    /// The search was interrupted.
    #[error("the search was interrupted")]
    Interrupted,
}

impl From<Interrupted> for ExplainError {
    fn from(Interrupted: Interrupted) -> Self {
        Self::Interrupted
    }
}

/// How far an explanation reaches.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Confidence {
    /// The picture agrees with ours without faults.
    Agrees,
    /// The faults explain nearly all differences.
    Complete,
    /// The faults explain some of the differences.
    Partial,
    /// No known fault explains the differences.
    Unknown,
}

/// Fault that was found.
#[derive(Clone, Debug)]
pub struct Cause {
    /// The fault.
    pub fault: &'static Fault,
    /// Number of pixels that agree with all causes, but not without this one.
    pub explained: u64,
    /// Number of the explained pixels that agree exactly.
    pub exact: u64,
    /// Number of pixels that differ without this cause.
    pub differing_without: u64,
    /// Number of pixels that agree without this cause, but not with all of them.
    pub spoiled: u64,
    /// Other faults that would give exactly the same picture here.
    pub alternatives: Vec<&'static Fault>,
}

/// Answer to a [`Query`].
#[derive(Clone, Debug, Serialize)]
pub struct Explanation {
    /// Number of pixels of the picture.
    pub pixels: u64,
    /// Number of pixels that differ from our drawing without faults.
    pub differing_before: u64,
    /// Number of pixels that differ from our drawing with the causes.
    pub differing_after: u64,
    /// Faults that were found, the one that explains most first.
    pub causes: Vec<Cause>,
    /// How far the causes reach.
    pub confidence: Confidence,
    /// What they leave unexplained, the object with most pixels first.
    pub rest: Vec<Rest>,
    /// Setup with the causes, which draws our picture with the faults.
    #[serde(skip)]
    pub setup: Setup,
    /// Number of drawings made.
    pub drawings: usize,
}

impl Explanation {
    /// Returns the other renderer's picture with only the pixels in colour that differ from `faulty`, our drawing with
    /// the causes. Both have the size of the setup.
    pub fn unexplained(&self, theirs: &Image<Rgba8>, faulty: &Image<Rgba8>) -> Image<Rgba8> {
        let (width, height) = theirs.size();
        let rounding = self.setup.rounding;
        let differs = |x, y| difference(theirs.at(x, y), faulty.at(x, y), rounding) > TOLERANCE;
        Changes::of_mask(Image::from_fn(width, height, differs)).with_unchanged_dimmed(theirs)
    }
}

/// Finds the faults that explain a picture. `go_on` is called with the progress in [0, 1] and returns whether to
/// continue.
///
/// # Examples
/// ```
/// use std::sync::Arc;
///
/// use rasterscope_engine::chain::{Recipe, Renderer};
/// use rasterscope_engine::pipeline::viewport::Viewport;
/// use rasterscope_engine::scene::builtin;
/// use rasterscope_explain::{Query, Setup, by_id, explain};
///
/// let scene = Arc::new(builtin::by_id("cubes").unwrap().build());
/// let viewport = Viewport { width: 96, height: 54 };
/// let correct = Setup::new(Arc::clone(&scene), scene.home, Recipe::default(), viewport);
/// let upside_down = correct.with([by_id("flip-vertical").unwrap()]).draw(&mut Renderer::default());
///
/// let answer = explain(&Query { correct, theirs: upside_down, without: Vec::new() }, &|_| true).unwrap();
/// assert_eq!(answer.causes[0].fault.id, "flip-vertical");
/// assert_eq!(answer.differing_after, 0);
/// ```
pub fn explain(query: &Query, go_on: &(dyn Fn(f32) -> bool + Sync)) -> Result<Explanation, ExplainError> {
    let viewport = query.correct.viewport;
    let ours = (viewport.width, viewport.height);
    if query.theirs.size() != ours {
        return Err(ExplainError::Size { theirs: query.theirs.size(), ours });
    }
    let mut search = Search::new(query, go_on);
    let mut faults = search.run()?.faults;
    let causes = loop {
        let causes = causes(&mut search, &faults)?;
        match causes.iter().find(|cause| !is_convincing(cause, &query.theirs)) {
            None => break causes,
            Some(weak) => faults.retain(|index| ALL[*index].id != weak.fault.id),
        }
    };
    search.draw_all(vec![FaultSet::new(), faults.clone()])?;
    let setup = search.setup(&faults);
    let drawn = setup.draw(&mut Renderer::default());
    let differing = |set: &[usize]| search.get(set).map_or(0, |trial| trial.agreement.differing);
    let (before, after) = (differing(&[]), differing(&faults));
    Ok(Explanation {
        pixels: u64::from(viewport.width) * u64::from(viewport.height),
        differing_before: before,
        differing_after: after,
        confidence: confidence(&causes, before, after, &query.theirs),
        causes,
        rest: Rest::of(&setup, &query.theirs, &drawn),
        setup,
        drawings: search.drawings(),
    })
}

/// Returns what each fault of a set explains, the one that explains most first.
fn causes(search: &mut Search<'_>, faults: &[usize]) -> Result<Vec<Cause>, Interrupted> {
    let mut causes = Vec::new();
    let with_all = differences(search, faults);
    for index in faults {
        let others = reduced(faults, *index);
        // Rounding changes codes by one, which is within the tolerance.
        let most = if ALL[*index].slot == Slot::Rounding { 0 } else { TOLERANCE };
        let without = differences(search, &others);
        let pairs = || with_all.iter().copied().zip(without.iter().copied());
        causes.push(Cause {
            fault: &ALL[*index],
            explained: pairs().filter(|(with, without)| *with <= most && *without > most).count() as u64,
            differing_without: without.iter().filter(|difference| **difference > most).count() as u64,
            exact: pairs().filter(|(with, without)| *with == 0 && *without > most).count() as u64,
            spoiled: pairs().filter(|(with, without)| *with > TOLERANCE && *without <= TOLERANCE).count() as u64,
            alternatives: alternatives(search, faults, *index)?,
        });
    }
    causes.sort_by_key(|cause| std::cmp::Reverse(cause.explained));
    Ok(causes)
}

/// Returns the difference of each pixel from the drawing of a set, in codes.
fn differences(search: &Search<'_>, faults: &[usize]) -> Vec<u8> {
    let setup = search.setup(faults);
    search.target().differences(&setup.draw(&mut Renderer::default()), setup.rounding)
}

/// Returns the faults that give the same picture in place of one fault of a set.
fn alternatives(search: &mut Search<'_>, faults: &[usize], index: usize) -> Result<Vec<&'static Fault>, Interrupted> {
    let others = reduced(faults, index);
    let is_compatible =
        |other: &usize| *other != index && others.iter().all(|kept| ALL[*kept].slot != ALL[*other].slot);
    let sets: Vec<_> =
        search.known().iter().copied().filter(is_compatible).map(|other| (other, extended(&others, other))).collect();
    search.draw_all(sets.iter().map(|(_, set)| set.clone()).collect())?;
    let hash = |set: &[usize]| search.get(set).map(|trial| trial.hash);
    let same = sets.iter().filter(|(_, set)| hash(set) == hash(faults));
    Ok(same.map(|(other, _)| &ALL[*other]).collect())
}

/// Returns whether enough pixels agree only with a cause, many of them exactly, and few only without it.
fn is_convincing(cause: &Cause, picture: &Image<Rgba8>) -> bool {
    let (explained, exact, spoiled) = (cause.explained as f64, cause.exact as f64, cause.spoiled as f64);
    let share = if cause.fault.slot == Slot::Rounding { LEAST_ROUNDED } else { LEAST_SHARE };
    let least = LEAST_PIXELS.max(share * picture.pixels().len() as f64);
    let of_differing = LEAST_OF_DIFFERING * cause.differing_without as f64;
    explained >= least.max(of_differing)
        && exact >= LEAST_EXACT * explained
        && explained >= LEAST_PRECISION * (explained + spoiled)
}

fn confidence(causes: &[Cause], before: u64, after: u64, picture: &Image<Rgba8>) -> Confidence {
    let noise = LEAST_PIXELS.max(NOISE * picture.pixels().len() as f64);
    let (before, after) = (before as f64, after as f64);
    match causes {
        [] if before <= noise => Confidence::Agrees,
        [] => Confidence::Unknown,
        _ if after <= noise.max(COMPLETE * before) => Confidence::Complete,
        _ => Confidence::Partial,
    }
}
