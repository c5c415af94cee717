//! Write an upscaler, register it, and measure its error and its time like those of the built-in upscalers.
//!
//! Run it with `cargo run --release --example own_upscaler`. EPX (Eric Johnston, 1992) doubles pixel art: a corner of a
//! doubled pixel takes the colour of its two neighbours if these are equal.

#![expect(clippy::print_stdout, reason = "an example prints its results")]

use std::sync::Arc;

use rasterscope::chain::{Recipe, RenderInputs, Renderer};
use rasterscope::image::{Image, Rgba8};
use rasterscope::measure::error::compare;
use rasterscope::measure::metric::Metric;
use rasterscope::measure::motion::Turn;
use rasterscope::measure::reference::Reference;
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::report::upscaling::csv::csv;
use rasterscope::report::upscaling::sweep::{self, NamedView, UpscalingPlan};
use rasterscope::scene::builtin;
use rasterscope::upscale::{
    self, Anchor, FilterSpace, Offers, Sampling, Scale, Tap, UpscaleInputs, Upscaler, Upscaling,
};

/// The EPX upscaler, which has a scale of 2.
struct Epx;

impl Epx {
    /// Returns the drawn sample that output pixel (x, y) copies.
    fn source(samples: &Image<Rgba8>, x: u32, y: u32) -> (u32, u32) {
        let (i, j) = (i64::from(x / 2), i64::from(y / 2));
        // Steps to the neighbours beside the corner of the sample that the pixel occupies.
        let (dx, dy) = (if x.is_multiple_of(2) { -1 } else { 1 }, if y.is_multiple_of(2) { -1 } else { 1 });
        let at = |i: i64, j: i64| samples.at_clamped(i, j);
        let (beside, above) = (at(i + dx, j), at(i, j + dy));
        let is_corner = beside == above && beside != at(i, j - dy) && above != at(i - dx, j);
        if is_corner {
            ((i + dx).clamp(0, i64::from(samples.width()) - 1) as u32, j as u32)
        } else {
            (i as u32, j as u32)
        }
    }
}

impl Upscaler for Epx {
    fn id(&self) -> &'static str {
        "epx"
    }

    fn name(&self) -> &'static str {
        "EPX"
    }

    fn help(&self) -> &'static str {
        "Doubles pixel art and rounds its corners. Invents no colour."
    }

    fn offers(&self) -> Offers {
        let scales = &[Scale::TWO];
        Offers {
            scales,
            anchors: &[Anchor::Centre],
            lights: &[FilterSpace::Bytes],
            deringing: false,
            sharpening: false,
            history: false,
        }
    }

    fn sampling(&self, how: Upscaling) -> Sampling {
        Sampling::of_lattice(how.lattice())
    }

    fn upscale(&self, how: Upscaling, drawn: &UpscaleInputs<'_>, full: &mut Image<Rgba8>) {
        let size = full.size();
        for y in 0..size.1 {
            for x in 0..size.0 {
                full.set(x, y, self.pixel(how, drawn, size, (x, y)));
            }
        }
    }

    // With the colour of a single pixel and its sources, the inspector can explain every pixel.
    fn pixel(&self, _how: Upscaling, drawn: &UpscaleInputs<'_>, _size: (u32, u32), (x, y): (u32, u32)) -> Rgba8 {
        let (column, row) = Self::source(drawn.color, x, y);
        drawn.color.at(column, row)
    }

    fn taps(&self, _how: Upscaling, drawn: &UpscaleInputs<'_>, _size: (u32, u32), (x, y): (u32, u32)) -> Vec<Tap> {
        let (x, y) = Self::source(drawn.color, x, y);
        vec![Tap { x, y, weight: 1.0 }]
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // From here on, recipes, menus, comparisons and reports of this program know the upscaler by its id.
    upscale::register(&Epx)?;

    let scene = Arc::new(builtin::ALL[0].build());
    let viewport = Viewport { width: 640, height: 360 };
    let mut renderer = Renderer::default();
    let reference = renderer.render_converged(RenderInputs {
        scene: &scene,
        camera: &scene.home,
        recipe: &Recipe::default(),
        viewport,
    });
    let mut upscalers = Vec::new();
    for method in ["nearest", "epx"] {
        let mut recipe = Recipe::default();
        recipe.set_all(&[&format!("upscaler.method={method}"), "upscaler.scale=2", "upscaler.anchor=centre"])?;
        let frame =
            renderer.render_converged(RenderInputs { scene: &scene, camera: &scene.home, recipe: &recipe, viewport });
        let error = compare(frame.image(), reference.image()).ok_or("pictures of different sizes")?;
        println!("{:8} PSNR {:.2} dB, SSIM {:.4}", recipe.upscaler.upscaler().name(), error.psnr_db, error.ssim);
        upscalers.push(recipe.upscaler);
    }

    // `Upscaling::every` would return all upscalers at every scale, including the registered one.
    let plan = UpscalingPlan {
        subjects: vec![NamedView { name: scene.name.clone(), camera: scene.home, recipe: Recipe::default(), scene }],
        upscalers,
        viewport,
        rounds: 5,
        reference: Reference::Native,
        metric: Metric::Flip,
        turn: Turn::default(),
    };
    let report = sweep::run(&plan, &|_| (), &|| false).ok_or("nothing was measured")?;
    print!("{}", csv(&report));
    Ok(())
}
