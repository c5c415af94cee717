//! Tests of the tab “Calculation”: stepping through the lines of the picked pixel, and showing one of its values for
//! all pixels.

use eframe::egui::{Key, Modifiers};
use rasterscope::inspect::trace::Trace;
use rasterscope::inspect::{Buffer, Intermediate};
use rasterscope::ui::engine::Shown;
use rasterscope::ui::session::workspace::Panel;

use super::bench::Bench;

/// Returns the trace in the window, after checking that it is the trace of the picked pixel.
fn trace(bench: &Bench) -> Trace {
    let session = bench.session();
    let shown = session.features.trace.trace(session.view.as_ref()).expect("the tab is open and a pixel picked");
    let (view, frame) = (bench.view(), bench.expected());
    let report = view.report.as_ref().expect("a pixel is picked");
    let Trace { fragment, .. } = **shown;
    let expected = Trace::of(&view.request.scene, &view.request.recipe, &frame, report, fragment);
    assert_eq!(**shown, expected);
    expected
}

#[test]
fn keys_step_through_the_lines_and_open_the_tab() {
    let mut bench = Bench::small("interpenetrating");
    bench.press(Key::F10);
    bench.rest();
    let count = trace(&bench).lines.len();
    assert_eq!(bench.session().features.trace.line, 1);
    assert!(bench.mentions(&format!("2 of {count} · Model")));
    bench.press_with(Modifiers::SHIFT, Key::F10);
    assert_eq!(bench.session().features.trace.line, 0);
    bench.press(Key::F11);
    let lines = trace(&bench).lines;
    let line = bench.session().features.trace.line;
    assert!(line > 0 && lines[line].stage != lines[0].stage && lines[line - 1].stage == lines[0].stage);
    bench.press_with(Modifiers::SHIFT, Key::F11);
    assert_eq!(bench.session().features.trace.line, 0);
}

#[test]
fn the_inspector_leads_to_the_arithmetic_of_a_fragment() {
    let mut bench = Bench::small("interpenetrating");
    bench.click("Show calculation");
    bench.rest();
    let shown = bench.view().report.as_ref().and_then(|report| {
        let visible = report.visible()?;
        report.fragments.iter().position(|fragment| std::ptr::eq(fragment, visible))
    });
    assert_eq!(trace(&bench).fragment, shown);
    assert!(bench.mentions(" · Model"), "the panel is shown");
}

#[test]
fn another_pixel_is_traced_when_it_is_picked() {
    let mut bench = Bench::small("interpenetrating");
    bench.show_panel(Panel::Calculation);
    let first = trace(&bench);
    let (x, y) = bench.session().pick.expect("a pixel is picked at first");
    bench.session_mut().pick = Some((x + 1, y));
    bench.rest();
    let second = trace(&bench);
    assert_eq!((first.pixel, second.pixel), ([x, y], [x + 1, y]));
    let table = &bench.session().features.trace;
    let changed = (0..second.lines.len()).filter(|line| table.is_changed(*line)).count();
    assert!(changed > 3 && changed < second.lines.len(), "{changed}");
}

#[test]
fn the_eye_of_a_line_shows_its_number_and_hides_it_again() {
    let mut bench = Bench::small("interpenetrating");
    bench.show_panel(Panel::Calculation);
    let line = trace(&bench).lines.iter().position(|line| line.buffer == Some(Intermediate::Lambda1));
    let step = rasterscope::ui::session::trace::TraceChange::Step(line.expect("every fragment has weights") as i64);
    bench.session_mut().apply(rasterscope::ui::session::command::Command::Trace(step));
    bench.rest();
    bench.click("Show “λ1 on screen” for the whole picture");
    assert_eq!(bench.session().shown, Shown::Intermediate(Intermediate::Lambda1));
    let (x, y) = bench.session().pick.expect("a pixel is picked at first");
    let view = bench.view();
    assert!(matches!(view.value(x, y), rasterscope::inspect::view::Value::Number(_)));
    assert!(view.range.is_some_and(|range| range.low >= 0.0 && range.high <= 1.0), "{:?}", view.range);
    bench.click("Show the finished picture again");
    assert_eq!(bench.session().shown, Shown::Buffer(Buffer::Color));
}
