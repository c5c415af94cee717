//! Textured cubes on a textured floor.

use glam::DVec3;

use super::super::Fault;
use super::super::scene::{Light, Material, Object, Scene};
use super::super::view::Camera;
use super::super::{pattern, shapes};
use super::placed;

/// Returns the scene.
pub(super) fn scene() -> Scene {
    let material = |name, texture| Material { name, texture, opacity: 1.0 };
    let letter = material("letter", pattern::letter([190, 40, 30], [240, 220, 170]));
    let bricks = material("bricks", pattern::bricks([180, 90, 60], [210, 205, 190]));
    let arrows = material("arrows", pattern::arrows([30, 60, 150], [150, 200, 230]));
    let tiles = material("tiles", pattern::letter([60, 90, 70], [160, 180, 140]));
    // Edge length, turn about y in degrees, x and z. Near cubes come first, so that the drawing order is wrong.
    let cubes = [
        (1.3, 25.0, -0.9, 1.2, &letter),
        (1.6, -35.0, 1.3, 0.3, &bricks),
        (1.1, 60.0, -2.6, 0.2, &arrows),
        (2.0, 10.0, -0.8, -2.2, &bricks),
        (1.8, 40.0, 3.2, -2.6, &letter),
        (1.5, -15.0, -4.0, -3.2, &arrows),
        (0.8, 50.0, 0.4, 2.4, &arrows),
    ];
    let mut objects: Vec<Object> = cubes
        .into_iter()
        .map(|(edge, turn, x, z, material)| {
            let model = placed(DVec3::splat(edge), DVec3::Y, turn, DVec3::new(x, edge / 2.0, z));
            Object::new(&shapes::cube(), model, material.clone())
        })
        .collect();
    let floor = placed(DVec3::new(16.0, 12.0, 1.0), DVec3::X, -90.0, DVec3::new(0.0, 0.0, -2.0));
    // Between the cubes: without a depth test, it covers some of them only.
    objects.insert(3, Object::new(&shapes::card().repeated(8.0, 6.0), floor, tiles));
    Scene {
        name: "cubes",
        objects,
        camera: Camera {
            eye: DVec3::new(2.0, 3.2, 7.0),
            target: DVec3::new(-0.2, 0.5, -0.5),
            fov_y_degrees: 40.0,
            near: 0.1,
            far: 40.0,
        },
        light: Light::default(),
        background: [120, 160, 210],
        invisible: &[
            Fault::FillInclusive,
            Fault::FillExclusive,
            Fault::CullNone,
            Fault::Depth16,
            Fault::NormalsNotUnit,
            Fault::NormalsByModel,
            Fault::NoNearClip,
            Fault::Premultiplied,
            Fault::NoSnapping,
        ],
        pairs: &[
            [Fault::FlipVertical, Fault::Affine],
            [Fault::DepthOff, Fault::RedBlue],
            [Fault::TextureTop, Fault::NoEncoding],
            [Fault::Nearest, Fault::CullFront],
            [Fault::LightNegated, Fault::Clamp],
            [Fault::AspectIgnored, Fault::NoEncoding],
            [Fault::Painter, Fault::TextureTop],
            [Fault::FovHorizontal, Fault::LightOnCodes],
        ],
    }
}
