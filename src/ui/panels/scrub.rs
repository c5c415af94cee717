//! The playback bar below the canvas: step and play controls, and sliders for the numbers of drawn triangles and
//! fragments.

pub(super) mod outline;

use std::sync::Arc;

use eframe::egui::{
    self, Align, Button, Color32, Layout, Rect, Response, RichText, Slider, Stroke, Ui, WidgetInfo, pos2, vec2,
};

use crate::inspect::scrub::{Moment, Timeline, Unit};
use crate::pipeline::settings::Choice as _;
use crate::ui::format;
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::scrub::{SPEEDS, Scrub, ScrubChange};
use crate::ui::theme::{self, CONTROL_HEIGHT, Icon, font_size, space, tokens};
use crate::ui::widgets::{combo, icon_button};

/// Height of the playback bar, in points.
pub(crate) const HEIGHT: f32 = theme::ROW_HEIGHT + 8.0;

/// Fraction of the sliders' width for the triangle slider; the fragment slider takes the rest.
const TRIANGLES_SHARE: f32 = 0.66;

/// Minimum width for the numbers beside the sliders, in points.
const NUMBERS_FROM: f32 = 360.0;

/// Minimum width for the name of the last triangle, in points. In a narrower bar, only the strip above it shows the name.
const NAME_FROM: f32 = 620.0;

/// Width of the numbers, without and with the name of the last triangle, in points.
const FIGURES: [f32; 2] = [118.0, 300.0];

/// Maximum number of ticks on the triangle slider; more would merge into a band.
const MAX_TICKS: usize = 400;

/// Draws the playback bar.
pub(crate) fn ui(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let before = commands.len();
    let known = session.view.as_ref().and_then(|view| view.timeline.clone());
    ui.horizontal_centered(|ui| {
        buttons(ui, session, commands);
        ui.add_space(space::S);
        let room = ui.available_width();
        let figures_width = match room {
            room if room >= NAME_FROM => FIGURES[1],
            room if room >= NUMBERS_FROM => FIGURES[0],
            _ => 0.0,
        };
        let width = (room - figures_width - 2.0 * space::M).max(0.0);
        let [of_triangles, of_fragments] = slider_widths(width);
        if let Some(width) = of_triangles {
            triangles(ui, session, known.as_ref(), width, commands);
        }
        if let Some(width) = of_fragments {
            fragments(ui, session, known.as_deref(), width, commands);
        }
        if figures_width > 0.0 {
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                figures(ui, session, known.as_deref().filter(|_| figures_width == FIGURES[1]));
            });
        }
    });
    let is_untouched = commands.len() == before;
    if session.features.scrub.playing != 0 && is_untouched {
        commands.push(Command::Scrub(ScrubChange::Tick(ui.input(|i| i.stable_dt))));
        ui.request_repaint();
    }
}

/// Returns the widths of the sliders for triangles and fragments that share `width` points; `None` for a slider that has
/// no room.
fn slider_widths(width: f32) -> [Option<f32>; 2] {
    /// Minimum width of a slider, in points.
    const LEAST: f32 = 50.0;
    match width * (1.0 - TRIANGLES_SHARE) {
        of_fragments if of_fragments >= LEAST => [Some(width * TRIANGLES_SHARE), Some(of_fragments)],
        _ => [Some(width).filter(|width| *width >= LEAST), None],
    }
}

fn buttons(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let Scrub { unit, playing, .. } = session.features.scrub;
    if icon_button(ui, Icon::ChevronFirst, "Go to the start, before the first triangle  (Home)").clicked() {
        commands.push(Command::LimitTriangles(Some(0)));
    }
    let (less, more) = match unit {
        Unit::Stage => ("Show the previous stage", "Show the next stage"),
        Unit::Draw => ("Draw one fewer object  (Ctrl+,)", "Draw one more object  (Ctrl+.)"),
        Unit::Triangle => ("Draw one fewer triangle  (,)", "Draw one more triangle  (.)"),
        Unit::Fragment => ("Draw one fewer fragment  (Shift+,)", "Draw one more fragment  (Shift+.)"),
    };
    if icon_button(ui, Icon::StepBack, less).clicked() {
        commands.push(Command::Scrub(ScrubChange::StepUnit(false)));
    }
    let (icon, name) = match playing {
        0 => (Icon::Play, "Play  (Space; Shift+Space backwards)"),
        _ => (Icon::Pause, "Pause  (Space)"),
    };
    if icon_button(ui, icon, name).clicked() {
        commands.push(Command::Scrub(ScrubChange::Play(playing >= 0)));
    }
    if icon_button(ui, Icon::StepForward, more).clicked() {
        commands.push(Command::Scrub(ScrubChange::StepUnit(true)));
    }
    if icon_button(ui, Icon::ChevronLast, "Go to the end, after the last triangle  (End)").clicked() {
        commands.push(Command::LimitTriangles(None));
    }
    touching(ui, session, commands);
    choices(ui, session.features.scrub, commands);
}

