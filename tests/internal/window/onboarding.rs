//! Tests of the start card, the coach, and the gallery of built-in scenes.

use eframe::egui::{Key, Modifiers, PointerButton, Vec2};
use egui_kittest::kittest::Queryable as _;
use rasterscope::inspect::{Stage, lesson};
use rasterscope::scene::SceneSource;
use rasterscope::ui::session::WindowState;
use rasterscope::ui::session::onboarding::CoachStep;
use rasterscope::ui::session::workspace::Workspace;

use super::bench::Bench;

/// Opens a window with the start card.
fn with_card(scene: &str) -> Bench {
    let mut bench = Bench::small(scene);
    bench.session_mut().features.onboarding.begin();
    bench.rest();
    bench.rest();
    assert!(bench.says("Why is a pixel black?"), "the card is shown");
    bench
}

#[test]
fn each_example_of_the_start_card_picks_a_black_pixel_and_the_verdict_names_the_cause() {
    for lesson in lesson::ALL {
        let mut bench = with_card("chess");
        bench.click(lesson.question);
        assert_eq!(bench.session().source.name().to_str(), Some(lesson.scene));
        assert_eq!(bench.session().state.recipe, lesson.recipe());
        assert!(
            bench.session().pick.is_some_and(|(x, y)| lesson::is_black(bench.image().at(x, y))),
            "{}",
            lesson.scene
        );
        let verdict = bench.view().report.as_ref().expect("the pixel is explained").verdict.clone();
        assert!(verdict.contains(lesson.cause), "{}: {verdict}", lesson.scene);
        assert!(bench.says(&verdict), "the panel shows it");
        assert!(!bench.session().features.onboarding.card_open);
    }
}

#[test]
fn undo_restores_the_settings_from_before_a_lesson() {
    let mut bench = with_card("chess");
    bench.session_mut().state.recipe.wireframe = true;
    bench.session_mut().settle_silently();
    bench.click(lesson::ALL[1].question);
    assert!(!bench.session().state.recipe.wireframe);
    bench.press_with(Modifiers::COMMAND, Key::Z);
    assert!(bench.session().state.recipe.wireframe);
}

#[test]
fn a_scene_opened_after_a_lesson_keeps_its_own_pick() {
    let mut bench = with_card("chess");
    bench.click(lesson::ALL[0].question);
    bench.click("Scene");
    bench.click("Chess floor");
    assert_eq!(bench.session().state.recipe, lesson::ALL[0].recipe(), "settings stay");
    assert!(matches!(&bench.session().source, SceneSource::Builtin(scene) if scene.id == "chess"));
    let (x, y) = bench.session().pick.expect("a pixel is picked");
    assert!(!lesson::is_black(bench.image().at(x, y)));
}

#[test]
fn every_choice_closes_the_start_card_for_good() {
    for (button, workspace) in [("Compare upscalers", Workspace::Compare), ("2D lab", Workspace::Lab)] {
        let mut bench = with_card("triangle");
        let name = if button == "2D lab" { bench.window.query_all_by_label(button).count() } else { 1 };
        assert!(name >= 1);
        let last = bench.window.query_all_by_label(button).last().expect("the card has the button");
        last.click();
        bench.rest();
        assert_eq!(bench.session().workspace(), workspace);
        assert!(bench.session().preferences(&WindowState::default()).seen.start_card);
    }
    let mut bench = with_card("triangle");
    bench.click("Open a model…");
    assert!(bench.says("Open a model") && !bench.session().features.onboarding.card_open);
    for close in [|bench: &mut Bench| bench.click("Close the start card"), |bench: &mut Bench| bench.press(Key::Escape)]
    {
        let mut bench = with_card("triangle");
        let pick = bench.session().pick;
        close(&mut bench);
        assert!(!bench.says("Why is a pixel black?"));
        assert_eq!(bench.session().pick, pick, "nothing else happens");
        bench.press(Key::Escape);
        bench.click("Help");
        bench.click("Start card");
        assert!(bench.says("Why is a pixel black?"));
    }
}

#[test]
fn the_coach_advances_with_what_the_user_does() {
    let mut bench = with_card("triangle");
    bench.click("Close the start card");
    let step = |bench: &Bench| bench.session().features.onboarding.step;
    assert!(bench.says("Orbit and zoom"));
    let center = bench.canvas().center();
    bench.drag(PointerButton::Primary, center, Vec2::new(30.0, 0.0));
    assert_eq!(step(&bench), Some(CoachStep::Move));
    bench.wheel(center, 120.0, Modifiers::NONE);
    assert!(bench.says("Explain a pixel"));
    bench.click_at(center);
    assert!(bench.says("See a stage"));
    bench.click_eye(Stage::Rasterize);
    assert!(bench.says("Compare upscalers"));
    bench.press_with(Modifiers::COMMAND, Key::Num3);
    assert_eq!(step(&bench), None);
    assert!(bench.session().preferences(&WindowState::default()).seen.coach);
}

#[test]
fn the_coach_can_be_stepped_through_and_skipped() {
    let mut bench = with_card("triangle");
    bench.click("Close the start card");
    for step in CoachStep::ALL {
        assert_eq!(bench.session().features.onboarding.step, Some(step));
        bench.click(if step == CoachStep::Compare { "Done" } else { "Next" });
    }
    assert_eq!(bench.session().features.onboarding.step, None);
    for skip in [|bench: &mut Bench| bench.click("Skip"), |bench: &mut Bench| bench.press(Key::Escape)] {
        bench.click("Help");
        bench.click("Introduction in four steps");
        assert!(bench.says("Orbit and zoom"));
        let pick = bench.session().pick;
        skip(&mut bench);
        assert!(!bench.says("Orbit and zoom"));
        assert_eq!(bench.session().pick, pick);
    }
}
