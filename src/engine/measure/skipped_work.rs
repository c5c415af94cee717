//! Time saved by skipping parts of the pipeline that a draw does not need. Frames of one view are timed in alternation,
//! with every such skip enabled and with skips disabled.

use std::hint::black_box;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use serde::Serialize;

use super::noise::{Noise, Pairs};
use super::timing::{Summary, summarize};
use crate::chain::{KeepDepth, RenderInputs, Renderer};
use crate::image::{Image, Rgba8};
use crate::pipeline::plan::{DrawPlan, PipelinePart};
use crate::pipeline::settings::{DisabledOptimisation, Settings};
use crate::pipeline::vertex::{DrawMatrices, containment};
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, Scene};

/// Time that a view saves because some draws skip a part of the pipeline.
#[derive(Clone, Debug, Serialize)]
pub struct Saving {
    /// Skipped part of the pipeline; `None` stands for all parts together.
    pub part: Option<PipelinePart>,
    /// Number of draws that skip the part if the skip is enabled.
    pub draws: usize,
    /// Frame time with the skip disabled minus frame time with every skip enabled, both from the same round, in
    /// milliseconds.
    pub saved_ms: Summary,
    /// Whether the median saving is within the noise floor.
    pub within_noise: bool,
    /// Whether the image is identical with the skip enabled and disabled.
    pub same_picture: bool,
}

/// Time saved by all work that a view skips.
#[derive(Clone, Debug, Serialize)]
pub struct Savings {
    /// Frame time with every skip enabled, in milliseconds.
    pub planned_ms: Summary,
    /// Noise floor, from drawing the frame with every skip enabled twice per round.
    pub noise: Noise,
    /// Time spent computing the draw plans of a frame, in milliseconds; it is the only overhead for a view that skips
    /// nothing.
    pub planning_ms: Summary,
    /// Parts that every draw in view runs. [`PipelinePart::Vertices`] is included only if all draws are in view.
    pub(crate) needed: Vec<PipelinePart>,
    /// Savings for each part that some draw skips and whose skip can be disabled. If there are several such parts, the
    /// last entry is for all of them together.
    pub savings: Vec<Saving>,
}

/// Number of warm-up rounds before the measured ones.
const WARM_UP_ROUNDS: usize = 2;

/// Variant of the view that is timed: with every skip enabled, or with some skips disabled.
struct PlanVariant {
    part: Option<PipelinePart>,
    force: DisabledOptimisation,
    draws: usize,
    renderer: Renderer,
    ms: Vec<f64>,
    picture: Image<Rgba8>,
}

/// Times a view with every skip enabled (twice, for the noise floor) and with each skip disabled in turn. Measures
/// `rounds` ≥ 1 rounds on the current rayon pool. `progress` receives the completed fraction in [0, 1]. Returns `None`
/// if cancelled.
pub fn savings(
    inputs: RenderInputs<'_>,
    rounds: usize,
    progress: &dyn Fn(f32),
    cancel: &AtomicBool,
) -> Option<Savings> {
    let RenderInputs { scene, camera, recipe, viewport } = inputs;
    let plans = |force: DisabledOptimisation| {
        let mut recipe = *recipe;
        recipe.pipeline.force = force;
        Renderer::default().render(RenderInputs { recipe: &recipe, ..inputs }, KeepDepth::No).plans
    };
    let first_plans = plans(DisabledOptimisation::Nothing);
    let way = |part: Option<PipelinePart>, force, draws| {
        let (renderer, ms) = (Renderer::default(), Vec::with_capacity(rounds));
        PlanVariant { part, force, draws, renderer, ms, picture: Image::filled(0, 0, [0; 4]) }
    };
    let mut ways = vec![way(None, DisabledOptimisation::Nothing, 0), way(None, DisabledOptimisation::Nothing, 0)];
    for part in PipelinePart::ALL {
        if cancel.load(Ordering::Relaxed) {
            return None;
        }
        let Some(force) = part.disabled_optimisation() else { continue };
        let draws = differing(&first_plans, &plans(force));
        if draws > 0 {
            ways.push(way(Some(part), force, draws));
        }
    }
    if ways.len() > 3 {
        ways.push(way(
            None,
            DisabledOptimisation::Everything,
            differing(&first_plans, &plans(DisabledOptimisation::Everything)),
        ));
    }
    let mut planning_ms = Vec::with_capacity(rounds);
    let all_rounds = WARM_UP_ROUNDS + rounds;
    for round in 0..all_rounds {
        // The order alternates, so that no variant always comes first.
        let count = ways.len();
        for turn in 0..count {
            let way = &mut ways[if round % 2 == 0 { turn } else { count - 1 - turn }];
            if cancel.load(Ordering::Relaxed) {
                return None;
            }
            let mut recipe = *recipe;
            recipe.pipeline.force = way.force;
            let frame = way.renderer.render(RenderInputs { recipe: &recipe, ..inputs }, KeepDepth::No);
            if round >= WARM_UP_ROUNDS {
                way.ms.push(frame.times.total.as_secs_f64() * 1e3);
            } else {
                way.picture = frame.image().clone();
            }
            way.renderer.recycle(frame);
        }
        let planning = time_of_planning(scene, camera, &recipe.pipeline, viewport);
        if round >= WARM_UP_ROUNDS {
            planning_ms.push(planning);
        }
        progress((round + 1) as f32 / all_rounds as f32);
    }
    let [planned, again, forced @ ..] = &ways[..] else { return None };
    let against = |way: &PlanVariant| {
        summarize(&way.ms.iter().zip(&planned.ms).map(|(with, without)| with - without).collect::<Vec<_>>())
    };
    let planned_ms = summarize(&planned.ms)?;
    let mut pairs = Pairs::default();
    pairs.add(&planned.ms, &again.ms);
    let noise = pairs.noise()?;
    let saving = |way: &PlanVariant| {
        let saved_ms = against(way)?;
        Some(Saving {
            part: way.part,
            draws: way.draws,
            saved_ms,
            within_noise: noise.covers_change(saved_ms.median, planned_ms.median),
            same_picture: way.picture == planned.picture,
        })
    };
    let in_view: Vec<_> = first_plans.iter().filter(|plan| plan.runs(PipelinePart::Vertices)).collect();
    let is_needed = |part: &PipelinePart| match part {
        PipelinePart::Vertices => in_view.len() == first_plans.len(),
        _ => !in_view.is_empty() && in_view.iter().all(|plan| plan.runs(*part)),
    };
    Some(Savings {
        planned_ms,
        noise,
        planning_ms: summarize(&planning_ms)?,
        needed: PipelinePart::ALL.into_iter().filter(is_needed).collect(),
        savings: forced.iter().map(saving).collect::<Option<_>>()?,
    })
}

