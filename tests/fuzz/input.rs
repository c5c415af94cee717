//! Inputs of fuzz targets, which are a few small files that are written to a folder, read back, and minimised.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;
use std::{fs, io};

/// File beside a saved input that states how to reproduce the failure; never part of the input.
pub(crate) const NOTES: &str = "reproduce.txt";

/// Input of one execution: files by name.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Input(pub(crate) BTreeMap<String, Vec<u8>>);

impl Input {
    /// Returns an input of one file.
    pub(crate) fn file(name: &str, bytes: impl Into<Vec<u8>>) -> Self {
        Self::default().with(name, bytes)
    }

    /// Returns the input with a further file.
    pub(crate) fn with(mut self, name: &str, bytes: impl Into<Vec<u8>>) -> Self {
        self.0.insert(name.to_owned(), bytes.into());
        self
    }

    /// Returns the size of all files, in bytes.
    pub(crate) fn size(&self) -> usize {
        self.0.values().map(Vec::len).sum()
    }

    /// Writes the files into `folder`. Creates the folder, or removes its previous contents.
    pub(crate) fn write(&self, folder: &Path) -> io::Result<()> {
        if folder.exists() {
            fs::remove_dir_all(folder)?;
        }
        fs::create_dir_all(folder)?;
        self.0.iter().try_for_each(|(name, bytes)| fs::write(folder.join(name), bytes))
    }

    /// Reads the files of a folder, except [`NOTES`].
    pub(crate) fn read(folder: &Path) -> io::Result<Self> {
        let mut input = Self::default();
        for entry in fs::read_dir(folder)? {
            let path = entry?.path();
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            if path.is_file() && name != NOTES {
                input = input.with(&name, fs::read(path)?);
            }
        }
        Ok(input)
    }
}

/// Returns the input without files, lines and bytes that are not needed for the failure. Stops when nothing more can be
/// removed, or at the deadline.
pub(crate) fn minimise(mut input: Input, deadline: Instant, mut fails: impl FnMut(&Input) -> bool) -> Input {
    loop {
        let before = input.clone();
        for name in before.0.keys() {
            let mut without = input.clone();
            without.0.remove(name);
            if Instant::now() < deadline && fails(&without) {
                input = without;
            }
        }
        let names: Vec<_> = input.0.keys().cloned().collect();
        for split in [lines, single_bytes] {
            for name in &names {
                let mut candidate = input.clone();
                let parts = split(&input.0[name]);
                let least = shrink(parts, deadline, |parts| {
                    candidate.0.insert(name.clone(), parts.concat());
                    fails(&candidate)
                });
                input.0.insert(name.clone(), least.concat());
            }
        }
        if input == before || Instant::now() >= deadline {
            return input;
        }
    }
}

fn lines(bytes: &[u8]) -> Vec<&[u8]> {
    bytes.split_inclusive(|byte| *byte == b'\n').collect()
}

fn single_bytes(bytes: &[u8]) -> Vec<&[u8]> {
    bytes.chunks(1).collect()
}

/// Returns the parts without runs that are not needed for the failure, trying halves first and single parts last.
fn shrink<'a>(
    mut parts: Vec<&'a [u8]>,
    deadline: Instant,
    mut fails: impl FnMut(&[&'a [u8]]) -> bool,
) -> Vec<&'a [u8]> {
    let mut length = parts.len().div_ceil(2);
    while length > 0 {
        let mut at = 0;
        while at < parts.len() {
            if Instant::now() >= deadline {
                return parts;
            }
            let end = (at + length).min(parts.len());
            let rest = [&parts[..at], &parts[end..]].concat();
            if fails(&rest) {
                parts = rest;
            } else {
                at = end;
            }
        }
        length = if length == 1 { 0 } else { length.div_ceil(2) };
    }
    parts
}
