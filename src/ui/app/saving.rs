//! Exporting files and copying to the clipboard.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use eframe::egui::{self, Ui};

use super::Workbench;
use crate::case::MinimalCase;
use crate::image::file::encode_png;
use crate::image::{Image, Rgba8};
use crate::inspect::outline::{OutlineControl, OutlineKind, OutlineRequest, outline};
use crate::lab::drawing::encode_recording;
use crate::pipeline::settings::Choice as _;
use crate::ui::compare::export::ComparisonPage;
use crate::ui::engine::Request;
use crate::ui::session::{Notice, Severity};
use crate::ui::task::{BackgroundTask, TaskStatus};
use crate::ui::what_if;
use crate::{disk, drawing};

/// File being written by a background thread.
pub(super) struct PendingExport {
    task: BackgroundTask<f32, Result<PathBuf, String>>,
    /// Completed fraction, from 0 to 1; `None` until the export reports progress. Some exports never do.
    completed: Option<f32>,
}

impl PendingExport {
    /// Cancels the export if it has reported progress; other exports cannot be cancelled.
    pub(super) fn cancel(&self) {
        if self.completed.is_some() {
            self.task.cancel();
        }
    }
}

impl Workbench {
    /// Writes all frame times to a CSV file in the current folder.
    pub(super) fn export_timings(&mut self, ui: &Ui) {
        let table = self.session.timings.csv();
        self.save(ui, ("frame-times", "csv"), move || Ok(table.into_bytes()));
    }

    /// Writes the triangle visible at the picked pixel to a case file in the current folder.
    pub(super) fn save_case(&mut self, ui: &Ui) {
        let Some(view) = &self.session.view else { return };
        let visible = view.report.as_ref().and_then(|report| Some((report.drawn_at, report.visible()?.submission)));
        let Some(([x, y], submission)) = visible else {
            self.session.report(Severity::Error, "No triangle to save as a case: pick a pixel that shows a triangle");
            return;
        };
        let settings = &view.request.recipe.pipeline;
        let triangle = &view.frame.geometry.triangles[submission];
        let minimal = MinimalCase::new(triangle, (x, y), view.frame.raster, settings, &view.request.scene.name);
        self.write_case(ui, &minimal);
    }

    pub(super) fn write_case(&mut self, ui: &Ui, minimal: &MinimalCase) {
        let text = minimal.to_json();
        self.save(ui, (&minimal.id, "json"), move || Ok(text.into_bytes()));
    }

    /// Writes the picture on the canvas to a PNG file in the current folder.
    pub(super) fn save_picture(&mut self, ui: &Ui) {
        let Some(picture) = self.shown_picture(ui) else { return };
        self.save(ui, ("picture", "png"), move || encode_png(&picture).map_err(|error| error.to_string()));
    }

    /// Writes the compared pictures with their errors to an HTML page in the current folder.
    pub(super) fn save_comparison(&mut self, ui: &Ui) {
        match ComparisonPage::of(&self.session) {
            Ok(page) => self.save(ui, ("comparison", "html"), move || {
                page.html().map(String::into_bytes).map_err(|error| error.to_string())
            }),
            Err(reason) => self.session.report(Severity::Error, reason),
        }
    }

    /// Writes a vector drawing of the current scene to a file in the current folder. `end` is the file name extension,
    /// which selects the format.
    pub(super) fn save_outline(&mut self, ui: &Ui, kind: OutlineKind, end: &'static str) {
        let Request { scene, camera, recipe, viewport, .. } = self.session.request();
        self.save_cancellable(ui, (kind.id(), end), move |progress, cancel| {
            let request = OutlineRequest { scene: &scene, camera: &camera, recipe: &recipe, viewport, kind };
            let drawing = outline(&request, OutlineControl { progress, cancel })?;
            let path = Path::new(kind.id()).with_extension(end);
            let encoded = drawing::file::encode(&path, &drawing, 1.0).map_err(|error| error.to_string());
            (!cancel.load(Ordering::Relaxed)).then_some(encoded)
        });
    }

