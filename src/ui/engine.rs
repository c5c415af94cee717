//! From what the window wants to see to what it shows: renders, captures and replays, and keeps what is still valid.
//!
//! A [`Request`] says everything; the engine compares it with the last one and does only what changed: a new pick replays
//! one pixel, another buffer recolours, and only scene, view, recipe or size draw a frame. It has no thread and no clock
//! of its own, so screenshots and tests call it directly; [`super::worker`] puts it on a thread.

use std::sync::Arc;
use std::time::Duration;

use super::look::{self, Look, Looked, Slow, Source};
use super::scrub::reel::{Reel, timeline_of};
use super::seam_search::SeamSearch;
use crate::chain::{self, Frame, KeepDepth, Recipe, Renderer};
use crate::image::{Image, Rgba8};
use crate::inspect::bad_fragments::BadFragments;
use crate::inspect::buffers::{Buffer, Buffers, capture};
use crate::inspect::intermediate::{self, Captured};
use crate::inspect::scrub::{Moment, Timeline};
use crate::inspect::view::Range;
use crate::inspect::{Intermediate, PixelReport, Stage, Survey, explain};
use crate::measure::stages::{StageTimer, StageTimes};
use crate::pipeline::Until;
use crate::pipeline::observe::Counters;
use crate::pipeline::settings::Choice as _;
use crate::pipeline::viewport::Viewport;
use crate::scene::seams::Seams;
use crate::scene::{Camera, Scene};

/// What the canvas shows of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// A quantity of the finished frame.
    Buffer(Buffer),
    /// The picture after a stage.
    Stage(Stage),
    /// A number on the way from triangle to colour.
    Intermediate(Intermediate),
}

impl Shown {
    /// What a person calls it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Buffer(buffer) => buffer.name(),
            Self::Stage(stage) => stage.name(),
            Self::Intermediate(intermediate) => intermediate.name(),
        }
    }

    /// One sentence: what is seen.
    pub fn help(self) -> &'static str {
        match self {
            Self::Buffer(buffer) => buffer.help(),
            Self::Stage(stage) => stage.help(),
            Self::Intermediate(intermediate) => intermediate.help(),
        }
    }
}

/// Everything that decides what the window shows.
#[derive(Clone, Debug)]
pub struct Request {
    /// Scene; the same one as long as the pointer is the same.
    pub scene: Arc<Scene>,
    /// View.
    pub camera: Camera,
    /// Recipe.
    pub recipe: Recipe,
    /// Picture size.
    pub viewport: Viewport,
    /// What to show of the frame.
    pub shown: Shown,
    /// Only the first so many rasterized triangles, to see the frame come about.
    pub triangle_limit: Option<usize>,
    /// Of the last of these triangles only the first so many fragments.
    pub fragment_limit: Option<usize>,
    /// The questioned pixel.
    pub pick: Option<(u32, u32)>,
    /// By which colours it is shown, and what is laid over it.
    pub look: Look,
}

impl Request {
    /// Whether the answer to both is the same.
    pub fn same_view(&self, other: &Self) -> bool {
        self.same_frame(other) && self.shown == other.shown && self.pick == other.pick && self.look == other.look
    }

    /// Whether the canvas shows the same for both, whichever pixel is questioned.
    pub fn same_picture(&self, other: &Self) -> bool {
        self.same_frame(other) && self.shown == other.shown && self.look == other.look
    }

    /// Whether the frames of both are the same.
    pub fn same_frame(&self, other: &Self) -> bool {
        self.same_complete_frame(other) && self.moment() == other.moment()
    }

    /// The moment of the frame that is asked for; none if it is the last.
    pub fn moment(&self) -> Option<Moment> {
        self.triangle_limit.map(|triangles| Moment { triangles, fragments: self.fragment_limit })
    }

    /// Whether anything shows the open seams of the scene.
    fn reads_seams(&self) -> bool {
        let has_layer = self.look.layers.iter().any(|layer| layer.overlay.reads_seams());
        self.shown == Shown::Buffer(Buffer::Hits) || self.pick.is_some() || has_layer
    }

    /// Whether the frames of both, with all of their triangles, are the same.
    pub fn same_complete_frame(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.scene, &other.scene)
            && self.camera == other.camera
            && self.recipe == other.recipe
            && self.viewport == other.viewport
    }
}

