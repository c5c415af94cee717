//! The stability report: a heat map of the errors of every configuration (columns) on every class of difficult cases
//! (rows), and a plot of error against time. A click on a cell of the heat map opens its worst case.

use eframe::egui::{
    self, Align2, Button, Color32, FontId, ProgressBar, Rect, RichText, Role, ScrollArea, Sense, Ui, WidgetInfo, vec2,
};
use egui_plot::{HoverPosition, MarkerShape, Plot, PlotPoints, Points};

use crate::manual::Chapter;
use crate::pipeline::settings::Choice as _;
use crate::report::stability::catalogue::Family;
use crate::report::stability::column::ReportColumn;
use crate::report::stability::metric::LEVELS;
use crate::report::stability::sweep::{ClassReport, ReportCell, StabilityReport};
use crate::report::stability::tradeoff;
use crate::ui::panels::PanelSpec;
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::long_tasks::{MeasureCommand, StabilityView};
use crate::ui::session::open_case::CaseChange;
use crate::ui::theme::{Icon, font_size, tokens};
use crate::ui::widgets::empty_state;

/// Description of the panel.
pub(crate) const PANEL: PanelSpec = PanelSpec {
    chapter: Chapter::Stability,
    grows: true,
    titled: true,
    controls: Some(|ui, cx| controls(ui, cx.session, cx.commands)),
    content: |ui, cx| self::ui(ui, cx.session, cx.commands),
};

/// Size of a cell of the heat map, in points.
const CELL: egui::Vec2 = vec2(58.0, 20.0);

/// Width of the column of class names, in points.
const NAMES: f32 = 190.0;

/// Colours of the levels of severity, from no error to all wrong. They run from dark to light, so that the scale is
/// readable without distinguishing hues.
const SEVERITY: [Color32; LEVELS + 1] = [
    Color32::from_rgb(0x1F, 0x3A, 0x4D),
    Color32::from_rgb(0x2A, 0x5A, 0x6B),
    Color32::from_rgb(0x54, 0x6E, 0x5E),
    Color32::from_rgb(0x8A, 0x7A, 0x3A),
    Color32::from_rgb(0xC0, 0x84, 0x2C),
    Color32::from_rgb(0xE8, 0xA0, 0x3C),
    Color32::from_rgb(0xFA, 0xD2, 0x7A),
];

/// First level of severity whose colour is so light that the text on it must be dark.
const LIGHT_FROM: usize = 4;

/// Error plotted in place of an error of 0, which has no position on the logarithmic axis.
const NO_ERROR: f64 = 1e-9;

/// Marker shape of each arithmetic in the plot, and its symbol in the legend.
const MARKS: [(MarkerShape, &str); 4] =
    [(MarkerShape::Circle, "●"), (MarkerShape::Diamond, "◆"), (MarkerShape::Square, "■"), (MarkerShape::Up, "▲")];

/// Draws the controls of the panel “Stability”.
pub(crate) fn controls(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    if let Some(progress) = session.features.tasks.stability.progress {
        if ui.button("Cancel").on_hover_text("Stop the report and keep the last one").clicked() {
            commands.push(Command::Measure(MeasureCommand::CancelStability));
        }
        let share = progress.done as f32 / progress.of.max(1) as f32;
        ui.add(ProgressBar::new(share).desired_width(240.0).text(progress.stage.name()));
        return;
    }
    let run = Button::new((crate::ui::theme::icon(Icon::Play), "Run the stability report"));
    let help = "Test every rasterizer, arithmetic and depth format on ill-conditioned and extreme cases; takes about \
                a minute";
    if ui.add(run).on_hover_text(help).clicked() {
        commands.push(Command::Measure(MeasureCommand::RunStability));
    }
    if session.features.tasks.stability.report.is_none() {
        return;
    }
    for (view, name, help) in [
        (StabilityView::HeatMap, "Heat map", "One row per class of cases, one column per configuration"),
        (
            StabilityView::ErrorAgainstTime,
            "Error against time",
            "One point for each combination of rasterizer and arithmetic",
        ),
    ] {
        if ui.selectable_label(session.features.tasks.stability.view == view, name).on_hover_text(help).clicked() {
            commands.push(Command::Measure(MeasureCommand::ShowStability(view)));
        }
    }
}

