//! Exact cases stored outside the crate: one file per case, with its answer in exact arithmetic beside it.

#[path = "../samples/mod.rs"]
mod samples;

use std::path::PathBuf;

use serde_json::Value;

/// A case with its exact answer.
pub(crate) struct Sample {
    /// File of the case.
    pub(crate) path: PathBuf,
    /// Contents of the case.
    pub(crate) case: Value,
    /// Exact answer.
    pub(crate) expected: Value,
}

/// Returns all cases of these kinds, sorted by name. Without the folder it prints a note to stderr and returns no
/// cases.
pub(crate) fn of_kinds(kinds: &[&str]) -> Vec<Sample> {
    let folder = samples::folder().join("cases");
    let Ok(entries) = std::fs::read_dir(folder.join("cases")) else {
        eprintln!("no exact cases in {}: nothing checked", folder.display());
        return Vec::new();
    };
    let mut names: Vec<_> = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok()).collect();
    names.sort_unstable();
    let read = |path: &PathBuf| -> Value {
        let text = std::fs::read_to_string(path).expect("a readable case");
        serde_json::from_str(&text).expect("a case in JSON")
    };
    let of_kind = |name: &String| {
        let path = folder.join("cases").join(name);
        let case = read(&path);
        let wanted = kinds.iter().any(|kind| case["kind"] == *kind);
        wanted.then(|| Sample { path, case, expected: read(&folder.join("expected").join(name)) })
    };
    names.iter().filter_map(of_kind).collect()
}
