//! Second pass over an OBJ file: reads faces with their objects, groups and materials (`f`, `o`, `g`, `usemtl`,
//! `mtllib`).
//!
//! Faces become triangles that refer to the lists of the first pass by indices counted from 0. The triangles are
//! collected in [`MeshPart`]s. A part holds the triangles of one object with one material, either all with texture
//! coordinates or all without. Points, lines and curves are skipped with a warning, and so are faces without area.

mod division;

use std::collections::HashMap;
use std::ops::Range;
use std::path::Path;

use glam::Vec3;

use super::attributes::{AttributeLists, quoted};
use super::decode::joined_lines;
use super::polygon::{Triangulation, TriangulationOutcome, Triangulator};
use super::statements::{self, Format, Treatment};
use crate::scene::SceneError;
use crate::scene::load::Load;
use crate::scene::warnings::Warnings;

/// Value that represents "no texture coordinate" or "no normal" in a [`FaceCorner`].
pub(super) const NONE: u32 = u32::MAX;

/// Maximum number of triangles of a scene: the indices of their corners have 32 bits.
const MAX_TRIANGLES: usize = u32::MAX as usize / 3;

/// Estimated memory used by a [`MeshPart`] in bytes, excluding its triangles. Each part becomes a mesh and an instance.
const PART_BYTES: u64 = 1024;

/// Number of copies of the object name and the material name of a part that the memory accounting assumes.
const NAME_COPIES: u64 = 4;

/// Corner of a triangle, as indices into the attribute lists, counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct FaceCorner {
    pub(super) position: u32,
    pub(super) uv: u32,
    pub(super) normal: u32,
}

/// Triangles that become one mesh: one object, one material, and either all with texture coordinates or all without.
#[derive(Debug)]
pub(super) struct MeshPart {
    /// Name of the object or group; empty if the file has none.
    pub(super) name: String,
    /// Material name in the file; `None` before the first `usemtl`.
    pub(super) material: Option<String>,
    /// Line number of the `usemtl` that set the material.
    pub(super) material_line: usize,
    /// Triangles of the part, as ranges of indices into [`Faces::triangles`].
    pub(super) runs: Vec<Range<usize>>,
}

/// Faces of a file, with their parts, material libraries and smoothing.
#[derive(Debug, Default)]
pub(super) struct Faces {
    /// Triangles of all faces, in file order.
    pub(super) triangles: Vec<[FaceCorner; 3]>,
    /// Parts that become meshes, in order of first use. No part is empty.
    pub(super) parts: Vec<MeshPart>,
    /// Text after each `mtllib` statement, and its line number.
    pub(super) libraries: Vec<(String, usize)>,
    /// Runs of triangles with equal smoothing, in ascending order of their first triangle; empty if the file has no `s`
    /// statement.
    pub(super) smoothing: Vec<SmoothingRun>,
}

/// Smoothing of the triangles from `first` up to the next run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct SmoothingRun {
    /// Index of the run's first triangle in [`Faces::triangles`].
    pub(super) first: usize,
    pub(super) smoothing: Smoothing,
}

/// Rule that decides which edges of a triangle are smooth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Smoothing {
    /// No `s` statement precedes the triangle: edges above a crease angle are hard.
    Crease,
    /// All edges are hard (`s off` or `s 0`).
    Off,
    /// Edges to triangles of the same group are smooth at any angle; other edges are hard.
    Group(i64),
}

/// Reads the faces of a whole OBJ file. Appends the self-intersection points of faces to `lists`.
pub(super) fn read(
    path: &Path,
    text: &str,
    lists: &mut AttributeLists,
    warnings: &mut Warnings,
    load: &mut Load<'_>,
) -> Result<Faces, SceneError> {
    let mut reader = FaceReader::new(lists, load);
    let mut statements = joined_lines(text);
    while let Some((line, statement)) = statements.next() {
        reader.load.work(1 + std::mem::take(&mut reader.cut_corners), || statements.completed())?;
        match reader.statement(line, statement.trim()) {
            Ok(None) => {}
            Ok(Some(remark)) => warnings.add(path, Some(line), remark),
            Err(reason) => return Err(SceneError::Line { path: path.to_owned(), line, reason }),
        }
    }
    let FaceReader { corners, faces, load, .. } = reader;
    load.free(corners);
    Ok(faces)
}

