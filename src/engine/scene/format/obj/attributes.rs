//! First pass over an OBJ file: reads the numbered lists of vertex attributes (`v`, `vt`, `vn`).
//!
//! The lists are read before any face, because a face may refer to lines below it. NaN and infinity are read with a
//! warning. Positions keep these values, so that the triangles that use them are reported as not finite. Coordinates
//! are kept as written; the optional weight `w`, which only rational curves use, is ignored.

use std::path::Path;

use glam::{Vec2, Vec3};

use super::decode::joined_lines;
use crate::math::unit_or;
use crate::scene::SceneError;
use crate::scene::load::Load;
use crate::scene::warnings::Warnings;

/// Maximum number of entries in one list: indices have 32 bits, and one value is reserved for “none”.
const MAX_ENTRIES: usize = u32::MAX as usize;

/// Vertex attributes of an OBJ file (`v`, `vt`, `vn`), in file order.
#[derive(Debug, Default)]
pub(super) struct AttributeLists {
    /// Positions (`v`), in file units.
    pub(super) positions: Vec<Vec3>,
    /// Vertex colours in [0, 1], which follow the position on a `v` line. Empty if no vertex has a colour; otherwise,
    /// vertices without a colour are white.
    pub(super) colors: Vec<Vec3>,
    /// Texture coordinates (`vt`), with v pointing up as in the file. They may be NaN or infinite.
    pub(super) uvs: Vec<Vec2>,
    /// Unit normals (`vn`); zero for a normal of zero length, NaN for one that is not finite.
    pub(super) normals: Vec<Vec3>,
}

/// Reads the attribute lists of a whole OBJ file.
pub(super) fn read(
    path: &Path,
    text: &str,
    warnings: &mut Warnings,
    load: &mut Load<'_>,
) -> Result<AttributeLists, SceneError> {
    let mut lists = AttributeLists::default();
    let mut statements = joined_lines(text);
    while let Some((line, statement)) = statements.next() {
        load.work(1, || statements.completed())?;
        let mut words = statement.split_whitespace();
        let remark = match words.next() {
            Some("v" | "V") => lists.vertex(words, load),
            Some("vt" | "VT" | "Vt" | "vT") => lists.uv(words, load),
            Some("vn" | "VN" | "Vn" | "vN") => lists.normal(words, load),
            _ => continue,
        };
        match remark {
            Ok(None) => {}
            Ok(Some(remark)) => warnings.add(path, Some(line), remark),
            Err(reason) => return Err(SceneError::Line { path: path.to_owned(), line, reason }),
        }
    }
    Ok(lists)
}

/// Result of reading a line: success, a warning, or an error.
type LineOutcome = Result<Option<&'static str>, String>;

impl AttributeLists {
    /// Drops the lists and releases their memory.
    pub(super) fn free(self, load: &mut Load<'_>) {
        load.free(self.positions);
        load.free(self.colors);
        load.free(self.uvs);
        load.free(self.normals);
    }

