//! Sequences of picture files in a comparison: the frame that they show, playback, and the shift between them.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::Session;
use super::feature::Feature;
use super::picture_role::PictureRole;
use super::window_task::WindowTask;
use crate::image::sequence::FileSequence;
use crate::inspect::project::{ComparedFile, Comparison, FilePlayback};

/// Selectable playback speeds, in frames per second.
pub(crate) const SPEEDS: [f32; 7] = [1.0, 6.0, 12.0, 24.0, 25.0, 30.0, 60.0];

/// Opened sequence of picture files.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct OpenedSequence {
    /// Path that was opened: a folder, or a pattern. The comparison knows the shown frame by this path.
    pub(crate) path: PathBuf,
    /// Files of the sequence.
    pub(crate) files: Arc<FileSequence>,
    /// Number of frames by which the sequence is ahead of the others.
    pub(crate) shift: i64,
}

impl OpenedSequence {
    /// Returns the number and the file for a common frame number: the last frame up to it, or the first one.
    pub(crate) fn at(&self, frame: i64) -> (u64, &Path) {
        self.files.at_or_before(frame.saturating_add(self.shift))
    }
}

/// Opened sequences of picture files, and the frame that all of them show.
#[derive(Debug)]
pub(crate) struct Sequences {
    opened: Vec<OpenedSequence>,
    /// Shifts of the last opened project by path, for its sequences when they are opened.
    of_project: BTreeMap<PathBuf, i64>,
    /// Frame number that all sequences show, before their shifts.
    pub(crate) frame: i64,
    /// Whether the sequences are being played.
    pub(crate) is_playing: bool,
    /// Playback speed in frames per second.
    pub(crate) speed: f32,
    /// Elapsed fraction of the shown frame's time, in [0, 1).
    due: f32,
}

impl Default for Sequences {
    fn default() -> Self {
        Self { opened: Vec::new(), of_project: BTreeMap::new(), frame: 0, is_playing: false, speed: 24.0, due: 0.0 }
    }
}

/// Change to the sequences that the user requests.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum SequenceChange {
    /// Shows this frame and pauses.
    Go(i64),
    /// Shows the frame after this number of frames and pauses.
    Step(i64),
    /// Plays from the shown frame, or pauses.
    TogglePlay,
    /// Sets the playback speed in frames per second.
    Speed(f32),
    /// Sets the number of frames by which the sequence with this path is ahead.
    Shift(PathBuf, i64),
    /// Advances playback by this many seconds.
    Tick(f32),
}

impl Feature for Sequences {
    type Change = SequenceChange;

    fn apply(session: &mut Session, change: SequenceChange) -> Option<WindowTask> {
        let (first, last) = session.sequence_range()?;
        let is_loaded = session.shows_wanted_frames();
        let sequences = &mut session.features.sequences;
        match change {
            SequenceChange::Go(frame) => (sequences.frame, sequences.is_playing) = (frame, false),
            SequenceChange::Step(frames) => {
                (sequences.frame, sequences.is_playing) = (sequences.frame.saturating_add(frames), false);
            }
            SequenceChange::TogglePlay => (sequences.is_playing, sequences.due) = (!sequences.is_playing, 0.0),
            SequenceChange::Speed(speed) => sequences.speed = speed,
            SequenceChange::Shift(path, shift) => {
                let named = sequences.opened.iter_mut().filter(|opened| opened.path == path);
                named.for_each(|opened| opened.shift = shift);
            }
            SequenceChange::Tick(seconds) => {
                // Slow files slow playback down: no frame is skipped.
                sequences.due = (sequences.due + seconds * sequences.speed).min(1.0);
                if sequences.due >= 1.0 && is_loaded {
                    sequences.due = 0.0;
                    sequences.frame = if sequences.frame >= last { first } else { sequences.frame + 1 };
                }
            }
        }
        let (first, last) = session.sequence_range()?;
        let sequences = &mut session.features.sequences;
        sequences.frame = sequences.frame.clamp(first, last);
        None
    }

    fn leave_scene(&mut self) {}
}

impl Sequences {
    /// Adds a sequence, or replaces the sequence with the same path and keeps its shift.
    pub(crate) fn insert(&mut self, path: &Path, files: Arc<FileSequence>) {
        let of_project = || self.of_project.get(path).copied().unwrap_or_default();
        let shift = self.get(path).map_or_else(of_project, |opened| opened.shift);
        self.opened.retain(|opened| opened.path != path);
        self.opened.push(OpenedSequence { path: path.to_owned(), files, shift });
    }

    /// Whether a path belongs to the last opened project, which gives the frame to show.
    pub(in crate::ui) fn is_of_project(&self, path: &Path) -> bool {
        self.of_project.contains_key(path)
    }

    /// Returns the playback for a project with these files; `None` if none of them is a sequence.
    pub(in crate::ui) fn stored(&self, files: &[ComparedFile]) -> Option<FilePlayback> {
        let has_sequence = files.iter().any(|entry| self.get(&entry.file).is_some());
        has_sequence.then_some(FilePlayback { frame: self.frame, speed: self.speed })
    }

    /// Restores shifts, frame and speed of a project, and pauses. Its sequences may be opened later.
    pub(in crate::ui) fn restore(&mut self, stored: &Comparison) {
        self.is_playing = false;
        self.of_project.clear();
        let Some(FilePlayback { frame, speed }) = stored.playback else { return };
        (self.frame, self.speed) = (frame, speed);
        self.of_project = stored.files.iter().map(|entry| (entry.file.clone(), entry.shift)).collect();
        for opened in &mut self.opened {
            opened.shift = self.of_project.get(&opened.path).copied().unwrap_or(opened.shift);
        }
    }

    /// Returns the sequence with this path.
    pub(crate) fn get(&self, path: &Path) -> Option<&OpenedSequence> {
        self.opened.iter().find(|opened| opened.path == path)
    }
}

impl Session {
    /// Returns every sequence that takes part in the current comparison, with one of its roles.
    pub(crate) fn shown_sequences(&self) -> Vec<(PictureRole, &OpenedSequence)> {
        let tiles = &self.state.tiles;
        let count = self.features.comparison.shown(tiles);
        let reference = Some(PictureRole::Reference).filter(|_| count > 0);
        let mut shown: Vec<(PictureRole, &OpenedSequence)> = Vec::new();
        for role in (0..count).map(PictureRole::Tile).chain(reference) {
            let sequence = tiles.file(role).and_then(|path| self.features.sequences.get(path));
            shown.extend(
                sequence.filter(|new| shown.iter().all(|(_, known)| known.path != new.path)).map(|s| (role, s)),
            );
        }
        shown
    }

    /// Returns the first and the last common frame number of the shown sequences; `None` if there are none.
    pub(crate) fn sequence_range(&self) -> Option<(i64, i64)> {
        let ranges = self.shown_sequences().into_iter().map(|(_, sequence)| {
            let (first, last) = sequence.files.range();
            let number = |frame: u64| i64::try_from(frame).unwrap_or(i64::MAX).saturating_sub(sequence.shift);
            (number(first), number(last))
        });
        ranges.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }

    /// Whether every shown sequence shows the wanted frame.
    pub(crate) fn shows_wanted_frames(&self) -> bool {
        let frame = self.features.sequences.frame;
        self.shown_sequences().into_iter().all(|(_, sequence)| {
            let shown = self.features.comparison.pictures.get(&sequence.path);
            shown.is_none_or(|shown| shown.file == sequence.at(frame).1)
        })
    }
}
