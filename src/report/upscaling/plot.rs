//! The report's drawings: error against time, and time against the share of pixels that are drawn.

use std::fmt::Write as _;

use super::page::escaped;
use super::skipping::{Share, Split};
use super::sweep::{Row, SceneReport};
use crate::upscale;

/// Size of a drawing.
const WIDTH: f64 = 720.0;
const HEIGHT: f64 = 430.0;

/// Room around the plot for axes.
const LEFT: f64 = 62.0;
const RIGHT: f64 = 16.0;
const TOP: f64 = 12.0;
const BOTTOM: f64 = 46.0;

/// Height of the lane below the logarithmic axis where errors of 0 stand.
const ZERO_LANE: f64 = 34.0;

/// Width of a letter of a label, on average.
const LETTER: f64 = 5.9;

/// Height of a label.
const LINE: f64 = 13.0;

/// Radius of a mark.
const MARK: f64 = 4.5;

/// An axis in the unit of its values or of their logarithms.
#[derive(Clone, Copy, Debug)]
struct Axis {
    low: f64,
    high: f64,
    is_log: bool,
}

impl Axis {
    /// A logarithmic one around all values above 0, with some room on both sides.
    fn log(values: impl Iterator<Item = f64>) -> Option<Self> {
        /// Share of the axis that stays free on either side.
        const ROOM: f64 = 0.07;
        /// Powers of ten at least.
        const LEAST: f64 = 0.3;
        let powers = values.filter(|v| *v > 0.0 && v.is_finite()).map(f64::log10);
        let (low, high) = powers.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
        let room = (high - low).max(LEAST) * ROOM;
        low.is_finite().then_some(Self { low: low - room, high: high + room, is_log: true })
    }

    /// A linear one from 0 to a little more than the greatest value.
    fn from_zero(values: impl Iterator<Item = f64>) -> Self {
        let high = values.filter(|v| v.is_finite()).fold(0.0, f64::max);
        Self { low: 0.0, high: if high > 0.0 { high * 1.06 } else { 1.0 }, is_log: false }
    }

    /// 0 at the low end, 1 at the high one.
    fn share(self, value: f64) -> f64 {
        let value = if self.is_log { value.log10() } else { value };
        (value - self.low) / (self.high - self.low)
    }

    /// Values for lines across the drawing: 1, 2 or 5 times a power of ten.
    fn ticks(self) -> Vec<f64> {
        let ticks: Vec<f64> = if self.is_log {
            let powers = self.low.floor() as i32..=self.high.ceil() as i32;
            powers.flat_map(|power| [1.0, 2.0, 5.0].map(|factor| factor * 10.0_f64.powi(power))).collect()
        } else {
            let rough = self.high / 5.0;
            let power = 10.0_f64.powf(rough.log10().floor());
            let step = [1.0, 2.0, 5.0, 10.0].map(|f| f * power).into_iter().find(|s| *s >= rough).unwrap_or(rough);
            (0..=10).map(|i| f64::from(i) * step).collect()
        };
        ticks.into_iter().filter(|tick| (0.0..=1.0).contains(&self.share(*tick))).collect()
    }
}

/// Where things stand in a drawing.
struct Plot {
    x: Axis,
    y: Axis,
    /// Height at the bottom that the vertical axis leaves free.
    lane: f64,
}

impl Plot {
    fn x(&self, value: f64) -> f64 {
        LEFT + self.x.share(value).clamp(0.0, 1.0) * (WIDTH - LEFT - RIGHT)
    }

    fn y(&self, value: f64) -> f64 {
        let floor = HEIGHT - BOTTOM - self.lane;
        if self.y.is_log && value <= 0.0 {
            floor + self.lane / 2.0
        } else {
            floor - self.y.share(value).clamp(0.0, 1.0) * (floor - TOP)
        }
    }

