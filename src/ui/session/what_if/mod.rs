//! The what-if comparison: keeps the settings before the last change and shows its effect, as changed fields, number of
//! changed pixels, error between the pictures, and difference in frame time.
//!
//! A is the state before the change, B the current one. Every completed change sets a new A, unless A is pinned. The
//! render thread draws both, but only while the bar is open.

pub(crate) mod drawer;

use std::sync::Arc;

use eframe::egui::Ui;

use super::Session;
use crate::chain::Recipe;
use crate::inspect::fields;
use crate::inspect::what_if::Changes;
use crate::ui::engine::{RenderedView, Request};
use crate::ui::session::feature::Feature;
use crate::ui::session::window_task::WindowTask;
use drawer::{WhatIfRequest, WhatIfResults};

/// Picture of a what-if comparison that the canvas shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Show {
    /// Picture B dimmed, with changed pixels in the signal colour.
    #[default]
    Marked,
    /// Picture B, with unchanged pixels dimmed.
    Changed,
    /// Picture B, the current state.
    After,
    /// Picture A, the state before the change.
    Before,
}

impl Show {
    /// All options, each with its name and help text.
    pub(crate) const ALL: [(Self, &'static str, &'static str); 4] = [
        (
            Self::Marked,
            "Changed pixels",
            "Mark changed pixels over the dimmed picture B, each large enough to be visible. Hold Shift to show A",
        ),
        (Self::Changed, "B, rest grey", "Show B with unchanged pixels in dark grey. Hold Shift to show A"),
        (Self::Before, "A", "Show A, the frame before the change"),
        (Self::After, "B", "Show B, the current frame. Hold Shift to show A"),
    ];
}

/// State of the what-if comparison.
#[derive(Clone, Debug, Default)]
pub(crate) struct WhatIf {
    /// Whether the what-if bar is open.
    pub(crate) open: bool,
    /// Recipe of A: the last recipe before the current one, or the pinned one; `None` before the first change.
    pub(crate) before: Option<Recipe>,
    /// Whether A is pinned while B changes.
    pub(crate) pinned: bool,
    /// Picture that the canvas shows.
    pub(crate) show: Show,
    /// Results so far, if any.
    pub(crate) found: Option<WhatIfResults>,
    /// Last request sent to the renderer.
    last_request: Option<WhatIfRequest>,
}

/// Change to the what-if comparison.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum WhatIfChange {
    /// Opens or closes the what-if bar.
    Toggle,
    /// Sets which picture the canvas shows.
    Show(Show),
    /// Pins or unpins A.
    Pin(bool),
    /// Pins this recipe as A, and opens the bar.
    Against(Box<Recipe>),
    /// Pins the current recipe as A.
    PinNow,
    /// Restores the settings of A.
    Revert,
    /// Swaps A and B.
    Swap,
    /// Picks the next changed pixel, or the previous one if the number is negative.
    Step(i64),
}

impl WhatIf {
    /// Stores the recipe before a completed change as A, unless A is pinned.
    pub(crate) fn settled(&mut self, before: &Recipe, after: &Recipe) {
        if before != after && !self.pinned {
            self.before = Some(*before);
        }
    }

    /// Describes the last change if the bar is closed and the settings still differ from A.
    pub(crate) fn unseen_change(&self, after: &Recipe) -> Option<String> {
        let before = self.before.as_ref().filter(|before| !self.open && *before != after)?;
        let changed = fields::changes(before, after);
        let first = changed.first()?.words();
        Some(if changed.len() == 1 { first } else { format!("{first}, and {} more", changed.len() - 1) })
    }

    /// Stores a request as the last one. Returns whether it differs from the previous one.
    pub(crate) fn update_request(&mut self, request: Option<&WhatIfRequest>) -> bool {
        let same = match (&self.last_request, request) {
            (Some(asked), Some(request)) => asked.same_as(request),
            (None, None) => true,
            _ => false,
        };
        if !same {
            self.last_request = request.cloned();
        }
        if request.is_none() {
            self.found = None;
        }
        !same
    }

