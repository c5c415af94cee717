//! Upscalers that a program registers through the library.

use std::sync::Arc;

use rasterscope::chain::{Recipe, RenderInputs, Renderer};
use rasterscope::image::{Image, Rgba8};
use rasterscope::inspect::inspect;
use rasterscope::measure::motion::Turn;
use rasterscope::measure::reference::Reference;
use rasterscope::measure::response::Responses;
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::report::upscaling::csv::csv;
use rasterscope::report::upscaling::page::page;
use rasterscope::report::upscaling::sweep::{self, NamedView, UpscalingPlan};
use rasterscope::scene::builtin;
use rasterscope::upscale::{
    self, Anchor, BUILT_IN, FilterSpace, Offers, RegisterError, Sampling, Scale, Tap, UpscaleInputs, Upscaler,
    Upscaling,
};

/// Upscaler that paints every pixel in the colour of the first sample.
struct Flat {
    id: &'static str,
    scales: &'static [Scale],
}

impl Upscaler for Flat {
    fn id(&self) -> &'static str {
        self.id
    }

    fn name(&self) -> &'static str {
        "Flat"
    }

    fn help(&self) -> &'static str {
        "Paints every pixel in the colour of the first sample."
    }

    fn offers(&self) -> Offers {
        Offers {
            scales: self.scales,
            anchors: &[Anchor::Corner],
            lights: &[FilterSpace::Bytes],
            deringing: false,
            sharpening: false,
            history: false,
        }
    }

    fn sampling(&self, how: Upscaling) -> Sampling {
        Sampling::of_lattice(how.lattice())
    }

    fn upscale(&self, _how: Upscaling, drawn: &UpscaleInputs<'_>, full: &mut Image<Rgba8>) {
        full.pixels_mut().fill(drawn.color.at(0, 0));
    }

    fn pixel(&self, _how: Upscaling, drawn: &UpscaleInputs<'_>, _size: (u32, u32), _at: (u32, u32)) -> Rgba8 {
        drawn.color.at(0, 0)
    }

    fn taps(&self, _how: Upscaling, _drawn: &UpscaleInputs<'_>, _size: (u32, u32), _at: (u32, u32)) -> Vec<Tap> {
        vec![Tap { x: 0, y: 0, weight: 1.0 }]
    }
}

const SIZE: Viewport = Viewport { width: 32, height: 18 };

fn flat(id: &'static str) -> Flat {
    Flat { id, scales: &[Scale::TWO, Scale::FOUR] }
}

#[test]
fn a_registered_upscaler_follows_the_built_in_ones_and_is_known_by_its_id() {
    static FLAT: Flat = Flat { id: "flat-static", scales: &[Scale::TWO] };
    let json = r#"{"method":"flat-static","scale":2}"#;
    let unknown = serde_json::from_str::<Upscaling>(json).unwrap_err().to_string();
    assert!(unknown.starts_with("unknown upscaler `flat-static`, expected one of `native`"), "{unknown}");
    assert_eq!(Upscaling::new("flat-static", 2), None);

    upscale::register(&FLAT).unwrap();
    let ids: Vec<_> = upscale::all().iter().map(|upscaler| upscaler.id()).collect();
    let built_in: Vec<_> = BUILT_IN.iter().map(|upscaler| upscaler.id()).collect();
    assert_eq!(ids[..built_in.len()], built_in);
    assert!(ids[built_in.len()..].contains(&"flat-static"), "{ids:?}");
    let upscaling: Upscaling = serde_json::from_str(json).unwrap();
    assert_eq!((upscaling.method(), upscaling.label().as_str()), ("flat-static", "Flat"));
    assert!(Upscaling::every().any(|other| other == upscaling));
    let mut recipe = Recipe::default();
    recipe.set("upscaler.method=flat_static").unwrap();
    assert_eq!(recipe.upscaler, upscaling);
}

#[test]
fn unusable_upscalers_are_refused() {
    upscale::register_boxed(Box::new(flat("flat-twice"))).unwrap();
    let refused = |id, scales| upscale::register_boxed(Box::new(Flat { id, scales })).unwrap_err();
    let (two, none): (&'static [Scale], &'static [Scale]) = (&[Scale::TWO], &[]);
    assert_eq!(refused("flat-twice", two), RegisterError::DuplicateId("flat-twice".to_owned()));
    assert_eq!(refused("nearest", two), RegisterError::DuplicateId("nearest".to_owned()));
    assert_eq!(refused("Flat", two), RegisterError::BadId("Flat".to_owned()));
    assert_eq!(refused("flat-empty", none), RegisterError::NoOffers("flat-empty".to_owned()));
    assert_eq!(Upscaling::new("flat-empty", 2), None);
}

#[test]
fn a_registered_upscaler_is_drawn_explained_and_measured_like_a_built_in_one() {
    upscale::register_boxed(Box::new(flat("flat-measured"))).unwrap();
    let scene = Arc::new(builtin::by_id("cubes").unwrap().build());
    let mut recipe = Recipe::default();
    recipe.set_all(&["upscaler.method=flat-measured", "upscaler.scale=4"]).unwrap();
    let frame = Renderer::default().render_converged(RenderInputs {
        scene: &scene,
        camera: &scene.home,
        recipe: &recipe,
        viewport: SIZE,
    });
    let first = frame.drawn.color.at(0, 0);
    assert!(frame.image().pixels().iter().all(|pixel| *pixel == first));
    let report = inspect(&scene, &recipe, &frame, 31, 17).unwrap();
    assert_eq!((report.color, report.sources.len()), (first, 1));
    assert_eq!(Responses::of(recipe.upscaler).impulse.len(), 64);

    let plan = UpscalingPlan {
        subjects: vec![NamedView { name: "Cubes".to_owned(), camera: scene.home, recipe: Recipe::default(), scene }],
        upscalers: vec![Recipe::default().upscaler, recipe.upscaler],
        viewport: SIZE,
        rounds: 1,
        reference: Reference::Native,
        metric: rasterscope::measure::metric::Metric::Flip,
        turn: Turn::STILL,
    };
    let report = sweep::run(&plan, &|_| (), &|| false).unwrap();
    assert!(csv(&report).contains(",flat-measured,4,"), "{}", csv(&report));
    let page = page(&report).unwrap();
    assert!(page.contains("Flat ×4") && !page.contains("<th>transfer</th>"));
}
