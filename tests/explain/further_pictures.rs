//! Depths and ids of the textbook renderer, in several mappings and numberings.

use rasterscope::explain::{Explanation, IdLevel, TheirBuffers};

use crate::SMALL;
use crate::judge::{explained_picture, image};
use crate::textbook::scene::Scene;
use crate::textbook::{Fault, Faults, render_with_buffers, scenes};

/// Largest number of pixels whose depths or ids may disagree because corners are rounded differently: 1 %.
const NOISE_PX: u64 = 144;

fn cubes() -> Scene {
    scenes::all().into_iter().find(|scene| scene.name == "cubes").unwrap()
}

/// Asks for the explanation of the textbook's picture of a scene with its depths, changed by a function.
fn with_depths(scene: &Scene, faults: &[Fault], change: impl Fn(f64) -> f64) -> Explanation {
    let drawn = render_with_buffers(scene, SMALL, Faults::new(faults));
    let depths = drawn.depths.iter().map(|depth| change(f64::from(*depth)) as f32).collect();
    let buffers = TheirBuffers { depth: Some(image(SMALL, depths)), ids: None };
    explained_picture(scene, &drawn.picture, &buffers)
}

#[test]
fn mappings_of_depths_are_named() {
    let scene = cubes();
    let (near, far) = (scene.camera.near, scene.camera.far);
    let distance = |z: f64| far * near / (far - z * (far - near));
    let mappings: [(&str, &dyn Fn(f64) -> f64); 5] = [
        ("0 at the near plane, 1 at the far plane", &|z| z),
        ("reversed, 1 at the near plane, 0 at the far plane", &|z| 1.0 - z),
        ("−1 at the near plane, 1 at the far plane (OpenGL)", &|z| 2.0 * z - 1.0),
        ("the distance along the line of sight", &distance),
        ("linear in the logarithm of the distance, falling with it", &|z| 3.0 - 0.2 * distance(z).ln()),
    ];
    for (name, mapping) in mappings {
        let found = with_depths(&scene, &[], mapping);
        let depth = found.depth.as_ref().unwrap();
        assert_eq!(depth.mapping.as_deref(), Some(name), "{found}");
        assert!(found.causes.is_empty() && depth.differing_after < NOISE_PX, "{found}");
    }
}

#[test]
fn few_bits_and_unknown_mappings_of_depths_are_reported() {
    let found = with_depths(&cubes(), &[Fault::Depth8], |z| z);
    assert_eq!(found.depth.as_ref().unwrap().bits, Some(8), "{found}");
    let found = with_depths(&cubes(), &[], |_| 0.5);
    assert_eq!(found.depth.as_ref().unwrap().mapping, None, "{found}");
}

#[test]
fn depths_confirm_a_fault() {
    let found = with_depths(&cubes(), &[Fault::DepthReversed], |z| z);
    let [cause] = &found.causes[..] else { panic!("{found}") };
    let depth = found.depth.as_ref().unwrap();
    assert_eq!(cause.fault.id, "depth-test-reversed");
    assert!(cause.depth.explained > 10 * NOISE_PX, "{found}");
    assert!(depth.differing_before > 10 * NOISE_PX && depth.differing_after < NOISE_PX, "{found}");
}

#[test]
fn ids_in_any_numbering_are_compared() {
    let scene = cubes();
    for faults in [&[][..], &[Fault::CullFront]] {
        let drawn = render_with_buffers(&scene, SMALL, Faults::new(faults));
        // A permutation of all numbers, because the factor is odd.
        let ids = drawn.objects.iter().map(|object| object.wrapping_mul(0x9E37_79B9)).collect();
        let buffers = TheirBuffers { depth: None, ids: Some(image(SMALL, ids)) };
        let found = explained_picture(&scene, &drawn.picture, &buffers);
        let report = found.ids.as_ref().unwrap();
        assert_eq!((found.causes.len(), report.level), (faults.len(), IdLevel::Objects), "{found}");
        assert!(report.differing_after < NOISE_PX, "{found}");
        assert!(faults.is_empty() || report.differing_before > NOISE_PX, "{found}");
    }
}
