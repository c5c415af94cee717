//! The pipeline panel: one row per stage with its count, its time and its share of the frame time, and below
//! them the switches of the selected stage.

mod figures;

use std::time::Duration;

use eframe::egui::{
    Align, Align2, Color32, FontId, Key, Label, Layout, Modifiers, Rect, Response, RichText, Role, ScrollArea, Sense,
    Stroke, StrokeKind, TextStyle, Ui, UiBuilder, WidgetInfo, vec2,
};

use self::figures::{Detail, RowFigures, StageTime, time_of, timed_within};
use super::switches;
use crate::chain::Recipe;
use crate::inspect::{Buffer, Stage};
use crate::manual::Chapter;
use crate::measure::stages::StageTimes;
use crate::pipeline::settings::Choice as _;
use crate::ui::engine::Shown;
use crate::ui::format;
use crate::ui::manual::manual_button;
use crate::ui::panels::{PanelSpec, framed};
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::stages::StageChange;
use crate::ui::theme::{self, CONTROL_HEIGHT, Icon, space, tokens};
use crate::ui::widgets::{icon_button, section_header};

/// Description of the panel.
pub(crate) const PANEL: PanelSpec = PanelSpec {
    chapter: Chapter::Stages,
    grows: false,
    titled: true,
    controls: None,
    content: |ui, cx| framed(ui, |ui| self::ui(ui, cx.session, cx.commands)),
};

/// Height of the row of a stage, in points.
const STAGE_HEIGHT: f32 = theme::ROW_HEIGHT - 2.0;

/// Height of the row of work outside the stages, in points.
const REST_HEIGHT: f32 = STAGE_HEIGHT - space::XS;

/// Distance of a row's name from the left edge of the row, in points.
const NAME_INSET: f32 = space::S;

/// Space between a time and the button beside it, in points.
const GAP: f32 = 2.0;

/// Space above and below the bar that shows the share of the frame time, in points.
const BAR_MARGIN: f32 = 3.0;

/// Opacity of the bar in the selected row.
const SELECTED_BAR: f32 = 0.35;

/// Width of the mark beside the stage whose picture is shown, in points.
const MARK_WIDTH: f32 = 3.0;

/// Minimum width of the rows, in points, at which the column of times is wide enough for the names of stages. In a
/// narrower panel, these names are truncated in favour of the counts.
const ROOMY: f32 = 250.0;

/// Minimum height of the switches, in points. In a window that is too low for rows and switches, the panel scrolls.
const LEAST_SWITCHES: f32 = 5.0 * theme::ROW_HEIGHT;

/// Draws the rows of all stages, and the switches of the selected stage.
pub(crate) fn ui(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let height = ui.available_height();
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        let top = ui.cursor().top();
        rows(ui, session, commands);
        let stage = session.features.stages.selected;
        section_header(ui, stage.name(), |ui| {
            manual_button(ui, Chapter::Settings, commands);
            reset_button(ui, session, commands);
        });
        let left = height - (ui.cursor().top() - top);
        ScrollArea::vertical()
            .id_salt(("switches", stage.id()))
            .max_height(left.max(LEAST_SWITCHES))
            .auto_shrink(false)
            .show(ui, |ui| selected_switches(ui, session, commands));
    });
}

fn reset_button(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let is_changed = session.state.recipe != Recipe::default();
    let reset = ui.add_enabled_ui(is_changed, |ui| icon_button(ui, Icon::RotateCcw, "Reset all settings")).inner;
    if reset.on_disabled_hover_text("All settings are at their defaults").clicked() {
        commands.push(Command::ResetRecipe);
    }
}

fn selected_switches(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let mut recipe = session.state.recipe;
    let stage = session.features.stages.selected;
    ui.push_id(stage.id(), |ui| switches::ui(ui, stage, session, &mut recipe, commands));
    if recipe != session.state.recipe {
        commands.push(Command::SetRecipe(recipe));
    }
}

/// Draws the rows of all stages, of the work outside the stages, and of the whole frame.
fn rows(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let spacing = std::mem::take(&mut ui.spacing_mut().item_spacing.y);
    let column = TimeColumn::new(ui, session);
    let stages = Stage::ALL.iter().map(|stage| stage_row(ui, *stage, &column, session, commands)).collect::<Vec<_>>();
    step_by_key(ui, &stages, session, commands);
    if let Some(times) = session.features.stages.times() {
        for rest in rest_rows(&times) {
            rest_row(ui, &rest, &column);
        }
    }
    ui.spacing_mut().item_spacing.y = spacing;
}

/// Moves selection and focus by `[` and `]` while a row has the focus. A focused widget receives all keys, so the
/// shortcuts of the window do not apply.
fn step_by_key(ui: &Ui, rows: &[Response], session: &Session, commands: &mut Vec<Command>) {
    if !rows.iter().any(Response::has_focus) {
        return;
    }
    let pressed = |key| i64::from(ui.input_mut(|input| input.consume_key(Modifiers::NONE, key)));
    let step = pressed(Key::CloseBracket) - pressed(Key::OpenBracket);
    if step == 0 {
        return;
    }
    commands.push(Command::Stage(StageChange::Step(step)));
    let next = session.features.stages.selected.stepped(step);
    if let Some((row, _)) = rows.iter().zip(Stage::ALL).find(|(_, stage)| **stage == next) {
        row.request_focus();
    }
}

