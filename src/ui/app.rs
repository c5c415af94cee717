//! Top level of the window. It lays out the panels, turns keys and dropped files into commands, applies the commands,
//! and exchanges messages with the renderer. It owns only the session, the worker and widget state; the session makes
//! all decisions about the picture.

mod requests;

mod keeping;

mod opening;

mod saving;

mod tasks;

use std::time::{Duration, Instant};

use eframe::egui::{self, CentralPanel, Context, Panel, Ui};

use opening::{Loading, OpeningCase, SLOW_LOAD};
use saving::PendingExport;

use super::canvas::CanvasView;
use super::checks;
use super::command::{BINDINGS, Command};
use super::compare::compute::CompareRequest;
use super::compare::tiles::TilesView;
use super::compare::{self, CompareChange, Mode};
use super::engine::{Request, Shown};
use super::fates;
use super::fates::finder::Finder;
use super::lab;
use super::layout;
use super::long_tasks::{SavingsTask, ScalingTask, StabilityTask};
use super::manual::ManualWindow;
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
use super::range;
use super::scrub;
use super::session::{PointerMode, Session, Severity, WindowState};
use super::store::Store;
use super::task::BackgroundTask;
use super::theme;
use super::what_if;
use super::worker::{Worker, WorkerRequest};
use crate::inspect::Buffer;
use crate::inspect::find::{SearchResult, SearchTarget};
use crate::scene::SceneSource;
use crate::scene::obj::TrMeaning;

/// Height of the message bar below the menu, in points.
const MESSAGE_HEIGHT: f32 = theme::ROW_HEIGHT + 4.0;

/// Time after which a spinner is shown for an unanswered render request.
const SLOW_FRAME: Duration = Duration::from_millis(150);

/// Height of the bars above and below the canvas, in points.
const BAR_HEIGHT: f32 = theme::ROW_HEIGHT + 12.0;

/// Default height of the tabs along the bottom, in points.
const TABS_HEIGHT: f32 = 226.0;

/// Upper limit of the tabs' default height in low windows, as a fraction of the height that tabs and canvas share.
const TABS_SHARE: f32 = 0.34;

/// Upper limit of each side panel's default width in narrow windows, as a fraction of the window's width.
const SIDE_SHARE: f32 = 0.29;

/// Application behind the window: session, render worker and widget state.
pub(crate) struct Workbench {
    session: Session,
    worker: Worker,
    last_request: Option<Request>,
    /// Time at which the oldest unanswered render request was sent; `None` if all requests are answered.
    requested_at: Option<Instant>,
    /// Sequence number of the latest measurement of all upscalers; responses with another number are discarded.
    measurement: u64,
    loading: Option<Loading>,
    opening_case: Option<OpeningCase>,
    measuring_stability: Option<StabilityTask>,
    measuring_savings: Option<SavingsTask>,
    measuring_scaling: Option<ScalingTask>,
    case_view: CaseView,
    /// Exports that background threads are writing to files.
    saving: Vec<PendingExport>,
    canvas: CanvasView,
    mesh: MeshPane,
    tiles: TilesView,
    last_compare_request: Option<CompareRequest>,
    last_watch_request: Vec<(u32, u32)>,
    searching: Option<BackgroundTask<(), (SearchTarget, SearchResult)>>,
    inspector: Inspector,
    checks: checks::Runner,
    fates: Finder,
    dialog: Dialog,
    manual: ManualWindow,
    tab: Tab,
    /// Window state as of the last frame.
    window: WindowState,
    /// egui context of the window; `None` until the first frame.
    context: Option<Context>,
    /// Whether models and cases are loaded synchronously, as in screenshots and tests.
    is_synchronous: bool,
    /// Commands queued from outside the window, applied in the next frame.
    queued: Vec<Command>,
    /// Preferences on disk; `None` if nothing is stored, as in screenshots and tests.
    store: Option<Store>,
}

