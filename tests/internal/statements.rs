//! Effects of the statements of models and material libraries, and warnings about statements without effect.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use glam::{Vec2, Vec3};
use rasterscope::chain::{Frame, Recipe, run};
use rasterscope::image::{Image, Rgba8, file};
use rasterscope::inspect::Fates;
use rasterscope::inspect::fates::TriangleFate;
use rasterscope::inspect::inspect;
use rasterscope::inspect::mesh_view::{self, Inner, MeshNormals, MeshStyle, Painting, paint};
use rasterscope::inspect::pixel::TextureMap;
use rasterscope::inspect::selection::TriangleSelection;
use rasterscope::pipeline::settings::{Choice as _, Settings};
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::scene::obj::{self, TrMeaning};
use rasterscope::scene::{Alpha, LoadControl, Loaded, Material, MemoryLimit, Scene, TriangleId};

const SQUARE: &str = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
const FACE: &str = "f 1/1 2/2 3/3 4/4\n";

/// Creates a folder with a model `a.obj`, a square in the material `m`, and a material library `a.mtl` with this text.
fn folder_with(library: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.obj"), format!("mtllib a.mtl\n{SQUARE}usemtl m\n{FACE}")).unwrap();
    fs::write(folder.path().join("a.mtl"), library).unwrap();
    folder
}

/// Returns the warnings of a loaded model, without the path of their folder.
fn warnings(loaded: &Loaded, folder: &Path) -> Vec<String> {
    let prefix = format!("{}/", folder.display());
    loaded.warnings.iter().map(|warning| warning.to_string().replacen(&prefix, "", 1)).collect()
}

fn load(folder: &Path) -> (Loaded, Vec<String>) {
    let loaded = obj::load(&folder.join("a.obj")).unwrap();
    let texts = warnings(&loaded, folder);
    (loaded, texts)
}

fn material(scene: &Scene) -> &Material {
    scene.library.material(scene.instances[0].material)
}

fn write_picture(path: &Path, texels: &[Rgba8]) {
    file::write_png(path, &Image::from_pixels(texels.len() as u32, 1, texels.to_vec())).unwrap();
}

/// Returns the texels of a texture of the scene's library.
fn texels(scene: &Scene, texture: Option<rasterscope::scene::TextureId>) -> &[Rgba8] {
    scene.library.texture(texture.unwrap()).image().pixels()
}

#[test]
fn colours_and_numbers_reach_the_material() {
    let folder = folder_with("newmtl m\nKE 1 0.5 0\nKs 0.25\nnS 77\nkd 0.1 0.2 0.3\n");
    let (loaded, reported) = load(folder.path());
    let Material { emission, specular, shininess, diffuse, .. } = material(&loaded.scene);
    assert_eq!((*emission, *specular, *shininess), (Vec3::new(1.0, 0.5, 0.0), Vec3::splat(0.25), 77.0));
    assert_eq!(*diffuse, Vec3::new(0.1, 0.2, 0.3));
    assert!(reported.is_empty(), "{reported:?}");
}

#[test]
fn texture_coordinates_are_moved_as_the_file_says_with_v_up() {
    let folder = folder_with("newmtl m\nmap_Kd -o 0.25 0.5 -s 2 4 -clamp on a.png\n");
    write_picture(&folder.path().join("a.png"), &[[1, 2, 3, 255]]);
    let (loaded, reported) = load(folder.path());
    let Material { uv_scale, uv_offset, clamp, .. } = *material(&loaded.scene);
    assert!(clamp && reported.is_empty(), "{reported:?}");
    for up in [Vec2::ZERO, Vec2::new(0.5, 0.25), Vec2::new(-1.0, 3.0)] {
        let down = Vec2::new(up.x, 1.0 - up.y);
        let expected = up * Vec2::new(2.0, 4.0) + Vec2::new(0.25, 0.5);
        assert_eq!(down * uv_scale + uv_offset, Vec2::new(expected.x, 1.0 - expected.y));
    }
}

#[test]
fn an_opacity_texture_is_read_from_alpha_luminance_or_the_named_channel() {
    for (texel, options, expected) in [
        ([200, 200, 200, 255], "", 200),
        ([200, 200, 200, 77], "", 77),
        ([10, 20, 30, 255], "-imfchan r ", 10),
        ([10, 20, 30, 255], "-imfchan B ", 30),
        ([10, 20, 30, 77], "-imfchan m ", 77),
        ([255, 0, 0, 77], "-imfchan l ", 54),
    ] {
        let folder = folder_with(&format!("newmtl m\nKd 1 1 1\nMap_D {options}mask.png\n"));
        write_picture(&folder.path().join("mask.png"), &[texel]);
        let (loaded, reported) = load(folder.path());
        let texture = material(&loaded.scene).alpha_texture;
        assert_eq!(texels(&loaded.scene, texture)[0][3], expected, "{options}{texel:?}");
        assert!(reported.is_empty(), "{reported:?}");
    }
}

