//! A workbench without a display that is driven as by a user: by pointer, keys and names in the accessibility tree.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use eframe::egui::{
    Event, Key, Modifiers, MouseWheelSource, MouseWheelUnit, PointerButton, Pos2, Rect, Role, TouchPhase, Vec2,
};
use egui_kittest::{Harness, kittest::Queryable as _};
use rasterscope::chain::{Frame, KeepDepth, RenderInputs, Renderer, run};
use rasterscope::image::{Image, Rgba8};
use rasterscope::inspect::Stage;
use rasterscope::measure::motion::Turn;
use rasterscope::pipeline::settings::Choice as _;
use rasterscope::scene::SceneSource;
use rasterscope::ui::app::Workbench;
use rasterscope::ui::engine::{RenderedView, Request};
use rasterscope::ui::session::command::Command;
use rasterscope::ui::session::workspace::{Panel, WorkspaceChange};
use rasterscope::ui::session::{PictureSize, Session};
use rasterscope::ui::theme;
use rasterscope::ui::worker::Worker;

/// Size of the window, in points and in pixels.
pub(crate) const WINDOW: Vec2 = Vec2::new(1280.0, 800.0);

pub(crate) struct Bench {
    pub(crate) window: Harness<'static, Workbench>,
}

impl Bench {
    /// Opens a window on a built-in scene with a synchronous renderer.
    pub(crate) fn new(scene: &str) -> Self {
        Self::with_worker(scene, Worker::inline())
    }

    /// Opens a window with a fixed picture of 160 × 90 px, which is drawn fast and shown enlarged, and whose
    /// measurements use a still view.
    pub(crate) fn small(scene: &str) -> Self {
        let mut bench = Self::new(scene);
        bench.session_mut().state.size = PictureSize::Fixed(160, 90);
        bench.session_mut().features.timings.turn = Turn::STILL;
        bench.session_mut().settle_silently();
        bench.rest();
        bench
    }

    pub(crate) fn with_worker(scene: &str, worker: Worker) -> Self {
        let source = SceneSource::named(scene.into());
        let loaded = source.load().unwrap().scene;
        let camera = loaded.home;
        let mut session = Session::new(Arc::new(loaded), source, rasterscope::chain::Recipe::default(), camera);
        // Smaller than the default, which tests with unoptimised code would draw slowly.
        session.state.size = PictureSize::Fixed(480, 270);
        session.settle_silently();
        let window = Harness::builder().with_size(WINDOW).with_step_dt(0.1).with_max_steps(24).build_eframe(|cc| {
            theme::install(&cc.egui_ctx);
            Workbench::new(session, worker)
        });
        let mut bench = Self { window };
        bench.rest();
        bench
    }

    /// Runs frames until the window is idle. Panics if it does not become idle.
    pub(crate) fn rest(&mut self) {
        self.window.run();
        // A frame requested at the end of a pass appears in the next pass.
        self.window.run();
    }

    pub(crate) fn session(&self) -> &Session {
        self.window.state().session()
    }

    pub(crate) fn session_mut(&mut self) -> &mut Session {
        self.window.state_mut().session_mut()
    }

    pub(crate) fn view(&self) -> &RenderedView {
        self.session().view.as_ref().expect("a frame was drawn")
    }

    /// Returns the finished picture of the frame on screen, even if a stage or a buffer is shown.
    pub(crate) fn image(&self) -> Image<Rgba8> {
        self.view().frame.image().clone()
    }

    /// Returns the frame for the current state of the window, drawn directly by the library.
    pub(crate) fn expected(&self) -> Frame {
        let Request { scene, camera, recipe, viewport, .. } = self.session().request();
        let mut frame = run(&scene, &camera, &recipe, viewport, &mut ());
        let mut renderer = Renderer::default();
        while frame.is_converging(&recipe) {
            frame = renderer
                .render(RenderInputs { scene: &scene, camera: &camera, recipe: &recipe, viewport }, KeepDepth::Yes);
        }
        frame
    }

    pub(crate) fn press(&mut self, key: Key) {
        self.press_with(Modifiers::NONE, key);
    }

    pub(crate) fn press_with(&mut self, modifiers: Modifiers, key: Key) {
        self.window.key_press_modifiers(modifiers, key);
        self.rest();
    }

    /// Clicks the button with this name, after scrolling it into view.
    pub(crate) fn click(&mut self, button: &str) {
        self.click_role(Role::Button, button);
    }