impl Workbench {
    /// Creates the application with `worker` as its renderer. With an inline worker, models and cases are also loaded
    /// synchronously.
    pub(crate) fn new(session: Session, worker: Worker) -> Self {
        let is_synchronous = matches!(worker, Worker::Inline(_));
        Self {
            session,
            worker,
            last_request: None,
            measurement: 0,
            loading: None,
            opening_case: None,
            measuring_stability: None,
            measuring_savings: None,
            measuring_scaling: None,
            case_view: CaseView::default(),
            saving: Vec::new(),
            requested_at: None,
            canvas: CanvasView::default(),
            mesh: MeshPane::default(),
            tiles: TilesView::default(),
            last_compare_request: None,
            last_watch_request: Vec::new(),
            searching: None,
            inspector: Inspector::default(),
            checks: checks::Runner::default(),
            fates: Finder::default(),
            dialog: Dialog::default(),
            manual: ManualWindow::default(),
            tab: Tab::default(),
            window: WindowState::default(),
            context: None,
            is_synchronous,
            queued: Vec::new(),
            store: None,
        }
    }

    /// Returns the session: scene, settings and view.
    pub(crate) fn session(&self) -> &Session {
        &self.session
    }

    /// Returns a mutable reference to the session, for code outside the window.
    pub(crate) fn session_mut(&mut self) -> &mut Session {
        &mut self.session
    }

    /// Opens a tab along the bottom.
    pub(crate) fn open_tab(&mut self, tab: Tab) {
        self.tab = tab;
    }

    /// Queues commands for the next frame, as if the user had triggered them.
    pub(crate) fn queue(&mut self, commands: Vec<Command>) {
        self.queued.extend(commands);
    }

    /// Runs one frame of the window: receives responses, handles input, lays out the panels, applies commands and sends
    /// requests.
    pub(crate) fn show(&mut self, ui: &mut Ui) {
        self.receive_answers();
        let mut commands = std::mem::take(&mut self.queued);
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
        self.send_request(ui);
        self.send_compare_request(ui);
        self.checks.step(&mut self.session, ui.ctx(), self.is_synchronous);
        self.fates.update(ui, &mut self.session, self.tab == Tab::Fates, self.is_synchronous);
        self.send_what_if_request(ui);
        self.send_watch_request(ui);
    }

    fn layout(&mut self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let frame = theme::panel_frame(ui);
        Panel::top("menu").frame(frame).show(ui, |ui| menu::ui(ui, &self.session, commands));
        let tight = frame.inner_margin(egui::Margin::symmetric(theme::space::S as i8, 2));
        Panel::top("message").frame(tight).exact_size(MESSAGE_HEIGHT).show(ui, |ui| {
            message::ui(ui, &self.session, self.slow_open(), commands);
        });
        if self.session.lab.open {
            lab::ui(ui, &self.session.lab, commands);
        } else {
            self.pipeline_layout(ui, frame, commands);
        }
        self.dialog.ui(ui, &self.session, commands);
        self.manual.ui(ui);
        if self.loading.is_some() || self.opening_case.is_some() {
            ui.request_repaint_after(SLOW_LOAD);
        }
    }

    /// Lays out everything below the message bar, except the 2D lab.
    fn pipeline_layout(&mut self, ui: &mut Ui, frame: egui::Frame, commands: &mut Vec<Command>) {
        // In a narrow window, the canvas keeps the largest share of the width.
        let share = |wanted: f32| wanted.min(ui.available_width() * SIDE_SHARE);
        let (left, right) = (share(292.0), share(316.0));
        let tabs = TABS_HEIGHT.min(ui.available_height() * TABS_SHARE).floor();
        Panel::bottom("tabs").frame(frame).resizable(true).default_size(tabs).min_size(bottom::MIN_HEIGHT).show(
            ui,
            |ui| {
                bottom::ui(ui, &mut self.tab, &self.session, commands);
            },
        );
        Panel::left("pipeline").frame(frame).resizable(true).default_size(left).min_size(230.0).show(ui, |ui| {
            pipeline::ui(ui, &self.session, commands);
        });
        Panel::right("inspector").frame(frame).resizable(true).default_size(right).min_size(250.0).show(ui, |ui| {
            self.inspector.ui(ui, &self.session, self.canvas.hovered, commands);
        });
        CentralPanel::default().frame(theme::canvas_frame(ui)).show(ui, |ui| {
            self.center(ui, commands);
        });
    }

