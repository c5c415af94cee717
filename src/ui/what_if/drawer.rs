//! The renderer's part: draws A and B, finds what differs, then measures error and time piece by piece.

use std::sync::Arc;

use crate::image::{Image, Rgba8};
use crate::inspect::what_if::Changes;
use crate::measure::error::{ImageError, compare};
use crate::measure::motion::{Shot, Turn};
use crate::measure::pair::{PairTimer, PairTimes};
use crate::ui::engine::{Engine, Request, Shown, View};

/// Rounds of timing that count.
pub const ROUNDS: usize = 15;

/// What is to be found out: the same view by two recipes.
#[derive(Clone, Debug)]
pub struct WhatIfRequest {
    /// A.
    pub before: Request,
    /// B.
    pub after: Request,
}

impl WhatIfRequest {
    /// Whether the answer to both is the same.
    pub fn same_as(&self, other: &Self) -> bool {
        self.before.same_view(&other.before) && self.after.same_view(&other.after)
    }
}

/// What is known so far.
#[derive(Clone, Debug)]
pub struct Found {
    /// What was asked.
    pub request: WhatIfRequest,
    /// A, coloured like B.
    pub before: View,
    /// B, with all that did not change pushed back.
    pub marked: View,
    /// What differs in what is shown.
    pub changes: Arc<Changes>,
    /// How far the finished pictures are apart, when that is found out.
    pub error: Option<ImageError>,
    /// What the change does to the time of a frame, when that is measured.
    pub times: Option<PairTimes>,
}

/// Works on the newest request.
#[derive(Debug, Default)]
pub struct Drawer {
    engines: [Engine; 2],
    known: Option<Found>,
    timer: Option<PairTimer>,
    begun: bool,
}

impl Drawer {
    /// Draws A and B as far as they are not there yet, and finds what differs. `None` if they cannot be compared.
    pub fn ask(&mut self, request: WhatIfRequest) -> Option<&Found> {
        self.begun = false;
        let [a, b] = &mut self.engines;
        let (mut before, after) = (settled(a, request.before.clone()), settled(b, request.after.clone()));
        let old = self.known.take();
        let kept = old.filter(|old| {
            Arc::ptr_eq(&old.before.frame, &before.frame)
                && Arc::ptr_eq(&old.marked.frame, &after.frame)
                && old.request.after.same_picture(&request.after)
        });
        if let Some(old) = kept {
            // Another pixel was picked.
            let (before, marked) =
                (View { picture: old.before.picture, ..before }, View { picture: old.marked.picture, ..after });
            return Some(self.known.insert(Found { request, before, marked, ..old }));
        }
        let changes = changes(&before, &after)?;
        if let Some(picture) = like(&before, &after) {
            (before.picture, before.range) = (picture, after.range);
        }
        let marked = View { picture: Arc::new(changes.marked(&after.picture)), ..after };
        self.timer = Some(PairTimer::new(request.before.recipe, request.after.recipe, ROUNDS));
        Some(self.known.insert(Found { request, before, marked, changes: Arc::new(changes), error: None, times: None }))
    }

    /// Finds out one more piece. `None` if that tells nothing new yet.
    pub fn step(&mut self) -> Option<&Found> {
        self.begun = true;
        let known = self.known.as_mut()?;
        if known.error.is_none() {
            known.error = compare(known.before.frame.image(), known.marked.frame.image());
        } else {
            let Request { scene, camera, viewport, .. } = &known.request.after;
            let shot = Shot { scene, camera, viewport: *viewport, turn: Turn::STILL };
            known.times = Some(self.timer.as_mut()?.step(&shot)?);
            self.timer = None;
        }
        self.known.as_ref()
    }

    /// Whether there is something left to find out.
    pub fn has_work(&self) -> bool {
        self.known.is_some() && self.timer.is_some()
    }

    /// Whether it has begun to find that out.
    pub fn has_begun(&self) -> bool {
        self.begun && self.has_work()
    }

    /// Stops, and forgets everything.
    pub fn clear(&mut self) {
        *self = Self::default();
    }
}

/// The view when no further frame of it is better.
fn settled(engine: &mut Engine, request: Request) -> View {
    let mut view = engine.answer(request);
    while view.wants_another() {
        view = engine.answer(view.request);
    }
    view
}

fn changes(before: &View, after: &View) -> Option<Changes> {
    match after.request.shown {
        Shown::Stage(_) => match (&before.looked.stage, &after.looked.stage) {
            (Some(before), Some(after)) => Changes::of_pictures(before, after),
            _ => Changes::of_pictures(&before.picture, &after.picture),
        },
        Shown::Buffer(_) | Shown::Intermediate(_) => Changes::of_values(
            (before.picture.size(), |x, y| before.value(x, y)),
            (after.picture.size(), |x, y| after.value(x, y)),
        ),
    }
}

/// A in the colours of B, where that is another picture: equal values shall have equal colours. With something laid over
/// it A keeps its own, and its own range beside it.
fn like(before: &View, after: &View) -> Option<Arc<Image<Rgba8>>> {
    let look = &after.request.look;
    if before.range == after.range || !look.layers.is_empty() {
        return None;
    }
    match after.request.shown {
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
