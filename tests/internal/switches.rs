//! Matrix of recipes that is generated from the settings: a recipe for each value of every setting. A new setting or value
//! is included by itself.

use rasterscope::chain::{Recipe, SettingKey, SettingStage, ValueForm};
use rasterscope::pipeline::settings::Choice as _;

use crate::internal::common::recipe;

/// Settings under which other settings have an effect that they lack under the defaults.
struct Context {
    assignments: &'static [&'static str],
    keys: &'static [SettingKey],
}

/// Contexts of the settings that have no effect under the defaults. A test checks that every setting changes a picture in
/// its context.
const CONTEXTS: [Context; 10] = [
    Context { assignments: &["filter=trilinear"], keys: &[SettingKey::MipBias] },
    Context { assignments: &["filter=anisotropic"], keys: &[SettingKey::MaxAnisotropy] },
    Context {
        assignments: &["shading=checker"],
        keys: &[SettingKey::CheckerEven, SettingKey::CheckerOdd, SettingKey::CheckerSquares],
    },
    Context {
        assignments: &["antialias.method=jittered"],
        keys: &[SettingKey::AntialiasLight, SettingKey::AntialiasSamples, SettingKey::AntialiasSeed],
    },
    Context { assignments: &["post.filter=blur"], keys: &[SettingKey::PostLight, SettingKey::PostStrength] },
    Context { assignments: &["post.filter=motion", "post.strength=9"], keys: &[SettingKey::PostAngle] },
    Context { assignments: &["post.filter=own"], keys: &[SettingKey::PostMask] },
    Context {
        assignments: &["upscaler.method=lanczos3", "upscaler.scale=2"],
        keys: &[
            SettingKey::UpscalerAnchor,
            SettingKey::UpscalerDeringing,
            SettingKey::UpscalerLight,
            SettingKey::UpscalerScale,
        ],
    },
    Context { assignments: &["upscaler.method=fsr1", "upscaler.scale=2"], keys: &[SettingKey::UpscalerSharpening] },
    Context {
        assignments: &["upscaler.method=taa"],
        keys: &[
            SettingKey::UpscalerHistoryFilter,
            SettingKey::UpscalerLuminanceWeighting,
            SettingKey::UpscalerRectification,
        ],
    },
];

/// Settings that change no picture by design, as other tests check.
pub(crate) const WITHOUT_EFFECT: [SettingKey; 2] = [SettingKey::Execution, SettingKey::Force];

/// Returns the recipe in whose context the values of a setting have an effect.
pub(crate) fn context_of(key: SettingKey) -> Recipe {
    let own = CONTEXTS.iter().find(|context| context.keys.contains(&key));
    own.map_or_else(Recipe::default, |context| recipe(context.assignments))
}

/// Returns `key=value` for all words of a setting, and for some numbers or colours if it accepts them.
pub(crate) fn assignments_of(key: SettingKey) -> Vec<String> {
    let values = key.values();
    let numbers = match values.form {
        None => Vec::new(),
        Some(ValueForm::Number(Some(range))) => vec![range.start().to_string(), range.end().to_string()],
        Some(ValueForm::Number(None)) => ["0", "-1.5", "2.5", "40", "-5e6"].map(str::to_owned).into(),
        Some(ValueForm::Whole) => ["0", "7"].map(str::to_owned).into(),
        Some(ValueForm::Percent(most)) => vec!["0".to_owned(), most.to_string()],
        Some(ValueForm::Numbers(lengths)) => {
            lengths.iter().flat_map(|length| ["0.75", "-0.3"].map(|number| vec![number; *length].join(","))).collect()
        }
        Some(ValueForm::Color) => vec!["#d04010".to_owned()],
    };
    let words = values.words.into_iter().map(|word| word.id).chain(numbers);
    words.map(|value| format!("{}={value}", key.id())).collect()
}

/// Returns a recipe changed by an assignment, or `None` if it does not accept the value.
fn with(mut recipe: Recipe, assignment: &str) -> Option<Recipe> {
    recipe.set(assignment).ok().map(|()| recipe)
}

/// Returns a recipe with a word in the context of its setting or, if that does not accept it, in the first one that does.
///
/// # Panics
/// Panics if no context accepts the word.
fn with_word(key: SettingKey, assignment: &str) -> Recipe {
    let others = CONTEXTS.iter().map(|context| recipe(context.assignments));
    let mut contexts = [context_of(key), Recipe::default()].into_iter().chain(others);
    contexts.find_map(|context| with(context, assignment)).unwrap_or_else(|| panic!("{assignment} needs a context"))
}

/// Returns a recipe for each value of a setting, with the other settings as in its context. Numbers that are out of range
/// there are left out.
///
/// # Panics
/// Panics if all values are equal, or if no context accepts a word.
pub(crate) fn switches_of(key: SettingKey) -> Vec<Recipe> {
    let assignments = assignments_of(key);
    let (words, numbers) = assignments.split_at(key.values().words.len());
    let with_numbers = numbers.iter().filter_map(|assignment| with(context_of(key), assignment));
    let recipes = distinct(words.iter().map(|assignment| with_word(key, assignment)).chain(with_numbers));
    assert!(recipes.len() > 1, "{}: only one value", key.id());
    recipes
}

/// Returns the recipes of all settings that affect the drawn samples.
pub(crate) fn single_switches() -> Vec<Recipe> {
    switches_where(|stage| stage != SettingStage::Upscale)
}

/// Returns the recipes of all settings of the stage after shading: anti-aliasing, upscaler and post filter.
pub(crate) fn finishing_switches() -> Vec<Recipe> {
    switches_where(|stage| stage == SettingStage::Upscale)
}

fn switches_where(is_wanted: fn(SettingStage) -> bool) -> Vec<Recipe> {
    let keys = SettingKey::ALL.iter().copied().filter(|key| is_wanted(key.stage()));
    distinct(keys.flat_map(switches_of))
}

/// Returns the recipes without repetitions. Variations of several settings contain the default once per setting.
pub(crate) fn distinct(recipes: impl IntoIterator<Item = Recipe>) -> Vec<Recipe> {
    let mut distinct = Vec::new();
    for recipe in recipes {
        if !distinct.contains(&recipe) {
            distinct.push(recipe);
        }
    }
    distinct
}
