//! Tests of the effect of the last change: errors, pictures before and after, and stepping through the changed pixels.

use eframe::egui::{Key, Modifiers};
use rasterscope::chain::{Recipe, run};
use rasterscope::inspect::Stage;
use rasterscope::pipeline::settings::FillRule;

use super::bench::Bench;

/// Opens the scene `shared-edges` and changes the fill rule from top-left to inclusive in the panel.
fn changed() -> Bench {
    let mut bench = Bench::small("shared-edges");
    bench.press(Key::X);
    assert!(bench.says("What changed?"));
    bench.select(Stage::Rasterize);
    bench.choose("Fill rule", "Inclusive");
    bench
}

#[test]
fn the_bar_names_the_changed_setting_and_counts_the_changed_pixels() {
    let bench = changed();
    assert!(bench.says("fill_rule: top-left → inclusive"));
    let request = bench.session().request();
    let before = run(&request.scene, &request.camera, &Recipe::default(), request.viewport, &mut ());
    let after = bench.expected();
    let pairs = before.image().pixels().iter().zip(after.image().pixels());
    let count = pairs.filter(|(before, after)| before != after).count();
    assert!(count > 1);
    assert!(bench.mentions(&format!("{count} pixels changed (")), "{count}");
    assert!(bench.mentions("PSNR") && bench.mentions("Δ time"));
}

#[test]
fn a_change_without_effect_is_reported_as_such() {
    let mut bench = Bench::small("triangle");
    bench.press(Key::X);
    bench.select(Stage::Cull);
    bench.choose("Culling", "None");
    assert!(bench.says("culling: back → none") && bench.says("No pixel changed"));
    assert!(bench.mentions("pictures identical"));
}

#[test]
fn a_button_steps_through_the_changed_pixels() {
    let mut bench = changed();
    let found = bench.session().features.what_if.found.clone().unwrap();
    for _ in 0..3 {
        bench.click("Next changed pixel");
        let (x, y) = bench.session().pick.unwrap();
        assert!(found.changes.mask.at(x, y));
    }
}

#[test]
fn a_pinned_a_stays_and_revert_leads_back_to_it() {
    let mut bench = changed();
    bench.click("Pin A");
    bench.select(Stage::Cull);
    bench.choose("Culling", "None");
    assert!(bench.says("culling: back → none,  fill_rule: top-left → inclusive"));
    bench.click("Swap");
    assert_eq!(bench.session().state.recipe, Recipe::default());
    bench.click("Swap");
    assert_eq!(bench.session().state.recipe.pipeline.fill_rule, FillRule::Inclusive);
    bench.click("Revert");
    assert_eq!(bench.session().state.recipe, Recipe::default());
    assert!(bench.says("A and B have the same settings"));
    bench.press_with(Modifiers::COMMAND, Key::Z);
    assert_eq!(bench.session().state.recipe.pipeline.fill_rule, FillRule::Inclusive);
}

#[test]
fn a_closed_bar_requests_nothing_from_the_renderer() {
    let mut bench = changed();
    assert!(bench.session().features.what_if.found.is_some());
    bench.press(Key::X);
    assert!(bench.session().features.what_if.found.is_none() && bench.session().what_if_request().is_none());
    assert_eq!(
        bench.session().features.what_if.before,
        Some(Recipe::default()),
        "the previous settings are still kept"
    );
}
