//! Upscalers that are not built in: registered from Rust, and run as external processes by the program.
//!
//! The registry of a process never shrinks. Therefore these tests have a program of their own, and each registers its
//! own ids.

mod processes;
mod registered;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use tempfile::TempDir;

/// Returns the path of a file among the examples.
fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/examples").join(name)
}

/// Runs the program in a folder, with settings of its own.
fn run(folder: &TempDir, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rasterscope"));
    command.current_dir(folder.path()).env("HOME", folder.path()).env("XDG_DATA_HOME", folder.path());
    command.args(arguments).output().expect("the program starts")
}

/// Returns the lines on standard error.
fn errors(output: &Output) -> Vec<String> {
    String::from_utf8_lossy(&output.stderr).lines().map(str::to_owned).collect()
}