    /// Returns the results if they describe the view on screen and the bar is open. While frames are missing from the
    /// history of the view or of picture B, the two may differ.
    pub(in crate::ui) fn current(&self, view: &RenderedView) -> Option<&WhatIfResults> {
        let is_complete = |found: &&WhatIfResults| !view.needs_replay && !found.marked.needs_replay;
        let same = |found: &&WhatIfResults| found.request.after.same_picture(&view.request);
        self.found.as_ref().filter(|_| self.open).filter(is_complete).filter(same)
    }

    /// Returns the view that the canvas shows: A, B, or B with unchanged pixels dimmed. If `held` is `true` (Shift
    /// is held down), it shows A.
    pub(crate) fn visible_view<'a>(&'a self, view: &'a RenderedView, held: bool) -> &'a RenderedView {
        let Some(found) = self.current(view) else { return view };
        match self.show {
            _ if held => &found.before,
            Show::Before => &found.before,
            Show::Changed => &found.marked,
            Show::After | Show::Marked => view,
        }
    }

    /// Returns the changed pixels if the canvas marks them; `None` while `held` is `true`.
    pub(crate) fn marked_changes(&self, view: &RenderedView, held: bool) -> Option<&Arc<Changes>> {
        let is_marked = self.show == Show::Marked && !held;
        self.current(view).filter(|_| is_marked).map(|found| &found.changes)
    }
}

/// Returns the view that the canvas shows: A, B, or B with unchanged pixels dimmed. While Shift is held down, it
/// shows A. Returns `None` before the first view.
pub(crate) fn visible_view<'a>(ui: &Ui, session: &'a Session) -> Option<&'a RenderedView> {
    let view = session.view.as_ref()?;
    if session.features.comparison.is_on() {
        return Some(view);
    }
    Some(session.features.what_if.visible_view(view, ui.input(|input| input.modifiers.shift)))
}

/// Returns the changed pixels that the canvas marks over the picture; `None` if it marks none.
pub(crate) fn marked_changes<'a>(ui: &Ui, session: &'a Session) -> Option<&'a Arc<Changes>> {
    let view = session.view.as_ref().filter(|_| !session.features.comparison.is_on())?;
    session.features.what_if.marked_changes(view, ui.input(|input| input.modifiers.shift))
}

impl Session {
    /// Returns the what-if request for the renderer; `None` if the bar is closed, if there is no state A, or while a
    /// comparison or a case is open.
    pub(crate) fn what_if_request(&self) -> Option<WhatIfRequest> {
        let shown = self.features.what_if.open && !self.features.comparison.is_on() && self.features.case.is_none();
        let recipe = self.features.what_if.before.filter(|_| shown)?;
        let after = self.request();
        Some(WhatIfRequest { before: Request { recipe, ..after.clone() }, after })
    }

    /// Returns the next changed pixel after the picked one, or the previous one if not `forwards`.
    pub(crate) fn change_beside_pick(&self, forwards: bool) -> Option<(u32, u32)> {
        let found = self.features.what_if.current(self.view.as_ref()?)?;
        found.changes.next_changed(self.pick, forwards)
    }
}

impl Feature for WhatIf {
    type Change = WhatIfChange;

    fn apply(session: &mut Session, change: WhatIfChange) -> Option<WindowTask> {
        let what_if = &mut session.features.what_if;
        match change {
            WhatIfChange::Toggle => what_if.open ^= true,
            WhatIfChange::Show(show) => what_if.show = show,
            WhatIfChange::Pin(pinned) => what_if.pinned = pinned,
            WhatIfChange::Against(recipe) => {
                (what_if.before, what_if.pinned, what_if.open) = (Some(*recipe), true, true);
            }
            WhatIfChange::PinNow => (what_if.before, what_if.pinned) = (Some(session.state.recipe), true),
            WhatIfChange::Revert => session.state.recipe = what_if.before.unwrap_or(session.state.recipe),
            WhatIfChange::Swap => {
                if let Some(before) = &mut what_if.before {
                    std::mem::swap(before, &mut session.state.recipe);
                }
            }
            WhatIfChange::Step(step) => {
                let pixel = session.change_beside_pick(step > 0)?;
                session.pick = Some(pixel);
                return Some(WindowTask::BringIntoView(pixel));
            }
        }
        None
    }

    fn leave_scene(&mut self) {}
}

#[cfg(test)]
mod tests;
