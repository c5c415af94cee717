//! Rigs: trees of nodes whose transforms depend on the time.

use glam::{DMat4, DQuat, DVec3};

use super::sampler::Sampler;

/// Transform from the space of a node to that of its parent.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Local {
    /// Affine matrix, which no channel changes.
    Matrix(DMat4),
    /// Translation after rotation after scale, each of which a channel may replace.
    Parts(Parts),
}

/// Parts of the transform of a node.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Parts {
    pub(crate) translation: DVec3,
    /// Unit quaternion.
    pub(crate) rotation: DQuat,
    pub(crate) scale: DVec3,
}

impl Default for Parts {
    fn default() -> Self {
        Self { translation: DVec3::ZERO, rotation: DQuat::IDENTITY, scale: DVec3::ONE }
    }
}

impl Local {
    /// Returns the matrix from the space of the node to that of its parent.
    pub(crate) fn matrix(&self) -> DMat4 {
        match self {
            Self::Matrix(matrix) => *matrix,
            Self::Parts(Parts { translation, rotation, scale }) => {
                DMat4::from_scale_rotation_translation(*scale, *rotation, *translation)
            }
        }
    }

    fn mirrored_z(&self) -> Self {
        match *self {
            Self::Matrix(matrix) => Self::Matrix(mirrored_matrix(matrix)),
            Self::Parts(Parts { translation, rotation, scale }) => Self::Parts(Parts {
                translation: mirrored_vector(translation),
                rotation: mirrored_rotation(rotation),
                scale,
            }),
        }
    }
}

/// Returns a vector with z negated.
pub(super) fn mirrored_vector(vector: DVec3) -> DVec3 {
    DVec3 { z: -vector.z, ..vector }
}

/// Returns the rotation that a scene mirrored in z has instead of this one.
fn mirrored_rotation(rotation: DQuat) -> DQuat {
    DQuat::from_xyzw(-rotation.x, -rotation.y, rotation.z, rotation.w)
}

/// Returns the affine transform that a scene mirrored in z has instead of this one.
pub(super) fn mirrored_matrix(matrix: DMat4) -> DMat4 {
    let mirror = DMat4::from_scale(mirrored_vector(DVec3::ONE));
    mirror * matrix * mirror
}

/// Node of a rig.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    /// Index of the parent, less than that of the node; `None` if the parent is the world.
    pub(crate) parent: Option<usize>,
    /// Transform where no channel changes it.
    pub(crate) local: Local,
    /// Weights of the morph targets of the node's mesh where no channel changes them.
    pub(crate) weights: Vec<f64>,
}

/// Change of one property of a node over time.
#[derive(Clone, Debug)]
pub(crate) struct Channel {
    /// Index of the node.
    pub(crate) node: usize,
    pub(crate) track: Track,
}

/// Property of a node over time.
#[derive(Clone, Debug)]
pub(crate) enum Track {
    Translation(Sampler<DVec3>),
    Rotation(Sampler<DQuat>),
    Scale(Sampler<DVec3>),
    /// Weight of each morph target.
    Weights(Vec<Sampler<f64>>),
}

impl Track {
    /// Returns the time of the last key frame, in seconds.
    fn end_s(&self) -> f64 {
        match self {
            Self::Translation(sampler) | Self::Scale(sampler) => sampler.end_s(),
            Self::Rotation(sampler) => sampler.end_s(),
            Self::Weights(samplers) => samplers.iter().map(Sampler::end_s).fold(0.0, f64::max),
        }
    }

    fn mirrored_z(&self) -> Self {
        match self {
            Self::Translation(sampler) => Self::Translation(sampler.map(mirrored_vector)),
            Self::Rotation(sampler) => Self::Rotation(sampler.map(mirrored_rotation)),
            Self::Scale(_) | Self::Weights(_) => self.clone(),
        }
    }

    fn bytes(&self) -> usize {
        match self {
            Self::Translation(sampler) | Self::Scale(sampler) => sampler.bytes(),
            Self::Rotation(sampler) => sampler.bytes(),
            Self::Weights(samplers) => samplers.iter().map(Sampler::bytes).sum(),
        }
    }
}

/// Tree of nodes with their motion.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rig {
    nodes: Vec<Node>,
    channels: Vec<Channel>,
}

