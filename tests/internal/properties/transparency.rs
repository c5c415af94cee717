//! Blending, alpha test and blending order, checked against the blending formula in f64 and against the same scene with
//! its alpha drawn as a colour.

use glam::{Mat4, Vec3};
use rasterscope::chain::{Frame, Recipe, redraw};
use rasterscope::image::{Image, Rgba8};
use rasterscope::pipeline::framebuffer::Framebuffer;
use rasterscope::pipeline::interpolate::Fragment;
use rasterscope::pipeline::observe::Observer;
use rasterscope::pipeline::plan::{DrawPlan, PipelinePart, PlanStep};
use rasterscope::pipeline::screen_triangle::{ScreenTriangle, depth_at};
use rasterscope::pipeline::settings::{BlendingOrder, Choice as _, ColorSpace, DepthFormat, Shading, TexelFilter};
use rasterscope::pipeline::shade::Shader;
use rasterscope::pipeline::{DrawCall, Extent, LastStage};
use rasterscope::scene::{Instance, Material, Mesh, MeshData, Scene, Texture, Transparency};

use crate::internal::common::{
    SceneBuilder, for_seeds, noise_texture, plane, recipe, render, scenes, transparency_scene, with_alpha,
};

const SIZE: (u32, u32) = (48, 36);

/// Upright pane that covers the middle of the picture.
#[derive(Clone, Copy)]
struct Pane {
    z: f32,
    color: Vec3,
    opacity: f32,
}

/// Returns a scene of panes in the given order, seen from z = 4.
fn panes(list: impl IntoIterator<Item = Pane>) -> Scene {
    let mut scene = SceneBuilder::new(Vec3::Z * 4.0).0;
    let uncolored = Mesh::new(MeshData { colors: Vec::new(), ..(*plane()).clone() }).expect("test meshes are valid");
    let mesh = scene.library.add_mesh(uncolored);
    for Pane { z, color, opacity } in list {
        let material = scene.library.add_material(Material { opacity, ..Material::plain("pane", color) });
        let world_from_model = Mat4::from_translation(Vec3::Z * z);
        scene.instances.push(Instance { name: format!("at {z}"), mesh, material, world_from_model, tint: Vec3::ONE });
    }
    scene
}

/// Returns up to five panes from far to near, some of which may be opaque.
fn random_panes(rng: &mut fastrand::Rng) -> Vec<Pane> {
    let count = rng.u8(1..=5);
    let pane = |place| Pane {
        z: f32::from(place) * 0.3 - 1.0,
        color: Vec3::new(rng.f32(), rng.f32(), rng.f32()),
        opacity: if rng.u8(..4) == 0 { 1.0 } else { rng.f32() },
    };
    (0..count).map(pane).collect()
}

/// Returns the functions that convert a code to the number that is blended, and back, in f64 (IEC 61966-2-1).
fn mixing(space: ColorSpace) -> [fn(f64) -> f64; 2] {
    fn decode(code: f64) -> f64 {
        let value = code / 255.0;
        if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
    }
    fn encode(linear: f64) -> f64 {
        255.0 * if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
    }
    match space {
        ColorSpace::Linear => [decode, encode],
        ColorSpace::Bytes => [|code| code / 255.0, |value| value * 255.0],
    }
}

/// Returns the colour of `list`, blended from far to near over a background. Rounds to codes after every pane, like the
/// framebuffer.
fn blended(list: &[Pane], background: [u8; 3], space: ColorSpace) -> [f64; 3] {
    let [numbers, code] = mixing(space);
    list.iter().fold(background.map(f64::from), |below, pane| {
        let alpha = f64::from(pane.opacity);
        std::array::from_fn(|channel| {
            let own = f64::from(pane.color[channel]) * 255.0;
            code(numbers(own) * alpha + numbers(below[channel]) * (1.0 - alpha)).round()
        })
    })
}

