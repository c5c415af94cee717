//! Exact cases kept outside the crate: one file per case, and beside it the answer in exact arithmetic.

#![allow(dead_code, reason = "each test file uses a part of it")]

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
    samples(|_, case| kinds.iter().any(|kind| case["kind"] == *kind))
}

/// All cases in files whose name starts with `prefix`, by name. Empty, with a word on stderr, without the folder.
pub(crate) fn starting_with(prefix: &str) -> Vec<Sample> {
    samples(|name, _| name.starts_with(prefix))
}

fn samples(wanted: impl Fn(&str, &Value) -> bool) -> Vec<Sample> {
    let samples = std::env::var_os("RASTERSCOPE_SAMPLES")
        .map_or_else(|| PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../shared")), PathBuf::from);
    let folder = samples.join("cases");
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
    let sample = |name: &String| {
        let path = folder.join("cases").join(name);
        let case = read(&path);
        wanted(name, &case).then(|| Sample { path, case, expected: read(&folder.join("expected").join(name)) })
    };
    names.iter().filter_map(sample).collect()
}
