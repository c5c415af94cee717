//! Commands that read and write files.

use std::path::PathBuf;

use super::picture_role::PictureRole;
use super::save_item::SaveItem;
use crate::inspect::lesson::BlackPixelLesson;
use crate::inspect::outline::OutlineKind;
use crate::scene::obj::TrMeaning;

/// Command that reads or writes files, or copies to the clipboard.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum FileCommand {
    /// Opens a model, case or picture file.
    Open(PathBuf),
    /// Opens a picture file in a comparison.
    OpenPicture(PictureRole, PathBuf),
    /// Reloads a model with another interpretation of `Tr` in its MTL files.
    Reopen(PathBuf, TrMeaning),
    /// Opens a built-in scene by id.
    OpenBuiltin(String),
    /// Opens the scene of a lesson with its settings, and picks its black spot.
    OpenLesson(&'static BlackPixelLesson),
    /// Cancels loading a model or case.
    CancelLoading,
    /// Cancels all running exports.
    CancelExport,
    /// Asks for a path, and saves this item there.
    SaveAs(SaveItem),
    /// Saves an item at this path, and replaces an existing file.
    SaveTo(SaveItem, PathBuf),
    /// Opens the folder of a saved file with the desktop's file manager.
    OpenFolder(PathBuf),
    /// Opens a web address in the browser.
    OpenAddress(String),
    /// Saves the triangle visible at the picked pixel as a minimal case.
    SaveCase,
    /// Saves the picture on the canvas as PNG.
    SavePicture,
    /// Saves the compared pictures and their errors as an HTML page.
    SaveComparison,
    /// Saves the exact values on the canvas as floats (PFM).
    SaveData,
    /// Saves the scene as a vector drawing, in the format with this file name extension.
    SaveOutline(OutlineKind, &'static str),
    /// Copies the picture to the clipboard.
    CopyPicture,
}
