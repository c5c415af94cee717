//! Explanation of another renderer's picture: which faults turn our drawing of the view into the opened picture file.
//!
//! A background thread searches. When it ends, the drawing with the faults becomes a tile of the comparison, so that
//! every pixel can be inspected in three pictures: ours, theirs, and ours with the faults.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use eframe::egui::Context;

use super::compare::CompareChange;
use super::compare::files::OpenedPicture;
use super::picture_role::PictureRole;
use super::{Session, Severity};
use crate::chain::Renderer;
use crate::explain::{ExplainError, Explanation, Query, Setup, TheirBuffers, depths, explain_with, ids};
use crate::image::{Image, Rgba8};
use crate::pipeline::viewport::Viewport;
use crate::ui::session::feature::Feature;
use crate::ui::session::window_task::WindowTask;
use crate::ui::task::{BackgroundTask, TaskStatus};

/// Tile that shows our drawing with the faults: C.
const FAULTY_TILE: usize = 2;

/// State of the explanation of a picture.
#[derive(Debug, Default)]
pub(crate) struct Explaining {
    /// Latest answer.
    pub(crate) found: Option<Arc<Explained>>,
    /// Completed fraction of the running search, from 0 to 1; `None` if none is running.
    pub(crate) progress: Option<f32>,
    /// Depths of the other renderer, if they were opened.
    pub(crate) depths: Option<Arc<OpenedPicture>>,
    /// Ids of the other renderer, if they were opened.
    pub(crate) ids: Option<Arc<OpenedPicture>>,
    /// Whether a search was requested.
    wanted: bool,
    task: Option<BackgroundTask<f32, Explained>>,
}

/// Explanation of a picture file.
#[derive(Debug)]
pub(crate) struct Explained {
    /// Path of the picture file.
    pub(crate) path: PathBuf,
    /// Inputs of our drawing without faults.
    correct: Setup,
    /// The other renderer's picture, as displayed.
    pub(in crate::ui) theirs: Arc<Image<Rgba8>>,
    /// Our drawing with the causes.
    pub(in crate::ui) faulty: Image<Rgba8>,
    /// The explanation.
    pub(crate) explanation: Explanation,
}

/// Change to the explanation, requested by the user.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ExplainingChange {
    /// Explains the opened picture file.
    Run,
    /// Cancels the search.
    Cancel,
    /// Closes the picture of depths.
    CloseDepths,
    /// Closes the picture of ids.
    CloseIds,
}

impl Feature for Explaining {
    type Change = ExplainingChange;

    fn apply(session: &mut Session, change: ExplainingChange) -> Option<WindowTask> {
        let explaining = &mut session.features.explaining;
        match change {
            ExplainingChange::Run => explaining.wanted = true,
            ExplainingChange::Cancel => explaining.task.iter().for_each(BackgroundTask::cancel),
            ExplainingChange::CloseDepths => explaining.depths = None,
            ExplainingChange::CloseIds => explaining.ids = None,
        }
        None
    }

    fn leave_scene(&mut self) {
        *self = Self::default();
    }
}

impl Explained {
    /// Whether the explanation is of this view, with the current settings.
    pub(crate) fn is_of(&self, session: &Session) -> bool {
        let (state, correct) = (&session.state, &self.correct);
        Arc::ptr_eq(&session.scene, &correct.scene) && state.camera == correct.camera && state.recipe == correct.recipe
    }
}

impl Session {
    /// Shows an opened picture file in its role: in the comparison, or in the explanation of one of its pictures.
    pub(in crate::ui) fn show_opened_picture(&mut self, role: PictureRole, picture: Arc<OpenedPicture>) {
        match role {
            PictureRole::Depths => open_depths(self, picture),
            PictureRole::Ids => open_ids(self, picture),
            PictureRole::Tile(_) | PictureRole::Reference => self.show_compared_picture(role, picture),
        }
    }
}

/// Uses a picture file as the depths of the explained picture, unless it has colours.
fn open_depths(session: &mut Session, picture: Arc<OpenedPicture>) {
    if let Err(reason) = depths(&picture.picture) {
        return session.report(Severity::Error, format!("{}: {reason}", picture.path.display()));
    }
    session.report(Severity::Info, format!("Opened {} as depths of the explained picture", picture.name()));
    session.features.explaining.depths = Some(picture);
}

/// Uses a picture file as the ids of the explained picture.
fn open_ids(session: &mut Session, picture: Arc<OpenedPicture>) {
    session.report(Severity::Info, format!("Opened {} as ids of the explained picture", picture.name()));
    session.features.explaining.ids = Some(picture);
}

