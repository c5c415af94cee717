//! The shown quantity as a file of exact floats.

use std::path::PathBuf;

use crate::image::pfm::write_pfm;
use crate::inspect::planes::planes;
use crate::pipeline::settings::Choice as _;
use crate::ui::app::free_name;
use crate::ui::engine::Shown;
use crate::ui::session::Session;

/// What writes the exact values of what is on screen into the current folder.
pub fn data(session: &Session) -> impl FnOnce() -> Result<PathBuf, String> + Send + 'static {
    let stem = match session.shown {
        Shown::Buffer(buffer) => buffer.id(),
        Shown::Stage(stage) => stage.id(),
        Shown::Intermediate(number) => number.id(),
    };
    let (view, path) = (session.view.clone(), free_name(&session.folder, stem, "pfm"));
    move || {
        let view = view.ok_or("Nothing is drawn yet")?;
        let floats = planes(view.picture.size(), |x, y| view.value(x, y));
        write_pfm(&path, &floats).map(|()| path).map_err(|error| error.to_string())
    }
}
