//! Tests of “Save as…” and of the notice about a saved file.

use std::path::Path;
use std::sync::Arc;

use eframe::egui::{Event, Key, Modifiers};
use egui_kittest::kittest::Queryable as _;
use rasterscope::chain::Frame;
use rasterscope::image::file;
use rasterscope::image::picture::{Picture, Sample};
use rasterscope::inspect::view::{self, Value};
use rasterscope::inspect::{Buffer, capture};
use rasterscope::lab::{Lesson, Page};
use rasterscope::ui::session::command::Command;
use rasterscope::ui::session::save_item::SaveItem;

use super::bench::Bench;
use crate::ui::session::camera_path::CameraPathChange;
use crate::ui::session::file_command::FileCommand;
use crate::ui::session::lab::LabChange;

/// Opens the dialog for saving an item, and replaces the suggested path.
fn ask(bench: &mut Bench, item: SaveItem, path: &str) {
    bench.window.state_mut().queue(vec![Command::File(FileCommand::SaveAs(item))]);
    bench.rest();
    assert!(bench.says(&format!("Save {}", item.name())), "the dialog is open");
    bench.press_with(Modifiers::COMMAND, Key::A);
    bench.window.event(Event::Text(path.to_owned()));
    bench.rest();
}

#[test]
fn the_picture_is_saved_under_a_typed_path() {
    let folder = tempfile::tempdir().unwrap();
    let mut bench = Bench::small("triangle");
    bench.session_mut().features.files.folder = folder.path().to_owned();
    bench.press_with(Modifiers::COMMAND | Modifiers::SHIFT, Key::S);
    assert!(bench.says("Save picture"));
    bench.press_with(Modifiers::COMMAND, Key::A);
    let path = folder.path().join("chosen.png");
    bench.window.event(Event::Text(folder.path().join("chosen").to_str().unwrap().to_owned()));
    bench.press(Key::Enter);
    assert_eq!(bench.session().features.messages.error, None);
    assert_eq!(file::read(&path).unwrap(), bench.image());
    assert!(!bench.says("Save picture") && bench.says(&format!("Saved {}", path.display())));
    assert!(bench.window.query_by_label("Open folder").is_some());
}

#[test]
fn every_item_suggests_a_name_and_is_saved() {
    let folder = tempfile::tempdir().unwrap();
    let mut bench = Bench::small("triangle");
    bench.session_mut().features.files.folder = folder.path().to_owned();
    bench.session_mut().apply(Command::CameraPath(CameraPathChange::Add));
    bench.press(Key::T);
    for item in SaveItem::LISTED {
        bench.window.state_mut().queue(vec![Command::File(FileCommand::SaveAs(item))]);
        bench.rest();
        bench.click("Save");
        assert_eq!(bench.session().features.messages.error, None, "{item:?}");
        let name = format!("{}.{}", item.stem(bench.session()), item.extension());
        assert!(std::fs::metadata(folder.path().join(&name)).is_ok_and(|file| file.len() > 0), "{name}");
    }
}

#[test]
fn an_existing_file_is_replaced_only_after_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("taken.png");
    std::fs::write(&path, "old").unwrap();
    let mut bench = Bench::small("triangle");
    ask(&mut bench, SaveItem::Picture, path.to_str().unwrap());
    assert!(bench.says(&format!("{} exists and is replaced.", path.display())));
    bench.click("Cancel");
    assert_eq!(std::fs::read(&path).unwrap(), b"old");
    ask(&mut bench, SaveItem::Picture, path.to_str().unwrap());
    bench.click("Replace");
    assert_eq!(file::read(&path).unwrap(), bench.image());
}

