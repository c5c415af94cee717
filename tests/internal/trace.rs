//! Checks that replays and traces of pixels agree bit for bit with the picture and the depth buffer of the frame, under
//! every setting and in both executions.
//!
//! Coverage: every pixel of three scenes (geometry behind the eye, coinciding surfaces, panes and alpha test), each
//! frame in classic execution, and in tiled execution where possible:
//! - Replays: every rasterizer with every row of a pairwise covering array of the pipeline's settings, in which any two
//!   values of any two settings occur together at least once; also every anti-aliasing method, kind of upscaler and post
//!   filter.
//! - Traces, which repeat all arithmetic in exact numbers and take a hundred times as long: the same rows and the same
//!   steps after the pipeline on smaller pictures, each row with one rasterizer, all of them in turn.

use std::collections::BTreeSet;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::internal::common::{coplanar_scene, ground_and_cube, recipe, transparency_scene};
use crate::internal::switches::assignments_of;
use rasterscope::antialias::settings::{AntialiasMethod, PostFilterKind as PostChoice};
use rasterscope::chain::{Frame, KeepDepth, Recipe, RenderInputs, Renderer, SettingKey, SettingStage, execution};
use rasterscope::image::Rgba8;
use rasterscope::inspect::trace::TraceLine;
use rasterscope::inspect::{PixelReport, Trace, inspect};
use rasterscope::pipeline::settings::{Choice, ColorSpace, Execution, Rasterizer};
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::scene::{Scene, Transparency};
use rasterscope::upscale::Upscaling;
use rayon::prelude::*;

/// Size of the pictures, odd to test incomplete blocks.
const SIZE: Viewport = Viewport { width: 17, height: 13 };

/// Size of the pictures for long lists of recipes, smaller than [`SIZE`].
const SIZE_OF_MANY: Viewport = Viewport { width: 9, height: 5 };

/// Size of the traced pictures, small because tracing is slow.
const SIZE_TRACED: Viewport = Viewport { width: 6, height: 5 };

/// Names of the colour channels in the lines of a trace.
const CHANNELS: [&str; 3] = ["red", "green", "blue"];

