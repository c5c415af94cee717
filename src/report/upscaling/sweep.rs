//! Draws every recipe of every scene: once for its error, then in rounds for its time.
//!
//! A round runs all recipes once, in an order that is dealt anew each time, so that a change of the machine's speed hits
//! all alike; a round before those that count settles caches and clocks. The first recipe runs twice per round as if it were two:
//! the gap between the two is the noise floor, and smaller differences mean nothing. Files and measures are not timed.

use std::sync::Arc;
use std::time::Duration;

use serde::Serialize;

use super::skipping::{self, Share};
use super::tradeoff::dominated_by;
use crate::chain::{Frame, Recipe, Renderer};
use crate::image::{Image, Rgba8};
use crate::measure::against::{Figures, figures};
use crate::measure::motion::{MotionError, MotionTest, References, Shot, Turn};
use crate::measure::reference::Reference;
use crate::measure::region::Region;
use crate::measure::timing::{Summary, summarize};
use crate::pipeline::settings::Choice as _;
use crate::pipeline::viewport::Viewport;
use crate::report::stability::machine::Machine;
use crate::scene::{Camera, Scene};
use crate::upscale::Upscaling;

/// A scene and a view.
#[derive(Clone, Debug)]
pub struct Subject {
    /// What it is called.
    pub name: String,
    /// The scene.
    pub scene: Arc<Scene>,
    /// The view.
    pub camera: Camera,
}

/// What is measured.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Scenes.
    pub subjects: Vec<Subject>,
    /// Recipes, the first of which is timed twice.
    pub recipes: Vec<Recipe>,
    /// Size of the full picture.
    pub viewport: Viewport,
    /// Rounds that count, ≥ 1.
    pub rounds: usize,
    /// What errors are against.
    pub reference: Reference,
    /// Motion of the camera over which errors are measured.
    pub turn: Turn,
}

/// A recipe with every upscaler and every enlargement.
pub fn every_upscaler(recipe: Recipe) -> Vec<Recipe> {
    Upscaling::every().map(|upscaler| Recipe { upscaler, ..recipe }).collect()
}

/// How far a sweep has come.
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    /// Which scene.
    pub scene: String,
    /// What is done.
    pub stage: &'static str,
    /// Steps done of this stage …
    pub done: usize,
    /// … of so many.
    pub of: usize,
}

/// Everything that was measured.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Where.
    pub machine: Machine,
    /// Threads that drew.
    pub threads: usize,
    /// Size of the full picture, px.
    pub size: [u32; 2],
    /// Rounds that count.
    pub rounds: usize,
    /// Name of what errors are against.
    pub reference: &'static str,
    /// Motion of the camera over which errors are measured.
    pub turn: Turn,
    /// Scene by scene.
    pub scenes: Vec<SceneReport>,
    /// Whether it was cancelled before all scenes and rounds were complete.
    pub partial: bool,
}

/// What was measured on one scene.
#[derive(Clone, Debug, Serialize)]
pub struct SceneReport {
    /// Its name.
    pub scene: String,
    /// Triangles in it.
    pub triangles: usize,
    /// Median frame time of the duplicate over that of its twin, less 1, without sign: smaller differences mean nothing.
    pub noise: f64,
    /// One for each recipe.
    pub rows: Vec<Row>,
    /// Fewer pixels two ways; `None` if the scene is seen through somewhere.
    pub shares: Option<Vec<Share>>,
    /// The part of the picture that methods differ in most.
    pub crop: Region,
}

/// One recipe on one scene.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// Name of the upscaler with what was chosen about it.
    pub label: String,
    /// How it was drawn.
    pub recipe: Recipe,
    /// Share of the pixels that were drawn, in (0, 1].
    pub drawn: f64,
    /// Times of whole frames, ms.
    pub frame_ms: Summary,
    /// Median times of the parts of a frame, ms.
    pub parts_ms: Parts,
    /// Error of the still view.
    pub error: Figures,
    /// Error over the frames of the moving view; ranks the methods. Equal to that of the still view without motion.
    pub motion: MotionError,
    /// Label of a recipe that is as good in time and in FLIP in motion and better in one, if there is one.
    pub dominated_by: Option<String>,
    /// The cropped picture.
    #[serde(skip)]
    pub crop: Image<Rgba8>,
}

