use super::*;
use crate::chain::run;
use crate::inspect::inspect;
use crate::pipeline::settings::{
    Address, Arithmetic, ColorSpace, DepthFormat, FillRule, Filter, Interpolation, Rasterizer, Shading,
};
use crate::pipeline::viewport::Viewport;
use crate::scene::builtin;

const VIEW: Viewport = Viewport { width: 24, height: 18 };

/// All pixels of a small picture by a recipe, traced.
fn all(id: &str, recipe: &Recipe, mut check: impl FnMut(&PixelReport, &Frame, &Trace)) {
    let scene = builtin::by_id(id).unwrap().build();
    let frame = run(&scene, &scene.home, recipe, VIEW, &mut ());
    for (x, y) in (0..VIEW.height).flat_map(|y| (0..VIEW.width).map(move |x| (x, y))) {
        let report = inspect(&scene, recipe, &frame, x, y).unwrap();
        for fragment in 0..report.fragments.len() {
            check(&report, &frame, &Trace::of(&scene, recipe, &frame, &report, Some(fragment)));
        }
        if report.fragments.is_empty() {
            check(&report, &frame, &Trace::of(&scene, recipe, &frame, &report, None));
        }
    }
}

/// The recipes that between them take every way through the pipeline.
fn recipes() -> Vec<Recipe> {
    let with = |change: fn(&mut Recipe)| {
        let mut recipe = Recipe::default();
        change(&mut recipe);
        recipe
    };
    vec![
        with(|_| {}),
        with(|r| {
            (r.pipeline.arithmetic, r.pipeline.rasterizer) = (Arithmetic::F32, Rasterizer::Scanline);
            (r.pipeline.depth_format, r.pipeline.shading) = (DepthFormat::ReversedF32, Shading::Gouraud);
        }),
        with(|r| {
            (r.pipeline.arithmetic, r.pipeline.rasterizer) = (Arithmetic::F64, Rasterizer::EdgeWalk);
            (r.pipeline.depth_format, r.pipeline.color_space) = (DepthFormat::Unorm24, ColorSpace::Bytes);
            (r.pipeline.filter, r.pipeline.address) = (Filter::Trilinear, Address::Mirror);
        }),
        with(|r| {
            (r.pipeline.arithmetic, r.pipeline.fill_rule) = (Arithmetic::Exact, FillRule::BottomRight);
            (r.pipeline.depth_format, r.pipeline.shading) = (DepthFormat::WBuffer, Shading::Cel);
            (r.pipeline.filter, r.pipeline.address) = (Filter::Point, Address::Clamp);
        }),
        with(|r| {
            (r.pipeline.interpolation, r.pipeline.shading) = (Interpolation::Published, Shading::Normals);
            r.pipeline.rasterizer = Rasterizer::BoundingBoxPublished;
        }),
        with(|r| (r.pipeline.depth_format, r.pipeline.shading) = (DepthFormat::Unorm16, Shading::Barycentric)),
        with(|r| r.set_all(&["upscaler.method=bicubic", "upscaler.scale=2", "wireframe=true"]).unwrap()),
    ]
}

fn line<'a>(trace: &'a Trace, what: &str) -> Option<&'a TraceLine> {
    trace.lines.iter().find(|line| line.what == what)
}

fn f64s(trace: &Trace, what: &str) -> Option<f64> {
    Some(line(trace, what)?.number()?.to_f64())
}

/// Whether two numbers are the same, NaN being the same as NaN.
fn same(a: f64, b: f64) -> bool {
    a == b || (a.is_nan() && b.is_nan())
}

#[test]
fn every_line_that_frame_and_report_know_agrees_bit_for_bit() {
    for recipe in recipes() {
        for id in ["stained-glass", "near-plane", "cubes"] {
            let mut traced = 0;
            all(id, &recipe, |report, frame, trace| {
                for (channel, name) in attributes::CHANNELS.into_iter().enumerate() {
                    let code = f64s(trace, &format!("pixel {name}")).unwrap();
                    assert_eq!(code, f64::from(frame.image().at(report.x, report.y)[channel]), "{id} {recipe:?}");
                }
                let Some(fragment) = trace.fragment else { return };
                let record = &report.fragments[fragment];
                traced += 1;
                for corner in 0..3 {
                    let edge = f64s(trace, &format!("edge {corner} · scaled value"))
                        .or_else(|| f64s(trace, &format!("edge {corner} · value")));
                    assert_eq!(edge, Some(record.edges[corner]), "{id} {recipe:?}");
                    let lambda = f64s(trace, &format!("λ{corner} on the screen")).unwrap();
                    assert!(same(lambda, record.affine_weights[corner].into()));
                    let weight = f64s(trace, &format!("weight {corner}")).unwrap();
                    assert!(same(weight, record.attribute_weights[corner].into()), "{id} {weight}");
                }
                if record.stored_depth.is_some() {
                    assert_eq!(f64s(trace, "depth as stored"), Some(record.depth.value.into()));
                    assert_eq!(f64s(trace, "code"), record.depth.code.map(f64::from));
                }
                let Some(shading) = &record.shading else { return };
                for (channel, name) in attributes::CHANNELS.into_iter().enumerate() {
                    let code = f64s(trace, &format!("{name} code"));
                    assert_eq!(code, Some(shading.color[channel].into()), "{id} {recipe:?}");
                }
                if let (Some(cosine), Some(told)) = (shading.cosine, f64s(trace, "N·L")) {
                    assert!(same(told, cosine.into()));
                }
                if let Some(light) = shading.light {
                    assert!(same(f64s(trace, "light").unwrap(), light.into()));
                }
                if let (Some([u, v]), Some(told)) = (shading.uv, f64s(trace, "u")) {
                    assert!(same(told, u.into()) && same(f64s(trace, "v").unwrap(), v.into()));
                }
            });
            assert!(traced > 50, "{id}: {traced}");
        }
    }
}

