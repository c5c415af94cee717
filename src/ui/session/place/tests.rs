use std::sync::Arc;

use super::*;
use crate::chain::Recipe;
use crate::inspect::Intermediate;
use crate::inspect::display::Display;
use crate::ui::session::WindowState;
use crate::ui::session::command::Command;
use crate::ui::session::file_command::FileCommand;

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
    (session.pick, session.features.scrub.triangle_limit) = (Some((10, 20)), Some(5));
    session.features.range.show_by("range=0.25..0.5,map=magma,reversed".parse().unwrap(), session.shown);
    session.features.overlays.layers = ["facing=0.3", "wireframe"].map(|text| text.parse().unwrap()).to_vec();
}

#[test]
fn a_bookmark_restores_an_intermediate_value_with_its_colours_and_overlays() {
    let mut session = session("triangle");
    wander(&mut session);
    session.shown = Shown::Intermediate(Intermediate::Cosine);
    session.features.range.show_by("range=most,map=diverging".parse().unwrap(), session.shown);
    let there = session.place();
    let look = session.request().look;
    session.apply(Command::Place(PlaceChange::Bookmark));
    session.apply(Command::Show(Shown::Buffer(Buffer::Color)));
    session.features.range.show_by(Display::default(), Shown::Intermediate(Intermediate::Cosine));
    session.features.overlays.layers.clear();
    assert_eq!(session.apply(Command::Place(PlaceChange::Jump(0))), None);
    assert_eq!(session.place(), there);
    assert_eq!((session.shown, session.request().look), (Shown::Intermediate(Intermediate::Cosine), look));
    // A bookmark survives a round trip through the preferences. A file from an earlier version, in which the three
    // fields below are missing, is accepted.
    let kept = serde_json::to_value(session.preferences(&WindowState::default())).unwrap();
    let again: crate::ui::session::Preferences = serde_json::from_value(kept.clone()).unwrap();
    assert_eq!(again.bookmarks[0].place, there);
    let mut old = kept;
    let place = old.pointer_mut("/bookmarks/0/place").unwrap().as_object_mut().unwrap();
    for key in ["number", "display", "overlays"] {
        assert!(place.remove(key).is_some(), "{key}");
    }
    let old: crate::ui::session::Preferences = serde_json::from_value(old).unwrap();
    assert_eq!((old.bookmarks[0].place.number, &old.bookmarks[0].place.overlays), (None, &Vec::new()));
}

#[test]
fn going_back_restores_what_was_shown_but_not_colours_and_overlays() {
    let mut session = session("triangle");
    session.features.canvas.size_px = (64, 48);
    session.view = Some(crate::ui::engine::Engine::default().answer(session.request()));
    session.note_visit(0.0);
    session.shown = Shown::Intermediate(Intermediate::Cosine);
    session.note_visit(10.0);
    session.features.overlays.layers = vec!["facing".parse().unwrap()];
    session.features.range.show_by("map=grey".parse().unwrap(), session.shown);
    session.note_visit(20.0);
    session.apply(Command::Place(PlaceChange::Back));
    assert_eq!(session.shown, Shown::Buffer(Buffer::Color), "changes of colours and overlays are not visits");
    assert_eq!(session.features.overlays.layers.len(), 1);
    session.apply(Command::Place(PlaceChange::Forward));
    assert_eq!(session.place().display, "map=grey".parse().unwrap());
}

#[test]
fn a_bookmark_restores_the_whole_place() {
    let mut session = session("triangle");
    wander(&mut session);
    let (there, request) = (session.place(), session.request());
    session.apply(Command::Place(PlaceChange::Bookmark));
    session.apply(Command::ResetRecipe);
    session.apply(Command::ResetCamera);
    session.apply(Command::MirrorZ);
    session.apply(Command::Pick(None));
    assert_ne!(session.place(), there);
    assert_eq!(session.apply(Command::Place(PlaceChange::Jump(0))), None);
    assert_eq!(session.place(), there);
    assert_eq!((session.request().recipe, session.request().camera), (request.recipe, request.camera));
}

#[test]
fn a_bookmark_of_another_scene_opens_it_first() {
    let mut session = session("triangle");
    wander(&mut session);
    let there = session.place();
    session.apply(Command::Place(PlaceChange::Bookmark));
    let chess = SceneSource::named("cubes".into());
    session.show_scene(chess.load().unwrap().scene, chess);
    let open = session.apply(Command::Place(PlaceChange::Jump(0)));
    assert_eq!(open, Some(WindowTask::File(FileCommand::OpenBuiltin("triangle".to_owned()))));
    let triangle = SceneSource::named("triangle".into());
    session.show_scene(triangle.load().unwrap().scene, triangle);
    assert_eq!(session.place(), there);
    assert!(!session.can_undo(), "undo must not restore the view of another scene");
}

#[test]
fn bookmarks_persist_and_can_be_renamed_and_deleted() {
    let mut session = session("triangle");
    wander(&mut session);
    for change in [
        PlaceChange::Bookmark,
        PlaceChange::Bookmark,
        PlaceChange::Rename(1, "second".to_owned()),
        PlaceChange::Remove(0),
    ] {
        session.apply(Command::Place(change));
    }
    let kept = session.preferences(&WindowState::default());
    let text = serde_json::to_string(&kept).unwrap();
    let again: crate::ui::session::Preferences = serde_json::from_str(&text).unwrap();
    assert_eq!(again.bookmarks, session.features.places.bookmarks);
    assert_eq!(again.bookmarks.iter().map(|b| b.name.as_str()).collect::<Vec<_>>(), ["second"]);
    session.apply(Command::Place(PlaceChange::Remove(7)));
    assert_eq!(session.features.places.bookmarks.len(), 1, "there is no eighth bookmark");
}

#[test]
fn an_invalid_place_is_reported_and_not_opened() {
    let mut session = session("triangle");
    let mut place = session.place();
    place.camera.near = -1.0;
    let before = session.place();
    session.apply(Command::Place(PlaceChange::Go(Box::new(place))));
    assert_eq!(session.place(), before);
    assert!(session.features.messages.error.as_ref().is_some_and(|error| error.contains("near")));
}
