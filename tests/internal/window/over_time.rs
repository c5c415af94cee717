//! Tests of errors over time in the window.

use eframe::egui::Key;
use rasterscope::measure::metric::Metric;
use rasterscope::ui::session::command::Command;
use rasterscope::ui::session::over_time::OverTimeChange;
use rasterscope::ui::session::workspace::Panel;
use rasterscope::upscale::Upscaling;

use super::bench::Bench;

fn change(bench: &mut Bench, change: OverTimeChange) {
    bench.session_mut().apply(Command::OverTime(change));
    bench.rest();
}

#[test]
fn compared_upscalers_are_measured_and_a_click_shows_a_frame() {
    let mut bench = Bench::small("fence");
    bench.press(Key::T);
    let compared: Vec<Upscaling> =
        bench.session().compare_request().unwrap().recipes.iter().map(|recipe| recipe.upscaler).collect();
    bench.show_panel(Panel::OverTime);
    assert!(bench.mentions("No measurement yet"));
    change(&mut bench, OverTimeChange::Frames(12));
    bench.click("Measure over time");
    let clip = bench.session().features.over_time.found.clone().unwrap();
    assert_eq!(clip.report.methods.iter().map(|method| method.upscaler).collect::<Vec<_>>(), compared);
    assert!(clip.report.frames == 12 && bench.session().is_measured_now(&clip));
    bench.click("Show frame 7");
    assert_eq!(bench.session().scene_frame(), 7);
    assert!(bench.session().is_measured_now(&clip), "another time is part of the same clip");
    change(&mut bench, OverTimeChange::Metric(Metric::Ssim));
    assert!(bench.mentions("Click a frame to show it"));
    bench.session_mut().state.camera.orbit(0.1, 0.0);
    bench.rest();
    assert!(bench.mentions("measure again to update"));
}

#[test]
fn nothing_is_measured_while_nothing_moves() {
    let mut bench = Bench::small("triangle");
    change(&mut bench, OverTimeChange::Measure);
    assert!(bench.session().features.over_time.found.is_none());
    assert!(bench.session().features.messages.error.as_ref().is_some_and(|error| error.starts_with("Nothing moves")));
}
