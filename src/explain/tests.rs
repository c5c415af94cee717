//! Tests of the search on our own drawings: every fault is found, no fault is invented.

use std::collections::HashSet;
use std::sync::Arc;

use rasterscope_engine::chain::{Recipe, Renderer};
use rasterscope_engine::image::{Image, Rgba8};
use rasterscope_engine::pipeline::viewport::Viewport;
use rasterscope_engine::scene::builtin;

use crate::agreement::{Rounding, TOLERANCE, differences};
use crate::buffers::TheirBuffers;
use crate::fault::Change;
use crate::setup::{OutputChange, PixelChange};
use crate::window::Window;
use crate::{ALL, Confidence, ExplainError, Explanation, Kind, Query, Setup, by_id, explain, explain_with};

const SIZE: Viewport = Viewport { width: 96, height: 54 };

fn correct(scene: &str) -> Setup {
    let scene = Arc::new(builtin::by_id(scene).unwrap().build());
    Setup::new(Arc::clone(&scene), scene.home, Recipe::default(), SIZE)
}

fn drawn(setup: &Setup) -> Image<Rgba8> {
    setup.draw(&mut Renderer::default())
}

fn explained(correct: &Setup, theirs: Image<Rgba8>, without: &[&str]) -> Explanation {
    let without = without.iter().map(|id| (*id).to_owned()).collect();
    explain(&Query { correct: correct.clone(), theirs, without }, &|_| true).unwrap()
}

fn ids_of(found: &Explanation) -> Vec<&'static str> {
    found.causes.iter().map(|cause| cause.fault.id).collect()
}

#[test]
fn ids_are_unique_and_settings_are_valid() {
    let mut seen = HashSet::new();
    for fault in ALL.iter() {
        assert!(seen.insert(fault.id), "{} twice", fault.id);
        assert_eq!(by_id(fault.id).unwrap().name, fault.name);
        if let Change::Settings(assignments) = fault.change {
            let mut recipe = Recipe::default();
            assert_eq!(recipe.set_all(assignments), Ok(()), "{}", fault.id);
        }
    }
    assert!(by_id("gremlins").is_none());
}

#[test]
fn an_equal_picture_needs_no_explanation() {
    for scene in ["chess", "stained-glass"] {
        let correct = correct(scene);
        let found = explained(&correct, drawn(&correct), &[]);
        assert_eq!((ids_of(&found), found.confidence), (vec![], Confidence::Agrees), "{scene}");
        assert_eq!((found.differing_before, found.rest.len()), (0, 0));
    }
}

#[test]
fn single_faults_and_pairs_are_found() {
    for (scene, planted) in [
        ("chess", vec!["srgb-lighting"]),
        ("chess", vec!["colour-truncated"]),
        ("stained-glass", vec!["alpha-multiplied-twice"]),
        ("cubes", vec!["texture-v-flipped", "no-srgb-encoding"]),
    ] {
        let correct = correct(scene);
        let faults = planted.iter().map(|id| by_id(id).unwrap());
        let theirs = match planted[..] {
            ["colour-truncated"] => truncated(&drawn(&correct)),
            _ => drawn(&correct.with(faults)),
        };
        let found = explained(&correct, theirs, &[]);
        let (mut named, mut planted) = (ids_of(&found), planted);
        named.sort_unstable();
        planted.sort_unstable();
        assert_eq!((named, found.confidence), (planted, Confidence::Complete), "{scene}: {found}");
        assert_eq!(found.differing_after, 0, "{scene}: {found}");
    }
}

/// Returns the picture with every second code one lower, as truncation does on average.
fn truncated(picture: &Image<Rgba8>) -> Image<Rgba8> {
    let mut random = fastrand::Rng::with_seed(7);
    picture.map(|[r, g, b, a]| {
        let [r, g, b] = [r, g, b].map(|code| code.saturating_sub(random.u8(..2)));
        [r, g, b, a]
    })
}

#[test]
fn an_unknown_fault_is_not_blamed_on_a_known_one() {
    let correct = correct("cubes");
    let mut theirs = drawn(&correct);
    for (x, y) in (20..50).flat_map(|x| (15..40).map(move |y| (x, y))) {
        theirs.set(x, y, [(x * 3) as u8, (y * 4) as u8, (x ^ y) as u8, 255]);
    }
    let found = explained(&correct, theirs, &[]);
    assert_eq!((ids_of(&found), found.confidence), (vec![], Confidence::Unknown), "{found}");
    assert_eq!(found.rest.iter().map(|rest| rest.pixels).sum::<u64>(), found.differing_before);
    assert!(found.rest.len() > 1 && found.to_string().contains("unexplained:"));
}

