//! The shown quantity as a file of exact floats.

use std::path::Path;

use crate::image::pfm::write_pfm;
use crate::inspect::planes::planes;
use crate::pipeline::settings::Choice as _;
use crate::ui::engine::{Shown, View};

/// The name of what a view shows, and what writes its exact values.
pub fn data(view: View) -> (&'static str, impl FnOnce(&Path) -> Result<(), String> + Send + 'static) {
    let stem = match view.request.shown {
        Shown::Buffer(buffer) => buffer.id(),
        Shown::Stage(stage) => stage.id(),
        Shown::Intermediate(number) => number.id(),
    };
    let write = move |path: &Path| {
        let floats = planes(view.picture.size(), |x, y| view.value(x, y));
        write_pfm(path, &floats).map_err(|error| error.to_string())
    };
    (stem, write)
}
