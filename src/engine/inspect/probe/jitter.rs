//! Jitter of positions by a few units in the last place.
//!
//! A position moves by multiples of one unit in the last place of its largest coordinate, which is about the rounding
//! error of computing the position. A zero coordinate therefore moves by as much as the others.

use glam::Vec3;

use super::Probe;
use crate::scene::mesh::MeshData;
use crate::scene::{Camera, Mesh, Scene};

/// Returns the jittered camera of run `run`. Eye and target move independently, by multiples of one unit in the last
/// place of the largest coordinate of the two positions.
pub(super) fn camera(camera: &Camera, probe: Probe, run: u16) -> Camera {
    let mut random = fastrand::Rng::with_seed(mixed(probe.seed, u64::from(run)));
    let unit = unit_of(camera.eye.abs().max(camera.target.abs()));
    let eye = moved(camera.eye, unit, probe.ulps, &mut random);
    let target = moved(camera.target, unit, probe.ulps, &mut random);
    let seen = Camera { eye, target, ..*camera };
    // Near the limits of the float range, the jittered camera may be invalid.
    if seen.check().is_ok() { seen } else { *camera }
}

/// Returns the scene with the jittered vertices of run `run`. Vertices at the same position move together, even in
/// different meshes, so seams stay closed.
pub(super) fn scene(scene: &Scene, probe: Probe, run: u16) -> Scene {
    let seed = mixed(probe.seed, u64::from(run));
    let library = scene.library.with_meshes(|mesh| {
        let positions = mesh.positions.iter().map(|position| vertex(*position, seed, probe.ulps)).collect();
        let data: &MeshData = mesh;
        // Positions stay finite and nothing else changes, so a valid mesh stays valid.
        Mesh::new(MeshData { positions, ..data.clone() }).unwrap_or_else(|_| mesh.clone())
    });
    // The meshes of the scene, which take most of its memory, are not cloned.
    Scene {
        name: scene.name.clone(),
        library,
        instances: scene.instances.clone(),
        background: scene.background,
        home: scene.home,
        views: scene.views.clone(),
        light: scene.light,
        animation: None,
    }
}

fn vertex(position: Vec3, seed: u64, ulps: u32) -> Vec3 {
    let place = position.to_array().iter().fold(seed, |seed, c| mixed(seed, u64::from(c.to_bits())));
    let moved = moved(position, unit_of(position.abs()), ulps, &mut fastrand::Rng::with_seed(place));
    if moved.is_finite() { moved } else { position }
}

/// Returns one unit in the last place of the largest of these magnitudes.
fn unit_of(magnitudes: Vec3) -> f32 {
    let largest = magnitudes.max_element();
    largest.next_up() - largest
}

/// Moves each coordinate by a random multiple of `unit`, with an integer factor uniformly distributed from −`ulps` to
/// `ulps`.
fn moved(position: Vec3, unit: f32, ulps: u32, random: &mut fastrand::Rng) -> Vec3 {
    let most = i64::from(ulps);
    // In f64 the sum is rounded only once, and is exact for the largest coordinate.
    position.as_dvec3().map(|c| c + f64::from(unit) * random.i64(-most..=most) as f64).as_vec3()
}

/// Mixes two numbers into a seed that depends on all their bits (the finalizer of Steele, Lea and Flood, "Fast
/// Splittable Pseudorandom Number Generators", 2014).
fn mixed(a: u64, b: u64) -> u64 {
    let mut z = (a ^ b.wrapping_mul(0x9E37_79B9_7F4A_7C15)).wrapping_add(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin;

    #[test]
    fn moves_are_whole_units_of_the_largest_coordinate_and_reach_both_ends() {
        let position = Vec3::new(3.0, 0.0, -0.25);
        let unit = 3.0_f32.next_up() - 3.0;
        let mut seen = [0; 5];
        for seed in 0..200 {
            let moved = vertex(position, seed, 2);
            for (new, old) in moved.to_array().into_iter().zip(position.to_array()) {
                let steps = (f64::from(new) - f64::from(old)) / f64::from(unit);
                assert!(steps.fract() == 0.0 && steps.abs() <= 2.0, "{old} to {new}: {steps}");
                seen[(steps + 2.0) as usize] += 1;
            }
        }
        assert!(seen.iter().all(|count| *count > 60), "{seen:?} of 600");
    }

    #[test]
    fn vertices_at_one_position_move_together_and_zero_ulps_move_nothing() {
        let (probe, still) = (Probe { ulps: 3, ..Probe::default() }, Probe { ulps: 0, ..Probe::default() });
        let cubes = builtin::by_id("cubes").unwrap().build();
        let (moved, same) = (scene(&cubes, probe, 5), scene(&cubes, still, 5));
        let mut places = std::collections::HashMap::new();
        let mut others = 0;
        for (mesh, new) in cubes.library.meshes().iter().zip(moved.library.meshes()) {
            for (old, new) in mesh.positions.iter().zip(&new.positions) {
                let first = places.entry(old.to_array().map(f32::to_bits)).or_insert(*new);
                assert_eq!(first, new);
                others += usize::from(old != new);
            }
        }
        assert!(others > 0);
        assert_eq!(same.library.meshes(), cubes.library.meshes());
        assert_eq!(camera(&cubes.home, still, 1), cubes.home);
        assert_ne!(camera(&cubes.home, probe, 1), cubes.home);
    }
}
