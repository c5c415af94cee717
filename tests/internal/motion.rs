//! Pictures of scenes in motion.

use std::sync::Arc;

use rasterscope::image::Rgba8;
use rasterscope::scene::{Scene, builtin};

use crate::internal::common::{recipe, render};

const SIZE: (u32, u32) = (96, 54);

/// Returns the fraction of pixels that differ by more than 8 codes between the pictures of two poses.
fn changed(a: &Scene, b: &Scene) -> f64 {
    let [a, b] = [a, b].map(|scene| render(scene, &recipe(&[]), SIZE).image().clone());
    let differs = |a: &Rgba8, b: &Rgba8| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > 8);
    let count = a.pixels().iter().zip(b.pixels()).filter(|(a, b)| differs(a, b)).count();
    count as f64 / a.pixels().len() as f64
}

#[test]
fn built_in_scenes_in_motion_change_and_loop_seamlessly() {
    let mut moving = 0;
    for scene in builtin::ALL.iter().map(|builtin| Arc::new(builtin.build())) {
        let Some(animation) = &scene.animation else { continue };
        moving += 1;
        let duration_s = animation.duration_s();
        // Less than a frame before the loop ends, the picture is that of its beginning, unless a material is exchanged.
        if animation.animation.materials.is_empty() {
            let seam = changed(&scene.at(duration_s - 1e-4), &scene);
            assert!(seam < 0.005, "{}: {seam} of the pixels change at the seam", scene.name);
        }
        let half = changed(&scene.at(duration_s * 0.45), &scene);
        assert!(half > 0.01, "{}: only {half} of the pixels change", scene.name);
    }
    assert!(moving >= 5, "{moving} scenes move");
}
