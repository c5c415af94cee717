//! Explanation: the faults that a search found, what each of them explains, and what remains.

use rasterscope_engine::image::{Image, Rgba8};
use rasterscope_engine::inspect::what_if::Changes;
use serde::Serialize;
use thiserror::Error;

use crate::agreement::{TOLERANCE, difference};
use crate::buffers::{DepthReport, IdReport, TheirBuffers};
use crate::candidate::Candidate;
use crate::cause::{Cause, LEAST_PIXELS};
use crate::query::{Evidence, Query};
use crate::rest::Rest;
use crate::search::{FaultSet, Interrupted, Progress, Search};
use crate::setup::Setup;
use crate::verification::{Drawn, Verification};
use crate::window::Window;

/// Greatest share of pixels of the picture that may differ between two correct renderers.
const NOISE: f64 = 0.005;

/// Greatest number of searches, each on windows of the picture where the causes of the previous one explain nothing.
const MOST_SEARCHES: usize = 2;

/// Greatest share of differing pixels, of those without faults, that may remain in a complete explanation.
const COMPLETE: f64 = 0.05;

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
        let windows = Window::sample(viewport, &best.differences.map(|code| code > TOLERANCE));
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
        depth: buffers.depth_report(&best.setup.camera, [&buffers_before, &best.buffers]),
        ids: buffers.id_report([&buffers_before, &best.buffers]),
        rest: Rest::of(&best.setup, &query.theirs, &best.differences),
        setup: best.setup,
        drawings: progress.drawings(),
    })
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
