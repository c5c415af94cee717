//! Tests of camera paths.

use glam::Vec3;

use super::*;

fn home() -> Camera {
    Camera::look_at(Vec3::new(1.0, 2.0, 6.0), Vec3::new(0.0, 1.0, 0.0))
}

fn key(time_s: f64, eye: Vec3, fov_y: f32) -> KeyView {
    let projection = Projection::Perspective { fov_y };
    KeyView { time_s, camera: Camera { projection, ..Camera::look_at(eye, Vec3::new(0.1, 0.2, 0.3)) } }
}

fn read(text: &str) -> Result<CameraPath, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("path.json");
    std::fs::write(&path, text).unwrap();
    CameraPath::read(&path).map_err(|error| error.to_string().rsplit_once("path.json").unwrap().1.to_owned())
}

const VIEW: &str = r#"{"eye": [0, 0, 5], "target": [0, 0, 0], "fov_y_degrees": 45, "near": 0.1, "far": 100}"#;

#[test]
fn a_path_passes_through_its_key_views_exactly_and_stops_at_its_ends() {
    let keys = [
        key(0.5, Vec3::new(0.1, 1.0, 7.3), 0.7),
        key(1.0, Vec3::new(3.3, -1.0, 4.1), 0.9),
        key(4.0, Vec3::new(-2.7, 0.4, 5.9), 0.5),
    ];
    let path = CameraPath(Motion::Keys(keys.to_vec()));
    for key in keys {
        assert_eq!(path.at(&home(), key.time_s), key.camera);
    }
    assert_eq!(
        [-1.0, 0.0, 9.0].map(|time_s| path.at(&home(), time_s)),
        [keys[0], keys[0], keys[2]].map(|key| key.camera)
    );
    assert_eq!(path.duration_s(), 4.0);
}

#[test]
fn uniform_motion_stays_uniform_at_unequal_key_times() {
    let place = |time_s: f64| Vec3::new(2.0 * time_s as f32, 1.0 - time_s as f32, 5.0);
    let keys = [0.0, 1.0, 1.5, 4.0].map(|time_s| key(time_s, place(time_s), 0.5 + 0.1 * time_s as f32));
    let path = CameraPath(Motion::Keys(keys.to_vec()));
    for time_s in [0.3, 1.2, 2.0, 3.7] {
        let view = path.at(&home(), time_s);
        assert!(view.eye.distance(place(time_s)) < 1e-6, "{time_s}: {}", view.eye);
        let Projection::Perspective { fov_y } = view.projection else { panic!("{view:?}") };
        assert!((f64::from(fov_y) - 0.5 - 0.1 * time_s).abs() < 1e-6, "{time_s}: {fov_y}");
    }
}

#[test]
fn the_velocity_is_continuous_at_key_views() {
    let keys = [0.0, 1.0, 1.5, 4.0].map(|time_s| key(time_s, Vec3::new((time_s * 2.0).sin() as f32, 0.0, 5.0), 0.7));
    let path = CameraPath(Motion::Keys(keys.to_vec()));
    let x = |time_s: f64| f64::from(path.at(&home(), time_s).eye.x);
    for time_s in [1.0, 1.5] {
        const STEP_S: f64 = 1e-3;
        let (before, after) = ((x(time_s) - x(time_s - STEP_S)) / STEP_S, (x(time_s + STEP_S) - x(time_s)) / STEP_S);
        assert!((before - after).abs() < 0.02, "{time_s}: {before} {after}");
    }
}

#[test]
fn presets_begin_at_home_loop_seamlessly_and_move() {
    for name in CameraPath::presets() {
        let path = CameraPath::preset(name).unwrap();
        let (home, duration_s) = (home(), path.duration_s());
        for loops in [0.0, 1.0, 3.0, -2.0] {
            assert_eq!(path.at(&home, duration_s * loops), home, "{name}");
        }
        let seam = path.at(&home, duration_s - 1e-6);
        assert!(seam.eye.distance(home.eye) < 1e-4 && seam.target.distance(home.target) < 1e-4, "{name}: {seam:?}");
        assert!(path.at(&home, duration_s * 0.3) != home, "{name}");
        assert_eq!(path.at(&home, f64::NAN), home);
    }
    assert_eq!(CameraPath::preset("dance"), None);
}

