//! The manual in the window: opened by key and by panel, searched, and closed without other effects.

use eframe::egui::{Event, Key};
use rasterscope::manual::Chapter;

use crate::bench::Bench;

fn type_text(bench: &mut Bench, text: &str) {
    bench.window.event(Event::Text(text.to_owned()));
    bench.rest();
}

#[test]
fn f1_opens_the_manual_and_escape_closes_nothing_else() {
    let mut bench = Bench::small("triangle");
    let pick = bench.session().pick;
    assert!(!bench.mentions(Chapter::Changelog.title()));
    bench.press(Key::F1);
    for chapter in Chapter::ALL {
        assert!(bench.mentions(chapter.title()), "{}", chapter.title());
    }
    // The first one leaves the search field.
    bench.press(Key::Escape);
    bench.press(Key::Escape);
    assert!(!bench.mentions(Chapter::Changelog.title()));
    assert_eq!(bench.session().pick, pick);
}

#[test]
fn a_search_lists_sections_and_a_click_opens_one() {
    let mut bench = Bench::small("triangle");
    bench.press(Key::F1);
    type_text(&mut bench, "arithmetic fragment");
    assert!(!bench.mentions(Chapter::Changelog.title()), "only results are listed");
    bench.click("The arithmetic of a fragment");
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
