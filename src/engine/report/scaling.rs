//! Report on how frame time scales with the numbers of triangles, pixels, layers and threads, as text, CSV, and an HTML
//! page.

use std::fmt::Write as _;

use super::PARTIAL;
use super::html::{document, escaped, partial, tiles};
use super::plot::{MARK, Plot, PlotAxis, svg};
use crate::measure::machine::Machine;
use crate::measure::scaling::{Scaling, ScalingPoint, ScalingQuantity, Series};

/// CSS rules specific to the scaling report.
const STYLE: &str = "svg .points { fill: none; stroke: var(--c0); stroke-width: 2; } svg .mark { fill: var(--c0); } \
    svg .bar { stroke: var(--c0); opacity: 0.55; } svg .line { fill: none; stroke: var(--soft); stroke-dasharray: 5 4; }\n\
    table.rows td, table.rows th { text-align: right; padding: 3px 10px; }\n";

/// Text that describes the quantity on the x-axis, such as the number of triangles, in the report.
struct QuantityDescription {
    title: &'static str,
    of: &'static str,
    /// Singular noun for one unit of the varied quantity, such as "triangle".
    one: &'static str,
}

fn view(quantity: ScalingQuantity) -> QuantityDescription {
    let (title, of, one) = match quantity {
        ScalingQuantity::Triangles => {
            ("Triangles", "a textured sheet as high as the picture, of ever smaller triangles", "triangle")
        }
        ScalingQuantity::Pixels => ("Pixels", "one textured square in pictures of increasing size", "pixel"),
        ScalingQuantity::Layers => {
            ("Layers", "textured squares behind each other, drawn back to front: all but the last are hidden", "layer")
        }
        ScalingQuantity::Threads => {
            ("Threads", "a sheet of a hundred thousand triangles, drawn by an increasing number of threads", "thread")
        }
    };
    QuantityDescription { title, of, one }
}

/// Returns the frame time per unit of the varied quantity, in nanoseconds.
fn ns_each(point: &ScalingPoint) -> f64 {
    point.ms.median * 1e6 / point.value
}

/// Returns the speed-up of a point relative to the first point of the series, or `None` if the series is empty.
fn speed_up(series: &Series, point: &ScalingPoint) -> Option<f64> {
    Some(series.points.first()?.ms.median / point.ms.median)
}

/// Describes a series in one or two sentences: the line through its first and last points or, for a series over
/// threads, the speed-up. Returns `None` for a series over threads with only one thread.
pub fn finding(series: &Series) -> Option<String> {
    let QuantityDescription { one, .. } = view(series.quantity);
    if series.quantity == ScalingQuantity::Threads {
        let last = series.points.last().filter(|point| point.value > 1.0)?;
        let times = speed_up(series, last)?;
        return Some(format!("{} threads are {times:.2} times as fast as one.", last.value));
    }
    let Some(line) = series.line() else { return Some(format!("Cost does not grow with the number of {one}s.")) };
    let each = duration(line.ns_each);
    if line.fixed_ms < 0.0 {
        return Some(format!(
            "Cost grows faster than the number of {one}s: {each} for each {one} beyond the first point."
        ));
    }
    Some(format!(
        "{:.3} ms of fixed cost, and {each} for each {one}. Both parts are equal at {}; below, cost hardly depends on \
            the number.",
        line.fixed_ms,
        short(line.bend())
    ))
}

/// Returns the reference curve of a series: the line through its first and last point, or ideal scaling for threads.
/// The points are (value, milliseconds), dense enough for a smooth curve on logarithmic axes. Empty if the series has
/// no points or, except for threads, if cost does not rise.
pub fn guide(series: &Series) -> Vec<(f64, f64)> {
    /// Number of line segments that approximate the curve.
    const PIECES: i32 = 60;
    let (Some(first), Some(last)) = (series.points.first(), series.points.last()) else { return Vec::new() };
    let line = series.line();
    let ms = |value: f64| match series.quantity {
        ScalingQuantity::Threads => Some(first.ms.median * first.value / value),
        _ => line.map(|line| line.fixed_ms + line.ns_each * value / 1e6),
    };
    let ratio = last.value / first.value;
    let along = (0..=PIECES).map(|i| first.value * ratio.powf(f64::from(i) / f64::from(PIECES)));
    along.filter_map(|value| Some((value, ms(value)?))).collect()
}

