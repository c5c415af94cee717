//! The totals of all overlays as a file.

use std::path::PathBuf;

use crate::inspect::overlays::csv;
use crate::ui::app::free_name;
use crate::ui::session::Session;

/// What writes the totals of what is on screen into the current folder.
pub fn totals(session: &Session) -> impl FnOnce() -> Result<PathBuf, String> + Send + 'static {
    let sheets = session.view.as_ref().map(|view| view.looked.sheets.clone()).unwrap_or_default();
    let path = free_name(&session.folder, "overlays", "csv");
    move || {
        let table = csv(sheets.iter().map(AsRef::as_ref));
        std::fs::write(&path, table).map(|()| path.clone()).map_err(|error| format!("{}: {error}", path.display()))
    }
}
