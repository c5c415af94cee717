//! Plots of the upscaling report: error against time, and time against the fraction of pixels drawn.

use std::fmt::Write as _;

use super::skipping::{PixelShareTimes, Split};
use super::sweep::{SceneReport, UpscalingRow};
use crate::measure::metric::Metric;
use crate::measure::noise::WITHIN;
use crate::measure::timing::Summary;
use crate::pipeline::settings::Choice as _;
use crate::report::html::escaped;
use crate::report::plot::{
    BOTTOM, HEIGHT, LEFT, LETTER, LINE, MARK, Plot, PlotAxis, RIGHT, TOP, WIDTH, ZERO_LANE, svg, tick,
};
use crate::upscale::Upscaling;

/// Angle between the hues of consecutive methods, in degrees: the golden angle, which keeps the hues of any number of
/// methods apart and those of neighbours far apart.
const HUE_STEP_DEGREES: f32 = 137.508;

/// Hue of the first method after native rendering, in degrees.
const FIRST_HUE_DEGREES: f32 = 60.0;

/// Returns the hue in Oklab of an upscaler's colour in pages and in the window, in degrees. Native rendering has no hue.
pub fn hue_degrees(upscaling: Upscaling) -> Option<f32> {
    let method = upscaling.place().checked_sub(1)?;
    Some(FIRST_HUE_DEGREES + HUE_STEP_DEGREES * method as f32)
}

/// Returns the colour of a row's method as a style attribute.
pub(super) fn color(row: &UpscalingRow) -> String {
    let color = match hue_degrees(row.recipe.upscaler) {
        None => "var(--native)".to_owned(),
        Some(degrees) => format!("oklch(var(--method) {degrees:.1})"),
    };
    format!("style=\"color: {color}\"")
}

/// Returns an SVG plot of error by a metric against time, or an empty string if there are no rows.
pub(super) fn tradeoff(scene: &SceneReport, metric: Metric) -> String {
    let times = scene.rows.iter().flat_map(|row| {
        let Summary { p10, median, p90, .. } = row.frame_ms;
        [p10, median, p90].map(|ms| ms * row.scale)
    });
    let Some(x) = PlotAxis::log(times) else { return String::new() };
    let y = PlotAxis::log(scene.rows.iter().map(|row| row.error_in_motion(metric)));
    let y = y.unwrap_or(PlotAxis { low: -3.0, high: 0.0, is_log: true });
    let plot = ErrorPlot { plot: Plot { x, y, lane: ZERO_LANE }, metric };
    let y_name = format!("error in motion: mean {}", metric.error_name());
    let mut content = plot.plot.axes("median time of a frame, ms", &y_name, tick);
    for rows in scene.rows.chunk_by(|a, b| a.recipe.upscaler.method() == b.recipe.upscaler.method()) {
        let points: Vec<String> =
            rows.iter().map(|row| plot.place(row)).map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
        let _ = write!(content, "<polyline class=\"family\" {} points=\"{}\"/>", color(&rows[0]), points.join(" "));
    }
    content += &plot.front(&scene.rows);
    scene.rows.iter().for_each(|row| content += &plot.drawn(row));
    content += &plot.labels(&scene.rows);
    svg("Error against time", &content)
}

/// Plot of error by a metric against time.
struct ErrorPlot {
    plot: Plot,
    metric: Metric,
}

impl ErrorPlot {
    /// Returns the position of a row's marker, in units of the plot.
    fn place(&self, row: &UpscalingRow) -> (f64, f64) {
        (self.plot.x(row.comparable_ms()), self.plot.y(row.error_in_motion(self.metric)))
    }

