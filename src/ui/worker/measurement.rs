//! A measurement of all upscalers, piece by piece: frame times in rounds, errors at rest and over the same frames in motion.

use super::Answer;
use crate::chain::Recipe;
use crate::measure::against::Figures;
use crate::measure::motion::{Judge, MotionError, Shot, Turn};
use crate::measure::reference::Reference;
use crate::measure::rounds::RoundTimer;
use crate::ui::engine::Request;
use crate::upscale::Upscaling;

/// Rounds that count; each times one frame by every method.
pub const MEASURE_ROUNDS: usize = 25;

/// Request to measure time and error of upscalers.
#[derive(Clone, Debug)]
pub struct MeasureRequest {
    /// Number that the answers carry.
    pub number: u64,
    /// Scene, view and recipe; the upscaler is what varies.
    pub of: Request,
    /// Reference that errors are computed against.
    pub reference: Reference,
    /// Motion of the camera over the frames that are judged and timed.
    pub turn: Turn,
}

/// Error of a method, as far as it is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MethodError {
    /// Figures of the settled still view.
    pub still: Figures,
    /// Error over the frames judged so far; that of the still view without motion.
    pub motion: MotionError,
}

/// A measurement under way.
#[derive(Debug)]
pub(super) struct Measurement {
    request: Box<MeasureRequest>,
    methods: Vec<Upscaling>,
    timer: RoundTimer,
    at_rest: Judge,
    /// `None` for a camera that stands still.
    in_motion: Option<Judge>,
    /// Rounds whose noise floor was reported.
    reported: usize,
}

impl Measurement {
    pub(super) fn new(request: Box<MeasureRequest>) -> Self {
        let methods: Vec<_> = Upscaling::every().collect();
        let recipe = request.of.recipe;
        let timed: Vec<_> = methods.iter().map(|upscaler| Recipe { upscaler: *upscaler, ..recipe }).collect();
        let judge = || Judge::new(request.reference, timed.iter().map(|recipe| Recipe { wireframe: false, ..*recipe }));
        Self {
            timer: RoundTimer::new(&timed, MEASURE_ROUNDS),
            at_rest: judge(),
            in_motion: (!request.turn.is_still()).then(judge),
            methods,
            reported: 0,
            request,
        }
    }

    /// Number of the measurement.
    pub(super) fn number(&self) -> u64 {
        self.request.number
    }

    pub(super) fn is_complete(&self) -> bool {
        let (timed, judged) = (self.timer.progress(), self.judged());
        timed.0 >= timed.1 && judged.0 >= judged.1 && self.reported >= self.timer.rounds()
    }

    /// Number of frames judged, and of all frames to judge.
    fn judged(&self) -> (usize, usize) {
        let moving = self.in_motion.as_ref().map_or((0, 0), |judge| (judge.judged(), judge.total(self.request.turn)));
        (self.at_rest.judged() + moving.0, self.at_rest.total(Turn::STILL) + moving.1)
    }

    /// Share of the frames that are drawn to be timed or judged, in [0, 1].
    fn progress(&self) -> f32 {
        let (timed, judged) = (self.timer.progress(), self.judged());
        (timed.0 + judged.0) as f32 / (timed.1 + judged.1).max(1) as f32
    }

    /// Draws at most one frame; to time it or to judge it, whichever is behind, so that both advance alike.
    pub(super) fn step(&mut self) -> Option<Answer> {
        if self.reported < self.timer.rounds() {
            self.reported = self.timer.rounds();
            let noise = self.timer.noise()?;
            return Some(Answer::Noise { of: self.number(), noise });
        }
        let (timed, judged) = (self.timer.progress(), self.judged());
        if judged.0 * timed.1 < timed.0 * judged.1 || timed.0 >= timed.1 {
            return self.judge();
        }
        let Request { scene, camera, viewport, .. } = &self.request.of;
        let shot = Shot { scene, camera, viewport: *viewport, turn: self.request.turn };
        let timed = self.timer.step(&shot)?;
        Some(Answer::Sample {
            of: self.number(),
            upscaling: self.methods[timed.recipe],
            milliseconds: timed.times.total.as_secs_f64() * 1e3,
            progress: self.progress(),
        })
    }

    /// Draws at most one frame to be judged or of a reference.
    fn judge(&mut self) -> Option<Answer> {
        let Request { scene, camera, viewport, .. } = &self.request.of;
        let shot = Shot { scene, camera, viewport: *viewport, turn: self.request.turn };
        let still = Shot { turn: Turn::STILL, ..shot };
        let method = match &mut self.in_motion {
            Some(judge) if self.at_rest.is_complete(Turn::STILL) => judge.step(&shot, |_, _, _| ())?,
            _ => self.at_rest.step(&still, |_, _, _| ())?,
        };
        let at_rest = self.at_rest.error(method)?;
        let motion = self.in_motion.as_ref().map_or(Some(at_rest), |judge| judge.error(method))?;
        Some(Answer::Judged {
            of: self.number(),
            upscaling: self.methods[method],
            error: Box::new(MethodError { still: at_rest.mean, motion }),
            progress: self.progress(),
        })
    }
}
