//! The window's top: lays the panels out, turns keys and dropped files into commands, applies commands, and talks to the
//! renderer. It holds the session, the worker and what belongs to widgets only; every decision about the picture is in
//! the session.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::{Duration, Instant};

use eframe::egui::{self, CentralPanel, Panel, Ui};

use super::canvas::Canvas;
use super::checks;
use super::command::{BINDINGS, Command};
use super::compare::compute::CompareRequest;
use super::compare::tiles::TilesView;
use super::compare::{self, Change, Mode};
use super::engine::{Request, Shown};
use super::fates;
use super::fates::finder::Finder;
use super::judging::{Judging, MeasuringGrowth, MeasuringSavings};
use super::lab;
use super::mesh_view::MeshPane;
use super::navigate::FLYING_KEYS;
use super::overlays;
use super::palette::Palette;
use super::panels::bottom::Tab;
use super::panels::case::CaseView;
use super::panels::dialogs::{Dialog, OpenDialog};
use super::panels::inspector::Inspector;
use super::panels::{bottom, menu, message, pipeline, transport};
use super::place;
use super::probe;
use super::range;
use super::scrub;
use super::session::{Level, Measuring, PointerMode, Session};
use super::task::{Listening, Task};
use super::theme;
use super::what_if;
use super::worker::{Answer, Job, Worker};
use crate::case::{Case, MinimalCase};
use crate::drawing;
use crate::image::file::write_png;
use crate::inspect::Buffer;
use crate::inspect::find::{self, Found, Wanted};
use crate::inspect::outline::{OutlineKind, outline};
use crate::lab::drawing::write_recording;
use crate::measure::leaving_out::savings;
use crate::measure::scaling::{self, Quantity};
use crate::pipeline::settings::Choice as _;
use crate::report::stability::sweep::{self, Plan, Progress, Stage};
use crate::scene::obj::Loaded;
use crate::scene::{SceneError, SceneSource};

/// A model is called slow, and its progress shown, after this time.
const SLOW_LOAD: Duration = Duration::from_millis(300);

/// Height of the line under the menu, in points.
const MESSAGE_HEIGHT: f32 = theme::ROW_HEIGHT + 4.0;

/// A frame is called slow, and a mark turns, after this time.
const SLOW_FRAME: Duration = Duration::from_millis(150);

/// Height of the bars over and under the canvas, in points.
const BAR_HEIGHT: f32 = theme::ROW_HEIGHT + 12.0;

/// Height of the tabs along the bottom at first, in points.
const TABS_HEIGHT: f32 = 226.0;

/// Most of the window's height that they take at first.
const TABS_SHARE: f32 = 0.34;

/// Most of the window's width that each panel beside the canvas takes at first.
const SIDE_SHARE: f32 = 0.29;

/// A model that is being loaded on a thread of its own.
struct Loading {
    source: SceneSource,
    result: Receiver<Result<Loaded, SceneError>>,
    since: Instant,
}

/// The application.
pub struct Workbench {
    session: Session,
    worker: Worker,
    asked: Option<Request>,
    /// When the renderer was asked for something that is not there yet.
    asked_at: Option<Instant>,
    loading: Option<Loading>,
    judging: Option<Judging>,
    measuring_savings: Option<MeasuringSavings>,
    measuring_growth: Option<MeasuringGrowth>,
    case_view: CaseView,
    saving: Option<Receiver<Result<PathBuf, String>>>,
    canvas: Canvas,
    mesh: MeshPane,
    tiles: TilesView,
    asked_to_compare: Option<CompareRequest>,
    asked_to_watch: Vec<(u32, u32)>,
    finding: Option<Task<(), (Wanted, Found)>>,
    inspector: Inspector,
    checks: checks::Runner,
    fates: Finder,
    dialog: Dialog,
    tab: Tab,
    /// Whether the theme is light, and the interface scale, as last drawn: saving has no context to ask.
    look: (bool, f32),
    /// Whether models are loaded while the window waits, as screenshots and tests want it.
    waits: bool,
    /// What was asked for from outside of the window, to be done with the next frame.
    asked_for: Vec<Command>,
}

