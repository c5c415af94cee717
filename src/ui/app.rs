//! Top level of the window. It lays out the panels, turns keys and dropped files into commands, applies the commands,
//! and exchanges messages with the renderer. It owns only the session, the worker and widget state; the session makes
//! all decisions about the picture.

mod idle_measurement;

mod input;

mod keeping;

mod opening;

mod perform;

mod pictures;

mod requests;

mod saving;

mod tasks;

use eframe::egui::{self, CentralPanel, Context, Panel, Ui};

use idle_measurement::UpscalerMeasurement;
use input::dropped_files;
use keeping::KeptWindow;
use opening::{Opening, SLOW_LOAD};
use pictures::PictureFiles;
use requests::SentRequests;
use saving::Saving;

use super::dialogs::Dialog;
use super::engine::Shown;
use super::manual::ManualWindow;
use super::panels::{PanelContext, PanelWidgets, menu, message, range};
use super::session::command::Command;
use super::session::fates::finder;
use super::session::layout::StoredLayouts;
use super::session::onboarding::Observed;
use super::session::workspace::{self, WorkspaceChange};
use super::session::{Session, checks, explaining, over_time};
use super::thumbnails::Thumbnails;
use super::worker::Worker;
use super::workspace::Docks;
use super::{motion, theme};

/// Height of the message bar at the bottom of the window, in points.
const MESSAGE_HEIGHT: f32 = theme::ROW_HEIGHT;

/// Application behind the window: session, render worker and widget state.
pub(crate) struct Workbench {
    session: Session,
    worker: Worker,
    /// Requests that the worker has received last.
    sent: SentRequests,
    /// Number of failures of upscaler processes that were reported.
    process_failures: usize,
    /// Measurements of all upscalers.
    measuring: UpscalerMeasurement,
    /// Model or case that is being opened.
    opening: Opening,
    /// Picture files that are being read, and the watch on those that are open.
    pictures: PictureFiles,
    /// Exports that are being written.
    saving: Saving,
    /// State of the widgets in the panels.
    widgets: PanelWidgets,
    /// Layouts of the workspaces.
    docks: Docks,
    dialog: Dialog,
    manual: ManualWindow,
    /// State of the window that is stored between runs.
    kept: KeptWindow,
    /// Commands queued from outside the window, applied in the next frame.
    queued: Vec<Command>,
}

impl Workbench {
    /// Creates the application with `worker` as its renderer. With an inline worker, models and cases are also loaded
    /// synchronously.
    pub(crate) fn new(session: Session, worker: Worker) -> Self {
        let is_synchronous = matches!(worker, Worker::Inline(_));
        Self {
            session,
            worker,
            sent: SentRequests::default(),
            process_failures: 0,
            measuring: UpscalerMeasurement::default(),
            opening: Opening::default(),
            pictures: PictureFiles::default(),
            saving: Saving::default(),
            widgets: PanelWidgets {
                is_synchronous,
                thumbnails: Thumbnails::new(is_synchronous),
                ..PanelWidgets::default()
            },
            docks: Docks::new(&StoredLayouts::default()),
            dialog: Dialog::default(),
            manual: ManualWindow::default(),
            kept: KeptWindow::default(),
            queued: Vec::new(),
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

    /// Queues commands for the next frame, as if the user had triggered them.
    pub(crate) fn queue(&mut self, commands: Vec<Command>) {
        self.queued.extend(commands);
    }

    /// Runs one frame of the window: receives responses, handles input, lays out the panels, applies commands and sends
    /// requests.
    pub(crate) fn show(&mut self, ui: &mut Ui) {
        motion::set_motion(ui.ctx(), self.session.features.appearance.reduces_motion());
        self.receive_answers();
        self.reload_changed_pictures(ui);
        let mut commands = std::mem::take(&mut self.queued);
        self.keys(ui, &mut commands);
        dropped_files(ui, &self.session, &mut commands);
        self.layout(ui, &mut commands);
        for command in commands {
            self.session.features.onboarding.observe_command(&command);
            self.run(ui, command);
        }
        self.session.features.onboarding.observe(Observed {
            zoom: self.widgets.canvas.scale(),
            shows_stage: matches!(self.session.shown, Shown::Stage(_)),
            compares: self.session.features.comparison.is_on(),
        });
        if !ui.input(|i| i.pointer.any_down()) {
            self.session.settle(ui.input(|i| i.time));
        }
        self.update_sequences(ui);
        self.send_request(ui);
        self.send_compare_request(ui);
        self.send_filmstrip_request(ui);
        let is_synchronous = self.widgets.is_synchronous;
        checks::step(&mut self.session, ui.ctx(), is_synchronous);
        over_time::step(&mut self.session, ui.ctx(), is_synchronous);
        explaining::step(&mut self.session, ui.ctx(), is_synchronous);
        let shows_fates = self.docks.shows(workspace::Panel::TriangleFates);
        finder::update(ui, &mut self.session, shows_fates, is_synchronous);
        self.send_what_if_request(ui);
        self.send_watch_request(ui);
        self.send_temporal_request(ui);
        self.measure_when_idle(ui);
    }

    fn layout(&mut self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let frame = theme::panel_frame(ui);
        let tight = frame.inner_margin(egui::Margin::symmetric(theme::space::S as i8, 2));
        Panel::top("menu")
            .frame(tight)
            .show(ui, |ui| menu::ui(ui, &self.session, &mut self.widgets.thumbnails, commands));
        Panel::bottom("message").frame(tight).exact_size(MESSAGE_HEIGHT).show(ui, |ui| {
            message::ui(ui, &self.session, self.opening.slow(), commands);
        });
        CentralPanel::no_frame().show(ui, |ui| {
            let context = PanelContext { session: &self.session, widgets: &mut self.widgets, commands };
            self.docks.ui(ui, self.session.workspace(), context);
        });
        self.session.features.canvas.size_px = self.widgets.canvas_px;
        // A workspace without the picture draws no filmstrip.
        let shows_picture = self.docks.shows(workspace::Panel::Picture);
        self.session.features.filmstrip.is_shown = self.widgets.shows_filmstrip && shows_picture;
        let shows_histogram = self.docks.shows(workspace::Panel::Histogram);
        range::notify_open(shows_histogram, &self.session, commands);
        self.widgets.mesh.hovered &= self.docks.shows(workspace::Panel::MeshView);
        self.dialog.ui(ui, &self.session, commands);
        self.manual.ui(ui, commands);
        if self.opening.is_running() {
            ui.request_repaint_after(SLOW_LOAD);
        }
    }
}

impl eframe::App for Workbench {
    /// Turns the Tab key into a command while the pointer is over the picture. Otherwise, the toolkit moves the focus.
    /// With reduced motion, also prevents smooth scrolling.
    fn raw_input_hook(&mut self, context: &Context, raw_input: &mut egui::RawInput) {
        if self.session.features.appearance.reduces_motion() {
            motion::split_wheel_events(context, raw_input);
        }
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
            self.session.features.timings.window.record(f64::from(seconds) * 1e3);
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
        self.kept.record_layout();
        self.save_preferences();
    }

    /// Returns `false`, so that the toolkit does not store the layout itself. The layout is part of the preferences
    /// file, which is replaced atomically.
    fn persist_egui_memory(&self) -> bool {
        false
    }
}
