use glam::DVec3;

use super::*;
use crate::image::Image;
use crate::inspect::overlays::{FACE_NORMAL, VERTEX_NORMAL};
use crate::inspect::selection::TriangleSelection;
use crate::pipeline::settings::Culling;
use crate::scene::{Scene, builtin};

const SIZE: Viewport = Viewport { width: 160, height: 120 };

fn inner(scene: &Scene) -> Inner {
    Inner { camera: scene.home, settings: Settings::default(), viewport: SIZE }
}

fn scene(id: &str) -> Scene {
    builtin::by_id(id).unwrap().build()
}

fn outside(scene: &Scene, inner: &Inner) -> Camera {
    with_planes(first_view(scene, inner, SIZE.aspect()), scene, inner)
}

fn painting(style: MeshStyle, backdrop: [u8; 3]) -> Painting {
    Painting { style, explode: 0.0, selection: TriangleSelection::default(), backdrop, normals: MeshNormals::default() }
}

fn marks(scene: &Scene, look: &OverlayInputs) -> Vec<MeshMark> {
    let inner = inner(scene);
    drawn(scene, &inner, look, &outside(scene, &inner), SIZE)
}

#[test]
fn the_first_view_shows_the_eye_and_every_triangle_can_be_picked() {
    for id in ["cubes", "triangle", "z-fighting", "near-plane"] {
        let scene = scene(id);
        let inner = inner(&scene);
        let seen = outside(&scene, &inner);
        assert_eq!(seen.check(), Ok(()), "{id}");
        let marks = drawn(&scene, &inner, &OverlayInputs::default(), &seen, SIZE);
        let eye = marks.iter().find(|mark| mark.kind == MarkKind::Eye).unwrap();
        let [x, y] = eye.points[0];
        assert!((0.0..160.0).contains(&x) && (0.0..120.0).contains(&y), "{id}: {x}, {y}");
        let painted = paint(&scene, &inner, seen, SIZE, &painting(MeshStyle::Flat, [0; 3]));
        let shown = painted.owner.pixels().iter().filter(|id| **id != TriangleId::NONE).count();
        let lit = painted.image.pixels().iter().filter(|pixel| pixel[..3] != [0; 3]).count();
        assert!(shown > 0 && shown == lit, "{id}: {shown} {lit}");
    }
}

#[test]
fn fates_match_the_counters_of_the_pipeline() {
    let scene = scene("cubes");
    let inner = inner(&scene);
    let mut counters = crate::pipeline::observe::Counters::default();
    crate::pipeline::prepare(&scene, &inner.camera, &inner.settings, SIZE, &mut counters);
    let met: Vec<_> = inner.rejections(&scene, inner.settings.culling).outcomes().collect();
    for fate in crate::pipeline::observe::Fate::ALL {
        let count = met.iter().filter(|met| **met == GeometryOutcome::Rejected(fate)).count() as u64;
        assert_eq!(count, counters.fate(fate), "{fate:?}");
    }
    assert!(counters.fate(Fate::BackFacing) > 0);
    let both = inner.rejections(&scene, Culling::None);
    assert!(both.outcomes().all(|met| met != GeometryOutcome::Rejected(Fate::BackFacing)));
}

#[test]
fn culled_triangles_are_outlined_if_they_are_few_or_selected() {
    let outlines = |scene: &Scene, culling, look: &OverlayInputs| {
        let inner = Inner { settings: Settings { culling, ..Settings::default() }, ..inner(scene) };
        let marks = drawn(scene, &inner, look, &outside(scene, &inner), SIZE);
        marks.iter().filter(|mark| mark.kind == MarkKind::Culled).count()
    };
    let all = OverlayInputs { culled: true, ..OverlayInputs::default() };
    let alone = scene("triangle");
    assert_eq!(outlines(&alone, Culling::Front, &all), 1);
    assert_eq!(outlines(&alone, Culling::Back, &all), 0);
    assert_eq!(outlines(&alone, Culling::Front, &OverlayInputs::default()), 0);
    let many = scene("cubes");
    let back = inner(&many)
        .rejections(&many, Culling::Back)
        .outcomes()
        .position(|m| m == GeometryOutcome::Rejected(Fate::BackFacing));
    assert_eq!(outlines(&many, Culling::Back, &all), 0);
    let selected = back.map(|id| TriangleId(id as u32));
    assert_eq!(outlines(&many, Culling::Back, &OverlayInputs { selected, ..all }), 1);
}

#[test]
fn triangles_across_the_near_plane_have_new_vertices_on_their_edges() {
    let scene = scene("near-plane");
    let marks = marks(&scene, &OverlayInputs::default());
    let new: Vec<_> =
        marks.iter().filter_map(|m| if let MarkKind::NewVertex(t) = m.kind { Some(t) } else { None }).collect();
    assert!(!new.is_empty());
    assert!(new.iter().flatten().all(|t| *t > 0.0 && *t < 1.0), "{new:?}");
    assert!(marks.iter().any(|mark| mark.kind == MarkKind::CutAway));
    assert!(marks.iter().any(|mark| mark.kind == MarkKind::RemainingPart));
}