    /// Reads a vertex: `v x y z`, optionally followed by a weight, a colour, or a colour with alpha.
    fn vertex<'a>(&mut self, words: impl Iterator<Item = &'a str>, load: &mut Load<'_>) -> LineOutcome {
        let words = Words::<7>::new(words);
        let count = words.count;
        if count < 3 {
            return Err(format!("a vertex needs three coordinates, this one has {count}"));
        }
        if !matches!(count, 3 | 4 | 6 | 7) {
            return Err(
                "after its three coordinates a vertex may have a weight or a colour of three numbers".to_owned()
            );
        }
        let position = words.vector()?;
        push(&mut self.positions, position, load)?;
        let broken = (!position.is_finite()).then_some("position that is not finite; faces that use it are not drawn");
        if count < 6 {
            if !self.colors.is_empty() {
                load.push(&mut self.colors, Vec3::ONE)?;
            }
            return Ok(broken);
        }
        let missing = self.positions.len() - self.colors.len();
        load.reserve(&mut self.colors, missing)?;
        self.colors.resize(self.positions.len() - 1, Vec3::ONE);
        let channel = |i: usize| number(words.list[i]);
        let (color, remark) = match (channel(3), channel(4), channel(5)) {
            (Ok(r), Ok(g), Ok(b)) => (Vec3::new(r, g, b), None),
            _ => (Vec3::ONE, Some("vertex colour that is not three finite numbers; treated as white")),
        };
        let clamped = color.clamp(Vec3::ZERO, Vec3::ONE);
        self.colors.push(clamped);
        Ok(broken.or(remark).or((clamped != color).then_some("vertex colour outside 0 to 1; clamped")))
    }

    /// Reads a texture coordinate: `vt u`, `vt u v` or `vt u v w`. A missing v is 0; w applies only to volume textures
    /// and is ignored.
    fn uv<'a>(&mut self, words: impl Iterator<Item = &'a str>, load: &mut Load<'_>) -> LineOutcome {
        let words = Words::<3>::new(words);
        if words.count == 0 || words.count > 3 {
            return Err(format!("a texture coordinate needs one to three numbers, this one has {}", words.count));
        }
        let v = if words.count > 1 { any_number(words.list[1])? } else { 0.0 };
        let uv = Vec2::new(any_number(words.list[0])?, v);
        push(&mut self.uvs, uv, load)?;
        Ok((!uv.is_finite()).then_some("texture coordinate that is not finite; treated as 0 0"))
    }

    /// Reads a normal: `vn x y z`.
    fn normal<'a>(&mut self, words: impl Iterator<Item = &'a str>, load: &mut Load<'_>) -> LineOutcome {
        let words = Words::<3>::new(words);
        if words.count != 3 {
            return Err(format!("a normal needs three components, this one has {}", words.count));
        }
        let given = words.vector()?;
        if !given.is_finite() {
            push(&mut self.normals, Vec3::NAN, load)?;
            return Ok(Some("normal that is not finite; corners that use it receive no direct light"));
        }
        push(&mut self.normals, unit_or(given.as_dvec3(), Vec3::ZERO), load)?;
        Ok((given == Vec3::ZERO).then_some("zero-length normal; computed from the faces instead"))
    }
}

/// Appends an entry to a list. Returns an error if the list has its maximum length or the memory limit is reached.
fn push<T>(list: &mut Vec<T>, entry: T, load: &mut Load<'_>) -> Result<(), String> {
    if list.len() == MAX_ENTRIES {
        return Err(format!("more than {MAX_ENTRIES} entries in one list: indices have 32 bits"));
    }
    load.push(list, entry)
}

/// Words of a statement, without a trailing comment: the first `N` words, and the total number of words.
struct Words<'a, const N: usize> {
    list: [&'a str; N],
    count: usize,
}

impl<'a, const N: usize> Words<'a, N> {
    fn new(words: impl Iterator<Item = &'a str>) -> Self {
        let mut this = Self { list: [""; N], count: 0 };
        for word in words.take_while(|word| !word.starts_with('#')) {
            if let Some(place) = this.list.get_mut(this.count) {
                *place = word;
            }
            this.count += 1;
        }
        this
    }
}

impl<const N: usize> Words<'_, N> {
    /// Parses the first three words as a vector, whose components may be NaN or infinite.
    fn vector(&self) -> Result<Vec3, String> {
        Ok(Vec3::new(any_number(self.list[0])?, any_number(self.list[1])?, any_number(self.list[2])?))
    }
}

/// Parses a number that may be NaN or infinite, including the spellings of C libraries: `-nan(ind)`, `1.#INF`,
/// `-1.#IND`. Numbers beyond the range of f32 become infinite.
fn any_number(word: &str) -> Result<f32, String> {
    word.parse::<f32>().or_else(|_| {
        let unsigned = word.trim_start_matches(['-', '+']).to_ascii_lowercase();
        match unsigned.strip_prefix("1.#") {
            Some(rest) if rest.starts_with("inf") => {
                Ok(f32::INFINITY.copysign(if word.starts_with('-') { -1.0 } else { 1.0 }))
            }
            Some(rest) if rest.starts_with(['i', 'q', 's', 'n']) => Ok(f32::NAN),
            None if unsigned.starts_with("nan(") => Ok(f32::NAN),
            _ => number(word),
        }
    })
}

