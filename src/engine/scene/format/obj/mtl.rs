//! Parser for material libraries: converts MTL text to material descriptions.
//!
//! Keywords are case-insensitive, because programs differ in their spelling. A statement that is not rendered gives one
//! warning per keyword and file ([`super::statements`]). A colour with one number is grey, as the format specifies. `d`
//! takes precedence over its complement `Tr`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use glam::{Vec2, Vec3};

use super::attributes::{number, quoted};
use super::decode::lines;
use super::statements::{self, Format, Treatment};
use crate::scene::warnings::Warnings;

/// Description of a material, as parsed from a library.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Description {
    /// Diffuse colour (`Kd`) in [0, 1], if given.
    pub(super) diffuse: Option<Vec3>,
    /// Opacity (`d`) in [0, 1], if given.
    pub(super) dissolve: Option<Located<f32>>,
    /// Transparency or opacity (`Tr`) in [0, 1], if given.
    pub(super) tr: Option<Located<f32>>,
    /// Emitted colour (`Ke`) in [0, 1], if given.
    pub(super) emission: Option<Vec3>,
    /// Specular colour (`Ks`) in [0, 1], if given.
    pub(super) specular: Option<Vec3>,
    /// Specular exponent (`Ns`), at least 0, if given.
    pub(super) shininess: Option<f32>,
    /// Colour texture (`map_Kd`), if given.
    pub(super) picture: Option<PictureReference>,
    /// Emission texture (`map_Ke`), if given.
    pub(super) emission_picture: Option<PictureReference>,
    /// Opacity texture (`map_d`), if given.
    pub(super) alpha_picture: Option<PictureReference>,
    /// Normal map (`norm`), if given.
    pub(super) normal_picture: Option<PictureReference>,
    /// Height map or normal map (`map_Bump` or `bump`), if given.
    pub(super) bump_picture: Option<PictureReference>,
}

/// Value with the library and line that define it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Located<T> {
    pub(super) value: T,
    pub(super) library: PathBuf,
    pub(super) line: usize,
}

/// Reference to a picture file.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PictureReference {
    /// File name of the picture as written in the library, with `/` between folders.
    pub(super) name: String,
    /// Path of the library that names the picture.
    pub(super) library: PathBuf,
    /// Line number in the library that names the picture.
    pub(super) line: usize,
    pub(super) options: TextureOptions,
}

/// Options of a texture statement that affect rendering.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TextureOptions {
    /// Scale of u and v (`-s`).
    pub(super) scale: Vec2,
    /// Offset of u and v (`-o`), with v pointing up.
    pub(super) offset: Vec2,
    /// Whether texture coordinates are clamped (`-clamp on`).
    pub(super) clamp: bool,
    /// Scale factor for the x and y components of a normal map (`-bm`).
    pub(super) bump: f32,
    /// Channel of the picture to read (`-imfchan`), if given.
    pub(super) channel: Option<PictureChannel>,
}

impl Default for TextureOptions {
    fn default() -> Self {
        Self { scale: Vec2::ONE, offset: Vec2::ZERO, clamp: false, bump: 1.0, channel: None }
    }
}

impl TextureOptions {
    /// Whether two sets of options have the same scale, offset and clamping.
    pub(super) fn same_placement(&self, other: &Self) -> bool {
        (self.scale, self.offset, self.clamp) == (other.scale, other.offset, other.clamp)
    }
}

/// Channel of a picture that provides one number per texel (`-imfchan`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum PictureChannel {
    Red,
    Green,
    Blue,
    /// Alpha channel.
    Matte,
    Luminance,
}

/// Material descriptions by name, sorted so that their order is the same in every run.
pub(super) type Descriptions = BTreeMap<String, Description>;

/// Text in a comment that identifies MeshLab, which writes opacity as `Tr`.
const MESHLAB: &str = "meshlab";

