//! Texts around the grid: effect of the current step, state of the algorithm, facts about the whole run, and
//! explanation of the lesson.

use eframe::egui::{Label, RichText, Ui};

use crate::drawing::file::EXTENSIONS;
use crate::manual::Chapter;
use crate::ui::format;
use crate::ui::manual::manual_button;
use crate::ui::session::command::Command;
use crate::ui::session::lab::{Lab, LabChange};
use crate::ui::theme::{self, Icon, space, tokens};
use crate::ui::widgets::{icon_button, section_header, value_row};

/// Draws the description of the current step above the grid.
pub(super) fn sentence(ui: &mut Ui, lab: &Lab) {
    ui.horizontal_centered(|ui| {
        let step = lab.step.checked_sub(1).and_then(|last| lab.recording.steps.get(last));
        let text = step.map_or("No step yet: step forward or play.", |step| &step.description);
        ui.add(Label::new(RichText::new(text).color(tokens(ui).text_strong)).truncate());
    });
}

/// Draws the panel beside the grid: explanation of the lesson, state of the algorithm, facts about the run, and
/// buttons.
pub(super) fn ui(ui: &mut Ui, lab: &Lab, changes: &mut Vec<LabChange>, commands: &mut Vec<Command>) {
    section_header(ui, "Explanation", |ui| {
        manual_button(ui, Chapter::Lab, commands);
        if icon_button(ui, Icon::RotateCcw, "Reset this page").clicked() {
            changes.push(LabChange::Reset);
        }
    });
    theme::card_frame(ui).show(ui, |ui| {
        ui.add(Label::new(RichText::new(lab.lesson().explanation()).color(tokens(ui).text)).wrap());
    });
    section_header(ui, "State after this step", |_| {});
    match lab.step.checked_sub(1).and_then(|last| lab.recording.steps.get(last)) {
        Some(step) => step.state.iter().for_each(|(name, value)| {
            value_row(ui, name, value, "");
        }),
        None => {
            ui.label(RichText::new("No state yet").color(tokens(ui).text_weak));
        }
    }
    section_header(ui, "Facts about the whole run", |_| {});
    value_row(
        ui,
        "time",
        &in_words(lab.run_time),
        "Duration of one run of the algorithm without recording; the shortest of several rounds",
    );
    for (name, value) in &lab.recording.facts {
        value_row(ui, name, value, "");
    }
    ui.add_space(space::S);
    ui.horizontal_wrapped(|ui| {
        let compares = lab.lesson().compare_is_possible();
        let button = ui
            .add_enabled(compares, eframe::egui::Button::new((theme::icon(Icon::ChartScatter), "Compare all methods")));
        let help =
            "Run all methods on a larger input, and measure the time of each and its error against the exact result";
        if button
            .on_hover_text(help)
            .on_disabled_hover_text(
                "Not available for points, lines and triangles, which have no exact result to compare with",
            )
            .clicked()
        {
            changes.push(LabChange::Compare);
        }
        ui.menu_button((theme::icon(Icon::Download), "Save drawing"), |ui| save_menu(ui, changes));
    });
}

fn save_menu(ui: &mut Ui, changes: &mut Vec<LabChange>) {
    ui.label(RichText::new("Save to the current folder").color(tokens(ui).text_weak));
    for (end, _) in EXTENSIONS.iter().filter(|(end, _)| !matches!(*end, "jpeg" | "tif")) {
        let what = match *end {
            "svg" => "SVG: vector drawing, sharp at any size",
            "pdf" => "PDF: vector drawing on a page",
            "gif" => "GIF: all steps as an animation",
            "png" => "PNG",
            "bmp" => "BMP",
            "jpg" => "JPEG",
            _ => "TIFF",
        };
        if ui.button(what).clicked() {
            changes.push(LabChange::Save(end));
            ui.close();
        }
    }
}

/// Formats a time with its unit: microseconds below 1 ms, milliseconds otherwise.
pub(super) fn in_words(time: std::time::Duration) -> String {
    let micros = time.as_secs_f64() * 1e6;
    if micros < 1_000.0 { format!("{} µs", format::fixed(micros, 2)) } else { format::ms(micros / 1e3) }
}
