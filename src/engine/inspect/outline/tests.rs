//! Compares drawings with rendered images of the same view.

use std::collections::HashMap;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use glam::Vec3;

use super::*;
use crate::drawing::bitmap::bitmap;
use crate::image::Rgba8;
use crate::scene::builtin;
use crate::scene::obj;

const SIZE: Viewport = Viewport { width: 200, height: 150 };

/// Draws a view as vector shapes, without progress reports or cancellation.
fn outline(scene: &Arc<Scene>, camera: &Camera, recipe: &Recipe, viewport: Viewport, kind: OutlineKind) -> Drawing {
    let control = TaskControl::quiet();
    super::outline(&OutlineRequest { scene, camera, recipe, viewport, kind }, control).unwrap()
}

#[test]
fn progress_ends_at_one_and_cancelling_takes_effect_at_the_next_report() {
    let scene = Arc::new(builtin::by_id("cubes").unwrap().build());
    let (camera, recipe) = (&scene.home, &Recipe::default());
    let request = OutlineRequest { scene: &scene, camera, recipe, viewport: SIZE, kind: OutlineKind::Polygons };
    // With a single thread, the reports arrive in order.
    let single = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    for cancelled_at in [None, Some(0.3), Some(0.6), Some(0.9)] {
        let (reports, cancel) = (Mutex::new(Vec::new()), AtomicBool::new(false));
        let progress = |share: f32| {
            reports.lock().unwrap().push(share);
            cancel.fetch_or(cancelled_at.is_some_and(|at| share >= at), Ordering::Relaxed);
        };
        let drawing = single.install(|| super::outline(&request, TaskControl { progress: &progress, cancel: &cancel }));
        let reports = reports.into_inner().unwrap();
        assert!(reports.is_sorted(), "{reports:?}");
        assert_eq!(drawing.is_none(), cancelled_at.is_some());
        match cancelled_at {
            None => assert_eq!(reports.last(), Some(&1.0)),
            Some(at) => assert_eq!(reports.iter().filter(|share| **share >= at).count(), 1, "{reports:?}"),
        }
    }
}

fn drawn(id: &str, kind: OutlineKind) -> Drawing {
    let scene = Arc::new(builtin::ALL.iter().find(|scene| scene.id == id).unwrap().build());
    outline(&scene, &scene.home, &Recipe::default(), SIZE, kind)
}

fn length(drawing: &Drawing) -> f64 {
    let length = |shape: &Shape| if let Shape::Line { from, to, .. } = shape { from.distance(*to) } else { 0.0 };
    drawing.shapes.iter().map(length).sum()
}

#[test]
fn one_triangle_has_three_edges_and_all_are_visible() {
    let (all, visible) = (drawn("triangle", OutlineKind::Wireframe), drawn("triangle", OutlineKind::HiddenLine));
    assert_eq!(all.shapes.len(), 3);
    assert!((length(&all) - length(&visible)).abs() < 1e-9, "{} and {}", length(&all), length(&visible));
}

#[test]
fn visible_lines_are_a_part_of_the_wireframe_and_shared_edges_occur_once() {
    let (all, visible) = (drawn("cubes", OutlineKind::Wireframe), drawn("cubes", OutlineKind::HiddenLine));
    assert!(length(&visible) < 0.9 * length(&all) && length(&visible) > 0.1 * length(&all));
    let mut ends: Vec<_> = all
        .shapes
        .iter()
        .filter_map(|shape| if let Shape::Line { from, to, .. } = shape { Some([from, to]) } else { None })
        .map(|ends| ends.map(|end| end.to_array().map(f64::to_bits)))
        .collect();
    let before = ends.len();
    ends.sort_unstable();
    ends.dedup();
    assert!(ends.len() > before * 9 / 10, "{} of {before}", ends.len());
}

#[test]
fn an_edge_that_reaches_far_outside_the_picture_is_hidden_with_pixel_accuracy() {
    let depth = Image::from_fn(100, 10, |x, _| if (40..50).contains(&x) { 0.2 } else { 1.0 });
    let parts = visible_parts([(DVec2::new(-16_000.0, 5.5), 0.5), (DVec2::new(16_000.0, 5.5), 0.5)], Some(&depth));
    let ends: Vec<_> = parts
        .iter()
        .filter_map(|part| if let Shape::Line { from, to, .. } = part { Some((from.x, to.x)) } else { None })
        .collect();
    let [(left, hidden), (shown, right)] = ends[..] else { panic!("{ends:?}") };
    assert!(left.abs() < 1e-6 && (right - 100.0).abs() < 1e-6, "{ends:?}");
    // A pixel next to the occluder still shows the line.
    assert!((hidden - 40.5).abs() <= 1.0 && (shown - 49.5).abs() <= 1.0, "{ends:?}");
}

