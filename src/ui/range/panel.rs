//! The “Histogram” tab: the histogram of the whole picture in a wide plot, and the statistics of every channel.

use eframe::egui::{Grid, RichText, ScrollArea, Ui, vec2};

use super::RangeChange;
use super::figures::{COLUMNS, texts};
use super::plot::HistogramPlot;
use crate::inspect::range::Rule;
use crate::inspect::statistics::Statistics;
use crate::ui::command::Command;
use crate::ui::look::kind;
use crate::ui::session::Session;
use crate::ui::theme::{Icon, space, tokens};
use crate::ui::widgets::empty_state;

/// Width of the table of statistics, in points; the histogram takes the rest.
const TABLE: f32 = 700.0;

/// Draws the content of the “Histogram” tab.
pub(crate) fn ui(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let Some((view, measured)) =
        session.view.as_ref().and_then(|view| Some((view, view.look_result.measured.as_deref()?)))
    else {
        let how = "Choose a buffer that holds quantities, such as Depth, in the bar above the picture.";
        empty_state(ui, Icon::ChartColumn, "Identifiers have no histogram", how);
        return;
    };
    let shown = view.request.shown;
    ui.horizontal_top(|ui| {
        let size = vec2((ui.available_width() - TABLE).max(240.0), (ui.available_height() - space::S).max(60.0));
        let plot = HistogramPlot { view, setting: session.range.setting(shown), log_counts: session.range.log_counts };
        let dragged = plot.ui(ui, size);
        commands.extend(dragged.map(|range| Command::Range(RangeChange::Rule(Rule::Fixed(range)))));
        ui.add_space(space::M);
        ScrollArea::both().id_salt("figures").auto_shrink(false).show(ui, |ui| {
            Grid::new("figures").num_columns(9).spacing([12.0, 4.0]).striped(true).show(ui, |ui| {
                for (name, help) in [("", ""), ("channel", "")].into_iter().chain(COLUMNS) {
                    ui.label(RichText::new(name).small().color(tokens(ui).text_weak)).on_hover_text(help);
                }
                ui.end_row();
                let names = kind(shown).channels();
                rows(ui, "picture", names, &measured.whole);
                if let Some((_, part)) = &measured.part {
                    rows(ui, "box", names, part);
                }
            });
        });
    });
}

/// Draws the controls of the “Histogram” tab, beside the tab names.
pub(crate) fn controls(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let mut log = session.range.log_counts;
    if ui
        .checkbox(&mut log, "logarithmic counts")
        .on_hover_text("Logarithmic bars, so that rare values are visible, too")
        .changed()
    {
        commands.push(Command::Range(RangeChange::LogCounts(log)));
    }
    let mut open = session.range.open;
    let help = "Show the same histogram over the picture, with the range controls";
    if ui.checkbox(&mut open, "show over the picture").on_hover_text(help).changed() {
        commands.push(Command::Range(RangeChange::Open(open)));
    }
}

/// Notifies the range control when the tab opens or closes, because statistics are computed only while it is open.
pub(crate) fn notify_open(is_open: bool, session: &Session, commands: &mut Vec<Command>) {
    if session.range.tab != is_open {
        commands.push(Command::Range(RangeChange::Tab(is_open)));
    }
}

fn rows(ui: &mut Ui, of: &str, names: &[&str], channels: &[Statistics]) {
    for (name, channel) in names.iter().zip(channels) {
        ui.label(RichText::new(of).color(tokens(ui).text_weak));
        ui.label(*name);
        for text in texts(channel) {
            ui.label(RichText::new(text).monospace());
        }
        ui.end_row();
    }
}
