//! Opening scenes, projects, camera paths and cases: background threads load models, and read and evaluate cases.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use eframe::egui::Ui;

use super::Workbench;
use crate::case::{Case, CaseError, Control, Options};
use crate::image::file::is_named_picture;
use crate::inspect::lesson::BlackPixelLesson;
use crate::inspect::project::{LoadedProject, Project};
use crate::pipeline::settings::Settings;
use crate::scene::{CameraPath, LoadControl, Loaded, SceneError, SceneSource};
use crate::ui::panels::case::{Evaluation, EvaluationRequest};
use crate::ui::session::command::Command;
use crate::ui::session::place::OpenedProject;
use crate::ui::session::{Notice, Severity};
use crate::ui::task::{BackgroundTask, TaskStatus};
use crate::ui::worker::WorkerRequest;

/// Loading time after which progress is shown.
pub(super) const SLOW_LOAD: Duration = Duration::from_millis(300);

/// Model being loaded in a background thread.
struct Loading {
    source: SceneSource,
    /// Task that loads the model; reports its completed fraction, from 0 to 1.
    task: BackgroundTask<f32, Result<Loaded, SceneError>>,
    completed: Option<f32>,
    since: Instant,
}

/// Case being read and evaluated in a background thread.
struct OpeningCase {
    path: PathBuf,
    task: BackgroundTask<f32, Result<Evaluation, CaseError>>,
    /// Completed fraction of the evaluation, from 0 to 1.
    progress: Option<f32>,
    since: Instant,
}

/// Model or case that is being opened.
#[derive(Default)]
pub(super) struct Opening {
    model: Option<Loading>,
    case: Option<OpeningCase>,
}

impl Opening {
    /// Whether a model or a case is being opened.
    pub(super) fn is_running(&self) -> bool {
        self.model.is_some() || self.case.is_some()
    }

    /// If a file has been opening for at least [`SLOW_LOAD`], returns its path and the completed fraction, from 0 to 1.
    pub(super) fn slow(&self) -> Option<(&Path, f32)> {
        if let Some(OpeningCase { path, progress, since, .. }) = &self.case {
            return (since.elapsed() >= SLOW_LOAD).then_some((path, progress.unwrap_or(0.0)));
        }
        let loading = self.model.as_ref()?;
        match &loading.source {
            SceneSource::File(path, _) if loading.since.elapsed() >= SLOW_LOAD => {
                Some((path, loading.completed.unwrap_or(0.0)))
            }
            _ => None,
        }
    }
}

/// Reads a case and evaluates its first part. Returns `None` if cancelled.
fn opened_case(path: &Path, options: Options, control: &Control<'_>) -> Option<Result<Evaluation, CaseError>> {
    match Case::read(path) {
        Ok(case) => Evaluation::new(EvaluationRequest { case: Arc::new(case), part: 0, options }, control).map(Ok),
        Err(error) => Some(Err(error)),
    }
}

impl Workbench {
    /// Opens the scene of a lesson.
    pub(super) fn open_lesson(&mut self, ui: &Ui, lesson: &'static BlackPixelLesson) {
        self.open_for(ui, SceneSource::named(lesson.scene.into()), Some(lesson));
    }

    /// Opens a scene, a project, a camera path, a case or a picture.
    pub(super) fn open(&mut self, ui: &Ui, source: SceneSource) {
        self.open_for(ui, source, None);
    }

    fn open_for(&mut self, ui: &Ui, source: SceneSource, lesson: Option<&'static BlackPixelLesson>) {
        self.session.features.onboarding.opening_lesson = lesson;
        // The most recent request replaces a case that is still being opened.
        self.opening.case = None;
        if let SceneSource::File(path, _) = &source
            && Project::is_named(path)
        {
            self.open_project(ui, path);
            return;
        }
        if let SceneSource::File(path, _) = &source
            && path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json"))
        {
            if CameraPath::is_file(path) {
                self.open_camera_path(path);
            } else {
                self.open_case(ui, path.clone());
            }
            return;
        }
        if let SceneSource::File(path, _) = &source
            && is_named_picture(path)
        {
            // An image file is not a scene: offer it to the 2D lab, which fills and samples pictures.
            self.session.features.messages.offered_picture = Some(path.clone());
            return;
        }
        if self.widgets.is_synchronous {
            let result = source.load_with(LoadControl::quiet(self.session.features.files.memory_limit));
            self.loaded(source, result);
            return;
        }
        let (memory, wanted) = (self.session.features.files.memory_limit, source.clone());
        let task = BackgroundTask::start(ui.ctx().clone(), move |progress, cancel| {
            Some(wanted.load_with(LoadControl { memory, progress, cancel }))
        });
        self.opening.model = Some(Loading { source, task, completed: None, since: Instant::now() });
        ui.request_repaint_after(SLOW_LOAD);
    }

