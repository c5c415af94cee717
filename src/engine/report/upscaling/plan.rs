//! Plan of an upscaling report: scenes, upscalers and parameters, and the progress through them.

use std::sync::Arc;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::chain::{Recipe, run_unobserved};
use crate::image::{Image, Rgba8, png_text};
use crate::measure::metric::Metric;
use crate::measure::motion::Turn;
use crate::measure::reference::Reference;
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, Scene};
use crate::upscale::Upscaling;

/// Scene to measure, with its name, camera and recipe.
#[derive(Clone, Debug)]
pub struct NamedView {
    /// Display name of the scene.
    pub name: String,
    /// Scene to draw.
    pub scene: Arc<Scene>,
    /// Camera of the view.
    pub camera: Camera,
    /// Recipe with which the scene is drawn. The report replaces its upscaler.
    pub recipe: Recipe,
}

/// Scenes, upscalers, image size and measurement parameters of a report.
#[derive(Clone, Debug)]
pub struct UpscalingPlan {
    /// Scenes to measure, each from one view.
    pub subjects: Vec<NamedView>,
    /// Upscalers to measure on every scene.
    pub upscalers: Vec<Upscaling>,
    /// Size of the full image, in pixels.
    pub viewport: Viewport,
    /// Number of measured rounds, at least 1.
    pub rounds: usize,
    /// Reference that errors are computed against.
    pub reference: Reference,
    /// Metric on the error axis, by which the methods are ranked.
    pub metric: Metric,
    /// Camera motion over the frames that are measured for error and time.
    pub turn: Turn,
}

/// Plan of a report without the scenes themselves: everything that merging needs, and by which plans are compared.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct PlanRecord {
    pub(super) scenes: Vec<SceneRecord>,
    pub(super) upscalers: Vec<Upscaling>,
    /// Width and height of the full image, in pixels.
    pub(super) size: [u32; 2],
    pub(super) rounds: usize,
    pub(super) reference: Reference,
    pub(super) metric: Metric,
    pub(super) turn: Turn,
}

/// Scene of a [`PlanRecord`].
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct SceneRecord {
    pub(super) name: String,
    pub(super) triangles: usize,
    camera: Value,
    pub(super) recipe: Recipe,
    /// Small native image. Scenes of one name that differ are told apart by it.
    #[serde(with = "png_text")]
    sample: Image<Rgba8>,
}

/// Size of the images by which scenes are told apart, in pixels.
const SAMPLE: Viewport = Viewport { width: 96, height: 54 };

impl UpscalingPlan {
    /// Returns the plan without the scenes themselves. Draws a small image of each scene.
    pub fn record(&self) -> PlanRecord {
        let scene = |NamedView { name, scene, camera, recipe }: &NamedView| SceneRecord {
            name: name.clone(),
            triangles: scene.triangle_count(),
            // Plain data can always be written.
            camera: serde_json::to_value(camera).unwrap_or_default(),
            recipe: *recipe,
            sample: run_unobserved(scene, camera, &with(recipe, Upscaling::NATIVE), SAMPLE).image().clone(),
        };
        PlanRecord {
            scenes: self.subjects.iter().map(scene).collect(),
            upscalers: self.upscalers.clone(),
            size: [self.viewport.width, self.viewport.height],
            rounds: self.rounds,
            reference: self.reference,
            metric: self.metric,
            turn: self.turn,
        }
    }
}

/// Returns the recipe with another upscaler.
pub(super) fn with(recipe: &Recipe, upscaler: Upscaling) -> Recipe {
    Recipe { upscaler, ..*recipe }
}

/// Progress of an upscaling report.
#[derive(Clone, Debug, PartialEq)]
pub struct UpscalingProgress {
    /// Name of the scene that is being measured.
    pub scene: String,
    /// Name of the current stage, such as "errors at rest".
    pub stage: &'static str,
    /// Number of completed steps in this stage.
    pub done: usize,
    /// Total number of steps in this stage.
    pub of: usize,
}