/// Where the time of a frame goes, ms.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Parts {
    /// Plan to cull.
    pub geometry: f64,
    /// Rasterize to shade.
    pub pixels: f64,
    /// Filling in.
    pub upscale: f64,
}

/// Sides of a crop in px, at most.
const CROP: (u32, u32) = (160, 110);

/// Seed of the order of rounds.
const SEED: u64 = 7;

/// Measures everything. If cancelled, returns the complete scenes, the last one with the rounds that were complete, or `None`
/// if there are none.
pub fn run(plan: &Plan, tell: &dyn Fn(Progress), cancelled: &dyn Fn() -> bool) -> Option<Report> {
    let mut scenes = Vec::with_capacity(plan.subjects.len());
    for subject in &plan.subjects {
        match of_scene(plan, subject, tell, cancelled) {
            Some(scene) => scenes.push(scene),
            None if cancelled() && !scenes.is_empty() => break,
            None => return None,
        }
        if cancelled() {
            break;
        }
    }
    let Viewport { width, height } = plan.viewport;
    Some(Report {
        machine: Machine::here(),
        threads: rayon::current_num_threads(),
        size: [width, height],
        rounds: plan.rounds,
        reference: plan.reference.name(),
        turn: plan.turn,
        scenes,
        partial: cancelled(),
    })
}

/// One recipe's picture with its error.
struct Judged {
    picture: Image<Rgba8>,
    error: Figures,
    motion: MotionError,
    flip: Image<f32>,
    drawn: f64,
}

fn of_scene(
    plan: &Plan,
    subject: &Subject,
    tell: &dyn Fn(Progress),
    cancelled: &dyn Fn() -> bool,
) -> Option<SceneReport> {
    let say = |stage, done, of| tell(Progress { scene: subject.name.clone(), stage, done, of });
    let Subject { scene, camera, .. } = subject;
    let shot = Shot { scene, camera, viewport: plan.viewport, turn: plan.turn };
    let mut renderer = Renderer::default();
    let mut references = Vec::new();
    let mut judged = Vec::with_capacity(plan.recipes.len());
    for (done, recipe) in plan.recipes.iter().enumerate() {
        if cancelled() {
            return None;
        }
        say("errors", done, plan.recipes.len());
        let references = references_of(plan, &shot, recipe, &mut references, cancelled)?;
        judged.push(judge(&shot, *recipe, references, &mut renderer, cancelled)?);
    }
    let samples = time(plan, subject, &mut renderer, &|done, of| say("times", done, of), cancelled)?;
    say("shares", 0, 1);
    let first = plan.recipes.first()?;
    let applies = skipping::applies(&subject.scene, first, &subject.camera, plan.viewport);
    let Subject { scene, camera, .. } = subject;
    let rounds = plan.rounds.min(SHARE_ROUNDS);
    let shares = applies.then(|| skipping::measure(scene, camera, first, plan.viewport, rounds, cancelled));
    let shares = shares.map_or(Some(None), |shares| shares.map(Some).or(cancelled().then_some(None)))?;
    let crop = crop_of(&judged);
    let noise = noise(&samples)?;
    let mut rows = Vec::with_capacity(judged.len());
    for ((recipe, judged), samples) in plan.recipes.iter().zip(&judged).zip(&samples) {
        rows.push(row(*recipe, judged, samples, crop)?);
    }
    let points: Vec<_> = rows.iter().map(|row| (row.frame_ms.median, row.motion.mean.flip)).collect();
    let labels: Vec<_> = rows.iter().map(|row| row.label.clone()).collect();
    for (row, by) in rows.iter_mut().zip(dominated_by(&points)) {
        row.dominated_by = by.map(|by| labels[by].clone());
    }
    Some(SceneReport {
        scene: subject.name.clone(),
        triangles: subject.scene.triangle_count(),
        noise,
        rows,
        shares,
        crop,
    })
}

