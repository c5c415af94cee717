//! Appearance of the window: theme and interface scale.

use super::features::Feature;
use super::session::Session;
use super::window_task::WindowTask;

/// Appearance of the window, apart from what the toolkit stores itself: theme and scale.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Appearance;

/// Change to the appearance of the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum AppearanceChange {
    /// Switches between the dark and the light theme.
    ToggleTheme,
    /// Sets the scale of the whole interface; 1 is the default.
    Scale(f32),
}

impl Feature for Appearance {
    type Change = AppearanceChange;

    fn apply(_: &mut Session, change: AppearanceChange) -> Option<WindowTask> {
        Some(WindowTask::Appearance(change))
    }

    fn leave_scene(&mut self) {}
}
