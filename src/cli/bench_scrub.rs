//! `rasterscope bench --scrub`: cost of stepping through the drawing of a frame.

use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::chain::run;
use crate::inspect::scrub::{BUDGET, Moment, Scrubber};
use crate::measure::timing::{Summary, summarize};
use crate::pipeline::viewport::Viewport;
use serde::Serialize;

use super::scene_args::RequestedView;

/// Cost of stepping through the drawing of one frame.
#[derive(Debug, Serialize)]
pub(crate) struct ScrubReport {
    scene: String,
    size: [u32; 2],
    triangles: usize,
    /// Time to prepare the frame for stepping, in milliseconds.
    preparing_ms: f64,
    /// Duration of the first complete drawing of the frame, which also copies the framebuffer at checkpoints, in
    /// milliseconds.
    first_walk_ms: f64,
    /// Number of framebuffer copies made by the first complete drawing.
    copies: usize,
    copy_bytes: usize,
    /// Name of each kind of step, with the time in milliseconds from the start of a step to the finished picture.
    steps: Vec<(&'static str, Summary)>,
}

/// Measures the durations of `count` steps of each kind, spread evenly over the frame.
pub(crate) fn measure(view: &RequestedView, viewport: Viewport, count: usize) -> ScrubReport {
    let RequestedView { scene, camera, recipe, .. } = view;
    let frame = run(scene, camera, recipe, viewport, &mut ());
    let begun = Instant::now();
    let mut scrubber = Scrubber::new(scene, recipe, &frame, BUDGET);
    let preparing = begun.elapsed();
    let triangles = scrubber.geometry().triangles.len();
    let mut show = |moment: Moment| {
        let begun = Instant::now();
        let drawn = scrubber.frame_at(moment);
        let shown = frame.at_moment(recipe, drawn, scrubber.geometry_at(moment));
        let picture = Arc::new(shown.image().clone());
        (begun.elapsed(), picture, scrubber.memory())
    };
    let (first_walk, _, (copies, copy_bytes)) = show(Moment::after(triangles));
    let mut times: Vec<(&str, Vec<Duration>)> =
        ["one triangle forward", "one triangle back", "one fragment forward", "jump"]
            .map(|kind| (kind, Vec::new()))
            .into();
    // Multiples of the golden ratio, modulo 1, spread evenly over the frame for any number of steps.
    const GOLDEN_SHARE: f64 = 0.618_033_988_749_895;
    for number in 0..count {
        let share = (number as f64 * GOLDEN_SHARE).fract();
        let place = 2 + (share * triangles.saturating_sub(4) as f64) as usize;
        let moments = [
            Moment::after(place),
            Moment::after(place + 1),
            Moment::after(place - 1),
            Moment { triangles: place, fragments: Some(1) },
        ];
        for (moment, kind) in moments.into_iter().zip([3, 0, 1, 2]) {
            times[kind].1.push(show(moment).0);
        }
    }
    let ms = |time: &Duration| time.as_secs_f64() * 1e3;
    let summary = |(kind, times): (&'static str, Vec<Duration>)| {
        Some((kind, summarize(&times.iter().map(ms).collect::<Vec<_>>())?))
    };
    ScrubReport {
        scene: scene.name.clone(),
        size: [viewport.width, viewport.height],
        triangles,
        preparing_ms: ms(&preparing),
        first_walk_ms: ms(&first_walk),
        copies,
        copy_bytes,
        steps: times.into_iter().filter_map(summary).collect(),
    }
}

/// Formats the report as text.
pub(crate) fn table(report: &ScrubReport) -> String {
    let ScrubReport { scene, size: [width, height], triangles, steps, .. } = report;
    let mut text = format!("{scene}, {width} × {height} px, {triangles} triangles rasterized\n\n");
    text += &format!(
        "{:24} {:10.3}\n{:24} {:10.3}\n",
        "preparation, ms", report.preparing_ms, "first pass, ms", report.first_walk_ms
    );
    text += &format!("{:24} {:10}, {:.1} MB\n\n", "copies", report.copies, report.copy_bytes as f64 / 1e6);
    text += &format!("{:24} {:>10} {:>10} {:>10} {:>10}\n", "milliseconds", "median", "p10", "p90", "per second");
    for (kind, ms) in steps {
        let rate = 1e3 / ms.median.max(1e-6);
        text += &format!("{kind:24} {:10.3} {:10.3} {:10.3} {rate:10.0}\n", ms.median, ms.p10, ms.p90);
    }
    text
}
