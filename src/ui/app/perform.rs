//! Completes the tasks that the session leaves to the window.

use eframe::egui::{self, Ui};

use super::Workbench;
use super::opening::Opening;
use crate::scene::SceneSource;
use crate::scene::obj::TrMeaning;
use crate::ui::dialogs::{Dialog, OpenDialog};
use crate::ui::palette::Palette;
use crate::ui::panels::add_upscaler::AddUpscalerDialog;
use crate::ui::session::command::Command;
use crate::ui::session::file_command::FileCommand;
use crate::ui::session::probe;
use crate::ui::session::save_item::{Destination, SaveItem};
use crate::ui::session::window_task::{DialogCommand, MeasureTask, WindowTask};
use crate::ui::session::workspace::WorkspaceChange;
use crate::ui::worker::WorkerRequest;

impl Workbench {
    /// Applies a command to the session, and completes it.
    pub(super) fn run(&mut self, ui: &Ui, command: Command) {
        if let Some(task) = self.session.apply(command) {
            self.perform(ui, task);
        }
    }

    fn perform(&mut self, ui: &Ui, task: WindowTask) {
        let visible_px = self.widgets.visible_px;
        match task {
            WindowTask::File(command) => self.perform_file_command(ui, command),
            WindowTask::Save(item) => self.save_item(ui, item, Destination::Automatic),
            WindowTask::SaveCase(case) => self.write_case(ui, &case, Destination::Automatic),
            WindowTask::SaveOverlayTotals => self.save_overlay_totals(ui),
            WindowTask::Measure(task) => self.perform_measure_task(ui, task),
            WindowTask::CancelReplay => self.worker.send(WorkerRequest::CancelReplay),
            WindowTask::DeclineMeasurement => self.measuring.idle.decline(self.session.request()),
            WindowTask::StartProbe => probe::start(&mut self.session, ui.ctx()),
            WindowTask::Dialog(command) => self.show_dialog(command),
            WindowTask::Search(wanted) => self.search(ui, wanted),
            WindowTask::CopyText(text) => ui.ctx().copy_text(text),
            WindowTask::ToggleTheme => {
                let dark = ui.visuals().dark_mode;
                ui.ctx().set_theme(if dark { egui::Theme::Light } else { egui::Theme::Dark });
            }
            WindowTask::SetScale(scale) => ui.ctx().set_zoom_factor(scale),
            WindowTask::Workspace(change) => self.change_workspace(ui, change),
            WindowTask::ShowPanel(panel) => self.show_panel(panel),
            WindowTask::Fit => self.widgets.canvas.fit(),
            WindowTask::OneToOne => {
                let viewport = self.session.viewport();
                self.widgets.canvas.one_to_one((viewport.width, viewport.height), visible_px);
            }
            WindowTask::ShowAt(x, y, percent) => {
                let center = (x as f32 + 0.5, y as f32 + 0.5);
                self.widgets.canvas.zoom.set_view(percent as f32 / 100.0, visible_px, center);
            }
            WindowTask::BringIntoView(pixel) => self.widgets.canvas.bring_into_view(pixel, visible_px),
            WindowTask::KeepInView(pixel) => self.widgets.canvas.zoom.keep_in_view(pixel, visible_px),
            WindowTask::Escape => {
                if self.manual.is_open() {
                    self.manual.close();
                } else {
                    self.session.escape();
                }
            }
        }
    }

    fn perform_file_command(&mut self, ui: &Ui, command: FileCommand) {
        let mut save = |item| self.save_item(ui, item, Destination::Automatic);
        match command {
            FileCommand::Open(path) => self.open(ui, SceneSource::File(path, TrMeaning::Auto)),
            FileCommand::OpenPicture(role, path) => self.open_picture(ui, role, &path),
            FileCommand::Reopen(path, tr) => self.open(ui, SceneSource::File(path, tr)),
            FileCommand::OpenBuiltin(id) => self.open(ui, SceneSource::named(id.into())),
            FileCommand::OpenLesson(lesson) => self.open_lesson(ui, lesson),
            FileCommand::CancelLoading => {
                self.opening = Opening::default();
                self.session.features.places.pending = None;
            }
            FileCommand::CancelExport => self.saving.cancel(),
            FileCommand::SaveAs(item) => self.ask_where_to_save(ui, item),
            FileCommand::SaveTo(item, path) => self.save_item(ui, item, Destination::File(path)),
            FileCommand::OpenFolder(file) => self.open_folder(ui, &file),
            FileCommand::OpenAddress(address) => self.open_outside(ui, "page", address.into()),
            FileCommand::SaveCase => save(SaveItem::Case),
            FileCommand::SavePicture => save(SaveItem::Picture),
            FileCommand::SaveComparison => save(SaveItem::Comparison),
            FileCommand::SaveData => save(SaveItem::Values),
            FileCommand::SaveOutline(kind, extension) => save(SaveItem::Outline(kind, extension)),
            FileCommand::CopyPicture => self.copy_picture(ui),
        }
    }

    fn perform_measure_task(&mut self, ui: &Ui, task: MeasureTask) {
        match task {
            MeasureTask::Upscalers => self.measure(),
            MeasureTask::CancelUpscalers => {
                self.measuring.idle.decline(self.session.request());
                self.session.features.tasks.measuring = None;
                self.worker.send(WorkerRequest::CancelMeasure);
            }
            MeasureTask::Stability => self.measure_stability(ui),
            MeasureTask::Plan => self.measure_plan(ui),
            MeasureTask::Scaling => self.measure_scaling(ui),
        }
    }

    fn show_dialog(&mut self, command: DialogCommand) {
        self.dialog = match command {
            DialogCommand::Open => Dialog::Open(OpenDialog::default()),
            DialogCommand::OpenPicture(role) => Dialog::Open(OpenDialog::of_picture(role)),
            DialogCommand::GoTo => Dialog::Pixel(String::new()),
            DialogCommand::Keys => Dialog::Keys(String::new()),
            DialogCommand::Palette => Dialog::Palette(Box::new(Palette::new(&self.session, ""))),
            DialogCommand::Bookmarks => Dialog::Bookmarks,
            DialogCommand::AddUpscaler => Dialog::AddUpscaler(AddUpscalerDialog::default()),
            DialogCommand::Manual(chapter) => {
                self.manual.open(chapter);
                return;
            }
        };
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
}
