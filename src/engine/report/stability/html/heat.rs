//! Heat maps: one row per class, one column per configuration, with a number and a colour in each cell.

use super::worst::anchor;
use crate::pipeline::settings::Choice as _;
use crate::report::html::escaped;
use crate::report::stability::catalogue::Family;
use crate::report::stability::column::ReportColumn;
use crate::report::stability::metric::{LEVELS, Metric, Verdict, short};
use crate::report::stability::sweep::{ClassReport, ReportCell, StabilityReport};

/// Returns the heat map of rasterization errors, with one column for each combination of rasterizer and arithmetic.
pub(super) fn coverage(report: &StabilityReport) -> String {
    let families = [Family::Coverage, Family::Mesh, Family::ClipSpace, Family::Throughput];
    let text = "Single triangles count wrong pixels relative to the corners that the configuration declares (snapped \
        or not); the second line counts them relative to the corners as given (raw), or shows the time per pixel if \
        the two counts agree. Meshes count pixels that were not drawn exactly once; clip space counts pixels that are \
        clearly wrong; throughput is the time relative to a compact triangle. The published rasterizers compute with \
        their own number types.";
    section(report, &families, "Rasterizers and arithmetic", text)
}

/// Returns the heat map of interpolation errors, with one column for each combination of interpolation formula and
/// arithmetic.
pub(super) fn weights(report: &StabilityReport) -> String {
    let text = "Largest error of a weight relative to perspective-correct weights; for huge texture coordinates, in \
        texels of a texture 1024 wide; for coplanar triangles, samples where two triangles in one plane have different \
        depths. Below, the largest error of the interpolated depth in units in the last place, and answers that are \
        NaN or infinite.";
    section(report, &[Family::Weights], "Weights and attributes", text)
}

/// Returns the heat map of depth buffer formats, followed by a table that compares them in a published experiment.
pub(super) fn depth(report: &StabilityReport) -> String {
    let text = "Share of neighbouring distances that get the same stored depth or swap their order; below, the largest \
        error in units in the last place of the stored format.";
    let table = section(report, &[Family::Depth], "Depth buffer", text);
    let published = report.classes.iter().find(|class| class.class.id == "depth-published");
    match (published, table.strip_suffix("</section>\n")) {
        (Some(class), Some(open)) => format!("{open}{}</section>\n", experiment(class)),
        _ => table,
    }
}

/// Returns one heat map as an HTML section, or an empty string if no class of these families was measured.
fn section(report: &StabilityReport, families: &[Family], title: &str, text: &str) -> String {
    let classes: Vec<&ClassReport> = report.classes.iter().filter(|c| families.contains(&c.class.family)).collect();
    let Some(first) = classes.first().filter(|class| !class.cells.is_empty()) else { return String::new() };
    let columns: Vec<ReportColumn> = first.cells.iter().map(|cell| cell.column).collect();
    let bodies = families.iter().map(|family| {
        let classes: Vec<_> = classes.iter().filter(|class| class.class.family == *family).collect();
        let rows: String = classes.iter().map(|class| row(class, &columns)).collect();
        let name = format!("<tr class=\"family\"><th>{}</th></tr>\n", escaped(family.name()));
        if classes.is_empty() { String::new() } else { format!("<tbody>\n{name}{rows}</tbody>\n") }
    });
    format!(
        "<section>\n<h2>{title}</h2>\n<p class=\"soft\">{text}</p>\n{}<div class=\"scroll\"><table>\n{}{}{}</table></div>\n\
         </section>\n",
        legend(),
        header(&columns),
        bodies.collect::<String>(),
        footer(&classes, &columns),
    )
}

fn legend() -> String {
    let names = ["none", "least", "", "", "", "", "most"];
    let boxes = (0..=LEVELS).map(|level| format!("<span><i class=\"h{level}\"></i>{}</span>", names[level]));
    format!(
        "<div class=\"legend\"><span>Error, by order of magnitude:</span>{}<span><i class=\"refused\"></i>no answer</span>\
         <span>✓ within the bounds of its class</span></div>\n",
        boxes.collect::<String>()
    )
}

/// Returns the heading of a column's group: its arithmetic, or "As published"; empty for depth formats.
fn group(column: ReportColumn) -> &'static str {
    if column.is_published() { "As published" } else { column.arithmetic_name().unwrap_or_default() }
}

