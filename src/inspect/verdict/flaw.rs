//! What was wrong with the scene as it was given, and shows at a pixel: the loader made it drawable, the cause remains.

use glam::Vec3;

use super::instance_of;
use crate::chain::{Frame, Recipe};
use crate::inspect::pixel::{FragmentRecord, PixelReport};
use crate::pipeline::plan::Part;
use crate::scene::Scene;

/// What is said of a normal that the loader put aside.
pub(super) const LOST_NORMALS: &str = "was not a finite number (NaN) as it was given";

/// The corners of the fragment's triangle whose normals were no finite numbers as they were given.
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

/// What was repaired or left out of the surface that the pixel shows, if anything was, the shading would have read it, and
/// `said` does not tell it already.
pub(super) fn told(report: &PixelReport, scene: &Scene, recipe: &Recipe, frame: &Frame, said: &str) -> Option<String> {
    let visible = report.visible()?;
    let (index, instance) = instance_of(scene, visible.triangle)?;
    let mut told = Vec::new();
    let material = scene.library.material(instance.material);
    let reads_material = recipe.pipeline.shading.reads_material();
    if let Some(file) = material.missing_texture.as_ref().filter(|file| reads_material && !said.contains(file.as_str()))
    {
        told.push(format!(
            "The texture “{file}” of its material “{}” could not be read: the plain colour stands in for it.",
            material.name
        ));
    }
    let reads_normals = frame.plans.get(index).is_some_and(|plan| plan.runs(Part::Normals));
    let lost = lost_normals(visible, scene);
    if reads_normals && !lost.is_empty() && !said.contains(LOST_NORMALS) {
        told.push(format!(
            "The normal at {} {LOST_NORMALS}, one of {} in this mesh: it counts as none, and no direct light falls on it.",
            lost.join(", "),
            scene.library.mesh(instance.mesh).lost_normals()
        ));
    }
    (!told.is_empty()).then(|| told.join(" "))
}