/// Draws the stability report.
pub(crate) fn ui(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let Some(report) = &session.features.tasks.stability.report else {
        let how = "“Run the stability report” tests the engine on slivers, needles, huge and tiny triangles, shared \
                   edges, vertices behind the camera and close depths, against exact arithmetic.";
        empty_state(ui, Icon::ShieldCheck, "No stability report yet", how);
        return;
    };
    match session.features.tasks.stability.view {
        StabilityView::HeatMap => {
            ScrollArea::both().auto_shrink(false).show(ui, |ui| {
                for family in Family::ALL {
                    let classes: Vec<_> = report.classes.iter().filter(|c| c.class.family == family).collect();
                    if !classes.is_empty() {
                        heat_map(ui, family, &classes, commands);
                    }
                }
            });
        }
        StabilityView::ErrorAgainstTime => scatter(ui, report),
    }
}

fn heat_map(ui: &mut Ui, family: Family, classes: &[&ClassReport], commands: &mut Vec<Command>) {
    let columns: Vec<ReportColumn> = classes[0].cells.iter().map(|cell| cell.column).collect();
    let width = NAMES + columns.len() as f32 * CELL.x;
    let (header, _) = ui.allocate_exact_size(vec2(width, 30.0), Sense::hover());
    let small = FontId::proportional(font_size::SMALL);
    let weak = tokens(ui).text_weak;
    let title = header.left_bottom() + vec2(0.0, -3.0);
    let strong = FontId::proportional(font_size::BODY);
    ui.painter().text(title, Align2::LEFT_BOTTOM, family.name(), strong, tokens(ui).text_strong);
    let mut arithmetic = None;
    for (index, column) in columns.iter().enumerate() {
        let left = header.left() + NAMES + index as f32 * CELL.x;
        if column.arithmetic() != arithmetic {
            arithmetic = column.arithmetic();
            let top = egui::pos2(left, header.top());
            ui.painter().text(top, Align2::LEFT_TOP, arithmetic.unwrap_or_default(), small.clone(), tokens(ui).text);
        }
        let cell = Rect::from_min_size(egui::pos2(left, header.center().y), vec2(CELL.x - 2.0, 15.0));
        let clipped = ui.painter().with_clip_rect(cell);
        clipped.text(cell.left_center(), Align2::LEFT_CENTER, short(*column), small.clone(), weak);
        ui.interact(cell, ui.scope_id().with((family.id(), index)), Sense::hover()).on_hover_text(column.label());
    }
    for class in classes {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 0.0;
            let (name, response) = ui.allocate_exact_size(vec2(NAMES, CELL.y), Sense::hover());
            let clipped = ui.painter().with_clip_rect(name);
            clipped.text(name.left_center(), Align2::LEFT_CENTER, class.class.name, small.clone(), tokens(ui).text);
            response.on_hover_text(class.class.about);
            for cell in &class.cells {
                draw_cell(ui, class, cell, commands);
            }
        });
    }
}

/// Returns a short label for a column of the heat map.
fn short(column: ReportColumn) -> &'static str {
    match column.method() {
        "bounding-box" => "box",
        "active-edge" => "edge list",
        "edge-walk" => "walk",
        "bounding-box-published" => "box (publ.)",
        "scanline-published" => "scan (publ.)",
        "reversed-infinite" => "rev. inf.",
        "reversed-f32" => "rev. f32",
        "perspective" => "persp.",
        other => other,
    }
}

