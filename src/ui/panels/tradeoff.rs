//! Plot of error against time with one point for every upscaler, measured on the current scene. A click on a point uses
//! the upscaler for picture A or B of the comparison.

mod labels;

mod table;

use eframe::egui::{
    self, Button, Color32, FontId, Pos2, ProgressBar, Rect, RichText, ScrollArea, Sense, Stroke, Ui, pos2,
};
use egui_plot::{GridMark, HoverPosition, Line, Plot, PlotPoint, PlotPoints, PlotTransform, PlotUi, Points};

use super::budget_line;
use crate::chain::Recipe;
use crate::manual::Chapter;
use crate::measure::metric::Metric;
use crate::measure::motion::Turn;
use crate::pipeline::settings::Choice as _;
use crate::report::upscaling::tradeoff::Standing;
use crate::ui::format;
use crate::ui::method_colors::method_color;
use crate::ui::panels::PanelSpec;
use crate::ui::panels::compare::bar::reference_list;
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::compare::{CompareChange, Mode};
use crate::ui::session::long_tasks::MeasureCommand;
use crate::ui::session::timings::{TimingsChange, TradeOff};
use crate::ui::session::workspace::Panel;
use crate::ui::theme::{Icon, font_size, tokens};
use crate::ui::ticks::log_marks;
use crate::ui::widgets::{combo, empty_state};
use crate::upscale::Upscaling;

/// Description of the panel.
pub(crate) const PANEL: PanelSpec = PanelSpec {
    chapter: Chapter::ErrorAgainstTime,
    grows: true,
    titled: true,
    controls: Some(|ui, cx| controls(ui, cx.session, cx.commands)),
    content: |ui, cx| self::ui(ui, cx.session, cx.commands),
};

/// Width of the table of errors and times, in points.
const TABLE_POINTS: f32 = 690.0;

/// Radius around a point within which a click selects it, in points.
const NEAR_POINTS: f32 = 12.0;

/// Radius of the ring around the point of the method under the pointer, in points.
const RING: f32 = 8.0;

/// Distance from the smallest nonzero error down to the line on which an error of 0 is plotted, in powers of ten. A
/// logarithmic axis has no position for 0.
const LANE: f64 = 0.4;

/// Plotted point with its position on the screen.
struct PlacedPoint<'a> {
    point: &'a TradeOff,
    at: Pos2,
}

/// Draws the controls of the panel “Error vs time”.
pub(crate) fn controls(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    if let Some(measuring) = session.features.tasks.measuring {
        if ui.button("Cancel").on_hover_text("Stop the measurement and keep the results so far").clicked() {
            commands.push(Command::Measure(MeasureCommand::CancelUpscalers));
        }
        ui.add(ProgressBar::new(measuring.progress).desired_width(200.0).show_percentage());
    } else {
        let measure = Button::new((crate::ui::theme::icon(Icon::Timer), "Measure error and time"));
        let help = "Time every upscaler in interleaved rounds, and compare each frame with the reference for the \
                    same camera. Takes a minute or more in motion, and a few seconds for a still view";
        if ui.add(measure).on_hover_text(help).clicked() {
            commands.push(Command::Measure(MeasureCommand::MeasureUpscalers));
        }
        let chosen = reference_list(ui, "Reference to measure against", 150.0, session.features.comparison.reference);
        commands.extend(chosen.map(Command::Compare));
        motion_switch(ui, session.features.timings.turn, commands);
    }
    commands.extend(metric_list(ui, session.features.timings.metric).map(Command::Timings));
    let viewport = session.viewport();
    let fits = session.features.timings.measurement_fits(&session.request());
    let text = match (session.features.timings.measurement_request(), fits) {
        (Some(_), true) if session.features.timings.metric_in_use() != session.features.timings.metric => format!(
            "{} is not in this measurement, FLIP is shown; measure again to add it",
            session.features.timings.metric.name()
        ),
        (None, _) => "Click a point to show it as picture B, Shift+click to show it as A".to_owned(),
        (Some(measured), true) => format!(
            "Reference: {} · {} · {} × {} px · {}{} · Click a point: show as B, Shift+click: as A",
            measured.reference.name(),
            session.scene.name,
            viewport.width,
            viewport.height,
            motion(session, measured.turn),
            session.features.timings.noise().map_or(
                " · times of single frames, not ranked yet".to_owned(),
                |noise| format!(" · noise floor {}", noise.words())
            )
        ),
        (Some(_), false) => {
            "Measured with a different scene, view, size or setting; measure again to update".to_owned()
        }
    };
    ui.add(egui::Label::new(RichText::new(text).color(tokens(ui).text_weak)).truncate());
}

