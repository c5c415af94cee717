//! Preferences on disk: every change is written at once, by a thread of its own.
//!
//! The file is replaced atomically under a lock. Several windows may run at the same time: each writes its own changes
//! since its last write into what the file holds by then, so bookmarks of all of them are kept. What cannot be read is
//! copied to a backup before it is replaced. If a write fails (a full disk), the old file stays, the failure is reported
//! once, and the write is repeated until it succeeds.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::Duration;

use super::session::{Preferences, WindowState};
use crate::disk;

/// Name of the file in the folder of the program's data.
const FILE: &str = "preferences.json";

/// Name of backups, without extension and number.
const BACKUP: &str = "preferences-backup";

/// Largest file that is read, bytes.
const MAX_BYTES: u64 = 16 << 20;

/// Time between two writes: dragging the view changes it in every frame.
const PAUSE: Duration = Duration::from_millis(200);

/// Time until a failed write is repeated.
const RETRY: Duration = Duration::from_secs(2);

/// The preferences of a window, kept on disk. Dropping it writes what is still unwritten.
#[derive(Debug)]
pub struct Store {
    changes: Option<Sender<Preferences>>,
    thread: Option<JoinHandle<()>>,
    failures: Receiver<String>,
    known: Preferences,
}

/// Preferences found on disk.
#[derive(Clone, Debug, Default)]
pub struct Found {
    /// The preferences, or the defaults.
    pub preferences: Preferences,
    /// What could not be read, and where its backup is.
    pub warning: Option<String>,
}

/// Returns the preferences in `folder`; `None` if there is no file yet.
pub fn read(folder: &Path) -> Option<Found> {
    let path = folder.join(FILE);
    if !path.exists() {
        return None;
    }
    let (preferences, warning) = match read_file(&path) {
        Ok((preferences, damage)) => (preferences, damage.map(|damage| damage.warning)),
        Err(error) => (Preferences::default(), Some(format!("{}: cannot read it: {error}", path.display()))),
    };
    Some(Found { preferences, warning })
}

/// Report of a file of which some cannot be read.
struct Damage {
    warning: String,
    /// Whether it was not reported before: no backup held these bytes.
    is_new: bool,
}

/// Reads the file. If some of it cannot be read, the file is kept as a backup.
fn read_file(path: &Path) -> std::io::Result<(Preferences, Option<Damage>)> {
    let bytes = disk::read_own(path, MAX_BYTES)?;
    let (preferences, is_complete) = Preferences::read_checked(&String::from_utf8_lossy(&bytes));
    if is_complete {
        return Ok((preferences, None));
    }
    let folder = path.parent().unwrap_or(Path::new("."));
    let known = backup_of(folder, &bytes);
    let is_new = known.is_none();
    let kept = known.map_or_else(|| disk::write_new(folder, BACKUP, "json", &bytes), Ok);
    let kept = match kept {
        Ok(backup) => format!("kept as {}", backup.display()),
        Err(error) => format!("no backup can be written: {error}"),
    };
    let warning = format!("{}: some of it cannot be read; {kept}", path.display());
    Ok((preferences, Some(Damage { warning, is_new })))
}

/// Returns the backup in `folder` that holds these bytes.
fn backup_of(folder: &Path, bytes: &[u8]) -> Option<PathBuf> {
    let entries = std::fs::read_dir(folder).ok()?.filter_map(|entry| Some(entry.ok()?.path()));
    let is_backup = |path: &PathBuf| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(BACKUP));
    entries.filter(is_backup).find(|path| disk::read_own(path, MAX_BYTES).is_ok_and(|kept| kept == bytes))
}

impl Store {
    /// Keeps preferences in `folder`; `found` is what the window started with.
    pub fn new(folder: PathBuf, found: Preferences) -> Self {
        let (changes, heard) = channel();
        let (report, failures) = channel();
        let writer = Writer { folder, base: found.clone(), report, has_failed: false };
        let thread = std::thread::spawn(move || writer.run(&heard));
        Self { changes: Some(changes), thread: Some(thread), failures, known: found }
    }

    /// Writes `now` if it is not what was written last. Returns at once.
    pub fn keep(&mut self, now: Preferences) {
        if let Some(changes) = self.changes.as_ref().filter(|_| now != self.known) {
            // The thread ends only with this.
            drop(changes.send(now.clone()));
            self.known = now;
        }
    }

    /// Returns the state of the window that was kept last.
    pub fn window(&self) -> &WindowState {
        &self.known.window
    }

    /// Returns failures since the last call.
    pub fn failures(&self) -> impl Iterator<Item = String> {
        self.failures.try_iter()
    }
}

impl Drop for Store {
    fn drop(&mut self) {
        self.changes = None;
        if let Some(thread) = self.thread.take() {
            drop(thread.join());
        }
    }
}

/// The thread that writes.
struct Writer {
    folder: PathBuf,
    /// What this window wrote last.
    base: Preferences,
    report: Sender<String>,
    has_failed: bool,
}

