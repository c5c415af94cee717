//! Preferences on disk: a background thread writes every change promptly.
//!
//! The file is replaced atomically under a lock. Several windows may run at the same time: each merges its own changes
//! since its last write into the current contents of the file, so the bookmarks of all windows are kept. Unreadable
//! contents are copied to a backup before they are replaced. If a write fails (for example because the disk is full),
//! the old file stays, the failure is reported once, and the write is repeated until it succeeds.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::Duration;

use super::session::{Preferences, WindowState};
use crate::disk;

/// Name of the preferences file in the program's data folder.
const FILE: &str = "preferences.json";

/// Base name of backups, without number and extension.
const BACKUP: &str = "preferences-backup";

/// Maximum size of a preferences file that is read, in bytes.
const MAX_BYTES: u64 = 16 << 20;

/// Minimum time between two writes. Orbiting the camera, for example, changes the preferences in every frame.
const PAUSE: Duration = Duration::from_millis(200);

/// Delay before a failed write is repeated.
const RETRY: Duration = Duration::from_secs(2);

/// Preferences of a window, stored on disk. Dropping the store writes pending changes.
#[derive(Debug)]
pub(crate) struct Store {
    changes: Option<Sender<Preferences>>,
    thread: Option<JoinHandle<()>>,
    failures: Receiver<String>,
    known: Preferences,
}

/// Preferences read from disk.
#[derive(Clone, Debug, Default)]
pub(crate) struct LoadedPreferences {
    /// Preferences, with defaults for everything that cannot be read.
    pub(crate) preferences: Preferences,
    /// Warning about unreadable contents, with the path of their backup; `None` if everything was read.
    pub(crate) warning: Option<String>,
}

/// Reads the preferences in `folder`; returns `None` if there is no file yet.
pub(crate) fn read(folder: &Path) -> Option<LoadedPreferences> {
    let path = folder.join(FILE);
    if !path.exists() {
        return None;
    }
    let (preferences, warning) = match read_file(&path) {
        Ok((preferences, damage)) => (preferences, damage.map(|damage| damage.warning)),
        Err(error) => (Preferences::default(), Some(format!("{}: cannot read preferences: {error}", path.display()))),
    };
    Some(LoadedPreferences { preferences, warning })
}

/// Description of a preferences file that is partly unreadable.
struct Damage {
    warning: String,
    /// Whether the user must be warned, because no earlier backup has the same contents.
    is_new: bool,
}

/// Reads a preferences file. Copies it to a backup if some of it cannot be read.
fn read_file(path: &Path) -> std::io::Result<(Preferences, Option<Damage>)> {
    let bytes = disk::read_own(path, MAX_BYTES)?;
    let stored = String::from_utf8_lossy(&bytes);
    let (preferences, is_complete) = Preferences::read_checked(&stored);
    if is_complete {
        return Ok((preferences, None));
    }
    let folder = path.parent().unwrap_or(Path::new("."));
    let known = backup_of(folder, &bytes);
    let is_new = known.is_none();
    let kept = known.map_or_else(|| disk::write_new(folder, BACKUP, "json", &bytes), Ok);
    let kept = match kept {
        Ok(backup) => format!("the file is kept as {}", backup.display()),
        Err(error) => format!("no backup of the file was written: {error}"),
    };
    let unknown = Preferences::unknown_upscaler(&stored);
    let unknown = unknown.map_or_else(String::new, |id| format!(", such as those with the unknown upscaler `{id}`"));
    let warning = format!("{}: some preferences cannot be read{unknown}; {kept}", path.display());
    Ok((preferences, Some(Damage { warning, is_new })))
}

/// Returns the path of the backup in `folder` that contains these bytes, if there is one.
fn backup_of(folder: &Path, bytes: &[u8]) -> Option<PathBuf> {
    let entries = std::fs::read_dir(folder).ok()?.filter_map(|entry| Some(entry.ok()?.path()));
    let is_backup = |path: &PathBuf| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(BACKUP));
    entries.filter(is_backup).find(|path| disk::read_own(path, MAX_BYTES).is_ok_and(|kept| kept == bytes))
}