#[test]
fn panes_are_blended_from_far_to_near_whatever_order_they_come_in() {
    for_seeds(40, |rng| {
        let list = random_panes(rng);
        let mut shuffled = list.clone();
        rng.shuffle(&mut shuffled);
        let mut scene = panes(shuffled);
        for (space, orthographic) in ColorSpace::ALL.iter().flat_map(|s| [false, true].map(|o| (*s, o))) {
            let expected = blended(&list, scene.background, space);
            scene.home = scene.home.with_orthographic(orthographic);
            for format in DepthFormat::ALL {
                let mut recipe = recipe(&["shading=texture"]);
                (recipe.pipeline.color_space, recipe.pipeline.depth_format) = (space, *format);
                let drawn = render(&scene, &recipe, SIZE).image().at(SIZE.0 / 2, SIZE.1 / 2);
                for (code, expected) in drawn.into_iter().zip(expected) {
                    // If the blended value lies between two codes, f32 may round differently.
                    assert!((f64::from(code) - expected).abs() <= 1.0, "{drawn:?} {expected:?} {space:?} {format:?}");
                }
            }
        }
    });
}

#[test]
fn blended_triangles_come_last_from_far_to_near_and_the_others_in_submission_order() {
    for orthographic in [false, true] {
        let mut scene = transparency_scene();
        scene.home = scene.home.with_orthographic(orthographic);
        for format in DepthFormat::ALL {
            let mut recipe = recipe(&["culling=none"]);
            recipe.pipeline.depth_format = *format;
            let frame = render(&scene, &recipe, SIZE);
            let (others, blended) = frame.geometry().triangles.split_at(frame.geometry().blended_from());
            let is_blended = |t: &ScreenTriangle| {
                frame.geometry().plans[t.instance as usize].transparency() == Transparency::Blended
            };
            assert!(blended.len() > 20 && blended.iter().all(is_blended), "{format:?}");
            assert!(others.len() > 20 && !others.iter().any(is_blended), "{format:?}");
            assert!(others.windows(2).all(|pair| pair[0].id <= pair[1].id), "{format:?}");
            // Corner depths of a distant triangle are coarse, especially in 16 bits; 1/w is available in every format.
            let distance = |t: &ScreenTriangle| t.vertices.iter().map(|v| 1.0 / f64::from(v.inv_w)).sum::<f64>();
            if !orthographic {
                assert!(blended.windows(2).all(|pair| distance(&pair[0]) >= distance(&pair[1])), "{format:?}");
            }
            for (place, triangle) in frame.geometry().triangles.iter().enumerate() {
                assert_eq!(frame.geometry().index_of(triangle), place);
            }
        }
    }
}

/// Observer that collects the blended fragments of each pixel with their depths, in submission order.
struct Collect {
    frame: Frame,
    fragments: Vec<Vec<(f32, ScreenTriangle, Fragment)>>,
}

impl Observer for Collect {
    fn shaded(&mut self, triangle: &ScreenTriangle, fragment: &Fragment, _color: Rgba8) {
        if self.frame.geometry().is_blended(triangle) {
            let pixel = fragment.sample.y * SIZE.0 + fragment.sample.x;
            let depth = depth_at(triangle, &fragment.sample);
            self.fragments[pixel as usize].push((depth, *triangle, *fragment));
        }
    }
}

/// Compares exact order with an oracle, which draws only the opaque objects, collects the blended fragments, sorts
/// those of each pixel by stored depth, and blends them in sequence.
#[test]
fn exact_order_is_that_of_fragments_sorted_by_depth() {
    let mut reordered = 0;
    for_seeds(8, |rng| {
        let scene = transparency_scene();
        let mut exact = recipe(&["culling=none", "blending.order=exact"]);
        exact.pipeline.depth_format =
            [DepthFormat::F32, DepthFormat::ReversedF32, DepthFormat::WBuffer][rng.usize(..3)];
        let shadings = [Shading::Texture, Shading::Gouraud, Shading::Lambert, Shading::Cel];
        exact.pipeline.shading = shadings[rng.usize(..shadings.len())];
        let mut submitted = exact;
        submitted.pipeline.blending.order = BlendingOrder::Objects;
        let frame = render(&scene, &submitted, SIZE);
        let plans = frame.geometry().plans.clone();
        let pixels = (SIZE.0 * SIZE.1) as usize;
        let mut collect = Collect { frame, fragments: vec![Vec::new(); pixels] };
        let again = render(&scene, &submitted, SIZE);
        redraw(&scene, &submitted, &again, LastStage::Shade, &mut collect);
        let opaque =
            Extent { triangles: 0..again.geometry().blended_from(), ..Extent::all(again.geometry(), again.raster) };
        let mut drawn = Framebuffer::new(again.drawn.grid, SIZE.0, SIZE.1, scene.background, &submitted.pipeline);
        DrawCall::new(&scene, again.geometry(), &submitted.pipeline, &opaque).draw(&mut drawn, &mut ());
        let mut expected = drawn.color;
        let shaders: Vec<_> = scene
            .instances
            .iter()
            .zip(&plans)
            .map(|(instance, plan)| Shader::new(&exact.pipeline, &scene.library, instance, plan))
            .collect();
        for (pixel, fragments) in collect.fragments.iter_mut().enumerate() {
            let before: Vec<_> = fragments.iter().map(|(depth, ..)| *depth).collect();
            fragments.sort_by(|a, b| b.0.total_cmp(&a.0));
            if exact.pipeline.reversed() {
                fragments.sort_by(|a, b| a.0.total_cmp(&b.0));
            }
            reordered += usize::from(fragments.iter().map(|(depth, ..)| *depth).ne(before));
            for (_, triangle, fragment) in fragments {
                let (x, y) = (pixel as u32 % SIZE.0, pixel as u32 / SIZE.0);
                let shader = &shaders[triangle.instance as usize];
                expected.set(x, y, shader.blend(fragment, triangle, expected.at(x, y)));
            }
        }
        assert_eq!(*render(&scene, &exact, SIZE).image(), expected, "{exact:?}");
    });
    assert!(reordered > 100, "{reordered}");
}

