//! Recipe: all settings that determine how a scene is drawn, accessible by name.

use serde::{Deserialize, Serialize};
use serde_json::Value;
use thiserror::Error;

use crate::antialias::settings::{Antialiasing, PostFilter, PostFilterKind, centred_in_5x5};
use crate::pipeline::settings::{Choice, Execution, Light, MIP_BIAS, Settings};
use crate::scene::Scene;
use crate::upscale::{self, HistoryFilter, Offers, Rectification, Sampling, Scale, Upscaler, Upscaling};

/// All settings that determine how a scene is drawn, as plain data. Panels edit them, the command line parses them, and
/// reports vary them. Equal recipes and equal scenes give bit-identical frames.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Recipe {
    /// Execution mode of the pipeline, classic or tiled. Both give the same picture.
    pub execution: Execution,
    /// Settings of the pipeline stages, from transform to shading.
    #[serde(flatten)]
    pub pipeline: Settings,
    /// Anti-aliasing of the drawn pixels.
    pub antialias: Antialiasing,
    /// Upscaler: selects the pixels to draw, and fills in the others.
    pub upscaler: Upscaling,
    /// Filter applied to the finished picture.
    pub post: PostFilter,
    /// Whether the edges of all drawn triangles are drawn over the picture.
    pub wireframe: bool,
}

impl Default for Recipe {
    fn default() -> Self {
        Self {
            execution: Execution::Tiled,
            pipeline: Settings::default(),
            antialias: Antialiasing::default(),
            upscaler: Upscaling::NATIVE,
            post: PostFilter::default(),
            wireframe: false,
        }
    }
}

/// Prefix of the upscaler's setting keys.
const UPSCALER_KEYS: &str = "upscaler.";

/// Key of the upscaler's method, which determines the valid values of the other upscaler keys.
const METHOD_KEY: &str = "upscaler.method";

/// Key of the post filter's kind, which determines the range of its strength.
const FILTER_KEY: &str = "post.filter";

/// Key of the strength of the post filter.
const STRENGTH_KEY: &str = "post.strength";

/// Error returned if an assignment `key=value` cannot be applied to a recipe.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum SetError {
    /// The assignment has no `=`.
    #[error("`{0}` is not of the form key=value")]
    NotAPair(String),
    /// No setting has this key.
    #[error("`{key}` is not a setting; the settings are {known}")]
    UnknownKey {
        /// Key in the assignment.
        key: String,
        /// All existing keys, separated by commas.
        known: String,
    },
    /// The setting does not accept this value.
    #[error("{key}: {reason}")]
    BadValue {
        /// Key of the setting that rejected the value.
        key: String,
        /// Reason why the value is rejected, with the accepted values.
        reason: String,
    },
}

impl Recipe {
    /// Takes the light of `scene`, which replaces that of `before` if a scene was shown before. Without a light of its
    /// own, `scene` keeps the light of the recipe, unless that is the light of `before`.
    pub fn take_light(&mut self, scene: &Scene, before: Option<&Scene>) {
        let direction = &mut self.pipeline.light.direction;
        match (scene.light, before.and_then(|before| before.light)) {
            (Some(own), _) => *direction = own,
            (None, Some(old)) if old == *direction => *direction = Light::default().direction,
            (None, _) => {}
        }
    }

