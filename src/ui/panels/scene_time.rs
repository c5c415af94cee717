//! The strip below the picture of an animated scene or of a camera path: playback controls, time, speed and frame rate.

use eframe::egui::{RichText, Slider, Ui};

use super::camera_path;
use crate::ui::engine::replay::ReplayProgress;
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::scene_time::{FRAME_RATES, SPEEDS, SceneTimeChange};
use crate::ui::theme::{Icon, tokens};
use crate::ui::widgets::{combo, icon_button};

/// Draws the strip; nothing for a still scene without a camera path.
pub(crate) fn ui(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let Some(count) = session.scene_frame_count() else { return };
    let time = &session.features.scene_time;
    let before = commands.len();
    ui.horizontal_wrapped(|ui| {
        let mut change = |change| commands.push(Command::SceneTime(change));
        ui.label(RichText::new("Scene").color(tokens(ui).text_weak));
        if icon_button(ui, Icon::ChevronFirst, "Go to the first frame").clicked() {
            change(SceneTimeChange::Go(0));
        }
        if icon_button(ui, Icon::StepBack, "Show the previous frame of the scene  (Alt+,)").clicked() {
            change(SceneTimeChange::Step(-1));
        }
        let (icon, name) = match time.is_playing {
            false => (Icon::Play, "Play the scene  (Ctrl+Space)"),
            true => (Icon::Pause, "Pause  (Ctrl+Space)"),
        };
        if icon_button(ui, icon, name).clicked() {
            change(SceneTimeChange::TogglePlay);
        }
        if icon_button(ui, Icon::StepForward, "Show the next frame of the scene  (Alt+.)").clicked() {
            change(SceneTimeChange::Step(1));
        }
        let shown = session.scene_frame().rem_euclid(count);
        let mut frame = shown;
        ui.name_inputs("Frame of the scene", |ui| {
            let slider = Slider::new(&mut frame, 0..=count - 1);
            ui.add(slider).on_hover_text(format!("Frame number, 0 to {}", count - 1));
        });
        if frame != shown {
            change(SceneTimeChange::Go(frame));
        }
        let seconds = format!("{:.2} s", session.shown_time_s());
        ui.label(RichText::new(seconds).monospace()).on_hover_text("Shown time");
        let mut speed = time.speed;
        let list = combo("scene speed", &format!("×{speed}"), 56.0).show_ui(ui, |ui| {
            for choice in SPEEDS {
                ui.selectable_value(&mut speed, choice, format!("×{choice}"));
            }
        });
        list.response.on_hover_text("Speed relative to real time; no frame is skipped if drawing is slower");
        if speed != time.speed {
            change(SceneTimeChange::Speed(speed));
        }
        let mut rate = time.frames_per_second;
        let list = combo("frame rate", &format!("{rate} /s"), 60.0).show_ui(ui, |ui| {
            for choice in FRAME_RATES {
                ui.selectable_value(&mut rate, choice, format!("{choice} /s"));
            }
        });
        list.response
            .on_hover_text("Frames per second of the scene: the time between two frames for motion and history");
        if rate != time.frames_per_second {
            change(SceneTimeChange::FrameRate(rate));
        }
        let mut loops = time.loops;
        ui.checkbox(&mut loops, "Loop").on_hover_text("Start again at the end of the motion");
        if loops != time.loops {
            change(SceneTimeChange::Loop(loops));
        }
        camera_path::ui(ui, session, commands);
        replay(ui, session, commands);
    });
    if time.is_playing && commands.len() == before {
        commands.push(Command::SceneTime(SceneTimeChange::Tick(ui.input(|i| i.stable_dt))));
        ui.request_repaint();
    }
}

/// Says that the picture has the history of the frames shown, and how far the frames before it are drawn.
fn replay(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    if !session.view.as_ref().is_some_and(|view| view.needs_replay) {
        return;
    }
    ui.separator();
    let help = "The upscaler's history is that of the frames that were shown. Once playback rests, the missing frames are \
                drawn, and the picture depends on the frame number only";
    ui.label(RichText::new("History of the frames shown").color(tokens(ui).text_weak)).on_hover_text(help);
    let Some(ReplayProgress { done, of }) = session.features.scene_time.replay else { return };
    ui.label(RichText::new(format!("Drawing frame {done} of {of} …")).color(tokens(ui).text_weak));
    if ui.small_button("Cancel").on_hover_text("Keep the history of the frames shown").clicked() {
        commands.push(Command::SceneTime(SceneTimeChange::CancelReplay));
    }
}