/// The answer to a [`Request`].
#[derive(Clone, Debug)]
pub struct View {
    /// What was asked.
    pub request: Request,
    /// The frame.
    pub frame: Arc<Frame>,
    /// Triangles that are rasterized without a limit.
    pub rasterized: usize,
    /// The picture to show.
    pub picture: Arc<Image<Rgba8>>,
    /// Quantities of the frame, if a buffer that needs them is shown.
    pub buffers: Option<Arc<Buffers>>,
    /// The number of every sample that is shown, if one is.
    pub captured: Option<Arc<Captured>>,
    /// Ends of the colour map, if one is used.
    pub range: Option<Range>,
    /// What the picture was made from, and its figures.
    pub looked: Looked,
    /// The story of the picked pixel.
    pub report: Option<Arc<PixelReport>>,
    /// The moments around the one that is shown, if it is not the last or a pixel is picked.
    pub timeline: Option<Arc<Timeline>>,
    /// Whether the frame was drawn for this answer, rather than kept from the last one.
    pub fresh: bool,
}

impl View {
    /// Whether its frame has all triangles of the one of which `request` asks for a moment.
    fn is_whole_for(&self, request: &Request) -> bool {
        request.triangle_limit.is_some()
            && self.request.triangle_limit.is_none()
            && self.request.same_complete_frame(request)
    }

    /// Whether the same request again would be answered by a better frame.
    pub fn wants_another(&self) -> bool {
        self.request.triangle_limit.is_none() && self.frame.wants_another(&self.request.recipe)
    }
}

/// Longest wait for the open seams of a scene before an answer without them, once the frame is on screen: a newer request
/// waits no longer.
const SEAMS_WAIT: Duration = Duration::from_millis(50);

/// Renders requests.
#[derive(Debug, Default)]
pub struct Engine {
    last: Option<View>,
    renderer: Renderer,
    seams: SeamSearch,
    survey: Surveyed,
    reel: Option<Reel>,
}

impl Engine {
    /// Answers a request, reusing what the last answer has in common.
    pub fn answer(&mut self, request: Request) -> View {
        let mut last = self.last.take();
        self.reel.take_if(|reel| !reel.is_of(&request));
        let whole = last.as_ref().filter(|view| view.is_whole_for(&request)).map(|view| view.frame.clone());
        let stale = |view: &mut View| !view.request.same_frame(&request) || view.wants_another();
        if let Some(view) = last.take_if(stale) {
            // Whoever still shows it keeps it.
            if let Ok(frame) = Arc::try_unwrap(view.frame) {
                self.renderer.recycle(frame);
            }
        }
        let fresh = last.is_none();
        let (frame, rasterized, kept_buffers, kept_captured, kept) = match last {
            Some(view) => (view.frame, view.rasterized, view.buffers, view.captured, Some((view.request, view.looked))),
            None => {
                let (frame, rasterized) = render(&request, &mut self.renderer, (&mut self.reel, whole));
                (Arc::new(frame), rasterized, None, None, None)
            }
        };
        // Whoever asks for the same again has seen the rest.
        let is_asked_again = kept.as_ref().is_some_and(|(before, _)| before.same_view(&request));
        let patience = if is_asked_again { SEAMS_WAIT } else { Duration::ZERO };
        let reads_seams = request.reads_seams();
        let seams = reads_seams.then(|| self.seams.seams(&request.scene, patience)).flatten();
        let captured = needed_capture(&request, &frame, kept_captured);
        let had_seams = kept_buffers.as_deref().is_none_or(|buffers| !buffers.misses_seams());
        let buffers = needed_buffers(&request, &frame, kept_buffers, seams.as_deref());
        // A picture of hits that were counted before the seams were known lacks their faults.
        let kept = kept.filter(|_| had_seams || buffers.as_deref().is_some_and(Buffers::misses_seams));
        let mut looked = {
            let (buffers, captured) = (buffers.as_deref(), captured.as_deref());
            let slow = if is_asked_again { Slow::Made } else { Slow::Postponed };
            let source = Source { frame: &frame, buffers, captured, stage: None, seams: seams.as_deref() };
            look::look(&request, source, kept, slow)
        };
        looked.is_unfinished |= reads_seams && seams.is_none();
        let report = request.pick.and_then(|pick| {
            let survey = self.survey.of(&request, &frame, seams.as_ref());
            explain(&request.scene, &request.recipe, &frame, survey, pick).map(Arc::new)
        });
        let (picture, range) = (looked.picture.clone(), looked.range);
        let timeline = self.timeline(&request, &frame, report.as_deref()).map(Arc::new);
        let view =
            View { request, frame, rasterized, picture, buffers, captured, range, looked, report, timeline, fresh };
        self.last = Some(view.clone());
        view
    }

