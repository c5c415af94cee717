//! Scenes of any size for scaling measurements, with a given number of triangles or of overlapping layers.

use glam::{Mat4, Quat, Vec3};

use super::draft::SceneDraft;
use super::{shapes, textures};
use crate::scene::{Camera, Scene};

/// Side length of the texture, in texels.
const TEXTURE_PX: u32 = 256;

/// Returns the camera of the workload scenes. A square of edge length 2 around the origin fits into any picture that is
/// at least as wide as it is high.
fn camera() -> Camera {
    Camera { near: 0.5, far: 20.0, ..Camera::look_at(Vec3::new(0.0, 0.0, 3.2), Vec3::ZERO) }
}

/// Returns the rotation that turns a horizontal, upward-facing square upright, so that it faces the camera.
fn upright() -> Quat {
    Quat::from_rotation_x(std::f32::consts::FRAC_PI_2)
}

/// Returns a scene of a textured square made of about `triangles` triangles, all of them in view. The exact number is
/// twice a square number.
pub(crate) fn sheet(triangles: usize) -> Scene {
    let cells = ((triangles as f64 / 2.0).sqrt().round() as u32).max(1);
    let mut draft = SceneDraft::new([30, 32, 36], camera());
    let mesh = draft.mesh(shapes::grid(cells));
    let card = draft.textured("test card", textures::test_card(TEXTURE_PX));
    draft.place("sheet", mesh, card, Mat4::from_scale_rotation_translation(Vec3::splat(2.0), upright(), Vec3::ZERO));
    draft.finish(&format!("sheet of {} triangles", 2 * cells as usize * cells as usize))
}

/// Returns a scene of `count` textured squares, one behind the other. Each square fills the picture, and the farthest
/// is drawn first.
pub(crate) fn layers(count: usize) -> Scene {
    /// Edge length of a square, in world units. It fills a picture that is up to three times as wide as it is high.
    const EDGE: f32 = 24.0;
    /// Distance from the farthest to the nearest square, in world units.
    const DEPTH: f32 = 2.0;
    let mut draft = SceneDraft::new([30, 32, 36], camera());
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
