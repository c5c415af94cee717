//! Layout of the 2D lab. Each page has a file for its controls. All pages share the grid, the playback bar, the
//! description of the current step, and the comparison of methods.

mod grid;
mod grid_view;
mod methods;
mod pages;
mod palette;
mod pointer;
mod readout;
mod transport;

use eframe::egui::{self, CentralPanel, Panel, ScrollArea, Ui};

use crate::lab::Page;
use crate::manual::Chapter;
use crate::pipeline::settings::Choice as _;
use crate::ui::panels::PanelSpec;
use crate::ui::session::command::Command;
use crate::ui::session::lab::{Lab, LabChange};
use crate::ui::theme::{self, ROW_HEIGHT, space};

/// Description of the panel.
pub(crate) const PANEL: PanelSpec = PanelSpec {
    chapter: Chapter::Lab,
    grows: true,
    titled: false,
    controls: None,
    content: |ui, cx| self::ui(ui, &cx.session.features.lab, cx.commands),
};

/// Maximum initial width of each side panel, as a fraction of the window width.
const SIDE_SHARE: f32 = 0.27;

/// Height of the bars above and below the grid, in points.
const BAR_HEIGHT: f32 = ROW_HEIGHT + 12.0;

/// Draws the lab into the area below the menu.
fn ui(ui: &mut Ui, lab: &Lab, commands: &mut Vec<Command>) {
    let mut changes = Vec::new();
    let frame = theme::panel_frame(ui);
    // The grid keeps the largest share even in a narrow window.
    let share = |wanted: f32| wanted.min(ui.available_width() * SIDE_SHARE);
    let (left, right) = (share(264.0), share(316.0));
    if let Some(comparison) = &lab.comparison {
        Panel::bottom("lab rivals").frame(frame).resizable(true).default_size(230.0).min_size(120.0).show(ui, |ui| {
            methods::ui(ui, comparison, &mut changes);
        });
    }
    Panel::left("lab pages").frame(frame).resizable(true).default_size(left).min_size(200.0).show(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            page_list(ui, lab, &mut changes);
            pages::controls(ui, lab, &mut changes);
        });
    });
    Panel::right("lab readout").frame(frame).resizable(true).default_size(right).min_size(220.0).show(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| readout::ui(ui, lab, &mut changes, commands));
    });
    CentralPanel::default().frame(theme::canvas_frame(ui)).show(ui, |ui| {
        Panel::top("lab says").frame(frame).exact_size(BAR_HEIGHT).show(ui, |ui| readout::sentence(ui, lab));
        Panel::bottom("lab transport").frame(frame).exact_size(BAR_HEIGHT).show(ui, |ui| {
            transport::ui(ui, lab, &mut changes);
        });
        CentralPanel::no_frame().show(ui, |ui| grid::ui(ui, lab, &mut changes));
    });
    commands.extend(changes.into_iter().map(Command::Lab));
}

fn page_list(ui: &mut Ui, lab: &Lab, changes: &mut Vec<LabChange>) {
    for page in Page::ALL {
        // A growing atom after the name left-aligns it.
        let name = (page.name(), egui::Atom::grow());
        let button = egui::Button::selectable(*page == lab.page, name)
            .min_size(egui::vec2(ui.available_width(), theme::CONTROL_HEIGHT));
        if ui.add(button).on_hover_text(page.help()).clicked() {
            changes.push(LabChange::Page(*page));
        }
    }
    ui.add_space(space::XS);
    ui.separator();
}
