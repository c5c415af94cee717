//! Option `--shard` of the experiments that can be divided, and output of their parts.

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
