//! Tests of the palette with several input events in one pass.

use std::sync::Arc;

use eframe::egui::{Event, Modifiers, PointerButton, Pos2, Theme, Vec2};

use crate::chain::Recipe;
use crate::scene::SceneSource;
use crate::ui::app::Workbench;
use crate::ui::command::Command;
use crate::ui::headless::Headless;
use crate::ui::session::Session;
use crate::ui::worker::Worker;

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
        app.queue(vec![Command::OpenPalette]);
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
