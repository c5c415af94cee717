//! Material libraries: MTL text to materials, by way of tobj.
//!
//! As for geometry, the text is first checked line by line and rewritten: `newmtl`, `Kd`, `d`, `Tr` and `map_Kd`
//! alone, with complete and finite numbers, names replaced by numbers, texture options taken out of the file name.
//! What the pipeline does not shade (`Ks`, `illum`, bump maps …) is left out silently; of opacity 0 one is told, as some
//! programs write it where they mean 1. A colour with one number is grey, as the format's description has it; `d`
//! wins over `Tr`, its reverse.

use std::collections::{BTreeMap, HashMap};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use glam::Vec3;

use super::attributes::number;
use super::decode::lines;
use super::warnings::Warnings;

/// A material as the library describes it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Description {
    /// `Kd` in [0, 1], if given.
    pub(super) diffuse: Option<Vec3>,
    /// 1 is opaque.
    pub(super) opacity: f32,
    /// `map_Kd`, if given.
    pub(super) picture: Option<Picture>,
}

/// A reference to a picture file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Picture {
    /// As written, with `/` between folders.
    pub(super) name: String,
    /// The library that names it.
    pub(super) library: PathBuf,
    /// Where in the library.
    pub(super) line: usize,
}

/// Materials by their names, in an order that does not change from run to run.
pub(super) type Descriptions = BTreeMap<String, Description>;

/// Adds the materials of one library's `text` to `known`. Of several with one name the last counts.
pub(super) fn read(library: &Path, text: &str, known: &mut Descriptions, warnings: &mut Warnings) {
    let rewritten = rewrite(library, text, warnings);
    if rewritten.names.is_empty() {
        warnings.add(library, None, "the material library has no materials");
    }
    match tobj::load_mtl_buf(&mut rewritten.text.as_bytes()) {
        Ok((materials, _)) => {
            for (number, (name, material)) in rewritten.names.into_iter().zip(materials).enumerate() {
                let line = rewritten.picture_lines.get(&number).copied().unwrap_or(0);
                let description = describe(material, library, line);
                if description.opacity == 0.0 {
                    let line = rewritten.opacity_lines.get(&number).copied();
                    warnings.add(library, line, "opacity 0: what is made of it is not to be seen");
                }
                known.insert(name, description);
            }
        }
        Err(error) => warnings.add(library, None, format!("the material library is not understood: {error}")),
    }
}

fn describe(material: tobj::Material, library: &Path, line: usize) -> Description {
    let transparency = material.unknown_param.get("Tr").and_then(|t| number(t).ok()).unwrap_or(0.0);
    Description {
        diffuse: material.diffuse.map(Vec3::from_array),
        opacity: material.dissolve.unwrap_or(1.0 - transparency),
        picture: material.diffuse_texture.map(|name| Picture { name, library: library.to_owned(), line }),
    }
}

/// MTL text that tobj reads right, and what it does not carry.
#[derive(Default)]
struct Rewritten {
    text: String,
    /// Names of the materials, which the text numbers.
    names: Vec<String>,
    /// For materials with a picture, the line that names it.
    picture_lines: HashMap<usize, usize>,
    /// For materials with an opacity, the first line that sets it.
    opacity_lines: HashMap<usize, usize>,
}

fn rewrite(library: &Path, text: &str, warnings: &mut Warnings) -> Rewritten {
    let mut out = Rewritten::default();
    for (line, statement) in lines(text) {
        let statement = statement.trim();
        let (keyword, rest) = statement.split_once(char::is_whitespace).unwrap_or((statement, ""));
        let mut warn = |remark: String| warnings.add(library, Some(line), remark);
        if keyword == "newmtl" {
            let _ = writeln!(out.text, "newmtl {}", out.names.len());
            out.names.push(rest.trim().to_owned());
        } else if !matches!(keyword, "Kd" | "d" | "Tr" | "map_Kd" | "map_kd") {
        } else if out.names.is_empty() {
            warn(format!("`{keyword}` before any `newmtl`; left out"));
        } else if keyword.starts_with("map") {
            let (name, moved) = without_options(rest);
            if moved {
                warn("texture options that move, scale or turn are not applied".to_owned());
            }
            if name.is_empty() {
                warn(format!("`{keyword}` without a file name; left out"));
            } else {
                out.picture_lines.insert(out.names.len() - 1, line);
                let _ = writeln!(out.text, "map_Kd {name}");
            }
        } else {
            if keyword != "Kd" {
                out.opacity_lines.entry(out.names.len() - 1).or_insert(line);
            }
            let _ = writeln!(out.text, "{}", numbers(keyword, rest, &mut warn));
        }
    }
    out
}

