//! Tests of measuring the savings of the plan and the scaling of cost from the window.

use std::time::{Duration, Instant};

use super::bench::Bench;
use rasterscope::ui::session::workspace::Panel;

/// Time limit of a measurement, sufficient for slow machines.
const PATIENCE: Duration = Duration::from_secs(120);

fn wait_while(bench: &mut Bench, running: fn(&Bench) -> bool) {
    let begun = Instant::now();
    while running(bench) {
        assert!(begun.elapsed() < PATIENCE, "it does not end");
        std::thread::sleep(Duration::from_millis(20));
        bench.window.step();
    }
    bench.rest();
}

#[test]
fn the_plan_shows_its_savings_once_they_are_measured() {
    let mut bench = Bench::small("triangle");
    bench.show_panel(Panel::SkippedWork);
    bench.click("Measure savings");
    wait_while(&mut bench, |bench| bench.session().features.tasks.savings.progress.is_some());
    let (found, of) = bench.session().features.tasks.savings.found.clone().expect("it was measured");
    assert!(of.same_complete_frame(&bench.session().request()));
    assert!(found.savings.iter().all(|saving| saving.same_picture && saving.draws > 0));
    assert!(bench.mentions("with every skip enabled, median of"));
    let saving =
        found.savings.iter().find(|saving| saving.part.is_some()).expect("a triangle in view needs no clipping");
    let cell = format!("{:+.2} ms", saving.saved_ms.median);
    assert!(bench.says(&cell));
    bench.session_mut().state.camera.orbit(0.2, 0.0);
    bench.rest();
    assert!(!bench.says(&cell), "it was measured on another view");
}

#[test]
fn measuring_how_cost_grows_can_be_cancelled() {
    let mut bench = Bench::small("triangle");
    bench.show_panel(Panel::Scaling);
    assert!(bench.says("No measurement yet"));
    bench.click("Measure scaling");
    bench.click("Cancel");
    wait_while(&mut bench, |bench| bench.session().features.tasks.scaling.progress.is_some());
    assert!(
        bench.session().features.tasks.scaling.found.is_none() && bench.session().features.messages.error.is_none()
    );
}
