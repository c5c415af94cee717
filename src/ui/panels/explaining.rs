//! The panel “Other renderer”: the faults by which an opened picture differs from our drawing.

use eframe::egui::{Button, Label, ProgressBar, RichText, ScrollArea, Ui};

use crate::explain::{Cause, Confidence, Kind};
use crate::manual::Chapter;
use crate::ui::format;
use crate::ui::panels::PanelSpec;
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::explaining::{Explained, ExplainingChange, subject};
use crate::ui::session::picture_role::PictureRole;
use crate::ui::session::window_task::DialogCommand;
use crate::ui::theme::{self, Icon, tokens};
use crate::ui::widgets::{Status, chip, icon_button};

/// Description of the panel.
pub(crate) const PANEL: PanelSpec = PanelSpec {
    chapter: Chapter::OtherRenderers,
    grows: false,
    titled: true,
    controls: Some(|ui, cx| controls(ui, cx.session, cx.commands)),
    content: |ui, cx| self::ui(ui, cx.session, cx.commands),
};

fn controls(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let explaining = &session.features.explaining;
    let subject = subject(session);
    if ui.button("Open picture…").on_hover_text("Open the other renderer's picture of this view as B").clicked() {
        commands.push(Command::Dialog(DialogCommand::OpenPicture(PictureRole::Tile(1))));
    }
    let run = Button::new((theme::icon(Icon::Search), "Explain"));
    let run = ui.add_enabled(subject.is_some() && explaining.progress.is_none(), run);
    let help = "Draw this view with every known fault, and find those that explain the opened picture";
    if run.on_hover_text(help).on_disabled_hover_text("Open a picture first").clicked() {
        commands.push(Command::Explaining(ExplainingChange::Run));
    }
    if let Some(progress) = explaining.progress {
        if ui.button("Cancel").on_hover_text("Stop the search").clicked() {
            commands.push(Command::Explaining(ExplainingChange::Cancel));
        }
        ui.add(ProgressBar::new(progress).desired_width(80.0).show_percentage());
    }
}

/// Draws the opened depths and ids, with buttons that open and close them.
fn further_pictures(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let explaining = &session.features.explaining;
    let rows = [
        ("Depths", &explaining.depths, PictureRole::Depths, ExplainingChange::CloseDepths),
        ("Ids", &explaining.ids, PictureRole::Ids, ExplainingChange::CloseIds),
    ];
    for (name, opened, role, close) in rows {
        ui.horizontal(|ui| {
            let Some(opened) = opened else {
                let help = format!(
                    "Open the other renderer's {} of the same drawing; they tell similar faults apart",
                    name.to_lowercase()
                );
                if ui.button(format!("{name}…")).on_hover_text(help).clicked() {
                    commands.push(Command::Dialog(DialogCommand::OpenPicture(role)));
                }
                return;
            };
            if icon_button(ui, Icon::X, &format!("Close the {}", name.to_lowercase())).clicked() {
                commands.push(Command::Explaining(close));
            }
            ui.add(Label::new(format!("{name}: {}", opened.name())).truncate());
        });
    }
}

fn ui(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    further_pictures(ui, session, commands);
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| match &session.features.explaining.found {
        None => introduction(ui, session),
        Some(found) => answer(ui, session, found, commands),
    });
}

fn introduction(ui: &mut Ui, session: &Session) {
    let text = match subject(session) {
        Some(opened) => format!(
            "“{}” should show this scene in this view. “Explain” draws the view with each known fault and finds the few \
             that turn our picture into that one.",
            opened.name()
        ),
        None => {
            "Open a picture that another renderer drew of this scene in this view, for example your own rasterizer. \
                 The program finds the faults that turn our picture into that one."
                .to_owned()
        }
    };
    ui.add(Label::new(RichText::new(text).color(tokens(ui).text_weak)).wrap());
}

fn answer(ui: &mut Ui, session: &Session, found: &Explained, commands: &mut Vec<Command>) {
    let explanation = &found.explanation;
    if !found.is_of(session) {
        chip(ui, Status::Warning, "outdated", "The view or the settings have changed since the search");
    }
    let (status, word) = match explanation.confidence {
        Confidence::Agrees => (Status::Passed, "agrees"),
        Confidence::Complete => (Status::Passed, "explained"),
        Confidence::Partial => (Status::Warning, "partly explained"),
        Confidence::Unknown => (Status::Rejected, "not explained"),
    };
    ui.horizontal_wrapped(|ui| {
        chip(ui, status, word, "How far the known faults explain the picture");
        ui.add(Label::new(RichText::new(explanation.summary()).strong()).wrap());
    });
    for cause in &explanation.causes {
        row(ui, session, cause, commands);
    }
    let percent = |count: u64| format!("{:.2} %", count as f64 * 100.0 / explanation.pixels.max(1) as f64);
    let (before, after) = (explanation.differing_before, explanation.differing_after);
    let mut text = format!("Differing pixels: {} ({})", format::count(before), percent(before));
    if !explanation.causes.is_empty() {
        text += &format!(" before, {} ({}) after", format::count(after), percent(after));
    }
    ui.add(Label::new(text).wrap());
    let reports =
        [explanation.depth.as_ref().map(ToString::to_string), explanation.ids.as_ref().map(ToString::to_string)];
    for report in reports.into_iter().flatten() {
        ui.add(Label::new(report).wrap());
    }
    for rest in &explanation.rest {
        ui.add(Label::new(RichText::new(format!("Unexplained: {rest}")).color(tokens(ui).text_weak)).wrap());
    }
    pixel(ui, session, found);
}

/// Draws a cause with what it explains.
fn row(ui: &mut Ui, session: &Session, cause: &Cause, commands: &mut Vec<Command>) {
    ui.separator();
    ui.horizontal_wrapped(|ui| {
        ui.add(Label::new(cause.fault.title()).wrap());
        if let Some(detail) = &cause.detail {
            ui.add(Label::new(RichText::new(detail).strong()));
        }
    });
    let mut text = format!("{} px agree only with it", format::count(cause.explained));
    if cause.spoiled > 0 {
        text += &format!(", {} px only without it", format::count(cause.spoiled));
    }
    text += match cause.fault.kind {
        Kind::Error => "",
        Kind::Convention => "; another convention, not an error",
        Kind::Input => "; another input, not an error in drawing",
    };
    for other in &cause.alternatives {
        text += &format!("; here the same as: {}", other.name);
    }
    ui.add(Label::new(RichText::new(text).small().color(tokens(ui).text_weak)).wrap());
    let mut recipe = session.state.recipe;
    let settings = cause.settings().filter(|settings| recipe.set_all(settings).is_ok());
    if let Some(settings) = settings {
        let help = format!("Draw our picture with this fault: {}", settings.join(", "));
        if ui.small_button("Apply settings").on_hover_text(help).clicked() {
            commands.push(Command::SetRecipe(recipe));
        }
    }
}

/// Draws the three colours of the picked pixel.
fn pixel(ui: &mut Ui, session: &Session, found: &Explained) {
    let Some((x, y)) = session.pick else { return };
    let Some(theirs) = found.theirs.get(x, y) else { return };
    ui.separator();
    ui.label(RichText::new(format!("Pixel {x}, {y}")).strong());
    let ours = session.view_of_scene().and_then(|view| view.frame.image().get(x, y));
    let faulty = found.faulty.get(x, y);
    for (name, color) in [("theirs", Some(theirs)), ("ours", ours), ("ours with the faults", faulty)] {
        if let Some([r, g, b, _]) = color {
            ui.label(RichText::new(format!("{r:3} {g:3} {b:3}  {name}")).monospace());
        }
    }
}
