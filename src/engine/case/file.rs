//! Reads a [`Case`] from a file and validates its values; errors name the position and the cause.

use std::path::{Path, PathBuf};

use serde::Deserialize;
use thiserror::Error;

use super::{Case, Check as _, Task};
use crate::{disk, text};

/// Maximum size of a case file, in bytes. Parsing needs up to thirteen times as much memory, which stays below 256 MB.
const MAX_BYTES: u64 = 16 << 20;

/// Maximum length of a case ID, in bytes. With a suffix added, it is still a valid file name on every platform.
const MAX_ID_BYTES: usize = 200;

/// Error from reading a case.
#[derive(Debug, Error)]
pub enum CaseError {
    /// The file cannot be read.
    #[error("{}: cannot read it: {source}", path.display())]
    Unreadable {
        /// Path of the file.
        path: PathBuf,
        /// I/O error of the operating system.
        source: std::io::Error,
    },
    /// The file is not valid JSON, or its fields do not match the kind of case.
    #[error("{}:{line}:{column}: {reason}", path.display())]
    Malformed {
        /// Path of the file.
        path: PathBuf,
        /// Line of the error, counted from 1.
        line: usize,
        /// Column of the error, counted from 1.
        column: usize,
        /// Description of the error at this position.
        reason: String,
    },
    /// The values of the case are invalid.
    #[error("{}: {reason}", path.display())]
    Unusable {
        /// Path of the file.
        path: PathBuf,
        /// Description of the invalid value.
        reason: String,
    },
}

/// Fields common to all cases.
#[derive(Deserialize)]
#[serde(expecting = "a case: an object with `id` and `kind`")]
struct Header {
    id: String,
    kind: String,
}

pub(super) fn read(path: &Path) -> Result<Case, CaseError> {
    let json = disk::read(path, MAX_BYTES).map_err(|source| CaseError::Unreadable { path: path.to_owned(), source })?;
    parse(&json, path)
}

pub(super) fn parse(json: &[u8], path: &Path) -> Result<Case, CaseError> {
    let malformed = |error: serde_json::Error| {
        let whole = error.to_string();
        let reason = text::message(whole.rsplit_once(" at line ").map_or(&*whole, |(reason, _)| reason));
        CaseError::Malformed { path: path.to_owned(), line: error.line(), column: error.column(), reason }
    };
    let unusable = |reason: String| CaseError::Unusable { path: path.to_owned(), reason };
    // The JSON is parsed twice, and the first pass ignores the values. Keeping them in memory until the kind is known
    // would take many times the size of the file.
    let Header { id, kind } = serde_json::from_slice(json).map_err(malformed)?;
    check_id(&id).map_err(unusable)?;
    let task = Task::parse(&kind, json).ok_or_else(|| unusable(unknown_kind(&kind)))?.map_err(malformed)?;
    task.check().map_err(unusable)?;
    Ok(Case { id, task })
}

fn unknown_kind(kind: &str) -> String {
    let known: Vec<_> = Task::KINDS.iter().map(|kind| format!("`{kind}`")).collect();
    format!("unknown kind `{}`, expected one of {}", text::message(kind), known.join(", "))
}

/// Checks that an ID is a valid file name, because result files are named after their cases.
fn check_id(id: &str) -> Result<(), String> {
    let has_separator = id.contains(|c: char| c.is_control() || "/\\:".contains(c));
    if id.is_empty() || id.len() > MAX_ID_BYTES || id.starts_with('.') || has_separator {
        return Err(format!("the id {id:?} cannot be used as a file name"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(text: &str) -> String {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("case.json");
        std::fs::write(&path, text).unwrap();
        let message = read(&path).unwrap_err().to_string();
        message.rsplit_once("case.json").unwrap().1.to_owned()
    }

    #[test]
    fn error_messages_name_the_position_and_the_cause() {
        for (text, message) in [
            ("", ":1:0: EOF while parsing a value"),
            ("[]", ":1:2: invalid length 0, expected a case: an object with `id` and `kind`"),
            ("7", ":1:1: invalid type: integer `7`, expected a case: an object with `id` and `kind`"),
            ("{\"id\": \"a\",\n\"kind\": NaN}", ":2:9: expected value"),
            (r#"{"kind": "line"}"#, ":1:16: missing field `id`"),
            (r#"{"id": "a"}"#, ":1:11: missing field `kind`"),
            (r#"{"id": "a", "kind": "sphere"}"#, ": unknown kind `sphere`, expected one of `tri_coverage`, "),
            (r#"{"id": "../a", "kind": "line"}"#, ": the id \"../a\" cannot be used as a file name"),
            (r#"{"id": "", "kind": "line"}"#, ": the id \"\" cannot be used as a file name"),
            (r#"{"id": "a", "kind": "line", "p0": [0, 0]}"#, ":1:41: missing field `p1`"),
            (
                r#"{"id": "a", "kind": "line", "p0": [0], "p1": [0, 0], "last_pixel": true}"#,
                ":1:37: invalid length 1, expected a list of 2",
            ),
            (r#"{"id": "a", "kind": "circle", "c": [0, 0], "r": -1}"#, ":1:50: invalid value: integer `-1`"),
            (r#"{"id": "a", "kind": "real_line", "p0": [0, 1e999]}"#, ":1:48: number out of range"),
            (
                r#"{"id": "a", "kind": "real_line", "p0": [0, 1e39]}"#,
                ":1:48: 1e39 lies outside the range of 32-bit floats",
            ),
            (
                r#"{"id": "a", "kind": "distance_line", "width": 1000000000, "height": 1, "p0": [0, 0], "p1": [1, 1]}"#,
                ": a picture of 1000000000 × 1 px: each side must be 1 to 16384 pixels long",
            ),
            (
                r#"{"id": "a", "kind": "tri_area", "width": 9, "height": 9, "triangle": [[0, 0], [1, 1, 1], [0, 1]]}"#,
                ":1:87: invalid length 3, expected a list of 2",
            ),
            (r#"{"id": "a", "kind": "line", "p0": [0, 0]"#, ":1:40: EOF while parsing an object"),
        ] {
            let found = error(text);
            assert!(found.starts_with(message), "{found}\ninstead of\n{message}");
        }
    }

    #[test]
    fn a_missing_file_is_named() {
        let message = read(Path::new("nowhere/case.json")).unwrap_err().to_string();
        assert!(message.starts_with("nowhere/case.json: cannot read it: "), "{message}");
    }

    #[test]
    fn too_large_a_file_is_not_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("large.json");
        std::fs::File::create(&path).unwrap().set_len(MAX_BYTES + 1).unwrap();
        let message = read(&path).unwrap_err().to_string();
        assert!(message.ends_with("it is larger than 16 MiB, the maximum"), "{message}");
    }
}
