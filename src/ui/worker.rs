//! Renderer thread: the window sends requests without waiting, and is woken when there is a response.
//!
//! Only the newest request counts; older ones that were not started are dropped. Between requests the thread works on
//! deferred tasks: timing the stages of the frame on screen, and measuring all upscalers on request. A panic in a stage
//! is caught and reported, and a new engine serves the next request.

mod measurement;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, RecvError, RecvTimeoutError, Sender, TryRecvError, channel};
use std::time::Duration;

use super::engine::replay::{ReplayProgress, ReplayStep, Replayer};
use super::engine::{Engine, RenderedView, Request, StageFigures, StageMeasurement};
use super::session::compare::compute::{CompareRequest, Compared, Comparer};
use super::session::filmstrip::drawer::FilmstripDrawer;
use super::session::temporal::TemporalRequest;
use super::session::temporal::searcher::TemporalSearcher;
use super::session::timings::request::{MeasureRequest, MethodError};
use super::session::watch::watcher::PixelWatcher;
use super::session::what_if::drawer::{Drawer, WhatIfRequest, WhatIfResults};
use crate::inspect::temporal::PixelHistory;
use crate::inspect::watch::WatchedPixel;
use crate::measure::noise::Noise;
use crate::upscale::Upscaling;
#[cfg(test)]
pub(crate) use measurement::MEASURE_ROUNDS;
use measurement::Measurement;

/// Time for which a frame must stay on screen before its stages are timed. While the view moves, all time goes to new
/// frames.
const SETTLED: Duration = Duration::from_millis(120);

/// Request from the window to the renderer.
#[derive(Debug)]
pub(crate) enum WorkerRequest {
    /// Renders this view.
    Show(Box<Request>),
    /// Renders this comparison; `None` cancels the comparison.
    Compare(Option<Box<CompareRequest>>),
    /// Draws the pictures of the filmstrip; `None` cancels them.
    Filmstrip(Option<Box<CompareRequest>>),
    /// Finds the history of a pixel; `None` cancels the search.
    Temporal(Option<Box<TemporalRequest>>),
    /// Computes the effect of a settings change; `None` cancels the computation.
    WhatIf(Option<Box<WhatIfRequest>>),
    /// Sets the watched pixels, whose values are reported for every new frame.
    Watch(Vec<(u32, u32)>),
    /// Measures time and error of every upscaler.
    Measure(Box<MeasureRequest>),
    /// Cancels the measurement.
    CancelMeasure,
    /// Stops drawing the frames before the shown one, also for compared pictures.
    CancelReplay,
}

/// Response from the renderer to the window.
#[derive(Debug)]
pub(crate) enum WorkerResponse {
    /// A rendered view.
    View(Box<RenderedView>),
    /// Results of the comparison so far.
    Compared(Box<Compared>),
    /// Number of frames drawn so far before the shown one.
    Replaying(ReplayProgress),
    /// Pictures of the filmstrip so far.
    Filmstrip(Box<Compared>),
    /// History of a pixel.
    Temporal {
        /// Request that the history belongs to.
        request: Box<TemporalRequest>,
        /// Contribution of earlier frames.
        history: Box<PixelHistory>,
    },
    /// Values of the newest frame at the watched pixels.
    Watched(Vec<WatchedPixel>),
    /// Results of the what-if comparison so far.
    WhatIf(Box<WhatIfResults>),
    /// Counters and times of the pipeline stages of the last frame.
    Stages(Box<StageFigures>),
    /// One timed frame of a measurement.
    Sample {
        /// Number that identifies the measurement.
        of: u64,
        /// Upscaler that was timed.
        upscaling: Upscaling,
        /// Frame time, in milliseconds.
        milliseconds: f64,
        /// Completed fraction of the measurement, in [0, 1].
        progress: f32,
    },
    /// The error of an upscaler over the frames measured so far.
    MethodError {
        /// Number that identifies the measurement.
        of: u64,
        /// Upscaler whose error was measured.
        upscaling: Upscaling,
        /// Error at rest and in motion.
        error: Box<MethodError>,
        /// Time of the last frame whose error was measured, in milliseconds.
        milliseconds: f64,
        /// Completed fraction of the measurement, in [0, 1].
        progress: f32,
    },
    /// The noise floor of the completed rounds.
    Noise {
        /// Number that identifies the measurement.
        of: u64,
        /// Noise floor of frame times.
        noise: Noise,
    },
    /// The measurement with this number is complete.
    Measured(u64),
    /// A stage panicked with this message.
    Panicked(String),
}

