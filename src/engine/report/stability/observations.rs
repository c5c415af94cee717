//! Observations of one shard of a stability report: outcomes of its cases, and times of its classes.
//!
//! A class is timed by one shard alone, so that the times of its configurations come from the same machine and the same
//! rounds. Its cases are shared out.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::case::StabilityCase;
use super::measure::{Expected, MeasureOutcome, answer};
use super::plan::{StabilityPlan, StabilityProgress, SweepStage};
use super::timing::{Time, time_class};
use crate::measure::machine::Machine;
use crate::measure::noise::Pairs;
use crate::measure::shard::{Shard, ShardRun};

/// Observations of one shard.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Observations {
    /// Duration of the run.
    pub(super) duration: Duration,
    /// Observations of each class of the plan.
    pub(super) classes: Vec<ClassObservations>,
}

/// Observations of one class.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct ClassObservations {
    /// Observations of the shard's cases, by their index in the class.
    pub(super) cases: BTreeMap<usize, CaseObservation>,
    /// Times; `None` if another shard times the class, or if the plan has no times.
    pub(super) times: Option<ClassTimes>,
}

/// Comparison of one case with the exact results.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct CaseObservation {
    /// Number of pixels, samples or depths of the case.
    pub(super) units: u64,
    /// Outcome in each column; `None` if the column does not apply to the case.
    pub(super) outcomes: Vec<Option<MeasureOutcome>>,
}

/// Times of one class.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct ClassTimes {
    /// Time of each column.
    pub(super) columns: Vec<Time>,
    /// A/A pairs of the first column.
    pub(super) pairs: Pairs,
}

impl Observations {
    /// Returns the first contradiction between the observations of a shard and the plan, in words.
    ///
    /// # Errors
    /// Returns an error if an observation is missing although the run was complete, or has the wrong size.
    pub fn check(plan: &StabilityPlan, run: &ShardRun<Self>) -> Result<(), String> {
        let owned = owned_cases(plan, run.shard);
        if run.results.classes.len() != plan.classes.len() {
            return Err(format!("results of {} classes instead of {}", run.results.classes.len(), plan.classes.len()));
        }
        for (place, (class, found)) in plan.classes.iter().zip(&run.results.classes).enumerate() {
            let columns = plan.columns(class).len();
            if let Some(case) =
                owned[place].iter().find(|case| !found.cases.contains_key(case)).filter(|_| !run.partial)
            {
                return Err(format!("no result of case {case} of {}", class.id));
            }
            if found.cases.values().any(|case| case.outcomes.len() != columns) {
                return Err(format!("a case of {} without results of all columns", class.id));
            }
            let is_timed = plan.timed && columns > 0 && run.shard.owns(place);
            if found.times.is_none() && is_timed && !run.partial {
                return Err(format!("no times of {}", class.id));
            }
            if found.times.as_ref().is_some_and(|times| times.columns.len() != columns) {
                return Err(format!("times of {} without those of all columns", class.id));
            }
        }
        Ok(())
    }
}

/// Returns the indices of the cases of each class that belong to a shard. Cases are numbered through all classes.
fn owned_cases(plan: &StabilityPlan, shard: Shard) -> Vec<Vec<usize>> {
    let mut first = 0;
    let of_class = |count: usize| {
        let owned = (0..count).filter(|case| shard.owns(first + case)).collect();
        first += count;
        owned
    };
    plan.classes.iter().map(|class| class.cases(plan.seed).len()).map(of_class).collect()
}

/// Evaluates the cases of a shard, then times its classes. Calls `progress` after every step, from several threads. If
/// `cancel` becomes `true`, returns the observations so far, or `None` if there are none.
pub fn observe(
    plan: &StabilityPlan,
    shard: Shard,
    progress: &(dyn Fn(StabilityProgress) + Sync),
    cancel: &AtomicBool,
) -> Option<ShardRun<Observations>> {
    let start = Instant::now();
    let machine = Machine::at_start().with_host();
    let is_cancelled = || cancel.load(Ordering::Relaxed);
    let cases = plan.classes.iter().map(|class| (!is_cancelled()).then(|| class.cases(plan.seed)));
    let cases = cases.collect::<Option<Vec<Vec<StabilityCase>>>>()?;
    let mut classes = evaluate(plan, shard, &cases, progress, cancel);
    let of_shard = (0..classes.len()).filter(|place| plan.timed && shard.owns(*place)).collect::<Vec<_>>();
    for (done, place) in of_shard.iter().enumerate() {
        let columns = plan.columns(plan.classes[*place]);
        if columns.is_empty() || is_cancelled() {
            continue;
        }
        progress(StabilityProgress { stage: SweepStage::Timing, done, of: of_shard.len() });
        let units = units(&cases[*place], &classes[*place]);
        let times = time_class(plan.classes[*place], &cases[*place], &units, &columns, cancel);
        classes[*place].times = times.map(|(columns, pairs)| ClassTimes { columns, pairs });
    }
    let partial = is_cancelled();
    if partial && classes.iter().all(|class| class.cases.is_empty()) {
        return None;
    }
    let results = Observations { duration: start.elapsed(), classes };
    Some(ShardRun { shard, machine: machine.at_end(), partial, results })
}

/// Runs the cases of a shard in all configurations and compares the results with the exact ones. Cases that are
/// incomplete due to cancellation are left out.
fn evaluate(
    plan: &StabilityPlan,
    shard: Shard,
    cases: &[Vec<StabilityCase>],
    progress: &(dyn Fn(StabilityProgress) + Sync),
    cancel: &AtomicBool,
) -> Vec<ClassObservations> {
    let owned = owned_cases(plan, shard);
    let of = owned.iter().map(Vec::len).sum();
    let done = AtomicUsize::new(0);
    progress(StabilityProgress { stage: SweepStage::Judging, done: 0, of });
    let columns: Vec<_> = plan.classes.iter().map(|class| plan.columns(class)).collect();
    let judge_case = |(class, index): (usize, usize)| {
        if cancel.load(Ordering::Relaxed) {
            return None;
        }
        let case = &cases[class][index];
        let expected = Expected::new(case);
        let answered = columns[class]
            .iter()
            .map(|column| (!cancel.load(Ordering::Relaxed)).then(|| answer(case, &expected, *column)));
        let outcomes = answered.collect::<Option<Vec<_>>>()?;
        progress(StabilityProgress { stage: SweepStage::Judging, done: done.fetch_add(1, Ordering::Relaxed) + 1, of });
        Some((class, index, CaseObservation { units: expected.units(case), outcomes }))
    };
    let jobs: Vec<(usize, usize)> =
        owned.iter().enumerate().flat_map(|(class, cases)| cases.iter().map(move |case| (class, *case))).collect();
    let judged: Vec<_> = jobs.into_par_iter().map(judge_case).collect();
    let mut classes = vec![ClassObservations::default(); cases.len()];
    for (class, index, case) in judged.into_iter().flatten() {
        classes[class].cases.insert(index, case);
    }
    classes
}

/// Returns the number of pixels, samples or depths of each case of a class.
fn units(cases: &[StabilityCase], judged: &ClassObservations) -> Vec<u64> {
    let of_case = |(index, case): (usize, &StabilityCase)| match judged.cases.get(&index) {
        Some(known) => known.units,
        // Another shard evaluates the case.
        None => Expected::new(case).units(case),
    };
    cases.par_iter().enumerate().map(of_case).collect()
}
