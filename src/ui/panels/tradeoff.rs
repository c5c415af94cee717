//! Error against time of every upscaler on the present scene: one point each. A click makes it picture A or B of the
//! comparison.

use eframe::egui::{self, Button, Color32, Grid, ProgressBar, RichText, ScrollArea, Ui};
use egui_plot::{GridMark, HoverPosition, Line, Plot, PlotPoint, PlotPoints, PlotUi, Points};

use crate::chain::Recipe;
use crate::pipeline::settings::Choice as _;
use crate::ui::command::Command;
use crate::ui::compare::bar::reference_list;
use crate::ui::compare::{Change, Mode};
use crate::ui::format;
use crate::ui::session::Session;
use crate::ui::theme::{Icon, tokens};
use crate::ui::ticks::log_marks;
use crate::ui::timings::TradeOff;
use crate::ui::widgets::{empty_state, figure};
use crate::upscale::{self, Upscaling};

/// Width of the table, in points.
const TABLE_POINTS: f32 = 520.0;

/// Width of a column of the table, in points.
const FIGURE_POINTS: f32 = 62.0;

/// A click this near to a point means it, in points.
const NEAR_POINTS: f32 = 12.0;

/// Powers of ten that the lane of pictures without error lies below the least error.
const LANE: f64 = 0.4;

/// Draws the buttons beside the tabs.
pub fn controls(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    if let Some(measuring) = session.measuring {
        if ui.button("Cancel").on_hover_text("Stop; what was measured stays").clicked() {
            commands.push(Command::CancelMeasure);
        }
        ui.add(ProgressBar::new(measuring.progress).desired_width(200.0).show_percentage());
    } else {
        let measure = Button::new((crate::ui::theme::icon(Icon::Timer), "Measure error and time"));
        let help = "Draws every upscaler in interleaved rounds, those that read the frame before while the view turns a little, and \
                    measures its picture against the reference; takes some seconds";
        if ui.add(measure).on_hover_text(help).clicked() {
            commands.push(Command::Measure);
        }
        let chosen = reference_list(ui, "Measure against", 150.0, session.comparison.reference);
        commands.extend(chosen.map(Command::Compare));
    }
    let viewport = session.viewport();
    let fits = session.timings.measurement_fits(&session.request());
    let text = match (session.timings.measured_against(), fits) {
        (None, _) => "Click a point: it becomes B; with Shift it becomes A".to_owned(),
        (Some(reference), true) => format!(
            "Errors are against: {} · {} · {} × {} px · click a point: B; Shift: A",
            reference.name(),
            session.scene.name,
            viewport.width,
            viewport.height
        ),
        (Some(_), false) => "Measured on another scene, view, size or setting than the one on screen".to_owned(),
    };
    ui.add(egui::Label::new(RichText::new(text).color(tokens(ui).text_weak)).truncate());
}

/// Draws plot and table.
pub fn ui(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let points = session.timings.tradeoff();
    if points.is_empty() {
        // The tab stays as high as it is: the picture, whose size may be that of the canvas, is not to change.
        ui.set_min_height(ui.available_height());
        empty_state(
            ui,
            Icon::ChartScatter,
            "No error was measured yet",
            "“Measure error and time” draws every upscaler on the present scene, view and size.",
        );
        return;
    }
    ui.horizontal_top(|ui| {
        let width = (ui.available_width() - TABLE_POINTS - 16.0).max(220.0);
        let size = egui::vec2(width, ui.available_height());
        if let Some(upscaling) = plot(ui, &points, size) {
            let tile = usize::from(!ui.input(|i| i.modifiers.shift));
            choose(session, tile, upscaling, commands);
        }
        ScrollArea::both().id_salt("tradeoff table").show(ui, |ui| table(ui, &points, session, commands));
    });
}

