use super::*;
use crate::chain::{KeepDepth, RenderInputs, Renderer, run};
use crate::image::Rgba8;
use crate::inspect::explain;
use crate::inspect::history::Survey;
use crate::inspect::hits::Hits;
use crate::inspect::pixel::{Absent, Cause};
use crate::inspect::view::{CRACK, DOUBLE_HIT};
use crate::inspect::{FragmentOutcome, inspect};
use crate::pipeline::raster::cover;
use crate::pipeline::settings::{Arithmetic, Culling, DepthTest, FillRule};
use crate::pipeline::tiled::TILE_SIDE;
use crate::pipeline::viewport::Viewport;
use crate::pipeline::wireframe::{edge_pixels, line_pixels};
use crate::scene::builtin;
use crate::scene::seams::{self, Seams};
use std::sync::Arc;

struct OverlayBench {
    scene: Arc<Scene>,
    recipe: Recipe,
    frame: Frame,
    watched: OnceLock<FragmentStats>,
}

impl OverlayBench {
    fn new(scene: &str, recipe: Recipe, size: (u32, u32)) -> Self {
        let scene = Arc::new(builtin::by_id(scene).unwrap().build());
        let viewport = Viewport { width: size.0, height: size.1 };
        let frame = run(&scene, &scene.home, &recipe, viewport, &mut ());
        Self { scene, recipe, frame, watched: OnceLock::new() }
    }

    fn sheet(&self, overlay: Overlay) -> Sheet {
        self.sheet_over(overlay, None, &|x, y| self.frame.image().get(x, y).map_or(Value::Nothing, Value::Color))
    }

    fn sheet_over(&self, overlay: Overlay, range: Option<Range>, shown: &dyn Fn(u32, u32) -> Value) -> Sheet {
        overlay.sheet(&self.context(range, shown, &Seams::of(&self.scene)))
    }

    fn context<'a>(
        &'a self,
        range: Option<Range>,
        shown: &'a dyn Fn(u32, u32) -> Value,
        seams: &'a Seams,
    ) -> OverlayContext<'a> {
        OverlayContext {
            scene: &self.scene,
            recipe: &self.recipe,
            frame: &self.frame,
            is_whole: true,
            stats_cache: &self.watched,
            seams: Some(seams),
            shown,
            range,
        }
    }

    fn layer_sheet(&self, layer: &OverlayLayer) -> Sheet {
        layer.sheet(&self.context(None, &|_, _| Value::Nothing, &Seams::default()))
    }

    fn pixels(&self) -> impl Iterator<Item = (u32, u32)> + use<> {
        let (width, height) = self.frame.image().size();
        (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)))
    }
}

fn total(sheet: &Sheet, name: &str) -> f64 {
    sheet.totals.iter().find(|total| total.name == name).unwrap_or_else(|| panic!("{name}")).number
}

fn count(value: f32) -> usize {
    if value.is_nan() { 0 } else { value as usize }
}

