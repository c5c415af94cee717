//! The strip below a comparison of sequences: playback controls, the frame number, and the shift of each sequence.

use eframe::egui::{Label, RichText, Slider, Ui};

use crate::inspect::project::MAX_SHIFT;
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::picture_role::PictureRole;
use crate::ui::session::sequences::{OpenedSequence, SPEEDS, SequenceChange};
use crate::ui::theme::{Icon, space, tokens};
use crate::ui::widgets::{combo, icon_button, number_field};

/// Draws the strip. It wraps to further rows if there are many sequences.
pub(crate) fn ui(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let Some((first, last)) = session.sequence_range() else { return };
    let sequences = &session.features.sequences;
    let before = commands.len();
    let mut change = |change| commands.push(Command::Sequence(change));
    ui.horizontal_wrapped(|ui| {
        if icon_button(ui, Icon::ChevronFirst, "Go to the first frame  (Home)").clicked() {
            change(SequenceChange::Go(first));
        }
        if icon_button(ui, Icon::StepBack, "Show the previous frame  (,)").clicked() {
            change(SequenceChange::Step(-1));
        }
        let (icon, name) = match sequences.is_playing {
            false => (Icon::Play, "Play the sequences  (Space)"),
            true => (Icon::Pause, "Pause  (Space)"),
        };
        if icon_button(ui, icon, name).clicked() {
            change(SequenceChange::TogglePlay);
        }
        if icon_button(ui, Icon::StepForward, "Show the next frame  (.)").clicked() {
            change(SequenceChange::Step(1));
        }
        if icon_button(ui, Icon::ChevronLast, "Go to the last frame  (End)").clicked() {
            change(SequenceChange::Go(last));
        }
        let mut frame = sequences.frame.clamp(first, last);
        ui.name_inputs("Frame", |ui| {
            let slider = Slider::new(&mut frame, first..=last);
            ui.add(slider).on_hover_text(format!("Frame number, {first} to {last}"));
        });
        if frame != sequences.frame.clamp(first, last) {
            change(SequenceChange::Go(frame));
        }
        let mut speed = sequences.speed;
        let list = combo("sequence speed", &format!("{speed} /s"), 66.0).show_ui(ui, |ui| {
            for choice in SPEEDS {
                ui.selectable_value(&mut speed, choice, format!("{choice} /s"));
            }
        });
        list.response.on_hover_text("Frames per second; no frame is skipped if files are read more slowly");
        if speed != sequences.speed {
            change(SequenceChange::Speed(speed));
        }
        for (role, sequence) in session.shown_sequences() {
            ui.add_space(space::S);
            file(ui, session, role, sequence, &mut change);
        }
    });
    if sequences.is_playing && commands.len() == before {
        commands.push(Command::Sequence(SequenceChange::Tick(ui.input(|i| i.stable_dt))));
        ui.request_repaint();
    }
}

/// Draws the file that a sequence shows, and its shift.
fn file(
    ui: &mut Ui,
    session: &Session,
    role: PictureRole,
    sequence: &OpenedSequence,
    change: &mut impl FnMut(SequenceChange),
) {
    let frame = session.features.sequences.frame;
    let (number, wanted) = sequence.at(frame);
    let shown = session.features.comparison.pictures.get(&sequence.path);
    let name = shown.as_ref().map_or_else(|| sequence.files.name().to_owned(), |shown| shown.name());
    let is_exact = i64::try_from(number).is_ok_and(|number| number == frame.saturating_add(sequence.shift));
    let is_loaded = shown.is_none_or(|shown| shown.file == wanted);
    let color = if is_exact && is_loaded { tokens(ui).text } else { tokens(ui).warning };
    let label = ui.add(Label::new(RichText::new(format!("{} {name}", role.name())).color(color)));
    label.on_hover_text(match (is_loaded, is_exact) {
        (false, _) => format!("The file of frame {number} is not read yet"),
        (true, false) => {
            let missing = frame.saturating_add(sequence.shift);
            format!("The sequence has no frame {missing}; it shows frame {number}")
        }
        (true, true) => format!("{}: {} frames", sequence.files.name(), sequence.files.frames().count()),
    });
    let mut shift = sequence.shift;
    ui.name_inputs(format!("Shift of {}", role.name()), |ui| {
        let field = number_field(&mut shift, |shift| format!("{shift:+.0}")).speed(0.1).range(-MAX_SHIFT..=MAX_SHIFT);
        ui.add(field).on_hover_text("Number of frames by which this sequence is ahead of the others");
    });
    if shift != sequence.shift {
        change(SequenceChange::Shift(sequence.path.clone(), shift));
    }
}
