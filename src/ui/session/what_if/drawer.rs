//! Renderer side of the what-if comparison: draws the view before a change of settings (A) and after it (B), finds
//! their differences, then measures error and time in small steps.

use std::sync::Arc;

use crate::image::{Image, Rgba8};
use crate::inspect::what_if::{Changes, PictureValues};
use crate::measure::checkpoints;
use crate::measure::error::{ImageError, compare};
use crate::measure::motion::{FrameSequence, Turn};
use crate::measure::pair::{PairTimer, PairTimes};
use crate::ui::engine::replay::{ReplayProgress, ReplayStep, Replayer};
use crate::ui::engine::{CHECKPOINT_BYTES, Engine, RenderedView, Request, Shown};

/// Number of measured rounds, each of which times A and B.
pub(crate) const ROUNDS: usize = 15;

/// Request to compare the same view with two recipes.
#[derive(Clone, Debug)]
pub(crate) struct WhatIfRequest {
    /// View with the recipe before the change (A).
    pub(crate) before: Request,
    /// View with the recipe after the change (B).
    pub(crate) after: Request,
}

impl WhatIfRequest {
    /// Whether both requests have the same result.
    pub(crate) fn same_as(&self, other: &Self) -> bool {
        self.before.same_view(&other.before) && self.after.same_view(&other.after)
    }

    fn same_frames(&self, other: &Self) -> bool {
        self.before.same_frame(&other.before) && self.after.same_frame(&other.after)
    }
}

/// Results of a what-if request so far.
#[derive(Clone, Debug)]
pub(crate) struct WhatIfResults {
    /// Request for which the results were computed.
    pub(crate) request: WhatIfRequest,
    /// View A, coloured with the same range of values as B.
    pub(crate) before: RenderedView,
    /// View B, with unchanged pixels dimmed.
    pub(crate) marked: RenderedView,
    /// Pixels at which the shown quantity differs between A and B.
    pub(crate) changes: Arc<Changes>,
    /// Progress of drawing the frames before that of A or B, whose history the picture lacks; `None` if no frame is missing.
    pub(crate) replay: Option<ReplayProgress>,
    /// Error between the final pictures of A and B, once computed.
    pub(crate) error: Option<ImageError>,
    /// Frame times with and without the change, once measured.
    pub(crate) times: Option<PairTimes>,
}

/// Renderer of the most recent what-if request.
#[derive(Debug)]
pub(crate) struct Drawer {
    engines: [Engine; 2],
    /// Replays of the frames before those of A and B.
    replayers: [Replayer; 2],
    results: Option<WhatIfResults>,
    timer: Option<PairTimer>,
    begun: bool,
}

impl Default for Drawer {
    fn default() -> Self {
        Self {
            engines: [(); 2].map(|()| Engine::with_checkpoints_within(CHECKPOINT_BYTES / 2)),
            replayers: Default::default(),
            results: None,
            timer: None,
            begun: false,
        }
    }
}

impl Drawer {
    /// Draws A and B, reusing earlier results, and finds their differences. Returns `None` if they cannot be compared.
    pub(crate) fn start(&mut self, request: WhatIfRequest) -> Option<&WhatIfResults> {
        self.begun = false;
        if !self.results.as_ref().is_some_and(|known| known.request.same_frames(&request)) {
            self.replayers.iter_mut().for_each(Replayer::resume);
        }
        let ([a, b], [replay_a, replay_b]) = (&mut self.engines, &mut self.replayers);
        let mut before = render_converged(a, replay_a, request.before.clone());
        let after = render_converged(b, replay_b, request.after.clone());
        let replay = self.replay_progress();
        let old = self.results.take();
        let kept = old.filter(|old| {
            Arc::ptr_eq(&old.before.frame, &before.frame)
                && Arc::ptr_eq(&old.marked.frame, &after.frame)
                && old.request.after.same_picture(&request.after)
        });
        if let Some(old) = kept {
            // Only the picked pixel has changed.
            let (before, marked) = (
                RenderedView { picture: old.before.picture, ..before },
                RenderedView { picture: old.marked.picture, ..after },
            );
            return Some(self.results.insert(WhatIfResults { request, before, marked, replay, ..old }));
        }
        let changes = changes(&before, &after)?;
        if let Some(picture) = with_range_of(&before, &after) {
            (before.picture, before.range) = (picture, after.range);
        }
        let marked = RenderedView { picture: Arc::new(changes.with_unchanged_dimmed(&after.picture)), ..after };
        self.timer = Some(PairTimer::new(request.before.recipe, request.after.recipe, ROUNDS));
        Some(self.results.insert(WhatIfResults {
            request,
            before,
            marked,
            changes: Arc::new(changes),
            replay,
            error: None,
            times: None,
        }))
    }