fn draw_cell(ui: &mut Ui, class: &ClassReport, cell: &ReportCell, commands: &mut Vec<Command>) {
    let (rect, response) = ui.allocate_exact_size(CELL, Sense::click());
    let headline = class.class.headline;
    let value = cell.measures.get(headline);
    let level = cell.measures.severity(headline);
    let (fill, text) = match level {
        Some(level) if level >= LIGHT_FROM => (SEVERITY[level], Color32::BLACK),
        Some(level) => (SEVERITY[level], Color32::WHITE),
        None => (tokens(ui).raised, tokens(ui).text_weak),
    };
    let inner = rect.shrink(1.0);
    ui.painter().rect_filled(inner, 2.0, fill);
    let words = value.map_or_else(|| "–".to_owned(), |value| headline.format(value));
    ui.painter().text(inner.center(), Align2::CENTER_CENTER, &words, FontId::monospace(font_size::SMALL), text);
    if response.hovered() || response.has_focus() {
        ui.painter().rect_stroke(inner, 2.0, egui::Stroke::new(1.5, tokens(ui).accent), egui::StrokeKind::Inside);
    }
    let name = format!("{}, {}: {words}", class.class.name, cell.column.label());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, cell.worst.is_some(), &name));
    let worst = cell.worst.as_ref();
    if response.clicked()
        && let Some(worst) = worst
    {
        commands.push(Command::Case(CaseChange::Worst(cell.column, worst.case.to_json())));
    }
    response.on_hover_ui(|ui| {
        ui.label(
            RichText::new(format!("{} · {}: {}", class.class.name, cell.column.label(), cell.verdict.name())).strong(),
        );
        for (metric, value) in cell.measures.iter() {
            ui.label(format!("{}: {}", metric.name(), metric.format(value)));
        }
        if let Some(ns) = cell.time.and_then(|time| time.ns_per_pixel) {
            ui.label(format!("Median {:.2} ns per pixel (p10 {:.2}, p90 {:.2})", ns.median, ns.p10, ns.p90));
        }
        ui.label(RichText::new(if worst.is_some() { "Click to open the worst case" } else { "No errors" }).italics());
    });
}

/// Draws a plot of the fraction of wrong pixels against the time per pixel, over all classes of screen-space triangles.
/// The colour of a point denotes the rasterizer, and its shape the arithmetic.
fn scatter(ui: &mut Ui, report: &StabilityReport) {
    /// Width of the legend, in points.
    const KEY: f32 = 190.0;
    let points = tradeoff::coverage(report);
    let colors = tokens(ui).series;
    let words = |word: fn(ReportColumn) -> Option<&'static str>| {
        let mut all: Vec<_> = points.iter().filter_map(|point| word(point.column)).collect();
        let mut seen = std::collections::HashSet::new();
        all.retain(|word| seen.insert(*word));
        all
    };
    let (methods, arithmetics) = (words(|column| Some(column.method_name())), words(ReportColumn::arithmetic));
    let place = |list: &[&str], word: Option<&str>| list.iter().position(|known| Some(*known) == word).unwrap_or(0);
    ui.horizontal_top(|ui| {
        let plot = Plot::new("error against time")
            .width((ui.available_width() - KEY).max(200.0))
            .height(ui.available_height())
            .x_axis_label("log₁₀ of ns per pixel")
            .y_axis_label("log₁₀ of the share of wrong pixels")
            .allow_scroll(false)
            .label_formatter(|position| match position {
                HoverPosition::NearDataPoint { plot_name, position, .. } => {
                    let (ns, wrong) = (10_f64.powf(position.x), 10_f64.powf(position.y));
                    let none = wrong <= NO_ERROR * 1.01;
                    let wrong =
                        if none { "no wrong pixels".to_owned() } else { format!("{wrong:.1e} of the pixels wrong") };
                    Some(format!("{plot_name}: {ns:.2} ns per pixel, {wrong}"))
                }
                HoverPosition::Elsewhere { .. } => None,
            });
        plot.show(ui, |plot| {
            for point in &points {
                let color = colors[place(&methods, Some(point.column.method_name())) % colors.len()];
                let (shape, _) = MARKS[place(&arithmetics, point.column.arithmetic()) % MARKS.len()];
                let at = PlotPoints::from(vec![[point.ns.median.log10(), point.error.max(NO_ERROR).log10()]]);
                plot.points(Points::new(point.column.label(), at).color(color).shape(shape).radius(5.0));
            }
        });
        ScrollArea::vertical().id_salt("key").show(ui, |ui| {
            ui.vertical(|ui| {
                for (index, method) in methods.iter().enumerate() {
                    ui.label(RichText::new(*method).small().color(colors[index % colors.len()]));
                }
                for (index, arithmetic) in arithmetics.iter().enumerate() {
                    let (_, mark) = MARKS[index % MARKS.len()];
                    ui.label(RichText::new(format!("{mark} {arithmetic}")).small());
                }
                let note = "Points at 10⁻⁹ have no wrong pixels";
                ui.label(RichText::new(note).small().color(tokens(ui).text_weak));
            });
        });
    });
}
