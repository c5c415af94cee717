//! Recipes in project files: the settings that differ from the defaults, in the syntax of `--set`.

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::Value;

use crate::chain::Recipe;
use crate::inspect::fields::assignments;
use crate::upscale::{Scale, Upscaling};

/// Start of the setting that names the upscaler.
const METHOD: &str = "upscaler.method=";

/// Start of all settings of the upscaler.
const UPSCALER: &str = "upscaler.";

/// Serialises a recipe as the list of its settings, each as `key=value`.
pub(super) fn serialize<S: Serializer>(recipe: &Recipe, to: S) -> Result<S::Ok, S::Error> {
    assignments(recipe).serialize(to)
}

/// Deserialises a recipe written by [`serialize`]. An upscaler that is not registered becomes native resolution.
pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Recipe, D::Error> {
    let settings = Vec::<String>::deserialize(from)?;
    let has_unknown = settings.iter().any(|setting| unknown(setting).is_some());
    let known = settings.iter().filter(|setting| !has_unknown || !setting.starts_with(UPSCALER));
    let mut recipe = Recipe::default();
    recipe.set_all(&known.cloned().collect::<Vec<_>>()).map_err(|error| Error::custom(format!("settings: {error}")))?;
    Ok(recipe)
}

/// Returns the id of the upscaler that a setting names if it is not registered.
fn unknown(setting: &str) -> Option<&str> {
    setting.strip_prefix(METHOD).filter(|id| Upscaling::new(id, Scale::ONE).is_none())
}

/// Returns the ids of all upscalers in a project file that are not registered, without repetition.
pub(super) fn unknown_upscalers(bytes: &[u8]) -> Vec<String> {
    fn collect(value: &Value, found: &mut Vec<String>) {
        match value {
            Value::String(text) => found.extend(unknown(text).map(str::to_owned)),
            Value::Array(items) => items.iter().for_each(|item| collect(item, found)),
            Value::Object(fields) => fields.values().for_each(|field| collect(field, found)),
            _ => {}
        }
    }
    let mut found = Vec::new();
    collect(&serde_json::from_slice(bytes).unwrap_or_default(), &mut found);
    found.sort_unstable();
    found.dedup();
    found
}
