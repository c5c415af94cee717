//! Rows of settings, drawn from their declarations: the switches that need no code of their own.

use eframe::egui::{Label, RichText, Ui};

use crate::chain::{Recipe, SettingKey, SettingStage, ValueForm};
use crate::inspect::Stage;
use crate::pipeline::settings::Choice as _;
use crate::ui::theme::tokens;
use crate::ui::widgets::{choice, drag_by, integer_field, row, slider};

/// Change of a number without a range per dragged point.
const NUMBER_STEP: f64 = 0.05;

/// Number of decimals of a number within a range.
const DECIMALS: usize = 2;

/// Returns the stage whose switches include a setting; `None` if no stage has a switch for it.
pub(crate) fn owner(key: SettingKey) -> Option<Stage> {
    match key.stage() {
        SettingStage::Cull => Some(Stage::Cull),
        SettingStage::Rasterize => Some(Stage::Rasterize),
        SettingStage::Depth => Some(Stage::Depth),
        SettingStage::Interpolate => Some(Stage::Interpolate),
        SettingStage::Shade => Some(Stage::Shade),
        SettingStage::Upscale => Some(Stage::Upscale),
        SettingStage::Hidden => None,
    }
}

/// Draws the settings of a stage that have no place of their own.
pub(super) fn others(ui: &mut Ui, stage: Stage, recipe: &mut Recipe) {
    for key in SettingKey::ALL.iter().filter(|key| owner(**key) == Some(stage) && !key.is_placed()) {
        setting(ui, *key, recipe);
    }
}

/// Draws a setting with the control that suits its values.
pub(super) fn setting(ui: &mut Ui, key: SettingKey, recipe: &mut Recipe) {
    setting_row(ui, key, |ui| control(ui, key, recipe));
}

/// Draws a setting with its declared name and help text, and the controls added by `add_control`.
pub(super) fn setting_row<R>(ui: &mut Ui, key: SettingKey, add_control: impl FnOnce(&mut Ui) -> R) -> R {
    row(ui, key.name(), key.help(), add_control)
}

/// Draws an explanatory note below a setting.
pub(super) fn note(ui: &mut Ui, text: impl Into<String>) {
    ui.add(Label::new(RichText::new(text).small().color(tokens(ui).text_weak)).wrap());
}

fn control(ui: &mut Ui, key: SettingKey, recipe: &mut Recipe) {
    let present = key.read(recipe);
    let values = key.values();
    let chosen = match values.form {
        None if values.is_switch() => check_box(ui, &present),
        None => pick_word(ui, key, recipe, &present),
        Some(ValueForm::Number(range)) => edited::<f32>(&present, |number| match range {
            Some(range) => slider(ui, number, range, "", DECIMALS),
            None => drag_by(ui, number, NUMBER_STEP),
        }),
        Some(ValueForm::Whole) => edited::<u32>(&present, |number| ui.add(integer_field(number)).changed()),
        Some(ValueForm::Percent(most)) => edited::<f32>(&present, |percent| {
            let is_changed = slider(ui, percent, 0.0..=most as f32, " %", 0);
            *percent = percent.round();
            is_changed
        }),
        Some(ValueForm::Numbers(_)) => edit_list(ui, &present),
        Some(ValueForm::Color) => {
            ui.label(&present);
            None
        }
    };
    if let Some(value) = chosen {
        // Controls offer only values that the setting accepts.
        let _ = recipe.set(&format!("{}={value}", key.id()));
    }
}

fn check_box(ui: &mut Ui, present: &str) -> Option<String> {
    let mut is_on = present == "true";
    ui.checkbox(&mut is_on, "").changed().then(|| is_on.to_string())
}

fn pick_word(ui: &mut Ui, key: SettingKey, recipe: &Recipe, present: &str) -> Option<String> {
    let words = key.choices(recipe);
    let options: Vec<_> = words.iter().map(|word| (word.id.as_str(), word.name.as_str(), word.help)).collect();
    let mut word = present;
    choice(ui, &mut word, &options).then(|| word.to_owned())
}

/// Edits a number that is given as text. Returns its new text if `edit` returns that it changed.
fn edited<N: std::str::FromStr + ToString>(present: &str, edit: impl FnOnce(&mut N) -> bool) -> Option<String> {
    let mut number = present.parse().ok()?;
    edit(&mut number).then(|| number.to_string())
}

fn edit_list(ui: &mut Ui, present: &str) -> Option<String> {
    let mut numbers: Vec<f32> = present.split(',').filter_map(|number| number.parse().ok()).collect();
    let changed = numbers.iter_mut().map(|number| drag_by(ui, number, NUMBER_STEP)).fold(false, |any, now| any | now);
    changed.then(|| numbers.iter().map(f32::to_string).collect::<Vec<_>>().join(","))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ui::headless::Headless;
    use eframe::egui::{Theme, vec2};

    /// Sources that place rows of settings.
    const PLACING: [&str; 2] = [include_str!("switches.rs"), include_str!("smooth.rs")];

    /// Settings with several rows, or with a name that depends on other settings.
    const SPECIAL: [SettingKey; 3] = [SettingKey::LightDirection, SettingKey::PostMask, SettingKey::PostStrength];

    #[test]
    fn every_setting_with_a_place_of_its_own_is_drawn_there() {
        for key in SettingKey::ALL.iter().filter(|key| key.is_placed() && !SPECIAL.contains(key)) {
            let variant = format!("SettingKey::{key:?}");
            let is_named = |text: &str| text.split(|c: char| !(c.is_alphanumeric() || c == ':')).any(|w| w == variant);
            assert!(PLACING.iter().any(|text| is_named(text)), "{variant}");
        }
    }

    #[test]
    fn only_disabled_optimisations_have_no_switch() {
        let without: Vec<_> = SettingKey::ALL.iter().filter(|key| owner(**key).is_none()).collect();
        assert_eq!(without, [&SettingKey::Force]);
    }

    #[test]
    fn drawing_a_row_of_any_kind_changes_no_setting() {
        let mut recipe = Recipe::default();
        let mut headless = Headless::new(vec2(400.0, 2000.0), 1.0, Theme::Dark);
        headless.pass(Vec::new(), |ui| SettingKey::ALL.iter().for_each(|key| setting(ui, *key, &mut recipe)));
        assert_eq!(recipe, Recipe::default());
    }
}