/// Returns the time for computing the draw plans of a frame, in milliseconds. Matrices are not timed, because draws
/// need them anyway.
fn time_of_planning(scene: &Scene, camera: &Camera, settings: &Settings, viewport: Viewport) -> f64 {
    let clip_from_world = camera.clip_from_world_f64(viewport.aspect(), settings.depth_format.mapping());
    let matrices = |instance| DrawMatrices::new(instance, clip_from_world).clip_from_model;
    let draws: Vec<_> = scene.instances.iter().map(|instance| (instance, matrices(instance))).collect();
    let start = Instant::now();
    for (instance, clip_from_model) in draws {
        let inside = containment(scene.library.mesh(instance.mesh).visible_bounds(), clip_from_model);
        black_box(DrawPlan::new(&scene.library, instance, camera, settings, inside));
    }
    start.elapsed().as_secs_f64() * 1e3
}

/// Returns the number of draws whose plan differs between the two lists.
fn differing(some: &[DrawPlan], others: &[DrawPlan]) -> usize {
    some.iter().zip(others).filter(|(one, other)| one != other).count()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::chain::Recipe;
    use crate::scene::builtin;

    #[test]
    fn every_part_that_can_be_forced_is_measured_and_changes_no_picture() {
        let scene = Arc::new(builtin::by_id("chess").unwrap().build());
        let mut recipe = Recipe::default();
        recipe.set("shading=checker").unwrap();
        let viewport = Viewport { width: 64, height: 48 };
        let inputs = RenderInputs { scene: &scene, camera: &scene.home, recipe: &recipe, viewport };
        let cancel = AtomicBool::new(false);
        let reported = std::cell::Cell::new(0.0);
        let found = savings(inputs, 3, &|share| reported.set(share), &cancel).unwrap();
        assert_eq!((found.planned_ms.n, found.noise.pairs, reported.get()), (3, 1, 1.0));
        for saving in &found.savings {
            let is_small = saving.saved_ms.median.abs() <= found.noise.p90 * found.planned_ms.median;
            assert_eq!(saving.within_noise, is_small, "{saving:?}");
        }
        let parts: Vec<_> = found.savings.iter().map(|saving| saving.part).collect();
        assert!(parts.contains(&Some(PipelinePart::Normals)) && parts.last() == Some(&None), "{parts:?}");
        assert!(found.savings.iter().all(|saving| saving.same_picture && saving.draws > 0));
        assert!(
            found.needed.contains(&PipelinePart::Vertices) && !found.needed.contains(&PipelinePart::Normals),
            "{:?}",
            found.needed
        );
        assert_eq!(found.planning_ms.n, 3);
        cancel.store(true, Ordering::Relaxed);
        assert!(savings(inputs, 3, &|_| {}, &cancel).is_none());
    }
}
