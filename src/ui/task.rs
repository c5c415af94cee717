//! Work on a thread of its own that tells how far it has come and can be cancelled.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::sync::{Arc, Mutex};

use eframe::egui::Context;

/// Work that is being done; `P` is how far it has come, `T` what comes of it. Dropping it cancels it, so that work
/// that is begun anew does not go on twice.
#[derive(Debug)]
pub struct Task<P, T> {
    heard: Receiver<News<P, T>>,
    stop: Arc<AtomicBool>,
}

/// What the thread has to say.
enum News<P, T> {
    Progress(P),
    /// Without a result if it was cancelled.
    Done(Option<Box<T>>),
}

/// Whether there is more to come from the thread.
#[derive(Debug)]
pub enum Listening<T> {
    /// It works on.
    GoesOn,
    /// It has said all; without a result if it was cancelled.
    Ended(Option<Box<T>>),
    /// It is gone without a last word.
    BrokeOff,
}

impl<P, T> Drop for Task<P, T> {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}

impl<P: Send + 'static, T: Send + 'static> Task<P, T> {
    /// Does `work`, which hears when to stop; `context` is asked for a frame whenever there is news.
    pub fn start(
        context: Context,
        work: impl FnOnce(&(dyn Fn(P) + Sync), &AtomicBool) -> Option<T> + Send + 'static,
    ) -> Self {
        let (sender, heard) = channel();
        let stop = Arc::new(AtomicBool::new(false));
        let cancelled = stop.clone();
        std::thread::spawn(move || {
            let tell = Mutex::new(sender);
            let say = |news| {
                // Nobody listens any more if the window is closed.
                drop(tell.lock().map(|sender| sender.send(news)));
                context.request_repaint();
            };
            let result = work(&|progress| say(News::Progress(progress)), &cancelled);
            say(News::Done(result.map(Box::new)));
        });
        Self { heard, stop }
    }

    /// Has the thread end soon.
    pub fn cancel(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    /// Takes what the thread has said since; `progress` is set to the last of it, and to nothing at the end.
    pub fn listen(&self, progress: &mut Option<P>) -> Listening<T> {
        loop {
            match self.heard.try_recv() {
                Ok(News::Progress(news)) => *progress = Some(news),
                Ok(News::Done(result)) => {
                    *progress = None;
                    return Listening::Ended(result);
                }
                Err(TryRecvError::Empty) => return Listening::GoesOn,
                Err(TryRecvError::Disconnected) => {
                    *progress = None;
                    return Listening::BrokeOff;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dropped_work_is_told_to_stop() {
        let (sender, stopped) = channel();
        let task = Task::<(), ()>::start(Context::default(), move |_, stop| {
            while !stop.load(Ordering::Relaxed) {
                std::thread::yield_now();
            }
            sender.send(()).ok()
        });
        drop(task);
        assert_eq!(stopped.recv_timeout(std::time::Duration::from_secs(60)), Ok(()));
    }
}
