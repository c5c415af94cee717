//! Exporting files and copying to the clipboard.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use eframe::egui::{self, Ui};

use super::Workbench;
use crate::case::MinimalCase;
use crate::image::file::encode_png;
use crate::image::{Image, Rgba8};
use crate::inspect::buffer_file::BufferSource;
use crate::inspect::control::TaskControl;
use crate::inspect::display::Display;
use crate::inspect::outline::{OutlineKind, OutlineRequest, outline};
use crate::inspect::{Buffer, InspectionState, Trace};
use crate::lab::Lesson;
use crate::lab::drawing::encode_recording;
use crate::lab::page::LabPage;
use crate::pipeline::settings::Choice as _;
use crate::report::animation::animate;
use crate::report::pixel::{PixelPage, explain_fully};
use crate::text::shell_line;
use crate::ui::dialogs::Dialog;
use crate::ui::engine::{RenderedView, Request};
use crate::ui::panels::compare::export::comparison_page;
use crate::ui::save_dialog::SaveDialog;
use crate::ui::session::save_item::{Destination, SaveItem};
use crate::ui::session::{Notice, Severity, overlays, range, what_if};
use crate::ui::task::{BackgroundTask, TaskStatus};
use crate::{disk, drawing};

/// File being written by a background thread.
struct PendingExport {
    task: BackgroundTask<f32, Result<PathBuf, String>>,
    /// Completed fraction, from 0 to 1; `None` until the export reports progress. Some exports never do.
    completed: Option<f32>,
}

impl PendingExport {
    /// Cancels the export if it has reported progress; other exports cannot be cancelled.
    fn cancel(&self) {
        if self.completed.is_some() {
            self.task.cancel();
        }
    }
}

/// Exports that background threads are writing to files, and what is being opened outside the window.
#[derive(Default)]
pub(super) struct Saving {
    exports: Vec<PendingExport>,
    /// Task that opens a folder or a web address outside the window.
    opener: Option<OpenerTask>,
}

impl Saving {
    /// Cancels all exports that can be cancelled.
    pub(super) fn cancel(&self) {
        self.exports.iter().for_each(PendingExport::cancel);
    }
}

/// File to write, without its content.
struct SavedFile {
    /// Name without its extension, for [`Destination::Automatic`].
    stem: String,
    extension: &'static str,
    destination: Destination,
}

impl SavedFile {
    /// Returns the folder of the destination. `folder` is that of automatic ones.
    fn folder(&self, folder: &Path) -> PathBuf {
        match &self.destination {
            Destination::Automatic => folder.to_owned(),
            Destination::File(path) => path.parent().unwrap_or(folder).to_owned(),
        }
    }

    /// Returns the name of the file without its folder. An automatic destination may add a number to it.
    fn name(&self) -> String {
        let chosen = match &self.destination {
            Destination::Automatic => None,
            Destination::File(path) => path.file_name(),
        };
        chosen.map_or_else(|| format!("{}.{}", self.stem, self.extension), |name| name.to_string_lossy().into_owned())
    }

    /// Writes `bytes` to the destination, in `folder` if it is automatic. Returns the path of the file.
    ///
    /// # Errors
    /// Returns a message that names the file if it cannot be written.
    fn write(&self, folder: &Path, bytes: &[u8]) -> Result<PathBuf, String> {
        let Self { stem, extension, destination } = self;
        let unwritable = |path: &Path, error| format!("{}: cannot write it: {error}", path.display());
        match destination {
            Destination::Automatic => disk::write_new(folder, stem, extension, bytes)
                .map_err(|error| unwritable(&folder.join(format!("{stem}.{extension}")), error)),
            Destination::File(path) => match disk::write(path, bytes) {
                Ok(()) => Ok(path.clone()),
                Err(error) => Err(unwritable(path, error)),
            },
        }
    }
}

/// Task that opens a folder or a web address. Its result is an error message on failure.
type OpenerTask = BackgroundTask<(), Result<(), String>>;

impl Workbench {
    /// Asks for a path at which to save `item`, with the system's file dialog if there is one. Reports an error instead
    /// if there is nothing to save.
    pub(super) fn ask_where_to_save(&mut self, ui: &Ui, item: SaveItem) {
        let savable = match item {
            SaveItem::Case => self.minimal_case().map(drop).map_err(str::to_owned),
            SaveItem::Comparison => comparison_page(&self.session).map(drop).map_err(str::to_owned),
            SaveItem::Pixel => self.picked_pixel().map(drop).map_err(str::to_owned),
            SaveItem::CameraPath => self.camera_path().map(drop),
            SaveItem::Animation(format) => self.session.animation(format).map(drop),
            _ => Ok(()),
        };
        match savable {
            Ok(()) => {
                let mut dialog = SaveDialog::new(item, &self.session);
                if !self.widgets.is_synchronous {
                    dialog.browse(ui);
                }
                self.dialog = Dialog::Save(dialog);
            }
            Err(reason) => self.session.report(Severity::Error, reason),
        }
    }

