//! Four wheels that turn at different speeds, which shows temporal aliasing: at 30 frames per second, their spokes seem
//! to turn forwards, to double, to turn backwards and to stand still.
//!
//! The wall behind them shows what the spokes uncover.

use glam::{DMat4, DQuat, DVec3, Mat4, Quat, Vec2, Vec3};

use super::Builtin;
use super::draft::SceneDraft;
use super::motion::{add_node, move_node, sampled};
use super::shapes;
use super::textures::{self, srgb};
use super::wheels::{SPOKES, rim, spokes};
use crate::scene::Camera;
use crate::scene::animation::{Sampler, Track};

pub(super) const WHEELS_MOTION: Builtin = Builtin {
    id: "wheels-motion",
    title: "Turning wheels",
    summary: "Four wheels of twelve spokes turn by 3°, 15°, 27° and 30° per frame at 30 frames per second: their spokes \
              seem to turn forwards, double, turn backwards and stand still, their painted spokes do not.",
    draft,
};

/// Length of the loop in seconds: 120 frames at 30 frames per second.
const DURATION_S: f64 = 4.0;

/// Clockwise turns of each wheel per loop, row by row. One turn is 3° per frame at 30 frames per second.
const TURNS: [u32; 4] = [1, 5, 9, 10];

/// Distance between the centres of neighbouring wheels, in world units. A wheel has radius 1.
const SPACING: f32 = 2.2;

fn draft() -> SceneDraft {
    let home = Camera { near: 1.0, far: 40.0, ..Camera::look_at(Vec3::Z * 5.6, Vec3::ZERO) };
    let mut draft = SceneDraft::new([30, 32, 36], home);
    add_wall(&mut draft);
    let (rim, plain, marked) = (draft.mesh(rim()), draft.mesh(spokes(1..SPOKES)), draft.mesh(spokes(0..1)));
    let wood = draft.plain("wood", srgb(0xD9_C2_9A));
    let paint = draft.plain("paint", srgb(0xE5_48_3B));
    for (number, turns) in (0..).zip(TURNS) {
        let cell = Vec2::new((number % 2) as f32, (number / 2) as f32) - Vec2::splat(0.5);
        let center = Vec3::new(cell.x, -cell.y, 0.0) * SPACING;
        let node = add_node(&mut draft.animation, None, center.as_dvec3());
        move_node(&mut draft.animation, node, Track::Rotation(turning(turns)));
        for (part, mesh, material) in [("rim", rim, wood), ("spokes", plain, wood), ("marked spoke", marked, paint)] {
            let name = format!("{part} of wheel {}", number + 1);
            draft.place(name.clone(), mesh, material, Mat4::from_translation(center));
            let object = draft.object(&name);
            draft.attach(object, node, DMat4::IDENTITY);
        }
    }
    draft
}

fn add_wall(draft: &mut SceneDraft) {
    let plane = draft.mesh(shapes::tiled(Vec2::new(8.0, 5.0), 3.0));
    let bricks = draft.textured("bricks", textures::bricks(256, srgb(0x5C_66_70), srgb(0x8C_92_98)));
    let upright = Quat::from_rotation_x(std::f32::consts::FRAC_PI_2);
    draft.place("wall", plane, bricks, Mat4::from_rotation_translation(upright, Vec3::NEG_Z));
}

/// Returns the key frames of a number of clockwise turns at constant speed, one for every quarter of a turn.
fn turning(turns: u32) -> Sampler<DQuat> {
    let angle = f64::from(turns) * std::f64::consts::TAU;
    sampled(DURATION_S, 4 * turns, |share| DQuat::from_axis_angle(DVec3::NEG_Z, share * angle))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;

    #[test]
    fn spokes_seem_to_turn_otherwise_than_the_painted_spoke() {
        let scene = Arc::new(WHEELS_MOTION.build());
        let next = scene.at(1.0 / 30.0);
        let spacing = 360.0 / SPOKES as f32;
        let turned = |wheel: usize| {
            let name = format!("marked spoke of wheel {}", wheel + 1);
            let object = next.instances.iter().position(|instance| instance.name == name).unwrap();
            let up = next.instances[object].world_from_model.transform_vector3(Vec3::Y);
            // Clockwise, from straight up.
            up.x.atan2(up.y).to_degrees()
        };
        for (wheel, (degrees, seeming)) in [(3.0, 3.0), (15.0, 15.0), (27.0, -3.0), (30.0, 0.0)].into_iter().enumerate()
        {
            let painted = turned(wheel);
            let others = painted - (painted / spacing - 1e-3).round() * spacing;
            assert!((painted - degrees).abs() < 1e-3 && (others - seeming).abs() < 1e-3, "{painted} and {others}");
        }
    }
}
