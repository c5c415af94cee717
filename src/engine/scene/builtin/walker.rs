//! A figure that walks in a circle, deformed by a skeleton.
//!
//! Arms and legs are tubes whose vertices near knee or elbow follow both bones. The steps of a walk are sine curves of
//! the phase; one loop is one round.

use std::f64::consts::{PI, TAU};

use glam::{DMat4, DQuat, DVec3, Mat4, Quat, Vec2, Vec3};

use super::Builtin;
use super::draft::SceneDraft;
use super::motion::{add_node, move_node, sampled};
use super::revolve::Profile;
use super::{shapes, textures};
use crate::scene::animation::{Animation, Deformation, Influence, Joint, Skin, Track};
use crate::scene::{Camera, MeshData};
use textures::{smoothstep, srgb};

pub(super) const WALKER: Builtin = Builtin {
    id: "walker",
    title: "Walking figure",
    summary: "A figure with a skeleton walks in a circle: shows motion of deformed surfaces, whose vertices have no \
              common transform.",
    draft,
};

/// Length of the loop, one round, in seconds.
const DURATION_S: f64 = 7.0;

/// Number of double steps per round.
const CYCLES: f64 = 7.0;

/// Radius of the circle, in world units; the figure is 1.8 high.
const RADIUS: f64 = 1.6;

/// Angle at which the loop begins, in radians: the figure walks towards the viewer.
const START: f64 = -2.3;

/// Number of key frames per round.
const KEYS: u32 = 168;

/// Bone of the skeleton. At rest, all bones have the orientation of the world, and the figure faces −z.
struct Bone {
    parent: Option<usize>,
    /// Place of the joint at rest, in model space.
    joint: DVec3,
    /// Angle about the x axis at a phase of the walk, both in radians. Positive angles lift limbs forwards.
    angle: fn(f64) -> f64,
}

const HIPS: usize = 0;
const CHEST: usize = 1;
const HEAD: usize = 2;
const LEFT_LEG: [usize; 2] = [3, 4];
const RIGHT_LEG: [usize; 2] = [5, 6];
const LEFT_ARM: [usize; 2] = [7, 8];
const RIGHT_ARM: [usize; 2] = [9, 10];

const BONES: [Bone; 11] = [
    Bone { parent: None, joint: DVec3::new(0.0, 0.92, 0.0), angle: |_| 0.0 },
    Bone { parent: Some(HIPS), joint: DVec3::new(0.0, 1.04, 0.0), angle: |phase| -0.06 + 0.03 * (2.0 * phase).sin() },
    Bone { parent: Some(CHEST), joint: DVec3::new(0.0, 1.5, 0.0), angle: |phase| 0.05 - 0.04 * (2.0 * phase).sin() },
    Bone { parent: Some(HIPS), joint: DVec3::new(-0.11, 0.88, 0.0), angle: thigh },
    Bone { parent: Some(LEFT_LEG[0]), joint: DVec3::new(-0.11, 0.48, 0.0), angle: shin },
    Bone { parent: Some(HIPS), joint: DVec3::new(0.11, 0.88, 0.0), angle: |phase| thigh(phase + PI) },
    Bone { parent: Some(RIGHT_LEG[0]), joint: DVec3::new(0.11, 0.48, 0.0), angle: |phase| shin(phase + PI) },
    Bone { parent: Some(CHEST), joint: DVec3::new(-0.25, 1.38, 0.0), angle: |phase| -0.9 * thigh(phase) },
    Bone { parent: Some(LEFT_ARM[0]), joint: DVec3::new(-0.25, 1.11, 0.0), angle: |phase| 0.4 - 0.2 * phase.sin() },
    Bone { parent: Some(CHEST), joint: DVec3::new(0.25, 1.38, 0.0), angle: |phase| 0.9 * thigh(phase) },
    Bone { parent: Some(RIGHT_ARM[0]), joint: DVec3::new(0.25, 1.11, 0.0), angle: |phase| 0.4 + 0.2 * phase.sin() },
];

/// Returns the angle of the left thigh.
fn thigh(phase: f64) -> f64 {
    0.06 + 0.5 * phase.sin()
}

/// Returns the angle of the left shin, which is bent while the leg swings forwards.
fn shin(phase: f64) -> f64 {
    let swing = (phase + 0.5).cos().max(0.0);
    -0.06 - 0.85 * swing * swing
}