/// Draws the drop-down lists of step units and playback speeds.
fn choices(ui: &mut Ui, Scrub { mut unit, mut speed, .. }: Scrub, commands: &mut Vec<Command>) {
    let (unit_before, speed_before) = (unit, speed);
    /// Widths of the unit list and the speed list, in points.
    const WIDTHS: [f32; 2] = [84.0, 82.0];
    /// Minimum width for the speed list, in points.
    const SPEED_FROM: f32 = 560.0;
    let by_unit = combo("scrub-unit", unit.name(), WIDTHS[0].min(ui.available_width())).show_ui(ui, |ui| {
        for choice in Unit::ALL {
            ui.selectable_value(&mut unit, *choice, choice.name()).on_hover_text(choice.help());
        }
    });
    by_unit.response.on_hover_text("Unit of the step buttons and of playback");
    if ui.available_width() >= SPEED_FROM {
        let name = |speed: f32| format!("{} /s", format::count(speed as u64));
        let by_speed = combo("scrub-speed", &name(speed), WIDTHS[1]).show_ui(ui, |ui| {
            for choice in SPEEDS {
                ui.selectable_value(&mut speed, choice, name(choice));
            }
        });
        by_speed
            .response
            .on_hover_text("Playback speed in steps per second; steps are skipped if drawing cannot keep up");
    }
    if unit != unit_before {
        commands.push(Command::Scrub(ScrubChange::Unit(unit)));
    }
    if speed != speed_before {
        commands.push(Command::Scrub(ScrubChange::Speed(speed)));
    }
}

fn touching(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let button = Button::new(theme::icon(Icon::Crosshair)).selected(session.features.scrub.only_touches);
    let name = "Step only at the picked pixel";
    let response = ui
        .add_enabled(session.pick.is_some(), button)
        .on_disabled_hover_text("Pick a pixel first")
        .on_hover_text(format!("{name}: stepping and playback skip triangles and fragments elsewhere  (Y)"));
    response.widget_info(|| WidgetInfo::selected(egui::Role::Button, true, session.features.scrub.only_touches, name));
    if response.clicked() {
        commands.push(Command::Scrub(ScrubChange::Touching(None)));
    }
}

/// Draws the number of drawn triangles and, if the timeline is given, the name of the last one, right-aligned.
fn figures(ui: &mut Ui, session: &Session, known: Option<&Timeline>) {
    let (moment, all) = (session.moment(), session.triangle_count());
    let text = format!("{} / {}", format::count(moment.triangles as u64), format::count(all as u64));
    ui.label(RichText::new(text).monospace().color(tokens(ui).text))
        .on_hover_text("Triangles drawn / triangles of the frame");
    if session.features.scrub.triangle_limit.is_some() && !session.state.recipe.antialias.is_off() {
        let note = RichText::new("1 sample").color(tokens(ui).text_weak);
        ui.label(note).on_hover_text(
            "Until the last triangle is drawn, each pixel shows the sample at its centre, not the mean of its samples",
        );
    }
    if let Some(name) = known.and_then(|_| last_drawn(session)) {
        let help =
            format!("{name}: the last triangle drawn. It is outlined in the picture, and its object more faintly");
        ui.add(egui::Label::new(RichText::new(name).color(tokens(ui).text)).truncate()).on_hover_text(help);
    }
}

/// Names the object, the triangle and the number of drawn fragments of the triangle that was drawn last; `None` before
/// the first triangle and if the frame is complete.
pub(crate) fn last_drawn(session: &Session) -> Option<String> {
    let known = session.view.as_ref()?.timeline.as_ref()?;
    let last = known.last.as_ref().filter(|_| session.features.scrub.triangle_limit.is_some())?;
    let object = session.scene.instances.get(last.instance as usize)?;
    let all = known.fragments[0] as u64;
    let fragments = match session.moment().fragments {
        Some(drawn) => format!("{} of {} fragments", format::count(drawn as u64), format::count(all)),
        None if all == 1 => "1 fragment".to_owned(),
        None => format!("{} fragments", format::count(all)),
    };
    Some(format!("{}, triangle {}, {fragments}", object.name, format::count(last.id.0.into())))
}

