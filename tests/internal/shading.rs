//! Highlights, normal maps, emission, opacity maps and alpha filtering, checked against independent oracles in double
//! precision. Both executions, replays and traces must also agree bit for bit.

use crate::internal::common;
use std::sync::Arc;

use crate::internal::common::{cube, noise_texture, recipe, render, sphere, with_alpha};
use glam::{DVec2, DVec3, Mat4, Vec2, Vec3};
use rasterscope::chain::{Frame, KeepDepth, Recipe, RenderInputs, Renderer};
use rasterscope::image::{Image, Rgba8};
use rasterscope::inspect::overlays::{Overlay, OverlayContext};
use rasterscope::inspect::view::Value;
use rasterscope::inspect::{Trace, inspect};
use rasterscope::pipeline::settings::{AlphaMode, Choice as _, Execution, Shading, TexelFilter};
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::scene::{
    Camera, Instance, Library, Material, Mesh, MeshData, Projection, Scene, Texture, TextureId, Transparency,
};

const SIZE: (u32, u32) = (40, 30);

/// Returns the square [−1, 1]² at z = 0, facing +z, whose u increases to the right and v downwards.
fn square() -> Mesh {
    let corners = [Vec2::new(-1.0, -1.0), Vec2::new(1.0, -1.0), Vec2::ONE, Vec2::new(-1.0, 1.0)];
    Mesh::new(MeshData {
        name: "square".into(),
        positions: corners.map(|corner| corner.extend(0.0)).into(),
        normals: vec![Vec3::Z; 4],
        uvs: corners.map(|corner| Vec2::new(corner.x + 1.0, 1.0 - corner.y) * 0.5).into(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..MeshData::default()
    })
    .expect("the square is valid")
}

/// Returns a scene of one mesh with the material that `make` returns.
fn scene_of(mesh: Mesh, world_from_model: Mat4, make: impl FnOnce(&mut Library) -> Material) -> Scene {
    let mut library = Library::default();
    let material = make(&mut library);
    let (mesh, material) = (library.add_mesh(mesh), library.add_material(material));
    let instance = Instance { name: "object".into(), mesh, material, world_from_model, tint: Vec3::ONE };
    let home = Camera::look_at(Vec3::new(0.3, 0.2, 2.6), Vec3::ZERO);
    Scene {
        name: "test".into(),
        library,
        instances: vec![instance],
        background: [0, 0, 90],
        home,
        views: Vec::new(),
        light: None,
        animation: None,
    }
}

fn texture(library: &mut Library, image: Image<Rgba8>) -> TextureId {
    library.add_texture(Texture::new(image).expect("not empty"))
}

fn classic(recipe: &Recipe) -> Recipe {
    Recipe { execution: Execution::Classic, ..*recipe }
}

/// Draws a scene in both executions, checks that the pictures are equal, and returns one.
fn picture(scene: &Scene, recipe: &Recipe) -> Image<Rgba8> {
    let drawn = render(scene, &classic(recipe), SIZE);
    let tiled = Renderer::default().render(
        RenderInputs {
            scene: &Arc::new(scene.clone()),
            camera: &scene.home,
            recipe,
            viewport: Viewport { width: SIZE.0, height: SIZE.1 },
        },
        KeepDepth::No,
    );
    assert_eq!(drawn.image(), tiled.image());
    drawn.image().clone()
}

fn decode(srgb: f64) -> f64 {
    if srgb <= 0.04045 { srgb / 12.92 } else { ((srgb + 0.055) / 1.055).powf(2.4) }
}

fn code(light: f64) -> f64 {
    let light = light.clamp(0.0, 1.0);
    255.0 * if light <= 0.003_130_8 { light * 12.92 } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 }
}

/// Returns the point that the centre of a pixel shows on the plane through the origin with the normal `plane`.
fn point_seen(camera: &Camera, (x, y): (u32, u32), plane: DVec3) -> DVec3 {
    let Projection::Perspective { fov_y } = camera.projection else { panic!("a perspective view") };
    let tan = (f64::from(fov_y) * 0.5).tan();
    let aspect = f64::from(SIZE.0) / f64::from(SIZE.1);
    let forward = (camera.target.as_dvec3() - camera.eye.as_dvec3()).normalize();
    let right = forward.cross(DVec3::Y).normalize();
    let up = right.cross(forward);
    let [across, down] = [(x, SIZE.0), (y, SIZE.1)].map(|(at, size)| (f64::from(at) + 0.5) / f64::from(size));
    let ray = forward + right * (tan * aspect * (2.0 * across - 1.0)) + up * (tan * (1.0 - 2.0 * down));
    let eye = camera.eye.as_dvec3();
    eye - ray * (eye.dot(plane) / ray.dot(plane))
}