#[test]
fn counts_match_single_triangles_and_the_replay_of_every_pixel() {
    for scene in ["interpenetrating", "stained-glass"] {
        let mut recipe = Recipe::default();
        recipe.pipeline.culling = Culling::None;
        let bench = OverlayBench::new(scene, recipe, (24, 18));
        let mut covered = Image::filled(24, 18, 0_usize);
        let settings = &bench.recipe.pipeline;
        let viewport = bench.frame.viewport;
        for triangle in &bench.frame.geometry().triangles {
            let corners = triangle.corners_px();
            for span in cover(settings.rasterizer, settings.arithmetic, corners, settings.fill_rule, viewport) {
                for x in span.left..span.right {
                    covered.set(x, span.row, covered.at(x, span.row) + 1);
                }
            }
        }
        let [rasterized, passed, visible, depth] =
            [Overlay::Rasterized, Overlay::Passed, Overlay::Visible, Overlay::DepthTest].map(|o| bench.sheet(o));
        let mut rejected_in_all = 0;
        for (x, y) in bench.pixels() {
            assert_eq!(count(rasterized.values.at(x, y)), covered.at(x, y), "{scene} {x}, {y}");
            let report = inspect(&bench.scene, &bench.recipe, &bench.frame, x, y).unwrap();
            let of = |outcomes: &[FragmentOutcome]| {
                report.fragments.iter().filter(|f| outcomes.contains(&f.outcome)).count()
            };
            let rejected = of(&[FragmentOutcome::DepthRejected]);
            rejected_in_all += rejected;
            assert_eq!(count(passed.values.at(x, y)), report.fragments.len() - rejected, "{scene} {x}, {y}");
            let seen = of(&[FragmentOutcome::Visible, FragmentOutcome::BlendedOver]);
            assert_eq!(count(visible.values.at(x, y)), seen, "{scene} {x}, {y}");
            let expected = match (report.fragments.len(), rejected) {
                (0, _) => None,
                (_, 0) => Some("all passed"),
                (all, rejected) if all == rejected => Some("all rejected"),
                _ => Some("some rejected"),
            };
            assert_eq!(depth.text(x, y).as_deref(), expected, "{scene} {x}, {y}");
        }
        assert_eq!(total(&depth, "rejected"), rejected_in_all as f64);
        assert_eq!(total(&rasterized, "in all"), covered.pixels().iter().sum::<usize>() as f64);
    }
}

#[test]
fn discarded_fragments_match_the_replay_of_every_pixel() {
    let (mut discarded, mut of_kinds) = (0, [0_usize; 3]);
    for scene in ["interpenetrating", "stained-glass", "cubes", "near-plane"] {
        for method in ["native", "checkerboard"] {
            let mut recipe = Recipe::default();
            recipe.set_all(&[format!("upscaler.method={method}")]).unwrap();
            let bench = OverlayBench::new(scene, recipe, (24, 18));
            let sheet = bench.sheet(Overlay::Discarded);
            let survey = Survey::of(&bench.scene, &bench.recipe, &bench.frame);
            let mut sums = [0; 3];
            for (x, y) in bench.pixels().filter(|(x, y)| bench.frame.sample_at(*x, *y).is_some()) {
                let report = explain(&bench.scene, &bench.recipe, &bench.frame, &survey, (x, y)).unwrap();
                let ended = |outcome| report.fragments.iter().filter(|f| f.outcome == outcome).count();
                let is_culled = |absent: &&Absent| matches!(absent.cause, Cause::BackFacing | Cause::FrontFacing);
                let culled = report.absent.iter().filter(is_culled).count();
                let counts = [ended(FragmentOutcome::DepthRejected), ended(FragmentOutcome::AlphaRejected), culled];
                let names = ["depth test", "alpha test", "face culling"].into_iter().zip(counts);
                let words: Vec<_> = names.filter(|(_, n)| *n > 0).map(|(name, n)| format!("{name} {n}")).collect();
                let expected = (!words.is_empty()).then(|| words.join(", "));
                assert_eq!(sheet.text(x, y), expected, "{scene} {method} {x}, {y}");
                let shown = counts.get(sheet.values.at(x, y) as usize).filter(|_| expected.is_some());
                assert_eq!(shown, expected.is_some().then_some(counts.iter().max().unwrap()), "{scene} {x}, {y}");
                sums.iter_mut().zip(counts).for_each(|(sum, count)| *sum += count);
            }
            for (kind, name) in ["depth test", "alpha test", "face culling"].into_iter().enumerate() {
                assert_eq!(total(&sheet, name), sums[kind] as f64, "{scene} {method} {name}");
                of_kinds[kind] += sums[kind];
            }
            discarded += sums.iter().sum::<usize>();
            assert_eq!(total(&sheet, "in all"), sums.iter().sum::<usize>() as f64);
        }
    }
    assert!(discarded > 1000 && of_kinds.iter().all(|sum| *sum > 0), "{of_kinds:?}");
}

