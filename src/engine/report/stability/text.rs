//! Stability report as plain text: one table per family and arithmetic, with one row per class.

use super::catalogue::Family;
use super::column::ReportColumn;
use super::metric::{Verdict, short};
use super::sweep::{ClassReport, ReportCell, StabilityReport};
use crate::report::PARTIAL;

/// Width of the class column, in characters.
const CLASS_WIDTH: usize = 17;

/// Width of the other columns, in characters.
const CELL_WIDTH: usize = 22;

/// Formats the stability report as plain text.
pub fn text(report: &StabilityReport) -> String {
    let mut lines = vec![
        format!(
            "Stability report, seed {}, {:.1} s on {}",
            report.seed,
            report.duration.as_secs_f64(),
            report.machines.summary()
        ),
        "Each cell: main measure of the class, then nanoseconds per pixel; * is PASS, ! is REFUSED.".to_owned(),
    ];
    for family in Family::ALL {
        let classes: Vec<&ClassReport> = report.classes.iter().filter(|c| c.class.family == family).collect();
        for (group, columns) in groups(&classes) {
            lines.push(String::new());
            lines.push(format!("{}{}", family.name(), group.map(|g| format!(" · {g}")).unwrap_or_default()));
            lines.extend(table(&classes, &columns));
        }
    }
    lines.push(String::new());
    lines.push(totals(report));
    let timed = report.classes.iter().filter_map(|class| Some((class.class.id, class.machine.as_ref()?)));
    lines.extend(timed.map(|(class, machine)| format!("{class} was timed on {machine}")));
    lines.extend(report.partial.then(|| PARTIAL.to_owned()));
    lines.join("\n") + "\n"
}

/// Groups columns by the heading of their table: the arithmetic, "as published", or `None` for depth formats.
fn groups(classes: &[&ClassReport]) -> Vec<(Option<&'static str>, Vec<ReportColumn>)> {
    let mut groups: Vec<(Option<&'static str>, Vec<ReportColumn>)> = Vec::new();
    for cell in classes.first().map(|class| &class.cells).into_iter().flatten() {
        let name = if cell.column.is_published() { Some("as published") } else { cell.column.arithmetic_name() };
        match groups.iter_mut().find(|(group, _)| *group == name) {
            Some((_, columns)) => columns.push(cell.column),
            None => groups.push((name, vec![cell.column])),
        }
    }
    groups
}

fn table(classes: &[&ClassReport], columns: &[ReportColumn]) -> Vec<String> {
    let heads: String = columns.iter().map(|column| format!(" {:>CELL_WIDTH$}", column.method())).collect();
    let mut lines = vec![format!("  {:CLASS_WIDTH$}{heads}", "")];
    for class in classes {
        let cell = |column: &ReportColumn| class.cells.iter().find(|cell| cell.column == *column);
        let cells = columns.iter().map(|column| cell(column).map(|cell| cell_text(class, cell)).unwrap_or_default());
        let cells: String = cells.map(|text| format!(" {text:>CELL_WIDTH$}")).collect();
        lines.push(format!("  {:CLASS_WIDTH$}{cells}", class.class.id));
    }
    lines
}

fn cell_text(class: &ClassReport, cell: &ReportCell) -> String {
    let metric = class.class.headline;
    let value = cell.measures.get(metric).map_or("–".to_owned(), |value| metric.format(value));
    let mark = match cell.verdict {
        Verdict::Pass => "*",
        Verdict::Measured => "",
        Verdict::Refused => "!",
    };
    let time = cell.time.and_then(|time| time.ns_per_pixel).map(|spread| format!(" {:>7} ns", short(spread.median)));
    format!("{value}{mark}{}", time.unwrap_or_default())
}

fn totals(report: &StabilityReport) -> String {
    let verdicts: Vec<Verdict> =
        report.classes.iter().flat_map(|class| &class.cells).map(|cell| cell.verdict).collect();
    let count = |verdict: Verdict| verdicts.iter().filter(|v| **v == verdict).count();
    let [pass, measured, refused] = [Verdict::Pass, Verdict::Measured, Verdict::Refused].map(count);
    let noise = report.timing_noise.map(|noise| format!("; noise floor of the times {}", noise.words()));
    format!("{pass} PASS, {measured} MEASURED, {refused} REFUSED{}", noise.unwrap_or_default())
}