impl Workbench {
    /// Draws by `worker`.
    pub fn new(session: Session, worker: Worker) -> Self {
        let waits = matches!(worker, Worker::Inline(_));
        Self {
            session,
            worker,
            asked: None,
            loading: None,
            judging: None,
            measuring_savings: None,
            measuring_growth: None,
            case_view: CaseView::default(),
            saving: None,
            asked_at: None,
            canvas: Canvas::default(),
            mesh: MeshPane::default(),
            tiles: TilesView::default(),
            asked_to_compare: None,
            asked_to_watch: Vec::new(),
            finding: None,
            inspector: Inspector::default(),
            checks: checks::Runner::default(),
            fates: Finder::default(),
            dialog: Dialog::default(),
            tab: Tab::default(),
            look: (false, 1.0),
            waits,
            asked_for: Vec::new(),
        }
    }

    /// What the window knows.
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// What the window knows, to be changed from outside of it.
    pub fn session_mut(&mut self) -> &mut Session {
        &mut self.session
    }

    /// Opens a tab along the bottom.
    pub fn open_tab(&mut self, tab: Tab) {
        self.tab = tab;
    }

    /// Does all this with the next frame, as if a person had asked for it.
    pub fn ask_for(&mut self, commands: Vec<Command>) {
        self.asked_for.extend(commands);
    }

    /// One frame of the window.
    pub fn show(&mut self, ui: &mut Ui) {
        self.listen();
        let mut commands = std::mem::take(&mut self.asked_for);
        self.keys(ui, &mut commands);
        dropped_files(ui, &mut commands);
        self.layout(ui, &mut commands);
        for command in commands {
            let nudges = matches!(command, Command::NudgePick(..));
            self.run(ui, command);
            if let Some(pixel) = self.session.pick.filter(|_| nudges) {
                self.canvas.zoom.keep_in_view(pixel, self.session.canvas_px);
            }
        }
        if !ui.input(|i| i.pointer.any_down()) {
            self.session.settle(ui.input(|i| i.time));
        }
        self.ask(ui);
        self.ask_to_compare(ui);
        self.checks.step(&mut self.session, ui.ctx(), self.waits);
        self.fates.tend(ui, &mut self.session, self.tab == Tab::Fates, self.waits);
        self.ask_what_if(ui);
        self.ask_to_watch(ui);
        self.look = (!ui.visuals().dark_mode, ui.ctx().zoom_factor());
    }

    fn layout(&mut self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let frame = theme::panel_frame(ui);
        Panel::top("menu").frame(frame).show(ui, |ui| menu::ui(ui, &self.session, commands));
        let tight = frame.inner_margin(egui::Margin::symmetric(theme::space::S as i8, 2));
        Panel::top("message").frame(tight).exact_size(MESSAGE_HEIGHT).show(ui, |ui| {
            message::ui(ui, &self.session, self.slow_load(), commands);
        });
        if self.session.lab.open {
            lab::ui(ui, &self.session.lab, commands);
        } else {
            self.pipeline_layout(ui, frame, commands);
        }
        self.dialog.ui(ui, &self.session, commands);
        if self.loading.is_some() {
            ui.request_repaint_after(SLOW_LOAD);
        }
    }

