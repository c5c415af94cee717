//! Engine behind the window: renders frames, captures buffers and replays pixels for requests, and reuses results that
//! are still valid.
//!
//! A [`Request`] contains everything that determines the view. The engine compares it with the last one and recomputes
//! only the parts that changed: a new pick replays one pixel, and showing another buffer only changes colours. A frame
//! is rendered only if the scene, camera, recipe, size, triangle limit or fragment limit changes, or if the upscaler
//! has not converged. The engine has no thread of its own, so screenshots and tests call it directly; [`super::worker`]
//! runs it on a thread.

pub(crate) mod look;

pub(crate) mod reel;

pub(crate) mod replay;

mod request;

use std::sync::Arc;
use std::time::Duration;

pub(crate) use request::{Look, Request, Shown, StatisticsRequest};

use look::{LookResult, SlowOverlays, ValueSource};
use reel::{Reel, timeline_of};
use replay::ReplayedFrame;

use super::seam_search::SeamSearch;
use crate::chain::{Frame, KeepDepth, Recipe, RenderInputs, Renderer};
use crate::image::{Image, Rgba8};
use crate::inspect::bad_fragments::BadFragments;
use crate::inspect::buffers::{Buffer, Buffers, capture};
use crate::inspect::intermediate::{self, Captured};
use crate::inspect::scrub::Timeline;
use crate::inspect::view::Range;
use crate::inspect::{PixelReport, Survey, explain, remedy_search};
use crate::measure::checkpoints::Checkpoints;
use crate::measure::shot::{ShotFrame, ShotInputs, ShotRenderer};
use crate::measure::stages::{StageTimer, StageTimes};
use crate::pipeline::observe::Counters;
use crate::scene::Scene;
use crate::scene::seams::Seams;

/// Response to a [`Request`].
#[derive(Clone, Debug)]
pub(crate) struct RenderedView {
    /// Request that this view belongs to.
    pub(crate) request: Request,
    /// Rendered frame.
    pub(crate) frame: Arc<Frame>,
    /// Number of rasterized triangles of the complete frame.
    pub(crate) rasterized: usize,
    /// Picture on the canvas.
    pub(crate) picture: Arc<Image<Rgba8>>,
    /// Captured buffers of the frame; `None` if the displayed quantity does not need them.
    pub(crate) buffers: Option<Arc<Buffers>>,
    /// Intermediate value of every sample; `None` if the shown quantity is not an intermediate value.
    pub(crate) captured: Option<Arc<Captured>>,
    /// Value range covered by the colour map or by each colour channel; `None` if the shown quantity has no
    /// range, such as triangle ids.
    pub(crate) range: Option<Range>,
    /// Intermediate images from which the picture was composed, and statistics of the shown quantity.
    pub(crate) look_result: LookResult,
    /// Report on all fragments at the picked pixel; `None` if no pixel is picked.
    pub(crate) report: Option<Arc<PixelReport>>,
    /// Draws of the frame and fragments at the picked pixel, for stepping through the frame's drawing; `None` if the
    /// frame is complete and no pixel is picked.
    pub(crate) timeline: Option<Arc<Timeline>>,
    /// Whether the frame was rendered for this response rather than reused from the last one.
    pub(crate) fresh: bool,
    /// Whether the frame has the history of the frames shown before, although [`Request::replayed_frame`] requests that of
    /// its sequence.
    pub(crate) needs_replay: bool,
}

impl RenderedView {
    /// Whether `request` shows a partially drawn frame, and this view contains the same frame drawn completely.
    fn is_whole_for(&self, request: &Request) -> bool {
        request.triangle_limit.is_some()
            && self.request.triangle_limit.is_none()
            && self.request.same_complete_frame(request)
    }

    /// Whether repeating the request would improve the frame, because the upscaler has not converged yet.
    pub(crate) fn is_unconverged(&self) -> bool {
        self.request.triangle_limit.is_none()
            && self.request.replayed_frame().is_none()
            && self.frame.is_converging(&self.request.recipe)
    }
}

/// Maximum time for which a repeated request waits until the open seams of the scene are found. If they are not found
/// by then, the request is handled without them. First requests do not wait, so that their frame is on screen soon. The
/// limit bounds the delay of a newer request.
const SEAMS_WAIT: Duration = Duration::from_millis(50);

/// Maximum memory for checkpoints of the history of scenes in motion, in bytes: for the picture, for all compared pictures,
/// and for both pictures of a what-if. A picture of 1920 × 1080 px needs about 50 MiB for each checkpoint.
pub(crate) const CHECKPOINT_BYTES: usize = 512 << 20;