/// Makes an upscaler A (0) or B (1).
fn choose(session: &Session, tile: usize, upscaling: Upscaling, commands: &mut Vec<Command>) {
    let recipe = session.state.tiles.recipe(tile, session.state.recipe);
    let recipe = Recipe { upscaler: upscaling, ..recipe };
    commands.push(Command::Compare(Change::Recipe(tile, Box::new(recipe))));
    if !session.comparison.is_on() {
        commands.push(Command::Compare(Change::Mode(Mode::Wipe)));
    }
}

/// The colour of a method.
fn color(ui: &Ui, upscaling: Upscaling) -> Color32 {
    let colors = tokens(ui).series;
    let place = upscale::ALL.iter().position(|upscaler| upscaler.id() == upscaling.method());
    colors[place.unwrap_or(0) % colors.len()]
}

/// Where a point stands: logarithms of both, and pictures without error in a lane below.
fn place(point: &TradeOff, lane: f64) -> [f64; 2] {
    let error = point.error.flip;
    [point.ms.median.max(f64::MIN_POSITIVE).log10(), if error > 0.0 { error.log10() } else { lane }]
}

/// Draws all points; the one that was clicked.
fn plot(ui: &mut Ui, points: &[TradeOff], size: egui::Vec2) -> Option<Upscaling> {
    let least = points.iter().map(|point| point.error.flip).filter(|error| *error > 0.0).fold(1.0, f64::min);
    let lane = least.log10() - LANE;
    let weak = tokens(ui).border;
    let colors: Vec<Color32> = points.iter().map(|point| color(ui, point.upscaling)).collect();
    let front_color = tokens(ui).text_weak;
    let number =
        |value: f64| format!("{:.2}", 10_f64.powf(value)).trim_end_matches('0').trim_end_matches('.').to_owned();
    let response = Plot::new("error against time of upscalers")
        .width(size.x)
        .height(size.y)
        .x_axis_label("median ms")
        .y_axis_label("FLIP")
        .allow_scroll(false)
        .x_grid_spacer(|input| log_marks(&input))
        .y_grid_spacer(move |input| {
            let mut marks = log_marks(&input);
            marks.retain(|mark| mark.value > lane + LANE / 2.0);
            marks.push(GridMark { value: lane, step_size: 1.0 });
            marks
        })
        .x_axis_formatter(move |mark: GridMark, _| number(mark.value))
        .y_axis_formatter(move |mark: GridMark, _| {
            if mark.value <= lane + 1e-9 { "0".to_owned() } else { format!("{:.3}", 10_f64.powf(mark.value)) }
        })
        .label_formatter(move |position| match position {
            HoverPosition::NearDataPoint { plot_name, position, .. } => {
                let error = if position.y <= lane + 1e-9 { 0.0 } else { 10_f64.powf(position.y) };
                Some(format!("{plot_name}: {}, FLIP {error:.4}", format::ms(10_f64.powf(position.x))))
            }
            HoverPosition::Elsewhere { .. } => None,
        })
        .show(ui, |plot| {
            for step in front(points, lane) {
                plot.line(step.color(front_color).width(1.0));
            }
            for (point, color) in points.iter().zip(&colors) {
                draw(plot, point, lane, if point.dominated_by.is_some() { weak } else { *color });
            }
        });
    name_points(ui, points, |point| {
        let [x, y] = place(point, lane);
        response.transform.position_from_point(&PlotPoint::new(x, y))
    });
    let clicked = response.response.clicked().then(|| response.response.interact_pointer_pos()).flatten()?;
    let distance = |point: &TradeOff| {
        let [x, y] = place(point, lane);
        response.transform.position_from_point(&PlotPoint::new(x, y)).distance(clicked)
    };
    let nearest = points.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
    (distance(nearest) <= NEAR_POINTS).then_some(nearest.upscaling)
}

/// Tells those who cannot see the plot what stands where.
fn name_points(ui: &Ui, points: &[TradeOff], position: impl Fn(&TradeOff) -> egui::Pos2) {
    for point in points {
        let rect = egui::Rect::from_center_size(position(point), egui::Vec2::splat(NEAR_POINTS));
        let label = point.upscaling.label();
        let node = ui.interact(rect, ui.scope_id().with(&label), egui::Sense::hover());
        let words =
            format!("Point: {label}, {}, FLIP {}", format::ms(point.ms.median), format::fixed(point.error.flip, 4));
        node.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, &words));
    }
}

