//! Commands that a tool takes or observes before the session applies them.

use super::Session;
use super::file_command::FileCommand;
use super::save_item::SaveItem;
use crate::image::file;
use crate::ui::session::canvas_state::CanvasChange;
use crate::ui::session::command::Command;
use crate::ui::session::lab::{Lab, LabChange};
use crate::ui::session::onboarding::Onboarding;
use crate::ui::session::scrub::ScrubChange;
use crate::ui::session::sequences::SequenceChange;
use crate::ui::session::stages::StageChange;
use crate::ui::session::window_task::DialogCommand;

impl Lab {
    /// Converts a command for the lab if the lab is open. A command with a counterpart in the lab, such as stepping,
    /// becomes that lab command. A command without meaning in the lab becomes `None`. Any other command is returned
    /// unchanged. Opening a model or a built-in scene also closes the lab.
    pub(crate) fn claim(&mut self, command: Command) -> Option<Command> {
        if !self.open {
            return Some(command);
        }
        let change = match command {
            Command::StepTriangle(step) | Command::NudgePick(step, 0) => LabChange::StepBy(step),
            Command::LimitTriangles(Some(0)) => LabChange::Go(0),
            Command::LimitTriangles(None) => LabChange::Go(usize::MAX),
            Command::Scrub(ScrubChange::Play(_)) => LabChange::TogglePlay,
            Command::Canvas(CanvasChange::Fit) => LabChange::View(None),
            Command::File(FileCommand::SavePicture) => LabChange::Save("png"),
            Command::File(FileCommand::SaveAs(SaveItem::Picture)) => {
                return Some(Command::File(FileCommand::SaveAs(SaveItem::LabDrawing("png"))));
            }
            Command::File(FileCommand::SaveAs(
                SaveItem::Values
                | SaveItem::Buffers
                | SaveItem::Pixel
                | SaveItem::Outline(..)
                | SaveItem::Case
                | SaveItem::Comparison,
            )) => {
                return None;
            }
            Command::Escape => LabChange::Play(0),
            Command::NudgePick(..)
            | Command::ChooseUpscaler(_)
            | Command::Stage(StageChange::Step(_))
            | Command::Scrub(_)
            | Command::StepFault(_)
            | Command::Canvas(CanvasChange::TogglePointerMode(_))
            | Command::ResetCamera
            | Command::Orbit(..)
            | Command::Dialog(DialogCommand::GoTo)
            | Command::File(FileCommand::CopyPicture)
            | Command::WhatIf(_)
            | Command::Watch(_)
            | Command::Undo
            | Command::Redo
            | Command::Compare(_)
            | Command::Overlays(_)
            | Command::Range(_)
            | Command::MeshView(_)
            | Command::Trace(_)
            | Command::File(FileCommand::SaveData)
            | Command::File(FileCommand::SaveOutline(..))
            | Command::Canvas(CanvasChange::OneToOne) => return None,
            Command::File(FileCommand::Open(path)) if file::is_named_picture(&path) => LabChange::Picture(path),
            Command::File(FileCommand::Open(_)) | Command::File(FileCommand::OpenBuiltin(_)) => {
                self.open = false;
                return Some(command);
            }
            other => return Some(other),
        };
        Some(Command::Lab(change))
    }
}

impl Session {
    /// Turns commands for playing back the drawing of a frame into commands for the sequences of a comparison, if it has
    /// any: compared pictures are complete.
    pub(in crate::ui) fn redirect_playback(&self, command: Command) -> Command {
        let Some((first, last)) = self.sequence_range() else { return command };
        Command::Sequence(match command {
            Command::StepTriangle(step) => SequenceChange::Step(step),
            Command::LimitTriangles(Some(0)) => SequenceChange::Go(first),
            Command::LimitTriangles(None) => SequenceChange::Go(last),
            Command::Scrub(ScrubChange::Play(_)) => SequenceChange::TogglePlay,
            other => return other,
        })
    }
}

impl Onboarding {
    /// Advances the coach if the user has done what its step explains, by this command.
    pub(crate) fn observe_command(&mut self, command: &Command) {
        match command {
            Command::SetCamera(_) | Command::Orbit(..) => self.observe_camera(),
            Command::Pick(Some(_)) => self.observe_pick(),
            _ => {}
        }
    }
}
