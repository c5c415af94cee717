//! Explanations of pictures by a renderer that shares no code with the engine: planted faults are named, and nothing
//! else is.
//!
//! `cargo test --release --test explain -- --ignored --nocapture` tries all faults and pairs in all scenes and prints a
//! table; the other tests try a few of them.

mod textbook;

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use rasterscope::chain::Recipe;
use rasterscope::explain::{Explanation, Query, Setup, explain};
use rasterscope::image::Image;
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::scene::{SceneSource, camera_file};
use textbook::scene::Scene;
use textbook::{Fault, Faults, Size, export, render, scenes};

/// Size of the pictures in quick tests.
const SMALL: Size = Size { width: 160, height: 90 };

/// Size of the pictures in the test of everything.
const LARGE: Size = Size { width: 640, height: 360 };

/// Step between the faults and scenes that are tried in quick tests.
const STEP: usize = 4;

/// Smallest shares of planted single faults and pairs that must be named, and nothing else with them.
const LEAST_NAMED: [f64; 2] = [0.9, 0.75];

/// Returns the id of the explanation that names a planted fault; `None` if the program knows no such fault, or if the
/// scene's file does not contain what it would need to know.
fn id(fault: Fault) -> Option<&'static str> {
    Some(match fault {
        Fault::FlipVertical => "flip-vertical",
        Fault::FlipHorizontal => "flip-horizontal",
        Fault::PixelCorners => "corner-samples",
        Fault::FillInclusive => "fill-inclusive",
        Fault::FillExclusive => "fill-exclusive",
        Fault::CullNone => "culling-none",
        Fault::CullFront => "culling-front",
        Fault::DepthReversed => "depth-test-reversed",
        Fault::DepthOff => "depth-test-off",
        Fault::Painter => "painters-algorithm",
        Fault::Depth16 => "depth-16-bit",
        Fault::Affine => "affine-interpolation",
        Fault::TextureTop => "texture-v-flipped",
        Fault::Clamp => "texture-clamped",
        Fault::Nearest => "filter-point",
        Fault::HalfTexel => "half-texel-offset",
        Fault::LightOnCodes => "srgb-lighting",
        Fault::NoEncoding => "no-srgb-encoding",
        Fault::LightNegated => "light-negated",
        Fault::NormalsNegated => "normals-negated",
        Fault::NormalsNotUnit => "normals-not-normalised",
        Fault::AspectIgnored => "aspect-ignored",
        Fault::AspectInverse => "aspect-inverted",
        Fault::FovHorizontal => "fov-horizontal",
        Fault::LeftHanded => "left-handed-view",
        Fault::NoNearClip => "near-plane-unclipped",
        Fault::Premultiplied => "alpha-not-multiplied",
        Fault::Truncated => "colour-truncated",
        Fault::RedBlue => "red-blue-swapped",
        // No depth format has 8 bits, an OBJ file has no transforms, and vertices may be rounded or not.
        Fault::Depth8 | Fault::NormalsUntransformed | Fault::NormalsByModel | Fault::NoSnapping => return None,
    })
}

/// Asks for the explanation of the textbook's picture of a scene.
fn explained(scene: &Scene, size: Size, faults: &[Fault]) -> Explanation {
    let folder = tempfile::tempdir().unwrap();
    export::write(scene, folder.path()).unwrap();
    let picture = render(scene, size, Faults::new(faults));
    let (width, height) = (size.width as u32, size.height as u32);
    let pixels = picture.pixels.iter().map(|[r, g, b]| [*r, *g, *b, 255]).collect();
    let theirs = Image::from_pixels(width, height, pixels);
    let correct = correct(folder.path(), Viewport { width, height });
    explain(&Query { correct, theirs, without: Vec::new() }, &|_| true).unwrap()
}

/// Returns our setup of the scene in a folder.
fn correct(folder: &Path, viewport: Viewport) -> Setup {
    let scene = SceneSource::named(folder.join("scene.obj")).load().unwrap().scene;
    let camera = camera_file::read(&folder.join("camera.json")).unwrap();
    let settings = std::fs::read_to_string(folder.join("settings.txt")).unwrap();
    let mut recipe = Recipe::default();
    recipe.set_all(&settings.lines().collect::<Vec<_>>()).unwrap();
    Setup::new(Arc::new(scene), camera, recipe, viewport)
}

/// Returns whether an explanation names exactly the planted faults. Faults with equal pictures may stand for each other.
fn names_exactly(found: &Explanation, planted: &[Fault]) -> bool {
    let mut wanted: Vec<_> = planted.iter().map(|fault| id(*fault)).collect();
    for cause in &found.causes {
        let is_named = |id: &Option<&str>| {
            id.is_some_and(|id| cause.fault.id == id || cause.alternatives.iter().any(|fault| fault.id == id))
        };
        let Some(place) = wanted.iter().position(is_named) else { return false };
        wanted.remove(place);
    }
    wanted.is_empty()
}

fn causes(found: &Explanation) -> String {
    let named: Vec<_> = found.causes.iter().map(|cause| cause.fault.id).collect();
    format!("{:?} [{}]", found.confidence, named.join(", "))
}

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

#[test]
#[ignore = "takes many minutes; prints a table"]
#[expect(clippy::print_stdout, reason = "the table is its result")]
fn all_faults_and_pairs_in_all_scenes() {
    let mut named = [[0_u32; 2]; 2];
    let mut seconds = Vec::new();
    for scene in scenes::all() {
        let singles = scene.faults().map(|fault| vec![fault]);
        let all = [Vec::new()].into_iter().chain(singles).chain(scene.pairs.iter().map(|pair| pair.to_vec()));
        for planted in all {
            let start = Instant::now();
            let found = explained(&scene, LARGE, &planted);
            seconds.push(start.elapsed().as_secs_f64());
            let is_known = planted.iter().all(|fault| id(*fault).is_some());
            let is_right = if is_known { names_exactly(&found, &planted) } else { found.causes.is_empty() };
            let names: Vec<_> = planted.iter().map(|fault| fault.name()).collect();
            let verdict = if is_right { "right" } else { "WRONG" };
            println!(
                "{verdict} {} [{}]: {}, {} px before, {} px after, {:.1} s",
                scene.name,
                names.join(", "),
                causes(&found),
                found.differing_before,
                found.differing_after,
                seconds[seconds.len() - 1]
            );
            match planted.len() {
                0 => assert!(is_right, "{}: {found}", scene.name),
                count => {
                    let [right, of] = &mut named[count - 1];
                    *right += u32::from(is_right);
                    *of += 1;
                }
            }
        }
    }
    seconds.sort_by(f64::total_cmp);
    println!(
        "named: {named:?}; median {:.1} s, longest {:.1} s",
        seconds[seconds.len() / 2],
        seconds[seconds.len() - 1]
    );
    for ([right, of], least) in named.into_iter().zip(LEAST_NAMED) {
        assert!(f64::from(right) >= least * f64::from(of), "{right} of {of}");
    }
}
