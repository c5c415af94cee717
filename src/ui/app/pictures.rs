//! Opens picture files of a comparison in background threads, and reloads them when they change. Reads the frames of
//! sequences.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use eframe::egui::{Context, Ui};
use notify::{RecommendedWatcher, RecursiveMode, Watcher as _};

use super::Workbench;
use crate::image::file::ImageFileError;
use crate::image::sequence::FileSequence;
use crate::ui::session::Severity;
use crate::ui::session::command::Command;
use crate::ui::session::compare::CompareChange;
use crate::ui::session::compare::files::OpenedPicture;
use crate::ui::session::picture_role::PictureRole;
use crate::ui::task::{BackgroundTask, TaskStatus};

/// Time after the last change of a file before it is read again, so that a file that is being written is rarely read.
const QUIET: Duration = Duration::from_millis(100);

/// Time for which a changed file may stay unreadable before the error is reported; the old picture stays on screen.
const PATIENCE: Duration = Duration::from_secs(5);

/// Picture files that are being read, and the watch on those that are open.
#[derive(Default)]
pub(super) struct PictureFiles {
    opening: Vec<OpeningPicture>,
    changed: Vec<ChangedFile>,
    watch: Option<FolderWatch>,
    /// Frames of sequences that are read but not shown yet.
    ready: Vec<Arc<OpenedPicture>>,
    /// Files of frames that cannot be read.
    unreadable: BTreeSet<PathBuf>,
}

/// Reason to read a file.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Purpose {
    /// The user opened the file.
    Open(PictureRole),
    /// The open file has changed. The time is that of its first unread change.
    Reload(Instant),
    /// The file is a frame of a sequence that is shown now or soon.
    Frame,
}

/// Picture file that a background thread reads.
struct OpeningPicture {
    purpose: Purpose,
    /// Path of the file.
    file: PathBuf,
    task: BackgroundTask<(), Result<OpenedPicture, ImageFileError>>,
}

/// Open picture file that has changed since it was read.
struct ChangedFile {
    path: PathBuf,
    since: Instant,
    read_at: Instant,
}

/// Watch on the folders of all open picture files. Folders are watched instead of files, because many programs replace a
/// file by renaming another one.
struct FolderWatch {
    watcher: RecommendedWatcher,
    folders: BTreeSet<PathBuf>,
    events: Receiver<notify::Result<notify::Event>>,
}

impl FolderWatch {
    /// Creates a watch without folders. Returns `None` if the system has no notifications left.
    fn new(context: Context) -> Option<Self> {
        let (sender, events) = channel();
        let watcher = notify::recommended_watcher(move |event| {
            // The receiver is gone if the window is closed.
            drop(sender.send(event));
            context.request_repaint();
        });
        Some(Self { watcher: watcher.ok()?, folders: BTreeSet::new(), events })
    }

    /// Watches the folder of a file. Returns whether that is possible.
    fn add(&mut self, file: &Path) -> bool {
        let folder = folder_of(file);
        if self.folders.contains(&folder) {
            return true;
        }
        let is_watched = self.watcher.watch(&folder, RecursiveMode::NonRecursive).is_ok();
        if is_watched {
            self.folders.insert(folder);
        }
        is_watched
    }
}

/// Returns the absolute folder of a file.
fn folder_of(file: &Path) -> PathBuf {
    let absolute = std::path::absolute(file).unwrap_or_else(|_| file.to_owned());
    absolute.parent().map_or_else(PathBuf::new, Path::to_owned)
}

impl Workbench {
    /// Opens a picture file, or the shown frame of a sequence of picture files, for a comparison.
    pub(super) fn open_picture(&mut self, ui: &Ui, role: PictureRole, path: &Path) {
        let file = match FileSequence::is_named_by(path).then(|| FileSequence::find(path)) {
            None => path.to_owned(),
            Some(Ok(files)) => self.begin_sequence(path, files),
            Some(Err(error)) => return self.session.report(Severity::Error, error.to_string()),
        };
        if !self.widgets.is_synchronous {
            self.watch_file(ui, &file);
        }
        // The most recent request for a role replaces an earlier one.
        self.pictures.opening.retain(|opening| opening.purpose != Purpose::Open(role));
        self.read_picture(ui.ctx(), Purpose::Open(role), path, &file);
    }