#[test]
fn a_fault_that_is_left_out_is_not_blamed_on_another_one() {
    for (scene, planted) in [("cubes", "depth-test-reversed"), ("chess", "affine-interpolation")] {
        let correct = correct(scene);
        let theirs = drawn(&correct.with([by_id(planted).unwrap()]));
        let found = explained(&correct, theirs, &[planted]);
        assert_ne!(found.confidence, Confidence::Complete, "{scene}, {planted}: {found}");
    }
}

#[test]
fn faults_with_equal_pictures_are_named_together() {
    let correct = correct("cubes");
    let theirs = drawn(&correct.with([by_id("normals-negated").unwrap()]));
    let found = explained(&correct, theirs, &[]);
    assert_eq!(ids_of(&found), ["light-negated"]);
    assert_eq!(found.causes[0].alternatives.iter().map(|fault| fault.id).collect::<Vec<_>>(), ["normals-negated"]);
}

#[test]
fn another_size_and_an_interruption_are_errors() {
    let correct = correct("triangle");
    let theirs = Image::filled(10, 10, [0; 4]);
    let query = Query { correct: correct.clone(), theirs, without: Vec::new() };
    assert_eq!(explain(&query, &|_| true).unwrap_err(), ExplainError::Size { theirs: (10, 10), ours: (96, 54) });
    let query = Query { theirs: drawn(&correct), ..query };
    assert_eq!(explain(&query, &|_| false).unwrap_err(), ExplainError::Interrupted);
}

#[test]
fn another_background_is_measured_and_named() {
    let correct = correct("cubes");
    let mut changed = correct.clone();
    changed.recipe.set_all(&["background=#102030"]).unwrap();
    for (flips, color) in [(vec![], "#102030"), (vec!["flip-vertical", "red-blue-swapped"], "#302010")] {
        let theirs = drawn(&changed.with(flips.iter().map(|id| by_id(id).unwrap())));
        let found = explained(&correct, theirs, &[]);
        let background = found.causes.iter().find(|cause| cause.fault.kind == Kind::Input).expect("it is named");
        assert_eq!((background.fault.id, background.detail.as_deref()), ("background-colour", Some(color)), "{found}");
        assert_eq!(background.settings(), Some(vec![format!("background={color}")]));
        assert_eq!((found.causes.len(), found.differing_after), (1 + flips.len(), 0), "{found}");
    }
}

#[test]
fn a_window_shows_the_pixels_of_the_whole_picture() {
    let viewport = Viewport { width: 400, height: 300 };
    let window = Window { x: 96, y: 160, width: 128, height: 96 };
    let correct = Setup { viewport, ..correct("chess") };
    for ids in [
        &[][..],
        &["flip-vertical", "flip-horizontal"],
        &["left-handed-view", "corner-samples"],
        &["aspect-inverted", "flip-vertical"],
        &["upscaled-bilinear-2"],
        &["fxaa", "msaa-4"],
    ] {
        let setup = correct.with(ids.iter().map(|id| by_id(id).unwrap()));
        let part = setup.draw_window(&mut Renderer::default(), window);
        let differing = differences(&window.of(&drawn(&setup)), &part, Rounding::Nearest);
        let count = differing.pixels().iter().filter(|difference| **difference > TOLERANCE).count();
        // Vertices are rounded to 1/256 px after another matrix product.
        assert!(count <= 24, "{ids:?}: {count} px");
    }
}

#[test]
fn a_large_picture_is_searched_in_windows_where_it_differs() {
    let viewport = Viewport { width: 1024, height: 640 };
    let differing = Image::from_fn(1024, 640, |x, y| if x > 700 && y > 400 { 9 } else { u8::from(x == 0) });
    let windows = Window::sample(viewport, &differing.map(|code| code > TOLERANCE));
    assert!(windows.len() > 1 && windows.iter().all(|w| w.x + w.width <= 1024 && w.y + w.height <= 640));
    assert!(windows.iter().any(|window| window.of(&differing).pixels().iter().all(|code| *code == 9)));
    assert_eq!(Window::sample(SIZE, &Image::filled(96, 54, true)), [Window::whole(SIZE)]);

    let correct = Setup { viewport, ..correct("cubes") };
    let planted = ["texture-v-flipped", "depth-test-reversed"];
    let theirs = drawn(&correct.with(planted.map(|id| by_id(id).unwrap())));
    // Few candidates, so that the test is quick.
    let is_left_out = |id: &&str| !planted.contains(id) && !["unlit", "flip-vertical"].contains(id);
    let without: Vec<_> = ALL.iter().map(|fault| fault.id).filter(is_left_out).collect();
    let found = explained(&correct, theirs, &without);
    assert_eq!((found.causes.len(), found.differing_after), (2, 0), "{found}");
}