#[test]
fn culled_coverage_equals_rasterized_coverage_with_the_other_side_culled() {
    let with = |culling| {
        let mut recipe = Recipe::default();
        (recipe.pipeline.culling, recipe.pipeline.depth_test) = (culling, DepthTest::Off);
        OverlayBench::new("cubes", recipe, (40, 30))
    };
    let (backs, fronts) =
        (with(Culling::Back).sheet(Overlay::Discarded), with(Culling::Front).sheet(Overlay::Rasterized));
    for (x, y) in (0..30).flat_map(|y| (0..40).map(move |x| (x, y))) {
        assert_eq!(backs.counts[2].at(x, y) as usize, count(fronts.values.at(x, y)), "{x}, {y}");
    }
    assert!(total(&backs, "face culling") > 100.0 && total(&backs, "depth test") == 0.0);
}

#[test]
fn sizes_match_integer_arithmetic_on_snapped_corners() {
    let bench = OverlayBench::new("shared-edges", Recipe::default(), (40, 30));
    let sizes = bench.sheet(Overlay::TriangleSize);
    let heights = bench.sheet(Overlay::Sliver);
    let mut seen = 0;
    for (x, y) in bench.pixels() {
        let report = inspect(&bench.scene, &bench.recipe, &bench.frame, x, y).unwrap();
        let Some(fragment) = report.visible() else {
            assert!(sizes.values.at(x, y).is_nan());
            continue;
        };
        let [a, b, c] = bench.frame.geometry().triangles[fragment.submission]
            .vertices
            .each_ref()
            .map(|v| [v.x, v.y].map(i64::from));
        let doubled = ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])).abs();
        let area = doubled as f64 / (2.0 * 65_536.0);
        assert!((f64::from(sizes.values.at(x, y)) - area).abs() <= 1e-6 * area);
        let side = [(a, b), (b, c), (c, a)].map(|(a, b)| ((a[0] - b[0]).pow(2) + (a[1] - b[1]).pow(2)) as f64);
        let longest = side.into_iter().fold(0.0, f64::max).sqrt() / 256.0;
        assert!((f64::from(heights.values.at(x, y)) - 2.0 * area / longest).abs() <= 1e-5 * longest);
        seen += 1;
    }
    assert!(seen > 100);
    assert_eq!(total(&sizes, "triangles"), bench.frame.geometry().triangles.len() as f64);
    // With a single triangle, the least, median and greatest sizes are equal.
    let one = OverlayBench::new("triangle", Recipe::default(), (40, 30)).sheet(Overlay::TriangleSize);
    assert_eq!(total(&one, "triangles"), 1.0);
    assert!(["least", "greatest"].iter().all(|name| total(&one, name) == total(&one, "median")));
}

#[test]
fn the_snapped_wireframe_matches_the_wireframe_setting() {
    let bench = OverlayBench::new("slivers", Recipe::default(), (60, 40));
    let sheet = bench.sheet(Overlay::SnappedWireframe);
    let mut on_line = Image::filled(60, 40, false);
    for triangle in &bench.frame.geometry().triangles {
        edge_pixels(triangle, (60, 40)).for_each(|(x, y)| on_line.set(x, y, true));
    }
    assert!(bench.pixels().all(|(x, y)| sheet.values.at(x, y).is_nan() != on_line.at(x, y)));
    assert_eq!(sheet.lines.len(), 3 * bench.frame.geometry().triangles.len());
    let exact = bench.sheet(Overlay::Wireframe);
    let corners = bench.frame.geometry().triangles[0].corners_px();
    assert_eq!(exact.lines[0], [corners[0], corners[1]]);
}

#[test]
fn front_and_back_faces_are_distinguished() {
    let mut recipe = Recipe::default();
    recipe.pipeline.culling = Culling::None;
    let mut bench = OverlayBench::new("cubes", recipe, (32, 24));
    let sheet = bench.sheet(Overlay::Facing);
    assert_eq!(total(&sheet, "back"), 0.0, "closed meshes hide their back faces");
    assert!(total(&sheet, "front") > 50.0);
    bench.recipe.pipeline.culling = Culling::Front;
    let inside_out = OverlayBench::new("cubes", bench.recipe, (32, 24)).sheet(Overlay::Facing);
    assert_eq!(total(&inside_out, "front"), 0.0);
    assert!(total(&inside_out, "back") > 50.0);
}

