use std::sync::Arc;

use super::*;
use crate::chain::run;
use crate::inspect::inspect;
use crate::pipeline::settings::{Arithmetic, BlendingOrder, Culling, DepthTest, Rasterizer};
use crate::pipeline::viewport::Viewport;
use crate::scene::builtin;
use crate::upscale::Upscaling;

const SIZE: Viewport = Viewport { width: 53, height: 37 };

fn scene(id: &str) -> Arc<Scene> {
    Arc::new(builtin::by_id(id).unwrap().build())
}

/// Draws the first `triangles` triangles of a frame from the start, without checkpoints.
fn from_the_start(scene: &Scene, recipe: &Recipe, frame: &Frame, triangles: usize) -> Framebuffer {
    let mut geometry = prepare_again(scene, recipe, frame, &mut ());
    geometry.triangles.truncate(triangles);
    let (grid, Viewport { width, height }) = (frame.sampling.grid(), frame.raster);
    let mut drawn = Framebuffer::new(grid, width, height, scene.background, &recipe.pipeline);
    drawn.depth_scale = geometry.depth_scale;
    let extent = Extent::all(&geometry, frame.raster);
    DrawCall::new(scene, &geometry, &recipe.pipeline, &extent).draw(&mut drawn, &mut ());
    drawn
}

fn recipes() -> Vec<Recipe> {
    let with = |change: fn(&mut Recipe)| {
        let mut recipe = Recipe::default();
        change(&mut recipe);
        recipe
    };
    vec![
        Recipe::default(),
        with(|r| (r.pipeline.blending.order, r.pipeline.culling) = (BlendingOrder::Exact, Culling::None)),
        with(|r| (r.pipeline.arithmetic, r.pipeline.culling) = (Arithmetic::F32, Culling::None)),
        with(|r| (r.pipeline.depth_test, r.pipeline.rasterizer) = (DepthTest::Off, Rasterizer::Tiled)),
        Recipe { upscaler: Upscaling::new("checkerboard", 1).unwrap(), ..Recipe::default() },
        Recipe { upscaler: Upscaling::new("bilinear", 2).unwrap(), ..Recipe::default() },
    ]
}

#[test]
fn every_moment_equals_drawing_from_the_start_bit_for_bit() {
    let mut dice = fastrand::Rng::with_seed(7);
    for id in ["interpenetrating", "stained-glass", "cubes", "near-plane"] {
        let scene = scene(id);
        for recipe in recipes() {
            let frame = run(&scene, &scene.home, &recipe, SIZE, &mut ());
            // The first budget allows few checkpoints, far apart; the second allows many.
            for budget in [0, BUDGET] {
                let mut scrubber = Scrubber::new(&scene, &recipe, &frame, budget);
                let all = scrubber.geometry().triangles.len();
                let jumps = (0..4).map(|_| dice.usize(..=all)).collect::<Vec<_>>();
                for triangles in jumps.into_iter().chain([all, all.saturating_sub(1), 0, 1.min(all), all + 3]) {
                    let expected = from_the_start(&scene, &recipe, &frame, triangles);
                    assert_eq!(scrubber.frame_at(Moment::after(triangles)), expected, "{id} {triangles} {recipe:?}");
                }
                assert!(budget > 0 || scrubber.memory().0 <= 2);
                assert_eq!(scrubber.frame_at(Moment::after(all)).color, frame.drawn.color, "{id} {recipe:?}");
            }
        }
    }
}

/// Counts the samples at which two framebuffers differ.
fn differing(a: &Framebuffer, b: &Framebuffer) -> usize {
    a.color.pixels().iter().zip(b.color.pixels()).filter(|(a, b)| a != b).count()
}

