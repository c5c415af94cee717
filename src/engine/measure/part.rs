//! Parts of an experiment: JSON files, one per shard, which are merged into the result of the whole experiment.
//!
//! A part contains the complete plan, so that merging needs neither the options nor the inputs of the experiment, and
//! can refuse parts of another one.

use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use thiserror::Error;

use super::shard::{Shard, ShardRun};
use crate::{disk, text};

/// Version of the format of parts, to be increased with every change of a plan or of results.
const FORMAT: u32 = 3;

/// Maximum size of a part, in bytes.
const MAX_PART_BYTES: u64 = 4 << 30;

/// Largest number of missing shards that a message lists.
const MAX_LISTED: usize = 8;

/// Kind of experiment that can be divided into shards.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Experiment {
    /// Explanations of another renderer's pictures.
    Explain,
    /// Probe of a view with jittered inputs.
    Probe,
    /// Error against run time of every upscaler.
    Report,
    /// Numerical stability on hard cases.
    Stability,
}

impl Experiment {
    /// Returns the name of the command that runs the experiment.
    fn command(self) -> &'static str {
        match self {
            Self::Explain => "explain",
            Self::Probe => "probe",
            Self::Report => "report",
            Self::Stability => "stability",
        }
    }
}

/// First fields of every part, whatever its format.
#[derive(Serialize, Deserialize)]
struct Head {
    /// Version of the format.
    part_format: u32,
    /// Package version of the program that wrote the part.
    rasterscope: String,
}

impl Head {
    fn current() -> Self {
        Self { part_format: FORMAT, rasterscope: env!("CARGO_PKG_VERSION").to_owned() }
    }
}

/// Content of a part.
#[derive(Serialize, Deserialize)]
struct Part<P, R> {
    #[serde(flatten)]
    head: Head,
    experiment: Experiment,
    plan: P,
    run: ShardRun<R>,
}

/// Reason why parts cannot be merged.
#[derive(Debug, Error)]
pub enum PartError {
    /// A part cannot be read.
    #[error("{}: cannot read it: {source}", text::path(file))]
    Unreadable {
        /// Path of the part.
        file: PathBuf,
        /// Error from the operating system.
        source: std::io::Error,
    },
    /// A file is not a part, or a damaged one.
    #[error("{}: not a complete part of an experiment: {reason}", text::path(file))]
    Damaged {
        /// Path of the file.
        file: PathBuf,
        /// First fault that was found.
        reason: String,
    },
    /// A part was written by another version of the program.
    #[error("{}: written by Rasterscope {found}, but this is {}; merge with the version that wrote the parts",
        text::path(file), env!("CARGO_PKG_VERSION"))]
    OtherVersion {
        /// Path of the part.
        file: PathBuf,
        /// Version of the program that wrote it, with the format if only that differs.
        found: String,
    },
    /// Two parts belong to different experiments.
    #[error("{}: part of another experiment than {}: {difference}", text::path(file), text::path(first))]
    Foreign {
        /// Path of the part.
        file: PathBuf,
        /// Path of the first part.
        first: PathBuf,
        /// First difference between the two.
        difference: String,
    },
    /// Two parts contain the same shard.
    #[error("{} and {} are both shard {shard}", text::path(first), text::path(file))]
    Duplicate {
        /// Path of the second part.
        file: PathBuf,
        /// Path of the first part.
        first: PathBuf,
        /// Shard that both contain.
        shard: Shard,
    },
    /// Some shards are in none of the parts.
    #[error("{missing} missing besides {}", text::path(file))]
    Missing {
        /// Path of a part that exists.
        file: PathBuf,
        /// The missing shards, and the verb.
        missing: String,
    },
}

/// Serialises a part as one line of JSON.
pub fn to_json<P: Serialize, R: Serialize>(
    experiment: Experiment,
    plan: P,
    run: ShardRun<R>,
) -> serde_json::Result<String> {
    Ok(serde_json::to_string(&Part { head: Head::current(), experiment, plan, run })? + "\n")
}