/// Returns the bilinear sample of a repeated texture at `uv`, as sRGB-encoded values in [0, 1].
fn bilinear(image: &Image<Rgba8>, uv: DVec2) -> DVec3 {
    let (width, height) = image.size();
    let place = DVec2::new(uv.x * f64::from(width) - 0.5, uv.y * f64::from(height) - 0.5);
    let (base, share) = (place.floor(), place - place.floor());
    let texel = |dx: f64, dy: f64| {
        let at = |value: f64, size: u32| value.rem_euclid(f64::from(size)) as u32;
        let [r, g, b, _] = image.at(at(base.x + dx, width), at(base.y + dy, height)).map(f64::from);
        DVec3::new(r, g, b) / 255.0
    };
    texel(0.0, 0.0) * (1.0 - share.x) * (1.0 - share.y)
        + texel(1.0, 0.0) * share.x * (1.0 - share.y)
        + texel(0.0, 1.0) * (1.0 - share.x) * share.y
        + texel(1.0, 1.0) * share.x * share.y
}

#[test]
fn a_normal_map_and_a_highlight_agree_with_double_precision() {
    let mut random = fastrand::Rng::with_seed(5);
    let map = Image::from_fn(8, 8, |_, _| [random.u8(90..166), random.u8(90..166), 255, 255]);
    for (scale, offset) in [([1.0, 1.0], [0.0, 0.0]), ([-1.0, 2.0], [1.0, 0.25])] {
        let turn = Mat4::from_rotation_y(0.35);
        let (specular, emission) = (Vec3::new(0.7, 0.6, 0.5), Vec3::new(0.1, 0.2, 0.3));
        let scene = scene_of(square(), turn, |library| Material {
            normal_texture: Some(texture(library, map.clone())),
            normal_scale: 0.8,
            specular,
            shininess: 18.5,
            emission,
            uv_scale: scale.into(),
            uv_offset: offset.into(),
            ..Material::plain("bumpy", Vec3::new(0.5, 0.4, 0.3))
        });
        let recipe = recipe(&["shading=blinn-phong"]);
        let drawn = picture(&scene, &recipe);
        let light = recipe.pipeline.light.direction.as_dvec3().normalize();
        let ambient = f64::from(recipe.pipeline.light.ambient);
        let turn = turn.as_dmat4();
        let [right, up, out] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| turn.transform_vector3(axis));
        let (mut compared, mut brightest) = (0, 0.0_f64);
        for (x, y) in (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (x, y))) {
            let point = point_seen(&scene.home, (x, y), out);
            let [across, upwards] = [point.dot(right), point.dot(up)];
            if across.abs().max(upwards.abs()) > 0.97 {
                continue;
            }
            let uv = DVec2::new((across + 1.0) * 0.5, (1.0 - upwards) * 0.5);
            let uv = uv * DVec2::from(scale.map(f64::from)) + DVec2::from(offset.map(f64::from));
            let texel = bilinear(&map, uv) * 2.0 - 1.0;
            let tangent = right * f64::from(scale[0]).signum();
            let normal = (tangent * texel.x * f64::from(0.8_f32) + up * texel.y * f64::from(0.8_f32) + out * texel.z)
                .normalize();
            let to_eye = (scene.home.eye.as_dvec3() - point).normalize();
            let halfway = (light + to_eye).normalize();
            let highlight = if normal.dot(light) > 0.0 { normal.dot(halfway).max(0.0).powf(18.5) } else { 0.0 };
            brightest = brightest.max(highlight);
            let diffuse = ambient + (1.0 - ambient) * normal.dot(light).max(0.0);
            let found = drawn.at(x, y);
            let of = |color: Vec3, channel: usize| decode(f64::from(color[channel]));
            for channel in 0..3 {
                let kd = of(Vec3::new(0.5, 0.4, 0.3), channel);
                let due = kd * diffuse + of(specular, channel) * highlight + of(emission, channel);
                let off = (f64::from(found[channel]) - code(due)).abs();
                assert!(off <= 1.0, "{scale:?} {x},{y}: {found:?} is {off} from {}", code(due));
            }
            compared += 1;
        }
        assert!(compared > 300 && brightest > 0.5, "{compared} {brightest}");
    }
}

