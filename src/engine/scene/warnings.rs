//! Collection of warnings about skipped or repaired content, with repetitions merged.
//!
//! A faulty exporter often repeats the same fault on every line. Warnings with equal texts about one file are therefore
//! merged into one, which has the line number of the first occurrence and a count. At most [`MAX_KEPT`] warnings are
//! kept.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::path::{Path, PathBuf};

use crate::scene::Warning;

/// Maximum number of warnings kept; further warnings are only counted.
const MAX_KEPT: usize = 100;

/// Collected warnings, in order of their first occurrence.
#[derive(Debug, Default)]
pub(super) struct Warnings {
    kept: Vec<(Warning, usize)>,
    place: HashMap<(PathBuf, String), usize>,
    dropped: usize,
}

impl Warnings {
    /// Adds a warning about `line` of the file, or about the whole file if `line` is `None`. Warnings with identical
    /// `text` are merged.
    pub(super) fn add(&mut self, path: &Path, line: Option<usize>, text: impl Into<String>) {
        let text = text.into();
        let kept = self.kept.len();
        match self.place.entry((path.to_owned(), text)) {
            Entry::Occupied(place) => self.kept[*place.get()].1 += 1,
            Entry::Vacant(_) if kept == MAX_KEPT => self.dropped += 1,
            Entry::Vacant(place) => {
                self.kept.push((Warning { path: path.to_owned(), line, text: place.key().1.clone() }, 1));
                place.insert(kept);
            }
        }
    }

    /// Returns the first warning that has a line number.
    pub(super) fn first_with_line(&self) -> Option<&Warning> {
        self.kept.iter().map(|(warning, _)| warning).find(|w| w.line.is_some())
    }

    /// Returns all warnings. A repeated warning includes its count. If warnings were dropped, a final “and … more”
    /// warning about `path` is added.
    pub(super) fn finish(self, path: &Path) -> Vec<Warning> {
        let more = (self.dropped > 0).then(|| Warning::file(path, format!("and {} more warnings", self.dropped)));
        let counted = |(mut warning, count): (Warning, usize)| {
            if count > 1 {
                let here = if warning.line.is_some() { ", here first" } else { "" };
                warning.text.push_str(&format!(" ({count} times{here})"));
            }
            warning
        };
        self.kept.into_iter().map(counted).chain(more).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repetitions_become_one_warning_with_a_count() {
        let mut warnings = Warnings::default();
        for line in [7, 8, 9] {
            warnings.add(Path::new("a.obj"), Some(line), "odd");
        }
        warnings.add(Path::new("b.mtl"), Some(1), "odd");
        let texts: Vec<_> = warnings.finish(Path::new("a.obj")).iter().map(ToString::to_string).collect();
        assert_eq!(texts, ["a.obj:7: odd (3 times, here first)", "b.mtl:1: odd"]);
    }

    #[test]
    fn the_number_of_warnings_is_limited() {
        let mut warnings = Warnings::default();
        for line in 0..1000 {
            warnings.add(Path::new("a.obj"), Some(line), format!("odd {line}"));
        }
        let all = warnings.finish(Path::new("a.obj"));
        assert_eq!(all.len(), MAX_KEPT + 1);
        assert_eq!(all[MAX_KEPT].text, "and 900 more warnings");
    }
}
