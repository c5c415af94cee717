//! Plot of error against time with one point for every upscaler, measured on the current scene. A click on a point uses
//! the upscaler for picture A or B of the comparison.

use eframe::egui::{self, Button, Color32, Grid, ProgressBar, RichText, ScrollArea, Ui};
use egui_plot::{GridMark, HoverPosition, Line, Plot, PlotPoint, PlotPoints, PlotUi, Points};

use crate::chain::Recipe;
use crate::measure::motion::{MotionError, Turn};
use crate::measure::noise::WITHIN;
use crate::pipeline::settings::Choice as _;
use crate::report::upscaling::tradeoff::Standing;
use crate::ui::command::Command;
use crate::ui::compare::bar::reference_list;
use crate::ui::compare::{CompareChange, Mode};
use crate::ui::format;
use crate::ui::session::Session;
use crate::ui::theme::{Icon, tokens};
use crate::ui::ticks::log_marks;
use crate::ui::timings::TradeOff;
use crate::ui::widgets::{empty_state, figure};
use crate::upscale::{self, Upscaling};

/// Width of the table of errors and times, in points.
const TABLE_POINTS: f32 = 660.0;

/// Width of a column of the table, in points.
const FIGURE_POINTS: f32 = 62.0;

/// Headings of the numeric columns of the table, with their tooltips.
const HEADINGS: [(&str, &str); 6] = [
    ("ms", "Median frame time"),
    ("FLIP", "Mean FLIP error over the frames, which ranks the upscalers"),
    ("worst", "FLIP error of the worst frame"),
    ("at rest", "FLIP error of the still view after it has converged"),
    ("PSNR dB", "PSNR computed from the mean squared error over all frames"),
    ("SSIM", "Mean SSIM over the frames"),
];

/// Radius around a point within which a click selects it, in points.
const NEAR_POINTS: f32 = 12.0;

/// Distance from the smallest nonzero error down to the line on which an error of 0 is plotted, in powers of ten. A
/// logarithmic axis has no position for 0.
const LANE: f64 = 0.4;

/// Draws the controls of the tab “Error vs time”, beside the tabs.
pub(crate) fn controls(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    if let Some(measuring) = session.measuring {
        if ui.button("Cancel").on_hover_text("Stop the measurement and keep the results so far").clicked() {
            commands.push(Command::CancelMeasure);
        }
        ui.add(ProgressBar::new(measuring.progress).desired_width(200.0).show_percentage());
    } else {
        let measure = Button::new((crate::ui::theme::icon(Icon::Timer), "Measure error and time"));
        let help = "Time every upscaler in interleaved rounds, and compare each frame with the reference for the \
                    same camera. Takes a minute or more in motion, and a few seconds for a still view";
        if ui.add(measure).on_hover_text(help).clicked() {
            commands.push(Command::Measure);
        }
        let chosen = reference_list(ui, "Reference to measure against", 150.0, session.comparison.reference);
        commands.extend(chosen.map(Command::Compare));
        motion_switch(ui, session.timings.turn, commands);
    }
    let viewport = session.viewport();
    let fits = session.timings.measurement_fits(&session.request());
    let text = match (session.timings.measurement_request(), fits) {
        (None, _) => "Click a point to show it as picture B, Shift+click to show it as A".to_owned(),
        (Some(measured), true) => format!(
            "Reference: {} · {} · {} × {} px · {}{} · Click a point: show as B, Shift+click: as A",
            measured.reference.name(),
            session.scene.name,
            viewport.width,
            viewport.height,
            motion(session, measured.turn),
            session.timings.noise().map(|noise| format!(" · noise floor {}", noise.words())).unwrap_or_default()
        ),
        (Some(_), false) => {
            "Measured with a different scene, view, size or setting; measure again to update".to_owned()
        }
    };
    ui.add(egui::Label::new(RichText::new(text).color(tokens(ui).text_weak)).truncate());
}

