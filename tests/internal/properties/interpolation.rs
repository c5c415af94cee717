//! Barycentric weights and interpolated attributes, checked against f64 arithmetic.
//!
//! Vertices lie on the 1/256 px grid, so snapping moves nothing and the oracle computes with the same triangle.

use glam::{DVec3, Vec2, Vec3};
use rasterscope::pipeline::clip_space::Varyings;
use rasterscope::pipeline::depth::DepthFunction;
use rasterscope::pipeline::depth_format::DepthEncoding;
use rasterscope::pipeline::interpolate::{AttributeSelection, affine_weights, attribute_weights, interpolate};
use rasterscope::pipeline::raster::{AnyTriangle, RasterSample};
use rasterscope::pipeline::screen_triangle::{ScreenTriangle, depth_at};
use rasterscope::pipeline::settings::{Arithmetic, FillRule, Interpolation, Rasterizer};
use rasterscope::pipeline::viewport::Viewport;

use crate::internal::common::{clip_vertex, covered, for_seeds, in_cube, screen_triangles};

/// Size of the pictures: a power of two, so that converting grid positions to NDC and back is exact.
const VIEW: Viewport = Viewport { width: 64, height: 64 };

/// Relative error of one rounding to f32: half a unit in the last place of 1.
const ROUNDING: f64 = 1.0 / (1 << 24) as f64;

/// Returns a random triangle inside the picture, with vertices on the grid and w over four powers of ten; `None` if it
/// is empty.
fn random_triangle(
    rng: &mut fastrand::Rng,
    varyings: impl Fn(&mut fastrand::Rng) -> Varyings,
) -> Option<ScreenTriangle> {
    let vertices = [0; 3].map(|_| {
        let place = (rng.u32(0..64 * 256) as f32 / 256.0, rng.u32(0..64 * 256) as f32 / 256.0);
        let mut vertex = clip_vertex(VIEW, place, rng.f32(), 10.0_f32.powf(4.0 * rng.f32() - 2.0));
        vertex.varyings = varyings(rng);
        vertex
    });
    screen_triangles(&vertices, &[[0, 1, 2]], VIEW, &mut ()).first().copied()
}

/// Runs a test for every covered sample of many random triangles.
fn for_samples(
    varyings: impl Fn(&mut fastrand::Rng) -> Varyings + Copy,
    mut test: impl FnMut(&ScreenTriangle, RasterSample),
) {
    let mut samples = 0;
    for_seeds(400, |rng| {
        if let Some(triangle) = random_triangle(rng, varyings) {
            for sample in covered(&triangle, Rasterizer::BoundingBox, FillRule::Inclusive, VIEW) {
                samples += 1;
                test(&triangle, sample);
            }
        }
    });
    assert!(samples > 50_000, "only {samples} samples");
}

/// Returns perspective-correct or affine weights, as shares of signed volumes in homogeneous space. Uses neither edge
/// functions nor interpolation of 1/w.
fn oracle(triangle: &ScreenTriangle, sample: RasterSample, perspective: bool) -> [f64; 3] {
    let corners = triangle.vertices.each_ref().map(|v| {
        let w = if perspective { 1.0 / f64::from(v.inv_w) } else { 1.0 };
        DVec3::new(f64::from(v.x) / 256.0, f64::from(v.y) / 256.0, 1.0) * w
    });
    let at = DVec3::new(f64::from(sample.column) + 0.5, f64::from(sample.row) + 0.5, 1.0);
    let [a, b, c] = corners;
    let volumes = [b.cross(c).dot(at), c.cross(a).dot(at), a.cross(b).dot(at)];
    volumes.map(|v| v / volumes.iter().sum::<f64>())
}

fn largest_error(got: [f32; 3], expected: [f64; 3]) -> f64 {
    got.iter().zip(expected).map(|(g, e)| (f64::from(*g) - e).abs()).fold(0.0, f64::max)
}

#[test]
fn weights_are_not_negative_and_sum_to_one() {
    for_samples(
        |_| Varyings::default(),
        |triangle, sample| {
            for weights in
                [affine_weights(triangle, &sample), attribute_weights(triangle, &sample, Interpolation::Perspective)]
            {
                assert!(weights.iter().all(|w| *w >= 0.0), "{weights:?}");
                let sum: f64 = weights.iter().map(|w| f64::from(*w)).sum();
                assert!((sum - 1.0).abs() <= 4.0 * ROUNDING, "{weights:?} sum to {sum}");
            }
        },
    );
}

#[test]
fn affine_weights_are_within_three_roundings_of_the_oracle() {
    for_samples(
        |_| Varyings::default(),
        |triangle, sample| {
            // Edge function, area, reciprocal, product: four roundings of a number up to 1.
            let error = largest_error(affine_weights(triangle, &sample), oracle(triangle, sample, false));
            assert!(error <= 4.0 * ROUNDING, "{error} at {sample:?} of {triangle:?}");
        },
    );
}

#[test]
fn perspective_weights_are_within_eight_roundings_of_the_oracle() {
    for_samples(
        |_| Varyings::default(),
        |triangle, sample| {
            // Roundings of the edge function, the ratio of 1/w, the product, two sums, the reciprocal and the product,
            // and one for the cancelling errors of the sum.
            let error = largest_error(
                attribute_weights(triangle, &sample, Interpolation::Perspective),
                oracle(triangle, sample, true),
            );
            assert!(error <= 8.0 * ROUNDING, "{error} at {sample:?} of {triangle:?}");
        },
    );
}