#[test]
fn emission_is_added_after_light_by_all_shadings_of_materials() {
    let emission = Vec3::new(0.4, 0.0, 0.2);
    for shading in Shading::ALL.iter().filter(|shading| shading.reads_material()) {
        let with = |emission: Vec3| {
            let scene = scene_of(square(), Mat4::IDENTITY, |_| Material {
                emission,
                ..Material::plain("glowing", Vec3::new(0.5, 0.4, 0.3))
            });
            picture(&scene, &recipe(&[&format!("shading={}", shading.id())])).at(SIZE.0 / 2, SIZE.1 / 2)
        };
        let (dark, glowing) = (with(Vec3::ZERO), with(emission));
        for channel in 0..3 {
            let due = code(decode(f64::from(dark[channel]) / 255.0) + decode(f64::from(emission[channel])));
            assert!((f64::from(glowing[channel]) - due).abs() <= 1.0, "{shading:?} {dark:?} {glowing:?} {due}");
        }
    }
}

#[test]
fn an_opacity_map_cuts_out_or_blends_as_the_alpha_of_a_texture_does() {
    let mut random = fastrand::Rng::with_seed(6);
    for (codes, kind) in [(&[0, 255][..], Transparency::AlphaTested), (&[0, 90, 200, 255], Transparency::Blended)] {
        let color = noise_texture(&mut random);
        let map = with_alpha(&mut random, &Image::filled(5, 7, [255; 4]), codes);
        let both = Image::from_fn(5, 7, |x, y| {
            let ([r, g, b, _], [_, _, _, alpha]) = (color.at(x, y), map.at(x, y));
            [r, g, b, alpha]
        });
        for filter in TexelFilter::ALL.iter().filter(|filter| !filter.reads_mip_levels()) {
            let recipe = recipe(&[&format!("filter={}", filter.id())]);
            let apart = scene_of(square(), Mat4::IDENTITY, |library| Material {
                alpha_texture: Some(texture(library, map.clone())),
                ..Material::textured("apart", texture(library, color.clone()))
            });
            let together = scene_of(square(), Mat4::IDENTITY, |library| {
                Material::textured("together", texture(library, both.clone()))
            });
            let frame = render(&apart, &recipe, SIZE);
            assert_eq!(frame.plans[0].transparency(), kind);
            assert_eq!(picture(&apart, &recipe), picture(&together, &recipe), "{kind:?} {filter:?}");
        }
    }
}

#[test]
fn a_material_that_clamps_does_so_under_every_address() {
    let mut random = fastrand::Rng::with_seed(7);
    let image = noise_texture(&mut random);
    let scene = |clamp: bool| {
        scene_of(square(), Mat4::IDENTITY, |library| Material {
            clamp,
            uv_scale: Vec2::splat(3.0),
            uv_offset: Vec2::splat(-1.0),
            ..Material::textured("clamped", texture(library, image.clone()))
        })
    };
    let due = picture(&scene(false), &recipe(&["address=clamp"]));
    for address in ["clamp", "repeat", "mirror"] {
        assert_eq!(picture(&scene(true), &recipe(&[&format!("address={address}")])), due, "{address}");
    }
    assert_ne!(picture(&scene(false), &recipe(&["address=repeat"])), due);
}

#[test]
fn scale_and_offset_of_a_material_equal_those_in_texture_coordinates() {
    let mut random = fastrand::Rng::with_seed(8);
    let image = noise_texture(&mut random);
    let (scale, offset) = (Vec2::new(2.0, -0.5), Vec2::new(0.25, 0.5));
    let moved = scene_of(square(), Mat4::IDENTITY, |library| Material {
        uv_scale: scale,
        uv_offset: offset,
        ..Material::textured("moved", texture(library, image.clone()))
    });
    let mesh = square();
    let mesh = Mesh::new(MeshData {
        name: "moved".into(),
        positions: mesh.positions.to_vec(),
        normals: mesh.normals.to_vec(),
        uvs: mesh.uvs.iter().map(|uv| *uv * scale + offset).collect(),
        triangles: mesh.triangles.to_vec(),
        ..MeshData::default()
    })
    .expect("the mesh is valid");
    let due = scene_of(mesh, Mat4::IDENTITY, |library| Material::textured("as it is", texture(library, image.clone())));
    assert_eq!(picture(&moved, &Recipe::default()), picture(&due, &Recipe::default()));
}

