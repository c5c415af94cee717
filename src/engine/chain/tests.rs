//! Tests of frames that depend on earlier frames, with either execution.

use std::sync::Arc;

use super::replay;
use super::*;
use crate::antialias::settings::Antialiasing;
use crate::image::{Image, Rgba8};
use crate::pipeline::settings::{Choice as _, Execution};
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, Scene};
use crate::upscale::{Scale, Upscaling};

fn frames(
    method: &str,
    scale: impl Into<Scale>,
    cameras: &[Camera],
    scene: &Arc<Scene>,
    execution: Execution,
) -> Vec<Frame> {
    let upscaler = Upscaling::new(method, scale).unwrap();
    let recipe = Recipe { upscaler, execution, ..Recipe::default() };
    let mut renderer = Renderer::default();
    cameras
        .iter()
        .map(|camera| renderer.render(RenderInputs { scene, camera, recipe: &recipe, viewport: SIZE }, KeepDepth::Yes))
        .collect()
}

const SIZE: Viewport = Viewport { width: 131, height: 77 };

fn scene(id: &str) -> Arc<Scene> {
    Arc::new(crate::scene::builtin::by_id(id).unwrap().build())
}

fn native(scene: &Scene, camera: &Camera) -> Frame {
    run(scene, camera, &Recipe::default(), SIZE, &mut ())
}

fn squared_error(a: &Image<Rgba8>, b: &Image<Rgba8>) -> f64 {
    let codes = a.pixels().as_flattened().iter().zip(b.pixels().as_flattened());
    codes.map(|(a, b)| f64::from(a.abs_diff(*b)).powi(2)).sum()
}

#[test]
fn a_temporal_checkerboard_is_native_in_the_second_still_frame() {
    for id in ["chess", "cubes", "near-plane", "interpenetrating"] {
        let scene = scene(id);
        for execution in Execution::ALL {
            let still = [scene.home; 4];
            let drawn = frames("checkerboard-temporal", 1, &still, &scene, *execution);
            let native = native(&scene, &scene.home);
            assert_ne!(drawn[0].image(), native.image(), "{id}");
            for frame in &drawn[1..] {
                assert_eq!(frame.image(), native.image(), "{id} {execution:?}");
                assert!(frame.drawn_share() < 0.51);
            }
            let recipe = Recipe { upscaler: Upscaling::new("checkerboard-temporal", 1).unwrap(), ..Recipe::default() };
            assert_eq!(drawn.iter().map(|f| f.is_converging(&recipe)).collect::<Vec<_>>(), [true, false, false, false]);
        }
    }
}

#[test]
fn in_motion_the_frame_before_helps_more_than_neighbours() {
    let scene = scene("chess");
    let mut cameras = [scene.home; 6];
    for (step, camera) in cameras.iter_mut().enumerate() {
        camera.orbit(0.004 * step as f32, 0.0);
    }
    let last = |method| {
        let frame = frames(method, 1, &cameras, &scene, Execution::Tiled).pop().unwrap();
        squared_error(frame.image(), native(&scene, &cameras[5]).image())
    };
    let [plain, surfaces, temporal] = ["checkerboard", "checkerboard-surfaces", "checkerboard-temporal"].map(last);
    assert!(surfaces < plain, "{surfaces} {plain}");
    assert!(temporal < surfaces, "{temporal} {surfaces}");
}

/// Upscalers that read earlier frames, with scales.
const MANY_FRAMES: [(&str, f64); 5] =
    [("checkerboard-temporal", 1.0), ("accumulation", 1.0), ("accumulation", 2.0), ("fsr2", 1.5), ("sgsr2", 1.5)];

