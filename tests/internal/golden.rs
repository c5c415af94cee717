//! Compares pictures with the golden images in `tests/golden`, which were inspected once and found correct. Every pixel
//! must be equal.
//!
//! A picture that differs is written to the target folder with its difference image, and the failure names both files.
//! A picture without a golden image fails, and so does a golden image without a picture. After an intended change,
//! renew them with `RASTERSCOPE_BLESS=1 cargo test golden::`, and inspect the changes before committing them.
//!
//! The golden images were made on x86-64 Linux with glibc. The pipeline itself uses basic IEEE arithmetic, which is the
//! same everywhere, but the sRGB tables, fields of view and some textures use `powf`, `tan` and `sin` of the platform's
//! library. On other platforms a code may differ by one.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::internal::common::{picture_in_motion, recipe, render};
use crate::internal::switches::{WITHOUT_EFFECT, switches_of};
use glam::Quat;
use rasterscope::chain::{Frame, KeepDepth, Recipe, RenderInputs, Renderer, SettingKey};
use rasterscope::image::{Image, Rgba8, file};
use rasterscope::inspect::buffers::{Buffer, capture};
use rasterscope::inspect::stages::{self, Stage};
use rasterscope::inspect::view;
use rasterscope::pipeline::settings::{Choice as _, DepthFormat, Shading};
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::scene::builtin::Builtin;
use rasterscope::scene::{Scene, builtin};
use rasterscope::upscale::{self, Scale, Upscaling};

const SIZE: (u32, u32) = (160, 100);

/// Factor that amplifies difference images, so that a difference of one code is visible.
const DIFFERENCE_GAIN: u8 = 32;

fn scene(id: &str) -> Scene {
    builtin::by_id(id).expect("a built-in scene").build()
}

fn image(scene: &Scene, recipe: &Recipe) -> Image<Rgba8> {
    render(scene, recipe, SIZE).image().clone()
}

/// Returns every picture that has a golden image, with the file name of that image without extension.
fn pictures() -> Vec<(String, Image<Rgba8>)> {
    // Scenes in motion are shown at a time at which they differ from still ones.
    let posed = |builtin: &builtin::Builtin| Arc::new(builtin.build()).at(0.4);
    let mut pictures: Vec<_> =
        builtin::ALL.iter().map(|b| (b.id.to_owned(), image(&posed(b), &Recipe::default()))).collect();
    pictures.extend(switches());
    pictures.extend(strips());
    pictures.extend(shadings());
    pictures.extend(depth_formats());
    pictures.extend(upscalers());
    pictures.extend(buffers());
    pictures.extend(stages());
    pictures
}

/// Settings whose values are shown by larger pictures of their own instead of a strip.
const WITHOUT_STRIP: [SettingKey; 3] = [SettingKey::DepthFormat, SettingKey::Shading, SettingKey::UpscalerMethod];

/// Size of each picture in a strip.
const SIZE_IN_STRIP: Viewport = Viewport { width: 48, height: 30 };

/// Returns a strip for every setting that changes pictures.
fn strips() -> impl Iterator<Item = (String, Image<Rgba8>)> {
    let apart = |key: &&SettingKey| WITHOUT_STRIP.contains(key) || WITHOUT_EFFECT.contains(key);
    SettingKey::ALL.iter().filter(move |key| !apart(key)).map(|key| (format!("setting.{}", key.id()), strip(*key)))
}

/// Returns the pictures of all values of a setting beside each other, of the first built-in scene in which they differ.
fn strip(key: SettingKey) -> Image<Rgba8> {
    let recipes = switches_of(key);
    let of_scene = |builtin: &Builtin| {
        let scene = Arc::new(builtin.build());
        recipes.iter().map(|recipe| picture_in_motion(&scene, recipe, SIZE_IN_STRIP)).collect::<Vec<_>>()
    };
    let pictures =
        builtin::ALL.iter().map(of_scene).find(|pictures| pictures.iter().any(|other| *other != pictures[0]));
    let pictures = pictures.unwrap_or_else(|| panic!("{} changes no picture", key.id()));
    let Viewport { width, height } = SIZE_IN_STRIP;
    Image::from_fn(width * pictures.len() as u32, height, |x, y| pictures[(x / width) as usize].at(x % width, y))
}

