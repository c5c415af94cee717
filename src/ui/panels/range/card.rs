//! The range card in the lower left corner of the canvas: name of the shown quantity, its histogram with draggable
//! handles, and the range controls.

use eframe::egui::{
    self, Align, Button, Label, Layout, Rect, Response, RichText, Ui, UiBuilder, Vec2, WidgetInfo, vec2,
};

use super::figures::{self, row};
use super::plot::{HistogramPlot, color_of};
use crate::inspect::display::{ColorMap, ValueKind};
use crate::inspect::histogram::Histogram;
use crate::inspect::range::{RangeFit, Rule};
use crate::inspect::view::{Range, absence};
use crate::manual::Chapter;
use crate::pipeline::settings::Choice as _;
use crate::ui::engine::look::kind;
use crate::ui::engine::{RenderedView, Shown};
use crate::ui::manual::manual_button;
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::range::RangeChange;
use crate::ui::theme::{self, Icon, RADIUS, ROW_HEIGHT, space, tokens};
use crate::ui::widgets::{combo, icon_button, number_field};

/// Width of the range card, in points.
const WIDTH: f32 = 320.0;

/// Height of the histogram including the numbers on its axis, in points.
const PLOT_HEIGHT: f32 = 78.0;

/// Width of the number field for the minimum or maximum of the range, in points.
const FIELD: f32 = 84.0;

/// Draws the range card.
pub(crate) fn ui(ui: &mut Ui, canvas: Rect, session: &Session, view: &RenderedView, commands: &mut Vec<Command>) {
    let control = &session.features.range;
    let shown = view.request.shown;
    let kind = kind(shown);
    let part_rows = match view.look_result.measured.as_deref().and_then(|measured| measured.part.as_ref()) {
        Some((_, channels)) => 1 + channels.len(),
        None => 0,
    };
    let rows = if kind == ValueKind::Names { 2.0 } else { 3.0 } + part_rows as f32;
    let plot = if kind == ValueKind::Names { 0.0 } else { PLOT_HEIGHT + space::XS };
    let size = vec2(WIDTH.min(canvas.width() - 2.0 * space::S), rows * ROW_HEIGHT + plot + 2.0 * space::S);
    let card = Rect::from_min_size(canvas.left_bottom() + vec2(space::S, -space::S - size.y), size);
    ui.painter().rect_filled(card, RADIUS, tokens(ui).panel.gamma_multiply(0.94));
    // The card captures pointer input, so that it does not reach the picture below.
    ui.interact(card, ui.scope_id().with("range card"), egui::Sense::click_and_drag());
    let inner = UiBuilder::new().max_rect(card.shrink(space::S)).layout(Layout::top_down(Align::Min));
    let mut column = ui.new_child(inner);
    column.spacing_mut().item_spacing.y = 0.0;
    let mut changes = Vec::new();
    row(&mut column, |ui| title(ui, view, &mut changes, commands));
    if kind == ValueKind::Names {
        column.weak("These values are identifiers, not quantities, so they have no range.");
    } else {
        let setting = control.setting(shown);
        let size = vec2(column.available_width(), PLOT_HEIGHT);
        let color = |range, value| color_of(shown, &setting, range, value);
        let histograms = histograms(view);
        let plot = HistogramPlot {
            histograms,
            channels: kind.channels(),
            range: view.range,
            color: &color,
            log_counts: control.uses_log_counts(histograms),
        };
        changes.extend(plot.ui(&mut column, size).map(|range| RangeChange::Rule(Rule::Fixed(range))));
        column.add_space(space::XS);
        row(&mut column, |ui| ends(ui, session, view, &mut changes));
        row(&mut column, |ui| colors(ui, session, kind, shown, &mut changes));
        if let Some((region, channels)) = view.look_result.measured.as_deref().and_then(|m| m.part.as_ref()) {
            figures::part(&mut column, *region, kind, channels, &mut changes);
        }
    }
    commands.extend(changes.into_iter().map(Command::Range));
}