#[test]
fn a_settled_picture_changes_no_more() {
    // The camera is still from the first frame, or stops after moving for five frames.
    for (id, moved) in [("chess", 0), ("stained-glass", 5)] {
        let scene = scene(id);
        let mut cameras = vec![scene.home; moved + 28];
        for (step, camera) in cameras.iter_mut().enumerate().take(moved) {
            camera.orbit(0.01 * (step as f32 - moved as f32), 0.0);
        }
        for (method, scale) in MANY_FRAMES {
            let upscaler = Upscaling::new(method, scale).unwrap();
            let recipe = Recipe { upscaler, ..Recipe::default() };
            let drawn = frames(method, scale, &cameras, &scene, Execution::Tiled);
            let settled = drawn.iter().skip(moved).position(|frame| !frame.is_converging(&recipe)).unwrap();
            assert_eq!(settled + 1, upscaler.upscaler().converges_after(upscaler) as usize, "{method} ×{scale}");
            let [first, rest @ ..] = &drawn[moved + settled..] else { panic!("no frame has converged") };
            assert!(rest.len() >= 10 && rest.iter().all(|frame| frame.image() == first.image()), "{method} ×{scale}");
        }
    }
}

#[test]
fn every_pixel_of_a_frame_with_a_past_is_replayed() {
    let scene = scene("cubes");
    let mut cameras = [scene.home; 3];
    cameras[2].orbit(0.03, 0.01);
    for (method, scale) in MANY_FRAMES {
        let recipe = Recipe { upscaler: Upscaling::new(method, scale).unwrap(), ..Recipe::default() };
        let size = Viewport { width: 37, height: 29 };
        let mut renderer = Renderer::default();
        for camera in &cameras {
            let frame = renderer
                .render(RenderInputs { scene: &scene, camera, recipe: &recipe, viewport: size }, KeepDepth::Yes);
            let how = recipe.upscaler;
            for (x, y) in (0..size.height).flat_map(|y| (0..size.width).map(move |x| (x, y))) {
                let taps =
                    how.upscaler().taps(how, &frame.as_drawn(&frame.drawn.color), (size.width, size.height), (x, y));
                let pixels: Vec<_> = taps.iter().map(|tap| (tap.x, tap.y)).collect();
                let mut known = Image::filled(frame.drawn.color.width(), frame.drawn.color.height(), [255, 0, 173, 1]);
                for (samples, at) in replay::replay(&scene, &recipe, &frame, &pixels).iter().zip(&pixels) {
                    let (column, row) = frame.drawn.grid.sample_at(at.0, at.1).unwrap();
                    known.set(column, row, samples[0]);
                }
                let alone = how.upscaler().pixel(how, &frame.as_drawn(&known), (size.width, size.height), (x, y));
                assert_eq!(alone, frame.image().at(x, y), "{method} ({x}, {y}) {taps:?}");
                assert!((taps.iter().map(|tap| tap.weight).sum::<f32>() - 1.0).abs() < 1e-5);
            }
        }
    }
}

#[test]
fn accumulation_comes_to_the_mean_of_its_samples() {
    let scene = scene("chess");
    let drawn = frames("accumulation", 1, &[scene.home; 16], &scene, Execution::Tiled);
    let antialias = Antialiasing {
        method: crate::antialias::settings::AntialiasMethod::LowDiscrepancy,
        samples: crate::antialias::settings::SampleCount::Sixteen,
        ..Antialiasing::default()
    };
    let smooth = run(&scene, &scene.home, &Recipe { antialias, ..Recipe::default() }, SIZE, &mut ());
    let codes = drawn[15].image().pixels().as_flattened().iter().zip(smooth.image().pixels().as_flattened());
    assert!(codes.into_iter().all(|(a, b)| a.abs_diff(*b) <= 1));
    let errors: Vec<_> = drawn.iter().map(|frame| squared_error(frame.image(), smooth.image())).collect();
    assert!(errors[7] < errors[0] / 4.0 && errors[15] < errors[7] / 4.0, "{errors:?}");
}

#[test]
fn enlarged_accumulation_regains_what_one_frame_has_not() {
    let scene = scene("chess");
    let drawn = frames("accumulation", 2, &[scene.home; 16], &scene, Execution::Tiled);
    let native = native(&scene, &scene.home);
    let errors: Vec<_> = drawn.iter().map(|frame| squared_error(frame.image(), native.image())).collect();
    assert!(errors[15] < errors[0] / 2.0, "{errors:?}");
}