/// Returns larger pictures with a single changed setting, each of a scene that shows its effect.
fn switches() -> impl Iterator<Item = (String, Image<Rgba8>)> {
    [
        ("chess", "interpolation=affine"),
        ("chess", "filter=point"),
        ("chess", "filter=trilinear"),
        ("chess", "filter=anisotropic"),
        ("chess", "culling=front"),
        ("chess", "color-space=bytes"),
        ("chess", "wireframe=true"),
        ("chess", "antialias.method=regular"),
        ("chess", "antialias.method=jittered"),
        ("chess", "antialias.method=rotated-grid"),
        ("chess", "antialias.method=low-discrepancy"),
        ("chess", "antialias.method=multisample"),
        ("chess", "post.filter=fxaa"),
        ("chess", "post.filter=smaa"),
        ("chess", "post.filter=gaussian"),
        ("chess", "post.filter=sharpen"),
        ("cubes", "depth-test=greater"),
        ("interpenetrating", "depth-test=off"),
        ("stained-glass", "filter=point"),
        ("stained-glass", "color-space=bytes"),
        ("stained-glass", "depth-test=off"),
        ("stained-glass", "alpha=premultiplied"),
        ("polished", "shading=normals"),
    ]
    .into_iter()
    .map(|(id, switch)| with_switch(id, switch))
}

/// Returns the picture of a scene with a single changed setting, and its name.
fn with_switch(id: &str, switch: &str) -> (String, Image<Rgba8>) {
    (format!("{id}.{}", switch.replace('=', "-")), image(&scene(id), &recipe(&[switch])))
}

/// Scene that shows a shading, unless it is [`SCENE_OF_SHADINGS`].
const SCENES_OF_SHADINGS: [(Shading, &str); 7] = [
    (Shading::Texture, "cel"),
    (Shading::VertexColor, "triangle"),
    (Shading::BlinnPhong, "polished"),
    (Shading::Cel, "cel"),
    (Shading::Checker, "near-plane"),
    (Shading::Barycentric, "triangle"),
    (Shading::TriangleId, "interpenetrating"),
];

/// Scene that shows all shadings except those in [`SCENES_OF_SHADINGS`].
const SCENE_OF_SHADINGS: &str = "chess";

/// Returns a picture with every shading except the default.
fn shadings() -> impl Iterator<Item = (String, Image<Rgba8>)> {
    let others = Shading::ALL.iter().filter(|shading| **shading != Recipe::default().pipeline.shading);
    others.map(|shading| {
        let own = SCENES_OF_SHADINGS.iter().find(|(of, _)| of == shading).map(|(_, id)| *id);
        with_switch(own.unwrap_or(SCENE_OF_SHADINGS), &format!("shading={}", shading.id()))
    })
}

/// Returns a picture with every depth format except the default, of the scene where they differ most.
fn depth_formats() -> impl Iterator<Item = (String, Image<Rgba8>)> {
    let z_fighting = scene("z-fighting");
    DepthFormat::ALL.iter().filter(|format| **format != DepthFormat::F32).map(move |format| {
        let mut recipe = Recipe::default();
        recipe.pipeline.depth_format = *format;
        (format!("z-fighting.depth-format-{}", format.id()), image(&z_fighting, &recipe))
    })
}

/// Ids of upscalers whose first frame, which has no history, equals the picture of another upscaler.
const FIRST_FRAME_OF_ANOTHER: [&str; 1] = ["checkerboard-temporal"];

/// Returns a picture of every upscaler at its largest scale, and one with history of those that read earlier frames.
fn upscalers() -> Vec<(String, Image<Rgba8>)> {
    let chess = Arc::new(scene("chess"));
    let mut pictures = Vec::new();
    for method in upscale::BUILT_IN.iter().filter(|upscaler| upscaler.id() != "native") {
        let id = method.id();
        let upscaler = Upscaling::new(id, Scale::FOUR).expect("an upscaler of the registry");
        let recipe = Recipe { upscaler, ..Recipe::default() };
        let name = format!("chess.{id}-{}", upscaler.scale());
        if method.reads().history {
            pictures.push((format!("{name}.history"), image_with_history(&chess, &recipe)));
        }
        if !FIRST_FRAME_OF_ANOTHER.contains(&id) {
            pictures.push((name, image(&chess, &recipe)));
        }
    }
    pictures
}

/// Number of frames that are drawn for a picture with history.
const FRAMES: u8 = 4;

/// Angle by which the camera orbits between two frames of a picture with history, in degrees.
const DEGREES_PER_FRAME: f32 = 0.5;

/// Returns the last of [`FRAMES`] frames drawn by one renderer, while the camera orbits its target and ends in the home
/// view.
fn image_with_history(scene: &Arc<Scene>, recipe: &Recipe) -> Image<Rgba8> {
    let viewport = Viewport { width: SIZE.0, height: SIZE.1 };
    let mut renderer = Renderer::default();
    let mut last = None;
    for frames_left in (0..FRAMES).rev() {
        let angle = (-DEGREES_PER_FRAME * f32::from(frames_left)).to_radians();
        let mut camera = scene.home;
        camera.eye = camera.target + Quat::from_rotation_y(angle) * (camera.eye - camera.target);
        last = Some(renderer.render(RenderInputs { scene, camera: &camera, recipe, viewport }, KeepDepth::Yes));
    }
    last.expect("at least one frame").image().clone()
}