    /// Changes one setting by its dotted key, as in `light.direction=0.4,0.7,0.6`. Keys and values may be written with
    /// `-` or `_`. On error nothing changes.
    ///
    /// # Examples
    /// ```
    /// use rasterscope_engine::chain::Recipe;
    /// use rasterscope_engine::pipeline::settings::Shading;
    ///
    /// let mut recipe = Recipe::default();
    /// recipe.set("shading=gouraud")?;
    /// assert_eq!(recipe.pipeline.shading, Shading::Gouraud);
    ///
    /// // The error lists the accepted values, and the recipe is unchanged.
    /// let error = recipe.set("shading=phong").unwrap_err();
    /// assert!(error.to_string().contains("lambert"));
    /// assert_eq!(recipe.pipeline.shading, Shading::Gouraud);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn set(&mut self, assignment: &str) -> Result<(), SetError> {
        let (_, value) = assignment.split_once('=').ok_or_else(|| SetError::NotAPair(assignment.to_owned()))?;
        let key = key_of(assignment);
        let mut tree = json(self);
        let pointer = format!("/{}", key.replace('.', "/"));
        let leaf = tree.pointer_mut(&pointer).filter(|leaf| !leaf.is_object()).ok_or_else(|| {
            let known: Vec<_> = Self::keys().into_iter().map(|(key, _)| key).collect();
            SetError::UnknownKey { key: key.clone(), known: known.join(", ") }
        })?;
        let bad = |reason: String| SetError::BadValue { key: key.clone(), reason };
        let wanted = parse_like(leaf, value.trim()).map_err(bad)?;
        *leaf = wanted.clone();
        let mut changed: Self = serde_json::from_value(tree).map_err(|e| bad(e.to_string()))?;
        if key == FILTER_KEY {
            changed.post = self.post.with_filter(changed.post.filter);
        }
        if key == METHOD_KEY {
            let chosen = self.upscaler.with_method(changed.upscaler.method());
            changed.upscaler = chosen.unwrap_or(changed.upscaler);
        }
        changed.check().map_err(bad)?;
        if key.starts_with(UPSCALER_KEYS) && !json(&changed).pointer(&pointer).is_some_and(|set| is_equal(set, &wanted))
        {
            let method = changed.upscaler.method();
            return Err(bad(format!("`{method}` offers {}", offered(&key, &[changed.upscaler.upscaler()]))));
        }
        *self = changed;
        Ok(())
    }

    /// Changes several settings. The assignments may be in any order: upscaling method and post filter are set before
    /// the settings that depend on them. On error nothing changes.
    ///
    /// # Examples
    /// ```
    /// use rasterscope_engine::chain::Recipe;
    /// use rasterscope_engine::upscale::Scale;
    ///
    /// let mut recipe = Recipe::default();
    /// recipe.set_all(&["upscaler.scale=4", "upscaler.method=bicubic"])?;
    /// assert_eq!(recipe.upscaler.method(), "bicubic");
    /// assert_eq!(recipe.upscaler.scale(), Scale::FOUR);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn set_all(&mut self, assignments: &[impl AsRef<str>]) -> Result<(), SetError> {
        let mut changed = *self;
        let depends = |assignment: &&str| {
            let key = key_of(assignment);
            key == STRENGTH_KEY || key.starts_with(UPSCALER_KEYS) && key != METHOD_KEY
        };
        let all = || assignments.iter().map(AsRef::as_ref);
        for assignment in all().filter(|a| !depends(a)).chain(all().filter(depends)) {
            changed.set(assignment)?;
        }
        *self = changed;
        Ok(())
    }

    /// Returns all dotted keys, each with a description of the values that it accepts.
    ///
    /// # Examples
    /// ```
    /// use rasterscope_engine::chain::Recipe;
    ///
    /// let keys = Recipe::keys();
    /// let (_, values) = keys.iter().find(|(key, _)| key == "light.ambient").unwrap();
    /// assert_eq!(values, "number, 0…1");
    /// ```
    pub fn keys() -> Vec<(String, String)> {
        let mut keys = Vec::new();
        collect_keys(&json(&Self::default()), "", &mut keys);
        keys
    }

    /// Returns other words, in lower case, for a setting or for one of its values; `assignment` is `key=value`.
    pub fn synonyms(assignment: &str) -> Vec<&'static str> {
        let matching = SYNONYMS.iter().filter(|(start, _)| assignment.starts_with(start));
        matching.flat_map(|(_, words)| words.iter().copied()).collect()
    }

    /// Returns the mip bias that suits the upscaler, in levels to two decimals. For temporal upscalers that draw a
    /// lower-resolution image, this is log₂(drawn width / full width) − 1 (AMD, FidelityFX Super Resolution 2
    /// documentation, "Mipmap biasing"). For all others, it is 0.
    pub fn recommended_mip_bias(&self) -> f32 {
        let draws_less =
            matches!(self.upscaler.sampling(), Sampling::Lattice(_)) && self.upscaler.scale() != Scale::ONE;
        if !draws_less || !self.upscaler.upscaler().reads().history {
            return 0.0;
        }
        let levels = -self.upscaler.scale().value().log2() - 1.0;
        ((levels * 100.0).round() / 100.0) as f32
    }

    /// Checks the numeric ranges that the types of the settings do not enforce. Returns an error message if a number is
    /// out of range.
    pub fn check(&self) -> Result<(), String> {
        let light = &self.pipeline.light;
        if !light.direction.is_finite() || light.direction == glam::Vec3::ZERO {
            return Err("the direction of the light must be finite and not zero".to_owned());
        }
        if !(0.0..=1.0).contains(&light.ambient) {
            return Err(format!("the ambient share of the light must lie in 0…1, not {}", light.ambient));
        }
        let bias = &self.pipeline.depth_bias;
        if !bias.constant.is_finite() || !bias.slope.is_finite() {
            return Err("the depth bias must be finite".to_owned());
        }
        let mip_bias = self.pipeline.mip_bias;
        if !MIP_BIAS.contains(&mip_bias) {
            let (least, most) = MIP_BIAS.into_inner();
            return Err(format!("the mip bias must lie in {least}…{most}, not {mip_bias}"));
        }
        let checker = &self.pipeline.checker;
        if !checker.squares.is_finite() || !checker.even.is_finite() || !checker.odd.is_finite() {
            return Err("numbers must be finite".to_owned());
        }
        self.post.check()
    }
}

