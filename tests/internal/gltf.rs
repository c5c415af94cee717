//! Loading of glTF files: pictures equal to those of the same scene as OBJ, every supported feature, and errors that name
//! the place of a fault.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use glam::{Mat4, Vec2, Vec3};
use rasterscope::chain::{Recipe, run};
use rasterscope::image::{Image, Rgba8, color, file};
use rasterscope::measure::equality::verify;
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::scene::obj::TrMeaning;
use rasterscope::scene::{
    Camera, LoadControl, Loaded, Material, MemoryLimit, Projection, Scene, SceneError, SceneSource, gltf,
};
use serde_json::{Value, json};

use crate::internal::common::{recipe, render};
use crate::internal::gltf_builder::{GltfBuilder, SQUARE, SQUARE_INDICES};
use crate::internal::samples;
use crate::internal::sound::sound;

const SIZE: (u32, u32) = (80, 60);

/// Linear value of the sRGB value 0.5.
const HALF: f32 = 0.214_041_14;

fn load(path: &Path) -> Loaded {
    let loaded = SceneSource::File(path.to_owned(), TrMeaning::Auto).load().unwrap_or_else(|error| panic!("{error}"));
    sound(&loaded).unwrap_or_else(|fault| panic!("{}: {fault}", path.display()));
    loaded
}

fn built(builder: &GltfBuilder) -> Loaded {
    let folder = tempfile::tempdir().unwrap();
    load(&builder.write(folder.path()))
}

/// Returns the error of loading a file, without its path.
fn error(builder: &GltfBuilder) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = builder.write(folder.path());
    let message = SceneSource::File(path.clone(), TrMeaning::Auto).load().unwrap_err().to_string();
    let (named, rest) = message.split_at(path.display().to_string().len());
    assert_eq!(named, path.display().to_string());
    rest.trim_start_matches(": ").to_owned()
}

fn texts(warnings: &[rasterscope::scene::Warning]) -> Vec<&str> {
    warnings.iter().map(|warning| warning.text.as_str()).collect()
}

fn picture(scene: &Scene, settings: &[&str]) -> Image<Rgba8> {
    render(scene, &recipe(settings), SIZE).image().clone()
}

/// Returns a view straight at [`SQUARE`] that it fills exactly.
fn straight(distance: f32) -> Camera {
    let target = Vec3::new(0.5, 0.5, 0.0);
    Camera {
        projection: Projection::Orthographic { height: 1.0 },
        ..Camera::look_at(target + Vec3::Z * distance, target)
    }
}

/// Returns the colours of a scene at the centres of the quarters of [`SQUARE`]: top left, top right, bottom left, bottom
/// right.
fn quarters(scene: &Scene, distance: f32, settings: &[&str]) -> [Rgba8; 4] {
    let viewport = Viewport { width: 8, height: 8 };
    let frame = run(scene, &straight(distance), &recipe(settings), viewport, &mut ());
    [(2, 2), (6, 2), (2, 6), (6, 6)].map(|(x, y)| frame.image().at(x, y))
}

fn material(loaded: &Loaded) -> &Material {
    loaded.scene.library.material(loaded.scene.instances[0].material)
}

/// Writes a scene as OBJ with its vertices in world space, and loads it.
fn as_obj(scene: &Scene, picture: Option<&Path>) -> Loaded {
    let folder = tempfile::tempdir().unwrap();
    let (mut model, mut library) = ("mtllib a.mtl\n".to_owned(), String::new());
    let mut first = 1;
    for (number, instance) in scene.instances.iter().enumerate() {
        let (mesh, material) = (scene.library.mesh(instance.mesh), scene.library.material(instance.material));
        let world = instance.world_from_model.as_dmat4();
        let has_uvs = !mesh.uvs.is_empty();
        for (vertex, (position, normal)) in mesh.positions.iter().zip(&mesh.normals).enumerate() {
            let position = world.transform_point3(position.as_dvec3()).as_vec3();
            let normal = world.inverse().transpose().transform_vector3(normal.as_dvec3()).as_vec3();
            let color = mesh.colors.get(vertex).map_or(String::new(), |c| format!(" {} {} {}", c.x, c.y, c.z));
            let _ = writeln!(model, "v {} {} {}{color}", position.x, position.y, position.z);
            let _ = writeln!(model, "vn {} {} {}", normal.x, normal.y, normal.z);
            let uv = mesh.uvs.get(vertex).copied().unwrap_or_default();
            let _ = writeln!(model, "vt {} {}", uv.x, 1.0 - uv.y);
        }
        let _ = writeln!(model, "o part{number}\nusemtl m{number}");
        for corners in &mesh.triangles {
            let word = |corner: &u32| {
                let index = first + corner;
                if has_uvs { format!("{index}/{index}/{index}") } else { format!("{index}//{index}") }
            };
            let _ = writeln!(model, "f {}", corners.iter().map(word).collect::<Vec<_>>().join(" "));
        }
        first += mesh.positions.len() as u32;
        let Vec3 { x, y, z } = material.diffuse;
        let _ = writeln!(library, "newmtl m{number}\nKd {x} {y} {z}");
        if let (Some(picture), Some(_)) = (picture, material.texture) {
            fs::copy(picture, folder.path().join("t.png")).unwrap();
            library += "map_Kd t.png\n";
        }
    }
    fs::write(folder.path().join("a.obj"), model).unwrap();
    fs::write(folder.path().join("a.mtl"), library).unwrap();
    load(&folder.path().join("a.obj"))
}

