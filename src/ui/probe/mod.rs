//! The stability probe in the window: what is asked, the work in the background, and what was found.

mod canvas;

mod panel;

use std::sync::Arc;

use eframe::egui::Context;

use super::command::Command;
use super::engine::{Request, Shown, View};
use super::session::{Level, PictureSize, Session};
use super::task::{Listening, Task};
use crate::case::MinimalCase;
use crate::image::{Image, Rgba8};
use crate::inspect::Buffer;
use crate::inspect::probe::{self, Fragile, Heat, Probe, ProbeResult, Subject};

pub use canvas::legend;
pub use panel::{controls, ui};

/// What the window knows of the probe.
#[derive(Debug, Default)]
pub struct Probing {
    /// What is asked next.
    pub probe: Probe,
    /// What was found last.
    pub found: Option<Arc<ProbeResult>>,
    /// Share of the present probe that is done.
    pub progress: Option<f32>,
    /// What of the finding is laid over the picture.
    pub heat: Option<Heat>,
    /// That as a picture, and the number of runs that its brightest colour stands for.
    picture: Option<(Arc<Image<Rgba8>>, u16)>,
    task: Option<Task<f32, ProbeResult>>,
}

/// A change of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Change {
    /// Ask this next.
    Set(Probe),
    /// Begin.
    Start,
    /// Stop; the last finding stays.
    Cancel,
    /// Lay this over the picture, or nothing.
    Show(Option<Heat>),
    /// Look from where the last finding was made.
    GoBack,
    /// Pick the worst pixel of a triangle.
    GoTo(Fragile),
    /// Save a triangle as a case.
    SaveCase(Fragile),
}

/// What is left for the window to do after a change.
#[derive(Debug, PartialEq)]
pub enum Rest {
    /// Nothing.
    Nothing,
    /// Bring a pixel into view.
    BringIntoView((u32, u32)),
    /// Write a case.
    Write(Box<MinimalCase>),
}

/// Makes a change.
pub fn apply(session: &mut Session, context: &Context, change: Change) -> Rest {
    match change {
        Change::Set(probe) => session.probing.probe = probe,
        Change::Start => start(session, context),
        Change::Cancel => {
            if let Some(task) = &session.probing.task {
                task.cancel();
            }
        }
        Change::Show(heat) => {
            session.probing.show(heat);
            session.shown = Shown::Buffer(Buffer::Color);
        }
        Change::GoBack => {
            if let Some(found) = session.probing.found.clone() {
                let Subject { camera, settings, viewport, .. } = found.subject;
                session.state.camera = camera;
                session.state.recipe.pipeline = settings;
                if session.viewport() != viewport {
                    session.state.size = PictureSize::Fixed(viewport.width, viewport.height);
                }
                session.apply(Command::LimitTriangles(None));
            }
        }
        Change::GoTo(fragile) => {
            session.pick = Some(fragile.worst_pixel);
            return Rest::BringIntoView(fragile.worst_pixel);
        }
        Change::SaveCase(fragile) => return case_of(session, &fragile),
    }
    Rest::Nothing
}

/// Takes what the task has said.
pub fn listen(session: &mut Session) {
    let Probing { task, progress, .. } = &mut session.probing;
    let Some(running) = task else { return };
    match running.listen(progress) {
        Listening::GoesOn => return,
        Listening::Ended(found) => {
            if let Some(found) = found {
                session.probing.take(*found);
                session.shown = Shown::Buffer(Buffer::Color);
            }
        }
        Listening::BrokeOff => session.report(Level::Error, "The probe stopped by an error of the program"),
    }
    session.probing.task = None;
}

/// Probes while the caller waits, as pictures of the window want it.
pub fn probe_now(session: &mut Session) {
    let subject = subject_of(&session.request());
    let never = std::sync::atomic::AtomicBool::new(false);
    if let Some(found) = probe::run(&subject, session.probing.probe, &|_| {}, &never) {
        session.probing.take(found);
    }
}

