//! Files that the window writes, and what it copies.

use std::fs::File;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use eframe::egui::{self, Ui};

use super::Workbench;
use crate::case::MinimalCase;
use crate::drawing;
use crate::image::file::write_png;
use crate::image::{Image, Rgba8};
use crate::inspect::outline::{OutlineKind, outline};
use crate::lab::drawing::write_recording;
use crate::pipeline::settings::Choice as _;
use crate::ui::engine::Request;
use crate::ui::panels::bottom::Tab;
use crate::ui::session::Level;
use crate::ui::task::{Listening, Task};
use crate::ui::what_if;

impl Workbench {
    /// Writes all frame times into the current folder.
    pub(super) fn export_timings(&mut self, ui: &Ui) {
        let table = self.session.timings.csv();
        self.save(ui, ("frame-times", "csv"), move |path| write_text(path, &table));
    }

    /// Writes the triangle that the picked pixel shows as a case into the current folder.
    pub(super) fn save_case(&mut self, ui: &Ui) {
        let Some(view) = &self.session.view else { return };
        let visible = view.report.as_ref().and_then(|report| Some((report.drawn_at, report.visible()?.submission)));
        let Some(([x, y], submission)) = visible else {
            self.session
                .report(Level::Error, "Pick a pixel that shows a triangle first: that triangle becomes the case");
            return;
        };
        let settings = &view.request.recipe.pipeline;
        let triangle = &view.frame.geometry.triangles[submission];
        let minimal = MinimalCase::new(triangle, (x, y), view.frame.raster, settings, &view.request.scene.name);
        self.write_case(ui, &minimal);
    }

    pub(super) fn write_case(&mut self, ui: &Ui, minimal: &MinimalCase) {
        let text = minimal.to_json();
        self.save(ui, (&minimal.id, "json"), move |path| write_text(path, &text));
    }

    /// Writes the picture.
    pub(super) fn save_picture(&mut self, ui: &Ui) {
        let Some(picture) = self.shown_picture(ui) else { return };
        self.save(ui, ("picture", "png"), move |path| write_png(path, &picture).map_err(|error| error.to_string()));
    }

    /// Writes the scene on screen as drawing commands.
    pub(super) fn save_outline(&mut self, ui: &Ui, kind: OutlineKind, end: &'static str) {
        let Request { scene, camera, recipe, viewport, .. } = self.session.request();
        self.save(ui, (kind.id(), end), move |path| {
            let drawing = outline(&scene, &camera, &recipe, viewport, kind);
            drawing::file::write(path, &drawing, 1.0).map_err(|error| error.to_string())
        });
    }

    /// Writes what the lab shows.
    pub(super) fn save_drawing(&mut self, ui: &Ui, end: &'static str) {
        let lab = &self.session.lab;
        let (page, recording, step) = (lab.page, lab.recording.clone(), lab.step);
        self.save(ui, (page.id(), end), move |path| {
            write_recording(path, &recording, step).map_err(|error| error.to_string())
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

    /// The picture that the canvas shows.
    fn shown_picture(&self, ui: &Ui) -> Option<Arc<Image<Rgba8>>> {
        let view = what_if::seen(ui, &self.session)?;
        Some(self.session.probing.picture(view).unwrap_or(&view.picture).clone())
    }

    pub(super) fn copy_picture(&mut self, ui: &Ui) {
        if let Some(picture) = self.shown_picture(ui) {
            let (width, height) = picture.size();
            let size = [width as usize, height as usize];
            ui.ctx().copy_image(egui::ColorImage::from_rgba_premultiplied(size, picture.as_bytes()));
            self.session.report(Level::Info, format!("Copied the picture, {width} × {height} px"));
        }
    }

    /// Writes a new file into the current folder, on a thread of its own: encoding a large picture takes a while.
    pub(super) fn save(
        &mut self,
        ui: &Ui,
        (stem, extension): (&str, &str),
        write: impl FnOnce(&Path) -> Result<(), String> + Send + 'static,
    ) {
        let path = match new_file(&self.session.folder, stem, extension) {
            Ok(path) => path,
            Err(error) => return self.session.report(Level::Error, error),
        };
        let save = move || match write(&path) {
            Ok(()) => Ok(path),
            Err(error) => {
                // What was not written whole is of no use.
                drop(std::fs::remove_file(&path));
                Err(error)
            }
        };
        if self.waits {
            self.saved(save());
        } else {
            self.saving.push(Task::start(ui.ctx().clone(), move |_, _| Some(save())));
        }
    }

    /// Takes what has become of files that are being written.
    pub(super) fn hear_saving(&mut self) {
        let mut outcomes = Vec::new();
        self.saving.retain(|saving| match saving.listen(&mut None) {
            Listening::GoesOn => true,
            Listening::Ended(outcome) => {
                outcomes.extend(outcome.map(|outcome| *outcome));
                false
            }
            Listening::BrokeOff => {
                outcomes.push(Err("Saving stopped by an error of the program".to_owned()));
                false
            }
        });
        outcomes.into_iter().for_each(|outcome| self.saved(outcome));
    }
}

/// Text as a file.
pub(in crate::ui) fn write_text(path: &Path, text: &str) -> Result<(), String> {
    std::fs::write(path, text).map_err(|error| format!("{}: {error}", path.display()))
}

/// An empty file `stem.extension`, or the first free `stem-2.extension`, `stem-3.extension` … in `folder`. It is there from
/// now on, so that whatever else is saved before it is written takes another name.
fn new_file(folder: &Path, stem: &str, extension: &str) -> Result<PathBuf, String> {
    let mut number = 1;
    loop {
        let name = if number == 1 { format!("{stem}.{extension}") } else { format!("{stem}-{number}.{extension}") };
        let path = folder.join(name);
        match File::create_new(&path) {
            Ok(_) => return Ok(path),
            Err(error) if error.kind() == ErrorKind::AlreadyExists => number += 1,
            Err(error) => return Err(format!("{}: {error}", path.display())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_taken_before_anything_is_written() {
        let folder = tempfile::tempdir().unwrap();
        let names = ["picture.png", "picture-2.png", "picture-3.png"];
        for name in names {
            assert_eq!(new_file(folder.path(), "picture", "png"), Ok(folder.path().join(name)));
        }
    }

    #[test]
    fn a_folder_that_is_gone_is_named() {
        let error = new_file(Path::new("/nowhere"), "picture", "png").unwrap_err();
        assert!(error.contains("picture.png"), "{error}");
    }
}
