//! Interface of the parts of the window that own state.

use std::fmt::Debug;

use super::window_task::WindowTask;
use super::{Preferences, Session};

/// Part of the window that owns its state.
pub(crate) trait Feature {
    /// Change that a command makes to the feature.
    type Change: Clone + Debug + PartialEq;

    /// Applies a change to the feature and to the rest of the session. Returns a task if the window must complete it.
    fn apply(session: &mut Session, change: Self::Change) -> Option<WindowTask>;

    /// Discards everything that belongs to the previous scene, after another one was opened.
    fn leave_scene(&mut self);

    /// Copies what the feature stores between runs into the preferences.
    fn store(&self, _preferences: &mut Preferences) {}

    /// Restores what [`Self::store`] has stored.
    fn restore(&mut self, _preferences: &Preferences) {}
}
