//! Report on the pipeline parts that each draw of a frame runs or skips, with reasons. Draws with equal plans are
//! grouped.

use serde::Serialize;

use crate::chain::whole::{FramePart, rasterized_pixels};
use crate::chain::{KeepDepth, Recipe, ViewChange};
use crate::pipeline::plan::{CullStats, DrawPlan, PipelinePart, PlanStep};
use crate::pipeline::viewport::Viewport;
use crate::scene::{Scene, Transparency};

/// State of one pipeline part: whether it runs in a frame and, if not, why it is skipped.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct PlanEntry<P = PipelinePart> {
    /// Pipeline part, of a draw or of the whole frame.
    pub(crate) part: P,
    /// Whether the part runs in this frame.
    pub(crate) runs: bool,
    /// Reason why the part is skipped; `None` if it runs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) reason: Option<&'static str>,
}

/// Group of draws of a frame with equal plans: the same pipeline parts run, and the others are skipped for the same
/// reasons.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct DrawGroup {
    /// Number of draws in the group.
    pub(crate) draws: usize,
    /// Names of the instances, in scene order.
    pub(crate) names: Vec<String>,
    /// Transparency mode, which determines how the draws combine with what was drawn before.
    pub(crate) transparency: Transparency,
    /// Numbers of culled clusters by reason, and the number of all clusters, each summed over the draws with cluster
    /// culling.
    pub(crate) clusters: CullStats,
    /// State of all pipeline parts in these draws, in pipeline order.
    pub(crate) parts: Vec<PlanEntry>,
}

/// Pipeline parts of a frame that do not belong to any draw, and its numbers of rasterized pixels and of all pixels.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct WholeFrame {
    /// Number of pixels that are rasterized.
    pub(crate) rasterized_pixels: u64,
    /// Number of pixels in the finished image.
    pub(crate) pixels: u64,
    /// State of all pipeline parts that do not belong to any draw, in pipeline order.
    pub(crate) parts: Vec<PlanEntry<FramePart>>,
}

/// Describes the pipeline parts of a frame that do not belong to any draw. Assumes that the frame is the first one, and
/// that its depth buffer is not read afterwards.
pub fn whole(scene: &Scene, recipe: &Recipe, viewport: Viewport) -> WholeFrame {
    WholeFrame {
        rasterized_pixels: rasterized_pixels(recipe, viewport),
        pixels: u64::from(viewport.width) * u64::from(viewport.height),
        parts: FramePart::ALL
            .map(|part| entry(part, part.step(scene, recipe, KeepDepth::No, ViewChange::First)))
            .into(),
    }
}

/// Formats the pipeline parts of a frame as text, with a line per part.
pub fn whole_text(whole: &WholeFrame) -> String {
    let WholeFrame { rasterized_pixels, pixels, parts } = whole;
    let share = *rasterized_pixels as f64 / *pixels as f64 * 100.0;
    let mut text = format!("The frame: {rasterized_pixels} of {pixels} pixels are rasterized, {share:.2} %\n");
    parts.iter().for_each(|PlanEntry { part, reason, .. }| text.push_str(&line(part.name(), *reason)));
    text
}

/// Groups the draws of a scene by draw plan. Groups are in the order of their first draws. `plans` holds one plan per
/// instance.
pub fn groups(scene: &Scene, plans: &[DrawPlan]) -> Vec<DrawGroup> {
    let mut found: Vec<(Vec<DrawPlan>, Vec<String>)> = Vec::new();
    for (instance, plan) in scene.instances.iter().zip(plans) {
        match found.iter_mut().find(|(known, _)| known[0].agrees_with(plan)) {
            Some((known, names)) => {
                known.push(*plan);
                names.push(instance.name.clone());
            }
            None => found.push((vec![*plan], vec![instance.name.clone()])),
        }
    }
    found.into_iter().map(|(plans, names)| group(&plans, names)).collect()
}

fn group(plans: &[DrawPlan], names: Vec<String>) -> DrawGroup {
    let plan = &plans[0];
    let parts = PipelinePart::ALL.map(|part| entry(part, plan.step(part))).into();
    DrawGroup { draws: names.len(), names, transparency: plan.transparency(), clusters: CullStats::of(plans), parts }
}

