//! Checks that replays equal the frame: under every setting, the replay of every pixel gives its colour and depth, bit
//! for bit, and its list of fragments agrees with the buffers.

use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;

use crate::internal::common::{DEPTH_BIASES, recipe, render, scenes};
use crate::internal::switches::{finishing_switches, single_switches};
use rasterscope::antialias::settings::{AntialiasMethod, PostFilterKind as PostChoice};
use rasterscope::chain::{Frame, Recipe};
use rasterscope::inspect::buffers::Buffers;
use rasterscope::inspect::{FragmentRecord, PixelReport, capture, inspect};
use rasterscope::pipeline::settings::{
    Arithmetic, BlendingOrder, Choice, ColorSpace, Culling, DepthBias, DepthFormat, DepthTest, FillRule, Interpolation,
    Rasterizer, Settings,
};
use rasterscope::scene::{Scene, Transparency, TriangleId, builtin};
use rasterscope::upscale::{Anchor, Upscaling};

/// Size of the pictures, odd so that blocks and squares do not divide it.
const SIZE: (u32, u32) = (31, 23);

/// Size of the pictures for long lists of recipes, smaller than [`SIZE`].
const SIZE_OF_MANY: (u32, u32) = (15, 11);

/// Returns a recipe for every rasterizer × arithmetic. The culling mode varies: each occurs with every rasterizer and
/// with every arithmetic. `tests/internal/trace.rs` combines all three.
fn ways_of_covering() -> Vec<Recipe> {
    let recipes = cross::<Rasterizer>(&[Recipe::default()], |r, c| r.pipeline.rasterizer = c);
    let mut recipes = cross::<Arithmetic>(&recipes, |r, c| r.pipeline.arithmetic = c);
    for (index, recipe) in recipes.iter_mut().enumerate() {
        let turn = index / Arithmetic::ALL.len() + index % Arithmetic::ALL.len();
        recipe.pipeline.culling = Culling::ALL[turn % Culling::ALL.len()];
    }
    recipes
}

/// Returns each recipe combined with every value of a setting.
fn cross<C: Choice>(recipes: &[Recipe], set: fn(&mut Recipe, C)) -> Vec<Recipe> {
    let with = |recipe: &Recipe, choice: C| {
        let mut recipe = *recipe;
        set(&mut recipe, choice);
        recipe
    };
    recipes.iter().flat_map(|recipe| C::ALL.iter().map(move |choice| with(recipe, *choice))).collect()
}

/// Returns a recipe for every fill rule × depth test × depth format, without culling, so that more fragments cover each
/// pixel.
///
/// The interpolation, which affects visibility only through alpha, varies: each occurs with every combination of two of
/// these settings.
fn combined_switches() -> Vec<Recipe> {
    let mut recipes = vec![Recipe::default()];
    recipes[0].pipeline.culling = Culling::None;
    recipes = cross::<FillRule>(&recipes, |r, c| r.pipeline.fill_rule = c);
    recipes = cross::<DepthTest>(&recipes, |r, c| r.pipeline.depth_test = c);
    recipes = cross::<DepthFormat>(&recipes, |r, c| r.pipeline.depth_format = c);
    let (tests, formats) = (DepthTest::ALL.len(), DepthFormat::ALL.len());
    for (index, recipe) in recipes.iter_mut().enumerate() {
        let turn = index % formats + index / formats % tests + index / (formats * tests);
        recipe.pipeline.interpolation = Interpolation::ALL[turn % Interpolation::ALL.len()];
    }
    recipes
}

/// Returns a recipe for every depth bias × depth format, without culling. Depth test and arithmetic vary.
fn depth_biases() -> Vec<Recipe> {
    let mut recipe = Recipe::default();
    recipe.pipeline.culling = Culling::None;
    let recipes = cross::<DepthFormat>(&[recipe], |r, c| r.pipeline.depth_format = c);
    let biased = recipes.iter().flat_map(|recipe| DEPTH_BIASES.map(|bias| (recipe, bias)));
    let with = |(turn, (recipe, depth_bias)): (usize, (&Recipe, DepthBias))| {
        let mut recipe = Recipe { pipeline: Settings { depth_bias, ..recipe.pipeline }, ..*recipe };
        recipe.pipeline.depth_test = DepthTest::ALL[turn % DepthTest::ALL.len()];
        recipe.pipeline.arithmetic = Arithmetic::ALL[turn / 2 % Arithmetic::ALL.len()];
        recipe
    };
    biased.enumerate().map(with).collect()
}

