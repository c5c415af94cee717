//! Four log-log plots of frame time against triangles, pixels, overlapping layers and threads.

use eframe::egui::{Button, ProgressBar, RichText, Ui, vec2};
use egui_plot::{GridMark, Line, LineStyle, Plot, PlotPoints, Points};

use crate::manual::Chapter;
use crate::measure::scaling::Series;
use crate::report::scaling::{amount, finding, guide};
use crate::ui::panels::PanelSpec;
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::long_tasks::MeasureCommand;
use crate::ui::theme::{Icon, tokens};
use crate::ui::ticks::log_marks;
use crate::ui::widgets::empty_state;

/// Description of the panel.
pub(crate) const PANEL: PanelSpec = PanelSpec {
    chapter: Chapter::ErrorAgainstTime,
    grows: true,
    titled: true,
    controls: Some(|ui, cx| controls(ui, cx.session, cx.commands)),
    content: |ui, cx| self::ui(ui, cx.session),
};

/// Height reserved for the three lines of text below a plot, in points.
const WORDS: f32 = 50.0;

/// Draws the controls of the panel “Scaling”.
pub(crate) fn controls(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    if let Some((quantity, share)) = session.features.tasks.scaling.progress {
        if ui.button("Cancel").on_hover_text("Stop the measurement and keep the last result").clicked() {
            commands.push(Command::Measure(MeasureCommand::CancelScaling));
        }
        ui.add(ProgressBar::new(share).desired_width(240.0).text(quantity.name()));
        return;
    }
    let measure = Button::new((crate::ui::theme::icon(Icon::Timer), "Measure scaling"));
    let help = "Draw generated scenes with increasing numbers of triangles, pixels, layers and threads, with the \
                current settings; takes about a minute";
    if ui.add(measure).on_hover_text(help).clicked() {
        commands.push(Command::Measure(MeasureCommand::MeasureScaling));
    }
    if let Some((scaling, recipe)) = &session.features.tasks.scaling.found {
        let [width, height] = scaling.size;
        let by = if *recipe == session.state.recipe { "" } else { ", measured with other settings" };
        let text =
            format!("{width} × {height} px, {} threads, medians of {} rounds{by}", scaling.threads, scaling.rounds);
        ui.label(RichText::new(text).color(tokens(ui).text_weak));
    }
}

/// Draws the four plots of the scaling measurement.
pub(crate) fn ui(ui: &mut Ui, session: &Session) {
    let Some((scaling, _)) = &session.features.tasks.scaling.found else {
        let how = "“Measure scaling” shows the fixed cost of a frame, the cost of each triangle, pixel and layer, and \
                   the speed-up from threads.";
        empty_state(ui, Icon::ChartScatter, "No measurement yet", how);
        return;
    };
    let count = scaling.series.len().max(1) as f32;
    let spacing = ui.spacing().item_spacing.x;
    let size = vec2((ui.available_width() - spacing * (count - 1.0)) / count, ui.available_height() - WORDS);
    ui.horizontal_top(|ui| {
        for series in &scaling.series {
            ui.vertical(|ui| {
                ui.set_width(size.x);
                plot(ui, series, size);
                if let Some(finding) = finding(series) {
                    ui.label(RichText::new(finding).small().color(tokens(ui).text_weak));
                }
            });
        }
    });
}

fn plot(ui: &mut Ui, series: &Series, size: eframe::egui::Vec2) {
    let color = tokens(ui).series[0];
    let at = |value: f64, ms: f64| [value.log10(), ms.max(f64::MIN_POSITIVE).log10()];
    let points: Vec<[f64; 2]> = series.points.iter().map(|point| at(point.value, point.ms.median)).collect();
    let number = |mark: GridMark, _: &_| amount(10_f64.powf(mark.value));
    let guide: Vec<[f64; 2]> = guide(series).into_iter().map(|(value, ms)| at(value, ms)).collect();
    let weak = tokens(ui).text_weak;
    Plot::new(series.quantity.name())
        .width(size.x)
        .height(size.y)
        .x_axis_label(series.quantity.name())
        .y_axis_label("Median frame time (ms)")
        .allow_scroll(false)
        .allow_drag(false)
        .allow_zoom(false)
        .x_grid_spacer(|input| log_marks(&input))
        .y_grid_spacer(|input| log_marks(&input))
        .x_axis_formatter(number)
        .y_axis_formatter(number)
        .show(ui, |plot| {
            plot.line(Line::new("guide", PlotPoints::from(guide.clone())).color(weak).style(LineStyle::dashed_dense()));
            plot.line(Line::new("median", PlotPoints::from(points.clone())).color(color).width(1.5));
            plot.points(Points::new("median", PlotPoints::from(points.clone())).color(color).radius(3.5));
        });
}
