//! Checks that both executions of the pipeline give the same picture and the same depths, bit for bit: for every scene,
//! every setting and any number of threads, with AVX-512, AVX2 or neither.

mod mips;
mod transparency;

use crate::internal::common;
use std::sync::Arc;

use crate::internal::common::{DEPTH_BIASES, SceneBuilder, scenes};
use crate::internal::switches::{distinct, single_switches};
use glam::{Mat4, Vec3, Vec4};
use rasterscope::antialias::settings::{AntialiasMethod, SampleCount};
use rasterscope::chain::{KeepDepth, Recipe, RenderInputs, Renderer, execution, run};
use rasterscope::image::Image;
use rasterscope::math::lanes::Lanes;
use rasterscope::pipeline::plan::{CullStats, DrawPlan, PipelinePart};
use rasterscope::pipeline::settings::{
    AddressMode, Choice, ColorSpace, Culling, DepthFormat, DepthTest, DisabledOptimisation, Execution, FillRule,
    Shading, TexelFilter,
};
use rasterscope::pipeline::tiled;
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::scene::{Camera, Projection, Scene, SceneSource, SubView, builtin};
use rasterscope::upscale::Upscaling;

/// Size of the pictures, odd so that neither tiles nor blocks divide it.
const SIZE: Viewport = Viewport { width: 203, height: 149 };

/// Size of the pictures for recipes whose classic execution is slow.
const SMALL: Viewport = Viewport { width: 101, height: 67 };

/// Maximum number of triangles of a scene that is drawn with every kind of lanes, and often with jittered samples.
/// Jittered samples are slow in classic execution, which draws each triangle once per possible sample position.
const FEW_TRIANGLES: usize = 200;

/// Interval between the recipes of a list that scenes of many triangles are drawn with.
const RECIPE_STEP: usize = 2;

/// Returns each of `recipes` combined with every value of a setting.
fn with<C: Choice>(recipes: &[Recipe], set: fn(&mut Recipe, C)) -> Vec<Recipe> {
    let changed = |recipe: &Recipe, choice: C| {
        let mut recipe = *recipe;
        set(&mut recipe, choice);
        recipe
    };
    recipes.iter().flat_map(|recipe| C::ALL.iter().map(move |choice| changed(recipe, *choice))).collect()
}

/// Returns one upscaler for each set of drawn samples and inputs. The tests compare samples before upscaling, so
/// another upscaler of the same samples would repeat the comparison.
fn upscalers() -> Vec<Upscaling> {
    let mut chosen: Vec<Upscaling> = Vec::new();
    for upscaler in Upscaling::every() {
        let needs = |upscaler: &Upscaling| (upscaler.sampling(), upscaler.upscaler().reads());
        if !chosen.iter().any(|other| needs(other) == needs(&upscaler)) {
            chosen.push(upscaler);
        }
    }
    chosen
}

/// Returns [`single_switches`], and recipes with all kinds of upscalers and of samples.
fn switches() -> Vec<Recipe> {
    let mut recipes = single_switches();
    recipes.extend(upscalers().into_iter().map(|upscaler| Recipe { upscaler, ..Recipe::default() }));
    let settings = ["antialias.method=none", "antialias.method=multisample", "antialias.method=jittered"];
    recipes.extend(settings.map(|setting| common::recipe(&[setting, "background=#d04010"])));
    recipes
}

/// Returns a recipe for every depth test × depth format, without culling, so that more fragments cover each sample.
fn depths() -> Vec<Recipe> {
    let mut recipe = Recipe::default();
    recipe.pipeline.culling = Culling::None;
    let recipes = with::<DepthTest>(&[recipe], |r, c| r.pipeline.depth_test = c);
    with::<DepthFormat>(&recipes, |r, c| r.pipeline.depth_format = c)
}

/// Returns the recipes, each with one depth bias; all biases take turns.
fn biased(mut recipes: Vec<Recipe>) -> Vec<Recipe> {
    for (recipe, depth_bias) in recipes.iter_mut().zip(DEPTH_BIASES.into_iter().cycle()) {
        recipe.pipeline.depth_bias = depth_bias;
    }
    recipes
}