    /// Saves `item` to `destination`.
    pub(super) fn save_item(&mut self, ui: &Ui, item: SaveItem, destination: Destination) {
        let file = SavedFile { stem: item.stem(&self.session).to_owned(), extension: item.extension(), destination };
        match item {
            SaveItem::Picture => {
                let Some(picture) = self.shown_picture(ui) else { return };
                self.save(ui, file, move || encode_png(&picture).map_err(|error| error.to_string()));
            }
            SaveItem::Values => {
                if let Some(view) = what_if::visible_view(ui, &self.session).cloned() {
                    self.save(ui, file, move || Ok(range::save::encoded(&view)));
                }
            }
            SaveItem::Project => {
                let folder = file.folder(&self.session.features.files.folder);
                let project = self.session.project();
                self.save(ui, file, move || {
                    project.encode(&folder).map_err(|error| format!("the model cannot be read: {error}"))
                });
            }
            SaveItem::Buffers => self.save_buffers(ui, file),
            SaveItem::Pixel => match self.picked_pixel() {
                Ok((view, pixel)) => self.save_pixel(ui, file, view, pixel),
                Err(reason) => self.session.report(Severity::Error, reason),
            },
            SaveItem::LabRun => {
                let lab = &self.session.features.lab;
                let (lesson, page) = (lab.lesson().clone(), lab.page);
                // No command restores an edited input.
                let is_original = lesson == Lesson::new(page);
                let words = ["rasterscope", "lab", page.id(), "-o", &file.name()];
                let command = is_original.then(|| shell_line(&words));
                self.save(ui, file, move || {
                    let recording = lesson.record();
                    let steps = recording.steps.len();
                    let page = LabPage { lesson: &lesson, recording: &recording, steps, command: command.as_deref() };
                    Ok(page.html().into_bytes())
                });
            }
            SaveItem::Outline(kind, extension) => self.save_outline(ui, file, kind, extension),
            SaveItem::Case => match self.minimal_case() {
                Ok(minimal) => self.write_case(ui, &minimal, file.destination),
                Err(reason) => self.session.report(Severity::Error, reason),
            },
            SaveItem::Comparison => match comparison_page(&self.session) {
                Ok(page) => {
                    self.save(ui, file, move || page.html().map(String::into_bytes).map_err(|error| error.to_string()));
                }
                Err(reason) => self.session.report(Severity::Error, reason),
            },
            SaveItem::CameraPath => match self.camera_path() {
                Ok(encoded) => self.save(ui, file, || Ok(encoded)),
                Err(reason) => self.session.report(Severity::Error, reason),
            },
            SaveItem::Animation(format) => match self.session.animation(format) {
                Ok(plan) => self.save_cancellable(ui, file, move |progress, cancel| {
                    let encoded = animate(&plan, &mut |done, of| {
                        progress(done as f32 / of.max(1) as f32);
                        !cancel.load(Ordering::Relaxed)
                    });
                    encoded.map_err(|error| error.to_string()).transpose()
                }),
                Err(reason) => self.session.report(Severity::Error, reason),
            },
            SaveItem::FrameTimes => {
                let table = self.session.features.timings.csv();
                self.save(ui, file, move || Ok(table.into_bytes()));
            }
            SaveItem::LabDrawing(extension) => {
                let lab = &self.session.features.lab;
                let (page, recording, step) = (lab.page, lab.recording.clone(), lab.step);
                self.save(ui, file, move || {
                    encode_recording(Path::new(page.id()).with_extension(extension).as_path(), &recording, step)
                        .map_err(|error| error.to_string())
                });
            }
        }
    }

