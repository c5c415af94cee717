//! Translucent panes in front of textured solids.

use glam::{DVec2, DVec3};

use super::super::Fault;
use super::super::mesh::Mesh;
use super::super::scene::{Light, Material, Object, Scene};
use super::super::view::Camera;
use super::super::{pattern, shapes};
use super::placed;

/// Vertical field of view in degrees.
const FOV_Y: f64 = 36.0;

/// Distance of the eye from the plane z = 0.
const DISTANCE: f64 = 7.0;

/// Height of the eye.
const HEIGHT: f64 = 1.25;

/// Returns the scene.
pub(super) fn scene() -> Scene {
    let material = |name, texture| Material { name, texture, opacity: 1.0 };
    let pane = |name, color, opacity| Material { name, texture: pattern::shaded(color), opacity };
    let stripes = material("stripes", pattern::stripes([[230, 190, 70], [60, 110, 160], [200, 215, 220]]));
    let letter = material("letter", pattern::letter([60, 40, 120], [235, 225, 200]));
    let wall = material("bricks", pattern::bricks([150, 120, 100], [200, 195, 180]));
    let tiles = material("arrows", pattern::arrows([90, 70, 50], [190, 175, 150]));
    let (amber, rose) = (pane("amber", [250, 170, 40], 0.4), pane("rose", [230, 60, 110], 0.55));
    let (sea, lime) = (pane("sea", [40, 130, 230], 0.35), pane("lime", [120, 220, 60], 0.5));
    let square = |edge: f64, turn, x, y, z| placed(DVec3::splat(edge), DVec3::Y, turn, DVec3::new(x, y, z));
    // Parallel to the picture, with the centre at whole pixels: the diagonals run through pixel centres.
    let pixel = 2.0 * (DISTANCE + 0.5) * (FOV_Y.to_radians() / 2.0).tan() / 360.0;
    let split = |material: &Material, x: f64, y: f64| {
        let position = DVec3::new(x * pixel, HEIGHT + y * pixel, -0.5);
        Object::new(&split_square(), placed(DVec3::splat(0.9), DVec3::Y, 0.0, position), material.clone())
    };
    let objects = vec![
        Object::new(&shapes::card(), square(1.8, 25.0, -1.7, 1.0, 1.2), amber.clone()),
        Object::new(&shapes::cube(), square(1.2, 30.0, -1.5, 0.6, 0.0), letter.clone()),
        Object::new(&shapes::sphere(18, 10).repeated(4.0, 2.0), square(0.8, 70.0, 0.4, 0.8, -0.6), stripes.clone()),
        Object::new(&shapes::cube(), square(1.0, -20.0, 2.2, 0.5, 0.3), stripes),
        Object::new(&shapes::card(), square(1.7, -30.0, 0.2, 0.9, 1.0), sea.clone()),
        Object::new(&shapes::card(), square(1.7, -12.0, 0.9, 1.1, 1.9), rose.clone()),
        Object::new(&shapes::card(), square(1.5, 40.0, 2.3, 0.9, 1.4), lime.clone()),
        Object::new(&shapes::card(), square(1.4, 190.0, -0.5, 1.3, 2.2), lime),
        split(&rose, -192.0, 56.0),
        split(&sea, 192.0, 64.0),
        split(&amber, 0.0, 84.0),
        Object::new(
            &shapes::card().repeated(5.0, 3.0),
            placed(DVec3::new(12.0, 5.0, 1.0), DVec3::Y, 0.0, DVec3::new(0.0, 2.4, -2.5)),
            wall,
        ),
        Object::new(
            &shapes::card().repeated(6.0, 5.0),
            placed(DVec3::new(12.0, 7.0, 1.0), DVec3::X, -90.0, DVec3::new(0.0, 0.0, 1.0)),
            tiles,
        ),
    ];
    Scene {
        name: "panes",
        objects,
        camera: Camera {
            eye: DVec3::new(0.0, HEIGHT, DISTANCE),
            target: DVec3::Y * HEIGHT,
            fov_y_degrees: FOV_Y,
            near: 0.1,
            far: 30.0,
        },
        light: Light { direction: DVec3::new(0.5, 0.6, 0.9), ambient: 0.3 },
        background: [200, 210, 225],
        invisible: &[
            Fault::Depth16,
            Fault::NormalsNotUnit,
            Fault::NormalsByModel,
            Fault::NoNearClip,
            Fault::NoSnapping,
        ],
        pairs: &[
            [Fault::Premultiplied, Fault::FlipHorizontal],
            [Fault::Premultiplied, Fault::TextureTop],
            [Fault::LightOnCodes, Fault::CullNone],
            [Fault::Painter, Fault::RedBlue],
            [Fault::DepthOff, Fault::FlipVertical],
            [Fault::FillInclusive, Fault::HalfTexel],
            [Fault::Affine, Fault::NoEncoding],
            [Fault::Clamp, Fault::LightNegated],
        ],
    }
}

/// Returns a square from −1 to 1 in x and y, split into eight triangles around its centre.
fn split_square() -> Mesh {
    let rim: Vec<DVec2> = [[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1]]
        .map(|[x, y]: [i32; 2]| DVec2::new(x.into(), y.into()))
        .to_vec();
    let wedges = (0..8).flat_map(|i| shapes::wedge(rim[i], rim[(i + 1) % 8], 1.0).triangles);
    Mesh { triangles: wedges.collect() }
}