/// Returns whether the column at this index starts a new group.
fn starts_group(columns: &[ReportColumn], index: usize) -> bool {
    index > 0 && group_key(columns, index) != group_key(columns, index - 1)
}

/// Returns the heading under which adjacent columns are grouped: the formula for interpolation weights, otherwise the
/// result of [`group`].
fn group_key(columns: &[ReportColumn], index: usize) -> &'static str {
    match columns[index] {
        column @ ReportColumn::Weights(_) => column.method_name(),
        column => group(column),
    }
}

fn header(columns: &[ReportColumn]) -> String {
    let mut groups: Vec<(&str, usize)> = Vec::new();
    for index in 0..columns.len() {
        let name = group_key(columns, index);
        match groups.last_mut().filter(|(last, _)| *last == name) {
            Some((_, count)) => *count += 1,
            None => groups.push((name, 1)),
        }
    }
    let gap = "<th class=\"gap\"></th>";
    let heads: Vec<String> = groups
        .iter()
        .map(|(name, count)| format!("<th class=\"group\" colspan=\"{count}\">{}</th>", escaped(name)))
        .collect();
    let methods = columns.iter().enumerate().map(|(index, column)| {
        let name = match column {
            ReportColumn::Weights(_) => column.arithmetic_name().unwrap_or_default(),
            ReportColumn::Coverage(_) | ReportColumn::Depth(_) => column.method_name(),
        };
        let before = if starts_group(columns, index) { gap } else { "" };
        format!("{before}<th class=\"method\">{}</th>", escaped(name.trim_end_matches(" (as published)")))
    });
    let methods = methods.collect::<String>();
    let groups = if heads.len() > 1 { format!("<tr><th></th>{}</tr>\n", heads.join(gap)) } else { String::new() };
    format!("<thead>\n{groups}<tr><th></th>{methods}</tr>\n</thead>\n")
}

fn row(class: &ClassReport, columns: &[ReportColumn]) -> String {
    let cells = columns.iter().enumerate().map(|(index, column)| {
        let before = if starts_group(columns, index) { "<td class=\"gap\"></td>" } else { "" };
        let cell = class.cells.iter().find(|cell| cell.column == *column);
        let text = cell.map_or("<td class=\"none\">–</td>".to_owned(), |cell| self::cell(class, cell));
        format!("{before}{text}")
    });
    let counts = format!("{} cases, {}", class.cases, class.class.headline.name());
    format!(
        "<tr><th title=\"{}\">{}<small>{}</small></th>{}</tr>\n",
        escaped(class.class.about),
        escaped(class.class.name),
        escaped(&counts),
        cells.collect::<String>()
    )
}

fn cell(class: &ClassReport, cell: &ReportCell) -> String {
    let headline = class.class.headline;
    let level = cell.measures.severity(headline);
    let style = match (cell.verdict, level) {
        (Verdict::Refused, _) => "refused".to_owned(),
        (_, None) => "none".to_owned(),
        (Verdict::Pass, Some(level)) => format!("h{level} pass"),
        (Verdict::Measured, Some(level)) => format!("h{level}"),
    };
    let value = match cell.measures.get(headline) {
        _ if cell.verdict == Verdict::Refused => format!("{} refused", cell.refused),
        Some(value) => headline.format(value),
        None => "–".to_owned(),
    };
    let inner = format!("<b>{}</b><span>{}</span>", escaped(&value), escaped(&second_line(class, cell)));
    let linked = match &cell.worst {
        Some(worst) => format!("<a href=\"#{}\">{inner}</a>", anchor(class, worst)),
        None => inner,
    };
    format!("<td class=\"{style}\" title=\"{}\">{linked}</td>", escaped(&tooltip(class, cell)))
}

/// Returns the small second line of a cell: the most informative metric after the headline or, if there is none, the
/// time per pixel.
fn second_line(class: &ClassReport, cell: &ReportCell) -> String {
    let value = |metric: Metric| cell.measures.get(metric).filter(|value| *value > 0.0);
    let time = || cell.time.and_then(|time| time.ns_per_pixel).map(|spread| format!("{} ns", short(spread.median)));
    let second = match class.class.family {
        Family::Coverage => {
            let unsnapped = value(Metric::WrongUnsnapped).filter(|u| Some(*u) != cell.measures.get(Metric::Wrong));
            unsnapped.map(|count| format!("{} raw", brief(count)))
        }
        Family::Mesh => value(Metric::Wrong).map(|count| format!("{} wrong", brief(count))),
        Family::ClipSpace => value(Metric::WeightError).map(|error| format!("λ′ {}", short(error))),
        Family::Weights | Family::Depth => {
            let broken = value(Metric::NotFinite).map(|count| format!("{count:.0} NaN"));
            broken.or_else(|| value(Metric::DepthUlp).map(|ulp| format!("{} ulp", short(ulp))))
        }
        Family::Throughput => None,
    };
    second.or_else(time).unwrap_or_default()
}

