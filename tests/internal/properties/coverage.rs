//! Checks of coverage: shared edges are drawn exactly once, regardless of clipping and projection.
//!
//! The oracle defines the fill rules differently from edge ownership: it moves a sample by an infinitesimal step, and
//! the triangle that then strictly contains the sample owns it. A step of ε to the right and ε² down gives the top-left
//! rule.

use rasterscope::image::Image;
use rasterscope::pipeline::clip_space::ClipVertex;
use rasterscope::pipeline::screen_triangle::ScreenTriangle;
use rasterscope::pipeline::settings::{FillRule, Rasterizer};
use rasterscope::pipeline::viewport::Viewport;

use crate::internal::common::{
    clip_vertex, covered, for_seeds, grid_triangles, screen_triangles, signed, sound_fill_rules,
};

const VIEW: Viewport = Viewport { width: 48, height: 32 };

/// Number of triangles that cover each pixel, and the number of front-facing minus back-facing ones.
struct Counts {
    all: Image<i32>,
    signed: Image<i32>,
}

fn count(triangles: &[ScreenTriangle], rule: FillRule) -> Counts {
    let blank = Image::filled(VIEW.width, VIEW.height, 0);
    let mut counts = Counts { all: blank.clone(), signed: blank };
    for triangle in triangles {
        let orientation = -snapped_area(triangle).signum() as i32;
        for s in covered(triangle, Rasterizer::BoundingBox, rule, VIEW) {
            counts.all.set(s.x, s.y, counts.all.at(s.x, s.y) + 1);
            counts.signed.set(s.x, s.y, counts.signed.at(s.x, s.y) + orientation);
        }
    }
    counts
}

fn snapped_area(triangle: &ScreenTriangle) -> i128 {
    let [a, b, c] = triangle.vertices.each_ref().map(|v| (i128::from(v.x), i128::from(v.y)));
    (b.0 - a.0) * (c.1 - a.1) - (c.0 - a.0) * (b.1 - a.1)
}

/// Returns a front-facing mesh of jittered cells that extends beyond the picture on all sides, every vertex with its
/// own w. About a third of the vertices lie on pixel centres, where fill rules matter.
fn jittered_grid(
    rng: &mut fastrand::Rng,
    depth: impl Fn(&mut fastrand::Rng) -> f32,
) -> (Vec<ClipVertex>, Vec<[u32; 3]>) {
    let (columns, rows) = (rng.u32(3..9), rng.u32(3..7));
    let cell = (60.0 / columns as f32, 44.0 / rows as f32);
    let mut vertices = Vec::new();
    for y in 0..=rows {
        for x in 0..=columns {
            let inner = x > 0 && y > 0 && x < columns && y < rows;
            let jitter = if inner { 0.3 } else { 0.0 };
            let mut at =
                ((x as f32 + jitter * signed(rng)) * cell.0 - 6.0, (y as f32 + jitter * signed(rng)) * cell.1 - 6.0);
            if inner && rng.u8(..3) == 0 {
                at = (at.0.floor() + 0.5, at.1.floor() + 0.5);
            }
            let w = 0.05 + 20.0 * rng.f32().powi(3);
            vertices.push(clip_vertex(VIEW, at, depth(rng), w));
        }
    }
    // The rows run downwards on the screen, so the grid's own order is clockwise.
    let triangles = grid_triangles(columns, rows).into_iter().map(|[a, b, c]| [a, c, b]).collect();
    (vertices, triangles)
}

/// Returns a triangle fan around a point in the picture, large enough to cover the picture.
fn fan(rng: &mut fastrand::Rng) -> (Vec<ClipVertex>, Vec<[u32; 3]>) {
    let spokes = rng.u32(3..12);
    let center = (rng.u32(4..44) as f32 + 0.5, rng.u32(4..28) as f32 + 0.5);
    let rim = (0..spokes).map(|i| {
        let angle = (i as f32 + 0.3 * rng.f32()) / spokes as f32 * std::f32::consts::TAU;
        let radius = 200.0 + 10_000.0 * rng.f32().powi(4);
        (center.0 + radius * angle.cos(), center.1 - radius * angle.sin())
    });
    let places: Vec<_> = std::iter::once(center).chain(rim).collect();
    let vertices = places.into_iter().map(|p| clip_vertex(VIEW, p, 0.5, 0.1 + 5.0 * rng.f32())).collect();
    (vertices, (0..spokes).map(|i| [0, i + 1, (i + 1) % spokes + 1]).collect())
}