/// Checks that a scene and the same scene as OBJ have the same pictures, bit for bit.
fn check_as_obj(loaded: &Loaded, picture_path: Option<&Path>) {
    let other = as_obj(&loaded.scene, picture_path).scene;
    assert_eq!(loaded.scene.home, other.home, "{}", loaded.scene.name);
    for settings in [&["shading=lambert"][..], &["shading=normals"], &["shading=texture", "color_space=bytes"]] {
        let equal = picture(&loaded.scene, settings) == picture(&other, settings);
        assert!(equal, "{} with {settings:?}", loaded.scene.name);
    }
}

/// Returns a cube whose faces have normals and texture coordinates of their own.
fn cube() -> GltfBuilder {
    let (mut positions, mut normals, mut uvs, mut indices) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for axis in 0..3 {
        for sign in [-1.0_f32, 1.0] {
            let first = positions.len() as u32 / 3;
            for [u, v] in [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5_f32]] {
                let mut position = [0.0; 3];
                position[axis] = 0.5 * sign;
                position[(axis + 1) % 3] = u * sign;
                position[(axis + 2) % 3] = v;
                positions.extend(position);
                let mut normal = [0.0; 3];
                normal[axis] = sign;
                normals.extend(normal);
                uvs.extend([u + 0.5, 0.5 - v]);
            }
            indices.extend(SQUARE_INDICES.map(|index| first + index));
        }
    }
    let mut builder = GltfBuilder::empty();
    let attributes = json!({
        "POSITION": builder.floats(&positions, 3), "NORMAL": builder.floats(&normals, 3),
        "TEXCOORD_0": builder.floats(&uvs, 2),
    });
    let indices = builder.indices(&indices);
    builder.mesh(json!({"attributes": attributes, "indices": indices, "material": 0}));
    builder.json["materials"] = json!([{"pbrMetallicRoughness": {"baseColorFactor": [HALF, 0.0, 1.0, 1.0]}}]);
    builder
}

#[test]
fn a_cube_has_the_same_pictures_in_every_encoding_and_as_obj() {
    let folder = tempfile::tempdir().unwrap();
    let cube = cube().with(|json| {
        json["nodes"] = json!([{"children": [1], "translation": [3, 0, 0]}, {"mesh": 0, "translation": [-1, 0.5, 2]}]);
    });
    let files = [cube.write(folder.path()), cube.write_binary(folder.path())].map(|path| load(&path));
    let apart = load(&cube.write_apart(folder.path()));
    for loaded in files.iter().chain([&apart]) {
        assert_eq!(loaded.scene.triangle_count(), 12);
        assert_eq!(loaded.scene.instances[0].world_from_model, Mat4::from_translation(Vec3::new(2.0, 0.5, 2.0)));
        assert_eq!(picture(&loaded.scene, &[]), picture(&apart.scene, &[]));
        check_as_obj(loaded, None);
    }
    // The linear factor is encoded: 0.214 is the sRGB value 0.5.
    let Vec3 { x, y, z } = material(&apart).diffuse;
    assert!((x - 0.5).abs() < 1e-6 && y == 0.0 && z == 1.0, "{x} {y} {z}");
    let seen = picture(&apart.scene, &["shading=texture"]).at(SIZE.0 / 2, SIZE.1 / 2);
    assert_eq!(seen, [128, 0, 255, 255]);
}

/// Texels of a picture of 2 × 2 different colours: top left, top right, bottom left, bottom right.
const FLAG: [Rgba8; 4] = [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255, 255, 0, 255]];

fn write_flag(path: &Path) {
    file::write_png(path, &Image::from_pixels(2, 2, FLAG.to_vec())).unwrap();
}

const UNLIT: [&str; 2] = ["shading=texture", "filter=point"];

/// Returns a square whose base colour texture is the picture at this URI.
fn textured(uri: &str) -> GltfBuilder {
    GltfBuilder::square().with(|json| {
        json["images"] = json!([{"uri": uri}]);
        json["textures"] = json!([{"source": 0}]);
        json["materials"] = json!([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]);
    })
}

#[test]
fn textures_are_upright_from_files_data_uris_and_buffers() {
    use base64::Engine as _;
    let folder = tempfile::tempdir().unwrap();
    let flag = folder.path().join("a flag.png");
    write_flag(&flag);
    let bytes = fs::read(&flag).unwrap();
    let beside = textured("a%20flag.png");
    let embedded =
        textured(&format!("data:image/png;base64,{}", base64::engine::general_purpose::STANDARD.encode(&bytes)));
    let mut buffered = textured("");
    let view = buffered.view(&bytes);
    buffered.json["images"] = json!([{"bufferView": view, "mimeType": "image/png"}]);
    for builder in [beside, embedded, buffered] {
        let loaded = load(&builder.write(folder.path()));
        assert_eq!(quarters(&loaded.scene, 3.0, &UNLIT), FLAG);
        assert_eq!(texts(&loaded.warnings), [""; 0]);
        check_as_obj(&loaded, Some(&flag));
    }
    let missing = built(&textured("missing.png"));
    assert!(missing.warnings[0].text.starts_with("images[0]: texture not loaded"), "{:?}", missing.warnings);
    assert_eq!(quarters(&missing.scene, 3.0, &UNLIT), [[255; 4]; 4]);
}

