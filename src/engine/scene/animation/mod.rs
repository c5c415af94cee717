//! Motion of scenes: objects that move rigidly, meshes that change their shape, and materials that are exchanged.
//!
//! An [`Animation`] is data: a [`Rig`] of nodes with key frames, and the parts of the scene that depend on it.
//! [`Scene::at`] poses a scene at a time. Poses are computed in f64 and rounded once to f32, so that a pose depends only
//! on the scene and the time.

mod deform;
mod rig;
mod sampler;

use std::sync::Arc;

use glam::{DMat4, Mat4};

use super::load::MAX_COORDINATE;
use super::{MaterialId, Scene};
use crate::math::Aabb;
pub(crate) use deform::{Deformation, Influence, Joint, MorphTarget, Skin};
pub(crate) use rig::{Channel, Local, Node, Parts, Rig, Track};
pub(crate) use sampler::{Interpolation, KeyTimes, KeyValue, Sampler, unit};

/// Object that a node of the rig carries.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Attachment {
    /// Index of the instance.
    pub(crate) instance: usize,
    /// Index of the node.
    pub(crate) node: usize,
    /// Affine transform from model space to the space of the node.
    pub(crate) node_from_model: DMat4,
    /// Transform of the instance at times at which the node's is not finite or too large.
    pub(crate) fallback: Mat4,
}

/// Exchange of the material of an object.
#[derive(Clone, Debug)]
pub(crate) struct MaterialTrack {
    /// Index of the instance.
    pub(crate) instance: usize,
    /// Times at which a material begins to be shown.
    pub(crate) times: KeyTimes,
    /// Material from each of the times on.
    pub(crate) materials: Vec<MaterialId>,
}

/// Motion of a scene, and the time of its pose.
#[derive(Clone, Debug)]
pub struct SceneMotion {
    pub(crate) animation: Arc<Animation>,
    time_s: f64,
}

impl SceneMotion {
    /// Returns the length of one loop, in seconds; greater than 0.
    pub fn duration_s(&self) -> f64 {
        self.animation.duration_s()
    }

    /// Returns the time of the pose, in seconds, as it was given to [`Scene::at`].
    pub fn time_s(&self) -> f64 {
        self.time_s
    }
}

/// Motion of a scene, which repeats endlessly.
#[derive(Clone, Debug, Default)]
pub(crate) struct Animation {
    pub(crate) rig: Rig,
    pub(crate) attachments: Vec<Attachment>,
    pub(crate) deformations: Vec<Deformation>,
    pub(crate) materials: Vec<MaterialTrack>,
    /// Minimum length of one loop, in seconds. The loop ends no earlier than the last key frame.
    pub(crate) least_duration_s: f64,
}

impl Animation {
    /// Returns the length of one loop, in seconds: the time of the last key frame.
    pub(crate) fn duration_s(&self) -> f64 {
        let exchanges = self.materials.iter().map(|track| track.times.end_s());
        exchanges.fold(self.rig.end_s().max(self.least_duration_s), f64::max)
    }

    /// Returns the time within the loop that corresponds to a time, in seconds. Times that are not finite correspond to
    /// the beginning.
    fn wrapped_s(&self, time_s: f64) -> f64 {
        let duration_s = self.duration_s();
        let wrapped_s = time_s.rem_euclid(duration_s);
        // The remainder of a tiny negative time is rounded to the divisor.
        if wrapped_s < duration_s { wrapped_s } else { 0.0 }
    }

    /// Returns the scene in the pose at a time.
    fn posed(&self, scene: &Scene, time_s: f64) -> Scene {
        let time_s = self.wrapped_s(time_s);
        let rig = self.rig.pose(time_s);
        let mut posed = scene.clone();
        for deformation in &self.deformations {
            posed.library.replace_mesh(deformation.mesh, deformation.deformed(&rig));
        }
        for attachment in &self.attachments {
            let Attachment { instance, node, node_from_model, fallback } = *attachment;
            let world_from_model = (rig.world_from_node[node] * node_from_model).as_mat4();
            let instance = &mut posed.instances[instance];
            let is_usable = is_usable(scene.library.mesh(instance.mesh).bounds(), world_from_model);
            instance.world_from_model = if is_usable { world_from_model } else { fallback };
        }
        for MaterialTrack { instance, times, materials } in &self.materials {
            posed.instances[*instance].material = materials[times.span(time_s).key];
        }
        posed
    }

