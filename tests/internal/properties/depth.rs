//! Depths of vertices and samples, checked against independent computations.

use glam::{Mat4, Vec3};
use num_rational::BigRational;
use num_traits::{Signed as _, ToPrimitive as _};
use rasterscope::chain::{Frame, Recipe, run};
use rasterscope::inspect::capture;
use rasterscope::pipeline::clip::{clip, guard_band_widening};
use rasterscope::pipeline::depth::DepthScale;
use rasterscope::pipeline::depth_format::DepthEncoding;
use rasterscope::pipeline::observe::{DepthOutcome, Observer};
use rasterscope::pipeline::plan::PipelinePart;
use rasterscope::pipeline::raster::RasterSample;
use rasterscope::pipeline::screen_triangle::ScreenTriangle;
use rasterscope::pipeline::settings::{
    Arithmetic, Choice, Culling, DepthBias, DepthFormat, DepthTest, FillRule, Rasterizer,
};
use rasterscope::pipeline::vertex::{DrawMatrices, transform};
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::scene::{Camera, DepthCurve, DepthMapping, Mesh, Scene, TriangleId, builtin};

use crate::internal::common::{DEPTH_BIASES, SceneBuilder, covered, cube, for_seeds, in_cube, mesh, render, scenes};

const SIZE: (u32, u32) = (32, 24);

const ENCODINGS: [DepthEncoding; 3] = [DepthEncoding::F32, DepthEncoding::Unorm24, DepthEncoding::Unorm16];

/// Returns a recipe with this depth format, a depth test that always passes, and no culling.
fn always(format: DepthFormat) -> Recipe {
    let mut recipe = Recipe::default();
    (recipe.pipeline.depth_test, recipe.pipeline.depth_format) = (DepthTest::Always, format);
    recipe.pipeline.culling = Culling::None;
    recipe
}

/// Returns a scene of `mesh` whose camera is at the origin and looks along −z.
fn seen_along_z(mesh: Mesh, [near, far]: [f32; 2]) -> Scene {
    let mut scene = SceneBuilder::new(Vec3::Z).with(mesh, Mat4::IDENTITY, None).0;
    scene.home = Camera { near, far, ..Camera::look_at(Vec3::ZERO, Vec3::NEG_Z) };
    scene
}

fn depths(frame: &Frame) -> &[f32] {
    frame.drawn.depth.as_ref().expect("a depth buffer").pixels()
}

/// Returns a log-uniform random number between two bounds.
fn log_uniform(rng: &mut fastrand::Rng, [from, to]: [f32; 2]) -> f32 {
    let [from, to] = [from, to].map(f64::from);
    (from * (to / from).powf(rng.f64())) as f32
}

#[test]
fn the_depth_scale_gives_the_depths_that_the_pipeline_stores() {
    for planes in [[0.1, 1e4], [1e-6, 1e3], [10.0, 10.5], [1.0, 1e9]] {
        for_seeds(10, |rng| {
            let [near, far] = planes;
            let w = log_uniform(rng, [near * 1.001, far * 0.999]);
            // The triangle is larger than the view and faces it.
            let corners = [Vec3::new(-3.0, -3.0, -1.0), Vec3::new(6.0, -3.0, -1.0), Vec3::new(-3.0, 6.0, -1.0)];
            let scene = seen_along_z(mesh(corners.map(|c| c * w).to_vec(), vec![[0, 1, 2]]), planes);
            for format in DepthFormat::ALL {
                let scale = DepthScale::perspective(format.mapping(), format.encoding(), near, far);
                let frame = render(&scene, &always(*format), SIZE);
                let expected = scale.stored(w);
                assert!(depths(&frame).iter().all(|d| *d == expected), "{format:?} at {w} of {planes:?}");
            }
        });
    }
}