#[test]
fn texture_transforms_scale_then_rotate_then_move() {
    let folder = tempfile::tempdir().unwrap();
    write_flag(&folder.path().join("flag.png"));
    let with = |transform: Value| {
        let builder = textured("flag.png").with(|json| {
            json["extensionsRequired"] = json!(["KHR_texture_transform"]);
            let base = &mut json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"];
            base["extensions"] = json!({"KHR_texture_transform": transform});
        });
        load(&builder.write(folder.path())).scene
    };
    // An example of the extension's description: the lower left quadrant, rotated.
    let quadrant = with(json!({"offset": [0, 1], "rotation": std::f32::consts::FRAC_PI_2, "scale": [0.5, 0.5]}));
    let uvs = &quadrant.library.meshes()[0].uvs;
    let expected = [[0.5, 1.0], [0.5, 0.5], [0.0, 0.5], [0.0, 1.0]].map(Vec2::from);
    let expected = SQUARE_INDICES.map(|corner| expected[corner as usize]);
    assert!(uvs.len() == 6 && uvs.iter().zip(expected).all(|(uv, expected)| uv.distance(expected) < 1e-6), "{uvs:?}");
    assert_eq!(quarters(&quadrant, 3.0, &UNLIT), [FLAG[2]; 4]);
    // v points up.
    let flipped = with(json!({"offset": [0, 1], "scale": [1, -1]}));
    assert_eq!(quarters(&flipped, 3.0, &UNLIT), [FLAG[2], FLAG[3], FLAG[0], FLAG[1]]);
}

#[test]
fn the_transform_of_a_normal_map_is_applied_or_reported() {
    let folder = tempfile::tempdir().unwrap();
    write_flag(&folder.path().join("flag.png"));
    let texture = |transform: &Value| json!({"index": 0, "extensions": {"KHR_texture_transform": transform}});
    let built = |material: Value| {
        let builder = textured("flag.png").with(|json| json["materials"] = json!([material]));
        load(&builder.write(folder.path()))
    };
    let twice = json!({"scale": [2, 3]});
    let alone = built(json!({"normalTexture": texture(&twice)}));
    assert_eq!(alone.scene.library.meshes()[0].uvs[0], Vec2::new(0.0, 3.0));
    assert_eq!(texts(&alone.warnings), [""; 0]);
    let surface = json!({"baseColorTexture": texture(&twice)});
    let equal = built(json!({"pbrMetallicRoughness": surface, "normalTexture": texture(&twice)}));
    assert_eq!((equal.scene.library.meshes()[0].uvs[0], texts(&equal.warnings)), (Vec2::new(0.0, 3.0), vec![]));
    for normals in [texture(&json!({"scale": [2, 2]})), json!({"index": 0})] {
        let differing = built(json!({"name": "bark", "pbrMetallicRoughness": surface, "normalTexture": normals}));
        assert_eq!(
            texts(&differing.warnings),
            [
                "material bark: the texture coordinates of its normal map differ from those of its base colour, which are \
              used"
            ]
        );
        assert_eq!(differing.scene.library.meshes()[0].uvs[0], Vec2::new(0.0, 3.0));
    }
    let malformed = textured("flag.png").with(|json| {
        json["materials"] = json!([{"normalTexture": texture(&json!({"scale": [2]}))}]);
    });
    let message = error(&malformed);
    let place = "materials[0].normalTexture.extensions.KHR_texture_transform: ";
    assert!(message.starts_with(place) && !message.contains('\n'), "{message}");
}

/// Returns the scene of a square with the alphas 255, 100, 40 and 0 in its quarters, white, in front of green.
fn with_alpha(mode: &Value) -> Scene {
    let folder = tempfile::tempdir().unwrap();
    let texels = [255, 100, 40, 0].map(|alpha| [255, 255, 255, alpha]);
    file::write_png(&folder.path().join("alpha.png"), &Image::from_pixels(2, 2, texels.to_vec())).unwrap();
    let builder = textured("alpha.png").with(|json| {
        for (key, value) in mode.as_object().unwrap() {
            json["materials"][0][key] = value.clone();
        }
    });
    let mut scene = load(&builder.write(folder.path())).scene;
    scene.background = [0, 255, 0];
    scene
}

