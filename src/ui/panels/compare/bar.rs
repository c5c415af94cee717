//! Bar above the compared pictures: comparison mode, tile count, region and reference.

use eframe::egui::{self, Align, Button, Layout, RichText, Ui, Vec2};

use crate::manual::Chapter;
use crate::measure::difference::{Difference, GAINS};
use crate::measure::reference::Reference;
use crate::measure::tone::ToneCurve;
use crate::pipeline::settings::Choice as _;
use crate::ui::manual::manual_button;
use crate::ui::panels::PanelWidgets;
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::compare::{CompareChange, Mode};
use crate::ui::session::file_command::FileCommand;
use crate::ui::session::filmstrip::{self, FilmstripChange};
use crate::ui::session::picture_role::PictureRole;
use crate::ui::session::window_task::DialogCommand;
use crate::ui::theme::{self, Icon, tokens};
use crate::ui::widgets::{combo, icon_button, number_field};

/// Tile counts that can be chosen with a button.
const COUNTS: [usize; 2] = [2, 4];

/// Width reserved for the list of references and its label, in points.
const REFERENCE_POINTS: f32 = 190.0;

/// Width reserved for the list of references without its label, in points.
const REFERENCE_LIST_POINTS: f32 = 136.0;

/// Width of the bar from which the list of references has a label, in points.
const LABEL_POINTS: f32 = 1080.0;

/// Draws the comparison modes, the tile count, the region, the filmstrip switch and the reference.
pub(crate) fn ui(ui: &mut Ui, session: &Session, widgets: &PanelWidgets, commands: &mut Vec<Command>) {
    let comparison = &session.features.comparison;
    let mut changes = Vec::new();
    let has_label = ui.available_width() >= LABEL_POINTS;
    ui.horizontal_wrapped(|ui| {
        for (mode, name, help) in Mode::ALL {
            if ui.selectable_label(comparison.mode == mode, name).on_hover_text(help).clicked() {
                changes.push(CompareChange::Mode(mode));
            }
        }
        ui.separator();
        match comparison.mode {
            Mode::Tiles => counts(ui, session, &mut changes),
            Mode::Difference => difference(ui, session, &mut changes),
            Mode::Off | Mode::Wipe | Mode::Flip => {}
        }
        if icon_button(ui, Icon::ArrowLeftRight, "Swap pictures A and B  (S)").clicked() {
            changes.push(CompareChange::Swap);
        }
        region(ui, session, &mut changes);
        files(ui, session, &mut changes, commands);
        let strip =
            Button::selectable(session.features.filmstrip.is_shown_in(widgets.picture_panel_height), "Filmstrip");
        let strip = ui.add_enabled(filmstrip::has_room(widgets.picture_panel_height), strip);
        let help = "Show every upscaling method in a strip below the pictures";
        let why = "The window is too low for a strip of all upscaling methods below the pictures";
        if strip.on_hover_text(help).on_disabled_hover_text(why).clicked() {
            commands.push(Command::Filmstrip(FilmstripChange::Toggle));
        }
        ui.separator();
        // One allocation keeps the label and its list on the same row.
        let width = if has_label { REFERENCE_POINTS } else { REFERENCE_LIST_POINTS };
        ui.allocate_ui_with_layout(
            Vec2::new(width, theme::CONTROL_HEIGHT),
            Layout::left_to_right(Align::Center),
            |ui| reference(ui, has_label, session, &mut changes),
        );
        if let Some(scale) = widgets.canvas.scale().filter(|scale| *scale < 1.0) {
            let text = format!("shown at {:.0} % of full size", scale * 100.0);
            ui.label(RichText::new(text).small().color(tokens(ui).warning)).on_hover_text(
                "Only the display is downscaled: errors and differences are computed from the full-size pictures",
            );
        }
        if icon_button(ui, Icon::Download, "Save comparison (HTML)").clicked() {
            commands.push(Command::File(FileCommand::SaveComparison));
        }
        manual_button(ui, Chapter::ComparingUpscalers, commands);
        if icon_button(ui, Icon::X, "Stop comparing  (Esc)").clicked() {
            changes.push(CompareChange::Mode(Mode::Off));
        }
    });
    commands.extend(changes.into_iter().map(Command::Compare));
}

fn counts(ui: &mut Ui, session: &Session, changes: &mut Vec<CompareChange>) {
    let count = session.state.tiles.count();
    for wanted in COUNTS {
        let label = ui.selectable_label(count == wanted, wanted.to_string());
        let name = format!("{wanted} tiles");
        label.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, count == wanted, &name));
        if label.on_hover_text(name).clicked() {
            changes.push(CompareChange::Count(wanted));
        }
    }
    let help = "Show a tile for every upscaling method, at the scale of the filmstrip";
    if ui.button("All").on_hover_text(help).clicked() {
        changes.push(CompareChange::Every(session.features.filmstrip.scale));
    }
    if count < crate::inspect::project::MAX_TILES && icon_button(ui, Icon::Plus, "Add a tile").clicked() {
        changes.push(CompareChange::Count(count + 1));
    }
    ui.separator();
}

