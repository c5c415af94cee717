//! Marks of a row of the dot plot: grid lines, the times on the axis, the numbers, and the star of the best row.

use eframe::egui::{Align2, Color32, FontId, Rangef, Rect, Shape, Stroke, TextStyle, Ui, pos2, vec2};

use super::columns::Columns;
use super::rows::MethodRow;
use crate::measure::noise::WITHIN;
use crate::ui::format;
use crate::ui::method_colors::method_color;
use crate::ui::session::Session;
use crate::ui::theme::{self, Icon, font_size, space, tokens};
use crate::upscale::Upscaling;

/// Radius of the dot at the median, in points.
const DOT: f32 = 4.5;

/// Height of the bar from the 10th to the 90th percentile, in points.
const BAR: f32 = 6.0;

/// Opacity of the bar from the 10th to the 90th percentile.
const BAR_OPACITY: f32 = 0.5;

/// Opacity of the line to the 99th percentile.
const LINE_OPACITY: f32 = 0.7;

/// Size of the star, in points.
const STAR: f32 = 13.0;

/// Length of the dashes and gaps of the line of native rendering, in points.
const DASH: f32 = 3.0;

/// Painter of the marks of all rows.
pub(super) struct RowMarks {
    /// Columns of the list.
    pub(super) columns: Columns,
    /// Median time of native rendering, in milliseconds.
    native_ms: Option<f64>,
    best: Option<Upscaling>,
    /// Horizontal position of the budget line.
    budget: f32,
}

impl RowMarks {
    /// Creates a painter for `rows`.
    pub(super) fn new(columns: Columns, session: &Session, rows: &[MethodRow]) -> Self {
        let native = rows.iter().find(|row| row.upscaling.is_native());
        let budget = columns.x(session.features.timings.budget_ms());
        let native_ms = native.map(|row| row.summary.median);
        Self { columns, native_ms, best: session.features.timings.budget_winner().best(), budget }
    }

    /// Draws all marks of a row within `rect`.
    pub(super) fn ui(&self, ui: &Ui, rect: Rect, row: &MethodRow) {
        self.grid(ui, rect);
        let end = self.times(ui, rect, row);
        self.note(ui, rect, row, end);
        self.numbers(ui, rect, row);
        if self.best == Some(row.upscaling) {
            let center = pos2(self.columns.star, rect.center().y);
            theme::paint_icon(ui.painter(), center, Icon::Star, STAR, tokens(ui).accent);
        }
    }

    /// Draws the grid lines at the ticks, and a dashed line at the median of native rendering.
    fn grid(&self, ui: &Ui, rect: Rect) {
        for ms in self.columns.ticks() {
            ui.painter().vline(self.columns.x(ms), rect.y_range(), Stroke::new(1.0, tokens(ui).control));
        }
        if let Some(ms) = self.native_ms {
            let x = self.columns.x(ms);
            let line = [pos2(x, rect.top()), pos2(x, rect.bottom())];
            ui.painter().extend(Shape::dashed_line(&line, Stroke::new(1.0, tokens(ui).text_weak), DASH, DASH));
        }
    }

    /// Draws a bar from the 10th to the 90th percentile, a line to the 99th, and a dot at the median. Returns the
    /// horizontal extent of the marks.
    fn times(&self, ui: &Ui, rect: Rect, row: &MethodRow) -> Rangef {
        let y = rect.center().y;
        let color = if row.native_within_noise { tokens(ui).text_weak } else { method_color(ui, row.upscaling) };
        let [p10, median, p90, p99] =
            [row.summary.p10, row.summary.median, row.summary.p90, row.summary.p99].map(|ms| self.columns.x(ms));
        let painter = ui.painter();
        painter.hline(p10..=p99, y, Stroke::new(1.0, color.gamma_multiply(LINE_OPACITY)));
        let bar = Rect::from_x_y_ranges(Rangef::new(p10, p90), Rangef::point(y).expand(BAR / 2.0));
        painter.rect_filled(bar, 1.0, color.gamma_multiply(BAR_OPACITY));
        if self.columns.is_beyond(row.summary.p99) {
            let tip = pos2(p99 + DOT, y);
            let arrow = [tip, tip - vec2(DOT, DOT / 1.5), tip - vec2(DOT, -DOT / 1.5)];
            painter.add(Shape::convex_polygon(arrow.to_vec(), color, Stroke::NONE));
        }
        painter.circle(pos2(median, y), DOT, color, Stroke::new(1.0, tokens(ui).panel));
        Rangef::new(p10.min(median - DOT), p99.max(median + DOT))
    }

    /// Draws a note beside the marks: that the row is the reference, or that its time is within noise of it. Draws
    /// nothing if there is no space; the tooltip has the same words.
    fn note(&self, ui: &Ui, rect: Rect, row: &MethodRow, marks: Rangef) {
        let words = match (row.upscaling.is_native(), row.native_within_noise) {
            (true, _) => "reference",
            (false, true) => WITHIN,
            (false, false) => return,
        };
        let color = tokens(ui).text_weak;
        let galley = ui.painter().layout_no_wrap(words.to_owned(), FontId::proportional(font_size::SMALL), color);
        let size = galley.size();
        let places = [marks.max + space::S, marks.min - space::S - size.x];
        let within = self.columns.plot;
        let fits = |left: &f32| {
            let extent = Rangef::new(*left, left + size.x);
            extent.min >= within.min && extent.max <= within.max + space::S && !extent.contains(self.budget)
        };
        if let Some(left) = places.into_iter().find(fits) {
            ui.painter().galley(pos2(left, rect.center().y - size.y / 2.0), galley, color);
        }
    }

    fn numbers(&self, ui: &Ui, rect: Rect, row: &MethodRow) {
        let color = if row.native_within_noise { tokens(ui).text_weak } else { tokens(ui).text };
        let font = TextStyle::Monospace.resolve(ui.style());
        let number = |x: f32, text: String, color: Color32| {
            ui.painter().text(pos2(x, rect.center().y), Align2::RIGHT_CENTER, text, font.clone(), color);
        };
        number(self.columns.ms, format::fixed(row.summary.median, 2), color);
        let speedup = row.speedup.map_or_else(|| "–".to_owned(), |factor| speedup(factor, row.native_within_noise));
        number(self.columns.speedup, speedup, color);
        if let Some(x) = self.columns.flip {
            number(x, row.flip().map_or_else(|| "–".to_owned(), |flip| format::fixed(flip, 4)), color);
        }
    }
}

/// Formats a speed-up, such as “3.2×”; with “≈” if it is within noise.
fn speedup(factor: f64, within_noise: bool) -> String {
    let prefix = if within_noise { "≈" } else { "" };
    let decimals = usize::from(factor < 100.0);
    format!("{prefix}{}×", format::fixed(factor, decimals))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speed_ups_have_one_decimal_below_100() {
        let texts = [(3.22, false), (1.02, true), (0.8, false), (123.4, false)].map(|(f, noise)| speedup(f, noise));
        assert_eq!(texts, ["3.2×", "≈1.0×", "0.8×", "123×"]);
    }
}
