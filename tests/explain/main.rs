//! Explanations of pictures by a renderer that shares no code with the engine: planted faults are named, and nothing
//! else is. `cargo bench --bench explanations` tries all faults and pairs in all scenes.

mod further_pictures;
mod judge;
mod textbook;

use judge::{explained, explained_picture, id, names_exactly};
use rasterscope::explain::{Confidence, Kind, TheirBuffers};
use textbook::scene::Scene;
use textbook::{Fault, Faults, Size, render, scenes};

/// Size of the pictures.
const SMALL: Size = Size { width: 160, height: 90 };

/// Step between the faults and scenes that are tried.
const STEP: usize = 4;

#[test]
fn correct_pictures_are_accused_of_nothing() {
    for scene in scenes::all().iter().step_by(STEP) {
        for faults in [&[][..], &[Fault::NoSnapping]] {
            let found = explained(scene, SMALL, faults);
            assert!(found.causes.is_empty(), "{}: {found}", scene.name);
        }
    }
}

#[test]
fn single_faults_are_named() {
    for fault in Fault::ALL.iter().copied().filter(|fault| id(*fault).is_some()).step_by(STEP) {
        let all = scenes::all();
        // The scenes take turns.
        let start = fault as usize % all.len();
        let order = all.iter().cycle().skip(start).take(all.len());
        let scene = order.into_iter().find(|scene| scene.faults().any(|visible| visible == fault)).unwrap();
        let found = explained(scene, SMALL, &[fault]);
        assert!(names_exactly(&found, &[fault]), "{}, {}: {found}", scene.name, fault.name());
    }
}

#[test]
fn pairs_of_faults_are_named() {
    for (turn, scene) in scenes::all().iter().enumerate().step_by(STEP) {
        let pair = scene.pairs[turn];
        let found = explained(scene, SMALL, &pair);
        assert!(names_exactly(&found, &pair), "{}, {pair:?}: {found}", scene.name);
    }
}

#[test]
fn unknown_faults_are_not_blamed_on_known_ones() {
    for (scene, fault) in scenes::all().iter().zip([Fault::Depth8, Fault::NormalsByModel]) {
        assert!(scene.faults().any(|visible| visible == fault));
        let found = explained(scene, SMALL, &[fault]);
        assert!(found.causes.is_empty(), "{}, {}: {found}", scene.name, fault.name());
    }
}

/// Returns the scene with a name.
fn scene(name: &str) -> Scene {
    scenes::all().into_iter().find(|scene| scene.name == name).unwrap()
}

#[test]
fn another_background_is_a_difference_of_inputs() {
    let asked = scene("cubes");
    for faults in [&[][..], &[Fault::FlipVertical, Fault::RedBlue]] {
        let drawn = Scene { background: [26, 200, 38], ..scene("cubes") };
        let picture = render(&drawn, SMALL, Faults::new(faults));
        let found = explained_picture(&asked, &picture, &TheirBuffers::default());
        let background = found.causes.iter().find(|cause| cause.fault.id == "background-colour");
        // The measured colour is that of the picture, in which red and blue may be swapped.
        let color = if faults.is_empty() { "#1ac826" } else { "#26c81a" };
        assert_eq!(background.and_then(|cause| cause.detail.as_deref()), Some(color), "{found}");
        assert_eq!(background.unwrap().fault.kind, Kind::Input);
        assert_eq!((found.causes.len(), found.confidence), (1 + faults.len(), Confidence::Complete), "{found}");
    }
}

#[test]
fn clipped_polygons_may_be_divided_in_other_ways() {
    for (name, fault) in [("gallery", Fault::Affine), ("cave", Fault::NoNearClip), ("gallery", Fault::NoNearClip)] {
        let scene = scene(name);
        if scene.faults().any(|visible| visible == fault) {
            let found = explained(&scene, SMALL, &[fault]);
            assert!(names_exactly(&found, &[fault]), "{name}, {}: {found}", fault.name());
        }
    }
}
