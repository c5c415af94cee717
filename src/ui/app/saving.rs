//! Files that the window writes, and what it copies.

use std::path::{Path, PathBuf};
use std::sync::mpsc::channel;

use eframe::egui::{self, Ui};

use super::Workbench;
use crate::case::MinimalCase;
use crate::drawing;
use crate::image::file::write_png;
use crate::inspect::outline::{OutlineKind, outline};
use crate::lab::drawing::write_recording;
use crate::pipeline::settings::Choice as _;
use crate::ui::engine::Request;
use crate::ui::panels::bottom::Tab;
use crate::ui::session::Level;

impl Workbench {
    /// Writes all frame times into the current folder.
    pub(super) fn export_timings(&mut self) {
        let path = free_name(&self.session.folder, "frame-times", "csv");
        match std::fs::write(&path, self.session.timings.csv()) {
            Ok(()) => {
                self.session.report(Level::Info, format!("Saved the frame times as {}", path.display()));
                self.tab = Tab::Log;
            }
            Err(error) => self.session.report(Level::Error, format!("{}: {error}", path.display())),
        }
    }

    /// Writes the triangle that the picked pixel shows as a case into the current folder.
    pub(super) fn save_case(&mut self) {
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

    pub(super) fn write_case(&mut self, minimal: &MinimalCase) {
        let path = free_name(&self.session.folder, &minimal.id, "json");
        match std::fs::write(&path, minimal.to_json()) {
            Ok(()) => {
                self.session.report(Level::Info, format!("Saved {} as the case {}", minimal.id, path.display()));
                self.tab = Tab::Log;
            }
            Err(error) => self.session.report(Level::Error, format!("{}: {error}", path.display())),
        }
    }

    /// Writes the picture on a thread of its own: encoding a large one takes a while.
    pub(super) fn save_picture(&mut self, ui: &Ui) {
        let Some(view) = &self.session.view else { return };
        let picture = view.picture.clone();
        let path = free_name(&self.session.folder, "picture", "png");
        self.save(ui, move || write_png(&path, &picture).map(|()| path).map_err(|error| error.to_string()));
    }

    /// Writes the scene on screen as drawing commands.
    pub(super) fn save_outline(&mut self, ui: &Ui, kind: OutlineKind, end: &'static str) {
        let Request { scene, camera, recipe, viewport, .. } = self.session.request();
        let path = free_name(&self.session.folder, kind.id(), end);
        self.save(ui, move || {
            let drawing = outline(&scene, &camera, &recipe, viewport, kind);
            drawing::file::write(&path, &drawing, 1.0).map(|()| path).map_err(|error| error.to_string())
        });
    }

    /// Writes what the lab shows.
    pub(super) fn save_drawing(&mut self, ui: &Ui, end: &'static str) {
        let lab = &self.session.lab;
        let (recording, step) = (lab.recording.clone(), lab.step);
        let path = free_name(&self.session.folder, lab.page.id(), end);
        self.save(ui, move || {
            write_recording(&path, &recording, step).map(|()| path).map_err(|error| error.to_string())
        });
    }

    pub(super) fn saved(&mut self, outcome: Result<PathBuf, String>) {
        match outcome {
            Ok(path) => {
                self.session.report(Level::Info, format!("Saved {}", path.display()));
                self.tab = Tab::Log;
            }
            Err(error) => self.session.report(Level::Error, error),
        }
    }

    pub(super) fn copy_picture(&mut self, ui: &Ui) {
        if let Some(view) = &self.session.view {
            let (width, height) = view.picture.size();
            let size = [width as usize, height as usize];
            ui.ctx().copy_image(egui::ColorImage::from_rgba_premultiplied(size, view.picture.as_bytes()));
            self.session.report(Level::Info, format!("Copied the picture, {width} × {height} px"));
        }
    }

    /// Runs what writes a file, on a thread of its own.
    pub(super) fn save(&mut self, ui: &Ui, write: impl FnOnce() -> Result<PathBuf, String> + Send + 'static) {
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
}

/// `stem.extension`, or the first free `stem-2.extension`, `stem-3.extension` … in `folder`.
pub(in crate::ui) fn free_name(folder: &Path, stem: &str, extension: &str) -> PathBuf {
    let first = folder.join(format!("{stem}.{extension}"));
    if !first.exists() {
        return first;
    }
    (2..).map(|n| folder.join(format!("{stem}-{n}.{extension}"))).find(|p| !p.exists()).unwrap_or(first)
}