#[test]
fn alpha_is_ignored_tested_or_blended_as_the_material_says() {
    let (white, green) = ([255; 4], [0, 255, 0, 255]);
    let pbr = |alpha: f32| json!({"baseColorTexture": {"index": 0}, "baseColorFactor": [1, 1, 1, alpha]});
    let bytes = [&UNLIT[..], &["color_space=bytes"]].concat();
    for (mode, expected) in [
        (json!({}), [white; 4]),
        (json!({"alphaMode": "MASK"}), [white, green, green, green]),
        (json!({"alphaMode": "MASK", "alphaCutoff": 0.3}), [white, white, green, green]),
        (json!({"alphaMode": "MASK", "alphaCutoff": 0.0}), [white; 4]),
        (json!({"alphaMode": "MASK", "alphaCutoff": 1.5}), [green; 4]),
        // 100 / 255 · 0.5 is below the threshold, and 255 / 255 · 0.5 is not.
        (
            json!({"alphaMode": "MASK", "alphaCutoff": 0.3, "pbrMetallicRoughness": pbr(0.5)}),
            [white, green, green, green],
        ),
        (json!({"alphaMode": "BLEND"}), [white, [100, 255, 100, 255], [40, 255, 40, 255], green]),
    ] {
        let scene = with_alpha(&mode);
        assert_eq!(quarters(&scene, 3.0, &bytes), expected, "{mode}");
        // Tiled execution draws the same.
        for filter in ["filter=point", "filter=bilinear", "filter=trilinear"] {
            let equality = verify(
                &Arc::new(scene.clone()),
                &straight(3.0),
                &recipe(&[filter]),
                Viewport { width: 33, height: 20 },
                &[1],
            );
            assert!(equality.unwrap().ways.iter().all(|way| way.difference.is_none()), "{mode} {filter}");
        }
    }
}

#[test]
fn a_mask_without_a_texture_is_drawn_whole_or_not_at_all() {
    for (alpha, is_drawn) in [(0.6, true), (0.4, false)] {
        let builder = GltfBuilder::square().with(|json| {
            let pbr = json!({"baseColorFactor": [1, 1, 1, alpha]});
            json["materials"] = json!([{"alphaMode": "MASK", "pbrMetallicRoughness": pbr}]);
        });
        let scene = built(&builder).scene;
        assert_eq!(quarters(&scene, 3.0, &UNLIT)[0] == [255; 4], is_drawn, "{alpha}");
        let tiled =
            verify(&Arc::new(scene.clone()), &scene.home, &Recipe::default(), Viewport { width: 21, height: 17 }, &[1]);
        assert!(tiled.unwrap().ways.iter().all(|way| way.difference.is_none()), "{alpha}");
    }
}

#[test]
fn double_sided_materials_are_drawn_from_behind() {
    for (double_sided, expected) in [(false, [38, 38, 38, 255]), (true, [255; 4])] {
        let builder = GltfBuilder::square().with(|json| json["materials"] = json!([{"doubleSided": double_sided}]));
        let scene = Arc::new(built(&builder).scene);
        assert_eq!(quarters(&scene, 3.0, &UNLIT), [[255; 4]; 4]);
        assert_eq!(quarters(&scene, -3.0, &UNLIT), [expected; 4]);
        for settings in ["culling=back", "culling=front", "force=everything"] {
            let size = Viewport { width: 21, height: 17 };
            let equality = verify(&scene, &straight(-3.0), &recipe(&[settings]), size, &[1]).unwrap();
            assert!(equality.ways.iter().all(|way| way.difference.is_none()), "{settings}");
        }
    }
}

#[test]
fn a_mirrored_node_keeps_its_front_faces() {
    let builder = GltfBuilder::square().with(|json| {
        json["nodes"] = json!([
            {"children": [1, 2]},
            {"mesh": 0, "scale": [-1, 1, 1], "translation": [1, 0, 0]},
            {"mesh": 0, "translation": [5, 0, 0]},
        ]);
    });
    let scene = built(&builder).scene;
    assert_eq!(quarters(&scene, 3.0, &UNLIT), [[255; 4]; 4]);
    assert_eq!((scene.library.meshes().len(), scene.instances.len()), (2, 2));
    assert_eq!(scene.home, scene.mirrored_z().mirrored_z().home);
}

#[test]
fn meshes_are_shared_by_their_nodes() {
    let builder = GltfBuilder::square().with(|json| {
        json["nodes"] = json!([{"children": [1, 2], "name": "root"}, {"mesh": 0, "name": "left"}, {"mesh": 0}]);
        json["meshes"][0]["name"] = json!("square");
    });
    let scene = built(&builder).scene;
    let names: Vec<_> = scene.instances.iter().map(|instance| instance.name.as_str()).collect();
    assert_eq!((names, scene.library.meshes().len()), (vec!["left", "square"], 1));
}

/// Returns the corner positions of all triangles.
fn corners(scene: &Scene) -> Vec<[Vec3; 3]> {
    let mesh = &scene.library.meshes()[0];
    mesh.triangles.iter().map(|corners| corners.map(|corner| mesh.positions[corner as usize])).collect()
}

#[test]
fn strips_and_fans_become_front_facing_triangles() {
    // A strip in zigzag, with a repeated vertex as exporters write between two strips.
    for (mode, indices, count) in [(4, &[0, 1, 2, 0, 2, 3][..], 2), (5, &[0, 1, 3, 2, 2], 2), (6, &[0, 1, 2, 3], 2)] {
        let mut builder = GltfBuilder::empty();
        let (positions, indices) = (builder.floats(&SQUARE, 3), builder.indices(indices));
        builder.mesh(json!({"attributes": {"POSITION": positions}, "indices": indices, "mode": mode}));
        let loaded = built(&builder);
        let triangles = corners(&loaded.scene);
        assert_eq!(triangles.len(), count, "{mode}");
        assert!(triangles.iter().all(|[a, b, c]| (*b - *a).cross(*c - *a) == Vec3::Z), "{mode}: {triangles:?}");
        assert!(loaded.scene.library.meshes()[0].normals.iter().all(|normal| *normal == Vec3::Z));
        assert_eq!(texts(&loaded.warnings), [""; 0], "{mode}");
    }
}

