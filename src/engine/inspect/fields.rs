//! Recipes as text: every setting with its value in the syntax of `--set`, and the differences between two recipes.
//!
//! The keys come from [`Recipe::keys`], so new settings of a recipe are included automatically.

use serde_json::Value;

use crate::chain::Recipe;

/// Key prefix of the upscaler settings. Their valid values depend on the upscaling method.
const UPSCALER_KEYS: &str = "upscaler.";

/// A setting with different values in two recipes, each in the syntax of [`Recipe::set`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FieldChange {
    /// Dotted key of the setting, such as `light.ambient`.
    pub key: String,
    /// Value of the setting in the first recipe.
    pub before: String,
    /// Value of the setting in the second recipe.
    pub after: String,
}

impl FieldChange {
    /// Returns the change as text, such as “fill_rule: top-left → inclusive”.
    pub fn words(&self) -> String {
        format!("{}: {} → {}", self.key, self.before, self.after)
    }
}

/// Returns every key of a recipe with its value in the syntax of [`Recipe::set`], in the order of [`Recipe::keys`].
pub fn fields(recipe: &Recipe) -> Vec<(String, String)> {
    let mut fields = Vec::new();
    // Every value of a recipe is representable in JSON.
    collect(&serde_json::to_value(recipe).unwrap_or(Value::Null), "", &mut fields);
    fields
}

/// Collects the keys and values of a recipe serialised as JSON. Unlike [`Recipe::keys`], this does not determine the
/// valid values, so it is fast enough to run for every frame of the window.
fn collect(tree: &Value, prefix: &str, fields: &mut Vec<(String, String)>) {
    let Value::Object(inner) = tree else {
        fields.push((prefix.to_owned(), text(tree)));
        return;
    };
    for (name, value) in inner {
        let key = if prefix.is_empty() { name.clone() } else { format!("{prefix}.{name}") };
        collect(value, &key, fields);
    }
}

/// Returns the settings that differ between two recipes, in the order of [`Recipe::keys`].
pub fn changes(before: &Recipe, after: &Recipe) -> Vec<FieldChange> {
    let pairs = fields(before).into_iter().zip(fields(after));
    pairs
        .filter(|((_, before), (_, after))| before != after)
        .map(|((key, before), (_, after))| FieldChange { key, before, after })
        .collect()
}

/// Returns the `key=value` assignments that turn the default recipe into `recipe` with [`Recipe::set_all`]; empty for
/// the default one.
pub fn assignments(recipe: &Recipe) -> Vec<String> {
    let changed = changes(&Recipe::default(), recipe);
    // Changing the upscaling method resets the other upscaler settings, so all upscaler settings are included.
    let other_upscaler = changed.iter().any(|change| change.key.starts_with(UPSCALER_KEYS));
    let belongs =
        |key: &str| changed.iter().any(|change| change.key == key) || other_upscaler && key.starts_with(UPSCALER_KEYS);
    let reported = fields(recipe).into_iter().filter(|(key, _)| belongs(key));
    reported.map(|(key, value)| format!("{key}={value}")).collect()
}

/// Returns the valid values of the setting `key`: the words in its description `values` that `recipe` accepts. Returns
/// no words if the setting accepts any number.
pub fn choices(recipe: &Recipe, values: &str, key: &str) -> Vec<String> {
    let is_taken = |word: &&str| {
        let mut changed = *recipe;
        changed.set(&format!("{key}={word}")).is_ok()
    };
    // Words of a numeric description (“number, 0…1”) are not accepted values.
    values.split([',', ' ']).filter(|word| !word.is_empty()).filter(is_taken).map(str::to_owned).collect()
}

fn text(value: &Value) -> String {
    match value {
        Value::String(word) => word.clone(),
        Value::Number(number) if !number.is_u64() => {
            // Settings are f32: converting back from f64 gives the shortest decimal that identifies the f32.
            number.as_f64().map_or_else(|| number.to_string(), |number| (number as f32).to_string())
        }
        Value::Array(items) => items.iter().map(text).collect::<Vec<_>>().join(","),
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::upscale::Upscaling;

    /// Asserts that applying a recipe's assignments to the default recipe restores it.
    fn comes_back(recipe: &Recipe) {
        let reported = assignments(recipe);
        let mut again = Recipe::default();
        assert_eq!(again.set_all(&reported), Ok(()), "{reported:?}");
        assert_eq!(again, *recipe, "{reported:?}");
    }

    #[test]
    fn every_choice_of_every_key_is_restored_from_its_assignments() {
        let default = Recipe::default();
        let mut tried = 0;
        for (key, values) in Recipe::keys() {
            for choice in choices(&default, &values, &key) {
                let mut recipe = default;
                recipe.set(&format!("{key}={choice}")).unwrap();
                comes_back(&recipe);
                tried += 1;
            }
        }
        assert!(tried > 60, "{tried}");
        for upscaler in Upscaling::every() {
            comes_back(&Recipe { upscaler, ..default });
        }
    }

    #[test]
    fn fields_are_the_keys_of_a_recipe_in_their_order() {
        let keys: Vec<_> = Recipe::keys().into_iter().map(|(key, _)| key).collect();
        let reported: Vec<_> = fields(&Recipe::default()).into_iter().map(|(key, _)| key).collect();
        assert_eq!(reported, keys);
    }

    #[test]
    fn numbers_are_restored_bit_for_bit() {
        let mut recipe = Recipe::default();
        let texts = ["light.direction=0.1,-0.7,1e-7", "light.ambient=0.33333334", "antialias.seed=4294967295"];
        recipe.set_all(&texts).unwrap();
        recipe.set("post.mask=1,2,3,4,5,6,7,8,0.1").unwrap();
        comes_back(&recipe);
        assert!(fields(&recipe).contains(&("light.ambient".to_owned(), "0.33333334".to_owned())));
    }

    #[test]
    fn only_settings_that_differ_are_listed() {
        let before = Recipe::default();
        assert!(changes(&before, &before).is_empty() && assignments(&before).is_empty());
        let mut after = before;
        after.set_all(&["fill_rule=inclusive", "wireframe=true"]).unwrap();
        let words: Vec<_> = changes(&before, &after).iter().map(FieldChange::words).collect();
        assert_eq!(words, ["fill_rule: top-left → inclusive", "wireframe: false → true"]);
        let back: Vec<_> = changes(&after, &before).iter().map(FieldChange::words).collect();
        assert_eq!(back, ["fill_rule: inclusive → top-left", "wireframe: true → false"]);
    }
}