/// Returns a texture of a green square, with alpha `edge` at its border, among invisible texels of the colour `hidden`.
fn leaf(hidden: [u8; 3], edge: u8) -> Image<Rgba8> {
    let [r, g, b] = hidden;
    Image::from_fn(16, 16, |x, y| match (x.abs_diff(8).max(y.abs_diff(7)), x) {
        (0..4, _) => [0, 200, 0, 255],
        (4, _) => [0, 200, 0, edge],
        _ => [r, g, b, 0],
    })
}

/// Returns the totals of the overlay “Colour bleeding”: the number of affected pixels and the greatest difference in
/// codes.
fn bleeding(scene: &Scene, recipe: &Recipe) -> [f64; 2] {
    let frame = render(scene, recipe, SIZE);
    let context = OverlayContext {
        scene,
        recipe,
        frame: &frame,
        is_whole: true,
        stats_cache: &Default::default(),
        seams: None,
        shown: &|_, _| Value::Nothing,
        range: None,
    };
    let sheet = Overlay::AlphaBleed.sheet(&context);
    let marked = sheet.values.pixels().iter().filter(|value| !value.is_nan()).count() as f64;
    assert_eq!(marked, sheet.totals[0].number);
    [sheet.totals[0].number, sheet.totals[1].number]
}

#[test]
fn premultiplied_filtering_takes_no_colour_from_hidden_texels_and_the_overlay_shows_bleeding() {
    for (edge, filter) in
        [255, 120].into_iter().flat_map(|edge| TexelFilter::ALL.iter().map(move |filter| (edge, filter)))
    {
        let mut scene = scene_of(square(), Mat4::IDENTITY, |library| {
            Material::textured("leaf", texture(library, leaf([255, 0, 255], edge)))
        });
        scene.background = [0, 0, 0];
        let recipe = |alpha: AlphaMode| {
            recipe(&["shading=texture", &format!("filter={}", filter.id()), &format!("alpha={}", alpha.id())])
        };
        let reds =
            |alpha| picture(&scene, &recipe(alpha)).pixels().iter().filter(|[r, _, b, _]| *r > 0 || *b > 0).count();
        assert_eq!(reds(AlphaMode::Premultiplied), 0, "{edge} {filter:?}");
        assert_eq!(bleeding(&scene, &recipe(AlphaMode::Premultiplied)), [0.0; 2]);
        let ([pixels, codes], straight) = (bleeding(&scene, &recipe(AlphaMode::Straight)), reds(AlphaMode::Straight));
        if *filter == TexelFilter::Point {
            assert_eq!((pixels, codes, straight), (0.0, 0.0, 0));
        } else {
            assert!(pixels >= straight as f64 && straight > 10 && codes > 20.0, "{pixels} {codes} {straight}");
        }
    }
}

#[test]
fn mip_levels_give_hidden_texels_the_colour_that_is_seen() {
    for hidden in [[255, 255, 0], [0, 0, 0], [0, 0, 255]] {
        let [r, g, b] = hidden;
        let image = Image::from_fn(64, 64, |x, _| if x % 32 < 16 { [255, 255, 0, 255] } else { [r, g, b, 0] });
        let texture = Texture::new(image).expect("not empty");
        for linear in [false, true] {
            for level in texture.mip_levels(linear) {
                assert!(level.pixels().iter().all(|[r, g, b, _]| [*r, *g, *b] == [255, 255, 0]), "{hidden:?}");
            }
        }
    }
}

#[test]
fn opaque_textures_are_the_same_under_both_alpha_modes() {
    let mut random = fastrand::Rng::with_seed(9);
    let image = noise_texture(&mut random);
    let scene =
        scene_of(square(), Mat4::IDENTITY, |library| Material::textured("opaque", texture(library, image.clone())));
    for filter in TexelFilter::ALL {
        let filter = format!("filter={}", filter.id());
        let modes =
            AlphaMode::ALL.iter().map(|mode| picture(&scene, &recipe(&[&filter, &format!("alpha={}", mode.id())])));
        let modes: Vec<_> = modes.collect();
        assert_eq!(modes[0], modes[1]);
    }
}

#[test]
fn without_specular_colour_blinn_phong_is_lambert() {
    let scene = common::ground_and_cube();
    assert_eq!(picture(&scene, &recipe(&["shading=blinn-phong"])), picture(&scene, &recipe(&["shading=lambert"])));
}

