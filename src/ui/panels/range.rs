//! The “Histogram” panel: the histogram of the whole picture in a wide plot, and the statistics of every channel.

pub(super) mod card;
pub(super) mod figures;
pub(super) mod plot;
pub(super) mod region;

use eframe::egui::{Grid, RichText, ScrollArea, Ui, vec2};

use crate::inspect::range::Rule;
use crate::inspect::statistics::Statistics;
use crate::manual::Chapter;
use crate::ui::engine::look::kind;
use crate::ui::panels::{PanelSpec, scrolling};
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::range::RangeChange;
use crate::ui::theme::{Icon, font_size, space, tokens};
use crate::ui::widgets::empty_state;
use card::histograms;
use figures::{COLUMNS, texts};
use plot::{HistogramPlot, color_of};

/// Description of the panel.
pub(crate) const PANEL: PanelSpec = PanelSpec {
    chapter: Chapter::ReadingPlots,
    grows: false,
    titled: true,
    controls: Some(|ui, cx| controls(ui, cx.session, cx.commands)),
    content: |ui, cx| self::ui(ui, cx.session, cx.commands),
};

/// Width of the table of statistics, in points; the histogram takes the rest.
const TABLE: f32 = 700.0;

/// Minimum width of the histogram beside the table, in points.
const MIN_PLOT: f32 = 240.0;

/// Height of the histogram above the table in a narrow panel, in points.
const COMPACT_PLOT_HEIGHT: f32 = 180.0;

/// Draws the content of the “Histogram” panel.
pub(crate) fn ui(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let Some((view, measured)) =
        session.view.as_ref().and_then(|view| Some((view, view.look_result.measured.as_deref()?)))
    else {
        let how = "Choose a buffer that holds quantities, such as Depth, in the bar above the picture.";
        empty_state(ui, Icon::ChartColumn, "Identifiers have no histogram", how);
        return;
    };
    let shown = view.request.shown;
    let setting = session.features.range.setting(shown);
    let color = |range, value| color_of(shown, &setting, range, value);
    let plot = HistogramPlot {
        histograms: &measured.histograms,
        channels: kind(shown).channels(),
        range: view.range,
        color: &color,
        log_counts: session.features.range.uses_log_counts(&measured.histograms),
    };
    let fixed = |range| Command::Range(RangeChange::Rule(Rule::Fixed(range)));
    let names = kind(shown).channels();
    let part = measured.part.as_ref().map(|(_, part)| part);
    if ui.available_width() < TABLE + MIN_PLOT {
        let size = vec2(ui.available_width(), COMPACT_PLOT_HEIGHT);
        commands.extend(plot.ui(ui, size).map(fixed));
        scrolling(ui, |ui| {
            compact_table(ui, "Picture", names, &measured.whole);
            if let Some(part) = part {
                compact_table(ui, "Rectangle", names, part);
            }
        });
        return;
    }
    ui.horizontal_top(|ui| {
        let size = vec2((ui.available_width() - TABLE).max(MIN_PLOT), (ui.available_height() - space::S).max(60.0));
        commands.extend(plot.ui(ui, size).map(fixed));
        ui.add_space(space::M);
        ScrollArea::both().id_salt("figures").auto_shrink(false).show(ui, |ui| {
            Grid::new("figures").num_columns(9).spacing([12.0, 4.0]).striped(true).show(ui, |ui| {
                for (name, help) in [("", ""), ("channel", "")].into_iter().chain(COLUMNS) {
                    ui.label(RichText::new(name).small().color(tokens(ui).text_weak)).on_hover_text(help);
                }
                ui.end_row();
                rows(ui, "picture", names, &measured.whole);
                if let Some(part) = part {
                    rows(ui, "rectangle", names, part);
                }
            });
        });
    });
}

/// Draws the controls of the “Histogram” panel.
pub(crate) fn controls(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let histograms = session.view.as_ref().map_or(&[][..], histograms);
    let mut log = session.features.range.uses_log_counts(histograms);
    if ui
        .checkbox(&mut log, "logarithmic counts")
        .on_hover_text("Logarithmic bars, so that rare values are visible, too")
        .changed()
    {
        commands.push(Command::Range(RangeChange::LogCounts(log)));
    }
    let mut open = session.features.range.open;
    let help = "Show the same histogram over the picture, with the range controls";
    if ui.checkbox(&mut open, "show over the picture").on_hover_text(help).changed() {
        commands.push(Command::Range(RangeChange::Open(open)));
    }
}

/// Notifies the range control when the panel appears or disappears, because statistics are computed only while it is open.
pub(crate) fn notify_open(is_open: bool, session: &Session, commands: &mut Vec<Command>) {
    if session.features.range.histogram_shown != is_open {
        commands.push(Command::Range(RangeChange::HistogramShown(is_open)));
    }
}

/// Draws the statistics in a narrow panel, with a column per channel.
fn compact_table(ui: &mut Ui, of: &str, names: &[&str], channels: &[Statistics]) {
    ui.label(RichText::new(of).strong());
    let texts: Vec<_> = channels.iter().map(texts).collect();
    Grid::new(of).num_columns(1 + names.len()).spacing([8.0, 2.0]).striped(true).show(ui, |ui| {
        ui.label("");
        for name in names {
            ui.label(RichText::new(*name).small().color(tokens(ui).text_weak));
        }
        ui.end_row();
        for (row, (name, help)) in COLUMNS.into_iter().enumerate() {
            ui.label(RichText::new(name).small().color(tokens(ui).text_weak)).on_hover_text(help);
            for channel in &texts {
                ui.label(RichText::new(&channel[row]).monospace().size(font_size::SMALL));
            }
            ui.end_row();
        }
    });
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
