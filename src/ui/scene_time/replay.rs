//! Drawing the frames before the shown one again, so that its history is that of the scene's motion and not that of the
//! frames that happened to be shown.
//!
//! Playback and single steps forwards continue the history of the frame on screen. After a jump, a step backwards or a
//! change of the settings, the worker first shows the frame with the history at hand, and then draws all frames from
//! frame 0 on. It draws one frame per step, so that newer requests do not wait.

use std::time::{Duration, Instant};

use crate::chain::{Frame, KeepDepth, Renderer};
use crate::measure::shot::ShotRenderer;
use crate::ui::engine::Request;

/// Time after which the progress is shown.
const SLOW: Duration = Duration::from_secs(1);

/// Progress of drawing the frames before the shown one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ReplayProgress {
    /// Number of frames drawn.
    pub(crate) done: u32,
    /// Number of frames in total.
    pub(crate) of: u32,
}

/// Frame with the history of all frames from frame 0 on.
#[derive(Debug)]
pub(crate) struct ReplayedFrame {
    /// Request for the frame.
    pub(crate) request: Request,
    /// Frame with the history of all frames of its sequence.
    pub(crate) frame: Frame,
    /// Renderer that holds the history of the frame.
    pub(crate) renderer: Renderer,
}

/// Result of [`Replayer::step`].
#[derive(Debug)]
pub(crate) enum ReplayStep {
    /// One more frame was drawn.
    Drawn,
    /// One more frame was drawn, and the user has waited for more than a second.
    Slow(ReplayProgress),
    /// The requested frame was drawn.
    Complete(Box<ReplayedFrame>),
}

/// Drawing of the frames before a requested frame.
#[derive(Debug, Default)]
pub(crate) struct Replayer {
    replay: Option<Box<Replay>>,
}

#[derive(Debug)]
struct Replay {
    request: Request,
    number: u32,
    renderer: ShotRenderer,
    since: Instant,
    is_cancelled: bool,
}

impl Replay {
    fn new(request: Request, number: u32) -> Option<Self> {
        let renderer = ShotRenderer::new(request.sequence.as_ref()?.shot.clone(), request.recipe, request.viewport);
        Some(Self { request, number, renderer, since: Instant::now(), is_cancelled: false })
    }

    /// Replaces the request by one for the same or a later frame of the same sequence. Returns `false` for any other
    /// request.
    fn continue_to(&mut self, request: &Request, number: u32) -> bool {
        let is_same_shot = request.sequence.as_ref().is_some_and(|frame| frame.shot.is_same(self.renderer.shot()));
        let is_same_recipe = (request.recipe, request.viewport) == (self.request.recipe, self.request.viewport);
        let continues = is_same_shot && is_same_recipe && number >= self.renderer.history_frames();
        if continues {
            self.is_cancelled &= number == self.number;
            (self.request, self.number) = (request.clone(), number);
        }
        continues
    }

    fn progress(&self) -> ReplayProgress {
        ReplayProgress { done: self.renderer.history_frames(), of: self.number + 1 }
    }
}

impl Replayer {
    /// Replaces the requested frame, and continues from the frames drawn so far if they precede it.
    pub(crate) fn set(&mut self, request: &Request) {
        let Some(number) = request.replayed_frame() else {
            self.clear();
            return;
        };
        if !self.replay.as_mut().is_some_and(|replay| replay.continue_to(request, number)) {
            self.replay = Replay::new(request.clone(), number).map(Box::new);
        }
    }

    /// Stops drawing until another frame is requested.
    pub(crate) fn cancel(&mut self) {
        if let Some(replay) = &mut self.replay {
            replay.is_cancelled = true;
        }
    }

    /// Drops the request and the frames drawn so far.
    pub(crate) fn clear(&mut self) {
        self.replay = None;
    }

    /// Whether frames are missing.
    pub(crate) fn has_work(&self) -> bool {
        self.replay.as_ref().is_some_and(|replay| !replay.is_cancelled)
    }

    /// Whether drawing has begun and frames are missing.
    pub(crate) fn has_begun(&self) -> bool {
        self.has_work() && self.replay.as_ref().is_some_and(|replay| replay.renderer.history_frames() > 0)
    }

