//! Fuzz target: glTF files, as JSON and binary.

use std::path::Path;

use fastrand::Rng;
use rasterscope::scene::obj::TrMeaning;
use serde_json::Value;

use crate::fuzz::driver::{Failure, Target};
use crate::fuzz::input::Input;
use crate::fuzz::mutate::{self, pick};
use crate::fuzz::{models, seeds};

/// Names of the input file, as JSON and binary; an input has one of them.
const MODELS: [&str; 2] = ["model.gltf", "model.glb"];

/// Start of the JSON chunk of a binary file, in bytes.
const JSON_START: usize = 20;

/// Fuzz target that loads and draws glTF files.
pub(crate) struct Gltf;

impl Target for Gltf {
    fn name(&self) -> &'static str {
        "gltf"
    }

    fn generate(&self, rng: &mut Rng) -> Input {
        let saved = seeds::files("gltf", |suffix| ["gltf", "glb", "bin"].contains(&suffix));
        let models: Vec<_> = saved.iter().filter(|(name, _)| !name.ends_with(".bin")).collect();
        let (name, seed) = pick(rng, &models);
        let mut bytes = match (json_of(seed), rng.u8(..4)) {
            (_, 0) | (None, _) => seed.clone(),
            (Some(mut tree), _) => {
                mutate::json(rng, &mut tree);
                with_json(seed, &tree)
            }
        };
        if rng.u8(..3) == 0 {
            mutate::bytes(rng, &mut bytes);
        }
        let own_buffer = format!("{}.bin", name.trim_end_matches(".gltf"));
        let beside = saved.iter().filter(|(name, _)| *name == own_buffer);
        let input = beside.fold(Input::default(), |input, (name, bytes)| input.with(name, bytes.clone()));
        input.with(MODELS[usize::from(name.ends_with(".glb"))], bytes)
    }

    fn run(&self, folder: &Path) -> Result<(), Failure> {
        let Some(name) = MODELS.iter().find(|name| folder.join(name).is_file()) else { return Ok(()) };
        models::check(&folder.join(name), TrMeaning::Auto, name)
    }
}

/// Returns the JSON of a file; `None` if it is malformed.
fn json_of(file: &[u8]) -> Option<Value> {
    serde_json::from_slice(if file.starts_with(b"glTF") { chunk(file) } else { file }).ok()
}

/// Returns the JSON chunk of a binary file.
fn chunk(file: &[u8]) -> &[u8] {
    let length = file.get(12..16).map_or(0, |bytes| u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]));
    file.get(JSON_START..JSON_START + length as usize).unwrap_or_default()
}

/// Returns a file with other JSON, as JSON or binary like `file`.
fn with_json(file: &[u8], tree: &Value) -> Vec<u8> {
    let mut text = tree.to_string().into_bytes();
    if !file.starts_with(b"glTF") {
        return text;
    }
    text.resize(text.len().next_multiple_of(4), b' ');
    let rest = &file[JSON_START + chunk(file).len()..];
    let number = |number: usize| (number as u32).to_le_bytes();
    let length = JSON_START + text.len() + rest.len();
    [&b"glTF"[..], &number(2), &number(length), &number(text.len()), b"JSON", &text, rest].concat()
}
