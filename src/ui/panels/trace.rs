//! The “Calculation” panel: buttons for stepping, the current line of the trace in full, and the table of all lines.

mod table;

use eframe::egui::style::ScrollAnimation;
use eframe::egui::{self, Align, Color32, Layout, Rect, RichText, ScrollArea, TextEdit, Ui, vec2};

use crate::inspect::trace::{Notable, StepDirection, Trace, TraceLine};
use crate::manual::Chapter;
use crate::pipeline::settings::Choice as _;
use crate::ui::panels::{PanelSpec, framed};
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::trace::{TraceChange, TraceView};
use crate::ui::theme::{Icon, font_size, space, tokens};
use crate::ui::widgets::{combo, copy_button, empty_state, icon_button};
use table::{ROW, TraceColumns, TraceTable, explain};

/// Description of the panel.
pub(crate) const PANEL: PanelSpec = PanelSpec {
    chapter: Chapter::InspectingAPixel,
    grows: false,
    titled: true,
    controls: None,
    content: |ui, cx| framed(ui, |ui| self::ui(ui, cx.session, cx.commands)),
};

/// Draws the buttons for stepping through the trace, the filter field, and the copy button.
fn controls(ui: &mut Ui, trace: &Trace, session: &Session, commands: &mut Vec<Command>) {
    let mut push = |change| commands.push(Command::Trace(change));
    for (icon, name, change) in [
        (Icon::ChevronFirst, "Go to the previous stage  (Shift+F11)", TraceChange::Stage(StepDirection::Back)),
        (Icon::StepBack, "Go to the previous line  (Shift+F10)", TraceChange::Step(-1)),
        (Icon::StepForward, "Go to the next line  (F10)", TraceChange::Step(1)),
        (Icon::ChevronLast, "Go to the next stage  (F11)", TraceChange::Stage(StepDirection::Forward)),
    ] {
        if icon_button(ui, icon, name).clicked() {
            push(change);
        }
    }
    for (kind, word) in [
        (None, "Next flagged line"),
        (Some(Notable::NotFinite), "NaN"),
        (Some(Notable::Tie), "Tie"),
        (Some(Notable::DepthEqual), "Equal depth"),
        (Some(Notable::Cancellation), "Cancellation"),
    ] {
        let place = trace.next(session.features.trace.line, kind, StepDirection::Forward);
        let help = kind.map_or("Go to the next line with any flag  (F5; previous: Shift+F5)", Notable::help);
        let button = egui::Button::new(word);
        let response = ui.add_enabled(place.is_some(), button).on_hover_text(help);
        if response.on_disabled_hover_text("No later line has this flag").clicked() {
            push(TraceChange::Run(kind, StepDirection::Forward));
        }
    }
    fragments(ui, trace, &mut push);
    let mut filter = session.features.trace.filter.clone();
    let field = TextEdit::singleline(&mut filter).hint_text("Filter").desired_width(90.0);
    if ui.add(field).on_hover_text("List only lines whose name, formula, stage or flag contains this text").changed() {
        push(TraceChange::Filter(filter));
    }
    copy_button(ui, "the trace as text", || trace.to_string());
}

fn fragments(ui: &mut Ui, trace: &Trace, push: &mut impl FnMut(TraceChange)) {
    let Some(now) = trace.fragment.filter(|_| trace.fragments > 1) else { return };
    let name = |index: usize| format!("Fragment {} of {}", index + 1, trace.fragments);
    let mut chosen = now;
    combo("traced fragment", &name(now), 118.0)
        .show_ui(ui, |ui| {
            for index in 0..trace.fragments {
                ui.selectable_value(&mut chosen, index, name(index));
            }
        })
        .response
        .on_hover_text("Fragment to trace; fragments are numbered in drawing order");
    if chosen != now {
        push(TraceChange::Fragment(chosen));
    }
}

