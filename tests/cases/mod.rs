//! Exact cases kept outside the crate: one file per case, and beside it the answer in exact arithmetic.

#[path = "../samples/mod.rs"]
mod samples;

use std::path::PathBuf;

use serde_json::Value;

/// One of them.
pub(crate) struct Sample {
    /// The file of the case.
    pub(crate) path: PathBuf,
    /// What it says.
    pub(crate) case: Value,
    /// The exact answer.
    pub(crate) expected: Value,
}

/// All cases of these kinds, by name. Empty, with a word on stderr, without the folder.
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