#[test]
fn texel_density_matches_the_differences_between_neighbouring_pixels() {
    let bench = OverlayBench::new("chess", Recipe::default(), (160, 120));
    let sheet = bench.sheet(Overlay::TexelDensity);
    let at = |x: u32, y: u32| {
        let report = inspect(&bench.scene, &bench.recipe, &bench.frame, x, y)?;
        let fragment = report.visible()?;
        let [u, v] = fragment.shading.as_ref()?.uv?;
        let instance = bench.frame.geometry().triangles[fragment.submission].instance;
        let material = bench.scene.library.material(bench.scene.instances[instance as usize].material);
        let size = bench.scene.library.texture(material.texture?).image().size();
        Some((fragment.triangle, [u * size.0 as f32, v * size.1 as f32]))
    };
    let mut compared = 0;
    for (x, y) in (80..110).step_by(4).flat_map(|y| (10..150).step_by(20).map(move |x| (x, y))) {
        let around = [at(x - 1, y), at(x + 1, y), at(x, y - 1), at(x, y + 1)];
        let [Some((a, left)), Some((b, right)), Some((c, up)), Some((d, down))] = around else { continue };
        if [b, c, d].iter().any(|triangle| *triangle != a) {
            continue;
        }
        let (along, across) = ([0, 1].map(|i| (right[i] - left[i]) / 2.0), [0, 1].map(|i| (down[i] - up[i]) / 2.0));
        let density = (along[0] * across[1] - along[1] * across[0]).abs().sqrt();
        let found = sheet.values.at(x, y);
        // Differences over two pixels only approximate the derivative.
        assert!((found - density).abs() < 0.05 * density, "{x}, {y}: {found}, not {density}");
        compared += 1;
    }
    assert!(compared > 10, "{compared}");
}

#[test]
fn faults_are_marked_where_hit_counts_are_wrong() {
    let mut recipe = Recipe::default();
    for (rule, kind, color) in [(FillRule::Exclusive, "crack", CRACK), (FillRule::Inclusive, "double hit", DOUBLE_HIT)]
    {
        recipe.pipeline.fill_rule = rule;
        let bench = OverlayBench::new("shared-edges", recipe, (32, 24));
        let (sheet, hits) = (bench.sheet(Overlay::Faults), Hits::of(&bench.frame, &bench.recipe.pipeline));
        let marked: Vec<_> = bench.pixels().filter(|(x, y)| !sheet.values.at(*x, *y).is_nan()).collect();
        assert_eq!(marked, hits.faults.iter().map(|fault| (fault.x, fault.y)).collect::<Vec<_>>());
        assert!(!marked.is_empty());
        assert_eq!(total(&sheet, kind), marked.len() as f64);
        let (x, y) = marked[0];
        assert_eq!(compose(&Image::filled(32, 24, [0, 0, 0, 255]), [(&sheet, 1.0)]).at(x, y), color);
    }
}

#[test]
fn exact_arithmetic_agrees_with_itself_and_reveals_a_wrong_fill_rule() {
    let mut recipe = Recipe::default();
    recipe.pipeline.arithmetic = Arithmetic::Exact;
    let exact = OverlayBench::new("slivers", recipe, (60, 40)).sheet(Overlay::ExactOwner);
    assert!(exact.totals.iter().all(|total| total.number == 0.0));
    assert!(exact.values.pixels().iter().all(|value| value.is_nan()));
    let exact_frame = OverlayBench::new("shared-edges", recipe, (32, 24));
    recipe.pipeline.fill_rule = FillRule::Exclusive;
    let bench = OverlayBench::new("shared-edges", recipe, (32, 24));
    let sheet = bench.sheet(Overlay::ExactOwner);
    let owner = |bench: &OverlayBench, x, y| {
        let report = inspect(&bench.scene, &bench.recipe, &bench.frame, x, y).unwrap();
        report.visible().map(|fragment| fragment.triangle)
    };
    let mut missing = 0;
    for (x, y) in bench.pixels() {
        let differs = owner(&bench, x, y) != owner(&exact_frame, x, y);
        assert_eq!(sheet.values.at(x, y).is_nan(), !differs, "{x}, {y}");
        missing += u32::from(differs);
    }
    assert!(missing > 10);
    assert_eq!(total(&sheet, "missing"), f64::from(missing));
}

