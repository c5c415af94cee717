//! Scatter plots of error against time.

use std::fmt::Write as _;

use crate::pipeline::settings::{Arithmetic, Choice as _, Interpolation, Rasterizer};
use crate::report::html::escaped;
use crate::report::stability::column::ReportColumn;
use crate::report::stability::metric::short;
use crate::report::stability::sweep::StabilityReport;
use crate::report::stability::tradeoff::{self, TradeoffPoint};

/// Width of a plot in SVG units; [`HEIGHT`] is its height.
const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 440.0;

/// Left margin of the plot area for the axis, in SVG units. [`RIGHT`], [`TOP`] and [`BOTTOM`] are the other margins.
const LEFT: f64 = 62.0;
const RIGHT: f64 = 14.0;
const TOP: f64 = 12.0;
const BOTTOM: f64 = 46.0;

/// Height of the lane for errors of 0, in SVG units. The lane lies below the logarithmic axis, which cannot show 0.
const ZERO_LANE: f64 = 34.0;

/// Average width of a label character, in SVG units.
const LETTER: f64 = 5.7;

/// Line height of a label, in SVG units.
const LINE: f64 = 13.0;

/// Returns the HTML section with both plots, or an empty string if no times were measured.
pub(super) fn section(report: &StabilityReport) -> String {
    let coverage = panel(&tradeoff::coverage(report), false, "mean share of wrong pixels, corners as given");
    let weights = panel(&tradeoff::weights(report), true, "largest error of a weight");
    if coverage.is_empty() && weights.is_empty() {
        return String::new();
    }
    let figure = |svg: &str, caption: &str| match svg {
        "" => String::new(),
        svg => format!("<figure>{svg}<figcaption>{caption}</figcaption></figure>\n"),
    };
    format!(
        "<section>\n<h2>Error against time</h2>\n<p class=\"soft\">Down and to the left is better. The colour shows \
         the arithmetic, the shape the method; filled markers, joined by the dashed line, form the Pareto front. Bars \
         extend from the 10th to the 90th percentile.</p>\n{}<div class=\"panels\">\n{}{}</div>\n</section>\n",
        legend(),
        figure(&coverage, "Coverage: single triangles and meshes, each class with the same weight."),
        figure(&weights, "Weights: small markers are single classes, large ones the worst class."),
    )
}

/// Returns the colour index of a column, which depends on its arithmetic. Published methods have a separate colour.
fn color(column: ReportColumn) -> usize {
    let place = |arithmetic: Arithmetic| Arithmetic::ALL.iter().position(|a| *a == arithmetic).unwrap_or(0);
    match column {
        ReportColumn::Coverage(by) if by.rasterizer.is_published() => Arithmetic::ALL.len(),
        ReportColumn::Coverage(by) => place(by.arithmetic),
        ReportColumn::Weights(by) => place(by.arithmetic),
        ReportColumn::Depth(_) => 0,
    }
}

/// Returns the index of the marker shape of a column, which depends on its method.
fn shape(column: ReportColumn) -> usize {
    match column {
        ReportColumn::Coverage(by) => Rasterizer::ALL.iter().position(|r| *r == by.rasterizer).unwrap_or(0),
        ReportColumn::Weights(by) => Interpolation::ALL.iter().position(|i| *i == by.interpolation).unwrap_or(0),
        ReportColumn::Depth(_) => 0,
    }
}

fn legend() -> String {
    let colors = Arithmetic::ALL.iter().enumerate().map(|(index, arithmetic)| (index, arithmetic.name()));
    let colors = colors.chain([(Arithmetic::ALL.len(), "as published")]).map(|(index, name)| {
        format!("<span><svg viewBox=\"0 0 14 14\" style=\"width:14px;display:inline-block;vertical-align:-2px\"><circle cx=\"7\" \
                 cy=\"7\" r=\"5\" class=\"k{index}\"/></svg> {}</span>", escaped(name))
    });
    let shapes = Rasterizer::ALL.iter().enumerate().map(|(index, rasterizer)| {
        format!("<span><svg viewBox=\"0 0 16 16\" style=\"width:15px;display:inline-block;vertical-align:-3px\">{}</svg> {}</span>",
            Marker { shape: index, color: 4, radius: 5.0, style: "dominated" }.svg((8.0, 8.0)), escaped(rasterizer.name()))
    });
    format!(
        "<div class=\"legend\">{}</div><div class=\"legend\">{}</div>\n",
        colors.collect::<String>(),
        shapes.collect::<String>()
    )
}

/// Range of a logarithmic axis, in powers of ten.
#[derive(Clone, Copy, Debug)]
struct LogAxis {
    low: f64,
    high: f64,
}