#[test]
fn no_farther_distance_is_ever_stored_as_nearer() {
    for planes in [[0.1, 1e4], [1e-30, 1e30], [1.0, 1.0_f32.next_up()], [1.0, 1e9], [1e-6, 1e-5], [7.0, 7.5]] {
        for (mapping, encoding) in DepthMapping::ALL.into_iter().flat_map(|m| ENCODINGS.map(|e| (m, e))) {
            let scale = DepthScale::perspective(mapping, encoding, planes[0], planes[1]);
            let [near, far] = planes.map(|w| scale.stored(w));
            let ends = if mapping.is_reversed() { [1.0, 0.0] } else { [0.0, 1.0] };
            assert_eq!(near, ends[0], "{mapping:?} {encoding:?}");
            assert!(far == ends[1] || !mapping.has_far_plane(), "{mapping:?} {encoding:?}: {far}");
            for_seeds(200, |rng| {
                // Compares adjacent floats, where an inversion would occur first.
                let mut w = log_uniform(rng, planes);
                let mut before = scale.stored(w);
                for _ in 0..20 {
                    w = w.next_up();
                    let here = scale.stored(w);
                    let sound = if mapping.is_reversed() { here <= before } else { here >= before };
                    assert!(
                        sound && (0.0..=1.0).contains(&here),
                        "{mapping:?} {encoding:?}: {here} after {before} at {w}"
                    );
                    before = here;
                }
            });
        }
    }
}

/// Returns the distance at which `depth` gives `target`, found by bisection instead of by solving the formula for w.
fn distance_of(depth: impl Fn(f64) -> f64, target: f64, [mut from, mut to]: [f64; 2]) -> f64 {
    let rises = depth(from) < depth(to);
    for _ in 0..200 {
        let middle = (from + to) * 0.5;
        *(if (depth(middle) < target) == rises { &mut from } else { &mut to }) = middle;
    }
    (from + to) * 0.5
}

#[test]
fn the_resolution_is_the_distance_between_two_neighbouring_depths() {
    for planes in [[0.1, 1e3], [1.0, 3.0], [1e-3, 50.0]] {
        let [n, f] = planes.map(f64::from);
        for format in DepthFormat::ALL {
            for orthographic in [false, true] {
                let camera = Camera { near: planes[0], far: planes[1], ..Camera::look_at(Vec3::ZERO, Vec3::NEG_Z) };
                let scale = DepthScale::new(*format, &camera.with_orthographic(orthographic));
                let DepthMapping { curve, reversed } = format.mapping();
                let curve = if orthographic { DepthCurve::Linear } else { curve };
                let depth = move |w: f64| match (curve, reversed) {
                    (DepthCurve::Hyperbolic, false) => f * (w - n) / (w * (f - n)),
                    (DepthCurve::Hyperbolic, true) => n * (f - w) / (w * (f - n)),
                    (DepthCurve::HyperbolicInfinite, false) => 1.0 - n / w,
                    (DepthCurve::HyperbolicInfinite, true) => n / w,
                    (DepthCurve::Linear, false) => (w - n) / (f - n),
                    (DepthCurve::Linear, true) => (f - w) / (f - n),
                };
                for_seeds(50, |rng| {
                    // Closer to the far plane, depths can be so small that their steps are finer than f64 resolves at
                    // that distance.
                    let w = f64::from(log_uniform(rng, [planes[0] * 1.1, planes[1] * 0.9]));
                    let stored = scale.encoding().quantize(depth(w));
                    let next = match format.encoding().largest_code() {
                        None => f64::from(f32::from_bits(stored.to_bits() + 1)),
                        Some(largest) => f64::from(stored) + 1.0 / f64::from(largest),
                    };
                    if next > 1.0 {
                        return;
                    }
                    // The search range extends beyond the planes, because a step of a coarse depth may lie outside
                    // them.
                    let [a, b] = [f64::from(stored), next].map(|d| distance_of(depth, d, [n * 1e-3, f * 1e3]));
                    let (expected, got) = ((b - a).abs(), scale.resolution(stored));
                    // The float of a code is off by up to half an ulp, and its distance by a corresponding amount.
                    assert!((got / expected - 1.0).abs() < 1e-3, "{format:?} at {w}: {got} for {expected}");
                });
            }
        }
    }
}