    /// Draws one frame. Returns `None` if none is missing.
    pub(crate) fn step(&mut self) -> Option<ReplayStep> {
        let replay = self.replay.as_mut().filter(|replay| !replay.is_cancelled)?;
        if replay.renderer.warm_up(replay.number) {
            let is_slow = replay.since.elapsed() > SLOW;
            return Some(if is_slow { ReplayStep::Slow(replay.progress()) } else { ReplayStep::Drawn });
        }
        let Replay { request, number, mut renderer, .. } = *self.replay.take()?;
        let frame = renderer.draw(number, KeepDepth::Yes);
        Some(ReplayStep::Complete(Box::new(ReplayedFrame { request, frame, renderer: renderer.into_renderer() })))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::chain::Recipe;
    use crate::inspect::Buffer;
    use crate::measure::shot::{CameraMotion, Shot, ShotFrame};
    use crate::pipeline::viewport::Viewport;
    use crate::scene::builtin;
    use crate::ui::engine::{Engine, Shown};
    use crate::ui::look::Look;
    use crate::upscale::Upscaling;

    const SIZE: Viewport = Viewport { width: 32, height: 18 };

    /// Returns requests for the first frames of a scene in motion.
    fn requests(count: i64) -> Vec<Request> {
        let scene = Arc::new(builtin::by_id("chess-motion").unwrap().build());
        let shot = Shot::from_start(Arc::clone(&scene), scene.home, CameraMotion::Still, 30.0);
        let recipe = Recipe { upscaler: Upscaling::new("taa", 2).unwrap(), ..Recipe::default() };
        let request = |number: i64| Request {
            scene: shot.view(number).0,
            camera: shot.camera,
            recipe,
            sequence: Some(ShotFrame { shot: shot.clone(), number }),
            is_replayed: true,
            viewport: SIZE,
            shown: Shown::Buffer(Buffer::Color),
            triangle_limit: None,
            fragment_limit: None,
            pick: None,
            look: Look::default(),
        };
        (0..count).map(request).collect()
    }

    #[test]
    fn a_later_frame_continues_and_an_earlier_one_starts_again() {
        let requests = requests(5);
        let mut replayer = Replayer::default();
        let drawn = |replayer: &mut Replayer, steps: usize| {
            (0..steps)
                .map(|_| replayer.step())
                .all(|step| matches!(step, Some(ReplayStep::Drawn | ReplayStep::Slow(_))))
        };
        replayer.set(&requests[3]);
        assert!(replayer.has_work() && !replayer.has_begun());
        assert!(drawn(&mut replayer, 2) && replayer.has_begun());
        replayer.set(&requests[4]);
        assert!(drawn(&mut replayer, 2), "frames 2 and 3 are missing");
        let Some(ReplayStep::Complete(replayed)) = replayer.step() else { panic!("frame 4 is complete") };
        assert_eq!(replayed.request.sequence.map(|frame| frame.number), Some(4));
        assert!(!replayer.has_work() && replayer.step().is_none());
        replayer.set(&requests[3]);
        assert!(drawn(&mut replayer, 3) && matches!(replayer.step(), Some(ReplayStep::Complete(_))));
    }

    #[test]
    fn a_cancelled_replay_rests_until_another_frame_is_requested() {
        let requests = requests(4);
        let mut replayer = Replayer::default();
        replayer.set(&requests[2]);
        assert!(matches!(replayer.step(), Some(ReplayStep::Drawn | ReplayStep::Slow(_))));
        replayer.cancel();
        replayer.set(&Request { pick: Some((1, 2)), ..requests[2].clone() });
        assert!(!replayer.has_work() && replayer.step().is_none());
        replayer.set(&requests[3]);
        assert!(replayer.has_work() && replayer.step().is_some());
    }

    #[test]
    fn the_engine_continues_consecutive_frames_and_adopts_replayed_ones() {
        let requests = requests(4);
        let mut shown = Engine::default();
        let consecutive: Vec<_> = requests.iter().map(|request| shown.answer(request.clone())).collect();
        assert!(consecutive.iter().all(|view| !view.needs_replay));
        let mut engine = Engine::default();
        let jumped = engine.answer(requests[2].clone());
        assert!(jumped.needs_replay && jumped.frame.image() != consecutive[2].frame.image());
        let mut replayer = Replayer::default();
        replayer.set(&requests[2]);
        let replayed = std::iter::from_fn(|| replayer.step()).find_map(|step| match step {
            ReplayStep::Complete(replayed) => Some(replayed),
            ReplayStep::Drawn | ReplayStep::Slow(_) => None,
        });
        engine.adopt(*replayed.unwrap());
        for number in [2, 3] {
            let view = engine.answer(requests[number].clone());
            assert!(!view.needs_replay && view.frame.image() == consecutive[number].frame.image(), "frame {number}");
        }
        let picked = engine.answer(Request { pick: Some((3, 4)), ..requests[3].clone() });
        assert!(!picked.needs_replay && !picked.fresh);
        assert!(engine.answer(requests[1].clone()).needs_replay, "a step backwards");
    }
}
