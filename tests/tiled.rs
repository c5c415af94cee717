//! Both ways to execute the pipeline give the same picture and the same depths, bit for bit: every scene, every switch, any
//! number of threads, AVX2 or not.

mod common;

use common::scenes;
use rasterscope::chain::{Recipe, run};
use rasterscope::math::lanes::Lanes;
use rasterscope::pipeline::framebuffer::Framebuffer;
use rasterscope::pipeline::settings::{
    Address, Arithmetic, Choice, ColorSpace, Culling, DepthFormat, DepthTest, FillRule, Filter, Interpolation,
    Rasterizer, Shading,
};
use rasterscope::pipeline::tiled::{Memory, draw, obstacle};
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::scene::{Camera, Scene, builtin};
use rasterscope::upscale::Upscaling;

/// Odd on purpose: neither tiles nor blocks divide it.
const SIZE: Viewport = Viewport { width: 203, height: 149 };

/// A recipe for each alternative of a setting, each with the others of `recipes`.
fn with<C: Choice>(recipes: &[Recipe], set: fn(&mut Recipe, C)) -> Vec<Recipe> {
    let changed = |recipe: &Recipe, choice: C| {
        let mut recipe = *recipe;
        set(&mut recipe, choice);
        recipe
    };
    recipes.iter().flat_map(|recipe| C::ALL.iter().map(move |choice| changed(recipe, *choice))).collect()
}

/// Every switch around the default recipe, and every upscaler.
fn single_switches() -> Vec<Recipe> {
    let default = &[Recipe::default()];
    let mut recipes = with::<Culling>(default, |r, c| r.pipeline.culling = c);
    recipes.extend(with::<FillRule>(default, |r, c| r.pipeline.fill_rule = c));
    recipes.extend(with::<Interpolation>(default, |r, c| r.pipeline.interpolation = c));
    recipes.extend(with::<Shading>(default, |r, c| r.pipeline.shading = c));
    recipes.extend(with::<Rasterizer>(default, |r, c| r.pipeline.rasterizer = c));
    recipes.extend(with::<Arithmetic>(default, |r, c| r.pipeline.arithmetic = c));
    recipes.extend(Upscaling::every().map(|upscaler| Recipe { upscaler, ..Recipe::default() }));
    recipes
}

/// Depth tests × formats, drawn from both sides, so that more meets at each sample.
fn depths() -> Vec<Recipe> {
    let mut recipe = Recipe::default();
    recipe.pipeline.culling = Culling::None;
    let recipes = with::<DepthTest>(&[recipe], |r, c| r.pipeline.depth_test = c);
    with::<DepthFormat>(&recipes, |r, c| r.pipeline.depth_format = c)
}

/// What lanes shade, in every way that textures are read.
fn textures() -> Vec<Recipe> {
    let recipes = with::<Filter>(&[Recipe::default()], |r, c| r.pipeline.filter = c);
    let recipes = with::<Address>(&recipes, |r, c| r.pipeline.address = c);
    let recipes = with::<ColorSpace>(&recipes, |r, c| r.pipeline.color_space = c);
    let mut all = recipes.clone();
    for shading in [Shading::Texture, Shading::Gouraud] {
        all.extend(recipes.iter().map(|recipe| {
            let mut recipe = *recipe;
            recipe.pipeline.shading = shading;
            recipe
        }));
    }
    all
}

/// Draws tile by tile and compares with the classic way.
fn check(name: &str, scene: &Scene, camera: &Camera, recipe: &Recipe, memory: &mut Memory) {
    let settings = &recipe.pipeline;
    if obstacle(scene, settings).is_some() {
        return;
    }
    let expected = run(scene, camera, recipe, SIZE, &mut ()).drawn;
    for lanes in [Lanes::best(), Lanes::baseline()] {
        let grid = recipe.upscaler.grid();
        // What the framebuffer holds beforehand must not matter.
        let mut frame = Framebuffer::new(grid, SIZE.width, SIZE.height, [1, 2, 3], settings);
        draw(scene, camera, settings, SIZE, &mut frame, memory, lanes);
        let (width, height) = frame.color.size();
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            let place = grid.pixel(x, y);
            if place.0 >= SIZE.width || place.1 >= SIZE.height {
                continue;
            }
            let context = || format!("{name} {} ({x}, {y}) {recipe:?}", lanes.name());
            assert_eq!(frame.color.at(x, y), expected.color.at(x, y), "colour, {}", context());
            if let Some((depth, expected)) = frame.depth.as_ref().zip(expected.depth.as_ref()) {
                assert_eq!(depth.at(x, y).to_bits(), expected.at(x, y).to_bits(), "depth, {}", context());
            }
        }
    }
}

fn check_all(recipes: &[Recipe]) {
    let mut memory = Memory::default();
    for builtin in builtin::ALL {
        let scene = builtin.build();
        for recipe in recipes {
            check(builtin.id, &scene, &scene.home, recipe, &mut memory);
        }
    }
    for (name, scene) in scenes() {
        for recipe in recipes {
            check(name, &scene, &scene.home, recipe, &mut memory);
        }
    }
}

#[test]
fn every_switch_gives_the_same_picture() {
    check_all(&single_switches());
}

#[test]
fn every_depth_test_and_format_gives_the_same_picture() {
    check_all(&depths());
}

#[test]
fn every_way_to_read_textures_gives_the_same_picture() {
    check_all(&textures());
}

#[test]
fn views_from_within_the_scene_give_the_same_picture() {
    let mut memory = Memory::default();
    let mut random = fastrand::Rng::with_seed(5);
    for builtin in builtin::ALL {
        let scene = builtin.build();
        for _ in 0..12 {
            let mut camera = scene.home;
            camera.eye = camera.eye.lerp(camera.target, random.f32() * 1.5);
            camera.target += common::in_cube(&mut random) * 2.0;
            check(builtin.id, &scene, &camera, &Recipe::default(), &mut memory);
        }
    }
}
