//! Loading of the material libraries to which `mtllib` refers.
//!
//! A model file is untrusted and must not make the program open arbitrary files. A library is read only if it is a
//! regular file inside the model's folder, after symbolic links are resolved. Names may contain spaces, and one
//! `mtllib` may list several names. The whole text is therefore tried as one name first, then word by word.

use std::collections::HashSet;
use std::path::{Component, Path, PathBuf};

use super::attributes::quoted;
use super::decode::decode;
use super::faces::{Faces, MeshPart};
use super::mtl::{self, Description, Descriptions};
use super::opacity::{self, TrMeaning};
use crate::disk;
use crate::scene::file_names::{self, NameDifference};
use crate::scene::warnings::Warnings;

/// Maximum size of a material library, in bytes.
const MAX_BYTES: u64 = 16 << 20;

const OUTSIDE: &str = "it lies outside the model's folder";

/// Materials from all libraries of a model.
#[derive(Debug, Default)]
pub(super) struct Libraries {
    /// Material descriptions by name.
    pub(super) descriptions: Descriptions,
    /// Whether MeshLab wrote one of the library files.
    is_meshlab: bool,
}

/// Reads all material libraries of `model`. `named` contains the text after each `mtllib` and its line number.
pub(super) fn read(model: &Path, named: &[(String, usize)], warnings: &mut Warnings) -> Libraries {
    let mut libraries = Libraries::default();
    let mut done = HashSet::new();
    for (names, line) in named {
        for name in split(model, names) {
            match open(model, name) {
                Ok(Opened { path, .. }) if done.contains(&path) => {}
                Ok(Opened { path, text, difference }) => {
                    if difference == NameDifference::Case {
                        let found = quoted(&path.file_name().unwrap_or_default().to_string_lossy());
                        let text =
                            format!("material library {} is read from {found}: the names differ in case", quoted(name));
                        warnings.add(model, Some(*line), text);
                    }
                    libraries.is_meshlab |= mtl::read(&path, &text, &mut libraries.descriptions, warnings);
                    done.insert(path);
                }
                Err(reason) => {
                    let text = format!("material library {} is not read: {reason}", quoted(name));
                    warnings.add(model, Some(*line), text);
                }
            }
        }
    }
    libraries
}

impl Libraries {
    /// Whether `Tr` means opacity in a model that consists of these parts. A part without a material is visible with
    /// either meaning. If there is one, opacity is not inferred from materials that would otherwise all be invisible.
    pub(super) fn tr_is_opacity(&self, meaning: TrMeaning, parts: &[MeshPart], warnings: &mut Warnings) -> bool {
        let names = parts.iter().filter_map(|part| part.material.as_ref());
        let used: Vec<&Description> = names.filter_map(|name| self.descriptions.get(name)).collect();
        let has_plain = parts.iter().any(|part| part.material.is_none());
        let decisive = if has_plain { &[] } else { used.as_slice() };
        opacity::tr_is_opacity(meaning, decisive, &self.descriptions, self.is_meshlab(), warnings)
    }

    /// Warns if materials are loaded but no face uses one.
    pub(super) fn warn_if_unused(&self, model: &Path, faces: &Faces, warnings: &mut Warnings) {
        if self.descriptions.is_empty() || faces.parts.iter().any(|part| part.material.is_some()) {
            return;
        }
        let count = self.descriptions.len();
        let materials = if count == 1 { "1 material is".to_owned() } else { format!("{count} materials are") };
        let line = faces.libraries.first().map(|(_, line)| *line);
        let text = format!("{materials} loaded and none is used: no `usemtl` precedes a face; the default is drawn");
        warnings.add(model, line, text);
    }

    /// Whether MeshLab wrote one of the library files.
    pub(super) fn is_meshlab(&self) -> bool {
        self.is_meshlab
    }
}

/// Content of a material library file.
struct Opened {
    path: PathBuf,
    text: String,
    /// Difference between the name on disk and the name in the model.
    difference: NameDifference,
}

/// Returns the file names that one `mtllib` statement lists. `names` is the text after the keyword.
fn split<'a>(model: &Path, names: &'a str) -> Vec<&'a str> {
    let whole = names.trim_matches('"');
    let is_one = whole.split_whitespace().nth(1).is_none()
        || locate(model, whole).is_ok_and(|path| file_names::existing(&path).is_some());
    if is_one { vec![whole] } else { whole.split_whitespace().collect() }
}

/// Reads the library `name` of `model`. Returns an error for a path outside the model's folder or an unreadable file.
fn open(model: &Path, name: &str) -> Result<Opened, String> {
    let written = locate(model, name)?;
    let (path, difference) = file_names::existing(&written).unwrap_or((written, NameDifference::None));
    let real = path.canonicalize().map_err(|e| e.to_string())?;
    let folder = folder_of(model).canonicalize().map_err(|e| e.to_string())?;
    if !real.starts_with(folder) {
        return Err(OUTSIDE.to_owned());
    }
    let bytes = disk::read(&real, MAX_BYTES).map_err(|e| e.to_string())?;
    Ok(Opened { path, text: decode(bytes)?.text, difference })
}

/// Returns the path of a library. Returns an error if the name leads outside the model's folder, whether or not the
/// file exists.
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

/// Returns the folder of a file; `.` for a bare file name.
fn folder_of(file: &Path) -> PathBuf {
    match file.parent() {
        Some(folder) if folder != Path::new("") => folder.to_owned(),
        _ => PathBuf::from("."),
    }
}