/// Time for which a request waits until the frames missing from the history of its frame are drawn. If they are not drawn
/// by then, the worker draws them in single steps, between which it handles newer requests. Tests, which do not judge
/// times, wait longer.
pub(crate) const CATCH_UP_TIME: Duration = Duration::from_millis(if cfg!(test) { 60_000 } else { 100 });

/// Engine that handles requests and reuses results of the last one.
#[derive(Debug)]
pub(crate) struct Engine {
    last: Option<RenderedView>,
    /// Earlier frame that the window may still hold. Its buffers are reused as soon as the window has dropped it.
    earlier: Option<Arc<Frame>>,
    renderer: Renderer,
    /// Request for the frame whose history `renderer` holds, if it is that of all frames from frame 0 on.
    continued: Option<Request>,
    /// Saved histories of the sequence shown last.
    pub(crate) checkpoints: Checkpoints,
    /// Frame that [`Engine::adopt`] received for the next request.
    replayed: Option<Frame>,
    seams: SeamSearch,
    survey: SurveyCache,
    reel: Option<Reel>,
}

/// Frame that was drawn for a request.
struct Rendered {
    frame: Frame,
    /// Number of rasterized triangles of the complete frame.
    rasterized: usize,
    /// See [`RenderedView::needs_replay`].
    needs_replay: bool,
}

impl Default for Engine {
    fn default() -> Self {
        Self::with_checkpoints_within(CHECKPOINT_BYTES)
    }
}

impl Engine {
    /// Creates an engine whose checkpoints use at most `limit` bytes.
    pub(crate) fn with_checkpoints_within(limit: usize) -> Self {
        Self {
            last: None,
            earlier: None,
            renderer: Renderer::default(),
            continued: None,
            checkpoints: Checkpoints::within(limit),
            replayed: None,
            seams: SeamSearch::default(),
            survey: SurveyCache::default(),
            reel: None,
        }
    }

    /// Replaces the frame of a request by one with the history of its sequence. The next request must be for this frame.
    pub(crate) fn adopt(&mut self, replayed: ReplayedFrame) {
        let ReplayedFrame { request, frame, renderer } = replayed;
        (self.renderer, self.continued, self.replayed) = (renderer, Some(request), Some(frame));
    }

    /// Handles a request, reusing the valid parts of the last response.
    pub(crate) fn answer(&mut self, request: Request) -> RenderedView {
        let mut last = self.last.take();
        self.checkpoints.keep_only(request.shot_inputs().as_ref());
        self.reel.take_if(|reel| !reel.is_of(&request));
        let whole = last.as_ref().filter(|view| view.is_whole_for(&request)).map(|view| view.frame.clone());
        let replayed = self.replayed.take();
        let stale =
            |view: &mut RenderedView| !view.request.same_frame(&request) || view.is_unconverged() || replayed.is_some();
        if let Some(view) = last.take_if(stale) {
            self.retire(view.frame);
        }
        let fresh = last.is_none();
        let (frame, rasterized, kept_buffers, kept_captured, kept, needs_replay) = match last {
            Some(view) => {
                let kept = Some((view.request, view.look_result));
                (view.frame, view.rasterized, view.buffers, view.captured, kept, view.needs_replay)
            }
            None => {
                let Rendered { frame, rasterized, needs_replay } = match replayed {
                    Some(frame) => Rendered { rasterized: frame.rasterized(), frame, needs_replay: false },
                    None => self.render(&request, whole),
                };
                (Arc::new(frame), rasterized, None, None, None, needs_replay)
            }
        };
        // If the request is repeated, everything that is fast to compute is already on screen.
        let is_asked_again = kept.as_ref().is_some_and(|(before, _)| before.same_view(&request));
        let patience = if is_asked_again { SEAMS_WAIT } else { Duration::ZERO };
        let reads_seams = request.reads_seams();
        let seams = reads_seams.then(|| self.seams.seams(&request.scene, patience)).flatten();
        let captured = needed_capture(&request, &frame, kept_captured);
        let had_seams = kept_buffers.as_deref().is_none_or(|buffers| !buffers.misses_seams());
        let buffers = needed_buffers(&request, &frame, kept_buffers, seams.as_deref());
        // Hit counts that were captured before the seams were found lack the faults along seams. When these faults are
        // added, the old picture is not reused.
        let kept = kept.filter(|_| had_seams || buffers.as_deref().is_some_and(Buffers::misses_seams));
        let slow = if is_asked_again { SlowOverlays::Computed } else { SlowOverlays::Postponed };
        let mut looked = {
            let (buffers, captured) = (buffers.as_deref(), captured.as_deref());
            let source = ValueSource { frame: &frame, buffers, captured, stage: None, seams: seams.as_deref() };
            look::apply_look(&request, source, kept, slow)
        };
        looked.is_unfinished |= reads_seams && seams.is_none();
        let report = request.pick.and_then(|pick| {
            // Replaying the pixel needs both lists of triangles, which take most of the time.
            let (_, survey) =
                rayon::join(|| frame.geometry().triangles.len(), || self.survey.of(&request, &frame, seams.as_ref()));
            explain(&request.scene, &request.recipe, &frame, survey, pick)
        });
        let report = report.map(|report| {
            let (report, is_finished) = with_remedies(&request, &frame, report, slow);
            looked.is_unfinished |= !is_finished;
            Arc::new(report)
        });
        let (picture, range) = (looked.picture.clone(), looked.range);
        let timeline = self.timeline(&request, &frame, report.as_deref()).map(Arc::new);
        let view = RenderedView {
            request,
            frame,
            rasterized,
            picture,
            buffers,
            captured,
            range,
            look_result: looked,
            report,
            timeline,
            fresh,
            needs_replay,
        };
        self.last = Some(view.clone());
        view
    }

