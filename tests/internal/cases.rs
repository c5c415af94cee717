//! Numerical cases with exact answers: one file per case, with its answer in another folder under the same name.

use crate::internal::samples;
use std::path::{Path, PathBuf};

use serde_json::Value;

/// Origin of a case: the project itself or the external samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Origin {
    /// A case of the project itself.
    Own,
    /// A case of the external samples.
    External,
}

/// Numerical case with its exact answer.
pub(crate) struct Sample {
    /// Origin of the case.
    pub(crate) origin: Origin,
    /// Path of the case file.
    pub(crate) path: PathBuf,
    /// Content of the case file.
    pub(crate) case: Value,
    /// Exact answer to the case, from the file of the same name in the folder `expected`.
    pub(crate) expected: Value,
}

/// Returns all cases of these kinds: the project's own, and the external ones if there are external samples. Panics if
/// one of these origins has no case of a kind.
pub(crate) fn of_kinds(kinds: &[&str]) -> Vec<Sample> {
    let own = Some((Origin::Own, samples::own()));
    let external = samples::external().map(|folder| (Origin::External, folder));
    let folders = own.into_iter().chain(external);
    folders.flat_map(|(origin, folder)| of_folder(origin, &folder.join("cases"), kinds)).collect()
}

/// Returns the cases of these kinds in a folder, sorted by file name.
fn of_folder(origin: Origin, folder: &Path, kinds: &[&str]) -> Vec<Sample> {
    let entries = std::fs::read_dir(folder.join("cases")).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let mut names: Vec<_> = entries.map(|entry| entry.expect("a readable folder").file_name()).collect();
    names.sort_unstable();
    let read = |path: &Path| -> Value {
        let text = std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        serde_json::from_str(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
    };
    let mut found = Vec::new();
    for name in names {
        let path = folder.join("cases").join(&name);
        let case = read(&path);
        if kinds.iter().any(|kind| case["kind"] == *kind) {
            found.push(Sample { origin, path, case, expected: read(&folder.join("expected").join(&name)) });
        }
    }
    for kind in kinds {
        assert!(found.iter().any(|sample| sample.case["kind"] == *kind), "no {kind} case in {}", folder.display());
    }
    found
}