/// Other words for the settings whose assignment `key=value` starts with the first string.
const SYNONYMS: &[(&str, &[&str])] = &[
    ("address=", &["wrap", "texture wrap", "tiling"]),
    ("antialias.method=", &["aa", "antialiasing", "supersampling", "ssaa"]),
    ("antialias.method=multisample", &["msaa"]),
    ("alpha=", &["premultiplied alpha"]),
    ("background", &["clear color", "sky"]),
    ("culling=", &["backface", "back face"]),
    ("depth_bias", &["polygon offset"]),
    ("depth_test=", &["depth compare", "zfunc"]),
    ("filter=", &["mipmap", "mip", "sampler"]),
    ("fill_rule=", &["top left rule"]),
    ("light.ambient", &["brightness"]),
    ("light.direction", &["sun"]),
    ("max_anisotropy=", &["anisotropic filtering"]),
    ("mip_bias=", &["lod bias", "texture sharpness"]),
    ("rasterizer=", &["scanline"]),
    ("wireframe=true", &["wireframe", "wire", "lines"]),
];

/// Returns the dotted key of an assignment `key=value`, with each `-` replaced by `_`.
fn key_of(assignment: &str) -> String {
    assignment.split('=').next().unwrap_or_default().trim().replace('-', "_")
}

fn json(recipe: &Recipe) -> Value {
    // Serialization cannot fail: all keys are strings, and a non-finite number becomes null.
    serde_json::to_value(recipe).unwrap_or(Value::Null)
}

/// Parses `text` as a JSON value of the same type as `like`, such as a number or a list of numbers.
fn parse_like(like: &Value, text: &str) -> Result<Value, String> {
    let number = |t: &str| {
        t.trim().parse::<f32>().ok().filter(|n| n.is_finite()).ok_or_else(|| format!("`{t}` is not a number"))
    };
    match like {
        Value::Bool(_) => match text {
            "true" | "on" | "yes" => Ok(true.into()),
            "false" | "off" | "no" => Ok(false.into()),
            _ => Err(format!("`{text}` is neither true nor false")),
        },
        Value::Number(n) if n.is_u64() => {
            text.parse::<u32>().map(Value::from).map_err(|_| format!("`{text}` is not a whole number"))
        }
        Value::Number(_) => number(text).map(Value::from),
        Value::Array(items) => {
            let numbers = text.split(',').map(number).collect::<Result<Vec<_>, _>>()?;
            let inner: Result<[f32; 9], _> = numbers.as_slice().try_into();
            match inner {
                _ if numbers.len() == items.len() => Ok(numbers.into()),
                Ok(inner) if items.len() == centred_in_5x5(inner).len() => Ok(centred_in_5x5(inner).to_vec().into()),
                _ => Err(format!("expected {} comma-separated numbers, not `{text}`", items.len())),
            }
        }
        _ => Ok(text.replace('_', "-").into()),
    }
}

/// Whether a setting has the value that was wanted. Numbers are compared as `f32`, as [`parse_like`] reads them.
fn is_equal(set: &Value, wanted: &Value) -> bool {
    match (set.as_f64(), wanted.as_f64()) {
        (Some(set), Some(wanted)) => set as f32 == wanted as f32,
        _ => set == wanted,
    }
}

fn collect_keys(tree: &Value, prefix: &str, keys: &mut Vec<(String, String)>) {
    let Value::Object(fields) = tree else {
        keys.push((prefix.to_owned(), describe_values(prefix, tree)));
        return;
    };
    for (name, value) in fields {
        let key = if prefix.is_empty() { name.clone() } else { format!("{prefix}.{name}") };
        collect_keys(value, &key, keys);
    }
}

