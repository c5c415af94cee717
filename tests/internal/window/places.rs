//! Tests of bookmarks, the navigation history, the palette, and copying the state as a command.

use eframe::egui::{Event, Key, Modifiers};
use egui_kittest::kittest::Queryable as _;
use rasterscope::inspect::{Buffer, Stage};
use rasterscope::pipeline::settings::{Choice as _, DepthFormat};
use rasterscope::ui::engine::Shown;
use rasterscope::ui::session::command::Command;
use rasterscope::ui::session::scene_time::SceneTimeChange;

use super::bench::Bench;

fn type_in(bench: &mut Bench, text: &str) {
    bench.window.event(Event::Text(text.to_owned()));
    bench.rest();
}

#[test]
fn a_bookmark_is_set_and_opened_by_keys() {
    let mut bench = Bench::small("triangle");
    let there = bench.place_of((40, 30));
    bench.click_at(there);
    bench.click_eye(Stage::Shade);
    let (pick, shown, image) = (bench.session().pick, bench.session().shown, bench.image());
    bench.press_with(Modifiers::COMMAND, Key::B);
    bench.press(Key::Escape);
    bench.press(Key::Escape);
    bench.select(Stage::Cull);
    bench.choose("Culling", "Front");
    assert_ne!(bench.image(), image);
    bench.press_with(Modifiers::ALT, Key::Num1);
    assert_eq!((bench.session().pick, bench.session().shown), (pick, shown));
    assert_eq!(bench.image(), image);
    assert_eq!(pick, Some((40, 30)));
}

#[test]
fn a_bookmark_has_the_time_of_the_scene() {
    let mut bench = Bench::small("chess-motion");
    let go = |bench: &mut Bench, frame| {
        bench.session_mut().apply(Command::SceneTime(SceneTimeChange::Go(frame)));
        bench.rest();
    };
    go(&mut bench, 12);
    let image = bench.image();
    bench.press_with(Modifiers::COMMAND, Key::B);
    go(&mut bench, 40);
    assert!(bench.image() != image);
    bench.press_with(Modifiers::ALT, Key::Num1);
    assert_eq!(bench.session().scene_frame(), 12);
    assert!(bench.image() == image);
}

#[test]
fn a_bookmark_opens_another_scene() {
    let mut bench = Bench::small("triangle");
    let image = bench.image();
    bench.press_with(Modifiers::COMMAND, Key::B);
    bench.click("Scene");
    bench.click("Shared edges");
    assert_ne!(bench.image(), image);
    bench.press_with(Modifiers::ALT, Key::Num1);
    assert_eq!(bench.image(), image);
}

#[test]
fn the_list_of_bookmarks_deletes_one() {
    let mut bench = Bench::small("triangle");
    for _ in 0..2 {
        bench.press_with(Modifiers::COMMAND, Key::B);
    }
    bench.click("Go");
    bench.click("Manage bookmarks…");
    bench.click("Delete bookmark 2");
    assert_eq!(bench.session().features.places.bookmarks.len(), 1);
    bench.click("Close");
    assert!(!bench.says("Bookmarks"));
}

#[test]
fn back_and_forward_go_through_picks_and_stages() {
    let mut bench = Bench::small("triangle");
    let first = bench.session().pick;
    let there = bench.place_of((40, 30));
    bench.click_at(there);
    bench.click_eye(Stage::Shade);
    assert!(matches!(bench.session().shown, Shown::Stage(_)));
    bench.press_with(Modifiers::ALT, Key::ArrowLeft);
    assert_eq!((bench.session().shown, bench.session().pick), (Shown::Buffer(Buffer::Color), Some((40, 30))));
    bench.press_with(Modifiers::ALT, Key::ArrowLeft);
    assert_eq!(bench.session().pick, first);
    for _ in 0..2 {
        bench.press_with(Modifiers::ALT, Key::ArrowRight);
    }
    assert!(matches!(bench.session().shown, Shown::Stage(Stage::Shade)));
}

#[test]
fn the_palette_finds_entries_by_letters_and_executes_them_on_enter() {
    let mut bench = Bench::small("z-fighting");
    bench.press_with(Modifiers::COMMAND | Modifiers::SHIFT, Key::P);
    type_in(&mut bench, "unorm16");
    bench.press(Key::Enter);
    assert_eq!(bench.session().state.recipe.pipeline.depth_format, DepthFormat::Unorm16);
    assert_eq!(bench.session().features.stages.selected, Stage::Depth);
    assert_eq!(bench.image(), *bench.expected().image());

    bench.press_with(Modifiers::COMMAND | Modifiers::SHIFT, Key::P);
    type_in(&mut bench, "buffer overdraw");
    bench.press(Key::Enter);
    assert_eq!(bench.session().shown, Shown::Buffer(Buffer::Overdraw));

    bench.press_with(Modifiers::COMMAND | Modifiers::SHIFT, Key::P);
    type_in(&mut bench, "light.ambient=0.75");
    bench.press(Key::Enter);
    assert_eq!(bench.session().state.recipe.pipeline.light.ambient, 0.75);
    assert!(bench.says("Ambient"), "the stage with the setting is selected");
}

#[test]
fn arrows_choose_in_the_palette_and_escape_closes_it() {
    let mut bench = Bench::small("triangle");
    bench.press_with(Modifiers::COMMAND | Modifiers::SHIFT, Key::P);
    type_in(&mut bench, "show stage:");
    let pick = bench.session().pick;
    bench.press(Key::ArrowDown);
    bench.press(Key::Enter);
    assert_eq!(bench.session().shown, Shown::Stage(Stage::ALL[1]));
    assert_eq!(bench.session().pick, pick, "arrows move in the list only");
    bench.press_with(Modifiers::COMMAND | Modifiers::SHIFT, Key::P);
    bench.press(Key::Escape);
    assert_eq!(bench.session().pick, pick);
    bench.press(Key::ArrowLeft);
    assert_ne!(bench.session().pick, pick, "keys reach the window again");
}

#[test]
fn the_copied_command_says_what_is_shown() {
    let mut bench = Bench::small("triangle");
    let there = bench.place_of((40, 30));
    bench.click_at(there);
    bench.select(Stage::Cull);
    bench.choose("Culling", "Front");
    let line = bench.session().command_line();
    bench.press_with(Modifiers::COMMAND | Modifiers::SHIFT, Key::C);
    assert_eq!(
        bench.session().features.messages.log.back().map(|line| line.text.clone()),
        Some(format!("Copied: {line}"))
    );
    for part in ["window triangle", "--set culling=front", "--picture 160x90", "--at 40,30"] {
        assert!(line.contains(part), "{part} in {line}");
    }
}

#[test]
fn the_key_sheet_is_filtered() {
    let mut bench = Bench::small("triangle");
    bench.press(Key::Questionmark);
    assert!(bench.says("Undo the last change") && bench.says("Bookmark the current view"));
    bench.window.get_by_label("Filter the keys").focus();
    bench.rest();
    type_in(&mut bench, "bookmark");
    assert!(!bench.says("Undo the last change") && bench.says("Bookmark the current view"));
}
