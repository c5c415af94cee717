//! Lookup of files whose names are written differently in the model and on disk.
//!
//! macOS writes decomposed names (NFD), and most other systems composed ones (NFC). Windows does not distinguish upper
//! and lower case. A model copied to another system may therefore refer to a file by a name that differs in normal form
//! or case.

use std::path::{Path, PathBuf};

use unicode_normalization::UnicodeNormalization as _;

/// Difference between the name of a file on disk and the requested name. Ordered by severity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum NameDifference {
    /// The names are equal.
    None,
    /// The names differ only in their Unicode normal form.
    NormalForm,
    /// The names differ in upper and lower case.
    Case,
}

/// Returns the existing path that matches `path`, and how its name differs from the requested one; `None` if no such
/// file exists.
pub(super) fn existing(path: &Path) -> Option<(PathBuf, NameDifference)> {
    if path.exists() {
        return Some((path.to_owned(), NameDifference::None));
    }
    let (Some(folder), Some(name)) = (path.parent(), path.file_name()?.to_str()) else { return None };
    let (folder, outer) =
        if folder == Path::new("") { (PathBuf::from("."), NameDifference::None) } else { existing(folder)? };
    let composed: String = name.nfc().collect();
    let folded = composed.to_lowercase();
    let alike = |found: &str| {
        let found: String = found.nfc().collect();
        if found == composed {
            Some(NameDifference::NormalForm)
        } else {
            (found.to_lowercase() == folded).then_some(NameDifference::Case)
        }
    };
    let names = std::fs::read_dir(&folder).ok()?.flatten().filter_map(|entry| entry.file_name().into_string().ok());
    // Of several matching names, the one with the smallest difference is used. Ties are broken by the order of the
    // names, so that the result does not depend on the file system.
    let (own, found) = names.filter_map(|found| Some((alike(&found)?, found))).min()?;
    Some((folder.join(found), own.max(outer)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_found_in_any_normal_form_and_case() {
        let folder = tempfile::tempdir().unwrap();
        let sub = folder.path().join("Bücher".nfd().collect::<String>());
        std::fs::create_dir(&sub).unwrap();
        std::fs::write(sub.join("Ångström.PNG"), "").unwrap();
        let find = |name: &str| existing(&folder.path().join(name));
        let found = sub.join("Ångström.PNG");
        assert_eq!(find("Bücher/Ångström.PNG"), Some((found.clone(), NameDifference::NormalForm)));
        assert_eq!(find("bücher/ångström.png"), Some((found, NameDifference::Case)));
        assert_eq!(find("Bucher/Angstrom.png"), None);
    }
}