#[test]
fn another_scene_recipe_or_size_has_no_past() {
    let scene = scene("cubes");
    let recipe = Recipe { upscaler: Upscaling::new("checkerboard-temporal", 1).unwrap(), ..Recipe::default() };
    let mut renderer = Renderer::default();
    let mut draw = |scene: &Arc<Scene>, recipe: &Recipe, size| {
        renderer
            .render(RenderInputs { scene, camera: &scene.home, recipe, viewport: size }, KeepDepth::Yes)
            .history
            .is_some()
    };
    let lines = Recipe { wireframe: true, ..recipe };
    let smaller = Viewport { width: 40, height: 30 };
    let twin = Arc::new((*scene).clone());
    assert!(!draw(&scene, &recipe, SIZE) && draw(&scene, &recipe, SIZE));
    assert!(!draw(&twin, &recipe, SIZE) && !draw(&twin, &lines, SIZE) && !draw(&twin, &lines, smaller));
}

#[test]
fn a_frame_reuses_the_buffers_of_a_recycled_one() {
    let scene = scene("chess");
    let upscaler = Upscaling::new("bilinear", 2).unwrap();
    for execution in Execution::ALL {
        let recipe = Recipe { upscaler, execution: *execution, ..Recipe::default() };
        let mut renderer = Renderer::default();
        let draw = |renderer: &mut Renderer| {
            renderer.render(
                RenderInputs { scene: &scene, camera: &scene.home, recipe: &recipe, viewport: SIZE },
                KeepDepth::Yes,
            )
        };
        let first = draw(&mut renderer);
        let (picture, memory) = (first.image().clone(), first.image().pixels().as_ptr());
        renderer.recycle(first);
        let second = draw(&mut renderer);
        assert_eq!(second.image().pixels().as_ptr(), memory, "{execution:?}");
        assert_eq!(*second.image(), picture, "{execution:?}");
    }
}

#[test]
fn the_gbuffer_is_redrawn_only_after_the_view_has_moved() {
    let scene = scene("cubes");
    let mut cameras = [scene.home; 4];
    cameras[2].orbit(0.03, 0.01);
    cameras[3] = cameras[2];
    for execution in Execution::ALL {
        let drawn = frames("accumulation", 1, &cameras, &scene, *execution);
        let shown: Vec<_> = drawn.iter().map(|frame| &frame.surfaces.as_ref().unwrap().gbuffer).collect();
        assert!(Arc::ptr_eq(shown[0], shown[1]) && Arc::ptr_eq(shown[2], shown[3]), "{execution:?}");
        for (frame, shown) in drawn.iter().zip(shown) {
            let alone = &frames("accumulation", 1, &[frame.camera], &scene, *execution)[0];
            assert_eq!(alone.surfaces.as_ref().map(|alone| &alone.gbuffer), Some(shown), "{execution:?}");
        }
    }
}

#[test]
fn the_blending_with_history_reproduces_every_pixel() {
    for (name, orbit) in [("chess-motion", 0.0), ("cubes", 0.02)] {
        let scene = scene(name);
        for upscaler in Upscaling::every().filter(|upscaler| upscaler.upscaler().reads().history) {
            let recipe = Recipe { upscaler, ..Recipe::default() };
            let mut renderer = Renderer::default();
            let (mut camera, mut blended, mut rejected) = (scene.home, 0, 0);
            for (number, first) in (0..10).zip(0..) {
                let posed = scene.at(f64::from(number) / 30.0);
                let frame = renderer.render(
                    RenderInputs { scene: &posed, camera: &camera, recipe: &recipe, viewport: SIZE },
                    KeepDepth::No,
                );
                let inputs = frame.as_drawn(&frame.drawn.color);
                let steps = upscaler.upscaler().history_steps(upscaler, &inputs);
                // Every pixel is compared in one of the frames.
                let pixels = (0..SIZE.height).flat_map(|y| (0..SIZE.width).map(move |x| (x, y)));
                for at in pixels.skip(first).step_by(10) {
                    let Some(step) = steps(at) else { continue };
                    let [r, g, b, _] = frame.image().at(at.0, at.1);
                    assert_eq!(step.codes(), [r, g, b], "{name} {} frame {number} {at:?}", upscaler.label());
                    *(if step.past.is_ok() { &mut blended } else { &mut rejected }) += 1;
                }
                camera.orbit(orbit, 0.0);
            }
            assert!(blended > 100 && rejected > 0, "{name} {}: {blended} {rejected}", upscaler.label());
        }
    }
}
