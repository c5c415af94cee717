//! Undo and redo of settings, camera and picture size.

use super::{PictureSize, Session};
use crate::chain::Recipe;
use crate::scene::Camera;
use crate::ui::session::tile_set::TileSet;

/// Maximum number of undo steps.
const UNDO_STEPS: usize = 200;

/// Maximum pause, in seconds, between camera moves that are combined into one undo step, for example while scrolling.
const ONE_MOVE_SECONDS: f64 = 0.6;

/// State covered by undo.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Undoable {
    /// Recipe with which the picture is drawn.
    pub(crate) recipe: Recipe,
    /// Camera with which the picture is drawn.
    pub(crate) camera: Camera,
    /// Size of the picture: fixed, or equal to the size of the canvas.
    pub(crate) size: PictureSize,
    /// Recipes of all comparison tiles, and the index of the active one.
    pub(crate) tiles: TileSet,
}

/// Steps that can be undone and redone.
#[derive(Debug)]
pub(super) struct UndoHistory {
    /// Earlier states, oldest first.
    undo: Vec<Undoable>,
    /// Undone states, the next one to restore last.
    redo: Vec<Undoable>,
    /// State after the last step.
    settled: Undoable,
    /// Time of the last camera movement, in seconds; −∞ if another change followed it.
    camera_moved_at: f64,
}

impl UndoHistory {
    /// Creates an empty history that begins with a state.
    pub(super) fn new(state: &Undoable) -> Self {
        Self { undo: Vec::new(), redo: Vec::new(), settled: state.clone(), camera_moved_at: f64::NEG_INFINITY }
    }

    /// Forgets all steps, and continues with a state.
    pub(super) fn restart(&mut self, state: &Undoable) {
        self.undo.clear();
        self.redo.clear();
        self.settled = state.clone();
    }

    /// Returns an iterator over all states of the history.
    pub(super) fn states(&mut self) -> impl Iterator<Item = &mut Undoable> {
        self.undo.iter_mut().chain(&mut self.redo).chain([&mut self.settled])
    }
}

impl Session {
    /// Combines all changes since the last call into one undo step. `now` is the current time, in seconds. Must not be
    /// called while a change is in progress, such as a slider being dragged. Camera moves in quick succession form one
    /// step.
    pub(crate) fn settle(&mut self, now: f64) {
        self.note_visit(now);
        self.state.tiles.store(self.state.recipe);
        if self.state == self.history.settled {
            return;
        }
        let only_camera =
            Undoable { camera: self.history.settled.camera, ..self.state.clone() } == self.history.settled;
        let goes_on = only_camera && now - self.history.camera_moved_at < ONE_MOVE_SECONDS;
        // A camera move after another change starts a new step.
        self.history.camera_moved_at = if only_camera { now } else { f64::NEG_INFINITY };
        if !goes_on {
            if self.history.undo.len() == UNDO_STEPS {
                self.history.undo.remove(0);
            }
            self.history.undo.push(self.history.settled.clone());
        }
        self.history.redo.clear();
        self.features.what_if.settled(&self.history.settled.recipe, &self.state.recipe);
        self.history.settled = self.state.clone();
    }

    /// Accepts all changes since the last undo step without adding a step for them.
    pub(crate) fn settle_silently(&mut self) {
        self.history.settled = self.state.clone();
    }

    /// Whether there is a step to undo.
    pub(crate) fn can_undo(&self) -> bool {
        !self.history.undo.is_empty()
    }

    /// Whether there is a step to redo.
    pub(crate) fn can_redo(&self) -> bool {
        !self.history.redo.is_empty()
    }

    pub(in crate::ui) fn travel(&mut self, back: bool) {
        let (from, to) = if back {
            (&mut self.history.undo, &mut self.history.redo)
        } else {
            (&mut self.history.redo, &mut self.history.undo)
        };
        if let Some(state) = from.pop() {
            to.push(std::mem::replace(&mut self.state, state));
            self.features.what_if.settled(&self.history.settled.recipe, &self.state.recipe);
            self.history.settled = self.state.clone();
            self.history.camera_moved_at = f64::NEG_INFINITY;
        }
    }
}
