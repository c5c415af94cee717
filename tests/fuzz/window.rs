//! Fuzz target: random pointer, key, text, file and resize events, sent to a whole window.

use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use eframe::egui::epaint::ClippedShape;
use eframe::egui::{
    Event, Key, Modifiers, MouseWheelSource, MouseWheelUnit, PointerButton, Pos2, Role, Shape, TouchPhase, Vec2,
};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use fastrand::Rng;
use rasterscope::chain::Recipe;
use rasterscope::scene::SceneSource;
use rasterscope::ui::app::Workbench;
use rasterscope::ui::session::command::Command;
use rasterscope::ui::session::{PictureSize, Session};
use rasterscope::ui::theme;
use rasterscope::ui::worker::Worker;

use crate::fuzz::cases::Cases;
use crate::fuzz::driver::{Failure, LIMIT, Target};
use crate::fuzz::images::Images;
use crate::fuzz::input::Input;
use crate::fuzz::mutate::{pick, word};
use crate::fuzz::obj::Obj;
use crate::fuzz::panics;
use crate::fuzz::process::Stopwatch;
use crate::ui::session::long_tasks::MeasureCommand;

/// Name of the input file that contains the events, one per line.
const FILE: &str = "events.txt";

/// Built-in scenes of few triangles, one of which the window opens.
const SCENES: [&str; 4] = ["triangle", "near-plane", "stained-glass", "z-fighting"];

/// Initial size of the window, in points.
const WINDOW: Vec2 = Vec2::new(1280.0, 800.0);

/// Time to wait for the renderer after each event; longer rendering continues during the next events.
const RENDERING: Duration = Duration::from_millis(20);

/// Label of the button that opens a system dialog, which no test can close.
const SYSTEM_DIALOG: &str = "Browse…";

/// Roles of the widgets that are clicked.
const CLICKED: [Role; 8] = [
    Role::Button,
    Role::CheckBox,
    Role::RadioButton,
    Role::ComboBox,
    Role::Slider,
    Role::TextInput,
    Role::Tab,
    Role::Link,
];

/// Fuzz target that sends random events to a window.
pub(crate) struct Window;

impl Target for Window {
    fn name(&self) -> &'static str {
        "window"
    }

    fn features(&self) -> &'static str {
        "window-tests"
    }

    /// Returns the time limit of all events together; the time of each event is limited by [`LIMIT`].
    fn limit(&self) -> Duration {
        LIMIT * 30
    }

    fn generate(&self, rng: &mut Rng) -> Input {
        let mut input = match rng.u8(..8) {
            0 => Obj.generate(rng),
            1 => Cases.generate(rng),
            2 => Images.generate(rng),
            _ => Input::default(),
        };
        let files: Vec<_> = input.0.keys().cloned().collect();
        let mut lines = vec![format!("scene {}", word(rng, &SCENES))];
        for _ in 0..rng.usize(5..40) {
            lines.push(event(rng));
        }
        for file in files {
            let at = rng.usize(1..=lines.len());
            lines.insert(at, format!("drop {file}"));
        }
        input = input.with(FILE, lines.join("\n") + "\n");
        input
    }

    fn run(&self, folder: &Path) -> Result<(), Failure> {
        let text = std::fs::read_to_string(folder.join(FILE)).unwrap_or_default();
        let scene = text.lines().find_map(|line| line.strip_prefix("scene ")).unwrap_or(SCENES[0]);
        let output = tempfile::tempdir_in(folder).map_err(|error| Failure::Wrong(error.to_string()))?;
        let mut window = window(scene, output.path());
        for line in text.lines() {
            let begun = Stopwatch::start();
            act(&mut window, line, folder);
            window.step();
            let taken = begun.elapsed();
            if taken > LIMIT {
                return Err(Failure::Slow(taken));
            }
            check(&window)?;
            stop_measurements(&mut window);
            let begun = Instant::now();
            while begun.elapsed() < RENDERING && is_behind(window.state().session()) {
                std::thread::sleep(Duration::from_millis(2));
                // The window receives results of the renderer in a step.
                window.step();
            }
        }
        window.step();
        check(&window)
    }
}

