//! Strip below the picture with everything that changes how the picture looks: overlays, shown quantity, heat map,
//! selection, triangle limit and mirroring. Each has a chip that removes it and, where it has colours, a legend.
//!
//! The strip takes no space while there is nothing to list, and scrolls if there is too much for a few rows. Below a
//! comparison, it has the legend of the difference.

mod chips;

mod difference;

use eframe::egui::{Button, Frame, Label, Panel, RichText, ScrollArea, Ui, WidgetInfo};

use super::fault_bar;
use super::overlays::legend;
use super::range::plot::{legend_colors, short};
use super::scrub::last_drawn;
use crate::inspect::Buffer;
use crate::inspect::display::ValueKind;
use crate::inspect::view::absence;
use crate::ui::engine::look::kind;
use crate::ui::engine::{RenderedView, Shown};
use crate::ui::legend::{ScaleLegend, note};
use crate::ui::session::command::Command;
use crate::ui::session::compare::Mode;
use crate::ui::session::{Session, what_if};
use crate::ui::theme::{self, CONTROL_HEIGHT, Icon, space, tokens};
use chips::Chip;

/// Maximum number of totals in the legend of an overlay.
const TOTALS: usize = 2;

/// Maximum height of the content, in rows. The incomplete last row shows that there is more to scroll to.
const MAX_ROWS: f32 = 2.5;

/// Draws the strip at the bottom of `ui` if it has content: the legend of the difference for a comparison, and otherwise
/// the chips. Returns its height, in points; 0 without content.
pub(crate) fn show(ui: &mut Ui, frame: Frame, compares: bool, session: &Session, commands: &mut Vec<Command>) -> f32 {
    let chips = if compares { Vec::new() } else { chips::active(session) };
    let shows_difference = compares && session.features.comparison.mode == Mode::Difference;
    if chips.is_empty() && !shows_difference {
        return 0.0;
    }
    let max_height = MAX_ROWS * (CONTROL_HEIGHT + space::XS);
    let response = Panel::bottom("legends").frame(frame).resizable(false).show(ui, |ui| {
        ScrollArea::vertical().max_height(max_height).auto_shrink([false, true]).show(ui, |ui| {
            ui.horizontal_wrapped(|ui| {
                ui.spacing_mut().item_spacing.y = space::XS;
                if shows_difference {
                    difference::ui(ui, session);
                }
                for chip in chips {
                    draw(ui, chip, session, commands);
                    ui.add_space(space::S);
                }
            });
        });
    });
    response.response.rect.height()
}

/// Returns what each chip removes, as an instruction, and the command for it.
pub(crate) fn removals(session: &Session) -> Vec<(String, Command)> {
    chips::active(session).into_iter().map(|chip| (chip.name(session), chip.remove())).collect()
}

/// Draws a chip and its legend.
fn draw(ui: &mut Ui, chip: Chip, session: &Session, commands: &mut Vec<Command>) {
    let text = chip.label(session);
    let button = ui.add(Button::new((text.as_str(), theme::icon(Icon::X))).min_size([0.0, CONTROL_HEIGHT].into()));
    let name = chip.name(session);
    button.widget_info(|| WidgetInfo::labeled(eframe::egui::Role::Button, true, &name));
    if button.on_hover_text(format!("{}. Click: {}", chip.help(session), chip.removal())).clicked() {
        commands.push(chip.remove());
    }
    let Some(view) = what_if::visible_view(ui, session) else { return };
    match chip {
        Chip::Shown => shown(ui, session, view, commands),
        Chip::Overlay(overlay) => {
            if let Some(sheet) = view.look_result.sheets.iter().find(|sheet| sheet.overlay == overlay) {
                legend::inline(ui, sheet, TOTALS);
            }
        }
        Chip::Probe => super::probe::legend::legend(ui, &session.features.probing),
        Chip::Marks if !session.features.overlays.vectors => {
            note(ui, "zoom in to see sample points and edges");
        }
        Chip::TriangleLimit => {
            if let Some(name) = last_drawn(session) {
                let help = "Last triangle drawn. It is outlined in the picture, and its object more faintly";
                ui.add(Label::new(RichText::new(name).color(tokens(ui).text)).extend()).on_hover_text(help);
            }
        }
        Chip::Marks | Chip::Selection | Chip::Mirrored => {}
    }
}

/// Draws the legend of the shown quantity: its colours, or the reason why it has no values.
fn shown(ui: &mut Ui, session: &Session, view: &RenderedView, commands: &mut Vec<Command>) {
    let shown = view.request.shown;
    let missing = match shown.source() {
        Shown::Buffer(buffer) => absence(buffer, &view.frame),
        Shown::Stage(_) | Shown::Intermediate(_) => None,
    };
    if let Some(missing) = missing {
        ui.add(Label::new(RichText::new(missing).small().color(tokens(ui).warning)).extend());
        return;
    }
    let range = view.range.filter(|_| kind(shown) == ValueKind::Numbers && !session.features.range.open);
    if let Some(range) = range {
        let colors = legend_colors(shown, &session.features.range.setting(shown), range);
        ScaleLegend { ends: [short(range.low), short(range.high)] }.ui(ui, colors);
    }
    let hits = view.buffers.as_ref().and_then(|buffers| buffers.hits.as_ref());
    if let Some(hits) = hits.filter(|_| shown == Shown::Buffer(Buffer::Hits)) {
        fault_bar::ui(ui, hits, commands);
    }
}
