//! Request to compare several pictures of one view.

use std::sync::Arc;

use super::files::ComparedFiles;
use crate::chain::Recipe;
use crate::measure::difference::Difference;
use crate::measure::reference::Reference;
use crate::measure::region::PixelRegion;
use crate::measure::shot::{ShotFrame, ShotInputs};
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, Scene};

/// Request to compare several pictures of one view.
#[derive(Clone, Debug)]
pub struct CompareRequest {
    /// Scene to draw. Two requests have the same scene if the pointers are equal.
    pub scene: Arc<Scene>,
    /// Camera shared by all pictures.
    pub camera: Camera,
    /// Frame of the motion of scene and camera, with the history of all frames from frame 0 on; `None` for a still view.
    pub sequence: Option<ShotFrame>,
    /// Size of every picture, in pixels.
    pub viewport: Viewport,
    /// Recipe of each picture.
    pub recipes: Vec<Recipe>,
    /// Pictures from files, in place of drawn ones.
    pub files: ComparedFiles,
    /// Reference that errors are measured against.
    pub reference: Reference,
    /// Region whose error metrics are measured in addition to those of the whole picture.
    pub region: Option<PixelRegion>,
    /// Kind and gain of the difference image of the first two pictures; `None` if not shown.
    pub difference: Option<(Difference, u32)>,
}

impl CompareRequest {
    /// Replaces the last request by a new one. Returns whether their results differ.
    pub(crate) fn replace(last: &mut Option<Self>, new: Option<&Self>) -> bool {
        let is_same = match (&*last, new) {
            (Some(last), Some(new)) => last.same_as(new),
            (last, new) => last.is_none() && new.is_none(),
        };
        if !is_same {
            *last = new.cloned();
        }
        !is_same
    }

    fn same_as(&self, other: &Self) -> bool {
        self.same_view(other)
            && self.recipes == other.recipes
            && self.files.has_same_tiles(&other.files)
            && self.has_same_reference(other)
            && self.region == other.region
            && self.difference == other.difference
    }

    pub(super) fn has_same_reference(&self, other: &Self) -> bool {
        self.reference == other.reference && self.files.has_same_reference(&other.files)
    }

    pub(super) fn same_view(&self, other: &Self) -> bool {
        let has_same_frame = match (&self.sequence, &other.sequence) {
            (Some(frame), Some(other)) => frame.is_same(other),
            (frame, other) => frame.is_none() && other.is_none(),
        };
        has_same_frame
            && Arc::ptr_eq(&self.scene, &other.scene)
            && self.camera == other.camera
            && self.viewport == other.viewport
    }

    /// Returns the inputs of all frames and the number of the requested one, if it has the history of a motion with this
    /// recipe.
    pub(super) fn moving(&self, recipe: &Recipe) -> Option<(ShotInputs, u32)> {
        let frame = self.sequence.as_ref().filter(|frame| frame.shows(&self.scene, &self.camera))?;
        let inputs = ShotInputs { shot: frame.shot.clone(), recipe: *recipe, viewport: self.viewport };
        Some((inputs, frame.number_with_history(recipe)?))
    }
}
