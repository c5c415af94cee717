//! Where models, damaged files and exact cases are that nobody here made.

use std::path::PathBuf;

/// The folder that `RASTERSCOPE_SAMPLES` names, or `shared` beside the repository. It may not be there.
pub(crate) fn folder() -> PathBuf {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../shared");
    std::env::var_os("RASTERSCOPE_SAMPLES").map_or_else(|| PathBuf::from(beside), PathBuf::from)
}