impl Writer {
    fn run(mut self, changes: &Receiver<Preferences>) {
        let mut unwritten: Option<Preferences> = None;
        let mut is_open = true;
        while is_open {
            let change = match unwritten {
                None => changes.recv().map_err(|_| RecvTimeoutError::Disconnected),
                Some(_) => changes.recv_timeout(RETRY),
            };
            is_open = !matches!(change, Err(RecvTimeoutError::Disconnected));
            unwritten = changes.try_iter().last().or(change.ok()).or(unwritten);
            let Some(mine) = unwritten.take() else { continue };
            match self.write(&mine) {
                Ok(()) => {
                    (self.base, self.has_failed) = (mine, false);
                    if is_open {
                        std::thread::sleep(PAUSE);
                    }
                }
                Err(error) => {
                    if !self.has_failed {
                        let path = self.folder.join(FILE);
                        // Nobody listens any more if the window is closed.
                        drop(self.report.send(format!("{}: preferences are not kept: {error}", path.display())));
                    }
                    (unwritten, self.has_failed) = (Some(mine), true);
                }
            }
        }
    }

    /// Merges the changes since the last write into the file.
    fn write(&self, mine: &Preferences) -> std::io::Result<()> {
        std::fs::create_dir_all(&self.folder)?;
        let path = self.folder.join(FILE);
        // Where files cannot be locked, merging still keeps what is not written in the same instant.
        let lock = disk::lock(&self.folder.join("preferences.lock")).ok();
        let theirs = if path.exists() {
            let (theirs, damage) = read_file(&path)?;
            if let Some(Damage { warning, .. }) = damage.filter(|damage| damage.is_new) {
                drop(self.report.send(warning));
            }
            theirs
        } else {
            self.base.clone()
        };
        disk::write(&path, mine.merged(&self.base, &theirs).write().as_bytes())?;
        drop(lock);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ui::session::tests::bookmark;

    fn with(names: &[&str]) -> Preferences {
        Preferences { bookmarks: names.iter().map(|name| bookmark(name)).collect(), ..Preferences::default() }
    }

    fn names(folder: &Path) -> Vec<String> {
        read(folder).unwrap().preferences.bookmarks.into_iter().map(|bookmark| bookmark.name).collect()
    }

    #[test]
    fn two_windows_keep_the_bookmarks_of_both() {
        let folder = tempfile::tempdir().unwrap();
        let store = |found| Store::new(folder.path().join("made"), found);
        let mut first = store(Preferences::default());
        first.keep(with(&["a", "b"]));
        drop(first);
        let at = folder.path().join("made");
        let (mut first, mut second) = (store(with(&["a", "b"])), store(with(&["a", "b"])));
        first.keep(with(&["a", "b", "first"]));
        drop(first);
        second.keep(with(&["b", "second"]));
        drop(second);
        assert_eq!(names(&at), ["b", "first", "second"], "added by both, and one removed by the second");
    }

    #[cfg(unix)]
    #[test]
    fn a_path_that_is_not_utf8_is_kept_with_everything_else() {
        use std::os::unix::ffi::OsStrExt as _;
        let folder = tempfile::tempdir().unwrap();
        let path = PathBuf::from(std::ffi::OsStr::from_bytes(b"/models/\xFF.obj"));
        let mut kept = with(&["kept"]);
        kept.bookmarks[0].place.scene = path.clone();
        kept.recent = vec![path.clone()];
        kept.source = Some(path);
        let mut store = Store::new(folder.path().to_owned(), Preferences::default());
        store.keep(kept.clone());
        drop(store);
        assert_eq!(read(folder.path()).unwrap().preferences, kept);
    }

    #[test]
    fn what_cannot_be_read_is_kept_as_a_backup_and_reported() {
        for damaged in [
            "",
            "no JSON",
            r#"{"scale": 1e300}"#,
            r#"{"bookmarks": [{"name": "of a newer version"}]}"#,
            r#"{"new field": 1}"#,
        ] {
            let folder = tempfile::tempdir().unwrap();
            std::fs::write(folder.path().join(FILE), damaged).unwrap();
            let found = read(folder.path()).unwrap();
            assert!(found.warning.unwrap().contains("preferences-backup.json"), "{damaged}");
            let backup = std::fs::read_to_string(folder.path().join("preferences-backup.json")).unwrap();
            assert_eq!((found.preferences, &*backup), (Preferences::default(), damaged));
            assert!(read(folder.path()).unwrap().warning.is_some(), "it is still damaged");
            assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2, "one backup");
        }
    }

    #[test]
    fn a_write_that_fails_is_reported_and_repeated() {
        let folder = tempfile::tempdir().unwrap();
        let at = folder.path().join("file in the way");
        std::fs::write(&at, "").unwrap();
        let mut store = Store::new(at.clone(), Preferences::default());
        store.keep(with(&["a"]));
        let failure = store.failures.recv().unwrap();
        assert!(failure.contains("preferences are not kept"), "{failure}");
        std::fs::remove_file(&at).unwrap();
        drop(store);
        assert_eq!(names(&at), ["a"], "written as soon as it is possible, at the latest when the window closes");
    }
}