#[test]
fn missing_normals_are_flat_and_unused_vertices_are_left_out() {
    let mut builder = GltfBuilder::empty();
    // Two triangles that share an edge at a right angle, and vertices that no index uses.
    let positions = builder.floats(&[9., 9., 9., 0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0., -1., 8., 8., 8.], 3);
    let normals = builder.floats(&[0., 0., 2.].repeat(6), 3);
    let indices = builder.indices(&[1, 2, 3, 1, 3, 4]);
    builder.mesh(json!({"attributes": {"POSITION": positions}, "indices": indices}));
    let few = builder.indices(&[1, 2, 3]);
    builder.mesh(json!({"attributes": {"POSITION": positions, "NORMAL": normals}, "indices": few}));
    builder.json["nodes"] = json!([{"mesh": 0}, {"mesh": 1}]);
    builder.json["scenes"] = json!([{"nodes": [0, 1]}]);
    let scene = built(&builder).scene;
    let [flat, given] = scene.library.meshes() else { panic!("two meshes") };
    assert_eq!(flat.normals, [[Vec3::Z; 3], [Vec3::NEG_X; 3]].concat());
    assert_eq!(
        (given.positions.as_slice(), given.normals.as_slice()),
        (&[Vec3::ZERO, Vec3::X, Vec3::Y][..], &[Vec3::Z; 3][..])
    );
}

#[test]
fn sparse_accessors_replace_elements() {
    let mut builder = GltfBuilder::square();
    let (places, values) =
        (builder.view(&[1, 0, 3, 0]), builder.view(&[7.0_f32, 0., 0., 0., 8., 0.].map(f32::to_le_bytes).concat()));
    let sparse = json!({
        "count": 2, "indices": {"bufferView": places, "componentType": 5123}, "values": {"bufferView": values},
    });
    builder.json["accessors"][0]["sparse"] = sparse.clone();
    let expected = [Vec3::ZERO, Vec3::X * 7.0, Vec3::new(1.0, 1.0, 0.0), Vec3::Y * 8.0];
    let triangle =
        |positions: [Vec3; 4]| [[positions[0], positions[1], positions[2]], [positions[0], positions[2], positions[3]]];
    assert_eq!(corners(&built(&builder).scene), triangle(expected));
    // Without a buffer view, the other elements are zero.
    builder.json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    let indices = builder.indices(&[0, 1, 3]);
    builder.json["meshes"][0]["primitives"][0]["indices"] = json!(indices);
    assert_eq!(corners(&built(&builder).scene), [[Vec3::ZERO, Vec3::X * 7.0, Vec3::Y * 8.0]]);
}

#[test]
fn integers_are_normalised_and_vertex_colours_are_encoded() {
    let mut builder = GltfBuilder::square();
    let colors = builder.view(&[0, 128, 255, 255].repeat(4));
    let accessors = builder.json["accessors"].as_array_mut().unwrap();
    accessors
        .push(json!({"bufferView": colors, "componentType": 5121, "count": 4, "type": "VEC4", "normalized": true}));
    let accessor = accessors.len() - 1;
    builder.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(accessor);
    let loaded = built(&builder);
    let encoded = Vec3::new(0.0, color::encode(128.0 / 255.0), 1.0);
    assert!(loaded.scene.library.meshes()[0].colors.iter().all(|color| *color == encoded));
    assert_eq!(quarters(&loaded.scene, 3.0, &["shading=texture"])[0], [0, color::quantize(encoded.y), 255, 255]);
    assert_eq!(texts(&loaded.warnings), [""; 0]);
}