#[test]
fn objects_are_blended_in_submission_order() {
    for_seeds(10, |rng| {
        let mut list = random_panes(rng);
        // The nearest pane would be opaque in some lists and hide the others from the test, so all are translucent.
        list.iter_mut().for_each(|pane| pane.opacity = pane.opacity.min(0.8));
        rng.shuffle(&mut list);
        let scene = panes(list.iter().copied());
        let expected = blended(&list, scene.background, ColorSpace::Linear);
        let drawn = render(&scene, &recipe(&["shading=texture", "blending.order=objects"]), SIZE);
        let drawn = drawn.image().at(SIZE.0 / 2, SIZE.1 / 2);
        for (code, expected) in drawn.into_iter().zip(expected) {
            assert!((f64::from(code) - expected).abs() <= 1.0, "{drawn:?} {expected:?}");
        }
    });
}

#[test]
fn triangles_at_the_same_distance_stay_in_submission_order() {
    let pane = |color| Pane { z: 0.0, color, opacity: 0.5 };
    let scene = panes([pane(Vec3::X), pane(Vec3::Y), pane(Vec3::Z)]);
    let frame = render(&scene, &Recipe::default(), SIZE);
    assert_eq!(frame.geometry().blended_from(), 0);
    // All cells of an upright pane have the same distance from the eye along the view axis.
    assert!(frame.geometry().triangles.windows(2).all(|pair| pair[0].id < pair[1].id));
}

#[test]
fn blended_surfaces_are_depth_tested_but_write_no_depth() {
    let pane = |z, opacity| Pane { z, color: Vec3::ONE, opacity };
    let wall = [pane(0.0, 1.0)];
    let depth = |scene: &Scene| render(scene, &Recipe::default(), SIZE).drawn.depth;
    let image = |scene: &Scene| render(scene, &Recipe::default(), SIZE).image().clone();
    let (alone, before, behind) =
        (panes(wall), panes([pane(0.5, 0.5), wall[0]]), panes([pane(-0.5, 0.5), pane(-0.6, 0.5), wall[0]]));
    assert_eq!([depth(&before), depth(&behind)], [depth(&alone), depth(&alone)]);
    assert_eq!(image(&behind).at(24, 18), image(&alone).at(24, 18));
    assert_ne!(image(&before), image(&alone));
}

/// Returns a scene of a tilted pane with a texture, and a pane behind it.
fn leaning(texture: Image<Rgba8>) -> Scene {
    let mut scene = panes([Pane { z: -1.0, color: Vec3::X, opacity: 1.0 }]);
    let texture = scene.library.add_texture(Texture::new(texture).expect("not empty"));
    let material = scene.library.add_material(Material::textured("textured", texture));
    let world_from_model = Mat4::from_rotation_y(0.7) * Mat4::from_rotation_x(0.4);
    let pane = Instance { name: "leaning".into(), material, world_from_model, ..scene.instances[0].clone() };
    scene.instances.push(pane);
    scene
}