impl LogAxis {
    /// Creates an axis that covers all positive, finite values, with a margin on both sides. Returns `None` if there
    /// are no such values.
    fn around(values: impl Iterator<Item = f64>) -> Option<Self> {
        /// Margin on each side, as a fraction of the range.
        const ROOM: f64 = 0.06;
        /// Range, in powers of ten, below which the margin no longer shrinks.
        const LEAST: f64 = 0.5;
        let powers = values.filter(|v| *v > 0.0 && v.is_finite()).map(f64::log10);
        let (low, high) = powers.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
        let room = (high - low).max(LEAST) * ROOM;
        low.is_finite().then_some(Self { low: low - room, high: high + room })
    }

    /// Returns the relative position of a value: 0 at the low end, 1 at the high end.
    fn share(self, value: f64) -> f64 {
        (value.log10() - self.low) / (self.high - self.low)
    }

    /// Returns the tick values: powers of ten and, on a short axis, 2 and 5 times these powers.
    fn ticks(self) -> Vec<f64> {
        /// Longest range of an axis, in powers of ten, at which 2 and 5 times each power also get ticks.
        const FEW: f64 = 2.0;
        let factors: &[f64] = if self.high - self.low > FEW { &[1.0] } else { &[1.0, 2.0, 5.0] };
        let step = ((self.high - self.low) / 10.0) as usize + 1;
        let powers = (self.low.floor() as i32..=self.high.ceil() as i32).step_by(step);
        let ticks = powers.flat_map(|power| factors.iter().map(move |factor| factor * 10.0_f64.powi(power)));
        ticks.filter(|tick| (0.0..=1.0).contains(&self.share(*tick))).collect()
    }
}

/// Mapping from values to positions in a plot.
struct ScatterPlot {
    ns: LogAxis,
    error: LogAxis,
}

impl ScatterPlot {
    fn x(&self, ns: f64) -> f64 {
        LEFT + self.ns.share(ns).clamp(0.0, 1.0) * (WIDTH - LEFT - RIGHT)
    }

    fn y(&self, error: f64) -> f64 {
        let floor = HEIGHT - BOTTOM - ZERO_LANE;
        if error > 0.0 {
            floor - self.error.share(error).clamp(0.0, 1.0) * (floor - TOP)
        } else {
            floor + ZERO_LANE / 2.0
        }
    }
}

/// Returns one plot as SVG, or an empty string if there are no points.
fn panel(points: &[TradeoffPoint], with_classes: bool, y_axis: &str) -> String {
    let times = points.iter().flat_map(|p| [p.ns.p10, p.ns.p90, p.ns.median]);
    let class_times = points.iter().filter(|_| with_classes).flat_map(|p| p.by_class.iter().map(|(_, ns, _)| *ns));
    let errors = points.iter().map(|p| p.error);
    let class_errors = points.iter().filter(|_| with_classes).flat_map(|p| p.by_class.iter().map(|(_, _, e)| *e));
    let Some(ns) = LogAxis::around(times.chain(class_times)) else { return String::new() };
    let error = LogAxis::around(errors.chain(class_errors)).unwrap_or(LogAxis { low: -6.0, high: 0.0 });
    let plot = ScatterPlot { ns, error };
    let mut svg = axes(&plot, y_axis);
    svg.push_str(&front(&plot, points));
    if with_classes {
        for point in points {
            for (class, ns, error) in &point.by_class {
                let title = format!("{class}: {} at {} ns", short(*error), short(*ns));
                let small = Marker::of(point, 3.0, "small").svg((plot.x(*ns), plot.y(*error)));
                let _ = write!(svg, "<g><title>{}</title>{small}</g>", escaped(&title));
            }
        }
    }
    points.iter().for_each(|point| svg.push_str(&drawn(&plot, point)));
    svg.push_str(&labels(&plot, points));
    format!("<svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"Error against time\">{svg}</svg>")
}