/// All parts of one experiment.
#[derive(Debug)]
pub struct Parts {
    /// Kind of experiment that the parts belong to.
    pub experiment: Experiment,
    plan: Value,
    /// Path and run of each shard, in the order of the shards.
    runs: Vec<(PathBuf, ShardRun<Value>)>,
}

impl Parts {
    /// Reads parts in any order.
    ///
    /// # Errors
    /// Returns an error if a file is not a part written by this version of the program, if the parts belong to different
    /// experiments, or if not every shard is there exactly once. Panics if `files` is empty.
    pub fn read(files: &[PathBuf]) -> Result<Self, PartError> {
        let mut parts = files.iter().map(|file| Ok((file, read(file)?))).collect::<Result<Vec<_>, PartError>>()?;
        let (first_file, first) = &parts[0];
        for (file, part) in &parts {
            if let Some(difference) = foreign(first, part) {
                return Err(PartError::Foreign {
                    file: file.to_path_buf(),
                    first: first_file.to_path_buf(),
                    difference,
                });
            }
        }
        parts.sort_by_key(|(_, part)| part.run.shard);
        if let Some([(first, part), (file, _)]) =
            parts.array_windows().find(|[(_, a), (_, b)]| a.run.shard == b.run.shard)
        {
            let (file, first) = (file.to_path_buf(), first.to_path_buf());
            return Err(PartError::Duplicate { file, first, shard: part.run.shard });
        }
        if let Some(missing) = missing(&parts.iter().map(|(_, part)| part.run.shard).collect::<Vec<_>>()) {
            return Err(PartError::Missing { file: parts[0].0.to_path_buf(), missing });
        }
        let (experiment, plan) = (parts[0].1.experiment, parts[0].1.plan.clone());
        let runs = parts.into_iter().map(|(file, part)| (file.to_path_buf(), part.run)).collect();
        Ok(Self { experiment, plan, runs })
    }

    /// Returns the plan of the experiment, and the run of each shard in the order of the shards. `check` returns the
    /// first fault of a run, if there is any.
    ///
    /// # Errors
    /// Returns an error that names the file if the plan or a run is damaged.
    pub fn into_runs<P: DeserializeOwned, R: DeserializeOwned>(
        self,
        check: impl Fn(&P, &ShardRun<R>) -> Result<(), String>,
    ) -> Result<(P, Vec<ShardRun<R>>), PartError> {
        let damaged = |file: &Path, reason: String| PartError::Damaged { file: file.to_owned(), reason };
        let plan: P = serde_json::from_value(self.plan).map_err(|error| damaged(&self.runs[0].0, error.to_string()))?;
        let mut runs = Vec::with_capacity(self.runs.len());
        for (file, ShardRun { shard, machine, partial, results }) in self.runs {
            let results = serde_json::from_value(results).map_err(|error| damaged(&file, error.to_string()))?;
            let run = ShardRun { shard, machine, partial, results };
            check(&plan, &run).map_err(|reason| damaged(&file, reason))?;
            runs.push(run);
        }
        Ok((plan, runs))
    }
}

/// Reads a part, and checks its version.
fn read(file: &Path) -> Result<Part<Value, Value>, PartError> {
    let bytes =
        disk::read(file, MAX_PART_BYTES).map_err(|source| PartError::Unreadable { file: file.to_owned(), source })?;
    let damaged = |error: serde_json::Error| PartError::Damaged { file: file.to_owned(), reason: error.to_string() };
    let head: Head = serde_json::from_slice(&bytes).map_err(damaged)?;
    if head.rasterscope != env!("CARGO_PKG_VERSION") {
        return Err(PartError::OtherVersion { file: file.to_owned(), found: head.rasterscope });
    }
    if head.part_format != FORMAT {
        let found = format!("{} in format {} instead of {FORMAT}", head.rasterscope, head.part_format);
        return Err(PartError::OtherVersion { file: file.to_owned(), found });
    }
    serde_json::from_slice(&bytes).map_err(damaged)
}