/// Returns a camera that looks along −z at the square from −1 to 1 in x and y.
fn front() -> Camera {
    Camera::look_at(Vec3::new(0.0, 0.0, 3.0), Vec3::ZERO)
}

/// Builds a scene of quads, each with its own flat material. Each quad has four corners in outline order.
fn quads(quads: &[[[f64; 3]; 4]], materials: &[&str]) -> Arc<Scene> {
    let folder = tempfile::tempdir().unwrap();
    let (mut model, mut library) = ("mtllib quads.mtl\n".to_owned(), String::new());
    for (number, (corners, material)) in quads.iter().zip(materials.iter().cycle()).enumerate() {
        for [x, y, z] in corners {
            model.push_str(&format!("v {x} {y} {z}\n"));
        }
        model.push_str(&format!("usemtl m{number}\nf -4 -3 -2 -1\n"));
        library.push_str(&format!("newmtl m{number}\n{material}\n"));
    }
    std::fs::write(folder.path().join("quads.mtl"), library).unwrap();
    let path = folder.path().join("quads.obj");
    std::fs::write(&path, model).unwrap();
    Arc::new(obj::load(&path).unwrap().scene)
}

/// Returns a recipe in which every triangle has a single colour.
fn flat(shading: &str) -> Recipe {
    let mut recipe = Recipe::default();
    recipe.set_all(&[format!("shading={shading}"), "culling=none".to_owned()]).unwrap();
    recipe
}

fn regions(drawing: &Drawing) -> &[PartitionRegion] {
    let [Shape::Partition(regions)] = drawing.shapes.as_slice() else { panic!("{:?}", drawing.shapes) };
    regions
}

/// Magnification of the images used to find edges between pixel centres.
const FINE: u32 = 5;

fn rendered(scene: &Arc<Scene>, camera: &Camera, recipe: &Recipe, zoom: u32) -> Image<Rgba8> {
    let size = Viewport { width: SIZE.width * zoom, height: SIZE.height * zoom };
    Renderer::default().render(RenderInputs { scene, camera, recipe, viewport: size }, KeepDepth::No).image().clone()
}

/// Returns two pixel counts of the magnified drawing: pixels that differ from the rendered image, and all pixels. Both
/// exclude pixels with an edge within `margin` pixels. Edges are detected in a finer image.
fn differing(scene: &Arc<Scene>, camera: &Camera, recipe: &Recipe, [zoom, margin]: [u32; 2]) -> [usize; 2] {
    let drawing = outline(scene, camera, recipe, SIZE, OutlineKind::Polygons);
    let drawn = bitmap(&drawing, zoom.into());
    let [picture, fine] = [zoom, FINE].map(|zoom| rendered(scene, camera, recipe, zoom));
    let per_pixel = FINE / zoom;
    let around = |place: u32| place.saturating_sub(margin) * per_pixel..(place + 1 + margin) * per_pixel;
    let is_inner = |(x, y): &(u32, u32)| {
        let mut near = around(*y).flat_map(|row| around(*x).map(move |column| (column, row)));
        near.all(|(column, row)| fine.get(column, row).is_none_or(|color| color == picture.at(*x, *y)))
    };
    let pixels = (0..picture.height()).flat_map(|y| (0..picture.width()).map(move |x| (x, y)));
    let inner: Vec<_> = pixels.filter(is_inner).collect();
    [inner.iter().filter(|(x, y)| drawn.at(*x, *y) != picture.at(*x, *y)).count(), inner.len()]
}

/// Asserts that the drawing matches the image except within a pixel of edges, at its own size and magnified.
fn assert_shows_the_picture(scene: &Arc<Scene>, camera: &Camera, recipe: &Recipe) {
    for [zoom, margin] in [[1, 1], [FINE, FINE]] {
        let [differing, of] = differing(scene, camera, recipe, [zoom, margin]);
        assert!(differing == 0 && of > 10_000, "enlarged {zoom} times: {differing} of {of}");
    }
}