    /// Draws the requested frame.
    fn render(&mut self, request: &Request, whole: Option<Arc<Frame>>) -> Rendered {
        let Request { scene, camera, recipe, viewport, .. } = request;
        if let Some(moment) = request.moment() {
            let reel = Reel::load(&mut self.reel, request, whole);
            return Rendered { frame: reel.frame(moment), rasterized: reel.triangles(), needs_replay: false };
        }
        let replayed = request.replayed_frame().zip(request.shot_inputs());
        let continues = replayed.as_ref().is_some_and(|(number, inputs)| self.continue_history(*number, inputs));
        self.continued = continues.then(|| request.clone());
        let mut frame =
            self.renderer.render(RenderInputs { scene, camera, recipe, viewport: *viewport }, KeepDepth::Yes);
        frame.before = request.sequence.as_ref().map(ShotFrame::before);
        if let Some((number, inputs)) = replayed.as_ref().filter(|_| continues) {
            self.checkpoints.save_spaced(inputs, number + 1, self.renderer.history());
        }
        Rendered { rasterized: frame.rasterized(), frame, needs_replay: replayed.is_some() && !continues }
    }

    /// Completes the history of frame `number` in the renderer if that takes little time. Returns whether it is complete.
    fn continue_history(&mut self, number: u32, inputs: &ShotInputs) -> bool {
        let drawn = self.history_frames(inputs);
        if drawn == number && number > 0 {
            return true;
        }
        if !self.checkpoints.is_near(inputs, number, drawn) {
            return false;
        }
        let history = self.renderer.history().filter(|_| drawn > 0);
        let mut frames = ShotRenderer::reusing(inputs.clone(), std::mem::take(&mut self.renderer));
        history.into_iter().for_each(|history| frames.restore_history(drawn, history));
        let is_complete = self.checkpoints.catch_up(&mut frames, number, CATCH_UP_TIME);
        self.renderer = frames.into_renderer();
        is_complete
    }

    /// Returns the number of frames in the history of the renderer, if it is that of all frames of `inputs` from frame 0 on,
    /// and 0 otherwise.
    fn history_frames(&self, inputs: &ShotInputs) -> u32 {
        let continued = self.continued.as_ref();
        let same = continued.filter(|continued| continued.shot_inputs().is_some_and(|own| own.is_same(inputs)));
        same.and_then(Request::replayed_frame).map_or(0, |number| number + 1)
    }

    /// Reuses the buffers of a replaced frame. If the window still holds it, which it does until it receives the next
    /// view, the buffers of the frame before it are reused.
    fn retire(&mut self, frame: Arc<Frame>) {
        let free = match Arc::try_unwrap(frame) {
            Ok(frame) => Some(frame),
            Err(held) => self.earlier.replace(held).and_then(Arc::into_inner),
        };
        if let Some(frame) = free {
            self.renderer.recycle(frame);
        }
    }

    /// Returns the timeline for stepping through the drawing of the frame; `None` if the frame is complete and no pixel
    /// is picked.
    fn timeline(&mut self, request: &Request, frame: &Frame, report: Option<&PixelReport>) -> Option<Timeline> {
        let pixel = report.map(|report| report.drawn_at.into());
        match (request.moment(), &mut self.reel) {
            (Some(moment), Some(reel)) => Some(reel.timeline(moment, pixel)),
            _ => pixel.map(|pixel| timeline_of(request, frame, Some(pixel))),
        }
    }
}