/// The staircase of those that nobody beats, step by step: a single line would be filled where it turns.
fn front(points: &[TradeOff], lane: f64) -> Vec<Line<'static>> {
    let mut best: Vec<_> = points.iter().filter(|point| point.dominated_by.is_none()).map(|p| place(p, lane)).collect();
    best.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut corners: Vec<[f64; 2]> = Vec::new();
    for point in best {
        if let Some(last) = corners.last() {
            corners.push([point[0], last[1]]);
        }
        corners.push(point);
    }
    let steps = corners.windows(2);
    steps.map(|step| Line::new("beaten by nobody", PlotPoints::from(step.to_vec())).allow_hover(false)).collect()
}

fn draw(plot: &mut PlotUi<'_>, point: &TradeOff, lane: f64, color: Color32) {
    let at = place(point, lane);
    let bar = vec![[point.ms.p10.log10(), at[1]], [point.ms.p90.log10(), at[1]]];
    let name = point.upscaling.label();
    plot.line(Line::new(name.clone(), PlotPoints::from(bar)).color(color.gamma_multiply(0.6)).allow_hover(false));
    plot.points(Points::new(name, PlotPoints::from(vec![at])).color(color).radius(5.0));
}

fn table(ui: &mut Ui, points: &[TradeOff], session: &Session, commands: &mut Vec<Command>) {
    let mut order: Vec<_> = points.iter().collect();
    order.sort_by(|a, b| a.error.flip.total_cmp(&b.error.flip));
    let shown = |tile: usize| {
        let recipe = session.state.tiles.recipe(tile, session.state.recipe);
        session.comparison.is_on().then_some(recipe.upscaler)
    };
    Grid::new("tradeoff").num_columns(7).striped(true).spacing([10.0, 3.0]).show(ui, |ui| {
        ui.label("");
        ui.label(RichText::new("Upscaler").small().color(tokens(ui).text_weak));
        for heading in ["ms", "FLIP", "PSNR dB", "SSIM"] {
            figure(ui, heading, FIGURE_POINTS, tokens(ui).text_weak);
        }
        ui.end_row();
        for point in order {
            let label = point.upscaling.label();
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = 2.0;
                for (tile, name, color) in [(0, "A", tokens(ui).a), (1, "B", tokens(ui).b)] {
                    let is_shown = shown(tile) == Some(point.upscaling);
                    let button = ui.selectable_label(is_shown, RichText::new(name).small().color(color));
                    let words = format!("Show {label} as {name}");
                    button.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, is_shown, &words));
                    if button.on_hover_text(&words).clicked() {
                        choose(session, tile, point.upscaling, commands);
                    }
                }
            });
            let beaten = point.dominated_by;
            let strength = if beaten.is_some() { tokens(ui).text_weak } else { tokens(ui).text };
            let dot = if beaten.is_some() { tokens(ui).border } else { color(ui, point.upscaling) };
            ui.horizontal(|ui| {
                let (mark, _) = ui.allocate_exact_size(egui::vec2(10.0, 10.0), egui::Sense::hover());
                ui.painter().circle_filled(mark.center(), 4.0, dot);
                let by = beaten
                    .map_or_else(|| "Nobody beats it in both".to_owned(), |by| format!("Beaten by {}", by.label()));
                ui.label(RichText::new(&label).color(strength)).on_hover_text(by);
            });
            let psnr = if point.error.codes.mse == 0.0 {
                "same".to_owned()
            } else {
                format::fixed(point.error.codes.psnr_db, 2)
            };
            let (flip, ssim) = (format::fixed(point.error.flip, 4), format::fixed(point.error.codes.ssim, 4));
            for text in [format::fixed(point.ms.median, 2), flip, psnr, ssim] {
                figure(ui, &text, FIGURE_POINTS, strength);
            }
            ui.end_row();
        }
    });
}
