//! Statistics of the shown quantity as text: minimum, maximum, mean and standard deviation, and the numbers of finite,
//! NaN and infinite values.

use eframe::egui::{Align, Label, Layout, RichText, Ui, vec2};

use super::plot::short;
use crate::inspect::display::ValueKind;
use crate::inspect::statistics::Statistics;
use crate::measure::region::PixelRegion;
use crate::ui::format;
use crate::ui::session::range::RangeChange;
use crate::ui::theme::{Icon, ROW_HEIGHT, space, tokens};
use crate::ui::widgets::icon_button;

/// Column heading and help text of each statistic.
pub(crate) const COLUMNS: [(&str, &str); 7] = [
    ("n", "Number of finite values"),
    ("min", "Smallest finite value"),
    ("max", "Largest finite value"),
    ("mean", "Mean of the finite values"),
    ("σ", "Standard deviation of the finite values"),
    ("#NaN", "Number of NaN values"),
    ("#Inf", "Number of infinite values of either sign"),
];

/// Draws a row of the card with a height of [`ROW_HEIGHT`] points.
pub(super) fn row(ui: &mut Ui, content: impl FnOnce(&mut Ui)) {
    let size = vec2(ui.available_width(), ROW_HEIGHT);
    ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
        ui.spacing_mut().item_spacing.x = space::XS;
        content(ui);
    });
}

/// Formats the statistics of one channel, in the order of [`COLUMNS`].
pub(crate) fn texts(figures: &Statistics) -> [String; 7] {
    let known = |text: String| if figures.finite == 0 { "–".to_owned() } else { text };
    [
        format::count(figures.finite),
        known(short(figures.min)),
        known(short(figures.max)),
        known(rounded(figures.mean)),
        known(rounded(figures.deviation())),
        format::count(figures.nan),
        format::count(figures.infinite),
    ]
}

/// Formats a derived statistic, such as the mean, with six significant digits.
fn rounded(value: f64) -> String {
    const DIGITS: i32 = 6;
    if value == 0.0 {
        return "0".to_owned();
    }
    let exponent = value.abs().log10().floor() as i32;
    if (-4..9).contains(&exponent) {
        return format::fixed(value, (DIGITS - 1 - exponent).max(0) as usize);
    }
    format!("{value:.5e}").replace('-', "−")
}

/// Draws the rows for the region that the user selected: its rectangle, then the statistics of each channel.
pub(crate) fn part(
    ui: &mut Ui,
    region: PixelRegion,
    kind: ValueKind,
    channels: &[Statistics],
    changes: &mut Vec<RangeChange>,
) {
    row(ui, |ui| {
        let PixelRegion { left, top, right, bottom } = region;
        let text = format!("Box {left}, {top} · {} × {} px", right.saturating_sub(left), bottom.saturating_sub(top));
        ui.label(RichText::new(text).color(tokens(ui).text));
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if icon_button(ui, Icon::X, "Clear the box").clicked() {
                changes.push(RangeChange::Region(None));
            }
        });
    });
    for (name, channel) in kind.channels().iter().zip(channels) {
        let [count, min, max, mean, deviation, nan, infinite] = texts(channel);
        let odd =
            if channel.nan + channel.infinite > 0 { format!(" · {nan} NaN · {infinite} ∞") } else { String::new() };
        let text = format!("{name} {min} … {max}, mean {mean}, σ {deviation}, n {count}{odd}");
        row(ui, |ui| {
            let label = Label::new(RichText::new(&text).small().monospace()).truncate().selectable(true);
            ui.add(label).on_hover_text(&text);
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn computed_figures_have_six_digits() {
        for (value, text) in [
            (0.0, "0"),
            (128.674_744, "128.675"),
            (-0.012_345_678, "−0.0123457"),
            (1_234_567.8, "1234568"),
            (1.5e-9, "1.50000e−9"),
        ] {
            assert_eq!(rounded(value), text);
        }
    }

    #[test]
    fn without_finite_values_there_are_only_counts() {
        let mut statistics = Statistics::default();
        [f32::NAN, f32::INFINITY].into_iter().for_each(|value| statistics.add(value));
        let texts = texts(&statistics);
        assert_eq!(texts.each_ref().map(String::as_str), ["0", "–", "–", "–", "–", "1", "1"]);
    }
}