#[test]
fn single_operations_are_off_by_half_an_ulp_at_most() {
    let (mut count, mut wide) = (0, 0);
    for recipe in recipes() {
        for id in ["stained-glass", "near-plane", "z-fighting"] {
            all(id, &recipe, |_, _, trace| {
                for line in &trace.lines {
                    let Some(ulps) = line.rounding_ulp else { continue };
                    if line.rounded_once {
                        count += 1;
                        assert!(ulps.abs() <= 0.5, "{id}: {line:?}");
                    }
                    wide += usize::from(!line.rounded_once);
                }
            });
        }
    }
    assert!(count > 10_000 && wide > 10_000, "{count} {wide}");
}

#[test]
fn formulas_come_to_what_the_pipeline_computes() {
    // Rounding grows with what cancels; where nothing does, a formula that is another one shows at once.
    const MOST_ULP: f64 = 64.0;
    for recipe in recipes() {
        for id in ["stained-glass", "near-plane"] {
            all(id, &recipe, |_, _, trace| {
                for line in &trace.lines {
                    let Some(ulps) = line.rounding_ulp else { continue };
                    let cancels = line.has(Notable::Cancellation) || line.formula.contains("N′");
                    let exact: f64 = line
                        .exact
                        .as_ref()
                        .map_or(1.0, |e| e.decimal.replace('…', "").replace('−', "-").parse().unwrap_or(1.0));
                    if !cancels && exact.abs() > 1e-6 {
                        assert!(ulps.abs() <= MOST_ULP, "{id}: {line:#?}");
                    }
                }
            });
        }
    }
}

#[test]
fn clipped_triangles_show_the_polygon_and_where_edges_were_cut() {
    let mut cut = 0;
    all("near-plane", &Recipe::default(), |_, _, trace| {
        let pieces = trace.lines.iter().filter(|line| line.what == "piece of the fragment").count();
        let shares: Vec<_> = trace.lines.iter().filter(|line| line.what.ends_with(" · t")).collect();
        assert_eq!(pieces > 0, !shares.is_empty());
        assert!(shares.iter().all(|line| (0.0..=1.0).contains(&line.number().unwrap().to_f64())));
        // Each corner of the piece is projected.
        assert_eq!(
            trace.fragment.is_some(),
            trace.lines.iter().filter(|line| line.what.ends_with("· 1/w")).count() == 3
        );
        cut += pieces;
    });
    assert!(cut > 20, "{cut}");
}

#[test]
fn the_next_line_is_the_nearest_with_such_a_flag() {
    let scene = builtin::by_id("shared-edges").unwrap().build();
    let recipe = Recipe::default();
    let frame = run(&scene, &scene.home, &recipe, VIEW, &mut ());
    let mut ties = 0;
    for (x, y) in (0..VIEW.height).flat_map(|y| (0..VIEW.width).map(move |x| (x, y))) {
        let report = inspect(&scene, &recipe, &frame, x, y).unwrap();
        let trace = Trace::of(&scene, &recipe, &frame, &report, None);
        let places: Vec<_> =
            (1..trace.lines.len()).filter(|i| trace.lines[*i].has(Notable::Tie) && !trace.lines[*i].aside).collect();
        let mut at = 0;
        for expected in &places {
            let found = trace.next(at, Some(Notable::Tie), Direction::Forward);
            assert_eq!(found, Some(*expected));
            at = *expected;
        }
        assert_eq!(trace.next(at, Some(Notable::Tie), Direction::Forward), None);
        if let [.., before, last] = places[..] {
            assert_eq!(trace.next(last, Some(Notable::Tie), Direction::Back), Some(before));
        }
        ties += places.len();
    }
    assert!(ties > 0);
}

#[test]
fn stages_are_stepped_to_their_first_lines() {
    all("cubes", &Recipe::default(), |_, _, trace| {
        let firsts: Vec<usize> =
            trace.stages().map(|(stage, _)| trace.lines.iter().position(|line| line.stage == stage).unwrap()).collect();
        for pair in firsts.windows(2) {
            assert_eq!(trace.next_stage(pair[0], Direction::Forward), Some(pair[1]));
            assert_eq!(trace.next_stage(pair[1], Direction::Back), Some(pair[0]));
        }
    });
}

#[test]
fn what_is_not_finite_or_cancels_is_flagged() {
    use formula::{given, whole};
    let mut scribe = Scribe::new();
    scribe.compute("finite", 0.5_f32, &(whole("1", 1) / given("two", 2.0_f32)));
    scribe.compute("infinite", f32::INFINITY, &(whole("1", 1) / given("zero", 0.0_f32)));
    scribe.compute("cancels", 0.000_976_562_5_f32, &(given("a", 1.000_976_562_5_f32) - given("b", 1.0_f32)));
    scribe.compute("keeps", 0.25_f32, &(given("a", 1.0_f32) - given("b", 0.75_f32)));
    scribe.compute("whole", 1_i64, &(given("a", 4096_i64) - given("b", 4095_i64)));
    let flags: Vec<Vec<Notable>> =
        scribe.finish().iter().map(|line| line.flags.iter().map(|flag| flag.kind).collect()).collect();
    assert_eq!(flags, [vec![], vec![Notable::NotFinite], vec![Notable::Cancellation], vec![], vec![]]);
}
