//! The renderer's thread: the window asks, goes on, and is woken when there is something new.
//!
//! Only the newest request counts; older ones that were not begun are dropped. Between requests the thread works on
//! what can wait: timing the stages of the frame that is on screen, and measuring all upscalers when asked to. A panic
//! in a stage is caught and reported, and the next request is served by a new engine.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, RecvError, RecvTimeoutError, Sender, TryRecvError, channel};
use std::time::{Duration, Instant};

use super::engine::{Engine, Figuring, Request, StageFigures, View};
use crate::chain::{KeepDepth, Recipe, Renderer};
use crate::upscale::Upscaling;

/// Rounds of a measurement; every round times every method once, so that drift of the machine's speed hits all alike.
pub const MEASURE_ROUNDS: usize = 25;

/// Rounds before those, which do not count: caches and clocks settle.
const WARM_UP_ROUNDS: usize = 2;

/// A frame that stays this long is taken apart into stages; while the view moves, all time goes to new frames.
const SETTLED: Duration = Duration::from_millis(120);

/// What the window asks for.
#[derive(Debug)]
pub enum Job {
    /// Show this.
    Show(Box<Request>),
    /// Time every upscaler on this request's scene.
    Measure(Box<Request>),
    /// Stop timing.
    CancelMeasure,
}

/// What the thread sends back.
#[derive(Debug)]
pub enum Answer {
    /// A view.
    View(Box<View>),
    /// Counts and times of the stages of the last frame.
    Stages(Box<StageFigures>),
    /// One timed frame of a measurement, and how much of it is done, in [0, 1].
    Sample {
        /// The method.
        upscaling: Upscaling,
        /// The frame's time, milliseconds.
        milliseconds: f64,
        /// Share of the measurement that is done.
        progress: f32,
    },
    /// The measurement is complete.
    Measured,
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
    to_time: Option<Box<Figuring>>,
    measurement: Option<Measurement>,
    done: std::collections::VecDeque<Answer>,
}

#[derive(Debug)]
struct Measurement {
    request: Box<Request>,
    methods: Vec<Upscaling>,
    next: usize,
    renderer: Renderer,
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
        if self.to_show.is_some() || self.measurement.is_some() {
            return Ok(None);
        }
        let Some(figuring) = &self.to_time else {
            return inbox.recv().map(Some);
        };
        if figuring.has_begun() {
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
            Job::Measure(request) => {
                let methods = Upscaling::every().collect();
                self.measurement = Some(Measurement { request, methods, next: 0, renderer: Renderer::default() });
            }
            Job::CancelMeasure => self.measurement = None,
        }
    }

    /// Does one piece of the most urgent work; false if there was none.
    fn step(&mut self) -> bool {
        if let Some(request) = self.to_show.take() {
            self.show(*request);
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
                    self.done.extend([Answer::Panicked(panic_text(&*panic)), Answer::Measured]);
                    return true;
                }
            }
            if measurement.is_complete() {
                self.done.push_back(Answer::Measured);
            } else {
                self.measurement = Some(measurement);
            }
        } else {
            return false;
        }
        true
    }

    fn show(&mut self, request: Request) {
        let mut engine = std::mem::take(&mut self.engine);
        match catch_unwind(AssertUnwindSafe(|| (engine.answer(request), engine))) {
            Ok((view, engine)) => {
                self.engine = engine;
                if view.fresh {
                    self.to_time = Some(Box::new(Figuring::new(view.clone())));
                }
                self.done.push_back(Answer::View(Box::new(view)));
            }
            Err(panic) => self.done.push_back(Answer::Panicked(panic_text(&*panic))),
        }
    }
}

impl Measurement {
    fn total(&self) -> usize {
        (WARM_UP_ROUNDS + MEASURE_ROUNDS) * self.methods.len()
    }

    fn is_complete(&self) -> bool {
        self.next >= self.total()
    }

    /// Times one frame of the next method in turn. Nothing to report during warm-up.
    fn step(&mut self) -> Option<Answer> {
        let upscaling = *self.methods.get(self.next % self.methods.len().max(1))?;
        let round = self.next / self.methods.len();
        self.next += 1;
        let Request { scene, camera, recipe, viewport, .. } = &*self.request;
        let recipe = Recipe { upscaler: upscaling, ..*recipe };
        let start = Instant::now();
        let frame = self.renderer.render(scene, camera, &recipe, *viewport, KeepDepth::No);
        let milliseconds = start.elapsed().as_secs_f64() * 1e3;
        self.renderer.recycle(frame);
        let progress = self.next as f32 / self.total() as f32;
        (round >= WARM_UP_ROUNDS).then_some(Answer::Sample { upscaling, milliseconds, progress })
    }
}

fn panic_text(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().copied().or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    text.unwrap_or("no reason given").to_owned()
}