#[test]
fn the_alpha_of_a_picture_that_is_named_twice_counts_once() {
    let folder = folder_with("newmtl m\nmap_Kd leaf.png\nmap_d leaf.png\n");
    write_picture(&folder.path().join("leaf.png"), &[[1, 2, 3, 128]]);
    let (loaded, reported) = load(folder.path());
    assert_eq!(material(&loaded.scene).alpha_texture, None);
    assert!(material(&loaded.scene).texture.is_some() && reported.is_empty(), "{reported:?}");
}

#[test]
fn bump_maps_are_rendered_if_their_texels_are_normals() {
    let (normal, height) = ([150, 120, 250, 255], [90, 90, 90, 255]);
    for (keyword, texel, is_rendered, text) in [
        ("norm", normal, true, ""),
        ("bump", normal, true, ""),
        ("map_Bump", height, false, "a.mtl:2: texture \"b.png\" is a height map, which is not rendered"),
        ("NORM", height, true, "a.mtl:2: texture \"b.png\" does not look like a tangent-space normal map"),
    ] {
        let folder = folder_with(&format!("newmtl m\n{keyword} -bm 3 b.png\n"));
        write_picture(&folder.path().join("b.png"), &[texel; 3]);
        let (loaded, reported) = load(folder.path());
        let found = material(&loaded.scene);
        assert_eq!(found.normal_texture.is_some(), is_rendered, "{keyword}");
        assert_eq!(found.normal_scale, 3.0, "{keyword}");
        assert!(reported.join("").starts_with(text) && reported.is_empty() == text.is_empty(), "{reported:?}");
    }
}

#[test]
fn statements_that_are_not_rendered_give_one_warning_each() {
    let folder =
        folder_with("newmtl m\nPr 0.2\nPM 1\nmap_Pr r.png\naniso 0.5\nillum 2\nNi 1\nKa 1 1 1\nnewmtl n\nPr 1\n");
    let model =
        format!("mtllib a.mtl\n{SQUARE}usemtl m\n{FACE}P 1\nl 1 2\nl 2 3\ncurv 0 1 1 2\nbevel on\nnonsense 1\n");
    fs::write(folder.path().join("a.obj"), model).unwrap();
    let (_, reported) = load(folder.path());
    let expected = [
        "a.obj:12: `p` (points) is not rendered",
        "a.obj:13: `l` (lines) is not rendered (2 times, here first)",
        "a.obj:15: `curv` (curve) is not rendered",
        "a.obj:16: `bevel` (bevel interpolation) is not rendered",
        "a.obj:17: unknown statement \"nonsense\"; ignored",
        "a.mtl:2: `Pr` (roughness (PBR)) is not rendered (2 times, here first)",
        "a.mtl:3: `Pm` (metalness (PBR)) is not rendered",
        "a.mtl:4: `map_Pr` (roughness texture (PBR)) is not rendered",
        "a.mtl:5: `aniso` (anisotropy (PBR)) is not rendered",
        "a.mtl:6: `illum` (illumination model; `shading` is a setting) is not rendered",
        "a.mtl:7: `Ni` (index of refraction) is not rendered",
        "a.mtl:8: `Ka` (ambient colour; ambient light is a setting) is not rendered",
    ];
    assert_eq!(reported, expected);
}

#[test]
fn the_meaning_of_tr_is_inferred_unless_it_is_given() {
    let meshlab = "# Converted by Meshlab Group\nnewmtl m\nTr 0.75\n";
    for (library, expected, reason) in [
        ("newmtl m\nTr 1\n", 1.0, "every material would be invisible otherwise"),
        ("newmtl m\nTr 0.25\n", 0.75, ""),
        ("newmtl m\nTr 0.25\nnewmtl n\nd 0.9\nTr 0.9\n", 0.25, "it equals `d` where both are given"),
        ("newmtl m\nTr 0.25\nnewmtl n\nd 0.9\nTr 0.1\n", 0.75, ""),
        (meshlab, 0.75, "the file was written by MeshLab"),
        ("newmtl m\nd 0\nTr 1\n", 0.0, ""),
    ] {
        let folder = folder_with(library);
        let (loaded, reported) = load(folder.path());
        assert_eq!(material(&loaded.scene).opacity, expected, "{library}");
        let said =
            reported.iter().any(|text| text.contains("`Tr` is treated as opacity because") && text.contains(reason));
        assert_eq!(said, !reason.is_empty(), "{library}: {reported:?}");
    }
    let folder = folder_with(meshlab);
    for (meaning, expected) in [(TrMeaning::Transparency, 0.25), (TrMeaning::Opacity, 0.75)] {
        let loaded =
            obj::load_with(&folder.path().join("a.obj"), meaning, LoadControl::quiet(MemoryLimit::default())).unwrap();
        assert_eq!(material(&loaded.scene).opacity, expected, "{meaning:?}");
    }
    let (used, unused) = ("newmtl m\nTr 1\n", "newmtl n\nKd 1 1 1\n");
    let folder = folder_with(&format!("{used}{unused}"));
    assert_eq!(material(&load(folder.path()).0.scene).opacity, 1.0, "no face uses the other material");
}

