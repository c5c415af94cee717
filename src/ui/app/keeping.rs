//! Window state that is stored on disk between runs.

use eframe::egui::Ui;

use super::Workbench;
use crate::ui::session::Severity;
use crate::ui::store::Store;
use crate::ui::workspace::Docks;

impl Workbench {
    /// Enables saving preferences to `store`, and restores the window state stored there.
    pub(in crate::ui) fn save_preferences_to(&mut self, store: Store) {
        self.window = store.window().clone();
        self.docks = Docks::new(&self.window.workspaces);
        self.store = Some(store);
    }

    /// Passes changed preferences to the thread that writes them, and reports failed writes.
    pub(in crate::ui) fn save_preferences(&mut self) {
        let Some(store) = &mut self.store else { return };
        store.enqueue(self.session.preferences(&self.window));
        for failure in store.failures().collect::<Vec<_>>() {
            self.session.report(Severity::Error, failure);
        }
    }

    /// Records the theme, interface scale and size of the window.
    pub(super) fn observe_window(&mut self, ui: &Ui) {
        self.context.get_or_insert_with(|| ui.ctx().clone());
        self.window.light_theme = !ui.visuals().dark_mode;
        self.window.scale = ui.ctx().zoom_factor();
        self.window.workspaces = self.docks.stored();
        ui.input(|i| {
            let viewport = i.viewport();
            self.window.maximized = viewport.maximized.unwrap_or(false);
            let is_ordinary = !self.window.maximized && !viewport.fullscreen.unwrap_or(false);
            if is_ordinary {
                self.window.window_size = Some((i.viewport_rect().size() * self.window.scale).round().into());
            }
        });
    }
}
