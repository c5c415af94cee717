//! Tests of opening built-in, dropped, typed and recent scenes, and of the handling of bad files.

use std::sync::Arc;

use eframe::egui::{Event, Key, Modifiers};
use rasterscope::inspect::Stage;
use rasterscope::scene::builtin;
use rasterscope::ui::session::Severity;

use super::bench::Bench;
use crate::internal::samples;

const QUAD: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";

#[test]
fn the_scene_menu_opens_every_built_in_scene() {
    let mut bench = Bench::small("chess");
    for scene in builtin::ALL.iter().rev() {
        bench.click("Scene");
        bench.click(scene.title);
        assert_eq!(bench.session().source.name().to_str(), Some(scene.id));
        assert!(bench.session().features.messages.error.is_none());
        assert_eq!(bench.session().state.camera, bench.session().scene.home);
        assert!(Arc::ptr_eq(&bench.view().request.scene, &bench.session().scene), "the new scene is drawn");
        assert_eq!(bench.image(), *bench.expected().image());
    }
}

#[test]
fn a_dropped_model_replaces_the_scene_and_is_listed_as_recent() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("quad.obj");
    std::fs::write(&path, QUAD).unwrap();
    let mut bench = Bench::small("chess");
    bench.drop_file(&path);
    assert_eq!(bench.session().features.messages.error, None);
    assert_eq!(bench.session().scene.triangle_count(), 2);
    assert_eq!(bench.session().features.files.recent, std::slice::from_ref(&path));
    assert!(bench.image().pixels().iter().any(|p| *p != bench.image().at(0, 0)), "the model is visible");

    bench.click("Scene");
    bench.click(builtin::ALL[0].title);
    bench.click("File");
    bench.click("Recent files");
    bench.click("quad.obj");
    assert_eq!(bench.session().source.name(), path);
}

#[test]
fn a_dropped_gltf_file_brings_its_cameras_and_its_light() {
    let path = samples::own().join("gltf/features.glb");
    let mut bench = Bench::small("chess");
    let light = bench.session().state.recipe.pipeline.light;
    bench.drop_file(&path);
    assert_eq!(bench.session().features.messages.error, None);
    assert_eq!(bench.session().features.files.recent, std::slice::from_ref(&path));
    assert_eq!(Some(bench.session().state.recipe.pipeline.light.direction), bench.session().scene.light);
    let front = bench.session().scene.views[0].clone();
    assert_ne!(bench.session().state.camera, front.camera);
    bench.click("View");
    bench.click("Cameras of the file");
    bench.click(&front.name);
    assert_eq!(bench.session().state.camera, front.camera);

    bench.click("Scene");
    bench.click(builtin::ALL[0].title);
    assert_eq!(bench.session().state.recipe.pipeline.light, light);
}

#[test]
fn a_dropped_picture_is_offered_to_the_lab_and_the_scene_stays() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("picture.png");
    let picture = rasterscope::image::Image::from_pixels(3, 2, vec![[9, 8, 7, 255]; 6]);
    rasterscope::image::file::write_png(&path, &picture).unwrap();
    let mut bench = Bench::small("triangle");
    let scene = bench.session().scene.clone();
    bench.drop_file(&path);
    assert!(bench.says("picture.png is a picture, not a scene") && !bench.session().features.lab.open);
    bench.click("Close this message");
    assert_eq!(bench.session().features.messages.offered_picture, None);
    bench.drop_file(&path);
    bench.click("Open in the 2D lab");
    assert_eq!(
        (&bench.session().features.messages.error, &bench.session().features.messages.offered_picture),
        (&None, &None)
    );
    assert!(bench.session().features.lab.open && Arc::ptr_eq(&bench.session().scene, &scene));
}

#[test]
fn a_bad_file_is_named_and_the_scene_stays() {
    let folder = tempfile::tempdir().unwrap();
    let bad = folder.path().join("broken.obj");
    std::fs::write(&bad, "v 0 0 0\nf 1 2 99\n").unwrap();
    let missing = folder.path().join("missing.obj");
    for path in [bad, missing] {
        let mut bench = Bench::small("triangle");
        let (scene, picture) = (bench.session().scene.clone(), bench.image());
        bench.drop_file(&path);
        let name = path.file_name().unwrap().to_str().unwrap();
        let error = bench.session().features.messages.error.clone().expect("it is reported");
        assert!(error.contains(name), "{error}");
        assert!(bench.says(&error), "the bar shows it");
        assert!(Arc::ptr_eq(&bench.session().scene, &scene));
        assert_eq!(bench.image(), picture);
        assert!(bench.session().features.files.recent.is_empty());
        assert_eq!(bench.session().features.messages.log.back().map(|line| line.level), Some(Severity::Error));

        bench.click("Close this message");
        assert_eq!(bench.session().features.messages.error, None);
        assert!(!bench.says(&error));
    }
}

#[test]
fn a_model_is_opened_by_typing_its_path() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("typed.obj");
    std::fs::write(&path, QUAD).unwrap();
    let mut bench = Bench::small("triangle");
    bench.press_with(Modifiers::COMMAND, Key::O);
    assert!(bench.says("Open a model"));
    bench.window.event(Event::Text(path.to_str().unwrap().to_owned()));
    bench.press(Key::Enter);
    assert_eq!(bench.session().source.name(), path);
    assert!(!bench.says("Open a model"), "the dialog closes");
}

#[test]
fn warnings_of_a_model_are_in_the_log() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("warned.obj");
    std::fs::write(&path, format!("mtllib nowhere.mtl\n{QUAD}")).unwrap();
    let mut bench = Bench::small("triangle");
    bench.drop_file(&path);
    let warning = bench
        .session()
        .features
        .messages
        .log
        .iter()
        .find(|line| line.level == Severity::Warning)
        .expect("a warning")
        .clone();
    assert!(warning.text.contains("nowhere.mtl"), "{}", warning.text);
    assert!(bench.says("Opened with 1 warning"));
    bench.click("Show log");
    assert!(bench.says(&warning.text) && !bench.says("Opened with 1 warning"), "the log is shown");
}

#[test]
fn undo_does_not_lead_back_into_another_scene() {
    let mut bench = Bench::small("triangle");
    bench.select(Stage::Cull);
    bench.choose("Culling", "None");
    bench.click("Scene");
    bench.click(builtin::ALL[1].title);
    let state = bench.session().state.clone();
    bench.press_with(Modifiers::COMMAND, Key::Z);
    assert_eq!(bench.session().state, state);
}

#[test]
fn a_scene_is_saved_as_drawing_commands() {
    let folder = tempfile::tempdir().unwrap();
    let mut bench = Bench::small("triangle");
    bench.session_mut().features.files.folder = folder.path().to_owned();
    bench.click("File");
    bench.click("Save as drawing");
    bench.click("Wireframe, SVG");
    assert_eq!(bench.session().features.messages.error, None);
    let text = std::fs::read_to_string(folder.path().join("wireframe.svg")).unwrap();
    assert_eq!(text.matches("<line").count(), 3);
}
