//! Find out why a pixel has its colour.
//!
//! Run it with `cargo run --release --example query_pixel`.

#![expect(clippy::print_stdout, reason = "an example prints its results")]

use std::sync::Arc;

use rasterscope::chain::{Recipe, RenderInputs, Renderer};
use rasterscope::inspect::inspect;
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::scene::builtin;

fn main() {
    let scene = builtin::ALL.iter().find(|scene| scene.id == "interpenetrating").expect("it is built in");
    let scene = Arc::new(scene.build());
    let (recipe, viewport) = (Recipe::default(), Viewport { width: 320, height: 180 });
    let frame = Renderer::default().render_converged(RenderInputs {
        scene: &scene,
        camera: &scene.home,
        recipe: &recipe,
        viewport,
    });

    // Nothing was recorded while the frame was drawn. The inspector draws this one pixel again, with the same
    // arithmetic and an observer, so the result has the same bits.
    let (x, y) = (160, 90);
    let report = inspect(&scene, &recipe, &frame, x, y).expect("the pixel lies in the picture");
    assert_eq!(report.color, frame.image().at(x, y));

    println!("{}", report.verdict);
    for fragment in &report.fragments {
        let [a, b, c] = fragment.affine_weights;
        println!(
            "triangle {}: {:?}, depth {}, weights {a:.3} {b:.3} {c:.3}: {}",
            fragment.triangle.0, fragment.outcome, fragment.depth.value, fragment.reason
        );
    }
}
