//! Measurement of all upscalers in small steps: frame times in rounds, errors of a still view, and errors in motion
//! over the frames that are timed.
//!
//! First, one frame of every upscaler is drawn at rest and one in motion, and their errors and times are measured. All
//! upscalers thus have a provisional result soon. Upscalers without history come first, because the others need warm-up
//! frames. Then rounds and further errors take turns.

use super::WorkerResponse;
use crate::chain::{Frame, Recipe};
use crate::measure::motion::{ErrorMeasurement, FrameSequence, Turn};
use crate::measure::rounds::RoundTimer;
use crate::ui::engine::Request;
use crate::ui::session::timings::request::{MeasureRequest, MethodError};
use crate::upscale::Upscaling;

/// Number of measured rounds, each of which times one frame of every upscaler. Tests, which do not judge times, need
/// fewer.
pub(crate) const MEASURE_ROUNDS: usize = if cfg!(test) { 4 } else { 25 };

/// Running measurement of all upscalers.
#[derive(Debug)]
pub(super) struct Measurement {
    request: Box<MeasureRequest>,
    methods: Vec<Upscaling>,
    timer: RoundTimer,
    at_rest: ErrorMeasurement,
    /// Error measurement of the frames in motion; `None` for a still camera.
    in_motion: Option<ErrorMeasurement>,
    /// Number of completed rounds when the noise floor was last reported.
    reported: usize,
}

impl Measurement {
    pub(super) fn new(request: Box<MeasureRequest>) -> Self {
        let recipe = request.of.recipe;
        let mut methods: Vec<_> = Upscaling::every().collect();
        methods.sort_by_key(|method| (method.upscaler().reads().history, *method != recipe.upscaler));
        let timed: Vec<_> = methods.iter().map(|upscaler| Recipe { upscaler: *upscaler, ..recipe }).collect();
        let judge = || {
            let drawn = timed.iter().map(|recipe| Recipe { wireframe: false, ..*recipe });
            ErrorMeasurement::new(request.reference, drawn).selecting(request.metric)
        };
        Self {
            timer: RoundTimer::new(&timed, MEASURE_ROUNDS),
            at_rest: judge(),
            in_motion: (!request.turn.is_still()).then(judge),
            methods,
            reported: 0,
            request,
        }
    }

    /// Returns the number that identifies the measurement.
    pub(super) fn number(&self) -> u64 {
        self.request.number
    }

    pub(super) fn is_complete(&self) -> bool {
        let (timed, judged) = (self.timer.progress(), self.measured_frames());
        timed.0 >= timed.1 && judged.0 >= judged.1 && self.reported >= self.timer.rounds()
    }

    /// Returns the number of frames whose error has been measured, and the total number of frames to measure.
    fn measured_frames(&self) -> (usize, usize) {
        let moving =
            self.in_motion.as_ref().map_or((0, 0), |judge| (judge.measured_frames(), judge.total(self.request.turn)));
        (self.at_rest.measured_frames() + moving.0, self.at_rest.total(Turn::STILL) + moving.1)
    }

    /// Returns the completed fraction of the measurement, in [0, 1]. Counts both the frames to time and the frames to
    /// compare with the reference.
    fn progress(&self) -> f32 {
        let (timed, judged) = (self.timer.progress(), self.measured_frames());
        (timed.0 + judged.0) as f32 / (timed.1 + judged.1).max(1) as f32
    }

    /// Draws at most one frame, to measure either its time or its error. After the first error of every upscaler, chooses
    /// the measurement that has progressed less, so that both advance evenly.
    pub(super) fn step(&mut self) -> Option<WorkerResponse> {
        if self.reported < self.timer.rounds() {
            self.reported = self.timer.rounds();
            let noise = self.timer.noise()?;
            return Some(WorkerResponse::Noise { of: self.number(), noise });
        }
        let (timed, judged) = (self.timer.progress(), self.measured_frames());
        let has_first_errors = self.at_rest.is_complete(Turn::STILL)
            && self.in_motion.as_ref().is_none_or(|judge| judge.measured_frames() >= self.methods.len());
        if !has_first_errors || judged.0 * timed.1 < timed.0 * judged.1 || timed.0 >= timed.1 {
            return self.measure_error();
        }
        let Request { scene, camera, viewport, .. } = &self.request.of;
        let shot = FrameSequence { scene, camera, viewport: *viewport, turn: self.request.turn };
        let timed = self.timer.step(&shot)?;
        Some(WorkerResponse::Sample {
            of: self.number(),
            upscaling: self.methods[timed.recipe],
            milliseconds: timed.times.total.as_secs_f64() * 1e3,
            progress: self.progress(),
        })
    }

    /// Draws at most one frame, either of an upscaler or of its reference, to measure the error. Errors at rest and of the
    /// first frame in motion alternate.
    fn measure_error(&mut self) -> Option<WorkerResponse> {
        let Request { scene, camera, viewport, .. } = &self.request.of;
        let shot = FrameSequence { scene, camera, viewport: *viewport, turn: self.request.turn };
        let still = FrameSequence { turn: Turn::STILL, ..shot };
        let mut milliseconds = 0.0;
        let look = |_, frame: &Frame, _| milliseconds = frame.times.total.as_secs_f64() * 1e3;
        let at_rest = self.at_rest.measured_frames();
        let method = match &mut self.in_motion {
            Some(judge) if judge.measured_frames() < at_rest || self.at_rest.is_complete(Turn::STILL) => {
                judge.step(&shot, look)?
            }
            _ => self.at_rest.step(&still, look)?,
        };
        let at_rest = self.at_rest.error(method)?;
        let motion = self.in_motion.as_ref().map_or(Some(at_rest), |judge| judge.error(method))?;
        Some(WorkerResponse::MethodError {
            of: self.number(),
            upscaling: self.methods[method],
            error: Box::new(MethodError { still: at_rest.mean, motion }),
            milliseconds,
            progress: self.progress(),
        })
    }
}
