//! Frame time of each upscaler: one line per upscaler with a point for every measured frame, and a bar with median and
//! spread.
//!
//! The frame times are measured with the current scene, view and settings. Every round times each upscaler once, so
//! that changes of the machine's speed affect all upscalers alike.

use eframe::egui::{self, Button, Color32, Grid, ProgressBar, RichText, ScrollArea, Ui};
use egui_plot::{Bar, BarChart, HoverPosition, Line, Plot, PlotPoints, Points, uniform_grid_spacer};

use crate::manual::Chapter;
use crate::measure::noise::WITHIN;
use crate::measure::timing::{Summary, summarize};
use crate::ui::command::Command;
use crate::ui::format;
use crate::ui::session::Session;
use crate::ui::theme::{Icon, tokens};
use crate::ui::ticks::{self, round_steps};
use crate::ui::timings::TimingsView;
use crate::ui::widgets::{empty_state, figure, icon_button};
use crate::ui::workspace::PanelSpec;
use crate::upscale::Upscaling;

/// Description of the panel.
pub(crate) const PANEL: PanelSpec = PanelSpec {
    id: "frame-time",
    name: "Frame time",
    help: "Frame time of each upscaler",
    chapter: Chapter::ErrorAgainstTime,
    grows: true,
    controls: Some(|ui, cx| controls(ui, cx.session, cx.commands)),
    content: |ui, cx| self::ui(ui, cx.session, cx.commands),
};

/// Width of the table of frame times, in points.
const TABLE_POINTS: f32 = 520.0;

/// Minimum length of the plot's frame axis, in frames.
const MIN_FRAMES: f64 = 10.0;

/// Width of a column of the table, in points.
const FIGURE_POINTS: f32 = 56.0;

/// Index of the median among the numbers of a table row.
const MEDIAN_COLUMN: usize = 1;

/// Upscaler with its measured frame times.
struct MethodTimes {
    upscaling: Upscaling,
    color: Color32,
    times_ms: Vec<f64>,
    summary: Summary,
}

/// Draws the plots and the table of frame times.
pub(crate) fn ui(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let series = collect(ui, session);
    if series.is_empty() {
        empty_state(
            ui,
            Icon::ChartLine,
            "No frame times yet",
            "“Measure all upscalers” times every upscaler with the current scene, view and size.",
        );
        return;
    }
    let height = ui.available_height();
    ui.horizontal_top(|ui| {
        let plots = (ui.available_width() - TABLE_POINTS - 24.0).max(200.0);
        let size = egui::vec2((plots * 0.6).floor(), height);
        match session.timings.view {
            TimingsView::Lines => lines(ui, &series, size),
            TimingsView::Distribution => distribution(ui, &series, size),
        }
        bars(ui, &series, egui::vec2((plots * 0.4).floor(), height));
        ScrollArea::vertical().id_salt("times table").show(ui, |ui| {
            ui.vertical(|ui| {
                table(ui, &series, session, commands);
                spikes(ui, session);
                window(ui, session);
            });
        });
    });
}

/// Draws the buttons, and the scene and size that the times were measured with.
pub(crate) fn controls(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    if let Some(measuring) = session.measuring {
        if ui.button("Cancel").on_hover_text("Stop the measurement and keep the results so far").clicked() {
            commands.push(Command::CancelMeasure);
        }
        ui.add(ProgressBar::new(measuring.progress).desired_width(240.0).show_percentage());
    } else {
        let measure = Button::new((crate::ui::theme::icon(Icon::Timer), "Measure all upscalers"));
        let help = "Time every upscaler in interleaved rounds with the current scene, view and size, and measure its \
                    error on the same frames. The tab “Error vs time” selects a moving or a still camera";
        if ui.add(measure).on_hover_text(help).clicked() {
            commands.push(Command::Measure);
        }
        if ui.button("Clear").on_hover_text("Delete all frame times").clicked() {
            commands.push(Command::ClearTimings);
        }
    }
    let paused = session.timings.paused;
    let (icon, name) = if paused {
        (Icon::Play, "Resume recording frame times")
    } else {
        (Icon::Pause, "Pause recording frame times")
    };
    if icon_button(ui, icon, name).clicked() {
        commands.push(Command::PauseTimings);
    }
    if icon_button(ui, Icon::Download, "Save all frame times as CSV").clicked() {
        commands.push(Command::ExportTimings);
    }
    for (view, name, help) in [
        (TimingsView::Lines, "Lines", "Frame times in drawing order"),
        (TimingsView::Distribution, "Distribution", "Cumulative distribution of frame times"),
    ] {
        if ui.selectable_label(session.timings.view == view, name).on_hover_text(help).clicked() {
            commands.push(Command::ShowTimings(view));
        }
    }
    let viewport = session.viewport();
    let timings = &session.timings;
    let text = if !timings.has_measurement() {
        format!("Recent frames · {} · {} × {} px", session.scene.name, viewport.width, viewport.height)
    } else if timings.measurement_fits(&session.request()) {
        let noise = timings.noise().map(|noise| format!(" · noise floor {}", noise.words())).unwrap_or_default();
        format!("Measured · {} · {} × {} px{noise}", session.scene.name, viewport.width, viewport.height)
    } else {
        "Measured with a different scene, view, size or setting; measure again to update".to_owned()
    };
    ui.add(egui::Label::new(RichText::new(text).color(tokens(ui).text_weak)).truncate());
}

