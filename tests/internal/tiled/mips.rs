//! Mip-mapped textures in tiled execution: every setting, textures of all shapes, and coordinates that are constant,
//! vary extremely, or are not finite.

use std::sync::Arc;

use glam::{Mat4, Vec2, Vec3};
use rasterscope::antialias::settings::SampleCount;
use rasterscope::chain::{KeepDepth, Recipe, RenderInputs, Renderer, execution};
use rasterscope::image::{Image, Rgba8};
use rasterscope::pipeline::settings::{
    AddressMode, Choice, ColorSpace, Culling, DisabledOptimisation, Execution, Interpolation, Shading, TexelFilter,
};
use rasterscope::scene::{Mesh, MeshData, Scene, builtin};

use super::{Renderers, SMALL, check_all, check_all_at, multisampled, upscalers, with};
use crate::internal::common::{self, SceneBuilder};

/// Returns the default recipe with trilinear filtering.
fn mipmapped() -> Recipe {
    let mut recipe = Recipe::default();
    recipe.pipeline.filter = TexelFilter::Trilinear;
    recipe
}

/// Returns mip-mapped recipes with every address mode and colour space: trilinear ones for the shadings that have SIMD
/// kernels, and anisotropic ones.
fn readings() -> Vec<Recipe> {
    let recipes = with::<AddressMode>(&[mipmapped()], |r, c| r.pipeline.address = c);
    let recipes = with::<ColorSpace>(&recipes, |r, c| r.pipeline.color_space = c);
    let filtered = |recipe: &Recipe, (filter, shading)| {
        let mut recipe = *recipe;
        (recipe.pipeline.filter, recipe.pipeline.shading) = (filter, shading);
        recipe
    };
    let ways = [
        (TexelFilter::Trilinear, Shading::Texture),
        (TexelFilter::Trilinear, Shading::Gouraud),
        (TexelFilter::Trilinear, Shading::Lambert),
        (TexelFilter::Anisotropic, Shading::Gouraud),
    ];
    recipes.iter().flat_map(|recipe| ways.map(|way| filtered(recipe, way))).collect()
}

fn noise((width, height): (u32, u32), random: &mut fastrand::Rng) -> Image<Rgba8> {
    Image::from_fn(width, height, |_, _| [random.u8(..), random.u8(..), random.u8(..), 255])
}

/// Returns a scene of a horizontal square that extends from below the eye far into the distance, with a texture
/// repeated `repeats` times along its sides.
fn board(texture: Image<Rgba8>, repeats: Vec2) -> Scene {
    let positions = [(-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)].map(|(x, z)| Vec3::new(x, 0.0, z)).to_vec();
    let uvs = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y].map(|uv| (uv - 0.3) * repeats).to_vec();
    let triangles = vec![[0, 1, 2], [0, 2, 3]];
    let mesh = Mesh::new(MeshData { name: "board".into(), positions, uvs, triangles, ..MeshData::default() }).unwrap();
    let placed = Mat4::from_translation(Vec3::NEG_Z * 15.0) * Mat4::from_scale(Vec3::splat(20.0));
    SceneBuilder::new(Vec3::new(0.4, 1.0, 3.0)).with(mesh, placed, Some([texture.clone(), texture])).0
}

#[test]
fn every_scene_and_shading_runs_in_tiled_execution() {
    for builtin in builtin::ALL {
        let scene = builtin.build();
        for shading in Shading::ALL {
            let mut recipe = mipmapped();
            recipe.pipeline.shading = *shading;
            assert_eq!(execution(&scene, &recipe), (Execution::Tiled, None), "{} {shading:?}", builtin.id);
        }
    }
}

#[test]
fn every_switch_gives_the_same_picture() {
    let default = &[mipmapped()];
    let mut recipes = with::<Shading>(default, |r, c| r.pipeline.shading = c);
    recipes.extend(with::<Culling>(default, |r, c| r.pipeline.culling = c));
    recipes.extend(with::<Interpolation>(default, |r, c| r.pipeline.interpolation = c));
    recipes.extend(with::<DisabledOptimisation>(default, |r, c| r.pipeline.force = c));
    let more = [
        &["mip_bias=-4"][..],
        &["mip_bias=0.7"],
        &["mip_bias=-1.58", "color_space=bytes"],
        &["filter=anisotropic"],
        &["filter=anisotropic", "shading=lambert", "address=mirror"],
        &["filter=anisotropic", "max_anisotropy=2", "mip_bias=-1", "color_space=bytes"],
    ];
    for settings in more {
        let mut recipe = mipmapped();
        recipe.set_all(settings).unwrap();
        recipes.push(recipe);
    }
    recipes.extend(upscalers().into_iter().map(|upscaler| Recipe { upscaler, ..default[0] }));
    check_all(&recipes);
}

