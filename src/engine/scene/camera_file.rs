//! Camera files: views as hand-editable JSON.
//!
//! Input: the path of a file such as `{"eye": [0, 1, 5], "target": [0, 0, 0], "up": [0, 1, 0], "fov_y_degrees": 45,
//! "near": 0.1, "far": 100}`, in world space. Output: a valid [`Camera`], or an error that names the file and, if
//! known, the line. `fov_y_radians` can replace `fov_y_degrees`; `height`, in world units, replaces it for an
//! orthographic view. [`text()`] writes a view that [`parse`] restores bit for bit.

use std::path::Path;

use glam::Vec3;
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::{Camera, Projection, SceneError};
use crate::{disk, text};

/// Maximum size of a camera file, in bytes. Typical files have a few hundred.
const MAX_BYTES: u64 = 1 << 20;

/// Serialized form of a [`Camera`].
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct CameraFile {
    eye: Vec3,
    target: Vec3,
    #[serde(default = "y_up")]
    up: Vec3,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    fov_y_degrees: Option<f32>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    fov_y_radians: Option<f32>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    height: Option<f32>,
    near: f32,
    far: f32,
}

fn y_up() -> Vec3 {
    Vec3::Y
}

impl TryFrom<CameraFile> for Camera {
    type Error = String;

    fn try_from(file: CameraFile) -> Result<Self, String> {
        let CameraFile { eye, target, up, fov_y_degrees, fov_y_radians, height, near, far } = file;
        let projection = match (fov_y_degrees, fov_y_radians, height) {
            (Some(degrees), None, None) => Projection::Perspective { fov_y: degrees.to_radians() },
            (None, Some(fov_y), None) => Projection::Perspective { fov_y },
            (None, None, Some(height)) => Projection::Orthographic { height },
            (None, None, None) => return Err("missing field `fov_y_degrees`".to_owned()),
            _ => return Err("give only one of fov_y_degrees, fov_y_radians and height".to_owned()),
        };
        let camera = Self { eye, target, up, projection, near, far, sub_view: None };
        camera.check().map(|()| camera)
    }
}

impl From<&Camera> for CameraFile {
    fn from(camera: &Camera) -> Self {
        let Camera { eye, target, up, projection, near, far, sub_view: _ } = *camera;
        let (mut fov_y_degrees, mut fov_y_radians, mut height) = (None, None, None);
        match projection {
            // Degrees are easier to read, but not every angle in radians survives the conversion to degrees and back.
            Projection::Perspective { fov_y } => match fov_y.to_degrees() {
                degrees if degrees.to_radians() == fov_y => fov_y_degrees = Some(degrees),
                _ => fov_y_radians = Some(fov_y),
            },
            Projection::Orthographic { height: slab } => height = Some(slab),
        }
        Self { eye, target, up, fov_y_degrees, fov_y_radians, height, near, far }
    }
}

/// Serializes a view as one line of JSON, which [`parse`] and [`read`] accept.
pub fn text(camera: &Camera) -> String {
    // All fields are plain numbers, so serialization cannot fail.
    serde_json::to_string(&CameraFile::from(camera)).unwrap_or_default()
}

/// Parses a view from JSON text. Returns an error for malformed JSON, unknown fields, or a view that [`Camera::check`]
/// rejects.
pub fn parse(text: &str) -> Result<Camera, String> {
    serde_json::from_str::<CameraFile>(text).map_err(|error| error.to_string()).and_then(Camera::try_from)
}

/// Serialises a view as a value of a larger file.
pub(crate) fn serialize<S: Serializer>(camera: &Camera, to: S) -> Result<S::Ok, S::Error> {
    CameraFile::from(camera).serialize(to)
}

/// Deserialises a view written by [`serialize`].
pub(crate) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Camera, D::Error> {
    CameraFile::deserialize(from)?.try_into().map_err(Error::custom)
}

/// Reads a view from a regular file of at most 1 MiB. Returns an error for an unreadable file, malformed JSON, unknown
/// fields, or a view that [`Camera::check`] rejects.
pub fn read(path: &Path) -> Result<Camera, SceneError> {
    let bytes =
        disk::read(path, MAX_BYTES).map_err(|source| SceneError::Unreadable { path: path.to_owned(), source })?;
    let file: CameraFile = serde_json::from_slice(&bytes).map_err(|e| {
        let whole = e.to_string();
        let reason = whole.split(" at line ").next().unwrap_or(&whole);
        let reason = text::message(reason);
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
    fn a_view_is_read_as_written_and_up_defaults_to_y() {
        let text = r#"{"eye": [1, 2, 3], "target": [0, 0, 0], "fov_y_degrees": 90, "near": 0.5, "far": 10}"#;
        let camera = read_text(text).unwrap();
        assert_eq!((camera.eye, camera.up, camera.near, camera.far), (Vec3::new(1.0, 2.0, 3.0), Vec3::Y, 0.5, 10.0));
        assert_eq!(camera.projection, Projection::Perspective { fov_y: std::f32::consts::FRAC_PI_2 });
    }

    #[test]
    fn error_messages_name_the_position_and_the_cause() {
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

    #[test]
    fn a_view_survives_a_round_trip_through_text_bit_for_bit() {
        let mut camera = Camera::look_at(Vec3::new(0.1, -2.0, 1e-7), Vec3::new(1.0 / 3.0, 0.0, 5e6));
        let angles = (1..300).map(|step| Projection::Perspective { fov_y: step as f32 * 0.010_432_1 });
        for projection in angles.chain([Projection::Orthographic { height: 0.7 }]) {
            camera.projection = projection;
            assert_eq!(parse(&text(&camera)), Ok(camera), "{}", text(&camera));
        }
        assert!(text(&Camera::look_at(Vec3::Z, Vec3::ZERO)).contains("\"fov_y_degrees\":45.0"));
        let two = r#"{"eye": [1,2,3], "target": [0,0,0], "fov_y_degrees": 45, "height": 2, "near": 1, "far": 2}"#;
        assert!(parse(two).unwrap_err().contains("only one"));
    }

    #[cfg(unix)]
    #[test]
    fn files_that_are_not_regular_are_not_opened() {
        let error = read(Path::new("/dev/zero")).unwrap_err().to_string();
        assert!(error.contains("not a regular file"), "{error}");
    }
}
