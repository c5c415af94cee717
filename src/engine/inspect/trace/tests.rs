use super::*;
use crate::chain::run;
use crate::inspect::inspect;
use crate::pipeline::settings::{
    AddressMode, Arithmetic, Choice as _, ColorSpace, DepthFormat, FillRule, Interpolation, Rasterizer, Shading,
    TexelFilter,
};
use crate::pipeline::viewport::Viewport;
use crate::scene::builtin;

const VIEW: Viewport = Viewport { width: 12, height: 9 };

/// Traces all fragments of a small picture of scene `id`, and calls `check` with each trace.
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

/// Returns recipes that together exercise every path through the pipeline.
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
            (r.pipeline.filter, r.pipeline.address) = (TexelFilter::Trilinear, AddressMode::Mirror);
            r.pipeline.mip_bias = -0.75;
        }),
        with(|r| {
            (r.pipeline.arithmetic, r.pipeline.fill_rule) = (Arithmetic::Exact, FillRule::BottomRight);
            (r.pipeline.depth_format, r.pipeline.shading) = (DepthFormat::WBuffer, Shading::Cel);
            (r.pipeline.filter, r.pipeline.address) = (TexelFilter::Point, AddressMode::Clamp);
        }),
        with(|r| r.set_all(&["filter=anisotropic", "max_anisotropy=4", "alpha=premultiplied"]).unwrap()),
        with(|r| {
            (r.pipeline.interpolation, r.pipeline.shading) = (Interpolation::Published, Shading::Normals);
            r.pipeline.rasterizer = Rasterizer::BoundingBoxPublished;
        }),
        with(|r| (r.pipeline.depth_format, r.pipeline.shading) = (DepthFormat::Unorm16, Shading::Barycentric)),
        with(|r| r.set_all(&["depth_bias.constant=-7", "depth_bias.slope=1.5", "shading=depth"]).unwrap()),
        with(|r| r.set_all(&["upscaler.method=bicubic", "upscaler.scale=2", "wireframe=true"]).unwrap()),
    ]
}

fn line<'a>(trace: &'a Trace, what: &str) -> Option<&'a TraceLine> {
    trace.lines.iter().find(|line| line.what == what)
}

fn f64s(trace: &Trace, what: &str) -> Option<f64> {
    Some(line(trace, what)?.number()?.to_f64())
}

#[test]
fn every_trace_matches_the_frame_and_its_formulas() {
    for recipe in recipes() {
        let (mut traced, mut once) = (0, 0);
        for id in ["stained-glass", "near-plane", "cubes"] {
            all(id, &recipe, |report, frame, trace| {
                agrees(report, frame, trace);
                traced += usize::from(trace.fragment.is_some());
                once += trace.lines.iter().filter(|line| single_operation(line)).count();
                trace.lines.iter().for_each(is_near_its_formula);
            });
        }
        assert!(traced > 50 && once > 5000, "{recipe:?}: {traced} traces, {once} operations");
    }
}

/// Asserts that each line whose value is also part of the frame or the report matches that value bit for bit.
fn agrees(report: &PixelReport, frame: &Frame, trace: &Trace) {
    for (channel, name) in names::CHANNELS.into_iter().enumerate() {
        let code = f64s(trace, &format!("pixel {name}"));
        assert_eq!(code, Some(frame.image().at(report.x, report.y)[channel].into()));
    }
    let Some(record) = trace.fragment.map(|fragment| &report.fragments[fragment]) else { return };
    for corner in 0..3 {
        let edge = f64s(trace, &format!("edge {corner} · scaled value"))
            .or_else(|| f64s(trace, &format!("edge {corner} · value")));
        assert_eq!(edge, Some(record.edges[corner]));
        is_same(trace, &format!("λ{corner} on the screen"), record.affine_weights[corner]);
        is_same(trace, &format!("weight {corner}"), record.attribute_weights[corner]);
    }
    if record.stored_depth.is_some() {
        is_same(trace, "depth as stored", record.depth.value);
        assert_eq!(f64s(trace, "code"), record.depth.code.map(f64::from));
    }
    let Some(shading) = &record.shading else { return };
    for (channel, name) in names::CHANNELS.into_iter().enumerate() {
        assert_eq!(f64s(trace, &format!("{name} code")), Some(shading.color[channel].into()));
    }
    if let (Some(cosine), Some(_)) = (shading.cosine, line(trace, "N·L")) {
        is_same(trace, "N·L", cosine);
    }
    if let Some(light) = shading.light {
        is_same(trace, "light", light);
    }
    if let (Some([u, v]), Some(_)) = (shading.uv, line(trace, "u")) {
        is_same(trace, "u", u);
        is_same(trace, "v", v);
    }
}

fn is_same(trace: &Trace, what: &str, expected: f32) {
    let reported = line(trace, what).and_then(TraceLine::number);
    assert!(
        reported.is_some_and(|reported| reported.same_bits(expected.into())),
        "{what}: {reported:?}, not {expected}"
    );
}

/// Whether a line is a single correctly rounded operation. If so, asserts that its error is at most half an ulp.
fn single_operation(line: &TraceLine) -> bool {
    if line.rounded_once {
        assert!(line.rounding_ulp.is_some_and(|ulps| ulps.abs() <= 0.5), "{line:#?}");
    }
    line.rounded_once
}