/// Checks multisampling with every fifth recipe, among which each address mode, colour space and shading occurs.
#[test]
fn multisampled_mip_levels_give_the_same_picture() {
    let mut recipes: Vec<_> = readings().into_iter().step_by(5).collect();
    for (recipe, samples) in recipes.iter_mut().zip([SampleCount::Four, SampleCount::Sixteen].into_iter().cycle()) {
        recipe.antialias = multisampled(&[samples])[0].antialias;
    }
    check_all_at(SMALL, &recipes);
}

/// Draws textures from one texel to more texels than samples, with sides that are powers of two or not. They are
/// magnified, minified, and read at coordinates that are NaN or so large that they have no fraction.
#[test]
fn textures_of_all_shapes_and_coordinates_give_the_same_picture() {
    let mut renderers = Renderers::of(SMALL);
    let recipes = readings();
    let mut random = fastrand::Rng::with_seed(17);
    let mut next = 0;
    for size in [(1, 1), (2, 2), (1, 64), (256, 1), (64, 16), (512, 512), (5, 7), (33, 1), (100, 37), (255, 129)] {
        let texture = noise(size, &mut random);
        for repeats in [1e-30, 0.02, 1.0, 7.0, 100.0, 3e4, 1e7, 1e20, 3e38] {
            let scene = Arc::new(board(texture.clone(), Vec2::new(repeats, -repeats * 0.7)));
            for _ in 0..3 {
                let recipe = &recipes[next % recipes.len()];
                next += 1;
                renderers.check(&format!("{size:?} × {repeats}"), &scene, &scene.home, recipe);
            }
        }
    }
}

/// Draws triangles from a fraction of a pixel to several hundred times the picture. Most samples of small ones lie
/// among those of other triangles.
#[test]
fn triangles_of_all_sizes_give_the_same_picture() {
    let mut renderers = Renderers::of(SMALL);
    let recipes = readings();
    common::for_seeds(8, |random| {
        let textures = [(); 2].map(|()| noise((64, 32), random));
        let placed = Mat4::from_translation(Vec3::NEG_Z);
        let mut builder = SceneBuilder::new(Vec3::new(0.2, 0.3, 1.1));
        for (count, size) in [(400, 0.05), (60, 1.0), (6, 300.0)] {
            let mut corner = || common::in_cube(random);
            let triangle = |middle: Vec3, corners: [Vec3; 3]| corners.map(|corner| middle + corner * size);
            let positions = (0..count).flat_map(|_| triangle(corner() * 2.0, [corner(), corner(), corner()])).collect();
            let mesh = common::mesh(positions, (0..count).map(|i| [0, 1, 2].map(|c| i * 3 + c)).collect());
            builder = builder.with(mesh, placed, Some(textures.clone()));
        }
        let scene = Arc::new(builder.0);
        let mut recipe = recipes[random.usize(..recipes.len())];
        recipe.pipeline.culling = Culling::None;
        renderers.check("all sizes", &scene, &scene.home, &recipe);
    });
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let scene = Arc::new(board(noise((256, 128), &mut fastrand::Rng::with_seed(3)), Vec2::splat(9.0)));
    let drawn_by = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let render = || {
            Renderer::default().render(
                RenderInputs { scene: &scene, camera: &scene.home, recipe: &mipmapped(), viewport: SMALL },
                KeepDepth::Yes,
            )
        };
        pool.install(render).drawn
    };
    assert_eq!(drawn_by(3), drawn_by(1));
}

/// Checks that texels of the second mip level are read only if the level has a weight.
#[test]
fn the_second_mip_level_is_not_read_where_its_weight_is_zero() {
    let texels = |repeats: f32| {
        let texture = noise((512, 512), &mut fastrand::Rng::with_seed(4));
        let scene = Arc::new(board(texture, Vec2::splat(repeats)));
        let frame = Renderer::default().render(
            RenderInputs { scene: &scene, camera: &scene.home, recipe: &mipmapped(), viewport: SMALL },
            KeepDepth::No,
        );
        let counts = frame.tiled.as_ref().unwrap().counts;
        assert!(counts.shaded > 1000);
        counts.texels as f64 / counts.shaded as f64
    };
    assert_eq!(texels(5e-4), 4.0, "less than a texel in every pixel");
    assert!((4.1..7.5).contains(&texels(0.2)), "less nearby, and more far away");
    assert!((7.5..=8.0).contains(&texels(3.8)), "more, but for the last row hardly ever more than there are");
    assert_eq!(texels(1e7), 4.0, "more in every pixel than there are");
}