#[test]
fn cameras_become_views_and_the_first_directional_light_the_light() {
    let half_turn = [0.0, 1.0, 0.0, 0.0];
    let quarter = std::f32::consts::FRAC_1_SQRT_2;
    let builder = GltfBuilder::square().with(|json| {
        json["cameras"] = json!([
            {"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.25}, "name": "lens"},
            {"type": "orthographic", "orthographic": {"xmag": 3, "ymag": 2, "znear": 0, "zfar": 50}},
            {"type": "perspective", "perspective": {"yfov": 4, "znear": 0.25}},
        ]);
        json["extensionsUsed"] = json!(["KHR_lights_punctual"]);
        json["extensions"] = json!({"KHR_lights_punctual": {"lights": [
            {"type": "point"}, {"type": "directional", "intensity": 3}, {"type": "directional"},
        ]}});
        let light = |index: usize| json!({"KHR_lights_punctual": {"light": index}});
        json["nodes"] = json!([
            {"mesh": 0},
            {"camera": 0, "translation": [0.5, 0.5, -4], "rotation": half_turn},
            {"camera": 1, "translation": [0.5, 9, 0], "rotation": [-quarter, 0.0, 0.0, quarter], "name": "map"},
            {"camera": 2}, {"extensions": light(0)}, {"extensions": light(1), "rotation": [-quarter, 0.0, 0.0, quarter]},
            {"extensions": light(2)},
        ]);
        json["scenes"] = json!([{"nodes": [0, 1, 2, 3, 4, 5, 6]}]);
    });
    let loaded = built(&builder);
    let [lens, map] = loaded.scene.views.as_slice() else { panic!("{:?}", loaded.scene.views) };
    assert_eq!((lens.name.as_str(), map.name.as_str()), ("lens", "map"));
    let Camera { eye, target, projection, near, far, .. } = lens.camera;
    assert_eq!((eye, projection, near), (Vec3::new(0.5, 0.5, -4.0), Projection::Perspective { fov_y: 0.7 }, 0.25));
    assert!(
        lens.camera.forward().distance(Vec3::Z) < 1e-6 && target.distance(Vec3::new(0.5, 0.5, 0.0)) < 1e-5 && far > 4.0
    );
    assert!(map.camera.forward().distance(Vec3::NEG_Y) < 1e-6 && map.camera.up.distance(Vec3::NEG_Z) < 1e-6);
    assert_eq!((map.camera.projection, map.camera.far), (Projection::Orthographic { height: 4.0 }, 50.0));
    assert!(loaded.scene.light.is_some_and(|light| light.distance(Vec3::Y) < 1e-6));
    let warnings = texts(&loaded.warnings);
    assert_eq!(warnings.len(), 3, "{warnings:?}");
    assert!(warnings[2].starts_with("the camera \"camera 2\" is not usable"), "{warnings:?}");
    assert_eq!(warnings[..2], ["point lights are not rendered", "further directional lights are not rendered"]);

    let (dark, mut recipe) = (built(&GltfBuilder::square()).scene, Recipe::default());
    recipe.take_light(&loaded.scene, None);
    assert_eq!(Some(recipe.pipeline.light.direction), loaded.scene.light);
    recipe.take_light(&dark, Some(&loaded.scene));
    assert_eq!(recipe, Recipe::default());
    recipe.pipeline.light.direction = Vec3::X;
    recipe.take_light(&dark, Some(&loaded.scene));
    assert_eq!(recipe.pipeline.light.direction, Vec3::X, "a light that the user has set stays");
    let mirrored = loaded.scene.mirrored_z();
    assert_eq!(mirrored.views[0].camera, lens.camera.mirrored_z());
}

#[test]
fn content_that_is_not_rendered_is_reported_once() {
    let mut builder = GltfBuilder::square();
    let primitive = builder.json["meshes"][0]["primitives"][0].clone();
    let with = |key: &str, value: Value| {
        let mut changed = primitive.clone();
        changed[key] = value;
        changed
    };
    let mut custom = primitive.clone();
    custom["attributes"]["_SCALAR"] = json!(1);
    builder.json["meshes"][0]["primitives"] = json!([
        primitive,
        with("mode", json!(0)),
        with("mode", json!(1)),
        with("mode", json!(3)),
        custom,
        with("targets", json!([{"POSITION": 0}])),
    ]);
    let builder = builder.with(|json| {
        json["skins"] = json!([{"joints": [1]}]);
        json["nodes"] = json!([{"mesh": 0, "skin": 0, "scale": [9, 9, 9]}, {}]);
        json["animations"] = json!([{"channels": [], "samplers": []}, {"channels": [], "samplers": []}]);
        json["extensionsUsed"] = json!(["KHR_materials_unlit"]);
        json["materials"] = json!([{"occlusionTexture": {"index": 0}}]);
        (json["textures"], json["images"]) = (json!([{"source": 0}]), json!([{"uri": "x.png"}]));
    });
    let loaded = built(&builder);
    let mut warnings = texts(&loaded.warnings);
    warnings.sort_unstable();
    assert_eq!(
        warnings,
        [
            "lines are not rendered (2 times)",
            "occlusion maps are not rendered",
            "points are not rendered",
            "skins[0]: a joint is not part of the scene; the mesh is shown in its bind pose",
            "the extension KHR_materials_unlit is not rendered",
        ]
    );
    let notes = texts(&loaded.notes);
    assert!(notes.contains(&"the animation animation 0 is shown; the file also has animation 1"), "{notes:?}");
    assert!(notes.contains(&"the vertex attribute _SCALAR is not rendered"), "{notes:?}");
    assert_eq!(loaded.scene.instances[0].world_from_model, Mat4::IDENTITY, "joints place skinned meshes");
}

#[test]
fn required_extensions_are_refused_by_name() {
    for (extension, word) in [
        ("KHR_draco_mesh_compression", "Draco"),
        ("EXT_meshopt_compression", "meshopt"),
        ("KHR_texture_basisu", "KTX2"),
        ("ACME_unheard_of", "not supported"),
    ] {
        let message = error(&GltfBuilder::square().with(|json| json["extensionsRequired"] = json!([extension])));
        assert!(message.contains(extension) && message.contains(word), "{message}");
    }
}

#[test]
fn own_files_load_with_all_their_features() {
    let folder = samples::own().join("gltf");
    for name in ["square.gltf", "square.glb"] {
        let loaded = load(&folder.join(name));
        assert_eq!((loaded.scene.triangle_count(), loaded.scene.instances[0].name.as_str()), (2, "flag"));
        assert_eq!(quarters(&loaded.scene, 3.0, &UNLIT), FLAG);
        assert!(loaded.warnings.is_empty() && loaded.notes.is_empty(), "{loaded:?}");
    }
    let [text, binary] = ["features.gltf", "features.glb"].map(|name| load(&folder.join(name)));
    assert_eq!(picture(&text.scene, &[]), picture(&binary.scene, &[]));
    assert_eq!((text.scene.triangle_count(), text.scene.views.len()), (14, 2));
    assert_eq!(texts(&text.warnings), ["points are not rendered (2 times)"]);
    let moving = load(&folder.join("moving.gltf"));
    assert!(moving.warnings.is_empty() && moving.scene.animation.is_some(), "{:?}", moving.warnings);
}

#[test]
fn faults_are_errors_that_name_their_place() {
    type Change = fn(&mut Value);
    let faults: [(Change, &str); 27] = [
        (|json| json["asset"]["version"] = json!("1.0"), "asset.version"),
        (|json| json["meshes"] = json!([]), "nodes[0].mesh: the index refers to nothing"),
        (|json| json["nodes"] = json!([{}]), "no triangles"),
        (|json| json["nodes"] = json!([{"children": [0]}]), "nodes[0]: it has two parents, or contains itself"),
        (|json| json["nodes"] = json!([{"children": [1, 1]}, {"mesh": 0}]), "nodes[1]: it has two parents"),
        (|json| json["nodes"][0]["matrix"] = json!(vec![1; 16]), "nodes[0]: its matrix is not affine"),
        (|json| json["nodes"][0]["rotation"] = json!([0, 0, 0, 0]), "nodes[0]: its rotation is zero"),
        (
            |json| {
                json["nodes"] = json!([{"children": [1], "scale": [1e30, 1, 1]}, {"mesh": 0, "scale": [1e30, 1, 1]}]);
            },
            "nodes[1]: its transform is too large",
        ),
        (|json| json["nodes"][0]["scale"] = json!([1e39, 1, 1]), "number out of range"),
        (|json| json["nodes"][0]["translation"] = json!([1e30, 1, 1]), "too large"),
        (|json| json["accessors"][0]["count"] = json!(5), "accessors[0]: 5 elements"),
        (
            |json| {
                json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(3);
                let colors = json!({"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"});
                json["accessors"].as_array_mut().unwrap().push(colors);
            },
            "accessors[3]: it has 3 elements for 4 vertices",
        ),
        (|json| json["accessors"][0]["count"] = json!(4_294_967_296_u64), "accessors[0]: it has too many elements"),
        (|json| json["accessors"][0]["byteOffset"] = json!(u64::MAX), "accessors[0]: 4 elements from byte"),
        (|json| json["accessors"][0]["type"] = json!("VEC2"), "accessors[0]: its type must be VEC3"),
        (
            |json| json["accessors"][0]["componentType"] = json!(5124),
            "accessors[0].componentType: the value is invalid",
        ),
        (|json| json["accessors"][0]["max"] = json!(vec![1; 17]), "accessors[0]: min or max"),
        (|json| drop(json["accessors"][0].as_object_mut().unwrap().remove("min")), "attributes[\"POSITION\"].min"),
        (|json| json["accessors"][2]["componentType"] = json!(5126), "accessors[2]: indices"),
        // As 16-bit integers, two corners of every triangle are equal.
        (|json| json["accessors"][2]["componentType"] = json!(5123), "no triangles"),
        (|json| json["bufferViews"][0]["byteLength"] = json!(1 << 20), "bufferViews[0]: 1048576 bytes"),
        (|json| json["bufferViews"][0]["byteOffset"] = json!(u64::MAX), "bufferViews[0]:"),
        (|json| json["bufferViews"][0]["byteStride"] = json!(8), "accessors[0]: its stride of 8 bytes"),
        (
            |json| json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(9),
            "meshes[0].primitives[0].attributes.POSITION",
        ),
        (
            |json| json["buffers"] = json!([{"byteLength": 8, "uri": "data:;base64,AAAA"}]),
            "buffers[0]: it has 3 of 8 bytes",
        ),
        (
            |json| json["buffers"] = json!([{"byteLength": 8, "uri": "http://example.org/a"}]),
            "buffers[0]: \"http://example.org/a\"",
        ),
        (|json| json["buffers"] = json!([{"byteLength": 8}]), "buffers[0]: it has no `uri`"),
    ];
    for (change, place) in faults {
        let message = error(&GltfBuilder::square().with(change));
        assert!(message.contains(place) && !message.contains('\n'), "{place}: {message}");
    }
    let mut builder = GltfBuilder::square();
    let indices = builder.indices(&[0, 1, 4]);
    builder.json["meshes"][0]["primitives"][0]["indices"] = json!(indices);
    assert_eq!(error(&builder), "meshes[0].primitives[0]: an index refers to vertex 4 of 4");
}

#[test]
fn broken_containers_are_named_errors_and_never_a_panic() {
    let folder = tempfile::tempdir().unwrap();
    let check = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        let result = SceneSource::File(path, TrMeaning::Auto).load();
        result.map_err(|error| error.to_string()).map(|loaded| sound(&loaded).unwrap())
    };
    let whole = GltfBuilder::square().binary();
    for end in 4..whole.len() {
        let message = check("cut.glb", &whole[..end]).unwrap_err();
        assert!(message.contains("cut.glb"), "{message}");
    }
    for at in 0..whole.len() {
        for value in [0, 1, 0x7F, 0xFF, whole[at] ^ 0x20] {
            let mut changed = whole.clone();
            changed[at] = value;
            let _ =
                check("changed.glb", &changed).map_err(|message| assert!(message.contains("changed.glb"), "{message}"));
        }
    }
    assert!(check("line.gltf", b"{\"asset\":\n {\"version\": 2}}").unwrap_err().contains("line.gltf:2: "));
    assert!(check("lfs.glb", b"version https://git-lfs.github.com/spec/v1\n").unwrap_err().contains("git lfs pull"));
    assert!(check("empty.gltf", b"").unwrap_err().contains("empty.gltf: "));
}