/// Handle to the renderer: a background thread, or a synchronous renderer for screenshots and tests.
#[derive(Debug)]
pub(crate) enum Worker {
    /// Asynchronous: responses arrive later.
    Thread {
        /// Sender of requests to the thread.
        jobs: Sender<WorkerRequest>,
        /// Receiver of responses from the thread.
        answers: Receiver<WorkerResponse>,
    },
    /// Synchronous: responses are ready when [`Worker::send`] returns.
    Inline(Box<RenderWorker>),
}

impl Worker {
    /// Starts the renderer thread. `wake` is called after every batch of responses. Falls back to a synchronous worker
    /// if no thread can be started.
    pub(crate) fn spawn(wake: impl Fn() + Send + 'static) -> Self {
        let (jobs, inbox) = channel();
        let (outbox, answers) = channel();
        std::thread::Builder::new()
            .name("renderer".to_owned())
            .spawn(move || RenderWorker::default().serve(&inbox, &outbox, wake))
            .map_or_else(|_| Self::inline(), |_| Self::Thread { jobs, answers })
    }

    /// Creates a synchronous worker.
    pub(crate) fn inline() -> Self {
        Self::Inline(Box::default())
    }

    /// Sends a request; a synchronous worker also completes it.
    pub(crate) fn send(&mut self, job: WorkerRequest) {
        match self {
            // The thread ends only with the window, so a failed send has no one to report to.
            Self::Thread { jobs, .. } => drop(jobs.send(job)),
            Self::Inline(work) => {
                work.queue_request(job);
                while work.step() {}
            }
        }
    }

    /// Returns the next response that is ready, if any.
    pub(crate) fn poll(&mut self) -> Option<WorkerResponse> {
        match self {
            Self::Thread { answers, .. } => answers.try_recv().ok(),
            Self::Inline(work) => work.done.pop_front(),
        }
    }
}

/// Renderer state with a queue of pending work.
#[derive(Debug, Default)]
pub(crate) struct RenderWorker {
    engine: Engine,
    to_show: Option<Box<Request>>,
    comparer: Comparer,
    to_compare: Option<Box<CompareRequest>>,
    drawer: Drawer,
    filmstrip: FilmstripDrawer,
    temporal: TemporalSearcher,
    replayer: Replayer,
    watcher: PixelWatcher,
    to_evaluate: Option<Box<WhatIfRequest>>,
    /// Current request, if one more frame would improve its view.
    to_improve: Option<Box<Request>>,
    /// Current request, if slow parts of its view are still missing.
    to_complete: Option<Box<Request>>,
    to_time: Option<Box<StageMeasurement>>,
    measurement: Option<Measurement>,
    done: std::collections::VecDeque<WorkerResponse>,
}

impl RenderWorker {
    fn serve(mut self, inbox: &Receiver<WorkerRequest>, outbox: &Sender<WorkerResponse>, wake: impl Fn()) {
        loop {
            match self.wait(inbox) {
                Ok(Some(job)) => self.queue_request(job),
                Ok(None) => {}
                Err(RecvError) => return,
            }
            loop {
                match inbox.try_recv() {
                    Ok(job) => self.queue_request(job),
                    Err(TryRecvError::Empty) => break,
                    Err(TryRecvError::Disconnected) => return,
                }
            }
            self.step();
            if self.done.is_empty() {
                continue;
            }
            for answer in self.done.drain(..) {
                if outbox.send(answer).is_err() {
                    return;
                }
            }
            wake();
        }
    }