fn draft() -> SceneDraft {
    let home = Camera { near: 0.5, far: 60.0, ..Camera::look_at(Vec3::new(0.0, 2.1, 6.4), Vec3::new(0.0, 0.95, 0.0)) };
    let mut draft = SceneDraft::new([98, 112, 128], home);
    add_room(&mut draft);
    add_figure(&mut draft);
    draft
}

fn add_room(draft: &mut SceneDraft) {
    let floor = draft.mesh(shapes::tiled(Vec2::new(30.0, 22.0), 4.0));
    let tiles = draft.textured("tiles", textures::chess(512, srgb(0xD8_D0_C0), srgb(0x7C_86_7E)));
    draft.place("floor", floor, tiles, Mat4::from_translation(Vec3::new(0.0, 0.0, -5.0)));
    let post = draft.mesh(shapes::capsule(3.0, 20));
    let marble = draft.textured("marble", textures::marble(256, srgb(0xC8_B8_9C), srgb(0x8A_78_60)));
    for (number, (x, z)) in (1..).zip([(0.0, 0.0), (-3.0, -2.6), (3.0, -2.6), (-6.0, -5.0), (6.0, -5.0)]) {
        let scale = Vec3::new(0.28, 0.55, 0.28);
        let place = Mat4::from_scale_rotation_translation(scale, Quat::IDENTITY, Vec3::new(x, 0.8, z));
        draft.place(format!("post {number}"), post, marble, place);
    }
}

fn add_figure(draft: &mut SceneDraft) {
    let Figure { mesh, influences } = figure();
    let (mesh, rest) = draft.deformed_mesh(mesh);
    let cloth = draft.plain("vertex colours", Vec3::ONE);
    draft.place("figure", mesh, cloth, Mat4::IDENTITY);
    let animation = &mut draft.animation;
    let circle = add_node(animation, None, DVec3::ZERO);
    let round = sampled(DURATION_S, 8, |share| DQuat::from_rotation_y(START + TAU * share));
    move_node(animation, circle, Track::Rotation(round));
    let body = add_node(animation, Some(circle), DVec3::X * RADIUS);
    let bob = |share: f64| DVec3::new(RADIUS, 0.02 * (2.0 * phase(share)).cos() - 0.03, 0.0);
    move_node(animation, body, Track::Translation(sampled(DURATION_S, KEYS, bob)));
    let joints = add_bones(animation, body);
    let skin = Some(Skin { joints: joints.into(), influences: influences.into(), per_vertex: 2 });
    let targets = [].into();
    animation.deformations.push(Deformation { mesh, rest, node: body, targets, skin, computes_normals: false });
}

/// Returns the phase of the walk at a fraction of the loop, in radians.
fn phase(share: f64) -> f64 {
    TAU * CYCLES * share
}

/// Adds the bones below the node of the body, and returns their joints.
fn add_bones(animation: &mut Animation, body: usize) -> Vec<Joint> {
    let mut joints: Vec<Joint> = Vec::new();
    for Bone { parent, joint, angle } in &BONES {
        let (parent, origin) = match parent {
            Some(parent) => (joints[*parent].node, BONES[*parent].joint),
            None => (body, DVec3::ZERO),
        };
        let node = add_node(animation, Some(parent), *joint - origin);
        let turns = sampled(DURATION_S, KEYS, |share| DQuat::from_rotation_x(angle(phase(share))));
        move_node(animation, node, Track::Rotation(turns));
        joints.push(Joint { node, joint_from_model: DMat4::from_translation(-*joint) });
    }
    joints
}

/// Mesh of the figure with two influences for each vertex.
struct Figure {
    mesh: MeshData,
    influences: Vec<Influence>,
}

/// Upright tube with round ends that follows an upper and a lower bone.
struct Limb {
    /// Distance of the axis from the middle of the body, to the right.
    x: f32,
    /// Heights of both ends.
    ends: [f32; 2],
    radius: f32,
    /// Upper and lower bone.
    bones: [usize; 2],
    /// Height at which the lower bone takes over, and at which the colour changes.
    joint: f32,
    /// Colours above and below the joint.
    colors: [Vec3; 2],
}