#[test]
fn an_alpha_tested_surface_is_drawn_where_its_alpha_is_at_least_one_half() {
    let (mut there, mut gone) = (0, 0);
    for_seeds(20, |rng| {
        let image = noise_texture(rng);
        let image = with_alpha(rng, &image, &[0, 255]);
        let [alpha_tested, opaque] = [image.clone(), image.map(|[r, g, b, _]| [r, g, b, 255])].map(leaning);
        let alpha = leaning(image.map(|[_, _, _, a]| [a, a, a, 255]));
        let behind = panes([Pane { z: -1.0, color: Vec3::X, opacity: 1.0 }]);
        for filter in TexelFilter::ALL {
            let mut recipe = recipe(&["color-space=bytes", "shading=texture"]);
            recipe.pipeline.filter = *filter;
            let [alpha_tested, opaque, alpha, behind] =
                [&alpha_tested, &opaque, &alpha, &behind].map(|s| render(s, &recipe, SIZE));
            let leaning = |x: u32, y: u32| {
                opaque.drawn.depth.as_ref().unwrap().at(x, y) != behind.drawn.depth.as_ref().unwrap().at(x, y)
            };
            for (x, y) in (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (x, y))).filter(|(x, y)| leaning(*x, *y)) {
                let expected = match alpha.image().at(x, y)[0] {
                    // One half lies between these two codes.
                    127 | 128 => continue,
                    0..127 => &behind,
                    _ => &opaque,
                };
                *(if std::ptr::eq(expected, &behind) { &mut gone } else { &mut there }) += 1;
                assert_eq!(alpha_tested.image().at(x, y), expected.image().at(x, y), "{x} {y} {filter:?}");
                let depth = |frame: &rasterscope::chain::Frame| frame.drawn.depth.as_ref().map(|d| d.at(x, y));
                assert_eq!(depth(&alpha_tested), depth(expected), "{x} {y} {filter:?}");
            }
        }
    });
    assert!(there > 1000 && gone > 1000, "{there} {gone}");
}

#[test]
fn the_alpha_of_a_texture_and_opacity_are_multiplied() {
    let graded = |alpha: u8| Image::filled(2, 2, [200, 100, 50, alpha]);
    let picture = |texture, opacity| {
        let mut scene = leaning(texture);
        let material = scene.library.material(scene.instances[1].material).clone();
        scene.instances[1].material = scene.library.add_material(Material { opacity, ..material });
        render(&scene, &recipe(&["shading=texture", "filter=point"]), SIZE).image().clone()
    };
    assert_eq!(picture(graded(51), 1.0), picture(graded(255), 0.2), "51 / 255 is the float nearest to 0.2");
    assert_eq!(picture(graded(204), 0.25), picture(graded(51), 1.0));
    assert_ne!(picture(graded(51), 1.0), picture(graded(255), 1.0));
}

#[test]
fn shadings_that_show_no_material_are_opaque_and_say_why() {
    let scene = transparency_scene();
    for shading in Shading::ALL {
        let mut recipe = Recipe::default();
        recipe.pipeline.shading = *shading;
        let frame = render(&scene, &recipe, SIZE);
        let kinds: Vec<_> = frame.geometry().plans.iter().map(DrawPlan::transparency).collect();
        for (plan, kind) in frame.geometry().plans.iter().zip(&kinds) {
            assert_eq!(plan.runs(PipelinePart::Blending), *kind == Transparency::Blended);
            assert_eq!(plan.runs(PipelinePart::AlphaTest), *kind == Transparency::AlphaTested);
            if !shading.reads_material() {
                let PlanStep::Skipped(reason) = plan.step(PipelinePart::Blending) else { panic!("{shading:?} blends") };
                assert!(reason.contains("ignores opacity"), "{reason}");
            }
        }
        for kind in [Transparency::AlphaTested, Transparency::Blended] {
            assert_eq!(kinds.contains(&kind), shading.reads_material(), "{shading:?} {kind:?}");
        }
        if !shading.reads_material() {
            assert!(frame.geometry().triangles.windows(2).all(|pair| pair[0].id <= pair[1].id), "{shading:?}");
        }
    }
}

#[test]
fn scenes_without_alpha_plan_no_transparency() {
    for (name, scene) in scenes().into_iter().filter(|(name, _)| *name != "transparency") {
        let frame = render(&scene, &Recipe::default(), SIZE);
        assert!(frame.geometry().plans.iter().all(|p| p.transparency() == Transparency::Opaque), "{name}");
        assert_eq!(frame.geometry().blended_from(), frame.geometry().triangles.len(), "{name}");
    }
}