    fn center(&mut self, ui: &mut Ui, commands: &mut Vec<Command>) {
        if self.session.case.is_none() {
            self.case_view = CaseView::default();
        }
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
                .show(ui, |ui| self.mesh.ui(ui, &self.session, self.is_synchronous, commands));
        } else {
            self.mesh.hovered = false;
        }
        CentralPanel::no_frame().show(ui, |ui| {
            let canvas = ui.max_rect();
            let size = if compares { TilesView::picture_size(canvas, &self.session) } else { ui.available_size() };
            let size = size * ui.pixels_per_point();
            self.session.canvas_px = (size.x.max(1.0) as u32, size.y.max(1.0) as u32);
            if self.session.case.is_some() {
                self.case_view.ui(ui, &self.session, self.is_synchronous, commands);
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

    /// Draws a spinner in the corner of the canvas if a render request has been unanswered for at least [`SLOW_FRAME`].
    fn busy_mark(&self, ui: &Ui) {
        let Some(since) = self.requested_at else { return };
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
            ui.painter().text(
                rect.center(),
                egui::Align2::CENTER_CENTER,
                "Drop the file to open it",
                font,
                egui::Color32::WHITE,
            );
        }
    }

    fn keys(&self, ui: &Ui, commands: &mut Vec<Command>) {
        // An open menu handles its own keys: Esc closes the menu and nothing else.
        if ui.egui_wants_keyboard_input() || self.dialog.is_open() || egui::Popup::is_any_open(ui.ctx()) {
            return;
        }
        // In camera mode, or while the pointer is over the mesh view, the flying keys (W A S D Q E) are reserved for
        // moving a camera and run no commands.
        let flies = self.session.pointer_mode == PointerMode::Camera || self.mesh.hovered;
        for binding in BINDINGS {
            let is_taken = flies && binding.modifiers == egui::Modifiers::NONE && FLYING_KEYS.contains(&binding.key);
            if !is_taken && ui.input_mut(|i| i.consume_shortcut(&binding.shortcut())) {
                commands.push((binding.command)());
            }
        }
        // The toolkit reports the copy shortcut as a separate event.
        if ui.input(|i| i.events.contains(&egui::Event::Copy)) {
            commands.push(Command::CopyPicture);
        }
    }

    fn run(&mut self, ui: &Ui, command: Command) {
        let Some(command) = self.session.apply(command) else { return };
        match command {
            Command::ShowFileDialog => self.dialog = Dialog::Open(OpenDialog::default()),
            Command::Open(path) => self.open(ui, SceneSource::File(path, TrMeaning::Auto)),
            Command::Reopen(path, tr) => self.open(ui, SceneSource::File(path, tr)),
            Command::OpenBuiltin(id) => self.open(ui, SceneSource::named(id.into())),
            Command::SaveCase => self.save_case(ui),
            Command::RunStability => self.measure_stability(ui),
            Command::Probe(change) => self.probe(ui, change),
            Command::MeasurePlan => self.measure_plan(ui),
            Command::CancelPlan => {
                if let Some(task) = &self.measuring_savings {
                    task.cancel();
                }
            }
            Command::MeasureScaling => self.measure_scaling(ui),
            Command::CancelScaling => {
                if let Some(task) = &self.measuring_scaling {
                    task.cancel();
                }
            }
            Command::CancelStability => {
                if let Some(judging) = &self.measuring_stability {
                    judging.cancel();
                }
            }
            Command::CancelLoading => {
                (self.loading, self.opening_case, self.session.places.pending) = (None, None, None);
            }
            Command::CancelExport => self.saving.iter().for_each(PendingExport::cancel),
            Command::Measure => self.measure(),
            Command::CancelMeasure => {
                self.session.measuring = None;
                self.worker.send(WorkerRequest::CancelMeasure);
            }
            Command::ExportTimings => self.export_timings(ui),
            Command::ZoomFit => self.canvas.fit(),
            Command::ZoomOne => {
                let viewport = self.session.viewport();
                self.canvas.one_to_one((viewport.width, viewport.height), self.session.canvas_px);
            }
            Command::StepFault(step) => self.step_fault(step > 0),
            Command::Trace(_) => self.tab = Tab::Arithmetic,
            Command::WhatIf(what_if::WhatIfChange::Step(step)) => {
                if let Some(pixel) = self.session.change_beside_pick(step > 0) {
                    self.session.pick = Some(pixel);
                    self.canvas.bring_into_view(pixel, self.session.canvas_px);
                }
            }
            Command::Overlays(overlays::OverlayChange::SaveTotals) => {
                self.save(ui, ("overlays", "csv"), overlays::save::totals(&self.session));
            }
            Command::Lab(lab::LabChange::Save(end)) => self.save_drawing(ui, end),
            Command::Lab(lab::LabChange::Picture(path)) => self.session.open_picture(&path),
            Command::SaveData => {
                if let Some(view) = what_if::visible_view(ui, &self.session) {
                    let (stem, encode) = range::save::data(view.clone());
                    self.save(ui, (stem, "pfm"), encode);
                }
            }
            Command::SavePicture => self.save_picture(ui),
            Command::SaveComparison => self.save_comparison(ui),
            Command::SaveOutline(kind, end) => self.save_outline(ui, kind, end),
            Command::CopyPicture => self.copy_picture(ui),
            Command::ToggleTheme => {
                let dark = ui.visuals().dark_mode;
                ui.ctx().set_theme(if dark { egui::Theme::Light } else { egui::Theme::Dark });
            }
            Command::SetScale(scale) => ui.ctx().set_zoom_factor(scale),
            Command::ToggleKeys => self.dialog = Dialog::Keys(String::new()),
            Command::OpenManual(chapter) => self.manual.open(chapter),
            Command::OpenTab(tab) => self.tab = tab,
            Command::OpenPalette => self.dialog = Dialog::Palette(Box::new(Palette::new(&self.session, ""))),
            Command::Place(place::PlaceChange::Manage) => self.dialog = Dialog::Bookmarks,
            Command::Place(place::PlaceChange::Find(SearchTarget::View(x, y, percent))) => {
                let center = (x as f32 + 0.5, y as f32 + 0.5);
                self.canvas.zoom.set_view(percent as f32 / 100.0, self.session.canvas_px, center);
            }
            Command::Place(place::PlaceChange::Find(wanted)) => self.search(ui, wanted),
            Command::Place(place::PlaceChange::Copy) => {
                ui.ctx().copy_text(self.session.command_line());
                self.session.report(Severity::Info, format!("Copied: {}", self.session.command_line()));
            }
            Command::ShowPixelDialog => self.dialog = Dialog::Pixel(String::new()),
            Command::Escape => self.escape(),
            _ => {}
        }
    }

    /// Picks the next or the previous fault (a crack or double hit), starting at the picked pixel, and brings it into
    /// view. If no faults are shown, shows the hit count instead.
    fn step_fault(&mut self, forwards: bool) {
        if self.session.shown != Shown::Buffer(Buffer::Hits) && self.session.overlays.stepped().is_none() {
            self.session.shown = Shown::Buffer(Buffer::Hits);
        } else if let Some((x, y)) = self.session.fault_beside_pick(forwards) {
            self.session.pick = Some((x, y));
            self.canvas.bring_into_view((x, y), self.session.canvas_px);
        }
    }

    fn escape(&mut self) {
        if self.manual.is_open() {
            self.manual.close();
            return;
        }
        if self.session.case.is_some() {
            self.session.close_case();
            return;
        }
        if !self.session.selection.is_empty() {
            self.session.apply(Command::Fates(fates::FatesChange::Clear));
            return;
        }
        if self.session.pick.take().is_some() {
            return;
        }
        if self.session.probing.hide() {
            return;
        }
        if self.session.comparison.is_on() {
            self.session.apply(Command::Compare(CompareChange::Mode(Mode::Off)));
        } else {
            self.session.shown = Shown::Buffer(Buffer::Color);
            self.session.apply(Command::LimitTriangles(None));
        }
    }
}

impl eframe::App for Workbench {
    fn ui(&mut self, ui: &mut Ui, frame: &mut eframe::Frame) {
        if let Some(seconds) = frame.info().cpu_usage {
            self.session.window_times.record(f64::from(seconds) * 1e3);
        }
        self.show(ui);
        self.observe_window(ui);
        self.save_preferences();
    }

    /// Saves the layout. The toolkit calls this every 30 seconds and when the window closes.
    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        // Earlier versions stored geometry and layout under these keys. If they still existed, the toolkit would
        // restore their values instead of those in the preferences.
        ["window", "egui"].into_iter().for_each(|key| storage.remove_string(key));
        if let Some(context) = &self.context {
            self.window.layout = layout::text(context);
        }
        self.save_preferences();
    }

    /// Returns `false`, so that the toolkit does not store the layout itself. The layout is part of the preferences
    /// file, which is replaced atomically.
    fn persist_egui_memory(&self) -> bool {
        false
    }
}

fn dropped_files(ui: &Ui, commands: &mut Vec<Command>) {
    if let Some(file) = ui.input(|i| i.raw.dropped_files.last().cloned()) {
        commands.push(Command::Open(file.path().to_owned()));
    }
}