fn axes(plot: &ScatterPlot, y_axis: &str) -> String {
    let (floor, right) = (HEIGHT - BOTTOM, WIDTH - RIGHT);
    let mut svg = format!(
        "<rect class=\"lane\" x=\"{LEFT}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{ZERO_LANE}\"/>",
        floor - ZERO_LANE,
        right - LEFT
    );
    for ns in plot.ns.ticks() {
        let (x, text) = (plot.x(ns), tick(ns));
        let _ = write!(
            svg,
            "<line class=\"grid\" x1=\"{x:.1}\" x2=\"{x:.1}\" y1=\"{TOP}\" y2=\"{floor}\"/><text class=\"tick\" x=\"{x:.1}\" \
             y=\"{:.1}\" text-anchor=\"middle\">{text} ns</text>",
            floor + 16.0
        );
    }
    for error in plot.error.ticks() {
        let (y, text) = (plot.y(error), tick(error));
        let _ = write!(
            svg,
            "<line class=\"grid\" x1=\"{LEFT}\" x2=\"{right}\" y1=\"{y:.1}\" y2=\"{y:.1}\"/><text class=\"tick\" x=\"{:.1}\" \
             y=\"{:.1}\" text-anchor=\"end\">{text}</text>",
            LEFT - 6.0,
            y + 4.0
        );
    }
    let zero = plot.y(0.0) + 4.0;
    let _ = write!(svg, "<text class=\"tick\" x=\"{:.1}\" y=\"{zero:.1}\" text-anchor=\"end\">0</text>", LEFT - 6.0);
    let _ = write!(
        svg,
        "<rect class=\"frame\" x=\"{LEFT}\" y=\"{TOP}\" width=\"{:.1}\" height=\"{:.1}\"/>",
        right - LEFT,
        floor - TOP
    );
    let (middle_x, middle_y) = ((LEFT + right) / 2.0, (TOP + floor) / 2.0);
    let _ = write!(
        svg,
        "<text class=\"axis\" x=\"{middle_x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">time per pixel</text>",
        HEIGHT - 10.0
    );
    let _ = write!(
        svg,
        "<text class=\"axis\" transform=\"translate(14 {middle_y:.1}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
        escaped(y_axis)
    );
    svg
}

/// Formats a tick value, which is 1, 2 or 5 times a power of ten: as a decimal if that is short, otherwise with a
/// superscript exponent.
fn tick(value: f64) -> String {
    const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    if (0.009..10_000.0).contains(&value) {
        // A tick value in this range has at most two decimals, so this only removes rounding errors.
        return ((value * 100.0).round() / 100.0).to_string();
    }
    let power = (value.log10() + 1e-9).floor() as i32;
    let factor = (value / 10.0_f64.powi(power)).round();
    let digits = power.unsigned_abs().to_string();
    let raised: String = digits.bytes().map(|digit| RAISED[usize::from(digit - b'0')]).collect();
    let sign = if power < 0 { "⁻" } else { "" };
    if factor == 1.0 { format!("10{sign}{raised}") } else { format!("{factor}·10{sign}{raised}") }
}

/// Returns the Pareto front as an SVG step line.
fn front(plot: &ScatterPlot, points: &[TradeoffPoint]) -> String {
    let mut best: Vec<&TradeoffPoint> = points.iter().filter(|point| point.optimal).collect();
    best.sort_by(|a, b| a.ns.median.total_cmp(&b.ns.median));
    let mut path = String::new();
    let mut last_y = None;
    for point in best {
        let (x, y) = (plot.x(point.ns.median), plot.y(point.error));
        match last_y {
            None => {
                let _ = write!(path, "M{x:.1} {y:.1}");
            }
            Some(before) => {
                let _ = write!(path, "L{x:.1} {before:.1}L{x:.1} {y:.1}");
            }
        }
        last_y = Some(y);
    }
    if path.is_empty() { path } else { format!("<path class=\"front\" d=\"{path}\"/>") }
}

/// Returns the SVG marker of a point, with a bar from the 10th to the 90th percentile of its time.
fn drawn(plot: &ScatterPlot, point: &TradeoffPoint) -> String {
    let (x, y, color) = (plot.x(point.ns.median), plot.y(point.error), color(point.column));
    let style = if point.optimal { "" } else { "dominated" };
    let broken = if point.not_finite > 0.0 {
        format!(", {:.0} answers are NaN or infinite", point.not_finite)
    } else {
        String::new()
    };
    let title = format!("{}: {} at {} ns{broken}", point.column.label(), short(point.error), short(point.ns.median));
    format!(
        "<g><title>{}</title><line class=\"bar k{color}\" x1=\"{:.1}\" x2=\"{:.1}\" y1=\"{y:.1}\" y2=\"{y:.1}\"/>{}</g>",
        escaped(&title),
        plot.x(point.ns.p10),
        plot.x(point.ns.p90),
        Marker::of(point, 5.0, style).svg((x, y))
    )
}

/// Marker of a point.
struct Marker<'a> {
    /// Number of the shape. The first seven differ most.
    shape: usize,
    /// Index of the colour: the CSS classes are `k0` to `k4`.
    color: usize,
    /// Radius in SVG units.
    radius: f64,
    /// Other class of its style.
    style: &'a str,
}