/// Returns a TGA file of 2 × 1 texels with 32 bits each, whose header states `alpha_bits` bits of alpha.
fn tga(alpha_bits: u8, alpha: u8) -> Vec<u8> {
    let mut bytes = vec![0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 1, 0, 32, 0x20 | alpha_bits];
    bytes.extend([10, 20, 30, alpha, 40, 50, 60, alpha]);
    bytes
}

#[test]
fn alpha_0_everywhere_is_no_alpha_in_tga_and_a_warning_elsewhere() {
    for (name, bits) in [("t.tga", 0), ("t.TGA", 8)] {
        let folder = folder_with(&format!("newmtl m\nmap_Kd {name}\n"));
        fs::write(folder.path().join(name), tga(bits, 0)).unwrap();
        let (loaded, reported) = load(folder.path());
        let texture = material(&loaded.scene).texture.unwrap();
        assert_eq!(loaded.scene.library.texture(texture).alpha(), Alpha::Opaque);
        assert_eq!(texels(&loaded.scene, Some(texture)), [[30, 20, 10, 255], [60, 50, 40, 255]]);
        assert!(reported.len() == 1 && reported[0].contains("has alpha 0 everywhere; drawn opaque"), "{reported:?}");
    }
    let folder = folder_with("newmtl m\nmap_Kd t.png\n");
    write_picture(&folder.path().join("t.png"), &[[9, 9, 9, 0]; 4]);
    let (_, reported) = load(folder.path());
    assert_eq!(
        reported,
        ["a.mtl:2: texture \"t.png\" has alpha 0 everywhere: surfaces of this material are invisible"]
    );
    write_picture(&folder.path().join("t.png"), &[[9, 9, 9, 0], [9, 9, 9, 1]]);
    assert!(load(folder.path()).1.is_empty());
}

#[test]
fn materials_that_no_face_uses_are_reported() {
    let folder = folder_with("newmtl m\nKd 1 0 0\nnewmtl n\n");
    assert!(load(folder.path()).1.is_empty());
    fs::write(folder.path().join("a.obj"), format!("{SQUARE}mtllib a.mtl\n{FACE}usemtl m\n")).unwrap();
    let expected =
        "a.obj:9: 2 materials are loaded and none is used: no `usemtl` precedes a face; the default is drawn";
    assert_eq!(load(folder.path()).1, [expected]);
}

#[test]
fn files_are_found_in_any_normal_form_and_in_other_case_with_a_warning() {
    let (composed, decomposed) = ("K\u{f6}ln.png", "Ko\u{308}ln.png");
    for (written, on_disk) in [(composed, decomposed), (decomposed, composed)] {
        let folder = folder_with(&format!("newmtl m\nmap_Kd {written}\n"));
        write_picture(&folder.path().join(on_disk), &[[1, 2, 3, 255]]);
        let (loaded, reported) = load(folder.path());
        assert!(material(&loaded.scene).texture.is_some() && reported.is_empty(), "{reported:?}");
    }
    let folder = folder_with("newmtl m\nmap_Kd Wall.PNG\n");
    write_picture(&folder.path().join("wall.png"), &[[1, 2, 3, 255]]);
    fs::rename(folder.path().join("a.mtl"), folder.path().join("A.Mtl")).unwrap();
    let (loaded, reported) = load(folder.path());
    assert!(material(&loaded.scene).texture.is_some());
    assert_eq!(
        reported,
        [
            "a.obj:1: material library \"a.mtl\" is read from \"A.Mtl\": the names differ in case",
            "A.Mtl:2: texture \"Wall.PNG\" is read from \"wall.png\": the names differ in case",
        ]
    );
}

