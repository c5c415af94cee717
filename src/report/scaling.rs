//! What a frame costs against what it is of, as text, as a table, and as a page for the browser.

use std::fmt::Write as _;

use super::html::{document, escaped, tiles};
use super::plot::{Axis, MARK, Plot, svg, tick};
use super::stability::machine::Machine;
use crate::measure::scaling::{Point, Quantity, Scaling, Series};

/// What this page has of its own.
const STYLE: &str = "svg .points { fill: none; stroke: var(--c0); stroke-width: 2; } svg .mark { fill: var(--c0); } \
    svg .bar { stroke: var(--c0); opacity: 0.55; } svg .line { fill: none; stroke: var(--soft); stroke-dasharray: 5 4; }\n\
    table.rows td, table.rows th { text-align: right; padding: 3px 10px; }\n";

/// How a quantity is looked at.
struct View {
    title: &'static str,
    of: &'static str,
    /// What one of it is called.
    one: &'static str,
}

fn view(quantity: Quantity) -> View {
    let (title, of, one) = match quantity {
        Quantity::Triangles => {
            ("Triangles", "a textured sheet of ever smaller triangles that fills the picture's height", "triangle")
        }
        Quantity::Pixels => ("Pixels", "pictures of ever more pixels, all of one textured square", "pixel"),
        Quantity::Layers => (
            "Layers",
            "textured squares behind each other, the farthest drawn first: all but one are hidden in the end",
            "layer",
        ),
        Quantity::Threads => {
            ("Threads", "a sheet of a hundred thousand triangles, drawn by more and more threads", "thread")
        }
    };
    View { title, of, one }
}

/// Nanoseconds for each one, as if nothing else cost anything.
fn ns_each(point: &Point) -> f64 {
    point.ms.median * 1e6 / point.value
}

/// How much faster than the first point of the series.
fn speed_up(series: &Series, point: &Point) -> Option<f64> {
    Some(series.points.first()?.ms.median / point.ms.median)
}

/// What the line through the ends of a series says, in words.
pub fn finding(series: &Series) -> String {
    let View { one, .. } = view(series.quantity);
    if series.quantity == Quantity::Threads {
        let last = series.points.last().and_then(|point| Some((point.value, speed_up(series, point)?)));
        return last.map_or_else(String::new, |(threads, times)| {
            format!("{threads} threads are {times:.2} times as fast as one.")
        });
    }
    match series.line() {
        Some(line) => {
            let bend = if line.fixed_ms > 0.0 {
                format!(" Both are equal at {}: below, cost hardly depends on it.", short(line.bend()))
            } else {
                String::new()
            };
            format!("{:.3} ms whatever it is, and {} ns for each {one}.{bend}", line.fixed_ms, short(line.ns_each))
        }
        None => "Cost does not grow with it.".to_owned(),
    }
}

/// Three digits, with the powers of a thousand that people write.
fn short(value: f64) -> String {
    let (scaled, unit) = match value {
        v if v >= 1e6 => (v / 1e6, " million"),
        v if v >= 1e4 => (v / 1e3, " thousand"),
        v => (v, ""),
    };
    let digits = if scaled >= 100.0 { 0 } else { 2 - usize::from(scaled >= 10.0) };
    format!("{scaled:.digits$}{unit}")
}

/// The tables for a terminal.
pub fn text(scaling: &Scaling) -> String {
    let [width, height] = scaling.size;
    let mut text =
        format!("{width} × {height} px, {} threads, medians of {} rounds\n", scaling.threads, scaling.rounds);
    for series in &scaling.series {
        let View { title, of, .. } = view(series.quantity);
        let _ = write!(
            text,
            "\n{title}: {of}\n{:>12} {:>10} {:>10} {:>10} {:>12} {:>10}\n",
            series.quantity.name(),
            "ms",
            "p10",
            "p90",
            "ns each",
            "MB"
        );
        for point in &series.points {
            let ms = point.ms;
            let _ = writeln!(
                text,
                "{:12} {:10.3} {:10.3} {:10.3} {:12.2} {:10.1}",
                point.value,
                ms.median,
                ms.p10,
                ms.p90,
                ns_each(point),
                point.bytes as f64 / 1e6
            );
        }
        let _ = writeln!(text, "{}", finding(series));
    }
    text
}

/// One line per point.
pub fn csv(scaling: &Scaling) -> String {
    let mut csv = "quantity,value,rounds,ms,p10,p90,ns_each,bytes\n".to_owned();
    for (series, point) in scaling.series.iter().flat_map(|s| s.points.iter().map(move |point| (s, point))) {
        let ms = point.ms;
        let _ = writeln!(
            csv,
            "{},{},{},{},{},{},{},{}",
            series.quantity.name(),
            point.value,
            ms.n,
            ms.median,
            ms.p10,
            ms.p90,
            ns_each(point),
            point.bytes
        );
    }
    csv
}

/// The page.
pub fn page(scaling: &Scaling) -> String {
    let [width, height] = scaling.size;
    let machine = Machine::here();
    let figures = [
        (format!("{width} × {height}"), "pixels, but where they vary"),
        (scaling.threads.to_string(), "threads, but where they vary"),
        (scaling.rounds.to_string(), "rounds"),
    ];
    let mut body = format!(
        "<h1>What a frame costs</h1>\n<p class=\"soft\">Whole frames of generated scenes against one quantity at a time. \
         Rasterscope {} on {}, {}.{}</p>\n{}",
        escaped(machine.version),
        escaped(&machine.platform),
        escaped(machine.processor.as_deref().unwrap_or("unknown processor")),
        if machine.optimized { "" } else { " The program was not optimised: its times say little." },
        tiles(figures)
    );
    scaling.series.iter().for_each(|series| body += &section(series));
    document("What a frame costs", STYLE, &body)
}

