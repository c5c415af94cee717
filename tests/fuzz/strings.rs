//! Fuzz target: settings, cameras, overlays, display ranges and search texts, in the forms that users write.

use std::path::Path;
use std::sync::{Arc, LazyLock};

use fastrand::Rng;
use rasterscope::chain::{Frame, Recipe, SettingKey, ValueForm};
use rasterscope::inspect::display::{ColorMap, Display};
use rasterscope::inspect::fields::assignments;
use rasterscope::inspect::find::{SearchTarget, find};
use rasterscope::inspect::overlays::{Overlay, OverlayLayer};
use rasterscope::pipeline::settings::Choice;
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::scene::{Scene, camera_file};
use serde_json::Value;

use crate::fuzz::driver::{Failure, Target};
use crate::fuzz::input::Input;
use crate::fuzz::mutate::{number, pick, word};
use crate::fuzz::{equal, mutate};
use crate::internal::scene_builder;

/// Name of the input file, which has one text per line, preceded by its kind.
const FILE: &str = "texts.txt";

/// Size of the drawn pictures, in pixels.
const SIZE: Viewport = Viewport { width: 19, height: 13 };

/// Text of a valid camera file.
const CAMERA: &str = r#"{"eye":[1.5,1.2,3.0],"target":[0,0,0],"up":[0,1,0],"fov_y_degrees":45,"near":0.1,"far":100}"#;

/// Scene that is drawn and searched.
static SCENE: LazyLock<Arc<Scene>> = LazyLock::new(|| Arc::new(scene_builder::ground_and_cube()));

/// Frame of [`SCENE`] with the default settings.
static FRAME: LazyLock<Frame> =
    LazyLock::new(|| scene_builder::render(&SCENE, &Recipe::default(), (SIZE.width, SIZE.height)));

/// Fuzz target that parses damaged texts.
pub(crate) struct Strings;

impl Target for Strings {
    fn name(&self) -> &'static str {
        "strings"
    }

    fn generate(&self, rng: &mut Rng) -> Input {
        let lines: Vec<_> = (0..rng.usize(1..12)).map(|_| damaged(rng)).collect();
        Input::file(FILE, lines.join("\n") + "\n")
    }

    fn run(&self, folder: &Path) -> Result<(), Failure> {
        let bytes = std::fs::read(folder.join(FILE)).unwrap_or_default();
        let text = String::from_utf8_lossy(&bytes);
        let mut recipe = Recipe::default();
        for (kind, text) in text.lines().filter_map(|line| line.split_once(' ')) {
            match kind {
                "set" => check_setting(&mut recipe, text)?,
                "layer" => check_layer(text)?,
                "look" => check_look(text)?,
                "go" => check_place(text),
                "camera" => check_camera(text, &recipe)?,
                _ => {}
            }
        }
        let settings: Vec<_> =
            text.lines().filter_map(|line| line.strip_prefix("set ")).filter(|text| text.contains('=')).collect();
        check_all_settings(&settings)
    }
}

/// Returns a random text preceded by its kind, damaged in a third of the cases.
fn damaged(rng: &mut Rng) -> String {
    let (kind, text) = match rng.u8(..8) {
        0 => ("camera", camera(rng)),
        1 => ("layer", layer(rng)),
        2 => ("look", look(rng)),
        3 => ("go", place(rng)),
        _ => ("set", sound_setting(rng)),
    };
    let mut bytes = text.into_bytes();
    if rng.u8(..3) == 0 {
        mutate::bytes(rng, &mut bytes);
    }
    format!("{kind} {}", String::from_utf8_lossy(&bytes).replace(['\n', '\r'], " "))
}

/// Returns a random setting `key=value`, whose value is one that the setting accepts, or a number.
pub(crate) fn sound_setting(rng: &mut Rng) -> String {
    let key = *pick(rng, SettingKey::ALL);
    let values = key.values();
    let words: Vec<_> = values.words.iter().map(|word| word.id.as_str()).collect();
    let value = match values.form {
        Some(form) if words.is_empty() || rng.bool() => value_of_form(rng, &form),
        _ => (*pick(rng, &words)).to_owned(),
    };
    let id = if rng.u8(..8) == 0 { key.id().replace('_', "-") } else { key.id().to_owned() };
    format!("{id}={value}")
}

fn value_of_form(rng: &mut Rng, form: &ValueForm) -> String {
    match form {
        ValueForm::Number(_) => number_in_range(rng),
        ValueForm::Whole => rng.u32(..20).to_string(),
        ValueForm::Percent(most) => rng.u32(..=*most).to_string(),
        ValueForm::Numbers(lengths) => {
            let length = *pick(rng, lengths);
            (0..length).map(|_| number_in_range(rng)).collect::<Vec<_>>().join(",")
        }
        ValueForm::Color => format!("#{:06x}", rng.u32(..0x0100_0000)),
    }
}

fn number_in_range(rng: &mut Rng) -> String {
    if rng.u8(..8) == 0 { number(rng) } else { format!("{:.2}", rng.f32() * 2.0 - 0.5) }
}

fn camera(rng: &mut Rng) -> String {
    let mut tree: Value = serde_json::from_str(CAMERA).expect("sound");
    if rng.u8(..4) > 0 {
        mutate::json(rng, &mut tree);
    }
    tree.to_string()
}