/// Returns a grid of 24 × 24 quads, large enough for clusters. `broken` lists vertices by index with invalid
/// coordinates.
fn grid(broken: &[(usize, &str)]) -> Scene {
    const SIDE: usize = 24;
    let mut text = String::new();
    for i in 0..(SIDE + 1) * (SIDE + 1) {
        let (x, y) = (i % (SIDE + 1), i / (SIDE + 1));
        match broken.iter().find(|(vertex, _)| *vertex == i) {
            Some((_, numbers)) => text.push_str(&format!("v {numbers}\n")),
            None => text.push_str(&format!("v {x} {y} 0\n")),
        }
    }
    text.push_str("vn 0 0 1\n");
    for quad in 0..SIDE * SIDE {
        let first = quad / SIDE * (SIDE + 1) + quad % SIDE + 1;
        let corners = [first, first + 1, first + SIDE + 2, first + SIDE + 1];
        text.push_str(&format!("f {}\n", corners.map(|corner| format!("{corner}//1")).join(" ")));
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    fs::write(&path, text).unwrap();
    obj::load(&path).unwrap().scene
}

fn frame(scene: &Scene, settings: &[&str]) -> (Recipe, Frame) {
    let mut recipe = Recipe::default();
    for setting in settings {
        recipe.set(setting).unwrap();
    }
    let frame = run(scene, &scene.home, &recipe, Viewport { width: 61, height: 47 }, &mut ());
    (recipe, frame)
}

#[test]
fn triangles_with_a_corner_that_is_not_finite_have_their_own_fate_in_every_execution() {
    // Each vertex that is not finite is a corner of six triangles, and no triangle has two such corners.
    let (whole, (scene, broken)) = (grid(&[]), broken_grid());
    assert_eq!(scene.home, whole.home, "bounds and first view ignore them");
    let mut reference = None;
    for settings in [
        &["execution=classic"] as &[&str],
        &["execution=tiled"],
        &["execution=tiled", "force=everything"],
        &["execution=classic", "culling=none"],
        &["execution=tiled", "culling=none"],
    ] {
        let (recipe, drawn) = frame(&scene, settings);
        let counts = Fates::of(&scene, &recipe, &drawn).triangle_counts();
        let corners = scene.library.meshes()[0]
            .triangles
            .iter()
            .filter(|triangle| triangle.iter().any(|i| !scene.library.meshes()[0].positions[*i as usize].is_finite()));
        assert_eq!(counts.of(TriangleFate::NotFinite), corners.count() as u64, "{settings:?}");
        assert_eq!(counts.of(TriangleFate::NotFinite), u64::from(broken), "{settings:?}");
        assert_eq!(counts.sum(), 24 * 24 * 2, "{settings:?}");
        let picture = drawn.image().pixels().to_vec();
        assert_eq!(&picture, reference.get_or_insert_with(|| picture.clone()), "{settings:?}");
    }
    assert_ne!(reference.as_deref(), Some(frame(&whole, &[]).1.image().pixels()), "there are holes");
}

/// Returns a grid with four vertices that are not finite, and the number of triangles that have such a corner.
fn broken_grid() -> (Scene, u32) {
    (grid(&[(110, "nan 1 0"), (304, "12 inf 0"), (480, "-inf -inf nan"), (404, "1e99 0 0")]), 24)
}

#[test]
fn pixels_beside_triangles_that_are_not_finite_replay_to_the_frame() {
    let (scene, _) = broken_grid();
    for settings in [
        &["execution=tiled"] as &[&str],
        &["execution=classic", "culling=none", "shading=lambert"],
        &["antialias.method=regular", "shading=triangle-id"],
        &["upscaler.method=bilinear", "upscaler.scale=2", "wireframe=on"],
    ] {
        let (recipe, drawn) = frame(&scene, settings);
        for (x, y) in (0..47).flat_map(|y| (0..61).map(move |x| (x, y))).step_by(13) {
            let report = inspect(&scene, &recipe, &drawn, x, y).unwrap();
            assert_eq!(report.color, drawn.image().at(x, y), "{settings:?} at {x}, {y}");
        }
    }
}

#[test]
fn the_mesh_view_leaves_out_triangles_that_are_not_finite() {
    let (scene, broken) = broken_grid();
    let size = Viewport { width: 300, height: 280 };
    let inner = Inner { camera: scene.home, settings: Settings::default(), viewport: size };
    for (style, explode) in MeshStyle::ALL.iter().flat_map(|style| [(*style, 0.0), (*style, 0.3)]) {
        let normals = MeshNormals { vertices: true, faces: true, ..MeshNormals::default() };
        let painting =
            Painting { style, explode, selection: TriangleSelection::default(), backdrop: [0, 0, 0], normals };
        let outside = mesh_view::fit(scene.home, &scene, &inner, 1.0);
        let picture = paint(&scene, &inner, outside, size, &painting);
        let shown: BTreeSet<_> = picture.owner.pixels().iter().filter(|id| **id != TriangleId::NONE).collect();
        assert_eq!(shown.len() as u32, 24 * 24 * 2 - broken, "{style:?}, exploded by {explode}");
    }
}

#[test]
fn broken_normals_and_texture_coordinates_load_with_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!("{SQUARE}vt nan 0\nvn 0 0 1\nvn nan 0 1\nf 1/1/1 2/2/1 3/3/2\nf 1/1/1 3/5/1 4/4/1\n");
    fs::write(folder.path().join("a.obj"), text).unwrap();
    let (loaded, reported) = load(folder.path());
    assert_eq!(
        reported,
        [
            "a.obj:9: texture coordinate that is not finite; treated as 0 0",
            "a.obj:11: normal that is not finite; corners that use it receive no direct light",
        ]
    );
    let mesh = &loaded.scene.library.meshes()[0];
    assert_eq!((mesh.lost_normals(), mesh.triangles.len()), (1, 2));
    assert!(mesh.uvs.iter().all(|uv| uv.is_finite()));
    let scene = &loaded.scene;
    let frame = run(scene, &scene.home, &Recipe::default(), Viewport { width: 40, height: 30 }, &mut ());
    let broken = Fates::of(scene, &Recipe::default(), &frame).broken;
    assert_eq!(
        broken.iter().map(|triangle| triangle.0).collect::<Vec<_>>(),
        [0, 1],
        "by a normal, and by a coordinate"
    );
}

