//! Trade-off of error against time.
//!
//! There is one point per configuration. Its time is the geometric mean of the time per pixel over all classes, so that
//! classes with a high cost per pixel do not dominate. Its error is the mean fraction of wrong pixels for rasterizers,
//! and the largest error of a weight for interpolation formulas.

use super::catalogue::Family;
use super::column::ReportColumn;
use super::metric::Metric;
use super::sweep::{ClassReport, ReportCell, StabilityReport};
use super::timing::Spread;
use crate::measure::noise::Noise;
use crate::report::upscaling::tradeoff::{Standing, standings};

/// Time and error of a configuration.
#[derive(Clone, Debug, PartialEq)]
pub struct TradeoffPoint {
    /// Configuration of the engine.
    pub column: ReportColumn,
    /// Time per pixel or sample, in nanoseconds.
    pub ns: Spread,
    /// Error of the results, as a fraction of wrong pixels or as a weight error; 0 if every result is correct.
    pub error: f64,
    /// Number of non-finite results, which the error does not include.
    pub(crate) not_finite: f64,
    /// Whether the point is on the Pareto front of time and error, accounting for timing noise.
    pub(crate) optimal: bool,
    /// Id, nanoseconds per pixel, and error of each class.
    pub(crate) by_class: Vec<(&'static str, f64, f64)>,
}

/// Returns one trade-off point for each combination of rasterizer and arithmetic. The error is the fraction of wrong
/// pixels relative to unsnapped vertices, averaged over the classes of single triangles and meshes.
pub fn coverage(report: &StabilityReport) -> Vec<TradeoffPoint> {
    let share = |cell: &ReportCell| {
        let pixels = cell.measures.get(Metric::Pixels).filter(|pixels| *pixels > 0.0)?;
        Some(cell.measures.get(Metric::WrongUnsnapped)? / pixels)
    };
    let mean = |errors: &[f64]| errors.iter().sum::<f64>() / errors.len() as f64;
    points(report, &[Family::Coverage, Family::Mesh], share, mean)
}

/// Returns one trade-off point for each combination of interpolation formula and arithmetic. The error is the largest
/// error of a weight.
pub(crate) fn weights(report: &StabilityReport) -> Vec<TradeoffPoint> {
    let error = |cell: &ReportCell| cell.measures.get(Metric::WeightError);
    let largest = |errors: &[f64]| errors.iter().copied().fold(0.0, f64::max);
    points(report, &[Family::Weights], error, largest)
}

/// Returns one trade-off point for each timed column. `error` returns the error of a cell; `join` combines the errors
/// of all classes.
fn points(
    report: &StabilityReport,
    families: &[Family],
    error: impl Fn(&ReportCell) -> Option<f64>,
    join: impl Fn(&[f64]) -> f64,
) -> Vec<TradeoffPoint> {
    let classes: Vec<&ClassReport> = report.classes.iter().filter(|c| families.contains(&c.class.family)).collect();
    let columns = classes.first().map(|class| class.cells.iter().map(|cell| cell.column)).into_iter().flatten();
    let point = |column: ReportColumn| {
        let cells = classes.iter().filter_map(|class| Some((class, class.cells.iter().find(|c| c.column == column)?)));
        let complete: Vec<_> = cells
            .filter_map(|(class, cell)| Some((class.class.id, cell.time?.ns_per_pixel?, error(cell)?, cell)))
            .collect();
        let errors: Vec<f64> = complete.iter().map(|(_, _, error, _)| *error).collect();
        let middle = |of: fn(&Spread) -> f64| geometric_mean(complete.iter().map(|(_, spread, _, _)| of(spread)));
        Some(TradeoffPoint {
            column,
            ns: Spread { median: middle(|s| s.median)?, p10: middle(|s| s.p10)?, p90: middle(|s| s.p90)? },
            error: join(&errors),
            not_finite: complete.iter().filter_map(|(_, _, _, cell)| cell.measures.get(Metric::NotFinite)).sum(),
            optimal: false,
            by_class: complete.iter().map(|(id, spread, error, _)| (*id, spread.median, *error)).collect(),
        })
    };
    let mut points: Vec<TradeoffPoint> = columns.filter_map(point).collect();
    if let Some(noise) = &report.timing_noise {
        mark_optimal(&mut points, noise);
    }
    points
}

fn mark_optimal(points: &mut [TradeoffPoint], noise: &Noise) {
    let places: Vec<(f64, f64)> = points.iter().map(|point| (point.ns.median, point.error)).collect();
    for (point, standing) in points.iter_mut().zip(standings(&places, noise)) {
        point.optimal = point.not_finite == 0.0 && standing == Standing::Front;
    }
}

/// Computes the geometric mean. Returns `None` for an empty sequence or if a value is not positive.
fn geometric_mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let logarithms: Vec<f64> = values.map(f64::ln).collect();
    let mean = logarithms.iter().sum::<f64>() / logarithms.len() as f64;
    mean.is_finite().then(|| mean.exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_on_the_pareto_front_are_optimal() {
        let column = ReportColumn::of(Family::Depth)[0];
        let point = |ns: f64, error: f64| TradeoffPoint {
            column,
            ns: Spread { median: ns, p10: ns, p90: ns },
            error,
            not_finite: 0.0,
            optimal: false,
            by_class: Vec::new(),
        };
        let mut points = [point(1.0, 0.5), point(2.0, 0.1), point(3.0, 0.1), point(4.0, 0.0), point(5.0, 0.7)];
        points[1].not_finite = 1.0;
        let noise = Noise { pairs: 10, p90: 0.02 };
        mark_optimal(&mut points, &noise);
        assert_eq!(points.each_ref().map(|point| point.optimal), [true, false, false, true, false]);
        points[0].ns.median = 3.99;
        mark_optimal(&mut points, &noise);
        assert!(!points[0].optimal, "a lead of 0.25 % over the one without error");
    }

    #[test]
    fn the_geometric_mean_is_the_middle_of_magnitudes() {
        assert!((geometric_mean([1.0, 100.0].into_iter()).unwrap() - 10.0).abs() < 1e-12);
        assert_eq!(geometric_mean(std::iter::empty()), None);
        assert_eq!(geometric_mean([1.0, 0.0].into_iter()), None);
    }
}