/// Rounds of the comparison of two ways to draw fewer pixels, at most: each draws twenty pictures on one thread.
const SHARE_ROUNDS: usize = 9;

/// A frame to be timed.
fn frame_of(plan: &Plan, subject: &Subject, recipe: &Recipe, renderer: &mut Renderer) -> Frame {
    renderer.render_in_motion(&subject.scene, &subject.camera, recipe, plan.viewport)
}

/// Returns the references of a recipe; recipes that differ in nothing but the upscaler share them. `None` if it was
/// cancelled.
fn references_of<'a>(
    plan: &Plan,
    shot: &Shot<'_>,
    recipe: &Recipe,
    known: &'a mut Vec<(Recipe, References)>,
    cancelled: &dyn Fn() -> bool,
) -> Option<&'a References> {
    let plain = Recipe { upscaler: Upscaling::NATIVE, ..*recipe };
    let place = match known.iter().position(|(of, _)| *of == plain) {
        Some(place) => place,
        None => {
            known.push((plain, References::new(plan.reference, plain).complete(shot, cancelled)?));
            known.len() - 1
        }
    };
    Some(&known[place].1)
}

fn judge(
    shot: &Shot<'_>,
    recipe: Recipe,
    references: &References,
    renderer: &mut Renderer,
    cancelled: &dyn Fn() -> bool,
) -> Option<Judged> {
    let frame = renderer.render_settled(shot.scene, shot.camera, &recipe, shot.viewport);
    let (error, flip) = figures(frame.image(), references.still()?)?;
    let (picture, drawn) = (frame.image().clone(), frame.drawn_share());
    renderer.recycle(frame);
    let motion = if shot.turn.degrees == 0.0 {
        MotionError { mean: error, worst: error }
    } else {
        MotionTest::new(recipe, shot.turn).complete(shot, references, cancelled)?
    };
    Some(Judged { picture, error, motion, flip, drawn })
}

/// Times of one frame's parts: whole, geometry, pixels, upscale.
type Sample = [Duration; 4];

/// Samples of every recipe, and last those of the duplicate of the first.
fn time(
    plan: &Plan,
    subject: &Subject,
    renderer: &mut Renderer,
    say: &dyn Fn(usize, usize),
    cancelled: &dyn Fn() -> bool,
) -> Option<Vec<Vec<Sample>>> {
    let count = plan.recipes.len() + 1;
    let mut order: Vec<usize> = (0..count).collect();
    let mut random = fastrand::Rng::with_seed(SEED);
    let mut samples = vec![Vec::with_capacity(plan.rounds); count];
    for round in 0..=plan.rounds {
        say(round, plan.rounds + 1);
        random.shuffle(&mut order);
        for place in &order {
            if cancelled() {
                // A round that counts and is complete is a result; the first round is the warm-up.
                return (round > 1).then_some(samples);
            }
            let recipe = plan.recipes[place % plan.recipes.len()];
            let frame = frame_of(plan, subject, &recipe, renderer);
            let times = frame.times;
            renderer.recycle(frame);
            if round > 0 {
                samples[*place].push([times.total, times.geometry, times.pixels, times.upscale]);
            }
        }
    }
    Some(samples)
}

fn summary_of(samples: &[Sample], part: usize) -> Option<Summary> {
    summarize(&samples.iter().map(|sample| sample[part].as_secs_f64() * 1e3).collect::<Vec<_>>())
}

fn noise(samples: &[Vec<Sample>]) -> Option<f64> {
    let (first, twin) = (summary_of(samples.first()?, 0)?, summary_of(samples.last()?, 0)?);
    Some((twin.median / first.median - 1.0).abs())
}

fn row(recipe: Recipe, judged: &Judged, samples: &[Sample], crop: Region) -> Option<Row> {
    let median = |part| Some(summary_of(samples, part)?.median);
    Some(Row {
        label: recipe.upscaler.label(),
        recipe,
        drawn: judged.drawn,
        frame_ms: summary_of(samples, 0)?,
        parts_ms: Parts { geometry: median(1)?, pixels: median(2)?, upscale: median(3)? },
        error: judged.error,
        motion: judged.motion,
        dominated_by: None,
        crop: crop.of(&judged.picture)?,
    })
}