    /// Draws one frame that is missing from the history of A or B, or runs one more step of measuring the error or the frame
    /// times. Returns `None` if there is no new result yet.
    pub(crate) fn step(&mut self) -> Option<&WhatIfResults> {
        self.begun = true;
        if !self.has_work() {
            return None;
        }
        if let Some(place) = self.replayers.iter().position(Replayer::has_work) {
            return self.replay(place);
        }
        let known = self.results.as_mut()?;
        if known.error.is_none() {
            known.error = compare(known.before.frame.image(), known.marked.frame.image());
        } else {
            let Request { scene, camera, viewport, .. } = &known.request.after;
            let shot = FrameSequence { scene, camera, viewport: *viewport, turn: Turn::STILL };
            known.times = Some(self.timer.as_mut()?.step(&shot)?);
            self.timer = None;
        }
        self.results.as_ref()
    }

    /// Draws one frame that is missing from the history of A (`place` is 0) or B (1), or else their pictures. Returns `None`
    /// if progress need not be shown yet.
    fn replay(&mut self, place: usize) -> Option<&WhatIfResults> {
        let engine = &mut self.engines[place];
        match self.replayers[place].step(&mut engine.checkpoints)? {
            ReplayStep::Complete(replayed) => {
                engine.adopt(*replayed);
                let request = self.results.as_ref()?.request.clone();
                self.start(request)?;
                self.begun = true;
            }
            ReplayStep::Slow(progress) if progress.done.is_multiple_of(checkpoints::SPACING) => {
                self.results.as_mut()?.replay = Some(progress);
            }
            ReplayStep::Slow(_) | ReplayStep::Drawn => return None,
        }
        self.results.as_ref()
    }

    fn replay_progress(&self) -> Option<ReplayProgress> {
        self.replayers.iter().find_map(Replayer::progress)
    }

    /// Whether any result is missing.
    pub(crate) fn has_work(&self) -> bool {
        self.results.is_some() && (self.timer.is_some() || self.replay_progress().is_some())
    }

    /// Whether computing the missing results has begun.
    pub(crate) fn has_begun(&self) -> bool {
        self.begun && self.has_work()
    }

    /// Stops drawing the frames that are missing from the history of A or B, until other frames are requested. If there are
    /// any, error and time are not measured either, because A and B depend on the frames that were shown.
    pub(crate) fn cancel_replay(&mut self) {
        if self.replay_progress().is_some() {
            self.replayers.iter_mut().for_each(Replayer::cancel);
            self.timer = None;
        }
    }

    /// Cancels all work and drops all results.
    pub(crate) fn clear(&mut self) {
        *self = Self::default();
    }
}

/// Draws frames until the view has converged, and returns it. In a scene in motion, draws one frame, and passes it to
/// `replayer` if frames are missing from its history.
fn render_converged(engine: &mut Engine, replayer: &mut Replayer, request: Request) -> RenderedView {
    let mut view = engine.answer(request);
    while view.is_unconverged() {
        view = engine.answer(view.request);
    }
    if view.needs_replay {
        replayer.set(&view.request);
    } else {
        replayer.clear();
    }
    view
}

fn changes(before: &RenderedView, after: &RenderedView) -> Option<Changes> {
    match after.request.shown.source() {
        Shown::Stage(_) => match (&before.look_result.stage, &after.look_result.stage) {
            (Some(before), Some(after)) => Changes::of_pictures(before, after),
            _ => Changes::of_pictures(&before.picture, &after.picture),
        },
        Shown::Buffer(_) | Shown::Intermediate(_) => Changes::of_values(
            &PictureValues { size: before.picture.size(), value: |x, y| before.value(x, y) },
            &PictureValues { size: after.picture.size(), value: |x, y| after.value(x, y) },
        ),
    }
}

/// Returns picture A, coloured with the range of B so that equal values have equal colours. Returns `None` if A keeps
/// its own picture, because the ranges are equal, an overlay is active, or a stage is shown.
fn with_range_of(before: &RenderedView, after: &RenderedView) -> Option<Arc<Image<Rgba8>>> {
    let look = &after.request.look;
    if before.range == after.range || !look.layers.is_empty() {
        return None;
    }
    match after.request.shown.source() {
        Shown::Buffer(buffer) => {
            Some(look.display.picture(buffer, &before.frame, before.buffers.as_deref(), after.range))
        }
        Shown::Intermediate(_) => {
            Some(look.display.picture_of(None, before.picture.size(), after.range, |x, y| before.value(x, y)))
        }
        Shown::Stage(_) => None,
    }
    .map(Arc::new)
}