/// Returns the legend of the reference curve that [`guide`] computes.
fn guide_words(quantity: ScalingQuantity) -> &'static str {
    match quantity {
        ScalingQuantity::Threads => "Dashed: ideal scaling, n threads n times as fast as one.",
        _ => "Dashed: a fixed cost plus the same cost for each additional one, through the first and the last point.",
    }
}

/// Returns by how many nanoseconds the frame time grows per additional unit of the varied quantity, between the
/// previous point and the point at index `place`. Returns `None` for the first point.
fn ns_each_more(series: &Series, place: usize) -> Option<f64> {
    let (point, before) = (series.points.get(place)?, series.points.get(place.checked_sub(1)?)?);
    Some((point.ms.median - before.ms.median) * 1e6 / (point.value - before.value))
}

/// Formats a number compactly for axis labels, for example 20 k or 8.3 M.
pub fn amount(value: f64) -> String {
    let (scaled, unit) = match value {
        v if v >= 1e6 => (v / 1e6, " M"),
        v if v >= 1e3 => (v / 1e3, " k"),
        v => (v, ""),
    };
    format!("{}{unit}", (scaled * 100.0).round() / 100.0)
}

/// Formats an integer exactly, with thin spaces between groups of three digits.
fn grouped(value: f64) -> String {
    /// Digit group separator, which cannot be mistaken for a decimal sign.
    const THIN_SPACE: char = '\u{2009}';
    let digits = format!("{value:.0}");
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(THIN_SPACE);
        }
        text.push(digit);
    }
    text
}

/// Formats a duration in ns, µs or ms.
fn duration(ns: f64) -> String {
    match ns {
        ns if ns.abs() >= 1e7 => format!("{} ms", short(ns / 1e6)),
        ns if ns.abs() >= 1e4 => format!("{} µs", short(ns / 1e3)),
        ns => format!("{} ns", short(ns)),
    }
}

/// Formats a number with at least three significant digits, using the words "thousand" and "million" for large numbers.
fn short(value: f64) -> String {
    let (scaled, unit) = match value {
        v if v >= 1e6 => (v / 1e6, " million"),
        v if v >= 1e4 => (v / 1e3, " thousand"),
        v => (v, ""),
    };
    let digits = if scaled >= 100.0 { 0 } else { 2 - usize::from(scaled >= 10.0) };
    format!("{scaled:.digits$}{unit}")
}

/// Formats the scaling report as tables for a terminal.
pub fn text(scaling: &Scaling) -> String {
    let [width, height] = scaling.size;
    let mut text =
        format!("{width} × {height} px, {} threads, medians of {} rounds\n", scaling.threads, scaling.rounds);
    for series in &scaling.series {
        let QuantityDescription { title, of, .. } = view(series.quantity);
        // Threads share the work, so cost per thread is meaningless.
        let by_threads = series.quantity == ScalingQuantity::Threads;
        let each = if by_threads { String::new() } else { format!("{:>12} {:>14} ", "ns per unit", "ns per extra") };
        let _ = write!(
            text,
            "\n{title}: {of}\n{:>12} {:>10} {:>10} {:>10} {each}{:>10}\n",
            series.quantity.name(),
            "ms",
            "p10",
            "p90",
            "MB"
        );
        for (place, point) in series.points.iter().enumerate() {
            let ms = point.ms;
            let more = ns_each_more(series, place).map_or_else(|| "–".to_owned(), |ns| format!("{ns:.2}"));
            let each = if by_threads { String::new() } else { format!("{:12.2} {more:>14} ", ns_each(point)) };
            let _ = writeln!(
                text,
                "{:12} {:10.3} {:10.3} {:10.3} {each}{:10.1}",
                point.value,
                ms.median,
                ms.p10,
                ms.p90,
                point.bytes as f64 / 1e6
            );
        }
        if let Some(finding) = finding(series) {
            let _ = writeln!(text, "{finding}");
        }
    }
    if scaling.partial {
        let _ = writeln!(text, "{PARTIAL}");
    }
    text
}

/// Formats the scaling report as CSV, one line per point. For the thread series, the cost per unit is left empty.
pub fn csv(scaling: &Scaling) -> String {
    let mut csv = "quantity,value,rounds,ms,p10,p90,ns_each,bytes\n".to_owned();
    for (series, point) in scaling.series.iter().flat_map(|s| s.points.iter().map(move |point| (s, point))) {
        let ms = point.ms;
        let each = if series.quantity == ScalingQuantity::Threads { String::new() } else { ns_each(point).to_string() };
        let _ = writeln!(
            csv,
            "{},{},{},{},{},{},{each},{}",
            series.quantity.name(),
            point.value,
            ms.n,
            ms.median,
            ms.p10,
            ms.p90,
            point.bytes
        );
    }
    if scaling.partial {
        let _ = writeln!(csv, "{PARTIAL}");
    }
    csv
}

