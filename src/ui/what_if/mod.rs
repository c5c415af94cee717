//! What if: the settings before the last change are kept, and what that change did is shown: which fields, how many
//! pixels, how far the pictures are apart, how much longer a frame takes.
//!
//! A is what was, B what is. A stays what it was while it is pinned; else every settled change makes its own A. Both
//! are drawn by the renderer's thread, and only while somebody looks.

pub mod bar;

pub mod drawer;

use eframe::egui::Ui;

use super::command::Command;
use super::engine::{Request, View};
use super::session::Session;
use crate::chain::Recipe;
use crate::inspect::fields;
use drawer::{Found, WhatIfRequest};

/// What the canvas shows of A and B.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Show {
    /// B, with all that did not change pushed back.
    #[default]
    Changed,
    /// What is.
    After,
    /// What was.
    Before,
}

impl Show {
    /// All, with name and explanation.
    pub const ALL: [(Self, &'static str, &'static str); 3] = [
        (Self::Changed, "Only changes", "B where it changed; all else in dark grey. Hold Shift to see A"),
        (Self::Before, "A", "What was drawn before the change"),
        (Self::After, "B", "What is drawn now; hold Shift to see A"),
    ];
}

/// What is asked of a change.
#[derive(Clone, Debug, Default)]
pub struct WhatIf {
    /// Whether the bar is there.
    pub open: bool,
    /// A: the recipe before the last change, or the pinned one.
    pub before: Option<Recipe>,
    /// Whether A stays while B changes further.
    pub pinned: bool,
    /// What the canvas shows.
    pub show: Show,
    /// What is known.
    pub found: Option<Found>,
    /// What was asked of the renderer last.
    asked: Option<WhatIfRequest>,
}

/// A change of what is asked.
#[derive(Clone, Debug, PartialEq)]
pub enum Change {
    /// Open the bar, or close it.
    Toggle,
    /// Show this on the canvas.
    Show(Show),
    /// Keep A while B changes further, or no more.
    Pin(bool),
    /// Take this for A, and keep it.
    Against(Box<Recipe>),
    /// Take what is now for A, and keep it.
    PinNow,
    /// Go back to A.
    Revert,
    /// A becomes B and B becomes A.
    Swap,
    /// Question the next changed pixel, or the one before.
    Step(i64),
}

impl WhatIf {
    /// Takes in that the recipe changed and no change is under way.
    pub fn settled(&mut self, before: &Recipe, after: &Recipe) {
        if before != after && !self.pinned {
            self.before = Some(*before);
        }
    }

    /// The last change in words, if its bar is closed and the settings still are what it made of them.
    pub fn unasked(&self, after: &Recipe) -> Option<String> {
        let before = self.before.as_ref().filter(|before| !self.open && *before != after)?;
        let changed = fields::changes(before, after);
        let first = changed.first()?.words();
        Some(if changed.len() == 1 { first } else { format!("{first}, and {} more", changed.len() - 1) })
    }

    /// Whether the renderer has to be asked anew; takes the request for asked.
    pub fn asks_anew(&mut self, request: Option<&WhatIfRequest>) -> bool {
        let same = match (&self.asked, request) {
            (Some(asked), Some(request)) => asked.same_as(request),
            (None, None) => true,
            _ => false,
        };
        if !same {
            self.asked = request.cloned();
        }
        if request.is_none() {
            self.found = None;
        }
        !same
    }

    /// What was found, if it is of what is shown now.
    fn current(&self, view: &View) -> Option<&Found> {
        let same = |found: &&Found| found.request.after.same_picture(&view.request);
        self.found.as_ref().filter(|_| self.open).filter(same)
    }

    /// The view that the canvas shows: A, or B with or without what did not change. A as long as `held`.
    pub fn seen<'a>(&'a self, view: &'a View, held: bool) -> &'a View {
        let Some(found) = self.current(view) else { return view };
        match self.show {
            _ if held => &found.before,
            Show::Before => &found.before,
            Show::Changed => &found.marked,
            Show::After => view,
        }
    }
}

/// What the canvas shows of the newest view, as [`WhatIf::seen`] tells.
pub fn seen<'a>(ui: &Ui, session: &'a Session) -> Option<&'a View> {
    let view = session.view.as_ref()?;
    if session.comparison.is_on() {
        return Some(view);
    }
    Some(session.what_if.seen(view, ui.input(|input| input.modifiers.shift)))
}

impl Session {
    /// What the renderer should find out, if the bar is open and there is an A.
    pub fn what_if_request(&self) -> Option<WhatIfRequest> {
        let shown = self.what_if.open && !self.comparison.is_on() && self.case.is_none();
        let recipe = self.what_if.before.filter(|_| shown)?;
        let after = self.request();
        Some(WhatIfRequest { before: Request { recipe, ..after.clone() }, after })
    }

    /// Does what concerns the comparison with what was; returns what concerns the canvas.
    pub fn change_what_if(&mut self, change: Change) -> Option<Command> {
        let what_if = &mut self.what_if;
        match change {
            Change::Toggle => what_if.open ^= true,
            Change::Show(show) => what_if.show = show,
            Change::Pin(pinned) => what_if.pinned = pinned,
            Change::Against(recipe) => (what_if.before, what_if.pinned, what_if.open) = (Some(*recipe), true, true),
            Change::PinNow => (what_if.before, what_if.pinned) = (Some(self.state.recipe), true),
            Change::Revert => self.state.recipe = what_if.before.unwrap_or(self.state.recipe),
            Change::Swap => {
                if let Some(before) = &mut what_if.before {
                    std::mem::swap(before, &mut self.state.recipe);
                }
            }
            Change::Step(_) => return Some(Command::WhatIf(change)),
        }
        None
    }

    /// The changed pixel after or before the picked one.
    pub fn change_beside_pick(&self, forwards: bool) -> Option<(u32, u32)> {
        let found = self.what_if.current(self.view.as_ref()?)?;
        found.changes.beside(self.pick, forwards)
    }
}

#[cfg(test)]
mod tests;
