//! Legend of the hit count: the number of cracks and double hits, and buttons to step through them.

use eframe::egui::{Button, Color32, Label, RichText, Ui, Vec2};

use crate::inspect::view::fault_color;
use crate::inspect::{FaultKind, Hits};
use crate::scene::seams::SeamCounts;
use crate::ui::format;
use crate::ui::legend::note;
use crate::ui::session::command::Command;
use crate::ui::theme::{self, CONTROL_HEIGHT, Icon, tokens};
use crate::ui::widgets::{Status, chip, swatch};

/// Draws the counts and the buttons, one beside the other.
pub(crate) fn ui(ui: &mut Ui, hits: &Hits, commands: &mut Vec<Command>) {
    draw_counts(ui, hits);
    steps(ui, hits, commands);
    if hits.elsewhere > 0 {
        let text = format!("{} more wrong pixels, not along shared edges", format::count(hits.elsewhere as u64));
        let help = "Pixels on outlines (edges of only one triangle) that are hit too often or too rarely";
        note(ui, &text).on_hover_text(help);
    }
    if let Some(text) = seams_text(hits) {
        let help = "T-junctions are vertices within the open edge of another triangle; unwelded vertices are close \
                    together, but not identical. Both can cause cracks. The overlay “T-junctions” marks them.";
        note(ui, &text).on_hover_text(help);
    }
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
        swatch(ui, Color32::from_rgb(r, g, b));
        let text = format!("{} {}", format::count(count as u64), if count == 1 { one } else { many });
        ui.add(Label::new(RichText::new(text).color(tokens(ui).text)).extend()).on_hover_text(help);
    }
}

fn steps(ui: &mut Ui, hits: &Hits, commands: &mut Vec<Command>) {
    for (icon, name, step) in
        [(Icon::ChevronLeft, "Previous fault  (Shift+J)", -1), (Icon::ChevronRight, "Next fault  (J)", 1)]
    {
        let button = Button::new(theme::icon(icon)).min_size(Vec2::splat(CONTROL_HEIGHT));
        let button = ui.add_enabled(!hits.faults.is_empty(), button).on_hover_text(name);
        if button.on_disabled_hover_text("No faults in this frame").clicked() {
            commands.push(Command::StepFault(step));
        }
    }
}