#[test]
fn the_turntable_keeps_distance_and_height_and_turns_once() {
    let (home, path) = (home(), CameraPath::preset("turntable").unwrap());
    let half = path.at(&home, path.duration_s() / 2.0);
    assert!(half.eye.distance(Vec3::new(-1.0, 2.0, -6.0)) < 1e-5, "{}", half.eye);
    for share in [0.1, 0.4, 0.8] {
        let view = path.at(&home, path.duration_s() * share);
        assert!((view.distance() - home.distance()).abs() < 1e-5 && (view.eye.y - home.eye.y).abs() < 1e-5);
    }
}

#[test]
fn the_shake_moves_the_picture_by_a_few_pixels() {
    let (home, path) = (home(), CameraPath::preset("shake").unwrap());
    let clip_from_world = |view: &Camera| view.clip_from_world_f64(1.6, crate::scene::DepthMapping::STANDARD);
    let pixel = |view: &Camera| clip_from_world(view).project_point3(home.target.as_dvec3()).truncate() * 360.0;
    let steps = (0..100).map(|step| pixel(&path.at(&home, path.duration_s() * f64::from(step) / 100.0)).length());
    let largest = steps.fold(0.0, f64::max);
    assert!((2.0..8.0).contains(&largest), "{largest} px at a height of 720 px");
}

#[test]
fn a_file_is_read_and_errors_name_line_and_cause() {
    let path = |keys: &str| format!("{{\"version\": 1, \"keys\": [\n{keys}\n]}}");
    let read_key = |time: &str, view: &str| format!("{{\"time_s\": {time}, \"camera\": {view}}}");
    let two = path(&[read_key("0", VIEW), read_key("2.5", VIEW)].join(",\n"));
    assert_eq!(read(&two).unwrap().duration_s(), 2.5);
    let orthographic = VIEW.replace("fov_y_degrees", "height");
    for (text, message) in [
        ("{".to_owned(), ":1: EOF"),
        (two.replace("\"version\": 1", "\"version\": 2"), ":1: version 2 is not known, only version 1"),
        (path(""), ":3: keys is empty"),
        (path(&[read_key("1", VIEW), read_key("1", VIEW)].join(",\n")), ":3: time_s must be above"),
        (path(&read_key("-1", VIEW)), ":2: time_s must be at least 0"),
        (path(&read_key("1e999", VIEW)), ":2: number out of range"),
        (path(&[read_key("0", VIEW), read_key("1", &orthographic)].join(",\n")), ":3: perspective and orthographic"),
        (path(&read_key("0", &VIEW.replace("[0, 0, 5]", "[0, 0, 0]"))), ":2: eye and target are the same point"),
        (two.replace("time_s", "at"), ":2: unknown field `at`"),
    ] {
        let error = read(&text).unwrap_err();
        assert!(error.starts_with(message), "{error} instead of {message}");
    }
}

#[test]
fn a_written_path_comes_back_bit_for_bit() {
    let keys = [key(0.0, Vec3::new(0.1, 1.0, 7.3), 0.7), key(1.0 / 3.0, Vec3::new(3.3, -1.0, 4.1), 0.9)];
    let path = CameraPath::through(keys.to_vec()).unwrap();
    let text = String::from_utf8(path.encode().unwrap().unwrap()).unwrap();
    assert_eq!(read(&text), Ok(path));
    assert_eq!(CameraPath::preset("shake").unwrap().encode().unwrap(), None);
}

#[test]
fn key_views_that_no_file_may_have_are_refused() {
    let flat = |time_s: f64| {
        let mut key = key(time_s, Vec3::Z, 0.7);
        key.camera.projection = Projection::Orthographic { height: 2.0 };
        key
    };
    let at = |time_s: f64| key(time_s, Vec3::Z, 0.7);
    for keys in [
        vec![],
        vec![at(-1.0)],
        vec![at(1.0), at(1.0)],
        vec![at(2.0), at(1.0)],
        vec![at(0.0), flat(1.0)],
        vec![at(f64::NAN)],
    ] {
        assert!(CameraPath::through(keys.clone()).is_err(), "{keys:?}");
    }
}
