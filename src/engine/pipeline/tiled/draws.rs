//! Draws of a frame: one per instance that may be visible, with its plan and its shader.

use super::clusters::{ClusterCulling, VisibleClusters};
use super::geometry::InstanceDraw;
use super::shader::DrawShader;
use crate::math::lanes::Lanes;
use crate::pipeline::DrawnView;
use crate::pipeline::plan::{DrawPlan, PipelinePart};
use crate::pipeline::settings::Settings;
use crate::pipeline::shade::Shader;
use crate::pipeline::vertex::{DrawMatrices, containment};
use crate::scene::Scene;

/// Creates the draw plan of every instance of a scene. Returns the draws of the instances that may be visible, and all
/// plans.
pub(super) fn plan<'a>(view: &DrawnView<'a>, lanes: Lanes) -> (Vec<InstanceDraw<'a>>, Vec<DrawPlan>) {
    let DrawnView { scene, camera, settings, viewport } = *view;
    let count = scene.instances.len();
    let (mut draws, mut plans) = (Vec::with_capacity(count), Vec::with_capacity(count));
    let mut first_vertex = 0;
    let clip_from_world = view.clip_from_world();
    for ((index, instance), first) in scene.instances.iter().enumerate().zip(scene.first_triangles()) {
        let mesh = scene.library.mesh(instance.mesh);
        let matrices = DrawMatrices::new(instance, clip_from_world);
        let inside = containment(mesh.visible_bounds(), matrices.clip_from_model);
        let mut plan = DrawPlan::new(&scene.library, instance, camera, settings, inside).starting_at(first);
        let mut kept = VisibleClusters::all(mesh);
        if !mesh.clusters().is_empty() && plan.may_cull_clusters(settings, inside) {
            let unseen;
            (kept, unseen) = VisibleClusters::cull_clusters(
                mesh,
                &ClusterCulling::new(matrices.clip_from_model, inside, plan.culling(), viewport),
                lanes,
            );
            plan = plan.with_cull_stats(unseen);
        }
        plans.push(plan);
        if plan.runs(PipelinePart::Vertices) && !mesh.triangles.is_empty() {
            draws.push(InstanceDraw { instance: index as u32, mesh, plan, matrices, first, first_vertex, kept });
            first_vertex += mesh.positions.len();
        }
    }
    (draws, plans)
}

/// Prepares the shaders of draws.
pub(super) fn shaders<'a>(scene: &'a Scene, settings: &'a Settings, draws: &[InstanceDraw<'_>]) -> Vec<DrawShader<'a>> {
    let shader = |draw: &InstanceDraw<'_>| {
        let instance = &scene.instances[draw.instance as usize];
        let shader = Shader::new(settings, &scene.library, instance, &draw.plan);
        let texture = scene.library.material(instance.material).texture.map(|id| scene.library.texture(id));
        DrawShader::new(shader, texture, draw.plan.runs(PipelinePart::PerspectiveDivision))
    };
    draws.iter().map(shader).collect()
}
