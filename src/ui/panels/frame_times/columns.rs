//! Horizontal layout of the dot plot: columns of names, times and numbers.

use eframe::egui::{Rangef, Rect};

use super::axis::TimeAxis;
use crate::ui::theme::space;

/// Width of the column of check boxes, in points.
const CHECK: f32 = 30.0;

/// Width of the column with the star of the best row, in points.
const STAR: f32 = 20.0;

/// Width of the column of speed-ups, in points.
const SPEEDUP: f32 = 56.0;

/// Width of the column of errors, in points.
const FLIP: f32 = 50.0;

/// Width of the column of median times with the space before it, in points.
const MS: f32 = 44.0;

/// Maximum width of the column of names, as a fraction of the width of the list. Longer names wrap.
const NAME_SHARE: f32 = 0.28;

/// Width that the column of names may always have, in points.
const NAME_MIN: f32 = 100.0;

/// Minimum distance between tick labels, in points.
const TICK_GAP: f32 = 36.0;

/// Columns of the dot plot and its time axis. Positions are in points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Columns {
    /// Horizontal extent of the rows.
    pub(super) whole: Rangef,
    /// Column of the check boxes.
    pub(super) checks: Rangef,
    /// Column of the names.
    pub(super) names: Rangef,
    /// Centre of the star of the best row.
    pub(super) star: f32,
    /// Extent of the time axis.
    pub(super) plot: Rangef,
    /// Right edge of the median times.
    pub(super) ms: f32,
    /// Right edge of the speed-ups over native rendering.
    pub(super) speedup: f32,
    /// Right edge of the errors; `None` if no errors were measured.
    pub(super) flip: Option<f32>,
    axis: TimeAxis,
}

impl Columns {
    /// Divides the width `whole` among the columns. `widest_name` is the width of the widest name.
    pub(super) fn divide(whole: Rangef, widest_name: f32, has_errors: bool, axis: TimeAxis) -> Self {
        let names = widest_name.min((whole.span() * NAME_SHARE).max(NAME_MIN));
        let checks = Rangef::new(whole.min, whole.min + CHECK);
        let names = Rangef::new(checks.max, checks.max + names);
        let right = whole.max - space::XS;
        let speedup = if has_errors { right - FLIP } else { right };
        let ms = speedup - SPEEDUP;
        let plot = Rangef::new(names.max + STAR + space::XS, ms - MS);
        let star = names.max + STAR / 2.0;
        Self { whole, checks, names, star, plot, ms, speedup, flip: has_errors.then_some(right), axis }
    }

    /// Returns the horizontal position of a time, limited to the plot.
    pub(super) fn x(&self, ms: f64) -> f32 {
        self.plot.min + self.axis.share(ms).clamp(0.0, 1.0) * self.plot.span()
    }

    /// Returns the time at a horizontal position, in milliseconds.
    pub(super) fn ms_at(&self, x: f32) -> f64 {
        self.axis.ms((x - self.plot.min) / self.plot.span())
    }

    /// Whether a time lies beyond the right end of the axis.
    pub(super) fn is_beyond(&self, ms: f64) -> bool {
        self.axis.share(ms) > 1.0
    }

    /// Returns the ticks of the time axis in milliseconds, with enough space between their labels.
    pub(super) fn ticks(&self) -> impl Iterator<Item = f64> {
        self.axis.ticks((self.plot.span() / TICK_GAP) as usize + 1)
    }

    /// Returns the area of the plot over a vertical extent.
    pub(super) fn plot_area(&self, rows: Rangef) -> Rect {
        Rect::from_x_y_ranges(self.plot, rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns(width: f32) -> Columns {
        let axis = TimeAxis::covering([0.5, 8.0].into_iter());
        Columns::divide(Rangef::new(10.0, 10.0 + width), 160.0, true, axis)
    }

    #[test]
    fn the_plot_keeps_a_useful_width_in_narrow_panels() {
        assert!(columns(420.0).plot.span() >= 90.0);
        assert!(columns(1920.0).plot.span() > 1400.0);
    }

    #[test]
    fn positions_on_the_axis_are_inverse_to_times_within_it() {
        let columns = columns(800.0);
        assert!((columns.ms_at(columns.x(2.5)) - 2.5).abs() < 1e-3);
        assert_eq!([columns.x(0.5), columns.x(100.0)], [columns.plot.min, columns.plot.max]);
        assert!(columns.is_beyond(100.0) && !columns.is_beyond(8.0));
    }
}
