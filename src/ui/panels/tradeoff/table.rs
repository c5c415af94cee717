//! Table of times and errors beside the plot of error against time.

use eframe::egui::{self, Grid, Rect, RichText, Sense, Ui, vec2};

use super::{choose, color, is_on_front, value_text};
use crate::measure::metric::Metric;
use crate::measure::noise::WITHIN;
use crate::pipeline::settings::Choice as _;
use crate::report::upscaling::tradeoff::Standing;
use crate::ui::format;
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::timings::{TradeOff, budget};
use crate::ui::theme::{self, Icon, tokens};
use crate::ui::widgets::figure;
use crate::upscale::Upscaling;

/// Width of a column of the table, in points.
const FIGURE_POINTS: f32 = 62.0;

/// Metrics that the table shows besides the one that ranks the upscalers.
const FURTHER: [Metric; 3] = [Metric::Flip, Metric::Psnr, Metric::Ssim];

/// Returns the headings of the numeric columns, with their tooltips.
fn headings(metric: Metric) -> Vec<(String, String)> {
    let name = metric.name();
    let further = FURTHER.into_iter().filter(|further| *further != metric);
    let ranked = [
        ("ms".to_owned(), "Median frame time".to_owned()),
        (name.to_owned(), format!("Mean {name} over the frames, which ranks the upscalers")),
        ("worst".to_owned(), format!("{name} of the frame with the largest FLIP error")),
        ("at rest".to_owned(), format!("{name} of the still view after it has converged")),
    ];
    let further = further.map(|metric| (metric.name().to_owned(), format!("Mean over the frames. {}", metric.help())));
    ranked.into_iter().chain(further).collect()
}

/// Size of the dot and of the star in the column of names, in points.
const MARK: f32 = 12.0;

/// Describes in one sentence whether an upscaler is ranked, whether it lies on the Pareto front, and if not, which upscaler dominates it.
fn standing(point: &TradeOff) -> String {
    match point.standing {
        None => "Not ranked before the first round: the time is that of a single frame".to_owned(),
        Some(Standing::Front) => "On the Pareto front: no other upscaler is both faster and more accurate".to_owned(),
        Some(Standing::WithinNoise(other)) => {
            format!("{} has less error, and its extra time is {WITHIN}", other.label())
        }
        Some(Standing::Beaten(by)) => format!("Dominated by {}", by.label()),
    }
}

/// Draws the table of times and errors, in ascending order of the errors. Returns the upscaler under the pointer.
pub(super) fn ui(
    ui: &mut Ui,
    points: &[TradeOff],
    session: &Session,
    commands: &mut Vec<Command>,
) -> Option<Upscaling> {
    let mut order: Vec<_> = points.iter().collect();
    order.sort_by(|a, b| a.mean_error().total_cmp(&b.mean_error()));
    let best = session.features.timings.budget_winner().best();
    let mut hovered = None;
    let headings = headings(session.features.timings.metric_in_use());
    Grid::new("tradeoff").num_columns(2 + headings.len()).striped(true).spacing([10.0, 3.0]).show(ui, |ui| {
        ui.label("");
        ui.label(RichText::new("Upscaler").small().color(tokens(ui).text_weak));
        for (heading, help) in &headings {
            figure(ui, heading, FIGURE_POINTS, tokens(ui).text_weak).on_hover_text(help);
        }
        ui.end_row();
        for point in order {
            let first = compare_buttons(ui, point.upscaling, session, commands);
            name(ui, point, session, best == Some(point.upscaling));
            let row = first.union(numbers(ui, point));
            if ui.rect_contains_pointer(row) {
                hovered = Some(point.upscaling);
            }
            ui.end_row();
        }
    });
    hovered
}

/// Draws the buttons that assign an upscaler to picture A or B. Returns their rectangle.
fn compare_buttons(ui: &mut Ui, upscaling: Upscaling, session: &Session, commands: &mut Vec<Command>) -> Rect {
    let shown = |tile: usize| {
        let recipe = session.state.tiles.recipe(tile, session.state.recipe);
        session.features.comparison.is_on().then_some(recipe.upscaler)
    };
    let buttons = ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        for (tile, name, color) in [(0, "A", tokens(ui).a), (1, "B", tokens(ui).b)] {
            let is_shown = shown(tile) == Some(upscaling);
            let button = ui.selectable_label(is_shown, RichText::new(name).small().color(color));
            let words = format!("Show {} as {name}", upscaling.label());
            button.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, is_shown, &words));
            if button.on_hover_text(&words).clicked() {
                choose(session, tile, upscaling, commands);
            }
        }
    });
    buttons.response.rect
}

/// Returns the text colour of a row.
fn strength(ui: &Ui, point: &TradeOff) -> egui::Color32 {
    if is_on_front(point) { tokens(ui).text } else { tokens(ui).text_weak }
}

/// Draws the name after a dot in the colour of the point, or after a star if it is the best within the budget.
fn name(ui: &mut Ui, point: &TradeOff, session: &Session, is_best: bool) {
    let is_hovered = session.features.timings.list.hovered() == Some(point.upscaling);
    let text = if is_hovered { tokens(ui).text_strong } else { strength(ui, point) };
    ui.horizontal(|ui| {
        let (mark, response) = ui.allocate_exact_size(vec2(MARK, MARK), Sense::hover());
        if is_best {
            theme::paint_icon(ui.painter(), mark.center(), Icon::Star, MARK, tokens(ui).accent);
            let budget = budget::text(session.features.timings.budget_ms());
            response
                .on_hover_text(format!("Best within the budget: {} within {budget}", budget::best_words(point.metric)));
        } else {
            ui.painter().circle_filled(mark.center(), MARK / 3.0, color(ui, point));
        }
        ui.label(RichText::new(point.upscaling.label()).color(text)).on_hover_text(standing(point));
    });
}

/// Draws the time and the errors of a row. Returns their rectangle.
fn numbers(ui: &mut Ui, point: &TradeOff) -> Rect {
    let strength = strength(ui, point);
    let ms = format::fixed(point.ms.median, 2);
    let mut row = if point.native_within_noise {
        figure(ui, &ms, FIGURE_POINTS, tokens(ui).text_weak).on_hover_text(format!("{WITHIN} of native")).rect
    } else {
        figure(ui, &ms, FIGURE_POINTS, strength).rect
    };
    let (motion, metric) = (point.error.motion, point.metric);
    let ranked = [motion.mean, motion.worst, point.error.still].map(|error| value_text(metric, error.value(metric)));
    let further = FURTHER.into_iter().filter(|further| *further != metric);
    let further = further.map(|metric| value_text(metric, motion.mean.value(metric)));
    for text in ranked.into_iter().chain(further) {
        row = row.union(figure(ui, &text, FIGURE_POINTS, strength).rect);
    }
    row
}