/// Transforms and weights of all nodes of a rig at one time.
#[derive(Clone, Debug)]
pub(crate) struct RigPose {
    /// Affine transform from the space of each node to world space.
    pub(super) world_from_node: Vec<DMat4>,
    /// Weights of the morph targets of each node's mesh.
    pub(super) weights: Vec<Vec<f64>>,
}

impl Rig {
    /// Adds a node, whose parent must have been added before, and returns its index.
    pub(crate) fn add_node(&mut self, node: Node) -> usize {
        assert!(node.parent.is_none_or(|parent| parent < self.nodes.len()));
        self.nodes.push(node);
        self.nodes.len() - 1
    }

    /// Adds a channel of a node that has been added. A later channel of the same property replaces an earlier one.
    pub(crate) fn add_channel(&mut self, channel: Channel) {
        assert!(channel.node < self.nodes.len());
        self.channels.push(channel);
    }

    /// Returns the time of the last key frame, in seconds; 0 without channels.
    pub(super) fn end_s(&self) -> f64 {
        self.channels.iter().map(|channel| channel.track.end_s()).fold(0.0, f64::max)
    }

    /// Returns the transform of a node where no channel changes it.
    pub(crate) fn local(&self, node: usize) -> &Local {
        &self.nodes[node].local
    }

    /// Returns, for each node, whether the morph targets of its mesh have a weight that is not zero, or that a channel
    /// changes.
    pub(crate) fn weighted(&self) -> Vec<bool> {
        let is_weighted = |node: &Node| node.weights.iter().any(|weight| *weight != 0.0);
        let mut weighted: Vec<bool> = self.nodes.iter().map(is_weighted).collect();
        for channel in self.channels.iter().filter(|channel| matches!(channel.track, Track::Weights(_))) {
            weighted[channel.node] = true;
        }
        weighted
    }

    /// Returns, for each node, whether a channel changes its transform or that of one of its ancestors.
    pub(crate) fn moving(&self) -> Vec<bool> {
        let mut moving = vec![false; self.nodes.len()];
        for channel in &self.channels {
            moving[channel.node] |= !matches!(channel.track, Track::Weights(_));
        }
        for (index, node) in self.nodes.iter().enumerate() {
            moving[index] |= node.parent.is_some_and(|parent| moving[parent]);
        }
        moving
    }

    /// Returns the transforms and weights at a time.
    pub(super) fn pose(&self, time_s: f64) -> RigPose {
        let mut locals: Vec<Local> = self.nodes.iter().map(|node| node.local).collect();
        let mut weights: Vec<Vec<f64>> = self.nodes.iter().map(|node| node.weights.clone()).collect();
        for Channel { node, track } in &self.channels {
            match (&mut locals[*node], track) {
                (_, Track::Weights(samplers)) => {
                    weights[*node] = samplers.iter().map(|sampler| sampler.at(time_s)).collect();
                }
                (Local::Matrix(_), _) => {}
                (Local::Parts(parts), Track::Translation(sampler)) => parts.translation = sampler.at(time_s),
                (Local::Parts(parts), Track::Rotation(sampler)) => parts.rotation = sampler.at(time_s),
                (Local::Parts(parts), Track::Scale(sampler)) => parts.scale = sampler.at(time_s),
            }
        }
        let mut world_from_node: Vec<DMat4> = Vec::with_capacity(locals.len());
        for (node, local) in self.nodes.iter().zip(&locals) {
            let world_from_parent = node.parent.map_or(DMat4::IDENTITY, |parent| world_from_node[parent]);
            world_from_node.push(world_from_parent * local.matrix());
        }
        RigPose { world_from_node, weights }
    }

    /// Returns the rig of the scene mirrored in z.
    pub(super) fn mirrored_z(&self) -> Self {
        let node = |node: &Node| Node { local: node.local.mirrored_z(), ..node.clone() };
        let channel = |channel: &Channel| Channel { track: channel.track.mirrored_z(), ..channel.clone() };
        Self { nodes: self.nodes.iter().map(node).collect(), channels: self.channels.iter().map(channel).collect() }
    }

    /// Returns the memory used by nodes and key frames, in bytes.
    pub(super) fn bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<Node>()
            + self.channels.iter().map(|channel| size_of::<Channel>() + channel.track.bytes()).sum::<usize>()
    }
}
