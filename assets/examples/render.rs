//! Render a scene into a PNG.
//!
//! Run it with `cargo run --release --example render`.

#![expect(clippy::print_stdout, reason = "an example prints its results")]

use std::path::Path;
use std::sync::Arc;

use rasterscope::chain::{Recipe, RenderInputs, Renderer};
use rasterscope::image::file::write_png;
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::scene::builtin;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A scene is validated data: meshes, materials and a camera of its own. The first built-in scene is the chess set;
    // `rasterscope::scene::SceneSource` loads OBJ files.
    let scene = Arc::new(builtin::ALL[0].build());

    // A recipe holds every setting. Settings are named as on the command line; an invalid one gives an error that lists
    // the valid ones.
    let mut recipe = Recipe::default();
    recipe.set("shading=gouraud")?;
    recipe.set("antialias.method=multisample")?;

    // A renderer keeps its buffers from frame to frame. It draws on the threads of the current rayon pool, and gives the
    // same bits for any number of them.
    let viewport = Viewport { width: 640, height: 360 };
    let mut renderer = Renderer::default();
    let frame =
        renderer.render_converged(RenderInputs { scene: &scene, camera: &scene.home, recipe: &recipe, viewport });

    let path = Path::new("chess.png");
    write_png(path, frame.image())?;
    println!("{}: {} triangles in {:.1} ms", path.display(), frame.rasterized(), frame.times.total.as_secs_f64() * 1e3);
    Ok(())
}
