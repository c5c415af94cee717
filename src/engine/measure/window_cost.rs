//! CPU cost of drawing the window's interface, as plain data.

use serde::Serialize;

use super::timing::Summary;

/// CPU cost of drawing the user interface while the window shows one view. Excludes GPU work and the rendering of the
/// picture.
#[derive(Clone, Debug, Serialize)]
pub struct WindowCost {
    /// Description of the view that the window shows.
    pub what: String,
    /// Time to lay out panels and text and to handle input, in milliseconds.
    pub layout_ms: Summary,
    /// Time to tessellate shapes into triangles, in milliseconds.
    pub tessellation_ms: Summary,
    /// Sum of layout and tessellation times of a pass, in milliseconds.
    pub whole_ms: Summary,
    /// Number of vertices of all triangles in the last pass.
    pub vertices: usize,
    /// Largest number of texture bytes that a pass uploads to the graphics card.
    pub texture_bytes: usize,
}