/// Draws the list of metrics. Returns the change if another one is chosen.
fn metric_list(ui: &mut Ui, present: Metric) -> Option<TimingsChange> {
    let mut metric = present;
    let list = ui.name_inputs("Metric", |ui| {
        combo("metric of errors", present.name(), 120.0).show_ui(ui, |ui| {
            for option in Metric::ALL {
                ui.selectable_value(&mut metric, *option, option.name()).on_hover_text(option.help());
            }
        })
    });
    list.response.on_hover_text(format!("Metric of the errors in plot and table. {}", present.help()));
    (metric != present).then_some(TimingsChange::Metric(metric))
}

/// Draws the switch that selects whether the next measurement moves the camera or keeps it still.
fn motion_switch(ui: &mut Ui, present: Turn, commands: &mut Vec<Command>) {
    let Turn { degrees, frames, .. } = Turn::default();
    let moving = format!("In motion ({degrees}° per frame)");
    let help = format!(
        "The camera orbits by {degrees}° per frame over {frames} frames, after {} warm-up frames for upscalers with \
         history; the mean error over the frames ranks the upscalers",
        Turn::WARM_UP
    );
    for (is_still, name, help) in
        [(false, &*moving, &*help), (true, "Still", "One still view, drawn until it has converged")]
    {
        let is_present = present.is_still() == is_still;
        if ui.selectable_label(is_present, name).on_hover_text(help).clicked() && !is_present {
            commands.push(Command::Timings(TimingsChange::Turn(if is_still { Turn::STILL } else { Turn::default() })));
        }
    }
}

/// Describes the camera motion of the measurement, and the number of frames measured so far.
fn motion(session: &Session, turn: Turn) -> String {
    if turn.is_still() {
        return "still".to_owned();
    }
    let points = session.features.timings.tradeoff();
    let fewest = points.iter().map(|point| point.error.motion.frames).min().unwrap_or_default();
    format!("in motion: {fewest} of {} frames, {}° per frame", turn.frames, turn.degrees)
}

/// Draws the plot of error against time, and the table of both.
pub(crate) fn ui(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let points = session.features.timings.tradeoff();
    if points.is_empty() {
        // Takes all of the available height, so that the canvas keeps its size, and so does a picture that has the size
        // of the canvas.
        ui.set_min_height(ui.available_height());
        let (title, text) = match session.features.tasks.measuring {
            None => (
                "No measurement yet",
                "“Measure error and time” measures every upscaler on the current scene, view and size.",
            ),
            Some(_) => ("Measuring…", "The reference is drawn first, then one frame of every upscaler."),
        };
        empty_state(ui, Icon::ChartScatter, title, text);
        return;
    }
    ui.horizontal_top(|ui| {
        let width = (ui.available_width() - TABLE_POINTS - 16.0).max(220.0);
        let size = egui::vec2(width, ui.available_height());
        let in_plot = ui.vertical(|ui| plot(ui, &points, size, session, commands)).inner;
        let table = ScrollArea::both().id_salt("tradeoff table");
        let in_table = table.show(ui, |ui| table::ui(ui, &points, session, commands)).inner;
        let change = session.features.timings.list.hover_change(Panel::ErrorTime, in_plot.or(in_table));
        commands.extend(change.map(Command::Timings));
    });
}

/// Assigns an upscaler to picture A (`tile` is 0) or picture B (1) of the comparison.
pub(crate) fn choose(session: &Session, tile: usize, upscaling: Upscaling, commands: &mut Vec<Command>) {
    let recipe = session.state.tiles.recipe(tile, session.state.recipe);
    let recipe = Recipe { upscaler: upscaling, ..recipe };
    commands.push(Command::Compare(CompareChange::Recipe(tile, Box::new(recipe))));
    if !session.features.comparison.is_on() {
        commands.push(Command::Compare(CompareChange::Mode(Mode::Wipe)));
    }
}

/// Formats a value of a metric for the table, without its unit.
fn value_text(metric: Metric, value: f64) -> String {
    let digits = match metric {
        Metric::Psnr if value.is_infinite() => return "identical".to_owned(),
        Metric::Max | Metric::Changed => 0,
        Metric::Psnr | Metric::Ssimulacra2 | Metric::Mse => 2,
        Metric::Jod => 3,
        Metric::Ssim | Metric::MsSsim | Metric::Flip | Metric::RelativeMse => 4,
    };
    format::fixed(value, digits)
}

