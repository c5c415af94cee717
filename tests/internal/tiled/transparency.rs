//! Alpha test and blending in tiled execution with several samples per pixel: triangles of all shapes, and the number
//! of shaded samples.

use std::sync::Arc;

use glam::{Mat4, Vec3};
use rasterscope::antialias::settings::SampleCount;
use rasterscope::chain::{KeepDepth, Recipe, RenderInputs, Renderer};
use rasterscope::pipeline::settings::{
    BlendingOrder, Choice, ColorSpace, Culling, DepthFormat, DepthTest, FillRule, Shading, TexelFilter,
};
use rasterscope::scene::{Mesh, Projection};
use rasterscope::upscale::Upscaling;

use super::{Renderers, SMALL, jittered, multisampled, with};
use crate::internal::common::{self, SceneBuilder};

/// Side of a pixel in the orthographic view, in world units; the origin is at the centre of a pixel.
const PIXEL: f32 = 1.0 / 32.0;

/// Returns random triangles around the origin, up to the given length and width in pixels. If `rounded`, corners lie on
/// pixel centres, so that edges pass through other centres.
fn triangles(random: &mut fastrand::Rng, count: u32, [length, width]: [f32; 2], rounded: bool) -> Mesh {
    let one = |random: &mut fastrand::Rng| {
        let size = PIXEL * 0.03_f32.powf(random.f32());
        let [first, tilt] = [(); 2].map(|()| common::in_cube(random) * Vec3::new(1.6, 1.1, 0.8));
        let along = common::in_cube(random).normalize_or(Vec3::X) * size * length;
        let across = along.cross(tilt).normalize_or(Vec3::Y) * size * width;
        let corners = [first - along, first + along, first + across];
        if rounded { corners.map(|corner| (corner / PIXEL).round() * PIXEL) } else { corners }
    };
    let positions = (0..count).flat_map(|_| one(random)).collect();
    common::mesh(positions, (0..count).map(|i| [0, 1, 2].map(|corner| i * 3 + corner)).collect())
}

/// Draws triangles that are smaller than pixels, thinner than pixels, or around the eye with edge functions that exceed
/// 32 bits. Each kind is drawn with alpha test, and blended by texture or by material.
#[test]
fn transparent_triangles_of_all_sizes_give_the_same_picture() {
    let mut renderers = Renderers::of(SMALL);
    let recipes = multisampled(&[SampleCount::Four, SampleCount::Sixteen, SampleCount::SixtyFour]);
    common::for_seeds(10, |random| {
        let flat = random.bool();
        let mut scene = SceneBuilder::new(Vec3::Z * 3.0).with(common::cube(), Mat4::IDENTITY, None);
        for (count, size) in [(250, [1.5, 1.5]), (40, [60.0, 1.0]), (4, [40.0, 40.0]), (2, [9000.0, 9000.0])] {
            for (codes, opacity) in [(&[0, 255][..], 1.0), (&[0, 90, 200, 255], 1.0), (&[0, 255], 0.6)] {
                let image = common::noise_texture(random);
                let textures = [(); 2].map(|()| common::with_alpha(random, &image, codes));
                let mesh = triangles(random, count, size, flat);
                scene = scene.with_opacity(mesh, Mat4::IDENTITY, Some(textures), opacity);
            }
        }
        let mut scene = scene.0;
        if flat {
            scene.home.projection = Projection::Orthographic { height: SMALL.height as f32 * PIXEL };
        }
        let scene = Arc::new(scene);
        let mut recipe = recipes[random.usize(..recipes.len())];
        let pipeline = &mut recipe.pipeline;
        let shadings = [Shading::Texture, Shading::Gouraud, Shading::Lambert, Shading::Cel];
        pipeline.shading = shadings[random.usize(..shadings.len())];
        pipeline.culling = Culling::None;
        pipeline.fill_rule = FillRule::ALL[random.usize(..FillRule::ALL.len())];
        pipeline.filter = TexelFilter::ALL[random.usize(..TexelFilter::ALL.len())];
        pipeline.color_space = ColorSpace::ALL[random.usize(..ColorSpace::ALL.len())];
        pipeline.blending.order = BlendingOrder::ALL[random.usize(..BlendingOrder::ALL.len())];
        renderers.check("all sizes", &scene, &scene.home, &recipe);
    });
}