/// Draws the content of the “Calculation” panel.
pub(crate) fn ui(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    if !is_picked(session) {
        let how = "Click a pixel of the picture to list every step of its calculation, with the rounding errors.";
        empty_state(ui, Icon::ScanSearch, "No pixel picked", how);
        return;
    }
    if session.features.trace.trace(session.view.as_ref()).is_none() {
        commands.push(Command::Trace(TraceChange::Renew));
        ui.request_repaint();
    }
    let Some(trace) = session.features.trace.latest() else { return };
    let columns = TraceColumns::of(ui.available_width());
    if columns.is_compact() {
        ui.horizontal_wrapped(|ui| controls(ui, trace, session, commands));
        compact_line(ui, trace, &session.features.trace);
    } else {
        ui.horizontal(|ui| {
            controls(ui, trace, session, commands);
            ui.add_space(space::S);
            current_line(ui, trace, &session.features.trace);
        });
        current_formula(ui, trace, &session.features.trace);
    }
    let listed = listed(trace, &session.features.trace.filter);
    let table = TraceTable { trace, view: &session.features.trace, columns, shown: session.shown };
    table.headings(ui);
    let stepped_to = row_after_step(ui, &session.features.trace, &listed);
    ui.spacing_mut().item_spacing.y = 0.0;
    ScrollArea::vertical().auto_shrink(false).id_salt("trace").show_rows(ui, ROW, listed.len(), |ui, rows| {
        if let Some(row) = stepped_to {
            let below = (row as f32 - rows.start as f32) * ROW;
            let place = Rect::from_min_size(ui.max_rect().min + vec2(0.0, below), vec2(1.0, ROW));
            ui.scroll_to_rect_animation(place, Some(Align::Center), ScrollAnimation::none());
        }
        for row in rows {
            table.row(ui, listed[row], commands);
        }
    });
}

fn is_picked(session: &Session) -> bool {
    session.view.as_ref().is_some_and(|view| view.report.is_some())
}

/// Returns the indices of the lines that match the filter.
fn listed(trace: &Trace, filter: &str) -> Vec<usize> {
    let wanted = filter.trim().to_lowercase();
    let has = |text: &str| text.to_lowercase().contains(&wanted);
    let is_listed = |line: &TraceLine| {
        wanted.is_empty()
            || has(&line.what)
            || has(&line.formula)
            || has(line.stage.name())
            || line.flags.iter().any(|flag| has(flag.kind.name()))
    };
    (0..trace.lines.len()).filter(|place| is_listed(&trace.lines[*place])).collect()
}

/// If a step was made since the last pass, returns the row of the current line, so that the caller can centre it.
fn row_after_step(ui: &Ui, table: &TraceView, listed: &[usize]) -> Option<usize> {
    let id = egui::Id::unique("steps of the trace");
    let seen: u64 = ui.data(|data| data.get_temp(id)).unwrap_or(0);
    ui.data_mut(|data| data.insert_temp(id, table.steps));
    listed.iter().position(|place| *place == table.line).filter(|_| seen != table.steps)
}

/// Draws the current line of the trace as text: its number, stage, quantity, computed value and exact value.
fn current_line(ui: &mut Ui, trace: &Trace, table: &TraceView) {
    let Some(line) = trace.lines.get(table.line) else { return };
    let place = format!("{} of {}", table.line + 1, trace.lines.len());
    let of = if line.aside { " (not computed by the pipeline)" } else { "" };
    let exact = line.exact.as_ref().map_or_else(String::new, |exact| {
        let fraction = exact.fraction.as_ref().map_or_else(String::new, |fraction| format!(" = {fraction}"));
        format!("   exactly {}{fraction}", exact.decimal)
    });
    let text = format!("{place}   {}: {}{of} = {}{exact}", line.stage.name(), line.what, line.value_text());
    line_of_text(ui, text, tokens(ui).text_strong);
}

/// Draws the formula of the current line, followed by the formula with its numbers substituted.
fn current_formula(ui: &mut Ui, trace: &Trace, table: &TraceView) {
    let Some(line) = trace.lines.get(table.line) else { return };
    let numbers = if line.numbers.is_empty() { String::new() } else { format!(" = {}", line.numbers) };
    line_of_text(ui, format!("{}{numbers}", line.formula), tokens(ui).text);
    ui.add_space(2.0);
}

/// Draws all details of the current line in several rows, because a compact table shows only its value. The area has a
/// fixed height, so that stepping does not move the table.
fn compact_line(ui: &mut Ui, trace: &Trace, table: &TraceView) {
    /// Height of the details, in points.
    const HEIGHT: f32 = 150.0;
    let Some(line) = trace.lines.get(table.line) else { return };
    let size = vec2(ui.available_width(), HEIGHT);
    ui.allocate_ui_with_layout(size, Layout::top_down(Align::Min), |ui| {
        ui.set_min_height(HEIGHT);
        ScrollArea::vertical().id_salt("line").auto_shrink(false).show(ui, |ui| {
            let place = format!("{} of {} · {}", table.line + 1, trace.lines.len(), line.stage.name());
            ui.label(RichText::new(place).size(font_size::SMALL).color(tokens(ui).text_weak));
            explain(ui, line, table.is_changed(table.line));
        });
    });
    ui.separator();
}

fn line_of_text(ui: &mut Ui, text: String, color: Color32) {
    let text = RichText::new(text).monospace().size(font_size::SMALL).color(color);
    ui.add(egui::Label::new(text).truncate());
}
