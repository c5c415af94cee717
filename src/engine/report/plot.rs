//! SVG plots for reports: axes with ticks, linear or logarithmic.

use std::fmt::Write as _;

use super::html::escaped;

/// Width of a plot in SVG units; [`HEIGHT`] is its height.
pub(super) const WIDTH: f64 = 720.0;
pub(super) const HEIGHT: f64 = 430.0;

/// Left margin of the plot area for the axis, in SVG units. [`RIGHT`], [`TOP`] and [`BOTTOM`] are the other margins.
pub(super) const LEFT: f64 = 62.0;
pub(super) const RIGHT: f64 = 16.0;
pub(super) const TOP: f64 = 12.0;
pub(super) const BOTTOM: f64 = 46.0;

/// Height of the lane below a logarithmic axis in which errors of 0 are drawn, in SVG units.
pub(super) const ZERO_LANE: f64 = 34.0;

/// Average width of a label character, in SVG units.
pub(super) const LETTER: f64 = 5.9;

/// Line height of a label, in SVG units.
pub(super) const LINE: f64 = 13.0;

/// Radius of a marker, in SVG units.
pub(super) const MARK: f64 = 4.5;

/// Range of an axis. `low` and `high` are values or, on a logarithmic axis, their decimal logarithms.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlotAxis {
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) is_log: bool,
}

impl PlotAxis {
    /// Creates a logarithmic axis that spans all finite positive values, with some margin at both ends. Returns `None`
    /// if there is no such value.
    pub(super) fn log(values: impl Iterator<Item = f64>) -> Option<Self> {
        /// Margin on each side, as a fraction of the range.
        const ROOM: f64 = 0.07;
        /// Range, in powers of ten, from which the margin is computed if the values span a smaller range.
        const LEAST: f64 = 0.3;
        let powers = values.filter(|v| *v > 0.0 && v.is_finite()).map(f64::log10);
        let (low, high) = powers.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
        let room = (high - low).max(LEAST) * ROOM;
        low.is_finite().then_some(Self { low: low - room, high: high + room, is_log: true })
    }

    /// Creates a linear axis from 0 to slightly above the largest value.
    pub(super) fn from_zero(values: impl Iterator<Item = f64>) -> Self {
        let high = values.filter(|v| v.is_finite()).fold(0.0, f64::max);
        Self { low: 0.0, high: if high > 0.0 { high * 1.06 } else { 1.0 }, is_log: false }
    }

    /// Returns the relative position of a value on the axis: 0 at the low end, 1 at the high end.
    fn share(self, value: f64) -> f64 {
        let value = if self.is_log { value.log10() } else { value };
        (value - self.low) / (self.high - self.low)
    }

    /// Returns the tick values: 1, 2 or 5 times a power of ten on a logarithmic axis, multiples of such a step on a
    /// linear one.
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

/// Mapping from values to positions in a plot.
pub(super) struct Plot {
    pub(super) x: PlotAxis,
    pub(super) y: PlotAxis,
    /// Height of the lane at the bottom of the plot area, below the vertical axis, in SVG units; 0 without a lane.
    pub(super) lane: f64,
}

impl Plot {
    pub(super) fn x(&self, value: f64) -> f64 {
        LEFT + self.x.share(value).clamp(0.0, 1.0) * (WIDTH - LEFT - RIGHT)
    }

    pub(super) fn y(&self, value: f64) -> f64 {
        let floor = HEIGHT - BOTTOM - self.lane;
        if self.y.is_log && value <= 0.0 {
            floor + self.lane / 2.0
        } else {
            floor - self.y.share(value).clamp(0.0, 1.0) * (floor - TOP)
        }
    }

    pub(super) fn axes(&self, x_name: &str, y_name: &str, x_tick: fn(f64) -> String) -> String {
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

/// Formats a tick value, rounded to four decimals, or in scientific notation if it is below 0.001.
pub(super) fn tick(value: f64) -> String {
    if value >= 0.001 || value == 0.0 { ((value * 1e4).round() / 1e4).to_string() } else { format!("{value:.0e}") }
}

pub(super) fn svg(label: &str, content: &str) -> String {
    format!("<svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{label}\">{content}</svg>")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_hold_their_values_and_ticks() {
        let log = PlotAxis::log([0.02, 3.0, 0.0].into_iter()).unwrap();
        assert!(log.share(0.02) > 0.0 && log.share(3.0) < 1.0);
        let ticks = log.ticks();
        assert!(ticks.contains(&1.0) && ticks.iter().all(|tick| (0.0..=1.0).contains(&log.share(*tick))), "{ticks:?}");
        assert!(PlotAxis::log([0.0].into_iter()).is_none());
        let linear = PlotAxis::from_zero([4.0, 9.0].into_iter());
        assert_eq!(linear.ticks()[..3], [0.0, 2.0, 4.0]);
    }

    #[test]
    fn ticks_are_written_without_false_digits() {
        assert_eq!([0.1 + 0.2, 0.05, 20.0, 0.0].map(tick), ["0.3", "0.05", "20", "0"]);
    }
}