/// Returns the plot position of an upscaler: the base-10 logarithms of its time in milliseconds and of its error. An
/// error of 0 is plotted at `lane`.
fn place(point: &TradeOff, lane: f64) -> [f64; 2] {
    let error = point.mean_error();
    [point.ms.median.max(f64::MIN_POSITIVE).log10(), if error > 0.0 { error.log10() } else { lane }]
}

/// Draws the plot of all upscalers with the budget line, and handles clicks on points. Returns the upscaler under the
/// pointer.
fn plot(
    ui: &mut Ui,
    points: &[TradeOff],
    size: egui::Vec2,
    session: &Session,
    commands: &mut Vec<Command>,
) -> Option<Upscaling> {
    let least = points.iter().map(TradeOff::mean_error).filter(|error| *error > 0.0).reduce(f64::min);
    let lane = least.unwrap_or(1.0).log10() - LANE;
    let (header, _) = ui.allocate_exact_size(egui::vec2(size.x, budget_line::LABEL_HEIGHT), Sense::hover());
    let below = egui::vec2(size.x, size.y - budget_line::LABEL_HEIGHT - ui.spacing().item_spacing.y);
    let colors: Vec<Color32> = points.iter().map(|point| color(ui, point)).collect();
    let front_color = tokens(ui).text_weak;
    let metric = session.features.timings.metric_in_use();
    let is_provisional = session.features.timings.noise().is_none();
    let time_axis = if is_provisional { "Frame time (ms)" } else { "Median frame time (ms)" };
    let response = empty_plot(metric, lane, is_in_motion(session), below)
        .x_axis_label(time_axis)
        .grid_color(tokens(ui).border)
        .show(ui, |plot| {
            for step in front(points, lane) {
                plot.line(step.color(front_color).width(1.0));
            }
            for (point, color) in points.iter().zip(&colors) {
                draw(plot, point, lane, *color);
            }
        });
    let placed = |point| {
        let [x, y] = place(point, lane);
        PlacedPoint { point, at: response.transform.position_from_point(&PlotPoint::new(x, y)) }
    };
    let placed: Vec<_> = points.iter().map(placed).collect();
    let near = |pointer: Pos2| {
        let distance = |placed: &&PlacedPoint<'_>| placed.at.distance(pointer);
        let nearest = placed.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        nearest.filter(|placed| distance(placed) <= NEAR_POINTS).map(|placed| placed.point.upscaling)
    };
    let budget_x = budget(ui, &response.transform, header, session, commands);
    // Points lie above the budget line, so that those below it can be clicked.
    let on_point = clicked_point(ui, &placed);
    let beside_point = response.response.interact_pointer_pos().filter(|_| response.response.clicked()).and_then(near);
    if let Some(upscaling) = on_point.or(beside_point) {
        let tile = usize::from(!ui.input(|i| i.modifiers.shift));
        choose(session, tile, upscaling, commands);
    }
    label_points(ui, &placed, session, *response.transform.frame(), budget_x);
    ui.input(|input| input.pointer.hover_pos()).filter(|at| response.response.rect.contains(*at)).and_then(near)
}

/// Whether the last measurement moved the camera.
fn is_in_motion(session: &Session) -> bool {
    session.features.timings.measurement_request().is_some_and(|measured| !measured.turn.is_still())
}

/// Whether a point is on the Pareto front.
fn is_on_front(point: &TradeOff) -> bool {
    point.standing == Some(Standing::Front)
}

/// Returns the colour of a point: that of its method on the Pareto front and before the first round, and grey elsewhere.
fn color(ui: &Ui, point: &TradeOff) -> Color32 {
    if is_on_front(point) || point.standing.is_none() { method_color(ui, point.upscaling) } else { tokens(ui).border }
}

/// Returns the plot with its axes, but without points.
fn empty_plot(metric: Metric, lane: f64, in_motion: bool, size: egui::Vec2) -> Plot<'static> {
    let name = metric.error_name();
    let axis = if in_motion { format!("{name} in motion") } else { name.clone() };
    let number =
        |value: f64| format!("{:.2}", 10_f64.powf(value)).trim_end_matches('0').trim_end_matches('.').to_owned();
    Plot::new("error against time of upscalers")
        .width(size.x)
        .height(size.y)
        .y_axis_label(axis)
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
                Some(format!("{plot_name}: {}, {name} {error:.4}", format::ms(10_f64.powf(position.x))))
            }
            HoverPosition::Elsewhere { .. } => None,
        })
}