#[test]
fn a_missing_folder_or_triangle_is_named() {
    let mut bench = Bench::small("triangle");
    ask(&mut bench, SaveItem::Picture, "/nowhere/a.png");
    assert!(bench.says("The folder /nowhere does not exist."));
    bench.press(Key::Enter);
    assert!(bench.says("Save picture"), "the dialog stays open");
    bench.press(Key::Escape);
    bench.session_mut().pick = None;
    bench.rest();
    bench.window.state_mut().queue(vec![Command::File(FileCommand::SaveAs(SaveItem::Case))]);
    bench.rest();
    assert!(bench.session().features.messages.error.as_ref().is_some_and(|error| error.contains("pick a pixel")));
}

/// Saves an item at a path, without the dialog.
fn save(bench: &mut Bench, item: SaveItem, path: &Path) {
    bench.window.state_mut().queue(vec![Command::File(FileCommand::SaveTo(item, path.to_owned()))]);
    bench.rest();
    assert_eq!(bench.session().features.messages.error, None, "{item:?}");
}

#[test]
fn saved_buffers_hold_the_values_of_the_frame() {
    let folder = tempfile::tempdir().unwrap();
    let mut bench = Bench::small("interpenetrating");
    let path = folder.path().join("all.exr");
    save(&mut bench, SaveItem::Buffers, &path);
    let picture = Picture::read(&path).unwrap();
    let (request, frame): (_, Arc<Frame>) = (&bench.view().request, bench.view().frame.clone());
    let buffers = capture(&request.scene, &request.recipe, &frame);
    let of = |name: &str| picture.channels().iter().find(|channel| channel.name == name).unwrap();
    let (width, height) = picture.size();
    assert_eq!((width, height), bench.image().size());
    let mut drawn = 0;
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let id = match view::value(Buffer::TriangleId, &frame, Some(&buffers), x, y) {
            Value::Triangle(id) => id.0,
            _ => u32::MAX,
        };
        assert_eq!(of("id.triangle").sample(x, y), Some(Sample::U32(id)), "{x},{y}");
        drawn += u32::from(id != u32::MAX);
    }
    assert!(drawn > 100, "{drawn}");
}

#[test]
fn the_saved_explanation_has_the_verdict_and_a_command() {
    let folder = tempfile::tempdir().unwrap();
    let mut bench = Bench::small("z-fighting");
    let path = folder.path().join("why.html");
    save(&mut bench, SaveItem::Pixel, &path);
    let page = std::fs::read_to_string(&path).unwrap();
    let report = bench.view().report.clone().expect("a pixel is picked");
    let escaped = report.verdict.replace('&', "&amp;").replace('"', "&quot;").replace('<', "&lt;");
    assert!(page.contains(&escaped), "{}", report.verdict);
    let command = format!("--at {},{} --html why.html</pre>", report.x, report.y);
    assert!(page.contains("<pre>rasterscope pixel z-fighting ") && page.contains(&command), "{command}");
    bench.session_mut().pick = None;
    bench.rest();
    bench.window.state_mut().queue(vec![Command::File(FileCommand::SaveAs(SaveItem::Pixel))]);
    bench.rest();
    assert!(bench.session().features.messages.error.as_ref().is_some_and(|error| error.contains("pick a pixel first")));
}

#[test]
fn a_saved_lab_run_has_all_steps_and_a_command_unless_it_was_edited() {
    let folder = tempfile::tempdir().unwrap();
    let mut bench = Bench::small("triangle");
    bench.session_mut().features.lab.page = Page::Lines;
    let path = folder.path().join("run.html");
    save(&mut bench, SaveItem::LabRun, &path);
    let page = std::fs::read_to_string(&path).unwrap();
    let steps = Lesson::new(Page::Lines).record().steps.len();
    assert_eq!(page.matches("data-row=").count(), steps);
    assert!(page.contains("<pre>rasterscope lab lines -o run.html</pre>"));
    let mut edited = Lesson::new(Page::Lines);
    edited.move_handle(0, glam::DVec2::new(9.5, 9.5));
    bench.session_mut().features.lab.apply(LabChange::Set(Box::new(edited)));
    save(&mut bench, SaveItem::LabRun, &path);
    assert!(!std::fs::read_to_string(&path).unwrap().contains("<h2>Command</h2>"), "no command restores the input");
}