    fn axes(&self, x_name: &str, y_name: &str, x_tick: fn(f64) -> String) -> String {
        let (floor, right) = (HEIGHT - BOTTOM, WIDTH - RIGHT);
        let mut svg = String::new();
        if self.lane > 0.0 {
            let _ = write!(
                svg,
                "<rect class=\"lane\" x=\"{LEFT}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{}\"/><text class=\"tick\" x=\"{:.1}\" \
                 y=\"{:.1}\" text-anchor=\"end\">0</text>",
                floor - self.lane,
                right - LEFT,
                self.lane,
                LEFT - 6.0,
                self.y(0.0) + 4.0
            );
        }
        for value in self.x.ticks() {
            let (x, text) = (self.x(value), x_tick(value));
            let _ = write!(
                svg,
                "<line class=\"grid\" x1=\"{x:.1}\" x2=\"{x:.1}\" y1=\"{TOP}\" y2=\"{floor}\"/><text class=\"tick\" \
                 x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{text}</text>",
                floor + 16.0
            );
        }
        for value in self.y.ticks() {
            let (y, text) = (self.y(value), tick(value));
            let _ = write!(
                svg,
                "<line class=\"grid\" x1=\"{LEFT}\" x2=\"{right}\" y1=\"{y:.1}\" y2=\"{y:.1}\"/><text class=\"tick\" \
                 x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{text}</text>",
                LEFT - 6.0,
                y + 4.0
            );
        }
        let (middle_x, middle_y) = ((LEFT + right) / 2.0, (TOP + floor) / 2.0);
        let _ = write!(
            svg,
            "<rect class=\"frame\" x=\"{LEFT}\" y=\"{TOP}\" width=\"{:.1}\" height=\"{:.1}\"/><text class=\"axis\" \
             x=\"{middle_x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text><text class=\"axis\" \
             transform=\"translate(14 {middle_y:.1}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            right - LEFT,
            floor - TOP,
            HEIGHT - 10.0,
            escaped(x_name),
            escaped(y_name)
        );
        svg
    }
}

/// Rounded to no more digits than it has.
fn tick(value: f64) -> String {
    if value >= 0.001 || value == 0.0 { ((value * 1e4).round() / 1e4).to_string() } else { format!("{value:.0e}") }
}

fn svg(label: &str, content: &str) -> String {
    format!("<svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{label}\">{content}</svg>")
}

/// Number of the colour of a row's method.
pub(super) fn color(row: &Row) -> usize {
    let method = row.recipe.upscaler.method();
    upscale::ALL.iter().position(|upscaler| upscaler.id() == method).unwrap_or(0)
}

/// Error against time; nothing without rows.
pub(super) fn tradeoff(scene: &SceneReport) -> String {
    let times = scene.rows.iter().flat_map(|row| [row.frame_ms.p10, row.frame_ms.median, row.frame_ms.p90]);
    let Some(x) = Axis::log(times) else { return String::new() };
    let y = Axis::log(scene.rows.iter().map(|row| row.error.flip));
    let y = y.unwrap_or(Axis { low: -3.0, high: 0.0, is_log: true });
    let plot = Plot { x, y, lane: ZERO_LANE };
    let y_name = "error: mean of FLIP";
    let mut content = plot.axes("median time of a frame, ms", y_name, tick);
    for rows in scene.rows.chunk_by(|a, b| a.recipe.upscaler.method() == b.recipe.upscaler.method()) {
        let points: Vec<String> =
            rows.iter().map(|row| place(&plot, row)).map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
        let _ = write!(content, "<polyline class=\"family m{}\" points=\"{}\"/>", color(&rows[0]), points.join(" "));
    }
    content += &front(&plot, &scene.rows);
    scene.rows.iter().for_each(|row| content += &drawn(&plot, row));
    content += &labels(&plot, &scene.rows);
    svg("Error against time", &content)
}

fn place(plot: &Plot, row: &Row) -> (f64, f64) {
    (plot.x(row.frame_ms.median), plot.y(row.error.flip))
}

/// The staircase through the points that nobody beats.
fn front(plot: &Plot, rows: &[Row]) -> String {
    let mut best: Vec<&Row> = rows.iter().filter(|row| row.dominated_by.is_none()).collect();
    best.sort_by(|a, b| a.frame_ms.median.total_cmp(&b.frame_ms.median));
    let mut path = String::new();
    let mut last = None;
    for row in best {
        let (x, y) = place(plot, row);
        let _ = match last {
            None => write!(path, "M{x:.1} {y:.1}"),
            Some(before) => write!(path, "L{x:.1} {before:.1}L{x:.1} {y:.1}"),
        };
        last = Some(y);
    }
    if path.is_empty() { path } else { format!("<path class=\"front\" d=\"{path}\"/>") }
}

/// A point with its bar from the 10th to the 90th percentile.
fn drawn(plot: &Plot, row: &Row) -> String {
    let ((x, y), color) = (place(plot, row), color(row));
    let style = if row.dominated_by.is_some() { "beaten" } else { "" };
    let by = row.dominated_by.as_ref().map(|by| format!(", beaten by {by}")).unwrap_or_default();
    let title = format!("{}: {:.2} ms, FLIP {:.4}{by}", row.label, row.frame_ms.median, row.error.flip);
    format!(
        "<g class=\"{style}\"><title>{}</title><line class=\"bar m{color}\" x1=\"{:.1}\" x2=\"{:.1}\" y1=\"{y:.1}\" \
         y2=\"{y:.1}\"/><circle class=\"mark m{color}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{MARK}\"/></g>",
        escaped(&title),
        plot.x(row.frame_ms.p10),
        plot.x(row.frame_ms.p90)
    )
}

