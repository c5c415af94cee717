//! Exact cases kept outside the crate: one file per case, and beside it the answer in exact arithmetic.

use std::path::PathBuf;

use serde_json::Value;

/// Case and expected answer of every file of a class. Empty, with a word on stderr, without the folder.
#[allow(dead_code, reason = "each test file uses a part of it")]
pub(crate) fn of_class(class: &str) -> Vec<(Value, Value)> {
    starting_with(&format!("{class}__"))
}

/// Case and expected answer of every file whose name starts with `prefix`. Empty, with a word on stderr, without the
/// folder.
pub(crate) fn starting_with(prefix: &str) -> Vec<(Value, Value)> {
    let samples = std::env::var_os("RASTERSCOPE_SAMPLES")
        .map_or_else(|| PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../shared")), PathBuf::from);
    let folder = samples.join("cases");
    let Ok(entries) = std::fs::read_dir(folder.join("cases")) else {
        eprintln!("no exact cases in {}: nothing checked", folder.display());
        return Vec::new();
    };
    let mut names: Vec<_> = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok()).collect();
    names.retain(|name| name.starts_with(prefix));
    names.sort_unstable();
    let read = |kind: &str, name: &str| {
        let text = std::fs::read_to_string(folder.join(kind).join(name)).expect("a readable case");
        serde_json::from_str(&text).expect("a case in JSON")
    };
    names.iter().map(|name| (read("cases", name), read("expected", name))).collect()
}
