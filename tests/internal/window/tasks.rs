//! Tests of frequent tasks with the keyboard alone, and of the number of actions that they take.

use eframe::egui::{Event, Key, Modifiers, Role};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use rasterscope::inspect::Buffer;
use rasterscope::inspect::overlays::Overlay;
use rasterscope::measure::metric::Metric;
use rasterscope::pipeline::settings::{Choice as _, FillRule};
use rasterscope::scene::Camera;
use rasterscope::ui::engine::Shown;
use rasterscope::ui::session::PictureSize;
use rasterscope::ui::session::workspace::{Panel, Workspace};

use super::bench::Bench;
use super::cases::small_report;

/// Largest number of widgets in a window, before which the Tab key reaches each of them.
const WIDGETS: usize = 400;

/// Window that is operated by keys, with the number of actions so far. An action is a key, a typed text, or a series of
/// Tab keys that moves the focus.
struct KeyUser {
    bench: Bench,
    actions: usize,
}

impl KeyUser {
    fn new(scene: &str) -> Self {
        Self { bench: Bench::small(scene), actions: 0 }
    }

    fn press(&mut self, key: Key) {
        self.press_with(Modifiers::NONE, key);
    }

    fn press_with(&mut self, modifiers: Modifiers, key: Key) {
        self.bench.press_with(modifiers, key);
        self.actions += 1;
    }

    fn type_text(&mut self, text: &str) {
        self.bench.window.event(Event::Text(text.to_owned()));
        self.bench.rest();
        self.actions += 1;
    }

    /// Runs an entry of the palette.
    fn find(&mut self, text: &str) {
        self.press_with(Modifiers::COMMAND | Modifiers::SHIFT, Key::P);
        self.type_text(text);
        self.press(Key::Enter);
    }

    /// Moves the focus by the Tab key to the widget whose name contains `name`.
    fn tab_to(&mut self, role: Role, name: &str) {
        self.actions += 1;
        for _ in 0..WIDGETS {
            self.bench.window.key_press(Key::Tab);
            self.bench.window.run_steps(2);
            let mut found = self.bench.window.query_all_by_role(role).filter(egui_kittest::Node::is_focused);
            if found.any(|node| node.accesskit_node().label().is_some_and(|label| label.contains(name))) {
                return;
            }
        }
        panic!("the Tab key does not reach “{name}”");
    }

    /// Asserts the number of actions since the last task.
    fn took(&mut self, actions: usize) {
        assert_eq!(std::mem::take(&mut self.actions), actions);
    }
}

#[test]
fn a_scene_is_opened_viewed_and_explained_by_keys() {
    let folder = tempfile::tempdir().unwrap();
    let (good, broken) = (folder.path().join("quad.obj"), folder.path().join("broken.obj"));
    std::fs::write(&good, "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n").unwrap();
    std::fs::write(&broken, "v 0 0 0\nf 1 2 99\n").unwrap();
    let mut user = KeyUser::new("triangle");

    // A broken file.
    user.press_with(Modifiers::COMMAND, Key::O);
    user.type_text(broken.to_str().unwrap());
    user.press(Key::Enter);
    let error = user.bench.session().features.messages.error.clone().expect("it is reported");
    assert!(error.contains("broken.obj:2") && user.bench.says(&error), "{error}");
    user.took(3);

    // Open and orbit.
    user.press_with(Modifiers::COMMAND, Key::O);
    user.type_text(good.to_str().unwrap());
    user.press(Key::Enter);
    user.press_with(Modifiers::COMMAND, Key::ArrowRight);
    assert_eq!(user.bench.session().source.name(), good);
    let mut orbited = user.bench.session().scene.home;
    orbited.orbit(5_f32.to_radians(), 0.0);
    let distance = |a: Camera, b: Camera| (a.eye - b.eye).length() / a.distance();
    assert!(distance(user.bench.session().state.camera, orbited) < 1e-5);
    user.took(4);

    // A bookmark, and back to it.
    user.press_with(Modifiers::COMMAND, Key::B);
    user.press(Key::H);
    user.press_with(Modifiers::ALT, Key::Num1);
    assert!(distance(user.bench.session().state.camera, orbited) < 1e-5);
    user.took(3);

    // The reason for a black pixel.
    user.find("why is this pixel black");
    let verdict = user.bench.view().report.as_ref().expect("a pixel is explained").verdict.clone();
    let shown = user.bench.session().features.onboarding.lesson.expect("a lesson is open");
    assert!(verdict.contains(shown.cause) && user.bench.says(&verdict));
    user.took(3);
}