#[test]
fn a_far_plane_at_infinity_cuts_nothing_away() {
    for distance in [1e3_f32, 1e9, 1e20] {
        let place = Mat4::from_translation(Vec3::NEG_Z * distance) * Mat4::from_scale(Vec3::splat(distance * 0.2));
        let mut scene = SceneBuilder::new(Vec3::Z).with(cube(), place, None).0;
        scene.home = Camera { near: 0.1, far: 10.0, ..Camera::look_at(Vec3::ZERO, Vec3::NEG_Z) };
        for format in DepthFormat::ALL {
            let mut recipe = Recipe::default();
            recipe.pipeline.depth_format = *format;
            // Without reversal, large distances round to the depth of the cleared buffer.
            recipe.pipeline.depth_test = DepthTest::LessEqual;
            let frame = render(&scene, &recipe, SIZE);
            let drawn = frame.image().pixels().iter().filter(|p| p[..3] != scene.background).count();
            if !format.mapping().has_far_plane() {
                assert!(drawn > 50, "{drawn} at {distance}");
                let plan = &frame.plans[0];
                assert!(!plan.runs(PipelinePart::Clipping), "wholly inside at {distance}");
                if format.mapping().is_reversed() {
                    // The front of the cube is at 0.8 of the distance.
                    let nearest = depths(&frame).iter().fold(0.0_f32, |a, b| a.max(*b));
                    assert!((nearest * distance * 0.8 / 0.1 - 1.0).abs() < 1e-6, "{nearest} at {distance}");
                }
            } else {
                assert_eq!(drawn, 0, "{format:?} has a far plane");
            }
        }
    }
}

#[test]
fn a_w_buffer_holds_distances_up_to_a_far_plane_of_any_ratio_to_the_near_one() {
    // Ground one unit below the eye, from near the eye to far beyond the far plane.
    let corners = [[-1e7, -1e-1], [1e7, -1e-1], [1e7, -1e6], [-1e7, -1e6]].map(|[x, z]| Vec3::new(x, -1.0, z));
    let planes = [1e-6, 1e3];
    let scene = seen_along_z(mesh(corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]]), planes);
    let (width, height) = (8, 4000);
    let frame = render(&scene, &always(DepthFormat::WBuffer), (width, height));
    let half_height = f64::from(rasterscope::scene::camera::DEFAULT_FOV_Y * 0.5).tan();
    let mut beyond = 0;
    for row in height / 2..height {
        // Distance of the ground in this row of pixels, from the ray through it; a row covers many units there.
        let slope = |row: f64| (row / f64::from(height) * 2.0 - 1.0) * half_height;
        let [farthest, nearest] = [0.49, 0.51].map(|offset| 1.0 / slope(f64::from(row) + offset));
        let stored = f64::from(depths(&frame)[(row * width) as usize]);
        let distance = stored * f64::from(planes[1]);
        if nearest > f64::from(planes[1]) {
            assert_eq!(stored, 1.0, "row {row} lies beyond the far plane");
            beyond += 1;
        } else if farthest < f64::from(planes[1]) {
            assert!((nearest..farthest).contains(&distance), "row {row}: {distance}, not {nearest} to {farthest}");
        }
    }
    assert!(beyond > 1, "{beyond} rows beyond the far plane");
}

