//! Views in files: JSON that people write by hand.
//!
//! In: the path of a file such as `{"eye": [0, 1, 5], "target": [0, 0, 0], "up": [0, 1, 0], "fov_y_degrees": 45,
//! "near": 0.1, "far": 100}`, in world space. Out: a perspective [`Camera`] that can be drawn from, or an error that
//! names the file and, where there is one, the line.

use std::path::Path;

use glam::Vec3;
use serde::Deserialize;

use super::{Camera, Projection, SceneError};
use crate::disk;

/// Largest file that is read, bytes; real ones have some hundred.
const MAX_BYTES: u64 = 1 << 20;

/// A view as it is written.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct CameraFile {
    eye: Vec3,
    target: Vec3,
    #[serde(default = "y_up")]
    up: Vec3,
    fov_y_degrees: f32,
    near: f32,
    far: f32,
}

fn y_up() -> Vec3 {
    Vec3::Y
}

impl TryFrom<CameraFile> for Camera {
    type Error = String;

    fn try_from(file: CameraFile) -> Result<Self, String> {
        let CameraFile { eye, target, up, fov_y_degrees, near, far } = file;
        let projection = Projection::Perspective { fov_y: fov_y_degrees.to_radians() };
        let camera = Self { eye, target, up, projection, near, far, window: None };
        camera.check().map(|()| camera)
    }
}

/// Reads a view. Errors: not a regular file of at most 1 MiB, not the JSON above, or what [`Camera::check`] says.
pub fn read(path: &Path) -> Result<Camera, SceneError> {
    let bytes =
        disk::read(path, MAX_BYTES).map_err(|source| SceneError::Unreadable { path: path.to_owned(), source })?;
    let file: CameraFile = serde_json::from_slice(&bytes).map_err(|e| {
        let text = e.to_string();
        let reason = text.split(" at line ").next().unwrap_or(&text).to_owned();
        SceneError::Line { path: path.to_owned(), line: e.line(), reason }
    })?;
    Camera::try_from(file).map_err(|reason| SceneError::Unusable { path: path.to_owned(), reason })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_text(text: &str) -> Result<Camera, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("view.json");
        std::fs::write(&path, text).unwrap();
        read(&path).map_err(|e| e.to_string().rsplit_once("view.json").unwrap().1.to_owned())
    }

    #[test]
    fn a_view_is_read_as_written_and_up_is_y_unless_told() {
        let text = r#"{"eye": [1, 2, 3], "target": [0, 0, 0], "fov_y_degrees": 90, "near": 0.5, "far": 10}"#;
        let camera = read_text(text).unwrap();
        assert_eq!((camera.eye, camera.up, camera.near, camera.far), (Vec3::new(1.0, 2.0, 3.0), Vec3::Y, 0.5, 10.0));
        assert_eq!(camera.projection, Projection::Perspective { fov_y: std::f32::consts::FRAC_PI_2 });
    }

    #[test]
    fn what_is_wrong_is_said_with_its_place() {
        for (text, message) in [
            ("", ":1: EOF while parsing a value"),
            ("{\n\"lens\": 3}", ":2: unknown field `lens`"),
            ("{\"eye\": [1e999, 0, 0]}", ":1: number out of range"),
            (
                r#"{"eye": [0,0,1], "target": [0,0,0], "fov_y_degrees": 180, "near": 1, "far": 2}"#,
                ": fov_y_degrees must lie between 0 and 180, not 180",
            ),
            (
                r#"{"eye": [0,0,1], "target": [0,0,1], "fov_y_degrees": 45, "near": 1, "far": 2}"#,
                ": eye and target are the same point",
            ),
        ] {
            let error = read_text(text).unwrap_err();
            assert!(error.starts_with(message), "{error}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn what_may_never_end_is_not_opened() {
        let error = read(Path::new("/dev/zero")).unwrap_err().to_string();
        assert!(error.contains("not a regular file"), "{error}");
    }
}