#[test]
fn a_closed_mesh_over_the_picture_covers_every_pixel_exactly_once_under_sound_rules() {
    for_seeds(150, |rng| {
        let (vertices, triangles) = if rng.bool() { jittered_grid(rng, |rng| 0.1 + 0.8 * rng.f32()) } else { fan(rng) };
        for rule in sound_fill_rules() {
            let counts = count(&screen_triangles(&vertices, &triangles, VIEW, &mut ()), rule);
            assert!(counts.all.pixels().iter().all(|c| *c == 1), "{rule:?}: {:?}", counts.all);
            assert_eq!(counts.all.pixels(), counts.signed.pixels(), "all of them are front-facing");
        }
    });
}

#[test]
fn the_two_wrong_rules_overlap_and_crack() {
    let (mut doubled, mut missing) = (0, 0);
    for_seeds(40, |rng| {
        let (vertices, triangles) = jittered_grid(rng, |_| 0.5);
        let drawn = screen_triangles(&vertices, &triangles, VIEW, &mut ());
        let inclusive = count(&drawn, FillRule::Inclusive);
        assert!(inclusive.all.pixels().iter().all(|c| *c >= 1));
        let exclusive = count(&drawn, FillRule::Exclusive);
        assert!(exclusive.all.pixels().iter().all(|c| *c <= 1));
        doubled += inclusive.all.pixels().iter().filter(|c| **c > 1).count();
        missing += exclusive.all.pixels().iter().filter(|c| **c == 0).count();
    });
    assert!(doubled > 100 && missing > 100, "{doubled} drawn twice, {missing} missing");
}

#[test]
fn cuts_at_the_near_and_far_planes_neither_crack_nor_overlap() {
    let (mut cut_away, mut kept) = (0, 0);
    for_seeds(150, |rng| {
        // A plane in (x, y, depth), so that the remaining part is a strip between two straight lines.
        let (a, b, c) = (signed(rng), signed(rng), 0.5 + 0.3 * signed(rng));
        let (mut vertices, triangles) = jittered_grid(rng, |_| 0.0);
        for v in &mut vertices {
            v.position.z = a * v.position.x + b * v.position.y + c * v.position.w;
        }
        for rule in sound_fill_rules() {
            let counts = count(&screen_triangles(&vertices, &triangles, VIEW, &mut ()), rule);
            for y in 0..VIEW.height {
                for x in 0..VIEW.width {
                    let ndc = ((x as f32 + 0.5) / 24.0 - 1.0, 1.0 - (y as f32 + 0.5) / 16.0);
                    let depth = a * ndc.0 + b * ndc.1 + c;
                    let expected = i32::from((0.0..=1.0).contains(&depth));
                    // Within a grid step of the cut, zero hits and one hit are both correct, but two are not.
                    let undecided = depth.abs().min((1.0 - depth).abs()) < 1e-3;
                    let got = counts.signed.at(x, y);
                    assert!(
                        got == expected || (undecided && (0..=1).contains(&got)),
                        "{rule:?} {x},{y}: {got}, depth {depth}"
                    );
                    *(if expected == 1 { &mut kept } else { &mut cut_away }) += 1;
                }
            }
        }
    });
    assert!(cut_away > 10_000 && kept > 10_000, "{cut_away} pixels cut away, {kept} kept");
}