/// Opens a window on a built-in scene, with a separate renderer thread. Exports are written to `output`.
fn window(scene: &str, output: &Path) -> Harness<'static, Workbench> {
    let source = SceneSource::named(scene.into());
    let loaded = source.load().map_or_else(|_| SceneSource::default().load().expect("built in").scene, |l| l.scene);
    let camera = loaded.home;
    let mut session = Session::new(Arc::new(loaded), source, Recipe::default(), camera);
    session.state.size = PictureSize::Fixed(96, 54);
    session.features.files.folder = output.to_owned();
    // Names from files may contain any character; those without a glyph are drawn as boxes, as in the program.
    Harness::builder().with_size(WINDOW).with_step_dt(0.1).allow_missing_glyphs().build_eframe(|cc| {
        theme::install(&cc.egui_ctx);
        Workbench::new(session, Worker::spawn(|| ()))
    })
}

/// Returns whether the frame on screen does not yet match the current request.
fn is_behind(session: &Session) -> bool {
    session.view.as_ref().is_none_or(|view| !view.request.same_view(&session.request()))
}

/// Cancels measurements, because they would delay all other work.
fn stop_measurements(window: &mut Harness<'_, Workbench>) {
    let app = window.state_mut();
    let session = app.session();
    let mut commands = Vec::new();
    commands.extend(
        session
            .features
            .tasks
            .stability
            .progress
            .is_some()
            .then_some(Command::Measure(MeasureCommand::CancelStability)),
    );
    commands.extend(
        session.features.tasks.savings.progress.is_some().then_some(Command::Measure(MeasureCommand::CancelPlan)),
    );
    commands.extend(
        session.features.tasks.scaling.progress.is_some().then_some(Command::Measure(MeasureCommand::CancelScaling)),
    );
    commands.extend(
        session.features.tasks.measuring.is_some().then_some(Command::Measure(MeasureCommand::CancelUpscalers)),
    );
    app.queue(commands);
}

/// Checks that the program reports no internal error, and that no shape has a NaN position.
fn check(window: &Harness<'_, Workbench>) -> Result<(), Failure> {
    let session = window.state().session();
    if let Some(line) = session.features.messages.log.iter().find(|line| line.text.contains("internal error")) {
        let panic = panics::take_elsewhere().unwrap_or_default();
        return Err(Failure::Panic(format!("{panic} ({})", line.text)));
    }
    let is_lost = |shape: &ClippedShape| shape.clip_rect.any_nan() || has_nan_position(&shape.shape);
    match window.output().shapes.iter().find(|shape| is_lost(shape)) {
        None => Ok(()),
        Some(shape) => Err(Failure::Wrong(format!("shape at a position that is not a number: {shape:?}"))),
    }
}

/// Returns whether a shape or a part of it has a NaN position.
fn has_nan_position(shape: &Shape) -> bool {
    match shape {
        Shape::Vec(parts) => parts.iter().any(has_nan_position),
        // Empty text has no bounds.
        Shape::Text(text) => text.pos.any_nan(),
        shape => shape.visual_bounding_rect().any_nan(),
    }
}

/// Returns a random event as one line. Positions are in thousandths of the window's size.
fn event(rng: &mut Rng) -> String {
    let place = |rng: &mut Rng| format!("{} {}", rng.i32(-20..1020), rng.i32(-20..1020));
    // Half of the positions are over the picture.
    let place = |rng: &mut Rng| {
        if rng.bool() { format!("{} {}", rng.i32(250..740), rng.i32(150..700)) } else { place(rng) }
    };
    let mods = word(rng, &["-", "-", "-", "-", "c", "s", "cs", "a"]);
    match rng.u8(..24) {
        0..=2 => format!("move {}", place(rng)),
        3..=6 => format!("press {} {mods} {}", word(rng, &["primary", "primary", "secondary", "middle"]), place(rng)),
        7..=8 => format!("release {} {mods} {}", word(rng, &["primary", "primary", "secondary", "middle"]), place(rng)),
        9 => format!("wheel {mods} {} {}", pick(rng, &[0.0, 30.0]), pick(rng, &[-1e4, -50.0, 50.0, 400.0, 1e9])),
        10..=14 => format!("key {mods} {}", pick(rng, Key::ALL).name()),
        15 => format!(
            "text {}",
            word(rng, &["1", "12,5", "tri 0", "-1e39", "800% 3,3", "nan", "shading", "é\u{202e}", "/dev/null"])
        ),
        16 => {
            format!("resize {} {}", pick(rng, &[1, 40, 300, 900, 1280, 2600]), pick(rng, &[1, 40, 300, 560, 800, 1500]))
        }
        17 => word(rng, &["wait", "leave", "blur", "focus", "scale 0.5", "scale 2.5", "zoom 0.1", "zoom 8"]).to_owned(),
        _ => format!("click {}", rng.u16(..400)),
    }
}

