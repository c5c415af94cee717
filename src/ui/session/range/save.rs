//! Export of the shown quantity as exact floating-point values.

use crate::inspect::planes::planes;
use crate::ui::engine::RenderedView;

/// Returns the exact values of the shown quantity as a PFM file.
pub(crate) fn encoded(view: &RenderedView) -> Vec<u8> {
    planes(view.picture.size(), |x, y| view.value(x, y)).encode()
}