#[test]
fn memory_is_limited_and_loading_can_be_cancelled() {
    let folder = tempfile::tempdir().unwrap();
    // 100 000 nodes place the same two triangles.
    let builder = GltfBuilder::square().with(|json| {
        json["nodes"] = Value::Array(vec![json!({"mesh": 0}); 100_000]);
        json["scenes"] = json!([{"nodes": (0..100_000).collect::<Vec<_>>()}]);
    });
    let path = builder.write(folder.path());
    let limited = |mib| gltf::load_with(&path, TrMeaning::Auto, LoadControl::quiet(MemoryLimit::mib(mib)));
    assert!(limited(40).unwrap_err().to_string().contains("memory limit of 40 MiB"));
    assert_eq!(limited(1000).unwrap().scene.instances.len(), 100_000);
    let cancel = AtomicBool::new(true);
    let control = LoadControl { memory: MemoryLimit::default(), progress: &|_| {}, cancel: &cancel };
    assert!(matches!(gltf::load_with(&path, TrMeaning::Auto, control), Err(SceneError::Cancelled { .. })));
    // An accessor without data takes no memory that the file does not justify.
    let zeros = GltfBuilder::square().with(|json| {
        let accessor = &mut json["accessors"][0];
        (accessor["count"], accessor["bufferView"]) = (json!(100_000_000), Value::Null);
        accessor["sparse"] = json!({
            "count": 1, "indices": {"bufferView": 2, "componentType": 5121}, "values": {"bufferView": 0},
        });
    });
    assert!(error(&zeros).contains("accessors[0]: it has 100000000 elements, but no data"), "{}", error(&zeros));
}