/// Returns the first difference between the experiments of two parts.
fn foreign(first: &Part<Value, Value>, part: &Part<Value, Value>) -> Option<String> {
    if first.experiment != part.experiment {
        return Some(format!("`{}` instead of `{}`", part.experiment.command(), first.experiment.command()));
    }
    let [of, expected] = [part, first].map(|part| part.run.shard.count());
    if of != expected {
        return Some(format!("one of {of} shards instead of {expected}"));
    }
    difference("plan", &first.plan, &part.plan)
}

/// Returns the path of the first value that differs, with both values.
fn difference(path: &str, expected: &Value, found: &Value) -> Option<String> {
    match (expected, found) {
        (Value::Object(a), Value::Object(b)) => {
            let keys = a.keys().chain(b.keys().filter(|key| !a.contains_key(*key)));
            let of = |map: &serde_json::Map<_, _>, key| map.get(key).cloned().unwrap_or_default();
            keys.into_iter().find_map(|key| difference(&format!("{path}.{key}"), &of(a, key), &of(b, key)))
        }
        (Value::Array(a), Value::Array(b)) if a.len() == b.len() => {
            let mut pairs = a.iter().zip(b).enumerate();
            pairs.find_map(|(index, (a, b))| difference(&format!("{path}[{index}]"), a, b))
        }
        (a, b) if a == b => None,
        (a, b) => Some(format!("{path} is {} instead of {}", shortened(b), shortened(a))),
    }
}

/// Returns a value as JSON of limited length.
fn shortened(value: &Value) -> String {
    /// Maximum number of characters.
    const MOST: usize = 60;
    let text = value.to_string();
    match text.char_indices().nth(MOST) {
        None => text,
        Some((end, _)) => format!("{}…", &text[..end]),
    }
}

/// Returns the shards that are missing from a sorted list without duplicates, with a verb; `None` if there are none.
fn missing(there: &[Shard]) -> Option<String> {
    let missing: Vec<String> =
        there.first()?.all().filter(|shard| there.binary_search(shard).is_err()).map(|s| s.to_string()).collect();
    match &missing[..] {
        [] => None,
        [only] => Some(format!("shard {only} is")),
        [listed @ .., last] if listed.len() < MAX_LISTED => {
            Some(format!("shards {} and {last} are", listed.join(", ")))
        }
        many => Some(format!("shards {} and {} more are", many[..MAX_LISTED].join(", "), many.len() - MAX_LISTED)),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn the_first_difference_of_two_plans_is_named_with_its_path() {
        let plan = json!({"classes": ["a", "b"], "seed": 1, "size": {"width": 4}});
        assert_eq!(difference("plan", &plan, &plan.clone()), None);
        for (other, message) in [
            (json!({"classes": ["a", "b"], "seed": 2, "size": {"width": 4}}), "plan.seed is 2 instead of 1"),
            (
                json!({"classes": ["a", "c"], "seed": 1, "size": {"width": 4}}),
                "plan.classes[1] is \"c\" instead of \"b\"",
            ),
            (json!({"classes": ["a"], "seed": 1}), "plan.classes is [\"a\"] instead of [\"a\",\"b\"]"),
            (json!({"classes": ["a", "b"], "seed": 1}), "plan.size is null instead of {\"width\":4}"),
        ] {
            assert_eq!(difference("plan", &plan, &other).as_deref(), Some(message));
        }
    }

    #[test]
    fn missing_shards_are_listed_up_to_a_limit() {
        let shards = |texts: &[&str]| texts.iter().map(|text| text.parse().unwrap()).collect::<Vec<Shard>>();
        assert_eq!(missing(&shards(&["1/2", "2/2"])), None);
        assert_eq!(missing(&shards(&["1/2"])).as_deref(), Some("shard 2/2 is"));
        assert_eq!(missing(&shards(&["2/4"])).as_deref(), Some("shards 1/4, 3/4 and 4/4 are"));
        let many = missing(&shards(&["1/100"])).unwrap();
        assert!(many.starts_with("shards 2/100, ") && many.ends_with(", 9/100 and 91 more are"), "{many}");
    }
}
