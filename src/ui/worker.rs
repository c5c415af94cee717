//! Renderer thread: the window sends requests without waiting, and is woken when there is an answer.
//!
//! Only the newest request counts; older ones that were not started are dropped. Between requests the thread works on
//! deferred tasks: timing the stages of the frame on screen, and measuring all upscalers on request. A panic in a stage
//! is caught and reported, and a new engine serves the next request.

mod measurement;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, RecvError, RecvTimeoutError, Sender, TryRecvError, channel};
use std::time::Duration;

use super::compare::compute::{CompareRequest, Compared, Comparer};
use super::engine::{Engine, Figuring, Request, StageFigures, View};
use super::watch::watcher::Watcher;
use super::what_if::drawer::{Drawer, Found, WhatIfRequest};
use crate::inspect::watch::Watched;
use crate::measure::noise::Noise;
use crate::upscale::Upscaling;
pub use measurement::MEASURE_ROUNDS;
pub use measurement::MeasureRequest;
use measurement::Measurement;
pub(crate) use measurement::MethodError;

/// Time for which a frame must stay before its stages are timed; while the view moves, all time goes to new frames.
const SETTLED: Duration = Duration::from_millis(120);

/// A request of the window.
#[derive(Debug)]
pub enum Job {
    /// Renders this view.
    Show(Box<Request>),
    /// Renders this comparison; ends the comparison if `None`.
    Compare(Option<Box<CompareRequest>>),
    /// Determines the effect of a change of settings; stops if `None`.
    WhatIf(Option<Box<WhatIfRequest>>),
    /// Reports the values of every new frame at these pixels.
    Watch(Vec<(u32, u32)>),
    /// Measures time and error of every upscaler.
    Measure(Box<MeasureRequest>),
    /// Cancels the measurement.
    CancelMeasure,
}

/// A message of the renderer.
#[derive(Debug)]
pub enum Answer {
    /// A view.
    View(Box<View>),
    /// Results of the comparison so far.
    Compared(Box<Compared>),
    /// Values of the newest frame at the watched pixels.
    Watched(Vec<Watched>),
    /// Known effects of the change of settings so far.
    WhatIf(Box<Found>),
    /// Counters and times of the stages of the last frame.
    Stages(Box<StageFigures>),
    /// One timed frame of a measurement.
    Sample {
        /// Number of the measurement.
        of: u64,
        /// Method that was timed.
        upscaling: Upscaling,
        /// Frame time, in milliseconds.
        milliseconds: f64,
        /// Completed share of the measurement, in [0, 1].
        progress: f32,
    },
    /// The error of a method, as far as it is known.
    Judged {
        /// Number of the measurement.
        of: u64,
        /// Method that was judged.
        upscaling: Upscaling,
        /// Error at rest and in motion.
        error: Box<MethodError>,
        /// Completed share of the measurement, in [0, 1].
        progress: f32,
    },
    /// The noise floor of the completed rounds.
    Noise {
        /// Number of the measurement.
        of: u64,
        /// Noise floor of frame times.
        noise: Noise,
    },
    /// The measurement with this number is complete.
    Measured(u64),
    /// A stage panicked with this message.
    Panicked(String),
}

/// Handle to the renderer: a thread of its own, or synchronous for screenshots and tests.
#[derive(Debug)]
pub enum Worker {
    /// Asynchronous: answers arrive later.
    Thread {
        /// Sender of requests to the thread.
        jobs: Sender<Job>,
        /// Receiver of answers from the thread.
        answers: Receiver<Answer>,
    },
    /// Synchronous: answers are ready when [`Worker::send`] returns.
    Inline(Box<Loop>),
}

impl Worker {
    /// Starts the thread. `wake` is called after every batch of answers. Falls back to a synchronous worker if no
    /// thread can be started.
    pub fn spawn(wake: impl Fn() + Send + 'static) -> Self {
        let (jobs, inbox) = channel();
        let (outbox, answers) = channel();
        std::thread::Builder::new()
            .name("renderer".to_owned())
            .spawn(move || Loop::default().serve(&inbox, &outbox, wake))
            .map_or_else(|_| Self::inline(), |_| Self::Thread { jobs, answers })
    }

    /// Creates a synchronous worker.
    pub fn inline() -> Self {
        Self::Inline(Box::default())
    }

    /// Sends a request; a synchronous worker also completes it.
    pub(crate) fn send(&mut self, job: Job) {
        match self {
            // The thread ends only with the window, so a failed send has no one to report to.
            Self::Thread { jobs, .. } => drop(jobs.send(job)),
            Self::Inline(work) => {
                work.take(job);
                while work.step() {}
            }
        }
    }

    /// Returns the next answer that is ready.
    pub(crate) fn poll(&mut self) -> Option<Answer> {
        match self {
            Self::Thread { answers, .. } => answers.try_recv().ok(),
            Self::Inline(work) => work.done.pop_front(),
        }
    }
}

/// Pending work and the state that it needs.
#[derive(Debug, Default)]
pub struct Loop {
    engine: Engine,
    to_show: Option<Box<Request>>,
    comparer: Comparer,
    to_compare: Option<Box<CompareRequest>>,
    drawer: Drawer,
    watcher: Watcher,
    to_ask: Option<Box<WhatIfRequest>>,
    /// Current request, if one more frame would improve its answer.
    to_improve: Option<Box<Request>>,
    /// Current request, if slow parts of its answer are still missing.
    to_complete: Option<Box<Request>>,
    to_time: Option<Box<Figuring>>,
    measurement: Option<Measurement>,
    done: std::collections::VecDeque<Answer>,
}