#[test]
fn tile_loads_match_the_bins_of_the_tiled_renderer() {
    let mut smooth = Recipe::default();
    smooth.set("antialias.method=multisample").unwrap();
    for recipe in [Recipe::default(), smooth] {
        assert_tile_loads_match_the_bins(recipe);
    }
}

fn assert_tile_loads_match_the_bins(recipe: Recipe) {
    let mut bench = OverlayBench::new("cubes", recipe, (200, 150));
    bench.frame = Renderer::default().render(
        RenderInputs {
            scene: &bench.scene,
            camera: &bench.scene.home,
            recipe: &bench.recipe,
            viewport: bench.frame.viewport,
        },
        KeepDepth::Yes,
    );
    let sheet = bench.sheet(Overlay::TileLoad);
    let counts = bench.frame.tiled.as_ref().unwrap().counts;
    assert_eq!(total(&sheet, "entries"), counts.binned as f64);
    assert_eq!(total(&sheet, "tiles"), 12.0);
    // A tile's bin contains all triangles visible in it, and all its pixels have the same value.
    let owners = &bench.watched.get_or_init(|| watch::watch(&bench.scene, &bench.recipe, &bench.frame)).owner;
    for (column, row) in [(0, 0), (1, 1), (2, 0)] {
        let inside = || bench.pixels().filter(|(x, y)| (x / TILE_SIDE, y / TILE_SIDE) == (column, row));
        let mut seen: Vec<_> = inside().map(|(x, y)| owners.at(x, y).0).filter(|id| *id != u32::MAX).collect();
        seen.sort_unstable();
        seen.dedup();
        assert!(inside().all(|(x, y)| sheet.values.at(x, y) >= seen.len() as f32));
        let first = inside().next().unwrap();
        assert!(inside().all(|(x, y)| sheet.values.at(x, y) == sheet.values.at(first.0, first.1)));
    }
    bench.recipe.pipeline.arithmetic = Arithmetic::F64;
    assert!(bench.sheet(Overlay::TileLoad).absence.is_some_and(|why| why.contains("fixed-point")));
}

#[test]
fn invalid_numbers_are_marked_and_can_be_stepped_through() {
    let bench = OverlayBench::new("triangle", Recipe::default(), (8, 4));
    let shown = |x: u32, y: u32| match (x, y) {
        (1, 0) => Value::Number(f32::NAN),
        (5, 1) => Value::Weights([0.5, f32::NEG_INFINITY, -1.0]),
        (2, 3) => Value::Number(-0.25),
        (3, 3) => Value::Number(7.0),
        (4, 3) => Value::Nothing,
        _ => Value::Number(0.5),
    };
    let range = Some(Range { low: 0.0, high: 1.0 });
    let bad = bench.sheet_over(Overlay::BadNumbers, range, &shown);
    assert_eq!(bad.text(1, 0).as_deref(), Some("not a number"));
    assert_eq!(bad.text(5, 1).as_deref(), Some("infinite"));
    assert_eq!(bad.text(2, 3).as_deref(), Some("negative"));
    assert_eq!(bad.totals.iter().map(|total| total.number).collect::<Vec<_>>(), [1.0, 1.0, 1.0]);
    assert_eq!(bad.next_pixel(None, true), Some((1, 0)));
    assert_eq!(bad.next_pixel(Some((1, 0)), true), Some((5, 1)));
    assert_eq!(bad.next_pixel(Some((2, 3)), true), Some((1, 0)), "wraps around");
    assert_eq!(bad.next_pixel(Some((1, 0)), false), Some((2, 3)));
    assert_eq!(bad.next_pixel(None, false), Some((2, 3)));
    let clipped = bench.sheet_over(Overlay::Clipped, range, &shown);
    assert_eq!(clipped.text(3, 3).as_deref(), Some("above"));
    assert_eq!(clipped.text(2, 3).as_deref(), Some("below"));
    assert_eq!(clipped.text(0, 0), None);
    let nothing = bench.sheet_over(Overlay::Clipped, None, &shown);
    assert!(nothing.absence.is_some() && nothing.next_pixel(None, true).is_none());
}