fn difference(ui: &mut Ui, session: &Session, changes: &mut Vec<CompareChange>) {
    let mut kind = session.features.comparison.difference;
    ui.name_inputs("Difference to show", |ui| {
        combo("difference", kind.name(), 116.0).show_ui(ui, |ui| {
            for option in Difference::ALL {
                ui.selectable_value(&mut kind, *option, option.name()).on_hover_text(option.help());
            }
        });
    });
    if kind != session.features.comparison.difference {
        changes.push(CompareChange::Difference(kind));
    }
    let mut gain = session.features.comparison.gain;
    if kind.has_gain() {
        ui.name_inputs("Gain", |ui| {
            combo("gain", &format!("×{gain}"), 60.0).show_ui(ui, |ui| {
                for option in GAINS {
                    ui.selectable_value(&mut gain, option, format!("×{option}"));
                }
            });
        });
    }
    if gain != session.features.comparison.gain {
        changes.push(CompareChange::Gain(gain));
    }
    ui.separator();
}

fn region(ui: &mut Ui, session: &Session, changes: &mut Vec<CompareChange>) {
    let comparison = &session.features.comparison;
    let help = "Drag a rectangle on a picture to measure only that region  (R)";
    let button = ui.selectable_label(comparison.draws_region, "Region");
    if button.on_hover_text(help).clicked() {
        changes.push(CompareChange::ToggleRegion);
    }
    if let Some(region) = comparison.region {
        let (width, height) = (region.right - region.left, region.bottom - region.top);
        let text = RichText::new(format!("{width} × {height} at {}, {}", region.left, region.top)).monospace();
        let forget = ui.add(Button::new((text, theme::icon(Icon::X))));
        forget.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, "Clear the region"));
        if forget.on_hover_text("Clear the region").clicked() {
            changes.push(CompareChange::Region(None));
        }
    }
}

/// Draws the menu that opens picture files, and exposure and tone curve if a file has linear light.
fn files(ui: &mut Ui, session: &Session, changes: &mut Vec<CompareChange>, commands: &mut Vec<Command>) {
    let help = "Open a picture file as A, as B or as reference; it can also be dropped on a picture";
    ui.menu_button("Open picture…", |ui| {
        for role in PictureRole::LISTED {
            if ui.button(format!("As {}…", role.name())).clicked() {
                commands.push(Command::Dialog(DialogCommand::OpenPicture(role)));
                ui.close();
            }
        }
    })
    .response
    .on_hover_text(help);
    if !session.features.comparison.pictures.have_tone() {
        return;
    }
    let mut tone = session.features.comparison.pictures.tone();
    let help = "Exposure of float pictures in stops: for display, for FLIP and for the other errors";
    ui.name_inputs("Exposure", |ui| {
        let field = number_field(&mut tone.exposure, |stops| format!("{stops:.2} EV"));
        let field = field.speed(0.05).range(-20.0..=20.0);
        ui.add(field).on_hover_text(help);
    });
    ui.name_inputs("Tone curve", |ui| {
        combo("tone curve", tone.curve.name(), 90.0).show_ui(ui, |ui| {
            for curve in ToneCurve::ALL {
                ui.selectable_value(&mut tone.curve, *curve, curve.name()).on_hover_text(curve.help());
            }
        });
    });
    if tone != session.features.comparison.pictures.tone() {
        changes.push(CompareChange::Tone(tone));
    }
}

fn reference(ui: &mut Ui, has_label: bool, session: &Session, changes: &mut Vec<CompareChange>) {
    if has_label {
        ui.label(RichText::new("against").color(tokens(ui).text_weak));
    }
    let Some(file) = session.features.comparison.opened(&session.state.tiles, PictureRole::Reference) else {
        changes.extend(reference_list(ui, "Reference", 124.0, session.features.comparison.reference));
        return;
    };
    let label = ui.add_sized([100.0, theme::CONTROL_HEIGHT], egui::Label::new(file.name()).truncate());
    let is_chosen = session.state.tiles.file(PictureRole::Reference).is_some();
    let why = "A is a file, so errors are measured against it; open a reference to measure against another picture";
    label.on_hover_text(if is_chosen { file.picture.description() } else { why.to_owned() });
    if is_chosen && icon_button(ui, Icon::X, "Close the reference file and draw the reference").clicked() {
        changes.push(CompareChange::RemoveFile(PictureRole::Reference));
    }
}

/// Draws the list of references, `width` points wide. `name` is its accessible name. Returns the change if another
/// reference was chosen.
pub(crate) fn reference_list(ui: &mut Ui, name: &str, width: f32, present: Reference) -> Option<CompareChange> {
    let mut reference = present;
    let list = ui.name_inputs(name, |ui| {
        combo(name, present.name(), width).show_ui(ui, |ui| {
            for option in Reference::ALL {
                ui.selectable_value(&mut reference, *option, option.name()).on_hover_text(option.help());
            }
        })
    });
    // Attached after the list has its accessible name: an unnamed list would take the tooltip as its name.
    list.response.on_hover_text(format!("Reference that errors are measured against. {}", present.help()));
    (reference != present).then_some(CompareChange::Reference(reference))
}
