//! The stability report in the window: what is known of it, and the thread that makes it.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::sync::{Arc, Mutex};

use eframe::egui::Context;

use crate::report::stability::sweep::{Plan, Progress, Report, Stage, run};

/// How the stability report is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StabilityView {
    /// Classes against configurations.
    #[default]
    HeatMap,
    /// One point for each configuration.
    ErrorAgainstTime,
}

/// What is known of the stability report.
#[derive(Clone, Debug, Default)]
pub struct Stability {
    /// The last one that was finished.
    pub report: Option<Arc<Report>>,
    /// How far the one that is running has come.
    pub progress: Option<Progress>,
    /// How it is shown.
    pub view: StabilityView,
}

/// A stability report that is being made on a thread of its own.
#[derive(Debug)]
pub struct Judging {
    heard: Receiver<News>,
    stop: Arc<AtomicBool>,
}

/// What that thread has to say.
enum News {
    Progress(Progress),
    /// Without a report if it was cancelled.
    Done(Option<Box<Report>>),
}

/// Whether there is more to come from the thread.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Listening {
    /// It works on.
    GoesOn,
    /// It has said all.
    Ended,
    /// It is gone without a last word.
    BrokeOff,
}

impl Judging {
    /// Makes a report by `plan`; `context` is asked for a frame whenever there is news.
    pub fn start(plan: Plan, context: Context, known: &mut Stability) -> Self {
        let (sender, heard) = channel();
        let stop = Arc::new(AtomicBool::new(false));
        known.progress = Some(Progress { stage: Stage::Judging, done: 0, of: 1 });
        let cancelled = stop.clone();
        std::thread::spawn(move || {
            let tell = Mutex::new(sender);
            let say = |news| {
                // Nobody listens any more if the window is closed.
                drop(tell.lock().map(|sender| sender.send(news)));
                context.request_repaint();
            };
            let report = run(&plan, &|progress| say(News::Progress(progress)), &cancelled);
            say(News::Done(report.map(Box::new)));
        });
        Self { heard, stop }
    }

    /// Has the thread end soon; the last report stays.
    pub fn cancel(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    /// Takes what the thread has said since into what is `known`.
    pub fn listen(&self, known: &mut Stability) -> Listening {
        loop {
            match self.heard.try_recv() {
                Ok(News::Progress(progress)) => known.progress = Some(progress),
                Ok(News::Done(report)) => {
                    known.progress = None;
                    if let Some(report) = report {
                        known.report = Some(Arc::from(report));
                    }
                    return Listening::Ended;
                }
                Err(TryRecvError::Empty) => return Listening::GoesOn,
                Err(TryRecvError::Disconnected) => {
                    known.progress = None;
                    return Listening::BrokeOff;
                }
            }
        }
    }
}
