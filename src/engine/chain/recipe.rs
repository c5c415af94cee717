//! Recipe: all settings that determine how a scene is drawn, accessible by name.

mod keys;
#[cfg(test)]
mod tests;
mod values;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::antialias::settings::{Antialiasing, PostFilter};
use crate::pipeline::settings::{Choice, Execution, Light, Settings};
use crate::scene::Scene;
use crate::upscale::{Sampling, Scale, Upscaling};

pub use keys::SettingKey;
pub use keys::SettingStage;
pub use values::ValueForm;
pub use values::Values;
pub use values::Word;

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
        key: &'static str,
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
        let (id, value) = assignment.split_once('=').ok_or_else(|| SetError::NotAPair(assignment.to_owned()))?;
        let key = SettingKey::by_id(id).ok_or_else(|| SetError::UnknownKey {
            key: id.trim().to_owned(),
            known: SettingKey::ALL.iter().map(|key| key.id()).collect::<Vec<_>>().join(", "),
        })?;
        let mut changed = *self;
        let bad = |reason| SetError::BadValue { key: key.id(), reason };
        key.write(&mut changed, value.trim()).map_err(bad)?;
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
            let key = assignment.split('=').next().and_then(SettingKey::by_id);
            key.is_some_and(|key| key == SettingKey::PostStrength || key.is_upscaler_option())
        };
        let all = || assignments.iter().map(AsRef::as_ref);
        for assignment in all().filter(|a| !depends(a)).chain(all().filter(depends)) {
            changed.set(assignment)?;
        }
        *self = changed;
        Ok(())
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

    /// Checks the numeric ranges that the types of the settings do not enforce. Returns an error message with the key if a
    /// number is out of range.
    pub fn check(&self) -> Result<(), String> {
        SettingKey::ALL.iter().try_for_each(|key| key.check(self).map_err(|flaw| format!("{}: {flaw}", key.id())))
    }
}
