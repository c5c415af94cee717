//! Checks that both executions and the replay of pixels agree bit for bit.

use std::sync::Arc;

use rasterscope::chain::{KeepDepth, Recipe, RenderInputs, Renderer, run};
use rasterscope::inspect::inspect;
use rasterscope::measure::equality::verify;
use rasterscope::pipeline::settings::Execution;
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::scene::{Camera, Scene};
use rayon::ThreadPoolBuilder;

use crate::fuzz::driver::{Failure, STACK_BYTES};

/// Number of threads in tiled execution.
const THREADS: usize = 2;

/// Checks that tiled execution, on all kinds of SIMD lanes, draws the same frame as classic execution.
pub(crate) fn check(scene: &Arc<Scene>, camera: &Camera, recipe: &Recipe, size: Viewport) -> Result<(), Failure> {
    let equality = verify(scene, camera, recipe, size, &[THREADS])
        .map_err(|error| Failure::Wrong(format!("no threads: {error}")))?;
    match equality.ways.iter().find(|way| way.difference.is_some()) {
        None => Ok(()),
        Some(way) => Err(Failure::Wrong(format!("tiled execution differs: {way:?}"))),
    }
}

/// Checks that the second of two frames, which may use the first as its history, is equal in both executions.
pub(crate) fn check_second_frame(
    scene: &Arc<Scene>,
    cameras: [&Camera; 2],
    recipe: &Recipe,
    size: Viewport,
) -> Result<(), Failure> {
    let pool = ThreadPoolBuilder::new().num_threads(THREADS).stack_size(STACK_BYTES).build();
    let pool = pool.map_err(|error| Failure::Wrong(format!("no threads: {error}")))?;
    let draw = |execution| {
        let mut renderer = Renderer::default();
        let recipe = Recipe { execution, ..*recipe };
        let first = renderer
            .render(RenderInputs { scene, camera: cameras[0], recipe: &recipe, viewport: size }, KeepDepth::Yes);
        renderer.recycle(first);
        renderer.render(RenderInputs { scene, camera: cameras[1], recipe: &recipe, viewport: size }, KeepDepth::Yes)
    };
    let [classic, tiled] = [Execution::Classic, Execution::Tiled].map(|execution| pool.install(|| draw(execution)));
    let pixels = classic.image().pixels().iter().zip(tiled.image().pixels());
    match pixels.enumerate().find(|(_, (classic, tiled))| classic != tiled) {
        None => Ok(()),
        Some((index, (classic, tiled))) => {
            Err(Failure::Wrong(format!("second frame differs: pixel {index}, {classic:?} classic, {tiled:?} tiled")))
        }
    }
}

/// Checks that the replay of every `step`-th pixel gives the drawn colour.
pub(crate) fn check_replay(
    scene: &Scene,
    camera: &Camera,
    recipe: &Recipe,
    size: Viewport,
    step: usize,
) -> Result<(), Failure> {
    let frame = run(scene, camera, recipe, size, &mut ());
    let pixels = (0..size.height).flat_map(|y| (0..size.width).map(move |x| (x, y)));
    for (x, y) in pixels.step_by(step) {
        let replayed = inspect(scene, recipe, &frame, x, y).map(|report| report.color);
        let drawn = frame.image().at(x, y);
        if replayed != Some(drawn) {
            return Err(Failure::Wrong(format!("replay differs: pixel {x}, {y} is {drawn:?}, replayed {replayed:?}")));
        }
    }
    Ok(())
}
