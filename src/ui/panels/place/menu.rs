//! The “Go” menu: search, navigation history, command line of the current inspection state, and bookmarks.

use eframe::egui::{Button, Ui};

use crate::ui::key_map::BINDINGS;
use crate::ui::key_sheet::key_name;
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::place::PlaceChange;
use crate::ui::session::window_task::DialogCommand;

/// Maximum number of bookmarks in the menu. The bookmarks dialog lists all of them.
const LISTED: usize = 20;

/// Draws the entries of the “Go” menu.
pub(crate) fn ui(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let mut entry = |ui: &mut Ui, enabled: bool, name: &str, command: Command| {
        let mut button = Button::new(name);
        if let Some(binding) = BINDINGS.iter().find(|binding| (binding.command)() == command) {
            button = button.shortcut_text(key_name(binding));
        }
        if ui.add_enabled(enabled, button).clicked() {
            commands.push(command);
            ui.close();
        }
    };
    let visits = &session.features.places.visits;
    entry(ui, true, "Find anything…", Command::Dialog(DialogCommand::Palette));
    entry(ui, true, "Go to…", Command::Dialog(DialogCommand::GoTo));
    ui.separator();
    entry(ui, visits.can_go_back(), "Go back to the previous view", Command::Place(PlaceChange::Back));
    entry(ui, visits.can_go_forward(), "Go forward to the next view", Command::Place(PlaceChange::Forward));
    ui.separator();
    entry(ui, true, "Copy view as command", Command::Place(PlaceChange::Copy));
    entry(ui, true, "Bookmark the current view", Command::Place(PlaceChange::Bookmark));
    entry(ui, true, "Manage bookmarks…", Command::Dialog(DialogCommand::Bookmarks));
    for (number, bookmark) in session.features.places.bookmarks.iter().take(LISTED).enumerate() {
        entry(ui, true, &bookmark.name, Command::Place(PlaceChange::Jump(number)));
    }
}