/// Sends the event that a line describes. Skips invalid lines, which minimising an input may create.
fn act(window: &mut Harness<'_, Workbench>, line: &str, folder: &Path) {
    let (word, rest) = line.split_once(' ').unwrap_or((line, ""));
    let words: Vec<_> = rest.split(' ').collect();
    let size = window.input().screen_rect.map_or(WINDOW, |rect| rect.size());
    let number = |index: usize| words.get(index).and_then(|word| word.parse::<f32>().ok()).unwrap_or(0.0);
    let place = |index: usize| Pos2::ZERO + size * Vec2::new(number(index), number(index + 1)) / 1000.0;
    match word {
        "move" => window.event(Event::PointerMoved(place(0))),
        "press" | "release" => {
            let pos = place(2);
            let is_system_dialog =
                |node: &egui_kittest::Node<'_>| node.rect().contains(pos) && !node.rect().is_negative();
            if window.query_all_by_label(SYSTEM_DIALOG).any(|node| is_system_dialog(&node)) {
                return;
            }
            let button = match words[0] {
                "secondary" => PointerButton::Secondary,
                "middle" => PointerButton::Middle,
                _ => PointerButton::Primary,
            };
            let modifiers = modifiers(words.get(1));
            window.event(Event::PointerMoved(pos));
            window
                .event_modifiers(Event::PointerButton { pos, button, pressed: word == "press", modifiers }, modifiers);
        }
        "wheel" => {
            let modifiers = modifiers(words.first());
            let (unit, source, phase) = (MouseWheelUnit::Point, MouseWheelSource::Wheel, TouchPhase::Move);
            let delta = Vec2::new(number(1), number(2));
            window.event_modifiers(Event::MouseWheel { unit, delta, source, phase, modifiers }, modifiers);
        }
        "key" => {
            if let Some(key) = words.get(1).and_then(|name| Key::from_name(name)) {
                window.key_press_modifiers(modifiers(words.first()), key);
            }
        }
        "text" => window.event(Event::Text(rest.to_owned())),
        "resize" => drop(window.set_size(Vec2::new(number(0), number(1)))),
        "leave" => window.event(Event::PointerGone),
        "blur" | "focus" => window.event(Event::WindowFocused(word == "focus")),
        "scale" => window.ctx.set_zoom_factor(number(0)),
        "zoom" => window.event(Event::Zoom(number(0))),
        "click" => click(window, number(0) as usize),
        "drop" => window.input_mut().dropped_files.push(Arc::new(Dropped(folder.join(rest)))),
        _ => {}
    }
}

/// Clicks the widget with this number among all that can be clicked; `number` wraps around.
fn click(window: &Harness<'_, Workbench>, number: usize) {
    let is_clicked = |node: &egui_kittest::Node<'_>| {
        let node = node.accesskit_node();
        CLICKED.contains(&node.role()) && node.label().is_none_or(|label| label != SYSTEM_DIALOG)
    };
    let nodes: Vec<_> = window.root().children_recursive().filter(is_clicked).collect();
    if let Some(node) = number.checked_rem(nodes.len()).map(|index| &nodes[index]) {
        node.scroll_to_me();
        node.click();
    }
}

fn modifiers(word: Option<&&str>) -> Modifiers {
    let has = |letter: char| word.is_some_and(|word| word.contains(letter));
    Modifiers { alt: has('a'), ctrl: has('c'), shift: has('s'), mac_cmd: false, command: has('c') }
}

/// A file dropped on the window.
#[derive(Debug)]
struct Dropped(std::path::PathBuf);

impl eframe::egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}
