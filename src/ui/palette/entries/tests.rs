use std::sync::Arc;

use super::*;
use crate::scene::TriangleId;
use crate::ui::session::PictureSize;

fn run(command: Command) -> Action {
    Action::Run(Box::new(command))
}

fn session() -> Session {
    let source = SceneSource::named("triangle".into());
    let scene = source.load().unwrap().scene;
    let home = scene.home;
    Session::new(Arc::new(scene), source, Recipe::default(), home)
}

#[test]
fn everything_with_a_name_has_an_entry() {
    let entries = all(&session());
    let offers = |kind: EntryKind, name: &str| entries.iter().any(|e| e.kind == kind && e.title.contains(name));
    for binding in BINDINGS {
        let elsewhere = ["Choose an upscaler", "Go to a bookmark", "Find anything"];
        assert!(
            offers(EntryKind::Command, binding.description) || elsewhere.contains(&binding.description),
            "{}",
            binding.description
        );
    }
    for scene in builtin::ALL {
        assert!(offers(EntryKind::Scene, scene.title));
    }
    assert!(Buffer::ALL.iter().all(|buffer| offers(EntryKind::Buffer, buffer.name())));
    assert!(Overlay::ALL.iter().all(|overlay| offers(EntryKind::Buffer, overlay.name())));
    assert!(Stage::ALL.iter().all(|stage| offers(EntryKind::Stage, stage.name())));
    assert!(upscale::all().iter().all(|upscaler| offers(EntryKind::Upscaler, upscaler.name())));
    assert!(Panel::ALL.iter().all(|panel| offers(EntryKind::Panel, panel.name())));
    assert!(SettingKey::ALL.iter().all(|key| offers(EntryKind::Setting, &format!("{} = ", key.id()))));
}

#[test]
fn setting_entries_set_their_value_and_mark_the_current_one() {
    let session = session();
    let entries = all(&session);
    let find = |title: &str| entries.iter().find(|entry| entry.title == title).unwrap();
    let mut wanted = session.state.recipe;
    wanted.set("fill_rule=inclusive").unwrap();
    assert_eq!(find("fill_rule = inclusive").action, run(Command::SetRecipe(wanted)));
    assert!(find("fill_rule = top-left").is_current && !find("fill_rule = inclusive").is_current);
    for key in SettingKey::ALL {
        let of_key = entries.iter().filter(|entry| entry.title.starts_with(&format!("{} = ", key.id())));
        let holding = of_key.filter(|entry| entry.is_current || matches!(entry.action, Action::Type(_)));
        assert_eq!(holding.count(), 1, "{key:?} has exactly one value");
    }
}

#[test]
fn entries_of_settings_select_the_stage_with_their_switch() {
    let session = session();
    let entries = all(&session);
    let owner = |start: &str| entries.iter().find(|entry| entry.title.starts_with(start)).unwrap().owner;
    assert_eq!(owner("fill_rule = inclusive"), Some(Stage::Rasterize));
    assert_eq!(owner("light.ambient = …"), Some(Stage::Shade));
    assert_eq!(owner("Choose upscaler: "), Some(Stage::Upscale));
    assert_eq!(owner("Show panel: "), None);
    assert_eq!(assignment(&session, "fill-rule=inclusive").unwrap().owner, Some(Stage::Rasterize));
}

#[test]
fn a_number_is_typed_as_key_and_value() {
    let session = session();
    let typed = assignment(&session, "light.ambient=0.5").unwrap();
    let Action::Run(command) = typed.action else { panic!("it is a command") };
    let Command::SetRecipe(recipe) = *command else { panic!("it sets the recipe") };
    assert_eq!(recipe.pipeline.light.ambient, 0.5);
    assert_eq!(assignment(&session, "light.ambient=7"), None);
    assert_eq!(assignment(&session, "light"), None);
}

#[test]
fn typed_pixels_triangles_and_vertices_are_destinations() {
    let mut session = session();
    session.state.size = PictureSize::Fixed(320, 200);
    let go = |typed: &str| destination(&session, typed).map(|entry| entry.action);
    assert_eq!(go("12,34"), Some(run(Command::Pick(Some((12, 34))))));
    for (typed, wanted) in [("tri 0", SearchTarget::Triangle(TriangleId(0))), ("v 2", SearchTarget::Vertex(0, 2))] {
        assert_eq!(go(typed), Some(run(Command::Place(place::PlaceChange::Find(wanted)))), "{typed}");
    }
    assert_eq!(go("320,0"), None);
    assert_eq!(go(&session.scene.instances[0].name.clone()), None);
}

#[test]
fn synonyms_are_lower_case_and_not_repeated() {
    for entry in all(&session()) {
        for (index, word) in entry.synonyms.iter().enumerate() {
            assert_eq!(*word, word.to_lowercase(), "{}", entry.title);
            assert!(!entry.synonyms[..index].contains(word), "{}: {word}", entry.title);
        }
    }
}

#[test]
fn entries_show_their_keys() {
    let entries = all(&session());
    let undo = entries.iter().find(|entry| entry.action == run(Command::Undo)).unwrap();
    assert_eq!(undo.key, "Ctrl + Z");
    let second = entries.iter().find(|entry| entry.action == run(Command::ChooseUpscaler(1))).unwrap();
    assert_eq!(second.key, "2");
}
