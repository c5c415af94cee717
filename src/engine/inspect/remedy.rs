//! Remedies: changes of one setting or of the camera that repair a pixel.

use serde::Serialize;

use crate::chain::Recipe;
use crate::pipeline::settings::{Arithmetic, BlendingOrder, Culling, DepthFormat, FillRule, Rasterizer};
use crate::scene::Camera;

/// Change of one setting or of the camera that repairs a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(into = "RemedyRecord")]
pub enum Remedy {
    /// Stores reversed depths as floats, which separates close surfaces.
    ReversedDepth,
    /// Draws front-facing and back-facing triangles.
    NoCulling,
    /// Moves the near plane to this distance from the eye, in world units.
    NearPlane(f32),
    /// Moves the far plane to this distance from the eye, in world units.
    FarPlane(f32),
    /// Replaces a rasterizer that has deliberate faults.
    CorrectRasterizer,
    /// Decides coverage in fixed point, which is exact after snapping.
    FixedPoint,
    /// Assigns every shared edge to exactly one triangle.
    TopLeftRule,
    /// Blends fragments from far to near.
    ExactBlending,
}

/// A remedy in JSON.
#[derive(Serialize)]
struct RemedyRecord {
    label: String,
    change: String,
    effect: &'static str,
}

impl From<Remedy> for RemedyRecord {
    fn from(remedy: Remedy) -> Self {
        Self { label: remedy.label(), change: remedy.change(), effect: remedy.effect() }
    }
}

impl Remedy {
    /// Returns the change as an instruction, for buttons.
    pub fn label(self) -> String {
        match self {
            Self::ReversedDepth => "Use reversed f32 depth".to_owned(),
            Self::NoCulling => "Turn culling off".to_owned(),
            Self::NearPlane(distance) => format!("Move the near plane to {distance}"),
            Self::FarPlane(distance) => format!("Move the far plane to {distance}"),
            Self::CorrectRasterizer => "Use the bounding box rasterizer".to_owned(),
            Self::FixedPoint => "Use fixed-point arithmetic".to_owned(),
            Self::TopLeftRule => "Use the top-left fill rule".to_owned(),
            Self::ExactBlending => "Blend in exact order".to_owned(),
        }
    }

    /// Returns the changed setting as `key=value`, or the changed field of the camera.
    pub fn change(self) -> String {
        match self {
            Self::ReversedDepth => "depth_format=reversed-f32".to_owned(),
            Self::NoCulling => "culling=none".to_owned(),
            Self::NearPlane(distance) => format!("near of the camera: {distance}"),
            Self::FarPlane(distance) => format!("far of the camera: {distance}"),
            Self::CorrectRasterizer => "rasterizer=bounding-box".to_owned(),
            Self::FixedPoint => "arithmetic=fixed".to_owned(),
            Self::TopLeftRule => "fill_rule=top-left".to_owned(),
            Self::ExactBlending => "blending.order=exact".to_owned(),
        }
    }

    /// Describes the effect at the pixel, in one sentence without a full stop.
    pub fn effect(self) -> &'static str {
        match self {
            Self::ReversedDepth => "The depths of the surfaces here then differ by more than rounding",
            Self::NoCulling => "The culled triangle is then visible here",
            Self::NearPlane(_) => "The triangle in front of the near plane is then visible here",
            Self::FarPlane(_) => "The triangle beyond the far plane is then visible here",
            Self::CorrectRasterizer | Self::FixedPoint | Self::TopLeftRule => {
                "The shared edge is then drawn exactly once here"
            }
            Self::ExactBlending => "The fragments here are then blended from far to near",
        }
    }

    /// Applies the change to the settings or to the camera.
    pub fn apply(self, recipe: &mut Recipe, camera: &mut Camera) {
        let settings = &mut recipe.pipeline;
        match self {
            Self::ReversedDepth => settings.depth_format = DepthFormat::ReversedF32,
            Self::NoCulling => settings.culling = Culling::None,
            Self::NearPlane(distance) => camera.near = distance,
            Self::FarPlane(distance) => camera.far = distance,
            Self::CorrectRasterizer => settings.rasterizer = Rasterizer::BoundingBox,
            Self::FixedPoint => settings.arithmetic = Arithmetic::Fixed,
            Self::TopLeftRule => settings.fill_rule = FillRule::TopLeft,
            Self::ExactBlending => settings.blending.order = BlendingOrder::Exact,
        }
    }
}