/// Draws the switch that selects whether the next measurement moves the camera or keeps it still.
fn motion_switch(ui: &mut Ui, present: Turn, commands: &mut Vec<Command>) {
    let Turn { degrees, frames } = Turn::default();
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
            commands.push(Command::MeasureOver(if is_still { Turn::STILL } else { Turn::default() }));
        }
    }
}

/// Describes the camera motion of the measurement, and the number of frames measured so far.
fn motion(session: &Session, turn: Turn) -> String {
    if turn.is_still() {
        return "still".to_owned();
    }
    let points = session.timings.tradeoff();
    let fewest = points.iter().map(|point| point.error.motion.frames).min().unwrap_or_default();
    format!("in motion: {fewest} of {} frames, {}° per frame", turn.frames, turn.degrees)
}

/// Draws the plot of error against time, and the table of both.
pub(crate) fn ui(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let points = session.timings.tradeoff();
    let in_motion = session.timings.measurement_request().is_some_and(|measured| !measured.turn.is_still());
    if points.is_empty() {
        // Takes all of the available height, so that the canvas keeps its size, and so does a picture that has the size
        // of the canvas.
        ui.set_min_height(ui.available_height());
        empty_state(
            ui,
            Icon::ChartScatter,
            "No measurement yet",
            "“Measure error and time” measures every upscaler on the current scene, view and size.",
        );
        return;
    }
    ui.horizontal_top(|ui| {
        let width = (ui.available_width() - TABLE_POINTS - 16.0).max(220.0);
        let size = egui::vec2(width, ui.available_height());
        if let Some(upscaling) = plot(ui, &points, in_motion, size) {
            let tile = usize::from(!ui.input(|i| i.modifiers.shift));
            choose(session, tile, upscaling, commands);
        }
        ScrollArea::both().id_salt("tradeoff table").show(ui, |ui| table(ui, &points, session, commands));
    });
}

/// Assigns an upscaler to picture A (`tile` is 0) or picture B (1) of the comparison.
pub(crate) fn choose(session: &Session, tile: usize, upscaling: Upscaling, commands: &mut Vec<Command>) {
    let recipe = session.state.tiles.recipe(tile, session.state.recipe);
    let recipe = Recipe { upscaler: upscaling, ..recipe };
    commands.push(Command::Compare(CompareChange::Recipe(tile, Box::new(recipe))));
    if !session.comparison.is_on() {
        commands.push(Command::Compare(CompareChange::Mode(Mode::Wipe)));
    }
}

/// Returns the plot colour of an upscaler.
fn color(ui: &Ui, upscaling: Upscaling) -> Color32 {
    let colors = tokens(ui).series;
    let place = upscale::ALL.iter().position(|upscaler| upscaler.id() == upscaling.method());
    colors[place.unwrap_or(0) % colors.len()]
}

/// Returns the mean FLIP error over the frames of the camera motion. It is plotted, and the table is sorted by it.
fn flip(point: &TradeOff) -> f64 {
    point.error.motion.mean.flip
}

/// Describes in one sentence whether an upscaler lies on the Pareto front, and if not, which upscaler dominates it.
fn standing(point: &TradeOff) -> String {
    match point.standing {
        Standing::Front => "On the Pareto front: no other upscaler is both faster and more accurate".to_owned(),
        Standing::WithinNoise(other) => {
            format!("{} has less error, and its extra time is {WITHIN}", other.label())
        }
        Standing::Beaten(by) => format!("Dominated by {}", by.label()),
    }
}

/// Returns the plot position of an upscaler: the base-10 logarithms of its time in milliseconds and of its error. An
/// error of 0 is plotted at `lane`.
fn place(point: &TradeOff, lane: f64) -> [f64; 2] {
    let error = flip(point);
    [point.ms.median.max(f64::MIN_POSITIVE).log10(), if error > 0.0 { error.log10() } else { lane }]
}