/// Adds the materials of one library's `text` to `known`. If a name repeats, the last description wins. Returns whether
/// a comment identifies MeshLab as the exporter.
pub(super) fn read(library: &Path, text: &str, known: &mut Descriptions, warnings: &mut Warnings) -> bool {
    let mut reader = MtlReader { library, warnings, material: None };
    let mut is_meshlab = false;
    for (line, statement) in lines(text) {
        let statement = statement.trim();
        is_meshlab |= statement.starts_with('#') && statement.to_ascii_lowercase().contains(MESHLAB);
        let (keyword, rest) = statement.split_once(char::is_whitespace).unwrap_or((statement, ""));
        if keyword.eq_ignore_ascii_case("newmtl") {
            known.extend(reader.material.replace((rest.trim().to_owned(), Description::default())));
        } else if !(keyword.is_empty() || keyword.starts_with('#')) {
            reader.statement(line, keyword, rest);
        }
    }
    let last = reader.material.take();
    known.extend(last);
    if known.is_empty() {
        warnings.add(library, None, "the material library has no materials");
    }
    is_meshlab
}

struct MtlReader<'a> {
    library: &'a Path,
    warnings: &'a mut Warnings,
    /// Material to which the next statement belongs, with its name; `None` before the first `newmtl`.
    material: Option<(String, Description)>,
}

impl MtlReader<'_> {
    fn warn(&mut self, line: usize, remark: impl Into<String>) {
        self.warnings.add(self.library, Some(line), remark);
    }

    fn statement(&mut self, line: usize, keyword: &str, rest: &str) {
        let known = match statements::find(Format::Mtl, keyword) {
            None => return self.warn(line, format!("unknown statement {}; ignored", quoted(keyword))),
            Some(known) if known.treatment == Treatment::Warned => return self.warn(line, known.not_rendered()),
            Some(known) => known.keyword,
        };
        let Some((name, mut material)) = self.material.take() else {
            return self.warn(line, format!("`{keyword}` before any `newmtl`; ignored"));
        };
        match known {
            "Kd" => material.diffuse = self.color(line, known, rest).or(material.diffuse),
            "Ke" => material.emission = self.color(line, known, rest).or(material.emission),
            "Ks" => material.specular = self.color(line, known, rest).or(material.specular),
            "Ns" => material.shininess = self.shininess(line, rest).or(material.shininess),
            "d" => material.dissolve = self.opacity(line, known, rest).or(material.dissolve),
            "Tr" => material.tr = self.opacity(line, known, rest).or(material.tr),
            _ => {
                let picture = self.picture(line, known, rest);
                let place = match known {
                    "map_Kd" => &mut material.picture,
                    "map_Ke" => &mut material.emission_picture,
                    "map_d" => &mut material.alpha_picture,
                    "norm" => &mut material.normal_picture,
                    _ => &mut material.bump_picture,
                };
                *place = picture.or(place.take());
            }
        }
        self.material = Some((name, material));
    }

    /// Returns the first `COUNT` numbers of a statement. If there are fewer, the first number replaces the missing
    /// ones. Returns `None` with a warning if there are none or one is malformed.
    fn numbers<const COUNT: usize>(&mut self, line: usize, keyword: &str, rest: &str) -> Option<[f32; COUNT]> {
        let words = rest.split_whitespace().take_while(|word| !word.starts_with('#'));
        let values: Result<Vec<f32>, String> = words.take(COUNT).map(number).collect();
        match values {
            Ok(values) if !values.is_empty() => Some(std::array::from_fn(|i| *values.get(i).unwrap_or(&values[0]))),
            other => {
                let reason = other.err().unwrap_or_else(|| "the number is missing".to_owned());
                self.warn(line, format!("`{keyword}`: {reason}; ignored"));
                None
            }
        }
    }

    /// Returns the numbers of a statement, clamped to [0, 1]. Warns if clamping changes a number.
    fn shares<const COUNT: usize>(&mut self, line: usize, keyword: &str, rest: &str) -> Option<[f32; COUNT]> {
        let values = self.numbers::<COUNT>(line, keyword, rest)?;
        if values.iter().any(|v| !(0.0..=1.0).contains(v)) {
            self.warn(line, format!("`{keyword}` outside 0 to 1; clamped"));
        }
        Some(values.map(|v| v.clamp(0.0, 1.0)))
    }

    fn color(&mut self, line: usize, keyword: &str, rest: &str) -> Option<Vec3> {
        self.shares(line, keyword, rest).map(Vec3::from_array)
    }

    fn shininess(&mut self, line: usize, rest: &str) -> Option<f32> {
        let [value] = self.numbers(line, "Ns", rest)?;
        if value < 0.0 {
            self.warn(line, "`Ns` below 0; clamped");
        }
        Some(value.max(0.0))
    }

    fn opacity(&mut self, line: usize, keyword: &str, rest: &str) -> Option<Located<f32>> {
        let rest = match rest.trim().strip_prefix("-halo") {
            Some(rest) => {
                self.option_not_rendered(line, "-halo");
                rest
            }
            None => rest,
        };
        let [value] = self.shares(line, keyword, rest)?;
        Some(Located { value, library: self.library.to_owned(), line })
    }

    fn option_not_rendered(&mut self, line: usize, option: &str) {
        if let Some(statement) = statements::find(Format::Option, option) {
            self.warn(line, statement.not_rendered());
        }
    }

    /// Parses the text after the keyword of a texture statement: a file name, with options before or after it.
    /// Backslashes in the name become `/`. Returns `None` with a warning if there is no name.
    fn picture(&mut self, line: usize, keyword: &str, rest: &str) -> Option<PictureReference> {
        let mut options = TextureOptions::default();
        let mut name = Vec::new();
        let mut words = rest.split_whitespace().peekable();
        while let Some(word) = words.next() {
            let option = word.starts_with('-').then(|| max_values(word)).flatten();
            let Some((option, most)) = option else {
                name.push(word);
                continue;
            };
            let mut values = Vec::with_capacity(most);
            while values.len() < most {
                // An option with several numbers may have fewer than `most`; a word that is not a number starts the
                // file name.
                let ends = |word: &&str| most > 1 && !values.is_empty() && number(word).is_err();
                match words.next_if(|word| !ends(word)) {
                    Some(value) => values.push(value),
                    None => break,
                }
            }
            match options.set(keyword, option, &values) {
                Ok(true) => {}
                Ok(false) => self.option_not_rendered(line, option),
                Err(reason) => self.warn(line, format!("texture option `{option}`: {reason}; ignored")),
            }
        }
        let name = name.join(" ").trim_matches('"').replace('\\', "/");
        if name.is_empty() {
            self.warn(line, format!("`{keyword}` without a file name; ignored"));
            return None;
        }
        Some(PictureReference { name, library: self.library.to_owned(), line, options })
    }
}