fn triangles(ui: &mut Ui, session: &Session, known: Option<&Arc<Timeline>>, width: f32, commands: &mut Vec<Command>) {
    let all = session.triangle_count();
    let mut drawn = session.moment().triangles.min(all);
    ui.spacing_mut().slider_width = width.floor();
    let slider = ui.add_enabled(all > 0, Slider::new(&mut drawn, 0..=all).show_value(false)).on_hover_text(
        "Triangles drawn, in rasterization order. Ticks mark fragments at the picked pixel: green ones were \
                        written, red ones rejected",
    );
    slider.widget_info(|| WidgetInfo::slider(true, drawn as f64, "Triangles drawn"));
    if slider.changed() {
        commands.push(Command::Scrub(ScrubChange::Go(Moment::after(drawn))));
    }
    if let Some(known) = known {
        ticks(ui, &slider, known);
    }
}

fn fragments(ui: &mut Ui, session: &Session, known: Option<&Timeline>, width: f32, commands: &mut Vec<Command>) {
    let moment = session.moment();
    let all = known.map_or(0, |known| known.fragments[0]);
    let mut drawn = moment.fragments.unwrap_or(all).min(all);
    let text = format!("{} / {}", format::count(drawn as u64), format::count(all as u64));
    /// Width of the fragment counts beside the slider, in points. The counts are omitted if the slider would be shorter
    /// than half this width.
    const NUMBERS: f32 = 122.0;
    let has_numbers = width >= 1.5 * NUMBERS;
    ui.spacing_mut().slider_width = (if has_numbers { width - NUMBERS - space::M } else { width }).floor();
    let is_known = all > 0 && moment.triangles > 0;
    let slider = ui
        .add_enabled(is_known, Slider::new(&mut drawn, 0..=all.max(1)).show_value(false))
        .on_hover_text("Fragments drawn of the last triangle, in the order in which the rasterizer finds them")
        .on_disabled_hover_text(
            "Move the triangle slider first: this slider steps through the fragments of the last triangle drawn",
        );
    slider.widget_info(|| WidgetInfo::slider(is_known, drawn as f64, "Fragments drawn"));
    if slider.changed() {
        let fragments = (drawn < all).then_some(drawn);
        commands.push(Command::Scrub(ScrubChange::Go(Moment { fragments, ..moment })));
    }
    if has_numbers {
        let color = if is_known { tokens(ui).text } else { tokens(ui).text_weak };
        let text = RichText::new(if is_known { text } else { "–".to_owned() }).monospace().size(font_size::SMALL);
        let size = vec2(ui.available_width().min(NUMBERS), CONTROL_HEIGHT);
        ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
            ui.add(egui::Label::new(text.color(color)).truncate())
                .on_hover_text("Fragments of the last triangle: drawn / all");
        });
    }
}

/// Draws ticks on the triangle slider for the fragments at the picked pixel.
fn ticks(ui: &Ui, slider: &Response, timeline: &Timeline) {
    /// Distance between the centre of egui's round handle and the slider's ends, as a fraction of the slider's height.
    const HANDLE_RADIUS: f32 = 1.0 / 2.5;
    const LENGTH: f32 = 5.0;
    let rect = slider.rect;
    let range = rect.x_range().shrink(rect.height() * HANDLE_RADIUS);
    let all = timeline.triangles.max(1) as f32;
    let each = timeline.touches.len().div_ceil(MAX_TICKS).max(1);
    for touch in timeline.touches.iter().step_by(each) {
        let x = range.min + range.span() * touch.moment.triangles as f32 / all;
        let color: Color32 = if touch.written { tokens(ui).passed } else { tokens(ui).rejected };
        // Written fragments have ticks at the top, rejected ones at the bottom, so that colour is not the only
        // distinction.
        let (from, to) =
            if touch.written { (rect.top(), rect.top() + LENGTH) } else { (rect.bottom() - LENGTH, rect.bottom()) };
        let tick = Rect::from_min_max(pos2(x, from), pos2(x, to)).expand2(vec2(0.75, 0.0));
        ui.painter().rect_filled(tick, 0.0, color);
        ui.painter().line_segment([pos2(x, from), pos2(x, to)], Stroke::new(1.0, color));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sliders_without_room_are_left_out() {
        let count = |width| slider_widths(width).iter().flatten().count();
        assert_eq!([600.0, 160.0, 100.0, 40.0, 0.0].map(count), [2, 2, 1, 0, 0]);
        for width in [600.0_f32, 160.0, 100.0] {
            assert!((slider_widths(width).iter().flatten().sum::<f32>() - width).abs() < 1e-3, "{width}");
        }
    }
}
