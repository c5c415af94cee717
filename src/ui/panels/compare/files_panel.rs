//! The panel “Picture files”: layer, range, histogram and statistics of each compared picture file, and its values at the
//! picked and the watched pixels.

use std::sync::Arc;

use eframe::egui::{Label, RichText, Ui, vec2};

use crate::inspect::statistics::Statistics;
use crate::inspect::view::Range;
use crate::manual::Chapter;
use crate::pipeline::settings::Choice as _;
use crate::ui::format;
use crate::ui::panels::range::figures;
use crate::ui::panels::range::plot::HistogramPlot;
use crate::ui::panels::{PanelSpec, scrolling};
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::compare::CompareChange;
use crate::ui::session::compare::files::{OpenedPicture, PictureLook};
use crate::ui::session::picture_role::PictureRole;
use crate::ui::session::range::RangeChange;
use crate::ui::theme::{Icon, font_size, space, tokens};
use crate::ui::widgets::{combo, empty_state, number_field};

/// Description of the panel.
pub(crate) const PANEL: PanelSpec = PanelSpec {
    chapter: Chapter::ComparingUpscalers,
    grows: false,
    titled: true,
    controls: Some(|ui, cx| controls(ui, cx.session, cx.commands)),
    content: |ui, cx| self::ui(ui, cx.session, cx.commands),
};

/// Height of a histogram, in points.
const PLOT_HEIGHT: f32 = 110.0;

/// Maximum number of watched pixels whose values are listed.
const MAX_LISTED: usize = 8;

fn controls(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let is_log = |(_, opened): &(PictureRole, Arc<OpenedPicture>)| {
        session.features.range.uses_log_counts(&opened.statistics().histograms)
    };
    let mut log = shown_files(session).iter().any(is_log);
    let checkbox = ui.checkbox(&mut log, "logarithmic counts");
    if checkbox.on_hover_text("Logarithmic bars, so that rare values are visible, too").changed() {
        commands.push(Command::Range(RangeChange::LogCounts(log)));
    }
}

/// Returns the picture files that are being compared.
fn shown_files(session: &Session) -> Vec<(PictureRole, Arc<OpenedPicture>)> {
    let (comparison, tiles) = (&session.features.comparison, &session.state.tiles);
    let roles = (0..comparison.shown(tiles)).map(PictureRole::Tile).chain([PictureRole::Reference]);
    roles.filter_map(|role| Some((role, comparison.pictures.get(tiles.file(role)?)?))).collect()
}

fn ui(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let files = shown_files(session);
    if files.is_empty() {
        let how = "Open a picture of any program as A, B or reference with “Open picture…” above the pictures.";
        return empty_state(ui, Icon::Image, "No picture file is compared", how);
    }
    scrolling(ui, |ui| {
        for (role, opened) in files {
            file(ui, session, role, &opened, commands);
            ui.add_space(space::M);
        }
    });
}

/// Draws everything about one file.
fn file(ui: &mut Ui, session: &Session, role: PictureRole, opened: &OpenedPicture, commands: &mut Vec<Command>) {
    let name = role.name();
    ui.add(Label::new(RichText::new(format!("{name}: {}", opened.name())).strong()).wrap());
    let description = RichText::new(opened.picture.description()).small().color(tokens(ui).text_weak);
    ui.add(Label::new(description).wrap());
    let mut look = opened.look().clone();
    layers(ui, &name, opened, &mut look);
    let statistics = opened.statistics();
    let range = look.range.or(statistics.extent);
    let layer = opened.layer();
    let channels: Vec<&str> = opened.picture.channels_of(layer).map(|channel| channel.name.as_str()).collect();
    if layer.is_color {
        let help = "Exposure and tone curve of colours are above the pictures";
        ui.label(RichText::new("Stored values").small()).on_hover_text(help);
    } else {
        bounds(ui, &name, range, &mut look);
    }
    let grey = |range: Range, value: f32| {
        let code = (range.position(value) * 255.0).round() as u8;
        [code, code, code, 255]
    };
    let plot = HistogramPlot {
        histograms: &statistics.histograms,
        channels: &channels[..statistics.histograms.len().min(channels.len())],
        range,
        color: &grey,
        log_counts: session.features.range.uses_log_counts(&statistics.histograms),
    };
    let size = vec2(ui.available_width(), PLOT_HEIGHT);
    if let Some(range) = plot.ui(ui, size).filter(|_| !layer.is_color) {
        look.range = Some(range);
    }
    for (channel, statistics) in channels.iter().zip(&statistics.whole) {
        ui.add(Label::new(RichText::new(summary(channel, statistics)).monospace().size(font_size::SMALL)).wrap());
    }
    errors(ui, session, role, opened);
    values(ui, session, opened);
    if look != *opened.look() {
        commands.push(Command::Compare(CompareChange::Look(opened.path.clone(), look)));
    }
}