/// Column of times, which has the same position in all rows.
struct TimeColumn {
    /// Width of the widest text in the column, in points.
    width: f32,
    /// Time of the whole frame; `None` if no frame was timed yet.
    frame: Option<Duration>,
}

impl TimeColumn {
    fn new(ui: &Ui, session: &Session) -> Self {
        /// Time whose width the column has at least, so that it keeps its width while times change.
        const USUAL: Duration = Duration::from_micros(88_880);
        let times = session.features.stages.times();
        let stages = Stage::ALL.iter().filter_map(|stage| time_of(*stage, &times?));
        let all = stages.chain(times.iter().map(|times| times.frame)).chain([USUAL]);
        let font = TextStyle::Monospace.resolve(ui.style());
        let width = |text, font| ui.painter().layout_no_wrap(text, font, Color32::WHITE).size().x;
        let mut width_of_all = all.map(|time| width(milliseconds(time), font.clone())).fold(0.0, f32::max);
        if ui.available_width() >= ROOMY {
            let small = TextStyle::Small.resolve(ui.style());
            let others = Stage::ALL.iter().filter_map(|stage| timed_within(*stage));
            width_of_all = others.map(|other| width(part_of(other), small.clone())).fold(width_of_all, f32::max);
        }
        let width = width_of_all.ceil();
        Self { width, frame: times.map(|times| times.frame) }
    }

    /// Returns the rectangle of the column in a row. To its right is the button that shows the picture after a stage.
    fn place(&self, row: Rect) -> Rect {
        let right = row.right() - CONTROL_HEIGHT - GAP;
        Rect::from_x_y_ranges((right - self.width)..=right, row.y_range())
    }

    /// Draws the time of a row into the column. Returns the left end of the text.
    fn draw_time(&self, ui: &mut Ui, row: Rect, time: Duration, color: Color32) -> f32 {
        let place = self.place(row);
        let text = milliseconds(time);
        let font = TextStyle::Monospace.resolve(ui.style());
        let written = ui.painter().text(place.right_center(), Align2::RIGHT_CENTER, &text, font, color);
        let response = ui.interact(place, ui.next_auto_id(), Sense::hover());
        ui.skip_ahead_auto_ids(1);
        response.widget_info(|| WidgetInfo::labeled(Role::Label, true, &text));
        written.left()
    }

    /// Draws a bar in the background of a row, as long as the share of `time` in the frame time.
    fn draw_bar(&self, ui: &Ui, row: Rect, time: Duration, color: Color32) {
        let Some(frame) = self.frame.filter(|frame| !frame.is_zero()) else { return };
        let share = (time.as_secs_f64() / frame.as_secs_f64()).clamp(0.0, 1.0) as f32;
        let bar = row.shrink2(vec2(0.0, BAR_MARGIN));
        ui.painter().rect_filled(bar.with_max_x(bar.left() + share * bar.width()), 0.0, color);
    }
}

/// Returns the text in the place of a time that is part of the time of another stage.
fn part_of(other: Stage) -> String {
    format!("in {}", other.name())
}

fn milliseconds(time: Duration) -> String {
    format::ms(time.as_secs_f64() * 1e3)
}

/// Draws the row of a stage: name, count or reason for skipping it, time, and the button that shows its picture.
/// Returns the response of the row, which selects the stage when it is clicked.
fn stage_row(
    ui: &mut Ui,
    stage: Stage,
    column: &TimeColumn,
    session: &Session,
    commands: &mut Vec<Command>,
) -> Response {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), STAGE_HEIGHT), Sense::click());
    let selected = session.features.stages.selected == stage;
    let label = format!("{} stage", stage.name());
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, selected, &label));
    let figures = RowFigures::of(stage, session);
    let tokens = tokens(ui);
    let skipped = matches!(figures.detail, Detail::Skipped(_));
    let (name_color, color) = match (selected, skipped) {
        (true, _) => (tokens.text_strong, tokens.text_strong),
        (false, true) => (tokens.text_weak, tokens.text_weak),
        (false, false) => (tokens.text_strong, tokens.text),
    };
    background(ui, rect, &response, selected);
    let time = column.place(rect);
    let mut time_left = time.left();
    if let StageTime::Measured(time) = figures.time {
        column.draw_bar(
            ui,
            rect,
            time,
            if selected { tokens.accent.gamma_multiply(SELECTED_BAR) } else { tokens.control },
        );
        time_left = column.draw_time(ui, rect, time, color);
    }
    let shown = session.shown == Shown::Stage(stage);
    if shown {
        ui.painter().rect_filled(rect.with_max_x(rect.left() + MARK_WIDTH), 0.0, tokens.accent);
    }
    let font = TextStyle::Body.resolve(ui.style());
    let start = rect.left_center() + vec2(NAME_INSET, 0.0);
    let name = ui.painter().text(start, Align2::LEFT_CENTER, stage.name(), font, name_color);
    let weak = if selected { color } else { tokens.text_weak };
    if let StageTime::PartOf(other) = figures.time {
        small_text(ui, time, &part_of(other), weak);
    }
    let until = |right: f32| Rect::from_x_y_ranges((name.right() + space::XS)..=(right - space::S), rect.y_range());
    let middle = until(time.left());
    match &figures.detail {
        Detail::Count(count) => small_text(ui, middle, &count.fitting(ui, middle.width()), weak),
        // A reason is longer than a count: it may reach into the column up to the time.
        Detail::Skipped(reason) => small_text(ui, until(time_left), reason, weak),
        Detail::Nothing => {}
    }
    let eye = Rect::from_min_max(rect.right_top() - vec2(CONTROL_HEIGHT, 0.0), rect.max);
    eye_button(ui, eye, stage, shown, commands);
    if response.clicked() {
        commands.push(Command::Stage(StageChange::Select(stage)));
    }
    response.on_hover_ui(|ui| figures.tooltip(ui, stage))
}

