//! The histogram, with a handle at each bound of the range, and a strip below it that shows the colours of the values.

use eframe::egui::{
    self, Align2, Color32, CursorIcon, FontId, Id, Rect, Response, Role, Sense, Shape, Stroke, Ui, WidgetInfo, pos2,
    vec2,
};

use crate::image::Rgba8;
use crate::inspect::Buffer;
use crate::inspect::display::ValueKind;
use crate::inspect::histogram::Histogram;
use crate::inspect::view::Range;
use crate::ui::engine::Shown;
use crate::ui::engine::look::kind;
use crate::ui::format;
use crate::ui::legend::color_bar;
use crate::ui::session::range::Setting;
use crate::ui::theme::{self, RADIUS, font_size, space, tokens};

/// Height of the colour strip, in points.
const STRIP: f32 = 7.0;

/// Height of the numbers along the axis, in points.
const NUMBERS: f32 = 14.0;

/// Half the width of a handle, in points.
const GRIP: f32 = 5.0;

/// Inputs of a histogram plot.
#[derive(Clone, Copy)]
pub(crate) struct HistogramPlot<'a> {
    /// Histogram of each channel, all with the same range.
    pub(crate) histograms: &'a [Histogram],
    /// Name of each channel.
    pub(crate) channels: &'a [&'a str],
    /// Range of the values that differ in the picture; others have the colour of the nearer bound.
    pub(crate) range: Option<Range>,
    /// Returns the colour of a value in the picture, given the range.
    pub(crate) color: &'a dyn Fn(Range, f32) -> Rgba8,
    /// Whether bar heights are logarithms of the counts.
    pub(crate) log_counts: bool,
}

impl HistogramPlot<'_> {
    /// Draws the plot in an area of `size` points. Returns the new range if a handle was dragged.
    pub(crate) fn ui(self, ui: &mut Ui, size: egui::Vec2) -> Option<Range> {
        let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(Role::Image, true, "Histogram"));
        let bars = Rect::from_min_max(rect.min, rect.max - vec2(0.0, STRIP + NUMBERS));
        ui.painter().rect_filled(bars, RADIUS, tokens(ui).field);
        let Some(axis) = self.histograms.first().map(|histogram| histogram.range) else {
            let font = FontId::proportional(font_size::SMALL);
            let text = "No finite values to count";
            ui.painter().text(bars.center(), Align2::CENTER_CENTER, text, font, tokens(ui).text_weak);
            return None;
        };
        let range = self.range?;
        let most = self.histograms.iter().map(Histogram::max_count).max().unwrap_or(0);
        for channel in 0..self.histograms.len() {
            self.bars(ui, bars, channel, most);
        }
        self.strip(ui, Rect::from_min_size(bars.left_bottom(), vec2(bars.width(), STRIP)), axis);
        axis_numbers(ui, rect, axis, most, self.log_counts);
        let dragged = handles(ui, &response, bars, axis, range);
        tooltip(response, bars, self.histograms, self.channels);
        dragged
    }

    /// Draws the bars of a channel. `most` is the count of the highest bar of all channels.
    fn bars(&self, ui: &Ui, rect: Rect, channel: usize, most: u64) {
        let histogram = &self.histograms[channel];
        let height = |count: u64| {
            let (count, most) = (count as f32, most.max(1) as f32);
            if self.log_counts { count.ln_1p() / most.ln_1p() } else { count / most }
        };
        let color =
            if self.channels.len() > 1 { theme::WEIGHTS[channel].gamma_multiply(0.6) } else { tokens(ui).text_weak };
        let step = rect.width() / histogram.bins.len() as f32;
        for (bin, count) in histogram.bins.iter().enumerate().filter(|(_, count)| **count > 0) {
            let left = rect.left() + bin as f32 * step;
            // At least 1 point high, so that even a single value is visible.
            let top = rect.bottom() - (height(*count) * rect.height()).max(1.0);
            let bar = Rect::from_min_max(pos2(left, top), pos2(left + step.max(1.0), rect.bottom()));
            ui.painter().rect_filled(bar, 0.0, color);
        }
    }

    /// Draws a strip with the colours of the values along the axis.
    fn strip(&self, ui: &Ui, rect: Rect, axis: Range) {
        let Some(range) = self.range else { return };
        color_bar(ui.painter(), rect, |share| (self.color)(range, axis.low + (axis.high - axis.low) * share));
    }
}

/// Returns the colour that the picture shows for the value `number`. For a colour channel, returns a grey with the
/// displayed brightness of the channel.
pub(crate) fn color_of(shown: Shown, setting: &Setting, range: Range, number: f32) -> Rgba8 {
    if kind(shown) == ValueKind::Numbers {
        return setting.display.number_color(buffer_of(shown), range, number);
    }
    let grey = (range.position(number) * 255.0).round() as u8;
    [grey, grey, grey, 255]
}

fn buffer_of(shown: Shown) -> Option<Buffer> {
    if let Shown::Buffer(buffer) = shown.source() { Some(buffer) } else { None }
}

