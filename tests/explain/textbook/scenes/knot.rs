//! A smooth knot between overlapping spheres, all coarse.

use glam::DVec3;

use super::super::Fault;
use super::super::scene::{Light, Material, Object, Scene};
use super::super::view::Camera;
use super::super::{pattern, shapes};
use super::placed;

/// Returns the scene.
pub(super) fn scene() -> Scene {
    let material = |name, texture| Material { name, texture, opacity: 1.0 };
    let stripes = material("stripes", pattern::stripes([[220, 180, 60], [150, 60, 140], [90, 160, 190]]));
    let arrows = material("arrows", pattern::arrows([140, 40, 30], [235, 215, 190]));
    let letter = material("letter", pattern::letter([40, 110, 60], [220, 235, 200]));
    let knot = placed(DVec3::splat(1.3), DVec3::new(1.0, 0.4, 0.0), 35.0, DVec3::ZERO);
    let mut objects = vec![Object::new(&shapes::knot(60, 7, 0.3).repeated(12.0, 2.0), knot, stripes)];
    // Scale of each axis, turn in degrees, position.
    let spheres = [
        (DVec3::splat(0.7), 20.0, DVec3::new(-1.9, 0.6, 0.9), &arrows),
        (DVec3::splat(0.55), 110.0, DVec3::new(1.5, -0.9, 1.4), &letter),
        (DVec3::splat(0.9), 200.0, DVec3::new(1.9, 1.1, -1.2), &arrows),
        (DVec3::splat(0.5), 60.0, DVec3::new(0.1, 0.1, 0.2), &letter),
        (DVec3::new(1.5, 0.5, 0.8), 35.0, DVec3::new(-1.6, -1.2, -0.8), &letter),
        (DVec3::splat(0.45), 300.0, DVec3::new(-1.35, 0.95, 1.35), &letter),
        (DVec3::new(0.4, 1.2, 0.6), 50.0, DVec3::new(3.1, -0.4, -0.6), &arrows),
    ];
    objects.extend(spheres.into_iter().map(|(scale, turn, position, material)| {
        let model = placed(scale, DVec3::new(0.3, 1.0, 0.2), turn, position);
        Object::new(&shapes::sphere(12, 7).repeated(4.0, 2.0), model, material.clone())
    }));
    Scene {
        name: "knot",
        objects,
        camera: Camera {
            eye: DVec3::new(0.8, 1.2, 7.5),
            target: DVec3::new(0.3, 0.0, 0.0),
            fov_y_degrees: 35.0,
            near: 0.2,
            far: 30.0,
        },
        light: Light { direction: DVec3::new(-0.6, 0.5, 0.7), ambient: 0.1 },
        background: [45, 50, 70],
        invisible: &[
            Fault::FillInclusive,
            Fault::FillExclusive,
            Fault::CullNone,
            Fault::Depth16,
            Fault::NoNearClip,
            Fault::Premultiplied,
            Fault::NoSnapping,
        ],
        pairs: &[
            [Fault::NormalsNotUnit, Fault::FlipHorizontal],
            [Fault::NormalsNegated, Fault::RedBlue],
            [Fault::CullFront, Fault::NoEncoding],
            [Fault::DepthReversed, Fault::TextureTop],
            [Fault::LightOnCodes, Fault::Nearest],
            [Fault::NormalsUntransformed, Fault::FovHorizontal],
            [Fault::HalfTexel, Fault::LightNegated],
            [Fault::DepthOff, Fault::NoEncoding],
        ],
    }
}
