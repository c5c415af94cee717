//! Tests of the palette: synonyms, and several input events in one pass.

use std::sync::Arc;

use eframe::egui::{Event, Modifiers, PointerButton, Pos2, Theme, Vec2};

use super::Palette;
use super::entries::all;
use crate::chain::Recipe;
use crate::scene::SceneSource;
use crate::ui::app::Workbench;
use crate::ui::headless::Headless;
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::window_task::DialogCommand;
use crate::ui::worker::Worker;

/// Returns the title of the entry that the palette lists first for a query.
fn first(session: &Session, query: &str) -> String {
    let mut palette = Palette::new(session, query);
    palette.search(session);
    palette.at(0).map(|(entry, _)| entry.title.clone()).unwrap_or_default()
}

#[test]
fn synonyms_find_their_entry_first() {
    let source = SceneSource::named("chess".into());
    let scene = source.load().unwrap().scene;
    let home = scene.home;
    let session = Session::new(Arc::new(scene), source, Recipe::default(), home);
    for (typed, title) in [
        ("zbuffer", "Show buffer: Depth"),
        ("depth buffer", "Show buffer: Depth"),
        ("wrap", "address = "),
        ("export", "Save the picture as PNG under a chosen name"),
        ("screenshot", "Save the picture as PNG"),
        ("fps", "Show panel: Frame time"),
        ("crop", "Draw a rectangle"),
        ("msaa", "antialias.method = multisample"),
        ("AA", "antialias.method = "),
        ("wireframe", "wireframe = true"),
        ("reset", "Reset all settings"),
        ("fov", "Select stage: Transform"),
        ("undo", "Undo the last change"),
        ("zoom", "Fit the picture into the canvas"),
        ("pan", "Turn pan mode on or off"),
        ("dark mode", "Switch between dark and light theme"),
        ("tutorial", "Start the introduction in four steps"),
        ("ssim", "Show panel: Error"),
        ("help", "Open and search the manual"),
        ("import", "Open a model"),
    ] {
        let found = first(&session, typed);
        assert!(found.starts_with(title), "{typed}: {found}");
    }
    // Every synonym finds its entry first, or another entry with the same synonym.
    for entry in all(&session) {
        for word in &entry.synonyms {
            let found = first(&session, word);
            let owners = all(&session).into_iter().filter(|other| other.synonyms.contains(word));
            assert!(owners.into_iter().any(|owner| owner.title == found), "{word}: {found}");
        }
    }
}

#[test]
fn a_list_may_empty_while_its_scroll_bar_is_pressed() {
    let source = SceneSource::named("triangle".into());
    let scene = source.load().unwrap().scene;
    let home = scene.home;
    // The scroll bar is at the right edge of the palette.
    for x in [940.0, 944.0, 947.0, 949.0, 951.0] {
        let session = Session::new(Arc::new(scene.clone()), source.clone(), Recipe::default(), home);
        let mut app = Workbench::new(session, Worker::inline());
        let mut headless = Headless::new(Vec2::new(1280.0, 800.0), 1.0, Theme::Dark);
        let mut pass = |events: Vec<Event>, app: &mut Workbench| {
            headless.pass(events, |ui| app.show(ui));
        };
        app.queue(vec![Command::Dialog(DialogCommand::Palette)]);
        for _ in 0..3 {
            pass(Vec::new(), &mut app);
        }
        let pos = Pos2::new(x, 155.0);
        pass(vec![Event::PointerMoved(pos)], &mut app);
        let press =
            Event::PointerButton { pos, button: PointerButton::Primary, pressed: true, modifiers: Modifiers::NONE };
        pass(vec![Event::Text("#".into()), press], &mut app);
        pass(Vec::new(), &mut app);
    }
}