fn scenes() -> [(&'static str, Arc<Scene>); 3] {
    [
        ("ground and cube", Arc::new(ground_and_cube())),
        ("coplanar", Arc::new(coplanar_scene())),
        ("transparency", Arc::new(transparency_scene())),
    ]
}

/// Returns whether a setting belongs to the pipeline and may change replays. The rasterizer is combined with all rows;
/// both executions are always compared; the wireframe is drawn after the pipeline.
fn is_factor(key: SettingKey) -> bool {
    let apart = [SettingKey::Execution, SettingKey::Rasterizer, SettingKey::Wireframe];
    key.stage() != SettingStage::Upscale && !apart.contains(&key)
}

/// Returns the values of each of the pipeline's settings except the rasterizer, which is combined with all of them.
fn factors() -> Vec<Vec<String>> {
    SettingKey::ALL.iter().copied().filter(|key| is_factor(*key)).map(assignments_of).collect()
}

/// Values of two different factors (settings), each as indices of factor and value.
type Pair = [(usize, usize); 2];

/// Returns all pairs of values of two different factors.
fn all_pairs(factors: &[Vec<String>]) -> BTreeSet<Pair> {
    let value = |factor: usize| (0..factors[factor].len()).map(move |value| (factor, value));
    let firsts = (0..factors.len()).flat_map(value);
    firsts.flat_map(|a| (a.0 + 1..factors.len()).flat_map(value).map(move |b| [a, b])).collect()
}

/// Returns rows with one value per factor, which together contain all pairs. Each row starts with a missing pair and
/// takes, factor by factor, the value that covers most of the missing pairs (after D. M. Cohen and others, "The AETG
/// System", 1997).
fn rows_of_all_pairs(factors: &[Vec<String>]) -> Vec<Vec<usize>> {
    let mut missing = all_pairs(factors);
    let mut rows = Vec::new();
    while let Some([a, b]) = missing.first().copied() {
        let mut row = vec![None; factors.len()];
        (row[a.0], row[b.0]) = (Some(a.1), Some(b.1));
        for factor in 0..factors.len() {
            let made_by = |value: usize| {
                let with = |(other, chosen): (usize, &Option<usize>)| {
                    let (x, y) = ((factor, value), (other, (*chosen)?));
                    missing.contains(&if x < y { [x, y] } else { [y, x] }).then_some(())
                };
                row.iter().enumerate().filter_map(with).count()
            };
            // Ties are broken differently in each row.
            let turned = |value: usize| (value + rows.len()) % factors[factor].len();
            let best = (0..factors[factor].len()).map(turned).max_by_key(|value| made_by(*value));
            row[factor] = row[factor].or(best);
        }
        let row: Vec<usize> = row.into_iter().flatten().collect();
        let is_made = |[a, b]: &Pair| row[a.0] == a.1 && row[b.0] == b.1;
        missing.retain(|pair| !is_made(pair));
        rows.push(row);
    }
    rows
}

/// Returns a recipe for each row of the covering array.
fn pipelines() -> Vec<Recipe> {
    let factors = factors();
    let of_row = |row: &Vec<usize>| {
        let assignments: Vec<&str> = row.iter().zip(&factors).map(|(value, all)| all[*value].as_str()).collect();
        recipe(&assignments)
    };
    rows_of_all_pairs(&factors).iter().map(of_row).collect()
}

/// Returns each recipe combined with every rasterizer.
fn by_every_rasterizer(recipes: &[Recipe]) -> Vec<Recipe> {
    let with = |recipe: &Recipe, rasterizer| {
        let mut recipe = *recipe;
        recipe.pipeline.rasterizer = rasterizer;
        recipe
    };
    recipes.iter().flat_map(|recipe| Rasterizer::ALL.iter().map(|rasterizer| with(recipe, *rasterizer))).collect()
}

/// Returns the recipes, each with one rasterizer; all rasterizers take turns.
fn by_rasterizers_in_turn(mut recipes: Vec<Recipe>) -> Vec<Recipe> {
    for (recipe, rasterizer) in recipes.iter_mut().zip(Rasterizer::ALL.iter().cycle()) {
        recipe.pipeline.rasterizer = *rasterizer;
    }
    recipes
}

/// Returns recipes that vary the steps after the pipeline: each anti-aliasing method in both colour spaces, each
/// upscaler at its first scale, each post filter, and the wireframe.
fn ways_to_finish() -> Vec<Recipe> {
    let mut methods: Vec<Upscaling> = Upscaling::every().collect();
    methods.dedup_by_key(|upscaling| upscaling.method());
    let smooth = AntialiasMethod::ALL.iter().flat_map(|method| {
        ColorSpace::ALL.iter().map(move |light| {
            let mut recipe = Recipe::default();
            (recipe.antialias.method, recipe.antialias.light) = (*method, *light);
            recipe
        })
    });
    let upscaled = methods.into_iter().map(|upscaler| Recipe { upscaler, ..Recipe::default() });
    let filtered = PostChoice::ALL.iter().map(|filter| {
        let mut recipe = Recipe::default();
        (recipe.post.filter, recipe.post.strength) = (*filter, 1.5);
        recipe
    });
    smooth.chain(upscaled).chain(filtered).chain([Recipe { wireframe: true, ..Recipe::default() }]).collect()
}

/// Returns the frame in classic execution, and in tiled execution if the recipe supports that, each with its recipe.
fn frames(scene: &Arc<Scene>, recipe: &Recipe, size: Viewport) -> Vec<(Recipe, Frame)> {
    let ways = Execution::ALL.iter().map(|execution| Recipe { execution: *execution, ..*recipe });
    let ways = ways.filter(|recipe| execution(scene, recipe).0 == recipe.execution);
    ways.map(|recipe| {
        let frame = Renderer::default()
            .render(RenderInputs { scene, camera: &scene.home, recipe: &recipe, viewport: size }, KeepDepth::Yes);
        assert_eq!(frame.execution, recipe.execution);
        (recipe, frame)
    })
    .collect()
}

/// Numbers of compared frames, pixels, colours and depths.
#[derive(Default)]
struct Compared {
    frames: [AtomicUsize; Execution::ALL.len()],
    pixels: AtomicUsize,
    colors: AtomicUsize,
    depths: AtomicUsize,
}

/// Whether traces are compared as well.
#[derive(Clone, Copy, PartialEq)]
enum Traces {
    Written,
    Skipped,
}

/// Compares replays, and traces if wanted, with all pixels of all frames, and prints the numbers of comparisons.
#[expect(clippy::print_stderr, reason = "prints how much was compared")]
fn compare_all(recipes: &[Recipe], size: Viewport, traces: Traces) {
    let compared = Compared::default();
    let scenes = scenes();
    let cases: Vec<_> = scenes.iter().flat_map(|scene| recipes.iter().map(move |recipe| (scene, recipe))).collect();
    cases.par_iter().for_each(|((name, scene), recipe)| {
        for (recipe, frame) in frames(scene, recipe, size) {
            compared.frames[recipe.execution as usize].fetch_add(1, Ordering::Relaxed);
            for (x, y) in (0..size.height).flat_map(|y| (0..size.width).map(move |x| (x, y))) {
                let reported = || format!("{name} ({x}, {y}) {recipe:?}");
                let report = inspect(scene, &recipe, &frame, x, y).expect("inside of the picture");
                let drawn = CheckedFrame { scene, recipe: &recipe, frame: &frame };
                drawn.assert_equals_replay(&report, &reported);
                if traces == Traces::Written {
                    drawn.assert_equals_traces(&report, &compared, &reported);
                }
                compared.pixels.fetch_add(1, Ordering::Relaxed);
            }
        }
    });
    let [tiled, classic] = compared.frames.map(AtomicUsize::into_inner);
    let [pixels, colors, depths] = [compared.pixels, compared.colors, compared.depths].map(AtomicUsize::into_inner);
    eprintln!(
        "{} recipes × 3 scenes: {classic} frames by triangle and {tiled} by tile, {pixels} pixels replayed, {colors} \
         colours and {depths} depths written out: all equal",
        recipes.len()
    );
    assert_eq!(classic, 3 * recipes.len());
    assert!(tiled > 0);
    // Every pixel that shows a surface is traced; backgrounds and translucent surfaces leave no depth.
    assert!(traces == Traces::Skipped || colors > pixels / 4 && depths > pixels / 8, "{pixels} {colors} {depths}");
}

/// Returns the bits of the depth that the frame holds at the drawn pixel of a report.
fn stored(report: &PixelReport, frame: &Frame) -> Option<u32> {
    let [x, y] = report.drawn_at;
    let (column, row) = frame.drawn.grid.sample_at(x, y).expect("reports describe drawn pixels");
    frame.drawn.depth.as_ref().map(|depth| depth.at(column, row).to_bits())
}

/// Returns the codes of the three channels that a trace computes in the lines that `name` names.
fn codes(trace: &Trace, name: impl Fn(&str) -> String) -> Option<[u8; 3]> {
    let number = |name: String| trace.lines.iter().rfind(|line| line.what == name)?.number();
    let codes = CHANNELS.map(|channel| Some(number(name(channel))?.to_f64() as u8));
    Some([codes[0]?, codes[1]?, codes[2]?])
}

fn opaque([r, g, b, _]: Rgba8) -> [u8; 3] {
    [r, g, b]
}

/// Frame that is compared with its replays and traces.
struct CheckedFrame<'a> {
    scene: &'a Scene,
    recipe: &'a Recipe,
    frame: &'a Frame,
}

