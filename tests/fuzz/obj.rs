//! Fuzz target: OBJ models with material libraries and textures.

use std::fmt::Write as _;
use std::path::Path;

use fastrand::Rng;
use rasterscope::scene::obj::TrMeaning;
use rasterscope::scene::obj::statements::{Format, STATEMENTS};

use crate::fuzz::driver::{Failure, Target};
use crate::fuzz::images;
use crate::fuzz::input::Input;
use crate::fuzz::mutate::{number, pick, word};
use crate::fuzz::{models, mutate, seeds};

/// Name of the input file that contains the model.
const MODEL: &str = "model.obj";

/// Name of the material library of generated models.
const LIBRARY: &str = "model.mtl";

/// Name of a marker file; if it exists, `Tr` means opacity.
const TR_IS_OPACITY: &str = "tr-is-opacity";

/// Fuzz target that loads and draws models.
pub(crate) struct Obj;

impl Target for Obj {
    fn name(&self) -> &'static str {
        "obj"
    }

    fn generate(&self, rng: &mut Rng) -> Input {
        let mut input = match seeds::files("models", |suffix| ["obj", "mtl"].contains(&suffix)) {
            [] => generated(rng),
            _ if rng.u8(..3) > 0 => generated(rng),
            saved => sample(rng, saved),
        };
        if rng.u8(..4) == 0 {
            input = input.with(TR_IS_OPACITY, "");
        }
        input
    }

    fn run(&self, folder: &Path) -> Result<(), Failure> {
        let tr = if folder.join(TR_IS_OPACITY).exists() { TrMeaning::Opacity } else { TrMeaning::Auto };
        // A warning may name the material library instead of the model.
        models::check(&folder.join(MODEL), tr, "")
    }
}

/// Returns a damaged seed model with the material libraries that it names, half of them damaged.
fn sample(rng: &mut Rng, saved: &[seeds::File]) -> Input {
    let models: Vec<_> = saved.iter().filter(|(name, _)| name.ends_with(".obj")).collect();
    if models.is_empty() {
        return generated(rng);
    }
    let mut model = pick(rng, &models).1.clone();
    let text = String::from_utf8_lossy(&model).into_owned();
    let mut input = Input::default();
    for (name, bytes) in saved.iter().filter(|(name, _)| name.ends_with(".mtl") && text.contains(name)) {
        let mut bytes = bytes.clone();
        if rng.bool() {
            mutate::bytes(rng, &mut bytes);
        }
        input = input.with(name, bytes);
    }
    mutate::bytes(rng, &mut model);
    input.with(MODEL, model)
}

/// Returns a random model with a material library and up to two textures; some of the files are damaged.
fn generated(rng: &mut Rng) -> Input {
    let mut input = Input::default();
    for _ in 0..rng.u8(..3) {
        let (name, mut bytes) = images::picture(rng);
        if rng.u8(..4) == 0 {
            images::damage(rng, &name, &mut bytes);
        }
        input = input.with(&name, bytes);
    }
    let mut pictures: Vec<_> = input.0.keys().cloned().collect();
    pictures.push("missing.png".to_owned());
    let (mut model, mut library) = (model(rng).into_bytes(), library(rng, &pictures).into_bytes());
    for file in [&mut model, &mut library] {
        if rng.u8(..4) == 0 {
            mutate::bytes(rng, file);
        }
    }
    input.with(MODEL, model).with(LIBRARY, library)
}

/// Returns the text of a random model: lists of vertices, then faces among other statements.
fn model(rng: &mut Rng) -> String {
    let mut text = String::new();
    let counts = [rng.usize(3..24), rng.usize(..9), rng.usize(..9)];
    if rng.u8(..8) > 0 {
        line(&mut text, &["mtllib", word(rng, &[LIBRARY, LIBRARY, LIBRARY, "missing.mtl", "../model.mtl", "."])]);
    }
    for (keyword, count, least) in [("v", counts[0], 3), ("vt", counts[1], 2), ("vn", counts[2], 3)] {
        for _ in 0..count {
            let further = if rng.u8(..8) == 0 { rng.usize(..5) } else { 0 };
            let is_odd = rng.u8(..60) == 0;
            let numbers: Vec<_> = (0..least + further).map(|_| coordinate(rng, is_odd)).collect();
            line(&mut text, &[keyword, &numbers.join(" ")]);
        }
    }
    for _ in 0..rng.usize(1..16) {
        match rng.u8(..12) {
            0 => line(&mut text, &["usemtl", word(rng, &["m0", "m1", "m2", "unknown", "", "m 0"])]),
            1 => line(&mut text, &[word(rng, &["o", "g"]), word(rng, &["a", "b", "", "a b", "\u{202e}x"])]),
            2 => line(&mut text, &["s", word(rng, &["off", "0", "1", "2", "-1", "x", ""])]),
            3 => odd_statement(rng, &mut text, Format::Obj),
            _ => face(rng, &mut text, counts),
        }
    }
    text
}