/// Formats a count in at most five characters.
fn brief(count: f64) -> String {
    if count < 1e4 { format!("{count:.0}") } else { format!("{count:.1e}") }
}

/// Returns the tooltip of a cell: all its measurements, one per line.
fn tooltip(class: &ClassReport, cell: &ReportCell) -> String {
    let mut lines = vec![format!("{} · {}: {}", class.class.name, cell.column.label(), cell.verdict.name())];
    lines.extend(cell.measures.iter().map(|(metric, value)| format!("{}: {}", metric.name(), metric.format(value))));
    if let Some(time) = cell.time {
        if let Some(spread) = time.ns_per_pixel {
            let [median, p10, p90] = [spread.median, spread.p10, spread.p90].map(short);
            lines.push(format!("{median} ns per pixel ({p10} to {p90}, {} rounds)", time.rounds));
        }
        lines.extend(time.ns_per_triangle.map(|ns| format!("{} ns per triangle", short(ns))));
    }
    lines.join("\n")
}

/// Returns the footer row of a heat map: the geometric mean of each column's time per pixel over all classes.
fn footer(classes: &[&ClassReport], columns: &[ReportColumn]) -> String {
    let mean = |column: &ReportColumn| {
        let times = classes.iter().filter_map(|class| {
            let cell = class.cells.iter().find(|cell| cell.column == *column)?;
            Some(cell.time?.ns_per_pixel?.median.ln())
        });
        let logarithms: Vec<f64> = times.collect();
        (!logarithms.is_empty()).then(|| (logarithms.iter().sum::<f64>() / logarithms.len() as f64).exp())
    };
    let means: Vec<Option<f64>> = columns.iter().map(mean).collect();
    if means.iter().all(Option::is_none) {
        return String::new();
    }
    let cells = means.iter().enumerate().map(|(index, mean)| {
        let before = if starts_group(columns, index) { "<td class=\"gap\"></td>" } else { "" };
        format!("{before}<td><b>{}</b><span>ns</span></td>", mean.map(short).unwrap_or_default())
    });
    format!(
        "<tfoot><tr><th>Time per pixel<small>geometric mean</small></th>{}</tr></tfoot>\n",
        cells.collect::<String>()
    )
}

/// Returns the published depth experiment as an HTML table with one row per setting. Each cell shows the tied and the
/// inverted pairs, in percent of all pairs.
fn experiment(class: &ClassReport) -> String {
    let Some(first) = class.cells.first() else { return String::new() };
    let heads: String =
        class.cells.iter().map(|cell| format!("<th>{}</th>", escaped(cell.column.method_name()))).collect();
    let rows = first.by_case.iter().enumerate().map(|(index, case)| {
        let cells = class.cells.iter().map(|cell| {
            let measures = cell.by_case.get(index).and_then(|case| case.measures);
            let share = |metric| Some(measures?.get(metric)? * 100.0 / measures?.get(Metric::Pairs)?);
            let text = share(Metric::Ties)
                .zip(share(Metric::Inversions))
                .map_or("–".to_owned(), |(ties, inversions)| format!("{} + {}", percent(ties), percent(inversions)));
            format!("<td>{text}</td>")
        });
        format!("<tr><td>{}</td>{}</tr>\n", escaped(&case.note), cells.collect::<String>())
    });
    format!(
        "<h3>{}</h3>\n<p class=\"soft\">{} Per cent of 200 000 random pairs per setting: tied + inverted. The \
         remaining loss of reversed depth arises in the transform from world to view.</p>\n<div \
         class=\"scroll\"><table \
         class=\"plain\">\n<thead><tr><th></th>{heads}</tr></thead>\n<tbody>\n{}</tbody></table></div>\n",
        escaped(class.class.name),
        escaped(class.class.about),
        rows.collect::<String>()
    )
}

/// Formats a percentage with two decimals, as in the published tables.
fn percent(value: f64) -> String {
    if value == 0.0 { "0".to_owned() } else { format!("{value:.2}") }
}