fn figure() -> Figure {
    const SHIRT: Vec3 = srgb(0x3E_7C_B8);
    const TROUSERS: Vec3 = srgb(0x4A_42_3C);
    const SKIN: Vec3 = srgb(0xE8_B4_8C);
    const HAIR: Vec3 = srgb(0x6A_3E_24);
    const SHOES: Vec3 = srgb(0xB0_34_2C);
    let leg = |x: f32, bones| Limb { x, ends: [0.94, 0.05], radius: 0.095, bones, joint: 0.48, colors: [TROUSERS; 2] };
    let arm = |x: f32, bones| Limb { x, ends: [1.44, 0.8], radius: 0.065, bones, joint: 1.11, colors: [SHIRT, SKIN] };
    let (torso, head) = ([CHEST, HIPS], [HEAD; 2]);
    let limbs = [
        Limb { x: 0.0, ends: [1.48, 0.84], radius: 0.185, bones: torso, joint: 1.04, colors: [SHIRT, TROUSERS] },
        Limb { x: 0.0, ends: [1.84, 1.54], radius: 0.13, bones: head, joint: 1.7, colors: [HAIR, SKIN] },
        leg(-0.11, LEFT_LEG),
        leg(0.11, RIGHT_LEG),
        arm(-0.25, LEFT_ARM),
        arm(0.25, RIGHT_ARM),
    ];
    let mut figure =
        Figure { mesh: MeshData { name: "figure".to_owned(), ..MeshData::default() }, influences: Vec::new() };
    limbs.iter().for_each(|limb| figure.add_limb(limb));
    for (x, [_, shin]) in [(-0.11, LEFT_LEG), (0.11, RIGHT_LEG)] {
        figure.add_shoe(x, shin, SHOES);
    }
    figure
}

impl Figure {
    fn add_limb(&mut self, limb: &Limb) {
        /// Number of sections of the straight part, so that it can bend.
        const SECTIONS: u32 = 12;
        /// Half height of the zone in which vertices follow both bones.
        const BLEND: f32 = 0.13;
        let Limb { x, ends: [top, bottom], radius, bones: [upper, lower], joint, colors } = *limb;
        let straight = [top - radius, bottom + radius];
        let mut profile = Profile::from(0.0, top).arc_to(radius, straight[0], 90.0, 5);
        for section in 1..=SECTIONS {
            let share = section as f32 / SECTIONS as f32;
            profile = profile.line_to(radius, straight[0] + (straight[1] - straight[0]) * share);
        }
        let tube = profile.arc_to(0.0, bottom, 90.0, 5).revolve("limb", 18);
        for position in &tube.positions {
            let share = smoothstep(joint - BLEND, joint + BLEND, position.y);
            self.mesh.colors.push(colors[usize::from(position.y < joint)]);
            self.influence([(upper, share), (lower, 1.0 - share)]);
        }
        self.append(tube, Vec3::new(x, 0.0, 0.0));
    }

    fn add_shoe(&mut self, x: f32, shin: usize, color: Vec3) {
        let mut shoe = shapes::cube();
        shoe.positions.iter_mut().for_each(|position| *position *= Vec3::new(0.075, 0.05, 0.15));
        for _ in &shoe.positions {
            self.mesh.colors.push(color);
            self.influence([(shin, 1.0), (shin, 0.0)]);
        }
        self.append(shoe, Vec3::new(x, 0.05, -0.06));
    }

    fn influence(&mut self, bones: [(usize, f32); 2]) {
        let influence = |(bone, weight): (usize, f32)| Influence { joint: bone as u32, weight: f64::from(weight) };
        self.influences.extend(bones.map(influence));
    }

    /// Appends a part, moved by `offset`.
    fn append(&mut self, part: MeshData, offset: Vec3) {
        let first = self.mesh.positions.len() as u32;
        self.mesh.positions.extend(part.positions.iter().map(|position| *position + offset));
        self.mesh.normals.extend(part.normals);
        self.mesh.triangles.extend(part.triangles.iter().map(|corners| corners.map(|corner| first + corner)));
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;

    #[test]
    fn the_figure_bends_its_limbs_and_stays_on_its_circle() {
        let scene = Arc::new(WALKER.build());
        let figure = figure();
        for time_s in [0.0, 0.3, 2.2, 4.9] {
            let posed = scene.at(time_s);
            let instance = posed.instances.iter().find(|instance| instance.name == "figure").unwrap();
            let mesh = posed.library.mesh(instance.mesh);
            let center = mesh.bounds().center();
            assert!((center.with_y(0.0).length() - RADIUS as f32).abs() < 0.3, "{time_s}: {center}");
            // The distance between shoe and hips changes only if the knee bends.
            let [first, last] = [0, mesh.positions.len() - 1];
            let stretched = figure.mesh.positions[first].distance(figure.mesh.positions[last]);
            assert!(mesh.positions[first].distance(mesh.positions[last]) < stretched, "{time_s}");
            let off = mesh.normals.iter().map(|normal| (normal.length() - 1.0).abs()).fold(0.0, f32::max);
            assert!(off < 1e-5, "{time_s}: {off}");
        }
    }
}