#[test]
fn triangles_far_beyond_the_guard_band_and_behind_the_eye_stay_watertight() {
    for_seeds(300, |rng| {
        // A grid of huge triangles on a plane in front of the eye that extends in all directions, so that its outermost
        // vertices lie behind the eye.
        let reach = 10.0_f32.powi(rng.i32(0..12));
        let tilt = 0.9 * signed(rng);
        let vertices: Vec<ClipVertex> = (0..49)
            .map(|i| {
                let spread = |n: i32, jitter: f32| ((n - 3) as f32 + jitter).powi(3) * reach * 0.1;
                let (x, y) = (spread(i % 7, 0.3 * signed(rng)), spread(i / 7, 0.3 * signed(rng)));
                let w = 1.0 + tilt * x;
                clip_at(x, y, w)
            })
            .collect();
        let triangles: Vec<[u32; 3]> = grid_triangles(6, 6);
        for rule in sound_fill_rules() {
            let drawn = screen_triangles(&vertices, &triangles, VIEW, &mut ());
            let far = drawn.iter().flat_map(|t| &t.vertices).map(|v| v.x.abs().max(v.y.abs())).max();
            assert!(far.is_none_or(|f| f <= (32_768 + 48) * 256), "{far:?} is outside of the guard band");
            let counts = count(&drawn, rule);
            assert!(counts.signed.pixels().iter().all(|c| (0..=1).contains(c)), "{rule:?} {:?}", counts.signed);
        }
    });
}

fn clip_at(x: f32, y: f32, w: f32) -> ClipVertex {
    ClipVertex::at(glam::Vec4::new(x, y, w * 0.5, w))
}

/// Returns whether the triangle contains the pixel centre, moved by the infinitesimal step of the rule. Computes in
/// i128, with coordinates scaled so that the step is an integer.
fn oracle(triangle: &ScreenTriangle, (x, y): (u32, u32), rule: FillRule) -> bool {
    let (right, down) = match rule {
        FillRule::TopLeft => (1, 1),
        FillRule::TopRight => (-1, 1),
        FillRule::BottomLeft => (1, -1),
        FillRule::BottomRight => (-1, -1),
        FillRule::Inclusive | FillRule::Exclusive => (0, 0),
    };
    const SCALE: i128 = 1 << 60;
    let corners = triangle.vertices.each_ref().map(|v| (i128::from(v.x) * SCALE, i128::from(v.y) * SCALE));
    let center = |pixel: u32| (i128::from(pixel) * 256 + 128) * SCALE;
    let (px, py) = (center(x) + right * (1 << 30), center(y) + down);
    let orientation = snapped_area(triangle).signum();
    let side = |a: (i128, i128), b: (i128, i128)| {
        // Differences between corners are scaled down again, so that the products fit into i128.
        ((b.0 - a.0) / SCALE * (py - a.1) - (b.1 - a.1) / SCALE * (px - a.0)) * orientation
    };
    let [a, b, c] = corners;
    let sides = [side(a, b), side(b, c), side(c, a)];
    if rule == FillRule::Inclusive { sides.iter().all(|s| *s >= 0) } else { sides.iter().all(|s| *s > 0) }
}

#[test]
fn coverage_agrees_with_an_oracle_that_moves_the_sample() {
    let mut inside = 0;
    for_seeds(200, |rng| {
        let on_grid = rng.bool();
        let mut place = || {
            let (x, y) = (rng.f32() * 70.0 - 11.0, rng.f32() * 50.0 - 9.0);
            if on_grid { (x.floor() + 0.5, y.floor() + 0.5) } else { (x, y) }
        };
        let places: Vec<_> = (0..9).map(|_| place()).collect();
        let vertices: Vec<_> = places.into_iter().map(|p| clip_vertex(VIEW, p, 0.5, 0.2 + rng.f32())).collect();
        let triangles = [[0, 1, 2], [3, 4, 5], [6, 7, 8]];
        for rule in sound_fill_rules().chain([FillRule::Inclusive, FillRule::Exclusive]) {
            for triangle in screen_triangles(&vertices, &triangles, VIEW, &mut ()) {
                let expected = Image::from_fn(VIEW.width, VIEW.height, |x, y| oracle(&triangle, (x, y), rule));
                for rasterizer in Rasterizer::correct() {
                    let mut found = Image::filled(VIEW.width, VIEW.height, false);
                    for s in covered(&triangle, rasterizer, rule, VIEW) {
                        found.set(s.x, s.y, true);
                    }
                    assert_eq!(found, expected, "{rasterizer:?} {rule:?} {triangle:?}");
                }
                inside += expected.pixels().iter().filter(|c| **c).count();
            }
        }
    });
    assert!(inside > 100_000, "only {inside} samples inside");
}
