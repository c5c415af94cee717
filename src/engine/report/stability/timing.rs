//! Time per pixel of every configuration.
//!
//! All configurations of a class run in turn, round after round, in a shuffled order, so that disturbances of the
//! machine affect all of them. Short runs are repeated until the clock resolution suffices. For the noise floor, the
//! first configuration runs twice per round.

use std::hint::black_box;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use super::case::{Body, StabilityCase};
use super::catalogue::{Class, Family};
use super::column::ReportColumn;
use super::oracle::{ExactRegion, Snap};
use super::spans::pixel_count;
use super::subject::{self, DepthBuffer, Interpolator};
use crate::measure::noise::Pairs;
use crate::measure::timing::summarize;
use crate::pipeline::settings::FillRule;
use crate::pipeline::viewport::Viewport;

/// Minimum duration of a timed interval. Shorter work is repeated within the interval.
const MIN_SPELL: Duration = Duration::from_micros(100);

/// Time budget for all configurations of a class together.
const CLASS_BUDGET: Duration = Duration::from_millis(900);

/// Minimum number of rounds, however long they take.
const MIN_ROUNDS: usize = 5;

/// Maximum number of rounds, however short they are.
const MAX_ROUNDS: usize = 31;

/// Number of distances that are timed instead of the random pairs of a case.
const DISTANCES: usize = 2000;

/// Median and percentiles of a time, over all rounds of a measurement.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Median over the rounds.
    pub median: f64,
    /// 10th percentile over the rounds.
    pub p10: f64,
    /// 90th percentile over the rounds.
    pub p90: f64,
}

/// Cost of one configuration on the cases of a class.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Time {
    /// Time in nanoseconds per pixel, sample or stored depth, depending on the class. Pixels are those of the exact
    /// coverage. `None` if the cases have none.
    pub ns_per_pixel: Option<Spread>,
    /// Median nanoseconds per triangle.
    pub(crate) ns_per_triangle: Option<f64>,
    /// Time per pixel, as a multiple of the time per pixel of compact triangles that cover about as many pixels.
    pub(crate) stiffness: Option<f64>,
    /// Number of rounds measured.
    pub(crate) rounds: usize,
}

/// Function to be timed, which runs all cases of a class once. It stops early if the flag passed to it becomes `true`.
type ClassWork<'a> = Box<dyn Fn(&AtomicBool) + 'a>;

/// Function to be timed, which runs one case once.
type CaseWork<'a> = Box<dyn Fn() + 'a>;

/// Times every column of a class. `columns` must not be empty; `units` holds the number of pixels, samples or depths of
/// each case. The first column is timed twice per round; these pairs of times (A/A pairs) are also returned. Returns
/// `None` if cancelled.
pub(super) fn time_class(
    class: &Class,
    cases: &[StabilityCase],
    units: &[u64],
    columns: &[ReportColumn],
    cancel: &AtomicBool,
) -> Option<(Vec<Time>, Pairs)> {
    let twins = twins(class, cases, units);
    let units = cases.iter().zip(units).map(|(case, units)| timed_units(case, *units)).sum();
    let twin_pixels: u64 = twins.iter().map(Twin::pixels).sum();
    let mut works: Vec<ClassWork<'_>> = columns.iter().map(|column| work(cases, *column)).collect();
    if twin_pixels > 0 {
        works.extend(columns.iter().map(|column| twin_work(&twins, *column)));
    }
    works.extend(columns.first().map(|first| work(cases, *first)));
    let seconds = interleaved(&works, cancel)?;
    let triangles: usize = cases.iter().map(StabilityCase::triangle_count).sum();
    let times = (0..columns.len()).map(|index| {
        let spent = &seconds[index];
        let ns_per_pixel = spread(spent, units);
        let twin = seconds.get(columns.len() + index).filter(|_| twin_pixels > 0);
        let twin_per_pixel = twin.and_then(|spent| Some(spread(spent, twin_pixels)?.median));
        Time {
            ns_per_pixel,
            ns_per_triangle: spread(spent, triangles as u64).map(|spread| spread.median),
            stiffness: ns_per_pixel.zip(twin_per_pixel).map(|(here, there)| here.median / there),
            rounds: spent.len(),
        }
    });
    let mut pairs = Pairs::default();
    if let [first, .., again] = &seconds[..] {
        pairs.add(first, again);
    }
    Some((times.collect(), pairs))
}

/// Summarizes the times of all rounds, in seconds, as nanoseconds per unit. Returns `None` if there are no units.
fn spread(seconds: &[f64], units: u64) -> Option<Spread> {
    let per_unit: Vec<f64> = seconds.iter().map(|s| s * 1e9 / units as f64).collect();
    let summary = summarize(&per_unit).filter(|_| units > 0)?;
    Some(Spread { median: summary.median, p10: summary.p10, p90: summary.p90 })
}

