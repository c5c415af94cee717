use super::*;
use crate::case::{Case, Options};
use crate::inspect::Stage;
use crate::pipeline::settings::{Arithmetic, Rasterizer};
use crate::report::stability::column::ReportColumn;
use crate::report::stability::subject::Configuration;
use crate::ui::engine::{Engine, StageFigures};
use crate::ui::session::first_pick::nearest_drawn;
use crate::ui::session::long_tasks::Measuring;
use crate::ui::session::open_case::CaseChange;
use crate::ui::session::preferences::Bookmark;

fn session() -> Session {
    let source = SceneSource::default();
    let scene = source.load().unwrap().scene;
    let home = scene.home;
    Session::new(Arc::new(scene), source, Recipe::default(), home)
}

/// Returns a bookmark with this name, which opens the default scene.
pub(in crate::ui) fn bookmark(name: &str) -> Bookmark {
    Bookmark { name: name.to_owned(), place: session().place() }
}

#[test]
fn the_first_pick_is_near_its_position_for_every_upscaler() {
    let session = session();
    let place = (60, 50);
    for upscaling in ["native", "checkerboard", "nearest", "bilinear"] {
        let mut recipe = Recipe::default();
        recipe.set(&format!("upscaler.method={upscaling}")).unwrap();
        if upscaling == "bilinear" {
            recipe.set("upscaler.anchor=centre").unwrap();
        }
        let viewport = Viewport { width: 96, height: 64 };
        let frame = crate::chain::run(&session.scene, &session.scene.home, &recipe, viewport, &mut ());
        let (x, y) = nearest_drawn(&frame, place).unwrap();
        assert!(x.abs_diff(place.0) <= 4 && y.abs_diff(place.1) <= 4, "{upscaling}: {x}, {y}");
    }
}

#[test]
fn comparison_shows_finished_pictures_and_ends_when_a_buffer_or_stage_is_shown() {
    let mut session = session();
    let color = Shown::Buffer(Buffer::Color);
    for other in [Command::Show(Shown::Buffer(Buffer::Depth)), Command::Show(Shown::Stage(Stage::Shade))] {
        session.apply(other.clone());
        session.apply(Command::Compare(CompareChange::Toggle(Mode::Wipe)));
        assert_eq!((session.features.comparison.is_on(), session.shown), (true, color));
        session.apply(Command::Show(color));
        assert!(session.features.comparison.is_on());
        session.apply(other);
        assert!(!session.features.comparison.is_on() && session.shown != color);
    }
}

#[test]
fn a_worst_case_has_its_own_settings_and_leaves_the_recipe_alone() {
    let mut session = session();
    session.state.recipe.pipeline.arithmetic = Arithmetic::F64;
    session.settle_silently();
    let before = session.state.recipe;
    let json = r#"{"id":"d","kind":"depth","mapping":"standard","format":"f32","near":1,"far":3,"z":[1,2]}"#;
    let by = Configuration { rasterizer: Rasterizer::ScanlinePublished, arithmetic: Arithmetic::F32 };
    let options = |session: &Session| session.options_of(session.features.case.as_ref().unwrap());
    session.apply(Command::Case(CaseChange::Worst(ReportColumn::Coverage(by), json.to_owned())));
    session.settle(0.0);
    assert_eq!(options(&session), Options { rasterizer: by.rasterizer, arithmetic: by.arithmetic });
    assert!(session.state.recipe == before && !session.can_undo());
    let changed = Options { rasterizer: Rasterizer::Tiled, arithmetic: Arithmetic::Exact };
    session.apply(Command::Case(CaseChange::Options(changed)));
    assert_eq!((options(&session), session.state.recipe), (changed, before));
    session.apply(Command::Case(CaseChange::Close));
    session.settle(1.0);
    assert!(session.state.recipe == before && !session.can_undo());

    session.show_case(Case::parse(json.as_bytes(), "d.json".as_ref()).unwrap());
    assert_eq!(options(&session).arithmetic, Arithmetic::F64, "a case from a file uses the recipe");
    session.apply(Command::Case(CaseChange::Options(changed)));
    assert_eq!(session.state.recipe.pipeline.arithmetic, Arithmetic::Exact);
}

fn move_camera(session: &mut Session, now: f64) {
    session.state.camera.orbit(0.1, 0.0);
    session.settle(now);
}

#[test]
fn camera_moves_in_quick_succession_are_one_undo_step() {
    let mut session = session();
    for notch in 0..5 {
        move_camera(&mut session, 0.1 * f64::from(notch));
    }
    session.apply(Command::Undo);
    assert_eq!(session.state.camera, session.scene.home);
    assert!(!session.can_undo());
}

#[test]
fn a_pause_or_another_change_separates_camera_moves() {
    let mut session = session();
    move_camera(&mut session, 0.0);
    let first = session.state.clone();
    move_camera(&mut session, 10.0);
    session.state.recipe.wireframe = true;
    session.settle(10.1);
    move_camera(&mut session, 10.2);
    session.apply(Command::Undo);
    session.apply(Command::Undo);
    session.apply(Command::Undo);
    assert_eq!(session.state, first);
}

#[test]
fn another_scene_resets_pick_limit_and_measurements() {
    let mut session = session();
    (session.pick, session.features.scrub.triangle_limit) = (Some((1, 2)), Some(3));
    (session.features.stages.figures, session.features.tasks.measuring) =
        (Some(StageFigures::default()), Some(Measuring { progress: 0.5 }));
    move_camera(&mut session, 0.0);
    let source = SceneSource::named("triangle".into());
    session.show_scene(source.load().unwrap().scene, source);
    assert_eq!(
        (session.pick, session.features.scrub.triangle_limit, session.features.tasks.measuring),
        (None, None, None)
    );
    assert!(session.features.stages.figures.is_none() && !session.can_undo());
}

#[test]
fn the_first_pick_waits_for_a_frame_of_the_new_scene() {
    let mut session = session();
    session.state.size = PictureSize::Fixed(64, 48);
    let mut engine = Engine::default();
    session.view = Some(engine.answer(session.request()));
    let source = SceneSource::named("triangle".into());
    session.show_scene(source.load().unwrap().scene, source);
    session.pick_by_itself();
    assert_eq!(session.pick, None);
    session.view = Some(engine.answer(session.request()));
    session.pick_by_itself();
    assert!(session.pick.is_some());
}

#[test]
fn mirroring_twice_changes_nothing_and_preferences_store_the_original_camera() {
    let mut session = session();
    let camera = session.state.camera;
    session.apply(Command::MirrorZ);
    assert_ne!(session.state.camera, camera);
    assert_eq!(session.preferences(&WindowState::default()).camera, Some(camera));
    session.apply(Command::MirrorZ);
    assert_eq!(session.state.camera, camera);
}