#[test]
fn vertices_clipped_at_a_plane_have_exactly_the_depth_of_that_plane() {
    const VIEW: Viewport = Viewport { width: SIZE.0, height: SIZE.1 };
    for format in DepthFormat::ALL {
        let mut cut = [0; 2];
        let mut scene = builtin::by_id("near-plane").expect("a built-in scene").build();
        // Both planes cross the visible part of the scene.
        scene.home.far = 20.0;
        let (camera, recipe) = (scene.home, always(*format));
        let plans = render(&scene, &recipe, SIZE).plans;
        let scale = DepthScale::new(*format, &camera);
        for (instance, plan) in
            scene.instances.iter().zip(plans.iter()).filter(|(_, plan)| plan.runs(PipelinePart::Clipping))
        {
            let mesh = scene.library.mesh(instance.mesh);
            let matrices = DrawMatrices::new(instance, camera.clip_from_world_f64(VIEW.aspect(), format.mapping()));
            let vertices = transform(mesh, &matrices, &recipe.pipeline, plan);
            let widening = guard_band_widening(VIEW.width, VIEW.height);
            for triangle in clip(&vertices, &mesh.triangles, TriangleId(0), widening, &mut ()) {
                let corners = VIEW.project(&triangle, &scale);
                for (vertex, corner) in triangle.vertices.iter().zip(corners).filter(|(v, _)| v.cut_at.is_some()) {
                    let w = vertex.position.w;
                    let at_near = (w - camera.near).abs() < (w - camera.far).abs();
                    let [plane, end] = if at_near { [camera.near, 0.0] } else { [camera.far, 1.0] };
                    assert!((w / plane - 1.0).abs() < 1e-4, "{format:?}: cut at {w}");
                    let expected = if format.mapping().is_reversed() { 1.0 - end } else { end };
                    assert_eq!(corner.depth, f64::from(expected), "{format:?}: cut at {w}");
                    cut[usize::from(!at_near)] += 1;
                }
            }
        }
        let endless = !format.mapping().has_far_plane();
        assert!(cut[0] > 20 && (cut[1] > 20 || endless && cut[1] == 0), "{format:?}: {cut:?} vertices cut");
    }
}

#[test]
fn without_perspective_depth_is_linear_whatever_the_format() {
    for (name, mut scene) in scenes() {
        scene.home = scene.home.with_orthographic(true);
        let stored = |format| depths(&render(&scene, &always(format), SIZE)).to_vec();
        assert_eq!(stored(DepthFormat::WBuffer), stored(DepthFormat::F32), "{name}");
        assert_eq!(stored(DepthFormat::ReversedInfinite), stored(DepthFormat::ReversedF32), "{name}");
        for (standard, reversed) in stored(DepthFormat::F32).iter().zip(stored(DepthFormat::ReversedF32)) {
            assert!((standard + reversed - 1.0).abs() < 1e-5, "{name}: {standard} and {reversed}");
        }
    }
}

#[test]
fn a_w_buffer_grows_with_the_distance_at_any_ratio_of_distances() {
    for exponent in [1, 5, 15] {
        let (close, far) = (10.0_f32.powi(-exponent), 10.0_f32.powi(exponent));
        // One corner is close, in the centre of the picture; two are far away at one distance, beyond its sides.
        let corners = vec![
            Vec3::new(0.0, -0.3, -1.0) * close,
            Vec3::new(1.0, 0.3, -1.0) * far,
            Vec3::new(-1.0, 0.35, -1.0) * far,
        ];
        let scene = seen_along_z(mesh(corners, vec![[0, 1, 2]]), [close * 0.5, far * 2.0]);
        let frame = render(&scene, &always(DepthFormat::WBuffer), (64, 64));
        let triangle = &frame.geometry().triangles[0];
        let (view, stored) = (Viewport { width: 64, height: 64 }, frame.drawn.depth.as_ref().expect("a depth buffer"));
        let samples = covered(triangle, Rasterizer::BoundingBox, FillRule::TopLeft, view);
        // Sorted by the weight of the close corner.
        let mut samples: Vec<_> = samples.into_iter().map(|s| (s.edges[0], stored.at(s.x, s.y))).collect();
        assert!(samples.len() > 200, "only {} samples", samples.len());
        samples.sort_by(|a, b| b.0.total_cmp(&a.0));
        assert!(samples.iter().all(|(_, depth)| (0.0..=1.0).contains(depth)), "in range at 1e±{exponent}");
        assert!(samples.windows(2).all(|pair| pair[0].1 <= pair[1].1), "growing at 1e±{exponent}");
        assert!(samples[0].1 < samples[samples.len() - 1].1);
    }
}

