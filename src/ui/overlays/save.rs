//! The totals of all overlays as a file.

use std::path::Path;

use crate::inspect::overlays::csv;
use crate::ui::app::write_text;
use crate::ui::session::Session;

/// What writes the totals of what is on screen.
pub fn totals(session: &Session) -> impl FnOnce(&Path) -> Result<(), String> + Send + 'static {
    let sheets = session.view.as_ref().map(|view| view.looked.sheets.clone()).unwrap_or_default();
    move |path| write_text(path, &csv(sheets.iter().map(AsRef::as_ref)))
}
