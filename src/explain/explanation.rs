//! Explanation: the faults that a search found, what each of them explains, and what remains.

use rasterscope_engine::image::{Image, Rgba8};
use rasterscope_engine::inspect::what_if::Changes;
use serde::Serialize;
use thiserror::Error;

use crate::agreement::{TOLERANCE, difference};
use crate::candidate::Candidate;
use crate::fault::{Fault, Slot};
use crate::rest::Rest;
use crate::search::{FaultSet, Interrupted, Progress, Search};
use crate::setup::Setup;
use crate::verification::Verification;
use crate::window::Window;

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

/// Greatest number of searches, each on windows of the picture where the causes of the previous one explain nothing.
const MOST_SEARCHES: usize = 2;

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
    /// Value that was measured in the picture: the colour of the background as `#rrggbb`.
    pub detail: Option<String>,
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

impl Cause {
    /// Returns the settings, each as `key=value`, that have the effect of the cause; `None` if no settings have it.
    pub fn settings(&self) -> Option<Vec<String>> {
        let of_fault = self.fault.settings().map(|settings| settings.iter().map(|text| (*text).to_owned()).collect());
        of_fault.or_else(|| self.detail.as_ref().map(|color| vec![format!("background={color}")]))
    }
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
    let candidates = Candidate::all(query);
    let progress = Progress::new(go_on, candidates.len());
    let verification = Verification::new(query, &candidates, &progress);
    let mut best = verification.draw(FaultSet::new())?;
    let before = best.agreement.differing;
    let mut causes = Vec::new();
    for _ in 0..MOST_SEARCHES {
        let windows = Window::sample(viewport, &best.differences);
        let mut search = Search::new(query, &candidates, &windows, &progress);
        let found = search.run(&best.faults)?.faults;
        let (drawn, convincing) = verification.convincing(&mut search, found)?;
        if drawn.total() >= best.total() {
            break;
        }
        (best, causes) = (drawn, convincing);
        let is_partial = confidence(&causes, before, best.agreement.differing, &query.theirs) == Confidence::Partial;
        if windows == [Window::whole(viewport)] || !is_partial {
            break;
        }
    }
    let after = best.agreement.differing;
    Ok(Explanation {
        pixels: u64::from(viewport.width) * u64::from(viewport.height),
        differing_before: before,
        differing_after: after,
        confidence: confidence(&causes, before, after, &query.theirs),
        causes,
        rest: Rest::of(&best.setup, &query.theirs, &best.differences),
        setup: best.setup,
        drawings: progress.drawings(),
    })
}

/// Returns whether enough pixels agree only with a cause, many of them exactly, and few only without it.
pub(crate) fn is_convincing(cause: &Cause, picture: &Image<Rgba8>) -> bool {
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
