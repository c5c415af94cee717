//! Explanation: the faults that a search found, what each of them explains, and what remains.

use rasterscope_engine::image::{Image, Rgba8};
use rasterscope_engine::inspect::what_if::Changes;
use serde::Serialize;
use thiserror::Error;

use crate::agreement::{TOLERANCE, difference};
use crate::buffers::{DepthReport, IdReport, TheirBuffers};
use crate::candidate::Candidate;
use crate::fault::{Fault, Slot};
use crate::rest::Rest;
use crate::search::{FaultSet, Interrupted, Progress, Search};
use crate::setup::Setup;
use crate::verification::{Drawn, Verification};
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

/// All pictures of the other renderer.
#[derive(Clone, Copy)]
pub(crate) struct Evidence<'a> {
    pub(crate) query: &'a Query,
    pub(crate) buffers: &'a TheirBuffers,
}

/// Reason why there is no explanation.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum ExplainError {
    /// A picture and the view have different sizes.
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
    /// Pixels whose depths agree only with, or only without it.
    pub depth: Tally,
    /// Pixels whose ids agree only with, or only without it.
    pub ids: Tally,
    /// Other faults that would give exactly the same picture here.
    pub alternatives: Vec<&'static Fault>,
}

/// Effect of a cause on the agreement of depths or ids.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Tally {
    /// Number of pixels that agree with all causes, but not without this one.
    pub explained: u64,
    /// Number of pixels that differ without this cause.
    pub differing_without: u64,
    /// Number of pixels that agree without this cause, but not with all of them.
    pub spoiled: u64,
}

impl Tally {
    /// Counts pixels that differ with and without a cause.
    pub(crate) fn of(with: &[bool], without: &[bool]) -> Self {
        let count = |is_counted: &dyn Fn(bool, bool) -> bool| {
            with.iter().zip(without).filter(|(with, without)| is_counted(**with, **without)).count() as u64
        };
        Self {
            explained: count(&|with, without| !with && without),
            differing_without: count(&|_, without| without),
            spoiled: count(&|with, without| with && !without),
        }
    }

    /// Returns whether enough pixels agree only with the cause, and few only without it.
    fn is_convincing(self, least: f64) -> bool {
        let (explained, spoiled) = (self.explained as f64, self.spoiled as f64);
        let of_differing = LEAST_OF_DIFFERING * self.differing_without as f64;
        explained >= least.max(of_differing) && explained >= LEAST_PRECISION * (explained + spoiled)
    }
}

impl Cause {
    /// Returns the effect on colours.
    fn color(&self) -> Tally {
        let Self { explained, differing_without, spoiled, .. } = *self;
        Tally { explained, differing_without, spoiled }
    }

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
    /// Agreement of the depths, if they were given.
    pub depth: Option<DepthReport>,
    /// Agreement of the ids, if they were given.
    pub ids: Option<IdReport>,
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
    explain_with(query, &TheirBuffers::default(), go_on)
}