#[test]
fn fragments_are_added_one_by_one_until_their_triangle_is_complete() {
    for id in ["interpenetrating", "stained-glass"] {
        let scene = scene(id);
        let recipe = Recipe::default();
        let frame = run(&scene, &scene.home, &recipe, SIZE, &mut ());
        let mut scrubber = Scrubber::new(&scene, &recipe, &frame, BUDGET);
        for triangles in 1..=scrubber.geometry().triangles.len().min(4) {
            let fragments = scrubber.fragments_of(triangles - 1);
            let mut before = scrubber.frame_at(Moment::after(triangles - 1));
            for drawn in 0..=fragments {
                let now = scrubber.frame_at(Moment { triangles, fragments: Some(drawn) });
                assert!(differing(&before, &now) <= usize::from(drawn > 0), "{id} {triangles} {drawn}");
                before = now;
            }
            assert_eq!(before, scrubber.frame_at(Moment::after(triangles)), "{id} {triangles}");
        }
    }
}

#[test]
fn the_inspector_agrees_with_the_frame_at_every_moment() {
    let scene = scene("interpenetrating");
    let recipe = Recipe::default();
    let frame = run(&scene, &scene.home, &recipe, SIZE, &mut ());
    let mut scrubber = Scrubber::new(&scene, &recipe, &frame, BUDGET);
    let all = scrubber.geometry().triangles.len();
    let mut compared = 0;
    for triangles in 1..=all {
        let fragments = scrubber.fragments_of(triangles - 1);
        for fragments in [None, Some(0), Some(1), Some(fragments / 2), Some(fragments)] {
            let moment = Moment { triangles, fragments };
            let drawn = scrubber.frame_at(moment);
            let frame = frame.at_moment(&recipe, drawn, scrubber.geometry_at(moment));
            for (x, y) in (0..SIZE.height).flat_map(|y| (0..SIZE.width).map(move |x| (x, y))) {
                let report = inspect(&scene, &recipe, &frame, x, y).unwrap();
                assert_eq!(report.color, frame.image().at(x, y), "({x}, {y}) {moment:?}");
                compared += report.fragments.len();
            }
        }
    }
    assert!(compared > 1000);
}

#[test]
fn each_touch_adds_one_fragment_to_the_replay() {
    let scene = scene("stained-glass");
    let recipe = Recipe::default();
    let frame = run(&scene, &scene.home, &recipe, SIZE, &mut ());
    let scrubber = Scrubber::new(&scene, &recipe, &frame, BUDGET);
    let whole = scrubber.drawing();
    for pixel in [(26, 18), (20, 20), (10, 30), (40, 12)] {
        let found = whole.touches(pixel, TouchPrecision::Fragments);
        let report = inspect(&scene, &recipe, &frame, pixel.0, pixel.1).unwrap();
        let expected: Vec<_> =
            report.fragments.iter().map(|f| (f.triangle, f.submission + 1, f.shading.is_some())).collect();
        let reported: Vec<_> = found.iter().map(|t| (t.triangle, t.moment.triangles, t.written)).collect();
        assert_eq!(reported, expected);
        for (count, touch) in found.iter().enumerate() {
            let fragments = touch.moment.fragments.unwrap();
            for (fragments, expected) in [(fragments - 1, count), (fragments, count + 1)] {
                let moment = Moment { fragments: Some(fragments), ..touch.moment };
                let geometry = scrubber.geometry_at(moment);
                let drawing = TouchedDrawing { geometry: &geometry, ..whole };
                assert_eq!(drawing.touches(pixel, TouchPrecision::Fragments).len(), expected, "{moment:?}");
            }
        }
    }
}

#[test]
fn checkpoints_stay_within_their_memory_budget() {
    let scene = scene("cubes");
    let recipe = Recipe::default();
    let frame = run(&scene, &scene.home, &recipe, SIZE, &mut ());
    let one = SIZE.width as usize * SIZE.height as usize * 8;
    let mut scrubber = Scrubber::new(&scene, &recipe, &frame, 5 * one);
    scrubber.frame_at(Moment::after(usize::MAX));
    let (count, bytes) = scrubber.memory();
    assert!((3..=5).contains(&count) && bytes <= 5 * one, "{count} copies, {bytes} bytes");
}