/// Draws small text, right-aligned in `place` and truncated if necessary.
fn small_text(ui: &mut Ui, place: Rect, text: &str, color: Color32) {
    let mut place = ui.new_child(UiBuilder::new().max_rect(place).layout(Layout::right_to_left(Align::Center)));
    let text = RichText::new(text).small().color(color);
    place.add(Label::new(text).truncate().show_tooltip_when_elided(false));
}

/// Fills the row of a stage if it is selected or under the pointer, and frames it if it has the keyboard focus.
fn background(ui: &Ui, row: Rect, response: &Response, selected: bool) {
    let fill = match (selected, response.hovered()) {
        (true, _) => Some(tokens(ui).accent_fill),
        (false, true) => Some(tokens(ui).raised),
        (false, false) => None,
    };
    if let Some(fill) = fill {
        ui.painter().rect_filled(row, theme::RADIUS, fill);
    }
    if response.has_focus() {
        ui.painter().rect_stroke(row, theme::RADIUS, Stroke::new(1.0, tokens(ui).accent), StrokeKind::Inside);
    }
}

/// Draws the button that shows the picture after a stage, or the finished picture if that picture is shown.
fn eye_button(ui: &mut Ui, place: Rect, stage: Stage, shown: bool, commands: &mut Vec<Command>) {
    let layout = Layout::right_to_left(Align::Center);
    let mut place = ui.new_child(UiBuilder::new().id_salt(("eye", stage.id())).max_rect(place).layout(layout));
    let icon = if shown { Icon::EyeOff } else { Icon::Eye };
    if icon_button(&mut place, icon, &format!("Show the picture after “{}”", stage.name())).clicked() {
        let next = if shown { Shown::Buffer(Buffer::Color) } else { Shown::Stage(stage) };
        commands.push(Command::Show(next));
    }
}

/// Row of work outside the stages.
struct RestRow {
    name: &'static str,
    time: Duration,
    help: &'static str,
}

/// Returns the rows of the work outside the stages that this frame does, and of the whole frame.
fn rest_rows(times: &StageTimes) -> Vec<RestRow> {
    let rows = [
        ("Resolve", times.resolve, "Averages the samples of each pixel"),
        ("Surfaces", times.surfaces, "Finds the visible surface of each rasterized pixel for the upscaler"),
        ("Transfer", times.transfer, "Sends the samples to the process of the upscaler and receives its picture"),
        ("Post filter", times.post, "Applies the post filter and draws the wireframe"),
        ("Other", Some(times.other), "Work between the stages: buffers, thread pool and copies"),
        (
            "Whole frame",
            Some(times.frame),
            "Sum of all rows; of several timed frames, the one with the median time is shown",
        ),
    ];
    rows.into_iter().filter_map(|(name, time, help)| Some(RestRow { name, time: time?, help })).collect()
}

fn rest_row(ui: &mut Ui, row: &RestRow, column: &TimeColumn) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), REST_HEIGHT), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, row.name));
    let is_whole = column.frame == Some(row.time);
    let color = if is_whole { tokens(ui).text } else { tokens(ui).text_weak };
    // Below the text: a long bar would hide it.
    if !is_whole {
        column.draw_bar(ui, rect, row.time, tokens(ui).control);
    }
    let start = rect.left_center() + vec2(NAME_INSET, 0.0);
    ui.painter().text(start, Align2::LEFT_CENTER, row.name, FontId::proportional(theme::font_size::SMALL), color);
    column.draw_time(ui, rect, row.time, color);
    response.on_hover_ui(|ui| {
        ui.strong(row.name);
        ui.label(row.help);
    });
}
