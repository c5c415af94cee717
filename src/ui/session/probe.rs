//! The stability probe, which counts the pixels that change under a tiny jitter: its settings, the background task, and
//! its result.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use eframe::egui::Context;

use super::{PictureSize, Session, Severity};
use crate::case::MinimalCase;
use crate::image::{Image, Rgba8};
use crate::inspect::Buffer;
use crate::inspect::control::TaskControl;
use crate::inspect::probe::{self, Fragile, Heat, Probe, ProbeResult, ProbedView};
use crate::ui::engine::{RenderedView, Request, Shown};
use crate::ui::session::feature::Feature;
use crate::ui::session::window_task::WindowTask;
use crate::ui::task::{BackgroundTask, TaskStatus};

/// State of the stability probe.
#[derive(Debug, Default)]
pub(crate) struct ProbeState {
    /// Settings for the next run of the probe.
    pub(crate) probe: Probe,
    /// Result of the last completed probe; `None` if there is none.
    pub(crate) found: Option<Arc<ProbeResult>>,
    /// Completed fraction of the running probe, from 0 to 1; `None` if none is running.
    pub(crate) progress: Option<f32>,
    /// Kind of heat map shown in place of the picture; `None` if hidden.
    pub(crate) heat: Option<Heat>,
    /// Image of the heat map, and the number of runs represented by its brightest colour.
    pub(in crate::ui) picture: Option<(Arc<Image<Rgba8>>, u16)>,
    task: Option<BackgroundTask<f32, ProbeResult>>,
}

/// Change to the stability probe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ProbeChange {
    /// Sets the settings for the next run of the probe.
    Set(Probe),
    /// Starts the probe.
    Start,
    /// Cancels the probe; the last result stays.
    Cancel,
    /// Shows a heat map in place of the picture; `None` hides it.
    Show(Option<Heat>),
    /// Restores the camera, settings and picture size with which the last result was measured.
    GoBack,
    /// Picks one pixel of an unstable triangle: the pixel that changed in the most runs.
    GoTo(Fragile),
    /// Saves an unstable triangle as a case.
    SaveCase(Fragile),
}

impl Feature for ProbeState {
    type Change = ProbeChange;

    fn apply(session: &mut Session, change: ProbeChange) -> Option<WindowTask> {
        let probing = &mut session.features.probing;
        match change {
            ProbeChange::Set(probe) => probing.probe = probe,
            ProbeChange::Start => return Some(WindowTask::StartProbe),
            ProbeChange::Cancel => probing.task.iter().for_each(BackgroundTask::cancel),
            ProbeChange::Show(heat) => {
                probing.show(heat);
                session.shown = Shown::Buffer(Buffer::Color);
            }
            ProbeChange::GoBack => {
                if let Some(found) = probing.found.clone() {
                    let ProbedView { camera, settings, viewport, .. } = found.subject;
                    session.state.camera = camera;
                    session.state.recipe.pipeline = settings;
                    if session.viewport() != viewport {
                        session.state.size = PictureSize::Fixed(viewport.width, viewport.height);
                    }
                    session.limit_triangles(None);
                }
            }
            ProbeChange::GoTo(fragile) => {
                session.pick = Some(fragile.worst_pixel);
                return Some(WindowTask::BringIntoView(fragile.worst_pixel));
            }
            ProbeChange::SaveCase(fragile) => return case_of(session, &fragile),
        }
        None
    }

    fn leave_scene(&mut self) {}
}

/// Handles the progress and the result of the background task.
pub(crate) fn listen(session: &mut Session) {
    let ProbeState { task, progress, .. } = &mut session.features.probing;
    let Some(running) = task else { return };
    match running.poll(progress) {
        TaskStatus::Running => return,
        TaskStatus::Ended(found) => {
            if let Some(found) = found {
                session.features.probing.set_result(*found);
                session.shown = Shown::Buffer(Buffer::Color);
            }
        }
        TaskStatus::Lost => session.report(Severity::Error, "The probe stopped because of an internal error"),
    }
    session.features.probing.task = None;
}

/// Runs the probe synchronously, for screenshots.
pub(crate) fn probe_now(session: &mut Session) {
    let subject = subject_of(&session.request());
    if let Some(found) = probe::run(&subject, session.features.probing.probe, TaskControl::quiet()) {
        session.features.probing.set_result(found);
    }
}

/// Starts the probe of the current view in a background thread.
pub(crate) fn start(session: &mut Session, context: &Context) {
    let (subject, probe) = (subject_of(&session.request()), session.features.probing.probe);
    session.features.probing.progress = Some(0.0);
    let work = BackgroundTask::start(context.clone(), move |progress: &(dyn Fn(f32) + Sync), cancel: &AtomicBool| {
        probe::run(&subject, probe, TaskControl { progress, cancel })
    });
    session.features.probing.task = Some(work);
}

