//! Export of the shown quantity as exact floating-point values.

use crate::inspect::planes::planes;
use crate::pipeline::settings::Choice as _;
use crate::ui::engine::{RenderedView, Shown};

/// Returns a file stem that names the shown quantity of a view, and a function that encodes its exact values as a file.
pub(crate) fn data(view: RenderedView) -> (&'static str, impl FnOnce() -> Result<Vec<u8>, String> + Send + 'static) {
    let stem = match view.request.shown {
        Shown::Buffer(buffer) => buffer.id(),
        Shown::Stage(stage) => stage.id(),
        Shown::Intermediate(number) => number.id(),
    };
    let encode = move || Ok(planes(view.picture.size(), |x, y| view.value(x, y)).encode());
    (stem, encode)
}
