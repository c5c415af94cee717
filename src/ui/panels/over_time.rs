//! Panel with the errors of the compared upscalers over time. A click on a frame shows it.

use eframe::egui::{self, Button, Grid, ProgressBar, Rect, RichText, ScrollArea, Sense, Ui, WidgetInfo, pos2, vec2};
use egui_plot::{Line, Plot, PlotPoint, PlotPoints, PlotTransform, VLine};

use crate::manual::Chapter;
use crate::measure::against::ErrorMetrics;
use crate::measure::metric::Metric;
use crate::pipeline::settings::Choice as _;
use crate::report::motion::MotionReport;
use crate::ui::method_colors::method_color;
use crate::ui::panels::PanelSpec;
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::over_time::{FRAMES, MeasuredClip, OverTimeChange};
use crate::ui::session::scene_time::SceneTimeChange;
use crate::ui::theme::{Icon, icon, tokens};
use crate::ui::widgets::{combo, empty_state};

/// Description of the panel.
pub(crate) const PANEL: PanelSpec = PanelSpec {
    chapter: Chapter::ErrorAgainstTime,
    grows: false,
    titled: true,
    controls: Some(|ui, cx| controls(ui, cx.session, cx.commands)),
    content: |ui, cx| self::ui(ui, cx.session, cx.commands),
};

/// Width of the table beside the plot, in points.
const TABLE_POINTS: f32 = 560.0;

/// Draws the controls of the panel.
fn controls(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let over_time = &session.features.over_time;
    let mut change = |change| commands.push(Command::OverTime(change));
    if let Some(progress) = over_time.progress {
        if ui.button("Cancel").on_hover_text("Stop the measurement and keep the frames so far").clicked() {
            change(OverTimeChange::Cancel);
        }
        ui.add(ProgressBar::new(progress).desired_width(200.0).show_percentage());
    } else {
        let measure = Button::new((icon(Icon::Timer), "Measure over time"));
        let help = "Draw the compared upscalers over the frames of the scene and of the camera path, and compare each frame \
                    with its reference of 16 samples per pixel. Without a comparison: the present upscaler and native";
        if ui.add(measure).on_hover_text(help).clicked() {
            change(OverTimeChange::Measure);
        }
        let mut frames = over_time.frames;
        ui.name_inputs("Number of frames", |ui| {
            combo("frames over time", &format!("{frames} frames"), 90.0).show_ui(ui, |ui| {
                for count in FRAMES {
                    ui.selectable_value(&mut frames, count, format!("{count} frames"));
                }
            })
        });
        if frames != over_time.frames {
            change(OverTimeChange::Frames(frames));
        }
    }
    let mut metric = over_time.metric;
    ui.name_inputs("Metric over time", |ui| {
        combo("metric over time", metric.name(), 120.0).show_ui(ui, |ui| {
            for option in Metric::ALL.iter().filter(|metric| ErrorMetrics::always_has(**metric)) {
                ui.selectable_value(&mut metric, *option, option.name()).on_hover_text(option.help());
            }
        })
    });
    if metric != over_time.metric {
        change(OverTimeChange::Metric(metric));
    }
    if let Some(clip) = &over_time.found {
        ui.add(egui::Label::new(RichText::new(summary(session, clip)).color(tokens(ui).text_weak)).truncate());
    }
}

/// Describes a result in one line.
fn summary(session: &Session, clip: &MeasuredClip) -> String {
    if !session.is_measured_now(clip) {
        return "Measured with a different scene, view, size, comparison or setting; measure again to update"
            .to_owned();
    }
    let [width, height] = clip.report.size_px;
    let partial = if clip.report.partial { ", cancelled" } else { "" };
    format!("{} frames of {width} × {height} px{partial} · Click a frame to show it", clip.report.frames)
}

/// Draws the plot and the table.
fn ui(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let Some(clip) = &session.features.over_time.found else {
        // Takes all of the available height, so that the canvas keeps its size.
        ui.set_min_height(ui.available_height());
        let how = "“Measure over time” draws the compared upscalers over the frames of a scene in motion or of a camera path.";
        empty_state(ui, Icon::ChartLine, "No measurement yet", how);
        return;
    };
    ui.horizontal_top(|ui| {
        let size = vec2((ui.available_width() - TABLE_POINTS - 16.0).max(220.0), ui.available_height());
        ui.vertical(|ui| plot(ui, session, &clip.report, size, commands));
        ScrollArea::both().id_salt("table over time").show(ui, |ui| table(ui, &clip.report));
    });
}