/// Draws the plot of all upscalers. Returns the one that was clicked.
fn plot(ui: &mut Ui, points: &[TradeOff], in_motion: bool, size: egui::Vec2) -> Option<Upscaling> {
    let least = points.iter().map(flip).filter(|error| *error > 0.0).fold(1.0, f64::min);
    let lane = least.log10() - LANE;
    let weak = tokens(ui).border;
    let colors: Vec<Color32> = points.iter().map(|point| color(ui, point.upscaling)).collect();
    let front_color = tokens(ui).text_weak;
    let number =
        |value: f64| format!("{:.2}", 10_f64.powf(value)).trim_end_matches('0').trim_end_matches('.').to_owned();
    let response = Plot::new("error against time of upscalers")
        .width(size.x)
        .height(size.y)
        .x_axis_label("Median frame time (ms)")
        .y_axis_label(if in_motion { "FLIP in motion" } else { "FLIP" })
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
                draw(plot, point, lane, if point.standing == Standing::Front { *color } else { weak });
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

/// Adds an accessible name for each plotted point, for screen readers.
fn name_points(ui: &Ui, points: &[TradeOff], position: impl Fn(&TradeOff) -> egui::Pos2) {
    for point in points {
        let rect = egui::Rect::from_center_size(position(point), egui::Vec2::splat(NEAR_POINTS));
        let label = point.upscaling.label();
        let node = ui.interact(rect, ui.scope_id().with(&label), egui::Sense::hover());
        let words = format!("Point: {label}, {}, FLIP {}", format::ms(point.ms.median), format::fixed(flip(point), 4));
        node.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, &words));
    }
}

/// Returns the Pareto front as separate line segments, because the plot would fill the corners of a single polyline.
fn front(points: &[TradeOff], lane: f64) -> Vec<Line<'static>> {
    let mut best: Vec<_> =
        points.iter().filter(|point| point.standing == Standing::Front).map(|p| place(p, lane)).collect();
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
    plot.points(Points::new(name, PlotPoints::from(vec![at])).color(color).radius(5.0));
}

fn table(ui: &mut Ui, points: &[TradeOff], session: &Session, commands: &mut Vec<Command>) {
    let mut order: Vec<_> = points.iter().collect();
    order.sort_by(|a, b| flip(a).total_cmp(&flip(b)));
    let shown = |tile: usize| {
        let recipe = session.state.tiles.recipe(tile, session.state.recipe);
        session.comparison.is_on().then_some(recipe.upscaler)
    };
    Grid::new("tradeoff").num_columns(2 + HEADINGS.len()).striped(true).spacing([10.0, 3.0]).show(ui, |ui| {
        ui.label("");
        ui.label(RichText::new("Upscaler").small().color(tokens(ui).text_weak));
        for (heading, help) in HEADINGS {
            figure(ui, heading, FIGURE_POINTS, tokens(ui).text_weak).on_hover_text(help);
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
            let is_best = point.standing == Standing::Front;
            let strength = if is_best { tokens(ui).text } else { tokens(ui).text_weak };
            let dot = if is_best { color(ui, point.upscaling) } else { tokens(ui).border };
            ui.horizontal(|ui| {
                let (mark, _) = ui.allocate_exact_size(egui::vec2(10.0, 10.0), egui::Sense::hover());
                ui.painter().circle_filled(mark.center(), 4.0, dot);
                ui.label(RichText::new(&label).color(strength)).on_hover_text(standing(point));
            });
            let ms = format::fixed(point.ms.median, 2);
            if point.native_within_noise {
                figure(ui, &ms, FIGURE_POINTS, tokens(ui).text_weak).on_hover_text(format!("{WITHIN} of native"));
            } else {
                figure(ui, &ms, FIGURE_POINTS, strength);
            }
            let MotionError { mean, worst, .. } = point.error.motion;
            let psnr =
                if mean.codes.mse == 0.0 { "identical".to_owned() } else { format::fixed(mean.codes.psnr_db, 2) };
            let [mean_flip, worst, still] =
                [mean.flip, worst.flip, point.error.still.flip].map(|flip| format::fixed(flip, 4));
            for text in [mean_flip, worst, still, psnr, format::fixed(mean.codes.ssim, 4)] {
                figure(ui, &text, FIGURE_POINTS, strength);
            }
            ui.end_row();
        }
    });
}
