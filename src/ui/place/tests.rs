use std::sync::Arc;

use super::*;
use crate::chain::Recipe;

fn session(scene: &str) -> Session {
    let source = SceneSource::named(scene.into());
    let scene = source.load().unwrap().scene;
    let home = scene.home;
    Session::new(Arc::new(scene), source, Recipe::default(), home)
}

fn wander(session: &mut Session) {
    session.state.camera.orbit(0.3, 0.1);
    session.state.recipe.set("culling=none").unwrap();
    session.state.size = PictureSize::Fixed(320, 200);
    session.shown = Shown::Buffer(Buffer::Depth);
    (session.pick, session.triangle_limit) = (Some((10, 20)), Some(5));
}

#[test]
fn a_bookmark_leads_back_to_everything_that_was_there() {
    let mut session = session("triangle");
    wander(&mut session);
    let (there, request) = (session.place(), session.request());
    session.apply(Command::Place(Change::Bookmark));
    session.apply(Command::ResetRecipe);
    session.apply(Command::ResetCamera);
    session.apply(Command::MirrorZ);
    session.apply(Command::Pick(None));
    assert_ne!(session.place(), there);
    assert_eq!(session.apply(Command::Place(Change::Jump(0))), None);
    assert_eq!(session.place(), there);
    assert_eq!((session.request().recipe, session.request().camera), (request.recipe, request.camera));
}

#[test]
fn a_bookmark_of_another_scene_opens_it_first() {
    let mut session = session("triangle");
    wander(&mut session);
    let there = session.place();
    session.apply(Command::Place(Change::Bookmark));
    let chess = SceneSource::named("cubes".into());
    session.show_scene(chess.load().unwrap().scene, chess);
    let open = session.apply(Command::Place(Change::Jump(0)));
    assert_eq!(open, Some(Command::OpenBuiltin("triangle".to_owned())));
    let triangle = SceneSource::named("triangle".into());
    session.show_scene(triangle.load().unwrap().scene, triangle);
    assert_eq!(session.place(), there);
    assert!(!session.can_undo(), "undo does not lead into another scene's view");
}

#[test]
fn bookmarks_are_kept_between_runs_renamed_and_forgotten() {
    let mut session = session("triangle");
    wander(&mut session);
    for change in [Change::Bookmark, Change::Bookmark, Change::Rename(1, "second".to_owned()), Change::Remove(0)] {
        session.apply(Command::Place(change));
    }
    let kept = session.preferences(false, 1.0);
    let text = serde_json::to_string(&kept).unwrap();
    let again: crate::ui::session::Preferences = serde_json::from_str(&text).unwrap();
    assert_eq!(again.bookmarks, session.places.bookmarks);
    assert_eq!(again.bookmarks.iter().map(|b| b.name.as_str()).collect::<Vec<_>>(), ["second"]);
    session.apply(Command::Place(Change::Remove(7)));
    assert_eq!(session.places.bookmarks.len(), 1, "there is no eighth");
}

#[test]
fn what_is_damaged_is_told_and_not_gone_to() {
    let mut session = session("triangle");
    let mut place = session.place();
    place.camera.near = -1.0;
    let before = session.place();
    session.apply(Command::Place(Change::Go(Box::new(place))));
    assert_eq!(session.place(), before);
    assert!(session.error.as_ref().is_some_and(|error| error.contains("near")));
}
