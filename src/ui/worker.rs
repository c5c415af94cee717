//! The renderer's thread: the window asks, goes on, and is woken when there is something new.
//!
//! Only the newest request counts; older ones that were not begun are dropped. Between requests the thread works on
//! what can wait: timing the stages of the frame that is on screen, and measuring all upscalers when asked to. A panic
//! in a stage is caught and reported, and the next request is served by a new engine.

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
use measurement::Measurement;
pub use measurement::{MEASURE_ROUNDS, MeasureRequest, MethodError};

/// A frame that stays this long is taken apart into stages; while the view moves, all time goes to new frames.
const SETTLED: Duration = Duration::from_millis(120);

/// What the window asks for.
#[derive(Debug)]
pub enum Job {
    /// Show this.
    Show(Box<Request>),
    /// Compare these; nothing any more if none.
    Compare(Option<Box<CompareRequest>>),
    /// Find out what a change does; nothing any more if none.
    WhatIf(Option<Box<WhatIfRequest>>),
    /// Tell what every new frame holds at these pixels.
    Watch(Vec<(u32, u32)>),
    /// Time and judge every upscaler.
    Measure(Box<MeasureRequest>),
    /// Stop timing.
    CancelMeasure,
}

/// What the thread sends back.
#[derive(Debug)]
pub enum Answer {
    /// A view.
    View(Box<View>),
    /// What is known by now of what is compared.
    Compared(Box<Compared>),
    /// What the newest frame holds at the watched pixels.
    Watched(Vec<Watched>),
    /// What is known by now of what a change does.
    WhatIf(Box<Found>),
    /// Counts and times of the stages of the last frame.
    Stages(Box<StageFigures>),
    /// One timed frame of a measurement, and how much of it is done, in [0, 1].
    Sample {
        /// The number of the measurement.
        of: u64,
        /// The method.
        upscaling: Upscaling,
        /// The frame's time, milliseconds.
        milliseconds: f64,
        /// Share of the measurement that is done.
        progress: f32,
    },
    /// The error of a method, as far as it is known.
    Judged {
        /// The number of the measurement.
        of: u64,
        /// The method.
        upscaling: Upscaling,
        /// Error at rest and in motion.
        error: Box<MethodError>,
        /// Share of the measurement that is done.
        progress: f32,
    },
    /// The noise floor of the rounds that are complete.
    Noise {
        /// The number of the measurement.
        of: u64,
        /// The noise floor of frame times.
        noise: Noise,
    },
    /// The measurement of this number is complete.
    Measured(u64),
    /// A stage panicked.
    Panicked(String),
}

/// Handle to the renderer: a thread of its own, or none at all for screenshots and tests.
#[derive(Debug)]
pub enum Worker {
    /// Answers come later.
    Thread {
        /// To the thread.
        jobs: Sender<Job>,
        /// From the thread.
        answers: Receiver<Answer>,
    },
    /// Answers are there when [`Worker::send`] returns.
    Inline(Box<Loop>),
}

impl Worker {
    /// Starts the thread. `wake` is called after every answer.
    pub fn spawn(wake: impl Fn() + Send + 'static) -> Self {
        let (jobs, inbox) = channel();
        let (outbox, answers) = channel();
        std::thread::Builder::new()
            .name("renderer".to_owned())
            .spawn(move || Loop::default().serve(&inbox, &outbox, wake))
            .map_or_else(|_| Self::inline(), |_| Self::Thread { jobs, answers })
    }

    /// A worker that works while it is asked.
    pub fn inline() -> Self {
        Self::Inline(Box::default())
    }

    /// Asks.
    pub fn send(&mut self, job: Job) {
        match self {
            // The thread ends only with the window; there is nobody left to tell.
            Self::Thread { jobs, .. } => drop(jobs.send(job)),
            Self::Inline(work) => {
                work.take(job);
                while work.step() {}
            }
        }
    }

    /// The next answer that is ready.
    pub fn poll(&mut self) -> Option<Answer> {
        match self {
            Self::Thread { answers, .. } => answers.try_recv().ok(),
            Self::Inline(work) => work.done.pop_front(),
        }
    }
}

/// The work that waits, in order of urgency.
#[derive(Debug, Default)]
pub struct Loop {
    engine: Engine,
    to_show: Option<Box<Request>>,
    comparer: Comparer,
    to_compare: Option<Box<CompareRequest>>,
    drawer: Drawer,
    watcher: Watcher,
    to_ask: Option<Box<WhatIfRequest>>,
    /// The present request, if one more frame of it is better than the last.
    to_improve: Option<Box<Request>>,
    /// The present request, if a part of its answer takes long and is yet to be made.
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

    /// Waits for a job as long as the present work allows: for ever without any, not at all for what a person waits for,
    /// and a moment before taking apart a frame that the next one may replace.
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

    /// Does one piece of the most urgent work; false if there was none.
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

    /// Does one piece of a comparison and tells what is known then. One that panicked is given up.
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

    /// Replays the watched pixels. If that panicked they are watched no more.
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

    /// Does one piece of finding out what a change does. One that panicked is given up.
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
    text.unwrap_or("no reason given").to_owned()
}