impl Store {
    /// Creates a store that writes to `folder`. `found` contains the preferences that were read when the window opened.
    pub(crate) fn new(folder: PathBuf, found: Preferences) -> Self {
        let (changes, heard) = channel();
        let (report, failures) = channel();
        let writer = Writer { folder, base: found.clone(), report, has_failed: false };
        let thread = std::thread::spawn(move || writer.run(&heard));
        Self { changes: Some(changes), thread: Some(thread), failures, known: found }
    }

    /// Queues `now` for writing unless it equals the last queued preferences. Never blocks.
    pub(crate) fn enqueue(&mut self, now: Preferences) {
        if let Some(changes) = self.changes.as_ref().filter(|_| now != self.known) {
            // The thread ends only when the store is dropped, so sending succeeds.
            drop(changes.send(now.clone()));
            self.known = now;
        }
    }

    /// Returns the window state that was queued last.
    pub(crate) fn window(&self) -> &WindowState {
        &self.known.window
    }

    /// Returns the messages about failed writes since the last call.
    pub(crate) fn failures(&self) -> impl Iterator<Item = String> {
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

/// State of the thread that writes the preferences.
struct Writer {
    folder: PathBuf,
    /// Preferences that this window last wrote successfully.
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
                        // The receiver is gone if the window is closed.
                        drop(self.report.send(format!("{}: cannot save preferences: {error}", path.display())));
                    }
                    (unwritten, self.has_failed) = (Some(mine), true);
                }
            }
        }
    }

    /// Merges the changes since the last write into the preferences file.
    fn write(&self, mine: &Preferences) -> std::io::Result<()> {
        std::fs::create_dir_all(&self.folder)?;
        let path = self.folder.join(FILE);
        // On a file system without locks, changes are lost only if two windows write at the same time.
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
        first.enqueue(with(&["a", "b"]));
        drop(first);
        let at = folder.path().join("made");
        let (mut first, mut second) = (store(with(&["a", "b"])), store(with(&["a", "b"])));
        first.enqueue(with(&["a", "b", "first"]));
        drop(first);
        second.enqueue(with(&["b", "second"]));
        drop(second);
        assert_eq!(names(&at), ["b", "first", "second"], "added by both, and one removed by the second");
    }

    #[cfg(unix)]
    #[test]
    fn a_path_that_is_not_utf8_is_stored() {
        use std::os::unix::ffi::OsStrExt as _;
        let folder = tempfile::tempdir().unwrap();
        let path = PathBuf::from(std::ffi::OsStr::from_bytes(b"/models/\xFF.obj"));
        let mut kept = with(&["kept"]);
        kept.bookmarks[0].place.scene = path.clone();
        kept.recent = vec![path.clone()];
        kept.source = Some(path);
        let mut store = Store::new(folder.path().to_owned(), Preferences::default());
        store.enqueue(kept.clone());
        drop(store);
        assert_eq!(read(folder.path()).unwrap().preferences, kept);
    }

    #[test]
    fn an_unreadable_file_is_backed_up_and_reported() {
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
    fn an_upscaler_that_is_not_registered_is_named() {
        let stored = with(&["kept"]).write().replace("\"method\":\"native\"", "\"method\":\"my-net\"");
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(FILE), stored).unwrap();
        let found = read(folder.path()).unwrap();
        assert_eq!(found.preferences.recipe.upscaler.method(), "native");
        let warning = found.warning.unwrap();
        assert!(warning.contains("the unknown upscaler `my-net`; the file is kept as "), "{warning}");
    }

    #[test]
    fn a_write_that_fails_is_reported_and_repeated() {
        let folder = tempfile::tempdir().unwrap();
        let at = folder.path().join("file in the way");
        std::fs::write(&at, "").unwrap();
        let mut store = Store::new(at.clone(), Preferences::default());
        store.enqueue(with(&["a"]));
        let failure = store.failures.recv().unwrap();
        assert!(failure.contains("cannot save preferences"), "{failure}");
        std::fs::remove_file(&at).unwrap();
        drop(store);
        assert_eq!(names(&at), ["a"], "written as soon as it is possible, at the latest when the window closes");
    }
}