impl<'a> Marker<'a> {
    /// Returns the marker of a point, in the shape and colour of its column.
    fn of(point: &TradeoffPoint, radius: f64, style: &'a str) -> Self {
        Self { shape: shape(point.column), color: color(point.column), radius, style }
    }

    /// Returns the SVG of the marker at a position in SVG units.
    fn svg(&self, (x, y): (f64, f64)) -> String {
        let Self { shape, color, radius: r, style } = *self;
        let class = format!("class=\"mark k{color} {style}\"");
        let polygon = |corners: &[(f64, f64)]| {
            let points: Vec<String> =
                corners.iter().map(|(dx, dy)| format!("{:.1},{:.1}", x + dx * r, y + dy * r)).collect();
            format!("<polygon {class} points=\"{}\"/>", points.join(" "))
        };
        match shape {
            0 => polygon(&[(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)]),
            1 => format!("<circle {class} cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{r}\"/>"),
            2 => polygon(&[(0.0, -1.1), (1.0, 0.8), (-1.0, 0.8)]),
            3 => polygon(&[(0.0, 1.1), (1.0, -0.8), (-1.0, -0.8)]),
            4 => polygon(&[(0.0, -1.2), (1.2, 0.0), (0.0, 1.2), (-1.2, 0.0)]),
            5 => polygon(&[
                (-1.0, -1.0),
                (0.0, -0.4),
                (1.0, -1.0),
                (0.4, 0.0),
                (1.0, 1.0),
                (0.0, 0.4),
                (-1.0, 1.0),
                (-0.4, 0.0),
            ]),
            6 => polygon(&[(0.0, -1.2), (1.1, -0.3), (0.7, 1.0), (-0.7, 1.0), (-1.1, -0.3)]),
            _ => {
                let sides = shape - 1;
                let corner = |corner: usize| (std::f64::consts::TAU * corner as f64 / sides as f64).sin_cos();
                polygon(&(0..sides).map(corner).map(|(sin, cos)| (1.2 * sin, -1.2 * cos)).collect::<Vec<_>>())
            }
        }
    }
}

/// Rectangle in SVG units: left, top, right, bottom.
type Rectangle = [f64; 4];

/// Returns the labels of the points, beside their markers. A label is omitted if, at every candidate position, it would
/// overlap a marker, a bar or another label, or leave the plot.
fn labels(plot: &ScatterPlot, points: &[TradeoffPoint]) -> String {
    let around = |x: f64, y: f64, r: f64| [x - r, y - r, x + r, y + r];
    let mut taken: Vec<Rectangle> = points.iter().map(|p| around(plot.x(p.ns.median), plot.y(p.error), 6.0)).collect();
    let bar = |p: &TradeoffPoint| [plot.x(p.ns.p10), plot.y(p.error) - 1.0, plot.x(p.ns.p90), plot.y(p.error) + 1.0];
    taken.extend(points.iter().map(bar));
    // Place the labels of the Pareto front first, because they matter most.
    let mut order: Vec<&TradeoffPoint> = points.iter().collect();
    order.sort_by_key(|point| !point.optimal);
    let mut svg = String::new();
    for point in order {
        let text = name(point.column);
        let (x, y) = (plot.x(point.ns.median), plot.y(point.error));
        let width = text.chars().count() as f64 * LETTER;
        // Candidate positions: right, left, above, below, then the diagonals.
        let sides = [(9.0, 4.0), (-9.0 - width, 4.0), (-width / 2.0, -10.0), (-width / 2.0, 18.0)];
        let corners = [(8.0, -8.0), (8.0, 16.0), (-8.0 - width, -8.0), (-8.0 - width, 16.0)];
        let places = sides.into_iter().chain(corners);
        let place = places.map(|(dx, dy)| [x + dx, y + dy - LINE + 3.0, x + dx + width, y + dy + 3.0]);
        let mut free = place.filter(|r| r[0] > LEFT && r[2] < WIDTH - RIGHT && r[1] > TOP && r[3] < HEIGHT - BOTTOM);
        let Some(place) = free.find(|place| !taken.iter().any(|other| overlap(place, other))) else { continue };
        taken.push(place);
        let _ = write!(
            svg,
            "<text class=\"label\" x=\"{:.1}\" y=\"{:.1}\">{}</text>",
            place[0],
            place[3] - 3.0,
            escaped(&text)
        );
    }
    svg
}

fn overlap(a: &Rectangle, b: &Rectangle) -> bool {
    a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3]
}

/// Returns a short label of a column: the method alone if it is a published one, otherwise the method and the
/// arithmetic.
fn name(column: ReportColumn) -> String {
    if column.is_published() { column.method().to_owned() } else { column.label() }
}