/// Returns a timeline of three draws with 2, 3 and 1 triangles; every triangle has 4 fragments. The third fragment of
/// triangle 1 and that of triangle 4 lie at the picked pixel.
fn timeline() -> Timeline {
    let touch = |place: usize| Touch {
        triangle: crate::scene::TriangleId(place as u32),
        moment: Moment { triangles: place + 1, fragments: Some(3) },
        written: true,
    };
    Timeline {
        triangles: 6,
        draws: vec![(0, 0), (2, 1), (5, 2)],
        fragments: [4, 4],
        last: None,
        touches: vec![touch(1), touch(4)],
    }
}

/// Returns the playback positions visited by stepping from one end of the timeline to the other.
fn walk(unit: Unit, forwards: bool, touching: bool) -> Vec<(usize, Option<usize>)> {
    let timeline = timeline();
    let mut moments = vec![Moment::after(if forwards { 0 } else { timeline.triangles })];
    loop {
        let last = moments[moments.len() - 1];
        match timeline.step(last, unit, forwards, touching) {
            next if next == last => return moments.iter().map(|m| (m.triangles, m.fragments)).collect(),
            next => moments.push(next),
        }
    }
}

#[test]
fn steps_lead_through_every_moment_and_end() {
    let whole = |places: &[usize]| places.iter().map(|place| (*place, None)).collect::<Vec<_>>();
    assert_eq!(walk(Unit::Draw, true, false), whole(&[0, 2, 5, 6]));
    assert_eq!(walk(Unit::Draw, false, false), whole(&[6, 5, 2, 0]));
    assert_eq!(walk(Unit::Triangle, true, false), whole(&[0, 1, 2, 3, 4, 5, 6]));
    assert_eq!(walk(Unit::Triangle, true, true), whole(&[0, 2, 5, 6]));
    assert_eq!(walk(Unit::Triangle, false, true), whole(&[6, 5, 2, 0]));
    assert_eq!(walk(Unit::Fragment, true, true), [(0, None), (2, Some(3)), (5, Some(3)), (6, None)]);
    assert_eq!(walk(Unit::Fragment, false, true), [(6, None), (5, Some(3)), (2, Some(3)), (0, None)]);
    assert_eq!(walk(Unit::Stage, true, false), whole(&[0]));
    let mut there = walk(Unit::Fragment, true, false);
    assert_eq!(there.len(), 1 + 6 * 4);
    assert_eq!(there[..6], [(0, None), (1, Some(1)), (1, Some(2)), (1, Some(3)), (1, None), (2, Some(1))]);
    let mut back = walk(Unit::Fragment, false, false);
    back.reverse();
    assert_eq!(there, back);
    there.dedup();
    assert_eq!(there.len(), 25);
}

#[test]
fn several_steps_at_once_stop_at_the_end_of_the_frame() {
    let timeline = timeline();
    let steps = |from: Moment, unit, count| timeline.steps(from, unit, count, false);
    assert_eq!(steps(Moment::after(1), Unit::Triangle, 3), Moment::after(4));
    assert_eq!(steps(Moment::after(1), Unit::Triangle, -9), Moment::after(0));
    assert_eq!(steps(Moment::after(1), Unit::Triangle, 900), Moment::after(6));
    let partial = Moment { triangles: 2, fragments: Some(1) };
    assert_eq!(steps(partial, Unit::Fragment, 2), Moment { triangles: 2, fragments: Some(3) });
    // The number of fragments of the next triangle is not yet known.
    assert_eq!(steps(partial, Unit::Fragment, 9).triangles, 3);
    assert_eq!(steps(partial, Unit::Draw, 1), Moment::after(2));
    assert_eq!(steps(partial, Unit::Draw, -1), Moment::after(0));
}
