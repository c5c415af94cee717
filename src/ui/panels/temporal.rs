//! Section of the panel “Pixel” with the contribution of earlier frames.

use eframe::egui::{Button, Color32, Label, Rect, RichText, Role, Sense, Ui, Vec2, WidgetInfo};

use crate::inspect::temporal::{FrameShare, PastFrames, PixelFrame};
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::scene_time::SceneTimeChange;
use crate::ui::session::temporal::TemporalChange;
use crate::ui::theme::{self, tokens};
use crate::ui::widgets::section_header;

/// Number of listed frames, the newest first. Older ones rarely contribute visibly.
const LISTED: usize = 24;

/// Height of each row of colours in the strip, in points.
const COLOR_HEIGHT: f32 = 10.0;

/// Width of a frame's name and of its share, in points.
const NAME_WIDTH: f32 = 72.0;

/// Draws the section; nothing for an upscaler without history.
pub(crate) fn ui(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    if !session.has_earlier_frames() {
        return;
    }
    let view = &session.features.temporal;
    section_header(ui, "Earlier frames", |ui| {
        let (text, help) = match view.is_hidden {
            true => ("Show", "Draw the frames from frame 0 on and show how each contributes to this pixel"),
            false => ("Hide", "Hide how earlier frames contribute to this pixel, and draw none for it"),
        };
        if ui.small_button(text).on_hover_text(help).clicked() {
            commands.push(Command::Temporal(TemporalChange::Toggle));
        }
    });
    let Some(history) = &view.history else {
        if view.is_searching {
            ui.weak("Drawing the frames from frame 0 on …");
        }
        return;
    };
    let moves = session.shot_frame().is_some();
    let mut go = |frame: u32| {
        if moves {
            commands.push(Command::SceneTime(SceneTimeChange::Go(frame.into())));
        }
    };
    strip(ui, &history.pixel_frames, &mut go);
    if let Some(past) = &history.past_frames {
        shares(ui, past, &mut go);
    }
    for score in &history.masks {
        let help = "Precision: share of these pixels that are disoccluded. Recall: share of the disoccluded pixels that \
                    are among these. The disocclusion is exact.";
        ui.add(Label::new(RichText::new(score.sentence()).color(tokens(ui).text_weak)).wrap()).on_hover_text(help);
    }
    if session.view.as_ref().is_some_and(|view| view.needs_replay) {
        let drawn = "As drawn from frame 0 on; the picture still has the history of the frames shown.";
        ui.add(Label::new(RichText::new(drawn).color(tokens(ui).text_weak)).wrap());
    }
}

/// Draws the colours of the pixel in every frame: samples, history and result, one above the other.
fn strip(ui: &mut Ui, frames: &[PixelFrame], go: &mut impl FnMut(u32)) {
    let size = Vec2::new(ui.available_width(), 3.0 * COLOR_HEIGHT);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, "Colours of the pixel in every frame"));
    let width = rect.width() / frames.len().max(1) as f32;
    let color = |[r, g, b]: [u8; 3]| Color32::from_rgb(r, g, b);
    for (place, frame) in frames.iter().enumerate() {
        let rows = [Some(frame.samples), frame.history, Some(frame.result)];
        for (row, codes) in rows.into_iter().enumerate() {
            let corner = rect.min + Vec2::new(place as f32 * width, row as f32 * COLOR_HEIGHT);
            let cell = Rect::from_min_size(corner, Vec2::new(width, COLOR_HEIGHT));
            ui.painter().rect_filled(cell, 0.0, codes.map_or(Color32::TRANSPARENT, color));
        }
    }
    let pointed = response.hover_pos().and_then(|at| frames.get(((at.x - rect.min.x) / width).max(0.0) as usize));
    let is_clicked = response.clicked();
    if let Some(frame) = pointed {
        response.on_hover_text(format!("Upper row: samples, middle: history, lower: result. {}", frame.line()));
        if is_clicked {
            go(frame.frame);
        }
    }
}

/// Draws a bar for the share of each frame.
fn shares(ui: &mut Ui, past: &PastFrames, go: &mut impl FnMut(u32)) {
    let most = past.frames.iter().map(|frame| frame.share).fold(0.0, f64::max);
    for frame in past.frames.iter().take(LISTED) {
        if share_row(ui, past, frame, most) {
            go(frame.frame);
        }
    }
    if let Some(more) = past.frames.len().checked_sub(LISTED).filter(|more| *more > 0) {
        ui.weak(format!("… {more} older frames; print them with “rasterscope pixel” …"));
    }
    ui.add(Label::new(RichText::new(past.remark()).color(tokens(ui).text)).wrap());
}

/// Draws the row of a frame, with a bar that is full at the share `most`. Returns whether it was clicked.
fn share_row(ui: &mut Ui, past: &PastFrames, frame: &FrameShare, most: f64) -> bool {
    let outcome = frame.outcome(past.space);
    let [x, y] = frame.position_px;
    let help = format!(
        "Share before clamping. {} px around {x:.2}, {y:.2} contribute. {outcome}. Click to show this frame",
        frame.pixels
    );
    let clicked = ui.horizontal(|ui| {
        let name = Button::new(RichText::new(format!("Frame {}", frame.frame)).small()).frame(false);
        let clicked = ui.add_sized([NAME_WIDTH, theme::CONTROL_HEIGHT], name).on_hover_text(&help).clicked();
        let width = (ui.available_width() - NAME_WIDTH).max(0.0);
        let (rect, _) = ui.allocate_exact_size(Vec2::new(width, COLOR_HEIGHT), Sense::hover());
        let fraction = if most > 0.0 { (frame.share / most).max(0.0) as f32 } else { 0.0 };
        let bar = Rect::from_min_size(rect.min, Vec2::new(rect.width() * fraction, rect.height()));
        let is_changed = frame.rectified > 0.0 || !frame.rejected.is_empty();
        let color = if is_changed { tokens(ui).warning } else { tokens(ui).accent };
        ui.painter().rect_filled(bar, theme::RADIUS, color);
        ui.label(RichText::new(format!("{:.1} %", frame.share * 100.0)).monospace().small()).on_hover_text(&help);
        clicked
    });
    clicked.inner
}
