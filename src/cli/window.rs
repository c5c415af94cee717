//! The window, and what happens where there can be none.
//!
//! Asked for by name (`rasterscope window`), a window that cannot open is an error. Started plainly, the program has
//! something to show on any machine: the whole workbench is drawn once into a picture instead.

use std::path::Path;

use super::failure::Failure;
#[cfg(feature = "ui")]
use super::open::open;
use super::output;
use super::scene_args::{SceneArgs, View};
use super::screenshot::{self, Look};

/// What a plain start leaves behind where no window can open.
const FALLBACK_PICTURE: &str = "rasterscope.png";

/// Opens the window and returns when it is closed.
pub(crate) fn run(args: &SceneArgs) -> Result<(), Failure> {
    open(args.view()?).map_err(Failure::NoWindow)
}

/// Opens the window; draws the workbench into a picture where there can be none.
pub(crate) fn run_or_draw(args: &SceneArgs) -> Result<(), Failure> {
    let view = args.view()?;
    let Err(reason) = open(view.clone()) else { return Ok(()) };
    if cfg!(not(feature = "ui")) {
        return Err(Failure::NoWindow(reason));
    }
    output::complain("note", format!("{reason}; the workbench is drawn into {FALLBACK_PICTURE} instead"));
    screenshot::draw(view, &Look::default(), Path::new(FALLBACK_PICTURE))
}

#[cfg(not(feature = "ui"))]
pub(super) const BUILT_WITHOUT: &str = "this program was built without its window (feature `ui`); \
    the commands render, pixel and scenes work";

#[cfg(not(feature = "ui"))]
fn open(_view: View) -> Result<(), String> {
    Err(BUILT_WITHOUT.to_owned())
}
