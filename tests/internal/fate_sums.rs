//! Checks that every input triangle and every generated fragment ends in exactly one bin, in every built-in scene and
//! every model, from outside and inside, with every culling mode, depth test and depth format; in the built-in scenes also
//! with every value of every other setting.
//!
//! The expected sums do not come from the bins: triangles are counted in the scene's meshes, fragments and rejections
//! by an observer while the frame is drawn.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use crate::internal::samples;
use crate::internal::switches::{distinct, finishing_switches, single_switches};
use rasterscope::chain::{Recipe, run};
use rasterscope::inspect::Fates;
use rasterscope::inspect::fates::TriangleFate;
use rasterscope::pipeline::observe::{Counters, Fate};
use rasterscope::pipeline::settings::{Choice, Culling, DepthFormat, DepthTest};
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::scene::{Camera, Scene, builtin, obj};
use rayon::prelude::*;

/// Size of the pictures, odd to test incomplete blocks.
const SIZE: Viewport = Viewport { width: 33, height: 23 };

/// Number of triangles above which a scene is tested with fewer recipes.
const MANY_TRIANGLES: usize = 3_000;

/// Number of scenes that are drawn with each value of a setting.
const SCENES_PER_SWITCH: usize = 3;

/// Returns a recipe for each combination of culling mode, depth test and depth format.
fn all_recipes() -> Vec<Recipe> {
    let mut recipes = Vec::new();
    for culling in Culling::ALL {
        for test in DepthTest::ALL {
            for format in DepthFormat::ALL {
                let mut recipe = Recipe::default();
                (recipe.pipeline.culling, recipe.pipeline.depth_test) = (*culling, *test);
                recipe.pipeline.depth_format = *format;
                recipes.push(recipe);
            }
        }
    }
    recipes
}

/// Returns a few recipes in which every culling mode, depth test and depth format occurs.
fn few_recipes() -> Vec<Recipe> {
    let longest = Culling::ALL.len().max(DepthTest::ALL.len()).max(DepthFormat::ALL.len());
    (0..longest)
        .map(|row| {
            let mut recipe = Recipe::default();
            recipe.pipeline.culling = Culling::ALL[row % Culling::ALL.len()];
            recipe.pipeline.depth_test = DepthTest::ALL[row % DepthTest::ALL.len()];
            recipe.pipeline.depth_format = DepthFormat::ALL[row % DepthFormat::ALL.len()];
            recipe
        })
        .collect()
}

/// Returns the recipes of all settings.
fn switches() -> Vec<Recipe> {
    distinct(single_switches().into_iter().chain(finishing_switches()))
}

/// Returns the home view, a view so close that many triangles are clipped or behind the eye, and an orthographic view.
fn views(scene: &Scene) -> [Camera; 3] {
    let mut inside = scene.home;
    inside.dolly(0.15);
    [scene.home, inside, scene.home.with_orthographic(true)]
}

/// Counts of triangles by fate, fragments and clipped triangles over all checked frames.
#[derive(Default)]
struct Met {
    triangles: [AtomicU64; TriangleFate::ALL.len()],
    fragments: AtomicU64,
    cut: AtomicU64,
}

fn check(scene: &Scene, recipe: &Recipe, met: &Met) {
    for camera in views(scene) {
        let mut counters = Counters::default();
        let frame = run(scene, &camera, recipe, SIZE, &mut counters);
        let fates = Fates::of(scene, recipe, &frame);
        let (triangles, fragments) = (fates.triangle_counts(), fates.fragment_counts());
        let reported = format!("{} {camera:?} {recipe:?}", scene.name);
        let in_meshes = scene.instances.iter().map(|instance| scene.library.mesh(instance.mesh).triangles.len());
        assert_eq!(triangles.sum(), in_meshes.sum::<usize>() as u64, "{reported}");
        assert_eq!(triangles.of(TriangleFate::Unaccounted), 0, "{reported}");
        for fate in Fate::ALL {
            assert_eq!(triangles.of(fate.into()), counters.fate(fate), "{reported} {fate:?}");
        }
        assert_eq!(fragments.sum(), counters.covered, "{reported}");
        assert_eq!(fates.account.complaints(), [""; 0], "{reported}");
        for fate in TriangleFate::ALL {
            met.triangles[*fate as usize].fetch_add(triangles.of(*fate), Ordering::Relaxed);
        }
        met.fragments.fetch_add(fragments.sum(), Ordering::Relaxed);
        met.cut.fetch_add(counters.clipped, Ordering::Relaxed);
    }
}

