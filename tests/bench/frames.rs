//! Benchmarks of whole frames, of single upscalers and of the inspector: `cargo bench`.

use std::sync::Arc;

use divan::Bencher;
use rasterscope::chain::{Recipe, RenderInputs, Renderer};
use rasterscope::image::Image;
use rasterscope::inspect::inspect;
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::scene::{Scene, builtin};
use rasterscope::upscale::{UpscaleInputs, Upscaling};

const VIEWPORT: Viewport = Viewport { width: 1280, height: 720 };

fn main() {
    divan::main();
}

fn scene(id: &str) -> Arc<Scene> {
    Arc::new(builtin::ALL.iter().find(|scene| scene.id == id).expect("it is built in").build())
}

/// Measures frames of a scene with the default settings and warm buffers, on all threads.
#[divan::bench(args = ["chess", "cubes", "stained-glass", "cel"])]
fn frame(bencher: Bencher<'_, '_>, id: &str) {
    let (scene, recipe, mut renderer) = (scene(id), Recipe::default(), Renderer::default());
    bencher.bench_local(move || {
        let frame = renderer.render_converged(RenderInputs {
            scene: &scene,
            camera: &scene.home,
            recipe: &recipe,
            viewport: VIEWPORT,
        });
        renderer.recycle(frame);
    });
}

/// Measures upscaling of the scene chess at scale 2, without drawing.
#[divan::bench(args = ["nearest", "bilinear", "bicubic", "lanczos3", "fsr1"])]
fn upscale(bencher: Bencher<'_, '_>, method: &str) {
    let how = Upscaling::new(method, 2).expect("the method offers scale 2");
    let recipe = Recipe { upscaler: how, ..Recipe::default() };
    let scene = scene("chess");
    let frame = Renderer::default().render_converged(RenderInputs {
        scene: &scene,
        camera: &scene.home,
        recipe: &recipe,
        viewport: VIEWPORT,
    });
    let mut full = Image::filled(VIEWPORT.width, VIEWPORT.height, [0; 4]);
    bencher.bench_local(move || how.upscaler().upscale(how, &UpscaleInputs::from(&frame.drawn.color), &mut full));
}

/// Measures replaying and explaining one pixel.
#[divan::bench]
fn inspect_pixel(bencher: Bencher<'_, '_>) {
    let (scene, recipe) = (scene("chess"), Recipe::default());
    let frame = Renderer::default().render_converged(RenderInputs {
        scene: &scene,
        camera: &scene.home,
        recipe: &recipe,
        viewport: VIEWPORT,
    });
    bencher.bench_local(|| inspect(&scene, &recipe, &frame, 700, 300));
}
