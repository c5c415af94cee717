//! Drawing the frames before the shown one again, so that its history is that of the scene's motion and not that of the
//! frames that happened to be shown.
//!
//! Playback and single steps forwards continue the history of the frame on screen. Steps backwards continue from the
//! nearest checkpoint. After a long jump or a change of settings, the worker first shows the frame with the available
//! history. It then draws the missing frames, from the nearest checkpoint or frame 0 on. It draws one frame per step, so
//! that newer requests do not wait.

use std::time::{Duration, Instant};

use crate::chain::{Frame, KeepDepth, Renderer};
use crate::measure::checkpoints::Checkpoints;
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
        let renderer = ShotRenderer::new(request.shot_inputs()?);
        Some(Self { request, number, renderer, since: Instant::now(), is_cancelled: false })
    }

    /// Replaces the request by one for the same or a later frame of the same sequence. Returns `false` for any other
    /// request.
    fn continue_to(&mut self, request: &Request, number: u32) -> bool {
        let is_same = request.shot_inputs().is_some_and(|inputs| inputs.is_same(self.renderer.inputs()));
        let continues = is_same && number >= self.renderer.history_frames();
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

    /// Continues drawing after [`Replayer::cancel`].
    pub(crate) fn resume(&mut self) {
        if let Some(replay) = &mut self.replay {
            replay.is_cancelled = false;
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

    /// Returns the progress if frames are missing.
    pub(crate) fn progress(&self) -> Option<ReplayProgress> {
        self.replay.as_ref().filter(|replay| !replay.is_cancelled).map(|replay| replay.progress())
    }

    /// Whether drawing has begun and frames are missing.
    pub(crate) fn has_begun(&self) -> bool {
        self.has_work() && self.replay.as_ref().is_some_and(|replay| replay.renderer.history_frames() > 0)
    }

    /// Draws one frame, from the nearest checkpoint on, and saves checkpoints. Returns `None` if none is missing.
    pub(crate) fn step(&mut self, checkpoints: &mut Checkpoints) -> Option<ReplayStep> {
        let replay = self.replay.as_mut().filter(|replay| !replay.is_cancelled)?;
        if checkpoints.warm_up(&mut replay.renderer, replay.number) {
            let is_slow = replay.since.elapsed() > SLOW;
            return Some(if is_slow { ReplayStep::Slow(replay.progress()) } else { ReplayStep::Drawn });
        }
        let Replay { request, number, mut renderer, .. } = *self.replay.take()?;
        let frame = checkpoints.draw(&mut renderer, number, KeepDepth::Yes);
        Some(ReplayStep::Complete(Box::new(ReplayedFrame { request, frame, renderer: renderer.into_renderer() })))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::chain::Recipe;
    use crate::image::{Image, Rgba8};
    use crate::inspect::Buffer;
    use crate::measure::shot::{CameraMotion, Shot, ShotFrame};
    use crate::pipeline::viewport::Viewport;
    use crate::scene::builtin;
    use crate::ui::engine::{Engine, Look, Shown};
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
        // Without memory, no checkpoint shortens a replay.
        let none = &mut Checkpoints::within(0);
        let mut drawn = |replayer: &mut Replayer, steps: usize| {
            (0..steps)
                .map(|_| replayer.step(none))
                .all(|step| matches!(step, Some(ReplayStep::Drawn | ReplayStep::Slow(_))))
        };
        replayer.set(&requests[3]);
        assert!(replayer.has_work() && !replayer.has_begun());
        assert!(drawn(&mut replayer, 2) && replayer.has_begun());
        replayer.set(&requests[4]);
        assert!(drawn(&mut replayer, 2), "frames 2 and 3 are missing");
        let Some(ReplayStep::Complete(replayed)) = replayer.step(&mut Checkpoints::within(0)) else {
            panic!("frame 4 is complete")
        };
        assert_eq!(replayed.request.sequence.map(|frame| frame.number), Some(4));
        assert!(!replayer.has_work() && replayer.step(&mut Checkpoints::within(0)).is_none());
        replayer.set(&requests[3]);
        assert!(drawn(&mut replayer, 3));
        assert!(matches!(replayer.step(&mut Checkpoints::within(0)), Some(ReplayStep::Complete(_))));
    }

    #[test]
    fn a_cancelled_replay_rests_until_another_frame_is_requested() {
        let requests = requests(4);
        let mut replayer = Replayer::default();
        let checkpoints = &mut Checkpoints::within(usize::MAX);
        replayer.set(&requests[2]);
        assert!(matches!(replayer.step(checkpoints), Some(ReplayStep::Drawn | ReplayStep::Slow(_))));
        replayer.cancel();
        replayer.set(&Request { pick: Some((1, 2)), ..requests[2].clone() });
        assert!(!replayer.has_work() && replayer.step(checkpoints).is_none());
        replayer.set(&requests[3]);
        assert!(replayer.has_work() && replayer.step(checkpoints).is_some());
    }

    /// Answers a request, and replays until its frame has the history of its sequence. Returns the picture, and whether a
    /// replay was necessary.
    fn shown(engine: &mut Engine, request: &Request) -> (Image<Rgba8>, bool) {
        let view = engine.answer(request.clone());
        if !view.needs_replay {
            return (view.frame.image().clone(), false);
        }
        let mut replayer = Replayer::default();
        replayer.set(request);
        let replayed = std::iter::from_fn(|| replayer.step(&mut engine.checkpoints)).find_map(|step| match step {
            ReplayStep::Complete(replayed) => Some(replayed),
            ReplayStep::Drawn | ReplayStep::Slow(_) => None,
        });
        engine.adopt(*replayed.unwrap());
        (engine.answer(request.clone()).frame.image().clone(), true)
    }

    #[test]
    fn the_engine_shows_the_history_of_all_frames_in_both_directions_without_replays() {
        let requests = requests(40);
        let mut engine = Engine::default();
        let consecutive: Vec<_> = requests.iter().map(|request| shown(&mut engine, request)).collect();
        assert!(consecutive.iter().all(|(_, is_replayed)| !is_replayed));
        for number in (0..40).rev().chain([1, 2, 3, 2, 1, 39]) {
            let (picture, is_replayed) = shown(&mut engine, &requests[number]);
            assert!(!is_replayed && picture == consecutive[number].0, "frame {number}");
        }
        let picked = engine.answer(Request { pick: Some((3, 4)), ..requests[39].clone() });
        assert!(!picked.needs_replay && !picked.fresh);
        let other = |request: &Request| Request {
            recipe: Recipe { upscaler: Upscaling::new("fsr2", 2).unwrap(), ..request.recipe },
            ..request.clone()
        };
        assert!(engine.answer(other(&requests[38])).needs_replay, "other settings have no checkpoints");
    }

    #[test]
    fn other_inputs_show_a_preview_without_drawing_the_frames_before() {
        let requests = requests(6);
        let mut engine = Engine::default();
        requests.iter().for_each(|request| assert!(!engine.answer(request.clone()).needs_replay));
        let Request { mut camera, recipe, viewport, .. } = requests[5].clone();
        camera.orbit(0.2, 0.0);
        let turned = |number: usize| {
            let mut request = Request { camera, ..requests[number].clone() };
            request.sequence.as_mut().unwrap().shot.camera = camera;
            request
        };
        let other_recipe = Recipe { wireframe: true, ..recipe };
        let smaller = Viewport { width: viewport.width - 1, ..viewport };
        for other in [
            turned(5),
            Request { recipe: other_recipe, ..requests[5].clone() },
            Request { viewport: smaller, ..requests[5].clone() },
        ] {
            let view = engine.answer(other.clone());
            assert!(view.fresh && view.needs_replay);
            assert_eq!(engine.checkpoints.missing(&other.shot_inputs().unwrap(), 5, 0), 5, "no other frame was drawn");
        }
        assert!(shown(&mut engine, &turned(5)).1);
        let (picture, is_replayed) = shown(&mut engine, &turned(4));
        let frame = ShotRenderer::new(turned(4).shot_inputs().unwrap()).draw(4, KeepDepth::No);
        assert!(!is_replayed && picture == *frame.image(), "one step back is complete at once");
    }

    #[test]
    fn the_engine_keeps_no_checkpoints_of_views_without_this_history() {
        let requests = requests(9);
        let bilinear = Recipe { upscaler: Upscaling::new("bilinear", 2).unwrap(), ..requests[8].recipe };
        let still = Arc::new(builtin::by_id("triangle").unwrap().build());
        for other in [
            Request { recipe: bilinear, ..requests[8].clone() },
            Request { camera: still.home, scene: still, sequence: None, ..requests[8].clone() },
        ] {
            let mut engine = Engine::default();
            requests.iter().for_each(|request| drop(engine.answer(request.clone())));
            let inputs = requests[8].shot_inputs().unwrap();
            engine.answer(Request { triangle_limit: Some(3), ..requests[8].clone() });
            assert_eq!(engine.checkpoints.missing(&inputs, 8, 0), 0, "a part of the frame keeps them");
            engine.answer(other);
            assert_eq!(engine.checkpoints.missing(&inputs, 8, 0), 8);
        }
    }

    #[test]
    fn the_engine_adopts_replayed_frames_and_continues_them() {
        let requests = requests(20);
        let mut consecutive = Engine::default();
        let expected: Vec<_> = requests.iter().map(|request| shown(&mut consecutive, request).0).collect();
        let mut engine = Engine::default();
        let jumped = engine.answer(requests[17].clone());
        assert!(jumped.needs_replay && *jumped.frame.image() != expected[17]);
        for (number, is_replayed) in [(17, true), (18, false), (17, false), (16, false), (3, false), (19, false)] {
            let expected = (expected[number].clone(), is_replayed);
            assert!(shown(&mut engine, &requests[number]) == expected, "frame {number}");
        }
    }
}
