//! The window, and what happens where there can be none.
//!
//! Asked for by name (`rasterscope window`), a window that cannot open is an error. Started plainly, the program has
//! something to show on any machine: the whole workbench is drawn once into a picture instead.

use std::path::Path;

use super::failure::Failure;
use super::screenshot::{self, Look};
use super::seen_args::WindowArgs;
use super::{output, workbench};

/// What a plain start leaves behind where no window can open.
const FALLBACK_PICTURE: &str = "rasterscope.png";

/// Opens the window and returns when it is closed.
pub(crate) fn run(args: &WindowArgs) -> Result<(), Failure> {
    workbench::open(args.view()?, args).map_err(Failure::NoWindow)
}

/// Opens the window; draws the workbench into a picture where there can be none.
pub(crate) fn run_or_draw(args: &WindowArgs) -> Result<(), Failure> {
    let view = args.view()?;
    let Err(reason) = workbench::open(view.clone(), args) else { return Ok(()) };
    let look = Look { at: args.at, ..Look::default() };
    let image = workbench::draw(view, &look, args.seen.clone(), None)?;
    // Said before the picture is written: should that fail too, both reasons are told.
    output::complain("note", format!("{reason}; the workbench is drawn into {FALLBACK_PICTURE} instead"));
    screenshot::save(&image, Path::new(FALLBACK_PICTURE))
}
