//! Scenes of any size, to see what grows with what: so many triangles, or so many layers over each other.

use glam::{Mat4, Quat, Vec3};

use super::draft::Draft;
use super::{shapes, textures};
use crate::scene::{Camera, Scene};

/// Side of the texture, px.
const TEXTURE_PX: u32 = 256;

/// Where both scenes are seen from: a square of edge 2 around the origin just fits into a wide picture.
fn camera() -> Camera {
    Camera { near: 0.5, far: 20.0, ..Camera::look_at(Vec3::new(0.0, 0.0, 3.2), Vec3::ZERO) }
}

/// Turns a flat square that is seen from above so that it is seen from the front.
fn upright() -> Quat {
    Quat::from_rotation_x(std::f32::consts::FRAC_PI_2)
}

/// A textured square of some `triangles`, all of them in view: the nearest number that gives rows of squares cut in two.
pub fn sheet(triangles: usize) -> Scene {
    let cells = ((triangles as f64 / 2.0).sqrt().round() as u32).max(1);
    let mut draft = Draft::new([30, 32, 36], camera());
    let mesh = draft.mesh(shapes::grid(cells));
    let card = draft.textured("test card", textures::test_card(TEXTURE_PX));
    draft.place("sheet", mesh, card, Mat4::from_scale_rotation_translation(Vec3::splat(2.0), upright(), Vec3::ZERO));
    draft.finish(&format!("sheet of {} triangles", 2 * cells as usize * cells as usize))
}

/// So many textured squares behind each other, each of which fills the picture, the farthest first.
pub fn layers(count: usize) -> Scene {
    /// Wide enough for a picture three times as wide as high.
    const EDGE: f32 = 24.0;
    /// From the farthest to the nearest, world units.
    const DEPTH: f32 = 2.0;
    let mut draft = Draft::new([30, 32, 36], camera());
    let mesh = draft.mesh(shapes::grid(1));
    let card = draft.textured("test card", textures::test_card(TEXTURE_PX));
    for layer in 0..count {
        let z = DEPTH * ((layer + 1) as f32 / count as f32 - 1.0);
        let place = Vec3::new(0.0, 0.0, z);
        draft.place(
            format!("layer {layer}"),
            mesh,
            card,
            Mat4::from_scale_rotation_translation(Vec3::splat(EDGE), upright(), place),
        );
    }
    draft.finish(&format!("{count} layers"))
}