    /// Everything below the message, but for the lab.
    fn pipeline_layout(&mut self, ui: &mut Ui, frame: egui::Frame, commands: &mut Vec<Command>) {
        // In a narrow window the canvas still has the largest share.
        let share = |wanted: f32| wanted.min(ui.available_width() * SIDE_SHARE);
        let (left, right) = (share(292.0), share(316.0));
        let tabs = TABS_HEIGHT.min(ui.available_height() * TABS_SHARE).floor();
        Panel::bottom("tabs").frame(frame).resizable(true).default_size(tabs).min_size(bottom::LEAST_HEIGHT).show(
            ui,
            |ui| {
                bottom::ui(ui, &mut self.tab, &self.session, commands);
            },
        );
        Panel::left("pipeline").frame(frame).resizable(true).default_size(left).min_size(230.0).show(ui, |ui| {
            egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| pipeline::ui(ui, &self.session, commands));
        });
        Panel::right("inspector").frame(frame).resizable(true).default_size(right).min_size(250.0).show(ui, |ui| {
            self.inspector.ui(ui, &self.session, self.canvas.hovered, commands);
        });
        CentralPanel::default().frame(theme::canvas_frame(ui)).show(ui, |ui| {
            self.center(ui, commands);
        });
    }

    fn center(&mut self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let frame = theme::panel_frame(ui);
        Panel::top("toolbar").frame(frame).exact_size(BAR_HEIGHT).show(ui, |ui| {
            transport::toolbar(ui, &self.session, self.canvas.scale(), commands);
        });
        Panel::bottom("scrubber").frame(frame).exact_size(scrub::transport::HEIGHT).show(ui, |ui| {
            scrub::transport::ui(ui, &self.session, commands);
        });
        let compares = self.session.comparison.is_on() && self.session.case.is_none();
        if compares {
            Panel::top("compare").frame(frame).show(ui, |ui| {
                compare::bar::ui(ui, &self.session, self.canvas.scale(), commands);
            });
        }
        let asks = self.session.what_if.open && !compares && self.session.case.is_none();
        if asks {
            Panel::top("what-if").frame(frame).show(ui, |ui| what_if::bar::ui(ui, &self.session, commands));
        }
        if self.session.mesh_view.open && self.session.case.is_none() {
            let half = ui.available_width() / 2.0;
            Panel::right("mesh")
                .frame(theme::canvas_frame(ui))
                .resizable(true)
                .default_size(half)
                .min_size(200.0)
                .show(ui, |ui| self.mesh.ui(ui, &self.session, self.waits, commands));
        } else {
            self.mesh.hovered = false;
        }
        CentralPanel::no_frame().show(ui, |ui| {
            let canvas = ui.max_rect();
            let size = if compares { TilesView::picture_size(canvas, &self.session) } else { ui.available_size() };
            let size = size * ui.pixels_per_point();
            self.session.canvas_px = (size.x.max(1.0) as u32, size.y.max(1.0) as u32);
            if self.session.case.is_some() {
                self.case_view.ui(ui, &self.session, commands);
            } else if compares {
                self.canvas.hovered = self.tiles.ui(ui, &mut self.canvas.zoom, &self.session, commands);
            } else {
                self.canvas.ui(ui, &self.session, commands);
                what_if::bar::label(ui, canvas, &self.session);
            }
            self.drop_hint(ui);
            self.busy_mark(ui);
        });
    }

    /// Turns in the canvas's corner while the renderer takes long enough to wonder.
    fn busy_mark(&self, ui: &Ui) {
        let Some(since) = self.asked_at else { return };
        if since.elapsed() >= SLOW_FRAME {
            let corner = ui.max_rect().right_top() + egui::vec2(-28.0, 8.0);
            egui::Spinner::new().paint_at(ui, egui::Rect::from_min_size(corner, egui::Vec2::splat(20.0)));
        } else {
            ui.request_repaint_after(SLOW_FRAME);
        }
    }

    fn drop_hint(&self, ui: &Ui) {
        if ui.input(|i| !i.raw.hovered_files.is_empty()) {
            let rect = ui.max_rect();
            ui.painter().rect_filled(rect, 0.0, egui::Color32::from_black_alpha(170));
            let font = egui::FontId::proportional(theme::font_size::TITLE);
            ui.painter().text(rect.center(), egui::Align2::CENTER_CENTER, "Drop to open", font, egui::Color32::WHITE);
        }
    }

    fn keys(&self, ui: &Ui, commands: &mut Vec<Command>) {
        // A key in an open menu is the menu's: Esc closes it, and drops nothing else.
        if ui.egui_wants_keyboard_input() || self.dialog.is_open() || egui::Popup::is_any_open(ui.ctx()) {
            return;
        }
        // In camera mode the letters that fly are no commands.
        let flies = self.session.pointer_mode == PointerMode::Camera || self.mesh.hovered;
        for binding in BINDINGS {
            let is_taken = flies && binding.modifiers == egui::Modifiers::NONE && FLYING_KEYS.contains(&binding.key);
            if !is_taken && ui.input_mut(|i| i.consume_shortcut(&binding.shortcut())) {
                commands.push((binding.command)());
            }
        }
        // The toolkit turns the key of copying into an event of its own.
        if ui.input(|i| i.events.contains(&egui::Event::Copy)) {
            commands.push(Command::CopyPicture);
        }
    }

    /// Takes what the renderer and the loader have ready.
    fn listen(&mut self) {
        while let Some(answer) = self.worker.poll() {
            self.hear(answer);
        }
        self.hear_tasks();
        if let Some(outcome) = self.saving.as_ref().and_then(|saving| saving.try_recv().ok()) {
            self.saving = None;
            self.saved(outcome);
        }
        if let Some(loading) = &self.loading {
            let source = loading.source.clone();
            match loading.result.try_recv() {
                Ok(result) => {
                    self.loading = None;
                    self.loaded(source, result);
                }
                Err(TryRecvError::Empty) => {}
                Err(TryRecvError::Disconnected) => {
                    self.loading = None;
                    let text = format!("Loading {} stopped by an error of the program", source.title());
                    self.session.report(Level::Error, text);
                }
            }
        }
    }

    fn hear(&mut self, answer: Answer) {
        match answer {
            Answer::View(view) => {
                if view.fresh && view.request.triangle_limit.is_none() {
                    let ms = view.frame.times.total.as_secs_f64() * 1e3;
                    self.session.timings.record_recent(&view.request, ms);
                }
                self.session.view = Some(*view);
                self.asked_at = None;
            }
            Answer::Compared(compared) => self.session.compared = Some(*compared),
            Answer::Watched(rows) => self.session.watch.hear(rows),
            Answer::WhatIf(found) => self.session.what_if.found = Some(*found),
            Answer::Stages(figures) => self.session.stages = Some(*figures),
            Answer::Sample { upscaling, milliseconds, progress } => {
                self.session.measuring = self.session.measuring.map(|_| Measuring { progress });
                self.session.timings.record_measured(upscaling, milliseconds);
            }
            Answer::Judged { upscaling, error } => self.session.timings.record_error(upscaling, *error),
            Answer::Measured => self.session.measuring = None,
            Answer::Panicked(text) => {
                let text = format!("Drawing stopped by an error of the program: {text}. The last good picture stays.");
                self.session.report(Level::Error, text);
            }
        }
    }

    /// Sends a request if something has changed that it depends on.
    fn ask(&mut self, ui: &Ui) {
        self.session.pick_by_itself();
        let request = self.session.request();
        let same = self.asked.as_ref().is_some_and(|asked| asked.same_view(&request));
        if !same && self.session.canvas_px != (0, 0) {
            self.asked = Some(request.clone());
            self.asked_at.get_or_insert_with(Instant::now);
            self.worker.send(Job::Show(Box::new(request)));
            if self.waits {
                self.listen();
                ui.request_repaint();
            }
        }
    }

    /// Sends what is to be compared if that has changed.
    fn ask_to_compare(&mut self, ui: &Ui) {
        let request = self.session.compare_request().filter(|_| self.session.canvas_px != (0, 0));
        let same = match (&self.asked_to_compare, &request) {
            (Some(asked), Some(request)) => asked.same_as(request),
            (asked, request) => asked.is_none() && request.is_none(),
        };
        if same {
            return;
        }
        if request.is_none() {
            self.session.compared = None;
        }
        self.asked_to_compare = request.clone();
        self.worker.send(Job::Compare(request.map(Box::new)));
        if self.waits {
            self.listen();
            ui.request_repaint();
        }
    }

    /// Says which pixels are watched if that has changed.
    fn ask_to_watch(&mut self, ui: &Ui) {
        if self.asked_to_watch != self.session.watch.pixels {
            self.asked_to_watch.clone_from(&self.session.watch.pixels);
            self.worker.send(Job::Watch(self.asked_to_watch.clone()));
            if self.waits {
                self.listen();
                ui.request_repaint();
            }
        }
    }

    /// Looks for something in the frame on screen, on a thread of its own.
    fn find(&mut self, ui: &Ui, wanted: Wanted) {
        let Some(view) = self.session.view.clone() else { return };
        let look = move || {
            let found = find::find(&view.request.scene, &view.request.recipe, &view.frame, &wanted);
            (wanted, found)
        };
        if self.waits {
            self.found(&look());
        } else {
            self.finding = Some(Task::start(ui.ctx().clone(), move |_, _| Some(look())));
        }
    }

    fn found(&mut self, (wanted, found): &(Wanted, Found)) {
        if let Some(pixel) = self.session.take_found(wanted, found) {
            self.canvas.bring_into_view(pixel, self.session.canvas_px);
        }
    }

    /// Asks what a change did if that is looked at and something is new.
    fn ask_what_if(&mut self, ui: &Ui) {
        let request = self.session.what_if_request().filter(|_| self.session.canvas_px != (0, 0));
        if self.session.what_if.asks_anew(request.as_ref()) {
            self.worker.send(Job::WhatIf(request.map(Box::new)));
            if self.waits {
                self.listen();
                ui.request_repaint();
            }
        }
    }

    fn run(&mut self, ui: &Ui, command: Command) {
        let Some(command) = self.session.apply(command) else { return };
        match command {
            Command::AskForFile => self.dialog = Dialog::Open(OpenDialog::default()),
            Command::Open(path) => self.open(ui, SceneSource::File(path)),
            Command::OpenBuiltin(id) => self.open(ui, SceneSource::named(id.into())),
            Command::SaveCase => self.save_case(),
            Command::RunStability => self.judge(ui),
            Command::Probe(change) => self.probe(ui, change),
            Command::MeasurePlan => self.measure_plan(ui),
            Command::CancelPlan => {
                if let Some(task) = &self.measuring_savings {
                    task.cancel();
                }
            }
            Command::MeasureGrowth => self.measure_growth(ui),
            Command::CancelGrowth => {
                if let Some(task) = &self.measuring_growth {
                    task.cancel();
                }
            }
            Command::CancelStability => {
                if let Some(judging) = &self.judging {
                    judging.cancel();
                }
            }
            Command::CancelLoading => (self.loading, self.session.places.pending) = (None, None),
            Command::Measure => self.measure(),
            Command::CancelMeasure => {
                self.session.measuring = None;
                self.worker.send(Job::CancelMeasure);
            }
            Command::ExportTimings => self.export_timings(),
            Command::ZoomFit => self.canvas.fit(),
            Command::ZoomOne => {
                let viewport = self.session.viewport();
                self.canvas.one_to_one((viewport.width, viewport.height), self.session.canvas_px);
            }
            Command::StepFault(step) => self.step_fault(step > 0),
            Command::Trace(_) => self.tab = Tab::Arithmetic,
            Command::WhatIf(what_if::Change::Step(step)) => {
                if let Some(pixel) = self.session.change_beside_pick(step > 0) {
                    self.session.pick = Some(pixel);
                    self.canvas.bring_into_view(pixel, self.session.canvas_px);
                }
            }
            Command::Overlays(overlays::Change::SaveTotals) => self.save(ui, overlays::save::totals(&self.session)),
            Command::Lab(lab::Change::Save(end)) => self.save_drawing(ui, end),
            Command::Lab(lab::Change::Picture(path)) => self.session.open_picture(&path),
            Command::SaveData => self.save(ui, range::save::data(&self.session)),
            Command::SavePicture => self.save_picture(ui),
            Command::SaveOutline(kind, end) => self.save_outline(ui, kind, end),
            Command::CopyPicture => self.copy_picture(ui),
            Command::ToggleTheme => {
                let dark = ui.visuals().dark_mode;
                ui.ctx().set_theme(if dark { egui::Theme::Light } else { egui::Theme::Dark });
            }
            Command::SetScale(scale) => ui.ctx().set_zoom_factor(scale),
            Command::ToggleKeys => self.dialog = Dialog::Keys(String::new()),
            Command::OpenTab(tab) => self.tab = tab,
            Command::OpenStages(open) => pipeline::open_all(ui, open),
            Command::OpenPalette => self.dialog = Dialog::Palette(Box::new(Palette::new(&self.session, ""))),
            Command::Place(place::Change::Manage) => self.dialog = Dialog::Bookmarks,
            Command::Place(place::Change::Find(Wanted::View(x, y, percent))) => {
                let center = (x as f32 + 0.5, y as f32 + 0.5);
                self.canvas.zoom.set_view(percent as f32 / 100.0, self.session.canvas_px, center);
            }
            Command::Place(place::Change::Find(wanted)) => self.find(ui, wanted),
            Command::Place(place::Change::Copy) => {
                ui.ctx().copy_text(self.session.command_line());
                self.session.report(Level::Info, format!("Copied: {}", self.session.command_line()));
            }
            Command::AskForPixel => self.dialog = Dialog::Pixel(String::new()),
            Command::Escape => self.escape(),
            _ => {}
        }
    }

    /// Picks the fault after or before the picked pixel and brings it into view; shows the hit count first if it is not shown.
    fn step_fault(&mut self, forwards: bool) {
        if self.session.shown != Shown::Buffer(Buffer::Hits) && self.session.overlays.stepped().is_none() {
            self.session.shown = Shown::Buffer(Buffer::Hits);
        } else if let Some((x, y)) = self.session.fault_beside_pick(forwards) {
            self.session.pick = Some((x, y));
            self.canvas.bring_into_view((x, y), self.session.canvas_px);
        }
    }

    fn escape(&mut self) {
        if self.session.case.take().is_some() {
            return;
        }
        if !self.session.selection.is_empty() {
            self.session.apply(Command::Fates(fates::Change::Clear));
            return;
        }
        if self.session.pick.take().is_some() {
            return;
        }
        if self.session.probing.hide() {
            return;
        }
        if self.session.comparison.is_on() {
            self.session.apply(Command::Compare(Change::Mode(Mode::Off)));
        } else {
            self.session.shown = Shown::Buffer(Buffer::Color);
            self.session.apply(Command::LimitTriangles(None));
        }
    }

    /// Starts timing all upscalers on what is shown.
    pub fn measure(&mut self) {
        let request = Request { triangle_limit: None, fragment_limit: None, ..self.session.request() };
        self.session.timings.begin_measurement(request.clone());
        self.session.measuring = Some(Measuring { progress: 0.0 });
        if self.tab != Tab::ErrorTime {
            self.tab = Tab::FrameTime;
        }
        self.worker.send(Job::Measure(Box::new(request)));
    }

    /// Writes all frame times into the current folder.
    fn export_timings(&mut self) {
        let path = free_name(&self.session.folder, "frame-times", "csv");
        match std::fs::write(&path, self.session.timings.csv()) {
            Ok(()) => {
                self.session.report(Level::Info, format!("Saved the frame times as {}", path.display()));
                self.tab = Tab::Log;
            }
            Err(error) => self.session.report(Level::Error, format!("{}: {error}", path.display())),
        }
    }

    /// Makes the stability report on a thread of its own.
    fn judge(&mut self, ui: &Ui) {
        self.tab = Tab::Stability;
        self.session.stability.progress = Some(Progress { stage: Stage::Judging, done: 0, of: 1 });
        let plan = Plan::default();
        self.judging = Some(Task::start(ui.ctx().clone(), move |tell, stop| sweep::run(&plan, tell, stop)));
    }

    /// Measures what the plan of the present view saves.
    fn measure_plan(&mut self, ui: &Ui) {
        /// Rounds that count.
        const ROUNDS: usize = 21;
        let request = self.session.request();
        self.session.savings.progress = Some(0.0);
        self.measuring_savings = Some(Task::start(ui.ctx().clone(), move |tell, stop| {
            let Request { scene, camera, recipe, viewport, .. } = &request;
            savings(scene, camera, recipe, *viewport, ROUNDS, tell, stop)
        }));
    }

    /// Measures how cost grows, with the present recipe.
    fn measure_growth(&mut self, ui: &Ui) {
        /// Triangles at most, and rounds that count: it shall take seconds, not minutes.
        const MOST: (usize, usize) = (1_000_000, 7);
        let recipe = self.session.state.recipe;
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        self.session.growth.progress = Some((Quantity::Triangles, 0.0));
        self.measuring_growth = Some(Task::start(ui.ctx().clone(), move |tell, stop| {
            let plan = scaling::Plan::new(recipe, MOST.0, threads, MOST.1);
            scaling::measure(&plan, &|quantity, share| tell((quantity, share)), stop).ok()
        }));
    }

    /// Takes what long measurements have said.
    fn hear_tasks(&mut self) {
        probe::listen(&mut self.session);
        let session = &mut self.session;
        let broke_off = hear(&mut self.judging, &mut session.stability.progress, |report| {
            session.stability.report = Some(Arc::from(report));
        });
        let name = &session.scene.name;
        let broke_off = broke_off
            | hear(&mut self.measuring_savings, &mut session.savings.progress, |found| {
                session.savings.found = Some((Arc::from(found), name.clone()));
            })
            | hear(&mut self.measuring_growth, &mut session.growth.progress, |found| {
                session.growth.found = Some(Arc::from(found));
            });
        let mut found = None;
        let broke_off = broke_off | hear(&mut self.finding, &mut None, |what| found = Some(what));
        if broke_off {
            session.report(Level::Error, "A measurement stopped by an error of the program");
        }
        if let Some(what) = found {
            self.found(&what);
        }
    }

    /// Changes what is known of how firmly the picture stands.
    fn probe(&mut self, ui: &Ui, change: probe::Change) {
        match probe::apply(&mut self.session, ui.ctx(), change) {
            probe::Rest::Nothing => {}
            probe::Rest::BringIntoView(pixel) => self.canvas.bring_into_view(pixel, self.session.canvas_px),
            probe::Rest::Write(case) => self.write_case(&case),
        }
    }

    /// Writes the triangle that the picked pixel shows as a case into the current folder.
    fn save_case(&mut self) {
        let Some(view) = &self.session.view else { return };
        let visible = view.report.as_ref().and_then(|report| Some((report.drawn_at, report.visible()?.submission)));
        let Some(([x, y], submission)) = visible else {
            self.session
                .report(Level::Error, "Pick a pixel that shows a triangle first: that triangle becomes the case");
            return;
        };
        let settings = &view.request.recipe.pipeline;
        let triangle = &view.frame.geometry.triangles[submission];
        let minimal = MinimalCase::new(triangle, (x, y), view.frame.viewport, settings, &view.request.scene.name);
        self.write_case(&minimal);
    }

    fn write_case(&mut self, minimal: &MinimalCase) {
        let path = free_name(&self.session.folder, &minimal.id, "json");
        match std::fs::write(&path, minimal.to_json()) {
            Ok(()) => {
                self.session.report(Level::Info, format!("Saved {} as the case {}", minimal.id, path.display()));
                self.tab = Tab::Log;
            }
            Err(error) => self.session.report(Level::Error, format!("{}: {error}", path.display())),
        }
    }

    fn open(&mut self, ui: &Ui, source: SceneSource) {
        if let SceneSource::File(path) = &source
            && path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json"))
        {
            match Case::read(path) {
                Ok(case) => self.session.show_case(case),
                Err(error) => self.session.report(Level::Error, error.to_string()),
            }
            return;
        }
        if self.waits {
            let result = source.load();
            self.loaded(source, result);
            return;
        }
        let (sender, result) = channel();
        let (context, wanted) = (ui.ctx().clone(), source.clone());
        std::thread::spawn(move || {
            // Nobody listens any more if loading was cancelled.
            drop(sender.send(wanted.load()));
            context.request_repaint();
        });
        self.loading = Some(Loading { source, result, since: Instant::now() });
        ui.request_repaint_after(SLOW_LOAD);
    }

    fn loaded(&mut self, source: SceneSource, result: Result<Loaded, SceneError>) {
        match result {
            Ok(Loaded { scene, warnings }) => {
                self.session.show_scene(scene, source);
                self.worker.send(Job::CancelMeasure);
                self.canvas.fit();
                self.warn(&warnings);
            }
            Err(error) => {
                self.session.places.pending = None;
                self.session.report(Level::Error, error.to_string());
            }
        }
    }

    /// Writes the loader's warnings into the log.
    pub fn warn(&mut self, warnings: &[crate::scene::Warning]) {
        for warning in warnings {
            self.session.report(Level::Warning, warning.to_string());
        }
        if !warnings.is_empty() {
            self.tab = Tab::Log;
        }
    }

    fn slow_load(&self) -> Option<&Path> {
        let loading = self.loading.as_ref()?;
        match &loading.source {
            SceneSource::File(path) if loading.since.elapsed() >= SLOW_LOAD => Some(path),
            _ => None,
        }
    }

    /// Writes the picture on a thread of its own: encoding a large one takes a while.
    fn save_picture(&mut self, ui: &Ui) {
        let Some(view) = &self.session.view else { return };
        let picture = view.picture.clone();
        let path = free_name(&self.session.folder, "picture", "png");
        self.save(ui, move || write_png(&path, &picture).map(|()| path).map_err(|error| error.to_string()));
    }

    /// Writes the scene on screen as drawing commands.
    fn save_outline(&mut self, ui: &Ui, kind: OutlineKind, end: &'static str) {
        let Request { scene, camera, recipe, viewport, .. } = self.session.request();
        let path = free_name(&self.session.folder, kind.id(), end);
        self.save(ui, move || {
            let drawing = outline(&scene, &camera, &recipe, viewport, kind);
            drawing::file::write(&path, &drawing, 1.0).map(|()| path).map_err(|error| error.to_string())
        });
    }

    /// Writes what the lab shows.
    fn save_drawing(&mut self, ui: &Ui, end: &'static str) {
        let lab = &self.session.lab;
        let (recording, step) = (lab.recording.clone(), lab.step);
        let path = free_name(&self.session.folder, lab.page.id(), end);
        self.save(ui, move || {
            write_recording(&path, &recording, step).map(|()| path).map_err(|error| error.to_string())
        });
    }

    /// Runs what writes a file, on a thread of its own.
    fn save(&mut self, ui: &Ui, write: impl FnOnce() -> Result<PathBuf, String> + Send + 'static) {
        let context = ui.ctx().clone();
        let (sender, result) = channel();
        let save = move || {
            // The window may be gone by now.
            drop(sender.send(write()));
            context.request_repaint();
        };
        if self.waits {
            save();
        } else {
            std::thread::spawn(save);
        }
        self.saving = Some(result);
    }

    fn saved(&mut self, outcome: Result<PathBuf, String>) {
        match outcome {
            Ok(path) => {
                self.session.report(Level::Info, format!("Saved {}", path.display()));
                self.tab = Tab::Log;
            }
            Err(error) => self.session.report(Level::Error, error),
        }
    }

    fn copy_picture(&mut self, ui: &Ui) {
        if let Some(view) = &self.session.view {
            let (width, height) = view.picture.size();
            let size = [width as usize, height as usize];
            ui.ctx().copy_image(egui::ColorImage::from_rgba_premultiplied(size, view.picture.as_bytes()));
            self.session.report(Level::Info, format!("Copied the picture, {width} × {height} px"));
        }
    }
}

