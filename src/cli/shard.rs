//! Experiments that can be divided: the option `--shard`, the output of parts, and the merged result.

use std::path::Path;

use crate::measure::part::{self, Experiment};
use crate::measure::shard::{Shard, ShardRun};
use clap::Args;
use serde::Serialize;

use super::failure::Failure;
use super::{interrupt, output};

/// Option that divides an experiment.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct ShardArgs {
    /// Run only share I of N, and write a part instead of the result: one JSON file, to -o or standard output. `merge`
    /// combines the N parts
    #[arg(long, value_name = "I/N")]
    pub(crate) shard: Option<Shard>,
}

/// Writes a part to a file or to standard output. Returns an error if its run was interrupted.
pub(crate) fn write_part(
    path: Option<&Path>,
    experiment: Experiment,
    plan: impl Serialize,
    run: ShardRun<impl Serialize>,
) -> Result<(), Failure> {
    let partial = run.partial;
    let text = part::to_json(experiment, plan, run).map_err(|error| Failure::Output(error.into()))?;
    match path {
        None => output::print(&text)?,
        Some(path) => output::write(path, &text)?,
    }
    interrupt::outcome(partial)
}

/// Result of an experiment whose parts were merged.
pub(crate) struct Merged {
    /// Name and content of each file.
    pub(crate) files: Vec<(&'static str, Vec<u8>)>,
    /// Whether a part was interrupted.
    pub(crate) partial: bool,
}
