//! File access: bounded reading of untrusted files, and atomic writing of outputs.
//!
//! Reading: a path may come from an untrusted file, such as a model. The result is the content of the file at that
//! path, or an error. Folders, devices and pipes are refused before they are opened, because opening a pipe waits for
//! its writer and a device may never end. Files that report a length of 0 count as empty and are not opened either,
//! because reading some files in `/proc` blocks. No more than the size limit is read, even if the file grows meanwhile.
//!
//! Writing: every output of the program goes through [`write()`] or [`write_new`]. The bytes are written to a temporary
//! file in the same folder and flushed to the disk; then the file is renamed to the output. The output name therefore
//! always refers to the complete old file or to the complete new file, never to a part.

pub mod stored_path;

use std::collections::BTreeSet;
use std::fs::{File, OpenOptions};
use std::io::{self, ErrorKind, Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use tempfile::{Builder, NamedTempFile};

/// Maximum number of symbolic links followed from the path of an output to its file.
const MAX_LINKS: usize = 40;

/// Canonical paths of the input files recorded since [`protect_inputs`] was called; `None` before that call.
static INPUTS: Mutex<Option<BTreeSet<PathBuf>>> = Mutex::new(None);

/// Reads all bytes of the regular file at `path`.
///
/// # Errors
/// Returns an error if the file is unreadable, not a regular file, or larger than `max_bytes`.
pub fn read(path: &Path, max_bytes: u64) -> io::Result<Vec<u8>> {
    note_input(path);
    read_own(path, max_bytes)
}

/// Reads one of the program's own files, such as its preferences, which the program may replace. Works like [`read`],
/// but the file does not count as an input.
///
/// # Errors
/// Returns the same errors as [`read`].
pub fn read_own(path: &Path, max_bytes: u64) -> io::Result<Vec<u8>> {
    let metadata = std::fs::metadata(path)?;
    if metadata.is_dir() {
        return Err(refused("it is a folder".to_owned()));
    }
    if !metadata.is_file() {
        return Err(refused("it is not a regular file".to_owned()));
    }
    let too_large = || refused(format!("it is larger than {} MiB, the maximum", max_bytes >> 20));
    if metadata.len() > max_bytes {
        return Err(too_large());
    }
    if metadata.len() == 0 {
        return Ok(Vec::new());
    }
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(metadata.len() as usize).map_err(|_| ErrorKind::OutOfMemory)?;
    File::open(path)?.take(max_bytes + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > max_bytes { Err(too_large()) } else { Ok(bytes) }
}

/// Returns the length of the file at `path` in bytes, or 0 if it is unknown.
pub(crate) fn length(path: &Path) -> u64 {
    std::fs::metadata(path).map_or(0, |metadata| metadata.len())
}

/// Returns whether the regular file at `path` starts with these bytes; `false` if it cannot be read.
pub(crate) fn starts_with(path: &Path, prefix: &[u8]) -> bool {
    start(path, prefix.len() as u64) == prefix
}

/// Returns the first bytes of the regular file at `path`, at most `max_bytes`; empty if it cannot be read.
pub(crate) fn start(path: &Path, max_bytes: u64) -> Vec<u8> {
    let mut start = Vec::new();
    let is_regular = std::fs::metadata(path).is_ok_and(|metadata| metadata.is_file());
    let file = is_regular.then(|| File::open(path)).and_then(Result::ok);
    let read = file.is_some_and(|file| file.take(max_bytes).read_to_end(&mut start).is_ok());
    if read { start } else { Vec::new() }
}

/// Makes [`write()`] refuse to replace files that this process reads from now on.
pub fn protect_inputs() {
    lock_inputs().get_or_insert_default();
}

/// Records the file at `path` as an input, which [`write()`] then refuses to replace. Has no effect unless
/// [`protect_inputs`] was called.
pub fn note_input(path: &Path) {
    let mut inputs = lock_inputs();
    if let (Some(inputs), Ok(path)) = (inputs.as_mut(), path.canonicalize()) {
        inputs.insert(path);
    }
}

fn lock_inputs() -> std::sync::MutexGuard<'static, Option<BTreeSet<PathBuf>>> {
    INPUTS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Writes `bytes` to `path` atomically. Replaces an existing file and keeps its permissions; follows symbolic links;
/// creates no folders. Devices and pipes, such as `/dev/stdout`, are written to directly.
///
/// # Errors
/// Returns an error if the file cannot be written or is a protected input. An existing file is then unchanged.
pub fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    write_by(path, |file| file.write_all(bytes))
}

/// Writes the output of `produce` to `path` piece by piece, without holding all of it in memory. In all other respects
/// it works like [`write()`].
///
/// # Errors
/// Returns the same errors as [`write()`], and errors of `produce`. An existing file is then unchanged.
pub fn write_by(path: &Path, produce: impl FnOnce(&mut dyn io::Write) -> io::Result<()>) -> io::Result<()> {
    match Destination::of(path)? {
        Destination::Direct(path) => {
            let mut file = OpenOptions::new().write(true).open(path)?;
            produce(&mut file)?;
            file.flush()
        }
        Destination::Replaced(path) => {
            // Fails for a file without write permission. The rename would replace even such a file.
            let permissions = OpenOptions::new().write(true).open(&path)?.metadata()?.permissions();
            let file = produced(folder_of(&path), produce)?;
            file.as_file().set_permissions(permissions)?;
            file.persist(&path).map_err(|error| error.error)?;
            sync_folder(folder_of(&path));
            Ok(())
        }
        Destination::New(path) => {
            produced(folder_of(&path), produce)?.persist(&path).map_err(|error| error.error)?;
            sync_folder(folder_of(&path));
            Ok(())
        }
    }
}

/// Writes `bytes` atomically to `stem.extension` in `folder` or, if that exists, to the first free one of
/// `stem-2.extension`, `stem-3.extension` … Returns the path. Never replaces a file, even if another process saves at
/// the same time.
///
/// # Errors
/// Returns an error if the file cannot be written.
pub fn write_new(folder: &Path, stem: &str, extension: &str, bytes: &[u8]) -> io::Result<PathBuf> {
    let numbered = |number: u32| match number {
        1 => folder.join(format!("{stem}.{extension}")),
        _ => folder.join(format!("{stem}-{number}.{extension}")),
    };
    let mut file = written(folder, bytes)?;
    for path in (1..).map(numbered) {
        match file.persist_noclobber(&path) {
            Ok(_) => {
                sync_folder(folder);
                return Ok(path);
            }
            Err(error) if error.error.kind() == ErrorKind::AlreadyExists => file = error.file,
            Err(error) => return Err(error.error),
        }
    }
    Err(ErrorKind::AlreadyExists.into())
}

/// Checks that [`write()`] can create or replace `path`, before a long computation. Leaves no file behind.
///
/// # Errors
/// Returns the same errors as [`write()`]. Does not detect a disk that becomes full later.
pub fn check_writable(path: &Path) -> io::Result<()> {
    match Destination::of(path)? {
        Destination::Direct(path) => OpenOptions::new().write(true).open(path).map(drop),
        Destination::Replaced(path) => {
            OpenOptions::new().write(true).open(&path)?;
            written(folder_of(&path), &[]).map(drop)
        }
        Destination::New(path) => written(folder_of(&path), &[]).map(drop),
    }
}

/// Opens the file at `path`, creating it if missing, and locks it against other processes until the returned file is
/// dropped.
///
/// # Errors
/// Returns an error if the file cannot be opened, or if other processes hold the lock for two seconds.
pub fn lock(path: &Path) -> io::Result<File> {
    const TRIES: u32 = 100;
    let file = OpenOptions::new().create(true).truncate(false).write(true).open(path)?;
    for _ in 0..TRIES {
        match file.try_lock() {
            Ok(()) => return Ok(file),
            Err(std::fs::TryLockError::WouldBlock) => std::thread::sleep(Duration::from_millis(20)),
            Err(std::fs::TryLockError::Error(error)) => return Err(error),
        }
    }
    Err(ErrorKind::WouldBlock.into())
}

/// Destination of an output, after following symbolic links.
enum Destination {
    /// Device, pipe, or a process's open file in `/proc`, which is written to directly.
    Direct(PathBuf),
    /// Existing regular file, which is replaced atomically.
    Replaced(PathBuf),
    /// Path at which no file exists yet.
    New(PathBuf),
}

impl Destination {
    /// Follows symbolic links to the file to write. Returns an error for a folder or a protected input.
    fn of(path: &Path) -> io::Result<Self> {
        let mut path = path.to_owned();
        for _ in 0..MAX_LINKS {
            let folder = folder_of(&path).canonicalize()?;
            let name = path.file_name().ok_or_else(|| refused("it is a folder".to_owned()))?;
            let real = folder.join(name);
            let metadata = match real.symlink_metadata() {
                Ok(metadata) => metadata,
                Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Self::New(real)),
                Err(error) => return Err(error),
            };
            if metadata.is_symlink() {
                // A link in /proc refers to an open file, which may have no name that a rename could replace.
                if folder.starts_with("/proc") {
                    return Ok(Self::Direct(path));
                }
                path = folder.join(real.read_link()?);
                continue;
            }
            if metadata.is_dir() {
                return Err(refused("it is a folder".to_owned()));
            }
            if lock_inputs().as_ref().is_some_and(|inputs| inputs.contains(&real)) {
                return Err(refused("it is an input of this command; choose another path".to_owned()));
            }
            return Ok(if metadata.is_file() { Self::Replaced(real) } else { Self::Direct(real) });
        }
        Err(refused("it has too many symbolic links".to_owned()))
    }
}

