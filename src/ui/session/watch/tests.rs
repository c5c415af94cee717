use std::sync::Arc;

use super::watcher::PixelWatcher;
use super::*;
use crate::chain::Recipe;
use crate::scene::SceneSource;
use crate::ui::engine::Engine;
use crate::ui::session::PictureSize;
use crate::ui::session::command::Command;

fn session() -> Session {
    let source = SceneSource::named("interpenetrating".into());
    let scene = source.load().unwrap().scene;
    let home = scene.home;
    let mut session = Session::new(Arc::new(scene), source, Recipe::default(), home);
    session.state.size = PictureSize::Fixed(64, 48);
    session
}

#[test]
fn a_pixel_is_watched_once_and_the_list_is_limited() {
    let mut session = session();
    session.apply(Command::Watch(WatchChange::AddPick));
    assert!(session.features.watch.pixels.is_empty(), "no pixel is picked");
    session.pick = Some((3, 4));
    session.apply(Command::Watch(WatchChange::AddPick));
    session.apply(Command::Watch(WatchChange::Add(3, 4)));
    assert_eq!(session.features.watch.pixels, [(3, 4)]);
    for x in 0..100 {
        session.apply(Command::Watch(WatchChange::Add(x, 0)));
    }
    assert_eq!(session.features.watch.pixels.len(), MAX_WATCHED);
    assert!(session.features.messages.error.is_some());
    session.apply(Command::Watch(WatchChange::Remove(3, 4)));
    assert_eq!(session.features.watch.pixels[0], (0, 0));
    session.apply(Command::Watch(WatchChange::Clear));
    assert!(session.features.watch.pixels.is_empty());
}

#[test]
fn rows_follow_the_frames_and_old_values_stay_until_the_next_change() {
    let mut session = session();
    let (mut engine, mut watcher) = (Engine::default(), PixelWatcher::default());
    watcher.set(vec![(32, 24), (0, 0)]);
    assert!(!watcher.has_work(), "there is no frame yet");
    let mut follow = |session: &mut Session| {
        watcher.set_view(&engine.answer(session.request()));
        let due = watcher.has_work();
        if due {
            session.features.watch.store_values(watcher.step().unwrap());
        }
        due
    };
    assert!(follow(&mut session));
    let first = session.features.watch.rows.clone();
    assert!(first[0].values.as_ref().unwrap().triangle.is_some());
    session.pick = Some((1, 1));
    assert!(!follow(&mut session), "a pick does not draw a new frame");
    session.state.recipe.set("shading=normals").unwrap();
    assert!(follow(&mut session));
    assert_ne!(session.features.watch.rows, first);
    assert_eq!(session.features.watch.before(&session.features.watch.rows[0]), Some(&first[0]));
    session.state.recipe.set("execution=classic").unwrap();
    follow(&mut session);
    assert_eq!(
        session.features.watch.before(&session.features.watch.rows[0]),
        Some(&first[0]),
        "equal values are not a change"
    );
    watcher.set(vec![(32, 24), (0, 0), (5, 5)]);
    session.features.watch.store_values(watcher.step().unwrap());
    assert_eq!(session.features.watch.rows.len(), 3);
    assert_eq!(
        session.features.watch.before(&session.features.watch.rows[0]),
        Some(&first[0]),
        "another watched pixel is not a change"
    );
}