fn title(ui: &mut Ui, view: &RenderedView, changes: &mut Vec<RangeChange>, commands: &mut Vec<Command>) {
    let shown = view.request.shown;
    let missing = match shown.source() {
        Shown::Buffer(buffer) => absence(buffer, &view.frame),
        Shown::Stage(_) | Shown::Intermediate(_) => None,
    };
    let (name, help) = (shown.name(), missing.unwrap_or(shown.help()));
    ui.label(RichText::new(name).strong());
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        if icon_button(ui, Icon::ChevronDown, "Hide the range controls").clicked() {
            changes.push(RangeChange::Open(false));
        }
        manual_button(ui, Chapter::ReadingPlots, commands);
        ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
            ui.add(Label::new(RichText::new(help).small().color(tokens(ui).text_weak)).truncate()).on_hover_text(help);
        });
    });
}

/// Draws number fields for the minimum and maximum of the range and, between the fields, buttons that fit the range.
fn ends(ui: &mut Ui, session: &Session, view: &RenderedView, changes: &mut Vec<RangeChange>) {
    let Some(range) = view.range else { return };
    let rule = session.features.range.setting(view.request.shown).display.rule;
    if let Some(low) = field(ui, "Lower bound of the range", range.low, range) {
        changes.push(RangeChange::Rule(Rule::Fixed(Range { low, high: range.high.max(low) })));
    }
    fits(ui, session, rule, changes);
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        if let Some(high) = field(ui, "Upper bound of the range", range.high, range) {
            changes.push(RangeChange::Rule(Rule::Fixed(Range { low: range.low.min(high), high })));
        }
    });
}

/// Draws a number field that can be dragged or edited as text. Returns the new value if the user changed it to a finite
/// number.
fn field(ui: &mut Ui, name: &str, value: f32, range: Range) -> Option<f32> {
    /// Drag distance, in points, that changes the value by the width of `range`.
    const POINTS: f64 = 300.0;
    let mut number = f64::from(value);
    let speed = ((f64::from(range.high) - f64::from(range.low)) / POINTS).max(f64::from(f32::MIN_POSITIVE));
    let drag = number_field(&mut number, |value| (value as f32).to_string()).speed(speed);
    let response = ui.add_sized(vec2(FIELD, theme::CONTROL_HEIGHT), drag);
    response.widget_info(|| WidgetInfo::labeled(egui::Role::SpinButton, true, name));
    let changed = response.on_hover_text(format!("{name}: drag, or click and type")).changed();
    (changed && (number as f32).is_finite()).then_some(number as f32)
}

fn fits(ui: &mut Ui, session: &Session, rule: Rule, changes: &mut Vec<RangeChange>) {
    ui.spacing_mut().item_spacing.x = 1.0;
    let sticky = matches!(rule, Rule::Sticky(_));
    let help = "Fit the range to the smallest and largest value  (N). Right-click: refit to every new picture";
    let fit = toggle(ui, Icon::WandSparkles, sticky, help);
    if fit.clicked() {
        changes.push(RangeChange::Fit(RangeFit::All));
    } else if fit.secondary_clicked() {
        changes.push(RangeChange::ToggleSticky);
    }
    if icon_button(ui, Icon::Scan, "Fit the range to the visible part of the picture  (Shift+N)").clicked() {
        changes.push(RangeChange::FitVisible);
    }
    let most = toggle(
        ui,
        Icon::Percent,
        rule == Rule::Sticky(RangeFit::Most),
        "Fit the range to the 1st to 99th percentile. Right-click: refit to every new picture",
    );
    if most.clicked() {
        changes.push(RangeChange::Fit(RangeFit::Most));
    } else if most.secondary_clicked() {
        changes.push(RangeChange::Rule(Rule::Sticky(RangeFit::Most)));
    }
    let region = session.features.range.region;
    ui.add_enabled_ui(region.is_some(), |ui| {
        let fit = icon_button(ui, Icon::Focus, "Fit the range to the values in the selected box");
        if let Some(region) = region.filter(|_| fit.on_disabled_hover_text("Drag a box on the picture first").clicked())
        {
            changes.push(RangeChange::Fit(RangeFit::Within(region)));
        }
    });
    if icon_button(ui, Icon::ZoomIn, "Zoom the histogram to the range").clicked() {
        changes.push(RangeChange::ZoomAxis);
    }
    if icon_button(ui, Icon::RotateCcw, "Reset the range to the default of the quantity  (R)").clicked() {
        changes.push(RangeChange::Reset);
    }
}

