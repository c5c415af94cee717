//! Seed files of the fuzz targets: the project's own inputs, and external samples if there are any.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use rasterscope::image::picture::suffixes;

use crate::internal::samples;

/// Size of the largest seed file, in bytes.
const MOST_BYTES: u64 = 16 << 10;

/// Name and bytes of a file.
pub(crate) type File = (String, Vec<u8>);

/// Returns the seed files of up to 16 KiB whose suffix `is_wanted` accepts, sorted by path. Reads the files once per
/// `kind`.
pub(crate) fn files(kind: &'static str, is_wanted: fn(&str) -> bool) -> &'static [File] {
    static KNOWN: Mutex<BTreeMap<&'static str, &'static [File]>> = Mutex::new(BTreeMap::new());
    let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    known.entry(kind).or_insert_with(|| {
        let mut paths = Vec::new();
        for folder in std::iter::once(samples::own()).chain(samples::external()) {
            collect(&folder, is_wanted, &mut paths);
        }
        paths.sort_unstable();
        let read = |path: &PathBuf| {
            let name = path.file_name()?.to_str()?.to_owned();
            Some((name, fs::read(path).ok()?))
        };
        // The few files stay in memory until the process ends.
        Box::leak(paths.iter().filter_map(read).collect())
    })
}

/// Returns whether a suffix belongs to a picture format.
pub(crate) fn is_picture(suffix: &str) -> bool {
    suffixes().any(|known| known == suffix)
}

fn collect(folder: &Path, is_wanted: fn(&str) -> bool, paths: &mut Vec<PathBuf>) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let path = entry.path();
        let is_small = entry.metadata().is_ok_and(|metadata| metadata.is_file() && metadata.len() <= MOST_BYTES);
        let suffix = path.extension().and_then(|suffix| suffix.to_str()).unwrap_or_default();
        if path.is_dir() {
            collect(&path, is_wanted, paths);
        } else if is_small && is_wanted(suffix) {
            paths.push(path);
        }
    }
}
