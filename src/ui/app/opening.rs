//! Opening scenes and cases: models are loaded on a thread of their own.

use std::path::Path;
use std::time::{Duration, Instant};

use eframe::egui::Ui;

use super::Workbench;
use crate::case::Case;
use crate::image::file::is_named_picture;
use crate::scene::obj::Loaded;
use crate::scene::{LoadControl, SceneError, SceneSource};
use crate::ui::panels::bottom::Tab;
use crate::ui::session::Level;
use crate::ui::task::{Listening, Task};
use crate::ui::worker::Job;

/// A model is called slow, and its progress shown, after this time.
pub(super) const SLOW_LOAD: Duration = Duration::from_millis(300);

/// A model that is being loaded on a thread of its own.
pub(super) struct Loading {
    source: SceneSource,
    /// Reports the completed share, from 0 to 1.
    task: Task<f32, Result<Loaded, SceneError>>,
    completed: Option<f32>,
    since: Instant,
}

impl Workbench {
    pub(super) fn open(&mut self, ui: &Ui, source: SceneSource) {
        if let SceneSource::File(path, _) = &source
            && path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json"))
        {
            match Case::read(path) {
                Ok(case) => self.session.show_case(case),
                Err(error) => self.session.report(Level::Error, error.to_string()),
            }
            return;
        }
        if let SceneSource::File(path, _) = &source
            && is_named_picture(path)
        {
            // A picture is no scene; the lab fills in and samples pictures.
            self.session.offered_picture = Some(path.clone());
            return;
        }
        if self.waits {
            let result = source.load_with(LoadControl::quiet(self.session.memory_limit));
            self.loaded(source, result);
            return;
        }
        let (memory, wanted) = (self.session.memory_limit, source.clone());
        let task = Task::start(ui.ctx().clone(), move |progress, cancel| {
            Some(wanted.load_with(LoadControl { memory, progress, cancel }))
        });
        self.loading = Some(Loading { source, task, completed: None, since: Instant::now() });
        ui.request_repaint_after(SLOW_LOAD);
    }

    /// Takes the model that is being loaded, once it is.
    pub(super) fn hear_loading(&mut self) {
        let Some(loading) = &mut self.loading else { return };
        match loading.task.listen(&mut loading.completed) {
            Listening::GoesOn => {}
            Listening::Ended(result) => {
                let source = loading.source.clone();
                self.loading = None;
                if let Some(result) = result {
                    self.loaded(source, *result);
                }
            }
            Listening::BrokeOff => {
                let text = format!("Loading {} stopped by an error of the program", loading.source.title());
                self.loading = None;
                self.session.report(Level::Error, text);
            }
        }
    }

    pub(super) fn loaded(&mut self, source: SceneSource, result: Result<Loaded, SceneError>) {
        match result {
            Ok(Loaded { scene, warnings, notes }) => {
                self.session.show_scene(scene, source);
                self.worker.send(Job::CancelMeasure);
                self.drop_findings();
                self.canvas.fit();
                for note in notes {
                    self.session.report(Level::Info, note.to_string());
                }
                self.warn(&warnings);
            }
            Err(error) => {
                self.session.places.pending = None;
                self.session.report(Level::Error, error.to_string());
            }
        }
    }

    /// Gives up what is being found out about the scene before: it would pick and select in the new one.
    fn drop_findings(&mut self) {
        (self.finding, self.checks, self.fates) = Default::default();
        self.session.checks.progress = None;
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

    /// The model that has been loading for a while, and its completed share from 0 to 1.
    pub(super) fn slow_load(&self) -> Option<(&Path, f32)> {
        let loading = self.loading.as_ref()?;
        match &loading.source {
            SceneSource::File(path, _) if loading.since.elapsed() >= SLOW_LOAD => {
                Some((path, loading.completed.unwrap_or(0.0)))
            }
            _ => None,
        }
    }
}
