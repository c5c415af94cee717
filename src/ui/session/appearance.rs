//! Appearance of the window: theme, interface scale, and reduced motion.

use super::feature::Feature;
use super::window_task::WindowTask;
use super::{Preferences, Session};

/// Appearance of the window, apart from the theme and the scale, which the toolkit stores.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Appearance {
    /// Whether the user wants reduced motion; `None` if the user has not chosen.
    pub(crate) reduce_motion: Option<bool>,
    /// Whether the desktop reduces motion, which is the default.
    pub(crate) desktop_reduces_motion: bool,
}

impl Appearance {
    /// Whether the window avoids motion: animations, fading, blinking and smooth scrolling.
    pub(crate) fn reduces_motion(&self) -> bool {
        self.reduce_motion.unwrap_or(self.desktop_reduces_motion)
    }
}

/// Change to the appearance of the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum AppearanceChange {
    /// Switches between the dark and the light theme.
    ToggleTheme,
    /// Sets the scale of the whole interface; 1 is the default.
    Scale(f32),
    /// Switches reduced motion on or off.
    ToggleMotion,
}

impl Feature for Appearance {
    type Change = AppearanceChange;

    fn apply(session: &mut Session, change: AppearanceChange) -> Option<WindowTask> {
        let appearance = &mut session.features.appearance;
        match change {
            AppearanceChange::ToggleMotion => appearance.reduce_motion = Some(!appearance.reduces_motion()),
            AppearanceChange::ToggleTheme => return Some(WindowTask::ToggleTheme),
            AppearanceChange::Scale(scale) => return Some(WindowTask::SetScale(scale)),
        }
        None
    }

    fn leave_scene(&mut self) {}

    fn store(&self, preferences: &mut Preferences) {
        preferences.window.reduce_motion = self.reduce_motion;
    }

    fn restore(&mut self, preferences: &Preferences) {
        self.reduce_motion = preferences.window.reduce_motion;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_choice_of_the_user_is_stored_and_overrides_the_desktop() {
        let mut appearance = Appearance { desktop_reduces_motion: true, ..Appearance::default() };
        assert!(appearance.reduces_motion());
        appearance.reduce_motion = Some(false);
        let mut preferences = Preferences::default();
        appearance.store(&mut preferences);
        let mut restored = Appearance { desktop_reduces_motion: true, ..Appearance::default() };
        restored.restore(&Preferences::read(&preferences.write()));
        assert!(!restored.reduces_motion());
    }
}