fn coordinate(rng: &mut Rng, is_odd: bool) -> String {
    match rng.u8(..3) {
        _ if is_odd => number(rng),
        0 => rng.i32(-2..3).to_string(),
        _ => format!("{:.4}", rng.f32() * 2.0 - 1.0),
    }
}

fn line(text: &mut String, words: &[&str]) {
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{}", words.join(" "));
}

/// Appends a face, mostly of existing vertices, in order or in random order (bow ties), sometimes with many corners.
fn face(rng: &mut Rng, text: &mut String, [positions, uvs, normals]: [usize; 3]) {
    let corners = match rng.u8(..24) {
        0 => rng.usize(..3),
        1 => rng.usize(100..1500),
        2..=8 => rng.usize(4..12),
        _ => 3,
    };
    let (has_uv, has_normal) = (uvs > 0 && rng.bool(), normals > 0 && rng.bool());
    let in_order = rng.bool();
    let is_wrong = rng.u8(..24) == 0;
    let index = |rng: &mut Rng, count: usize| match rng.u8(..8) {
        0 if is_wrong => number(rng),
        0 => format!("-{}", rng.usize(1..=count)),
        _ => rng.usize(1..=count).to_string(),
    };
    let words: Vec<_> = (0..corners)
        .map(|corner| {
            let position = if in_order { (corner % positions + 1).to_string() } else { index(rng, positions) };
            match (has_uv, has_normal) {
                (true, true) => format!("{position}/{}/{}", index(rng, uvs), index(rng, normals)),
                (true, false) => format!("{position}/{}", index(rng, uvs)),
                (false, true) => format!("{position}//{}", index(rng, normals)),
                (false, false) => position,
            }
        })
        .collect();
    line(text, &["f", &words.join(" ")]);
}

/// Appends a random statement that the loader supports, with numbers that may be invalid for it.
fn odd_statement(rng: &mut Rng, text: &mut String, format: Format) {
    let statements: Vec<_> = STATEMENTS.iter().filter(|statement| statement.format == format).collect();
    let numbers: Vec<_> = (0..rng.usize(..6)).map(|_| number(rng)).collect();
    let end = word(rng, &["", "", "", " \\", " # 1", "\r", "\t"]);
    line(text, &[pick(rng, &statements).keyword, &(numbers.join(" ") + end)]);
}

/// Returns the text of a random material library of up to three materials.
fn library(rng: &mut Rng, pictures: &[String]) -> String {
    let mut text = String::new();
    for material in 0..rng.usize(..4) {
        line(&mut text, &["newmtl", &format!("m{material}")]);
        for _ in 0..rng.usize(..8) {
            if rng.u8(..3) > 0 {
                odd_statement(rng, &mut text, Format::Mtl);
                continue;
            }
            let keyword = word(rng, &["map_Kd", "map_Kd", "map_Ke", "map_d", "norm", "map_Bump", "bump"]);
            let options: String = (0..rng.usize(..3)).map(|_| option(rng)).collect();
            line(&mut text, &[keyword, &(options + pick(rng, pictures).as_str())]);
        }
    }
    text
}

/// Returns a random option of a texture statement, with values that may be invalid for it.
fn option(rng: &mut Rng) -> String {
    let options: Vec<_> = STATEMENTS.iter().filter(|statement| statement.format == Format::Option).collect();
    let values: Vec<_> = (0..rng.usize(..4))
        .map(|_| if rng.bool() { number(rng) } else { word(rng, &["on", "off", "r", "m", "l"]).to_owned() })
        .collect();
    format!("{} {} ", pick(rng, &options).keyword, values.join(" "))
}
