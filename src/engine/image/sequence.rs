//! Sequences of picture files, such as the frames of an animation.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

use super::file::{ImageFileError, is_named_picture};
use crate::text;

/// Maximum number of files of a sequence.
const MAX_FRAMES: usize = 100_000;

/// File name with a frame number in it, such as `beauty.####.exr`.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct NamePattern {
    /// Part of the name before the number.
    before: String,
    /// Part of the name after the number.
    after: String,
}

impl NamePattern {
    /// Parses a file name in which a run of `#`, or `%d` or `%04d`, stands for the number.
    fn parse(name: &str) -> Option<Self> {
        if let (Some(first), Some(last)) = (name.find('#'), name.rfind('#')) {
            let is_run = name[first..last].bytes().all(|byte| byte == b'#');
            return is_run.then(|| Self { before: name[..first].to_owned(), after: name[last + 1..].to_owned() });
        }
        let (before, rest) = name.split_once('%')?;
        let after = rest.trim_start_matches(|character: char| character.is_ascii_digit()).strip_prefix('d')?;
        Some(Self { before: before.to_owned(), after: after.to_owned() })
    }

    /// Splits a file name at its last run of digits in front of the extension. Returns the pattern and the number.
    fn of_file(name: &str) -> Option<(Self, u64)> {
        let stem = name.rfind('.').unwrap_or(name.len());
        let end = name[..stem].rfind(|character: char| character.is_ascii_digit())? + 1;
        let start = name[..end]
            .rfind(|character: char| !character.is_ascii_digit())
            .map_or(0, |at| at + name[at..].chars().next().map_or(1, char::len_utf8));
        let number = name[start..end].parse().ok()?;
        Some((Self { before: name[..start].to_owned(), after: name[end..].to_owned() }, number))
    }

    /// Returns the number in a file name, or `None` if the name does not have this pattern.
    fn number(&self, name: &str) -> Option<u64> {
        let digits = name.strip_prefix(self.before.as_str())?.strip_suffix(self.after.as_str())?;
        let is_number = !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit());
        if is_number { digits.parse().ok() } else { None }
    }

    /// Returns the name with `#` in place of the number.
    fn name(&self) -> String {
        format!("{}#{}", self.before, self.after)
    }
}

/// Picture files of a sequence, each with its frame number. There is at least one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileSequence {
    name: String,
    frames: BTreeMap<u64, PathBuf>,
}

impl FileSequence {
    /// Returns whether a path names a sequence: an existing folder, or a file name in which `####` or `%04d` stands for
    /// a number, unless a file has just this name.
    pub fn is_named_by(path: &Path) -> bool {
        let pattern = path.file_name().and_then(OsStr::to_str).and_then(NamePattern::parse);
        path.is_dir() || (pattern.is_some() && !path.is_file())
    }

    /// Finds the pictures of a sequence: those whose names have the pattern, or those in a folder. The number in the
    /// name is the frame number. Pictures of a folder without numbers in their names are ordered by name and numbered
    /// from 0.
    ///
    /// # Errors
    /// Returns an error if the folder cannot be read, if there are no such pictures, or if a folder contains several
    /// sequences.
    pub fn find(path: &Path) -> Result<Self, ImageFileError> {
        if path.is_dir() {
            return Self::in_folder(path);
        }
        let none = || no_sequence(path, "no file has a name of this pattern");
        let name = path.file_name().and_then(OsStr::to_str).ok_or_else(none)?;
        let pattern = NamePattern::parse(name).ok_or_else(none)?;
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let names = files_in(path, folder)?.into_iter().filter_map(|file| Some(file.file_name()?.to_str()?.to_owned()));
        let numbered = names.filter_map(|name| Some((pattern.number(&name)?, path.with_file_name(&name))));
        let frames: BTreeMap<_, _> = numbered.collect();
        if frames.is_empty() { Err(none()) } else { Ok(Self { name: name.to_owned(), frames }) }
    }

    fn in_folder(folder: &Path) -> Result<Self, ImageFileError> {
        let pictures = pictures_in(folder)?;
        let mut patterns: BTreeMap<NamePattern, BTreeMap<u64, PathBuf>> = BTreeMap::new();
        for file in &pictures {
            let name = file.file_name().and_then(OsStr::to_str);
            if let Some((pattern, number)) = name.and_then(NamePattern::of_file) {
                patterns.entry(pattern).or_default().insert(number, file.clone());
            }
        }
        patterns.retain(|_, frames| frames.len() > 1);
        if patterns.len() > 1 {
            let names: Vec<_> = patterns.keys().map(|pattern| text::one_line(&pattern.name())).collect();
            let reason = format!("several sequences: {}; name one of them by its pattern", names.join(", "));
            return Err(no_sequence(folder, &reason));
        }
        let folder_name = text::path(Path::new(folder.file_name().unwrap_or(folder.as_os_str())));
        if let Some((pattern, frames)) = patterns.into_iter().next() {
            return Ok(Self { name: format!("{folder_name}/{}", text::one_line(&pattern.name())), frames });
        }
        Ok(Self { name: folder_name, frames: (0..).zip(pictures).collect() })
    }

    /// Returns the display name, such as `beauty.####.exr`.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns every frame number with its file, in ascending order.
    pub fn frames(&self) -> impl Iterator<Item = (u64, &Path)> {
        self.frames.iter().map(|(number, file)| (*number, file.as_path()))
    }