/// Draws a square icon button, highlighted if `on`. `name` is its tooltip and its accessible name.
fn toggle(ui: &mut Ui, icon: Icon, on: bool, name: &str) -> Response {
    let button = Button::new(theme::icon(icon))
        .selected(on)
        .frame_when_inactive(false)
        .min_size(Vec2::splat(theme::CONTROL_HEIGHT));
    let response = ui
        .scope(|ui| {
            ui.spacing_mut().button_padding = Vec2::splat((theme::CONTROL_HEIGHT - theme::ICON_SIZE) / 2.0);
            ui.add(button)
        })
        .inner;
    response.widget_info(|| WidgetInfo::selected(egui::Role::Button, true, on, name));
    response.on_hover_text(name)
}

/// Draws the colour map settings of a scalar quantity or the channel switches of a colour, and the histogram settings.
/// Returns the histograms of the shown values, one per channel.
pub(super) fn histograms(view: &RenderedView) -> &[Histogram] {
    view.look_result.measured.as_deref().map_or(&[], |measured| &measured.histograms)
}

fn colors(ui: &mut Ui, session: &Session, kind: ValueKind, shown: Shown, changes: &mut Vec<RangeChange>) {
    let control = &session.features.range;
    let display = control.setting(shown).display;
    if kind == ValueKind::Numbers {
        maps(ui, display.map, changes);
        if toggle(ui, Icon::ArrowLeftRight, display.reversed, "Reverse the colour map").clicked() {
            changes.push(RangeChange::Reverse(!display.reversed));
        }
    } else {
        for (channel, name) in kind.channels().iter().enumerate() {
            let on = display.channels[channel];
            let text = RichText::new(*name).color(if on { theme::WEIGHTS[channel] } else { tokens(ui).text_weak });
            let button = ui.add(Button::new(text).selected(on));
            let button = button.on_hover_text(format!("Show or hide {name}. Right-click: show only {name}, in grey"));
            if button.clicked() {
                let mut channels = display.channels;
                channels[channel] ^= true;
                changes.push(RangeChange::Channels(channels));
            } else if button.secondary_clicked() {
                changes.push(RangeChange::Solo(channel));
            }
        }
    }
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        let box_help =
            "Show statistics of a box: select this, then drag on the picture. Shift+drag does it at any time";
        if toggle(ui, Icon::SquareDashed, control.draws_region, box_help).clicked() {
            changes.push(RangeChange::DrawRegion(!control.draws_region));
        }
        let is_log = control.uses_log_counts(session.view.as_ref().map_or(&[], histograms));
        let log = ui.selectable_label(is_log, "log");
        if log.on_hover_text("Logarithmic bars, so that rare values are visible, too").clicked() {
            changes.push(RangeChange::LogCounts(!is_log));
        }
    });
}

fn maps(ui: &mut Ui, chosen: Option<ColorMap>, changes: &mut Vec<RangeChange>) {
    let mut map = chosen;
    let name = map.map_or("Default colours", ColorMap::name);
    ui.name_inputs("Colour map", |ui| {
        combo("color map", name, 156.0).show_ui(ui, |ui| {
            ui.selectable_value(&mut map, None, "Default colours").on_hover_text("Default colour map of the quantity");
            for option in ColorMap::ALL {
                ui.selectable_value(&mut map, Some(*option), option.name()).on_hover_text(option.help());
            }
        });
    });
    if map != chosen {
        changes.push(RangeChange::Map(map));
    }
}
