//! Serialisation of paths without loss: as text if a path is UTF-8, else as bytes.
//!
//! Single paths use `#[serde(with = "stored_path")]`; lists of paths use [`StoredPath`].

use std::path::{Path, PathBuf};

use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Path that can be serialised even if it is not UTF-8.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StoredPath(pub PathBuf);

/// JSON representation of a path: text, or bytes if it is not UTF-8.
#[derive(Deserialize, Serialize)]
#[serde(untagged)]
enum Form {
    Text(String),
    Bytes(Vec<u8>),
}

/// Serialises a path, even if it is not UTF-8.
pub(crate) fn serialize<S: Serializer>(path: &Path, to: S) -> Result<S::Ok, S::Error> {
    form(path).serialize(to)
}

/// Deserialises a path written by [`serialize`].
pub(crate) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<PathBuf, D::Error> {
    Form::deserialize(from).map(path)
}

impl Serialize for StoredPath {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        serialize(&self.0, to)
    }
}

impl<'de> Deserialize<'de> for StoredPath {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        deserialize(from).map(Self)
    }
}

#[cfg(unix)]
fn form(path: &Path) -> Form {
    use std::os::unix::ffi::OsStrExt as _;
    path.to_str().map_or_else(|| Form::Bytes(path.as_os_str().as_bytes().to_vec()), |text| Form::Text(text.to_owned()))
}

#[cfg(unix)]
fn path(form: Form) -> PathBuf {
    use std::os::unix::ffi::OsStringExt as _;
    match form {
        Form::Text(text) => text.into(),
        Form::Bytes(bytes) => std::ffi::OsString::from_vec(bytes).into(),
    }
}

#[cfg(not(unix))]
fn form(path: &Path) -> Form {
    Form::Text(path.to_string_lossy().into_owned())
}

#[cfg(not(unix))]
fn path(form: Form) -> PathBuf {
    match form {
        Form::Text(text) => text.into(),
        Form::Bytes(bytes) => String::from_utf8_lossy(&bytes).into_owned().into(),
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn every_path_comes_back() {
        use std::os::unix::ffi::OsStrExt as _;
        for bytes in [&b"/models/chair.obj"[..], b"/models/\xFF\xFE.obj", "/Stühle/椅子.obj".as_bytes(), b""] {
            let path = StoredPath(std::ffi::OsStr::from_bytes(bytes).into());
            let json = serde_json::to_string(&path).unwrap();
            assert_eq!(serde_json::from_str::<StoredPath>(&json).unwrap(), path, "{json}");
        }
        assert_eq!(serde_json::to_string(&StoredPath("a.obj".into())).unwrap(), r#""a.obj""#);
    }
}
