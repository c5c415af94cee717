//! Stability report as comma-separated values: one line per class and configuration, one column per metric.

use super::metric::Metric;
use super::sweep::{ClassReport, ReportCell, StabilityReport};
use crate::pipeline::settings::Choice as _;
use crate::report::{PARTIAL, quoted};

/// Headings of the columns before the metrics.
const KEYS: [&str; 10] =
    ["family", "class", "method", "arithmetic", "verdict", "cases", "refused", "triangles", "worst_case", "seed"];

/// Headings of the columns after the metrics.
const TIMES: [&str; 5] = ["ns_per_pixel", "ns_per_pixel_p10", "ns_per_pixel_p90", "ns_per_triangle", "rounds"];

/// Formats the stability report as CSV with a header line. Values that were not measured are left empty. A last column
/// names the machine that timed the class, if there were several.
pub fn csv(report: &StabilityReport) -> String {
    let metrics = Metric::ALL.iter().map(|metric| metric.id().replace('-', "_"));
    let machine = report.machines.are_several().then_some("machine");
    let head: Vec<String> = KEYS
        .into_iter()
        .map(str::to_owned)
        .chain(metrics)
        .chain(TIMES.into_iter().chain(machine).map(str::to_owned))
        .collect();
    let cells = report.classes.iter().flat_map(|class| class.cells.iter().map(move |cell| (class, cell)));
    let lines = cells.map(|(class, cell)| line(report, class, cell));
    let mark = report.partial.then(|| PARTIAL.to_owned());
    std::iter::once(head.join(",")).chain(lines).chain(mark).map(|line| line + "\n").collect()
}

/// Formats one line of the table. Only the machine needs quotation marks: every other field is a name or number from this
/// program, without commas or quotation marks.
fn line(report: &StabilityReport, class: &ClassReport, cell: &ReportCell) -> String {
    let keys = [
        class.class.family.id().to_owned(),
        class.class.id.to_owned(),
        cell.column.method().to_owned(),
        cell.column.arithmetic().unwrap_or_default().to_owned(),
        cell.verdict.name().to_owned(),
        class.cases.to_string(),
        cell.refused.to_string(),
        class.triangles.to_string(),
        cell.worst.as_ref().map(|worst| worst.of.clone()).unwrap_or_default(),
        report.seed.to_string(),
    ];
    let number = |value: Option<f64>| value.map(|value| value.to_string()).unwrap_or_default();
    let metrics = Metric::ALL.iter().map(|metric| number(cell.measures.get(*metric)));
    let spread = cell.time.and_then(|time| time.ns_per_pixel);
    let times = [
        number(spread.map(|s| s.median)),
        number(spread.map(|s| s.p10)),
        number(spread.map(|s| s.p90)),
        number(cell.time.and_then(|time| time.ns_per_triangle)),
        cell.time.map(|time| time.rounds.to_string()).unwrap_or_default(),
    ];
    let machine = report.machines.are_several().then(|| class.machine.as_deref().map(quoted).unwrap_or_default());
    keys.into_iter().chain(metrics).chain(times).chain(machine).collect::<Vec<_>>().join(",")
}