/// The statement with its one or three numbers made complete and clamped to [0, 1]; empty if they cannot be read.
fn numbers(keyword: &str, rest: &str, warn: &mut impl FnMut(String)) -> String {
    let wanted = if keyword == "Kd" { 3 } else { 1 };
    let words = rest.split_whitespace().filter(|word| *word != "-halo").take_while(|word| !word.starts_with('#'));
    let values: Result<Vec<f32>, String> = words.take(wanted).map(number).collect();
    let values = match values {
        Ok(values) if values.is_empty() => Err("no number".to_owned()),
        other => other,
    };
    match values {
        Ok(values) => {
            let mut statement = keyword.to_owned();
            if values.iter().any(|v| !(0.0..=1.0).contains(v)) {
                warn(format!("`{keyword}` outside 0 to 1; clamped"));
            }
            for i in 0..wanted {
                let value = values.get(i).unwrap_or(&values[0]).clamp(0.0, 1.0);
                let _ = write!(statement, " {value:?}");
            }
            statement
        }
        Err(reason) => {
            warn(format!("`{keyword}`: {reason}; left out"));
            String::new()
        }
    }
}

/// Options of texture statements: name, and most values that follow it.
const OPTIONS: [(&str, usize); 14] = [
    ("-blendu", 1),
    ("-blendv", 1),
    ("-boost", 1),
    ("-bm", 1),
    ("-cc", 1),
    ("-clamp", 1),
    ("-colorspace", 1),
    ("-imfchan", 1),
    ("-mm", 2),
    ("-o", 3),
    ("-s", 3),
    ("-t", 3),
    ("-texres", 1),
    ("-type", 1),
];

/// The file name of a texture statement, without options before or behind it and with `/` between folders; and
/// whether one of the options would have moved the picture.
fn without_options(rest: &str) -> (String, bool) {
    let option = |word: &str| OPTIONS.iter().find(|(name, _)| *name == word);
    let moves = |word: &str| matches!(word, "-o" | "-s" | "-t");
    let mut words = rest.split_whitespace().peekable();
    let mut moved = false;
    while let Some((name, most)) = words.peek().and_then(|word| option(word)) {
        words.next();
        moved |= moves(name);
        for taken in 0..*most {
            // Up to three numbers may follow, so a word that is none starts the file name.
            if *most > 1 && taken > 0 && words.peek().is_some_and(|word| number(word).is_err()) {
                break;
            }
            words.next();
        }
    }
    let name: Vec<&str> = words.by_ref().take_while(|word| option(word).is_none()).collect();
    (name.join(" ").trim_matches('"').replace('\\', "/"), moved)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn remarks(text: &str) -> Vec<String> {
        let library = Path::new("a.mtl");
        let (mut known, mut warnings) = (Descriptions::new(), Warnings::default());
        read(library, text, &mut known, &mut warnings);
        warnings.finish(library).iter().map(ToString::to_string).collect()
    }

    #[test]
    fn of_invisible_materials_one_is_told_once() {
        let told = remarks("newmtl a\nd 1\nTr 1\nnewmtl b\nKd 1 1 1\nTr 1\nnewmtl c\nd 0\n");
        assert_eq!(told, ["a.mtl:6: opacity 0: what is made of it is not to be seen (2 times, here first)"]);
    }

    #[test]
    fn opaque_and_transparent_materials_are_read_silently() {
        assert!(remarks("newmtl a\nd 1.0\nTr 0.0\nnewmtl b\nTr 0.9\nnewmtl c\nillum 4\nd 0.01\n").is_empty());
    }
}