/// The rectangle in which the error of all together is greatest, on a raster of half its size.
fn crop_of(judged: &[Judged]) -> Region {
    let (width, height) = judged.first().map_or((1, 1), |judged| judged.picture.size());
    let (across, down) = (CROP.0.min(width), CROP.1.min(height));
    let steps = |length: u32, part: u32| (0..=length - part).step_by((part as usize / 2).max(1));
    let regions = steps(height, down).flat_map(|top| steps(width, across).map(move |left| (left, top)));
    let region = |(left, top)| Region { left, top, right: left + across, bottom: top + down };
    let error = |region: &Region| judged.iter().filter_map(|judged| region.mean(&judged.flip)).sum::<f64>();
    let regions = regions.map(region).map(|region| (region, error(&region)));
    let worst = regions.max_by(|(_, a), (_, b)| a.total_cmp(b));
    worst.map_or(Region { left: 0, top: 0, right: across, bottom: down }, |(region, _)| region)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::SceneSource;

    fn plan(viewport: Viewport, rounds: usize) -> Plan {
        let scene = SceneSource::named("triangle".into()).load().unwrap().scene;
        let subject = Subject { name: scene.name.clone(), camera: scene.home, scene: Arc::new(scene) };
        Plan {
            subjects: vec![subject],
            recipes: every_upscaler(Recipe::default()),
            viewport,
            rounds,
            reference: Reference::Native,
            turn: Turn { degrees: 0.5, frames: 2 },
        }
    }

    #[test]
    fn every_upscaler_has_a_row_and_native_has_no_error() {
        let plan = plan(Viewport { width: 40, height: 24 }, 2);
        let report = run(&plan, &|_| {}, &|| false).unwrap();
        let [scene] = &report.scenes[..] else { panic!("one scene") };
        assert_eq!(scene.rows.len(), Upscaling::every().count());
        let native = &scene.rows[0];
        assert!(native.recipe.upscaler.is_native() && native.error.codes.mse == 0.0 && native.drawn == 1.0);
        assert_eq!(native.motion.worst.codes.mse, 0.0);
        let temporal = scene.rows.iter().find(|row| row.recipe.upscaler.method() == "checkerboard-temporal").unwrap();
        assert!(
            temporal.error.codes.mse == 0.0 && temporal.motion.mean.codes.mse > 0.0,
            "exact at rest, not in motion"
        );
        for row in &scene.rows {
            assert_eq!((row.frame_ms.n, row.crop.size()), (2, (40, 24)), "{}", row.label);
            assert!(row.parts_ms.pixels <= row.frame_ms.max && row.error.flip >= 0.0, "{}", row.label);
        }
        let nearest = scene.rows.iter().find(|row| row.label == "Nearest ×4").unwrap();
        assert!(nearest.error.flip > 0.0 && (nearest.drawn - 1.0 / 16.0).abs() < 1e-9);
        assert!(scene.rows.iter().any(|row| row.dominated_by.is_none()), "somebody is best");
    }

    #[test]
    fn a_cancelled_sweep_has_no_report() {
        assert!(run(&plan(Viewport { width: 16, height: 16 }, 1), &|_| {}, &|| true).is_none());
    }

    #[test]
    fn a_sweep_cancelled_later_has_the_rounds_that_were_complete() {
        let rounds_begun = std::cell::Cell::new(0);
        let count = |progress: Progress| rounds_begun.set(rounds_begun.get() + usize::from(progress.stage == "times"));
        // The warm-up and two more rounds are complete when the fourth begins.
        let report = run(&plan(Viewport { width: 16, height: 16 }, 9), &count, &|| rounds_begun.get() == 4).unwrap();
        assert!(report.partial && report.scenes[0].shares.is_none());
        assert!(report.scenes[0].rows.iter().all(|row| row.frame_ms.n == 2), "two complete rounds");
    }
}