    /// Returns the motion of the scene mirrored in z.
    fn mirrored_z(&self) -> Self {
        let attachment = |attachment: &Attachment| Attachment {
            node_from_model: rig::mirrored_matrix(attachment.node_from_model),
            fallback: rig::mirrored_matrix(attachment.fallback.as_dmat4()).as_mat4(),
            ..*attachment
        };
        Self {
            rig: self.rig.mirrored_z(),
            attachments: self.attachments.iter().map(attachment).collect(),
            deformations: self.deformations.iter().map(Deformation::mirrored_z).collect(),
            materials: self.materials.clone(),
            least_duration_s: self.least_duration_s,
        }
    }

    /// Returns the memory used by the motion, in bytes.
    fn bytes(&self) -> usize {
        self.rig.bytes() + self.deformations.iter().map(Deformation::bytes).sum::<usize>()
    }
}

impl Scene {
    /// Returns the scene with a motion, in the pose at time 0. A motion without a duration gives a still scene in this
    /// pose.
    pub(crate) fn animated(self, animation: Animation) -> Self {
        let posed = animation.posed(&self, 0.0);
        let moves = animation.duration_s() > 0.0;
        Self { animation: moves.then(|| SceneMotion { animation: Arc::new(animation), time_s: 0.0 }), ..posed }
    }

    /// Returns the scene in the pose at a time in seconds. The motion repeats endlessly, also before time 0.
    ///
    /// A still scene is returned itself. Otherwise, the result depends only on the scene and the time, and not on the
    /// pose of `self`. It has the same triangles in the same order as `self`, and shares the unmoved meshes and the
    /// textures.
    pub fn at(self: &Arc<Self>, time_s: f64) -> Arc<Self> {
        match &self.animation {
            Some(motion) => {
                let animation = Some(SceneMotion { time_s, ..motion.clone() });
                Arc::new(Self { animation, ..motion.animation.posed(self, time_s) })
            }
            None => Arc::clone(self),
        }
    }

    /// Whether both are poses of the same scene, so that equal [`TriangleId`](super::TriangleId)s mean the same
    /// triangle. A still scene is a pose of itself only. An edited scene is no pose of the original if the edit removes
    /// or replaces the motion, as every edit of the triangles must.
    pub fn is_pose_of(&self, other: &Self) -> bool {
        match (&self.animation, &other.animation) {
            (Some(own), Some(others)) => Arc::ptr_eq(&own.animation, &others.animation),
            _ => std::ptr::eq(self, other),
        }
    }

    /// Returns the motion of the scene mirrored in z.
    pub(super) fn mirrored_animation(&self) -> Option<SceneMotion> {
        let mirrored = |motion: &SceneMotion| SceneMotion {
            animation: Arc::new(motion.animation.mirrored_z()),
            time_s: motion.time_s,
        };
        self.animation.as_ref().map(mirrored)
    }

    /// Returns the memory used by the motion, in bytes.
    pub(super) fn animation_bytes(&self) -> usize {
        self.animation.as_ref().map_or(0, |motion| motion.animation.bytes())
    }
}

/// Whether a transform of a mesh with these bounds gives finite coordinates that are small enough to be drawn.
fn is_usable(bounds: Aabb, world_from_model: Mat4) -> bool {
    let bounds = bounds.transformed(world_from_model);
    let largest = bounds.min.abs().max(bounds.max.abs()).max_element();
    world_from_model.is_finite() && (bounds.is_empty() || largest <= MAX_COORDINATE)
}

#[cfg(test)]
mod tests;
