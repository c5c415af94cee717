//! The pipeline panel on the left. Each stage has a row with its time and count, its settings when expanded, and a
//! button that shows the picture after the stage.

use std::time::Duration;

use eframe::egui::collapsing_header::CollapsingState;
use eframe::egui::{self, Ui};

use super::switches;
use crate::chain::Recipe;
use crate::inspect::Stage;
use crate::manual::Chapter;
use crate::measure::stages::StageTimes;
use crate::pipeline::settings::Choice as _;
use crate::ui::command::Command;
use crate::ui::engine::{RenderedView, Shown, StageFigures};
use crate::ui::format;
use crate::ui::manual::manual_button;
use crate::ui::session::Session;
use crate::ui::theme::{self, Icon, tokens};
use crate::ui::widgets::{figure, icon_button, value_row};
use crate::ui::workspace::{PanelSpec, framed, scrolling};

/// Description of the panel.
pub(crate) const PANEL: PanelSpec = PanelSpec {
    id: "stages",
    name: "Stages",
    help: "Stages of the pipeline with their times, counts and settings",
    chapter: Chapter::Stages,
    grows: false,
    controls: None,
    content: |ui, cx| framed(ui, |ui| scrolling(ui, |ui| self::ui(ui, cx.session, cx.commands))),
};

/// Expands or collapses the rows of all stages in the next pass.
pub(crate) fn open_all(ui: &Ui, open: bool) {
    ui.data_mut(|data| data.insert_temp(open_all_id(), open));
}

fn open_all_id() -> egui::Id {
    egui::Id::unique("open all stages")
}

/// Draws the rows of all stages.
pub(crate) fn ui(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let mut recipe = session.state.recipe;
    let all = ui.data_mut(|data| data.remove_temp(open_all_id()));
    for stage in Stage::ALL {
        stage_row(ui, *stage, all, session, &mut recipe, commands);
    }
    rest(ui, session);
    if recipe != session.state.recipe {
        commands.push(Command::SetRecipe(recipe));
    }
    ui.add_space(theme::space::M);
    let changed = session.state.recipe != Recipe::default();
    ui.horizontal(|ui| {
        let reset = ui.add_enabled(changed, egui::Button::new("Reset all settings"));
        if reset
            .on_hover_text("Reset every setting to its default")
            .on_disabled_hover_text("All settings are at their defaults")
            .clicked()
        {
            commands.push(Command::ResetRecipe);
        }
        manual_button(ui, Chapter::Settings, commands);
    });
}

/// Draws the time spent outside the listed stages, and the frame time, which is the sum of all times in the panel.
fn rest(ui: &mut Ui, session: &Session) {
    let Some(StageFigures { times, .. }) = session.stages.as_ref() else { return };
    let rows = [
        ("Resolve", times.resolve, "Averages the samples of each pixel"),
        ("Surfaces", times.surfaces, "Finds the visible surface of each pixel for the upscaler"),
        ("Post filter", times.post, "Applies the post filter and draws the wireframe"),
        ("Other", Some(times.other), "Work between the stages: buffers, thread pool and copies"),
        (
            "Whole frame",
            Some(times.frame),
            "Sum of all rows; of several timed frames, the one with the median time is shown",
        ),
    ];
    for (name, time, help) in rows {
        if let Some(time) = time {
            value_row(ui, name, &format::ms(time.as_secs_f64() * 1e3), help);
        }
    }
}

/// Stages whose rows are initially expanded.
const OPEN_AT_FIRST: [Stage; 4] = [Stage::Assemble, Stage::Cull, Stage::Shade, Stage::Upscale];

/// Draws the row of a stage. If `all` is given, expands (`true`) or collapses (`false`) the row first.
fn stage_row(
    ui: &mut Ui,
    stage: Stage,
    all: Option<bool>,
    session: &Session,
    recipe: &mut Recipe,
    commands: &mut Vec<Command>,
) {
    let id = ui.make_persistent_id(("stage", stage.id()));
    let mut open = CollapsingState::load_with_default_open(ui.ctx(), id, OPEN_AT_FIRST.contains(&stage));
    if let Some(all) = all {
        open.set_open(all);
    }
    if header(ui, stage, open.is_open(), session, commands) {
        open.toggle(ui);
    }
    open.show_body_unindented(ui, |ui| {
        egui::Frame::new().inner_margin(egui::Margin { left: 8, right: 2, top: 2, bottom: 8 }).show(ui, |ui| {
            ui.push_id(stage.id(), |ui| switches::ui(ui, stage, session, recipe, commands));
        });
    });
    open.store(ui.ctx());
}