/// Returns a description of the values that a key accepts. Numeric ranges equal those that [`Recipe::check`] enforces.
/// The words of a choice are taken from the parser's error message for an invalid value.
fn describe_values(key: &str, value: &Value) -> String {
    match value {
        _ if key.starts_with(UPSCALER_KEYS) && key != METHOD_KEY => {
            format!("{}, where the method offers a choice", offered(key, &upscale::all()))
        }
        Value::Bool(_) => "true, false".to_owned(),
        Value::Number(_) if key == "light.ambient" => "number, 0…1".to_owned(),
        Value::Number(_) if key == "mip_bias" => {
            let (least, most) = MIP_BIAS.into_inner();
            format!("number, {least}…{most}")
        }
        Value::Number(_) if key == STRENGTH_KEY => {
            let ranges =
                PostFilterKind::ALL.iter().filter_map(|f| Some(format!(", 0…{} for {}", f.max_strength()?, f.id())));
            format!("number{}", ranges.collect::<String>())
        }
        Value::Number(number) if number.is_u64() => "whole number".to_owned(),
        Value::Number(_) => "number".to_owned(),
        Value::Array(_) if key == "post.mask" => "9 or 25 comma-separated numbers, row by row".to_owned(),
        Value::Array(_) if key == "light.direction" => "3 comma-separated numbers, not all of them 0".to_owned(),
        Value::Array(items) => format!("{} comma-separated numbers", items.len()),
        _ => {
            let complaint = Recipe::default().set(&format!("{key}=?")).err().map(|e| e.to_string()).unwrap_or_default();
            let words: Vec<_> = complaint.split('`').skip(1).step_by(2).filter(|w| *w != "?").collect();
            words.join(", ")
        }
    }
}

fn ids<T: Choice>() -> Vec<String> {
    T::ALL.iter().map(|choice| choice.id().to_owned()).collect()
}