/// Returns each scene with every combination, or with a few recipes if it has many triangles.
fn combinations(scenes: &[Scene]) -> Vec<(&Scene, Recipe)> {
    let recipes = |scene: &Scene| if scene.triangle_count() > MANY_TRIANGLES { few_recipes() } else { all_recipes() };
    scenes.iter().flat_map(|scene| recipes(scene).into_iter().map(move |recipe| (scene, recipe))).collect()
}

#[expect(clippy::print_stderr, reason = "prints how much was counted")]
fn check_all(cases: &[(&Scene, Recipe)]) -> Met {
    let met = Met::default();
    cases.par_iter().for_each(|(scene, recipe)| check(scene, recipe, &met));
    let triangles: u64 = met.triangles.iter().map(|count| count.load(Ordering::Relaxed)).sum();
    eprintln!(
        "{} frames: {triangles} triangles, {} of them cut, and {} fragments, each in one bin",
        3 * cases.len(),
        met.cut.load(Ordering::Relaxed),
        met.fragments.load(Ordering::Relaxed)
    );
    met
}

#[test]
fn sums_match_in_every_builtin_scene() {
    let scenes: Vec<_> = builtin::ALL.iter().map(builtin::Builtin::build).collect();
    let met = check_all(&combinations(&scenes));
    // No scene has corners that are not finite, and within the guard band no triangle is clipped away completely.
    let never = [TriangleFate::Unaccounted, TriangleFate::NotFinite, TriangleFate::ClippedAway];
    for fate in TriangleFate::ALL.iter().filter(|fate| !never.contains(fate)) {
        assert!(met.triangles[*fate as usize].load(Ordering::Relaxed) > 0, "no triangle has the fate {fate:?}");
    }
    assert!(met.cut.into_inner() > 0);
}

#[test]
fn sums_match_under_every_switch() {
    let scenes: Vec<_> = builtin::ALL.iter().map(builtin::Builtin::build).collect();
    let small: Vec<_> = scenes.iter().filter(|scene| scene.triangle_count() <= MANY_TRIANGLES).collect();
    // Every setting meets several scenes, and every scene several settings.
    let turns = switches()
        .into_iter()
        .enumerate()
        .flat_map(|(turn, recipe)| (0..SCENES_PER_SWITCH).map(move |step| (turn * SCENES_PER_SWITCH + step, recipe)));
    let cases: Vec<_> = turns.map(|(turn, recipe)| (small[turn % small.len()], recipe)).collect();
    assert!(check_all(&cases).fragments.into_inner() > 0);
}

/// Returns the models in a folder and in the folders below it.
fn model_files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let paths = entries.map(|entry| entry.expect("a readable folder").path());
    let (folders, files): (Vec<_>, Vec<_>) = paths.partition(|path| path.is_dir());
    let is_model = |path: &PathBuf| path.extension().is_some_and(|extension| extension == "obj");
    let below = folders.iter().flat_map(|folder| model_files(folder));
    files.into_iter().filter(is_model).chain(below).collect()
}

#[test]
fn sums_match_in_every_model() {
    let own = Some((samples::own(), 21));
    let external = samples::external().map(|folder| (folder, 31));
    for (folder, least) in own.into_iter().chain(external) {
        let files = model_files(&folder.join("models"));
        // Models of points and lines only, and files that are no models, cannot be loaded; other tests cover that.
        let scenes: Vec<_> = files.par_iter().filter_map(|path| Some(obj::load(path).ok()?.scene)).collect();
        assert!(scenes.len() >= least, "{} of {} files", scenes.len(), files.len());
        let met = check_all(&combinations(&scenes));
        assert!(met.cut.into_inner() > 0);
    }
}
