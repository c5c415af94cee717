//! Asks for the explanation of a textbook picture, and judges the answer.

use std::path::Path;
use std::sync::Arc;

use rasterscope::chain::Recipe;
use rasterscope::explain::{Explanation, Query, Setup, TheirBuffers, explain_with};
use rasterscope::image::Image;
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::scene::{SceneSource, camera_file};

use crate::textbook::scene::Scene;
use crate::textbook::{Fault, Faults, Picture, Size, export, render};

/// Returns the id of the explanation that names a planted fault; `None` if the program knows no such fault, or if the
/// scene's file does not contain what it would need to know.
pub(crate) fn id(fault: Fault) -> Option<&'static str> {
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
pub(crate) fn explained(scene: &Scene, size: Size, faults: &[Fault]) -> Explanation {
    explained_picture(scene, &render(scene, size, Faults::new(faults)), &TheirBuffers::default())
}

/// Asks for the explanation of a picture, and of depths and ids, that should show a scene.
pub(crate) fn explained_picture(scene: &Scene, picture: &Picture, buffers: &TheirBuffers) -> Explanation {
    let folder = tempfile::tempdir().unwrap();
    export::write(scene, folder.path()).unwrap();
    let theirs = image(picture.size, picture.pixels.iter().map(|[r, g, b]| [*r, *g, *b, 255]).collect());
    let (width, height) = theirs.size();
    let correct = correct(folder.path(), Viewport { width, height });
    explain_with(&Query { correct, theirs, without: Vec::new() }, buffers, &|_| true).unwrap()
}

/// Returns an image of the program from values row by row.
pub(crate) fn image<T: Copy>(size: Size, values: Vec<T>) -> Image<T> {
    Image::from_pixels(size.width as u32, size.height as u32, values)
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

/// Returns whether an explanation names exactly the planted faults, except those that the program does not know. Faults
/// with equal pictures may stand for each other.
pub(crate) fn names_exactly(found: &Explanation, planted: &[Fault]) -> bool {
    let mut wanted: Vec<_> = planted.iter().filter_map(|fault| id(*fault)).collect();
    for cause in &found.causes {
        let is_named = |id: &&str| cause.fault.id == *id || cause.alternatives.iter().any(|fault| fault.id == *id);
        let Some(place) = wanted.iter().position(is_named) else { return false };
        wanted.remove(place);
    }
    wanted.is_empty()
}
