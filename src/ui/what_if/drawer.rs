//! Renderer side of the what-if comparison: draws the view before a change of settings (A) and after it (B), finds
//! their differences, then measures error and time in small steps.

use std::sync::Arc;

use crate::image::{Image, Rgba8};
use crate::inspect::what_if::Changes;
use crate::measure::error::{ImageError, compare};
use crate::measure::motion::{FrameSequence, Turn};
use crate::measure::pair::{PairTimer, PairTimes};
use crate::ui::engine::{Engine, RenderedView, Request, Shown};

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
    /// Error between the final pictures of A and B, once computed.
    pub(crate) error: Option<ImageError>,
    /// Frame times with and without the change, once measured.
    pub(crate) times: Option<PairTimes>,
}

/// Renderer of the most recent what-if request.
#[derive(Debug, Default)]
pub(crate) struct Drawer {
    engines: [Engine; 2],
    results: Option<WhatIfResults>,
    timer: Option<PairTimer>,
    begun: bool,
}

impl Drawer {
    /// Draws A and B, reusing earlier results, and finds their differences. Returns `None` if they cannot be compared.
    pub(crate) fn start(&mut self, request: WhatIfRequest) -> Option<&WhatIfResults> {
        self.begun = false;
        let [a, b] = &mut self.engines;
        let (mut before, after) =
            (render_converged(a, request.before.clone()), render_converged(b, request.after.clone()));
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
            return Some(self.results.insert(WhatIfResults { request, before, marked, ..old }));
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
            error: None,
            times: None,
        }))
    }

    /// Runs one more step of measuring the error or the frame times. Returns `None` if there is no new result yet.
    pub(crate) fn step(&mut self) -> Option<&WhatIfResults> {
        self.begun = true;
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

    /// Whether any result is missing.
    pub(crate) fn has_work(&self) -> bool {
        self.results.is_some() && self.timer.is_some()
    }

    /// Whether computing the missing results has begun.
    pub(crate) fn has_begun(&self) -> bool {
        self.begun && self.has_work()
    }

    /// Cancels all work and drops all results.
    pub(crate) fn clear(&mut self) {
        *self = Self::default();
    }
}

/// Draws frames until the view has converged, and returns it.
fn render_converged(engine: &mut Engine, request: Request) -> RenderedView {
    let mut view = engine.answer(Request { is_replayed: false, ..request });
    while view.is_unconverged() {
        view = engine.answer(view.request);
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
            (before.picture.size(), |x, y| before.value(x, y)),
            (after.picture.size(), |x, y| after.value(x, y)),
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