/// Returns a scene of two objects that use every material feature, one blended and one alpha-tested.
fn everything() -> Scene {
    let mut random = fastrand::Rng::with_seed(10);
    let mut scene = scene_of(cube(), Mat4::from_rotation_y(0.6) * Mat4::from_scale(Vec3::splat(0.6)), |library| {
        full_material(library, &mut random, &[0, 255])
    });
    let material = full_material(&mut scene.library, &mut random, &[0, 120, 255]);
    let (mesh, material) = (scene.library.add_mesh(sphere(8)), scene.library.add_material(material));
    let world_from_model = Mat4::from_translation(Vec3::new(0.3, 0.1, 0.5)) * Mat4::from_scale(Vec3::splat(0.7));
    scene.instances.push(Instance { name: "ball".into(), mesh, material, world_from_model, tint: Vec3::ONE });
    scene
}

fn full_material(library: &mut Library, random: &mut fastrand::Rng, alphas: &[u8]) -> Material {
    let mut noise = |codes: &[u8]| {
        let image = noise_texture(random);
        let image = with_alpha(random, &image, codes);
        Some(texture(library, image))
    };
    Material {
        texture: noise(alphas),
        alpha_texture: noise(&[0, 255]),
        normal_texture: noise(&[255]),
        emission_texture: noise(&[255]),
        normal_scale: 0.5,
        emission: Vec3::new(0.3, 0.2, 0.4),
        specular: Vec3::splat(0.6),
        shininess: 12.0,
        uv_scale: Vec2::new(1.5, -0.75),
        uv_offset: Vec2::new(0.1, 0.2),
        clamp: alphas.len() > 2,
        ..Material::plain("everything", Vec3::new(0.8, 0.7, 0.6))
    }
}

/// Returns recipes that combine shadings, texture filters and alpha modes, and a few with other settings.
fn sweep() -> Vec<Recipe> {
    let mut all = Vec::new();
    for shading in Shading::ALL.iter().filter(|shading| shading.reads_material() || **shading == Shading::Normals) {
        for (filter, alpha) in TexelFilter::ALL.iter().flat_map(|f| AlphaMode::ALL.iter().map(move |a| (f, a))) {
            let mut recipe = Recipe::default();
            (recipe.pipeline.shading, recipe.pipeline.filter, recipe.pipeline.alpha) = (*shading, *filter, *alpha);
            all.push(recipe);
        }
    }
    let more = [
        &["color_space=bytes"][..],
        &["interpolation=affine"],
        &["address=mirror", "color_space=bytes", "alpha=premultiplied"],
        &["antialias.method=multisample"],
        &["antialias.method=jittered"],
        &["depth_test=off", "culling=none"],
        &["force=everything"],
        &["upscaler.method=bilinear"],
        &["blending.order=exact"],
        &["blending.order=exact", "antialias.method=multisample", "alpha=premultiplied"],
    ];
    all.extend(more.map(|settings| recipe(&[&["shading=blinn-phong", "filter=trilinear"], settings].concat())));
    all
}

#[test]
fn both_executions_agree_on_all_material_features() {
    let mut scene = everything();
    for recipe in sweep() {
        picture(&scene, &recipe);
    }
    scene.home = scene.home.with_orthographic(true);
    picture(&scene, &recipe(&["shading=blinn-phong"]));
}

#[test]
fn replays_and_traces_end_in_the_colour_of_the_pixel() {
    let scene = everything();
    let view = Viewport { width: 6, height: 5 };
    let mut traced = 0;
    for recipe in sweep() {
        let frame: Frame = render(&scene, &recipe, (view.width, view.height));
        for (x, y) in (0..view.height).flat_map(|y| (0..view.width).map(move |x| (x, y))) {
            let report = inspect(&scene, &recipe, &frame, x, y).expect("inside of the picture");
            assert_eq!(report.color, frame.image().at(x, y), "{x},{y} {recipe:?}");
            let Some(visible) = report.visible() else { continue };
            let trace = Trace::of(&scene, &recipe, &frame, &report, None);
            let Some(shading) = &visible.shading else { continue };
            for (channel, name) in ["red", "green", "blue"].into_iter().enumerate() {
                let what = format!("{name} code");
                let line = trace.lines.iter().rev().find(|line| line.what == what).expect("a line with the code");
                let number = line.number().expect("a number").to_f64();
                assert_eq!(number, f64::from(shading.color[channel]), "{x},{y} {recipe:?}");
                assert!(line.exact.as_ref().is_none_or(|_| line.rounding_ulp.is_some_and(|ulp| ulp.abs() <= 1.0)));
            }
            traced += 1;
        }
    }
    assert!(traced > 200, "{traced}");
}
