//! Plot of the frames drawn for the window, in drawing order, with a named line at each change of settings.

use eframe::egui::{Align2, RichText, Ui, Vec2};
use egui_plot::{HoverPosition, Line, Plot, PlotPoint, PlotPoints, Points, Text, VLine, uniform_grid_spacer};

use crate::ui::format;
use crate::ui::method_colors::method_color;
use crate::ui::session::Session;
use crate::ui::session::timings::history::SettingsMarker;
use crate::ui::theme::{Icon, tokens};
use crate::ui::ticks::{self, round_steps};
use crate::ui::widgets::empty_state;

/// Number of changes, counted from the newest, whose names are in the plot. Older ones are named under the pointer.
const NAMED: usize = 4;

/// Draws the plot in an area of `size` points. Frames have the colour of their method if its row is checked or under
/// the pointer, or if it draws the picture; others are grey.
pub(super) fn plot(ui: &mut Ui, size: Vec2, session: &Session) {
    let history = &session.features.timings.history;
    if history.is_empty() {
        empty_state(
            ui,
            Icon::ChartLine,
            "No frames yet",
            "Move the camera or change a setting: each frame is recorded.",
        );
        return;
    }
    let current = session.state.recipe.upscaler;
    let runs = history.runs();
    let highest_ms = runs.iter().flat_map(|run| &run.points).map(|[_, ms]| *ms).fold(0.0, f64::max);
    let (weak, grey, border) = (tokens(ui).text_weak, tokens(ui).border, tokens(ui).text_weak.gamma_multiply(0.5));
    let colors: Vec<_> = runs.iter().map(|run| method_color(ui, run.upscaling)).collect();
    let plot = Plot::new("frame time history")
        .width(size.x)
        .height(size.y)
        .grid_color(grey)
        .allow_scroll(false)
        .x_axis_label("Frame")
        .y_axis_label("ms")
        .include_y(0.0)
        .include_y(highest_ms * 1.3)
        .y_grid_spacer(uniform_grid_spacer(|input| round_steps(&input)))
        .y_axis_formatter(ticks::number)
        .label_formatter(|position| match position {
            HoverPosition::NearDataPoint { plot_name, position, .. } if position.y > 0.0 => {
                Some(format!("{plot_name}: {} in frame {}", format::ms(position.y), position.x))
            }
            HoverPosition::NearDataPoint { plot_name, .. } => Some((*plot_name).to_owned()),
            HoverPosition::Elsewhere { .. } => None,
        });
    plot.show(ui, |plot| {
        for (run, color) in runs.iter().zip(&colors) {
            let is_chosen = session.features.timings.list.plots_frames_of(run.upscaling, current);
            let color = if is_chosen { *color } else { grey };
            let name = run.upscaling.label();
            if let [single] = run.points[..] {
                plot.points(Points::new(name, PlotPoints::from(vec![single])).color(color).radius(2.0));
            } else {
                plot.line(Line::new(name, PlotPoints::from(run.points.clone())).color(color).width(1.5));
            }
        }
        for (place, SettingsMarker { number, words }) in history.markers().rev().enumerate() {
            // The change lies between two frames.
            let x = *number as f64 - 0.5;
            plot.vline(VLine::new(words.clone(), x).color(border).width(1.0));
            if place < NAMED {
                let y = highest_ms * (1.28 - 0.07 * place as f64);
                let text = RichText::new(format!(" {words}")).small();
                plot.text(Text::new(words.clone(), PlotPoint::new(x, y), text).color(weak).anchor(Align2::LEFT_TOP));
            }
        }
    });
}
