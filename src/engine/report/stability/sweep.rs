//! Runs the engine in all configurations on classes of test cases.
//!
//! First, all cases are evaluated in parallel. Then the classes are timed one after the other, with nothing else
//! running. The engine's results, and therefore the errors, do not depend on timing, on the number of threads, or on the
//! division into shards.

use std::collections::HashSet;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use serde::Serialize;

use super::case::{Body, StabilityCase};
use super::catalogue::{Class, Family};
use super::column::ReportColumn;
use super::measure::{MeasureOutcome, only_pair};
use super::metric::{Measures, Metric, Verdict};
use super::observations::{CaseObservation, ClassObservations, Observations, observe};
pub use super::plan::{DEFAULT_SEED, StabilityPlan, StabilityProgress, SweepStage};
use super::timing::Time;
use crate::measure::machine::Machines;
use crate::measure::noise::{Noise, Pairs};
use crate::measure::shard::{Shard, ShardRun};

/// Complete stability report.
#[derive(Clone, Debug, Serialize)]
pub struct StabilityReport {
    /// Seed from which the random cases were generated.
    pub(crate) seed: u64,
    /// Machines that ran the report.
    #[serde(flatten)]
    pub(crate) machines: Machines,
    /// Duration of the whole run, summed over shards; serialised in seconds.
    #[serde(serialize_with = "seconds")]
    pub(crate) duration: Duration,
    /// Noise floor, from timing the first configuration of each class against itself; `None` without times.
    pub(crate) timing_noise: Option<Noise>,
    /// Results of each class.
    pub classes: Vec<ClassReport>,
    /// Whether the run was cancelled before all classes were evaluated and timed.
    pub partial: bool,
}

fn seconds<S: serde::Serializer>(duration: &Duration, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_f64(duration.as_secs_f64())
}

/// Results of one class.
#[derive(Clone, Debug, Serialize)]
pub struct ClassReport {
    /// Class whose cases were run.
    #[serde(flatten)]
    pub class: &'static Class,
    /// Number of cases in the class.
    pub(crate) cases: usize,
    /// Total number of triangles in the cases.
    pub(crate) triangles: usize,
    /// Total number of pixels, samples or depths in the cases.
    pub(crate) units: u64,
    /// Machine that timed the class; `None` if all classes were timed by the same one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) machine: Option<String>,
    /// Results of each column.
    pub cells: Vec<ReportCell>,
    /// Complete cases to which [`Worst::of`] refers, without duplicates. [`Worst::measures`] can be recomputed from
    /// them.
    pub(crate) worst_cases: Vec<StabilityCase>,
}

/// Results of one class in one configuration.
#[derive(Clone, Debug, Serialize)]
pub struct ReportCell {
    /// Configuration of the engine.
    #[serde(flatten)]
    pub column: ReportColumn,
    /// Verdict that summarises the measures in one word.
    pub verdict: Verdict,
    /// Number of cases for which the engine produced no result.
    pub(crate) refused: usize,
    /// Measures combined over all cases.
    pub measures: Measures,
    /// Time measured for the cell; `None` without timing.
    pub time: Option<Time>,
    /// Worst case, if there was any fault.
    pub worst: Option<Worst>,
    /// Results of each case in depth classes, where every case is a separate experiment; empty in other classes.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) by_case: Vec<CaseMeasures>,
}

impl ReportCell {
    /// Records the time of the cell, and the measure that is derived from it.
    fn take(&mut self, time: Time) {
        self.time = Some(time);
        if let Some(stiffness) = time.stiffness {
            self.measures.note(Metric::Stiffness, stiffness);
        }
    }
}

/// Results of one case in one configuration.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct CaseMeasures {
    /// Id of the case.
    pub(crate) id: String,
    /// Description of the property that makes the case hard.
    pub(crate) note: String,
    /// Measures of the case; `None` if the engine produced no result.
    pub(crate) measures: Option<Measures>,
}

/// Worst case, reduced to the part that shows the fault.
#[derive(Clone, Debug, Serialize)]
pub struct Worst {
    /// Id of the complete case, which is in [`ClassReport::worst_cases`].
    pub(crate) of: String,
    /// Measures of the complete case; `None` if the engine produced no result.
    pub(crate) measures: Option<Measures>,
    /// Reduced case, which can be opened in the window.
    pub case: StabilityCase,
}

/// Runs a plan. Calls `progress` after every step, from several threads. If `cancel` becomes `true`, returns the
/// classes evaluated so far, or `None` if there are none.
pub fn run(
    plan: &StabilityPlan,
    progress: &(dyn Fn(StabilityProgress) + Sync),
    cancel: &AtomicBool,
) -> Option<StabilityReport> {
    combine(plan, &[observe(plan, Shard::WHOLE, progress, cancel)?])
}

