//! Request for a view: everything that determines what the canvas shows.

use std::sync::Arc;

use crate::chain::Recipe;
use crate::inspect::buffers::Buffer;
use crate::inspect::display::Display;
use crate::inspect::overlays::OverlayLayer;
use crate::inspect::scrub::Moment;
use crate::inspect::view::Range;
use crate::inspect::{Intermediate, Stage};
use crate::measure::region::PixelRegion;
use crate::measure::shot::{ShotFrame, ShotInputs};
use crate::pipeline::settings::Choice as _;
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, Scene};

/// Quantity of a frame that the canvas shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shown {
    /// A buffer of the finished frame.
    Buffer(Buffer),
    /// The picture after a pipeline stage.
    Stage(Stage),
    /// An intermediate value that the pipeline computes between triangle setup and final colour.
    Intermediate(Intermediate),
}

impl Shown {
    /// Returns the display name of the shown buffer, stage or intermediate value.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Buffer(buffer) => buffer.name(),
            Self::Stage(stage) => stage.name(),
            Self::Intermediate(intermediate) => intermediate.name(),
        }
    }

    /// Returns the source of the shown values: the buffer that holds the result of a shown stage if there is one,
    /// otherwise `self`.
    pub(crate) fn source(self) -> Self {
        match self {
            Self::Stage(stage) => stage.buffer().map_or(self, Self::Buffer),
            Self::Buffer(_) | Self::Intermediate(_) => self,
        }
    }

    /// Returns a description of the shown buffer, stage or intermediate value, in one sentence.
    pub(crate) fn help(self) -> &'static str {
        match self {
            Self::Buffer(buffer) => buffer.help(),
            Self::Stage(stage) => stage.help(),
            Self::Intermediate(intermediate) => intermediate.help(),
        }
    }
}

/// Display settings of the shown quantity, its overlays, and the statistics to compute.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Look {
    /// Range, colour map and channels of the shown quantity.
    pub(crate) display: Display,
    /// Statistics to compute; `None` to compute none.
    pub(crate) statistics: Option<StatisticsRequest>,
    /// Overlays, from bottom to top.
    pub(crate) layers: Vec<OverlayLayer>,
    /// Whether line overlays are omitted from the picture because they are drawn as vectors over enlarged pixels.
    pub(crate) vectors: bool,
}

impl Look {
    /// Whether `self` and `other` have the same overlays.
    pub(super) fn has_same_layers(&self, other: &Self) -> bool {
        (&self.layers, self.vectors) == (&other.layers, other.vectors)
    }
}

/// Request for statistics of the shown quantity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct StatisticsRequest {
    /// Value range of the histograms' horizontal axis; `None` means the range of all values.
    pub(crate) axis: Option<Range>,
    /// Region for which separate statistics are computed.
    pub(crate) region: Option<PixelRegion>,
}

/// Everything that determines the view on the canvas.
#[derive(Clone, Debug)]
pub(crate) struct Request {
    /// Scene to draw. Two requests have the same scene if the pointers are equal.
    pub(crate) scene: Arc<Scene>,
    /// Camera that views the scene.
    pub(crate) camera: Camera,
    /// Recipe to draw with.
    pub(crate) recipe: Recipe,
    /// Frame of the motion of scene and camera; `None` if nothing moves.
    pub(crate) sequence: Option<ShotFrame>,
    /// Whether the history of a frame of a sequence should be that of all frames from frame 0 on. Otherwise, it is that of
    /// the frames drawn before, and converges if the view stays the same.
    pub(crate) is_replayed: bool,
    /// Size of the picture, in pixels.
    pub(crate) viewport: Viewport,
    /// Quantity to show on the canvas.
    pub(crate) shown: Shown,
    /// Number of rasterized triangles to draw; `None` to draw all.
    pub(crate) triangle_limit: Option<usize>,
    /// If `triangle_limit` is set, number of fragments to draw of the last drawn triangle; `None` to draw all of them.
    pub(crate) fragment_limit: Option<usize>,
    /// Column and row of the picked pixel; `None` if no pixel is picked.
    pub(crate) pick: Option<(u32, u32)>,
    /// Value range, colour map and overlays of the picture.
    pub(crate) look: Look,
}

impl Request {
    /// Whether both requests have the same response.
    pub(crate) fn same_view(&self, other: &Self) -> bool {
        self.same_frame(other) && self.shown == other.shown && self.pick == other.pick && self.look == other.look
    }

    /// Whether the canvas shows the same picture for both requests, regardless of the picked pixel.
    pub(crate) fn same_picture(&self, other: &Self) -> bool {
        self.same_frame(other) && self.shown == other.shown && self.look == other.look
    }

    /// Whether both requests render the same frame with the same triangle and fragment limits.
    pub(crate) fn same_frame(&self, other: &Self) -> bool {
        self.same_complete_frame(other) && self.moment() == other.moment()
    }

    /// Returns the point at which drawing of the frame stops; `None` for the finished frame.
    pub(crate) fn moment(&self) -> Option<Moment> {
        self.triangle_limit.map(|triangles| Moment { triangles, fragments: self.fragment_limit })
    }

    /// Whether the response depends on the open seams of the scene, where adjacent surfaces share no vertices.
    pub(super) fn reads_seams(&self) -> bool {
        let has_layer = self.look.layers.iter().any(|layer| layer.overlay.reads_seams());
        self.shown == Shown::Buffer(Buffer::Hits) || self.pick.is_some() || has_layer
    }

    /// Whether both requests render the same frame if their triangle and fragment limits are ignored.
    pub(crate) fn same_complete_frame(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.scene, &other.scene)
            && self.camera == other.camera
            && self.recipe == other.recipe
            && self.viewport == other.viewport
            && self.has_same_sequence(other)
    }

    fn has_same_sequence(&self, other: &Self) -> bool {
        match (&self.sequence, &other.sequence) {
            (Some(frame), Some(other)) => frame.is_same(other),
            (frame, other) => frame.is_none() && other.is_none(),
        }
    }

    /// Returns the number of the frame if its history is that of all frames from frame 0 on. Returns `None` for partially
    /// drawn frames, for times between frames, and if the frame has no history.
    pub(crate) fn replayed_frame(&self) -> Option<u32> {
        let frame = self.sequence.as_ref().filter(|_| self.is_replayed && self.moment().is_none())?;
        frame.number_with_history(&self.recipe).filter(|_| frame.shows(&self.scene, &self.camera))
    }

    /// Returns the inputs of all frames of the sequence; `None` if nothing moves.
    pub(crate) fn shot_inputs(&self) -> Option<ShotInputs> {
        let shot = self.sequence.as_ref()?.shot.clone();
        Some(ShotInputs { shot, recipe: self.recipe, viewport: self.viewport })
    }
}