/// Result of reading a statement: success, a warning, or an error.
type StatementOutcome = Result<Option<String>, String>;

struct FaceReader<'a, 'l> {
    lists: &'a mut AttributeLists,
    load: &'a mut Load<'l>,
    /// Number of entries in the file's lists of `v`, `vt` and `vn`.
    totals: [usize; 3],
    /// Number of `v`, `vt` and `vn` lines so far, the base of relative indices.
    seen: [usize; 3],
    faces: Faces,
    name: String,
    material: Option<String>,
    material_line: usize,
    /// Indices of the mesh parts for the current object and material: first the part for faces without texture
    /// coordinates, then the part for faces with them.
    current: [Option<usize>; 2],
    known: HashMap<(String, Option<String>, bool), usize>,
    corners: Vec<FaceCorner>,
    outline: Vec<Vec3>,
    local: Triangulation,
    triangulator: Triangulator,
    /// Triangulation work of the last face, which is not yet counted as progress. The unit is the work for one corner
    /// of a simple face.
    cut_corners: usize,
    /// Whether all positions are finite.
    all_finite: bool,
}

impl<'a, 'l> FaceReader<'a, 'l> {
    fn new(lists: &'a mut AttributeLists, load: &'a mut Load<'l>) -> Self {
        Self {
            totals: [lists.positions.len(), lists.uvs.len(), lists.normals.len()],
            all_finite: lists.positions.iter().all(|position| position.is_finite()),
            lists,
            load,
            seen: [0; 3],
            faces: Faces::default(),
            name: String::new(),
            material: None,
            material_line: 0,
            current: [None; 2],
            known: HashMap::new(),
            corners: Vec::new(),
            outline: Vec::new(),
            local: Triangulation::default(),
            triangulator: Triangulator::default(),
            cut_corners: 0,
        }
    }

    fn statement(&mut self, line: usize, statement: &str) -> StatementOutcome {
        let (keyword, rest) = statement.split_once(char::is_whitespace).unwrap_or((statement, ""));
        match keyword {
            "v" => self.seen[0] += 1,
            "vt" => self.seen[1] += 1,
            "vn" => self.seen[2] += 1,
            "f" | "fo" => return self.face(rest),
            "o" | "g" => {
                self.name = rest.trim().to_owned();
                self.current = [None; 2];
            }
            "usemtl" => {
                self.material = Some(rest.trim().to_owned());
                self.material_line = line;
                self.current = [None; 2];
            }
            "mtllib" => self.faces.libraries.push((rest.trim().to_owned(), line)),
            "s" => return Ok(self.smoothing(rest)),
            "" => {}
            other => return self.other_statement(line, other, rest),
        }
        Ok(None)
    }

    /// Handles a comment, a keyword with unexpected capitalisation, a statement that does not affect rendering, or an
    /// unknown keyword.
    fn other_statement(&mut self, line: usize, keyword: &str, rest: &str) -> StatementOutcome {
        match statements::find(Format::Obj, keyword) {
            Some(known) if known.treatment == Treatment::Warned => Ok(Some(known.not_rendered())),
            // Except for the keyword `#MRGB`, a word that starts with `#` begins a comment.
            _ if keyword.starts_with('#') => Ok(None),
            Some(known) => self.statement(line, &format!("{} {rest}", known.keyword)),
            None => Ok(Some(format!("unknown statement {}; ignored", quoted(keyword)))),
        }
    }

