//! CPU cost of drawing the window's interface, as plain data.

use serde::Serialize;

use super::timing::Summary;

/// CPU cost of interface passes while the window shows one view. Excludes the graphics card and rendering of the image.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct WindowCost {
    /// Description of what the window shows.
    pub(crate) what: String,
    /// Layout of panels, text and input, in milliseconds.
    pub(crate) layout_ms: Summary,
    /// Tessellation of shapes into triangles, in milliseconds.
    pub(crate) tessellation_ms: Summary,
    /// Layout plus tessellation, in milliseconds.
    pub(crate) whole_ms: Summary,
    /// Number of vertices of all triangles in the last pass.
    pub(crate) vertices: usize,
    /// Largest number of texture bytes that a pass uploads to the graphics card.
    pub(crate) texture_bytes: usize,
}