fn start(session: &mut Session, context: &Context) {
    let (subject, probe) = (subject_of(&session.request()), session.probing.probe);
    session.probing.progress = Some(0.0);
    let work = Task::start(context.clone(), move |tell: &(dyn Fn(f32) + Sync), stop| {
        probe::run(&subject, probe, &|share| tell(share), stop)
    });
    session.probing.task = Some(work);
}

fn case_of(session: &mut Session, fragile: &Fragile) -> Rest {
    let Some(found) = &session.probing.found else { return Rest::Nothing };
    let Some(triangle) = found.triangle_of(fragile) else {
        let text =
            format!("Triangle {} is not rasterized without jitter: there is nothing to save", fragile.triangle.0);
        session.report(Level::Error, text);
        return Rest::Nothing;
    };
    let Subject { scene, settings, viewport, .. } = &found.subject;
    Rest::Write(Box::new(MinimalCase::new(&triangle, fragile.worst_pixel, *viewport, settings, &scene.name)))
}

/// What the pipeline draws for a request.
fn subject_of(request: &Request) -> Subject {
    let Request { scene, camera, recipe, viewport, .. } = request;
    Subject { scene: scene.clone(), camera: *camera, settings: recipe.pipeline, viewport: *viewport }
}

impl Probing {
    fn take(&mut self, found: ProbeResult) {
        self.found = Some(Arc::new(found));
        self.show(Some(self.heat.unwrap_or(Heat::Owner)));
    }

    fn show(&mut self, heat: Option<Heat>) {
        self.heat = heat;
        let painted = self.found.as_ref().zip(heat).and_then(|(found, heat)| probe::picture(found, heat));
        self.picture = painted.map(|(image, most)| (Arc::new(image), most));
    }

    /// Shows the picture as it is; whether the finding was laid over it.
    pub fn hide(&mut self) -> bool {
        self.picture = None;
        self.heat.take().is_some()
    }

    /// Whether the finding is of the frame that a view shows.
    fn is_of(&self, view: &View) -> bool {
        let is_whole = view.request.triangle_limit.is_none();
        is_whole && self.found.as_ref().is_some_and(|found| found.subject.is_same(&subject_of(&view.request)))
    }

    /// The picture that stands for that of a view, if the finding is of it and is to be shown.
    pub fn picture(&self, view: &View) -> Option<&Arc<Image<Rgba8>>> {
        let is_finished = view.request.shown == Shown::Buffer(Buffer::Color);
        self.picture.as_ref().filter(|_| is_finished && self.is_of(view)).map(|(image, _)| image)
    }

    /// How often a pixel of that picture changed.
    pub fn count(&self, (x, y): (u32, u32)) -> Option<u16> {
        self.found.as_ref()?.counts(self.heat?)?.get(x, y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::Recipe;
    use crate::scene::SceneSource;

    #[test]
    fn a_finding_is_shown_over_the_view_that_it_is_of_and_no_other() {
        let source = SceneSource::named("z-fighting".into());
        let scene = Arc::new(source.load().unwrap().scene);
        let home = scene.home;
        let mut session = Session::new(scene, source, Recipe::default(), home);
        session.canvas_px = (64, 48);
        session.probing.probe.runs = 3;
        probe_now(&mut session);
        let mut engine = crate::ui::engine::Engine::default();
        let view = engine.answer(session.request());
        assert_eq!(session.probing.picture(&view).map(|picture| picture.size()), Some((64, 48)));
        let context = Context::default();
        let worst = session.probing.found.as_ref().unwrap().ranking[0];
        assert_eq!(apply(&mut session, &context, Change::GoTo(worst)), Rest::BringIntoView(worst.worst_pixel));
        assert_eq!(session.pick, Some(worst.worst_pixel));
        assert!(matches!(apply(&mut session, &context, Change::SaveCase(worst)), Rest::Write(_)));

        session.state.camera.dolly(2.0);
        (session.canvas_px, session.triangle_limit) = ((80, 48), Some(1));
        let other = engine.answer(session.request());
        assert!(session.probing.picture(&other).is_none());
        apply(&mut session, &context, Change::GoBack);
        let back = engine.answer(session.request());
        assert!(session.probing.picture(&back).is_some());
        apply(&mut session, &context, Change::Show(None));
        assert!(session.probing.picture(&back).is_none());
    }
}