/// Creates a temporary file in `folder`, writes `bytes` to it and flushes it to the disk. The file is deleted when
/// dropped.
fn written(folder: &Path, bytes: &[u8]) -> io::Result<NamedTempFile> {
    produced(folder, |file| file.write_all(bytes))
}

/// Creates a temporary file in `folder`, lets `produce` write to it and flushes it to the disk. The file is deleted
/// when dropped.
fn produced(folder: &Path, produce: impl FnOnce(&mut dyn io::Write) -> io::Result<()>) -> io::Result<NamedTempFile> {
    let mut builder = Builder::new();
    builder.prefix(".rasterscope-").suffix(".tmp");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        // As for any new file, the user's umask removes further permissions.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut file = builder.tempfile_in(folder).map_err(|error| plain(&error))?;
    produce(&mut file).map_err(|error| plain(&error))?;
    if file.as_file().metadata()?.len() > 0 {
        file.as_file().sync_all()?;
    }
    Ok(file)
}

/// Removes the name of the temporary file from an error message, because the caller adds the name of the output.
fn plain(error: &io::Error) -> io::Error {
    match error.get_ref().and_then(std::error::Error::source).and_then(|source| source.downcast_ref::<io::Error>()) {
        Some(source) => source.raw_os_error().map_or_else(|| source.kind().into(), io::Error::from_raw_os_error),
        None => error.kind().into(),
    }
}

