//! Recipes as text: every setting with its value in the syntax of `--set`, and the differences between two recipes.
//!
//! The keys are those of [`SettingKey::ALL`], so new settings of a recipe are included automatically.

use crate::chain::{Recipe, SettingKey};
use crate::pipeline::settings::Choice;

/// A setting with different values in two recipes, each in the syntax of [`Recipe::set`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FieldChange {
    /// Setting.
    pub key: SettingKey,
    /// Value of the setting in the first recipe.
    pub before: String,
    /// Value of the setting in the second recipe.
    pub after: String,
}

impl FieldChange {
    /// Returns the change as text, such as “fill_rule: top-left → inclusive”.
    pub fn words(&self) -> String {
        format!("{}: {} → {}", self.key.id(), self.before, self.after)
    }
}

/// Returns the settings that differ between two recipes, in the order of [`SettingKey::ALL`].
pub fn changes(before: &Recipe, after: &Recipe) -> Vec<FieldChange> {
    let change = |key: &SettingKey| {
        let (before, after) = (key.read(before), key.read(after));
        (before != after).then_some(FieldChange { key: *key, before, after })
    };
    SettingKey::ALL.iter().filter_map(change).collect()
}

/// Returns the `key=value` assignments that turn the default recipe into `recipe` with [`Recipe::set_all`]; empty for
/// the default one.
pub fn assignments(recipe: &Recipe) -> Vec<String> {
    let changed: Vec<_> = changes(&Recipe::default(), recipe).into_iter().map(|change| change.key).collect();
    // Changing the upscaling method resets the other upscaler settings, so all upscaler settings are included.
    let other_upscaler = changed.iter().any(|key| key.is_of_upscaler());
    let belongs = |key: &&SettingKey| changed.contains(key) || other_upscaler && key.is_of_upscaler();
    SettingKey::ALL.iter().filter(belongs).map(|key| format!("{}={}", key.id(), key.read(recipe))).collect()
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
        for key in SettingKey::ALL {
            for choice in key.choices(&default) {
                let mut recipe = default;
                recipe.set(&format!("{}={}", key.id(), choice.id)).unwrap();
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
    fn numbers_are_restored_bit_for_bit() {
        let mut recipe = Recipe::default();
        let texts = ["light.direction=0.1,-0.7,1e-7", "light.ambient=0.33333334", "antialias.seed=4294967295"];
        recipe.set_all(&texts).unwrap();
        recipe.set("post.mask=1,2,3,4,5,6,7,8,0.1").unwrap();
        comes_back(&recipe);
        assert_eq!(SettingKey::LightAmbient.read(&recipe), "0.33333334");
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