impl CheckedFrame<'_> {
    /// Checks that the final colour and the stored depth of a replay equal those of the frame.
    fn assert_equals_replay(&self, report: &PixelReport, reported: &impl Fn() -> String) {
        let frame = self.frame;
        assert_eq!(report.color, frame.image().at(report.x, report.y), "{}", reported());
        assert_eq!(report.final_depth.map(|depth| depth.value.to_bits()), stored(report, frame), "{}", reported());
    }

    /// Checks the results of traces: that of the last written fragment gives the drawn colour and the final pixel, and
    /// that of the last fragment that wrote depth gives the stored depth.
    fn assert_equals_traces(&self, report: &PixelReport, compared: &Compared, reported: &impl Fn() -> String) {
        let Self { scene, recipe, frame } = *self;
        let written = report.fragments.iter().rposition(|fragment| fragment.outcome.is_written());
        let stores = report.fragments.iter().rposition(|fragment| {
            fragment.outcome.is_written()
                && fragment.transparency != Transparency::Blended
                && fragment.stored_depth.is_some()
        });
        let [x, y] = report.drawn_at;
        let (column, row) = frame.drawn.grid.sample_at(x, y).expect("reports describe drawn pixels");
        let drawn = opaque(frame.drawn.color.at(column, row));
        let trace = Trace::of(scene, recipe, frame, report, written);
        let pixel = opaque(frame.image().at(report.x, report.y));
        assert_eq!(codes(&trace, |channel| format!("pixel {channel}")), Some(pixel), "{}", reported());
        if !frame.antialias.is_off() {
            assert_eq!(codes(&trace, |channel| format!("mean {channel}")), Some(drawn), "{}", reported());
            compared.colors.fetch_add(1, Ordering::Relaxed);
        } else if written.is_some() {
            assert_eq!(codes(&trace, |channel| format!("{channel} code")), Some(drawn), "{}", reported());
            compared.colors.fetch_add(1, Ordering::Relaxed);
        }
        let Some(stores) = stores else { return };
        let trace = if Some(stores) == written { trace } else { Trace::of(scene, recipe, frame, report, Some(stores)) };
        let line = trace.lines.iter().find(|line| line.what == "depth as stored");
        let depth = line.and_then(TraceLine::number).map(|number| (number.to_f64() as f32).to_bits());
        assert_eq!(depth, stored(report, frame), "{}", reported());
        compared.depths.fetch_add(1, Ordering::Relaxed);
    }
}

#[test]
fn any_two_values_of_any_two_settings_occur_together() {
    let factors = factors();
    let rows = rows_of_all_pairs(&factors);
    for [a, b] in all_pairs(&factors) {
        assert!(rows.iter().any(|row| row[a.0] == a.1 && row[b.0] == b.1), "{a:?} {b:?}");
    }
}

#[test]
fn every_replay_equals_the_frame_with_every_rasterizer_under_all_pairs_of_settings() {
    compare_all(&by_every_rasterizer(&pipelines()), SIZE_OF_MANY, Traces::Skipped);
}

#[test]
fn every_replay_equals_the_frame_under_all_settings_after_the_pipeline() {
    compare_all(&ways_to_finish(), SIZE, Traces::Skipped);
}

#[test]
fn every_trace_equals_the_frame_under_all_pairs_of_settings() {
    compare_all(&by_rasterizers_in_turn(pipelines()), SIZE_TRACED, Traces::Written);
}

#[test]
fn every_trace_equals_the_frame_under_all_settings_after_the_pipeline() {
    compare_all(&ways_to_finish(), SIZE_TRACED, Traces::Written);
}