fn entry<P>(part: P, step: PlanStep) -> PlanEntry<P> {
    PlanEntry { part, runs: step.runs(), reason: step.reason() }
}

/// Maximum number of names listed in full; a longer list shows only its first few names and its last.
const MAX_LISTED_NAMES: usize = 4;

/// Formats a group as text: the names of its draws, then a line per pipeline part.
pub fn text(group: &DrawGroup) -> String {
    let draws = if group.draws == 1 { "draw" } else { "draws" };
    let mut text = format!("{} {draws}: {}\n", group.draws, listed_names(&group.names));
    for PlanEntry { part, reason, .. } in &group.parts {
        let counted =
            (*part == PipelinePart::EveryCluster && group.clusters.culled() > 0).then(|| group.clusters.describe());
        text.push_str(&line(part.name(), counted.as_deref().or(*reason)));
    }
    text
}

/// Formats a pipeline part and its state, run or skipped, as a line of text.
fn line(name: &str, reason: Option<&str>) -> String {
    let state = reason.map_or("run".to_owned(), |reason| format!("skipped: {reason}"));
    format!("  {name:21} {state}\n")
}

fn listed_names(names: &[String]) -> String {
    match names {
        [first @ .., last] if names.len() > MAX_LISTED_NAMES => {
            format!("{}, … {last}", first[..MAX_LISTED_NAMES - 1].join(", "))
        }
        _ => names.join(", "),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::{Recipe, run};
    use crate::pipeline::viewport::Viewport;
    use crate::scene::builtin;

    fn of(id: &str) -> Vec<DrawGroup> {
        let scene = builtin::by_id(id).unwrap().build();
        let frame = run(&scene, &scene.home, &Recipe::default(), Viewport { width: 64, height: 48 }, &mut ());
        groups(&scene, &frame.geometry().plans)
    }

    #[test]
    fn draws_with_equal_plans_are_grouped_and_none_is_listed_twice() {
        let groups = of("stained-glass");
        let names: Vec<_> = groups.iter().flat_map(|g| g.names.iter().map(String::as_str)).collect();
        assert_eq!(names.len(), builtin::by_id("stained-glass").unwrap().build().instances.len());
        let of = |name: &str| groups.iter().find(|g| g.names.iter().any(|n| n == name)).unwrap();
        assert_eq!(of("leaf 0"), of("leaf 21"));
        assert_eq!(of("red pane"), of("blue pane"));
        assert_eq!(of("red pane").transparency, Transparency::Blended);
        assert_ne!(of("red pane"), of("bottle"), "one has a texture");
        for (i, a) in groups.iter().enumerate() {
            assert!(groups[..i].iter().all(|b| (&a.parts, a.transparency) != (&b.parts, b.transparency)));
        }
    }

    #[test]
    fn the_frame_lists_its_skipped_parts() {
        let scene = builtin::by_id("triangle").unwrap().build();
        let mut recipe = Recipe::default();
        recipe.set_all(&["upscaler.method=nearest", "upscaler.scale=4"]).unwrap();
        let reported = whole_text(&whole(&scene, &recipe, Viewport { width: 64, height: 48 }));
        assert!(reported.starts_with("The frame: 192 of 3072 pixels are rasterized, 6.25 %\n"), "{reported}");
        assert!(reported.contains("  Every pixel           skipped: the upscaler reads fewer"), "{reported}");
        assert!(reported.contains("  Upscaling             run\n"), "{reported}");
        assert_eq!(reported.lines().count(), 1 + FramePart::ALL.len());
    }

    #[test]
    fn a_group_lists_every_part_and_a_few_names() {
        let [all] = &of("triangle")[..] else { panic!("one mesh") };
        assert!(text(all).starts_with("1 draw: "), "{}", text(all));
        let cubes = of("cubes");
        let most = cubes.iter().max_by_key(|g| g.draws).unwrap();
        let reported = text(most);
        assert!(reported.starts_with(&format!("{} draws: ", most.draws)) && reported.contains(", … "), "{reported}");
        assert_eq!(reported.lines().count(), 1 + PipelinePart::ALL.len());
        assert!(
            reported.contains("  Alpha test            skipped: no texture that is read has alpha\n"),
            "{reported}"
        );
        assert!(reported.contains("  Depth buffer          run\n"), "{reported}");
    }
}