#[test]
fn cyclically_overlapping_bars_are_drawn_correctly() {
    // Each bar rises along its length, so its far end lies over the next one.
    let bars: Vec<_> = (0..3)
        .map(|bar| {
            let turn = glam::DVec2::from_angle(f64::from(bar) * std::f64::consts::TAU / 3.0);
            [(-1.1, -0.5, -0.4), (1.1, -0.5, 0.4), (1.1, -0.2, 0.4), (-1.1, -0.2, -0.4)].map(|(x, y, z)| {
                let place = turn.rotate(glam::DVec2::new(x, y));
                [place.x, place.y, z]
            })
        })
        .collect();
    let scene = quads(&bars, &["Kd 1 0 0", "Kd 0 1 0", "Kd 0 0 1"]);
    assert_shows_the_picture(&scene, &front(), &flat("texture"));
}

#[test]
fn surfaces_that_pass_through_each_other_meet_in_a_straight_line() {
    let level = |z: [f64; 4]| [[-1.0, -1.0, z[0]], [1.0, -1.0, z[1]], [1.0, 1.0, z[2]], [-1.0, 1.0, z[3]]];
    let scene = quads(&[level([0.0; 4]), level([-0.7, 0.4, 0.6, -0.5])], &["Kd 1 0 0", "Kd 0 1 0"]);
    for depth_test in ["less", "greater"] {
        for format in ["f32", "reversed-f32", "w-buffer"] {
            let mut recipe = flat("texture");
            recipe.set_all(&[format!("depth_test={depth_test}"), format!("depth_format={format}")]).unwrap();
            assert_shows_the_picture(&scene, &front(), &recipe);
            // With `greater`, boundaries are accurate to a pixel, but not straight.
            if depth_test == "less" {
                let drawing = outline(&scene, &front(), &recipe, SIZE, OutlineKind::Polygons);
                // The tilted quad bends along its diagonal; each region has few corners if its sides are straight.
                let corners: Vec<_> = regions(&drawing).iter().map(|region| region.contours.concat().len()).collect();
                assert!(corners.iter().all(|corners| *corners <= 16), "{format}: {corners:?}");
            }
        }
    }
    let mut recipe = flat("texture");
    recipe.set("depth_test=off").unwrap();
    assert_shows_the_picture(&scene, &front(), &recipe);
}

#[test]
fn small_things_on_a_floor_are_not_hidden_by_it() {
    let on_floor = |x: f64, z: f64, half: f64, y: f64| {
        [[x - half, y, z + half], [x + half, y, z + half], [x + half, y, z - half], [x - half, y, z - half]]
    };
    let things = [on_floor(0.0, -40.0, 50.0, 0.0), on_floor(-3.0, -30.0, 3.0, 0.1), on_floor(2.0, -5.0, 0.8, 0.05)];
    let scene = quads(&things, &["Kd 0.2 0.2 0.2", "Kd 1 0 0", "Kd 0 1 0"]);
    let camera = Camera::look_at(Vec3::new(0.0, 2.0, 3.0), Vec3::new(0.0, 0.0, -8.0));
    assert_shows_the_picture(&scene, &camera, &flat("texture"));
    let drawing = outline(&scene, &camera, &flat("texture"), SIZE, OutlineKind::Polygons);
    assert_eq!(regions(&drawing).len(), 7, "three quads of two triangles, and the background");
}

#[test]
fn transparent_panes_tint_the_surfaces_behind_them() {
    let square = |x: f64, half: f64, z: f64| {
        [[x - half, -half, z], [x + half, -half, z], [x + half, half, z], [x - half, half, z]]
    };
    let scene = quads(
        &[square(0.0, 0.9, 0.0), square(-0.2, 0.5, 0.3), square(0.3, 0.5, 0.6)],
        &["Kd 1 1 1", "Kd 1 0 0\nd 0.5", "Kd 0 0 1\nd 0.5"],
    );
    for order in ["objects", "triangles", "exact"] {
        let mut recipe = flat("texture");
        recipe.set(&format!("blending.order={order}")).unwrap();
        assert_shows_the_picture(&scene, &front(), &recipe);
    }
}