#[test]
fn a_frame_is_stepped_through_and_marked_by_keys() {
    let mut user = KeyUser::new("shared-edges");

    // Depth and weights of a pixel.
    user.press(Key::ArrowRight);
    let report = user.bench.view().report.clone().expect("the pixel is explained");
    assert!(user.bench.mentions("λ0") && user.bench.mentions("Depth"));
    assert!(!report.fragments.is_empty());
    user.took(1);

    // Single triangles.
    user.press(Key::Home);
    user.press(Key::Period);
    assert_eq!(user.bench.session().features.scrub.triangle_limit, Some(1));
    user.took(2);
    user.bench.press(Key::End);

    // What a fill rule changes, and the cracks that it leaves.
    user.press(Key::X);
    user.find("fill_rule=exclusive");
    assert_eq!(user.bench.session().state.recipe.pipeline.fill_rule, FillRule::Exclusive);
    assert!(user.bench.says("fill_rule: top-left → exclusive") && user.bench.mentions("pixels changed ("));
    user.took(4);
    user.press(Key::J);
    assert_eq!(user.bench.session().shown, Shown::Buffer(Buffer::Hits));
    user.press(Key::J);
    let (x, y) = user.bench.session().pick.expect("a crack is picked");
    let hits = user.bench.view().buffers.as_ref().and_then(|buffers| buffers.hits.clone()).expect("they are counted");
    assert!(hits.neighbour(None, true).is_some() && hits.neighbour(Some((x, y)), true).is_some());
    user.took(2);

    // Overlays.
    user.find("overlay: triangle size");
    assert!(user.bench.session().features.overlays.layer(Overlay::TriangleSize).is_some());
    user.took(3);

    // The 2D lab.
    user.press_with(Modifiers::COMMAND, Key::Num6);
    user.press(Key::Comma);
    assert!(user.bench.session().features.lab.open);
    user.took(2);
}

#[test]
fn upscalers_are_measured_and_compared_by_keys() {
    let folder = tempfile::tempdir().unwrap();
    let mut user = KeyUser::new("triangle");
    user.bench.session_mut().features.files.folder = folder.path().to_owned();
    user.bench.session_mut().state.size = PictureSize::Fixed(48, 27);
    user.bench.session_mut().settle_silently();
    user.bench.rest();

    // Time of every upscaler. The window measures by itself when it is idle, unless it is synchronous.
    user.find("measure all upscalers");
    assert_eq!(user.bench.session().workspace(), Workspace::Measure);
    assert!(user.bench.session().features.timings.has_measurement());
    user.took(3);

    // The best method within 2 ms.
    user.tab_to(Role::SpinButton, "Time budget of a frame");
    user.type_text("2");
    user.press(Key::Enter);
    assert_eq!(user.bench.session().features.timings.budget_ms(), 2.0);
    let winner = user.bench.session().features.timings.budget_winner().words(Metric::Flip, 2.0);
    assert!(user.bench.says(&winner), "{winner}");
    user.took(3);

    // Skipped work.
    user.find("skipped work");
    assert!(user.bench.window.query_by_role_and_label(Role::Group, Panel::SkippedWork.name()).is_some());
    user.took(3);

    // A saved comparison.
    user.press_with(Modifiers::COMMAND, Key::Num3);
    user.find("save the compared pictures");
    assert_eq!(user.bench.session().features.messages.error, None);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    user.took(4);
}

#[test]
fn the_worst_case_of_a_stability_report_is_opened_by_keys() {
    let report = std::sync::Arc::new(small_report());
    let class = &report.classes[0];
    let cell = class.cells.iter().find(|cell| cell.column.method() == "scanline-published").unwrap();
    let worst = cell.worst.as_ref().expect("it goes wrong").case.id.clone();
    let mut user = KeyUser::new("triangle");
    // A complete report takes a minute.
    user.bench.session_mut().features.tasks.stability.report = Some(report.clone());
    user.press_with(Modifiers::COMMAND, Key::Num5);
    user.tab_to(Role::Button, &format!("{}, {}: ", class.class.name, cell.column.label()));
    user.press(Key::Enter);
    assert_eq!(user.bench.session().features.case.as_ref().map(|open| open.case.id.clone()), Some(worst));
    user.took(3);
}