#[test]
fn sheets_are_composed_in_order_and_leave_the_picture_unchanged() {
    let bench = OverlayBench::new("shared-edges", Recipe::default(), (32, 24));
    let (facing, size) = (bench.sheet(Overlay::Facing), bench.sheet(Overlay::TriangleSize));
    let base = bench.frame.image().clone();
    let over = |first: &Sheet, second: &Sheet, opacity: f32| compose(&base, [(first, 1.0), (second, opacity)]);
    let alone = |sheet: &Sheet| compose(&base, [(sheet, 1.0)]);
    assert_ne!(alone(&facing), alone(&size));
    assert_eq!(over(&facing, &size, 1.0), alone(&size), "both mark the same pixels");
    assert_eq!(over(&size, &facing, 1.0), alone(&facing));
    assert_eq!(over(&size, &facing, 0.0), alone(&size));
    let half = over(&size, &facing, 0.5);
    let mean = |a: Rgba8, b: Rgba8| (u32::from(a[0]) + u32::from(b[0])).div_ceil(2) as u8;
    for (x, y) in bench.pixels().filter(|(x, y)| !facing.values.at(*x, *y).is_nan()) {
        assert_eq!(half.at(x, y)[0], mean(alone(&size).at(x, y), alone(&facing).at(x, y)));
    }
    assert_eq!(*bench.frame.image(), base);
    let background = bench.pixels().find(|(x, y)| facing.values.at(*x, *y).is_nan());
    assert!(background.is_none_or(|(x, y)| half.at(x, y) == base.at(x, y)));
}

#[test]
fn owners_of_edges_follow_the_fill_rule() {
    let bench = OverlayBench::new("shared-edges", Recipe::default(), (32, 24));
    let marks = edge_marks(&bench.frame, &bench.recipe, [0.0, 0.0, 32.0, 24.0], 1000);
    assert_eq!(marks.len(), 3 * bench.frame.geometry().triangles.len());
    for EdgeMarks { ends_px: [from, to], inward, owned } in &marks {
        // Top-left rule: the inside lies to the right of the edge, or directly below it.
        let (right, down) = (inward[0], inward[1]);
        assert_eq!(*owned, right > 0.0 || right == 0.0 && down > 0.0, "{from:?} {to:?} {inward:?}");
    }
    assert!(edge_marks(&bench.frame, &bench.recipe, [-9.0, -9.0, -5.0, -5.0], 1000).is_empty());
}

#[test]
fn totals_are_written_as_comma_separated_values() {
    let bench = OverlayBench::new("triangle", Recipe::default(), (16, 12));
    let sheet = bench.sheet(Overlay::Rasterized);
    let table = csv([&sheet]);
    let rows: Vec<Vec<&str>> = table.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(rows[0], ["overlay", "total", "value", "unit"]);
    assert_eq!(rows.len(), 1 + sheet.totals.len());
    assert_eq!(rows[1][..2], ["rasterized", "in all"]);
    assert_eq!(rows[1][2].parse::<f64>(), Ok(total(&sheet, "in all")));
}