    /// Returns the Pareto front as an SVG step line.
    fn front(&self, rows: &[UpscalingRow]) -> String {
        let mut best: Vec<&UpscalingRow> = rows.iter().filter(|row| row.is_on_front()).collect();
        best.sort_by(|a, b| a.comparable_ms().total_cmp(&b.comparable_ms()));
        let mut path = String::new();
        let mut last = None;
        for row in best {
            let (x, y) = self.place(row);
            let _ = match last {
                None => write!(path, "M{x:.1} {y:.1}"),
                Some(before) => write!(path, "L{x:.1} {before:.1}L{x:.1} {y:.1}"),
            };
            last = Some(y);
        }
        if path.is_empty() { path } else { format!("<path class=\"front\" d=\"{path}\"/>") }
    }

    /// Returns the SVG marker of a row, with a bar from the 10th to the 90th percentile of its time.
    fn drawn(&self, row: &UpscalingRow) -> String {
        let ((x, y), color) = (self.place(row), color(row));
        let style = if row.is_on_front() { "" } else { "beaten" };
        let by = match (&row.dominated_by, &row.within_noise_of) {
            (Some(by), _) => format!(", dominated by {by}"),
            (None, Some(of)) => format!(", {WITHIN} of {of}"),
            (None, None) => String::new(),
        };
        let (metric, value) = (self.metric.name(), self.metric.format(row.motion.mean.value(self.metric)));
        let title = format!("{}: {:.2} ms, {metric} in motion {value}{by}", row.label, row.frame_ms.median);
        format!(
            "<g class=\"{style}\"><title>{}</title><line class=\"bar\" {color} x1=\"{:.1}\" x2=\"{:.1}\" y1=\"{y:.1}\" \
             y2=\"{y:.1}\"/><circle class=\"mark\" {color} cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{MARK}\"/></g>",
            escaped(&title),
            self.plot.x(row.frame_ms.p10 * row.scale),
            self.plot.x(row.frame_ms.p90 * row.scale)
        )
    }

    /// Returns the labels that fit beside their markers. Labels of points on the Pareto front are placed first.
    fn labels(&self, rows: &[UpscalingRow]) -> String {
        let mut taken: Vec<[f64; 4]> = Vec::new();
        for row in rows {
            let (x, y) = self.place(row);
            taken.push([x - 6.0, y - 6.0, x + 6.0, y + 6.0]);
        }
        let mut order: Vec<&UpscalingRow> = rows.iter().collect();
        order.sort_by_key(|row| !row.is_on_front());
        let mut svg = String::new();
        for row in order {
            let (x, y) = self.place(row);
            let width = row.label.chars().count() as f64 * LETTER;
            let offsets = [(9.0, 4.0), (-9.0 - width, 4.0), (-width / 2.0, -10.0), (-width / 2.0, 18.0)];
            let boxes = offsets.map(|(dx, dy)| [x + dx, y + dy - LINE + 3.0, x + dx + width, y + dy + 3.0]);
            let is_free = |place: &&[f64; 4]| {
                let inside =
                    place[0] > LEFT && place[2] < WIDTH - RIGHT && place[1] > TOP && place[3] < HEIGHT - BOTTOM;
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
}

/// One of two compared ways to draw fewer pixels: its CSS class, and a function that returns its times.
type SkippingVariant = (&'static str, fn(&PixelShareTimes) -> Split);

/// Returns an SVG plot of time against the fraction of pixels drawn, split into rasterization and shading. It compares
/// skipping pixels inside the loop with visiting only the wanted ones.
pub(super) fn shares(shares: &[PixelShareTimes]) -> String {
    let x = PlotAxis { low: 0.0, high: 1.04, is_log: false };
    let y = PlotAxis::from_zero(shares.iter().flat_map(|share| [share.skipping.whole.p90, share.visiting.whole.p90]));
    let plot = Plot { x, y, lane: 0.0 };
    let percent = |value: f64| format!("{:.0} %", value * 100.0);
    let mut content = plot.axes("share of pixels drawn", "median time of a frame, ms", percent);
    let ways: [SkippingVariant; 2] = [("skip", |share| share.skipping), ("visit", |share| share.visiting)];
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
                "{:.1} % of the pixels: {:.2} ms, of which rasterization {:.2} and shading {:.2}",
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
