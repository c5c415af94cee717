//! Cracks and double hits, checked against the number of triangles that contain a pixel centre, with and without their
//! edges. The oracle computes in integers and knows nothing about shared edges. In a mesh without overlaps, a pixel
//! centre that touches two or more triangles lies on their shared edge or corner.

use rasterscope::inspect::{FaultKind, Hits};
use rasterscope::pipeline::clip_space::ClipVertex;
use rasterscope::pipeline::grid::SampleGrid;
use rasterscope::pipeline::raster::cover;
use rasterscope::pipeline::screen_triangle::ScreenTriangle;
use rasterscope::pipeline::settings::{Arithmetic, Choice as _, FillRule, Rasterizer, Settings};
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::scene::builtin;

use crate::internal::common::{
    clip_vertex, for_seeds, grid_triangles, recipe, render, screen_triangles, signed, sound_fill_rules,
};

const VIEW: Viewport = Viewport { width: 40, height: 28 };

/// Returns the triangles of a grid inside the picture, so that its outline is visible. Most corners lie on pixel
/// centres.
fn cells(rng: &mut fastrand::Rng) -> Vec<ScreenTriangle> {
    let (columns, rows) = (rng.u32(2..6), rng.u32(2..5));
    let cell = (32.0 / columns as f32, 20.0 / rows as f32);
    let mut vertices: Vec<ClipVertex> = Vec::new();
    for y in 0..=rows {
        for x in 0..=columns {
            let at = ((x as f32 + 0.2 * signed(rng)) * cell.0 + 3.0, (y as f32 + 0.2 * signed(rng)) * cell.1 + 3.0);
            let at = if rng.u8(..4) > 0 { (at.0.floor() + 0.5, at.1.floor() + 0.5) } else { at };
            vertices.push(clip_vertex(VIEW, at, 0.5, 1.0));
        }
    }
    screen_triangles(&vertices, &grid_triangles(columns, rows), VIEW, &mut ())
}

/// Returns the number of triangles that contain the centre of a pixel, first including and then excluding their edges.
fn containing(triangles: &[ScreenTriangle], (x, y): (u32, u32)) -> (usize, usize) {
    let centre = [x, y].map(|c| i64::from(c) * 256 + 128);
    let cross = |a: [i64; 2], b: [i64; 2], p: [i64; 2]| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
    let least = triangles.iter().map(|t| {
        let [a, b, c] = t.vertices.each_ref().map(|v| [i64::from(v.x), i64::from(v.y)]);
        let sign = cross(a, b, c).signum();
        [(a, b), (b, c), (c, a)].map(|(from, to)| cross(from, to, centre) * sign).into_iter().min().unwrap_or(-1)
    });
    let least: Vec<i64> = least.collect();
    (least.iter().filter(|l| **l >= 0).count(), least.iter().filter(|l| **l > 0).count())
}

fn hits(triangles: &[ScreenTriangle], settings: &Settings) -> Hits {
    Hits::of_triangles(triangles, settings, SampleGrid::FULL, VIEW)
}

fn found(hits: &Hits, kind: FaultKind) -> Vec<(u32, u32)> {
    hits.faults.iter().filter(|fault| fault.kind == kind).map(|fault| (fault.x, fault.y)).collect()
}

fn pixels(mut keep: impl FnMut((u32, u32)) -> bool) -> Vec<(u32, u32)> {
    let all = (0..VIEW.height).flat_map(|y| (0..VIEW.width).map(move |x| (x, y)));
    all.filter(|pixel| keep(*pixel)).collect()
}

#[test]
fn the_wrong_rules_fault_where_two_triangles_touch_a_centre_and_nowhere_else() {
    let (mut doubles, mut cracks, mut outlines) = (0, 0, 0);
    for_seeds(60, |rng| {
        let triangles = cells(rng);
        let touched = |pixel| containing(&triangles, pixel);
        let at_seam = pixels(|pixel| touched(pixel).0 > 1);
        for rasterizer in Rasterizer::correct() {
            let with = |fill_rule| hits(&triangles, &Settings { rasterizer, fill_rule, ..Settings::default() });
            let (right, inclusive) = (with(FillRule::TopLeft), with(FillRule::Inclusive));
            assert_eq!(found(&inclusive, FaultKind::DoubleHit), at_seam, "{rasterizer:?}");
            assert_eq!(found(&inclusive, FaultKind::Crack), []);
            // A centre on the outline that top-left excludes is drawn by the only triangle that touches it.
            let more = pixels(|pixel| touched(pixel).0 == 1 && right.counts.at(pixel.0, pixel.1) == 0);
            assert_eq!(inclusive.elsewhere, more.len());
            let exclusive = with(FillRule::Exclusive);
            let lost = |pixel: (u32, u32)| touched(pixel).1 == 0 && right.counts.at(pixel.0, pixel.1) == 1;
            assert_eq!(found(&exclusive, FaultKind::Crack), pixels(|pixel| touched(pixel).0 > 1 && lost(pixel)));
            assert_eq!(found(&exclusive, FaultKind::DoubleHit), []);
            assert_eq!(exclusive.elsewhere, pixels(|pixel| touched(pixel).0 == 1 && lost(pixel)).len());
            for pixel in pixels(|_| true) {
                let (closed, open) = touched(pixel);
                assert_eq!(inclusive.counts.at(pixel.0, pixel.1) as usize, closed);
                assert_eq!(exclusive.counts.at(pixel.0, pixel.1) as usize, open);
            }
            doubles += inclusive.faults.len();
            cracks += exclusive.faults.len();
            outlines += inclusive.elsewhere + exclusive.elsewhere;
        }
    });
    assert!(doubles > 1000 && cracks > 1000 && outlines > 1000, "{doubles} {cracks} {outlines}");
}

