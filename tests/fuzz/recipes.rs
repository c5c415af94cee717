//! Fuzz target: random settings on random small scenes, drawn in classic and tiled execution, and replayed.

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use fastrand::Rng;
use glam::{Mat4, Vec3};
use rasterscope::chain::Recipe;
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::scene::{Camera, Scene, camera_file};

use crate::fuzz::driver::{Failure, LIMIT, Target};
use crate::fuzz::input::Input;
use crate::fuzz::mutate::{pick, word};
use crate::fuzz::{equal, strings};
use crate::internal::scene_builder::{SceneBuilder, in_cube, mesh, noise_texture, with_alpha};

/// Name of the input file that contains scene, views and settings.
const FILE: &str = "scene.txt";

/// Approximate number of replayed pixels per frame; few, because with a post filter each replay includes all pixels
/// under its mask.
const REPLAYED: u32 = 10;

/// Alpha codes of textures, by the keyword of the texture in the file.
const ALPHA: [(&str, &[u8]); 3] = [("opaque", &[255]), ("binary", &[0, 255]), ("graded", &[0, 90, 200, 255])];

/// Fuzz target that draws random scenes with random settings.
pub(crate) struct Recipes;

impl Target for Recipes {
    fn name(&self) -> &'static str {
        "recipes"
    }

    /// Returns a longer limit, because a view is drawn about ten times, with up to 256 samples per pixel.
    fn limit(&self) -> Duration {
        LIMIT * 5
    }

    fn generate(&self, rng: &mut Rng) -> Input {
        let mut lines = vec![format!("size {} {}", rng.u32(1..48), rng.u32(1..32))];
        for _ in 0..2 {
            lines.push(format!("camera {}", camera_file::text(&camera(rng))));
        }
        for _ in 0..rng.u8(1..4) {
            let opacity = *pick(rng, &[1.0, 1.0, 0.4, 0.0]);
            let texture = word(rng, &["none", "none", "opaque", "binary", "graded"]);
            lines.push(format!("object {opacity} {texture}"));
            for _ in 0..rng.u8(1..8) {
                lines.push(triangle(rng));
            }
        }
        lines.extend(settings(rng).iter().map(|setting| format!("set {setting}")));
        Input::file(FILE, lines.join("\n") + "\n")
    }

    fn run(&self, folder: &Path) -> Result<(), Failure> {
        let text = std::fs::read_to_string(folder.join(FILE)).unwrap_or_default();
        let Some(View { scene, cameras: [first, second], recipe, size }) = View::parse(&text) else { return Ok(()) };
        equal::check(&scene, &first, &recipe, size)?;
        equal::check_second_frame(&scene, [&first, &second], &recipe, size)?;
        let step = (size.width * size.height).div_ceil(REPLAYED) as usize;
        equal::check_replay(&scene, &first, &recipe, size, step)
    }
}

/// Returns a random camera that looks at the scene, sometimes from inside it or from far away.
fn camera(rng: &mut Rng) -> Camera {
    let distance = *pick(rng, &[0.5, 2.0, 3.0, 3.0, 50.0]);
    let mut camera = Camera::look_at(in_cube(rng) * distance, in_cube(rng) * 0.3);
    if rng.u8(..4) == 0 {
        camera = camera.with_orthographic(true);
    }
    if rng.u8(..4) == 0 {
        camera.near *= *pick(rng, &[1e-4, 10.0, 30.0]);
        camera.far = camera.far.max(camera.near * 2.0);
    }
    if camera.check().is_ok() { camera } else { Camera::look_at(Vec3::Z * 3.0, Vec3::ZERO) }
}

/// Returns the line of a random triangle, which is tiny, huge, or on a grid where edges and planes coincide.
fn triangle(rng: &mut Rng) -> String {
    let kind = rng.u8(..8);
    let corners = [(); 3].map(|()| match kind {
        0 => in_cube(rng) * 1e-3,
        1 => in_cube(rng) * *pick(rng, &[1.0, 1e4, 1e8]),
        2 | 3 => (in_cube(rng) * 2.0).round() * 0.5,
        _ => in_cube(rng) * 1.5,
    });
    let numbers: Vec<_> = corners.iter().flat_map(Vec3::to_array).map(|number| format!("{number:?}")).collect();
    format!("triangle {}", numbers.join(" "))
}