/// Returns recipes with every texture filter, address mode and colour space, for shadings that have SIMD kernels.
fn textures() -> Vec<Recipe> {
    let recipes = with::<TexelFilter>(&[Recipe::default()], |r, c| r.pipeline.filter = c);
    let recipes = with::<AddressMode>(&recipes, |r, c| r.pipeline.address = c);
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

/// Renderers of every kind of SIMD lanes. They reuse their buffers from frame to frame, which must not affect the
/// result.
struct Renderers {
    of_lanes: Vec<(&'static str, Renderer)>,
    size: Viewport,
    /// Number of checks so far, which selects the lanes for scenes of many triangles.
    checks: usize,
}

impl Renderers {
    fn new() -> Self {
        Self::of(SIZE)
    }

    /// Creates renderers for pictures of this size.
    fn of(size: Viewport) -> Self {
        Self { of_lanes: Lanes::all().map(|lanes| (lanes.name(), Renderer::on(lanes))).collect(), size, checks: 0 }
    }

    /// Draws in tiled execution and compares colours and depths with those of classic execution. Scenes of more than
    /// [`FEW_TRIANGLES`] take turns with the kinds of lanes; others are drawn with each.
    fn check(&mut self, name: &str, scene: &Arc<Scene>, camera: &Camera, recipe: &Recipe) {
        if execution(scene, recipe).0 == Execution::Classic {
            return;
        }
        let expected = run(scene, camera, recipe, self.size, &mut ());
        let kinds = self.of_lanes.len();
        let (first, count) = if scene.triangle_count() > FEW_TRIANGLES { (self.checks % kinds, 1) } else { (0, kinds) };
        self.checks += 1;
        for (lanes, renderer) in self.of_lanes.iter_mut().skip(first).take(count) {
            let frame = renderer.render(RenderInputs { scene, camera, recipe, viewport: self.size }, KeepDepth::Yes);
            let context = || format!("{name} {lanes} {recipe:?}");
            assert_eq!(frame.rasterized(), expected.geometry().triangles.len(), "{}", context());
            let (drawn, grid) = (&frame.drawn, frame.drawn.grid);
            let depths = drawn.depth.as_ref().zip(expected.drawn.depth.as_ref());
            let same_bits = |(a, b): (&Image<f32>, &Image<f32>)| {
                a.pixels().iter().map(|depth| depth.to_bits()).eq(b.pixels().iter().map(|depth| depth.to_bits()))
            };
            // Comparing whole buffers is much faster; the loop below finds and names a sample that differs.
            if drawn.color == expected.drawn.color && depths.is_none_or(same_bits) {
                renderer.recycle(frame);
                continue;
            }
            let (width, height) = drawn.color.size();
            for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
                let (px, py) = grid.pixel(x, y);
                if px >= frame.raster.width || py >= frame.raster.height {
                    continue;
                }
                assert_eq!(drawn.color.at(x, y), expected.drawn.color.at(x, y), "colour ({x}, {y}) {}", context());
                if let Some((depth, expected)) = depths {
                    assert_eq!(depth.at(x, y).to_bits(), expected.at(x, y).to_bits(), "depth ({x}, {y}) {}", context());
                }
            }
            renderer.recycle(frame);
        }
    }
}

fn check_all(recipes: &[Recipe]) {
    check_all_at(SIZE, recipes);
}

/// Checks recipes on all scenes. Scenes of more than [`FEW_TRIANGLES`] are slow in classic execution. They are drawn at
/// [`SMALL`] size with every [`RECIPE_STEP`]th recipe; the first one differs from scene to scene.
fn check_all_at(size: Viewport, recipes: &[Recipe]) {
    let (mut few, mut many) = (Renderers::of(size), Renderers::of(SMALL));
    let recipes = distinct(recipes.iter().copied());
    for (turn, (name, scene)) in all_scenes().enumerate() {
        if scene.triangle_count() <= FEW_TRIANGLES {
            recipes.iter().for_each(|recipe| few.check(name, &scene, &scene.home, recipe));
        } else {
            let first = turn % RECIPE_STEP.min(recipes.len());
            let chosen = recipes.iter().skip(first).step_by(RECIPE_STEP);
            chosen.for_each(|recipe| many.check(name, &scene, &scene.home, recipe));
        }
    }
}

/// Returns the built-in scenes and the test scenes.
fn all_scenes() -> impl Iterator<Item = (&'static str, Arc<Scene>)> {
    let builtins = builtin::ALL.iter().map(|builtin| (builtin.id, builtin.build()));
    builtins.chain(scenes()).map(|(name, scene)| (name, Arc::new(scene)))
}

#[test]
fn every_scene_runs_in_tiled_execution_with_any_transparency() {
    for builtin in builtin::ALL {
        for recipe in [Recipe::default(), multisampled(&[SampleCount::Four])[0], jittered(&[SampleCount::Four])[0]] {
            assert_eq!(execution(&builtin.build(), &recipe), (Execution::Tiled, None), "{}", builtin.id);
        }
    }
}

#[test]
fn every_switch_gives_the_same_picture() {
    check_all(&switches());
}

#[test]
fn every_depth_test_and_format_gives_the_same_picture() {
    check_all(&depths());
}

#[test]
fn every_depth_bias_gives_the_same_picture() {
    // Combines each bias with some of the depth tests and formats.
    let recipes = biased(depths());
    check_small_scenes(&recipes.iter().copied().step_by(3).collect::<Vec<_>>());
    check_all_at(SMALL, &recipes.into_iter().step_by(11).collect::<Vec<_>>());
    let smooth = [multisampled(&[SampleCount::Four]), jittered(&[SampleCount::Four])].concat();
    let smooth = biased(with::<DepthFormat>(&smooth, |r, c| r.pipeline.depth_format = c));
    check_small_scenes(&smooth.into_iter().step_by(2).collect::<Vec<_>>());
}

#[test]
fn every_way_to_read_textures_gives_the_same_picture() {
    let mut renderers = Renderers::new();
    let default = Recipe::default().pipeline;
    let is_default =
        |recipe: &&Recipe| (recipe.pipeline.filter, recipe.pipeline.address) == (default.filter, default.address);
    let all = textures();
    for (name, scene) in all_scenes() {
        // Filter and address mode have no effect without textures.
        let has_textures = !scene.library.textures().is_empty();
        for recipe in all.iter().filter(|recipe| has_textures || is_default(recipe)) {
            renderers.check(name, &scene, &scene.home, recipe);
        }
    }
}

#[test]
fn every_antialiasing_method_gives_the_same_picture() {
    let mut recipes = with::<AntialiasMethod>(&[Recipe::default()], |r, c| r.antialias.method = c);
    recipes.extend(with::<AntialiasMethod>(&recipes[..1], |r, c| {
        r.antialias.method = c;
        r.upscaler = Upscaling::new("checkerboard", 1).unwrap();
    }));
    check_all_at(SMALL, &recipes);
}

/// Returns a recipe with multisampling for each number of samples.
fn multisampled(samples: &[SampleCount]) -> Vec<Recipe> {
    smoothed(AntialiasMethod::Multisample, samples)
}

/// Returns a recipe with jittered samples for each number of samples, each with a different seed.
fn jittered(samples: &[SampleCount]) -> Vec<Recipe> {
    let mut recipes = smoothed(AntialiasMethod::Jittered, samples);
    for (seed, recipe) in recipes.iter_mut().enumerate() {
        recipe.antialias.seed = seed as u32;
    }
    recipes
}

fn smoothed(method: AntialiasMethod, samples: &[SampleCount]) -> Vec<Recipe> {
    let recipe = |samples: &SampleCount| {
        let mut recipe = Recipe::default();
        (recipe.antialias.method, recipe.antialias.samples) = (method, *samples);
        recipe
    };
    samples.iter().map(recipe).collect()
}

#[test]
fn every_number_of_multisamples_gives_the_same_picture() {
    check_all_at(SMALL, &multisampled(SampleCount::ALL));
}

#[test]
fn multisampling_gives_the_same_picture_with_every_setting() {
    let few = multisampled(&[SampleCount::Four, SampleCount::Sixteen]);
    let four = &few[..1];
    let mut recipes = with::<Culling>(&few, |r, c| r.pipeline.culling = c);
    recipes.extend(with::<FillRule>(&few, |r, c| r.pipeline.fill_rule = c));
    recipes.extend(with::<ColorSpace>(&few, |r, c| r.antialias.light = c));
    recipes.extend(with::<ColorSpace>(four, |r, c| r.pipeline.color_space = c));
    recipes.extend(with::<Shading>(four, |r, c| r.pipeline.shading = c));
    recipes.extend(with::<TexelFilter>(four, |r, c| r.pipeline.filter = c));
    recipes.extend(upscalers().into_iter().map(|upscaler| Recipe { upscaler, ..few[0] }));
    check_all_at(SMALL, &recipes);
}

#[test]
fn multisampling_gives_the_same_picture_with_every_depth_test_and_format() {
    let mut recipes = multisampled(&[SampleCount::Four]);
    recipes[0].pipeline.culling = Culling::None;
    let recipes = with::<DepthTest>(&recipes, |r, c| r.pipeline.depth_test = c);
    check_all_at(SMALL, &with::<DepthFormat>(&recipes, |r, c| r.pipeline.depth_format = c));
}

/// Checks recipes on all scenes of at most [`FEW_TRIANGLES`] triangles.
fn check_small_scenes(recipes: &[Recipe]) {
    let (mut renderers, recipes) = (Renderers::of(SMALL), distinct(recipes.iter().copied()));
    for (name, scene) in all_scenes().filter(|(_, scene)| scene.triangle_count() <= FEW_TRIANGLES) {
        for recipe in &recipes {
            renderers.check(name, &scene, &scene.home, recipe);
        }
    }
}

#[test]
fn every_number_of_jittered_samples_gives_the_same_picture() {
    check_all_at(SMALL, &jittered(&[SampleCount::Four]));
    check_small_scenes(&jittered(&[SampleCount::Sixteen]));
    let mut renderers = Renderers::of(Viewport { width: 71, height: 19 });
    for (name, scene) in scenes() {
        let scene = Arc::new(scene);
        for recipe in jittered(SampleCount::ALL) {
            renderers.check(name, &scene, &scene.home, &recipe);
        }
    }
}

#[test]
fn jittered_samples_give_the_same_picture_with_every_setting() {
    let four = &jittered(&[SampleCount::Four]);
    let mut recipes = with::<Culling>(four, |r, c| r.pipeline.culling = c);
    recipes.extend(with::<FillRule>(four, |r, c| r.pipeline.fill_rule = c));
    recipes.extend(with::<ColorSpace>(four, |r, c| r.antialias.light = c));
    recipes.extend(with::<ColorSpace>(four, |r, c| r.pipeline.color_space = c));
    recipes.extend(with::<Shading>(four, |r, c| r.pipeline.shading = c));
    recipes.extend(with::<TexelFilter>(four, |r, c| r.pipeline.filter = c));
    recipes.extend([1, 7, u32::MAX].map(|seed| {
        let mut recipe = four[0];
        recipe.antialias.seed = seed;
        recipe
    }));
    check_small_scenes(&recipes);
}

#[test]
fn jittered_samples_give_the_same_picture_with_every_upscaler() {
    let four = jittered(&[SampleCount::Four])[0];
    check_small_scenes(&upscalers().into_iter().map(|upscaler| Recipe { upscaler, ..four }).collect::<Vec<_>>());
}

#[test]
fn jittered_samples_give_the_same_picture_with_every_depth_test_and_format() {
    let mut recipes = jittered(&[SampleCount::Four]);
    recipes[0].pipeline.culling = Culling::None;
    let recipes = with::<DepthTest>(&recipes, |r, c| r.pipeline.depth_test = c);
    check_small_scenes(&with::<DepthFormat>(&recipes, |r, c| r.pipeline.depth_format = c));
}

/// Draws triangles from a few grid steps to several hundred times the picture, whose edge functions need more than 32
/// bits. Most samples of the small ones share pixels with other triangles, or lie just outside the tile of their
/// corners.
#[test]
fn triangles_of_all_sizes_are_sampled_alike() {
    let mut renderers = Renderers::of(SMALL);
    let few = [SampleCount::Four, SampleCount::Sixteen];
    let single: Vec<_> = upscalers().into_iter().map(|upscaler| Recipe { upscaler, ..Recipe::default() }).collect();
    let recipes = [multisampled(&few), jittered(&few), single.clone(), single];
    let recipes = recipes.map(|recipes| with::<FillRule>(&recipes, |r, c| r.pipeline.fill_rule = c));
    common::for_seeds(6, |random| {
        let mut triangles = |count: u32, least_px: f32, greatest_px: f32| {
            let pixel = 4.0 / SMALL.height as f32;
            let one = |random: &mut fastrand::Rng| {
                let size = pixel * least_px * (greatest_px / least_px).powf(random.f32());
                let middle = common::in_cube(random) * Vec3::new(3.0, 2.0, 1.0);
                [(); 3].map(|()| middle + common::in_cube(random) * Vec3::new(size, size, 0.2))
            };
            let positions = (0..count).flat_map(|_| one(random)).collect();
            common::mesh(positions, (0..count).map(|i| [0, 1, 2].map(|corner| i * 3 + corner)).collect())
        };
        let (tiny, large) = (triangles(3000, 0.02, 3.0), triangles(12, 3.0, 20_000.0));
        let mut scene = SceneBuilder::new(Vec3::Z * 3.0)
            .with(tiny, Mat4::IDENTITY, None)
            .with(large, Mat4::IDENTITY, Some([(); 2].map(|()| common::noise_texture(random))))
            .0;
        scene.home.projection = Projection::Orthographic { height: 4.0 };
        let scene = Arc::new(scene);
        for recipes in &recipes {
            let mut recipe = recipes[random.usize(..recipes.len())];
            recipe.pipeline.culling = Culling::ALL[random.usize(..Culling::ALL.len())];
            renderers.check("all sizes", &scene, &scene.home, &recipe);
        }
    });
}

/// Draws triangles that cover whole tiles, in front of, behind or crossing one another, with smaller ones in between,
/// in random order. A full-tile occluder must be valid for all later triangles.
#[test]
fn layers_over_whole_tiles_give_the_same_picture() {
    let (mut renderers, mut smooth) = (Renderers::new(), Renderers::of(SMALL));
    common::for_seeds(60, |random| {
        let pixel = 4.0 / SIZE.height as f32;
        let mut positions = Vec::new();
        for _ in 0..random.usize(2..40) {
            let size = pixel * [6.0, 40.0, 5_000.0, 5_000.0][random.usize(..4)];
            let middle = common::in_cube(random) * Vec3::new(3.0, 2.0, 1.0);
            // Mostly flat, so that many triangles lie completely in front of others.
            let tilt = if random.u32(..3) == 0 { 1.0 } else { 0.001 };
            positions.extend(
                [(-1.0, -0.7), (1.0, -0.7), (0.0, 1.0)]
                    .map(|(x, y)| middle + Vec3::new(x, y, tilt * (random.f32() - 0.5)) * Vec3::new(size, size, 1.0)),
            );
        }
        let triangles = (0..positions.len() as u32 / 3).map(|i| [0, 1, 2].map(|corner| i * 3 + corner)).collect();
        let mut textures = [(); 2].map(|()| common::noise_texture(random));
        if random.u32(..4) == 0 {
            textures = textures.map(|image| common::with_alpha(random, &image, &[0, 255]));
        }
        let mut scene =
            SceneBuilder::new(Vec3::Z * 3.0).with(common::mesh(positions, triangles), Mat4::IDENTITY, Some(textures));
        scene.0.home.projection = Projection::Orthographic { height: 4.0 };
        let scene = Arc::new(scene.0);
        let mut recipe = Recipe::default();
        recipe.pipeline.culling = Culling::None;
        recipe.pipeline.depth_test = DepthTest::ALL[random.usize(..DepthTest::ALL.len())];
        recipe.pipeline.depth_format = DepthFormat::ALL[random.usize(..DepthFormat::ALL.len())];
        if random.bool() {
            recipe.pipeline.depth_bias = DEPTH_BIASES[random.usize(..DEPTH_BIASES.len())];
        }
        renderers.check("layers", &scene, &scene.home, &recipe);
        for of in [multisampled(&[SampleCount::Four]), jittered(&[SampleCount::Four])] {
            smooth.check("layers", &scene, &scene.home, &Recipe { pipeline: recipe.pipeline, ..of[0] });
        }
    });
}

#[test]
fn views_from_within_the_scene_give_the_same_picture() {
    let (mut renderers, mut smooth) = (Renderers::new(), Renderers::of(SMALL));
    let mut random = fastrand::Rng::with_seed(5);
    for builtin in builtin::ALL {
        let scene = Arc::new(builtin.build());
        for _ in 0..12 {
            let mut camera = scene.home;
            camera.eye = camera.eye.lerp(camera.target, random.f32() * 1.5);
            camera.target += common::in_cube(&mut random) * 2.0;
            renderers.check(builtin.id, &scene, &camera, &Recipe::default());
            smooth.check(builtin.id, &scene, &camera, &multisampled(&[SampleCount::Four])[0]);
            if scene.triangle_count() <= FEW_TRIANGLES {
                smooth.check(builtin.id, &scene, &camera, &jittered(&[SampleCount::Four])[0]);
            }
        }
    }
}

/// Draws a sphere seen from inside. For any matrix and camera, some of its clusters lie outside a clip plane, and
/// others cross it. Sheets inside the sphere are seen from either side.
#[test]
fn skipping_invisible_clusters_changes_no_picture() {
    let mut renderers = Renderers::new();
    let mut random = fastrand::Rng::with_seed(31);
    let mut seen = CullStats::default();
    let shear = Mat4::from_cols(Vec4::X, Vec4::new(0.7, 1.0, -0.3, 0.0), Vec4::new(0.0, 0.4, 1.0, 0.0), Vec4::W);
    for (name, placed) in [
        ("as it is", Mat4::IDENTITY),
        ("mirrored", Mat4::from_scale(Vec3::new(1.0, -1.0, 1.0))),
        ("sheared", shear),
        ("huge", Mat4::from_scale(Vec3::splat(3e4))),
        ("tiny", Mat4::from_scale(Vec3::new(3e-5, 2e-3, 1e-4))),
        ("flat", Mat4::from_scale(Vec3::new(1.0, 0.0, 1.0))),
    ] {
        let sheets = [[Vec3::X, Vec3::Y], [Vec3::Y, Vec3::X], [Vec3::Y, Vec3::Z], [Vec3::Z, Vec3::X]];
        let scene =
            sheets.iter().fold(SceneBuilder::new(Vec3::Z).with(common::sphere(70), placed, None), |scene, edges| {
                let edges = edges.map(|edge| edge * 0.5);
                scene.with(common::sheet((edges[0] + edges[1]) * -0.5, edges), placed, None)
            });
        let scene = Arc::new(scene.0);
        for _ in 0..8 {
            let mut camera = scene.home;
            camera.eye = placed.transform_point3(common::in_cube(&mut random) * 0.9);
            camera.target = camera.eye + common::in_cube(&mut random);
            let size = placed.to_scale_rotation_translation().0.abs().max_element();
            (camera.near, camera.far) = (size * 0.05, size * random.f32() * 2.0 + size * 0.1);
            let camera = camera.with_orthographic(random.bool());
            let mut recipe = Recipe::default();
            recipe.pipeline.culling = Culling::ALL[random.usize(..Culling::ALL.len())];
            recipe.pipeline.depth_format = DepthFormat::ALL[random.usize(..DepthFormat::ALL.len())];
            renderers.check(name, &scene, &camera, &recipe);
            let unseen = CullStats::of(&tiled::plans(&scene, &camera, &recipe.pipeline, SIZE));
            seen.outside += unseen.outside;
            seen.turned_away += unseen.turned_away;
            seen.all += unseen.all;
        }
    }
    assert!(seen.outside > seen.all / 3 && seen.turned_away > 20, "{seen:?}");
}

/// Draws sheets at the planes of an orthographic view, whose side planes are at ±2. A sheet that touches a plane from
/// outside is rasterized, though it covers no pixel; a sheet that is farther out by one ulp is not. At the near and far
/// planes the whole sheet lies in the plane.
#[test]
fn clusters_that_touch_a_plane_are_rasterized() {
    let mut renderers = Renderers::new();
    for (name, outside, along) in [
        ("left", Vec3::NEG_X, Vec3::Y),
        ("right", Vec3::X, Vec3::Y),
        ("bottom", Vec3::NEG_Y, Vec3::X),
        ("top", Vec3::Y, Vec3::X),
        ("near", Vec3::Z, Vec3::Y),
        ("far", Vec3::NEG_Z, Vec3::Y),
    ] {
        for steps in -2_i32..=2 {
            let at = f32::from_bits((2.0_f32.to_bits() as i32 + steps) as u32);
            let first = if outside.z == 0.0 { outside } else { Vec3::X };
            let mesh = common::sheet(outside * at, [first, along]);
            let mut scene = SceneBuilder::new(Vec3::Z * 3.0).with(mesh, Mat4::IDENTITY, None).0;
            scene.home.projection = Projection::Orthographic { height: 4.0 };
            scene.home.sub_view = Some(SubView { aspect: 1.0, scale: [1.0; 2], shift: [0.0; 2] });
            (scene.home.near, scene.home.far) = (1.0, 5.0);
            let (scene, mut recipe) = (Arc::new(scene), Recipe::default());
            recipe.pipeline.culling = Culling::None;
            renderers.check(&format!("{name} {steps}"), &scene, &scene.home, &recipe);
            let rasterized = run(&scene, &scene.home, &recipe, SIZE, &mut ()).rasterized();
            // One ulp beyond the far plane, rounding brings the sheet back.
            assert!(if steps == 1 { name == "far" || rasterized == 0 } else { (rasterized > 0) == (steps <= 0) });
        }
    }
}

/// Draws panes behind each other that differ only in opacity, which must not be treated as the same material.
#[test]
fn panes_that_differ_only_in_opacity_are_distinguished() {
    let folder = tempfile::tempdir().unwrap();
    let [panes, materials] = ["panes.obj", "panes.mtl"].map(|name| folder.path().join(name));
    let material = |name: &str, opacity: f32| format!("newmtl {name}\nKd 0.9 0.4 0.2\nd {opacity}\n");
    std::fs::write(materials, [("thin", 0.3), ("thick", 0.8)].map(|(name, opacity)| material(name, opacity)).concat())
        .unwrap();
    let corners = |z: i32| format!("v -1 -1 {z}\nv 1 -1 {z}\nv 0 1 {z}\n");
    let faces = "usemtl thick\nf 1 2 3\nusemtl thin\nf 4 5 6\nusemtl thick\nf 7 8 9\n";
    std::fs::write(&panes, format!("mtllib panes.mtl\n{}{}{}{faces}", corners(-5), corners(-4), corners(-3))).unwrap();
    let scene = Arc::new(SceneSource::named(panes).load().unwrap().scene);
    let camera = Camera { eye: Vec3::ZERO, target: Vec3::NEG_Z, ..scene.home };
    for recipe in with::<ColorSpace>(&[Recipe::default()], |r, c| r.pipeline.color_space = c) {
        let middle = run(&scene, &camera, &recipe, SIZE, &mut ()).image().at(SIZE.width / 2, SIZE.height / 2);
        assert_ne!(middle[..3], scene.background, "the panes are visible");
        Renderers::new().check("panes", &scene, &camera, &recipe);
    }
}

/// Draws a fan with a vertex at the eye, which has no screen position. Triangles without that vertex must be
/// unaffected.
#[test]
fn a_vertex_at_the_eye_does_not_affect_other_triangles() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("fan.obj");
    let corner = |i: u32| format!("v {} {} -5\n", f64::from(i).cos(), f64::from(i).sin());
    let rim: String = (0..10).map(corner).collect();
    let faces: String = (2..11).map(|i| format!("f {} {} {}\n", if i == 2 { 1 } else { 2 }, i, i + 1)).collect();
    std::fs::write(&file, format!("v 0 0 0\n{rim}{faces}")).unwrap();
    let scene = Arc::new(SceneSource::named(file).load().unwrap().scene);
    let camera = Camera { eye: Vec3::ZERO, target: Vec3::NEG_Z, ..scene.home };
    let mut recipe = Recipe::default();
    for culling in Culling::ALL {
        recipe.pipeline.culling = *culling;
        Renderers::new().check("a fan", &scene, &camera, &recipe);
    }
}