    /// Reads `s N`, `s off` or `s 0`. Returns a warning if the group is not a number.
    fn smoothing(&mut self, rest: &str) -> Option<String> {
        let word = rest.split_whitespace().next().unwrap_or_default();
        let group = if word.eq_ignore_ascii_case("off") { Ok(0) } else { word.parse::<i64>() };
        let smoothing = match group {
            Ok(0) | Err(_) => Smoothing::Off,
            Ok(group) => Smoothing::Group(group),
        };
        let first = self.faces.triangles.len();
        match self.faces.smoothing.last_mut() {
            Some(last) if last.smoothing == smoothing => {}
            Some(last) if last.first == first => last.smoothing = smoothing,
            _ => self.faces.smoothing.push(SmoothingRun { first, smoothing }),
        }
        group.is_err().then(|| format!("smoothing group {} is not a number; treated as `off`", quoted(word)))
    }

    fn face(&mut self, rest: &str) -> StatementOutcome {
        self.corners.clear();
        for word in rest.split_whitespace().take_while(|word| !word.starts_with('#')) {
            let corner = self.corner(word)?;
            self.load.push(&mut self.corners, corner)?;
        }
        if self.corners.len() < 3 {
            return Ok(Some("face with fewer than three corners; skipped".to_owned()));
        }
        let with_uv = self.corners.iter().filter(|c| c.uv != NONE).count();
        let has_uvs = with_uv == self.corners.len();
        if !has_uvs {
            self.corners.iter_mut().for_each(|c| c.uv = NONE);
        }
        let is_broken = !self.all_finite && self.has_broken_corner();
        let outcome = if is_broken { self.fan() } else { self.triangulate()? };
        self.add_crossings()?;
        if !self.local.triangles.is_empty() {
            self.store(has_uvs)?;
        }
        Ok(match outcome {
            _ if is_broken => Some("face with a corner that is not finite; not drawn".to_owned()),
            TriangulationOutcome::NoArea => Some("face without area; skipped".to_owned()),
            TriangulationOutcome::Crossing => {
                Some("face that crosses itself; filled by its winding numbers".to_owned())
            }
            TriangulationOutcome::NotFlat => {
                Some("face that is not flat and crosses itself in its plane; drawn as a fan".to_owned())
            }
            TriangulationOutcome::TooManyCrossings => {
                Some("face that crosses itself too often; drawn as a fan".to_owned())
            }
            TriangulationOutcome::Whole if with_uv > 0 && !has_uvs => {
                Some("face with texture coordinates at some corners only; drawn without them".to_owned())
            }
            TriangulationOutcome::Whole => None,
        })
    }

    /// Appends the triangles of the current face to its part.
    fn store(&mut self, has_uvs: bool) -> Result<(), String> {
        let part = self.part(has_uvs)?;
        let start = self.faces.triangles.len();
        self.load.reserve(&mut self.faces.triangles, self.local.triangles.len())?;
        let corners = |triangle: &[u32; 3]| triangle.map(|corner| self.corners[corner as usize]);
        self.faces.triangles.extend(self.local.triangles.iter().map(corners));
        if self.faces.triangles.len() > MAX_TRIANGLES {
            return Err(format!("more than {MAX_TRIANGLES} triangles: their indices have 32 bits"));
        }
        let end = self.faces.triangles.len();
        let runs = &mut self.faces.parts[part].runs;
        match runs.last_mut() {
            Some(run) if run.end == start => run.end = end,
            _ => self.load.push(runs, start..end)?,
        }
        Ok(())
    }

