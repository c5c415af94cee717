//! Stability report as a self-contained HTML page without scripts. It follows the system's light or dark theme.

mod heat;

mod scatter;

mod worst;

use super::metric::{Metric, Verdict};
use super::sweep::StabilityReport;
use crate::pipeline::settings::Choice as _;
use crate::report::html::{document, escaped, partial, tiles};

/// Formats the stability report as an HTML page.
pub fn html(report: &StabilityReport) -> String {
    let body = [
        head(report),
        heat::coverage(report),
        heat::weights(report),
        heat::depth(report),
        scatter::section(report),
        worst::section(report),
        method(report),
    ];
    document("Stability report", "", &body.concat())
}

fn head(report: &StabilityReport) -> String {
    let verdicts = || report.classes.iter().flat_map(|class| &class.cells).map(|cell| cell.verdict);
    let count = |verdict: Verdict| verdicts().filter(|v| *v == verdict).count();
    let total = |of: fn(&super::sweep::ClassReport) -> usize| report.classes.iter().map(of).sum::<usize>();
    let figures = [
        (report.classes.len().to_string(), "classes of cases"),
        (total(|class| class.cases).to_string(), "cases"),
        (Metric::Pixels.format(total(|class| class.triangles) as f64), "triangles"),
        (count(Verdict::Pass).to_string(), "cells PASS"),
        (count(Verdict::Measured).to_string(), "cells MEASURED"),
        (count(Verdict::Refused).to_string(), "cells REFUSED"),
        (format!("{:.0} s", report.duration.as_secs_f64()), "to run"),
    ];
    format!(
        "<h1>Stability report</h1>\n<p class=\"soft\">Errors and costs of ill-conditioned and extreme cases on every \
         rasterizer, arithmetic and depth format of Rasterscope {}. The correct results come from exact arithmetic \
         that shares no code with the code under test.</p>\n{}{}",
        escaped(report.machines.version()),
        partial(report.partial),
        tiles(figures)
    )
}

fn method(report: &StabilityReport) -> String {
    let bounds = report.classes.iter().map(|class| {
        let bounds: Vec<String> = class.class.bounds.iter().map(ToString::to_string).collect();
        format!("<dt>{}</dt><dd>{}</dd>", escaped(class.class.name), escaped(&bounds.join(", ")))
    });
    let metrics = Metric::ALL.iter().map(|m| format!("<dt>{}</dt><dd>{}</dd>", escaped(m.name()), escaped(m.help())));
    let times = match report.timing_noise {
        Some(noise) => format!(
            "Times are medians over rounds in which all configurations of a class run in turn, in a new order each \
             time, after a warm-up; short runs are repeated until the clock resolves them. One thread, no files. The \
             first configuration runs twice per round as an A/A pair. Noise floor: {}.",
            noise.words()
        ),
        None => "No times were measured.".to_owned(),
    };
    format!(
        "<section>\n<h2>How it was measured</h2>\n<p>Seed {}. {}. {times}</p>\n<p>Stiffness is the time of a case over \
         that of one compact triangle with as many pixels, by the same configuration in the same rounds.</p>\n\
         {}<details><summary>Bounds for PASS, class by class</summary><dl>{}</dl></details>\n\
         <details><summary>Definitions of the measures</summary><dl>{}</dl></details>\n</section>\n",
        report.seed,
        escaped(&report.machines.summary()),
        machines(report),
        bounds.collect::<String>(),
        metrics.collect::<String>()
    )
}

/// Lists the machine that timed each class; empty if all classes were timed by the same one.
fn machines(report: &StabilityReport) -> String {
    let timed = report.classes.iter().filter_map(|class| Some((class.class.name, class.machine.as_ref()?)));
    let list: String =
        timed.map(|(class, by)| format!("<dt>{}</dt><dd>{}</dd>", escaped(class), escaped(by))).collect();
    if list.is_empty() {
        return list;
    }
    format!("<details open><summary>Machine that timed each class</summary><dl>{list}</dl></details>\n")
}
