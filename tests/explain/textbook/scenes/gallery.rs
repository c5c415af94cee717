//! A long floor to the horizon between pillars and walls, all of which reach behind the camera.

use glam::DVec3;

use super::super::Fault;
use super::super::scene::{Light, Material, Object, Scene};
use super::super::view::Camera;
use super::super::{pattern, shapes};
use super::placed;

/// Returns the scene.
pub(super) fn scene() -> Scene {
    let material = |name, texture| Material { name, texture, opacity: 1.0 };
    let arrows = material("arrows", pattern::arrows([120, 50, 40], [225, 205, 165]));
    let bricks = material("bricks", pattern::bricks([170, 100, 70], [215, 205, 190]));
    let marble = material("marble", pattern::stripes([[200, 205, 215], [120, 140, 170], [230, 230, 225]]));
    let letter = material("letter", pattern::letter([40, 60, 120], [220, 200, 120]));
    let runner = material("runner", pattern::stripes([[150, 30, 40], [190, 60, 50], [220, 170, 80]]));
    let distances = || (0..7).map(|index| 4.5 * f64::from(index));
    // Columns before the floor, blocks after it, near ones first: without a depth test, all look different.
    let mut objects: Vec<Object> = distances()
        .map(|distance| {
            let position = DVec3::new(-2.2, 0.0, 1.0 - distance);
            let column = placed(DVec3::new(0.45, 3.2, 0.45), DVec3::Y, 9.0 * distance, position);
            Object::new(&shapes::column(10).repeated(3.0, 4.0), column, marble.clone())
        })
        .collect();
    let wall = placed(DVec3::new(70.0, 2.2, 1.0), DVec3::Y, -90.0, DVec3::new(4.5, 1.1, -25.0));
    objects.push(Object::new(&shapes::card().repeated(25.0, 2.0), wall, bricks));
    let floor = placed(DVec3::new(18.0, 90.0, 1.0), DVec3::X, -90.0, DVec3::new(-2.0, 0.0, -30.0));
    objects.push(Object::new(&shapes::card().repeated(7.5, 42.0), floor, arrows));
    // So close above the floor that coarse depths tie.
    let carpet = placed(DVec3::new(1.4, 60.0, 1.0), DVec3::X, -90.0, DVec3::new(0.9, 0.005, -20.0));
    objects.push(Object::new(&shapes::card().repeated(2.0, 80.0), carpet, runner));
    objects.extend(distances().map(|distance| {
        let block = placed(DVec3::new(0.8, 2.8, 0.8), DVec3::Y, 20.0, DVec3::new(2.3, 1.4, -0.5 - distance));
        Object::new(&shapes::cube().repeated(1.0, 3.0), block, letter.clone())
    }));
    Scene {
        name: "gallery",
        objects,
        camera: Camera {
            eye: DVec3::new(0.2, 1.7, 4.0),
            target: DVec3::new(-0.1, 1.2, -4.0),
            fov_y_degrees: 55.0,
            near: 0.03,
            far: 150.0,
        },
        light: Light { direction: DVec3::new(-0.5, 0.8, 0.5), ambient: 0.15 },
        background: [150, 190, 235],
        invisible: &[
            Fault::FillInclusive,
            Fault::FillExclusive,
            Fault::CullNone,
            Fault::NormalsByModel,
            Fault::Premultiplied,
        ],
        pairs: &[
            [Fault::NoNearClip, Fault::RedBlue],
            [Fault::Affine, Fault::NormalsNegated],
            [Fault::Clamp, Fault::FlipHorizontal],
            [Fault::Nearest, Fault::NoEncoding],
            [Fault::TextureTop, Fault::FovHorizontal],
            [Fault::DepthOff, Fault::NormalsNotUnit],
            [Fault::AspectInverse, Fault::RedBlue],
            [Fault::LeftHanded, Fault::LightOnCodes],
        ],
    }
}
