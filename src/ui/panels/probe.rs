//! The panel “Probe”: settings on the left, unstable triangles on the right.

pub(crate) mod legend;

use eframe::egui::{self, Button, ProgressBar, RichText, ScrollArea, Ui};

use crate::inspect::probe::{Changed, Fragile, Heat, ProbeResult};
use crate::manual::Chapter;
use crate::pipeline::settings::Choice as _;
use crate::ui::format;
use crate::ui::panels::{PanelSpec, pick};
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::probe::ProbeChange;
use crate::ui::theme::{self, Icon, ROW_HEIGHT, tokens};
use crate::ui::widgets::{Status, chip, empty_state, figure, icon_button, integer_field, row, value_row};

/// Description of the panel.
pub(crate) const PANEL: PanelSpec = PanelSpec {
    chapter: Chapter::Stability,
    grows: true,
    titled: true,
    controls: Some(|ui, cx| controls(ui, cx.session, cx.commands)),
    content: |ui, cx| self::ui(ui, cx.session, cx.commands),
};

/// Width of the column of settings, in points.
const SETTINGS_POINTS: f32 = 270.0;

/// Width of a numeric column, in points.
const FIGURE_POINTS: f32 = 104.0;

/// Maximum values of two settings: displacement of the camera or of the vertices, in units in the last place, and
/// number of runs.
const MAX_SETTINGS: (u32, u16) = (65_536, 4096);

/// Draws the controls of the panel “Probe”.
fn controls(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let probing = &session.features.probing;
    if let Some(progress) = probing.progress {
        if ui.button("Cancel").on_hover_text("Stop the probe and keep the last result").clicked() {
            commands.push(Command::Probe(ProbeChange::Cancel));
        }
        ui.add(ProgressBar::new(progress).desired_width(200.0).show_percentage());
        return;
    }
    let help = "Draw the view repeatedly, with the camera or the vertices displaced by a few units in the last place, \
                and count the pixels that change";
    let run = Button::new((theme::icon(Icon::Play), "Run the probe"));
    if ui.add(run).on_hover_text(help).clicked() {
        commands.push(Command::Probe(ProbeChange::Start));
    }
    let Some(found) = &probing.found else { return };
    ui.separator();
    ui.label(RichText::new("Heat map").color(tokens(ui).text_weak));
    let nothing =
        ui.selectable_label(probing.heat.is_none(), "Hidden").on_hover_text("Show the picture without a heat map");
    if nothing.clicked() {
        commands.push(Command::Probe(ProbeChange::Show(None)));
    }
    for heat in Heat::ALL {
        let label = Button::selectable(probing.heat == Some(*heat), heat.name());
        let response = ui.add_enabled(found.findings.counts(*heat).is_some(), label).on_hover_text(heat.help());
        if response.on_disabled_hover_text("Not available: without a depth test, no depth is stored").clicked() {
            commands.push(Command::Probe(ProbeChange::Show(Some(*heat))));
        }
    }
}

/// Draws the content of the panel “Probe”.
fn ui(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    ui.horizontal_top(|ui| {
        ui.vertical(|ui| {
            ui.set_width(SETTINGS_POINTS);
            ScrollArea::vertical().id_salt("probe settings").auto_shrink(false).show(ui, |ui| {
                settings(ui, session, commands);
                if let Some(found) = &session.features.probing.found {
                    summary(ui, found);
                }
            });
        });
        ui.separator();
        ui.vertical(|ui| finding(ui, session, commands));
    });
}

fn settings(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let mut probe = session.features.probing.probe;
    row(ui, "Jitter target", "Input that is displaced at random in every run: the camera, or all vertices", |ui| {
        pick(ui, &mut probe.what)
    });
    let help = "Maximum displacement, in units in the last place; 1 is the smallest step of a float";
    row(ui, "Jitter, ulp", help, |ui| ui.add(integer_field(&mut probe.ulps).range(0..=MAX_SETTINGS.0).speed(0.1)));
    let help = "Number of times that the view is drawn; more runs give finer results but take longer";
    row(ui, "Runs", help, |ui| ui.add(integer_field(&mut probe.runs).range(1..=MAX_SETTINGS.1).speed(0.5)));
    row(ui, "Seed", "The same seed gives the same jitter", |ui| ui.add(integer_field(&mut probe.seed).speed(0.1)));
    if probe != session.features.probing.probe {
        commands.push(Command::Probe(ProbeChange::Set(probe)));
    }
}

