//! Reading files that nobody vouches for.
//!
//! In: a path, perhaps out of somebody else's file. Out: the bytes, or the reason why not. Directories, devices and
//! pipes are refused before they are opened (opening a pipe waits for its writer, and a device may never end), and no
//! more than the limit is ever read, even if the file grows meanwhile.

use std::fs::File;
use std::io::{self, Read as _};
use std::path::Path;

/// All bytes of the regular file at `path`, if there are at most `max_bytes`.
pub(crate) fn read(path: &Path, max_bytes: u64) -> io::Result<Vec<u8>> {
    let metadata = std::fs::metadata(path)?;
    if metadata.is_dir() {
        return Err(refused("it is a folder".to_owned()));
    }
    if !metadata.is_file() {
        return Err(refused("it is not a regular file".to_owned()));
    }
    let too_large = || refused(format!("it is larger than {} MiB, the most that is read", max_bytes >> 20));
    if metadata.len() > max_bytes {
        return Err(too_large());
    }
    let mut bytes = Vec::with_capacity(metadata.len() as usize);
    File::open(path)?.take(max_bytes + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > max_bytes { Err(too_large()) } else { Ok(bytes) }
}

fn refused(reason: String) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, reason)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_devices_and_large_files_are_refused_by_name_of_the_cause() {
        let folder = tempfile::tempdir().unwrap();
        let reason = |path: &Path| read(path, 1 << 20).unwrap_err().to_string();
        assert_eq!(reason(folder.path()), "it is a folder");
        if cfg!(unix) {
            assert_eq!(reason(Path::new("/dev/zero")), "it is not a regular file");
        }
        let large = folder.path().join("large");
        File::create(&large).unwrap().set_len((1 << 20) + 1).unwrap();
        assert_eq!(reason(&large), "it is larger than 1 MiB, the most that is read");
    }

    #[test]
    fn a_file_of_exactly_the_limit_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        std::fs::write(&path, b"1234").unwrap();
        assert_eq!(read(&path, 4).unwrap(), b"1234");
    }
}
