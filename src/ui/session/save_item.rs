//! Items that the window can save, and the files that they are saved to.

use std::path::{Path, PathBuf};

use super::Session;
use crate::inspect::outline::OutlineKind;
use crate::inspect::project;
use crate::pipeline::settings::Choice as _;
use crate::report::animation::AnimationFormat;
use crate::ui::engine::Shown;

/// Content that the window can save to a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SaveItem {
    /// Picture on the canvas, as PNG.
    Picture,
    /// Exact values on the canvas, as PFM.
    Values,
    /// All buffers of the frame, as named channels of an OpenEXR file.
    Buffers,
    /// Explanation of the picked pixel, as an HTML page.
    Pixel,
    /// Vector drawing of the scene, in the format with this file name extension.
    Outline(OutlineKind, &'static str),
    /// Triangle visible at the picked pixel, as a case file.
    Case,
    /// Compared pictures with their errors, as an HTML page.
    Comparison,
    /// All frame times, as CSV.
    FrameTimes,
    /// Drawing of the current page of the 2D lab, in the format with this file name extension.
    LabDrawing(&'static str),
    /// All steps of the current page of the 2D lab, as an HTML page.
    LabRun,
    /// State of the window, as a project file.
    Project,
    /// Recorded camera path, as JSON.
    CameraPath,
    /// Compared methods over the frames of the scene, as an animated picture with this file name extension.
    Animation(AnimationFormat),
}

impl SaveItem {
    /// Items with an entry “Save … as…” in the menu “File” and in the palette.
    pub(crate) const LISTED: [Self; 12] = [
        Self::Project,
        Self::Picture,
        Self::Values,
        Self::Buffers,
        Self::Pixel,
        Self::Case,
        Self::Comparison,
        Self::FrameTimes,
        Self::LabRun,
        Self::CameraPath,
        Self::Animation(AnimationFormat::Gif),
        Self::Animation(AnimationFormat::Apng),
    ];

    /// Whether the item exists now. Items whose absence has a reason to report always count as present.
    pub(crate) fn is_offered(self, session: &Session) -> bool {
        match self {
            Self::Comparison => session.features.comparison.is_on(),
            Self::LabRun => session.features.lab.open,
            Self::CameraPath => !session.features.camera_path.keys.is_empty(),
            Self::Animation(_) => session.scene_frame_count().is_some(),
            Self::Picture
            | Self::Values
            | Self::Buffers
            | Self::Pixel
            | Self::Outline(..)
            | Self::LabDrawing(_)
            | Self::Case
            | Self::FrameTimes
            | Self::Project => true,
        }
    }

    /// Returns the display name, which continues “Save …”.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Picture => "picture",
            Self::Values => "exact values (PFM)",
            Self::Buffers => "all buffers (OpenEXR)",
            Self::Pixel => "explanation of the pixel (HTML)",
            Self::Outline(..) | Self::LabDrawing(_) => "drawing",
            Self::Case => "triangle as case file",
            Self::Comparison => "comparison (HTML)",
            Self::FrameTimes => "frame times (CSV)",
            Self::LabRun => "2D lab run (HTML)",
            Self::Project => "project",
            Self::CameraPath => "camera path (JSON)",
            Self::Animation(AnimationFormat::Gif) => "animation (GIF)",
            Self::Animation(AnimationFormat::Apng) => "animation (APNG)",
        }
    }

    /// Returns the file name extension, which names the format.
    pub(crate) fn extension(self) -> &'static str {
        match self {
            Self::Picture => "png",
            Self::Values => "pfm",
            Self::Buffers => "exr",
            Self::Outline(_, extension) | Self::LabDrawing(extension) => extension,
            Self::Case | Self::CameraPath => "json",
            Self::Animation(format) => format.id(),
            Self::Comparison | Self::Pixel | Self::LabRun => "html",
            Self::Project => project::EXTENSION,
            Self::FrameTimes => "csv",
        }
    }

    /// Returns the suggested file name without its extension.
    pub(crate) fn stem(self, session: &Session) -> &'static str {
        match self {
            Self::Picture => "picture",
            Self::Values => match session.shown {
                Shown::Buffer(buffer) => buffer.id(),
                Shown::Stage(stage) => stage.id(),
                Shown::Intermediate(number) => number.id(),
            },
            Self::Outline(kind, _) => kind.id(),
            Self::Project => "view",
            Self::Buffers => "buffers",
            Self::Pixel => "pixel",
            Self::Case => "triangle",
            Self::Comparison => "comparison",
            Self::CameraPath => "camera-path",
            Self::Animation(_) => "animation",
            Self::FrameTimes => "frame-times",
            Self::LabDrawing(_) | Self::LabRun => session.features.lab.page.id(),
        }
    }

    /// Returns the path for a typed name: relative to `folder`, with the extension of this item.
    pub(in crate::ui) fn path(self, typed: &str, folder: &Path) -> PathBuf {
        let path = folder.join(typed.trim());
        let has_extension = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(self.extension()));
        if has_extension {
            return path;
        }
        let mut name = path.into_os_string();
        name.push(".");
        name.push(self.extension());
        name.into()
    }
}

/// Place of a saved file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Destination {
    /// New file in the current folder: the first free one of `stem.extension`, `stem-2.extension` …
    Automatic,
    /// This file, which is replaced if it exists.
    File(PathBuf),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_get_the_extension_of_the_format() {
        let path = |typed: &str| SaveItem::Picture.path(typed, "/pictures".as_ref());
        assert_eq!(path(" a "), Path::new("/pictures/a.png"));
        assert_eq!(path("a.PNG"), Path::new("/pictures/a.PNG"));
        assert_eq!(path("b/a.jpg"), Path::new("/pictures/b/a.jpg.png"));
        assert_eq!(path("/elsewhere/a.png"), Path::new("/elsewhere/a.png"));
    }
}