/// Returns pictures of buffers as the window shows them.
fn buffers() -> Vec<(String, Image<Rgba8>)> {
    let picture = |(id, buffer): (&str, Buffer), name: &str| {
        let (scene, recipe) = (scene(id), Recipe::default());
        let frame: Frame = render(&scene, &recipe, SIZE);
        let buffers = capture(&scene, &recipe, &frame);
        let range = view::range(buffer, &frame, Some(&buffers));
        (format!("{id}.buffer-{name}"), view::picture(buffer, &frame, Some(&buffers), range))
    };
    vec![
        picture(("chess", Buffer::Depth), "depth"),
        picture(("chess", Buffer::Overdraw), "overdraw"),
        picture(("triangle", Buffer::PerspectiveLambda), "perspective-lambda"),
        picture(("triangle", Buffer::Lambda), "lambda"),
    ]
}

/// Returns pictures of three stages before the finished frame.
fn stages() -> impl Iterator<Item = (String, Image<Rgba8>)> {
    let (scene, recipe) = (scene("near-plane"), Recipe::default());
    let frame = render(&scene, &recipe, SIZE);
    [("clip", Stage::Clip), ("project", Stage::Project), ("cull", Stage::Cull)].into_iter().map(move |(name, stage)| {
        (format!("near-plane.stage-{name}"), stages::picture(&scene, &scene.home, &recipe, &frame, stage))
    })
}

fn golden_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/golden")
}

/// Describes how a picture differs from its golden image; `None` if they are equal. Writes a wrong picture and its
/// difference image to a temporary folder.
fn complaint(name: &str, actual: &Image<Rgba8>) -> Option<String> {
    let golden = golden_folder().join(format!("{name}.png"));
    let aside = std::env::temp_dir().join("rasterscope-golden");
    let written = |kind: &str, image: &Image<Rgba8>| {
        let path = aside.join(format!("{name}.{kind}.png"));
        fs::create_dir_all(&aside).expect("a temporary folder that can be written");
        file::write_png(&path, image).expect("a temporary folder that can be written");
        path.display().to_string()
    };
    let expected = match file::read(&golden) {
        Ok(expected) => expected,
        Err(e) => return Some(format!("{e}; the picture is {}", written("actual", actual))),
    };
    if expected == *actual {
        return None;
    }
    if expected.size() != actual.size() {
        return Some(format!("{name}: {:?} px instead of {:?}", actual.size(), expected.size()));
    }
    let differing = expected.pixels().iter().zip(actual.pixels()).filter(|(e, a)| e != a).count();
    let difference = Image::from_fn(actual.width(), actual.height(), |x, y| {
        let (e, a) = (expected.at(x, y), actual.at(x, y));
        let [r, g, b] = [0, 1, 2].map(|i| e[i].abs_diff(a[i]).saturating_mul(DIFFERENCE_GAIN));
        [r, g, b, 255]
    });
    let (actual, difference) = (written("actual", actual), written("difference", &difference));
    Some(format!("{name}: {differing} pixels differ; compare {actual} and {difference}"))
}

#[test]
fn every_picture_equals_its_golden_and_every_golden_has_a_picture() {
    let pictures = pictures();
    if std::env::var_os("RASTERSCOPE_BLESS").is_some() {
        for (name, image) in &pictures {
            file::write_png(&golden_folder().join(format!("{name}.png")), image).expect("goldens can be written");
        }
    }
    let mut complaints: Vec<_> = pictures.iter().filter_map(|(name, image)| complaint(name, image)).collect();

    let names: BTreeSet<_> = pictures.iter().map(|(name, _)| format!("{name}.png")).collect();
    assert_eq!(names.len(), pictures.len(), "two pictures have the same name");
    let files = fs::read_dir(golden_folder()).expect("there are goldens");
    let files = files.map(|f| f.expect("a readable folder").file_name().to_string_lossy().into_owned());
    complaints.extend(files.filter(|f| !names.contains(f)).map(|f| format!("{f} belongs to no picture")));
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}

/// Checks that no two golden images are equal, because the second one would be redundant.
#[test]
fn no_two_goldens_are_equal() {
    let mut names = BTreeMap::new();
    for file in fs::read_dir(golden_folder()).expect("there are goldens") {
        let path = file.expect("a readable folder").path();
        let bytes = fs::read(&path).expect("a readable golden");
        if let Some(other) = names.insert(bytes, path.clone()) {
            panic!("{} and {} are equal", path.display(), other.display());
        }
    }
}