/// Draws the list of layers if there are several.
fn layers(ui: &mut Ui, name: &str, opened: &OpenedPicture, look: &mut PictureLook) {
    let layers = opened.picture.layers();
    if layers.len() < 2 {
        return;
    }
    ui.name_inputs(format!("Layer of {name}"), |ui| {
        let chosen = opened.layer().name.clone();
        combo(&format!("layer {name}"), &chosen, ui.available_width().min(180.0)).show_ui(ui, |ui| {
            for layer in layers {
                let kind = if layer.is_color { "colour" } else { "data" };
                if ui.selectable_label(layer.name == chosen, &layer.name).on_hover_text(kind).clicked() {
                    *look = PictureLook { layer: Some(layer.name.clone()), range: None };
                }
            }
        });
    });
}

/// Draws the values that are shown as black and as white.
fn bounds(ui: &mut Ui, name: &str, range: Option<Range>, look: &mut PictureLook) {
    let Some(Range { mut low, mut high }) = range else { return };
    ui.horizontal(|ui| {
        let speed = (f64::from(high - low) / 300.0).max(f64::from(f32::MIN_POSITIVE));
        for (bound, value) in [("Black", &mut low), ("White", &mut high)] {
            ui.name_inputs(format!("{bound} in {name}"), |ui| {
                let field = number_field(value, |value| (value as f32).to_string()).speed(speed);
                ui.add(field).on_hover_text(format!("Value that is shown as {}", bound.to_lowercase()));
            });
        }
        if Some(Range { low, high }) != range && low.is_finite() && high.is_finite() {
            look.range = Some(Range { low, high: high.max(low) });
        }
        if ui.button("Fit").on_hover_text("Show the smallest value as black and the largest as white").clicked() {
            look.range = None;
        }
    });
}

/// Returns the statistics of a channel in one line.
fn summary(channel: &str, statistics: &Statistics) -> String {
    let [count, min, max, mean, deviation, nan, infinite] = figures::texts(statistics);
    let odd =
        if statistics.nan + statistics.infinite > 0 { format!(", {nan} NaN, {infinite} ∞") } else { String::new() };
    format!("{channel}: {min} … {max}, mean {mean}, σ {deviation}, n {count}{odd}")
}

/// Lists the errors of the stored values against the reference, if it is a file, too.
fn errors(ui: &mut Ui, session: &Session, role: PictureRole, opened: &OpenedPicture) {
    let PictureRole::Tile(tile) = role else { return };
    let against = session.features.comparison.opened(&session.state.tiles, PictureRole::Reference);
    if against.is_some_and(|against| against.path == opened.path) {
        return;
    }
    let compared =
        session.features.comparison.compared.as_ref().and_then(|compared| compared.tiles.get(tile)?.measured.as_ref());
    let Some(stored) = compared.and_then(|measured| measured.stored.as_ref()) else { return };
    let reference = session.features.comparison.reference_name(&session.state.tiles);
    let help = "Errors of the stored values, as the command “compare” measures them; those below the picture are of what is shown";
    ui.label(RichText::new(format!("Stored values against {reference}")).small()).on_hover_text(help);
    for (metric, value) in &stored.metrics {
        let Some(value) = value else { continue };
        let text = format!("{} {}", metric.name(), metric.format(*value));
        ui.label(RichText::new(text).monospace().size(font_size::SMALL)).on_hover_text(metric.help());
    }
    if stored.non_finite_pixels > 0 {
        let text = format!("{} px are NaN or infinite in one picture only", format::count(stored.non_finite_pixels));
        ui.label(RichText::new(text).small().color(tokens(ui).warning));
    }
}

/// Lists the stored values at the picked and at the watched pixels.
fn values(ui: &mut Ui, session: &Session, opened: &OpenedPicture) {
    let (width, height) = opened.picture.size();
    let watched = session.features.watch.pixels.iter().take(MAX_LISTED).copied();
    let pixels = session.pick.into_iter().chain(watched.filter(|pixel| Some(*pixel) != session.pick));
    for (x, y) in pixels.filter(|(x, y)| *x < width && *y < height) {
        let text = format!("{x}, {y}:  {}", opened.values_at((x, y)));
        ui.add(Label::new(RichText::new(text).monospace().size(font_size::SMALL)).wrap().selectable(true));
    }
}