    /// Returns the index of the current part, creating the part if necessary.
    fn part(&mut self, has_uvs: bool) -> Result<usize, String> {
        if let Some(part) = self.current[usize::from(has_uvs)] {
            return Ok(part);
        }
        let new = self.faces.parts.len();
        let part = *self.known.entry((self.name.clone(), self.material.clone(), has_uvs)).or_insert(new);
        if part == new {
            let names = self.name.len() + self.material.as_ref().map_or(0, String::len);
            self.load.charge(PART_BYTES + NAME_COPIES * names as u64)?;
            let (name, material) = (self.name.clone(), self.material.clone());
            self.faces.parts.push(MeshPart { name, material, material_line: self.material_line, runs: Vec::new() });
        }
        self.current[usize::from(has_uvs)] = Some(part);
        Ok(part)
    }

    /// Parses a face corner: `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    fn corner(&self, word: &str) -> Result<FaceCorner, String> {
        let totals = self.totals;
        if word.bytes().filter(|b| *b == b'/').count() > 2 {
            return Err(format!("corner {} has more than three parts", quoted(word)));
        }
        let mut places = [NONE; 3];
        for (which, index) in word.split('/').enumerate() {
            // Some exporters refer to normals that they do not write. Computed normals replace them.
            let is_nowhere = which > 0 && totals[which] == 0;
            if which == 0 || !(index.is_empty() || is_nowhere) {
                places[which] = list_index(index, KINDS[which], totals[which], self.seen[which])?;
            }
        }
        let [position, uv, normal] = places;
        let has_length = normal != NONE && self.lists.normals[normal as usize] != Vec3::ZERO;
        Ok(FaceCorner { position, uv, normal: if has_length { normal } else { NONE } })
    }
}

const KINDS: [&str; 3] = ["vertex", "texture coordinate", "normal"];

/// Converts an index in the file to a list position, counted from 0. Positive indices start at 1; negative indices
/// count back from the last of `seen` entries.
fn list_index(index: &str, kind: &str, total: usize, seen: usize) -> Result<u32, String> {
    let digits = index.strip_prefix(['-', '+']).unwrap_or(index);
    if digits.is_empty() || !digits.bytes().all(|b| b.is_ascii_digit()) {
        return Err(format!("{} is not the index of a {kind}", quoted(index)));
    }
    // An index that overflows is treated like one that is too large.
    let relative = index.starts_with('-');
    let count = digits.parse::<usize>().unwrap_or(usize::MAX);
    let place = if relative { seen.checked_sub(count) } else { count.checked_sub(1).filter(|p| *p < total) };
    match place {
        Some(place) if count > 0 => Ok(place as u32),
        _ if count == 0 => Err(format!("{kind} 0: indices start at 1")),
        _ if relative => Err(format!("{kind} {} refers to an entry before the first of {seen}", quoted(index))),
        _ => Err(format!("{kind} {} does not exist; the file has {total}", quoted(index))),
    }
}

#[cfg(test)]
mod tests {
    use super::super::attributes;
    use super::super::attributes::tests::unlimited;
    use super::*;

    const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 1\nvn 0 0 1\n";

    fn faces(text: &str) -> Result<(Faces, Vec<String>), String> {
        let path = Path::new("a.obj");
        let mut warnings = Warnings::default();
        let mut load = unlimited(path);
        let mut lists = attributes::read(path, text, &mut warnings, &mut load).unwrap();
        let faces = read(path, text, &mut lists, &mut warnings, &mut load).map_err(|e| e.to_string())?;
        Ok((faces, warnings.finish(path).iter().map(ToString::to_string).collect()))
    }

    #[test]
    fn indices_count_from_one_or_back_from_the_last_line() {
        let (faces, _) = faces(&format!("f 1 2 3\n{SQUARE}f -4 -3 -2\n")).unwrap();
        assert_eq!(faces.triangles[0], faces.triangles[1]);
        assert_eq!(faces.triangles[0].map(|c| c.position), [0, 1, 2]);
    }

