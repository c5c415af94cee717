//! Legend and totals of an overlay.

use eframe::egui::{Align, Align2, Color32, FontId, Label, Layout, RichText, Sense, Ui, vec2};

use crate::image::Rgba8;
use crate::inspect::overlays::{ColorScale, Sheet, SheetLegend, Total};
use crate::ui::format;
use crate::ui::legend::{ScaleLegend, color_bar};
use crate::ui::theme::{font_size, space, tokens};

/// Height of the colour strip, in points.
const STRIP: f32 = 8.0;

/// Side of the colour swatches of a legend, in points.
const SQUARE: f32 = 9.0;

/// Draws the legend of an overlay and its totals, such as sums and maxima over all pixels, one below the other.
pub(crate) fn ui(ui: &mut Ui, sheet: &Sheet) {
    if let Some(why) = &sheet.absence {
        ui.label(RichText::new(format!("Nothing to show: {why}")).small().color(tokens(ui).warning));
        return;
    }
    match &sheet.key {
        SheetLegend::Lines => {}
        SheetLegend::Scale(scale) => strip(ui, scale),
        SheetLegend::Kinds(kinds) => {
            for (kind, total) in kinds.iter().zip(&sheet.totals) {
                ui.horizontal(|ui| {
                    ui.spacing_mut().item_spacing.x = space::XS;
                    square(ui, kind.color);
                    ui.label(RichText::new(kind.name).small().color(tokens(ui).text));
                    // If a total has the same name as this legend entry, it is shown in the row of the entry.
                    if kind.name == total.name {
                        let number = RichText::new(amount(total)).small().color(tokens(ui).text_weak);
                        ui.with_layout(Layout::right_to_left(Align::Center), |ui| ui.label(number));
                    }
                });
            }
        }
    }
    for total in other_totals(sheet) {
        let text = format!("{}: {}", total.name, amount(total));
        ui.label(RichText::new(text).small().color(tokens(ui).text_weak));
    }
}

/// Draws the legend of an overlay and at most `most_totals` of its totals, one beside the other.
pub(crate) fn inline(ui: &mut Ui, sheet: &Sheet, most_totals: usize) {
    let small = |ui: &mut Ui, text: String, color: Color32| {
        ui.add(Label::new(RichText::new(text).small().color(color)).extend());
    };
    if let Some(why) = &sheet.absence {
        small(ui, format!("Nothing to show: {why}"), tokens(ui).warning);
        return;
    }
    match &sheet.key {
        SheetLegend::Lines => {}
        SheetLegend::Scale(scale) => {
            let ends = [0.0, 1.0].map(|share| number(scale.number_at(share)));
            ScaleLegend { ends }.ui(ui, |share| scale.color(scale.number_at(share)));
        }
        SheetLegend::Kinds(kinds) => {
            for (kind, total) in kinds.iter().zip(&sheet.totals) {
                let count = if kind.name == total.name { format!(" {}", amount(total)) } else { String::new() };
                square(ui, kind.color);
                small(ui, format!("{}{count}", kind.name), tokens(ui).text);
            }
        }
    }
    for total in other_totals(sheet).take(most_totals) {
        small(ui, format!("{}: {}", total.name, amount(total)), tokens(ui).text_weak);
    }
}

/// Returns the totals that do not count the pixels of a kind in the legend.
fn other_totals(sheet: &Sheet) -> impl Iterator<Item = &Total> {
    sheet.totals.iter().filter(|total| match &sheet.key {
        SheetLegend::Kinds(kinds) => !kinds.iter().any(|kind| kind.name == total.name),
        SheetLegend::Lines | SheetLegend::Scale(_) => true,
    })
}

/// Formats a total with its unit.
fn amount(total: &Total) -> String {
    let number = if total.number.fract() == 0.0 && total.number >= 0.0 {
        format::count(total.number as u64)
    } else if total.number.abs() < 1e-2 {
        format!("{:.2e}", total.number)
    } else {
        format::fixed(total.number, 2)
    };
    if total.unit.is_empty() { number } else { format!("{number} {}", total.unit) }
}

fn square(ui: &mut Ui, [r, g, b, _]: Rgba8) {
    let (place, _) = ui.allocate_exact_size(vec2(SQUARE, SQUARE), Sense::hover());
    ui.painter().rect_filled(place, 1.0, Color32::from_rgb(r, g, b));
}

/// Draws the colour scale as a horizontal strip, with its minimum, middle and maximum value below.
fn strip(ui: &mut Ui, scale: &ColorScale) {
    let width = ui.available_width();
    let (place, _) = ui.allocate_exact_size(vec2(width, STRIP + font_size::SMALL + space::XS), Sense::hover());
    color_bar(ui.painter(), place.with_max_y(place.top() + STRIP), |share| scale.color(scale.number_at(share)));
    let font = FontId::monospace(font_size::SMALL);
    let color = tokens(ui).text;
    let bottom = place.bottom();
    for (share, x, align) in [
        (0.0, place.left(), Align2::LEFT_BOTTOM),
        (0.5, place.center().x, Align2::CENTER_BOTTOM),
        (1.0, place.right(), Align2::RIGHT_BOTTOM),
    ] {
        let position = eframe::egui::pos2(x, bottom);
        ui.painter().text(position, align, number(scale.number_at(share)), font.clone(), color);
    }
}

/// Formats a number of a legend with about three significant digits.
fn number(value: f32) -> String {
    match value.abs() {
        size if size >= 1e5 => format!("{value:.0e}"),
        size if size >= 100.0 || value.fract() == 0.0 => format!("{value:.0}"),
        size if size >= 1.0 => format!("{value:.1}"),
        _ => format!("{value:.3}"),
    }
}
