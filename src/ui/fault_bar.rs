//! Card above the legend of the hit count: the number of cracks and double hits, and buttons to step through them.

use eframe::egui::{Align, Color32, Layout, Rect, RichText, Ui, UiBuilder, pos2, vec2};

use super::command::Command;
use super::format;
use super::theme::{Icon, RADIUS, ROW_HEIGHT, space, tokens};
use super::widgets::{Status, chip, icon_button, swatch};
use crate::inspect::view::fault_color;
use crate::inspect::{FaultKind, Hits};
use crate::scene::seams::SeamCounts;

/// Draws the card directly above the legend's rectangle.
pub(crate) fn ui(ui: &mut Ui, legend: Rect, hits: &Hits, commands: &mut Vec<Command>) {
    let seams = seams_text(hits);
    let rows = 2.0 + f32::from(hits.elsewhere > 0) + f32::from(seams.is_some());
    let height = rows * ROW_HEIGHT + 2.0 * space::XS;
    let bottom = legend.top() - space::XS;
    let card = Rect::from_min_max(pos2(legend.left(), bottom - height), pos2(legend.right(), bottom));
    ui.painter().rect_filled(card, RADIUS, tokens(ui).panel.gamma_multiply(0.92));
    let inner = card.shrink2(vec2(space::S, space::XS));
    let mut column = ui.new_child(UiBuilder::new().max_rect(inner).layout(Layout::top_down(Align::Min)));
    column.spacing_mut().item_spacing.y = 0.0;
    let row = |ui: &mut Ui, content: &mut dyn FnMut(&mut Ui)| {
        let size = vec2(ui.available_width(), ROW_HEIGHT);
        ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| content(ui));
    };
    row(&mut column, &mut |ui| draw_counts(ui, hits));
    if hits.elsewhere > 0 {
        row(&mut column, &mut |ui| {
            let text = format!("{} more wrong pixels, not along shared edges", format::count(hits.elsewhere as u64));
            let help = "Pixels on outlines (edges of only one triangle) that are hit too often or too rarely";
            ui.label(RichText::new(text).small().color(tokens(ui).text_weak)).on_hover_text(help);
        });
    }
    if let Some(text) = seams {
        row(&mut column, &mut |ui| {
            let help = "T-junctions are vertices within the open edge of another triangle; unwelded vertices are close \
                        together, but not identical. Both can cause cracks. The overlay “T-junctions” marks them.";
            ui.label(RichText::new(&text).small().color(tokens(ui).text_weak)).on_hover_text(help);
        });
    }
    row(&mut column, &mut |ui| steps(ui, hits, commands));
}

/// Returns the numbers of T-junctions and unwelded vertices of the scene as text; `None` if all are zero. While the
/// search is running, the text is a note that says so.
fn seams_text(hits: &Hits) -> Option<String> {
    match hits.mesh {
        None => Some("Searching for T-junctions…".to_owned()),
        Some(counts) if counts == SeamCounts::default() => None,
        Some(counts) => Some(format!("Mesh: {}", counts.text())),
    }
}

/// Draws the number of cracks and the number of double hits, each beside the colour that marks such pixels. If both
/// numbers are zero, draws a green “passed” label instead.
fn draw_counts(ui: &mut Ui, hits: &Hits) {
    let (cracks, doubles) = (hits.count(FaultKind::Crack), hits.count(FaultKind::DoubleHit));
    if cracks + doubles == 0 {
        chip(ui, Status::Passed, "0 cracks · 0 double hits", "Every pixel along a shared edge is drawn exactly once");
        return;
    }
    for (kind, count, one, many, help) in [
        (FaultKind::Crack, cracks, "crack", "cracks", "Pixels along a shared edge hit by too few triangles"),
        (FaultKind::DoubleHit, doubles, "double hit", "double hits", "Pixels hit by both triangles of a shared edge"),
    ] {
        let [r, g, b, _] = fault_color(kind);
        ui.spacing_mut().item_spacing.x = space::XS;
        swatch(ui, Color32::from_rgb(r, g, b));
        let text = format!("{} {}", format::count(count as u64), if count == 1 { one } else { many });
        ui.label(RichText::new(text).color(tokens(ui).text)).on_hover_text(help);
        ui.add_space(space::XS);
    }
}

fn steps(ui: &mut Ui, hits: &Hits, commands: &mut Vec<Command>) {
    ui.label(RichText::new("Fault").color(tokens(ui).text_weak));
    ui.add_enabled_ui(!hits.faults.is_empty(), |ui| {
        for (icon, name, step) in
            [(Icon::ChevronLeft, "Previous fault  (Shift+J)", -1), (Icon::ChevronRight, "Next fault  (J)", 1)]
        {
            let button = icon_button(ui, icon, name).on_disabled_hover_text("No faults in this frame");
            if button.clicked() {
                commands.push(Command::StepFault(step));
            }
        }
    });
}