    #[test]
    fn invalid_indices_are_errors_with_the_line() {
        for (index, why) in [
            ("0", "indices start at 1"),
            ("5", "does not exist; the file has 4"),
            ("4294967297", "does not exist"),
            ("18446744073709551617", "does not exist"),
            ("-5", "refers to an entry before"),
            ("1.5", "is not the index"),
            ("1/3", "texture coordinate \"3\" does not exist"),
            ("1//2", "normal \"2\" does not exist"),
            ("1/1/1/1", "more than three parts"),
        ] {
            let message = faces(&format!("{SQUARE}f {index} 2 3\n")).unwrap_err();
            assert!(message.starts_with("a.obj:8: ") && message.contains(why), "{message}");
        }
    }

    #[test]
    fn one_part_per_object_material_and_corner_form() {
        let (faces, _) = faces(&format!(
            "{SQUARE}usemtl a\nf 1 2 3\nf 1/1 2/1 3/2\nf 1 3 4\nusemtl b\nf 1 2 3\nusemtl a\nf 1 2 4\no x\nf 1 2 3\n"
        ))
        .unwrap();
        let summary: Vec<_> = faces.parts.iter().map(|p| format!("{}:{:?}:{:?}", p.name, p.material, p.runs)).collect();
        assert_eq!(
            summary,
            [
                r#":Some("a"):[0..1, 2..3, 4..5]"#,
                r#":Some("a"):[1..2]"#,
                r#":Some("b"):[3..4]"#,
                r#"x:Some("a"):[5..6]"#,
            ]
        );
    }

    #[test]
    fn statements_without_a_surface_are_skipped_with_one_warning_per_kind() {
        let (faces, warnings) =
            faces(&format!("{SQUARE}l 1 2 3\nf 1 1 2\nf 1 2\ncurv 0 1 1 2\nl 1 2\nf 1 2 3\n")).unwrap();
        assert_eq!(faces.triangles.len(), 1);
        assert_eq!(
            warnings,
            [
                "a.obj:8: `l` (lines) is not rendered (2 times, here first)",
                "a.obj:9: face without area; skipped",
                "a.obj:10: face with fewer than three corners; skipped",
                "a.obj:11: `curv` (curve) is not rendered",
            ]
        );
    }

    #[test]
    fn keywords_are_recognised_in_any_case() {
        let text = |usual: bool| {
            let text = format!("{SQUARE}o x\ng y\ns 2\nusemtl m\nf 1/1/1 2/2/1 3/1/1\nmtllib a.mtl\n");
            if usual { text } else { text.to_uppercase().replace("X\n", "x\n").replace("Y\n", "y\n") }
        };
        let (upper, warnings) = faces(&text(false).replace(" M\n", " m\n").replace("A.MTL", "a.mtl")).unwrap();
        assert_eq!(format!("{upper:?}"), format!("{:?}", faces(&text(true)).unwrap().0));
        assert!(warnings.is_empty(), "{warnings:?}");
    }

    #[test]
    fn smoothing_runs_begin_where_the_group_changes() {
        let face = "f 1 2 3\n";
        let (faces, warnings) =
            faces(&format!("{SQUARE}{face}s 1\n{face}s 1\n{face}s off\n{face}S 0\ns 7\n{face}s x\n")).unwrap();
        let runs: Vec<_> = faces.smoothing.iter().map(|run| format!("{} {:?}", run.first, run.smoothing)).collect();
        assert_eq!(runs, ["1 Group(1)", "3 Off", "4 Group(7)", "5 Off"]);
        assert_eq!(warnings, ["a.obj:18: smoothing group \"x\" is not a number; treated as `off`"]);
    }

    #[test]
    fn a_face_with_mixed_corners_loses_only_its_texture_coordinates() {
        let (faces, warnings) = faces(&format!("{SQUARE}f 1/1 2/2 3\n")).unwrap();
        assert_eq!(faces.triangles[0].map(|c| (c.position, c.uv)), [(0, NONE), (1, NONE), (2, NONE)]);
        assert!(warnings[0].contains("at some corners only"), "{warnings:?}");
    }
}