#[test]
fn disabling_optimisations_changes_no_picture() {
    for builtin in builtin::ALL {
        let scene = Arc::new(builtin.build());
        for recipe in with::<Execution>(&[Recipe::default()], |r, c| r.execution = c) {
            let drawn = |force| {
                let mut recipe = recipe;
                recipe.pipeline.force = force;
                Renderer::default().render(
                    RenderInputs { scene: &scene, camera: &scene.home, recipe: &recipe, viewport: SIZE },
                    KeepDepth::Yes,
                )
            };
            let (planned, forced) = (drawn(DisabledOptimisation::Nothing), drawn(DisabledOptimisation::Everything));
            assert_eq!(planned.drawn, forced.drawn, "{} {:?}", builtin.id, recipe.execution);
            let runs = |plans: &[DrawPlan]| {
                plans.iter().map(|p| PipelinePart::ALL.iter().filter(|part| p.runs(**part)).count()).sum::<usize>()
            };
            assert!(runs(&forced.plans) >= runs(&planned.plans), "{}", builtin.id);
        }
    }
}

#[test]
fn the_number_of_threads_changes_nothing() {
    // Two threads share the three rows of tiles of the first size, and take whole rows of the eighteen rows of the
    // second.
    let sizes = [SIZE, Viewport { width: 130, height: 1100 }];
    let pool = |threads: usize| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let (alone, others) = (pool(1), [2, 8].map(pool));
    let mut recipes = with::<Shading>(&[Recipe::default()], |r, c| r.pipeline.shading = c);
    recipes.extend([multisampled(&[SampleCount::Four]), jittered(&[SampleCount::Four])].concat());
    recipes.push(Recipe { upscaler: Upscaling::new("checkerboard", 1).unwrap(), ..Recipe::default() });
    for id in ["chess", "stained-glass", "missing-texture"] {
        let scene = Arc::new(builtin::by_id(id).unwrap().build());
        for (recipe, size) in recipes.iter().flat_map(|recipe| sizes.map(|size| (recipe, size))) {
            let drawn = |keep_depth| {
                Renderer::default()
                    .render(RenderInputs { scene: &scene, camera: &scene.home, recipe, viewport: size }, keep_depth)
                    .drawn
            };
            let expected = alone.install(|| drawn(KeepDepth::Yes));
            for pool in &others {
                let context = || format!("{id} {recipe:?}, {} threads", pool.current_num_threads());
                assert!(pool.install(|| drawn(KeepDepth::Yes)) == expected, "{}", context());
                let color = pool.install(|| drawn(KeepDepth::No)).color;
                assert!(color == expected.color, "{}, without depths", context());
            }
        }
    }
}