fn collect(ui: &Ui, session: &Session) -> Vec<MethodTimes> {
    let colors = tokens(ui).series;
    let color_of = |upscaling| Upscaling::every().position(|u| u == upscaling).map_or(0, |i| i % colors.len());
    let series = session.timings.series().into_iter().filter_map(|(upscaling, times_ms)| {
        let summary = summarize(&times_ms)?;
        Some(MethodTimes { upscaling, color: colors[color_of(upscaling)], times_ms, summary })
    });
    series.collect()
}

fn lines(ui: &mut Ui, series: &[MethodTimes], size: egui::Vec2) {
    Plot::new("frame times")
        .width(size.x)
        .height(size.y)
        .x_axis_label("Frame")
        .include_x(0.0)
        .include_x(MIN_FRAMES)
        .y_axis_label("Frame time (ms)")
        .include_y(0.0)
        .y_grid_spacer(uniform_grid_spacer(|input| round_steps(&input)))
        .y_axis_formatter(ticks::number)
        .allow_scroll(false)
        .label_formatter(|position| match position {
            HoverPosition::NearDataPoint { plot_name, position, .. } => {
                Some(format!("{plot_name}: {} in frame {}", format::ms(position.y), position.x))
            }
            HoverPosition::Elsewhere { .. } => None,
        })
        .show(ui, |plot| {
            for s in series {
                // The slowest frame has its own mark, however many frames share its screen column.
                let slowest = s.times_ms.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
                if let Some((frame, ms)) = slowest {
                    let at = PlotPoints::from(vec![[frame as f64, *ms]]);
                    plot.points(Points::new(s.upscaling.label(), at).color(s.color).radius(2.5));
                }
                let points: PlotPoints<'_> = s.times_ms.iter().enumerate().map(|(i, t)| [i as f64, *t]).collect();
                if s.times_ms.len() == 1 {
                    plot.points(Points::new(s.upscaling.label(), points).color(s.color).radius(3.0));
                } else {
                    plot.line(Line::new(s.upscaling.label(), points).color(s.color).width(1.5));
                }
            }
        });
}

/// Draws the cumulative distribution: the fraction of frames that took at most a given time. A steep curve means steady
/// times, and a long tail to the right means spikes.
fn distribution(ui: &mut Ui, series: &[MethodTimes], size: egui::Vec2) {
    Plot::new("distribution of frame times")
        .width(size.x)
        .height(size.y)
        .x_axis_label("Frame time (ms)")
        .y_axis_label("Share of frames")
        .include_y(0.0)
        .include_y(1.0)
        .allow_scroll(false)
        .label_formatter(|position| match position {
            HoverPosition::NearDataPoint { plot_name, position, .. } => Some(format!(
                "{plot_name}: {} of frames took at most {}",
                format::percent(position.y),
                format::ms(position.x)
            )),
            HoverPosition::Elsewhere { .. } => None,
        })
        .show(ui, |plot| {
            for s in series {
                let mut sorted = s.times_ms.clone();
                sorted.sort_by(f64::total_cmp);
                let count = sorted.len() as f64;
                let steps = sorted
                    .iter()
                    .enumerate()
                    .flat_map(|(below, ms)| [[*ms, below as f64 / count], [*ms, (below + 1) as f64 / count]]);
                let points = PlotPoints::from(steps.collect::<Vec<_>>());
                plot.line(Line::new(s.upscaling.label(), points).color(s.color).width(1.5));
            }
        });
}

/// Draws a list of the slowest frames since the last change of scene, settings or size. These frames may no longer be
/// visible in the plot.
fn spikes(ui: &mut Ui, session: &Session) {
    if session.timings.has_measurement() || session.timings.slowest().is_empty() {
        return;
    }
    let slowest = session.timings.slowest().iter();
    let words: Vec<_> = slowest.map(|(upscaling, ms)| format!("{} {}", upscaling.label(), format::ms(*ms))).collect();
    let text = RichText::new(format!("Slowest frames: {}", words.join(", "))).small().color(tokens(ui).text_weak);
    ui.add(egui::Label::new(text).wrap()).on_hover_text("Slowest frames since scene, settings or size last changed");
}