#[test]
fn depth_is_affine_over_the_screen_whatever_w_is() {
    for_samples(
        |_| Varyings::default(),
        |triangle, sample| {
            let weights = oracle(triangle, sample, false);
            let expected: f64 = weights.iter().zip(&triangle.vertices).map(|(l, v)| l * v.depth).sum();
            // The depth is computed in f64 and rounded once: to the nearest float, or to either of two that are about
            // equally near.
            let nearest = (f64::from(expected as f32) - expected).abs();
            let error = (f64::from(depth_at(triangle, &sample)) - expected).abs();
            assert!(error <= nearest + 1e-15, "{error} at {sample:?} of {triangle:?}");
        },
    );
}

#[test]
fn depth_that_is_linear_in_space_follows_the_perspective_weights() {
    for_samples(
        |_| Varyings::default(),
        |triangle, sample| {
            let depths = triangle.vertices.each_ref().map(|v| v.depth);
            let linear =
                ScreenTriangle { depth: DepthFunction::linear_in_space(depths, DepthEncoding::F32), ..*triangle };
            let weights = oracle(triangle, sample, true);
            let expected: f64 = weights.iter().zip(depths).map(|(p, depth)| p * depth).sum();
            // As in the previous test, but the volumes of the oracle have fewer valid digits than edge functions.
            let nearest = (f64::from(expected as f32) - expected).abs();
            let error = (f64::from(depth_at(&linear, &sample)) - expected).abs();
            assert!(error <= nearest + 1e-9, "{error} at {sample:?} of {triangle:?}");
            let [least, greatest] =
                [f64::min, f64::max].map(|f| depths.into_iter().reduce(f).unwrap_or_default() as f32);
            assert!((least..=greatest).contains(&depth_at(&linear, &sample)), "beyond the corners");
        },
    );
}

#[test]
fn attributes_are_interpolated_with_the_perspective_weights() {
    for_samples(
        |rng| Varyings { normal: in_cube(rng), uv: Vec2::new(rng.f32(), rng.f32()), ..Varyings::default() },
        |triangle, sample| {
            let weights = oracle(triangle, sample, true);
            let fragment = interpolate(triangle, sample, AttributeSelection::all(Interpolation::Perspective));
            let mean = |value: fn(&Varyings) -> f32| -> f64 {
                weights.iter().zip(&triangle.vertices).map(|(p, v)| p * f64::from(value(&v.varyings))).sum()
            };
            for (got, expected) in [(fragment.uv.x, mean(|v| v.uv.x)), (fragment.normal.z, mean(|v| v.normal.z))] {
                assert!((f64::from(got) - expected).abs() <= 50.0 * ROUNDING, "{got} for {expected}");
            }
        },
    );
}

#[test]
fn attributes_that_are_equal_at_all_corners_are_exactly_constant() {
    let same = Varyings {
        normal: Vec3::new(0.6, -0.1, 1e-20),
        uv: Vec2::new(1.0 / 3.0, 1e20),
        color: Vec3::new(0.1, 0.2, 0.3),
        light: 0.7,
        source_weights: Vec3::splat(0.3),
    };
    for_samples(
        |_| same,
        |triangle, sample| {
            let got = interpolate(triangle, sample, AttributeSelection::all(Interpolation::Perspective));
            let varyings = Varyings {
                normal: got.normal,
                uv: got.uv,
                color: got.color,
                light: got.light,
                // Clipping sets these weights itself to identify the corners.
                source_weights: same.source_weights,
            };
            assert_eq!(varyings, same);
            let mut flat = *triangle;
            flat.depth = DepthFunction::affine_on_screen([0.123_456_79; 3], triangle.doubled_area, DepthEncoding::F32);
            assert_eq!(depth_at(&flat, &sample), 0.123_456_79);
            flat.depth = DepthFunction::linear_in_space([0.123_456_79; 3], DepthEncoding::F32);
            assert_eq!(depth_at(&flat, &sample), 0.123_456_79);
        },
    );
}

#[test]
fn clipping_changes_no_attribute_beyond_rounding() {
    // The weights of the unclipped corners are attributes, too: in the clipped pieces they must equal those of the
    // whole triangle.
    let mut compared = 0;
    for_seeds(300, |rng| {
        let mut vertices =
            [0; 3].map(|_| clip_vertex(VIEW, (rng.f32() * 64.0, rng.f32() * 64.0), rng.f32(), 0.1 + rng.f32()));
        let whole = screen_triangles(&vertices, &[[0, 1, 2]], VIEW, &mut ());
        for v in &mut vertices {
            v.position.z -= 0.3 * v.position.w;
        }
        let pieces = screen_triangles(&vertices, &[[0, 1, 2]], VIEW, &mut ());
        for piece in &pieces {
            for sample in covered(piece, Rasterizer::BoundingBox, FillRule::TopLeft, VIEW) {
                let pixel = (sample.x, sample.y);
                let in_whole = whole.iter().find_map(|whole| {
                    let edges = AnyTriangle::new(Arithmetic::Fixed, whole.corners_px(), FillRule::TopLeft)?;
                    let sample = edges.sample(pixel);
                    sample.edges.iter().all(|e| *e > 0.0).then_some((whole, sample))
                });
                let Some((whole, in_whole)) = in_whole else { continue };
                let [got, expected] = [(piece, sample), (whole, in_whole)].map(|(t, s)| {
                    interpolate(t, s, AttributeSelection::all(Interpolation::Perspective)).source_weights
                });
                // Snapping moves a cut by up to 1/512 px, which is the whole width of a sliver, so only wide triangles
                // count.
                let wide = [whole, piece].iter().all(|t| t.doubled_area > f64::from(200 << 16));
                assert!(!wide || (got - expected).abs().max_element() < 2e-3, "{got} for {expected}");
                compared += usize::from(wide);
            }
        }
    });
    assert!(compared > 20_000, "only {compared} samples compared");
}