impl Loop {
    fn serve(mut self, inbox: &Receiver<Job>, outbox: &Sender<Answer>, wake: impl Fn()) {
        loop {
            match self.wait(inbox) {
                Ok(Some(job)) => self.take(job),
                Ok(None) => {}
                Err(RecvError) => return,
            }
            loop {
                match inbox.try_recv() {
                    Ok(job) => self.take(job),
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

    /// Waits for a job as long as the pending work allows. Blocks without pending work, returns at once for work that
    /// the user waits for, and waits [`SETTLED`] before work that a newer frame may make obsolete.
    fn wait(&self, inbox: &Receiver<Job>) -> Result<Option<Job>, RecvError> {
        let is_asked = self.to_show.is_some() || self.to_improve.is_some() || self.to_compare.is_some();
        if is_asked || self.to_ask.is_some() || self.watcher.has_work() || self.measurement.is_some() {
            return Ok(None);
        }
        let figuring = self.to_time.as_ref();
        let is_complete = self.to_complete.is_none();
        if figuring.is_none() && is_complete && !self.comparer.has_work() && !self.drawer.has_work() {
            return inbox.recv().map(Some);
        }
        if self.comparer.has_begun() || self.drawer.has_begun() || figuring.is_some_and(|figuring| figuring.has_begun())
        {
            return Ok(None);
        }
        match inbox.recv_timeout(SETTLED) {
            Ok(job) => Ok(Some(job)),
            Err(RecvTimeoutError::Timeout) => Ok(None),
            Err(RecvTimeoutError::Disconnected) => Err(RecvError),
        }
    }

    fn take(&mut self, job: Job) {
        match job {
            Job::Show(request) => self.to_show = Some(request),
            Job::Compare(None) => {
                self.to_compare = None;
                self.comparer.clear();
            }
            Job::Compare(request) => self.to_compare = request,
            Job::Watch(pixels) => self.watcher.set(pixels),
            Job::WhatIf(request) => {
                if request.is_none() {
                    self.drawer.clear();
                }
                self.to_ask = request;
            }
            Job::Measure(request) => self.measurement = Some(Measurement::new(request)),
            Job::CancelMeasure => self.measurement = None,
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
            self.compare(|comparer| Some(comparer.ask(*request)));
        } else if let Some(request) = self.to_ask.take() {
            self.ask(|drawer| drawer.ask(*request).cloned());
        } else if let Some(request) = self.to_complete.take() {
            self.show(*request);
        } else if self.comparer.has_work() {
            self.compare(Comparer::step);
        } else if self.drawer.has_work() {
            self.ask(|drawer| drawer.step().cloned());
        } else if let Some(mut figuring) = self.to_time.take() {
            match catch_unwind(AssertUnwindSafe(|| figuring.step())) {
                Ok(Some(figures)) => self.done.push_back(Answer::Stages(Box::new(figures))),
                Ok(None) => self.to_time = Some(figuring),
                Err(panic) => self.done.push_back(Answer::Panicked(panic_text(&*panic))),
            }
        } else if let Some(mut measurement) = self.measurement.take() {
            match catch_unwind(AssertUnwindSafe(|| measurement.step())) {
                Ok(sample) => self.done.extend(sample),
                Err(panic) => {
                    self.done.extend([Answer::Panicked(panic_text(&*panic)), Answer::Measured(measurement.number())]);
                    return true;
                }
            }
            if measurement.is_complete() {
                self.done.push_back(Answer::Measured(measurement.number()));
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
            Ok(compared) => self.done.extend(compared.map(|compared| Answer::Compared(Box::new(compared)))),
            Err(panic) => {
                self.comparer.clear();
                self.done.push_back(Answer::Panicked(panic_text(&*panic)));
            }
        }
    }

    /// Replays the watched pixels. A panic ends watching.
    fn watch(&mut self) {
        let watcher = &mut self.watcher;
        match catch_unwind(AssertUnwindSafe(|| watcher.step())) {
            Ok(rows) => self.done.extend(rows.map(Answer::Watched)),
            Err(panic) => {
                self.watcher = Watcher::default();
                self.done.push_back(Answer::Panicked(panic_text(&*panic)));
            }
        }
    }

    /// Runs one step of determining the effect of a change. A panic ends it.
    fn ask(&mut self, piece: impl FnOnce(&mut Drawer) -> Option<Found>) {
        let drawer = &mut self.drawer;
        match catch_unwind(AssertUnwindSafe(|| piece(drawer))) {
            Ok(found) => self.done.extend(found.map(|found| Answer::WhatIf(Box::new(found)))),
            Err(panic) => {
                self.drawer.clear();
                self.done.push_back(Answer::Panicked(panic_text(&*panic)));
            }
        }
    }

    fn show(&mut self, request: Request) {
        let mut engine = std::mem::take(&mut self.engine);
        match catch_unwind(AssertUnwindSafe(|| (engine.answer(request), engine))) {
            Ok((view, engine)) => {
                self.engine = engine;
                if view.wants_another() {
                    self.to_improve = Some(Box::new(view.request.clone()));
                } else if view.fresh {
                    self.to_time = Some(Box::new(Figuring::new(view.clone())));
                }
                if view.looked.is_unfinished {
                    self.to_complete = Some(Box::new(view.request.clone()));
                }
                self.watcher.look_at(&view);
                self.done.push_back(Answer::View(Box::new(view)));
            }
            Err(panic) => self.done.push_back(Answer::Panicked(panic_text(&*panic))),
        }
    }
}

fn panic_text(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().copied().or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    text.unwrap_or("unknown reason").to_owned()
}
