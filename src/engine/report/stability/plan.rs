//! Plan of a stability report: the classes and configurations to run, and the progress through them.

use serde::{Deserialize, Serialize};

use super::catalogue::{self, Class};
use super::column::ReportColumn;
use crate::pipeline::settings::{Arithmetic, Choice as _, Rasterizer};

/// Selection of the classes and configurations to run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct StabilityPlan {
    /// Classes to run, in this order; serialised as their ids.
    #[serde(with = "class_ids")]
    pub classes: Vec<&'static Class>,
    /// Rasterizers to run, in the classes that compare rasterizers.
    pub rasterizers: Vec<Rasterizer>,
    /// Kinds of arithmetic to run, in the classes that compare them.
    pub arithmetics: Vec<Arithmetic>,
    /// Seed from which the random cases are generated.
    pub seed: u64,
    /// Whether to measure times as well.
    pub timed: bool,
}

/// Default seed of the random cases.
pub const DEFAULT_SEED: u64 = 1;

impl Default for StabilityPlan {
    fn default() -> Self {
        Self {
            classes: catalogue::all().collect(),
            rasterizers: Rasterizer::ALL.to_vec(),
            arithmetics: Arithmetic::ALL.to_vec(),
            seed: DEFAULT_SEED,
            timed: true,
        }
    }
}

impl StabilityPlan {
    /// Returns the selected columns of a class.
    pub(super) fn columns(&self, class: &Class) -> Vec<ReportColumn> {
        let wanted = |column: &ReportColumn| match column {
            ReportColumn::Coverage(by) => {
                self.rasterizers.contains(&by.rasterizer) && self.arithmetics.contains(&by.arithmetic)
            }
            ReportColumn::Weights(by) => self.arithmetics.contains(&by.arithmetic),
            ReportColumn::Depth(_) => true,
        };
        ReportColumn::of(class.family).into_iter().filter(wanted).collect()
    }
}

/// Serialisation of classes as a list of their ids.
mod class_ids {
    use serde::de::Error as _;
    use serde::{Deserialize as _, Deserializer, Serializer};

    use super::super::catalogue::{Class, by_id};

    pub(super) fn serialize<S: Serializer>(classes: &[&'static Class], to: S) -> Result<S::Ok, S::Error> {
        to.collect_seq(classes.iter().map(|class| class.id))
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<&'static Class>, D::Error> {
        let class = |id: String| by_id(&id).ok_or_else(|| D::Error::custom(format!("no class {id}")));
        Vec::<String>::deserialize(from)?.into_iter().map(class).collect()
    }
}

/// Progress of a stability report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StabilityProgress {
    /// Stage that is running.
    pub stage: SweepStage,
    /// Number of completed steps in this stage.
    pub done: usize,
    /// Total number of steps in this stage.
    pub of: usize,
}

/// Stages of a stability report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SweepStage {
    /// Comparing the engine's results with the exact ones.
    Judging,
    /// Timing the classes, one after the other.
    Timing,
}

impl SweepStage {
    /// Returns the display name of the stage.
    pub fn name(self) -> &'static str {
        match self {
            Self::Judging => "checking cases",
            Self::Timing => "timing classes",
        }
    }
}
