//! Tests of the manual in the window, which is opened by key and by panel, searched, and closed without other effects.

use eframe::egui::{Event, Key, Role, vec2};
use egui_kittest::kittest::Queryable as _;
use rasterscope::manual::Chapter;

use super::bench::Bench;

/// Returns whether the list of chapters is shown and contains this chapter.
fn lists(bench: &Bench, chapter: Chapter) -> bool {
    bench.window.query_all_by_role_and_label(Role::Button, chapter.title()).next().is_some()
}

fn type_text(bench: &mut Bench, text: &str) {
    bench.window.event(Event::Text(text.to_owned()));
    bench.rest();
}

#[test]
fn f1_opens_the_manual_and_escape_closes_nothing_else() {
    let mut bench = Bench::small("triangle");
    let pick = bench.session().pick;
    assert!(!lists(&bench, Chapter::Changelog));
    bench.press(Key::F1);
    for chapter in Chapter::ALL {
        assert!(lists(&bench, *chapter), "{}", chapter.title());
    }
    bench.press(Key::Escape);
    assert!(!lists(&bench, Chapter::Changelog));
    assert_eq!(bench.session().pick, pick);
}

#[test]
fn a_search_lists_sections_and_a_click_opens_one() {
    let mut bench = Bench::small("triangle");
    bench.press(Key::F1);
    type_text(&mut bench, "calculation fragment");
    assert!(!lists(&bench, Chapter::Changelog), "only results are listed");
    bench.click("The calculation of a fragment");
    assert!(bench.mentions("lists every step from the corners"), "text of the section");
}

#[test]
fn words_without_a_section_are_reported() {
    let mut bench = Bench::small("triangle");
    bench.press(Key::F1);
    type_text(&mut bench, "qqqqq");
    assert!(bench.says("No section contains these words."));
}

#[test]
fn a_panel_opens_its_chapter() {
    let mut bench = Bench::small("triangle");
    bench.click(&format!("Manual: {}", Chapter::InspectingAPixel.title()));
    assert!(bench.mentions("Nothing is recorded while a frame is drawn"), "text of the chapter");
}

#[test]
fn a_link_scrolls_to_its_section() {
    let mut bench = Bench::small("triangle");
    bench.press(Key::F1);
    // The tab at the bottom has the same name.
    let named = bench.window.query_all_by_role_and_label(Role::Button, Chapter::Stability.title());
    named.min_by(|a, b| a.rect().top().total_cmp(&b.rect().top())).expect("a chapter").click();
    bench.rest();
    let heading = |bench: &Bench| bench.window.get_by_role_and_label(Role::Label, "Probe").rect().top();
    let top = bench.window.get_by_role_and_label(Role::TextInput, "Search the manual").rect().top();
    let before = heading(&bench) - top;
    bench.window.get_by_role_and_label(Role::Link, "probe").click();
    bench.rest();
    let after = heading(&bench) - top;
    assert!(before > 100.0 && after.abs() < 20.0, "the page scrolls to the heading: {before} → {after}");
}

#[test]
fn the_manual_survives_the_narrowest_window() {
    let mut bench = Bench::small("triangle");
    bench.press(Key::F1);
    for size in [vec2(1.0, 300.0), vec2(900.0, 1.0), vec2(60.0, 60.0)] {
        bench.window.set_size(size);
        bench.rest();
    }
}
