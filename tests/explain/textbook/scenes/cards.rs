//! Coloured cards that overlap and intersect, a quilt and a fan whose edges run through pixel centres.

use glam::{DAffine3, DVec2, DVec3};

use super::super::Fault;
use super::super::scene::{Light, Material, Object, Scene};
use super::super::view::Camera;
use super::super::{pattern, shapes};
use super::placed;

/// Vertical field of view in degrees.
const FOV_Y: f64 = 40.0;

/// Distance of the eye from the plane z = 0.
const DISTANCE: f64 = 8.0;

/// Returns the length of one pixel in the plane z = 0 of a picture 360 px high.
fn pixel() -> f64 {
    2.0 * DISTANCE * (FOV_Y.to_radians() / 2.0).tan() / 360.0
}

/// Returns the materials of the cards, which share one pattern in different colours.
fn materials() -> [Material; 6] {
    [
        ("red", [215, 60, 50]),
        ("orange", [235, 150, 40]),
        ("green", [70, 170, 80]),
        ("teal", [40, 150, 165]),
        ("blue", [60, 80, 200]),
        ("violet", [160, 80, 180]),
    ]
    .map(|(name, color)| Material { name, texture: pattern::shaded(color), opacity: 1.0 })
}

/// Returns a fan around the middle of the picture. Its spokes have the slopes ±⅓, ±1 and ±3, and run through pixel
/// centres in pictures of 640×360 and 320×180 px.
fn fan(materials: &[Material; 6]) -> Vec<Object> {
    let rim = [[96, 32], [64, 64], [32, 96], [-32, 96], [-64, 64], [-96, 32]];
    let rim: Vec<DVec2> =
        rim.into_iter().chain(rim.map(|[x, y]| [-x, -y])).map(|[x, y]| DVec2::new(x.into(), y.into())).collect();
    (0..rim.len())
        .map(|i| {
            let wedge = shapes::wedge(rim[i], rim[(i + 1) % rim.len()], 96.0);
            Object::new(&wedge, DAffine3::from_scale(DVec3::splat(pixel())), materials[i * 5 % 6].clone())
        })
        .collect()
}

/// Returns rows of squares at the upper left, each split along its diagonal into two colours.
fn quilt(materials: &[Material; 6]) -> Vec<Object> {
    let mut objects = Vec::new();
    for (column, row) in (0..4).flat_map(|column| (0..3).map(move |row| (column, row))) {
        let place = DVec3::new(-300.0 + 36.0 * f64::from(column), 64.0 + 36.0 * f64::from(row), 0.0);
        let model =
            DAffine3::from_scale_rotation_translation(DVec3::splat(pixel()), glam::DQuat::IDENTITY, place * pixel());
        let corner = |x: f64, y: f64| DVec2::new(x, y) * 36.0;
        let halves = [(corner(1.0, 0.0), corner(1.0, 1.0)), (corner(1.0, 1.0), corner(0.0, 1.0))];
        for (half, (from, to)) in halves.into_iter().enumerate() {
            let material = &materials[(column + 2 * row + 3 * half as i32) as usize % 6];
            objects.push(Object::new(&shapes::wedge(from, to, 36.0), model, material.clone()));
        }
    }
    objects
}

/// Returns the scene.
pub(super) fn scene() -> Scene {
    let materials = materials();
    let mut objects = fan(&materials);
    objects.extend(quilt(&materials));
    // Width, height, axis of rotation, turn in degrees, position.
    let cards = [
        (2.2, 1.4, DVec3::Y, 50.0, DVec3::new(2.6, 0.8, 0.3), 0),
        (2.4, 1.2, DVec3::Y, -40.0, DVec3::new(2.8, 0.7, 0.2), 4),
        (1.6, 1.6, DVec3::X, 55.0, DVec3::new(2.6, 0.6, 0.4), 1),
        (2.6, 1.5, DVec3::new(0.3, 1.0, 0.1), 30.0, DVec3::new(-2.9, -1.3, 0.5), 2),
        (2.0, 1.8, DVec3::new(1.0, 0.5, 0.0), -45.0, DVec3::new(-2.6, -1.4, 0.4), 5),
        (1.8, 1.2, DVec3::Z, 20.0, DVec3::new(0.6, -2.0, 1.0), 3),
        (1.8, 1.2, DVec3::Z, -15.0, DVec3::new(1.2, -2.2, 0.99), 0),
        (2.4, 1.0, DVec3::Z, 40.0, DVec3::new(2.3, -1.8, 0.6), 1),
        (2.2, 1.1, DVec3::Y, 160.0, DVec3::new(0.3, 2.1, 1.0), 4),
        (1.4, 1.4, DVec3::X, 200.0, DVec3::new(-1.6, -2.4, 1.2), 0),
        (9.0, 5.0, DVec3::Z, 0.0, DVec3::new(0.2, 0.2, -1.5), 3),
        (4.0, 3.0, DVec3::Z, 5.0, DVec3::new(1.2, -1.0, -1.49), 2),
        (5.0, 2.5, DVec3::Y, 8.0, DVec3::new(-0.8, 1.2, -1.4), 5),
    ];
    objects.extend(cards.into_iter().map(|(width, height, axis, turn, position, material)| {
        let model = placed(DVec3::new(width, height, 1.0), axis, turn, position);
        Object::new(&shapes::card().repeated(2.0, 1.5), model, materials[material].clone())
    }));
    Scene {
        name: "cards",
        objects,
        camera: Camera { eye: DVec3::Z * DISTANCE, target: DVec3::ZERO, fov_y_degrees: FOV_Y, near: 0.02, far: 60.0 },
        light: Light::default(),
        background: [235, 235, 225],
        invisible: &[Fault::NormalsNotUnit, Fault::NormalsByModel, Fault::NoNearClip, Fault::Premultiplied],
        pairs: &[
            [Fault::FillExclusive, Fault::RedBlue],
            [Fault::FillInclusive, Fault::NoEncoding],
            [Fault::Depth16, Fault::FlipHorizontal],
            [Fault::DepthOff, Fault::Clamp],
            [Fault::Painter, Fault::LightOnCodes],
            [Fault::PixelCorners, Fault::RedBlue],
            [Fault::CullNone, Fault::TextureTop],
            [Fault::DepthReversed, Fault::AspectIgnored],
        ],
    }
}
