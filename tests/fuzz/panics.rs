//! Recording of panics during executions, with location and message, instead of printing them.
//!
//! Panics that the program itself catches and reports are recorded as well, because they are still errors of the
//! program.

use std::cell::RefCell;
use std::panic::PanicHookInfo;
use std::sync::{Mutex, Once, PoisonError};
use std::thread;

/// Prefix of the names of threads that execute targets.
pub(crate) const THREADS: &str = "fuzz ";

/// Name of the window's renderer thread.
const RENDERER: &str = "renderer";

thread_local! {
    /// Panics of this thread since the last call of [`take_own`].
    static OWN: RefCell<Vec<String>> = const { RefCell::new(Vec::new()) };
}

/// The last panic of a thread that a target started.
static ELSEWHERE: Mutex<Option<String>> = Mutex::new(None);

/// Starts recording panics. Those of other threads, such as failed assertions of tests, are still printed.
pub(crate) fn record() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let print = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| match thread::current().name() {
            Some(name) if name.starts_with(THREADS) => OWN.with_borrow_mut(|own| own.push(described(info))),
            // Threads of pools and tasks have no name.
            None | Some(RENDERER) => {
                *ELSEWHERE.lock().unwrap_or_else(PoisonError::into_inner) = Some(described(info));
            }
            Some(_) => print(info),
        }));
    });
}

/// Returns the first panic of this thread since the last call, and clears the record.
pub(crate) fn take_own() -> Option<String> {
    OWN.take().into_iter().next()
}

/// Returns and clears the last panic of a thread that a target started.
pub(crate) fn take_elsewhere() -> Option<String> {
    ELSEWHERE.lock().unwrap_or_else(PoisonError::into_inner).take()
}

/// Formats a panic as `src/file.rs:12: message`.
fn described(info: &PanicHookInfo<'_>) -> String {
    let place = info.location().map_or_else(String::new, |place| format!("{}:{}: ", place.file(), place.line()));
    let message = info.payload_as_str().unwrap_or("no message");
    format!("{place}{message}")
}
