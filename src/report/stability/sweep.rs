//! Runs classes of cases against everything that can be switched.
//!
//! First all cases are judged, on all processors; then the classes are timed one after the other with nothing else going
//! on. The engine's answers do not depend on the time or on the number of threads, and neither do the errors.

use std::collections::HashSet;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use rayon::prelude::*;
use serde::Serialize;

use super::case::{Body, Case};
use super::catalogue::{self, Class, Family};
use super::column::Column;
use super::measure::{Expected, Outcome, answer, only_pair};
use super::metric::{Measures, Metric, Verdict};
use super::timing::{Time, time_class};
use crate::measure::machine::Machine;
use crate::measure::noise::{Noise, Pairs};
use crate::pipeline::settings::{Arithmetic, Choice as _, Rasterizer};

/// What to run.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Classes of cases, in this order.
    pub classes: Vec<&'static Class>,
    /// Rasterizers, for classes that are about them.
    pub rasterizers: Vec<Rasterizer>,
    /// Arithmetics, for classes that are about them.
    pub arithmetics: Vec<Arithmetic>,
    /// What the cases depend on.
    pub seed: u64,
    /// Whether times are taken as well.
    pub timed: bool,
}

/// The seed if nothing is said.
pub const DEFAULT_SEED: u64 = 1;

impl Default for Plan {
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

impl Plan {
    /// The columns of a class that were asked for.
    fn columns(&self, class: &Class) -> Vec<Column> {
        let wanted = |column: &Column| match column {
            Column::Coverage(by) => {
                self.rasterizers.contains(&by.rasterizer) && self.arithmetics.contains(&by.arithmetic)
            }
            Column::Weights(by) => self.arithmetics.contains(&by.arithmetic),
            Column::Depth(_) => true,
        };
        Column::of(class.family).into_iter().filter(wanted).collect()
    }
}

/// How far a run has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// What is being done.
    pub stage: Stage,
    /// Steps done of this stage.
    pub done: usize,
    /// Steps of this stage.
    pub of: usize,
}

/// The two parts of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Cases are judged.
    Judging,
    /// Classes are timed.
    Timing,
}

impl Stage {
    /// What a person calls it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Judging => "judging cases",
            Self::Timing => "timing classes",
        }
    }
}

/// The whole report.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// What the cases depend on.
    pub seed: u64,
    /// Where it was made.
    pub machine: Machine,
    /// How long it took.
    #[serde(serialize_with = "seconds")]
    pub duration: Duration,
    /// Noise floor, from the first configuration of each class timed against itself; `None` without times.
    pub timing_noise: Option<Noise>,
    /// Class by class.
    pub classes: Vec<ClassReport>,
    /// Whether it was cancelled before all classes were judged and timed.
    pub partial: bool,
}

fn seconds<S: serde::Serializer>(duration: &Duration, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_f64(duration.as_secs_f64())
}

/// What came of one class.
#[derive(Clone, Debug, Serialize)]
pub struct ClassReport {
    /// The class.
    #[serde(flatten)]
    pub class: &'static Class,
    /// Number of cases.
    pub cases: usize,
    /// Triangles in all of them.
    pub triangles: usize,
    /// Pixels, samples or depths in all of them.
    pub units: u64,
    /// Column by column.
    pub cells: Vec<Cell>,
    /// Complete cases that [`Worst::of`] names, each once: what the counts of the cells can be recomputed from.
    pub worst_cases: Vec<Case>,
}

/// What came of one class in one configuration.
#[derive(Clone, Debug, Serialize)]
pub struct Cell {
    /// The configuration.
    #[serde(flatten)]
    pub column: Column,
    /// In one word.
    pub verdict: Verdict,
    /// Cases without an answer.
    pub refused: usize,
    /// In numbers, over all cases.
    pub measures: Measures,
    /// What it costs.
    pub time: Option<Time>,
    /// The case that went worst, if anything was wrong at all.
    pub worst: Option<Worst>,
    /// Case by case, for classes whose cases are an experiment each: those about depth.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub by_case: Vec<CaseMeasures>,
}

/// What came of one case.
#[derive(Clone, Debug, Serialize)]
pub struct CaseMeasures {
    /// Its name.
    pub id: String,
    /// What is special about it.
    pub note: String,
    /// In numbers; nothing if it was not answered.
    pub measures: Option<Measures>,
}

/// The case that went worst, cut down to the part that shows it.
#[derive(Clone, Debug, Serialize)]
pub struct Worst {
    /// The case that it is a part of.
    pub of: String,
    /// How wrong all of that case is; nothing if it was not answered.
    pub measures: Option<Measures>,
    /// What to open to see it.
    pub case: Case,
}

/// Runs a plan. `progress` hears of every step, from several threads. If `cancel` becomes true meanwhile,
/// returns the classes that were judged, or `None` if there are none.
pub fn run(plan: &Plan, progress: &(dyn Fn(Progress) + Sync), cancel: &AtomicBool) -> Option<Report> {
    let start = Instant::now();
    let machine = Machine::at_start();
    let is_cancelled = || cancel.load(Ordering::Relaxed);
    let cases = plan.classes.iter().map(|class| (!is_cancelled()).then(|| class.cases(plan.seed)));
    let cases = cases.collect::<Option<Vec<Vec<Case>>>>()?;
    let judged = judge(plan, &cases, progress, cancel);
    let (mut classes, mut pairs) = (Vec::new(), Pairs::default());
    for (done, (judged, cases)) in judged.into_iter().zip(&cases).enumerate() {
        let Some((mut report, units)) = judged else { continue };
        if plan.timed && !report.cells.is_empty() {
            progress(Progress { stage: Stage::Timing, done, of: plan.classes.len() });
            match time(&mut report, cases, &units, cancel) {
                Some(of_class) => pairs.append(of_class),
                None if cancel.load(Ordering::Relaxed) => {}
                None => return None,
            }
        }
        classes.push(report);
    }
    for report in &mut classes {
        report.cells.iter_mut().for_each(|cell| cell.verdict = verdict(report.class, cell));
    }
    let partial = cancel.load(Ordering::Relaxed);
    if partial && classes.is_empty() {
        return None;
    }
    let (machine, timing_noise) = (machine.at_end(), pairs.noise());
    Some(Report { seed: plan.seed, machine, duration: start.elapsed(), timing_noise, classes, partial })
}

