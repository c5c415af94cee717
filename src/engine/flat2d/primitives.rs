//! Drawing primitives: assembly of vertex lists into points, lines and triangles, and checks that a polygon can be
//! drawn.
//!
//! The ten types are those of OpenGL 1.0. A triangle strip reverses every second triangle so that all face the same
//! way; a quad strip reads its vertices in zigzag order. Quads and polygons are drawn as fans here, which is correct
//! only for simple, convex and flat outlines; [`check_outline`] checks these three properties.

use std::cmp::Ordering;

use glam::{DVec2, DVec3};

use super::side;

/// Primitive type: the way in which vertices are assembled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Primitive {
    /// Each vertex is a point.
    Points,
    /// Every two vertices form a line.
    Lines,
    /// Each vertex is connected to the next by a line.
    LineStrip,
    /// Line strip that is closed by a line back to the first vertex.
    LineLoop,
    /// Every three vertices form a triangle.
    Triangles,
    /// Each vertex forms a triangle with the two before it.
    TriangleStrip,
    /// Each vertex forms a triangle with the one before it and the first.
    TriangleFan,
    /// Every four vertices form a quadrilateral.
    Quads,
    /// Each pair of vertices forms a quadrilateral with the pair before it.
    QuadStrip,
    /// All vertices are one polygon.
    Polygon,
}

/// Assembled primitive, as vertex indices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Piece {
    /// Single point.
    Point(usize),
    /// Line between two vertices.
    Line([usize; 2]),
    /// Triangle, in its winding order.
    Triangle([usize; 3]),
}

/// Assembles `count` vertices into primitives, in drawing order. Incomplete primitives at the end are ignored.
pub(crate) fn pieces(primitive: Primitive, count: usize) -> Vec<Piece> {
    let triangle = |a, b, c| Piece::Triangle([a, b, c]);
    let pairs = count.saturating_sub(1);
    match primitive {
        Primitive::Points => (0..count).map(Piece::Point).collect(),
        Primitive::Lines => (0..count / 2).map(|i| Piece::Line([2 * i, 2 * i + 1])).collect(),
        Primitive::LineStrip => (0..pairs).map(|i| Piece::Line([i, i + 1])).collect(),
        Primitive::LineLoop if count < 2 => Vec::new(),
        Primitive::LineLoop => (0..count).map(|i| Piece::Line([i, (i + 1) % count])).collect(),
        Primitive::Triangles => (0..count / 3).map(|i| triangle(3 * i, 3 * i + 1, 3 * i + 2)).collect(),
        Primitive::TriangleStrip => (0..count.saturating_sub(2))
            .map(|i| if i % 2 == 0 { triangle(i, i + 1, i + 2) } else { triangle(i + 1, i, i + 2) })
            .collect(),
        Primitive::TriangleFan | Primitive::Polygon => (1..pairs).map(|i| triangle(0, i, i + 1)).collect(),
        Primitive::Quads => (0..count / 4).flat_map(|i| fan_of([4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3])).collect(),
        Primitive::QuadStrip => {
            (0..(count / 2).saturating_sub(1)).flat_map(|i| fan_of([2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2])).collect()
        }
    }
}

fn fan_of([a, b, c, d]: [usize; 4]) -> [Piece; 2] {
    [Piece::Triangle([a, b, c]), Piece::Triangle([a, c, d])]
}

/// Properties of an outline that decide whether a fan covers its interior.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct OutlineProperties {
    /// Whether no two sides cross or touch, except neighbours at their common corner.
    pub(crate) simple: bool,
    /// Whether the outline is simple and all corners turn the same way or are straight.
    pub(crate) convex: bool,
    /// Whether all corners lie in one plane.
    pub(crate) flat: bool,
}

/// Checks the closed outline with these corners. `simple` and `convex` are decided exactly, from x and y only.
pub(crate) fn check_outline(corners: &[DVec3]) -> OutlineProperties {
    let flat_view: Vec<_> = corners.iter().map(|corner| corner.truncate()).collect();
    let simple = is_simple(&flat_view);
    OutlineProperties { simple, convex: simple && turns_one_way(&flat_view), flat: is_flat(corners) }
}

fn is_simple(points: &[DVec2]) -> bool {
    let count = points.len();
    let sides = |i: usize| (points[i], points[(i + 1) % count]);
    (0..count).all(|i| {
        (i + 1..count).all(|j| {
            let neighbours = j == i + 1 || (i == 0 && j == count - 1);
            if neighbours && count > 2 { !fold_back(points, i, j) } else { !meet(sides(i), sides(j)) }
        })
    })
}

/// Whether the neighbouring sides `i` and `j` overlap.
fn fold_back(points: &[DVec2], i: usize, j: usize) -> bool {
    let count = points.len();
    let middle = if j == i + 1 { j } else { 0 };
    let (before, at, after) = (points[(middle + count - 1) % count], points[middle], points[(middle + 1) % count]);
    side(before, at, after) == Ordering::Equal && (before - at).dot(after - at) > 0.0
}

