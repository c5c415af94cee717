//! Plot of the single frames of the checked rows and of the row under the pointer: in drawing order, or as cumulative
//! distributions. Each line is labelled at its end.

use eframe::egui::{Align2, Color32, FontId, Rect, RichText, Role, Sense, Ui, Vec2, WidgetInfo, pos2, vec2};
use egui_plot::{HoverPosition, Line, Plot, PlotPoint, PlotPoints, PlotResponse, Points, uniform_grid_spacer};

use super::history;
use super::rows::MethodRow;
use crate::ui::format;
use crate::ui::method_colors::method_color;
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::timings::{TimingsChange, TimingsView};
use crate::ui::theme::{font_size, space, tokens};
use crate::ui::ticks::{self, round_steps};

/// Minimum length of the plot's frame axis, in frames.
const MIN_FRAMES: f64 = 10.0;

/// Maximum width of the labels beside the plot, as a fraction of the plot's width.
const LABEL_SHARE: f32 = 0.4;

/// Height of a label, in points.
const LABEL_HEIGHT: f32 = 15.0;

/// Radius of the dot before a label, in points.
const DOT: f32 = 3.5;

/// Plot with one line per row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum FramePlot {
    /// Time of each frame, in drawing order.
    Lines,
    /// Cumulative distribution of the times.
    Distribution,
}

/// Line of the plot: the frames of one upscaler.
struct FrameLine<'a> {
    row: &'a MethodRow,
    name: String,
    color: Color32,
    width: f32,
}

impl<'a> FrameLine<'a> {
    /// Creates the line of a row; that of the row under the pointer is wider.
    fn new(ui: &Ui, row: &'a MethodRow, session: &Session) -> Self {
        let is_hovered = session.features.timings.list.hovered() == Some(row.upscaling);
        let color = method_color(ui, row.upscaling);
        Self { row, name: row.upscaling.label(), color, width: if is_hovered { 2.5 } else { 1.5 } }
    }

    /// Returns the points of the line in plot coordinates.
    fn points(&self, view: FramePlot) -> Vec<[f64; 2]> {
        match view {
            FramePlot::Lines => self.row.times_ms.iter().enumerate().map(|(frame, ms)| [frame as f64, *ms]).collect(),
            FramePlot::Distribution => distribution(&self.row.times_ms),
        }
    }
}

/// Returns the corners of the cumulative distribution of times: the fraction of frames that took at most a given time.
/// A steep curve means steady times, and a long tail to the right means spikes.
fn distribution(times_ms: &[f64]) -> Vec<[f64; 2]> {
    let mut sorted = times_ms.to_vec();
    sorted.sort_by(f64::total_cmp);
    let count = sorted.len() as f64;
    let steps = sorted.iter().enumerate();
    steps.flat_map(|(below, ms)| [[*ms, below as f64 / count], [*ms, (below + 1) as f64 / count]]).collect()
}

/// Draws the plot of the single frames, with the switch of its kind, in an area of `size` points.
pub(super) fn ui(ui: &mut Ui, rows: &[MethodRow], size: Vec2, session: &Session, commands: &mut Vec<Command>) {
    let top = ui.cursor().top();
    let current = session.state.recipe.upscaler;
    let list = &session.features.timings.list;
    let is_drawn = |row: &&MethodRow| list.plots_frames_of(row.upscaling, current);
    let lines: Vec<_> = rows.iter().filter(is_drawn).map(|row| FrameLine::new(ui, row, session)).collect();
    ui.horizontal(|ui| {
        view_switch(ui, session.features.timings.view, commands);
        let what = match session.features.timings.view {
            TimingsView::Lines | TimingsView::Distribution => "of checked and hovered rows",
            TimingsView::History => "of all frames; checked and hovered rows are coloured",
        };
        ui.label(RichText::new(what).color(tokens(ui).text_weak));
    });
    let height = size.y - (ui.cursor().top() - top);
    let size = vec2(size.x, height);
    match session.features.timings.view {
        TimingsView::Lines => plot(ui, &lines, FramePlot::Lines, size),
        TimingsView::Distribution => plot(ui, &lines, FramePlot::Distribution, size),
        TimingsView::History => history::plot(ui, size, session),
    }
}

fn view_switch(ui: &mut Ui, present: TimingsView, commands: &mut Vec<Command>) {
    ui.spacing_mut().item_spacing.x = space::XS;
    for (view, name, help) in [
        (TimingsView::Lines, "Lines", "Frame times in drawing order"),
        (TimingsView::Distribution, "Distribution", "Cumulative distribution of frame times"),
        (TimingsView::History, "History", "Frames drawn for the window, across changes of settings"),
    ] {
        if ui.selectable_label(present == view, name).on_hover_text(help).clicked() {
            commands.push(Command::Timings(TimingsChange::View(view)));
        }
    }
}

fn plot(ui: &mut Ui, lines: &[FrameLine<'_>], view: FramePlot, size: Vec2) {
    let font = FontId::proportional(font_size::SMALL);
    let width_of = |line: &FrameLine<'_>| {
        ui.painter().layout_no_wrap(line.name.clone(), font.clone(), Color32::WHITE).size().x.ceil()
    };
    let widest = lines.iter().map(width_of).fold(0.0, f32::max) + 2.0 * DOT + space::S;
    let labels = widest.min(size.x * LABEL_SHARE);
    ui.horizontal_top(|ui| {
        ui.spacing_mut().item_spacing.x = space::XS;
        let plot = match view {
            FramePlot::Lines => frame_plot(),
            FramePlot::Distribution => distribution_plot(),
        };
        let plot =
            plot.width(size.x - labels - space::XS).height(size.y).grid_color(tokens(ui).border).allow_scroll(false);
        let response = plot.show(ui, |plot| {
            for line in lines {
                draw(plot, line, view);
            }
        });
        let (column, _) = ui.allocate_exact_size(vec2(labels, size.y), Sense::hover());
        end_labels(ui, lines, &end_heights(&response, lines, view), column);
    });
}