    /// Opens a project: reads it, then loads its scene. Until that has succeeded, the current scene stays.
    fn open_project(&mut self, ui: &Ui, path: &Path) {
        match Project::read(path) {
            Ok(LoadedProject { project, warnings }) => {
                let source = self.session.open_project(OpenedProject { path: path.to_owned(), project });
                self.open(ui, source);
                for warning in warnings {
                    self.session.report(Severity::Warning, warning.to_string());
                }
            }
            Err(error) => self.session.report(Severity::Error, error.to_string()),
        }
    }

    /// Reads a camera path, which replaces the recorded one.
    fn open_camera_path(&mut self, path: &Path) {
        match CameraPath::read(path) {
            Ok(path) => self.session.open_camera_path(&path),
            Err(error) => self.session.report(Severity::Error, error.to_string()),
        }
    }

    /// Updates the progress of loading a model. Shows the model once it is loaded, or reports the error.
    pub(super) fn poll_loading(&mut self) {
        let Some(loading) = &mut self.opening.model else { return };
        match loading.task.poll(&mut loading.completed) {
            TaskStatus::Running => {}
            TaskStatus::Ended(result) => {
                let source = loading.source.clone();
                self.opening.model = None;
                if let Some(result) = result {
                    self.loaded(source, *result);
                }
            }
            TaskStatus::Lost => {
                let text = format!("Loading {} stopped: internal error", loading.source.title());
                self.opening.model = None;
                self.session.report(Severity::Error, text);
            }
        }
    }

    /// Reads and evaluates a case. The view stays unchanged until the evaluation is complete.
    fn open_case(&mut self, ui: &Ui, path: PathBuf) {
        let Settings { rasterizer, arithmetic, .. } = self.session.state.recipe.pipeline;
        let options = Options { rasterizer, arithmetic };
        if self.widgets.is_synchronous {
            if let Some(opened) = opened_case(&path, options, &Control::default()) {
                self.case_opened(opened);
            }
            return;
        }
        let wanted = path.clone();
        let task = BackgroundTask::start(ui.ctx().clone(), move |report_progress: &(dyn Fn(f32) + Sync), stop| {
            opened_case(&wanted, options, &Control::new(report_progress, stop))
        });
        self.opening.model = None;
        self.opening.case = Some(OpeningCase { path, task, progress: None, since: Instant::now() });
        ui.request_repaint_after(SLOW_LOAD);
    }

    fn case_opened(&mut self, opened: Result<Evaluation, CaseError>) {
        match opened {
            Ok(evaluation) => {
                self.session.show_case(evaluation.request.case.clone());
                self.widgets.case.adopt(evaluation);
            }
            Err(error) => self.session.report(Severity::Error, error.to_string()),
        }
    }

    /// Updates the progress of opening a case. Shows the case once it is evaluated, or reports the error.
    pub(super) fn poll_case(&mut self) {
        let Some(opening) = &mut self.opening.case else { return };
        match opening.task.poll(&mut opening.progress) {
            TaskStatus::Running => {}
            TaskStatus::Ended(opened) => {
                self.opening.case = None;
                if let Some(opened) = opened {
                    self.case_opened(*opened);
                }
            }
            TaskStatus::Lost => {
                let text = format!("Opening {} stopped: internal error", opening.path.display());
                self.opening.case = None;
                self.session.report(Severity::Error, text);
            }
        }
    }

    pub(super) fn loaded(&mut self, source: SceneSource, result: Result<Loaded, SceneError>) {
        match result {
            Ok(Loaded { scene, warnings, notes }) => {
                self.session.show_scene(scene, source);
                self.worker.send(WorkerRequest::CancelMeasure);
                self.widgets.canvas.fit();
                let commands = std::mem::take(&mut self.session.features.places.after_project);
                self.queue(commands.into_iter().map(Command::File).collect());
                for note in notes {
                    self.session.report(Severity::Info, note.to_string());
                }
                self.warn(&warnings);
            }
            Err(error) => {
                self.session.features.places.pending = None;
                self.session.report(Severity::Error, error.to_string());
            }
        }
    }

    /// Writes the loader's warnings to the log, and shows their number in the message line if there are any.
    pub(crate) fn warn(&mut self, warnings: &[crate::scene::Warning]) {
        for warning in warnings {
            self.session.report(Severity::Warning, warning.to_string());
        }
        self.session.features.messages.notice = (!warnings.is_empty()).then_some(Notice::Warnings(warnings.len()));
    }
}