/// Asserts that a line's value is close to the exact result of its formula. Errors add up over operations and double
/// with each cancelled leading bit, but a formula that differs from the pipeline's has far larger errors. Exact results
/// of 0 are skipped, because they have no ulp.
fn is_near_its_formula(line: &TraceLine) {
    const MOST_ULP: f64 = 16.0;
    let Some(ulps) = line.rounding_ulp.filter(|_| line.exact.as_ref().is_some_and(|exact| exact.decimal != "0")) else {
        return;
    };
    assert!(ulps.abs() <= MOST_ULP * 2.0_f64.powi(line.lost_bits as i32), "{line:#?}");
}

#[test]
fn clipped_triangles_show_the_polygon_and_where_edges_were_cut() {
    let mut cut = 0;
    all("near-plane", &Recipe::default(), |_, _, trace| {
        let pieces = trace.lines.iter().filter(|line| line.what == "piece with the fragment").count();
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
    assert!(cut > 8, "{cut}");
}

#[test]
fn traces_name_the_near_plane_in_every_depth_format() {
    for format in DepthFormat::ALL {
        let mut recipe = Recipe::default();
        recipe.pipeline.depth_format = *format;
        let mut cut = 0;
        all("near-plane", &recipe, |_, _, trace| {
            let of_plane = |name: &str| trace.lines.iter().filter(|line| line.formula.ends_with(name)).count();
            assert_eq!(of_plane("through the far plane") + of_plane("on the far plane"), 0, "{format:?}");
            cut += of_plane("through the near plane").min(of_plane("on the near plane"));
        });
        assert!(cut > 8, "{format:?}: {cut}");
    }
}

#[test]
fn a_depth_bias_is_written_out_as_a_sum_and_leads_to_the_stored_depth() {
    let mut recipe = Recipe::default();
    recipe.set_all(&["depth_bias.constant=300", "depth_bias.slope=-0.5"]).unwrap();
    let mut written = 0;
    all("interpenetrating", &recipe, |report, _, trace| {
        let Some(record) = trace.fragment.map(|fragment| &report.fragments[fragment]) else { return };
        let of = |what: &str| f64s(trace, what).unwrap_or_else(|| panic!("no line “{what}”"));
        let slope = of("∂z/∂x").abs().max(of("∂z/∂y").abs());
        assert_eq!(of("slope m"), slope);
        assert_eq!(of("depth bias"), slope * -0.5 + of("smallest difference r") * 300.0);
        assert_eq!(of("least depth, biased"), of("least depth") + of("depth bias"));
        assert_eq!(record.depth_bias, Some(of("depth bias") as f32));
        written += 1;
    });
    assert!(written > 20, "{written}");
    all("triangle", &Recipe::default(), |_, _, trace| assert!(line(trace, "depth bias").is_none()));
}

#[test]
fn the_next_line_is_the_nearest_with_the_flag() {
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
            let found = trace.next(at, Some(Notable::Tie), StepDirection::Forward);
            assert_eq!(found, Some(*expected));
            at = *expected;
        }
        assert_eq!(trace.next(at, Some(Notable::Tie), StepDirection::Forward), None);
        if let [.., before, last] = places[..] {
            assert_eq!(trace.next(last, Some(Notable::Tie), StepDirection::Back), Some(before));
        }
        ties += places.len();
    }
    assert!(ties > 0);
}

#[test]
fn steps_by_stage_lead_to_the_first_line_of_the_stage() {
    all("cubes", &Recipe::default(), |_, _, trace| {
        let firsts: Vec<usize> =
            trace.stages().map(|(stage, _)| trace.lines.iter().position(|line| line.stage == stage).unwrap()).collect();
        for pair in firsts.windows(2) {
            assert_eq!(trace.next_stage(pair[0], StepDirection::Forward), Some(pair[1]));
            assert_eq!(trace.next_stage(pair[1], StepDirection::Back), Some(pair[0]));
        }
    });
}

#[test]
fn non_finite_results_and_cancellation_are_flagged() {
    use formula::{given, whole};
    let mut scribe = TraceRecorder::new();
    scribe.compute("finite", 0.5_f32, &(whole("1", 1) / given("two", 2.0_f32)));
    scribe.compute("infinite", f32::INFINITY, &(whole("1", 1) / given("zero", 0.0_f32)));
    let near = 1.0_f32 + 1.0 / 1024.0;
    scribe.compute("cancels", near - 1.0, &(given("a", near) - given("b", 1.0_f32)));
    scribe.compute("keeps", 0.25_f32, &(given("a", 1.0_f32) - given("b", 0.75_f32)));
    scribe.compute("whole", 1_i64, &(given("a", 4096_i64) - given("b", 4095_i64)));
    let flags: Vec<Vec<Notable>> =
        scribe.finish().iter().map(|line| line.flags.iter().map(|flag| flag.kind).collect()).collect();
    assert_eq!(flags, [vec![], vec![Notable::NotFinite], vec![Notable::Cancellation], vec![], vec![]]);
}
