//! Top level of the window. It lays out the panels, turns keys and dropped files into commands, applies the commands,
//! and exchanges messages with the renderer. It owns only the session, the worker and widget state; the session makes
//! all decisions about the picture.

mod idle_measurement;

mod requests;

mod keeping;

mod opening;

mod saving;

mod tasks;

use eframe::egui::{self, CentralPanel, Context, Panel, Ui};

use idle_measurement::IdleMeasurement;
use opening::{Loading, OpeningCase, SLOW_LOAD};
use saving::{FolderTask, PendingExport};

use super::checks;
use super::command::{BINDINGS, Command};
use super::compare::compute::CompareRequest;
use super::compare::{CompareChange, Mode};
use super::engine::{Request, Shown};
use super::fates;
use super::fates::finder::Finder;
use super::lab;
use super::layout;
use super::long_tasks::{SavingsTask, ScalingTask, StabilityTask};
use super::manual::ManualWindow;
use super::navigate::FLYING_KEYS;
use super::onboarding::Observed;
use super::overlays;
use super::palette::Palette;
use super::panels::dialogs::{Dialog, OpenDialog};
use super::panels::{menu, message};
use super::place;
use super::range;
use super::save_as::{Destination, SaveItem};
use super::session::{PointerMode, Session, Severity, WindowState};
use super::store::Store;
use super::task::BackgroundTask;
use super::theme;
use super::thumbnails::Thumbnails;
use super::what_if;
use super::worker::{Worker, WorkerRequest};
use super::workspace::{self, Docks, PanelContext, PanelWidgets, StoredLayouts, WorkspaceChange};
use crate::inspect::Buffer;
use crate::inspect::find::{SearchResult, SearchTarget};
use crate::scene::SceneSource;
use crate::scene::obj::TrMeaning;

/// Height of the message bar at the bottom of the window, in points.
const MESSAGE_HEIGHT: f32 = theme::ROW_HEIGHT;

/// Application behind the window: session, render worker and widget state.
pub(crate) struct Workbench {
    session: Session,
    worker: Worker,
    last_request: Option<Request>,
    /// Number of failures of upscaler processes that were reported.
    process_failures: usize,
    /// Sequence number of the latest measurement of all upscalers; responses with another number are discarded.
    measurement: u64,
    /// Decides when a measurement starts by itself.
    idle: IdleMeasurement,
    loading: Option<Loading>,
    opening_case: Option<OpeningCase>,
    measuring_stability: Option<StabilityTask>,
    measuring_savings: Option<SavingsTask>,
    measuring_scaling: Option<ScalingTask>,
    /// Exports that background threads are writing to files.
    saving: Vec<PendingExport>,
    /// Task that opens the folder of a saved file.
    opening_folder: Option<FolderTask>,
    /// State of the widgets in the panels.
    widgets: PanelWidgets,
    /// Layouts of the workspaces.
    docks: Docks,
    last_compare_request: Option<CompareRequest>,
    last_filmstrip_request: Option<CompareRequest>,
    last_watch_request: Vec<(u32, u32)>,
    searching: Option<BackgroundTask<(), (SearchTarget, SearchResult)>>,
    checks: checks::Runner,
    fates: Finder,
    dialog: Dialog,
    manual: ManualWindow,
    /// Window state as of the last frame.
    window: WindowState,
    /// egui context of the window; `None` until the first frame.
    context: Option<Context>,
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
            process_failures: 0,
            measurement: 0,
            idle: IdleMeasurement::default(),
            loading: None,
            opening_case: None,
            measuring_stability: None,
            measuring_savings: None,
            measuring_scaling: None,
            saving: Vec::new(),
            opening_folder: None,
            widgets: PanelWidgets {
                is_synchronous,
                thumbnails: Thumbnails::new(is_synchronous),
                ..PanelWidgets::default()
            },
            docks: Docks::new(&StoredLayouts::default()),
            last_compare_request: None,
            last_filmstrip_request: None,
            last_watch_request: Vec::new(),
            searching: None,
            checks: checks::Runner::default(),
            fates: Finder::default(),
            dialog: Dialog::default(),
            manual: ManualWindow::default(),
            window: WindowState::default(),
            context: None,
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

    /// Shows a panel, in the current workspace if it has the panel.
    pub(crate) fn show_panel(&mut self, panel: workspace::Panel) {
        let workspace = self.docks.workspace_of(panel, self.session.workspace());
        self.session.show_workspace(workspace);
        self.docks.reveal(workspace, panel);
    }