#[test]
fn normals_of_rasterized_triangles_have_the_length_of_their_layer() {
    let layer = |text: &str| text.parse::<OverlayLayer>().unwrap();
    let mut recipe = Recipe::default();
    let lines = |bench: &OverlayBench, text: &str| bench.layer_sheet(&layer(text)).lines;
    let bench = OverlayBench::new("cubes", recipe, (120, 90));
    for (id, name) in [("vertex-normals", "vertex normal"), ("face-normals", "face normal")] {
        let sheet = bench.layer_sheet(&layer(id));
        let mut on_lines = Image::filled(120, 90, false);
        for [from, to] in &sheet.lines {
            let wide = |[x, y]: [f32; 2]| (f64::from(x), f64::from(y));
            line_pixels(wide(*from), wide(*to), (120, 90)).for_each(|(x, y)| on_lines.set(x, y, true));
        }
        let differing = bench.pixels().filter(|(x, y)| on_lines.at(*x, *y) == sheet.values.at(*x, *y).is_nan()).count();
        // The ends are rounded to single precision, so a line that runs between two pixels may select the other pixel.
        assert!(differing < 20, "{differing}");
        let (x, y) = bench.pixels().find(|(x, y)| !sheet.values.at(*x, *y).is_nan()).unwrap();
        assert_eq!(sheet.text(x, y).as_deref(), Some(name));
        assert_eq!(compose(bench.frame.image(), [(&sheet, 1.0)]).at(x, y), sheet.line_color().unwrap());
        assert_eq!(total(&sheet, name), sheet.lines.len() as f64);
        let mean = |lines: &[[[f32; 2]; 2]]| {
            let length = |[[ax, ay], [bx, by]]: &[[f32; 2]; 2]| f64::from((bx - ax).hypot(by - ay));
            lines.iter().map(length).sum::<f64>() / lines.len() as f64
        };
        let ratio =
            mean(&lines(&bench, &format!("{id}=1,length=0.04"))) / mean(&lines(&bench, &format!("{id}=1,length=0.02")));
        assert!((1.9..2.2).contains(&ratio), "{ratio}");
        assert_eq!(bench.sheet(layer(id).overlay).lines, sheet.lines);
    }
    let faces = |bench: &OverlayBench| lines(bench, "face-normals").len();
    let drawn: std::collections::BTreeSet<_> =
        bench.frame.geometry().triangles.iter().map(|triangle| triangle.id).collect();
    assert_eq!(faces(&bench), drawn.len());
    recipe.pipeline.culling = Culling::None;
    assert!(faces(&OverlayBench::new("cubes", recipe, (120, 90))) > drawn.len());
}

#[test]
fn t_junctions_are_marked_where_their_vertices_lie() {
    let scene = Arc::new(seams::tests::scene(&[seams::tests::fan(&[-0.5, 0.2])], glam::Mat4::IDENTITY));
    let camera = crate::scene::Camera::look_at(glam::Vec3::new(0.0, 0.0, 4.0), glam::Vec3::ZERO);
    let (recipe, viewport) = (Recipe::default(), Viewport { width: 100, height: 80 });
    let frame = run(&scene, &camera, &recipe, viewport, &mut ());
    let bench = OverlayBench { scene, recipe, frame, watched: OnceLock::new() };
    let sheet = bench.sheet(Overlay::Junctions);
    let marked: Vec<_> = bench.pixels().filter(|(x, y)| !sheet.values.at(*x, *y).is_nan()).collect();
    let clip_from_world = camera.clip_from_world(viewport.aspect(), crate::scene::DepthMapping::STANDARD);
    let expected = [-0.5, 0.2].map(|x| {
        let (x, y) = viewport.pixels_from_ndc(clip_from_world.project_point3(glam::Vec3::new(x, 0.0, 0.0)));
        (x as u32, y as u32)
    });
    assert_eq!(marked, expected);
    assert_eq!(sheet.text(expected[0].0, expected[0].1).as_deref(), Some("T-junction"));
    assert_eq!((total(&sheet, "T-junction"), total(&sheet, "unwelded vertex")), (2.0, 0.0));
    // These overlays report that the search for seams is still running.
    assert!(Overlay::Junctions.reads_seams() && Overlay::Faults.reads_seams() && !Overlay::Facing.reads_seams());
}