#[test]
fn the_ray_of_a_pixel_ends_on_the_surface_that_it_shows() {
    let scene = scene("cubes");
    let inner = inner(&scene);
    let recipe = crate::chain::Recipe::default();
    let frame = crate::chain::run(&scene, &scene.home, &recipe, SIZE, &mut ());
    let mut checked = 0;
    for (x, y) in (0..SIZE.width).step_by(13).flat_map(|x| (0..SIZE.height).step_by(11).map(move |y| (x, y))) {
        let report = crate::inspect::inspect(&scene, &recipe, &frame, x, y).unwrap();
        let Some(hit) = report.visible() else { continue };
        let look = OverlayInputs {
            pixel: Some((x, y)),
            hit_distance: Some(frame.depth_scale().distance_of(hit.depth.value)),
            ..OverlayInputs::default()
        };
        // The hit, interpolated from the corners by their weights and projected by the second camera.
        let corners = corners(&scene, hit.triangle, 0.0).unwrap().map(glam::Vec3::as_dvec3);
        let weights = hit.attribute_weights.map(f64::from);
        let on_surface: DVec3 = corners.iter().zip(weights).map(|(corner, weight)| *corner * weight).sum();
        let seen = outside(&scene, &inner);
        let look = OverlayInputs { vertex: Some(on_surface), ..look };
        let marks = drawn(&scene, &inner, &look, &seen, SIZE);
        let at = |kind| marks.iter().find(|mark| mark.kind == kind).unwrap().points[0];
        let ([a, b], [c, d]) = (at(MarkKind::Hit), at(MarkKind::Vertex));
        assert!((a - c).hypot(b - d) < 0.5, "{x},{y}: {a},{b} and {c},{d}");
        checked += 1;
    }
    assert!(checked > 20, "{checked}");
}

#[test]
fn exploded_triangles_keep_their_numbers_and_move_away_from_the_middle() {
    let scene = scene("cubes");
    let apart = exploded(&scene, 0.5);
    assert_eq!(apart.triangle_count(), scene.triangle_count());
    for id in (0..scene.triangle_count() as u32).map(TriangleId) {
        let (moved, own) = (corners(&scene, id, 0.5).unwrap(), corners(&apart, id, 0.0).unwrap());
        assert!(moved.iter().zip(own).all(|(a, b)| a.distance(b) < 1e-4), "{id:?}");
        let still = corners(&scene, id, 0.0).unwrap();
        assert!(moved.iter().zip(still).any(|(a, b)| a.distance(b) > 1e-3), "{id:?}");
    }
    assert_eq!(corners(&exploded(&scene, 0.0), TriangleId(3), 0.0), corners(&scene, TriangleId(3), 0.0));
}

#[test]
fn every_style_draws_a_different_picture_and_legend_colours_are_distinct() {
    let scene = scene("near-plane");
    let inner = inner(&scene);
    let seen = outside(&scene, &inner);
    let pictures: Vec<_> =
        MeshStyle::ALL.iter().map(|style| paint(&scene, &inner, seen, SIZE, &painting(*style, [9; 3])).image).collect();
    for (index, picture) in pictures.iter().enumerate() {
        assert!(picture.pixels().iter().any(|pixel| pixel[..3] != [9; 3]));
        assert!(!pictures[..index].contains(picture), "{:?}", MeshStyle::ALL[index]);
    }
    for style in MeshStyle::ALL {
        let mut colors: Vec<_> = key(*style).into_iter().map(|(_, color)| color).collect();
        let before = colors.len();
        colors.sort_unstable();
        colors.dedup();
        assert_eq!(colors.len(), before);
    }
}

#[test]
fn selected_triangles_stay_bright() {
    let scene = scene("cubes");
    let inner = inner(&scene);
    let seen = outside(&scene, &inner);
    let plain = paint(&scene, &inner, seen, SIZE, &painting(MeshStyle::Flat, [0; 3]));
    let chosen = plain.owner.pixels().iter().copied().find(|id| is_triangle(*id)).unwrap();
    let selection = TriangleSelection::new("one", [chosen]);
    let singled = paint(&scene, &inner, seen, SIZE, &Painting { selection, ..painting(MeshStyle::Flat, [0; 3]) });
    assert_eq!(shown_at(&plain.owner, chosen).map(|(x, y)| plain.owner.at(x, y)), Some(chosen));
    for ((id, before), after) in plain.owner.pixels().iter().zip(plain.image.pixels()).zip(singled.image.pixels()) {
        assert_eq!(before == after, *id == chosen || !is_triangle(*id), "{id:?}");
    }
}

#[test]
fn normals_are_drawn_in_their_colours_over_everything_else() {
    let scene = scene("cubes");
    let inner = inner(&scene);
    let seen = outside(&scene, &inner);
    let with = |vertices, faces, length| {
        let normals = MeshNormals { vertices, faces, length };
        paint(&scene, &inner, seen, SIZE, &Painting { normals, ..painting(MeshStyle::Flat, [0; 3]) }).image
    };
    let count = |image: &Image<Rgba8>, color| image.pixels().iter().filter(|pixel| **pixel == color).count();
    let plain = with(false, false, 0.05);
    for (image, own, other) in
        [(with(true, false, 0.05), VERTEX_NORMAL, FACE_NORMAL), (with(false, true, 0.05), FACE_NORMAL, VERTEX_NORMAL)]
    {
        assert!(count(&image, own) > 100 && count(&image, other) == 0);
        let pixels = image.pixels().iter().zip(plain.pixels());
        assert!(pixels.clone().all(|(with, without)| with == without || *with == own));
    }
    assert!(count(&with(true, true, 0.05), VERTEX_NORMAL) > 100 && count(&with(true, true, 0.05), FACE_NORMAL) > 0);
    assert!(count(&with(true, false, 0.2), VERTEX_NORMAL) > count(&with(true, false, 0.05), VERTEX_NORMAL));
    assert_eq!(count(&plain, VERTEX_NORMAL) + count(&plain, FACE_NORMAL), 0);
}