fn section(series: &Series) -> String {
    let View { title, of, one } = view(series.quantity);
    let mut rows = String::new();
    for point in &series.points {
        let ms = point.ms;
        let times = speed_up(series, point).filter(|_| series.quantity == Quantity::Threads);
        let each = times.map_or_else(|| short(ns_each(point)), |times| format!("{times:.2} ×"));
        let _ = writeln!(
            rows,
            "<tr><td>{}</td><td>{:.3}</td><td>{:.3}</td><td>{:.3}</td><td>{each}</td><td>{:.1}</td></tr>",
            point.value,
            ms.median,
            ms.p10,
            ms.p90,
            point.bytes as f64 / 1e6
        );
    }
    let each = if series.quantity == Quantity::Threads { "speed-up".to_owned() } else { format!("ns per {one}") };
    format!(
        "<section>\n<h2>{title}</h2>\n<p class=\"soft\">Drawn: {}. {}</p>\n<div class=\"panels\"><figure>{}</figure></div>\n\
         <div class=\"scroll\"><table class=\"rows\">\n<thead><tr><th>{}</th><th>median ms</th><th>p10</th><th>p90</th>\
         <th>{each}</th><th>MB</th></tr></thead>\n<tbody>\n{rows}</tbody></table></div>\n</section>\n",
        escaped(of),
        escaped(&finding(series)),
        drawing(series),
        series.quantity.name()
    )
}

/// Times against the quantity, both logarithmic, with the line through the ends.
fn drawing(series: &Series) -> String {
    let times = series.points.iter().flat_map(|point| [point.ms.p10, point.ms.median, point.ms.p90]);
    let Some((x, y)) = Axis::log(series.points.iter().map(|point| point.value)).zip(Axis::log(times)) else {
        return String::new();
    };
    let plot = Plot { x, y, lane: 0.0 };
    let mut content = plot.axes(series.quantity.name(), "median time of a frame, ms", tick);
    let at = |value: f64, ms: f64| format!("{:.1},{:.1}", plot.x(value), plot.y(ms));
    if let (Some(line), Some(first), Some(last)) = (series.line(), series.points.first(), series.points.last()) {
        /// Pieces of the line: it is no straight one where both axes are logarithmic.
        const PIECES: i32 = 60;
        let ratio = last.value / first.value;
        let along = (0..=PIECES).map(|i| first.value * ratio.powf(f64::from(i) / f64::from(PIECES)));
        let points: Vec<_> = along.map(|value| at(value, line.fixed_ms + line.ns_each * value / 1e6)).collect();
        let _ = write!(content, "<polyline class=\"line\" points=\"{}\"/>", points.join(" "));
    }
    let points: Vec<_> = series.points.iter().map(|point| at(point.value, point.ms.median)).collect();
    let _ = write!(content, "<polyline class=\"points\" points=\"{}\"/>", points.join(" "));
    for point in &series.points {
        let (x, y) = (plot.x(point.value), plot.y(point.ms.median));
        let _ = write!(
            content,
            "<g><title>{}: {:.3} ms</title><line class=\"bar\" x1=\"{x:.1}\" x2=\"{x:.1}\" y1=\"{:.1}\" y2=\"{:.1}\"/>\
             <circle class=\"mark\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{MARK}\"/></g>",
            point.value,
            point.ms.median,
            plot.y(point.ms.p10),
            plot.y(point.ms.p90)
        );
    }
    svg("Time of a frame", &content)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::timing::summarize;

    fn scaling() -> Scaling {
        let point = |value: f64, ms: f64| Point { value, ms: summarize(&[ms]).unwrap(), bytes: 2_000_000 };
        let series = |quantity, points| Series { quantity, points };
        Scaling {
            size: [64, 36],
            threads: 2,
            rounds: 1,
            series: vec![
                series(Quantity::Triangles, vec![point(1000.0, 3.0), point(5000.0, 7.0)]),
                series(Quantity::Threads, vec![point(1.0, 8.0), point(2.0, 5.0)]),
            ],
        }
    }

    #[test]
    fn fixed_and_growing_cost_are_told_in_words() {
        let scaling = scaling();
        assert_eq!(
            finding(&scaling.series[0]),
            "2.000 ms whatever it is, and 1000 ns for each triangle. Both are equal at 2000: below, cost hardly depends on it."
        );
        assert_eq!(finding(&scaling.series[1]), "2 threads are 1.60 times as fast as one.");
        assert!(text(&scaling).contains("        1000      3.000"), "{}", text(&scaling));
    }

    #[test]
    fn the_page_draws_every_point_and_the_table_has_a_line_for_each() {
        let page = page(&scaling());
        assert_eq!(page.matches("class=\"mark\"").count(), 4);
        assert_eq!((page.matches("<section>").count(), page.matches("</section>").count()), (2, 2));
        assert_eq!(csv(&scaling()).lines().count(), 5);
    }

    #[test]
    fn large_numbers_are_written_as_people_do() {
        assert_eq!(
            [0.5, 12.34, 999.6, 25_000.0, 3_210_000.0].map(short),
            ["0.50", "12.3", "1000", "25.0 thousand", "3.21 million"]
        );
    }
}
