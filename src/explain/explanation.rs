//! Explanation: the faults that a search found, what each of them explains, and what remains.

use std::collections::BTreeMap;

use rasterscope_engine::antialias::settings::Antialiasing;
use rasterscope_engine::chain::{Recipe, Renderer, run_unobserved};
use rasterscope_engine::image::color::{decode, encode};
use rasterscope_engine::image::{Image, Rgba8};
use rasterscope_engine::inspect::capture;
use rasterscope_engine::inspect::what_if::Changes;
use rasterscope_engine::scene::TriangleId;
use rasterscope_engine::upscale::Upscaling;
use serde::Serialize;
use thiserror::Error;

use crate::agreement::{TOLERANCE, difference};
use crate::fault::{Fault, Slot};
use crate::faults::ALL;
use crate::search::{FaultSet, Interrupted, Search, extended, reduced};
use crate::setup::{Rounding, Setup};

/// Smallest number of pixels, and smallest share of the picture, that only one fault must explain to be named.
const LEAST: (f64, f64) = (20.0, 2e-4);

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

/// Differing pixels of one object that no cause explains.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Rest {
    /// Name of the object that our drawing with the causes shows there; `None` for the background.
    pub object: Option<String>,
    /// Number of pixels.
    pub pixels: u64,
    /// Number of them beside another triangle or the background, where rounded vertices decide.
    pub at_edges: u64,
    /// Number of them that are a lighter or darker shade of our colour: light or normals differ, not the surface.
    pub shades: u64,
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
    let differing = |set: &[usize]| search.get(set).map_or(0, |trial| trial.agreement.differing);
    let (before, after) = (differing(&[]), differing(&faults));
    Ok(Explanation {
        pixels: u64::from(viewport.width) * u64::from(viewport.height),
        differing_before: before,
        differing_after: after,
        confidence: confidence(&causes, before, after, &query.theirs),
        causes,
        rest: rest(&search, &setup),
        setup,
        drawings: search.drawings(),
    })
}

/// Returns what each fault of a set explains, the one that explains most first.
fn causes(search: &mut Search<'_>, faults: &[usize]) -> Result<Vec<Cause>, Interrupted> {
    let mut causes = Vec::new();
    for index in faults {
        let others = reduced(faults, *index);
        // Rounding changes codes by one, which is within the tolerance.
        let most = if ALL[*index].slot == Slot::Rounding { 0 } else { TOLERANCE };
        let (with_all, without) = (differences(search, faults), differences(search, &others));
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

/// Returns whether a cause explains enough pixels, many of them exactly, and spoils few.
fn is_convincing(cause: &Cause, picture: &Image<Rgba8>) -> bool {
    let (explained, exact, spoiled) = (cause.explained as f64, cause.exact as f64, cause.spoiled as f64);
    let share = if cause.fault.slot == Slot::Rounding { LEAST_ROUNDED } else { LEAST.1 };
    let least = LEAST.0.max(share * picture.pixels().len() as f64);
    let of_differing = LEAST_OF_DIFFERING * cause.differing_without as f64;
    explained >= least.max(of_differing)
        && exact >= LEAST_EXACT * explained
        && explained >= LEAST_PRECISION * (explained + spoiled)
}

fn confidence(causes: &[Cause], before: u64, after: u64, picture: &Image<Rgba8>) -> Confidence {
    let noise = LEAST.0.max(NOISE * picture.pixels().len() as f64);
    let (before, after) = (before as f64, after as f64);
    match causes {
        [] if before <= noise => Confidence::Agrees,
        [] => Confidence::Unknown,
        _ if after <= noise.max(COMPLETE * before) => Confidence::Complete,
        _ => Confidence::Partial,
    }
}

/// Returns the pixels that no cause explains, by the object that our drawing with the causes shows there.
fn rest(search: &Search<'_>, setup: &Setup) -> Vec<Rest> {
    // One sample per pixel, so that every pixel has one triangle.
    let (antialias, upscaler) = (Antialiasing::default(), Upscaling::NATIVE);
    let recipe = Recipe { antialias, upscaler, ..setup.recipe };
    let frame = run_unobserved(&setup.scene, &setup.camera, &recipe, setup.viewport);
    let triangles = setup.placed(capture(&setup.scene, &recipe, &frame).triangle);
    let first = setup.scene.first_triangles();
    let object = |triangle: TriangleId| {
        (triangle != TriangleId::NONE).then(|| first.partition_point(|start| *start <= triangle) - 1)
    };
    let mut rest: BTreeMap<Option<usize>, Rest> = BTreeMap::new();
    let (theirs, ours) = (&search.target().picture, setup.draw(&mut Renderer::default()));
    for (pixel, difference) in (0_u32..).zip(search.target().differences(&ours, setup.rounding)) {
        if difference <= TOLERANCE {
            continue;
        }
        let (x, y) = (pixel % triangles.width(), pixel / triangles.width());
        let here = triangles.at(x, y);
        let name = || object(here).map(|index| setup.scene.instances[index].name.clone());
        let found =
            rest.entry(object(here)).or_insert_with(|| Rest { object: name(), pixels: 0, at_edges: 0, shades: 0 });
        found.pixels += 1;
        found.at_edges += u64::from(is_edge(&triangles, x, y));
        found.shades += u64::from(is_shade(theirs.at(x, y), ours.at(x, y)));
    }
    let mut rest: Vec<_> = rest.into_values().collect();
    rest.sort_by_key(|object| std::cmp::Reverse(object.pixels));
    rest
}

/// Returns whether a colour is another one times a factor, in linear light and within [`TOLERANCE`].
fn is_shade(color: Rgba8, of: Rgba8) -> bool {
    let linear = |color: Rgba8| [0, 1, 2].map(|channel| decode(f32::from(color[channel]) / 255.0));
    let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let (ours, theirs) = (linear(of), linear(color));
    let factor = dot(ours, theirs) / dot(ours, ours).max(f32::MIN_POSITIVE);
    let [r, g, b] = ours.map(|value| (encode(factor * value) * 255.0).round() as u8);
    difference(color, [r, g, b, color[3]], Rounding::Nearest) <= TOLERANCE
}

/// Returns whether one of the eight neighbours of a pixel shows another triangle.
fn is_edge(triangles: &Image<TriangleId>, x: u32, y: u32) -> bool {
    let here = triangles.at(x, y);
    let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (i64::from(x) + dx, i64::from(y) + dy)));
    around.into_iter().any(|(x, y)| triangles.at_clamped(x, y) != here)
}