/// Returns the opened depths and ids, or a message if their size is not that of the explained picture.
fn their_buffers(explaining: &Explaining, (width, height): (u32, u32)) -> Result<TheirBuffers, String> {
    for opened in explaining.depths.iter().chain(&explaining.ids) {
        let (other_width, other_height) = opened.picture.size();
        if (other_width, other_height) != (width, height) {
            let name = opened.name();
            return Err(format!(
                "{name}: it has {other_width} × {other_height} px, but the picture {width} × {height}"
            ));
        }
    }
    let depth = explaining.depths.as_ref().and_then(|opened| depths(&opened.picture).ok());
    Ok(TheirBuffers { depth, ids: explaining.ids.as_ref().map(|opened| ids(&opened.picture)) })
}

/// Returns the picture file that would be explained: the first one that is opened as A, B or in another tile.
pub(crate) fn subject(session: &Session) -> Option<Arc<OpenedPicture>> {
    let faulty = session.features.explaining.found.as_ref().map(|found| faulty_name(&found.path));
    let tiles = &session.state.tiles;
    let opened =
        (0..tiles.count()).filter_map(|tile| session.features.comparison.opened(tiles, PictureRole::Tile(tile)));
    opened.into_iter().find(|opened| Some(&opened.path) != faulty.as_ref())
}

/// Returns the name, in place of a path, of our drawing with the faults of a picture file.
fn faulty_name(path: &std::path::Path) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    PathBuf::from(format!("ours with the faults of {name}"))
}

/// Handles the result of the running search, and starts the requested one. If `waits` is `true`, searches synchronously.
pub(crate) fn step(session: &mut Session, context: &Context, waits: bool) {
    listen(session);
    if !std::mem::take(&mut session.features.explaining.wanted) {
        return;
    }
    let Some(opened) = subject(session) else {
        return session.report(Severity::Error, "Open a picture file as B first: there is none to explain");
    };
    let (width, height) = opened.shown.size();
    let (camera, recipe) = (session.state.camera, session.state.recipe);
    let correct = Setup::new(session.scene.clone(), camera, recipe, Viewport { width, height });
    let buffers = match their_buffers(&session.features.explaining, (width, height)) {
        Ok(buffers) => buffers,
        Err(text) => return session.report(Severity::Error, text),
    };
    let subject = Subject { opened, buffers, correct };
    if waits {
        if let Some(found) = explained(&subject, &|_| {}, &AtomicBool::new(false)) {
            show(session, found);
        }
        return;
    }
    let explaining = &mut session.features.explaining;
    explaining.progress = Some(0.0);
    let work =
        move |report_progress: &(dyn Fn(f32) + Sync), stop: &AtomicBool| explained(&subject, report_progress, stop);
    explaining.task = Some(BackgroundTask::start(context.clone(), work));
}

fn listen(session: &mut Session) {
    let explaining = &mut session.features.explaining;
    let Some(task) = &explaining.task else { return };
    match task.poll(&mut explaining.progress) {
        TaskStatus::Running => {}
        TaskStatus::Ended(found) => {
            explaining.task = None;
            if let Some(found) = found {
                show(session, *found);
            }
        }
        TaskStatus::Lost => {
            explaining.task = None;
            session.report(Severity::Error, "Explaining stopped: internal error");
        }
    }
}

/// Inputs of a search.
struct Subject {
    /// The other renderer's picture.
    opened: Arc<OpenedPicture>,
    /// Its depths and ids.
    buffers: TheirBuffers,
    /// Inputs of our drawing without faults.
    correct: Setup,
}

/// Searches for the faults of a picture. Returns `None` if cancelled.
fn explained(
    Subject { opened, buffers, correct }: &Subject,
    report_progress: &(dyn Fn(f32) + Sync),
    stop: &AtomicBool,
) -> Option<Explained> {
    let go_on = |share: f32| {
        report_progress(share);
        !stop.load(Ordering::Relaxed)
    };
    let query = Query { correct: correct.clone(), theirs: (*opened.shown).clone(), without: Vec::new() };
    match explain_with(&query, buffers, &go_on) {
        Ok(explanation) => {
            let faulty = explanation.setup.draw(&mut Renderer::default());
            Some(Explained {
                path: opened.path.clone(),
                correct: correct.clone(),
                theirs: opened.shown.clone(),
                faulty,
                explanation,
            })
        }
        // Our drawing takes the size of the picture.
        Err(ExplainError::Interrupted | ExplainError::Size { .. }) => None,
    }
}

/// Stores an explanation, and shows the drawing with the faults if there are any.
fn show(session: &mut Session, found: Explained) {
    if !found.explanation.causes.is_empty() {
        let drawn = OpenedPicture::drawn(&faulty_name(&found.path), &found.faulty);
        session.compare(CompareChange::File(PictureRole::Tile(FAULTY_TILE), Arc::new(drawn)));
    }
    session.report(Severity::Info, found.explanation.summary());
    session.features.explaining.found = Some(Arc::new(found));
}
