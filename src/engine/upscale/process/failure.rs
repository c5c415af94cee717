//! Failures of upscaler processes, and the list of all of them.

use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use thiserror::Error;

/// All failures since the start of the program, oldest first.
static FAILURES: Mutex<Vec<ProcessFailure>> = Mutex::new(Vec::new());

/// Failure of an upscaler process. The process is stopped; until it is restarted, its upscaler repeats the nearest
/// sample.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("upscaler `{id}`, process `{command}`: {fault}; its pictures are filled in by nearest neighbour instead")]
pub struct ProcessFailure {
    /// Id of the upscaler.
    pub id: String,
    /// Command that was started.
    pub command: String,
    /// Cause of the failure.
    pub fault: ProcessFault,
}

/// Cause of the failure of an upscaler process.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ProcessFault {
    /// The operating system cannot start the command.
    #[error("it cannot be started: {0}")]
    Start(String),
    /// The process ended or closed its standard output, with this status and last line of standard error.
    #[error("it ended with {status}; {}", last_words(stderr))]
    Ended {
        /// Exit code or signal.
        status: String,
        /// Last line on standard error; empty if there is none.
        stderr: String,
    },
    /// The process did not answer in time.
    #[error("no complete answer within {limit:?}: {received} of {expected} bytes of {awaited} arrived")]
    TooSlow {
        /// Time limit.
        limit: Duration,
        /// Part of the answer that was awaited.
        awaited: &'static str,
        /// Number of bytes of this part that arrived.
        received: usize,
        /// Number of bytes of this part.
        expected: usize,
    },
    /// The answer to the opening message does not start with the magic bytes.
    #[error("its first bytes are `{0}`, not the header `RSUPSCAL` and a version; it must write nothing else there")]
    NoHeader(String),
    /// The process uses another version of the protocol.
    #[error("it answers with version {0} of the protocol; this program uses version 1")]
    Version(u32),
    /// The answer belongs to another frame, for example because an earlier answer was too long.
    #[error("it answers to frame {found} instead of {expected}; an earlier answer may be too long or too short")]
    OutOfStep {
        /// Number of the frame that was sent.
        expected: u32,
        /// Number in the answer.
        found: u32,
    },
    /// The picture has another size than requested.
    #[error("its picture has {} × {} px instead of {} × {} px", found.0, found.1, expected.0, expected.1)]
    WrongSize {
        /// Requested width and height, in pixels.
        expected: (u32, u32),
        /// Width and height in the answer.
        found: (u32, u32),
    },
    /// A value of a picture in the format `f32` is not a number, or outside [0, 1].
    #[error("{channel} of pixel ({}, {}) is {value}; values must lie in 0…1", at.0, at.1)]
    BadValue {
        /// Column and row of the first such pixel.
        at: (usize, usize),
        /// Name of the colour channel.
        channel: &'static str,
        /// The value.
        value: f32,
    },
}

fn last_words(stderr: &str) -> String {
    if stderr.is_empty() {
        "it wrote nothing to standard error".to_owned()
    } else {
        format!("last line of its standard error: {stderr}")
    }
}

/// Returns the failures since the start of the program without the first `known` ones, oldest first.
pub fn failures_after(known: usize) -> Vec<ProcessFailure> {
    FAILURES.lock().unwrap_or_else(PoisonError::into_inner).iter().skip(known).cloned().collect()
}

/// Adds a failure to the list that [`failures_after`] returns.
pub(super) fn record(failure: ProcessFailure) {
    FAILURES.lock().unwrap_or_else(PoisonError::into_inner).push(failure);
}
