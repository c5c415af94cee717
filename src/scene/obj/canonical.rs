//! From checked lists and faces to the text that tobj reads right, and to the arrays that it makes of it.
//!
//! The text holds `v`, `vt`, `vn`, `o` and `f` alone: triangles, numbered from 1, every corner with a normal, one `o`
//! for each part and named by the part's number. So none of tobj's limits is met (it shifts attributes when corner
//! forms mix, draws `l` as a face, opens any `mtllib`), and what it does well is left to it: one index for position,
//! texture coordinate and normal.

use std::fmt::Write as _;
use std::path::Path;

use super::attributes::Attributes;
use super::faces::{Corner, Faces, NONE};
use crate::scene::SceneError;

/// The whole geometry as text.
pub(super) fn write(lists: &Attributes, faces: &Faces) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = write_lists(&mut text, lists);
    for (number, part) in faces.parts.iter().enumerate() {
        let _ = writeln!(text, "o {number}");
        for triangle in part.runs.iter().flat_map(|run| &faces.triangles[run.clone()]) {
            let _ = write_face(&mut text, triangle);
        }
    }
    text
}

/// `{:?}` writes the shortest digits that read back as the same number.
fn write_lists(text: &mut String, lists: &Attributes) -> std::fmt::Result {
    for (i, p) in lists.positions.iter().enumerate() {
        write!(text, "v {:?} {:?} {:?}", p.x, p.y, p.z)?;
        if let Some(c) = lists.colors.get(i) {
            write!(text, " {:?} {:?} {:?}", c.x, c.y, c.z)?;
        }
        text.push('\n');
    }
    for t in &lists.uvs {
        writeln!(text, "vt {:?} {:?}", t.x, t.y)?;
    }
    for n in &lists.normals {
        writeln!(text, "vn {:?} {:?} {:?}", n.x, n.y, n.z)?;
    }
    Ok(())
}

fn write_face(text: &mut String, triangle: &[Corner; 3]) -> std::fmt::Result {
    text.push('f');
    for corner in triangle {
        write!(text, " {}/", corner.position + 1)?;
        if corner.uv != NONE {
            write!(text, "{}", corner.uv + 1)?;
        }
        write!(text, "/{}", corner.normal + 1)?;
    }
    text.push('\n');
    Ok(())
}

/// The meshes of a text written by [`write`], in the order of its parts.
pub(super) fn parse(path: &Path, text: &str) -> Result<Vec<tobj::Mesh>, SceneError> {
    let options = tobj::LoadOptions { single_index: true, ..tobj::LoadOptions::default() };
    let no_library = |_: &Path| Ok((Vec::new(), std::collections::HashMap::new()));
    let (models, _) = tobj::load_obj_buf(&mut text.as_bytes(), &options, no_library)
        .map_err(|e| SceneError::Unusable { path: path.to_owned(), reason: e.to_string() })?;
    Ok(models.into_iter().map(|model| model.mesh).collect())
}