    /// Shows a panel, in the current workspace if it has the panel.
    pub(crate) fn show_panel(&mut self, panel: Panel) {
        self.window.state_mut().queue(vec![Command::Workspace(WorkspaceChange::Panel(panel))]);
        self.rest();
    }

    /// Selects a stage, so that the pipeline panel shows its switches.
    pub(crate) fn select(&mut self, stage: Stage) {
        self.click(&format!("{} stage", stage.name()));
        assert_eq!(self.session().features.stages.selected, stage);
    }

    /// Shows the picture after a stage, or the finished picture if it is already shown.
    pub(crate) fn click_eye(&mut self, stage: Stage) {
        self.click(&format!("Show the picture after “{}”", stage.name()));
    }

    /// Selects an option in the row with this label, which has a button per option or a drop-down list.
    pub(crate) fn choose(&mut self, row: &str, option: &str) {
        if self.window.query_by_role_and_label(Role::ComboBox, row).is_some() {
            self.click_role(Role::ComboBox, row);
        }
        self.click(option);
    }

    fn click_role(&mut self, role: Role, name: &str) {
        self.window.get_by_role_and_label(role, name).scroll_to_me();
        self.rest();
        self.window.get_by_role_and_label(role, name).click();
        self.rest();
    }

    /// Returns whether a label with exactly this text exists.
    pub(crate) fn says(&self, text: &str) -> bool {
        self.window.query_all_by_role_and_label(Role::Label, text).next().is_some()
    }

    /// Returns whether any element has a label that contains this text.
    pub(crate) fn mentions(&self, text: &str) -> bool {
        self.window.query_all_by_label_contains(text).next().is_some()
    }

    pub(crate) fn canvas(&self) -> Rect {
        self.window.get_by_role_and_label(Role::Image, "Rendered picture").rect()
    }

    /// Returns the screen position of a pixel's centre, in points. The picture must be fitted: centred, at the largest
    /// integer scale that fits.
    pub(crate) fn place_of(&self, (x, y): (u32, u32)) -> Pos2 {
        let canvas = self.canvas();
        let viewport = self.session().viewport();
        let size = Vec2::new(viewport.width as f32, viewport.height as f32);
        let scale = (canvas.width() / size.x).min(canvas.height() / size.y).floor();
        assert!(scale >= 1.0, "the picture fits");
        let corner = canvas.min + ((canvas.size() - size * scale) / 2.0).floor();
        corner + (Vec2::new(x as f32, y as f32) + Vec2::splat(0.5)) * scale
    }

    pub(crate) fn click_at(&mut self, position: Pos2) {
        self.drag(PointerButton::Primary, position, Vec2::ZERO);
    }

    pub(crate) fn click_at_with(&mut self, modifiers: Modifiers, position: Pos2) {
        self.window.hover_at(position);
        for pressed in [true, false] {
            let event = Event::PointerButton { pos: position, button: PointerButton::Primary, pressed, modifiers };
            self.window.event_modifiers(event, modifiers);
        }
        self.rest();
    }

    /// Presses a button at `from`, moves the pointer by `by` points, and releases the button.
    pub(crate) fn drag(&mut self, button: PointerButton, from: Pos2, by: Vec2) {
        self.window.hover_at(from);
        self.button(button, from, true);
        if by != Vec2::ZERO {
            self.window.hover_at(from + by / 2.0);
            self.window.hover_at(from + by);
        }
        self.button(button, from + by, false);
        self.rest();
    }

    fn button(&self, button: PointerButton, pos: Pos2, pressed: bool) {
        self.window.event(Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE });
    }

    /// Turns the mouse wheel by `points` at `position`; positive values zoom in.
    pub(crate) fn wheel(&mut self, position: Pos2, points: f32, modifiers: Modifiers) {
        self.window.hover_at(position);
        let (unit, source, phase) = (MouseWheelUnit::Point, MouseWheelSource::Wheel, TouchPhase::Move);
        let delta = Vec2::new(0.0, points);
        self.window.event_modifiers(Event::MouseWheel { unit, delta, source, phase, modifiers }, modifiers);
        self.rest();
    }

    pub(crate) fn drop_file(&mut self, path: &Path) {
        self.window.input_mut().dropped_files.push(dropped(path));
        self.rest();
    }
}

/// Returns the file at `path` as one that is dropped on the window.
pub(crate) fn dropped(path: &Path) -> Arc<Dropped> {
    Arc::new(Dropped(path.to_owned()))
}

#[derive(Debug)]
pub(crate) struct Dropped(PathBuf);

impl eframe::egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|e| e.to_string())
    }
}