/// Judges all cases in all columns. With each class comes how many pixels, samples or depths each of its cases has. Classes
/// that were not complete when it was cancelled are `None`.
fn judge(
    plan: &Plan,
    cases: &[Vec<Case>],
    progress: &(dyn Fn(Progress) + Sync),
    cancel: &AtomicBool,
) -> Vec<Option<(ClassReport, Vec<u64>)>> {
    let columns: Vec<Vec<Column>> = plan.classes.iter().map(|class| plan.columns(class)).collect();
    let of = cases.iter().map(Vec::len).sum();
    let done = AtomicUsize::new(0);
    progress(Progress { stage: Stage::Judging, done: 0, of });
    let judge_case = |(class, case): (usize, &Case)| {
        if cancel.load(Ordering::Relaxed) {
            return None;
        }
        let expected = Expected::new(case);
        let answered = columns[class]
            .iter()
            .map(|column| (!cancel.load(Ordering::Relaxed)).then(|| answer(case, &expected, *column)));
        let outcomes = answered.collect::<Option<Vec<_>>>()?;
        progress(Progress { stage: Stage::Judging, done: done.fetch_add(1, Ordering::Relaxed) + 1, of });
        Some((expected.units(case), outcomes))
    };
    let jobs: Vec<(usize, &Case)> =
        cases.iter().enumerate().flat_map(|(i, cases)| cases.iter().map(move |c| (i, c))).collect();
    let judged: Vec<Option<(u64, Vec<Option<Outcome>>)>> = jobs.into_par_iter().map(judge_case).collect();
    let mut judged = judged.into_iter();
    let reports = plan.classes.iter().zip(cases).zip(columns).map(|((class, cases), columns)| {
        let judged: Vec<_> = judged.by_ref().take(cases.len()).collect();
        let judged = judged.into_iter().collect::<Option<Vec<_>>>()?;
        let cell = |(index, column): (usize, Column)| {
            let outcomes =
                cases.iter().zip(&judged).filter_map(|(case, (_, outcomes))| Some((case, outcomes[index].as_ref()?)));
            join(class, column, &outcomes.collect::<Vec<_>>())
        };
        let units: Vec<u64> = judged.iter().map(|(units, _)| *units).collect();
        let cells: Vec<Cell> = columns.into_iter().enumerate().map(cell).collect();
        let worst: HashSet<&str> = cells.iter().filter_map(|cell| Some(&*cell.worst.as_ref()?.of)).collect();
        let worst_cases = cases.iter().filter(|case| worst.contains(&*case.id)).cloned().collect();
        let report = ClassReport {
            class,
            cases: cases.len(),
            triangles: cases.iter().map(Case::triangle_count).sum(),
            units: units.iter().sum(),
            cells,
            worst_cases,
        };
        Some((report, units))
    });
    reports.collect()
}

/// Joins what came of all cases of a class in one column.
fn join(class: &Class, column: Column, outcomes: &[(&Case, &Outcome)]) -> Cell {
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
    Cell { column, verdict: Verdict::Measured, refused, measures, time: None, worst, by_case }
}

/// How bad a case is, most important number first.
fn rank(class: &Class, outcome: &Outcome) -> [f64; 7] {
    use Metric::{DepthUlp, Doubles, NotFinite, WeightError, Wrong, WrongUnsnapped};
    let value = |metric| outcome.measures.map_or(f64::INFINITY, |measures| measures.get(metric).unwrap_or(0.0));
    [class.headline, NotFinite, Wrong, Doubles, WrongUnsnapped, WeightError, DepthUlp].map(value)
}

/// The part of a case that shows what went wrong, as the column stores it.
fn shown(case: &Case, culprits: &[usize], column: Column) -> Case {
    let part = match (&case.body, culprits) {
        (_, []) => case.clone(),
        (Body::DepthPairs(pairs), [pair, ..]) => {
            let body = only_pair(pairs, *pair).map_or_else(|| case.body.clone(), Body::Depth);
            Case { id: format!("{}-pair", case.id), body, ..case.clone() }
        }
        (_, culprits) => case.only(culprits),
    };
    match column {
        Column::Depth(format) => {
            let (mapping, storage) = super::subject::meaning(format);
            part.stored_as(mapping, storage)
        }
        Column::Coverage(_) | Column::Weights(_) => part,
    }
}

/// Times all columns of a class, and returns its A/A pairs.
fn time(report: &mut ClassReport, cases: &[Case], units: &[u64], cancel: &AtomicBool) -> Option<Pairs> {
    let columns: Vec<Column> = report.cells.iter().map(|cell| cell.column).collect();
    let (times, pairs) = time_class(report.class, cases, units, &columns, cancel)?;
    for (cell, time) in report.cells.iter_mut().zip(times) {
        cell.time = Some(time);
        if let Some(stiffness) = time.stiffness {
            cell.measures.note(Metric::Stiffness, stiffness);
        }
    }
    Some(pairs)
}

fn verdict(class: &Class, cell: &Cell) -> Verdict {
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