    /// Adds a sequence, and returns the file of its frame to show. The first sequence starts at its first frame, unless a
    /// project gives the frame.
    fn begin_sequence(&mut self, path: &Path, files: FileSequence) -> PathBuf {
        let is_first = self.session.sequence_range().is_none();
        let sequences = &mut self.session.features.sequences;
        if is_first && !sequences.is_of_project(path) {
            sequences.frame = i64::try_from(files.range().0).unwrap_or(i64::MAX);
        }
        sequences.insert(path, Arc::new(files));
        let frame = sequences.frame;
        sequences.get(path).map_or_else(|| path.to_owned(), |sequence| sequence.at(frame).1.to_owned())
    }

    /// Reads a file that was opened as `path`, in the background unless the window is synchronous.
    fn read_picture(&mut self, context: &Context, purpose: Purpose, path: &Path, file: &Path) {
        let tone = self.session.features.comparison.pictures.tone();
        if self.widgets.is_synchronous {
            return self.picture_read(purpose, file, OpenedPicture::read(path, file, tone));
        }
        let (path, wanted) = (path.to_owned(), file.to_owned());
        let task = BackgroundTask::start(context.clone(), move |_, _| Some(OpenedPicture::read(&path, &wanted, tone)));
        self.pictures.opening.push(OpeningPicture { purpose, file: file.to_owned(), task });
    }

    /// Shows the wanted frame of every sequence in the comparison as soon as it is read, and reads the next one during
    /// playback.
    pub(super) fn update_sequences(&mut self, ui: &Ui) {
        let frame = self.session.features.sequences.frame;
        let (first, last) = self.session.sequence_range().unwrap_or_default();
        let next = if frame >= last { first } else { frame + 1 };
        let ahead = Some(next).filter(|_| self.session.features.sequences.is_playing);
        let mut wanted: Vec<(PathBuf, PathBuf)> = Vec::new();
        for frame in [frame].into_iter().chain(ahead) {
            let shown = self.session.shown_sequences().into_iter();
            wanted.extend(shown.map(|(_, sequence)| (sequence.path.clone(), sequence.at(frame).1.to_owned())));
        }
        self.pictures.ready.retain(|picture| wanted.iter().any(|(_, file)| *file == picture.file));
        self.pictures.unreadable.retain(|unreadable| wanted.iter().any(|(_, file)| file == unreadable));
        for (path, file) in &wanted {
            let Some(shown) = self.session.features.comparison.pictures.get(path) else { continue };
            let PictureFiles { opening, ready, unreadable, .. } = &self.pictures;
            let is_known = shown.file == *file
                || unreadable.contains(file)
                || ready.iter().any(|ready| ready.file == *file)
                || opening.iter().any(|opening| opening.file == *file);
            if !is_known {
                self.read_picture(ui.ctx(), Purpose::Frame, path, file);
            }
        }
        // The first ones of the list are shown now.
        let current = wanted.len() / if ahead.is_some() { 2 } else { 1 };
        for (_, file) in &wanted[..current] {
            let due = self.pictures.ready.extract_if(.., |ready| ready.file == *file).next();
            if let Some(picture) = due {
                self.session.apply(Command::Compare(CompareChange::Reload(picture)));
                ui.request_repaint();
            }
        }
    }

    fn watch_file(&mut self, ui: &Ui, path: &Path) {
        if self.pictures.watch.is_none() {
            self.pictures.watch = FolderWatch::new(ui.ctx().clone());
        }
        let is_watched = self.pictures.watch.as_mut().is_some_and(|watch| watch.add(path));
        if !is_watched {
            let text = format!("{}: changes of the file are not noticed; open it again to reload it", path.display());
            self.session.report(Severity::Warning, text);
        }
    }