/// Returns the values that upscaling methods offer for a setting, separated by commas. If there are several methods,
/// those that offer only a single value are ignored.
fn offered(key: &str, methods: &[&dyn Upscaler]) -> String {
    let words = |offers: Offers| -> Vec<String> {
        match key.trim_start_matches(UPSCALER_KEYS) {
            "scale" => offers.scales.iter().map(Scale::to_string).collect(),
            "anchor" => offers.anchors.iter().map(|anchor| anchor.id().to_owned()).collect(),
            "light" => offers.lights.iter().map(|light| light.id().to_owned()).collect(),
            "deringing" if offers.deringing => vec!["false".to_owned(), "true".to_owned()],
            "sharpening" if offers.sharpening => vec!["0…100 %".to_owned()],
            "sharpening" => vec!["0".to_owned()],
            "history.rectification" if offers.history => ids::<Rectification>(),
            "history.rectification" => vec![Rectification::Variance.id().to_owned()],
            "history.filter" if offers.history => ids::<HistoryFilter>(),
            "history.filter" => vec![HistoryFilter::CatmullRom.id().to_owned()],
            "history.luminance_weighting" if offers.history => vec!["false".to_owned(), "true".to_owned()],
            _ => vec!["false".to_owned()],
        }
    };
    let all: Vec<_> = methods.iter().map(|method| words(method.offers())).collect();
    // A range is a single word, but counts as a choice.
    let is_choice = |words: &[String]| words.len() > 1 || words.iter().any(|word| word.contains('…'));
    let choices = all.iter().filter(|words| is_choice(words) || methods.len() == 1);
    let mut known: Vec<String> = Vec::new();
    for word in choices.flatten() {
        if !known.contains(word) {
            known.push(word.clone());
        }
    }
    known.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::settings::{Culling, Shading};

    #[test]
    fn settings_are_reached_by_dotted_keys_in_either_case() {
        let mut recipe = Recipe::default();
        for assignment in [
            "shading=gouraud",
            "culling=none",
            "color-space=bytes",
            "light.direction=1,2,3",
            "light.ambient=0.5",
            "fill_rule=top_left",
        ] {
            recipe.set(assignment).unwrap();
        }
        assert_eq!(recipe.pipeline.shading, Shading::Gouraud);
        assert_eq!(recipe.pipeline.culling, Culling::None);
        assert_eq!(recipe.pipeline.light.direction, glam::Vec3::new(1.0, 2.0, 3.0));
        assert_eq!(recipe.pipeline.light.ambient, 0.5);
    }

    #[test]
    fn wrong_settings_are_named_and_change_nothing() {
        let mut recipe = Recipe::default();
        for (assignment, word) in [
            ("shading", "key=value"),
            ("shadign=gouraud", "fill_rule"),
            ("shading=phong", "lambert"),
            ("light=1", "light.direction"),
            ("light.direction=1,2", "3 comma-separated numbers"),
            ("light.direction=0,0,0", "zero"),
            ("light.ambient=2", "0…1"),
            ("wireframe=maybe", "true"),
            ("mip_bias=-4.5", "-4…4"),
            ("upscaler.method=dlss", "native"),
            ("upscaler.scale=3", "offers"),
        ] {
            let message = recipe.set(assignment).unwrap_err().to_string();
            assert!(message.contains(word), "{assignment}: {message}");
        }
        assert_eq!(recipe, Recipe::default());
    }

    #[test]
    fn the_scale_may_precede_its_method() {
        let mut recipe = Recipe::default();
        recipe.set_all(&["upscaler.scale=4", "upscaler.method=bicubic"]).unwrap();
        assert_eq!((recipe.upscaler.method(), recipe.upscaler.scale()), ("bicubic", Scale::FOUR));
        let before = recipe;
        assert!(recipe.set_all(&["wireframe=true", "Upscaler.scale=2"]).is_err(), "keys are in lower case");
        assert!(recipe.set_all(&["wireframe=true", "upscaler.scale=5"]).is_err());
        assert_eq!(recipe, before);
    }

    #[test]
    fn a_method_chosen_by_name_has_the_configuration_that_the_registry_gives_it() {
        for upscaler in Upscaling::every() {
            let mut recipe = Recipe::default();
            let scale = format!("upscaler.scale={}", upscaler.scale());
            let method = format!("upscaler.method={}", upscaler.method());
            recipe.set_all(&[&scale, &method]).unwrap();
            assert_eq!(recipe.upscaler, upscaler, "from native");
            let mut after_another = Recipe::default();
            let other = if upscaler.method() == "bicubic" { "bilinear" } else { "bicubic" };
            let other = format!("upscaler.method={other}");
            after_another.set_all(&[other.as_str(), "upscaler.anchor=centre", "upscaler.light=linear"]).unwrap();
            after_another.set_all(&[&scale, &method]).unwrap();
            assert_eq!(after_another.upscaler, upscaler, "after another method with its own options");
            let short = format!("{{\"method\":\"{}\",\"scale\":{}}}", upscaler.method(), upscaler.scale());
            let parsed = serde_json::from_str::<Upscaling>(&short).unwrap();
            assert_eq!(parsed, upscaler, "from a file without anchor and light");
        }
    }

    #[test]
    fn temporal_upscalers_of_fewer_samples_want_a_negative_mip_bias() {
        for (method, scale, expected) in
            [("fsr2", 2.0, -2.0), ("fsr2", 1.5, -1.58), ("taa", 1.0, 0.0), ("bicubic", 2.0, 0.0), ("native", 1.0, 0.0)]
        {
            let upscaler = Upscaling::new(method, scale).unwrap();
            assert_eq!(Recipe { upscaler, ..Recipe::default() }.recommended_mip_bias(), expected, "{method} {scale}");
        }
    }

    #[test]
    fn filter_strengths_are_limited_by_the_largest_mask() {
        for (filter, most, beyond) in [("blur", 15.0, "16"), ("gaussian", 5.0, "5.5"), ("motion", 30.0, "31")] {
            let mut recipe = Recipe::default();
            let set = [format!("post.strength={most}"), format!("post.filter={filter}")];
            recipe.set_all(&set).unwrap();
            let message = recipe.set(&format!("post.strength={beyond}")).unwrap_err().to_string();
            assert_eq!(
                message,
                format!("post.strength: the strength of the filter `{filter}` must lie in 0…{most}, not {beyond}")
            );
            recipe.set("post.filter=gaussian").unwrap();
            assert_eq!(recipe.post.strength, 5.0, "the strength is clamped to the range of the new filter");
        }
    }

    #[test]
    fn every_key_describes_its_values_and_recipes_survive_json() {
        for (key, values) in Recipe::keys() {
            assert!(values.starts_with(char::is_alphanumeric), "{key}: {values}");
        }
        let text = serde_json::to_string(&Recipe::default()).unwrap();
        assert_eq!(serde_json::from_str::<Recipe>(&text).unwrap(), Recipe::default());
    }
}