/// Combines the observations of all shards of a plan. Returns `None` if no class is complete because shards were
/// cancelled.
pub fn combine(plan: &StabilityPlan, shards: &[ShardRun<Observations>]) -> Option<StabilityReport> {
    let machines = Machines::of(shards.iter().map(|shard| &shard.machine))?;
    let (mut classes, mut pairs) = (Vec::new(), Pairs::default());
    for (place, class) in plan.classes.iter().enumerate() {
        let of_shards: Vec<&ClassObservations> = shards.iter().map(|shard| &shard.results.classes[place]).collect();
        let Some(mut report) = evaluated(class, plan.columns(class), &class.cases(plan.seed), &of_shards) else {
            continue;
        };
        let timed = shards.iter().find_map(|shard| Some((shard, shard.results.classes[place].times.as_ref()?)));
        if let Some((shard, times)) = timed {
            pairs.append(times.pairs.clone());
            report.machine = machines.label(&shard.machine);
            report.cells.iter_mut().zip(&times.columns).for_each(|(cell, time)| cell.take(*time));
        }
        report.cells.iter_mut().for_each(|cell| cell.verdict = verdict(class, cell));
        classes.push(report);
    }
    let partial = shards.iter().any(|shard| shard.partial);
    if partial && classes.is_empty() {
        return None;
    }
    let duration = shards.iter().map(|shard| shard.results.duration).sum();
    Some(StabilityReport { seed: plan.seed, machines, duration, timing_noise: pairs.noise(), classes, partial })
}

/// Combines the outcomes of all cases of a class. Returns `None` if an outcome is missing.
fn evaluated(
    class: &'static Class,
    columns: Vec<ReportColumn>,
    cases: &[StabilityCase],
    shards: &[&ClassObservations],
) -> Option<ClassReport> {
    let of_case = |case: usize| shards.iter().find_map(|shard| shard.cases.get(&case));
    let judged: Vec<&CaseObservation> = (0..cases.len()).map(of_case).collect::<Option<_>>()?;
    let cell = |(index, column): (usize, ReportColumn)| {
        let outcomes = cases.iter().zip(&judged).filter_map(|(case, one)| Some((case, one.outcomes[index].as_ref()?)));
        join(class, column, &outcomes.collect::<Vec<_>>())
    };
    let cells: Vec<ReportCell> = columns.into_iter().enumerate().map(cell).collect();
    let worst: HashSet<&str> = cells.iter().filter_map(|cell| Some(&*cell.worst.as_ref()?.of)).collect();
    let worst_cases = cases.iter().filter(|case| worst.contains(&*case.id)).cloned().collect();
    Some(ClassReport {
        class,
        cases: cases.len(),
        triangles: cases.iter().map(StabilityCase::triangle_count).sum(),
        units: judged.iter().map(|one| one.units).sum(),
        machine: None,
        cells,
        worst_cases,
    })
}

/// Combines the outcomes of all cases of a class in one column.
fn join(class: &Class, column: ReportColumn, outcomes: &[(&StabilityCase, &MeasureOutcome)]) -> ReportCell {
    let mut measures = Measures::default();
    outcomes.iter().filter_map(|(_, outcome)| outcome.measures.as_ref()).for_each(|one| measures.join(one));
    let refused = outcomes.iter().filter(|(_, outcome)| outcome.measures.is_none()).count();
    let worst = outcomes
        .iter()
        .max_by(|a, b| rank(class, a.1).partial_cmp(&rank(class, b.1)).unwrap_or(std::cmp::Ordering::Equal));
    let worst = worst.filter(|(_, outcome)| rank(class, outcome).iter().any(|value| *value > 0.0));
    let worst = worst.map(|(case, outcome)| Worst {
        of: case.id.clone(),
        measures: outcome.measures,
        case: shown(case, &outcome.culprits, column),
    });
    let by_case = outcomes.iter().filter(|_| class.family == Family::Depth).map(|(case, outcome)| CaseMeasures {
        id: case.id.clone(),
        note: case.note.clone(),
        measures: outcome.measures,
    });
    let by_case = by_case.collect();
    ReportCell { column, verdict: Verdict::Measured, refused, measures, time: None, worst, by_case }
}

/// Returns a sort key for the severity of a case: its error metrics in descending order of importance.
fn rank(class: &Class, outcome: &MeasureOutcome) -> [f64; 7] {
    use Metric::{DepthUlp, Doubles, NotFinite, WeightError, Wrong, WrongUnsnapped};
    let value = |metric| outcome.measures.map_or(f64::INFINITY, |measures| measures.get(metric).unwrap_or(0.0));
    [class.headline, NotFinite, Wrong, Doubles, WrongUnsnapped, WeightError, DepthUlp].map(value)
}

/// Returns the part of a case that shows the fault, with the depth format of the column.
fn shown(case: &StabilityCase, culprits: &[usize], column: ReportColumn) -> StabilityCase {
    let part = match (&case.body, culprits) {
        (_, []) => case.clone(),
        (Body::DepthPairs(pairs), [pair, ..]) => {
            let body = only_pair(pairs, *pair).map_or_else(|| case.body.clone(), Body::Depth);
            StabilityCase { id: format!("{}-pair", case.id), body, ..case.clone() }
        }
        (_, culprits) => case.only(culprits),
    };
    match column {
        ReportColumn::Depth(format) => {
            let (mapping, storage) = super::subject::meaning(format);
            part.stored_as(mapping, storage)
        }
        ReportColumn::Coverage(_) | ReportColumn::Weights(_) => part,
    }
}

fn verdict(class: &Class, cell: &ReportCell) -> Verdict {
    if cell.refused > 0 {
        Verdict::Refused
    } else if class.bounds.iter().all(|bound| bound.holds(&cell.measures)) {
        Verdict::Pass
    } else {
        Verdict::Measured
    }
}

#[cfg(test)]
mod tests;