impl TextureOptions {
    /// Sets an option of a texture statement with this keyword. Returns `false` if the option is not rendered, and an
    /// error if its values are invalid.
    fn set(&mut self, keyword: &str, option: &str, values: &[&str]) -> Result<bool, String> {
        let numbers: Result<Vec<f32>, String> = values.iter().map(|value| number(value)).collect();
        let at = |i: usize, missing: f32| match &numbers {
            Ok(numbers) => Ok(numbers.get(i).copied().unwrap_or(missing)),
            Err(reason) => Err(reason.clone()),
        };
        let pair = |missing: f32| Ok::<_, String>(Vec2::new(at(0, missing)?, at(1, missing)?));
        let value = values.first().copied().unwrap_or_default();
        match option {
            "-o" => self.offset = pair(0.0)?,
            "-s" => self.scale = pair(1.0)?,
            "-bm" => self.bump = at(0, 1.0)?,
            "-clamp" => self.clamp = switch(value)?,
            "-imfchan" if keyword != "map_d" => return Err(format!("it has no effect on `{keyword}`")),
            "-imfchan" => {
                let unknown = || format!("{} is not one of the channels r, g, b, m, l", quoted(value));
                self.channel = Some(channel(value).ok_or_else(unknown)?);
            }
            _ => return Ok(false),
        }
        Ok(true)
    }
}

/// Parses an option value that is `on` or `off`.
fn switch(value: &str) -> Result<bool, String> {
    match value.to_ascii_lowercase().as_str() {
        "on" => Ok(true),
        "off" => Ok(false),
        _ => Err(format!("{} is neither `on` nor `off`", quoted(value))),
    }
}