    /// Writes a drawing of the current step of the open 2D lab page to a file in the current folder. `end` is the file
    /// name extension, which selects the format.
    pub(super) fn save_drawing(&mut self, ui: &Ui, end: &'static str) {
        let lab = &self.session.lab;
        let (page, recording, step) = (lab.page, lab.recording.clone(), lab.step);
        self.save(ui, (page.id(), end), move || {
            encode_recording(Path::new(page.id()).with_extension(end).as_path(), &recording, step)
                .map_err(|error| error.to_string())
        });
    }

    pub(super) fn saved(&mut self, outcome: Result<PathBuf, String>) {
        match outcome {
            Ok(path) => {
                self.session.report(Severity::Info, format!("Saved {}", path.display()));
                self.session.notice = Some(Notice::Saved(path));
            }
            Err(error) => self.session.report(Severity::Error, error),
        }
    }

    /// Returns the picture on the canvas, which may be a what-if view or the heat map of the probe.
    fn shown_picture(&self, ui: &Ui) -> Option<Arc<Image<Rgba8>>> {
        let view = what_if::visible_view(ui, &self.session)?;
        Some(self.session.probing.picture(view).unwrap_or(&view.picture).clone())
    }

    pub(super) fn copy_picture(&mut self, ui: &Ui) {
        if let Some(picture) = self.shown_picture(ui) {
            let (width, height) = picture.size();
            let size = [width as usize, height as usize];
            ui.ctx().copy_image(egui::ColorImage::from_rgba_premultiplied(size, picture.as_bytes()));
            self.session.report(Severity::Info, format!("Copied the picture, {width} × {height} px"));
        }
    }

    /// Writes a new file to the current folder. Encoding a large picture takes a while, so this happens in a background
    /// thread unless the window is synchronous. The file appears under its name only once it is complete. `name`
    /// consists of the file stem and the extension.
    pub(super) fn save(
        &mut self,
        ui: &Ui,
        name: (&str, &'static str),
        encode: impl FnOnce() -> Result<Vec<u8>, String> + Send + 'static,
    ) {
        self.save_cancellable(ui, name, |_, _| Some(encode()));
    }

    /// Writes a new file like [`Self::save`], but shows progress and can be cancelled. `encode` may report its
    /// completed fraction, from 0 to 1, and returns `None` if cancelled.
    fn save_cancellable(
        &mut self,
        ui: &Ui,
        (stem, extension): (&str, &'static str),
        encode: impl FnOnce(&(dyn Fn(f32) + Sync), &AtomicBool) -> Option<Result<Vec<u8>, String>> + Send + 'static,
    ) {
        let (folder, stem) = (self.session.folder.clone(), stem.to_owned());
        let save = move |progress: &(dyn Fn(f32) + Sync), cancel: &AtomicBool| {
            let encoded = encode(progress, cancel)?;
            let written = |bytes: Vec<u8>| disk::write_new(&folder, &stem, extension, &bytes);
            let unwritable = |error| format!("{}.{extension}: cannot write it: {error}", folder.join(&stem).display());
            Some(encoded.and_then(|bytes| written(bytes).map_err(unwritable)))
        };
        if self.widgets.is_synchronous {
            let outcome = save(&|_| {}, &AtomicBool::new(false));
            outcome.into_iter().for_each(|outcome| self.saved(outcome));
        } else {
            self.saving.push(PendingExport { task: BackgroundTask::start(ui.ctx().clone(), save), completed: None });
        }
    }

    /// Handles the progress and the results of all files being written.
    pub(super) fn poll_saving(&mut self) {
        let mut outcomes = Vec::new();
        self.saving.retain_mut(|saving| match saving.task.poll(&mut saving.completed) {
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
        self.session.export_progress = self.saving.iter().find_map(|saving| saving.completed);
        outcomes.into_iter().for_each(|outcome| self.saved(outcome));
    }
}