    /// Shows the pictures that have been read, or reports why they cannot be read.
    pub(super) fn poll_pictures(&mut self) {
        let mut ended = Vec::new();
        self.pictures.opening.retain(|OpeningPicture { purpose, file, task }| match task.poll(&mut None) {
            TaskStatus::Running => true,
            TaskStatus::Ended(result) => {
                ended.extend(result.map(|result| (*purpose, file.clone(), Some(*result))));
                false
            }
            TaskStatus::Lost => {
                ended.push((*purpose, file.clone(), None));
                false
            }
        });
        for (purpose, file, result) in ended {
            match result {
                Some(result) => self.picture_read(purpose, &file, result),
                None => {
                    let text = format!("Reading {} stopped: internal error", file.display());
                    self.session.report(Severity::Error, text);
                }
            }
        }
    }

    /// Reads open picture files again after they have changed.
    pub(super) fn reload_changed_pictures(&mut self, ui: &Ui) {
        let now = Instant::now();
        let events: Vec<_> = self.pictures.watch.iter().flat_map(|watch| watch.events.try_iter()).collect();
        for path in events.into_iter().flatten().filter(|event| !event.kind.is_access()).flat_map(|event| event.paths) {
            let is_it = |file: &Path| {
                file.file_name() == path.file_name() && path.parent().is_some_and(|folder| folder == folder_of(file))
            };
            let changed = self.session.features.comparison.pictures.all().find(|opened| is_it(&opened.file));
            if let Some(file) = changed.map(|opened| opened.file.clone()) {
                self.note_change(file, now, now + QUIET);
            }
        }
        let opening = &self.pictures.opening;
        let is_due = |changed: &ChangedFile| {
            changed.read_at <= now && !opening.iter().any(|opening| opening.file == changed.path)
        };
        let due: Vec<_> = self.pictures.changed.extract_if(.., |changed| is_due(changed)).collect();
        for ChangedFile { path: file, since, .. } in due {
            let opened = self.session.features.comparison.pictures.all().find(|opened| opened.file == file);
            if let Some(path) = opened.map(|opened| opened.path.clone()) {
                self.read_picture(ui.ctx(), Purpose::Reload(since), &path, &file);
            }
        }
        if let Some(next) = self.pictures.changed.iter().map(|changed| changed.read_at).min() {
            ui.request_repaint_after(next.saturating_duration_since(now));
        }
    }

    /// Records that an open file must be read at a time. An earlier unread change keeps its time.
    fn note_change(&mut self, path: PathBuf, since: Instant, read_at: Instant) {
        match self.pictures.changed.iter_mut().find(|changed| changed.path == path) {
            // A file that changes all the time is read from time to time.
            Some(changed) => changed.read_at = changed.read_at.max(read_at.min(changed.since + 2 * QUIET)),
            None => self.pictures.changed.push(ChangedFile { path, since, read_at }),
        }
    }

    /// Whether the file of a picture is the one that is open under its path.
    fn is_shown(&self, picture: &OpenedPicture) -> bool {
        self.session.features.comparison.pictures.get(&picture.path).is_some_and(|opened| opened.file == picture.file)
    }

    fn picture_read(&mut self, purpose: Purpose, path: &Path, result: Result<OpenedPicture, ImageFileError>) {
        match (purpose, result) {
            (Purpose::Open(role), Ok(picture)) => self.session.show_opened_picture(role, Arc::new(picture)),
            (Purpose::Frame, Ok(picture)) => self.pictures.ready.push(Arc::new(picture)),
            (Purpose::Frame, Err(error)) => {
                self.pictures.unreadable.insert(path.to_owned());
                self.session.report(Severity::Warning, format!("{error}; the frame before it stays"));
            }
            // The sequence shows another frame now.
            (Purpose::Reload(_), Ok(picture)) if !self.is_shown(&picture) => {}
            (Purpose::Reload(_), Ok(picture)) => {
                let text = format!("Reloaded {}", picture.name());
                self.session.apply(Command::Compare(CompareChange::Reload(Arc::new(picture))));
                self.session.report(Severity::Info, text);
            }
            // Another program may still be writing the file.
            (Purpose::Reload(since), Err(_)) if since.elapsed() < PATIENCE => {
                self.note_change(path.to_owned(), since, Instant::now() + QUIET);
            }
            (Purpose::Reload(_), Err(error)) => {
                self.session.report(Severity::Warning, format!("{error}; the last complete picture is kept"));
            }
            (Purpose::Open(_), Err(error)) => self.session.report(Severity::Error, error.to_string()),
        }
    }
}