/// Formats the scaling report as an HTML page.
pub fn page(scaling: &Scaling) -> String {
    let [width, height] = scaling.size;
    let machine = Machine::at_start();
    let figures = [
        (format!("{width} × {height}"), "pixels, unless varied"),
        (scaling.threads.to_string(), "threads, unless varied"),
        (scaling.rounds.to_string(), "rounds"),
    ];
    let mut body = format!(
        "<h1>Cost of a frame</h1>\n<p class=\"soft\">Times of whole frames of generated scenes, with one quantity \
         varied at a time. Rasterscope {} on {}.</p>\n{}{}",
        escaped(&machine.version),
        escaped(&machine.summary()),
        partial(scaling.partial),
        tiles(figures)
    );
    scaling.series.iter().for_each(|series| body += &section(series));
    document("Cost of a frame", STYLE, &body)
}

fn section(series: &Series) -> String {
    let QuantityDescription { title, of, one } = view(series.quantity);
    let mut rows = String::new();
    let by_threads = series.quantity == ScalingQuantity::Threads;
    for (place, point) in series.points.iter().enumerate() {
        let ms = point.ms;
        let each = match speed_up(series, point).filter(|_| by_threads) {
            Some(times) => format!("<td>{times:.2} ×</td>"),
            None => {
                let more = ns_each_more(series, place).map_or_else(|| "–".to_owned(), duration);
                format!("<td>{}</td><td>{more}</td>", duration(ns_each(point)))
            }
        };
        let _ = writeln!(
            rows,
            "<tr><td>{}</td><td>{:.3}</td><td>{:.3}</td><td>{:.3}</td>{each}<td>{:.1}</td></tr>",
            grouped(point.value),
            ms.median,
            ms.p10,
            ms.p90,
            point.bytes as f64 / 1e6
        );
    }
    let each = if by_threads {
        "<th>speed-up</th>".to_owned()
    } else {
        format!("<th>per {one}</th><th>per additional {one}</th>")
    };
    format!(
        "<section>\n<h2>{title}</h2>\n<p class=\"soft\">Drawn: {}. {}</p>\n<div class=\"panels\"><figure>{}<figcaption class=\"soft\">{}</figcaption></figure></div>\n\
         <div class=\"scroll\"><table class=\"rows\">\n<thead><tr><th>{}</th><th>median ms</th><th>p10</th><th>p90</th>\
         {each}<th>MB</th></tr></thead>\n<tbody>\n{rows}</tbody></table></div>\n</section>\n",
        escaped(of),
        escaped(&finding(series).unwrap_or_default()),
        drawing(series),
        if guide(series).is_empty() { "" } else { guide_words(series.quantity) },
        series.quantity.name()
    )
}