/// Times all functions in a shuffled order, round after round. Returns the seconds per call of each function, with one
/// entry per round, or `None` if cancelled.
fn interleaved(works: &[ClassWork<'_>], cancel: &AtomicBool) -> Option<Vec<Vec<f64>>> {
    // The first run warms up; the second determines the number of repetitions.
    let mut repeats = Vec::new();
    let mut round = Duration::ZERO;
    for work in works {
        if cancel.load(Ordering::Relaxed) {
            return None;
        }
        work(cancel);
        let once = timed(work, 1, cancel).max(Duration::from_nanos(1));
        let times = (MIN_SPELL.as_secs_f64() / once.as_secs_f64()).ceil().max(1.0);
        round += once.mul_f64(times);
        repeats.push(times as u32);
    }
    let affordable = CLASS_BUDGET.as_secs_f64() / round.as_secs_f64().max(1e-9);
    let rounds = (affordable as usize).clamp(MIN_ROUNDS, MAX_ROUNDS);
    let mut random = fastrand::Rng::with_seed(0);
    let mut order: Vec<usize> = (0..works.len()).collect();
    let mut seconds = vec![Vec::with_capacity(rounds); works.len()];
    for _ in 0..rounds {
        random.shuffle(&mut order);
        for index in &order {
            if cancel.load(Ordering::Relaxed) {
                return None;
            }
            let spent = timed(&works[*index], repeats[*index], cancel);
            seconds[*index].push(spent.as_secs_f64() / f64::from(repeats[*index]));
        }
    }
    // If the run was cancelled meanwhile, the last time is invalid.
    (!cancel.load(Ordering::Relaxed)).then_some(seconds)
}

fn timed(work: &ClassWork<'_>, repeats: u32, cancel: &AtomicBool) -> Duration {
    let start = Instant::now();
    for _ in 0..repeats {
        work(cancel);
    }
    start.elapsed()
}

/// Returns a function that runs the engine on all cases in one configuration.
fn work(cases: &[StabilityCase], column: ReportColumn) -> ClassWork<'_> {
    let parts: Vec<CaseWork<'_>> = cases.iter().filter_map(|case| case_work(case, column)).collect();
    Box::new(move |cancel| parts.iter().take_while(|_| !cancel.load(Ordering::Relaxed)).for_each(|part| part()))
}

fn case_work(case: &StabilityCase, column: ReportColumn) -> Option<CaseWork<'_>> {
    let viewport = case.viewport();
    Some(match (&case.body, column) {
        (Body::TriCoverage(body), ReportColumn::Coverage(by)) => {
            let viewport = viewport?;
            Box::new(move || {
                for triangle in &body.triangles {
                    black_box(subject::cover(by, black_box(*triangle), body.rule, viewport));
                }
            })
        }
        (Body::ClipTri(body), ReportColumn::Coverage(by)) => {
            let viewport = viewport?;
            Box::new(move || {
                for triangle in &body.triangles {
                    black_box(subject::draw(by, black_box(*triangle), viewport));
                }
            })
        }
        (Body::TriAttr(body), ReportColumn::Weights(by)) => {
            sampling([Interpolator::new(by, &body.vertices)], &body.eval)
        }
        (Body::CoplanarPair(body), ReportColumn::Weights(by)) => {
            sampling([Interpolator::new(by, &body.first), Interpolator::new(by, &body.second)], &body.eval)
        }
        (Body::Depth(body), ReportColumn::Depth(format)) => {
            let buffer = DepthBuffer::new(format, body.near, body.far.unwrap_or(f32::MAX));
            storing(buffer, body.z.clone())
        }
        (Body::DepthPairs(body), ReportColumn::Depth(format)) => {
            let ratio = f64::from(body.far) / f64::from(body.near);
            let share = |i: usize| i as f64 / DISTANCES as f64;
            let distances = (0..DISTANCES).map(|i| body.near * ratio.powf(share(i)) as f32);
            storing(DepthBuffer::new(format, body.near, body.far), distances.collect())
        }
        _ => return None,
    })
}

/// Returns a function that computes the weights at all evaluated pixels. Triangle setup is not timed.
fn sampling<const N: usize>(triangles: [Option<Interpolator>; N], eval: &[[u32; 2]]) -> CaseWork<'_> {
    Box::new(move || {
        for triangle in triangles.iter().flatten() {
            for [column, row] in eval {
                black_box(triangle.weights(black_box(*column), *row));
            }
        }
    })
}

fn storing<'a>(buffer: DepthBuffer, distances: Vec<f32>) -> CaseWork<'a> {
    Box::new(move || {
        for z in &distances {
            black_box(buffer.stored(black_box(*z)));
        }
    })
}

/// Returns the number of pixels, samples or depths that the engine computes when a case is timed once. `units` is their
/// number in the case. Only for cases of random pairs, [`DISTANCES`] is returned instead.
fn timed_units(case: &StabilityCase, units: u64) -> u64 {
    if matches!(case.body, Body::DepthPairs(_)) { DISTANCES as u64 } else { units }
}