fn channel(name: &str) -> Option<PictureChannel> {
    Some(match name.to_ascii_lowercase().as_str() {
        "r" => PictureChannel::Red,
        "g" => PictureChannel::Green,
        "b" => PictureChannel::Blue,
        "m" => PictureChannel::Matte,
        "l" => PictureChannel::Luminance,
        _ => return None,
    })
}

/// Returns the usual spelling of a texture option and the maximum number of values that follow it; `None` if the word
/// is not a known option.
fn max_values(word: &str) -> Option<(&'static str, usize)> {
    let option = statements::find(Format::Option, word)?.keyword;
    let most = match option {
        "-o" | "-s" | "-t" => 3,
        "-mm" => 2,
        _ => 1,
    };
    Some((option, most))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> (Descriptions, Vec<String>) {
        let library = Path::new("a.mtl");
        let (mut known, mut warnings) = (Descriptions::new(), Warnings::default());
        read(library, text, &mut known, &mut warnings);
        (known, warnings.finish(library).iter().map(ToString::to_string).collect())
    }

    #[test]
    fn keywords_are_recognised_in_any_case() {
        let (lower, none) = parsed("NEWMTL m\nkd 1 0 0\nKE 0 1 0\nkS 1 1 1\nNS 9\nD 0.5\nMAP_kd a.png\nNorm n.png\n");
        let (usual, _) = parsed("newmtl m\nKd 1 0 0\nKe 0 1 0\nKs 1 1 1\nNs 9\nd 0.5\nmap_Kd a.png\nnorm n.png\n");
        assert_eq!((lower, none), (usual, vec![]));
    }

    #[test]
    fn a_statement_that_is_not_rendered_gives_one_warning_for_each_keyword() {
        let (_, warnings) = parsed("newmtl a\nNi 1.5\nillum 2\nnewmtl b\nNI 1.5\nmap_pr r.png\nfoo 1\n");
        assert_eq!(
            warnings,
            [
                "a.mtl:2: `Ni` (index of refraction) is not rendered (2 times, here first)",
                "a.mtl:3: `illum` (illumination model; `shading` is a setting) is not rendered",
                "a.mtl:6: `map_Pr` (roughness texture (PBR)) is not rendered",
                "a.mtl:7: unknown statement \"foo\"; ignored",
            ]
        );
    }

    #[test]
    fn texture_options_are_read_before_and_after_the_name() {
        let (known, warnings) = parsed(
            "newmtl m\nmap_Kd -o 0.5 -s 2 3 4 my file.png -clamp on\nmap_d -imfchan G m.png\nmap_bump b.png -bm 2\n",
        );
        let picture = known["m"].picture.clone().unwrap();
        assert_eq!(picture.name, "my file.png");
        assert_eq!(picture.options.offset, Vec2::new(0.5, 0.0));
        assert_eq!((picture.options.scale, picture.options.clamp), (Vec2::new(2.0, 3.0), true));
        assert_eq!(known["m"].alpha_picture.clone().unwrap().options.channel, Some(PictureChannel::Green));
        assert_eq!(known["m"].bump_picture.clone().unwrap().options.bump, 2.0);
        assert!(warnings.is_empty(), "{warnings:?}");
    }

    #[test]
    fn options_that_are_not_rendered_or_not_understood_give_warnings() {
        let (known, warnings) = parsed(
            "newmtl m\nmap_Kd -boost 2 -mm 0 1 -imfchan r -clamp maybe a.png\nmap_d -imfchan z a.png\nd -halo 0.5\n",
        );
        assert_eq!(known["m"].picture.clone().unwrap().name, "a.png");
        assert_eq!(known["m"].dissolve.clone().unwrap().value, 0.5);
        assert_eq!(
            warnings,
            [
                "a.mtl:2: `-boost` (sharpening of mip levels) is not rendered",
                "a.mtl:2: `-mm` (brightness and contrast) is not rendered",
                "a.mtl:2: texture option `-imfchan`: it has no effect on `map_Kd`; ignored",
                "a.mtl:2: texture option `-clamp`: \"maybe\" is neither `on` nor `off`; ignored",
                "a.mtl:3: texture option `-imfchan`: \"z\" is not one of the channels r, g, b, m, l; ignored",
                "a.mtl:4: `-halo` (dissolve by viewing angle) is not rendered",
            ]
        );
    }
}
