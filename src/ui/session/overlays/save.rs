//! Export of the totals of all overlays.

use crate::inspect::overlays::csv;
use crate::ui::session::Session;

/// Returns an encoder that writes the totals of the frame on screen as CSV.
pub(crate) fn totals(session: &Session) -> impl FnOnce() -> Result<Vec<u8>, String> + Send + 'static {
    let sheets = session.view.as_ref().map(|view| view.look_result.sheets.clone()).unwrap_or_default();
    move || Ok(csv(sheets.iter().map(AsRef::as_ref)).into_bytes())
}