fn rational(number: f64) -> BigRational {
    BigRational::from_float(number).expect("a finite number")
}

/// Returns the exact depth offset by the formula of Vulkan's `vkCmdSetDepthBias`. The slope m comes from the normal of
/// the plane through the snapped corners, and the unit r from a power of two found by halving.
fn exact_offset(triangle: &ScreenTriangle, bias: DepthBias, encoding: DepthEncoding) -> BigRational {
    let corners = triangle.vertices.each_ref().map(|v| {
        let [x, y] = [v.x, v.y].map(|steps| rational(steps.into()) / rational(256.0));
        [x, y, rational(v.depth)]
    });
    let [a, b] = [1, 2].map(|end| [0, 1, 2].map(|axis| &corners[end][axis] - &corners[0][axis]));
    let component = |i: usize, j: usize| &a[i] * &b[j] - &a[j] * &b[i];
    let (x, y, z) = (component(1, 2), component(2, 0), component(0, 1));
    let slope = x.abs().max(y.abs()) / z.abs();
    let step = match encoding {
        DepthEncoding::Unorm16 => rational(1.0) / rational(65_535.0),
        DepthEncoding::Unorm24 => rational(1.0) / rational(16_777_215.0),
        DepthEncoding::F32 => {
            let greatest = triangle.vertices.iter().map(|v| rational((v.depth as f32).into())).max().expect("a corner");
            let (mut power, mut halvings) = (rational(1.0), 0);
            while power > greatest && halvings < 126 {
                power /= rational(2.0);
                halvings += 1;
            }
            power / rational(f64::from(1_u32 << 23))
        }
    };
    slope * rational(bias.slope.into()) + step * rational(bias.constant.into())
}

#[test]
fn a_depth_bias_follows_the_formula_of_vulkan_and_clamps() {
    let (mut compared, mut clamped) = (0, 0);
    for_seeds(60, |rng| {
        let positions = [(); 3].map(|()| in_cube(rng) * Vec3::new(4.0, 4.0, 3.0) - Vec3::Z * 5.0);
        let planes = [log_uniform(rng, [0.01, 1.9]), log_uniform(rng, [8.1, 1e4])];
        let scene = seen_along_z(mesh(positions.to_vec(), vec![[0, 1, 2]]), planes);
        for (format, bias) in DepthFormat::ALL.iter().flat_map(|format| DEPTH_BIASES.map(|bias| (*format, bias))) {
            let plain = always(format);
            let mut biased = plain;
            biased.pipeline.depth_bias = bias;
            let [plain, biased] = [plain, biased].map(|recipe| render(&scene, &recipe, SIZE));
            let [Some(triangle)] = [biased.geometry().triangles.first()] else { continue };
            let encoding = format.encoding();
            let offset = exact_offset(triangle, bias, encoding).to_f64().expect("within the range of f64");
            let samples = covered(
                triangle,
                Rasterizer::BoundingBox,
                FillRule::TopLeft,
                Viewport { width: SIZE.0, height: SIZE.1 },
            );
            let [before, after] = [&plain, &biased].map(|frame| frame.drawn.depth.as_ref().expect("a depth buffer"));
            for sample in samples {
                let [before, after] = [before, after].map(|depths| f64::from(depths.at(sample.x, sample.y)));
                let expected = (before + offset).clamp(0.0, 1.0);
                // Both depths are rounded to a code if codes are stored, and to a float; the offset is rounded to f64.
                let code = encoding.largest_code().map_or(0.0, |largest| 1.0 / f64::from(largest));
                let rounding = code + before.max(after) * f64::from(f32::EPSILON) + f64::MIN_POSITIVE;
                let reported = || format!("{format:?} {bias:?}: {before} by {offset} became {after}, not {expected}");
                assert!((after - expected).abs() <= rounding + offset.abs() * 1e-9, "{}", reported());
                compared += 1;
                clamped += usize::from(expected != before + offset);
            }
        }
    });
    assert!(compared > 10_000 && clamped > 1000, "{compared} depths, {clamped} of them clamped");
}

