//! Tests of the history of a pixel, the menu “Why is this pixel black?”, and the assertions.

use rasterscope::inspect::assertions::Assertion;
use rasterscope::inspect::lesson;
use rasterscope::inspect::pixel::Kind;
use rasterscope::pipeline::settings::Choice as _;
use rasterscope::ui::session::workspace::Panel;

use super::bench::Bench;

/// Returns the label of the filter of the pixel history for `kind`, with its count in the current report.
fn filter(bench: &Bench, kind: Kind) -> String {
    let report = bench.view().report.clone().expect("a pixel is picked");
    format!("{} {}", kind.name(), kind.count(&report))
}

#[test]
fn near_misses_are_listed_on_request_and_can_be_inspected() {
    let mut bench = Bench::small("triangle");
    let place = bench.place_of((3, 3));
    bench.click_at(place);
    let report = bench.view().report.clone().expect("a pixel is picked");
    assert!(report.verdict.starts_with("Background: the nearest triangle, 0 of"), "{}", report.verdict);
    assert!(bench.says(&report.verdict));
    let reason = report.absent[0].reason.clone();
    assert!(!bench.says(&reason), "near misses are not listed at first");
    let missed = filter(&bench, Kind::Missed);
    bench.click(&missed);
    assert!(bench.says(&reason));
    bench.click("Triangle 0 without a fragment");
    assert!(bench.says("Triangle without a fragment") && bench.says("Distance, px"));
}

#[test]
fn the_inspector_offers_to_draw_all_triangles_again() {
    let mut bench = Bench::small("triangle");
    let place = bench.place_of((80, 45));
    bench.click_at(place);
    bench.press(eframe::egui::Key::Home);
    assert_eq!(bench.session().features.scrub.triangle_limit, Some(0));
    let report = bench.view().report.clone().expect("a pixel is picked");
    assert!(report.verdict.contains("comes after the last triangle"), "{}", report.verdict);
    bench.click("Draw all triangles again  (End)");
    assert_eq!(bench.session().features.scrub.triangle_limit, None);
    assert!(bench.view().report.as_ref().is_some_and(|report| report.visible().is_some()));
}

#[test]
fn every_lesson_is_answered_by_the_third_click() {
    for lesson in lesson::ALL {
        let mut bench = Bench::small("triangle");
        bench.click("Scene");
        bench.click("Why is this pixel black?");
        bench.click(lesson.question);
        let spot = lesson.black_pixel(&bench.view().frame).expect("something is black");
        let place = bench.place_of(spot);
        bench.click_at(place);
        let verdict = bench.view().report.as_ref().expect("a pixel is picked").verdict.clone();
        assert!(verdict.contains(lesson.cause) && bench.says(&verdict), "{}: {verdict}", lesson.scene);
    }
}

#[test]
fn the_first_violation_is_picked_and_described() {
    let mut bench = Bench::small("cubes");
    bench.show_panel(Panel::Assertions);
    bench.click("Check this frame");
    assert!(bench.mentions(&format!("all {} assertions hold in this frame", Assertion::ALL.len())));
    bench.session_mut().state.recipe.pipeline.rasterizer =
        rasterscope::pipeline::settings::Rasterizer::ScanlinePublished;
    bench.rest();
    bench.click("Check every frame");
    let (report, frame) = bench.session().features.checks.found.clone().expect("it was checked");
    let (assertion, first) = report.first_violation().expect("a published rasterizer owns too much");
    assert_eq!(assertion, Assertion::Owner);
    assert_eq!(bench.session().pick, Some(rasterscope::ui::session::checks::place(first, &frame)));
    assert!(!bench.session().features.checks.every_frame, "the first violation stops it");
    assert!(bench.mentions(&first.text));
    assert_eq!(Assertion::ALL.len(), report.findings.len());
}
