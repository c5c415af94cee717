//! CPU cost of the window as plain data: of drawing its interface, and of answering its requests.

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

/// Time from a request of the window to the finished picture and the explanation of the picked pixel, while the camera
/// moves.
#[derive(Clone, Debug, Serialize)]
pub struct AnswerTime {
    /// Width and height of the picture, in pixels.
    pub size: [u32; 2],
    /// Column and row of the picked pixel.
    pub pick: [u32; 2],
    /// Number of timed answers that explain the pixel.
    pub explained: usize,
    /// Time per answer, in milliseconds.
    pub answer_ms: Summary,
}
