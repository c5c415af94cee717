//! Options for upscalers that run as external processes, and the report of their failures.

use std::time::Duration;

use crate::upscale::process::{ProcessSpec, failures_after, register_process};
use clap::Args;

use super::failure::Failure;
use super::output;

/// Options for upscalers that run as external processes.
#[derive(Args, Clone, Debug)]
pub(crate) struct UpscalerArgs {
    /// Add an upscaler that runs as an external process; may be given several times
    #[arg(long, value_name = "ID[:OPTION,…]=COMMAND", long_help = PROCESS_HELP)]
    upscaler_process: Vec<ProcessSpec>,

    /// Time limit in seconds for an upscaler process to answer a frame; its start may take five times as long
    #[arg(long, value_name = "SECONDS", default_value = "2", value_parser = seconds)]
    upscaler_timeout: Duration,
}

const PROCESS_HELP: &str = "Add an upscaler that runs as an external process; may be given several times. The process \
    is started at the first use of the upscaler `ID` and upscales all frames. Options: scales (default: 2); `f32` for \
    colours as floats instead of bytes; `depth` to send depths, too. The command is not interpreted by a shell. The \
    manual documents the protocol in the chapter on upscalers.\n\
    Example: --upscaler-process 'my-net:2,4=python3 net.py' --set upscaler.method=my-net";

impl UpscalerArgs {
    /// Registers the upscalers. Must be called before a recipe is read, and at most once.
    pub(crate) fn register(&self) -> Result<(), Failure> {
        self.upscaler_process.iter().try_for_each(|spec| {
            register_process(spec, self.upscaler_timeout)
                .map_err(|error| Failure::Usage(format!("--upscaler-process: {error}")))
        })
    }
}

/// Parses a time limit in seconds.
fn seconds(text: &str) -> Result<Duration, String> {
    let limit = text.trim().parse().ok().filter(|limit| (0.01..=3600.0).contains(limit));
    limit.map(Duration::from_secs_f64).ok_or_else(|| "expected a time in seconds from 0.01 to 3600".to_owned())
}

/// Reports all failures of upscaler processes on standard error. A command that was otherwise successful fails because
/// of the last one.
pub(crate) fn with_process_failures(outcome: Result<(), Failure>) -> Result<(), Failure> {
    let mut failures = failures_after(0);
    let last = if outcome.is_ok() { failures.pop() } else { None };
    failures.iter().for_each(|failure| output::report("error", failure));
    last.map_or(outcome, |failure| Err(Failure::UpscalerProcess(failure)))
}
