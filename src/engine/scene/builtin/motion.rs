//! Key frames of built-in scenes. Every motion begins again seamlessly after its last key frame.

use std::f64::consts::TAU;

use glam::{DQuat, DVec3};

use crate::scene::animation::{
    Animation, Channel, Interpolation, KeyTimes, KeyValue, Local, Node, Parts, Sampler, Track,
};

/// Returns linearly interpolated key frames at the ends of `intervals` equal intervals. `value` gets the fraction of the
/// duration, from 0 to 1.
pub(super) fn sampled<T: KeyValue>(duration_s: f64, intervals: u32, value: impl Fn(f64) -> T) -> Sampler<T> {
    let shares = || (0..=intervals).map(|key| f64::from(key) / f64::from(intervals));
    let times = KeyTimes::new(shares().map(|share| share * duration_s).collect()).expect("times ascend");
    Sampler::new(times, shares().map(value).collect(), Interpolation::Linear).expect("there is a value for each time")
}

/// Returns the key frames of one turn about an axis at constant speed, counter-clockwise as seen against the unit
/// vector `axis`.
pub(super) fn turn(duration_s: f64, axis: DVec3) -> Sampler<DQuat> {
    sampled(duration_s, 4, |share| DQuat::from_axis_angle(axis, share * TAU))
}

/// Adds a node at a translation, and returns its index.
pub(super) fn add_node(animation: &mut Animation, parent: Option<usize>, translation: DVec3) -> usize {
    let local = Local::Parts(Parts { translation, ..Parts::default() });
    animation.rig.add_node(Node { parent, local, weights: Vec::new() })
}

/// Lets a property of a node follow key frames.
pub(super) fn move_node(animation: &mut Animation, node: usize, track: Track) {
    animation.rig.add_channel(Channel { node, track });
}
