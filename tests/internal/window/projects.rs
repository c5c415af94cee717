//! Tests of project files: saving the state of a window and restoring it in another one.

use std::path::Path;

use eframe::egui::Key;
use rasterscope::chain::Recipe;
use rasterscope::image::Image;
use rasterscope::image::pfm::{Floats, write_pfm};
use rasterscope::inspect::project::EXTENSION;
use rasterscope::inspect::view::Range;
use rasterscope::ui::session::camera_path::CameraPathChange;
use rasterscope::ui::session::command::Command;
use rasterscope::ui::session::save_item::SaveItem;
use rasterscope::ui::session::workspace::Workspace;

use super::bench::Bench;
use crate::ui::session::Severity;
use crate::ui::session::compare::files::PictureLook;
use crate::ui::session::compare::{CompareChange, Mode};
use crate::ui::session::file_command::FileCommand;
use crate::ui::session::picture_role::PictureRole;
use crate::ui::session::scene_time::SceneTimeChange;
use crate::ui::session::sequences::SequenceChange;

/// Saves the project of a window.
fn save(bench: &mut Bench, path: &Path) {
    bench.window.state_mut().queue(vec![Command::File(FileCommand::SaveTo(SaveItem::Project, path.to_owned()))]);
    bench.rest();
    assert_eq!(bench.session().features.messages.error, None);
}

/// Creates a window with a changed view of a model in `folder`.
fn changed(folder: &Path) -> Bench {
    let model = folder.join("model.obj");
    std::fs::write(&model, "v -1 -1 0\nv 1 -1 0.3\nv 0 1 0\nv 2 1 1\nf 1 2 3\nf 2 4 3\n").unwrap();
    let mut bench = Bench::small("triangle");
    bench.drop_file(&model);
    bench.rest();
    let session = bench.session_mut();
    session.state.camera.orbit(0.3, 0.2);
    let mut recipe: Recipe = session.state.recipe;
    recipe.set_all(&["shading=normals".to_owned(), "upscaler.method=bicubic".to_owned()]).unwrap();
    session.state.recipe = recipe;
    session.pick = Some((11, 17));
    session.features.probing.probe.runs = 5;
    bench.rest();
    bench
}

/// Returns a window with a scene, on which a project file was dropped.
fn reopened(scene: &str, project: &Path) -> Bench {
    let mut bench = Bench::small(scene);
    bench.drop_file(project);
    bench.rest();
    bench
}

#[test]
fn the_time_of_the_scene_comes_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("time.rasterscope");
    let mut first = Bench::small("chess-motion");
    first.session_mut().apply(Command::SceneTime(SceneTimeChange::Go(17)));
    first.rest();
    save(&mut first, &path);
    let second = reopened("triangle", &path);
    assert_eq!(second.session().scene_frame(), 17);
    assert_eq!(second.image(), first.image());
}

#[test]
fn a_recorded_camera_path_comes_back_with_its_time() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("path.rasterscope");
    let mut first = Bench::small("triangle");
    for _ in 0..2 {
        first.session_mut().apply(Command::CameraPath(CameraPathChange::Add));
        first.session_mut().state.camera.orbit(0.3, 0.1);
    }
    first.session_mut().apply(Command::SceneTime(SceneTimeChange::Go(20)));
    first.rest();
    save(&mut first, &path);
    let second = reopened("cubes", &path);
    let (a, b) = (first.session(), second.session());
    assert_eq!(b.features.camera_path.keys, a.features.camera_path.keys);
    assert_eq!((b.scene_frame(), b.scene_frame_count()), (20, Some(61)));
    assert_eq!((b.project(), second.image()), (a.project(), first.image()));
}

#[test]
fn another_window_shows_the_same_picture_and_pixel_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a view.rasterscope");
    let mut first = changed(folder.path());
    first.session_mut().features.overlays.layers = vec!["facing=0.5".parse().unwrap()];
    first.rest();
    save(&mut first, &path);
    let second = reopened("cubes", &path);
    assert_eq!(second.session().features.messages.error, None);
    assert_eq!(second.image(), first.image());
    assert_eq!(second.view().report, first.view().report);
    let (a, b) = (first.session(), second.session());
    assert_eq!((b.pick, b.state.camera, b.state.recipe), (a.pick, a.state.camera, a.state.recipe));
    assert_eq!(b.features.overlays.layers, a.features.overlays.layers);
    assert_eq!(b.features.probing.probe, a.features.probing.probe);
    assert_eq!(b.project(), a.project());
    assert_eq!(b.features.files.recent.first(), Some(&path));
}

