//! Tests of camera paths recorded in the window.

use rasterscope::scene::CameraPath;
use rasterscope::ui::session::camera_path::CameraPathChange;
use rasterscope::ui::session::command::Command;
use rasterscope::ui::session::save_item::SaveItem;
use rasterscope::ui::session::scene_time::SceneTimeChange;

use super::bench::Bench;
use crate::ui::session::file_command::FileCommand;

fn change(bench: &mut Bench, change: CameraPathChange) {
    bench.session_mut().apply(Command::CameraPath(change));
    bench.rest();
}

fn go(bench: &mut Bench, frame: i64) {
    bench.session_mut().apply(Command::SceneTime(SceneTimeChange::Go(frame)));
    bench.rest();
}

#[test]
fn key_views_of_a_still_scene_are_played_and_saved() {
    let folder = tempfile::tempdir().unwrap();
    let mut bench = Bench::small("triangle");
    let first = bench.session().state.camera;
    change(&mut bench, CameraPathChange::Add);
    bench.session_mut().state.camera.orbit(0.4, 0.1);
    let second = bench.session().state.camera;
    bench.click("Add key view");
    assert_eq!(
        bench.session().features.camera_path.keys.iter().map(|key| key.camera).collect::<Vec<_>>(),
        [first, second]
    );
    assert_eq!((bench.session().scene_frame(), bench.session().scene_frame_count()), (60, Some(61)));
    go(&mut bench, 0);
    assert_eq!(bench.session().state.camera, first);
    go(&mut bench, 30);
    let between = bench.session().state.camera;
    assert!(between != first && between != second);
    assert!(bench.image() == *bench.expected().image());
    let file = folder.path().join("path.json");
    let save = Command::File(FileCommand::SaveTo(SaveItem::CameraPath, file.clone()));
    bench.window.state_mut().queue(vec![save]);
    bench.rest();
    let path = CameraPath::read(&file).unwrap();
    assert_eq!([0.0, 1.0, 2.0].map(|time_s| path.at(&first, time_s)), [first, between, second]);
    let mut other = Bench::small("triangle");
    other.drop_file(&file);
    assert_eq!(other.session().features.camera_path.keys, bench.session().features.camera_path.keys);
    assert!(other.session().state.camera == first && other.session().features.case.is_none());
    go(&mut other, 30);
    assert!(other.session().state.camera == between && other.image() == bench.image());
    std::fs::write(&file, r#"{"version": 1, "keys": []}"#).unwrap();
    other.drop_file(&file);
    assert!(
        other.session().features.messages.error.as_ref().is_some_and(|text| text.contains("at least one key view"))
    );
    go(&mut bench, 60);
    bench.click("Remove key view");
    assert_eq!(bench.session().features.camera_path.keys.len(), 1);
    change(&mut bench, CameraPathChange::Clear);
    assert!(bench.session().scene_frame_count().is_none() && !bench.mentions("Follow path"));
}

#[test]
fn the_camera_of_a_scene_in_motion_stays_unless_it_follows() {
    let mut bench = Bench::small("chess-motion");
    change(&mut bench, CameraPathChange::Add);
    go(&mut bench, 30);
    bench.session_mut().state.camera.orbit(0.5, 0.0);
    change(&mut bench, CameraPathChange::Add);
    assert_eq!(bench.session().features.camera_path.keys[1].time_s, 1.0, "at the time of the scene");
    let last = bench.session().state.camera;
    change(&mut bench, CameraPathChange::Follow(false));
    go(&mut bench, 0);
    assert_eq!(bench.session().state.camera, last);
    change(&mut bench, CameraPathChange::Follow(true));
    go(&mut bench, 1);
    assert_ne!(bench.session().state.camera, last);
}
