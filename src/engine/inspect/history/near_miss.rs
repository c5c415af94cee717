//! Rasterized triangles that narrowly miss a pixel's centre, with the distance and the decisive edge.
//!
//! Distances are measured to the triangle that determines coverage. In fixed point, its corners are snapped to
//! multiples of 1/256 px within ±2¹⁵ px. Differences, products and cross products are then exact in f64; see
//! [`distance_px`].

use std::collections::BTreeSet;

use glam::DVec2;

use crate::chain::{Frame, Recipe};
use crate::inspect::pixel::{Absent, Cause};
use crate::pipeline::raster::AnyTriangle;
use crate::pipeline::screen_triangle::ScreenTriangle;
use crate::pipeline::settings::{Arithmetic, Choice as _, Settings};
use crate::scene::{Scene, TriangleId};

/// Maximum distance in px between a pixel's centre and a triangle's bounding box at which the triangle counts as near.
const NEAR_PX: f64 = 1.0;

/// Maximum number of reported near misses; a corner of a fine mesh may have thousands.
const MAX_NEAR_MISSES: usize = 40;

/// A rasterized triangle without a fragment at the pixel, and its distance from the pixel's centre.
#[derive(Clone, Copy)]
struct Miss {
    place: usize,
    distance_px: f64,
}

/// Returns the rasterized triangles near a drawn pixel, nearest first. Excludes the triangles in `there`, which have a
/// fragment at the pixel. If no triangle is near and `there` is empty, returns the nearest triangle of the frame.
pub(super) fn at(
    scene: &Scene,
    recipe: &Recipe,
    frame: &Frame,
    pixel: (u32, u32),
    there: &BTreeSet<TriangleId>,
) -> Vec<Absent> {
    let (triangles, settings) = (&frame.geometry().triangles, &recipe.pipeline);
    let centre = DVec2::new(f64::from(pixel.0) + 0.5, f64::from(pixel.1) + 0.5);
    let mut near: Vec<Miss> = Vec::new();
    let mut nearest: Option<Miss> = None;
    for (place, triangle) in triangles.iter().enumerate() {
        let corners = corners(triangle, settings.arithmetic);
        let to_box = box_distance_px(corners, centre);
        let is_near = to_box <= NEAR_PX;
        if !is_near && nearest.is_some_and(|nearest| nearest.distance_px <= to_box) || there.contains(&triangle.id) {
            continue;
        }
        let miss = Miss { place, distance_px: distance_px(corners, centre) };
        if is_near {
            near.push(miss);
        }
        if nearest.is_none_or(|nearest| miss.distance_px < nearest.distance_px) {
            nearest = Some(miss);
        }
    }
    if near.is_empty() && there.is_empty() {
        near.extend(nearest);
    }
    near.sort_by(|a, b| a.distance_px.total_cmp(&b.distance_px));
    let mut listed = BTreeSet::new();
    near.retain(|miss| listed.insert(triangles[miss.place].id));
    near.truncate(MAX_NEAR_MISSES);
    near.into_iter().filter_map(|miss| absent(scene, settings, &triangles[miss.place], miss, pixel)).collect()
}

/// Returns the corners that determine coverage, in px: snapped to the subpixel grid in fixed point, otherwise
/// unsnapped.
fn corners(triangle: &ScreenTriangle, arithmetic: Arithmetic) -> [DVec2; 3] {
    decided_by(triangle, arithmetic).map(|[x, y]| DVec2::new(x.into(), y.into()))
}

fn decided_by(triangle: &ScreenTriangle, arithmetic: Arithmetic) -> [[f32; 2]; 3] {
    if arithmetic == Arithmetic::Fixed { triangle.snapped_px() } else { triangle.corners_px() }
}

/// Returns the distance from a point to the bounding box of three corners, in px; 0 inside.
fn box_distance_px([a, b, c]: [DVec2; 3], point: DVec2) -> f64 {
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    (low - point).max(point - high).max(DVec2::ZERO).length()
}

/// Returns the distance from a point to a triangle, in the unit of the corners; 0 inside and on the edges. For corners
/// and points on a grid of 1/256 within ±2¹⁵, every sign is exact. Only the final root and quotient are rounded.
pub(super) fn distance_px(corners: [DVec2; 3], point: DVec2) -> f64 {
    let [a, b, c] = corners;
    let edges = [(b, c), (c, a), (a, b)];
    let sides = edges.map(|(from, to)| (to - from).perp_dot(point - from));
    let has_area = (b - a).perp_dot(c - a) != 0.0;
    if has_area && (sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0)) {
        return 0.0;
    }
    edges.iter().zip(sides).map(|((from, to), side)| segment_distance(*from, *to, side, point)).fold(f64::MAX, f64::min)
}

/// Returns the distance from a point to a line segment. `side` is the cross product of the vector along the segment and
/// the vector from its start to the point.
fn segment_distance(from: DVec2, to: DVec2, side: f64, point: DVec2) -> f64 {
    let (along, way) = (to - from, point - from);
    let (reach, length_squared) = (along.dot(way), along.length_squared());
    if reach <= 0.0 {
        way.length()
    } else if reach >= length_squared {
        (point - to).length()
    } else {
        side.abs() / length_squared.sqrt()
    }
}

