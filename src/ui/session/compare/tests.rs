use super::*;
use crate::chain::KeepDepth;
use crate::measure::shot::{CameraMotion, Shot, ShotInputs, ShotRenderer};
use crate::scene::SceneSource;
use crate::ui::session::command::Command;
use crate::ui::session::compare::compute::Comparer;
use crate::ui::session::scene_time::SceneTimeChange;
use crate::upscale::{self, Upscaling};

/// Comparison settings together with the session state that they change.
#[derive(Default)]
struct CompareBench {
    comparison: CompareState,
    tiles: TileSet,
    recipe: Recipe,
}

impl CompareBench {
    fn apply(&mut self, change: CompareChange) {
        self.comparison.apply(change, &mut self.tiles, &mut self.recipe);
    }

    fn recipes(&self) -> Vec<Recipe> {
        (0..self.tiles.count()).map(|tile| self.tiles.recipe(tile, self.recipe)).collect()
    }
}

#[test]
fn comparing_starts_with_the_current_picture_and_another_upscaler() {
    let mut bench = CompareBench::default();
    bench.recipe.wireframe = true;
    let before = bench.recipe;
    bench.apply(CompareChange::Toggle(Mode::Wipe));
    let recipes = bench.recipes();
    assert_eq!((recipes.len(), recipes[0], bench.recipe), (2, before, before));
    assert_eq!(Recipe { upscaler: before.upscaler, ..recipes[1] }, before, "only the upscaler differs");
    assert_ne!(recipes[1].upscaler, recipes[0].upscaler);
    bench.apply(CompareChange::Toggle(Mode::Wipe));
    assert!(!bench.comparison.is_on());
}

#[test]
fn a_tile_keeps_changes_made_while_it_was_active() {
    let mut bench = CompareBench::default();
    bench.apply(CompareChange::Count(4));
    bench.apply(CompareChange::Activate(2));
    bench.recipe.wireframe = true;
    bench.apply(CompareChange::Activate(0));
    assert!(!bench.recipe.wireframe);
    assert_eq!(bench.recipes().iter().map(|r| r.wireframe).collect::<Vec<_>>(), [false, false, true, false]);
}

#[test]
fn tiles_are_all_different_until_methods_run_out() {
    let mut bench = CompareBench::default();
    bench.apply(CompareChange::Count(8));
    let mut upscalers: Vec<_> = bench.recipes().iter().map(|recipe| recipe.upscaler).collect();
    upscalers.sort();
    upscalers.dedup();
    assert_eq!(upscalers.len(), 8);
    bench.apply(CompareChange::Every(None));
    let shown: Vec<_> = bench.recipes().iter().map(|recipe| recipe.upscaler.method()).collect();
    assert_eq!(shown, upscale::all().iter().map(|method| method.id()).collect::<Vec<_>>());
    bench.apply(CompareChange::Every(Some(Scale::TWO)));
    for (method, recipe) in upscale::all().iter().zip(bench.recipes()) {
        let offers_two = method.offers().scales.contains(&Scale::TWO);
        assert_eq!(recipe.upscaler.scale() == Scale::TWO, offers_two, "{}", method.id());
    }
}

#[test]
fn anchors_differ_only_among_visible_enlarged_pictures() {
    let mut bench = CompareBench::default();
    bench.apply(CompareChange::Count(3));
    let differ = |bench: &CompareBench| bench.comparison.anchors_differ(&bench.tiles, bench.recipe);
    let labels = |bench: &CompareBench| bench.recipes().iter().map(|r| r.upscaler.label()).collect::<Vec<_>>();
    assert_eq!(labels(&bench), ["Native", "Bicubic ×4", "Nearest ×4"]);
    assert!(!differ(&bench), "corners, and native has no blocks");
    let fsr = Recipe { upscaler: Upscaling::new("fsr1", 2).unwrap(), ..bench.recipe };
    bench.apply(CompareChange::Recipe(2, Box::new(fsr)));
    assert!(differ(&bench));
    let stated: Vec<_> = bench.recipes().iter().map(|recipe| recipe.upscaler.label_with_anchor()).collect();
    assert_eq!(stated, ["Native", "Bicubic ×4, corner", "FSR 1 ×2, centre"]);
    bench.apply(CompareChange::Mode(Mode::Wipe));
    assert!(!differ(&bench), "the third is not shown");
}

#[test]
fn removing_keeps_the_active_tile_if_possible_and_at_least_two_tiles() {
    let mut bench = CompareBench::default();
    bench.apply(CompareChange::Count(4));
    bench.apply(CompareChange::Activate(2));
    let third = bench.recipe;
    bench.apply(CompareChange::Remove(0));
    assert_eq!((bench.tiles.active, bench.recipe, bench.tiles.count()), (1, third, 3));
    bench.apply(CompareChange::Activate(2));
    bench.apply(CompareChange::Remove(2));
    assert_eq!((bench.tiles.active, bench.recipe), (1, third));
    bench.apply(CompareChange::Remove(0));
    assert_eq!(bench.tiles.count(), 2);
}

#[test]
fn swapping_exchanges_the_recipes_and_keeps_the_active_index() {
    let mut bench = CompareBench::default();
    bench.apply(CompareChange::Mode(Mode::Difference));
    let [a, b] = bench.recipes()[..] else { panic!("two tiles") };
    bench.apply(CompareChange::Swap);
    assert_eq!(bench.recipes(), [b, a]);
    assert_eq!(bench.recipe, b);
}

#[test]
fn pictures_of_a_scene_in_motion_have_the_history_of_all_frames() {
    let source = SceneSource::named("chess-motion".into());
    let scene = Arc::new(source.load().unwrap().scene);
    let (home, taa) = (scene.home, Upscaling::new("taa", 2).unwrap());
    let recipe = Recipe { upscaler: taa, ..Recipe::default() };
    let mut session = Session::new(Arc::clone(&scene), source, recipe, home);
    session.state.size = PictureSize::Fixed(64, 36);
    session.apply(Command::Compare(CompareChange::Mode(Mode::Wipe)));
    session.apply(Command::SceneTime(SceneTimeChange::Go(5)));
    let request = session.compare_request().unwrap();
    let mut comparer = Comparer::default();
    let mut compared = comparer.start(request.clone()).clone();
    while comparer.has_work() {
        compared = comparer.step().cloned().unwrap_or(compared);
    }
    let shot = Shot::from_start(scene, home, CameraMotion::Still, 30.0);
    let inputs = ShotInputs { shot, recipe, viewport: request.viewport };
    let frame = ShotRenderer::new(inputs).draw(5, KeepDepth::No);
    assert_eq!(compared.tiles[0].recipe, recipe);
    assert!(compared.tiles[0].picture.as_ref() == frame.image());
}
