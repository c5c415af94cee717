//! Partially drawn frames: renderer state that is cached while the user scrubs through the drawing of one frame.

use std::sync::Arc;

use crate::chain::{Frame, run_unobserved};
use crate::inspect::scrub::{BUDGET, Moment, Scrubber, Timeline, TouchPrecision, TouchedDrawing};
use crate::pipeline::partial;
use crate::ui::engine::Request;

/// Cached state of one frame, from which the picture after any number of triangles and fragments is drawn.
#[derive(Debug)]
pub(crate) struct Reel {
    request: Request,
    complete_frame: Arc<Frame>,
    scrubber: Scrubber,
    /// Timeline at the last moment, without fragment counts.
    timeline: Timeline,
    /// Pixel whose fragments the timeline lists.
    touched: Option<(u32, u32)>,
}

impl Reel {
    /// Returns the cached state of the requested frame. Creates it and stores it in `slot` if `slot` is empty or holds
    /// the state of another frame. `whole` is the complete frame, if the caller already has it.
    pub(crate) fn load<'a>(slot: &'a mut Option<Self>, request: &Request, whole: Option<Arc<Frame>>) -> &'a mut Self {
        slot.take_if(|reel| !reel.is_of(request));
        slot.get_or_insert_with(|| Self::new(request, whole))
    }

    /// Whether a request shows this frame, either completely or partially drawn.
    pub(crate) fn is_of(&self, request: &Request) -> bool {
        self.request.same_complete_frame(request)
    }

    fn new(request: &Request, whole: Option<Arc<Frame>>) -> Self {
        let Request { scene, camera, recipe, viewport, .. } = request;
        // An upscaler's history would show triangles that are not drawn yet at earlier moments.
        let whole = whole.filter(|frame| frame.history.is_none());
        let complete_frame = whole.unwrap_or_else(|| Arc::new(run_unobserved(scene, camera, recipe, *viewport)));
        let scrubber = Scrubber::new(scene, recipe, &complete_frame, BUDGET);
        let timeline = Timeline::new(scrubber.geometry());
        Self { request: request.clone(), complete_frame, scrubber, timeline, touched: None }
    }

    /// Returns the number of triangles of the complete frame.
    pub(crate) fn triangles(&self) -> usize {
        self.timeline.triangles
    }

    /// Draws the frame up to a moment and returns it.
    pub(crate) fn frame(&mut self, moment: Moment) -> Frame {
        let drawn = self.scrubber.frame_at(moment);
        self.complete_frame.at_moment(&self.request.recipe, drawn, self.scrubber.geometry_at(moment))
    }

    /// Returns the timeline for stepping from a moment. If `pixel` is given, the timeline lists all fragments at that
    /// pixel.
    pub(crate) fn timeline(&mut self, moment: Moment, pixel: Option<(u32, u32)>) -> Timeline {
        let Self { complete_frame: whole, scrubber, timeline, touched, .. } = self;
        let scale = [
            whole.viewport.width as f32 / whole.raster.width.max(1) as f32,
            whole.viewport.height as f32 / whole.raster.height.max(1) as f32,
        ];
        timeline.last = scrubber.last_triangle(moment, scale, timeline.last.take());
        if *touched != pixel {
            let of_pixel = |pixel| scrubber.drawing().touches(pixel, TouchPrecision::Fragments);
            (*touched, timeline.touches) = (pixel, pixel.map_or_else(Vec::new, of_pixel));
        }
        let fragments = |place: Option<usize>| place.map_or(0, |place| scrubber.fragments_of(place));
        let fragments = [fragments(moment.triangles.checked_sub(1)), fragments(Some(moment.triangles))];
        Timeline { fragments, ..timeline.clone() }
    }
}

/// Returns the timeline for stepping back from the end of a complete frame. If `pixel` is given, the timeline lists the
/// triangles that touch that pixel.
pub(crate) fn timeline_of(request: &Request, frame: &Frame, pixel: Option<(u32, u32)>) -> Timeline {
    let Request { scene, recipe, .. } = request;
    let last = frame.geometry().triangles.last();
    let samples =
        last.map_or_else(Vec::new, |triangle| partial::samples_of(triangle, &recipe.pipeline, frame.drawn_area()));
    Timeline {
        fragments: [partial::count(&samples), 0],
        touches: pixel.map_or_else(Vec::new, |pixel| {
            TouchedDrawing::of_frame(scene, recipe, frame).touches(pixel, TouchPrecision::Triangles)
        }),
        ..Timeline::new(frame.geometry())
    }
}