/// Draws the curves, and makes each frame a button.
fn plot(ui: &mut Ui, session: &Session, report: &MotionReport, size: egui::Vec2, commands: &mut Vec<Command>) {
    let metric = session.features.over_time.metric;
    let colors: Vec<_> = report.methods.iter().map(|method| method_color(ui, method.upscaler)).collect();
    let marker = tokens(ui).accent;
    let shown = session.scene_frame();
    let response = Plot::new("errors over time")
        .width(size.x)
        .height(size.y)
        .x_axis_label("Frame")
        .y_axis_label(metric.name())
        .include_x(0.0)
        .include_x(f64::from(report.frames) - 1.0)
        .allow_scroll(false)
        .allow_drag(false)
        .allow_zoom(false)
        .label_formatter(|_| None)
        .show(ui, |plot| {
            if (0..i64::from(report.frames)).contains(&shown) {
                plot.vline(VLine::new("shown frame", shown as f64).color(marker).width(1.0));
            }
            for (method, color) in report.methods.iter().zip(&colors) {
                let points = method.errors.iter().zip(0_u32..);
                let points = points.map(|(error, frame)| [f64::from(frame), error.value(metric)]);
                // Identical pictures have an infinite PSNR.
                let points: Vec<_> = points.filter(|[_, value]| value.is_finite()).collect();
                plot.line(Line::new(method.label.clone(), PlotPoints::from(points)).color(*color).width(1.5));
            }
        });
    if let Some(frame) = clicked_frame(ui, &response.transform, report, metric) {
        commands.push(Command::SceneTime(SceneTimeChange::Go(frame.into())));
    }
}

/// Makes each frame a button over its part of the plot. Returns the frame that was clicked.
fn clicked_frame(ui: &Ui, transform: &PlotTransform, report: &MotionReport, metric: Metric) -> Option<u32> {
    let x = |frame: f64| transform.position_from_point(&PlotPoint::new(frame, 0.0)).x;
    let plot = *transform.frame();
    let mut clicked = None;
    for frame in 0..report.frames {
        let [left, right] = [-0.5, 0.5].map(|offset| x(f64::from(frame) + offset));
        let column = Rect::from_min_max(pos2(left, plot.top()), pos2(right, plot.bottom())).intersect(plot);
        let node = ui.interact(column, ui.scope_id().with(("frame", frame)), Sense::click());
        node.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, format!("Show frame {frame}")));
        if node.hovered() {
            ui.painter().rect_filled(column, 0.0, tokens(ui).text_weak.gamma_multiply(0.15));
        }
        clicked = clicked.or(node.clicked().then_some(frame));
        node.on_hover_ui(|ui| values(ui, report, metric, frame));
    }
    clicked
}

/// Draws the values of all methods in a frame.
fn values(ui: &mut Ui, report: &MotionReport, metric: Metric, frame: u32) {
    ui.strong(format!("Frame {frame}"));
    for method in &report.methods {
        if let Some(error) = method.errors.get(frame as usize) {
            let words = format!("{}: {}", method.label, metric.format(error.value(metric)));
            ui.label(RichText::new(words).color(method_color(ui, method.upscaler)));
        }
    }
}

/// Draws the times and errors of all methods over the clip, as the command `motion` prints them.
fn table(ui: &mut Ui, report: &MotionReport) {
    Grid::new("over time").num_columns(MotionReport::HEADS.len()).striped(true).spacing([10.0, 3.0]).show(ui, |ui| {
        for head in MotionReport::HEADS {
            ui.label(RichText::new(head).small().color(tokens(ui).text_weak));
        }
        ui.end_row();
        for (method, row) in report.methods.iter().zip(report.rows()) {
            for (column, cell) in row.into_iter().enumerate() {
                let color = if column == 0 { method_color(ui, method.upscaler) } else { tokens(ui).text };
                ui.label(RichText::new(cell).color(color));
            }
            ui.end_row();
        }
    });
}