fn layer(rng: &mut Rng) -> String {
    let id = pick(rng, Overlay::ALL).id();
    if rng.bool() { id.to_owned() } else { format!("{id}={}", number(rng)) }
}

fn look(rng: &mut Rng) -> String {
    let parts = [
        format!("range={}", word(rng, &["all", "most"])),
        format!("range={}..{}", number(rng), number(rng)),
        format!("range={}:{}:{}:{}", number(rng), number(rng), number(rng), number(rng)),
        format!("map={}", pick(rng, ColorMap::ALL).id()),
        "reversed".to_owned(),
        format!("channels={}", word(rng, &["r", "rg", "rgb", "b", "", "x"])),
    ];
    (0..rng.usize(..5)).map(|_| pick(rng, &parts).clone()).collect::<Vec<_>>().join(",")
}

fn place(rng: &mut Rng) -> String {
    let number = number(rng);
    match rng.u8(..6) {
        0 => format!("{number},{}", rng.u32(..20)),
        1 => format!("{number}% {},{}", rng.u32(..20), rng.u32(..20)),
        2 => format!("tri {number}"),
        3 => format!("vertex {number} of object {}", rng.u32(..3)),
        4 => format!("v {number}"),
        _ => format!("object {number}"),
    }
}

/// Checks that a setting is either rejected without any change, or gives a valid recipe whose settings can be read
/// back.
fn check_setting(recipe: &mut Recipe, text: &str) -> Result<(), Failure> {
    let before = *recipe;
    match recipe.set(text) {
        Err(_) if *recipe == before => Ok(()),
        Err(_) => Err(Failure::Wrong(format!("refused setting changes the recipe: {text}"))),
        Ok(()) => check_recipe(recipe),
    }
}

/// Checks that settings in any order are either rejected as a whole, or give a valid recipe.
fn check_all_settings(settings: &[&str]) -> Result<(), Failure> {
    let mut recipe = Recipe::default();
    match recipe.set_all(settings) {
        Err(_) if recipe == Recipe::default() => Ok(()),
        Err(_) => Err(Failure::Wrong(format!("refused settings change the recipe: {settings:?}"))),
        Ok(()) => check_recipe(&recipe),
    }
}

fn check_recipe(recipe: &Recipe) -> Result<(), Failure> {
    recipe.check().map_err(|flaw| Failure::Wrong(format!("accepted setting is invalid: {flaw}")))?;
    let mut again = Recipe::default();
    again.set_all(&assignments(recipe)).map_err(|error| Failure::Wrong(format!("own setting refused: {error}")))?;
    let json = serde_json::to_string(recipe).unwrap_or_default();
    let stored = serde_json::from_str::<Recipe>(&json).map_err(|error| Failure::Wrong(format!("own JSON: {error}")))?;
    if again == *recipe && stored == *recipe {
        Ok(())
    } else {
        Err(Failure::Wrong(format!("recipe is not read back: {json}")))
    }
}

fn check_layer(text: &str) -> Result<(), Failure> {
    let Ok(layer) = text.parse::<OverlayLayer>() else { return Ok(()) };
    let is_same = layer.text().parse() == Ok(layer);
    if is_same { Ok(()) } else { Err(Failure::Wrong(format!("overlay is not read back: {}", layer.text()))) }
}

fn check_look(text: &str) -> Result<(), Failure> {
    let Ok(display) = text.parse::<Display>() else { return Ok(()) };
    let is_same = display.text().parse() == Ok(display);
    if is_same { Ok(()) } else { Err(Failure::Wrong(format!("look is not read back: {}", display.text()))) }
}

/// Searches the scene for what a text names, if the text is valid, to check that this does not panic.
fn check_place(text: &str) {
    if let Ok(wanted) = SearchTarget::parse(text, &SCENE, SIZE, Some(0)) {
        find(&SCENE, &Recipe::default(), &FRAME, &wanted);
    }
}

/// Checks that a camera can be written and read back, and that both executions draw the same picture with it.
fn check_camera(text: &str, recipe: &Recipe) -> Result<(), Failure> {
    let Ok(camera) = camera_file::parse(text) else { return Ok(()) };
    let own = camera_file::text(&camera);
    if camera_file::parse(&own) != Ok(camera) {
        return Err(Failure::Wrong(format!("view is not read back: {own}")));
    }
    equal::check(&SCENE, &camera, recipe, SIZE)
}

#[test]
fn settings_from_descriptions_are_mostly_accepted() {
    let mut rng = Rng::with_seed(1);
    let mut accepted = std::collections::BTreeSet::new();
    for _ in 0..4000 {
        let setting = sound_setting(&mut rng);
        if Recipe::default().set(&setting).is_ok() {
            accepted.insert(setting.split('=').next().unwrap_or_default().replace('-', "_"));
        }
    }
    let missing: Vec<_> = SettingKey::ALL.iter().filter(|key| !accepted.contains(key.id())).collect();
    // Settings that only some upscaling methods support are rejected by the default one.
    assert!(missing.iter().all(|key| key.is_upscaler_option()), "{missing:?}");
}
