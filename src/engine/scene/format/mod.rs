//! Registry of the file formats of models.
//!
//! The command line, the window, the error messages, the manual and the tests read this list. A new format is a module with
//! a `FORMAT`, and a line in `formats!`.

use std::path::Path;

use self::obj::TrMeaning;
use super::{LoadControl, Loaded, SceneError};
use crate::disk;

/// Declares the modules of the formats and [`SceneFormat::ALL`], which lists the `FORMAT` of each.
///
/// `cargo fmt` does not see modules that a macro declares; `.ci/run` formats them by their files.
macro_rules! formats {
    ($($visibility:vis mod $module:ident;)+) => {
        $($visibility mod $module;)+

        impl SceneFormat {
            /// All formats. The first one is assumed for a file that none of them recognises.
            pub const ALL: &[Self] = &[$($module::FORMAT),+];
        }
    };
}

formats! {
    pub mod obj;
    pub mod gltf;
}

/// File format of models.
#[derive(Clone, Copy, Debug)]
pub struct SceneFormat {
    /// Display name.
    pub name: &'static str,
    /// File extensions in lower case, without the dot; at least one.
    pub extensions: &'static [&'static str],
    /// Other files that a model may consist of, in a few words; empty if it is always a single file.
    pub companions: &'static str,
    /// Content of a small valid file, with at least one triangle and without companions. The tests load it, cut it and
    /// damage it.
    pub example: &'static [u8],
    /// Returns whether a file that starts with these bytes is certainly in this format. A file that no format recognises
    /// is chosen by its extension.
    pub(super) starts: fn(&[u8]) -> bool,
    /// Loads a file in this format.
    pub(super) load: fn(&Path, TrMeaning, LoadControl<'_>) -> Result<Loaded, SceneError>,
    /// Whether materials of this format have a transparency `Tr` whose meaning can be chosen.
    pub has_tr: bool,
}

/// Number of bytes at the start of a file by which a format is recognised.
const START_BYTES: u64 = 256;

impl SceneFormat {
    /// Returns the format of the file at `path`: by its content if that is conclusive, otherwise by its extension.
    /// Returns `None` if neither is known.
    pub fn of(path: &Path) -> Option<&'static Self> {
        let start = start(path);
        Self::ALL.iter().find(|format| (format.starts)(&start)).or_else(|| Self::by_extension(path))
    }

    /// Returns the format whose extension the path has, or `None` if there is none. Reads no file.
    pub fn by_extension(path: &Path) -> Option<&'static Self> {
        let own = path.extension()?;
        Self::ALL.iter().find(|format| format.extensions.iter().any(|known| own.eq_ignore_ascii_case(known)))
    }

    /// Loads a model in any format. `tr` is the meaning of `Tr` in its materials; `control` holds the memory limit, the
    /// progress callback and the cancellation flag.
    ///
    /// # Errors
    /// Returns an error that names the file and, if known, the place in it. Causes are an unreadable file, an unknown
    /// format, malformed content, no triangle to draw, or more memory than the limit.
    pub(super) fn load_file(path: &Path, tr: TrMeaning, control: LoadControl<'_>) -> Result<Loaded, SceneError> {
        match Self::of(path) {
            Some(format) => (format.load)(path, tr, control),
            None => (Self::ALL[0].load)(path, tr, control).map_err(|error| match error {
                SceneError::Unusable { path, reason } => {
                    let reason = format!("{reason} (models are read in the formats {})", Self::names_and_extensions());
                    SceneError::Unusable { path, reason }
                }
                other => other,
            }),
        }
    }

    /// Returns the names of all formats, as in “OBJ or glTF”.
    pub fn names() -> String {
        Self::ALL.iter().map(|format| format.name).collect::<Vec<_>>().join(" or ")
    }

    /// Returns the names of all formats with their extensions, as in “OBJ (.obj), glTF (.gltf, .glb)”.
    pub fn names_and_extensions() -> String {
        let described = |format: &Self| format!("{} (.{})", format.name, format.extensions.join(", ."));
        Self::ALL.iter().map(described).collect::<Vec<_>>().join(", ")
    }

    /// Returns the extensions of all formats, in lower case and without the dot.
    pub fn all_extensions() -> Vec<&'static str> {
        Self::ALL.iter().flat_map(|format| format.extensions).copied().collect()
    }
}

/// Returns the first bytes of a regular file, without a byte-order mark and white space; empty if it cannot be read.
fn start(path: &Path) -> Vec<u8> {
    // A file that cannot be read gives an error when it is loaded.
    let bytes = disk::start(path, START_BYTES);
    bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(&bytes).trim_ascii_start().to_vec()
}

#[cfg(test)]
mod tests;