/// Returns up to eight random settings, each of which is valid after the previous ones.
fn settings(rng: &mut Rng) -> Vec<String> {
    let mut recipe = Recipe::default();
    let candidates: Vec<_> = (0..rng.usize(..9)).map(|_| strings::sound_setting(rng)).collect();
    candidates.into_iter().filter(|setting| recipe.set(setting).is_ok()).collect()
}

/// Scene, cameras, settings and picture size of an input.
struct View {
    scene: Arc<Scene>,
    cameras: [Camera; 2],
    recipe: Recipe,
    size: Viewport,
}

impl View {
    /// Parses an input. Returns `None` if a part is missing, as may happen while an input is minimised.
    fn parse(text: &str) -> Option<Self> {
        let mut builder = SceneBuilder::new(Vec3::Z);
        let (mut cameras, mut recipe, mut size) = (Vec::new(), Recipe::default(), None);
        // All inputs share the same textures, because their texels do not matter.
        let mut rng = Rng::with_seed(0);
        let lines: Vec<_> = text.lines().filter_map(|line| line.split_once(' ')).collect();
        for (number, (word, rest)) in lines.iter().enumerate() {
            match *word {
                "size" => {
                    let (width, height) = rest.split_once(' ')?;
                    size = Some(Viewport { width: width.parse().ok()?, height: height.parse().ok()? });
                }
                "camera" => cameras.push(camera_file::parse(rest).ok()?),
                "set" => recipe.set(rest).ok()?,
                "object" => {
                    let (opacity, texture) = rest.split_once(' ')?;
                    let triangles = lines[number + 1..].iter().take_while(|(word, _)| *word == "triangle");
                    let corners: Vec<_> = triangles.map(|(_, numbers)| corners(numbers)).collect::<Option<_>>()?;
                    let codes = ALPHA.iter().find(|(name, _)| *name == texture).map(|(_, codes)| *codes);
                    let textures = codes.map(|codes| {
                        [(); 2].map(|()| {
                            let image = noise_texture(&mut rng);
                            with_alpha(&mut rng, &image, codes)
                        })
                    });
                    if !corners.is_empty() {
                        let indices =
                            (0..corners.len() as u32).map(|t| [0, 1, 2].map(|corner| t * 3 + corner)).collect();
                        let mesh = mesh(corners.into_iter().flatten().collect(), indices);
                        builder = builder.with_opacity(mesh, Mat4::IDENTITY, textures, opacity.parse().ok()?);
                    }
                }
                _ => {}
            }
        }
        let size = size.filter(|size| size.check().is_ok())?;
        let cameras = cameras.try_into().ok()?;
        Some(Self { scene: Arc::new(builder.0), cameras, recipe, size })
    }
}

fn corners(numbers: &str) -> Option<[Vec3; 3]> {
    let numbers: Vec<f32> = numbers.split(' ').map(|number| number.parse().ok()).collect::<Option<_>>()?;
    let (corners, []) = numbers.as_chunks::<3>() else { return None };
    let corners: [[f32; 3]; 3] = corners.try_into().ok()?;
    let corners = corners.map(Vec3::from_array);
    corners.iter().all(|corner| corner.is_finite()).then_some(corners)
}

#[test]
fn generated_scenes_are_read_back() {
    let mut with_settings = 0;
    for seed in 0..50 {
        let input = Recipes.generate(&mut Rng::with_seed(seed));
        let view = View::parse(std::str::from_utf8(&input.0[FILE]).unwrap()).unwrap();
        assert!(view.scene.triangle_count() > 0);
        with_settings += usize::from(view.recipe != Recipe::default());
    }
    assert!(with_settings > 25, "only {with_settings} with other settings");
}
