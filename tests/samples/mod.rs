//! Location of external models, damaged files and exact cases.

use std::path::PathBuf;

/// Returns the folder named by `RASTERSCOPE_SAMPLES`, or `shared` beside the repository. It may not exist.
pub(crate) fn folder() -> PathBuf {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../shared");
    std::env::var_os("RASTERSCOPE_SAMPLES").map_or_else(|| PathBuf::from(beside), PathBuf::from)
}