#[test]
fn a_texture_beyond_the_memory_limit_is_not_decoded() {
    let folder = tempfile::tempdir().unwrap();
    file::write_png(&folder.path().join("large.png"), &Image::filled(2048, 2048, [1, 2, 3, 255])).unwrap();
    let path = textured("large.png").write(folder.path());
    let loaded = gltf::load_with(&path, TrMeaning::Auto, LoadControl::quiet(MemoryLimit::mib(100))).unwrap();
    assert_eq!(loaded.scene.library.textures().len(), 0);
    assert!(loaded.warnings[0].text.contains("2048 × 2048 texels"), "{:?}", loaded.warnings);
}

/// Returns the number of triangles, warnings and views of an external file, or the expected part of its error.
const EXTERNAL: [(&str, Result<[usize; 2], &str>); 16] = [
    ("Box.glb", Ok([12, 0])),
    ("BoxSeparate/Box.gltf", Ok([12, 0])),
    ("BoxEmbedded.gltf", Ok([12, 0])),
    ("BoxTextured/BoxTextured.gltf", Ok([12, 0])),
    ("BoxVertexColors.glb", Ok([12, 1])),
    ("BoxDraco.gltf", Err("KHR_draco_mesh_compression")),
    ("BoxMeshopt.glb", Err("EXT_meshopt_compression")),
    ("BoxSparse.glb", Ok([12, 0])),
    ("bad_minimal_accessor.gltf", Err("meshes[0].primitives[0].attributes[\"POSITION\"].min")),
    ("bad_no_buffer_view.gltf", Err("accessors[0].bufferView")),
    ("Fox.glb", Ok([576, 0])),
    ("SimpleSkin.gltf", Ok([8, 0])),
    ("primitives.glb", Ok([12, 0])),
    ("alien.glb", Ok([292, 0])),
    ("CornellBox.glb", Ok([36, 1])),
    ("Cubes.glb", Ok([36, 1])),
];

#[test]
fn external_files_load_as_described() {
    let Some(folder) = samples::external().map(|folder| folder.join("gltf")).filter(|folder| folder.is_dir()) else {
        return;
    };
    for (name, expected) in EXTERNAL {
        let path = folder.join(name);
        let result = SceneSource::File(path.clone(), TrMeaning::Auto).load();
        match (expected, result) {
            (Ok(expected), Ok(loaded)) => {
                sound(&loaded).unwrap_or_else(|fault| panic!("{name}: {fault}"));
                let counts = [loaded.scene.triangle_count(), loaded.warnings.len()];
                assert_eq!(counts, expected, "{name}: {:?}", loaded.warnings);
                if name.contains("Box") && name != "CornellBox.glb" {
                    let beside = path.with_file_name("CesiumLogoFlat.png");
                    check_as_obj(&loaded, Some(&beside).filter(|path| path.is_file()).map(std::path::PathBuf::as_path));
                }
            }
            (Err(part), Err(error)) => {
                let message = error.to_string();
                assert!(message.contains(name) && message.contains(part), "{message}");
            }
            (expected, result) => panic!("{name}: {result:?} instead of {expected:?}"),
        }
    }
}