    fn change_workspace(&mut self, ui: &Ui, change: WorkspaceChange) {
        let workspace = self.session.workspace();
        match change {
            WorkspaceChange::Show(workspace) => self.session.show_workspace(workspace),
            WorkspaceChange::Panel(panel) => self.show_panel(panel),
            WorkspaceChange::Maximize(panel) => self.docks.maximize(workspace, panel),
            WorkspaceChange::TogglePanels => self.docks.toggle_panels(workspace),
            WorkspaceChange::NextPanel => self.docks.focus_next(ui),
            WorkspaceChange::ResetLayout => self.docks.reset(workspace),
        }
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
            self.session.onboarding.observe_command(&command);
            self.run(ui, command);
            if let Some(pixel) = self.session.pick.filter(|_| nudges) {
                self.widgets.canvas.zoom.keep_in_view(pixel, self.widgets.visible_px);
            }
        }
        self.session.onboarding.observe(Observed {
            zoom: self.widgets.canvas.scale(),
            shows_stage: matches!(self.session.shown, Shown::Stage(_)),
            compares: self.session.comparison.is_on(),
        });
        if !ui.input(|i| i.pointer.any_down()) {
            self.session.settle(ui.input(|i| i.time));
        }
        self.send_request(ui);
        self.send_compare_request(ui);
        self.send_filmstrip_request(ui);
        self.checks.step(&mut self.session, ui.ctx(), self.widgets.is_synchronous);
        self.fates.update(
            ui,
            &mut self.session,
            self.docks.shows(workspace::Panel::TriangleFates),
            self.widgets.is_synchronous,
        );
        self.send_what_if_request(ui);
        self.send_watch_request(ui);
        self.measure_when_idle(ui);
    }

    fn layout(&mut self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let frame = theme::panel_frame(ui);
        let tight = frame.inner_margin(egui::Margin::symmetric(theme::space::S as i8, 2));
        Panel::top("menu")
            .frame(tight)
            .show(ui, |ui| menu::ui(ui, &self.session, &mut self.widgets.thumbnails, commands));
        Panel::bottom("message").frame(tight).exact_size(MESSAGE_HEIGHT).show(ui, |ui| {
            message::ui(ui, &self.session, self.slow_open(), commands);
        });
        CentralPanel::no_frame().show(ui, |ui| {
            let context = PanelContext { session: &self.session, widgets: &mut self.widgets, commands };
            self.docks.ui(ui, self.session.workspace(), context);
        });
        self.session.canvas_px = self.widgets.canvas_px;
        // A workspace without the picture draws no filmstrip.
        let shows_picture = self.docks.shows(workspace::Panel::Picture);
        self.session.filmstrip.is_shown = self.widgets.shows_filmstrip && shows_picture;
        let shows_histogram = self.docks.shows(workspace::Panel::Histogram);
        range::panel::notify_open(shows_histogram, &self.session, commands);
        self.widgets.mesh.hovered &= self.docks.shows(workspace::Panel::MeshView);
        self.dialog.ui(ui, &self.session, commands);
        self.manual.ui(ui);
        if self.loading.is_some() || self.opening_case.is_some() {
            ui.request_repaint_after(SLOW_LOAD);
        }
    }

    fn keys(&self, ui: &Ui, commands: &mut Vec<Command>) {
        // An open menu handles its own keys: Esc closes the menu and nothing else.
        if ui.text_edit_focused() || self.dialog.is_open() || egui::Popup::is_any_open(ui.ctx()) {
            return;
        }
        // A focused widget handles plain keys such as Space and the arrows itself.
        let has_focus = ui.egui_wants_keyboard_input();
        // In camera mode, or while the pointer is over the mesh view, the flying keys (W A S D Q E) are reserved for
        // moving a camera and run no commands.
        let flies = self.session.pointer_mode == PointerMode::Camera || self.widgets.mesh.hovered;
        for binding in BINDINGS {
            let is_flying = flies && binding.modifiers == egui::Modifiers::NONE && FLYING_KEYS.contains(&binding.key);
            let is_taken = is_flying || (has_focus && !binding.works_beside_focus());
            if !is_taken && ui.input_mut(|i| i.consume_shortcut(&binding.shortcut())) {
                commands.push((binding.command)());
            }
        }
        // The toolkit reports the copy shortcut as a separate event.
        if !has_focus && ui.input(|i| i.events.contains(&egui::Event::Copy)) {
            commands.push(Command::CopyPicture);
        }
    }

    fn run(&mut self, ui: &Ui, command: Command) {
        let Some(command) = self.session.apply(command) else { return };
        match command {
            Command::ShowFileDialog => self.dialog = Dialog::Open(OpenDialog::default()),
            Command::Open(path) => self.open(ui, SceneSource::File(path, TrMeaning::Auto)),
            Command::Reopen(path, tr) => self.open(ui, SceneSource::File(path, tr)),
            Command::OpenLesson(lesson) => self.open_lesson(ui, lesson),
            Command::OpenBuiltin(id) => self.open(ui, SceneSource::named(id.into())),
            Command::SaveAs(item) => self.ask_where_to_save(ui, item),
            Command::SaveTo(item, path) => self.save_item(ui, item, Destination::File(path)),
            Command::OpenFolder(file) => self.open_folder(ui, &file),
            Command::SaveCase => self.save_item(ui, SaveItem::Case, Destination::Automatic),
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
                self.idle.decline(self.session.request());
                self.session.tasks.measuring = None;
                self.worker.send(WorkerRequest::CancelMeasure);
            }
            Command::ClearTimings => {
                self.idle.decline(self.session.request());
                self.session.timings.clear();
            }
            Command::ExportTimings => self.save_item(ui, SaveItem::FrameTimes, Destination::Automatic),
            Command::ZoomFit => self.widgets.canvas.fit(),
            Command::ZoomOne => {
                let viewport = self.session.viewport();
                self.widgets.canvas.one_to_one((viewport.width, viewport.height), self.widgets.visible_px);
            }
            Command::StepFault(step) => self.step_fault(step > 0),
            Command::Trace(_) => self.show_panel(workspace::Panel::Calculation),
            Command::WhatIf(what_if::WhatIfChange::Step(step)) => {
                if let Some(pixel) = self.session.change_beside_pick(step > 0) {
                    self.session.pick = Some(pixel);
                    self.widgets.canvas.bring_into_view(pixel, self.widgets.visible_px);
                }
            }
            Command::Overlays(overlays::OverlayChange::SaveTotals) => {
                self.save_overlay_totals(ui);
            }
            Command::Lab(lab::LabChange::Save(end)) => {
                self.save_item(ui, SaveItem::LabDrawing(end), Destination::Automatic);
            }
            Command::Lab(lab::LabChange::Picture(path)) => self.session.open_picture(&path),
            Command::SaveData => self.save_item(ui, SaveItem::Values, Destination::Automatic),
            Command::SavePicture => self.save_item(ui, SaveItem::Picture, Destination::Automatic),
            Command::SaveComparison => self.save_item(ui, SaveItem::Comparison, Destination::Automatic),
            Command::SaveOutline(kind, end) => {
                self.save_item(ui, SaveItem::Outline(kind, end), Destination::Automatic);
            }
            Command::CopyPicture => self.copy_picture(ui),
            Command::ToggleTheme => {
                let dark = ui.visuals().dark_mode;
                ui.ctx().set_theme(if dark { egui::Theme::Light } else { egui::Theme::Dark });
            }
            Command::SetScale(scale) => ui.ctx().set_zoom_factor(scale),
            Command::ToggleKeys => self.dialog = Dialog::Keys(String::new()),
            Command::OpenManual(chapter) => self.manual.open(chapter),
            Command::Workspace(change) => self.change_workspace(ui, change),
            Command::OpenPalette => self.dialog = Dialog::Palette(Box::new(Palette::new(&self.session, ""))),
            Command::Place(place::PlaceChange::Manage) => self.dialog = Dialog::Bookmarks,
            Command::Place(place::PlaceChange::Find(SearchTarget::View(x, y, percent))) => {
                let center = (x as f32 + 0.5, y as f32 + 0.5);
                self.widgets.canvas.zoom.set_view(percent as f32 / 100.0, self.widgets.visible_px, center);
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
            self.widgets.canvas.bring_into_view((x, y), self.widgets.visible_px);
        }
    }

    fn escape(&mut self) {
        if self.manual.is_open() {
            self.manual.close();
            return;
        }
        if self.session.onboarding.escape() {
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
    /// Turns the Tab key into a command while the pointer is over the picture. Otherwise, the toolkit moves the focus.
    fn raw_input_hook(&mut self, context: &Context, raw_input: &mut egui::RawInput) {
        if self.widgets.canvas.hovered.is_none() || context.egui_wants_keyboard_input() {
            return;
        }
        let is_tab = |event: &egui::Event| matches!(event, egui::Event::Key { key: egui::Key::Tab, pressed: true, modifiers, .. } if modifiers.is_none());
        if raw_input.events.iter().any(is_tab) {
            raw_input.events.retain(|event| !is_tab(event));
            self.queued.push(Command::Workspace(WorkspaceChange::TogglePanels));
        }
    }

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
