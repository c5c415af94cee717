//! Remedies: changes of one setting or of the camera after which a pixel shows what its verdict says is missing.
//!
//! A remedy is offered only if it helps: the frame is drawn again with the change, and the pixel is explained again.

use std::sync::Arc;

use serde::Serialize;

use super::history::Cause;
use super::pixel::PixelReport;
use super::verdict::{is_blended_wrongly, is_depth_contested};
use super::{Survey, explain};
use crate::chain::{Frame, Recipe, Renderer};
use crate::pipeline::depth::DepthComparison;
use crate::pipeline::settings::{Arithmetic, BlendingOrder, Culling, DepthFormat, FillRule, Rasterizer};
use crate::scene::{Camera, Scene};

/// Factors by which a clip plane is moved, the smallest first. The first one that helps is offered.
const PLANE_FACTORS: [f32; 3] = [10.0, 100.0, 1000.0];

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

    /// Whether the remedy has its effect: `before` and `after` explain the same pixel without and with it. `recipe`
    /// contains the remedy.
    fn helps(self, before: &PixelReport, after: &PixelReport, recipe: &Recipe) -> bool {
        let shows = |cause| {
            let visible = after.visible().map(|fragment| fragment.triangle);
            visible.is_some_and(|id| before.absent.iter().any(|absent| absent.cause == cause && absent.triangle == id))
        };
        match self {
            Self::ReversedDepth => {
                let comparison = DepthComparison::of(&recipe.pipeline);
                after.visible().is_some() && !is_depth_contested(&after.fragments, comparison)
            }
            Self::NoCulling => shows(Cause::BackFacing) || shows(Cause::FrontFacing),
            Self::NearPlane(_) => shows(Cause::NearPlane),
            Self::FarPlane(_) => shows(Cause::FarPlane),
            Self::CorrectRasterizer | Self::FixedPoint | Self::TopLeftRule => after.fault.is_none(),
            Self::ExactBlending => !is_blended_wrongly(after, &recipe.pipeline),
        }
    }
}

/// Returns the remedies that the report suggests, in groups. At most one remedy of a group is offered: the first that
/// helps.
fn candidates(report: &PixelReport, recipe: &Recipe, camera: &Camera) -> Vec<Vec<Remedy>> {
    let settings = &recipe.pipeline;
    let mut groups = Vec::new();
    if !settings.reversed() && is_depth_contested(&report.fragments, DepthComparison::of(settings)) {
        groups.push(vec![Remedy::ReversedDepth]);
    }
    let is_absent = |cause| report.absent.iter().any(|absent| absent.cause == cause);
    let is_background = report.visible().is_none();
    // Elsewhere, a culled triangle is usually the back of what is visible.
    if is_background && (is_absent(Cause::BackFacing) || is_absent(Cause::FrontFacing)) {
        groups.push(vec![Remedy::NoCulling]);
    }
    if is_absent(Cause::NearPlane) {
        groups.push(PLANE_FACTORS.map(|factor| Remedy::NearPlane(camera.near / factor)).to_vec());
    }
    if is_absent(Cause::FarPlane) {
        groups.push(PLANE_FACTORS.map(|factor| Remedy::FarPlane(camera.far * factor)).to_vec());
    }
    if report.fault.is_some() {
        groups.push(if settings.rasterizer.is_published() {
            vec![Remedy::CorrectRasterizer]
        } else if settings.fill_rule.draws_shared_edges_once() {
            vec![Remedy::FixedPoint]
        } else {
            vec![Remedy::TopLeftRule]
        });
    }
    if is_blended_wrongly(report, settings) {
        groups.push(vec![Remedy::ExactBlending]);
    }
    groups
}

/// Whether the report suggests remedies that [`remedies`] would have to try.
pub fn are_conceivable(report: &PixelReport, recipe: &Recipe, camera: &Camera) -> bool {
    !candidates(report, recipe, camera).is_empty()
}

/// Returns the remedies that help at the reported pixel of a completely drawn frame. Draws one frame for each remedy
/// that the report suggests.
pub fn remedies(scene: &Arc<Scene>, recipe: &Recipe, frame: &Frame, report: &PixelReport) -> Vec<Remedy> {
    let helps = |remedy: &Remedy| {
        let (mut changed, mut camera) = (*recipe, frame.camera);
        remedy.apply(&mut changed, &mut camera);
        let again = Renderer::default().render_converged(scene, &camera, &changed, frame.viewport);
        let survey = Survey::of(scene, &changed, &again);
        let after = explain(scene, &changed, &again, &survey, (report.x, report.y));
        after.is_some_and(|after| remedy.helps(report, &after, &changed))
    };
    candidates(report, recipe, &frame.camera).into_iter().filter_map(|group| group.into_iter().find(helps)).collect()
}

#[cfg(test)]
mod tests;