#[test]
fn a_comparison_with_a_picture_file_and_a_workspace_are_restored() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("c.rasterscope");
    let picture = folder.path().join("theirs.png");
    let mut first = Bench::small("cubes");
    rasterscope::image::file::write_png(&picture, &first.image()).unwrap();
    first.press(Key::W);
    first.session_mut().features.comparison.wipe = 0.25;
    let open = FileCommand::OpenPicture(PictureRole::Tile(1), picture);
    first.window.state_mut().queue(vec![Command::File(open)]);
    first.rest();
    save(&mut first, &path);
    let mut second = reopened("triangle", &path);
    assert_eq!(second.session().features.messages.error, None);
    assert_eq!(second.session().features.comparison.mode, Mode::Wipe);
    assert_eq!(second.session().project(), first.session().project());
    let shown = |bench: &Bench| {
        let tiles = &bench.session().features.comparison.compared.as_ref().unwrap().tiles;
        tiles.iter().map(|tile| (*tile.picture).clone()).collect::<Vec<_>>()
    };
    assert_eq!(shown(&second), shown(&first));
    second.session_mut().show_workspace(Workspace::Robustness);
    save(&mut second, &path);
    let third = reopened("triangle", &path);
    assert_eq!(third.session().workspace(), Workspace::Robustness);
    assert_eq!(third.session().features.comparison.mode, Mode::Off);
}

#[test]
fn sequences_and_the_look_of_picture_files_are_restored() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("s.rasterscope");
    for (name, blue) in [("f.0003.png", 3), ("f.0004.png", 4), ("f.0009.png", 9)] {
        let picture = Image::from_fn(48, 30, |x, _| [x as u8, 0, blue, 255]);
        rasterscope::image::file::write_png(&folder.path().join(name), &picture).unwrap();
    }
    let values = Image::from_fn(48, 30, |x, y| (y * 48 + x) as f32 / 1440.0);
    let depth = folder.path().join("depth.pfm");
    write_pfm(&depth, &Floats::One(values)).unwrap();
    let pattern = folder.path().join("f.####.png");
    let mut first = Bench::small("triangle");
    for (role, file) in [
        (PictureRole::Tile(0), &pattern),
        (PictureRole::Tile(1), &depth),
        (PictureRole::Reference, &folder.path().to_owned()),
    ] {
        first.window.state_mut().queue(vec![Command::File(FileCommand::OpenPicture(role, file.clone()))]);
        first.rest();
    }
    let look = PictureLook { layer: None, range: Some(Range { low: 0.25, high: 0.75 }) };
    first.window.state_mut().queue(vec![
        Command::Sequence(SequenceChange::Go(4)),
        Command::Sequence(SequenceChange::Speed(12.0)),
        Command::Sequence(SequenceChange::Shift(folder.path().to_owned(), 5)),
        Command::Compare(CompareChange::Look(depth.clone(), look.clone())),
    ]);
    first.rest();
    save(&mut first, &path);
    let mut second = reopened("cubes", &path);
    assert_eq!(second.session().features.messages.error, None);
    let session = second.session();
    let shown = |path: &Path| session.features.comparison.pictures.get(path).expect("it is opened");
    assert_eq!(shown(&pattern).file, folder.path().join("f.0004.png"));
    assert_eq!(shown(folder.path()).file, folder.path().join("f.0009.png"), "frame 4, ahead by 5");
    assert_eq!(shown(&depth).look(), &look);
    assert_eq!(shown(&depth).shown.at(0, 0), [0, 0, 0, 255]);
    assert_eq!(shown(&depth).shown, first.session().features.comparison.pictures.get(&depth).unwrap().shown);
    assert_eq!((session.features.sequences.frame, session.features.sequences.speed), (4, 12.0));
    assert_eq!(session.project(), first.session().project());
    second.press(Key::Period);
    assert_eq!(second.session().features.sequences.frame, 5, "the sequences are stepped on");
}

#[test]
fn a_damaged_project_is_reported_and_the_scene_stays() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(format!("d.{EXTENSION}"));
    let mut first = changed(folder.path());
    save(&mut first, &path);
    let text = std::fs::read_to_string(&path).unwrap();
    let missing = text.replace("./model.obj", "./missing.obj");
    assert_ne!(missing, text);
    for (damaged, words) in [
        (text[..text.len() / 3].to_owned(), "d.rasterscope:"),
        (text.replace("\"size\": [", "\"size\": [-"), "d.rasterscope:"),
        (missing, "missing.obj"),
    ] {
        std::fs::write(&path, damaged).unwrap();
        let mut bench = Bench::small("cubes");
        let (before, scene) = (bench.image(), bench.session().place().scene);
        bench.drop_file(&path);
        bench.rest();
        let error = bench.session().features.messages.error.clone().expect("an error");
        assert!(error.contains(words) && !error.contains('\n'), "{error}");
        assert_eq!((bench.session().place().scene, bench.image()), (scene, before));
    }
}

#[test]
fn a_changed_model_gives_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("w.rasterscope");
    save(&mut changed(folder.path()), &path);
    std::fs::write(folder.path().join("model.obj"), "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let bench = reopened("cubes", &path);
    assert!(bench.session().place().scene.ends_with("model.obj"), "the model is shown nevertheless");
    let log = &bench.session().features.messages.log;
    assert!(log.iter().any(|entry| entry.level == Severity::Warning && entry.text.contains("has changed")));
}
