//! Upscalers that run as external processes, in any language.
//!
//! A process is started at its first use, and upscales all frames one after the other. [`protocol`] defines the messages
//! on its standard input and output. If it fails, the failure is recorded once, the process is stopped, and its upscaler
//! repeats the nearest sample until [`Upscaler::retry`] is called.
//!
//! Only [`register_process`] adds such an upscaler, so that no file can start a process.

mod connection;
mod failure;
mod protocol;
mod spec;
#[cfg(all(test, unix))]
mod tests;

use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use connection::{Connection, TimeLimits};
pub use failure::ProcessFailure;
pub use failure::ProcessFault;
pub use failure::failures_after;
use protocol::FrameMessage;
pub use spec::ProcessSpec;

use super::nearest::NEAREST;
use super::{
    Accumulated, Anchor, FilterSpace, Offers, Reads, RegisterError, Sampling, Scale, Tap, UpscaleInputs, Upscaled,
    Upscaler, Upscaling, register_boxed,
};
use crate::image::{Image, Rgba8};
use crate::pipeline::settings::Choice as _;

/// Ratio of the time limit for the start of a process to that for a frame. Programs that load a network start slowly.
const START_LIMIT: u32 = 5;

/// Adds an upscaler that runs as an external process. `limit` is the time limit for a frame; the start may take five
/// times as long. The process starts at the first use of the upscaler.
///
/// # Errors
/// Fails like [`register`](super::register).
pub fn register_process(spec: &ProcessSpec, limit: Duration) -> Result<(), RegisterError> {
    register_boxed(Box::new(ProcessUpscaler::new(spec, limit)))
}

/// Upscaler that sends the drawn samples to a process.
struct ProcessUpscaler {
    spec: ProcessSpec,
    limits: TimeLimits,
    id: &'static str,
    help: &'static str,
    scales: &'static [Scale],
    /// Running process; `None` before its start and after a failure.
    connection: Mutex<Option<Connection>>,
    /// Message of the failure since which the process is not started; separate, because the lock of the connection is
    /// held while the process works.
    failure: Mutex<Option<String>>,
}

impl ProcessUpscaler {
    fn new(spec: &ProcessSpec, limit: Duration) -> Self {
        let help = format!(
            "External process: {}. Its picture is explained only as a whole: the inspector lists the nearest sample of a \
             pixel. If the process fails, each sample is repeated over its block until the process is restarted.",
            spec.command_text()
        );
        // An upscaler stays registered until the program ends, and so do its texts.
        Self {
            limits: TimeLimits { start: limit.saturating_mul(START_LIMIT), frame: limit },
            id: String::leak(spec.id.clone()),
            help: String::leak(help),
            scales: Vec::leak(spec.scales.clone()),
            connection: Mutex::default(),
            failure: Mutex::default(),
            spec: spec.clone(),
        }
    }

    /// Lets the process upscale a frame, and returns the time of the transfer. Starts the process if it is not running.
    /// Returns `None` if the process fails or has failed; `full` then has undefined contents.
    fn exchange(&self, how: Upscaling, drawn: &UpscaleInputs<'_>, full: &mut Image<Rgba8>) -> Option<Duration> {
        let depth = self.spec.depth.then(|| depths(self.sampling(how), drawn));
        // Nothing below runs on the thread pool: another task of it could wait for the same lock.
        let mut connection = self.connection.lock().unwrap_or_else(PoisonError::into_inner);
        if self.failure().is_some() {
            return None;
        }
        let message = FrameMessage {
            number: 0,
            color: drawn.color,
            depth: depth.as_deref(),
            lattice: how.lattice(),
            size: full.size(),
        };
        let exchanged = match &mut *connection {
            Some(running) => Ok(running),
            none => Connection::start(&self.spec, self.limits).map(|started| none.insert(started)),
        };
        match exchanged.and_then(|running| running.upscale(&self.spec, message, full, self.limits.frame)) {
            Ok(transfer) => Some(transfer),
            Err(fault) => {
                *connection = None;
                let failure = ProcessFailure { id: self.spec.id.clone(), command: self.spec.command_text(), fault };
                *self.failure.lock().unwrap_or_else(PoisonError::into_inner) = Some(failure.to_string());
                failure::record(failure);
                None
            }
        }
    }
}

/// Returns the distance along the view axis of each drawn sample. All distances are infinite if they are unknown.
fn depths(sampling: Sampling, drawn: &UpscaleInputs<'_>) -> Vec<f32> {
    let (columns, rows) = drawn.color.size();
    let samples = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
    let distance = |sample: (u32, u32)| {
        let (x, y) = match sampling {
            Sampling::Grid(grid) => grid.pixel(sample.0, sample.1),
            Sampling::Lattice(_) => sample,
        };
        drawn.frame.map_or(f32::INFINITY, |frame| frame.gbuffer.distance.at(x, y))
    };
    samples.map(distance).collect()
}

impl Upscaler for ProcessUpscaler {
    fn id(&self) -> &'static str {
        self.id
    }

    fn name(&self) -> &'static str {
        self.id
    }

    fn help(&self) -> &'static str {
        self.help
    }

    fn offers(&self) -> Offers {
        Offers {
            scales: self.scales,
            anchors: Anchor::ALL,
            lights: &[FilterSpace::Bytes],
            deringing: false,
            sharpening: false,
            history: false,
        }
    }

    fn reads(&self) -> Reads {
        Reads { gbuffer: self.spec.depth, history: false }
    }

    fn is_opaque(&self) -> bool {
        true
    }

    fn process(&self) -> Option<&str> {
        Some(&self.spec.text)
    }

    fn failure(&self) -> Option<String> {
        self.failure.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn retry(&self) {
        *self.failure.lock().unwrap_or_else(PoisonError::into_inner) = None;
    }

    fn sampling(&self, how: Upscaling) -> Sampling {
        Sampling::of_lattice(how.lattice())
    }

    fn upscale(&self, how: Upscaling, drawn: &UpscaleInputs<'_>, full: &mut Image<Rgba8>) {
        self.upscale_with_history(how, drawn, full, None);
    }

    fn upscale_with_history(
        &self,
        how: Upscaling,
        drawn: &UpscaleInputs<'_>,
        full: &mut Image<Rgba8>,
        _memory: Option<Accumulated>,
    ) -> Upscaled {
        if full.pixels().is_empty() {
            return Upscaled::default();
        }
        let transfer = self.exchange(how, drawn, full);
        if transfer.is_none() {
            NEAREST.upscale(how, drawn, full);
        }
        Upscaled { history: None, transfer: transfer.unwrap_or_default() }
    }

    fn pixel(&self, how: Upscaling, drawn: &UpscaleInputs<'_>, size: (u32, u32), at: (u32, u32)) -> Rgba8 {
        NEAREST.pixel(how, drawn, size, at)
    }

    fn taps(&self, how: Upscaling, drawn: &UpscaleInputs<'_>, size: (u32, u32), at: (u32, u32)) -> Vec<Tap> {
        NEAREST.taps(how, drawn, size, at)
    }
}