    /// Waits for a request. Blocks if no work is pending. Returns immediately if the user is waiting for pending work,
    /// or if pending work has begun. Otherwise, waits at most [`SETTLED`], because a newer frame may make the pending
    /// work obsolete.
    fn wait(&self, inbox: &Receiver<WorkerRequest>) -> Result<Option<WorkerRequest>, RecvError> {
        let is_asked = self.to_show.is_some() || self.to_improve.is_some() || self.to_compare.is_some();
        if is_asked || self.to_evaluate.is_some() || self.watcher.has_work() || self.measurement.is_some() {
            return Ok(None);
        }
        let figuring = self.to_time.as_ref();
        let is_complete = self.to_complete.is_none();
        let has_work = self.replayer.has_work()
            || self.comparer.has_work()
            || self.drawer.has_work()
            || self.filmstrip.has_work()
            || self.temporal.has_work();
        if figuring.is_none() && is_complete && !has_work {
            return inbox.recv().map(Some);
        }
        let has_begun = self.replayer.has_begun()
            || self.comparer.has_begun()
            || self.drawer.has_begun()
            || self.filmstrip.has_begun()
            || self.temporal.has_begun();
        if has_begun || figuring.is_some_and(|figuring| figuring.has_begun()) {
            return Ok(None);
        }
        match inbox.recv_timeout(SETTLED) {
            Ok(job) => Ok(Some(job)),
            Err(RecvTimeoutError::Timeout) => Ok(None),
            Err(RecvTimeoutError::Disconnected) => Err(RecvError),
        }
    }

    fn queue_request(&mut self, job: WorkerRequest) {
        match job {
            WorkerRequest::Show(request) => self.to_show = Some(request),
            WorkerRequest::Compare(None) => {
                self.to_compare = None;
                self.comparer.clear();
            }
            WorkerRequest::Compare(request) => self.to_compare = request,
            WorkerRequest::Watch(pixels) => self.watcher.set(pixels),
            WorkerRequest::WhatIf(request) => {
                if request.is_none() {
                    self.drawer.clear();
                }
                self.to_evaluate = request;
            }
            WorkerRequest::Filmstrip(request) => self.filmstrip.set(request.map(|request| *request)),
            WorkerRequest::Temporal(request) => self.temporal.set(request.map(|request| *request)),
            WorkerRequest::Measure(request) => self.measurement = Some(Measurement::new(request)),
            WorkerRequest::CancelMeasure => self.measurement = None,
            WorkerRequest::CancelReplay => {
                self.replayer.cancel();
                self.comparer.cancel_replay();
                self.drawer.cancel_replay();
            }
        }
    }

    /// Runs one step of the most urgent work. Returns `false` if there was none.
    fn step(&mut self) -> bool {
        if let Some(request) = self.to_show.take().or_else(|| self.to_improve.take()) {
            (self.to_improve, self.to_complete) = (None, None);
            self.show(*request);
        } else if self.watcher.has_work() {
            self.watch();
        } else if let Some(request) = self.to_compare.take() {
            self.compare(|comparer| Some(comparer.start(*request)));
        } else if let Some(request) = self.to_evaluate.take() {
            self.evaluate_change(|drawer| drawer.start(*request).cloned());
        } else if self.replayer.has_work() {
            self.replay();
        } else if let Some(request) = self.to_complete.take() {
            self.show(*request);
        } else if self.comparer.has_work() {
            self.compare(Comparer::step);
        } else if self.drawer.has_work() {
            self.evaluate_change(|drawer| drawer.step().cloned());
        } else if self.filmstrip.has_work() {
            self.draw_filmstrip();
        } else if self.temporal.has_work() {
            self.search_history();
        } else if let Some(mut figuring) = self.to_time.take() {
            match catch_unwind(AssertUnwindSafe(|| figuring.step())) {
                Ok(Some(figures)) => self.done.push_back(WorkerResponse::Stages(Box::new(figures))),
                Ok(None) => self.to_time = Some(figuring),
                Err(panic) => self.done.push_back(WorkerResponse::Panicked(panic_text(&*panic))),
            }
        } else if let Some(mut measurement) = self.measurement.take() {
            match catch_unwind(AssertUnwindSafe(|| measurement.step())) {
                Ok(sample) => self.done.extend(sample),
                Err(panic) => {
                    self.done.extend([
                        WorkerResponse::Panicked(panic_text(&*panic)),
                        WorkerResponse::Measured(measurement.number()),
                    ]);
                    return true;
                }
            }
            if measurement.is_complete() {
                self.done.push_back(WorkerResponse::Measured(measurement.number()));
            } else {
                self.measurement = Some(measurement);
            }
        } else {
            return false;
        }
        true
    }

    /// Runs one step of a comparison and queues its results. A panic ends the comparison.
    fn compare(&mut self, piece: impl FnOnce(&mut Comparer) -> Option<&Compared>) {
        let comparer = &mut self.comparer;
        match catch_unwind(AssertUnwindSafe(|| piece(comparer).cloned())) {
            Ok(compared) => self.done.extend(compared.map(|compared| WorkerResponse::Compared(Box::new(compared)))),
            Err(panic) => {
                self.comparer.clear();
                self.done.push_back(WorkerResponse::Panicked(panic_text(&*panic)));
            }
        }
    }