    /// Returns the first and the last frame number.
    pub fn range(&self) -> (u64, u64) {
        let first = self.frames.keys().next().copied().unwrap_or_default();
        (first, self.frames.keys().next_back().copied().unwrap_or(first))
    }

    /// Returns the file of a frame, or `None` if the sequence lacks it.
    pub fn file(&self, frame: u64) -> Option<&Path> {
        self.frames.get(&frame).map(PathBuf::as_path)
    }

    /// Returns the last frame up to `frame`, or the first one if `frame` lies before it.
    pub fn at_or_before(&self, frame: i64) -> (u64, &Path) {
        let before = u64::try_from(frame).ok().and_then(|frame| self.frames.range(..=frame).next_back());
        let (number, file) = before.or_else(|| self.frames.first_key_value()).expect("a sequence has a frame");
        (*number, file)
    }
}

fn no_sequence(path: &Path, reason: &str) -> ImageFileError {
    ImageFileError::NoSequence { path: path.to_owned(), reason: reason.to_owned() }
}

/// Returns the picture files in a folder, in the order of their names. There is at least one.
///
/// # Errors
/// Returns an error if the folder cannot be read or has no pictures.
pub fn pictures_in(folder: &Path) -> Result<Vec<PathBuf>, ImageFileError> {
    let mut pictures = files_in(folder, folder)?;
    pictures.retain(|file| is_named_picture(file));
    pictures.sort();
    if pictures.is_empty() { Err(no_sequence(folder, "the folder has no pictures")) } else { Ok(pictures) }
}

/// Returns the files in a folder. `named` is the path in messages.
fn files_in(named: &Path, folder: &Path) -> Result<Vec<PathBuf>, ImageFileError> {
    let unreadable = |source| ImageFileError::Unreadable { path: named.to_owned(), source };
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        if path.is_file() {
            files.push(path);
        }
        if files.len() > MAX_FRAMES {
            return Err(no_sequence(named, &format!("more than {MAX_FRAMES} files")));
        }
    }
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Creates a folder with empty files.
    fn folder(names: &[&str]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        names.iter().for_each(|name| fs::write(folder.path().join(name), "").unwrap());
        folder
    }

    fn numbers(sequence: &FileSequence) -> Vec<u64> {
        sequence.frames().map(|(number, _)| number).collect()
    }

    #[test]
    fn a_pattern_finds_files_with_a_number_in_place_of_the_mark() {
        let folder = folder(&["a.0001.png", "a.0002.png", "a.10.png", "a.x.png", "b.0001.png", "a.0003.exr"]);
        for pattern in ["a.####.png", "a.#.png", "a.%04d.png", "a.%d.png"] {
            let path = folder.path().join(pattern);
            assert!(FileSequence::is_named_by(&path));
            let sequence = FileSequence::find(&path).unwrap();
            assert_eq!(numbers(&sequence), [1, 2, 10], "{pattern}");
            assert_eq!(sequence.name(), pattern);
            assert_eq!(sequence.file(2), Some(folder.path().join("a.0002.png").as_path()));
        }
        let none = FileSequence::find(&folder.path().join("c.#.png")).unwrap_err().to_string();
        assert!(none.ends_with("c.#.png: no file has a name of this pattern"), "{none}");
    }

    #[test]
    fn the_numbered_pictures_of_a_folder_are_its_sequence() {
        let folder = folder(&["v2_frame7.png", "v2_frame08.png", "v2_frame9.png", "notes.txt", "cover.jpg"]);
        assert!(FileSequence::is_named_by(folder.path()));
        let sequence = FileSequence::find(folder.path()).unwrap();
        assert_eq!(numbers(&sequence), [7, 8, 9]);
        assert!(sequence.name().ends_with("/v2_frame#.png"), "{}", sequence.name());
    }

    #[test]
    fn pictures_without_numbers_are_numbered_by_name() {
        let folder = folder(&["chess.png", "armadillo.png", "readme.md"]);
        let sequence = FileSequence::find(folder.path()).unwrap();
        let names: Vec<_> = sequence.frames().map(|(number, file)| (number, file.file_name().unwrap())).collect();
        assert_eq!(names, [(0, OsStr::new("armadillo.png")), (1, OsStr::new("chess.png"))]);
    }

    #[test]
    fn a_folder_with_several_sequences_or_none_is_refused() {
        let several = folder(&["color.1.exr", "color.2.exr", "depth.1.exr", "depth.2.exr"]);
        let error = FileSequence::find(several.path()).unwrap_err().to_string();
        assert!(
            error.ends_with("several sequences: color.#.exr, depth.#.exr; name one of them by its pattern"),
            "{error}"
        );
        let error = FileSequence::find(folder(&["a.txt"]).path()).unwrap_err().to_string();
        assert!(error.ends_with("the folder has no pictures"), "{error}");
    }

    #[test]
    fn missing_frames_show_the_frame_before() {
        let folder = folder(&["5.png", "6.png", "9.png"]);
        let sequence = FileSequence::find(folder.path()).unwrap();
        let shown = [-3, 0, 5, 7, 9, 50].map(|frame| sequence.at_or_before(frame).0);
        assert_eq!(shown, [5, 5, 5, 6, 9, 9]);
        assert_eq!((sequence.range(), sequence.file(7)), ((5, 9), None));
    }

    #[test]
    fn an_existing_file_with_a_mark_in_its_name_is_no_sequence() {
        let folder = folder(&["#1.png"]);
        assert!(!FileSequence::is_named_by(&folder.path().join("#1.png")));
        assert!(!FileSequence::is_named_by(&folder.path().join("plain.png")));
    }
}