/// Parses a finite number. The error message says what is wrong with the word.
pub(super) fn number(word: &str) -> Result<f32, String> {
    match word.parse::<f32>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) if word.contains(|c: char| c.is_ascii_digit()) => Err(format!("{} is too large", quoted(word))),
        Ok(_) => Err(format!("{} is not a finite number", quoted(word))),
        Err(_) if word.replacen(',', ".", 1).parse::<f32>().is_ok() => {
            Err(format!("{} is not a number: write decimals with a point, not with a comma", quoted(word)))
        }
        Err(_) => Err(format!("{} is not a number", quoted(word))),
    }
}

/// Returns a word of the file for display in messages: escaped, and truncated to 40 characters.
pub(super) fn quoted(word: &str) -> String {
    const MAX_QUOTED_CHARS: usize = 40;
    match word.char_indices().nth(MAX_QUOTED_CHARS) {
        Some((end, _)) => format!("{:?}…", &word[..end]),
        None => format!("{word:?}"),
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::scene::{LoadControl, MemoryLimit};

    /// Returns a load that is never cancelled, with the default memory limit.
    pub(in super::super) fn unlimited(path: &Path) -> Load<'_> {
        Load::new(path, LoadControl::quiet(MemoryLimit::default()))
    }

    fn lists(text: &str) -> AttributeLists {
        let path = Path::new("a.obj");
        read(path, text, &mut Warnings::default(), &mut unlimited(path)).unwrap()
    }

    fn error(text: &str) -> String {
        let path = Path::new("a.obj");
        read(path, text, &mut Warnings::default(), &mut unlimited(path)).unwrap_err().to_string()
    }

    #[test]
    fn every_number_format_of_c_is_read() {
        let positions = lists("v 1 2. .5\nv +1 -2.e1 1E-2 # note\n").positions;
        assert_eq!(positions, [Vec3::new(1.0, 2.0, 0.5), Vec3::new(1.0, -20.0, 0.01)]);
    }

    #[test]
    fn bad_numbers_are_errors_that_say_why() {
        for (number, why) in [("0,5", "with a point"), ("1.#", "not a number"), ("3.1+e2", "not a number")] {
            let message = error(&format!("v 0 0 0\nv 0 {number} 0\n"));
            assert!(message.starts_with("a.obj:2: ") && message.contains(why), "{message}");
        }
    }

    #[test]
    fn numbers_that_are_not_finite_are_read_in_every_spelling_with_a_warning() {
        let path = Path::new("a.obj");
        for word in ["nan", "-NaN", "inf", "-Infinity", "1e300", "1.#IND", "-1.#QNAN00", "1.#INF", "-nan(ind)"] {
            let mut warnings = Warnings::default();
            let text = format!("v 0 {word} 0\nvt {word} 1\nvn 0 0 {word}\n");
            let lists = read(path, &text, &mut warnings, &mut unlimited(path)).unwrap();
            let expected =
                if word.to_lowercase().contains("inf") || word == "1e300" { f32::INFINITY } else { f32::NAN };
            assert_eq!(lists.positions[0].y.abs().to_bits(), expected.to_bits(), "{word}");
            assert_eq!(lists.positions[0].y < 0.0, word == "-Infinity", "{word}");
            assert_eq!((lists.uvs[0].is_finite(), lists.normals[0].is_nan()), (false, true), "{word}");
            let lines: Vec<_> = warnings.finish(path).iter().map(|warning| warning.line).collect();
            assert_eq!(lines, [Some(1), Some(2), Some(3)], "{word}");
        }
    }

    #[test]
    fn vertices_without_colour_among_coloured_ones_are_white() {
        let colors = lists("v 0 0 0\nv 0 0 0 1 0 0\nv 0 0 0 1\nv 0 0 0 nan 0 0\nv 0 0 0 0 2 0 1\n").colors;
        assert_eq!(colors, [Vec3::ONE, Vec3::X, Vec3::ONE, Vec3::ONE, Vec3::Y]);
    }

    #[test]
    fn normals_are_units_however_long_they_are_written() {
        assert_eq!(lists("vn 0 3e38 0\nvn 0 0 -1e-40\nvn 0 0 0\n").normals, [Vec3::Y, Vec3::NEG_Z, Vec3::ZERO]);
    }

    #[test]
    fn a_long_word_is_cut_in_messages() {
        assert!(error(&format!("v {} 0 0", "x".repeat(100_000))).len() < 120);
    }
}
