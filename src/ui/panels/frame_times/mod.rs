//! Frame time of each upscaler: a dot plot with one row per method and scale, and a plot of single frames.
//!
//! The frame times are measured with the current scene, view and settings. Every round times each upscaler once, so
//! that changes of the machine's speed affect all upscalers alike.

mod axis;

mod columns;

mod history;

mod list;

mod marks;

mod rows;

mod series;

mod toolbar;

mod tooltip;

use eframe::egui::{self, Button, ProgressBar, RichText, Sense, Ui, Vec2, vec2};

use self::axis::TimeAxis;
use self::list::MethodListView;
use self::rows::MethodRow;
use crate::manual::Chapter;
use crate::measure::timing::Summary;
use crate::ui::format;
use crate::ui::panels::PanelSpec;
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::long_tasks::MeasureCommand;
use crate::ui::session::timings::{RowOrder, TimingsChange};
use crate::ui::theme::{self, Icon, space, tokens};
use crate::ui::widgets::{empty_state, icon_button};

/// Description of the panel.
pub(crate) const PANEL: PanelSpec = PanelSpec {
    chapter: Chapter::ErrorAgainstTime,
    grows: true,
    titled: true,
    controls: Some(|ui, cx| controls(ui, cx.session, cx.commands)),
    content: |ui, cx| self::ui(ui, cx.session, cx.commands),
};

/// Minimum width at which the plot of single frames is beside the rows, in points.
const BESIDE_WIDTH: f32 = 900.0;

/// Fraction of the width of the rows if the plot of single frames is beside them.
const BESIDE_SHARE: f32 = 0.6;

/// Minimum height at which the plot of single frames is below the rows even in a wide panel, in points.
const BELOW_HEIGHT: f32 = 420.0;

/// Minimum height of the plot of single frames, in points.
const SERIES_MIN: f32 = 110.0;

/// Fraction of the height of the plot of single frames below the rows.
const SERIES_SHARE: f32 = 0.28;

/// Minimum number of rows that stay visible above the plot of single frames.
const MIN_ROWS: f32 = 3.0;

/// Place of the plot of single frames.
#[derive(Clone, Copy, Debug, PartialEq)]
enum SeriesPlace {
    /// To the right of the rows, which have this width in points.
    Beside(f32),
    /// Below the rows, which have this height in points.
    Below(f32),
    /// Nowhere, because the panel is too small.
    Hidden,
}

impl SeriesPlace {
    /// Chooses the place in an area of `size` points.
    fn within(size: Vec2) -> Self {
        let least = list::HEADER + MIN_ROWS * list::ROW;
        if size.y < BELOW_HEIGHT && size.x >= BESIDE_WIDTH {
            Self::Beside((size.x * BESIDE_SHARE).floor())
        } else if size.y >= least + SERIES_MIN {
            Self::Below((size.y - (size.y * SERIES_SHARE).max(SERIES_MIN)).floor())
        } else {
            Self::Hidden
        }
    }
}

/// Draws the rows and the plot of single frames.
pub(crate) fn ui(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let all = rows::collect(session);
    if all.is_empty() {
        empty_state(
            ui,
            Icon::ChartLine,
            "No frame times yet",
            "“Measure all upscalers” times every upscaler with the current scene, view and size.",
        );
        return;
    }
    toolbar::ui(ui, &all, session, commands);
    disturbance(ui, session);
    // Slower outliers have an arrow at the end of the axis, so that one slow frame does not compress all other rows.
    let axis = TimeAxis::covering(all.iter().flat_map(|row| [row.summary.p10, row.summary.p90]));
    let rows = shown(&all, session);
    let list = MethodListView { rows: &rows, axis, session };
    let notes = |ui: &mut Ui| {
        spikes(ui, session);
        window(ui, session);
    };
    let size = ui.available_size();
    match SeriesPlace::within(size) {
        SeriesPlace::Beside(width) => {
            ui.horizontal_top(|ui| {
                ui.allocate_ui(vec2(width, size.y), |ui| ui.vertical(|ui| list.ui(ui, commands, notes)));
                ui.vertical(|ui| series::ui(ui, &all, ui.available_size(), session, commands));
            });
        }
        SeriesPlace::Below(height) => {
            ui.allocate_ui(vec2(size.x, height), |ui| ui.vertical(|ui| list.ui(ui, commands, notes)));
            ui.add_space(space::S);
            series::ui(ui, &all, ui.available_size(), session, commands);
        }
        SeriesPlace::Hidden => {
            ui.vertical(|ui| list.ui(ui, commands, notes));
        }
    }
}

/// Returns the rows that the filter shows, sorted. During a measurement, rows have the order of the menus, because
/// sorting by preliminary results would move them in every round.
fn shown(all: &[MethodRow], session: &Session) -> Vec<MethodRow> {
    let list = &session.features.timings.list;
    let mut rows: Vec<_> = all.iter().filter(|row| list.shows(row.upscaling)).cloned().collect();
    let order = if session.features.tasks.measuring.is_some() { RowOrder::Method } else { list.order };
    rows::sort(&mut rows, order);
    rows
}

