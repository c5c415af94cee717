//! What passes of the window cost, as plain data.

use serde::Serialize;

use super::timing::Summary;

/// What passes of the window cost while it shows one thing. No graphics card has a part in it, nor has the drawing of the
/// picture.
#[derive(Clone, Debug, Serialize)]
pub struct WindowCost {
    /// What is open.
    pub what: String,
    /// Panels, text and input, ms.
    pub layout_ms: Summary,
    /// Shapes into triangles, ms.
    pub tessellation_ms: Summary,
    /// Both, ms.
    pub whole_ms: Summary,
    /// Corners of all triangles of the last pass.
    pub vertices: usize,
    /// Bytes of textures that a pass hands to the graphics card, the most of all passes.
    pub texture_bytes: usize,
}
