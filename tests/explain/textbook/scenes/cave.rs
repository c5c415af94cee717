//! A low-poly cave seen from inside, with terrain and stretched rocks.

use glam::DVec3;

use super::super::Fault;
use super::super::scene::{Light, Material, Object, Scene};
use super::super::view::Camera;
use super::super::{pattern, shapes};
use super::placed;

/// Returns the scene.
pub(super) fn scene() -> Scene {
    let material = |name, texture| Material { name, texture, opacity: 1.0 };
    let rock = material("rock", pattern::bricks([150, 130, 120], [110, 100, 100]));
    let crystal = material("crystal", pattern::stripes([[90, 200, 210], [150, 110, 220], [220, 240, 250]]));
    let moss = material("moss", pattern::arrows([60, 110, 50], [140, 150, 80]));
    let clay = material("clay", pattern::letter([170, 70, 40], [220, 160, 110]));
    let mut objects = Vec::new();
    // Scale of each axis, axis of rotation, turn in degrees, position.
    let stones = [
        (DVec3::new(1.5, 0.5, 0.8), DVec3::new(0.2, 1.0, 0.4), 35.0, DVec3::new(-1.6, -0.9, -0.6), &clay),
        (DVec3::new(0.35, 1.5, 0.5), DVec3::new(0.5, 0.3, 1.0), 20.0, DVec3::new(1.2, -0.2, -1.4), &crystal),
        (DVec3::new(0.3, 1.1, 0.3), DVec3::new(0.2, 0.1, 1.0), -30.0, DVec3::new(2.0, -0.5, -1.0), &crystal),
        (DVec3::new(0.9, 0.35, 1.4), DVec3::new(0.0, 1.0, 0.3), -50.0, DVec3::new(0.2, -1.1, 0.9), &clay),
        (DVec3::new(0.5, 1.9, 0.6), DVec3::new(1.0, 0.0, 0.5), 12.0, DVec3::new(-2.6, 0.1, -3.0), &rock),
        (DVec3::new(1.8, 0.6, 0.9), DVec3::new(0.4, 0.3, 1.0), 50.0, DVec3::new(2.9, 0.4, -3.6), &clay),
        (DVec3::new(0.25, 0.9, 0.25), DVec3::Z, 170.0, DVec3::new(0.1, 2.2, -2.0), &crystal),
    ];
    for (scale, axis, turn, position, material) in stones {
        let stone = shapes::sphere(8, 5).flat().repeated(3.0, 2.0);
        objects.push(Object::new(&stone, placed(scale, axis, turn, position), material.clone()));
    }
    let hills = shapes::terrain(10, |x, z| 0.5 * (11.0 * x).sin() * (8.0 * z + 1.0).cos());
    let ground = placed(DVec3::new(11.0, 0.7, 12.0), DVec3::Y, 15.0, DVec3::new(0.0, -1.4, -1.0));
    objects.push(Object::new(&hills.flat().repeated(9.0, 7.0), ground, moss));
    let shell = shapes::sphere(14, 8).flat().inverted().repeated(10.0, 5.0);
    let cave = placed(DVec3::new(5.5, 3.2, 7.5), DVec3::new(0.2, 1.0, 0.3), 25.0, DVec3::new(0.0, 0.6, -0.5));
    objects.push(Object::new(&shell, cave, rock));
    Scene {
        name: "cave",
        objects,
        camera: Camera {
            eye: DVec3::new(0.3, 0.6, 4.6),
            target: DVec3::new(0.1, -0.1, -1.5),
            fov_y_degrees: 60.0,
            near: 0.1,
            far: 40.0,
        },
        light: Light { direction: DVec3::new(0.3, 0.8, 0.9), ambient: 0.25 },
        background: [20, 20, 30],
        invisible: &[
            Fault::FillInclusive,
            Fault::FillExclusive,
            Fault::CullNone,
            Fault::Depth16,
            Fault::NormalsNotUnit,
            Fault::Premultiplied,
            Fault::NoSnapping,
        ],
        pairs: &[
            [Fault::NormalsUntransformed, Fault::RedBlue],
            [Fault::NormalsByModel, Fault::FlipVertical],
            [Fault::CullFront, Fault::LightNegated],
            [Fault::NormalsNegated, Fault::Nearest],
            [Fault::LightOnCodes, Fault::FlipHorizontal],
            [Fault::DepthReversed, Fault::NoEncoding],
            [Fault::Clamp, Fault::AspectIgnored],
            [Fault::Affine, Fault::NormalsUntransformed],
        ],
    }
}