#[test]
fn depths_and_ids_tell_what_colours_do_not() {
    let mut correct = correct("cubes");
    correct.output.push(OutputChange::Pixel(PixelChange { apply: |_| [0, 0, 0, 255], undo: |pixel| pixel }));
    let reversed = correct.with([by_id("depth-test-reversed").unwrap()]);
    let query = Query { correct: correct.clone(), theirs: drawn(&reversed), without: Vec::new() };
    assert_eq!(explain(&query, &|_| true).unwrap().confidence, Confidence::Agrees);

    let whole = Window::whole(SIZE);
    let all = Image::filled(SIZE.width, SIZE.height, 0.0);
    let request = TheirBuffers { depth: Some(all.clone()), ids: Some(all.map(|_| 0)) }.target(&[whole]);
    let ours = reversed.draw_buffers(&mut Renderer::default(), whole, &request);
    let depth = Image::from_pixels(SIZE.width, SIZE.height, ours.distances);
    let ids = Image::from_pixels(SIZE.width, SIZE.height, ours.triangles).map(u32::from_le_bytes);
    for buffers in [TheirBuffers { depth: Some(depth), ids: None }, TheirBuffers { depth: None, ids: Some(ids) }] {
        let found = explain_with(&query, &buffers, &|_| true).unwrap();
        assert_eq!(ids_of(&found), ["depth-test-reversed"], "{found}");
        let after = found.depth.as_ref().map(|depth| depth.differing_after);
        assert_eq!(after.or(found.ids.as_ref().map(|ids| ids.differing_after)), Some(0), "{found}");
    }
}

/// Returns the setup of a scene with only its first object.
fn first_object(scene: &str) -> Setup {
    let mut scene = builtin::by_id(scene).unwrap().build();
    scene.instances.truncate(1);
    let scene = Arc::new(scene);
    Setup::new(Arc::clone(&scene), scene.home, Recipe::default(), SIZE)
}

#[test]
fn two_faults_that_hide_each_other_are_found() {
    let correct = first_object("missing-texture");
    let [culling, test] = ["culling-none", "depth-test-off"].map(|id| by_id(id).unwrap());
    let ours = drawn(&correct);
    assert!(
        drawn(&correct.with([culling])) == ours && drawn(&correct.with([test])) == ours,
        "each one changes nothing"
    );
    let theirs = drawn(&correct.with([culling, test]));
    assert!(theirs != ours);
    let found = explained(&correct, theirs, &[]);
    let mut named = ids_of(&found);
    named.sort_unstable();
    assert_eq!((named, found.differing_after), (vec!["culling-none", "depth-test-off"], 0), "{found}");
}

#[test]
fn a_spot_of_few_pixels_is_no_rounding() {
    let correct = correct("chess");
    let ours = drawn(&correct);
    let is_spot = |x: u32, y: u32| (70..75).contains(&x) && (3..8).contains(&y);
    let spotted = Image::from_fn(96, 54, |x, y| if is_spot(x, y) { [255, 0, 255, 255] } else { ours.at(x, y) });
    let found = explained(&correct, spotted, &[]);
    assert_eq!(
        (ids_of(&found), found.confidence, found.differing_before),
        (vec![], Confidence::Unknown, 25),
        "{found}"
    );
}

#[test]
fn scattered_pixels_and_lines_are_rounding() {
    let correct = correct("chess");
    let ours = drawn(&correct);
    let differs = |x: u32, y: u32| (x, y) == (5, 40) || (x, y) == (80, 9) || (y == 3 && (20..40).contains(&x));
    let other = Image::from_fn(96, 54, |x, y| if differs(x, y) { [255, 0, 255, 255] } else { ours.at(x, y) });
    let found = explained(&correct, other, &[]);
    assert_eq!((found.confidence, found.differing_before), (Confidence::Agrees, 22), "{found}");
    assert_eq!(found.summary(), "The picture agrees with ours, except for 22 scattered px.");
}

#[test]
fn a_picture_of_another_scene_is_not_accused_of_drawing_nothing() {
    let theirs = drawn(&correct("cubes"));
    let found = explained(&correct("chess"), theirs, &[]);
    assert!(!ids_of(&found).contains(&"depth-not-cleared"), "{found}");
    assert!(!matches!(found.confidence, Confidence::Complete | Confidence::Agrees), "{found}");
}
