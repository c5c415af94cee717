//! Background tasks that report progress and can be cancelled.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::sync::{Arc, Mutex};

use eframe::egui::Context;

/// Running background task with progress reports of type `P` and a result of type `T`. Dropping this value cancels the
/// task, so replacing it with a new task ends the old one.
#[derive(Debug)]
pub(crate) struct BackgroundTask<P, T> {
    receiver: Receiver<Message<P, T>>,
    stop: Arc<AtomicBool>,
}

/// Message from the thread of a task.
enum Message<P, T> {
    Progress(P),
    /// Result of the task; `None` if it was cancelled.
    Done(Option<Box<T>>),
}

/// State of a background task, as returned by [`BackgroundTask::poll`].
#[derive(Debug)]
pub(crate) enum TaskStatus<T> {
    /// The task is running.
    Running,
    /// The task has ended with this result; `None` if it was cancelled.
    Ended(Option<Box<T>>),
    /// The thread ended without a result, for example because it panicked.
    Lost,
}

impl<P, T> Drop for BackgroundTask<P, T> {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}

impl<P: Send + 'static, T: Send + 'static> BackgroundTask<P, T> {
    /// Starts `work` on a new thread. The arguments of `work` are a function for progress reports and a cancellation
    /// flag. Requests a repaint of `context` after every message.
    pub(crate) fn start(
        context: Context,
        work: impl FnOnce(&(dyn Fn(P) + Sync), &AtomicBool) -> Option<T> + Send + 'static,
    ) -> Self {
        let (sender, receiver) = channel();
        let stop = Arc::new(AtomicBool::new(false));
        let cancelled = stop.clone();
        std::thread::spawn(move || {
            let sender = Mutex::new(sender);
            let say = |news| {
                // The receiver is gone if the window is closed.
                drop(sender.lock().map(|sender| sender.send(news)));
                context.request_repaint();
            };
            let result = work(&|progress| say(Message::Progress(progress)), &cancelled);
            say(Message::Done(result.map(Box::new)));
        });
        Self { receiver, stop }
    }

    /// Requests cancellation; the thread ends soon afterwards.
    pub(crate) fn cancel(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    /// Receives all pending messages from the thread. Sets `progress` to the latest report, or to `None` at the end of
    /// the task.
    pub(crate) fn poll(&self, progress: &mut Option<P>) -> TaskStatus<T> {
        loop {
            match self.receiver.try_recv() {
                Ok(Message::Progress(news)) => *progress = Some(news),
                Ok(Message::Done(result)) => {
                    *progress = None;
                    return TaskStatus::Ended(result);
                }
                Err(TryRecvError::Empty) => return TaskStatus::Running,
                Err(TryRecvError::Disconnected) => {
                    *progress = None;
                    return TaskStatus::Lost;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dropping_a_task_cancels_it() {
        let (sender, stopped) = channel();
        let task = BackgroundTask::<(), ()>::start(Context::default(), move |_, stop| {
            while !stop.load(Ordering::Relaxed) {
                std::thread::yield_now();
            }
            sender.send(()).ok()
        });
        drop(task);
        assert_eq!(stopped.recv_timeout(std::time::Duration::from_secs(60)), Ok(()));
    }
}
