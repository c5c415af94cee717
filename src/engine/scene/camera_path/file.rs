//! Files of camera paths.

use std::fmt;
use std::path::Path;

use serde::de::value::MapAccessDeserializer;
use serde::de::{DeserializeSeed, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::KeyView;
use crate::scene::{Camera, Projection, SceneError, camera_file};
use crate::{disk, text};

/// Version of the format.
const VERSION: u32 = 1;

/// Maximum size of a file, in bytes. A key view has a few hundred.
const MAX_BYTES: u64 = 16 << 20;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PathFile {
    #[serde(deserialize_with = "known_version")]
    #[expect(dead_code, reason = "it is checked while it is read")]
    version: u32,
    #[serde(deserialize_with = "ascending_keys")]
    keys: Vec<KeyView>,
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct FileKey {
    time_s: f64,
    #[serde(with = "camera_file")]
    camera: Camera,
}

/// Written form of a path.
#[derive(Serialize)]
struct WrittenPath {
    version: u32,
    keys: Vec<FileKey>,
}

fn known_version<'de, D: Deserializer<'de>>(from: D) -> Result<u32, D::Error> {
    match u32::deserialize(from)? {
        VERSION => Ok(VERSION),
        other => Err(D::Error::custom(format!("version {other} is not known, only version {VERSION}"))),
    }
}

/// Deserialises at least one key view.
pub(crate) fn ascending_keys<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<KeyView>, D::Error> {
    struct Keys;

    impl<'de> Visitor<'de> for Keys {
        type Value = Vec<KeyView>;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            write!(f, "a list of key views")
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut from: A) -> Result<Self::Value, A::Error> {
            let mut keys: Vec<KeyView> = Vec::new();
            while let Some(key) = from.next_element_seed(KeyAfter(keys.last().copied()))? {
                keys.push(key);
            }
            if keys.is_empty() {
                return Err(A::Error::custom("keys is empty: a path has at least one key view"));
            }
            Ok(keys)
        }
    }

    from.deserialize_seq(Keys)
}

/// Deserialises a key view that follows another one. The check is a part of it, so that an error has the line of the key
/// view.
struct KeyAfter(Option<KeyView>);

impl<'de> DeserializeSeed<'de> for KeyAfter {
    type Value = KeyView;

    fn deserialize<D: Deserializer<'de>>(self, from: D) -> Result<KeyView, D::Error> {
        from.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for KeyAfter {
    type Value = KeyView;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a key view")
    }

    fn visit_map<A: MapAccess<'de>>(self, from: A) -> Result<KeyView, A::Error> {
        let FileKey { time_s, camera } = FileKey::deserialize(MapAccessDeserializer::new(from))?;
        check(time_s, &camera, self.0).map_err(A::Error::custom)?;
        Ok(KeyView { time_s, camera })
    }
}

/// Checks a key view against the one before it.
pub(super) fn check(time_s: f64, camera: &Camera, before: Option<KeyView>) -> Result<(), String> {
    if time_s.is_nan() || time_s < 0.0 {
        return Err(format!("time_s must be at least 0, not {time_s}"));
    }
    let Some(before) = before else { return Ok(()) };
    if time_s <= before.time_s {
        return Err(format!("time_s must be above that of the key view before, {}, not {time_s}", before.time_s));
    }
    let is_orthographic = |camera: &Camera| matches!(camera.projection, Projection::Orthographic { .. });
    if is_orthographic(camera) != is_orthographic(&before.camera) {
        return Err("perspective and orthographic key views are mixed".to_owned());
    }
    Ok(())
}

/// Serialises key views as in a file.
pub(crate) fn serialize_keys<S: Serializer>(keys: &[KeyView], to: S) -> Result<S::Ok, S::Error> {
    to.collect_seq(keys.iter().map(|KeyView { time_s, camera }| FileKey { time_s: *time_s, camera: *camera }))
}

/// Whether a file has the list of key views that other JSON files lack.
pub(super) fn has_keys(path: &Path) -> bool {
    #[derive(Deserialize)]
    struct Head {
        #[serde(rename = "keys")]
        _keys: IgnoredAny,
    }

    disk::read(path, MAX_BYTES).is_ok_and(|bytes| serde_json::from_slice::<Head>(&bytes).is_ok())
}

/// Encodes key views as a file.
pub(super) fn encode(keys: &[KeyView]) -> serde_json::Result<Vec<u8>> {
    let keys = keys.iter().map(|KeyView { time_s, camera }| FileKey { time_s: *time_s, camera: *camera }).collect();
    let mut bytes = serde_json::to_vec_pretty(&WrittenPath { version: VERSION, keys })?;
    bytes.push(b'\n');
    Ok(bytes)
}

/// Reads the key views of a file.
pub(super) fn read(path: &Path) -> Result<Vec<KeyView>, SceneError> {
    let bytes =
        disk::read(path, MAX_BYTES).map_err(|source| SceneError::Unreadable { path: path.to_owned(), source })?;
    let file: PathFile = serde_json::from_slice(&bytes).map_err(|error| {
        let whole = error.to_string();
        let reason = text::message(whole.split(" at line ").next().unwrap_or(&whole));
        SceneError::Line { path: path.to_owned(), line: error.line(), reason }
    })?;
    Ok(file.keys)
}