/// Timing baseline for a case: identical compact triangles that together cover about as many pixels as the case.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Twin {
    corners_px: [[f32; 2]; 3],
    viewport: Viewport,
    count: u32,
}

impl Twin {
    /// Creates right isosceles triangles with about `pixels` pixels in total, each as large as the image allows.
    fn new(pixels: u64, viewport: Viewport) -> Self {
        /// Offset of the vertices from pixel corners, in pixels, so that no pixel centre lies on an edge.
        const AT: f32 = 0.3;
        let room = f64::from(viewport.width.min(viewport.height)) - 1.0;
        let leg = (2.0 * pixels as f64).sqrt().min(room).max(1.0) as f32;
        let corners_px = [[AT, AT], [AT + leg, AT], [AT, AT + leg]];
        let one = Self { corners_px, viewport, count: 1 };
        Self { count: (pixels / one.pixels().max(1)).clamp(1, u32::MAX.into()) as u32, ..one }
    }

    fn pixels(&self) -> u64 {
        let spans = ExactRegion::triangle(self.corners_px, Snap::Unsnapped, FillRule::TopLeft).spans(self.viewport);
        pixel_count(&spans) * u64::from(self.count)
    }
}

/// Returns one timing baseline for each case that covers a pixel. Only families of screen-space triangles have
/// baselines.
fn twins(class: &Class, cases: &[StabilityCase], pixels: &[u64]) -> Vec<Twin> {
    if !matches!(class.family, Family::Coverage | Family::Mesh | Family::Throughput) {
        return Vec::new();
    }
    let visible = cases.iter().zip(pixels).filter(|(_, pixels)| **pixels > 0);
    visible.filter_map(|(case, pixels)| Some(Twin::new(*pixels, case.viewport()?))).collect()
}

fn twin_work(twins: &[Twin], column: ReportColumn) -> ClassWork<'_> {
    Box::new(move |cancel| {
        let ReportColumn::Coverage(by) = column else { return };
        for twin in twins.iter().take_while(|_| !cancel.load(Ordering::Relaxed)) {
            for _ in 0..twin.count {
                black_box(subject::cover(by, black_box(twin.corners_px), FillRule::TopLeft, twin.viewport));
            }
        }
    })
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;
    use crate::report::stability::case::Coverage;

    #[test]
    fn a_twin_has_about_as_many_pixels_as_asked_for() {
        let viewport = Viewport { width: 64, height: 32 };
        for pixels in [50, 100, 400, 5000, 100_000] {
            let twin = Twin::new(pixels, viewport);
            let found = twin.pixels() as f64 / pixels as f64;
            assert!((0.6..1.4).contains(&found), "{} px for {pixels}", twin.pixels());
        }
    }

    #[test]
    fn each_round_runs_every_work_equally_often_and_rounds_are_counted() {
        let runs = [Cell::new(0), Cell::new(0)];
        let works = runs.each_ref().map(|runs| -> ClassWork<'_> { Box::new(move |_| runs.set(runs.get() + 1)) });
        let seconds = interleaved(&works, &AtomicBool::new(false)).unwrap();
        let rounds = seconds[0].len();
        assert!((MIN_ROUNDS..=MAX_ROUNDS).contains(&rounds));
        for (seconds, runs) in seconds.iter().zip(&runs) {
            assert_eq!(seconds.len(), rounds);
            // One warm-up run, and one to determine the repetitions.
            let counted = runs.get() - 2;
            assert!(counted >= rounds && counted.is_multiple_of(rounds), "{counted} in {rounds}");
        }
        assert_eq!(interleaved(&works, &AtomicBool::new(true)), None);
    }

    #[test]
    fn a_class_that_takes_long_is_cancelled_between_its_cases() {
        let viewport = Viewport { width: 64, height: 64 };
        let many = vec![Twin::new(1_000_000, viewport); 10_000];
        let first = ReportColumn::of(Family::Coverage)[0];
        let begun = Instant::now();
        twin_work(&many, first)(&AtomicBool::new(true));
        let case = |id: &str| {
            let body = Body::TriCoverage(Coverage {
                width: 2_048,
                height: 2_048,
                rule: FillRule::TopLeft,
                exactly_once: false,
                triangles: vec![[[0.0, 0.0], [2_048.0, 1.0], [3.0, 2_048.0]]; 1_000],
            });
            StabilityCase { id: id.to_owned(), class: String::new(), note: String::new(), body }
        };
        work(&vec![case("a"); 100], first)(&AtomicBool::new(true));
        // Running all cases would take minutes.
        assert!(begun.elapsed() < Duration::from_secs(5), "{:?}", begun.elapsed());
    }

    #[test]
    fn without_pixels_there_is_no_time_per_pixel() {
        assert_eq!(spread(&[1.0, 2.0], 0), None);
        assert_eq!(spread(&[1e-6, 3e-6], 1000).unwrap().median, 2.0);
    }
}