/// Draws the budget line over the plot, and its label in `header`. Returns the horizontal position of the line.
fn budget(ui: &Ui, transform: &PlotTransform, header: Rect, session: &Session, commands: &mut Vec<Command>) -> f32 {
    let frame = *transform.frame();
    let value = session.features.timings.budget_ms().log10();
    let x = transform.position_from_point(&PlotPoint::new(value, 0.0)).x.clamp(frame.left(), frame.right());
    budget_line::label(ui, session, header, x);
    if let Some(x) = budget_line::line(ui, frame, x) {
        let ms = 10_f64.powf(transform.value_from_position(pos2(x, frame.top())).x);
        commands.push(Command::Timings(TimingsChange::Budget(ms)));
    }
    x
}

/// Draws the names of the points on the Pareto front where there is space, and a ring around the point of the method
/// under the pointer, whose name has priority.
fn label_points(ui: &Ui, points: &[PlacedPoint<'_>], session: &Session, frame: Rect, budget_x: f32) {
    let hovered = session.features.timings.list.hovered();
    let is_hovered = |placed: &&PlacedPoint<'_>| hovered == Some(placed.point.upscaling);
    let of_front = points.iter().filter(|placed| is_on_front(placed.point) && !is_hovered(placed));
    let color = tokens(ui).text;
    let layout = |placed: &PlacedPoint<'_>| {
        let font = FontId::proportional(font_size::SMALL);
        (placed.at, ui.painter().layout_no_wrap(placed.point.upscaling.label(), font, color))
    };
    let names: Vec<_> = points.iter().filter(is_hovered).chain(of_front).map(layout).collect();
    let sizes: Vec<_> = names.iter().map(|(at, galley)| (*at, galley.size())).collect();
    let line = Rect::from_x_y_ranges(budget_x..=budget_x, frame.y_range());
    let obstacles: Vec<_> = points.iter().map(|placed| labels::around(placed.at)).chain([line]).collect();
    for (place, (_, galley)) in labels::place(&sizes, &obstacles, frame).into_iter().zip(names) {
        if let Some(place) = place {
            ui.painter().galley(place.min, galley, color);
        }
    }
    for placed in points.iter().filter(is_hovered) {
        let ring = Stroke::new(1.5, tokens(ui).accent);
        ui.painter().with_clip_rect(frame).circle_stroke(placed.at, RING, ring);
    }
}

/// Makes each plotted point a button with an accessible name. Returns the upscaler whose point was clicked.
fn clicked_point(ui: &Ui, points: &[PlacedPoint<'_>]) -> Option<Upscaling> {
    let mut clicked = None;
    for PlacedPoint { point, at } in points {
        let rect = Rect::from_center_size(*at, egui::Vec2::splat(NEAR_POINTS));
        let label = point.upscaling.label();
        let node = ui.interact(rect, ui.scope_id().with(&label), Sense::click());
        let (metric, value) = (point.metric.name(), value_text(point.metric, point.mean()));
        let words = format!("Point: {label}, {}, {metric} {value}", format::ms(point.ms.median));
        node.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &words));
        clicked = clicked.or(node.clicked().then_some(point.upscaling));
    }
    clicked
}

/// Returns the Pareto front as separate line segments, because the plot would fill the corners of a single polyline.
fn front(points: &[TradeOff], lane: f64) -> Vec<Line<'static>> {
    let mut best: Vec<_> = points.iter().filter(|point| is_on_front(point)).map(|point| place(point, lane)).collect();
    best.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut corners: Vec<[f64; 2]> = Vec::new();
    for point in best {
        if let Some(last) = corners.last() {
            corners.push([point[0], last[1]]);
        }
        corners.push(point);
    }
    let steps = corners.windows(2);
    steps.map(|step| Line::new("Pareto front", PlotPoints::from(step.to_vec())).allow_hover(false)).collect()
}

fn draw(plot: &mut PlotUi<'_>, point: &TradeOff, lane: f64, color: Color32) {
    let at = place(point, lane);
    let bar = vec![[point.ms.p10.log10(), at[1]], [point.ms.p90.log10(), at[1]]];
    let name = point.upscaling.label();
    plot.line(Line::new(name.clone(), PlotPoints::from(bar)).color(color.gamma_multiply(0.6)).allow_hover(false));
    // A ring marks a provisional time.
    let is_filled = point.standing.is_some();
    plot.points(Points::new(name, PlotPoints::from(vec![at])).color(color).radius(5.0).filled(is_filled));
}
