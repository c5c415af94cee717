//! Locations of input files: the project's own in `tests/inputs`, and optional external samples of the same layout.

use std::path::{Path, PathBuf};

/// Subfolders that the project's own inputs must have.
const OWN: [&str; 4] = ["bad", "cases", "gltf", "models"];

/// Subfolders that external samples must have.
const EXTERNAL: [&str; 4] = ["bad", "cases", "images", "models"];

/// Returns the folder of the project's own inputs. Panics if a part of it is missing, because the tests would then
/// check nothing.
pub(crate) fn own() -> PathBuf {
    let folder = repository().join("tests/inputs");
    if let Some(missing) = missing(&folder, &OWN) {
        panic!("{} is missing: it belongs to the repository", missing.display());
    }
    folder
}

/// Returns the folder of external samples: the one that `RASTERSCOPE_SAMPLES` names, or else `shared` beside the
/// repository.
///
/// Returns `None` if the variable is empty, or if it is not set and `shared` does not exist.
///
/// # Panics
/// Panics if the variable names a folder without samples.
pub(crate) fn external() -> Option<PathBuf> {
    let Some(named) = std::env::var_os("RASTERSCOPE_SAMPLES") else {
        let beside = repository().join("../shared");
        return missing(&beside, &EXTERNAL).is_none().then_some(beside);
    };
    if named.is_empty() {
        return None;
    }
    let folder = PathBuf::from(named);
    if let Some(missing) = missing(&folder, &EXTERNAL) {
        panic!("external samples were named but are missing: RASTERSCOPE_SAMPLES needs {}", missing.display());
    }
    Some(folder)
}

/// Returns the top-level folder of the repository, which contains both crates.
fn repository() -> &'static Path {
    let crate_folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    crate_folder.ancestors().find(|folder| folder.join("tests").is_dir()).expect("the crates lie in the repository")
}

/// Returns the path of the first of the subfolders `parts` that does not exist in `folder`.
fn missing(folder: &Path, parts: &[&str]) -> Option<PathBuf> {
    parts.iter().map(|part| folder.join(part)).find(|part| !part.is_dir())
}