/// Draws the median and the 99th percentile of the time spent in a pass of the user interface, excluding the rendering
/// of the picture.
fn window(ui: &mut Ui, session: &Session) {
    let Some(Summary { median, p99, .. }) = session.window_times.summary() else { return };
    let text = format!("User interface: median {}, p99 {}", format::ms(median), format::ms(p99));
    ui.add(egui::Label::new(RichText::new(text).small().color(tokens(ui).text_weak)).wrap()).on_hover_text(
        "Time spent in one pass of the user interface: laying out the panels, tessellating them and submitting the \
         triangles to the graphics driver. The picture is not included, because other threads draw it. Median and \
         99th percentile of the last passes; an idle window runs none",
    );
}

/// Draws one bar per upscaler up to its median, with an error bar from the 10th to the 90th percentile.
fn bars(ui: &mut Ui, series: &[MethodTimes], size: egui::Vec2) {
    let names: Vec<String> = series.iter().map(|s| s.upscaling.label()).collect();
    Plot::new("medians")
        .width(size.x)
        .height(size.y)
        .y_axis_label("Median frame time (ms)")
        .show_x(false)
        .include_y(0.0)
        .include_x(-0.6)
        .include_x(series.len() as f64 - 0.4)
        .y_grid_spacer(uniform_grid_spacer(|input| round_steps(&input)))
        .y_axis_formatter(ticks::number)
        .allow_scroll(false)
        .show_axes([false, true])
        .label_formatter(move |position| match position {
            HoverPosition::NearDataPoint { plot_name, .. } => Some((*plot_name).to_owned()),
            HoverPosition::Elsewhere { .. } => None,
        })
        .show(ui, |plot| {
            for (index, (s, name)) in series.iter().zip(&names).enumerate() {
                let x = index as f64;
                let bar = Bar::new(x, s.summary.median).width(0.7).fill(s.color.gamma_multiply(0.55)).name(name);
                plot.bar_chart(BarChart::new(name, vec![bar]).color(s.color));
                plot.line(bracket(x, s));
            }
        });
}

fn bracket(x: f64, series: &MethodTimes) -> Line<'static> {
    const HALF_WIDTH: f64 = 0.16;
    let (low, high) = (series.summary.p10, series.summary.p90);
    let points = vec![
        [x - HALF_WIDTH, low],
        [x + HALF_WIDTH, low],
        [x, low],
        [x, high],
        [x - HALF_WIDTH, high],
        [x + HALF_WIDTH, high],
    ];
    Line::new(series.upscaling.label(), PlotPoints::from(points)).color(series.color).width(1.5)
}

fn table(ui: &mut Ui, series: &[MethodTimes], session: &Session, commands: &mut Vec<Command>) {
    Grid::new("times").num_columns(7).striped(true).spacing([12.0, 4.0]).show(ui, |ui| {
        ui.label(RichText::new("Upscaler").small().color(tokens(ui).text_weak));
        for heading in ["n", "median", "p10", "p90", "p99", "max ms"] {
            figure(ui, heading, FIGURE_POINTS, tokens(ui).text_weak);
        }
        ui.end_row();
        for s in series {
            let chosen = session.state.recipe.upscaler == s.upscaling;
            ui.horizontal(|ui| {
                let (mark, _) = ui.allocate_exact_size(egui::vec2(12.0, 12.0), egui::Sense::hover());
                ui.painter().rect_filled(mark.shrink2(egui::vec2(0.0, 4.0)), 1.0, s.color);
                let label = ui.selectable_label(chosen, s.upscaling.label());
                if label.on_hover_text("Draw with this upscaler").clicked() {
                    let recipe = crate::chain::Recipe { upscaler: s.upscaling, ..session.state.recipe };
                    commands.push(Command::SetRecipe(recipe));
                }
            });
            let Summary { n, median, p10, p90, p99, max, .. } = s.summary;
            let times = [median, p10, p90, p99, max].map(|ms| format::fixed(ms, 2));
            let is_noise = session.timings.is_within_noise_of_native(s.upscaling);
            for (column, text) in std::iter::once(n.to_string()).chain(times).enumerate() {
                if column == MEDIAN_COLUMN && is_noise {
                    figure(ui, &text, FIGURE_POINTS, tokens(ui).text_weak).on_hover_text(format!("{WITHIN} of native"));
                } else {
                    figure(ui, &text, FIGURE_POINTS, tokens(ui).text);
                }
            }
            ui.end_row();
        }
    });
}
