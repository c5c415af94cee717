//! Window state that is stored on disk between runs.

use eframe::egui::{Context, Ui};

use super::Workbench;
use crate::ui::layout;
use crate::ui::session::{Severity, WindowState};
use crate::ui::store::Store;
use crate::ui::workspace::Docks;

/// State of the window that is stored between runs, and the store.
#[derive(Default)]
pub(super) struct KeptWindow {
    /// Window state as of the last frame.
    state: WindowState,
    /// egui context of the window; `None` until the first frame.
    context: Option<Context>,
    /// Preferences on disk; `None` if nothing is stored, as in screenshots and tests.
    store: Option<Store>,
}

impl KeptWindow {
    /// Records the state of widgets such as headings.
    pub(super) fn record_layout(&mut self) {
        if let Some(context) = &self.context {
            self.state.layout = layout::text(context);
        }
    }
}

impl Workbench {
    /// Enables saving preferences to `store`, and restores the window state stored there.
    pub(in crate::ui) fn save_preferences_to(&mut self, store: Store) {
        self.kept.state = store.window().clone();
        self.docks = Docks::new(&self.kept.state.workspaces);
        self.kept.store = Some(store);
    }

    /// Passes changed preferences to the thread that writes them, and reports failed writes.
    pub(in crate::ui) fn save_preferences(&mut self) {
        let Some(store) = &mut self.kept.store else { return };
        store.enqueue(self.session.preferences(&self.kept.state));
        for failure in store.failures().collect::<Vec<_>>() {
            self.session.report(Severity::Error, failure);
        }
    }

    /// Records the theme, interface scale and size of the window.
    pub(super) fn observe_window(&mut self, ui: &Ui) {
        self.kept.context.get_or_insert_with(|| ui.ctx().clone());
        self.kept.state.light_theme = !ui.visuals().dark_mode;
        self.kept.state.scale = ui.ctx().zoom_factor();
        self.kept.state.workspaces = self.docks.stored();
        ui.input(|i| {
            let viewport = i.viewport();
            self.kept.state.maximized = viewport.maximized.unwrap_or(false);
            let is_ordinary = !self.kept.state.maximized && !viewport.fullscreen.unwrap_or(false);
            if is_ordinary {
                self.kept.state.window_size = Some((i.viewport_rect().size() * self.kept.state.scale).round().into());
            }
        });
    }
}