/// Draws the header of a stage: name on the left; count, time and the button that shows the stage's picture on the
/// right. Returns whether the header was clicked.
fn header(ui: &mut Ui, stage: Stage, open: bool, session: &Session, commands: &mut Vec<Command>) -> bool {
    let size = egui::vec2(ui.available_width(), theme::ROW_HEIGHT);
    let (rect, response) = ui.allocate_exact_size(size, egui::Sense::click());
    response
        .widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, open, format!("{} stage", stage.name())));
    let shown = session.shown == Shown::Stage(stage);
    let fill = if response.hovered() { tokens(ui).control } else { tokens(ui).raised };
    ui.painter().rect_filled(rect, theme::RADIUS, fill);
    if shown {
        let mark = rect.with_max_x(rect.left() + 3.0);
        ui.painter().rect_filled(mark, theme::RADIUS, tokens(ui).accent);
    }
    let chevron = if open { Icon::ChevronDown } else { Icon::ChevronRight };
    let center = rect.left_center() + egui::vec2(14.0, 0.0);
    theme::paint_icon(ui.painter(), center, chevron, theme::ICON_SIZE, tokens(ui).text_weak);
    ui.painter().text(
        rect.left_center() + egui::vec2(26.0, 0.0),
        egui::Align2::LEFT_CENTER,
        stage.name(),
        egui::TextStyle::Body.resolve(ui.style()),
        tokens(ui).text_strong,
    );
    let right = egui::UiBuilder::new()
        .max_rect(rect.shrink2(egui::vec2(4.0, 0.0)))
        .layout(egui::Layout::right_to_left(egui::Align::Center));
    figures(&mut ui.new_child(right), stage, shown, session, commands);
    response.context_menu(|ui| {
        for (open, name) in [(true, "Expand all stages"), (false, "Collapse all stages")] {
            if ui.button(name).clicked() {
                commands.push(Command::OpenStages(open));
                ui.close();
            }
        }
    });
    response.on_hover_text(stage.help()).clicked()
}

fn figures(ui: &mut Ui, stage: Stage, shown: bool, session: &Session, commands: &mut Vec<Command>) {
    let icon = if shown { Icon::EyeOff } else { Icon::Eye };
    if icon_button(ui, icon, &format!("Show the picture after “{}”", stage.name())).clicked() {
        let next = if shown { Shown::Buffer(crate::inspect::Buffer::Color) } else { Shown::Stage(stage) };
        commands.push(Command::Show(next));
    }
    let time = session.stages.as_ref().and_then(|figures| time_of(stage, &figures.times));
    let time = time.map_or_else(|| "–".to_owned(), |t| format::ms(t.as_secs_f64() * 1e3));
    let help = "Time spent in this stage, in the frame with the median time of several. Tiled execution includes \
                projection in transform, clipping in cull, depth in rasterize, and interpolation in shade. Classic \
                execution divides the time of rasterize, depth, interpolate and shade in proportion to partial frames \
                that each run one more stage; 0 means too short to measure";
    figure(ui, &time, 62.0, tokens(ui).text).on_hover_text(help);
    if let Some((number, what)) = session.view.as_ref().and_then(|view| count_of(stage, session, view)) {
        let help = format!("{} {what}", format::count(number));
        figure(ui, &short_count(number), 54.0, tokens(ui).text_weak).on_hover_text(help);
    }
}

/// Formats a count in a few characters, such as 14 860 as "14.9 k".
fn short_count(number: u64) -> String {
    match number {
        0..10_000 => format::count(number),
        10_000..1_000_000 => format!("{:.1} k", number as f64 / 1e3),
        _ => format!("{:.2} M", number as f64 / 1e6),
    }
}

fn time_of(stage: Stage, times: &StageTimes) -> Option<Duration> {
    match stage {
        Stage::Assemble => None,
        Stage::Transform => Some(times.transform),
        Stage::Clip => times.clip,
        Stage::Project => times.project,
        Stage::Cull => Some(times.cull),
        Stage::Rasterize => Some(times.rasterize),
        Stage::Depth => times.depth,
        Stage::Interpolate => times.interpolate,
        Stage::Shade => Some(times.shade),
        Stage::Upscale => Some(times.upscale),
    }
}

fn count_of(stage: Stage, session: &Session, view: &RenderedView) -> Option<(u64, &'static str)> {
    let (counters, geometry) = (session.stages?.counters, &view.frame.geometry);
    match stage {
        Stage::Assemble => Some((session.scene.triangle_count() as u64, "triangles in the scene")),
        Stage::Transform => Some((geometry.vertices as u64, "vertices transformed")),
        Stage::Clip => Some((counters.clipped, "triangles clipped")),
        Stage::Project => Some((geometry.triangles_clipped as u64, "triangles projected")),
        Stage::Cull => Some((view.rasterized as u64, "triangles to rasterize")),
        Stage::Rasterize => Some((counters.covered, "samples covered")),
        Stage::Depth => view.frame.drawn.depth.as_ref().map(|_| (counters.passed, "fragments passed the depth test")),
        Stage::Interpolate => None,
        Stage::Shade => Some((counters.shaded, "fragments shaded")),
        Stage::Upscale => Some((view.frame.drawn_pixels(), "pixels drawn")),
    }
}