/// Whether two closed segments have a point in common.
fn meet((a, b): (DVec2, DVec2), (c, d): (DVec2, DVec2)) -> bool {
    let boxes_apart = a.max(b).cmplt(c.min(d)).any() || c.max(d).cmplt(a.min(b)).any();
    let apart = |p, q, r, s| side(p, q, r) == side(p, q, s) && side(p, q, r) != Ordering::Equal;
    !boxes_apart && !apart(a, b, c, d) && !apart(c, d, a, b)
}

fn turns_one_way(points: &[DVec2]) -> bool {
    let count = points.len();
    let turns = || (0..count).map(|i| side(points[i], points[(i + 1) % count], points[(i + 2) % count]));
    !(turns().any(|turn| turn == Ordering::Less) && turns().any(|turn| turn == Ordering::Greater))
}

/// Whether all corners lie in one plane: the plane through the first corner, perpendicular to the outline's normal. The
/// tolerance is a millionth of the outline's size.
fn is_flat(corners: &[DVec3]) -> bool {
    const TOLERANCE: f64 = 1e-6;
    let Some(first) = corners.first() else { return true };
    let from = |i: usize| corners[i % corners.len()] - *first;
    let normal: DVec3 = (0..corners.len()).map(|i| from(i).cross(from(i + 1))).sum();
    let Some(normal) = normal.try_normalize() else { return true };
    let size = corners.iter().map(|corner| (*corner - *first).length()).fold(0.0, f64::max);
    corners.iter().all(|corner| (*corner - *first).dot(normal).abs() <= TOLERANCE * size)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangles(primitive: Primitive, count: usize) -> Vec<[usize; 3]> {
        let only = |piece| if let Piece::Triangle(corners) = piece { Some(corners) } else { None };
        pieces(primitive, count).into_iter().filter_map(only).collect()
    }

    #[test]
    fn vertices_are_read_as_the_specification_says() {
        assert_eq!(triangles(Primitive::Triangles, 8), [[0, 1, 2], [3, 4, 5]]);
        assert_eq!(triangles(Primitive::TriangleStrip, 5), [[0, 1, 2], [2, 1, 3], [2, 3, 4]]);
        assert_eq!(triangles(Primitive::TriangleFan, 5), [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
        assert_eq!(triangles(Primitive::Quads, 9), [[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]]);
        assert_eq!(triangles(Primitive::QuadStrip, 6), [[0, 1, 3], [0, 3, 2], [2, 3, 5], [2, 5, 4]]);
        assert_eq!(pieces(Primitive::LineLoop, 3), [[0, 1], [1, 2], [2, 0]].map(Piece::Line));
        assert_eq!(pieces(Primitive::Lines, 5), [[0, 1], [2, 3]].map(Piece::Line));
    }

    #[test]
    fn too_few_vertices_give_nothing() {
        use Primitive::*;
        for primitive in [Lines, LineStrip, Triangles, TriangleStrip, TriangleFan, Quads, QuadStrip, Polygon, LineLoop]
        {
            for count in 0..2 {
                assert_eq!(pieces(primitive, count), [], "{primitive:?} of {count}");
            }
        }
    }

    #[test]
    fn strips_of_a_zigzag_all_turn_the_same_way() {
        let points: Vec<_> = (0..12).map(|i| DVec2::new(f64::from(i / 2), f64::from(i % 2) * -3.0)).collect();
        for primitive in [Primitive::TriangleStrip, Primitive::QuadStrip] {
            let turns: Vec<_> =
                triangles(primitive, 12).into_iter().map(|[a, b, c]| side(points[a], points[b], points[c])).collect();
            assert!(turns.iter().all(|turn| *turn == turns[0] && *turn != Ordering::Equal), "{turns:?}");
        }
    }

    fn verdict(corners: &[(f64, f64, f64)]) -> (bool, bool, bool) {
        let corners: Vec<_> = corners.iter().copied().map(DVec3::from).collect();
        let OutlineProperties { simple, convex, flat } = check_outline(&corners);
        (simple, convex, flat)
    }

    #[test]
    fn outlines_are_classified() {
        let square = [(0.0, 0.0, 0.0), (4.0, 0.0, 0.0), (4.0, 4.0, 0.0), (0.0, 4.0, 0.0)];
        assert_eq!(verdict(&square), (true, true, true));
        let mut bent = square;
        bent[2].2 = 1.0;
        assert_eq!(verdict(&bent), (true, true, false));
        let mut concave = square;
        (concave[2].0, concave[2].1) = (1.0, 1.5);
        assert_eq!(verdict(&concave), (true, false, true));
        let mut bow_tie = square;
        bow_tie.swap(2, 3);
        assert_eq!(verdict(&bow_tie), (false, false, true));
        let spike = [(0.0, 0.0, 0.0), (4.0, 0.0, 0.0), (2.0, 0.0, 0.0), (2.0, 3.0, 0.0)];
        assert!(!verdict(&spike).0, "a side runs back over another");
    }
}