/// Returns a recipe for every upscaler × scale, and for every upscaler with a wireframe.
fn upscalers() -> Vec<Recipe> {
    let plain = Upscaling::every().map(|upscaler| Recipe { upscaler, ..Recipe::default() });
    plain.chain(upscalers_at_their_first_scale(true)).collect()
}

/// Returns [`finishing_switches`], and recipes for every anti-aliasing method and post filter with and without an upscaler.
fn smooth() -> Vec<Recipe> {
    let plain = Recipe::default();
    let enlarged = Recipe { upscaler: Upscaling::new("bilinear", 3).unwrap(), ..plain };
    let shifted = Recipe { upscaler: enlarged.upscaler.with_anchor(Anchor::Centre), ..plain };
    let recipes = cross::<AntialiasMethod>(&[plain, enlarged, shifted], |r, c| r.antialias.method = c);
    let bytes = cross::<ColorSpace>(&[plain], |r, c| {
        (r.antialias.method, r.antialias.light) = (AntialiasMethod::RotatedGrid, c);
    });
    let filters = cross::<PostChoice>(&[plain, enlarged], |r, c| (r.post.filter, r.post.strength) = (c, 1.5));
    finishing_switches().into_iter().chain(recipes).chain(bytes).chain(filters).collect()
}

/// Returns a recipe for every upscaler at the first scale that it offers.
fn upscalers_at_their_first_scale(wireframe: bool) -> impl Iterator<Item = Recipe> {
    let mut methods: Vec<Upscaling> = Upscaling::every().collect();
    methods.dedup_by_key(|upscaling| upscaling.method());
    methods.into_iter().map(move |upscaler| Recipe { upscaler, wireframe, ..Recipe::default() })
}

/// Replays every pixel of every scene under every recipe, and prints the number of comparisons.
#[expect(clippy::print_stderr, reason = "prints how much was compared")]
fn replay_all(scenes: &[(&str, Scene)], recipes: &[Recipe], size: (u32, u32)) {
    let compared = AtomicU64::new(0);
    thread::scope(|scope| {
        for (name, scene) in scenes {
            let compared = &compared;
            scope.spawn(move || {
                for recipe in recipes {
                    compared.fetch_add(replay_frame(name, scene, recipe, size), Ordering::Relaxed);
                }
            });
        }
    });
    let (pixels, scenes, recipes) = (compared.into_inner(), scenes.len(), recipes.len());
    eprintln!("{pixels} pixels replayed over {scenes} scenes × {recipes} recipes: all equal");
}

fn replay_frame(name: &str, scene: &Scene, recipe: &Recipe, (width, height): (u32, u32)) -> u64 {
    let frame = render(scene, recipe, (width, height));
    let buffers = capture(scene, recipe, &frame);
    for y in 0..height {
        for x in 0..width {
            let report = inspect(scene, recipe, &frame, x, y).expect("inside of the picture");
            assert_eq!(report.color, frame.image().at(x, y), "{name} ({x}, {y}) {recipe:?}\n{report:#?}");
            check_against_buffers(&report, &frame, &buffers);
        }
    }
    u64::from(width) * u64::from(height)
}