#[test]
fn a_fault_names_triangles_that_touch_the_centre() {
    for_seeds(20, |rng| {
        let triangles = cells(rng);
        for fill_rule in [FillRule::Inclusive, FillRule::Exclusive] {
            for fault in hits(&triangles, &Settings { fill_rule, ..Settings::default() }).faults {
                let touches = |id| {
                    let one: Vec<_> = triangles.iter().filter(|t| t.id == id).copied().collect();
                    containing(&one, (fault.x, fault.y)).0 == 1
                };
                assert!(fault.sharing.into_iter().chain(fault.hit_by.clone()).all(touches), "{fault:?}");
                assert_ne!(fault.sharing[0], fault.sharing[1]);
                assert!(fault.due.len() <= 1, "nothing overlaps");
                match fault.kind {
                    FaultKind::Crack => assert_eq!((fault.hit_by.len(), fault.due[0]), (0, fault.sharing[0])),
                    FaultKind::DoubleHit => assert!(fault.sharing.iter().all(|id| fault.hit_by.contains(id))),
                }
            }
        }
    });
}

#[test]
fn sound_rules_have_no_fault_in_fixed_point_and_in_exact_arithmetic() {
    for scene in builtin::ALL {
        let built = scene.build();
        for rasterizer in Rasterizer::correct() {
            for (arithmetic, rule) in
                [("fixed", "top-left"), ("exact", "top-left"), ("fixed", "top-right"), ("fixed", "bottom-left")]
            {
                let recipe = recipe(&[
                    &format!("rasterizer={}", rasterizer.id()),
                    &format!("arithmetic={arithmetic}"),
                    &format!("fill-rule={rule}"),
                ]);
                let frame = render(&built, &recipe, (101, 64));
                let hits = Hits::of(&frame, &recipe.pipeline);
                assert_eq!(
                    (hits.faults.len(), hits.elsewhere),
                    (0, 0),
                    "{} {rasterizer:?} {arithmetic} {rule}",
                    scene.id
                );
            }
        }
    }
    for_seeds(40, |rng| {
        let triangles = cells(rng);
        for fill_rule in sound_fill_rules() {
            let hits = hits(&triangles, &Settings { fill_rule, ..Settings::default() });
            assert_eq!((hits.faults.len(), hits.elsewhere), (0, 0), "{fill_rule:?}");
        }
    });
}

#[test]
fn demonstration_scenes_show_faults_of_wrong_rules_and_published_rasterizers() {
    // An even size, so that the diagonals of `shared-edges` pass through pixel centres.
    let count = |scene: &str, setting: &str| {
        let (built, recipe) = (builtin::by_id(scene).map(builtin::Builtin::build), recipe(&[setting]));
        let built = built.expect("a scene of this name");
        let hits = Hits::of(&render(&built, &recipe, (320, 180)), &recipe.pipeline);
        (hits.count(FaultKind::Crack), hits.count(FaultKind::DoubleHit))
    };
    let (cracks, doubles) =
        (count("shared-edges", "fill-rule=exclusive"), count("shared-edges", "fill-rule=inclusive"));
    assert!(cracks.0 > 200 && cracks.1 == 0, "{cracks:?}");
    assert!(doubles.0 == 0 && doubles.1 > 200, "{doubles:?}");
    assert_eq!(count("slivers", "fill-rule=exclusive").1, 0);
    assert_eq!(count("slivers", "fill-rule=inclusive").0, 0);
    let (cracks, doubles) = count("slivers", "rasterizer=scanline-published");
    assert!(cracks > 50 && doubles > 1000, "{cracks} {doubles}");
    // This rasterizer shifts all samples equally and draws shared edges from both sides, which causes double hits but
    // no cracks.
    let (cracks, doubles) = count("shared-edges", "rasterizer=bounding-box-published");
    assert!(cracks == 0 && doubles > 200, "{cracks} {doubles}");
}

