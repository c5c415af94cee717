//! Results to standard output, warnings and errors to standard error, one line each.

use std::fmt::Display;
use std::io::{ErrorKind, Write as _, stderr, stdout};
use std::path::Path;

use serde::Serialize;

use super::failure::Failure;

/// Writes results. A reader that has gone away (`| head`) has what it wanted and is no failure.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut out = stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => Err(Failure::Output(e)),
        _ => Ok(()),
    }
}

/// A result as JSON, laid out for people and with a line's end after it.
pub(crate) fn json(result: &impl Serialize) -> Result<String, Failure> {
    Ok(serde_json::to_string_pretty(result).map_err(|e| Failure::Output(e.into()))? + "\n")
}

/// Writes a result as JSON.
pub(crate) fn print_json(result: &impl Serialize) -> Result<(), Failure> {
    print(&json(result)?)
}

/// Writes one line about something wrong. Where even that cannot be written there is nobody left to tell.
pub(crate) fn complain(kind: &str, text: impl Display) {
    let _ = writeln!(stderr(), "{kind}: {}", one_line(&text.to_string()));
}

/// A path within a line of text.
pub(crate) fn display(path: &Path) -> String {
    one_line(&path.display().to_string())
}

/// `text` without line breaks and other control characters, which names of files may bring in.
fn one_line(text: &str) -> String {
    let visible: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    visible.split_whitespace().collect::<Vec<_>>().join(" ")
}