impl eframe::App for Workbench {
    fn ui(&mut self, ui: &mut Ui, frame: &mut eframe::Frame) {
        if let Some(seconds) = frame.info().cpu_usage {
            self.session.window_times.record(f64::from(seconds) * 1e3);
        }
        self.show(ui);
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        let preferences = self.session.preferences(self.look.0, self.look.1);
        eframe::set_value(storage, eframe::APP_KEY, &preferences);
    }
}

fn dropped_files(ui: &Ui, commands: &mut Vec<Command>) {
    if let Some(file) = ui.input(|i| i.raw.dropped_files.last().cloned()) {
        commands.push(Command::Open(file.path().to_owned()));
    }
}

/// `stem.extension`, or the first free `stem-2.extension`, `stem-3.extension` … in `folder`.
pub(super) fn free_name(folder: &Path, stem: &str, extension: &str) -> PathBuf {
    let first = folder.join(format!("{stem}.{extension}"));
    if !first.exists() {
        return first;
    }
    (2..).map(|n| folder.join(format!("{stem}-{n}.{extension}"))).find(|p| !p.exists()).unwrap_or(first)
}

/// Takes what a task has said; whether it broke off.
fn hear<P: Send + 'static, T: Send + 'static>(
    task: &mut Option<Task<P, T>>,
    progress: &mut Option<P>,
    done: impl FnOnce(Box<T>),
) -> bool {
    let Some(running) = task else { return false };
    let listening = running.listen(progress);
    if !matches!(listening, Listening::GoesOn) {
        *task = None;
    }
    match listening {
        Listening::GoesOn => false,
        Listening::Ended(result) => {
            if let Some(result) = result {
                done(result);
            }
            false
        }
        Listening::BrokeOff => true,
    }
}