/// Finds the faults that explain a picture and further pictures of the same drawing, which tell causes apart that look
/// equal in colour. `go_on` is called as by [`explain`].
pub fn explain_with(
    query: &Query,
    buffers: &TheirBuffers,
    go_on: &(dyn Fn(f32) -> bool + Sync),
) -> Result<Explanation, ExplainError> {
    let viewport = query.correct.viewport;
    let ours = (viewport.width, viewport.height);
    if let Some(theirs) = buffers.sizes().chain([query.theirs.size()]).find(|size| *size != ours) {
        return Err(ExplainError::Size { theirs, ours });
    }
    let evidence = Evidence { query, buffers };
    let candidates = Candidate::all(query);
    let progress = Progress::new(go_on, candidates.len());
    let verification = Verification::new(&evidence, &candidates, &progress);
    let mut best = verification.draw(FaultSet::new())?;
    let (before, buffers_before) = (best.agreement.differing, best.buffers.clone());
    let mut causes = Vec::new();
    for _ in 0..MOST_SEARCHES {
        let windows = Window::sample(viewport, &best.differences);
        let mut search = Search::new(&evidence, &candidates, &windows, &progress);
        let found = search.run(&best.faults)?.faults;
        let (drawn, convincing) = verification.convincing(&mut search, found)?;
        if drawn.total() >= best.total() {
            break;
        }
        (best, causes) = (drawn, convincing);
        let is_partial = confidence(&causes, before, &best, query) == Confidence::Partial;
        if windows == [Window::whole(viewport)] || !is_partial {
            break;
        }
    }
    // That nothing is drawn explains every background, so it must explain the whole picture.
    let draws_nothing = best.setup.scene.instances.is_empty();
    if draws_nothing && confidence(&causes, before, &best, query) == Confidence::Partial {
        (best, causes) = (verification.draw(FaultSet::new())?, Vec::new());
    }
    let after = best.agreement.differing;
    Ok(Explanation {
        pixels: u64::from(viewport.width) * u64::from(viewport.height),
        differing_before: before,
        differing_after: after,
        confidence: confidence(&causes, before, &best, query),
        causes,
        depth: buffers.depth_report(&best.setup, [&buffers_before, &best.buffers]),
        ids: buffers.id_report([&buffers_before, &best.buffers]),
        rest: Rest::of(&best.setup, &query.theirs, &best.differences),
        setup: best.setup,
        drawings: progress.drawings(),
    })
}

/// Returns whether enough pixels agree only with a cause, many of them exactly, and few only without it: in colour,
/// depth or ids, without making the others worse.
pub(crate) fn is_convincing(cause: &Cause, picture: &Image<Rgba8>) -> bool {
    let least = |share: f64| LEAST_PIXELS.max(share * picture.pixels().len() as f64);
    let share = if cause.fault.slot == Slot::Rounding { LEAST_ROUNDED } else { LEAST_SHARE };
    let color = cause.color();
    let is_exact = cause.exact as f64 >= LEAST_EXACT * cause.explained as f64;
    let in_color = is_exact && color.is_convincing(least(share));
    let in_buffers = [cause.depth, cause.ids].iter().any(|tally| tally.is_convincing(least(LEAST_SHARE)));
    let all = [color, cause.depth, cause.ids];
    let explained: u64 = all.iter().map(|tally| tally.explained).sum();
    let spoiled: u64 = all.iter().map(|tally| tally.spoiled).sum();
    (in_color || in_buffers) && explained as f64 >= LEAST_PRECISION * (explained + spoiled) as f64
}

/// Returns how far the causes explain the picture. `before` is the number of pixels that differ without them, and `drawn`
/// the drawing with them.
fn confidence(causes: &[Cause], before: u64, drawn: &Drawn, query: &Query) -> Confidence {
    let pixels = query.theirs.pixels().len() as f64;
    let noise = (NOISE * pixels).max(LEAST_PIXELS.min(0.1 * pixels));
    let (before, after) = (before as f64, drawn.agreement.differing as f64);
    match causes {
        [] if before == 0.0 => Confidence::Agrees,
        [] if before <= noise && !has_spot(&drawn.differences) => Confidence::Agrees,
        [] => Confidence::Unknown,
        _ if after <= noise.max(COMPLETE * before) => Confidence::Complete,
        _ => Confidence::Partial,
    }
}

/// Returns whether all pixels differ in a square of three pixels. Rounding, as of vertices, makes single pixels and lines
/// along edges differ.
fn has_spot(differences: &Image<u8>) -> bool {
    let (width, height) = differences.size();
    let differs = |x: u32, y: u32| differences.at(x, y) > TOLERANCE;
    let is_spot = |(x, y): (u32, u32)| (y..y + 3).all(|row| (x..x + 3).all(|column| differs(column, row)));
    (0..height.saturating_sub(2)).flat_map(|y| (0..width.saturating_sub(2)).map(move |x| (x, y))).any(is_spot)
}