#[test]
fn a_pixel_lists_the_texels_of_every_map() {
    let maps = [
        (TextureMap::Color, "map_Kd color.png", [200, 100, 50, 255]),
        (TextureMap::Opacity, "map_d opacity.png", [180, 180, 180, 255]),
        (TextureMap::Emission, "map_Ke emission.png", [30, 20, 10, 255]),
        (TextureMap::Normal, "norm normal.png", [128, 128, 255, 255]),
    ];
    let statements: Vec<_> = maps.iter().map(|(_, statement, _)| *statement).collect();
    let folder = folder_with(&format!("newmtl m\nKe 1 1 1\n{}\n", statements.join("\n")));
    for (_, statement, texel) in &maps {
        write_picture(&folder.path().join(statement.split(' ').nth(1).unwrap()), &[*texel; 4]);
    }
    let (loaded, reported) = load(folder.path());
    assert!(reported.is_empty(), "{reported:?}");
    for filter in ["point", "bilinear", "trilinear"] {
        let (recipe, drawn) = frame(&loaded.scene, &["shading=lambert", &format!("filter={filter}")]);
        let report = inspect(&loaded.scene, &recipe, &drawn, 30, 23).unwrap();
        let shading = report.visible().unwrap().shading.as_ref().unwrap();
        for (map, _, texel) in &maps {
            let read: Vec<_> = shading.texels_of(*map).collect();
            let sum: f32 = read.iter().map(|texel| texel.tap.weight).sum();
            assert!((sum - 1.0).abs() < 1e-6, "{filter}, {map:?}: {sum}");
            // The single value of an opacity map is stored in alpha.
            let of = |color: &Rgba8| {
                if *map == TextureMap::Opacity { [color[3]; 3] } else { [color[0], color[1], color[2]] }
            };
            assert!(read.iter().all(|read| of(&read.color) == texel[..3]), "{filter}, {map:?}: {read:?}");
        }
    }
}

#[test]
fn a_crease_angle_is_only_used_and_reported_without_smoothing_groups() {
    let roof = "v -1 0 -1\nv -1 0 1\nv 0 1 1\nv 0 1 -1\nv 1 0 1\nv 1 0 -1\n";
    for (statement, is_reported) in [("", true), ("s 1\n", false), ("s off\n", false), ("S 0\n", false)] {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("a.obj"), format!("{roof}{statement}f 1 2 3 4\nf 4 3 5 6\n")).unwrap();
        let (loaded, reported) = load(folder.path());
        let text = "no smoothing groups (`s`): where normals are missing, edges above 45° are hard";
        let expected: &[&str] = if is_reported { &[text] } else { &[] };
        let notes: Vec<_> = loaded.notes.iter().map(|note| note.text.as_str()).collect();
        assert!(reported.is_empty(), "{reported:?}");
        assert_eq!(notes, expected, "{statement}");
    }
}