#[test]
fn a_triangle_keeps_its_exact_corners_and_leaves_a_hole_in_the_background() {
    let scene = Arc::new(builtin::by_id("triangle").unwrap().build());
    let recipe = flat("triangle-id");
    let drawing = outline(&scene, &scene.home, &recipe, SIZE, OutlineKind::Polygons);
    let [background, triangle] = regions(&drawing) else { panic!("{:?}", drawing.shapes) };
    let frame = Renderer::default()
        .render(RenderInputs { scene: &scene, camera: &scene.home, recipe: &recipe, viewport: SIZE }, KeepDepth::No);
    let [corner] = triangle.contours.as_slice() else { panic!("{triangle:?}") };
    assert_eq!(corner.len(), 3);
    for vertex in &frame.geometry().triangles[0].vertices {
        let off = corner.iter().map(|corner| corner.distance(end(vertex).0)).fold(f64::INFINITY, f64::min);
        assert!(off < 0.01, "{off} px from {:?}", vertex.position_px);
    }
    assert_eq!(background.fill, scene.background);
    let [page, hole] = background.contours.as_slice() else { panic!("{background:?}") };
    assert_eq!((page.len(), hole.len()), (4, 3));
}

/// Builds a wall of triangles of one colour, with shared edges in many directions.
fn wall() -> Arc<Scene> {
    const SIDE: usize = 12;
    let mut random = fastrand::Rng::with_seed(5);
    let corner = |column: usize, row: usize, random: &mut fastrand::Rng| {
        let mut at = |place: usize| place as f64 / SIDE as f64 * 4.0 - 2.0 + (random.f64() - 0.5) * 0.2;
        [at(column), at(row), 0.0]
    };
    let corners: Vec<Vec<_>> =
        (0..=SIDE).map(|row| (0..=SIDE).map(|column| corner(column, row, &mut random)).collect()).collect();
    let squares = (0..SIDE * SIDE).map(|square| {
        let (column, row) = (square % SIDE, square / SIDE);
        [corners[row][column], corners[row][column + 1], corners[row + 1][column + 1], corners[row + 1][column]]
    });
    quads(&squares.collect::<Vec<_>>(), &["Kd 1 1 1"])
}

#[test]
fn a_wall_of_one_colour_has_no_seams_at_any_size() {
    let drawing = outline(&wall(), &front(), &flat("texture"), SIZE, OutlineKind::Polygons);
    assert!(regions(&drawing).len() > 100);
    for scale in [0.34, 1.0, 2.98] {
        assert!(bitmap(&drawing, scale).pixels().iter().all(|pixel: &Rgba8| *pixel == [255; 4]), "at {scale}");
    }
}

#[test]
fn regions_share_all_their_boundaries() {
    let scene = Arc::new(builtin::by_id("cubes").unwrap().build());
    let drawing = outline(&scene, &scene.home, &flat("triangle-id"), SIZE, OutlineKind::Polygons);
    let mut sides = HashMap::new();
    let contours = || regions(&drawing).iter().flat_map(|region| &region.contours);
    for contour in contours() {
        for (from, to) in contour.iter().zip(contour.iter().cycle().skip(1)) {
            let side = [*from, *to].map(|end| end.to_array().map(f64::to_bits));
            assert!(sides.insert(side, [*from, *to]).is_none(), "{from} to {to} twice");
        }
    }
    for ([from, to], [start, stop]) in &sides {
        let on_edge = (0..2).any(|axis| [0.0, drawing.size[axis]].contains(&start[axis]) && start[axis] == stop[axis]);
        assert!(on_edge || sides.contains_key(&[*to, *from]), "{start} to {stop} has no other side");
    }
    let area = |contour: &Vec<DVec2>| {
        contour.iter().zip(contour.iter().cycle().skip(1)).map(|(a, b)| a.perp_dot(*b) / 2.0).sum::<f64>()
    };
    let total = contours().map(area).sum::<f64>();
    assert!((total - drawing.size.x * drawing.size.y).abs() < 1e-6, "{total}");
}

#[test]
fn every_built_in_scene_is_drawn_as_it_is_rendered() {
    for scene in builtin::ALL {
        let (id, scene) = (scene.id, Arc::new(scene.build()));
        let [differing, of] = differing(&scene, &scene.home, &flat("triangle-id"), [1, 1]);
        assert!(differing == 0, "{id}: {differing} of {of}");
    }
}

#[test]
fn polygons_lie_on_the_background_of_the_settings() {
    let scene = Arc::new(builtin::by_id("triangle").unwrap().build());
    let size = Viewport { width: 32, height: 24 };
    for (setting, expected) in [("background=scene", scene.background), ("background=#d04010", [0xd0, 0x40, 0x10])] {
        let mut recipe = Recipe::default();
        recipe.set(setting).unwrap();
        let drawing = outline(&scene, &scene.home, &recipe, size, OutlineKind::Polygons);
        assert_eq!(drawing.background, expected, "{setting}");
    }
}