/// Checks that a report agrees with the buffers at the drawn pixel that it describes.
fn check_against_buffers(report: &PixelReport, frame: &Frame, buffers: &Buffers) {
    let [x, y] = report.drawn_at;
    let (column, row) = frame.drawn.grid.sample_at(x, y).expect("reports describe drawn pixels");
    let stored = frame.drawn.depth.as_ref().map(|d| d.at(column, row));
    assert_eq!(report.final_depth.map(|d| d.value), stored);
    assert_eq!(report.fragments.len(), buffers.overdraw.at(column, row) as usize);
    let shaded = report.fragments.iter().filter(|f| f.shading.is_some()).count();
    assert_eq!(shaded, buffers.shaded.at(column, row) as usize);
    let winner = buffers.triangle.at(column, row);
    match report.visible() {
        None => assert_eq!(winner, TriangleId::NONE),
        Some(visible) => {
            assert_eq!(visible.triangle, winner);
            assert_eq!(visible.affine_weights, buffers.lambda.at(column, row));
            // Compared bit for bit, because published weights may be NaN.
            let bits = |weights: [f32; 3]| weights.map(f32::to_bits);
            assert_eq!(bits(visible.attribute_weights), bits(buffers.perspective_lambda.at(column, row)));
            if frame.antialias.is_off() {
                assert_eq!(visible.shading.as_ref().map(|s| s.color), Some(frame.drawn.color.at(column, row)));
            }
            assert_eq!(frame.geometry().triangles[visible.submission].id, visible.triangle);
        }
    }
    // Blended fragments write no depth.
    let stores = |f: &&FragmentRecord| f.outcome.is_written() && f.transparency != Transparency::Blended;
    let last = report.fragments.iter().rfind(stores).map_or(frame.drawn.clear_depth, |f| f.depth.value);
    assert!(stored.is_none_or(|d| d == last));
    assert_eq!(buffers.depth_stored.at(column, row), stored.is_some() && report.fragments.iter().any(|f| stores(&f)));
    let mut submissions: Vec<_> = report.fragments.iter().map(|f| f.submission).collect();
    if frame.geometry().blending.order == BlendingOrder::Exact {
        let blended = report.fragments.iter().filter(|f| f.transparency == Transparency::Blended);
        let written = blended.filter(|f| f.outcome.is_written()).map(|f| f.depth.value);
        assert!(written.is_sorted_by(|a, b| a >= b), "from far to near");
        submissions.sort_unstable();
    }
    assert!(submissions.is_sorted_by(|a, b| a < b), "in drawing order, each once");
    let weight: f32 = report.sources.iter().map(|s| s.tap.weight).sum();
    assert!((weight - 1.0).abs() < 1e-5, "weights of the sources sum to {weight}");
}

#[test]
fn every_pixel_replays_to_the_frame_under_every_switch() {
    let on_background = recipe(&["background=#204060", "blending.order=exact"]);
    let recipes = single_switches().into_iter().chain([on_background]).collect::<Vec<_>>();
    replay_all(&scenes(), &recipes, SIZE);
}

#[test]
fn every_pixel_replays_to_the_frame_under_all_combinations_of_visibility_rules() {
    let recipes = combined_switches();
    assert_eq!(recipes.len(), FillRule::ALL.len() * DepthTest::ALL.len() * DepthFormat::ALL.len());
    replay_all(&scenes(), &recipes, SIZE_OF_MANY);
}

#[test]
fn every_pixel_replays_to_the_frame_under_every_depth_bias() {
    replay_all(&scenes(), &depth_biases(), SIZE);
}

#[test]
fn every_pixel_replays_to_the_frame_under_every_rasterizer_and_arithmetic() {
    replay_all(&scenes(), &ways_of_covering(), SIZE);
}

#[test]
fn every_pixel_replays_to_the_frame_under_every_upscaler() {
    replay_all(&scenes(), &upscalers(), SIZE);
}

#[test]
fn every_pixel_replays_to_the_frame_under_every_switch_after_shading() {
    replay_all(&scenes(), &smooth(), (11, 7));
}

#[test]
fn every_pixel_of_every_builtin_scene_replays_to_the_frame_under_every_upscaler() {
    let scenes: Vec<_> = builtin::ALL.iter().map(|b| (b.id, b.build())).collect();
    let recipes: Vec<_> = upscalers_at_their_first_scale(false).collect();
    replay_all(&scenes, &recipes, (9, 7));
}

#[test]
fn there_is_no_report_outside_of_the_picture() {
    let (_, scene) = &scenes()[0];
    let recipe = Recipe::default();
    let frame = render(scene, &recipe, SIZE);
    for (x, y) in [(SIZE.0, 0), (0, SIZE.1), (u32::MAX, u32::MAX)] {
        assert_eq!(inspect(scene, &recipe, &frame, x, y), None);
    }
}