/// Draws the values at the ends of the axis, and the count of the highest bar.
fn axis_numbers(ui: &Ui, rect: Rect, axis: Range, most: u64, log: bool) {
    let font = FontId::monospace(font_size::SMALL);
    let color = tokens(ui).text_weak;
    let painter = ui.painter();
    let low = painter.text(rect.left_bottom(), Align2::LEFT_BOTTOM, short(axis.low), font.clone(), color);
    let high = painter.text(rect.right_bottom(), Align2::RIGHT_BOTTOM, short(axis.high), font, color);
    let scale = if log { "logarithmic counts" } else { "linear counts" };
    let font = FontId::proportional(font_size::SMALL);
    // Draws the longest text that fits between the numbers.
    let room = high.left() - low.right() - 2.0 * space::S;
    for text in [format!("{scale}, highest {}", format::count(most)), scale.to_owned()] {
        let text = painter.layout_no_wrap(text, font.clone(), color);
        if text.size().x <= room {
            let middle = pos2(0.5 * (low.right() + high.left()), rect.bottom());
            let corner = Align2::CENTER_BOTTOM.anchor_size(middle, text.size()).min;
            painter.galley(corner, text, color);
            return;
        }
    }
}

/// Formats a number of an axis: integers below 10⁹ in magnitude without decimals, others with nine significant digits.
pub(crate) fn short(value: f32) -> String {
    if value.fract() == 0.0 && value.abs() < 1e9 { format::fixed(f64::from(value), 0) } else { format::f32_full(value) }
}

/// Draws the handles at both bounds of the range. A drag moves the handle nearest to the point where the drag started.
/// Returns the new range during a drag.
fn handles(ui: &Ui, response: &Response, bars: Rect, axis: Range, range: Range) -> Option<Range> {
    let width = f64::from(axis.high) - f64::from(axis.low);
    let place = |value: f32| {
        let share = if width > 0.0 { (f64::from(value) - f64::from(axis.low)) / width } else { 0.0 };
        bars.left() + share.clamp(0.0, 1.0) as f32 * bars.width()
    };
    let ends = [place(range.low), place(range.high)];
    let held_id: Id = response.id.with("held");
    let mut dragged = None;
    if let Some(pointer) = response.interact_pointer_pos() {
        if response.drag_started() {
            // egui reports a drag only after some movement, so the start is the press position.
            let from = ui.input(|i| i.pointer.press_origin()).unwrap_or(pointer).x;
            let (from_low, from_high) = ((from - ends[0]).abs(), (from - ends[1]).abs());
            // If both handles coincide, the drag direction decides.
            let high = if from_low == from_high { pointer.x > ends[1] } else { from_high < from_low };
            ui.data_mut(|data| data.insert_temp(held_id, high));
        }
        if response.dragged() {
            let share = f64::from(((pointer.x - bars.left()) / bars.width()).clamp(0.0, 1.0));
            let value = (f64::from(axis.low) + width * share) as f32;
            let high = ui.data(|data| data.get_temp(held_id)).unwrap_or(false);
            dragged = Some(if high {
                Range { low: range.low, high: value.max(range.low) }
            } else {
                Range { low: value.min(range.high), high: range.high }
            });
        }
    }
    if response.hovered() {
        ui.set_cursor_icon(CursorIcon::ResizeHorizontal);
    }
    let hidden = Color32::from_black_alpha(if ui.visuals().dark_mode { 90 } else { 40 });
    ui.painter().rect_filled(bars.with_max_x(ends[0]), 0.0, hidden);
    ui.painter().rect_filled(bars.with_min_x(ends[1]), 0.0, hidden);
    for (x, fill) in [(ends[0], Color32::BLACK), (ends[1], Color32::WHITE)] {
        let line = Stroke::new(1.5, tokens(ui).accent);
        ui.painter().vline(x, bars.y_range(), line);
        let grip = [
            pos2(x, bars.bottom() - GRIP),
            pos2(x + GRIP, bars.bottom() + STRIP),
            pos2(x - GRIP, bars.bottom() + STRIP),
        ];
        ui.painter().add(Shape::convex_polygon(grip.to_vec(), fill, Stroke::new(1.0, tokens(ui).accent)));
    }
    dragged
}

/// Draws the tooltip with the counts of the bins under the pointer.
fn tooltip(response: Response, bars: Rect, histograms: &[Histogram], channels: &[&str]) {
    let Some(pointer) = response.hover_pos().filter(|pointer| bars.contains(*pointer)) else { return };
    let share = ((pointer.x - bars.left()) / bars.width()).clamp(0.0, 1.0);
    response.on_hover_ui_at_pointer(|ui| {
        ui.spacing_mut().item_spacing.y = space::XS / 2.0;
        for (name, histogram) in channels.iter().zip(histograms) {
            let bin = ((share * histogram.bins.len() as f32) as usize).min(histogram.bins.len() - 1);
            let (from, to) = histogram.span_of(bin);
            let count = format::count(histogram.bins[bin]);
            let text = format!("{name} {} … {}: {count} pixels", short(from as f32), short(to as f32));
            ui.label(egui::RichText::new(text).monospace());
        }
        ui.weak("Drag a handle to set a bound of the range: values beyond it get the colour of the bound");
    });
}

/// Returns a function that gives the colour of a position in a range: 0 at the lower bound, 1 at the upper bound.
pub(crate) fn legend_colors(shown: Shown, setting: &Setting, range: Range) -> impl Fn(f32) -> Rgba8 + use<> {
    let (display, buffer) = (setting.display, buffer_of(shown));
    move |share| display.legend_color(buffer, range, share)
}