fn summary(ui: &mut Ui, found: &ProbeResult) {
    let summary = found.findings.summary();
    let mut line = |name: &str, changed: Changed, help: &str| {
        let share = format::percent(changed.pixels as f64 / summary.pixels.max(1) as f64);
        value_row(ui, name, &format!("{} px  {share}", format::count(changed.pixels)), help);
    };
    line("Owner changed", summary.owner, "Pixels whose visible triangle changed in at least one run");
    if let Some(depth) = summary.depth {
        line("Depth changed", depth, "Pixels whose stored depth changed in at least one run, even by a single step");
    }
    line("Colour changed", summary.color, "Pixels whose colour changed in at least one run");
}

fn finding(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let Some(found) = &session.features.probing.found else {
        let how = "“Run the probe” repeatedly moves the camera, or every vertex, by a few units in the last place. \
                   Pixels that change were decided by rounding: z-fighting surfaces, edges through pixel centres.";
        empty_state(ui, Icon::Activity, "No probe results yet", how);
        return;
    };
    let probe = found.findings.probe;
    ui.horizontal(|ui| {
        let what = probe.what.name().to_lowercase();
        let text =
            format!("{}: {} runs, {what} moved by up to {} ulp", found.subject.scene.name, probe.runs, probe.ulps);
        ui.label(RichText::new(text).color(tokens(ui).text_weak));
        if session.view.as_ref().is_some_and(|view| !session.features.probing.is_of(view)) {
            let is_there = std::sync::Arc::ptr_eq(&found.subject.scene, &session.scene);
            let back = ui.add_enabled(is_there, Button::new("Restore the probed view"));
            let back = back.on_hover_text("The view has changed since the probe: restore the probed view");
            if back.on_disabled_hover_text("The probed scene is no longer open").clicked() {
                commands.push(Command::Probe(ProbeChange::GoBack));
            }
        }
    });
    if found.findings.ranking.is_empty() {
        chip(
            ui,
            Status::Passed,
            "No pixel shows a different triangle",
            "No triangle lost or gained a pixel in any run",
        );
        return;
    }
    header(ui);
    let rows = ScrollArea::vertical().id_salt("fragile triangles").auto_shrink(false);
    rows.show_rows(ui, ROW_HEIGHT - ui.spacing().item_spacing.y, found.findings.ranking.len(), |ui, range| {
        for fragile in &found.findings.ranking[range] {
            triangle(ui, session, found, fragile, commands);
        }
    });
}

fn header(ui: &mut Ui) {
    ui.horizontal(|ui| {
        let weak = tokens(ui).text_weak;
        for (name, help) in [
            ("Triangle", "Number of the triangle in the scene"),
            ("Changes", "Pixels that the triangle lost or gained, summed over all runs"),
            ("Worst pixel", "Lost or gained pixel that changed in the most runs"),
            ("Runs", "Number of runs in which a different triangle was visible at the worst pixel"),
        ] {
            figure(ui, name, FIGURE_POINTS, weak).on_hover_text(help);
        }
    });
}

fn triangle(ui: &mut Ui, session: &Session, found: &ProbeResult, fragile: &Fragile, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        let is_picked = session.pick == Some(fragile.worst_pixel);
        let (x, y) = fragile.worst_pixel;
        let texts = [
            fragile.triangle.0.to_string(),
            format::count(fragile.changes),
            format!("{x}, {y}"),
            format!("{} of {}", fragile.worst_changes, found.findings.probe.runs),
        ];
        let start = ui.cursor().min;
        let color = if is_picked { tokens(ui).accent } else { tokens(ui).text };
        for text in texts {
            figure(ui, &text, FIGURE_POINTS, color);
        }
        let row = egui::Rect::from_min_max(start, egui::pos2(ui.cursor().min.x, start.y + theme::CONTROL_HEIGHT));
        let name = format!("Go to the worst pixel of triangle {}", fragile.triangle.0);
        let response = ui.interact(row, ui.scope_id().with(fragile.triangle.0), egui::Sense::click());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
        if response.hovered() {
            ui.painter().rect_filled(row, theme::RADIUS, tokens(ui).text_weak.gamma_multiply(0.15));
        }
        if response.on_hover_text(name).on_hover_cursor(egui::CursorIcon::PointingHand).clicked() {
            commands.push(Command::Probe(ProbeChange::GoTo(*fragile)));
        }
        if icon_button(ui, Icon::Save, "Save this triangle as a case file").clicked() {
            commands.push(Command::Probe(ProbeChange::SaveCase(*fragile)));
        }
    });
}