    /// The moments around the one that is asked for, if anybody looks at them.
    fn timeline(&mut self, request: &Request, frame: &Frame, report: Option<&PixelReport>) -> Option<Timeline> {
        let pixel = report.map(|report| report.drawn_at.into());
        match (request.moment(), &mut self.reel) {
            (Some(moment), Some(reel)) => Some(reel.timeline(moment, pixel)),
            _ => pixel.map(|pixel| timeline_of(request, frame, Some(pixel))),
        }
    }
}

/// Where the triangles of the last frame of which a pixel was questioned came to, kept for its other pixels and moments.
#[derive(Debug, Default)]
struct Surveyed(Option<(Arc<Scene>, Recipe, Survey)>);

impl Surveyed {
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

/// The quantities that are shown, if any are: those of the last answer as far as they suffice.
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
    if buffer == Buffer::Hits && buffers.hits.is_none() {
        buffers = Arc::new(Arc::unwrap_or_clone(buffers).completed_for(buffer, recipe, frame));
    }
    if let Some(seams) = seams.filter(|_| buffers.misses_seams()) {
        buffers = Arc::new(Arc::unwrap_or_clone(buffers).with_seams(scene, recipe, frame, seams));
    }
    Some(buffers)
}

/// The number of every sample that is shown, if one is: that of the last answer if it is the same.
fn needed_capture(request: &Request, frame: &Frame, kept: Option<Arc<Captured>>) -> Option<Arc<Captured>> {
    let Shown::Intermediate(which) = request.shown else { return None };
    let again = || Arc::new(intermediate::capture(&request.scene, &request.recipe, frame, which));
    Some(kept.filter(|kept| kept.which == which).unwrap_or_else(again))
}

/// A frame, and how many triangles it would have without a limit.
fn render(
    request: &Request,
    renderer: &mut Renderer,
    (reel, whole): (&mut Option<Reel>, Option<Arc<Frame>>),
) -> (Frame, usize) {
    let Request { scene, camera, recipe, viewport, .. } = request;
    let Some(moment) = request.moment() else {
        let frame = renderer.render(scene, camera, recipe, *viewport, KeepDepth::Yes);
        let rasterized = frame.rasterized();
        return (frame, rasterized);
    };
    let reel = Reel::load(reel, request, whole);
    (reel.frame(moment), reel.triangles())
}

/// What happened in each stage of a frame, and how long it took. Found out after the frame is on screen, by drawing it a
/// few more times: the frame itself is neither watched nor slowed.
#[derive(Clone, Copy, Debug, Default)]
pub struct StageFigures {
    /// Wall-clock times.
    pub times: StageTimes,
    /// Counts.
    pub counters: Counters,
    /// Fragments whose depth or weights are NaN or infinite.
    pub bad: u64,
}

/// Finds out the figures of a view piece by piece, each at most as long as a frame.
#[derive(Debug)]
pub struct Figuring {
    view: View,
    timer: StageTimer,
}

impl Figuring {
    /// For a view.
    pub fn new(view: View) -> Self {
        Self { timer: StageTimer::new(&view.frame), view }
    }

    /// Whether a piece is done already.
    pub fn has_begun(&self) -> bool {
        self.timer.has_begun()
    }

    /// Does the next piece; the figures are there when all pieces are done.
    pub fn step(&mut self) -> Option<StageFigures> {
        let View { request, frame, .. } = &self.view;
        let times = self.timer.step(&request.scene, &request.camera, &request.recipe, frame)?;
        let BadFragments { counters, bad, .. } = count(request, frame);
        Some(StageFigures { times, counters, bad })
    }
}

/// Counts without shading: as many fragments are shaded as pass.
fn count(request: &Request, frame: &Frame) -> BadFragments {
    let Request { scene, recipe, .. } = request;
    let mut counting = BadFragments::new(recipe.pipeline);
    chain::prepare_again(scene, recipe, frame, &mut counting);
    let again = chain::redraw(scene, recipe, frame, Until::Depth, &mut counting);
    let counters = &mut counting.counters;
    counters.shaded = if again.depth.is_some() { counters.passed } else { counters.covered };
    counting
}