/// Adds the remedies to a report on a pixel of a complete frame. Finding them draws frames, so the search is postponed
/// together with slow overlays. Returns the report, and whether its remedies are known.
fn with_remedies(request: &Request, frame: &Frame, mut report: PixelReport, slow: SlowOverlays) -> (PixelReport, bool) {
    let is_whole = request.triangle_limit.is_none();
    let is_finished = !is_whole
        || slow == SlowOverlays::Computed
        || !remedy_search::are_conceivable(&report, &request.recipe, &request.camera);
    if is_whole && is_finished {
        report.remedies = remedy_search::remedies(&request.scene, &request.recipe, frame, &report);
    }
    (report, is_finished)
}

/// Cached survey of all triangles of a frame, reused for all pixels and for every partially drawn state of that frame.
#[derive(Debug, Default)]
struct SurveyCache(Option<(Arc<Scene>, Recipe, Survey)>);

impl SurveyCache {
    fn of(&mut self, request: &Request, frame: &Frame, seams: Option<&Arc<Seams>>) -> &Survey {
        let Request { scene, recipe, .. } = request;
        self.0.take_if(|(of, by, survey)| !Arc::ptr_eq(of, scene) || by != recipe || !survey.fits(recipe, frame));
        let make = || (scene.clone(), *recipe, Survey::of(scene, recipe, frame));
        let survey = &mut self.0.get_or_insert_with(make).2;
        if let Some(seams) = seams {
            survey.set_seams(seams.clone());
        }
        survey
    }
}

/// Returns the buffers needed for the shown quantity; `None` if no buffers are needed. Reuses `kept`, the buffers of
/// the last response, and adds what is missing.
fn needed_buffers(
    request: &Request,
    frame: &Frame,
    kept: Option<Arc<Buffers>>,
    seams: Option<&Seams>,
) -> Option<Arc<Buffers>> {
    let (Request { scene, recipe, .. }, Shown::Buffer(buffer)) = (request, request.shown) else { return None };
    if matches!(buffer, Buffer::Color | Buffer::Depth) {
        return None;
    }
    let mut buffers = kept.unwrap_or_else(|| Arc::new(capture(scene, recipe, frame)));
    if !buffers.is_complete_for(buffer, frame) {
        buffers = Arc::new(Arc::unwrap_or_clone(buffers).completed_for(buffer, scene, recipe, frame));
    }
    if let Some(seams) = seams.filter(|_| buffers.misses_seams()) {
        buffers = Arc::new(Arc::unwrap_or_clone(buffers).with_seams(scene, recipe, frame, seams));
    }
    Some(buffers)
}

/// Returns the shown intermediate value of every sample, or `None` if none is shown. Reuses `kept` if it holds the same
/// intermediate value.
fn needed_capture(request: &Request, frame: &Frame, kept: Option<Arc<Captured>>) -> Option<Arc<Captured>> {
    let Shown::Intermediate(which) = request.shown else { return None };
    let again = || Arc::new(intermediate::capture(&request.scene, &request.recipe, frame, which));
    Some(kept.filter(|kept| kept.which == which).unwrap_or_else(again))
}

/// Counters and times of each pipeline stage of a frame. They are measured after the frame is on screen, by drawing it
/// a few more times, so that the frame itself is neither instrumented nor slowed down.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct StageFigures {
    /// Wall-clock time of each pipeline stage.
    pub(crate) times: StageTimes,
    /// Numbers of processed triangles and fragments.
    pub(crate) counters: Counters,
    /// Number of fragments whose depth or barycentric weights are NaN or infinite.
    pub(crate) bad: u64,
}

/// Measurement of the pipeline stages of a view, in steps that each take at most one frame time.
#[derive(Debug)]
pub(crate) struct StageMeasurement {
    view: RenderedView,
    timer: StageTimer,
}

impl StageMeasurement {
    /// Creates a measurement of the frame of `view`.
    pub(crate) fn new(view: RenderedView) -> Self {
        Self { timer: StageTimer::new(&view.frame), view }
    }

    /// Whether at least one step is complete.
    pub(crate) fn has_begun(&self) -> bool {
        self.timer.has_begun()
    }

    /// Runs the next step. Returns the counters and times after the last step, and `None` after all earlier steps.
    pub(crate) fn step(&mut self) -> Option<StageFigures> {
        let RenderedView { request, frame, .. } = &self.view;
        let times = self.timer.step(&request.scene, &request.camera, &request.recipe, frame)?;
        let BadFragments { counters, bad, .. } = BadFragments::of(&request.scene, &request.recipe, frame);
        Some(StageFigures { times, counters, bad })
    }
}
