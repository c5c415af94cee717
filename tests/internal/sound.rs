//! Check of the properties that every loaded scene must have.

use glam::Vec3;
use rasterscope::scene::{DepthMapping, Loaded};

/// Checks that a loaded scene is not empty, that all its numbers are finite, and that normals have unit length. A
/// normal may be zero if a warning reports a normal in the file that is not finite.
pub(crate) fn sound(loaded: &Loaded) -> Result<(), String> {
    let scene = &loaded.scene;
    if scene.triangle_count() == 0 {
        return Err("an empty scene".to_owned());
    }
    let has_lost_normals = loaded.warnings.iter().any(|warning| warning.text.contains("normal that is not finite"));
    for mesh in scene.library.meshes() {
        let is_sound = |n: &Vec3| (n.length() - 1.0).abs() < 1e-4 || *n == Vec3::ZERO && has_lost_normals;
        if !mesh.normals.iter().all(is_sound) {
            return Err("a normal is no unit vector".to_owned());
        }
        let bounds = mesh.bounds();
        // A mesh without finite positions has an empty bounding box.
        let has_finite_box = bounds.is_empty() || (bounds.max - bounds.min).length_squared().is_finite();
        if !(has_finite_box && mesh.uvs.iter().all(|t| t.is_finite())) {
            return Err("extent or texture coordinates are not finite".to_owned());
        }
    }
    let matrix = scene.home.clip_from_world_f64(1.5, DepthMapping::STANDARD);
    if matrix.is_finite() { Ok(()) } else { Err("the first view is not finite".to_owned()) }
}