/// Returns a triangle fan that extends beyond the picture. Its spokes pass pixel centres as closely as floats allow.
fn close_fan(rng: &mut fastrand::Rng) -> Vec<ScreenTriangle> {
    let hub = (20.0 + 8.0 * signed(rng), 14.0 + 6.0 * signed(rng));
    let spokes = rng.u32(5..12);
    let rim = (0..spokes).map(|i| {
        let angle = (i as f32 + 0.3 * rng.f32()) / spokes as f32 * std::f32::consts::TAU;
        let passed = [hub.0 + 11.0 * angle.cos(), hub.1 - 11.0 * angle.sin()].map(|c| c.floor() + 0.5);
        let stretch = 20.0 + 10.0 * rng.f32();
        (hub.0 + (passed[0] - hub.0) * stretch, hub.1 + (passed[1] - hub.1) * stretch)
    });
    let places: Vec<_> = std::iter::once(hub).chain(rim).collect();
    let vertices: Vec<_> = places.into_iter().map(|place| clip_vertex(VIEW, place, 0.5, 1.0)).collect();
    let triangles: Vec<_> = (0..spokes).map(|i| [0, i + 1, (i + 1) % spokes + 1]).collect();
    screen_triangles(&vertices, &triangles, VIEW, &mut ())
}

#[test]
fn the_two_sides_of_an_edge_agree_in_floats_right_or_wrong() {
    // Counts wrong decisions, without which the test would prove nothing.
    let mut wrong = 0;
    for_seeds(400, |rng| {
        let triangles = close_fan(rng);
        for rasterizer in [Rasterizer::BoundingBox, Rasterizer::Tiled] {
            let settings = Settings { arithmetic: Arithmetic::F32, rasterizer, ..Settings::default() };
            let hits = hits(&triangles, &settings);
            assert_eq!((hits.faults.len(), hits.elsewhere), (0, 0), "{rasterizer:?}: {:?}", hits.faults);
            assert!(hits.counts.pixels().iter().all(|count| *count == 1));
            for triangle in &triangles {
                let covered =
                    |arithmetic| cover(rasterizer, arithmetic, triangle.corners_px(), FillRule::TopLeft, VIEW);
                wrong += usize::from(covered(Arithmetic::F32) != covered(Arithmetic::Exact));
            }
        }
    });
    assert!(wrong > 50, "only {wrong} triangles are decided wrongly");
}

#[test]
fn hits_are_counted_as_they_are_drawn_on_every_grid() {
    let scene = builtin::by_id("cubes").expect("a scene of this name").build();
    for (method, rasterizer) in [
        ("native", "tiled"),
        ("checkerboard", "scanline-published"),
        ("nearest", "bounding-box"),
        ("bicubic", "edge-walk"),
    ] {
        let recipe =
            recipe(&[&format!("upscaler.method={method}"), &format!("rasterizer={rasterizer}"), "fill-rule=inclusive"]);
        let frame = render(&scene, &recipe, (61, 44));
        let overdraw = rasterscope::inspect::capture(&scene, &recipe, &frame).overdraw;
        let hits = Hits::of(&frame, &recipe.pipeline);
        assert_eq!(hits.counts, overdraw, "{method}");
        for fault in &hits.faults {
            assert!(frame.drawn.grid.sample_at(fault.x, fault.y).is_some(), "{method}");
        }
        // A pixel examined alone has the same fault.
        for (x, y) in (0..44).flat_map(|y| (0..61).map(move |x| (x, y))) {
            let alone = rasterscope::inspect::hits::fault_at(&frame, &recipe.pipeline, x, y);
            let of_all = hits.faults.iter().find(|fault| (fault.x, fault.y) == (x, y));
            assert_eq!(alone.as_ref(), of_all, "{method} {x},{y}");
        }
    }
}

#[test]
fn faults_are_stepped_through_in_reading_order_and_wrap_around() {
    let triangles = cells(&mut fastrand::Rng::with_seed(3));
    let hits = hits(&triangles, &Settings { fill_rule: FillRule::Inclusive, ..Settings::default() });
    let mut seen = Vec::new();
    let mut at = None;
    for _ in 0..hits.faults.len() {
        let fault = hits.neighbour(at, true).expect("there are faults");
        at = Some((fault.x, fault.y));
        seen.push(fault.clone());
    }
    assert_eq!(seen, hits.faults);
    assert_eq!(hits.neighbour(at, true), hits.faults.first());
    for fault in hits.faults.iter().rev().skip(1).chain(hits.faults.last()) {
        let before = hits.neighbour(at, false).expect("there are faults");
        assert_eq!(before, fault);
        at = Some((before.x, before.y));
    }
}