fn case_of(session: &mut Session, fragile: &Fragile) -> Option<WindowTask> {
    let found = session.features.probing.found.as_ref()?;
    let Some(triangle) = found.triangle_of(fragile) else {
        let text = format!("Triangle {} is not rasterized without jitter, so no case can be saved", fragile.triangle.0);
        session.report(Severity::Error, text);
        return None;
    };
    let ProbedView { scene, settings, viewport, .. } = &found.subject;
    let case = MinimalCase::new(&triangle, fragile.worst_pixel, *viewport, settings, &scene.name);
    Some(WindowTask::SaveCase(Box::new(case)))
}

/// Returns the scene, camera, pipeline settings and viewport of a request, which determine the probed picture.
fn subject_of(request: &Request) -> ProbedView {
    let Request { scene, camera, recipe, viewport, .. } = request;
    ProbedView { scene: scene.clone(), camera: *camera, settings: recipe.pipeline, viewport: *viewport }
}

impl ProbeState {
    fn set_result(&mut self, found: ProbeResult) {
        self.found = Some(Arc::new(found));
        self.show(Some(self.heat.unwrap_or(Heat::Owner)));
    }

    fn show(&mut self, heat: Option<Heat>) {
        self.heat = heat;
        let painted = self.found.as_ref().zip(heat).and_then(|(found, heat)| probe::picture(&found.findings, heat));
        self.picture = painted.map(|(image, most)| (Arc::new(image), most));
    }

    /// Hides the heat map. Returns whether it was visible.
    pub(crate) fn hide(&mut self) -> bool {
        self.picture = None;
        self.heat.take().is_some()
    }

    /// Whether the last result was measured on the same frame that `view` shows.
    pub(in crate::ui) fn is_of(&self, view: &RenderedView) -> bool {
        let is_whole = view.request.triangle_limit.is_none();
        is_whole && self.found.as_ref().is_some_and(|found| found.subject.is_same(&subject_of(&view.request)))
    }

    /// Returns the heat map that replaces the picture of `view`; `None` if it is hidden or was measured on another
    /// view.
    pub(crate) fn picture(&self, view: &RenderedView) -> Option<&Arc<Image<Rgba8>>> {
        let is_finished = view.request.shown == Shown::Buffer(Buffer::Color);
        self.picture.as_ref().filter(|_| is_finished && self.is_of(view)).map(|(image, _)| image)
    }

    /// Returns the number of runs in which the pixel (x, y) changed, according to the visible heat map; `None` if no
    /// heat map is visible.
    pub(crate) fn count(&self, (x, y): (u32, u32)) -> Option<u16> {
        self.found.as_ref()?.findings.counts(self.heat?)?.get(x, y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::Recipe;
    use crate::scene::SceneSource;

    #[test]
    fn the_heat_map_is_shown_only_over_the_probed_view() {
        let source = SceneSource::named("z-fighting".into());
        let scene = Arc::new(source.load().unwrap().scene);
        let home = scene.home;
        let mut session = Session::new(scene, source, Recipe::default(), home);
        session.state.size = PictureSize::Fixed(64, 48);
        session.features.probing.probe.runs = 3;
        probe_now(&mut session);
        let mut engine = crate::ui::engine::Engine::default();
        let view = engine.answer(session.request());
        assert_eq!(session.features.probing.picture(&view).map(|picture| picture.size()), Some((64, 48)));
        let worst = session.features.probing.found.as_ref().unwrap().findings.ranking[0];
        assert_eq!(
            ProbeState::apply(&mut session, ProbeChange::GoTo(worst)),
            Some(WindowTask::BringIntoView(worst.worst_pixel))
        );
        assert_eq!(session.pick, Some(worst.worst_pixel));
        assert!(matches!(ProbeState::apply(&mut session, ProbeChange::SaveCase(worst)), Some(WindowTask::SaveCase(_))));

        session.state.camera.dolly(2.0);
        (session.features.canvas.size_px, session.features.scrub.triangle_limit) = ((80, 48), Some(1));
        let other = engine.answer(session.request());
        assert!(session.features.probing.picture(&other).is_none());
        ProbeState::apply(&mut session, ProbeChange::GoBack);
        let back = engine.answer(session.request());
        assert!(session.features.probing.picture(&back).is_some());
        ProbeState::apply(&mut session, ProbeChange::Show(None));
        assert!(session.features.probing.picture(&back).is_none());
    }
}
