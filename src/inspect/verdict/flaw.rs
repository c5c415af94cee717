//! What was wrong with the scene as it was given, and shows at a pixel: the loader made it drawable, the cause remains.

use glam::Vec3;

use super::instance_of;
use crate::chain::{Frame, Recipe};
use crate::inspect::pixel::PixelReport;
use crate::pipeline::plan::Part;
use crate::scene::Scene;

/// What was repaired or left out of the surface that the pixel shows, if anything was and the shading would have read it.
pub(super) fn told(report: &PixelReport, scene: &Scene, recipe: &Recipe, frame: &Frame) -> Option<String> {
    let is_flawless = scene.library.meshes().iter().all(|mesh| mesh.lost_normals() == 0)
        && scene.library.materials().iter().all(|material| material.missing_texture.is_none());
    let visible = report.visible().filter(|_| !is_flawless)?;
    let (index, instance) = instance_of(scene, visible.triangle)?;
    let mut told = Vec::new();
    let material = scene.library.material(instance.material);
    if let Some(file) = material.missing_texture.as_ref().filter(|_| recipe.pipeline.shading.reads_material()) {
        told.push(format!(
            "The texture “{file}” of its material “{}” could not be read: the plain colour stands in for it.",
            material.name
        ));
    }
    let mesh = scene.library.mesh(instance.mesh);
    if mesh.lost_normals() > 0 && frame.plans.get(index).is_some_and(|plan| plan.runs(Part::Normals)) {
        let first = scene.first_triangles().get(index).map_or(0, |first| first.0);
        let corners = mesh.triangles.get((visible.triangle.0 - first) as usize)?;
        let lost: Vec<_> =
            (0..3).filter(|i| mesh.normals[corners[*i] as usize] == Vec3::ZERO).map(|i| format!("v{i}")).collect();
        if !lost.is_empty() {
            told.push(format!(
                "The normal at {} was not a finite number (NaN) as it was given, one of {} in this mesh: it counts as none, and no \
                 direct light falls on it.",
                lost.join(", "),
                mesh.lost_normals()
            ));
        }
    }
    (!told.is_empty()).then(|| told.join(" "))
}
