//! Real models: triangle counts equal to an independent count, and the materials and textures of their libraries.

mod common;

use std::path::Path;

use common::models;
use rasterscope::scene::obj::{self, Loaded};
use rasterscope::scene::{DepthMapping, MeshData, SceneError};

/// Models with faces, or triangles of polygons, that have no area or repeat others. The loader drops them, which the
/// independent count (corners − 2) does not know. Name, remaining triangles, reason.
const WITHOUT_AREA: [(&str, usize, &str); 3] = [
    ("spider/spider.obj", 1368 - 56, "56 faces have two corners in one place"),
    ("odd/box_longline.obj", 12, "a cube, one face of which runs around its four corners 233 times"),
    ("odd/issue-319-002.obj", 14 - 1, "one polygon has two corners in one place"),
];

/// Returns name and triangle count of each row of the table.
fn rows(table: &str) -> Vec<(String, usize)> {
    table
        .lines()
        .filter_map(|line| {
            let cells: Vec<_> = line.split('|').map(str::trim).collect();
            let name = cells.get(1).filter(|name| name.ends_with(".obj"))?;
            let (_, count) = cells.get(4)?.split_once("-> ")?;
            Some(((*name).to_owned(), count.split(' ').next()?.parse().ok()?))
        })
        .collect()
}

fn load(models: &Path, name: &str) -> Loaded {
    obj::load(&models.join(name)).unwrap_or_else(|e| panic!("{e}"))
}

fn textures_and_materials(loaded: &Loaded) -> (usize, usize) {
    (loaded.scene.library.textures().len(), loaded.scene.library.materials().len())
}

#[test]
fn every_model_has_as_many_triangles_as_counted_independently() {
    let Some(models) = models() else { return };
    let rows = rows(&std::fs::read_to_string(models.join("SOURCES.md")).unwrap());
    assert_eq!(rows.len(), 39, "rows of the table");
    let mut failures = Vec::new();
    for (name, counted) in rows {
        let result = obj::load(&models.join(&name));
        let expected = WITHOUT_AREA.iter().find(|(n, ..)| *n == name).map_or(counted, |(_, left, _)| *left);
        match result {
            // `3.1+e2` is not a valid number, so an error is correct.
            Err(SceneError::Line { line: 11, .. }) if name == "odd/number_formats.obj" => {}
            // Points, lines or a single vertex: nothing to draw.
            Err(_) if counted == 0 => {}
            Ok(loaded) if loaded.scene.triangle_count() == expected && counted > 0 => {}
            Ok(loaded) => failures.push(format!("{name}: {} instead of {expected}", loaded.scene.triangle_count())),
            Err(error) => failures.push(error.to_string()),
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn textured_models_have_their_materials_and_textures_once_each() {
    let Some(models) = models() else { return };
    for (name, expected) in [
        ("spider/spider.obj", (5, 5)),
        ("spot/spot_textured_triangulated.obj", (1, 1)),
        ("spot/spot_textured_quadrangulated.obj", (1, 1)),
        ("viking-room/viking_room.obj", (1, 1)),
        ("cornell-box/CornellBox-Original.obj", (0, 8)),
    ] {
        let loaded = load(&models, name);
        assert_eq!(textures_and_materials(&loaded), expected, "{name}");
        let textured = loaded.scene.library.materials().iter().filter(|m| m.texture.is_some()).count();
        assert_eq!(textured, expected.0, "{name}");
    }
}

#[test]
fn line_ends_make_no_difference() {
    let Some(models) = models() else { return };
    let meshes = |name: &str| -> Vec<MeshData> {
        let loaded = load(&models, name);
        loaded.scene.library.meshes().iter().map(|m| MeshData { name: String::new(), ..(**m).clone() }).collect()
    };
    assert_eq!(meshes("utah-teapot/teapot.obj"), meshes("utah-teapot/teapot_crlf.obj"));
}

#[test]
fn vertex_colours_are_kept() {
    let Some(models) = models() else { return };
    let loaded = load(&models, "spot/spot_vertexcolors.obj");
    let mesh = &loaded.scene.library.meshes()[0];
    assert_eq!(mesh.colors.len(), mesh.positions.len());
    assert!(mesh.colors.iter().any(|c| *c != mesh.colors[0]));
}

#[test]
fn computed_normals_are_smooth_on_a_bunny_and_sharp_on_a_box() {
    let Some(models) = models() else { return };
    let bunny = load(&models, "stanford-bunny/stanford-bunny.obj");
    let (vertices, referenced) = (bunny.scene.library.meshes()[0].positions.len(), 34_834);
    assert!(vertices < referenced * 11 / 10, "{vertices} vertices for {referenced} positions");
    let cube = load(&models, "odd/cube-vertex-w-component.obj");
    for mesh in cube.scene.library.meshes() {
        assert!(mesh.normals.iter().all(|n| n.abs().max_element() == 1.0), "{:?}", mesh.normals);
    }
}

#[test]
fn opacity_is_read_from_d_wherever_tr_stands() {
    let Some(models) = models() else { return };
    let loaded = load(&models, "odd/tr-and-d-issue-43.obj");
    assert!(loaded.scene.library.materials().iter().all(|m| m.opacity == 0.75));
}

#[test]
fn every_corner_of_the_first_view_shows_the_model_from_outside() {
    let Some(models) = models() else { return };
    let scene = load(&models, "armadillo/armadillo.obj").scene;
    let clip_from_world = scene.home.clip_from_world(1.0, DepthMapping::Standard);
    for corner in scene.bounds().corners() {
        let clip = clip_from_world * corner.extend(1.0);
        assert!(clip.x.abs() <= clip.w && clip.y.abs() <= clip.w && (0.0..=clip.w).contains(&clip.z), "{clip}");
    }
}