    /// Runs one step of drawing the filmstrip and queues its results. A panic ends it.
    fn draw_filmstrip(&mut self) {
        let filmstrip = &mut self.filmstrip;
        match catch_unwind(AssertUnwindSafe(|| filmstrip.step().cloned())) {
            Ok(drawn) => self.done.extend(drawn.map(|drawn| WorkerResponse::Filmstrip(Box::new(drawn)))),
            Err(panic) => {
                self.filmstrip = FilmstripDrawer::default();
                self.done.push_back(WorkerResponse::Panicked(panic_text(&*panic)));
            }
        }
    }

    /// Draws one frame before the shown one, and shows the latter again after the last one. A panic ends the replay.
    fn replay(&mut self) {
        let (replayer, checkpoints) = (&mut self.replayer, &mut self.engine.checkpoints);
        match catch_unwind(AssertUnwindSafe(|| replayer.step(checkpoints))) {
            Ok(Some(ReplayStep::Complete(replayed))) => {
                let request = replayed.request.clone();
                self.engine.adopt(*replayed);
                self.show(request);
            }
            Ok(Some(ReplayStep::Slow(progress))) => self.done.push_back(WorkerResponse::Replaying(progress)),
            Ok(Some(ReplayStep::Drawn) | None) => {}
            Err(panic) => {
                self.replayer.clear();
                self.done.push_back(WorkerResponse::Panicked(panic_text(&*panic)));
            }
        }
    }

    /// Runs one step of the search for the history of a pixel and queues its result. A panic ends it.
    fn search_history(&mut self) {
        let temporal = &mut self.temporal;
        match catch_unwind(AssertUnwindSafe(|| temporal.step())) {
            Ok(found) => self.done.extend(found.map(|(request, history)| WorkerResponse::Temporal {
                request: Box::new(request),
                history: Box::new(history),
            })),
            Err(panic) => {
                self.temporal = TemporalSearcher::default();
                self.done.push_back(WorkerResponse::Panicked(panic_text(&*panic)));
            }
        }
    }

    /// Finds the values of the watched pixels and queues them as a response. A panic ends watching.
    fn watch(&mut self) {
        let watcher = &mut self.watcher;
        match catch_unwind(AssertUnwindSafe(|| watcher.step())) {
            Ok(rows) => self.done.extend(rows.map(WorkerResponse::Watched)),
            Err(panic) => {
                self.watcher = PixelWatcher::default();
                self.done.push_back(WorkerResponse::Panicked(panic_text(&*panic)));
            }
        }
    }

    /// Runs one step of a what-if comparison and queues its results. A panic ends the comparison.
    fn evaluate_change(&mut self, piece: impl FnOnce(&mut Drawer) -> Option<WhatIfResults>) {
        let drawer = &mut self.drawer;
        match catch_unwind(AssertUnwindSafe(|| piece(drawer))) {
            Ok(found) => self.done.extend(found.map(|found| WorkerResponse::WhatIf(Box::new(found)))),
            Err(panic) => {
                self.drawer.clear();
                self.done.push_back(WorkerResponse::Panicked(panic_text(&*panic)));
            }
        }
    }

    fn show(&mut self, request: Request) {
        let mut engine = std::mem::take(&mut self.engine);
        match catch_unwind(AssertUnwindSafe(|| (engine.answer(request), engine))) {
            Ok((view, engine)) => {
                self.engine = engine;
                if view.is_unconverged() {
                    self.to_improve = Some(Box::new(view.request.clone()));
                } else if view.fresh && !view.needs_replay {
                    self.to_time = Some(Box::new(StageMeasurement::new(view.clone())));
                }
                if view.look_result.is_unfinished {
                    self.to_complete = Some(Box::new(view.request.clone()));
                }
                if view.needs_replay {
                    self.replayer.set(&view.request);
                } else {
                    self.replayer.clear();
                }
                self.watcher.set_view(&view);
                self.done.push_back(WorkerResponse::View(Box::new(view)));
            }
            Err(panic) => self.done.push_back(WorkerResponse::Panicked(panic_text(&*panic))),
        }
    }
}

fn panic_text(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().copied().or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    text.unwrap_or("unknown reason").to_owned()
}
