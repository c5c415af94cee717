//! Scenes that show faults. Each file builds one.

mod cards;
mod cave;
mod cubes;
mod gallery;
mod knot;
mod panes;

use glam::{DAffine3, DQuat, DVec3};

use super::scene::Scene;

/// Returns all scenes.
pub(crate) fn all() -> Vec<Scene> {
    vec![cubes::scene(), knot::scene(), cards::scene(), panes::scene(), gallery::scene(), cave::scene()]
}

/// Returns a transformation that scales, then turns by `turn` degrees about `axis`, then moves to `position`.
fn placed(scale: DVec3, axis: DVec3, turn: f64, position: DVec3) -> DAffine3 {
    let rotation = DQuat::from_axis_angle(axis.normalize(), turn.to_radians());
    DAffine3::from_scale_rotation_translation(scale, rotation, position)
}

#[cfg(test)]
mod tests {
    use super::super::{Fault, Faults, Picture, Size, render};
    use super::*;

    const SIZE: Size = Size { width: 160, height: 90 };

    /// Smallest number of differing pixels of a visible fault. No count lies between 8 and 12.
    const VISIBLE: usize = 10;

    /// Returns the number of visibly different pixels: by more than 2 codes, or by any for truncation.
    fn differing(a: &Picture, b: &Picture, faults: &[Fault]) -> usize {
        a.differing(b, if faults.contains(&Fault::Truncated) { 0 } else { 2 })
    }

    #[test]
    fn exactly_the_faults_not_listed_as_invisible_are_visible() {
        for scene in all() {
            let correct = render(&scene, SIZE, Faults::default());
            for &fault in Fault::ALL {
                let count = differing(&correct, &render(&scene, SIZE, Faults::new(&[fault])), &[fault]);
                let listed = scene.invisible.contains(&fault);
                assert_eq!(count < VISIBLE, listed, "{} {}: {count} pixels", scene.name, fault.name());
            }
        }
    }

    #[test]
    fn both_faults_of_a_pair_are_visible() {
        for scene in all() {
            for pair in scene.pairs {
                let both = render(&scene, SIZE, Faults::new(pair));
                for [kept, missing] in [*pair, [pair[1], pair[0]]] {
                    let one = render(&scene, SIZE, Faults::new(&[kept]));
                    let count = differing(&both, &one, &[missing]);
                    assert!(count >= VISIBLE, "{} {pair:?} without {missing:?}: {count} pixels", scene.name);
                }
            }
        }
    }
}
