//! Writes results to standard output, and warnings and errors to standard error, one line each.

use std::fmt::Display;
use std::io::{self, ErrorKind, Write as _, stderr, stdout};
use std::path::Path;

use crate::{disk, text};
use serde::Serialize;

use super::failure::Failure;

/// Writes a result to standard output. A closed pipe (`| head`) is not an error.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    print_by(|out| out.write_all(text.as_bytes()))
}

/// Writes a result to standard output piece by piece. A closed pipe (`| head`) is not an error.
pub(crate) fn print_by(produce: impl FnOnce(&mut dyn io::Write) -> io::Result<()>) -> Result<(), Failure> {
    let mut out = stdout().lock();
    match produce(&mut out).and_then(|()| out.flush()) {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => Err(Failure::Output(e)),
        _ => Ok(()),
    }
}

/// Serializes a result as indented JSON with a final newline.
pub(crate) fn json(result: &impl Serialize) -> Result<String, Failure> {
    Ok(serde_json::to_string_pretty(result).map_err(|e| Failure::Output(e.into()))? + "\n")
}

/// Writes a result to standard output as JSON.
pub(crate) fn print_json(result: &impl Serialize) -> Result<(), Failure> {
    print(&json(result)?)
}

/// Writes a warning or an error as one line to standard error. Failures to write it are ignored.
pub(crate) fn report(kind: &str, text: impl Display) {
    let _ = writeln!(stderr(), "{kind}: {}", text::one_line(&text.to_string()));
}

/// Formats a path for display within one line of text.
pub(crate) fn display(path: &Path) -> String {
    text::path(path)
}

/// Returns the command line of this process for a POSIX shell.
pub(crate) fn command_line() -> String {
    let arguments = std::env::args_os().skip(1).map(|argument| argument.to_string_lossy().into_owned());
    text::shell_line(&std::iter::once("rasterscope".to_owned()).chain(arguments).collect::<Vec<_>>())
}

/// Returns whether the suffix of an output file requests an HTML page.
pub(crate) fn is_html(path: &Path) -> bool {
    path.extension().is_some_and(|suffix| suffix.eq_ignore_ascii_case("html") || suffix.eq_ignore_ascii_case("htm"))
}

/// Writes an HTML page atomically, unless its pictures could not be encoded.
pub(crate) fn write_page(path: &Path, html: io::Result<String>) -> Result<(), Failure> {
    write(path, &html.map_err(|source| Failure::ResultFile { path: path.to_owned(), source })?)
}

/// Writes a text file atomically.
pub(crate) fn write(path: &Path, text: &str) -> Result<(), Failure> {
    write_bytes(path, text.as_bytes())
}

/// Writes a file atomically.
pub(crate) fn write_bytes(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    disk::write(path, bytes).map_err(|source| Failure::ResultFile { path: path.to_owned(), source })
}

/// Writes a file atomically and piece by piece, without holding all of it in memory.
pub(crate) fn write_by(path: &Path, produce: impl FnOnce(&mut dyn io::Write) -> io::Result<()>) -> Result<(), Failure> {
    disk::write_by(path, produce).map_err(|source| Failure::ResultFile { path: path.to_owned(), source })
}

/// Checks that a result file is writable, before a long measurement.
pub(crate) fn check_writable(path: &Path) -> Result<(), Failure> {
    disk::check_writable(path).map_err(|source| Failure::ResultFile { path: path.to_owned(), source })
}

/// Creates the folder of a report if it is missing, and checks that the files in it are writable.
pub(crate) fn prepare_folder(folder: &Path, names: &[&str]) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(|source| Failure::ResultFile { path: folder.to_owned(), source })?;
    names.iter().try_for_each(|name| check_writable(&folder.join(name)))
}