/// Returns an SVG plot of frame time against the varied quantity, on logarithmic axes, with the reference curve of
/// [`guide`].
fn drawing(series: &Series) -> String {
    let times = series.points.iter().flat_map(|point| [point.ms.p10, point.ms.median, point.ms.p90]);
    let times = times.chain(guide(series).into_iter().map(|(_, ms)| ms));
    let Some((x, y)) = PlotAxis::log(series.points.iter().map(|point| point.value)).zip(PlotAxis::log(times)) else {
        return String::new();
    };
    let plot = Plot { x, y, lane: 0.0 };
    let mut content = plot.axes(series.quantity.name(), "median time of a frame, ms", amount);
    let at = |value: f64, ms: f64| format!("{:.1},{:.1}", plot.x(value), plot.y(ms));
    let guide: Vec<_> = guide(series).into_iter().map(|(value, ms)| at(value, ms)).collect();
    if !guide.is_empty() {
        let _ = write!(content, "<polyline class=\"line\" points=\"{}\"/>", guide.join(" "));
    }
    let points: Vec<_> = series.points.iter().map(|point| at(point.value, point.ms.median)).collect();
    let _ = write!(content, "<polyline class=\"points\" points=\"{}\"/>", points.join(" "));
    for point in &series.points {
        let (x, y) = (plot.x(point.value), plot.y(point.ms.median));
        let _ = write!(
            content,
            "<g><title>{} {}: {:.3} ms</title><line class=\"bar\" x1=\"{x:.1}\" x2=\"{x:.1}\" y1=\"{:.1}\" y2=\"{:.1}\"/>\
             <circle class=\"mark\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{MARK}\"/></g>",
            grouped(point.value),
            series.quantity.name(),
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
        let point = |value: f64, ms: f64| ScalingPoint { value, ms: summarize(&[ms]).unwrap(), bytes: 2_000_000 };
        let series = |quantity, points| Series { quantity, points };
        Scaling {
            size: [64, 36],
            threads: 2,
            rounds: 1,
            series: vec![
                series(ScalingQuantity::Triangles, vec![point(1000.0, 3.0), point(5000.0, 7.0)]),
                series(ScalingQuantity::Threads, vec![point(1.0, 8.0), point(2.0, 5.0)]),
            ],
            partial: false,
        }
    }

    #[test]
    fn fixed_and_growing_costs_are_described() {
        let scaling = scaling();
        assert_eq!(
            finding(&scaling.series[0]).unwrap(),
            "2.000 ms of fixed cost, and 1000 ns for each triangle. Both parts are equal at 2000; below, cost hardly \
             depends on the number."
        );
        assert_eq!(finding(&scaling.series[1]).unwrap(), "2 threads are 1.60 times as fast as one.");
        let alone = Series { points: scaling.series[1].points[..1].to_vec(), ..scaling.series[1].clone() };
        assert_eq!(finding(&alone), None, "one thread has nothing to be compared with");
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
    fn partial_results_are_marked_in_every_format() {
        let partial = Scaling { partial: true, ..scaling() };
        for form in [text, csv, page] {
            assert!(
                form(&partial).contains("artial: interrupted") && !form(&scaling()).contains("artial: interrupted")
            );
        }
    }

    #[test]
    fn threads_have_no_cost_per_thread() {
        let (text, csv) = (text(&scaling()), csv(&scaling()));
        let (triangles, threads) = text.split_once("Threads:").unwrap();
        assert!(triangles.contains("ns per unit") && !threads.contains("ns per unit"), "{text}");
        let cells: Vec<_> = csv.lines().map(|line| line.split(',').nth(6).unwrap()).collect();
        assert_eq!(cells, ["ns_each", "3000", "1400", "", ""]);
        assert!(csv.lines().all(|line| line.split(',').count() == 8), "{csv}");
    }

    #[test]
    fn cost_that_grows_faster_than_the_quantity_has_no_fixed_part_and_its_line_still_meets_both_ends() {
        let mut series = scaling().series.swap_remove(0);
        series.points[1].ms = summarize(&[23.0]).unwrap();
        assert_eq!(series.line().unwrap().fixed_ms, -2.0);
        let guide = guide(&series);
        assert!((guide[0].1 - 3.0).abs() < 1e-6 && (guide[60].1 - 23.0).abs() < 1e-6, "{guide:?}");
        assert_eq!(
            finding(&series).unwrap(),
            "Cost grows faster than the number of triangles: 5000 ns for each triangle beyond the first point."
        );
    }

    #[test]
    fn the_reference_is_the_line_through_the_ends_or_ideal_scaling() {
        let scaling = scaling();
        let of = |place: usize| guide(&scaling.series[place]);
        let near = |(value, ms): (f64, f64), (x, y): (f64, f64)| (value - x).abs() < 1e-6 && (ms - y).abs() < 1e-6;
        assert!(near(of(0)[0], (1000.0, 3.0)) && near(of(0)[60], (5000.0, 7.0)), "{:?}", of(0));
        assert!(near(of(1)[0], (1.0, 8.0)) && near(of(1)[60], (2.0, 4.0)), "{:?}", of(1));
        assert_eq!((ns_each_more(&scaling.series[0], 0), ns_each_more(&scaling.series[0], 1)), (None, Some(1000.0)));
    }

    #[test]
    fn large_numbers_are_written_readably() {
        assert_eq!(
            [0.5, 12.34, 999.6, 25_000.0, 3_210_000.0].map(short),
            ["0.50", "12.3", "1000", "25.0 thousand", "3.21 million"]
        );
        assert_eq!([64.0, 1e3, 2e4, 8_294_400.0].map(amount), ["64", "1 k", "20 k", "8.29 M"]);
        assert_eq!([12.0, 968.0, 8_294_400.0].map(grouped), ["12", "968", "8\u{2009}294\u{2009}400"]);
        assert_eq!([38.84, 64_800.0, 2e7].map(duration), ["38.8 ns", "64.8 µs", "20.0 ms"]);
    }
}
