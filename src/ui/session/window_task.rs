//! Tasks that the session leaves to the window, because they need files, threads, dialogs or the toolkit.

use super::file_command::FileCommand;
use super::picture_role::PictureRole;
use super::save_item::SaveItem;
use super::workspace::{Panel, WorkspaceChange};
use crate::case::MinimalCase;
use crate::inspect::find::SearchTarget;
use crate::manual::Chapter;

/// Task that the window completes after the session has applied a command.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum WindowTask {
    /// Reads or writes a file, or copies to the clipboard.
    File(FileCommand),
    /// Saves an item under a new name in the current folder.
    Save(SaveItem),
    /// Saves a case under a new name in the current folder.
    SaveCase(Box<MinimalCase>),
    /// Saves the totals of all overlays.
    SaveOverlayTotals,
    /// Starts or cancels a measurement.
    Measure(MeasureTask),
    /// Stops drawing the frames before the shown one.
    CancelReplay,
    /// Prevents measurements of the current view from starting by themselves.
    DeclineMeasurement,
    /// Starts the stability probe.
    StartProbe,
    /// Opens a dialog or the manual.
    Dialog(DialogCommand),
    /// Searches the frame on screen for a target.
    Search(SearchTarget),
    /// Copies text to the clipboard.
    CopyText(String),
    /// Switches between the dark and the light theme.
    ToggleTheme,
    /// Sets the scale of the whole interface; 1 is the default.
    SetScale(f32),
    /// Shows a workspace or a panel, or changes the layout.
    Workspace(WorkspaceChange),
    /// Shows a panel.
    ShowPanel(Panel),
    /// Fits the picture into the canvas.
    Fit,
    /// Shows one picture pixel per screen pixel.
    OneToOne,
    /// Shows the pixel at this column and row in the middle of the canvas, at this zoom in percent.
    ShowAt(u32, u32, u32),
    /// Scrolls and zooms to a pixel, unless it is visible and large enough.
    BringIntoView((u32, u32)),
    /// Scrolls as far as necessary to make a pixel visible.
    KeepInView((u32, u32)),
    /// Closes the manual, or otherwise applies [`Session::escape`](super::Session::escape).
    Escape,
}

/// Measurement that the window starts or cancels, because it needs threads or the worker.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MeasureTask {
    /// Measures time and error of every upscaler.
    Upscalers,
    /// Cancels the measurement of the upscalers.
    CancelUpscalers,
    /// Runs the stability report.
    Stability,
    /// Measures how much frame time the current view saves by skipped work.
    Plan,
    /// Measures how the frame time scales.
    Scaling,
}

/// Command that opens a dialog or the manual.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum DialogCommand {
    /// Shows the dialog for opening a model or a case.
    Open,
    /// Shows the dialog for opening a picture file in a comparison.
    OpenPicture(PictureRole),
    /// Shows the dialog for going to a pixel, triangle, vertex or object.
    GoTo,
    /// Shows the key sheet.
    Keys,
    /// Opens the command palette.
    Palette,
    /// Opens the dialog for renaming and deleting bookmarks.
    Bookmarks,
    /// Opens the dialog for adding an upscaler process.
    AddUpscaler,
    /// Opens the manual at a chapter; `None` focuses its search field.
    Manual(Option<Chapter>),
}
