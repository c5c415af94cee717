//! Animations: the channels of the first animation of the file, as channels of the rig.

use glam::{DQuat, DVec3, DVec4};
use gltf_json::Root;
use gltf_json::accessor::Type;
use gltf_json::animation::{self, Animation, Property};

use super::accessors::{Accessors, Elements};
use super::nodes::Placed;
use super::{Failure, Remarks, name_or, valid};
use crate::scene::animation::{Channel, Interpolation, KeyTimes, KeyValue, Local, Sampler, Track, unit};
use crate::scene::load::{Load, bytes_of};
use crate::text;

/// Maximum number of animations that a note names.
const MAX_NAMED: usize = 8;

/// Reads the first animation of the file into the rig.
///
/// # Errors
/// Returns an error that names the channel or sampler if its key frames are malformed.
pub(super) fn read(
    root: &Root,
    accessors: &mut Accessors<'_>,
    placed: &mut Placed,
    load: &mut Load<'_>,
    remarks: &mut Remarks<'_>,
) -> Result<(), Failure> {
    let Some(first) = root.animations.first() else { return Ok(()) };
    remark_others(root, remarks);
    for (number, channel) in first.channels.iter().enumerate() {
        load.advance(1.0)?;
        let target = channel.target.node.value();
        let Some(sampler) = first.samplers.get(channel.sampler.value()) else { continue };
        let Some(node) = placed.rig_nodes.get(target).copied().flatten() else { continue };
        let Some(property) = valid(channel.target.path) else { continue };
        if property != Property::MorphTargetWeights && matches!(placed.rig.local(node), Local::Matrix(_)) {
            return Err(
                format!("animations[0].channels[{number}]: it changes nodes[{target}], which has a matrix").into()
            );
        }
        let targets = targets(root, target);
        let track = Source { sampler, accessors, load }.track(property, targets);
        let track = track.map_err(|reason| format!("animations[0].samplers[{}]: {reason}", channel.sampler.value()))?;
        placed.rig.add_channel(Channel { node, track });
    }
    remark_fixed(root, placed, remarks);
    Ok(())
}

/// Notes which of several animations is shown.
fn remark_others(root: &Root, remarks: &mut Remarks<'_>) {
    let name =
        |(index, animation): (usize, &Animation)| text::message(&name_or(animation.name.as_ref(), "animation", index));
    let mut names = root.animations.iter().enumerate().map(name);
    let (Some(first), others) = (names.next(), names.by_ref().take(MAX_NAMED).collect::<Vec<_>>()) else { return };
    if !others.is_empty() {
        let more = if root.animations.len() > 1 + MAX_NAMED { " and more" } else { "" };
        remarks.note(format!("the animation {first} is shown; the file also has {}{more}", others.join(", ")));
    }
}

/// Notes that cameras and lights do not follow nodes in motion.
fn remark_fixed(root: &Root, placed: &Placed, remarks: &mut Remarks<'_>) {
    let moving = placed.rig.moving();
    let is_moving = |index: usize| placed.rig_nodes[index].is_some_and(|node| moving[node]);
    let has_light = |node: &gltf_json::Node| {
        node.extensions.as_ref().is_some_and(|extensions| extensions.khr_lights_punctual.is_some())
    };
    let is_fixed =
        |(index, node): (usize, &gltf_json::Node)| is_moving(index) && (node.camera.is_some() || has_light(node));
    if root.nodes.iter().enumerate().any(is_fixed) {
        remarks.note("cameras and lights keep the place that the file gives them: their motion is not rendered");
    }
}

/// Returns the number of morph targets of a node's mesh.
fn targets(root: &Root, node: usize) -> usize {
    let mesh = root.nodes.get(node).and_then(|node| node.mesh).and_then(|mesh| root.get(mesh));
    let first = mesh.and_then(|mesh| mesh.primitives.first());
    first.and_then(|primitive| primitive.targets.as_ref()).map_or(0, Vec::len)
}

/// Sampler of the file, with what reading it needs.
struct Source<'s, 'a, 'l> {
    sampler: &'s animation::Sampler,
    accessors: &'s mut Accessors<'a>,
    load: &'s mut Load<'l>,
}

impl Source<'_, '_, '_> {
    /// Reads the key frames of a property. `targets` is the number of morph targets.
    fn track(&mut self, property: Property, targets: usize) -> Result<Track, String> {
        Ok(match property {
            Property::Translation => Track::Translation(self.keys(&[Type::Vec3], vector)?),
            Property::Scale => Track::Scale(self.keys(&[Type::Vec3], vector)?),
            Property::Rotation => Track::Rotation(self.rotations()?),
            Property::MorphTargetWeights => Track::Weights(self.weights(targets)?),
        })
    }

    fn times(&mut self) -> Result<KeyTimes, String> {
        let elements = self.accessors.get(self.sampler.input, &[Type::Scalar])?;
        self.load.charge(bytes_of::<f64>(elements.count()))?;
        let time = |key: usize| f64::from(elements.vector::<1>(key)[0]);
        KeyTimes::new((0..elements.count()).map(time).collect())
    }

    fn interpolation(&self) -> Interpolation {
        match valid(self.sampler.interpolation) {
            Some(animation::Interpolation::Step) => Interpolation::Step,
            Some(animation::Interpolation::CubicSpline) => Interpolation::CubicSpline,
            Some(animation::Interpolation::Linear) | None => Interpolation::Linear,
        }
    }

    /// Reads the output accessor, whose elements must be of one of the types.
    fn output(&mut self, types: &[Type]) -> Result<Elements<'_>, String> {
        let elements = self.accessors.get(self.sampler.output, types)?;
        self.load.charge(bytes_of::<DVec4>(elements.count()))?;
        Ok(elements)
    }

    fn keys<T: KeyValue, const N: usize>(
        &mut self,
        types: &[Type],
        make: impl Fn([f32; N]) -> T,
    ) -> Result<Sampler<T>, String> {
        let (times, interpolation) = (self.times()?, self.interpolation());
        let output = self.output(types)?;
        let values = (0..output.count()).map(|index| make(output.vector(index))).collect();
        Sampler::new(times, values, interpolation)
    }

    /// Reads rotations, which are made unit quaternions. Tangents keep their length.
    fn rotations(&mut self) -> Result<Sampler<DQuat>, String> {
        let sampler =
            self.keys(&[Type::Vec4], |[x, y, z, w]: [f32; 4]| DQuat::from_array([x, y, z, w].map(f64::from)))?;
        Ok(sampler.map_keys(|rotation| unit(DVec4::from(rotation))))
    }

    /// Reads the weights of morph targets, which follow each other within a key frame.
    fn weights(&mut self, targets: usize) -> Result<Vec<Sampler<f64>>, String> {
        let (times, interpolation) = (self.times()?, self.interpolation());
        let output = self.output(&[Type::Scalar])?;
        let per_key = interpolation.values_per_key();
        let needed = times.count().saturating_mul(per_key).saturating_mul(targets);
        if output.count() != needed {
            let count = output.count();
            return Err(format!("it has {count} weights instead of {needed} for its key frames and {targets} targets"));
        }
        let of_target = |target: usize| {
            let values =
                (0..times.count() * per_key).map(|row| f64::from(output.vector::<1>(row * targets + target)[0]));
            Sampler::new(times.clone(), values.collect(), interpolation)
        };
        (0..targets).map(of_target).collect()
    }
}

fn vector(given: [f32; 3]) -> DVec3 {
    DVec3::from(given.map(f64::from))
}
