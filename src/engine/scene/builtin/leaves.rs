//! Leaves that fall and tumble before a wood of stripes.
//!
//! The leaves are squares with an alpha-tested texture. Each falls through the picture once or twice per loop and
//! appears again at the top, above the picture.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::{DMat4, DQuat, DVec3, Mat4, Quat, Vec2, Vec3};

use super::Builtin;
use super::draft::SceneDraft;
use super::motion::{add_node, move_node, sampled};
use super::{noise, shapes, textures};
use crate::scene::Camera;
use crate::scene::animation::{Interpolation, KeyTimes, Sampler, Track};
use textures::srgb;

pub(super) const LEAVES: Builtin = Builtin {
    id: "leaves",
    title: "Falling leaves",
    summary: "Leaves of an alpha-tested texture fall and tumble before tree trunks: shows fine edges in motion.",
    draft,
};

/// Length of the loop, in seconds.
const DURATION_S: f64 = 8.0;

/// Number of leaves.
const LEAVES_COUNT: u32 = 90;

/// Heights between which leaves fall, in world units: above the picture and below the ground.
const HEIGHTS: [f64; 2] = [7.9, -1.4];

/// Time in which a leaf that has fallen returns to the top, in seconds. No frame shows it.
const RETURN_S: f64 = 1e-6;

/// Number of key frames per loop.
const KEYS: u32 = 96;

fn draft() -> SceneDraft {
    let home = Camera { near: 0.5, far: 60.0, ..Camera::look_at(Vec3::new(0.0, 2.4, 9.0), Vec3::new(0.0, 2.4, 0.0)) };
    let mut draft = SceneDraft::new([196, 206, 198], home);
    add_wood(&mut draft);
    add_leaves(&mut draft);
    draft
}

fn add_wood(draft: &mut SceneDraft) {
    let ground = draft.mesh(shapes::tiled(Vec2::new(48.0, 28.0), 3.0));
    let soil = draft.textured("soil", textures::marble(256, srgb(0x6E_58_3C), srgb(0x9C_84_58)));
    draft.place("ground", ground, soil, Mat4::from_translation(Vec3::new(0.0, -0.8, -8.0)));
    let trunk = draft.mesh(shapes::mapped(shapes::capsule(12.0, 20), |position, normal| {
        Vec2::new(normal.x.atan2(normal.z) / std::f32::consts::TAU * 2.0, position.y * 0.25)
    }));
    let bark = draft.textured("bark", textures::marble(256, srgb(0x5A_46_34), srgb(0xA0_8A_6C)));
    for (number, (x, z)) in (1..).zip([(-5.2, -3.0), (-2.1, -5.5), (0.9, -3.4), (3.4, -6.5), (5.6, -2.6)]) {
        let place = Mat4::from_scale_rotation_translation(
            Vec3::new(0.55, 0.85, 0.55),
            Quat::from_rotation_y(x),
            Vec3::new(x, 4.0, z),
        );
        draft.place(format!("trunk {number}"), trunk, bark, place);
    }
}

fn add_leaves(draft: &mut SceneDraft) {
    let square = draft.mesh(shapes::two_sided(shapes::grid(1)));
    let colors = [0xD8_8A_2C, 0xC2_48_30, 0xD2_B8_3E, 0x8A_9C_3A].map(srgb);
    let materials = colors.map(|color| draft.textured("leaf", textures::leaf(128, color)));
    for number in 0..LEAVES_COUNT {
        let object = format!("leaf {}", number + 1);
        let material = materials[number as usize % materials.len()];
        draft.place(object.as_str(), square, material, Mat4::IDENTITY);
        let object = draft.object(&object);
        let path = LeafPath::of(number);
        let fall = add_node(&mut draft.animation, None, DVec3::ZERO);
        move_node(&mut draft.animation, fall, Track::Translation(path.fall()));
        let leaf = add_node(&mut draft.animation, Some(fall), DVec3::ZERO);
        let places = sampled(DURATION_S, KEYS, |share| path.sway(share));
        let turns = sampled(DURATION_S, KEYS, |share| path.turn(share));
        move_node(&mut draft.animation, leaf, Track::Translation(places));
        move_node(&mut draft.animation, leaf, Track::Rotation(turns));
        draft.attach(object, leaf, DMat4::from_rotation_x(FRAC_PI_2) * DMat4::from_scale(DVec3::splat(0.75)));
    }
}

/// Path of a leaf: it falls, sways and tumbles.
struct LeafPath {
    /// Mean position in x and z, in world units.
    middle: DVec3,
    /// Fraction of the height that the leaf has fallen at the start of the loop.
    start: f64,
    /// Numbers of falls, sways and turns per loop.
    falls: f64,
    sways: f64,
    turns: f64,
    /// Unit axis about which the leaf tumbles.
    axis: DVec3,
}

impl LeafPath {
    /// Returns the path of a leaf.
    fn of(number: u32) -> Self {
        let random = |what: u32| f64::from(noise::hash(number, what, 41));
        Self {
            middle: DVec3::new(random(0) * 13.0 - 6.5, 0.0, random(1) * 7.0 - 3.0),
            start: random(2),
            falls: 1.0 + f64::from(number % 2),
            sways: 3.0 + f64::from(number % 3),
            turns: 3.0 + f64::from(number % 4),
            axis: DVec3::new(random(3) - 0.5, 0.4 * random(4), random(5) - 0.5).normalize_or(DVec3::X),
        }
    }

    /// Returns the key frames of the fall.
    fn fall(&self) -> Sampler<DVec3> {
        let height = |fallen: f64| DVec3::Y * (HEIGHTS[0] + (HEIGHTS[1] - HEIGHTS[0]) * fallen);
        let (mut times_s, mut places) = (vec![0.0], vec![height(self.start)]);
        let mut landing_s = DURATION_S * (1.0 - self.start) / self.falls;
        while landing_s + RETURN_S < DURATION_S {
            times_s.extend([landing_s, landing_s + RETURN_S]);
            places.extend([height(1.0), height(0.0)]);
            landing_s += DURATION_S / self.falls;
        }
        times_s.push(DURATION_S);
        places.push(height(self.start));
        let times = KeyTimes::new(times_s).expect("times ascend");
        Sampler::new(times, places, Interpolation::Linear).expect("there is a place for each time")
    }

    /// Returns the orientation at a fraction of the loop.
    fn turn(&self, share: f64) -> DQuat {
        DQuat::from_axis_angle(self.axis, TAU * (self.start + self.turns * share))
    }

    /// Returns the offset from the vertical path at a fraction of the loop.
    fn sway(&self, share: f64) -> DVec3 {
        let sway = (TAU * (self.start + self.sways * share)).sin();
        self.middle + DVec3::new(0.5 * sway, 0.0, 0.2 * sway)
    }
}