    /// Returns the triangle visible at the picked pixel as a case.
    ///
    /// # Errors
    /// Returns an error if the picked pixel shows no triangle.
    fn minimal_case(&self) -> Result<MinimalCase, &'static str> {
        const NONE: &str = "No triangle to save as a case: pick a pixel that shows a triangle";
        let view = self.session.view.as_ref().ok_or(NONE)?;
        let visible = view.report.as_ref().and_then(|report| Some((report.drawn_at, report.visible()?.submission)));
        let ([x, y], submission) = visible.ok_or(NONE)?;
        let settings = &view.request.recipe.pipeline;
        let triangle = &view.frame.geometry().triangles[submission];
        Ok(MinimalCase::new(triangle, (x, y), view.frame.raster, settings, &view.request.scene.name))
    }

    /// Returns the recorded camera path as a file.
    ///
    /// # Errors
    /// Returns an error if there is no key view.
    fn camera_path(&self) -> Result<Vec<u8>, String> {
        let path = self.session.features.camera_path.path();
        let encoded = path.map(|path| path.encode()).transpose().map_err(|error| error.to_string())?;
        encoded.flatten().ok_or_else(|| "No camera path to save: add a key view first".to_owned())
    }

    /// Returns the view on the canvas and the picked pixel.
    ///
    /// # Errors
    /// Returns an error if no pixel is picked.
    fn picked_pixel(&self) -> Result<(RenderedView, (u32, u32)), &'static str> {
        const NONE: &str = "No pixel to explain: pick a pixel first";
        let view = self.session.view.clone().ok_or(NONE)?;
        let pixel = view.report.as_ref().map(|report| (report.x, report.y)).ok_or(NONE)?;
        Ok((view, pixel))
    }

    /// Saves all buffers of the frame as an OpenEXR file.
    fn save_buffers(&mut self, ui: &Ui, file: SavedFile) {
        let Some(view) = self.session.view.clone() else { return };
        let command = self.command_of(&view, "render", &["--buffers", "-o", &file.name()]);
        self.save(ui, file, move || {
            let Request { scene, recipe, .. } = &view.request;
            let source = BufferSource { scene, recipe, frame: &view.frame };
            source.encode(&command).map_err(|error| error.to_string())
        });
    }

    /// Saves the explanation of a pixel as an HTML page.
    fn save_pixel(&mut self, ui: &Ui, file: SavedFile, view: RenderedView, pixel: (u32, u32)) {
        let command = self.command_of(&view, "pixel", &["--html", &file.name()]);
        self.save(ui, file, move || {
            let Request { scene, recipe, triangle_limit, .. } = &view.request;
            let report = explain_fully(scene, recipe, &view.frame, pixel, triangle_limit.is_none());
            let report = report.ok_or("The pixel lies outside the picture")?;
            let trace = Trace::of(scene, recipe, &view.frame, &report, None);
            let page =
                PixelPage { scene: &scene.name, frame: &view.frame, report: &report, trace: &trace, command: &command };
            page.html().map(String::into_bytes).map_err(|error| error.to_string())
        });
    }

    /// Returns the command line that runs a command of the program with the state of a view. The way in which the canvas
    /// shows it is left out.
    fn command_of(&self, view: &RenderedView, command: &str, options: &[&str]) -> String {
        let Request { camera, recipe, viewport, .. } = &view.request;
        let state = InspectionState {
            camera: *camera,
            recipe: *recipe,
            picture: Some((viewport.width, viewport.height)),
            buffer: Buffer::Color,
            stage: None,
            number: None,
            display: Display::default(),
            overlays: Vec::new(),
            ..self.session.place()
        };
        state.command_line_of(command, options)
    }

    /// Saves a case as a JSON file.
    pub(super) fn write_case(&mut self, ui: &Ui, minimal: &MinimalCase, destination: Destination) {
        let text = minimal.to_json();
        let extension = SaveItem::Case.extension();
        let file = SavedFile { stem: minimal.id.clone(), extension, destination };
        self.save(ui, file, move || Ok(text.into_bytes()));
    }

    /// Saves a vector drawing of the current scene, in the format with this file name extension.
    fn save_outline(&mut self, ui: &Ui, file: SavedFile, kind: OutlineKind, extension: &'static str) {
        let Request { scene, camera, recipe, viewport, .. } = self.session.request();
        self.save_cancellable(ui, file, move |progress, cancel| {
            let request = OutlineRequest { scene: &scene, camera: &camera, recipe: &recipe, viewport, kind };
            let drawing = outline(&request, TaskControl { progress, cancel })?;
            let path = Path::new(kind.id()).with_extension(extension);
            let encoded = drawing::file::encode(&path, &drawing, 1.0).map_err(|error| error.to_string());
            (!cancel.load(Ordering::Relaxed)).then_some(encoded)
        });
    }

    /// Writes the totals of all overlays to a new CSV file in the current folder.
    pub(super) fn save_overlay_totals(&mut self, ui: &Ui) {
        let file = SavedFile { stem: "overlays".to_owned(), extension: "csv", destination: Destination::Automatic };
        self.save(ui, file, overlays::save::totals(&self.session));
    }

    /// Opens the folder of a saved file with the desktop's file manager.
    pub(super) fn open_folder(&mut self, ui: &Ui, file: &Path) {
        self.open_outside(ui, "folder", file.parent().unwrap_or(file).into());
    }

    /// Opens a path or a web address with the desktop's program for it, in a background thread because some openers
    /// block until that program is closed. `noun` says what it is.
    pub(super) fn open_outside(&mut self, ui: &Ui, noun: &'static str, target: OsString) {
        self.saving.opener = Some(BackgroundTask::start(ui.ctx().clone(), move |_: &(dyn Fn(()) + Sync), _| {
            let failure = |error| format!("Cannot open the {noun} {}: {error}", target.display());
            Some(open::that(&target).map_err(failure))
        }));
    }

    /// Reports an error if a folder or a page could not be opened.
    pub(super) fn poll_opener(&mut self) {
        let Some(opener) = &self.saving.opener else { return };
        if let TaskStatus::Ended(outcome) = opener.poll(&mut None) {
            self.saving.opener = None;
            if let Some(Err(error)) = outcome.map(|outcome| *outcome) {
                self.session.report(Severity::Error, error);
            }
        }
    }

    pub(super) fn saved(&mut self, outcome: Result<PathBuf, String>) {
        match outcome {
            Ok(path) => {
                self.session.report(Severity::Info, format!("Saved {}", path.display()));
                self.session.features.messages.notice = Some(Notice::Saved(path));
            }
            Err(error) => self.session.report(Severity::Error, error),
        }
    }

    /// Returns the picture on the canvas, which may be a what-if view or the heat map of the probe.
    fn shown_picture(&self, ui: &Ui) -> Option<Arc<Image<Rgba8>>> {
        let view = what_if::visible_view(ui, &self.session)?;
        Some(self.session.features.probing.picture(view).unwrap_or(&view.picture).clone())
    }

    pub(super) fn copy_picture(&mut self, ui: &Ui) {
        if let Some(picture) = self.shown_picture(ui) {
            let (width, height) = picture.size();
            let size = [width as usize, height as usize];
            ui.ctx().copy_image(egui::ColorImage::from_rgba_premultiplied(size, picture.as_bytes()));
            self.session.report(Severity::Info, format!("Copied the picture, {width} × {height} px"));
        }
    }

    /// Writes a file. Encoding a large picture takes a while, so this happens in a background thread unless the window
    /// is synchronous. The file appears under its name only once it is complete.
    fn save(&mut self, ui: &Ui, file: SavedFile, encode: impl FnOnce() -> Result<Vec<u8>, String> + Send + 'static) {
        self.save_cancellable(ui, file, |_, _| Some(encode()));
    }

    /// Writes a file like [`Self::save`], but shows progress and can be cancelled. `encode` may report its completed
    /// fraction, from 0 to 1, and returns `None` if cancelled.
    fn save_cancellable(
        &mut self,
        ui: &Ui,
        file: SavedFile,
        encode: impl FnOnce(&(dyn Fn(f32) + Sync), &AtomicBool) -> Option<Result<Vec<u8>, String>> + Send + 'static,
    ) {
        let folder = self.session.features.files.folder.clone();
        let save = move |progress: &(dyn Fn(f32) + Sync), cancel: &AtomicBool| {
            let encoded = encode(progress, cancel)?;
            Some(encoded.and_then(|bytes| file.write(&folder, &bytes)))
        };
        if self.widgets.is_synchronous {
            let outcome = save(&|_| {}, &AtomicBool::new(false));
            outcome.into_iter().for_each(|outcome| self.saved(outcome));
        } else {
            self.saving
                .exports
                .push(PendingExport { task: BackgroundTask::start(ui.ctx().clone(), save), completed: None });
        }
    }

    /// Handles the progress and the results of all files being written.
    pub(super) fn poll_saving(&mut self) {
        let mut outcomes = Vec::new();
        self.saving.exports.retain_mut(|saving| match saving.task.poll(&mut saving.completed) {
            TaskStatus::Running => true,
            TaskStatus::Ended(outcome) => {
                outcomes.extend(outcome.map(|outcome| *outcome));
                false
            }
            TaskStatus::Lost => {
                outcomes.push(Err("Saving stopped: internal error".to_owned()));
                false
            }
        });
        self.session.features.tasks.export_progress = self.saving.exports.iter().find_map(|saving| saving.completed);
        outcomes.into_iter().for_each(|outcome| self.saved(outcome));
    }
}
