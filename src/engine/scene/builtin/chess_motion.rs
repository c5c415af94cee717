//! The chess scene in motion: the knot turns about a vertical axis, and the sphere rolls to and fro without slipping.
//!
//! The floor is still, so its texture shows what moving objects uncover.

use std::f64::consts::TAU;

use glam::{DMat4, DQuat, DVec3};

use super::draft::SceneDraft;
use super::motion::{add_node, move_node, sampled, turn};
use super::{Builtin, chess};
use crate::scene::animation::Track;

pub(super) const CHESS_MOTION: Builtin = Builtin {
    id: "chess-motion",
    title: "Chess floor in motion",
    summary: "The chess scene with a knot that turns and a sphere that rolls without slipping: shows motion that a \
              static camera sees against a detailed floor.",
    draft,
};

/// Length of the loop, in seconds: one turn of the knot, and one roll of the sphere to and fro.
const DURATION_S: f64 = 4.0;

/// Horizontal path of the sphere from its place in the chess scene to the turning point, in world units.
const ROLL: DVec3 = DVec3::new(2.3, 0.0, -0.7);

/// Radius of the sphere, in world units.
const RADIUS: f64 = 0.95;

/// Number of key frames of the rolling sphere, between which its speed is constant.
const ROLL_KEYS: u32 = 120;

fn draft() -> SceneDraft {
    let mut draft = chess::draft();
    let (knot, _) = add_carrier(&mut draft, "knot");
    move_node(&mut draft.animation, knot, Track::Rotation(turn(DURATION_S, DVec3::Y)));
    let (sphere, start) = add_carrier(&mut draft, "sphere");
    let axis = DVec3::Y.cross(ROLL).normalize();
    let angle = ROLL.length() / RADIUS;
    let places = sampled(DURATION_S, ROLL_KEYS, |share| start + ROLL * rolled(share));
    let turns = sampled(DURATION_S, ROLL_KEYS, |share| DQuat::from_axis_angle(axis, angle * rolled(share)));
    move_node(&mut draft.animation, sphere, Track::Translation(places));
    move_node(&mut draft.animation, sphere, Track::Rotation(turns));
    draft
}

/// Returns the fraction of its path that the sphere has rolled at a fraction of the loop.
fn rolled(share: f64) -> f64 {
    0.5 - 0.5 * (TAU * share).cos()
}

/// Adds a node at the origin of an object's model space, and attaches the object to it. Returns the index of the node
/// and its world position.
fn add_carrier(draft: &mut SceneDraft, name: &str) -> (usize, DVec3) {
    let object = draft.object(name);
    let world_from_model = draft.transform(object);
    let center = world_from_model.w_axis.truncate();
    let node = add_node(&mut draft.animation, None, center);
    draft.attach(object, node, DMat4::from_translation(-center) * world_from_model);
    (node, center)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::Vec3;

    use super::*;

    #[test]
    fn the_sphere_rolls_without_slipping() {
        let scene = Arc::new(CHESS_MOTION.build());
        let sphere = scene.instances.iter().position(|instance| instance.name == "sphere").unwrap();
        let transform = |time_s: f64| scene.at(time_s).instances[sphere].world_from_model;
        const STEP_S: f64 = 0.02;
        for time_s in [0.31, 1.0, 1.77, 2.6, 3.3] {
            let [before, now, after] = [-STEP_S, 0.0, STEP_S].map(|offset| transform(time_s + offset));
            let touching = now.inverse().transform_point3(now.w_axis.truncate() - Vec3::Y * RADIUS as f32);
            let moved = |point: Vec3| after.transform_point3(point) - before.transform_point3(point);
            let (of_center, of_contact) = (moved(Vec3::ZERO).length(), moved(touching).length());
            assert!(of_center > 0.02 && of_contact < 0.01 * of_center, "{time_s}: {of_center} {of_contact}");
        }
    }

    #[test]
    fn the_loop_begins_with_the_chess_scene() {
        let (still, moving) = (chess::CHESS.build(), CHESS_MOTION.build());
        for (still, moving) in still.instances.iter().zip(&moving.instances) {
            assert!(still.world_from_model.abs_diff_eq(moving.world_from_model, 1e-6), "{}", still.name);
        }
    }
}