/// Draws the buttons, and the scene and size that the times were measured with.
pub(crate) fn controls(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    if let Some(measuring) = session.features.tasks.measuring {
        if ui.button("Cancel").on_hover_text("Stop the measurement and keep the results so far").clicked() {
            commands.push(Command::Measure(MeasureCommand::CancelUpscalers));
        }
        ui.add(ProgressBar::new(measuring.progress).desired_width(240.0).show_percentage());
    } else {
        let measure = Button::new((theme::icon(Icon::Timer), "Measure all upscalers"));
        let help = "Time every upscaler in interleaved rounds with the current scene, view and size, and measure its \
                    error on the same frames. The panel “Error vs time” selects a moving or a still camera";
        if ui.add(measure).on_hover_text(help).clicked() {
            commands.push(Command::Measure(MeasureCommand::MeasureUpscalers));
        }
        if ui.button("Clear").on_hover_text("Delete all frame times").clicked() {
            commands.push(Command::Timings(TimingsChange::Clear));
        }
    }
    let automatic = session.features.timings.automatic;
    let help = "Measure by itself while this panel is open, as soon as you and all other programs are idle";
    if ui.selectable_label(automatic, "Automatic").on_hover_text(help).clicked() {
        commands.push(Command::Timings(TimingsChange::Automatic(!automatic)));
    }
    let paused = session.features.timings.paused;
    let (icon, name) = if paused {
        (Icon::Play, "Resume recording frame times")
    } else {
        (Icon::Pause, "Pause recording frame times")
    };
    if icon_button(ui, icon, name).clicked() {
        commands.push(Command::Timings(TimingsChange::TogglePaused));
    }
    if icon_button(ui, Icon::Download, "Save all frame times as CSV").clicked() {
        commands.push(Command::Timings(TimingsChange::Export));
    }
    let viewport = session.viewport();
    let timings = &session.features.timings;
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

/// Draws a warning if other programs were busy during the measurement.
fn disturbance(ui: &mut Ui, session: &Session) {
    let Some(share) = session.features.timings.disturbance() else { return };
    let text = format!(
        "Other programs use up to {} of the processors, so these times may be too long. Close them and measure again.",
        format::percent(share)
    );
    let color = tokens(ui).warning;
    ui.horizontal(|ui| {
        let (rect, _) = ui.allocate_exact_size(Vec2::splat(theme::ICON_SIZE), Sense::hover());
        theme::paint_icon(ui.painter(), rect.center(), Icon::TriangleAlert, theme::ICON_SIZE, color);
        ui.add(egui::Label::new(RichText::new(text).color(color)).wrap());
    });
}

/// Draws a list of the slowest frames since the last change of scene, settings or size. These frames may no longer be
/// visible in the plot.
fn spikes(ui: &mut Ui, session: &Session) {
    if session.features.timings.has_measurement() || session.features.timings.slowest().is_empty() {
        return;
    }
    let slowest = session.features.timings.slowest().iter();
    let words: Vec<_> = slowest.map(|(upscaling, ms)| format!("{} {}", upscaling.label(), format::ms(*ms))).collect();
    let text = RichText::new(format!("Slowest frames: {}", words.join(", "))).small().color(tokens(ui).text_weak);
    ui.add(egui::Label::new(text).wrap()).on_hover_text("Slowest frames since scene, settings or size last changed");
}

/// Draws the median and the 99th percentile of the time spent in a pass of the user interface, excluding the rendering
/// of the picture.
fn window(ui: &mut Ui, session: &Session) {
    let Some(Summary { median, p99, .. }) = session.features.timings.window.summary() else { return };
    let text = format!("User interface: median {}, p99 {}", format::ms(median), format::ms(p99));
    ui.add(egui::Label::new(RichText::new(text).small().color(tokens(ui).text_weak)).wrap()).on_hover_text(
        "Time spent in one pass of the user interface: laying out the panels, tessellating them and submitting the \
         triangles to the graphics driver. The picture is not included, because other threads draw it. Median and \
         99th percentile of the last passes; an idle window runs none",
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn single_frames_are_beside_the_rows_in_low_panels_and_below_them_in_high_ones() {
        let place = |width, height| SeriesPlace::within(vec2(width, height));
        assert_eq!(place(1280.0, 150.0), SeriesPlace::Beside(768.0));
        assert_eq!(place(1280.0, 500.0), SeriesPlace::Below(360.0));
        assert_eq!(place(420.0, 300.0), SeriesPlace::Below(190.0));
        assert_eq!(place(420.0, 120.0), SeriesPlace::Hidden);
    }
}
