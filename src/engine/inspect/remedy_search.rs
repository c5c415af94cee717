//! Search for the remedies of a pixel: changes after which it shows what its verdict says is missing.
//!
//! A remedy is offered only if it helps: the frame is drawn again with the change, and the pixel is explained again.

use std::sync::Arc;

use super::pixel::{Cause, PixelReport};
use super::remedy::Remedy;
use super::verdict::{is_blended_wrongly, is_depth_contested};
use super::{Survey, explain};
use crate::chain::{Frame, Recipe, RenderInputs, Renderer};
use crate::pipeline::depth::DepthComparison;
use crate::scene::{Camera, Scene};

/// Factors by which a clip plane is moved, the smallest first. The first one that helps is offered.
const PLANE_FACTORS: [f32; 3] = [10.0, 100.0, 1000.0];

/// Whether a remedy has its effect: `before` and `after` explain the same pixel without and with it. `recipe`
/// contains the remedy.
fn helps(remedy: Remedy, before: &PixelReport, after: &PixelReport, recipe: &Recipe) -> bool {
    let shows = |cause| {
        let visible = after.visible().map(|fragment| fragment.triangle);
        visible.is_some_and(|id| before.absent.iter().any(|absent| absent.cause == cause && absent.triangle == id))
    };
    match remedy {
        Remedy::ReversedDepth => {
            let comparison = DepthComparison::of(&recipe.pipeline);
            after.visible().is_some() && !is_depth_contested(&after.fragments, comparison)
        }
        Remedy::NoCulling => shows(Cause::BackFacing) || shows(Cause::FrontFacing),
        Remedy::NearPlane(_) => shows(Cause::NearPlane),
        Remedy::FarPlane(_) => shows(Cause::FarPlane),
        Remedy::CorrectRasterizer | Remedy::FixedPoint | Remedy::TopLeftRule => after.fault.is_none(),
        Remedy::ExactBlending => !is_blended_wrongly(after, &recipe.pipeline),
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
        let again = Renderer::default().render_converged(RenderInputs {
            scene,
            camera: &camera,
            recipe: &changed,
            viewport: frame.viewport,
        });
        let survey = Survey::of(scene, &changed, &again);
        let after = explain(scene, &changed, &again, &survey, (report.x, report.y));
        after.is_some_and(|after| self::helps(*remedy, report, &after, &changed))
    };
    candidates(report, recipe, &frame.camera).into_iter().filter_map(|group| group.into_iter().find(helps)).collect()
}

#[cfg(test)]
mod tests;