/// Returns a scene of intersecting panes, some of them textured, in front of and behind an opaque cube.
fn crossing_panes(random: &mut fastrand::Rng) -> SceneBuilder {
    let mut scene = SceneBuilder::new(Vec3::Z * 3.0).with(common::cube(), Mat4::from_scale(Vec3::splat(0.4)), None);
    for textured in [true, false, true] {
        let image = common::noise_texture(random);
        let textures = [(); 2].map(|()| common::with_alpha(random, &image, &[0, 90, 200, 255]));
        let turn = Mat4::from_rotation_y(random.f32() * 3.0) * Mat4::from_rotation_x(random.f32() - 0.5);
        scene = scene.with_opacity(common::plane(), turn, textured.then_some(textures), 0.6);
    }
    scene.with_opacity(common::soup(random, 12), Mat4::IDENTITY, None, 0.5)
}

/// Checks every blending order with one, several or jittered samples per pixel, with partial frames, in every depth
/// format and with every depth test.
#[test]
fn every_blending_order_gives_the_same_picture() {
    let mut renderers = Renderers::of(SMALL);
    let scene = Arc::new(crossing_panes(&mut fastrand::Rng::with_seed(11)).0);
    let mut recipes = vec![Recipe::default(), Recipe::default()];
    recipes[1].upscaler = Upscaling::new("checkerboard", 1).unwrap();
    recipes.extend(multisampled(&[SampleCount::Four]));
    recipes.extend(jittered(&[SampleCount::Four]));
    let recipes: Vec<_> = recipes
        .into_iter()
        .map(|mut recipe| {
            recipe.pipeline.culling = Culling::None;
            recipe
        })
        .collect();
    let mut all = with::<DepthFormat>(&recipes, |r, c| r.pipeline.depth_format = c);
    all.extend(with::<DepthTest>(&recipes, |r, c| r.pipeline.depth_test = c));
    for recipe in with::<BlendingOrder>(&all, |r, c| r.pipeline.blending.order = c) {
        renderers.check("crossing panes", &scene, &scene.home, &recipe);
    }
}

/// Checks that a blended surface that fills the picture is shaded once per sample, and for no sample outside the
/// picture.
#[test]
fn blended_samples_are_counted_one_by_one() {
    let mut random = fastrand::Rng::with_seed(1);
    let textures = [(); 2].map(|()| common::noise_texture(&mut random));
    let large = Mat4::from_scale(Vec3::splat(10.0));
    let scene = SceneBuilder::new(Vec3::Z * 3.0).with_opacity(common::plane(), large, Some(textures), 0.5).0;
    let scene = Arc::new(scene);
    let pixels = u64::from(SMALL.width * SMALL.height);
    for (samples, recipe) in [4, 16].into_iter().zip(multisampled(&[SampleCount::Four, SampleCount::Sixteen])) {
        for shading in [Shading::Gouraud, Shading::Cel] {
            let mut recipe = recipe;
            (recipe.pipeline.shading, recipe.pipeline.filter) = (shading, TexelFilter::Bilinear);
            let frame = Renderer::default().render(
                RenderInputs { scene: &scene, camera: &scene.home, recipe: &recipe, viewport: SMALL },
                KeepDepth::Yes,
            );
            let counts = frame.tiled.as_ref().unwrap().counts;
            assert_eq!(counts.shaded, pixels * samples, "{shading:?}");
            assert_eq!(counts.texels, counts.shaded * 4, "{shading:?}");
        }
    }
}
