//! Figures of the shown quantity as text: count, least, greatest, mean, deviation, and what is no number.

use eframe::egui::{Align, Label, Layout, RichText, Ui};

use super::Change;
use super::card::row;
use super::plot::short;
use crate::inspect::display::Kind;
use crate::inspect::statistics::Statistics;
use crate::measure::region::Region;
use crate::ui::format;
use crate::ui::theme::{Icon, tokens};
use crate::ui::widgets::icon_button;

/// Names of the columns, with their explanations.
pub const COLUMNS: [(&str, &str); 7] = [
    ("n", "Finite values"),
    ("min", "The least"),
    ("max", "The greatest"),
    ("mean", "Their mean"),
    ("σ", "Standard deviation"),
    ("#NaN", "Values that are not a number"),
    ("#Inf", "Infinite values of either sign"),
];

/// The figures of one channel, as text, in the order of [`COLUMNS`].
pub fn texts(figures: &Statistics) -> [String; 7] {
    let known = |text: String| if figures.finite == 0 { "–".to_owned() } else { text };
    [
        format::count(figures.finite),
        known(short(figures.min)),
        known(short(figures.max)),
        known(short(figures.mean as f32)),
        known(short(figures.deviation() as f32)),
        format::count(figures.nan),
        format::count(figures.infinite),
    ]
}

/// The rows of a dragged rectangle: where it is, and the figures of each channel.
pub fn part(ui: &mut Ui, region: Region, kind: Kind, channels: &[Statistics], changes: &mut Vec<Change>) {
    row(ui, |ui| {
        let Region { left, top, right, bottom } = region;
        let text = format!("Box {left}, {top} · {} × {} px", right.saturating_sub(left), bottom.saturating_sub(top));
        ui.label(RichText::new(text).color(tokens(ui).text));
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if icon_button(ui, Icon::X, "Drop the box").clicked() {
                changes.push(Change::Region(None));
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
