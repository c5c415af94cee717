//! Which files `mtllib` may open.
//!
//! A model is somebody else's text, and must not make this program open whatever it likes: a library is read only if
//! it is a regular file inside the model's folder, after symbolic links are followed. Names may hold spaces, and one
//! `mtllib` may list several names; so the whole is tried as one name first, then word by word.

use std::collections::HashSet;
use std::path::{Component, Path, PathBuf};

use super::attributes::quoted;
use super::decode::decode;
use super::mtl::{self, Descriptions};
use super::warnings::Warnings;
use crate::disk;

/// Largest library that is read, bytes.
const MAX_BYTES: u64 = 16 << 20;

const OUTSIDE: &str = "it lies outside the model's folder";

/// All materials of the libraries that `model` names, given as what stands behind `mtllib` and its line.
pub(super) fn read(model: &Path, named: &[(String, usize)], warnings: &mut Warnings) -> Descriptions {
    let mut known = Descriptions::new();
    let mut done = HashSet::new();
    for (names, line) in named {
        for name in split(model, names) {
            match open(model, name) {
                Ok((path, _)) if done.contains(&path) => {}
                Ok((path, text)) => {
                    mtl::read(&path, &text, &mut known, warnings);
                    done.insert(path);
                }
                Err(reason) => {
                    let text = format!("material library {} is not read: {reason}", quoted(name));
                    warnings.add(model, Some(*line), text);
                }
            }
        }
    }
    known
}

/// The names behind one `mtllib`.
fn split<'a>(model: &Path, names: &'a str) -> Vec<&'a str> {
    let whole = names.trim_matches('"');
    let is_one = whole.split_whitespace().nth(1).is_none() || locate(model, whole).is_ok_and(|path| path.exists());
    if is_one { vec![whole] } else { whole.split_whitespace().collect() }
}

/// Path and text of the library that `model` calls `name`.
fn open(model: &Path, name: &str) -> Result<(PathBuf, String), String> {
    let path = locate(model, name)?;
    let real = path.canonicalize().map_err(|e| e.to_string())?;
    let folder = folder_of(model).canonicalize().map_err(|e| e.to_string())?;
    if !real.starts_with(folder) {
        return Err(OUTSIDE.to_owned());
    }
    let bytes = disk::read(&real, MAX_BYTES).map_err(|e| e.to_string())?;
    Ok((path, decode(bytes)?.text))
}

/// Where the library would be; an error if its name alone leads out of the model's folder, whether it exists or not.
fn locate(model: &Path, name: &str) -> Result<PathBuf, String> {
    let name = name.replace('\\', "/");
    if name.is_empty() {
        return Err("it has no name".to_owned());
    }
    let has_drive = name.chars().nth(1) == Some(':');
    let mut depth = 0_i32;
    for component in Path::new(&name).components() {
        depth += match component {
            Component::Normal(_) => 1,
            Component::CurDir => 0,
            Component::ParentDir => -1,
            Component::RootDir | Component::Prefix(_) => i32::MIN / 2,
        };
        if depth < 0 || has_drive {
            return Err(OUTSIDE.to_owned());
        }
    }
    Ok(folder_of(model).join(name))
}

/// The folder of a file; `.` for a bare name.
fn folder_of(file: &Path) -> PathBuf {
    match file.parent() {
        Some(folder) if folder != Path::new("") => folder.to_owned(),
        _ => PathBuf::from("."),
    }
}
