//! State of the canvas that other parts of the window use: its size and pointer mode.

use super::feature::Feature;
use super::window_task::WindowTask;
use super::{PointerMode, Session};

/// Size and pointer mode of the canvas.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct CanvasState {
    /// Size of the canvas in screen pixels, including the legend strip below it, as of the last frame.
    pub(crate) size_px: (u32, u32),
    /// Pointer mode of the canvas.
    pub(crate) pointer_mode: PointerMode,
}

/// Change to the canvas.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CanvasChange {
    /// Fits the picture into the canvas.
    Fit,
    /// Shows the picture at 1:1: one picture pixel per screen pixel.
    OneToOne,
    /// Sets the pointer mode.
    PointerMode(PointerMode),
    /// Sets the pointer mode, or returns to the default mode if this one is already on.
    TogglePointerMode(PointerMode),
}

impl Feature for CanvasState {
    type Change = CanvasChange;

    fn apply(session: &mut Session, change: CanvasChange) -> Option<WindowTask> {
        let mode = &mut session.features.canvas.pointer_mode;
        match change {
            CanvasChange::Fit => return Some(WindowTask::Fit),
            CanvasChange::OneToOne => return Some(WindowTask::OneToOne),
            CanvasChange::PointerMode(wanted) => *mode = wanted,
            CanvasChange::TogglePointerMode(wanted) => *mode = mode.toggled(wanted),
        }
        None
    }

    fn leave_scene(&mut self) {}
}
