//! Steps back and forward through settings, view and size.

use super::{PictureSize, Session};
use crate::chain::Recipe;
use crate::scene::Camera;
use crate::ui::compare::Tiles;

/// Steps that can be undone.
const UNDO_STEPS: usize = 200;

/// Camera moves closer in time than this are one step of undo: wheel notches, flying.
const ONE_MOVE_SECONDS: f64 = 0.6;

/// Everything that undo covers.
#[derive(Clone, Debug, PartialEq)]
pub struct Undoable {
    /// How the scene is drawn.
    pub recipe: Recipe,
    /// From where.
    pub camera: Camera,
    /// How large.
    pub size: PictureSize,
    /// The pictures that are compared with the one that is drawn by `recipe`.
    pub tiles: Tiles,
}

impl Session {
    /// Makes what changed since the last call one step of undo; `now` in seconds. Call it when no change is under way,
    /// such as a slider being dragged. Moves of the camera that follow each other closely are one step.
    pub fn settle(&mut self, now: f64) {
        self.note_visit(now);
        self.state.tiles.store(self.state.recipe);
        if self.state == self.settled {
            return;
        }
        let only_camera = Undoable { camera: self.settled.camera, ..self.state.clone() } == self.settled;
        let goes_on = only_camera && now - self.camera_moved_at < ONE_MOVE_SECONDS;
        // A move that follows another setting is no part of that step.
        self.camera_moved_at = if only_camera { now } else { f64::NEG_INFINITY };
        if !goes_on {
            if self.undo.len() == UNDO_STEPS {
                self.undo.remove(0);
            }
            self.undo.push(self.settled.clone());
        }
        self.redo.clear();
        self.what_if.settled(&self.settled.recipe, &self.state.recipe);
        self.settled = self.state.clone();
    }

    /// Takes the present state as the one that undo ends at.
    pub fn settle_silently(&mut self) {
        self.settled = self.state.clone();
    }

    /// Whether there is something to undo.
    pub fn can_undo(&self) -> bool {
        !self.undo.is_empty()
    }

    /// Whether there is something to redo.
    pub fn can_redo(&self) -> bool {
        !self.redo.is_empty()
    }

    pub(super) fn travel(&mut self, back: bool) {
        let (from, to) = if back { (&mut self.undo, &mut self.redo) } else { (&mut self.redo, &mut self.undo) };
        if let Some(state) = from.pop() {
            to.push(std::mem::replace(&mut self.state, state));
            self.what_if.settled(&self.settled.recipe, &self.state.recipe);
            self.settled = self.state.clone();
            self.camera_moved_at = f64::NEG_INFINITY;
        }
    }
}