/// Creates the history entry of a miss. Returns `None` for a triangle without area in the recipe's arithmetic, which
/// cannot cover any pixel.
fn absent(
    scene: &Scene,
    settings: &Settings,
    triangle: &ScreenTriangle,
    Miss { place, distance_px }: Miss,
    pixel: (u32, u32),
) -> Option<Absent> {
    let shape = AnyTriangle::new(settings.arithmetic, triangle.corners_px(), settings.fill_rule)?;
    let edges = shape.sample(pixel).edges;
    let (cause, reason) = if distance_px > 0.0 {
        (Cause::Missed, format!("misses by {} px: {}", px(distance_px), failed_edge(edges)))
    } else if let Some(edge) = edges.iter().position(|edge| *edge == 0.0) {
        let rule = settings.fill_rule.name();
        let given = format!("which the fill rule “{rule}” does not assign to it");
        (Cause::Tie, format!("has the centre exactly on its edge opposite to v{edge} (value 0), {given}"))
    } else {
        let by =
            if settings.rasterizer.is_published() { settings.rasterizer.name() } else { settings.arithmetic.name() };
        (Cause::Skipped, format!("has the centre inside, but is skipped by “{by}”: {}", failed_edge(edges)))
    };
    let instance = scene.instances[triangle.instance as usize].name.clone();
    Some(Absent {
        triangle: triangle.id,
        instance,
        submission: Some(place),
        cause,
        reason,
        corners_px: Some(decided_by(triangle, settings.arithmetic)),
        distance_px: Some(distance_px),
        edges: Some(edges),
    })
}

/// Describes the edge with the most negative edge function value, or all three values if none is negative.
fn failed_edge(edges: [f64; 3]) -> String {
    let least = (0..3).min_by(|a, b| edges[*a].total_cmp(&edges[*b])).unwrap_or(0);
    let value = edges[least];
    if value < 0.0 { format!("edge opposite to v{least} is {value} < 0") } else { format!("edge values {edges:?}") }
}

/// Formats a distance in px with about two significant digits, or rounded to whole pixels if it is 10 px or more.
pub(in crate::inspect) fn px(distance: f64) -> String {
    match distance {
        0.0..0.01 => format!("{distance:.4}"),
        0.01..0.1 => format!("{distance:.3}"),
        0.1..10.0 => format!("{distance:.2}"),
        _ => format!("{distance:.0}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [[i64; 2]; 3] = [[0, 0], [2560, 0], [0, 1024]];

    fn points(corners: [[i64; 2]; 3]) -> [DVec2; 3] {
        corners.map(|[x, y]| DVec2::new(x as f64 / 256.0, y as f64 / 256.0))
    }

    /// Returns the squared distance from a point to a triangle as numerator and denominator, in (1/256 px)², computed
    /// in integer arithmetic only.
    fn exact_squared(corners: [[i64; 2]; 3], [x, y]: [i64; 2]) -> (i128, i128) {
        let edge = |from: usize, to: usize| {
            let [[ax, ay], [bx, by]] = [corners[from], corners[to]].map(|c| c.map(i128::from));
            let (dx, dy, px, py) = (bx - ax, by - ay, i128::from(x) - ax, i128::from(y) - ay);
            let (reach, length) = (dx * px + dy * py, dx * dx + dy * dy);
            let (qx, qy) = (px - dx, py - dy);
            let squared = match reach {
                reach if reach <= 0 => (px * px + py * py, 1),
                reach if reach >= length => (qx * qx + qy * qy, 1),
                _ => ((dx * py - dy * px).pow(2), length),
            };
            (squared, dx * py - dy * px)
        };
        let edges = [edge(0, 1), edge(1, 2), edge(2, 0)];
        if edges.iter().all(|e| e.1 >= 0) || edges.iter().all(|e| e.1 <= 0) {
            return (0, 1);
        }
        edges.map(|e| e.0).into_iter().min_by(|a, b| (a.0 * b.1).cmp(&(b.0 * a.1))).unwrap_or((0, 1))
    }

    #[test]
    fn distances_match_integer_arithmetic() {
        let mut random = fastrand::Rng::with_seed(812);
        for _ in 0..20_000 {
            let mut place = || [random.i64(-9_000..9_000), random.i64(-9_000..9_000)];
            let (corners, point) = ([place(), place(), place()], place());
            let [a, b, c] = corners;
            if (b[0] - a[0]) * (c[1] - a[1]) == (b[1] - a[1]) * (c[0] - a[0]) {
                continue;
            }
            let (numerator, denominator) = exact_squared(corners, point);
            let exact = (numerator as f64 / denominator as f64).sqrt() / 256.0;
            let found = distance_px(points(corners), DVec2::new(point[0] as f64 / 256.0, point[1] as f64 / 256.0));
            assert!((found - exact).abs() <= exact * 4.0 * f64::EPSILON, "{corners:?} {point:?}: {found} {exact}");
            assert_eq!(found == 0.0, numerator == 0, "the sign is never wrong");
        }
    }

    #[test]
    fn a_point_one_grid_step_from_an_edge_has_that_distance() {
        let beside = distance_px(points(CORNERS), DVec2::new(5.0, -1.0 / 256.0));
        assert_eq!(beside, 1.0 / 256.0);
        assert_eq!(distance_px(points(CORNERS), DVec2::new(5.0, 0.0)), 0.0, "on the edge");
        assert_eq!(distance_px(points(CORNERS), DVec2::new(-3.0, -4.0)), 5.0, "from a corner");
        let flat = points([[0, 0], [256, 256], [512, 512]]);
        assert!(
            (distance_px(flat, DVec2::new(2.0, 0.0)) - 2.0_f64.sqrt()).abs() < 1e-15,
            "a triangle without area is a line"
        );
    }

    #[test]
    fn distances_are_formatted_with_about_two_significant_digits() {
        assert_eq!([0.003_906, 0.04, 0.5, 37.2].map(px), ["0.0039", "0.040", "0.50", "37"]);
    }
}
