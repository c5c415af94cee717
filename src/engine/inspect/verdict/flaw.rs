//! Defects of the scene file that affect a pixel. The loader worked around them, but the file still contains them.

use glam::Vec3;

use super::instance_of;
use crate::chain::{Frame, Recipe};
use crate::inspect::pixel::{FragmentRecord, PixelReport};
use crate::pipeline::plan::PipelinePart;
use crate::scene::Scene;

/// Predicate of a sentence about a normal that the loader discarded because it was not finite.
pub(super) const LOST_NORMALS: &str = "is not finite (NaN) in the model";

/// Returns the names of the corners of the fragment's triangle whose normals were not finite in the model.
pub(super) fn lost_normals(visible: &FragmentRecord, scene: &Scene) -> Vec<&'static str> {
    const CORNERS: [&str; 3] = ["v0", "v1", "v2"];
    let lost = || {
        let (index, instance) = instance_of(scene, visible.triangle)?;
        let mesh = scene.library.mesh(instance.mesh);
        let first = scene.first_triangles().get(index)?.0;
        let corners = mesh.triangles.get((visible.triangle.0 - first) as usize).filter(|_| mesh.lost_normals() > 0)?;
        let at = corners.iter().zip(CORNERS).filter(|(corner, _)| mesh.normals[**corner as usize] == Vec3::ZERO);
        Some(at.map(|(_, name)| name).collect())
    };
    lost().unwrap_or_default()
}

/// Describes defects of the scene file that affect the shading of the visible surface. Returns `None` if there are
/// none, or if the text `said` already mentions them.
pub(super) fn describe_flaws(
    report: &PixelReport,
    scene: &Scene,
    recipe: &Recipe,
    frame: &Frame,
    said: &str,
) -> Option<String> {
    let visible = report.visible()?;
    let (index, instance) = instance_of(scene, visible.triangle)?;
    let mut sentences = Vec::new();
    let material = scene.library.material(instance.material);
    let reads_material = recipe.pipeline.shading.reads_material();
    if let Some(file) = material.missing_texture.as_ref().filter(|file| reads_material && !said.contains(file.as_str()))
    {
        sentences.push(format!(
            "The texture “{file}” of its material “{}” could not be read; the plain material colour is used. Put the \
             file where the model expects it.",
            material.name
        ));
    }
    let reads_normals = frame.plans.get(index).is_some_and(|plan| plan.runs(PipelinePart::Normals));
    let lost = lost_normals(visible, scene);
    if reads_normals && !lost.is_empty() && !said.contains(LOST_NORMALS) {
        sentences.push(format!(
            "The normal at {} {LOST_NORMALS}, one of {} in this mesh: it is treated as missing, and the surface \
             receives no direct light. Export the normals again.",
            lost.join(", "),
            scene.library.mesh(instance.mesh).lost_normals()
        ));
    }
    (!sentences.is_empty()).then(|| sentences.join(" "))
}