fn frame_plot() -> Plot<'static> {
    Plot::new("frame times")
        .x_axis_label("Frame")
        .include_x(0.0)
        .include_x(MIN_FRAMES)
        .y_axis_label("ms")
        .include_y(0.0)
        .y_grid_spacer(uniform_grid_spacer(|input| round_steps(&input)))
        .y_axis_formatter(ticks::number)
        .label_formatter(|position| match position {
            HoverPosition::NearDataPoint { plot_name, position, .. } => {
                Some(format!("{plot_name}: {} in frame {}", format::ms(position.y), position.x))
            }
            HoverPosition::Elsewhere { .. } => None,
        })
}

fn distribution_plot() -> Plot<'static> {
    Plot::new("distribution of frame times")
        .x_axis_label("Frame time (ms)")
        .y_axis_label("Share")
        .include_y(0.0)
        .include_y(1.0)
        .label_formatter(|position| match position {
            HoverPosition::NearDataPoint { plot_name, position, .. } => Some(format!(
                "{plot_name}: {} of frames took at most {}",
                format::percent(position.y),
                format::ms(position.x)
            )),
            HoverPosition::Elsewhere { .. } => None,
        })
}

fn draw(plot: &mut egui_plot::PlotUi<'_>, line: &FrameLine<'_>, view: FramePlot) {
    let points = line.points(view);
    if view == FramePlot::Lines {
        // The slowest frame has its own mark, however many frames share its screen column.
        if let Some(slowest) = points.iter().max_by(|a, b| a[1].total_cmp(&b[1])) {
            let mark = PlotPoints::from(vec![*slowest]);
            plot.points(Points::new(line.name.clone(), mark).color(line.color).radius(2.5));
        }
    }
    plot.line(Line::new(line.name.clone(), PlotPoints::from(points)).color(line.color).width(line.width));
}

/// Returns the screen height of the end of each line, limited to the plot.
fn end_heights(response: &PlotResponse<()>, lines: &[FrameLine<'_>], view: FramePlot) -> Vec<f32> {
    let frame = response.transform.frame();
    let height = |line: &FrameLine<'_>| {
        let [x, y] = line.points(view).last().copied().unwrap_or_default();
        response.transform.position_from_point(&PlotPoint::new(x, y)).y.clamp(frame.top(), frame.bottom())
    };
    lines.iter().map(height).collect()
}

/// Draws the name of each line in the column beside the plot, at the height of its end or as near as possible.
fn end_labels(ui: &Ui, lines: &[FrameLine<'_>], heights: &[f32], column: Rect) {
    let centers = spread(heights, LABEL_HEIGHT, (column.top(), column.bottom()));
    for (line, center) in lines.iter().zip(centers) {
        let place = Rect::from_min_max(
            pos2(column.left(), center - LABEL_HEIGHT / 2.0),
            pos2(column.right(), center + LABEL_HEIGHT / 2.0),
        );
        ui.painter().circle_filled(pos2(place.left() + DOT, center), DOT, line.color);
        let corner = pos2(place.left() + 2.0 * DOT + space::XS, center);
        let font = FontId::proportional(font_size::SMALL);
        ui.painter().with_clip_rect(column.expand(space::XS)).text(
            corner,
            Align2::LEFT_CENTER,
            &line.name,
            font,
            tokens(ui).text,
        );
        let response = ui.interact(place, ui.scope_id().with(("end of line", &line.name)), Sense::hover());
        response.widget_info(|| WidgetInfo::labeled(Role::Label, true, &line.name));
    }
}

/// Moves labels of the given height vertically until they do not overlap, as little as possible and in the order of
/// `centers`. The labels stay between the bounds `(top, bottom)` unless there are too many. Returns the new centres in
/// the order of the arguments.
fn spread(centers: &[f32], height: f32, (top, bottom): (f32, f32)) -> Vec<f32> {
    let mut order: Vec<usize> = (0..centers.len()).collect();
    order.sort_by(|a, b| centers[*a].total_cmp(&centers[*b]));
    let mut moved = centers.to_vec();
    let mut least = top + height / 2.0;
    for index in &order {
        moved[*index] = moved[*index].max(least);
        least = moved[*index] + height;
    }
    let mut most = bottom - height / 2.0;
    for index in order.iter().rev() {
        moved[*index] = moved[*index].min(most);
        most = moved[*index] - height;
    }
    moved
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_of_lines_do_not_overlap() {
        assert_eq!(spread(&[50.0, 20.0], 10.0, (0.0, 100.0)), [50.0, 20.0], "there is enough space");
        assert_eq!(spread(&[50.0, 52.0, 51.0], 10.0, (0.0, 100.0)), [50.0, 70.0, 60.0]);
        assert_eq!(spread(&[99.0, 98.0], 10.0, (0.0, 100.0)), [95.0, 85.0]);
        assert_eq!(spread(&[1.0, 2.0], 10.0, (0.0, 100.0)), [5.0, 15.0]);
        assert!(spread(&[], 10.0, (0.0, 100.0)).is_empty());
    }

    #[test]
    fn a_distribution_rises_by_one_frame_at_each_time() {
        let steps = distribution(&[3.0, 1.0]);
        assert_eq!(steps, [[1.0, 0.0], [1.0, 0.5], [3.0, 0.5], [3.0, 1.0]]);
    }
}