/// Flushes the directory entries of a folder to the disk, if the system supports it.
fn sync_folder(folder: &Path) {
    if let Ok(folder) = File::open(folder) {
        // Not every file system supports it; the file itself is on the disk already.
        drop(folder.sync_all());
    }
}

/// Returns the folder of a file, or `.` if the path is only a file name.
fn folder_of(file: &Path) -> &Path {
    match file.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    }
}

fn refused(reason: String) -> io::Error {
    io::Error::new(ErrorKind::InvalidInput, reason)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_name_the_cause_for_folders_devices_and_large_files() {
        let folder = tempfile::tempdir().unwrap();
        let reason = |path: &Path| read(path, 1 << 20).unwrap_err().to_string();
        assert_eq!(reason(folder.path()), "it is a folder");
        if cfg!(unix) {
            assert_eq!(reason(Path::new("/dev/zero")), "it is not a regular file");
        }
        let large = folder.path().join("large");
        File::create(&large).unwrap().set_len((1 << 20) + 1).unwrap();
        assert_eq!(reason(&large), "it is larger than 1 MiB, the maximum");
    }

    #[test]
    fn a_file_of_exactly_the_limit_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        std::fs::write(&path, b"1234").unwrap();
        assert_eq!(read(&path, 4).unwrap(), b"1234");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn files_of_proc_are_empty() {
        // The file reports a length of 0, but has content.
        assert!(!std::fs::read("/proc/self/stat").unwrap().is_empty());
        assert_eq!(read(Path::new("/proc/self/stat"), 1 << 20).unwrap(), b"");
    }

    fn names(folder: &Path) -> Vec<String> {
        let entries = std::fs::read_dir(folder).unwrap();
        let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_write_replaces_the_file_and_leaves_no_other() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out");
        for text in ["first, longer", "second"] {
            write(&path, text.as_bytes()).unwrap();
            assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
        }
        check_writable(&path).unwrap();
        check_writable(&folder.path().join("not yet there")).unwrap();
        assert_eq!(names(folder.path()), ["out"]);
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "second");
    }

    #[test]
    fn new_files_take_the_first_free_name() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["picture.png", "picture-2.png", "picture-3.png"] {
            let path = write_new(folder.path(), "picture", "png", name.as_bytes()).unwrap();
            assert_eq!(path, folder.path().join(name));
        }
        let error = write_new(&folder.path().join("nowhere"), "picture", "png", b"").unwrap_err();
        assert_eq!(error.kind(), ErrorKind::NotFound);
    }

    #[cfg(unix)]
    #[test]
    fn links_and_permissions_are_kept() {
        use std::os::unix::fs::{MetadataExt as _, PermissionsExt as _, symlink};
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        write(&at("real"), b"1").unwrap();
        std::fs::write(at("ordinary"), b"").unwrap();
        let mode = |name: &str| std::fs::metadata(at(name)).unwrap().mode();
        assert_eq!(mode("real"), mode("ordinary"), "a new file has the usual permissions");
        std::fs::set_permissions(at("real"), std::fs::Permissions::from_mode(0o640)).unwrap();
        symlink("real", at("link")).unwrap();
        symlink("made", at("dangling")).unwrap();
        symlink("circle", at("circle")).unwrap();
        write(&at("link"), b"2").unwrap();
        write(&at("dangling"), b"3").unwrap();
        assert!(write(&at("circle"), b"").is_err());
        assert!(at("link").is_symlink() && at("dangling").is_symlink());
        assert_eq!((std::fs::read(at("real")).unwrap(), mode("real") & 0o777), (b"2".to_vec(), 0o640));
        assert_eq!(std::fs::read(at("made")).unwrap(), b"3");
        // A device is written to, not replaced.
        write(Path::new("/dev/null"), b"x").unwrap();
        assert!(!std::fs::metadata("/dev/null").unwrap().is_file());
    }

    #[test]
    fn errors_name_the_cause_and_no_temporary_file() {
        let error = write(Path::new("/nowhere/out"), b"").unwrap_err();
        assert!(!error.to_string().contains(".tmp"), "{error}");
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(write(folder.path(), b"").unwrap_err().to_string(), "it is a folder");
    }
}
