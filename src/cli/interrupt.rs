//! Interruption of a long measurement by Ctrl+C: complete results are written and marked as partial.

use std::process::exit;
use std::sync::atomic::{AtomicBool, Ordering};

use super::failure::{Failure, INTERRUPTED};

static FLAG: AtomicBool = AtomicBool::new(false);

/// Returns a flag that the first SIGINT, SIGTERM or SIGHUP sets; the second ends the process at once.
pub(crate) fn flag() -> &'static AtomicBool {
    let interrupt = || {
        if FLAG.swap(true, Ordering::Relaxed) {
            exit(INTERRUPTED.into());
        }
    };
    // Without a handler the signals end the process, as for any other command.
    drop(ctrlc::set_handler(interrupt));
    &FLAG
}

/// Returns an error if a measurement was interrupted and its results are therefore partial.
pub(crate) fn outcome(is_partial: bool) -> Result<(), Failure> {
    if is_partial { Err(Failure::Interrupted("the results so far are written and marked as partial")) } else { Ok(()) }
}

/// Returns the error for a measurement that was interrupted before any result was complete.
pub(crate) fn nothing() -> Failure {
    Failure::Interrupted("no result was complete, so nothing is written")
}
