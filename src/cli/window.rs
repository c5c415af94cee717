//! Opens the window, or falls back to a screenshot if there is no display.
//!
//! If the window was requested by name (`rasterscope window`), a failure to open it is an error. Without a command, the
//! program renders the workbench once to an image file instead, so that it shows something on any machine.

use std::path::Path;

use super::failure::Failure;
use super::output;
use super::screenshot;
pub(crate) use super::seen_args::WindowArgs;
use super::workbench::{self, WorkbenchArgs};

/// File name of the screenshot that is written if the program starts without a command and no window can be opened.
const FALLBACK_PICTURE: &str = "rasterscope.png";

/// Runs `window`: opens the window and returns when it is closed.
pub(crate) fn run(args: &WindowArgs) -> Result<(), Failure> {
    workbench::open(args.view()?, args).map_err(Failure::NoWindow)
}

/// Opens the window or, if no window can be opened, renders the workbench to an image file.
pub(crate) fn run_or_draw(args: &WindowArgs) -> Result<(), Failure> {
    let view = args.view()?;
    let Err(reason) = workbench::open(view.clone(), args) else { return Ok(()) };
    let look = WorkbenchArgs { at: args.at, ..WorkbenchArgs::default() };
    let image = workbench::draw(view, &look, args.seen.clone(), None)?;
    // Printed before the picture is written: if writing fails too, both reasons are reported.
    output::report("note", format!("{reason}; the workbench is rendered to {FALLBACK_PICTURE} instead"));
    screenshot::save(&image, Path::new(FALLBACK_PICTURE))
}