#[test]
fn a_depth_bias_decides_between_surfaces_at_one_depth() {
    // Two panes at one distance, the second one tilted: equal depths in the middle, different slopes.
    let pane = |tilt: f32| {
        let corner = |x: f32, y: f32| Vec3::new(x, y, -4.0 + x * tilt);
        mesh(
            [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| corner(x, y)).to_vec(),
            vec![[0, 1, 2], [0, 2, 3]],
        )
    };
    let mut scene =
        SceneBuilder::new(Vec3::Z).with(pane(0.0), Mat4::IDENTITY, None).with(pane(0.5), Mat4::IDENTITY, None).0;
    scene.home = Camera { near: 1.0, far: 10.0, ..Camera::look_at(Vec3::ZERO, Vec3::NEG_Z) };
    for format in DepthFormat::ALL {
        let seen = |slope: f32| {
            let mut recipe = Recipe::default();
            (recipe.pipeline.depth_format, recipe.pipeline.culling) = (*format, Culling::None);
            recipe.pipeline.depth_bias.slope = slope;
            let frame = render(&scene, &recipe, SIZE);
            let buffers = capture(&scene, &recipe, &frame);
            buffers.triangle.pixels().iter().filter(|id| [2, 3].contains(&id.0)).count()
        };
        let towards = if format.mapping().is_reversed() { 1.0 } else { -1.0 };
        let [nearer, plain, farther] = [towards, 0.0, -towards].map(seen);
        assert!(
            nearer > plain && plain > farther,
            "{format:?}: {nearer}, {plain}, {farther} pixels of the tilted pane"
        );
    }
}

/// Observer that panics if a depth is not a number in [0, 1], and counts depths.
struct OnlyDepths(usize);

impl Observer for OnlyDepths {
    fn depth_tested(&mut self, triangle: &ScreenTriangle, sample: &RasterSample, outcome: DepthOutcome) {
        assert!((0.0..=1.0).contains(&outcome.new), "{outcome:?} at {sample:?} of {triangle:?}");
        self.0 += 1;
    }
}

#[test]
fn every_depth_of_any_triangle_in_any_arithmetic_is_a_number_from_0_to_1() {
    let mut watch = OnlyDepths(0);
    for_seeds(40, |rng| {
        // Vertices of all magnitudes, seen with planes many powers of ten apart.
        let positions = (0..90).map(|_| in_cube(rng) * 10.0_f32.powi(rng.i32(-15..16)));
        let mesh = mesh(positions.collect(), (0..30).map(|i| [0, 1, 2].map(|c| i * 3 + c)).collect());
        let mut scene = SceneBuilder::new(in_cube(rng)).with(mesh, Mat4::IDENTITY, None).0;
        (scene.home.near, scene.home.far) = (10.0_f32.powi(rng.i32(-15..0)), 10.0_f32.powi(rng.i32(1..16)));
        for (format, arithmetic) in DepthFormat::ALL.iter().flat_map(|f| Arithmetic::ALL.iter().map(move |a| (f, a))) {
            let mut recipe = always(*format);
            recipe.pipeline.arithmetic = *arithmetic;
            recipe.pipeline.rasterizer = Rasterizer::ALL[rng.usize(..Rasterizer::ALL.len())];
            if rng.bool() {
                recipe.pipeline.depth_bias = DEPTH_BIASES[rng.usize(..DEPTH_BIASES.len())];
            }
            run(&scene, &scene.home, &recipe, Viewport { width: SIZE.0, height: SIZE.1 }, &mut watch);
        }
    });
    assert!(watch.0 > 1_000_000, "only {} depths", watch.0);
}