/// Names beside marks, as far as there is room; those that nobody beats first.
fn labels(plot: &Plot, rows: &[Row]) -> String {
    let mut taken: Vec<[f64; 4]> = Vec::new();
    for row in rows {
        let (x, y) = place(plot, row);
        taken.push([x - 6.0, y - 6.0, x + 6.0, y + 6.0]);
    }
    let mut order: Vec<&Row> = rows.iter().collect();
    order.sort_by_key(|row| row.dominated_by.is_some());
    let mut svg = String::new();
    for row in order {
        let (x, y) = place(plot, row);
        let width = row.label.chars().count() as f64 * LETTER;
        let offsets = [(9.0, 4.0), (-9.0 - width, 4.0), (-width / 2.0, -10.0), (-width / 2.0, 18.0)];
        let boxes = offsets.map(|(dx, dy)| [x + dx, y + dy - LINE + 3.0, x + dx + width, y + dy + 3.0]);
        let is_free = |place: &&[f64; 4]| {
            let inside = place[0] > LEFT && place[2] < WIDTH - RIGHT && place[1] > TOP && place[3] < HEIGHT - BOTTOM;
            let meets = |o: &[f64; 4]| place[0] < o[2] && o[0] < place[2] && place[1] < o[3] && o[1] < place[3];
            inside && !taken.iter().any(meets)
        };
        let Some(place) = boxes.iter().find(is_free).copied() else { continue };
        taken.push(place);
        let _ = write!(
            svg,
            "<text class=\"label\" x=\"{:.1}\" y=\"{:.1}\">{}</text>",
            place[0],
            place[3] - 3.0,
            escaped(&row.label)
        );
    }
    svg
}

/// A way to draw fewer pixels: the class of its marks, and its times.
type Way = (&'static str, fn(&Share) -> Split);

/// Time against the share of pixels that are drawn, for both ways, split into raster and shade.
pub(super) fn shares(shares: &[Share]) -> String {
    let x = Axis { low: 0.0, high: 1.04, is_log: false };
    let y = Axis::from_zero(shares.iter().flat_map(|share| [share.skipping.whole.p90, share.visiting.whole.p90]));
    let plot = Plot { x, y, lane: 0.0 };
    let percent = |value: f64| format!("{:.0} %", value * 100.0);
    let mut content = plot.axes("share of the pixels that are drawn", "median time of a frame, ms", percent);
    let ways: [Way; 2] = [("skip", |share| share.skipping), ("visit", |share| share.visiting)];
    for (class, of) in ways {
        let line = |value: fn(Split) -> f64| {
            let points = shares.iter().map(|share| (plot.x(share.drawn), plot.y(value(of(share)))));
            points.map(|(x, y)| format!("{x:.1},{y:.1}")).collect::<Vec<_>>()
        };
        let (whole, raster) = (line(|split| split.whole.median), line(|split| split.raster.median));
        let area: Vec<_> = whole.iter().chain(raster.iter().rev()).cloned().collect();
        let _ = write!(
            content,
            "<polygon class=\"area {class}\" points=\"{}\"/><polyline class=\"way {class}\" points=\"{}\"/><polyline \
             class=\"way raster {class}\" points=\"{}\"/>",
            area.join(" "),
            whole.join(" "),
            raster.join(" ")
        );
        for share in shares {
            let split = of(share);
            let (x, y) = (plot.x(share.drawn), plot.y(split.whole.median));
            let title = format!(
                "{:.1} % of the pixels: {:.2} ms, of these raster {:.2} and shade {:.2}",
                share.drawn * 100.0,
                split.whole.median,
                split.raster.median,
                split.shade_ms()
            );
            let _ = write!(
                content,
                "<g><title>{}</title><circle class=\"mark {class}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{MARK}\"/></g>",
                escaped(&title)
            );
        }
    }
    svg("Time against the share of pixels drawn", &content)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_hold_their_values_and_ticks() {
        let log = Axis::log([0.02, 3.0, 0.0].into_iter()).unwrap();
        assert!(log.share(0.02) > 0.0 && log.share(3.0) < 1.0);
        let ticks = log.ticks();
        assert!(ticks.contains(&1.0) && ticks.iter().all(|tick| (0.0..=1.0).contains(&log.share(*tick))), "{ticks:?}");
        assert!(Axis::log([0.0].into_iter()).is_none());
        let linear = Axis::from_zero([4.0, 9.0].into_iter());
        assert_eq!(linear.ticks()[..3], [0.0, 2.0, 4.0]);
    }

    #[test]
    fn ticks_are_written_without_false_digits() {
        assert_eq!([0.1 + 0.2, 0.05, 20.0, 0.0].map(tick), ["0.3", "0.05", "20", "0"]);
    }
}
